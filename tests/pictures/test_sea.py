"""The sea around a basin: its heights are the basin's inside it, its spectrum the basin's outside."""

import subprocess
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from _white_water import followed
from scipy.ndimage import median_filter, zoom

from ocean_sim import waves
from ocean_sim.basin import points as points_module
from ocean_sim.observers import render
from ocean_sim.pictures import frame_files
from ocean_sim.pictures.stage import opengl, overlays
from ocean_sim.pictures.stage.picture import Picture
from ocean_sim.pictures.water import far_sea, foam, sea_state, water_surface, waterline
from ocean_sim.pictures.water.sea import SeaSurface
from ocean_sim.waves.orbits import surface_fall

with_opengl = pytest.mark.skipif(opengl.probe() is not None, reason="no OpenGL on this machine")
LOWER, UPPER = np.array([-20.0, -7.5, -15.0]), np.array([20.0, 0.0, 15.0])
X, Z = points_module.middles(-20.0, 20.0, 1.25), points_module.middles(-15.0, 15.0, 1.25)
HERE = np.zeros(2)
GRID = {"x": X, "z": Z, "lower": LOWER, "upper": UPPER, "depth": 7.5, "spacing": 1.25}


def standing(time: float) -> SimpleNamespace:
    """A sea of modes of the basin, none of which stands still."""
    rng = np.random.default_rng(3)
    height = np.zeros((len(X), len(Z)))
    for p, q in [(2, 1), (4, 3), (7, 2), (3, 6), (9, 5)]:
        shape = np.outer(np.cos(p * np.pi * (X + 20.0) / 40.0), np.cos(q * np.pi * (Z + 15.0) / 30.0))
        height += 0.12 * np.cos(rng.uniform(1.0, 2.0) * time + rng.uniform(0.0, 6.28)) * shape
    return SimpleNamespace(time=time, elevation=0.05 + height, answer=None, origin=HERE)


def spectrum(seed: int = 1) -> waves.Components:
    wanted = waves.Spectrum(significant_wave_height=1.0, peak_period=4.0, heading_deg=60.0, seed=seed)
    return wanted.components(waves.heading_vector(60.0, 3), 7.5)


def kept_waves(sea: waves.Components) -> dict[str, np.ndarray]:
    """As frames keep them."""
    return frame_files.wave_arrays(SimpleNamespace(plane_waves=sea, can_be_disturbed=False))


def state(exact: waves.Components | None = None) -> SimpleNamespace:
    """Of a sea in closed form, or of the standing one."""
    return SimpleNamespace(
        exact=exact, beyond=modes().sea if exact is None else far_sea.strongest_waves(exact), angle=0.6
    )


def modes() -> far_sea.Modes:
    return far_sea.Modes((len(X), len(Z)), (40.0, 30.0), 7.5, np.array([0.6, 0.8]))


def now(time: float, exact: waves.Components | None = None) -> sea_state.SeaNow:
    """As its state is at a time: of the standing sea that of all times."""
    if exact is not None:
        return sea_state.SeaNow(
            0.0, exact.significant_height, far_sea.grown_waves(far_sea.strongest_waves(exact), time), 5.0
        )
    variances = np.mean([modes().variances(standing(t).elevation) for t in np.arange(0.0, 20.0, 0.5)], axis=0)
    sea = replace(modes().sea, amplitude=np.sqrt(2.0 * variances))
    return sea_state.SeaNow(0.05, 4.0 * float(np.sqrt(variances.sum())), sea, 5.0)


def inner(surface: SeaSurface) -> tuple[tuple[np.ndarray, ...], tuple[np.ndarray, ...]]:
    """Nodes at which heights are kept and where the basin's own waves are whole, and the numbers of these heights."""
    own = [np.abs(known) < half - surface.margin for known, half in ((X, 20.0), (Z, 15.0))]
    at = [
        np.abs(nodes[:, None] - known[o]).argmin(axis=0) for nodes, known, o in zip((surface.x, surface.z), (X, Z), own)
    ]
    return np.ix_(*at), np.ix_(*own)


def test_inside_the_basin_the_drawn_height_is_the_kept_one_within_a_millimetre():
    surface = SeaSurface(GRID, state(), 12_000)
    frame = standing(7.3)
    drawn = surface.at(frame, now(7.3)).height
    at, own = inner(surface)
    np.testing.assert_allclose(surface.x[at[0].ravel()], X[own[0].ravel()], atol=1e-9)  # known points are nodes
    assert np.abs(drawn[at] - frame.elevation[own]).max() < 1e-3
    shifted = SimpleNamespace(time=frame.time, elevation=frame.elevation + 0.01, answer=None, origin=HERE)
    assert np.abs(surface.at(shifted, now(7.3)).height[at] - frame.elevation[own]).max() > 5e-3


def test_a_sea_in_closed_form_is_drawn_as_it_is_where_no_far_sea_blends_in():
    sea = spectrum()
    surface = SeaSurface(GRID, state(sea), 5_000)
    calm = SimpleNamespace(time=12.3, elevation=np.zeros((len(X), len(Z))), answer=None, origin=HERE)
    drawn = surface.at(calm, now(12.3, sea))
    inside = surface.share == 1.0
    places = surface.nodes[inside.ravel()]
    assert inside.sum() > 500 and np.abs(drawn.height[inside] - waves.elevation(sea, places, 12.3)).max() < 1e-9


def test_what_answers_to_a_ship_is_drawn_on_top_of_the_sea_and_ends_at_the_walls():
    sea, wake = spectrum(), standing(3.0).elevation
    surface = SeaSurface(GRID | {"sea_answers": np.array(True)}, state(sea), 12_000)
    calm = SimpleNamespace(time=12.3, elevation=np.zeros_like(wake), answer=np.zeros_like(wake), origin=HERE)
    answered = SimpleNamespace(**vars(calm) | {"answer": wake})
    added = surface.at(answered, now(12.3, sea), wake).height - surface.at(calm, now(12.3, sea)).height
    at, own = inner(surface)
    assert np.abs(added[at] - wake[own]).max() < 1e-3
    assert not added[[0, -1]].any() and not added[:, [0, -1]].any()


def test_a_sea_that_is_left_behind_is_drawn_around_the_ships():
    """The exact sea at the places where the nodes lie now."""
    sea, away = spectrum(), np.array([2.5, 250.0])
    surface = SeaSurface(GRID | {"sea_answers": np.array(True)}, state(sea), 12_000)
    still = np.zeros((len(X), len(Z)))
    calm = SimpleNamespace(time=12.3, elevation=still, answer=still, origin=away)
    drawn = surface.at(calm, now(12.3, sea)).height
    inside = surface.share == 1.0
    places = surface.nodes[inside.ravel()] + away
    assert np.abs(drawn[inside] - waves.elevation(sea, places, 12.3)).max() < 1e-9


def test_no_edge_shows_where_the_basin_ends():
    """The basin's own surface ends as the far sea: at its walls both have one height. None mirrors the other: heights
    5 m inside and 5 m outside a wall are as good as uncorrelated."""
    surface = SeaSurface(GRID, state(), 12_000)
    fan, sea = surface.fan, now(7.3)
    far = sea.waves
    rim = np.concatenate([surface.nodes[:: len(surface.z)], surface.nodes[-len(surface.z) :]])
    frame = standing(7.3)
    drawn = surface.at(frame, sea).height
    ends = np.concatenate([drawn[:, 0], drawn[-1]])
    np.testing.assert_allclose(ends, sea.level + waves.elevation(far, rim, frame.time), atol=1e-9)
    as_now = far.amplitude
    assert fan.turn_to(8.0, 0.0, 0.5, 0.4, 1e-3, 0.5e-3, as_now) and not fan.turn_to(
        8.1, 0.05, 0.5, 0.4, 1e-3, 0.5e-3, 1.01 * as_now
    )
    times = np.arange(0.0, 60.0, 0.7)
    column = int(np.abs(surface.x - 15.0).argmin())
    inside = np.array([surface.at(standing(t), sea).height[column] for t in times])
    across = np.stack([np.full(len(surface.z), 25.0), surface.z], axis=1)
    outside = np.array([waves.elevation(far, across, t) for t in times])
    assert abs(np.corrcoef(inside.ravel(), outside.ravel())[0, 1]) < 0.2


@pytest.mark.parametrize(("sea", "height"), [(spectrum(), 8.0), (spectrum(5), 25.0), (None, 12.0)])
def test_the_far_sea_keeps_its_height_for_a_kilometre(sea, height):
    fan = far_sea.Fan(now(0.0).waves if sea is None else far_sea.strongest_waves(sea))
    fan.turn_to(height, 0.3, 0.55, 0.5, 8.5e-4, 4.25e-4, fan.sea.amplitude)
    distance = np.hypot(*fan.nodes.reshape(*fan.shape, 2)[:, 0].T)
    kept = np.sqrt(((fan.sea.amplitude * fan.drawn) ** 2).sum(axis=1) / (fan.sea.amplitude**2).sum())
    assert kept[distance < 400.0].min() > 0.95
    if sea is not None:  # of waves of 25 m; shorter ones are narrower than a ray
        assert kept[distance < 1000.0].min() > 0.85
    assert distance[-1] > far_sea.SEA_RADIUS and np.prod(fan.shape) < 200_000
    drawn = fan.at(far_sea.complex_amplitudes(fan.sea, 2.0, np.array([7.0, -3.0])))[:40, :, 0].ravel()
    near = fan.nodes.reshape(*fan.shape, 2)[:40].reshape(-1, 2) + [7.0, -3.0]
    assert np.abs(drawn - waves.elevation(fan.sea, near, 2.0)).max() < 2e-3 * height  # single precision


def test_what_is_narrower_than_a_pixel_widens_the_glint_instead():
    sea = spectrum()
    fan = far_sea.Fan(far_sea.strongest_waves(sea))
    fan.turn_to(8.0, 0.0, 0.55, 0.5, 8.5e-4, 4.25e-4, fan.sea.amplitude)
    slopes, lost = 0.5 * ((fan.sea.amplitude * fan.sea.wavenumber) ** 2).sum(), fan.lost_variance(fan.sea.amplitude)
    assert lost[0] == pytest.approx(0.0, abs=1e-9) and lost[-1] == pytest.approx(0.5 * slopes)
    seen = fan.at(far_sea.complex_amplitudes(fan.sea, 2.0, HERE))
    assert not seen[-1].any() and seen[5, :, 1].any()


def test_the_far_sea_is_what_the_basin_s_was_lately():
    """Weights of the frames before a time: they add up to one, forget in a few seconds, and know of no later frame."""
    times = np.arange(0.0, 60.0, 0.1)
    for time in (0.0, 0.1, 3.3, 40.0):
        numbers, weights = sea_state.recent_frames(times, time)
        assert times[numbers].max() <= time + 1e-9 and (weights >= 0.0).all()
        assert weights.sum() == pytest.approx(1.0, abs=1e-12) and len(numbers) < 110
        assert (numbers, *weights) == (lambda n, w: (n, *w))(
            *sea_state.recent_frames(times[times <= time + 1e-9], time)
        )
    numbers, weights = sea_state.recent_frames(times, 40.0)
    age = 40.0 - times[numbers]
    assert weights[age > sea_state.SWELL_SECONDS].sum() == pytest.approx(np.exp(-1.0), abs=0.05)
    assert sea_state.recent_frames(np.array([2.0]), 2.0)[0] == [0]


def test_the_far_sea_has_the_variance_of_the_basin_and_runs_with_the_wind():
    kept, towards = [standing(t).elevation for t in np.arange(0.0, 20.0, 0.5)], np.array([0.6, 0.8])
    for elevation in kept[:3]:
        assert modes().variances(elevation).sum() == pytest.approx(elevation.var(), rel=1e-6)
    far = now(0.0).waves
    assert len(far.amplitude) <= far_sea.WAVENUMBER_SHELLS * far_sea.HEADING_SECTORS
    mean = (far.amplitude**2 * far.wavenumber).sum() / (far.amplitude**2).sum()
    of_modes = np.pi * np.hypot(np.array([2, 4, 7, 3, 9]) / 40.0, np.array([1, 3, 2, 6, 5]) / 30.0)
    assert of_modes.min() < mean < of_modes.max()
    broad = far_sea.Modes((32, 24), (40.0, 30.0), 7.5, towards)
    variances = broad.variances(np.random.default_rng(0).normal(size=(32, 24)))
    assert (variances[:, None] * broad.sea.wavevector).sum(axis=0) @ towards > 0.0
    places = np.random.default_rng(5).uniform(-4000.0, 4000.0, (4000, 2))
    assert waves.elevation(far, places, 3.0).var() == pytest.approx(0.5 * (far.amplitude**2).sum(), rel=0.1)


def test_still_water_makes_a_flat_far_sea():
    calm = far_sea.Modes((8, 6), (10.0, 8.0), 2.0, np.array([1.0, 0.0])).variances(np.full((8, 6), 0.2))
    assert not calm.any()


def test_crests_converge_by_their_wavenumber():
    """A standing wave of a closed basin: by linear theory its water is drawn together by k times its height."""
    for p, q in [(1, 0), (3, 2)]:
        shape = np.outer(np.cos(p * np.pi * (X + 20.0) / 40.0), np.cos(q * np.pi * (Z + 15.0) / 30.0))
        k = np.pi * np.hypot(p / 40.0, q / 30.0)
        np.testing.assert_allclose(surface_fall(0.3 * shape, 1.25, 1.25), k * 0.3 * shape, atol=1e-12)


def test_white_crests_cover_what_steepness_calls_for():
    surface = SeaSurface(GRID, state(), 12_000)
    gentle = surface.at(standing(7.3), now(7.3)).convergence
    steep = gentle * 0.45 / gentle.max()
    assert not surface.foam(gentle * 0.25 / gentle.max()).any()
    wanted = foam.crest_cover(steep)
    assert 0.0 < wanted <= foam.MAX_COVER
    assert surface.foam(steep).mean() == pytest.approx(wanted, rel=0.1)


def test_distance_to_the_waterline_of_a_box():
    vertices = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-0.5, 0.5) for z in (-3.0, 3.0)])
    from scipy.spatial import ConvexHull

    line = waterline.waterline_segments(vertices, ConvexHull(vertices).simplices, vertices[:, 1] - 0.1)
    points = np.array([[0.0, 0.0], [0.9, 0.0], [1.5, 0.0], [2.0, 4.0], [0.0, -5.0]])
    np.testing.assert_allclose(waterline.distance_to_line(points, line), [-1.0, -0.1, 0.5, 2.0**0.5, 2.0], atol=1e-9)
    assert not len(waterline.waterline_segments(vertices, ConvexHull(vertices).simplices, vertices[:, 1] + 9.0))


def test_a_tank_is_no_piece_of_sea(folder):
    first = frame_files.Frame(frame_files.frame_path(folder, 0))
    for basin, piece in ({"motion": None}, True), ({"motion": {"surge": 0.1}}, False), ({"obstacles": []}, True):
        assert sea_state.is_open_sea({"basin": {"length": 40.0} | basin}, first, 7.5) == piece
        assert not sea_state.is_open_sea({"basin": {"length": 6.0} | basin}, first, 7.5)
    first.elevation[3, 4] = -7.5
    assert not sea_state.is_open_sea({}, first, 7.5)


def test_the_wind_of_a_scene_leads_the_ripples():
    assert sea_state.scene_wind_heading({"heading_deg": 90.0}) == pytest.approx(0.0)
    assert sea_state.scene_wind_heading({"heading_deg": 0.0}) == pytest.approx(np.pi / 2)
    gust = {"volumes": [{"acceleration": [0.0, 2.0, -1.0]}]}
    assert (
        sea_state.scene_wind_heading(gust) == pytest.approx(-np.pi / 2)
        and sea_state.scene_wind_heading({"kind": "still"}) is None
    )
    assert sea_state.ripple_wind_speed({"wind": {"u10": 9.0}}, 0.2) == 9.0
    assert sea_state.ripple_wind_speed({"wind": {"u10": None, "tau": None}}, 0.2) == 10.0
    assert sea_state.ripple_wind_speed({"wind": {"u10": None, "tau": 0.177625}}, 0.2) == pytest.approx(10.0)
    assert far_sea.wind_speed_from_height(0.21 * 10.0**2 / 9.80665) == pytest.approx(10.0, rel=2e-3)


def test_a_young_sea_tells_of_the_wind_that_raised_it_and_a_swell_of_none():
    """JONSWAP's growth at g F / U^2 = 4000 in a wind of 12 m/s: H = 1.49 m, T_p = 5.55 s."""
    wind, fetch = 12.0, 4000.0
    height, peak = 0.0016 * fetch**0.5 * wind**2 / 9.80665, 22.0 * fetch ** (-1.0 / 3.0) * 9.80665 / wind

    def sea(height: float, period: float) -> waves.Components:
        made = waves.Spectrum(kind="jonswap", significant_wave_height=height, peak_period=period)
        return made.components(waves.heading_vector(30.0, 3), 4000.0)

    assert far_sea.wind_speed_from_sea(sea(height, 2.0 * np.pi / peak), 0.0) == pytest.approx(wind, rel=0.05)
    assert foam.monahan_cover(far_sea.wind_speed_from_sea(sea(3.0, 14.0), 0.0)) < 3e-4


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Three frames of the standing sea with a ship in it, as a run leaves them."""
    made = tmp_path_factory.mktemp("sea")
    (made / "frames").mkdir()
    from scipy.spatial import ConvexHull

    box = np.array([[x, y, z] for x in (-2.0, 2.0) for y in (-1.0, 2.0) for z in (-5.0, 5.0)])
    look = {"ship_look": "box", "ship_helm": np.zeros(0), "ship_still_water": np.eye(4)[1]}
    skin = ConvexHull(box)
    a, b, c = (box[skin.simplices[:, k]] for k in range(3))
    inwards = (np.cross(b - a, c - a) * skin.equations[:, :3]).sum(axis=1) < 0.0
    outwards = np.where(inwards[:, None], skin.simplices[:, ::-1], skin.simplices)  # as every hull of a run
    hull = look | {"ship_vertices": box, "ship_triangles": outwards}
    np.savez(made / "frames" / "grid.npz", **GRID, every=0.5, has_surface=True, **hull)
    for k, t in enumerate((0.0, 0.5, 1.0)):
        kept = standing(t)
        place = {"ship_position": np.zeros(3), "ship_turn": np.eye(3)}
        np.savez(made / "frames" / f"frame_{k:05d}.npz", time=t, elevation=kept.elevation.astype(np.float32), **place)
    return made


QUALITIES = ("draft", "final")
MARKED, BARE, CALM = {"scale_bar": True}, {"caption": False}, {"ripples": False}
LOOKS = [{"quality": quality} | more for quality in QUALITIES for more in (MARKED, BARE, CALM)]
LOOKS += [{"camera": "top", "scale_bar": on, "caption": False} for on in (True, False)]


@pytest.fixture(scope="module")
def picture(folder, tmp_path_factory):
    """Pictures of the frames, each drawn once; those of LOOKS by one process, which takes long to begin."""
    import imageio.v2 as imageio

    made = {}

    def drawn(**options):
        if tuple(options.items()) not in made:
            asked = LOOKS if options in LOOKS else [options]
            outs = [tmp_path_factory.mktemp("picture") for _ in asked]
            orders = [render.order_of(folder, out=o, size=(320, 180), film=False, **one) for o, one in zip(outs, asked)]
            render.draw_apart(orders)
            images = [imageio.imread(out / "preview.png").astype(float) for out in outs]
            made.update({tuple(one.items()): image for one, image in zip(asked, images)})
        return made[tuple(options.items())]

    return drawn


@pytest.mark.slow
@with_opengl
def test_each_part_of_the_sea_switches_off_by_itself(picture):
    whole = picture()
    assert whole.std() > 15.0 and np.isfinite(whole).all()
    for part, least in {"far_sea": 1.0, "ripples": 1.0, "sky": 1.0, "foam": 0.01}.items():
        changed = np.abs(picture(**{part: False}) - whole).mean()
        assert changed > least, part


@with_opengl
@pytest.mark.parametrize("program", ["SHIP_PROGRAM", "SHIP_FUNCTIONS"])
def test_a_program_that_the_driver_refuses_is_no_picture(folder, tmp_path, program):
    """VTK would only log it, and leave out the ship."""
    order = render.order_of(folder, size=(64, 64), film=False, out=tmp_path)
    asked = render.Request(orders=[order], goes_on=False).model_dump_json()
    broken = f"ship_glsl.{program} += 'mistaken;'; sys.argv = ['', {asked!r}]; render.main()"
    imports = "import sys; from ocean_sim.observers import render; from ocean_sim.pictures.ships import ship_glsl"
    code = f"{imports}; {broken}"
    drawing, pipe = opengl.drawing_environment(opengl.window()), subprocess.PIPE
    with subprocess.Popen([sys.executable, "-c", code], env=drawing, stdin=pipe, stderr=pipe, text=True) as child:
        told = child.stderr.read()
    assert child.returncode == 1 and not list(tmp_path.iterdir())
    assert told.splitlines()[-1].startswith("OpenGL refuses a program of this picture: error: ")


@pytest.mark.slow
@with_opengl
def test_a_film_shows_what_a_final_picture_shows(picture):
    """Smoother edges and a finer mesh change no mean over 20 x 20 pixels by much: in both the ship is mirrored."""

    def blocks(quality):
        return picture(quality=quality, **CALM).reshape(9, 20, 16, 20, 3).mean(axis=(1, 3))

    change = np.abs(blocks("final") - blocks("draft")).max(axis=2)
    assert np.median(change) < 4.0 and np.quantile(change, 0.95) < 10.0


@with_opengl
@pytest.mark.parametrize("eye", [1.7, 40.0])
def test_water_far_away_changes_no_more_than_in_pictures_of_finer_pixels(tmp_path, eye):
    """What shimmers, or stands in stripes that are not there, changes more from one picture to the next than the means
    of pixels a third as wide; slopes that a pixel is too wide for are told by the width of the glint, and still."""
    (tmp_path / "frames").mkdir()
    sea, moments = spectrum(), (0.0, 0.08, 0.16)
    np.savez(tmp_path / "frames" / "grid.npz", **GRID, **kept_waves(sea), every=0.08, has_surface=True)
    for k, t in enumerate(moments):
        height = waves.elevation(sea, points_module.grid_points(X, Z), t).reshape(len(X), len(Z))
        np.savez(tmp_path / "frames" / f"frame_{k:05d}.npz", time=t, elevation=height)
    files, grid = frame_files.frame_files(tmp_path), dict(np.load(tmp_path / "frames" / "grid.npz"))

    def changes(finer):
        """(rows,) mean change of pixels from one picture to the next, from the horizon down."""
        order = render.order_of(
            tmp_path,
            camera="fixed",
            eye=(0.0, eye, 60.0),
            target=(0.0, eye, -200.0),
            size=(320 * finer, 180 * finer),
            foam=False,
            caption=False,
        )
        drawn = Picture(grid, order, frame_files.Frame(files[0]), 1.0, frame_files.FrameLog(files))
        film = np.array([drawn.draw(frame_files.Frame(file)) for file in files], float)
        drawn.close()
        film = film.reshape(len(files), 180, finer, 320, finer, 3).mean(axis=(2, 4))
        return np.abs(np.diff(film, axis=0)).mean(axis=(0, 2, 3))[91:]

    coarse, fine = changes(1), changes(3)
    assert coarse[:8].mean() < 1.2 * fine[:8].mean() + 0.1 and coarse[8:40].mean() < fine[8:40].mean()


@with_opengl
@pytest.mark.parametrize("quality", QUALITIES)
def test_words_and_the_scale_bar_are_as_large_in_every_quality(picture, quality):
    marked, bare = picture(quality=quality, **MARKED), picture(quality=quality, **BARE)
    changed = np.abs(marked - bare).max(axis=2) > 8.0
    low = changed[-16:-12, 160:]
    assert 0.1 * 320 < low.any(axis=0).sum() < 0.27 * 320  # the bar
    rows = np.flatnonzero(changed[:, :100].any(axis=1))
    assert 10 <= np.ptp(rows) + 1 <= 24 and rows.min() > 140  # the time


@with_opengl
def test_a_map_tells_which_colour_is_which_height(picture):
    marked, bare = (picture(camera="top", scale_bar=on, caption=False) for on in (True, False))
    left = 320 - overlays.BAR_LEFT
    bar = marked[56:124, left : left + overlays.BAR_WIDTH].mean(axis=1)
    assert (np.diff(bar.sum(axis=1)) <= 1e-9).all() and np.ptp(bar.sum(axis=1)) > 200.0  # crests are pale
    assert (np.abs(marked - bare).max(axis=2)[50:130, 230:320] > 40.0).sum() > 60  # heights in metres
    assert not np.abs(marked - bare)[:, : left - 3].any()


def test_heights_of_a_map_end_at_round_numbers_that_hold_them():
    assert [water_surface.round_up(v) for v in (0.011, 0.12, 0.95, 1.3, 2.0, 71.0)] == pytest.approx(
        [0.015, 0.15, 1.0, 1.5, 2.0, 80.0]
    )


def test_frames_keep_the_waves_of_a_sea_in_closed_form_and_nothing_of_particles():
    sea = spectrum()
    assert set(kept_waves(sea)) == {
        "sea_amplitude",
        "sea_wavevector",
        "sea_phase",
        "sea_ramp",
    }
    assert frame_files.wave_arrays(SimpleNamespace(plane_waves=None, can_be_disturbed=False)) == {}
    assert frame_files.wave_arrays(SimpleNamespace(plane_waves=sea, can_be_disturbed=True))["sea_answers"]


def test_foam_covers_what_is_asked_for():
    surface = SeaSurface(GRID, state(), 12_000)
    gentle = surface.at(standing(7.3), now(7.3)).convergence
    for wanted in (0.01, 0.05, 0.2):
        assert surface.foam(gentle, wanted).mean() == pytest.approx(wanted, rel=0.1)
    assert not surface.foam(gentle, 0.0).any()


@pytest.mark.parametrize("moves", [0.0, 1.0])
def test_foam_lives_as_long_as_whitecaps_do_and_covers_what_is_asked_for(moves):
    """Followed with the water, at rest and in motion: of what is white, most is after a second and a part after a fall
    to a third; the mean cover is the wanted one, whose own fluctuations leave no trace in it."""
    wanted, step = 0.04, 0.1
    covers = wanted * (1.0 + 0.6 * np.sin(2.0 * step * np.arange(400)))
    kept, ways = whitened(X, Z, far_sea.strongest_waves(spectrum(), 40), covers, moves)
    white = np.array(kept[100:])
    assert white.mean() == pytest.approx(wanted, rel=0.2)
    for after, least, most in ((10, 0.6, 1.0), (35, 0.15, 0.35)):
        shares = [followed(kept, ways, n, after) for n in range(100, 400 - after, 7)]
        assert least <= np.mean(np.concatenate(shares)) <= most, after


def test_where_little_of_the_sea_is_white_foam_lasts_as_long():
    """In short waves, too, whose steepest points are single cells: what is born there must not be as small."""
    wanted = 0.002
    x = points_module.middles(-40.0, 40.0, 1.25)
    kept, ways = whitened(x, x, spectrum(), np.full(300, wanted))
    assert np.mean(kept[100:]) == pytest.approx(wanted, rel=0.2)
    for after, least, most in ((10, 0.6, 1.0), (35, 0.15, 0.35)):
        shares = [followed(kept, ways, n, after) for n in range(60, 300 - after, 7)]
        assert least <= np.mean(np.concatenate(shares)) <= most, after
    grown = np.diff(kept[60:], axis=0).max()
    assert grown < 0.5  # of a cell in a step of 0.1 s: patches do not pop up


def test_where_waves_have_just_begun_to_break_foam_is_what_is_asked_for_from_the_first():
    """In a small basin, too, of whose water a patch of foam is a share as large as what is asked for."""
    x, wanted, begins = points_module.middles(-20.0, 20.0, 1.25), 0.004, 20
    kept, _ = whitened(x, x, spectrum(), np.where(np.arange(60) < begins, 0.0, wanted))
    assert not np.any(kept[:begins])
    assert np.mean(kept[begins:]) == pytest.approx(wanted, rel=0.2)


def test_foam_is_the_same_however_often_it_is_looked_at():
    """At 10 and at 30 pictures a second, a tick of its clock apart and between two ticks, in the middle of five seas:
    where few patches are on a sea, another crest may be the next to break."""
    x, wanted, seconds, apart = points_module.middles(-20.0, 20.0, 1.25), 0.03, 5.0, []
    for turn in range(5):
        sea = spectrum()
        sea = replace(sea, phase=sea.phase + turn * np.arange(len(sea.phase)))
        seldom, _ = whitened(x, x, sea, np.full(round(10 * seconds), wanted))
        often, _ = whitened(x, x, sea, np.full(round(30 * seconds), wanted), step=0.1 / 3.0)
        for pictures in (range(20, 50, 2), range(21, 50, 2)):
            off = np.mean([np.abs(seldom[n] - often[3 * n]).mean() for n in pictures])
            apart.append(off / np.mean([often[3 * n].mean() for n in pictures]))
    assert np.median(apart) < 0.15


def test_foam_turns_white_and_moves_as_evenly_between_the_ticks_of_its_clock_as_at_them():
    x = points_module.middles(-20.0, 20.0, 1.25)
    often, _ = whitened(x, x, spectrum(), np.full(150, 0.03), step=0.1 / 3.0)
    changes = np.abs(np.diff(often[30:], axis=0)).mean(axis=(1, 2))
    around = median_filter(
        changes, 2 * round(foam.BREAKING_INTERVAL * 30.0) + 1
    )  # as crests come and go, more or less breaks
    assert (changes / around).max() < 1.5 and changes.max() < 3.0 * np.median(changes)


def whitened(
    x: np.ndarray, z: np.ndarray, sea: waves.Components, covers: np.ndarray, moves: float = 1.0, step: float = 0.1
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """White water at points 1.25 m apart in a sea, every step [s], at covers that are called for, and the ways
    by which it goes in a step [cells]: those of the water times `moves`."""
    places = np.stack(np.meshgrid(x, z, indexing="ij"), axis=-1)
    shape, flat = (len(x), len(z)), np.insert(places.reshape(-1, 2), 1, 0.0, axis=1)
    field, kept, ways = foam.FoamField(shape, np.array([1.25, 1.25])), [], []
    for n, wanted in enumerate(covers):
        elevation = waves.elevation(sea, places.reshape(-1, 2), step * n).reshape(shape)
        ways.append(moves * waves.linear_velocity(sea, flat, step * n)[:, [0, 2]].reshape(*shape, 2))
        field.advance(step * n, ways[-1], surface_fall(elevation, 1.25, 1.25), float(wanted))
        kept.append(field.white.copy())
    return kept, [step / 1.25 * way for way in ways]


def unevenness(surface: SeaSurface, white: np.ndarray) -> float:
    """Spread of the distances of a spot's edge from its middle over their mean."""
    inside = white > 0.3
    core = inside.copy()
    for axis in (0, 1):
        for way in (1, -1):
            core &= np.roll(inside, way, axis=axis)
    places = surface.nodes.reshape(*white.shape, 2)
    away = np.linalg.norm(places[inside & ~core] - places[inside].mean(axis=0), axis=-1)
    return float(away.std() / away.mean())


def test_foam_of_a_coarse_grid_is_not_round_and_covers_as_much():
    """White cells on their own: a spline makes round spots of them, whose edges lie equally far from the middle."""
    surface = SeaSurface(GRID, state(), 40_000)
    uneven, cover = [], []
    for i, k in [(12, 10), (15, 14), (18, 9), (20, 13), (14, 12), (17, 15)]:
        kept = np.zeros((len(X), len(Z)))
        kept[i - 1 : i + 2, k - 1 : k + 2] = [[0.5, 0.7, 0.5], [0.7, 1.0, 0.7], [0.5, 0.7, 0.5]]
        both = surface.on_nodes(kept), surface.laced_foam(kept, surface.nodes)
        uneven.append([unevenness(surface, white) for white in both])
        cover.append([white.mean() for white in both])
    (round_spots, laced), (before, after) = np.mean(uneven, axis=0), np.mean(cover, axis=0)
    assert laced > 2.0 * round_spots
    assert after == pytest.approx(before, rel=0.15)


def test_foam_is_drawn_out_along_the_wind_and_its_cover_stays():
    """Edges are bent farther along it, so that patches become streaks, and its grain is longer."""
    x, z = (part.ravel() for part in np.meshgrid(np.arange(0.0, 120.0, 0.5), np.arange(0.0, 120.0, 0.5), indexing="ij"))
    for angle in (0.0, 0.7, -2.0):
        way = np.array([np.cos(angle), np.sin(angle)])
        bent = foam.edge_bends(x, z, angle)
        along, across = way @ bent, np.array([-way[1], way[0]]) @ bent
        assert along.std() == pytest.approx(foam.STREAK_STRETCH * across.std(), rel=0.1)
        gone = foam.grain_places(np.stack([x, z], axis=1), angle)
        np.testing.assert_allclose(gone @ way, (way[0] * x + way[1] * z) / foam.THREAD_STRETCH, atol=1e-9)
        np.testing.assert_allclose(gone @ [-way[1], way[0]], way[0] * z - way[1] * x, atol=1e-9)


def test_foam_between_the_middles_of_cells_is_scipy_s_byte_for_byte():
    cells = np.random.default_rng(2).normal(size=(20, 31))
    cells[3:6] = 0.0
    expected = zoom(cells, foam.FLECKS_PER_CELL, order=1, mode="nearest", grid_mode=True)
    assert foam.refined_cells(cells).tobytes() == expected.tobytes()


def test_foam_goes_with_the_water_and_its_grain_with_it():
    field = foam.FoamField((40, 30), np.array([0.5, 0.5]))
    x, z = np.meshgrid(0.5 * np.arange(40), 0.5 * np.arange(30), indexing="ij")
    spot = np.exp(-((x - 6.0) ** 2 + (z - 7.0) ** 2))
    velocity = np.broadcast_to([1.5, -0.5], (40, 30, 2))
    field.advance(0.0, velocity, spot, None)
    for n in range(1, 31):
        field.advance(0.1 * n, velocity, np.zeros_like(spot), None)
    carried = np.exp(-((x - 10.5) ** 2 + (z - 5.5) ** 2)) * np.exp(-3.0 / foam.FADE_SECONDS)
    assert np.abs(field.white - foam.refined_cells(carried)).max() < 0.03
    np.testing.assert_allclose(foam.cell_means(foam.refined_cells(carried), x.shape).sum(), carried.sum(), rtol=1e-3)
    expected = (1.5 * foam.GRAIN_SECONDS) * (1.0 - np.exp(-3.0 / foam.GRAIN_SECONDS))
    np.testing.assert_allclose(field.carried[20, 15, 0], expected, rtol=0.03)
    before, (i, k) = field.white.copy(), foam.FLECKS_PER_CELL * np.array([3, 2])
    field.shift(np.array([3, -2]))
    np.testing.assert_array_equal(field.white[:-i, k:], before[i:, :-k])
    assert not field.white[-i:].any() and not field.white[:, :k].any()


def test_between_ticks_foam_asks_for_no_crests():
    """Twelve frames a second: five of them look for crests, and the others see the same foam without."""
    shape, side, asked = (40, 40), np.array([0.5, 0.5]), 0
    always, due = (foam.FoamField(shape, side) for _ in range(2))
    x = 0.5 * np.arange(40)[:, None] + np.zeros(shape)
    velocity = np.broadcast_to([1.5, -0.5], (*shape, 2))
    for time in np.arange(25) / 12.0:
        drawn_together = 0.6 * np.cos(0.8 * x - 2.8 * time)
        always.advance(time, velocity, drawn_together, 0.05)
        looks = due.due(time)
        due.advance(time, velocity, *((drawn_together, 0.05) if looks else (None,)))
        asked += looks
        assert due.white.tobytes() == always.white.tobytes()
    assert asked == 11 and due.white.any()


def test_what_the_wind_whitens_is_what_was_counted():
    """Monahan & O'Muircheartaigh (1980): about 1 % at 10 m/s, 4 % at 15 m/s."""
    np.testing.assert_allclose([foam.monahan_cover(10.0), foam.monahan_cover(15.0)], [0.0099, 0.0393], rtol=0.02)


def test_foam_that_goes_around_in_a_circle_comes_back():
    """Half a turn in 31 steps: with the velocity at the end of each it would spiral inwards by 14 %."""
    field, side = foam.FoamField((40, 40), np.array([0.5, 0.5])), 0.5 * (np.arange(40) - 19.5)
    x, z = np.meshgrid(side, side, indexing="ij")
    spot = np.exp(-((x - 6.0) ** 2 + z**2) / 2.0)
    velocity = np.stack([-z, x], axis=-1)
    field.advance(0.0, velocity, spot, None)
    for n in range(1, 32):
        field.advance(0.1 * n, velocity, np.zeros_like(spot), None)
    fine = 0.25 * (np.arange(80) - 39.5)
    middle = (field.white.sum(axis=1) @ fine, field.white.sum(axis=0) @ fine) / field.white.sum()
    assert np.hypot(*middle) == pytest.approx(6.0, rel=0.02)


def test_patches_that_turn_white_go_with_the_water():
    field = foam.FoamField((40, 40), np.array([0.5, 0.5]))
    field.advance(0.0, np.zeros((40, 40, 2)), np.zeros((40, 40)), None)
    patch = np.zeros((80, 80))
    patch[20:28, 20:28] = 1.0
    field.add(patch, np.zeros_like(patch))
    for time in (0.1, 0.2):
        field.advance(time, np.broadcast_to([2.5, 0.0], (40, 40, 2)), np.zeros((40, 40)), None)
        assert (field.white > 0.05).sum() == 64 and field.white.max() == pytest.approx(time / foam.RISE_SECONDS)
    np.testing.assert_array_equal(np.argwhere(field.white).min(axis=0), [22, 20])


def test_foam_is_thick_when_it_is_born_and_wholly_white_for_a_while():
    """It fades by its thickness, not by what is seen of it; drawn apart by half it has no gaps, by three times it is
    thinner."""
    field, still = foam.FoamField((10, 10), np.array([1.0, 1.0])), np.zeros((10, 10, 2))
    field.advance(0.0, still, np.zeros((10, 10)), 0.0)
    patch = np.zeros((20, 20))
    patch[8:12, 8:12] = foam.FRESH_THICKNESS
    field.add(patch, patch)
    for after in (0.5, 1.0, 3.5):
        field.advance(after, still, np.zeros((10, 10)), 0.0)
        expected = min(foam.FRESH_THICKNESS * np.exp(-after / foam.FADE_SECONDS), 1.0)
        np.testing.assert_allclose(field.white[9:11, 9:11], expected, rtol=1e-9)
    assert field.white[9, 9] > 0.3 and not field.white[:8].any()
    place = field.flecks[0].copy()
    for times, least, most in ((1.5, 0.999, 1.001), (4.0, 0.3, 0.8)):
        field.flecks[0] = 4.5 + times * (place - 4.5)
        middle = field.cell_shares(field.flecks[2])[8:12, 9:11]
        assert least < middle.mean() / expected < most


def test_crests_break_sooner_where_the_water_is_not_white_yet(monkeypatch):
    """Of two crests that are alike the one over clear water."""
    monkeypatch.setattr(foam, "gathering_noise", lambda places: np.ones(places.shape[1:]))
    field = foam.FoamField((40, 40), np.array([1.0, 1.0]))
    field.advance(0.0, np.zeros((40, 40, 2)), np.zeros((40, 40)), 0.0)
    half = 0.5 * (np.arange(80) < 40) * np.ones((80, 1))
    field.add(half, half)
    x = np.arange(40)[:, None] - 19.5
    drawn = np.exp(-(x**2) / 8.0) * (np.abs(np.abs(np.arange(40) - 19.5) - 10.0) < 5.0)
    field.cover = 0.3
    made = field.breaking_foam(drawn, 0.0, 0.0)
    assert made[:, 40:].sum() > 1.05 * made[:, :40].sum() > 0.0
