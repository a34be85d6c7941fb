"""The sea around a basin: its heights are the basin's inside it, its spectrum the basin's outside."""

import json
import shutil
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from ocean_sim import waves
from ocean_sim.basin import points as points_module
from ocean_sim.observers import frames, render
from ocean_sim.pictures import far_sea, foam, opengl, sea_state, sea_surface, spray
from ocean_sim.pictures import ripples as ripples_module

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
    return wanted.components(waves.direction(60.0, 3), 7.5)


def state(exact: waves.Components | None = None) -> sea_state.SeaState:
    kept = [standing(t).elevation for t in np.arange(0.0, 20.0, 0.5)]
    estimated = far_sea.of_frames(kept, (40.0, 30.0), 7.5, np.array([0.6, 0.8]))
    height = 4.0 * float(np.mean([e.std() for e in kept]))
    return sea_state.SeaState(exact, estimated, ripples_module.Wind(5.0, 0.3), 0.05, height, 1.25, True)


def test_inside_the_basin_the_drawn_height_is_the_kept_one_within_a_millimetre():
    surface = sea_surface.SeaSurface(GRID, state(), 12_000)
    frame = standing(7.3)
    drawn = surface.at(frame).height
    at_x, at_z = (np.abs(nodes[:, None] - known).argmin(axis=0) for nodes, known in ((surface.x, X), (surface.z, Z)))
    np.testing.assert_allclose(surface.x[at_x], X, atol=1e-9)  # the points that are known are nodes
    assert np.abs(drawn[np.ix_(at_x, at_z)] - frame.elevation).max() < 1e-3
    shifted = SimpleNamespace(time=frame.time, elevation=frame.elevation + 0.01, answer=None, origin=HERE)
    assert np.abs(surface.at(shifted).height[np.ix_(at_x, at_z)] - frame.elevation).max() > 5e-3


def test_a_sea_in_closed_form_is_drawn_as_it_is_at_every_node_of_the_basin():
    sea = spectrum()
    surface = sea_surface.SeaSurface(GRID, state(sea), 5_000)
    drawn = surface.at(SimpleNamespace(time=12.3, elevation=np.zeros((len(X), len(Z))), answer=None, origin=HERE))
    inside = (np.abs(surface.x) <= 20.0)[:, None] & (np.abs(surface.z) <= 15.0)
    places = surface.nodes[inside.ravel()]
    assert np.abs(drawn.height[inside] - waves.elevation(sea, places, 12.3)).max() < 1e-9


def test_what_answers_to_a_ship_is_drawn_on_top_of_the_sea_and_ends_in_the_margin():
    sea, wake = spectrum(), standing(3.0).elevation
    surface = sea_surface.SeaSurface(GRID | {"sea_answers": np.array(True)}, state(sea), 12_000)
    drawn = surface.at(SimpleNamespace(time=12.3, elevation=np.zeros_like(wake), answer=wake, origin=HERE)).height
    added = drawn - surface.far.at(12.3, HERE).height
    at_x, at_z = (np.abs(nodes[:, None] - known).argmin(axis=0) for nodes, known in ((surface.x, X), (surface.z, Z)))
    assert np.abs(added[np.ix_(at_x, at_z)] - wake).max() < 1e-3
    far = np.abs(surface.x) > 20.0 + 1.01 * surface.margin
    assert not added[far].any()


def test_a_sea_that_is_left_behind_is_drawn_around_the_ships():
    """The exact sea at the places where the nodes lie now, and what answers to ships on top of it there."""
    sea, wake, away = spectrum(), standing(3.0).elevation, np.array([2.5, 250.0])
    surface = sea_surface.SeaSurface(GRID | {"sea_answers": np.array(True)}, state(sea), 12_000)
    frame = SimpleNamespace(time=12.3, elevation=np.zeros_like(wake), answer=0.0 * wake, origin=away)
    drawn = surface.at(frame).height
    inside = (np.abs(surface.x) <= 20.0)[:, None] & (np.abs(surface.z) <= 15.0)
    places = surface.nodes[inside.ravel()] + away
    assert np.abs(drawn[inside] - waves.elevation(sea, places, 12.3)).max() < 1e-9
    frame.answer = wake
    added = surface.at(frame).height - drawn
    at_x, at_z = (np.abs(nodes[:, None] - known).argmin(axis=0) for nodes, known in ((surface.x, X), (surface.z, Z)))
    assert np.abs(added[np.ix_(at_x, at_z)] - wake).max() < 1e-3


def test_no_edge_shows_where_the_basin_ends():
    """Neighbouring nodes differ no more across the rim and in the margin than within the basin."""
    surface = sea_surface.SeaSurface(GRID, state(), 12_000)
    height = surface.at(standing(7.3)).height
    slope = np.abs(np.diff(height, axis=0) / np.diff(surface.x)[:, None])
    middle = 0.5 * (surface.x[1:] + surface.x[:-1])
    across = np.abs(np.abs(middle) - 20.0) < 1.0
    within, margin = np.abs(middle) < 19.0, (np.abs(middle) > 20.0) & (np.abs(middle) < 20.0 + surface.margin)
    assert slope[across].max() < 1.2 * slope[within].max() and slope[margin].max() < 1.8 * slope[within].max()
    assert surface.x[0] < -far_sea.OUT and surface.x[-1] > far_sea.OUT


def test_the_far_sea_has_the_variance_of_the_basin_and_runs_with_the_wind():
    kept = [standing(t).elevation for t in np.arange(0.0, 20.0, 0.5)]
    towards = np.array([0.6, 0.8])
    far = far_sea.of_frames(kept, (40.0, 30.0), 7.5, towards)
    assert 0.5 * (far.amplitude**2).sum() == pytest.approx(np.mean([e.var() for e in kept]), rel=1e-6)
    mean = (far.amplitude**2 * far.wavenumber).sum() / (far.amplitude**2).sum()
    modes = np.pi * np.hypot(np.array([2, 4, 7, 3, 9]) / 40.0, np.array([1, 3, 2, 6, 5]) / 30.0)
    assert modes.min() < mean < modes.max()
    many = far_sea.of_frames([np.random.default_rng(0).normal(size=(32, 24))], (40.0, 30.0), 7.5, towards)
    assert ((many.amplitude**2)[:, None] * many.wavevector).sum(axis=0) @ towards > 0.0
    places = np.random.default_rng(5).uniform(-4000.0, 4000.0, (4000, 2))
    assert waves.elevation(far, places, 3.0).var() == pytest.approx(0.5 * (far.amplitude**2).sum(), rel=0.1)


def test_still_water_makes_a_flat_far_sea():
    far = far_sea.of_frames([np.full((8, 6), 0.2)], (10.0, 8.0), 2.0, np.array([1.0, 0.0]))
    assert not waves.elevation(far, np.zeros((3, 2))).any()


def test_waves_that_the_grid_cannot_hold_widen_the_glint_instead():
    sea = spectrum()
    x = np.array([-2000.0, -1000.0, -1.0, -0.5, 0.0, 0.5, 1.0, 1000.0, 2000.0])
    far = far_sea.FarSea(sea, x, x, np.full(2, -1.0), np.full(2, 1.0))
    slopes = 0.5 * ((sea.amplitude * sea.wavenumber) ** 2).sum()
    assert far.variance[4, 4] == pytest.approx(0.0, abs=1e-9) and far.variance[0, 0] == pytest.approx(0.5 * slopes)
    assert abs(far.at(1.0, HERE).height[0, 0]) < 1e-9


def test_crests_converge_by_their_wavenumber():
    """A standing wave of a closed basin: by linear theory its water is drawn together by k times its height."""
    for p, q in [(1, 0), (3, 2)]:
        shape = np.outer(np.cos(p * np.pi * (X + 20.0) / 40.0), np.cos(q * np.pi * (Z + 15.0) / 30.0))
        k = np.pi * np.hypot(p / 40.0, q / 30.0)
        np.testing.assert_allclose(foam.convergence(0.3 * shape, 1.25, 1.25), k * 0.3 * shape, atol=1e-12)


def test_white_crests_cover_what_steepness_calls_for():
    surface = sea_surface.SeaSurface(GRID, state(), 12_000)
    gentle = surface.at(standing(7.3)).convergence
    steep = gentle * 0.45 / gentle[surface.near].max()
    assert not surface.foam(gentle * 0.25 / gentle[surface.near].max()).any()
    wanted = foam.cover(steep[surface.near])
    assert 0.0 < wanted <= foam.MOST
    assert surface.foam(steep)[surface.near].mean() == pytest.approx(wanted, rel=0.1)


def test_distance_to_the_waterline_of_a_box():
    vertices = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-0.5, 0.5) for z in (-3.0, 3.0)])
    from scipy.spatial import ConvexHull

    line = foam.waterline(vertices, ConvexHull(vertices).simplices, vertices[:, 1] - 0.1)
    points = np.array([[0.0, 0.0], [0.9, 0.0], [1.5, 0.0], [2.0, 4.0], [0.0, -5.0]])
    np.testing.assert_allclose(foam.distance(points, line), [-1.0, -0.1, 0.5, 2.0**0.5, 2.0], atol=1e-9)
    assert not len(foam.waterline(vertices, ConvexHull(vertices).simplices, vertices[:, 1] + 9.0))


def test_a_drop_is_isolated_and_water_is_not():
    block = np.stack(np.meshgrid(*[np.arange(6) * 1.0] * 3), axis=-1).reshape(-1, 3)
    drops = np.array([[2.0, 9.0, 2.0], [4.0, 12.0, 4.0]])
    found = spray.isolated(np.concatenate([block, drops]), 1.0)
    assert found.sum() == 2 and found[-2:].all()


def test_a_tank_is_no_piece_of_sea(folder, tmp_path):
    assert sea_state.of_run(folder, GRID).open
    beside = tmp_path / "tank"
    shutil.copytree(folder, beside)
    for basin, piece in ({"motion": None}, True), ({"motion": {"surge": 0.1}}, False), ({"obstacles": []}, True):
        (beside / "manifest.json").write_text(json.dumps({"scene": {"basin": basin}}))
        assert sea_state.of_run(beside, GRID).open == piece
    last = beside / "frames" / "frame_00002.npz"
    dry = dict(np.load(last)) | {"elevation": np.full((len(X), len(Z)), -7.5)}
    np.savez(last, **dry)
    assert not sea_state.of_run(beside, GRID).open


def test_the_wind_of_a_scene_leads_the_ripples():
    assert sea_state.heading({"heading_deg": 90.0}) == pytest.approx(0.0)
    assert sea_state.heading({"heading_deg": 0.0}) == pytest.approx(np.pi / 2)
    gust = {"volumes": [{"acceleration": [0.0, 2.0, -1.0]}]}
    assert sea_state.heading(gust) == pytest.approx(-np.pi / 2) and sea_state.heading({"kind": "still"}) is None
    wind = sea_state.wind_of({"wind": {"u10": 9.0}}, None, 0.2)
    assert wind.speed == 9.0
    assert sea_state.wind_of({"wind": {"u10": None, "tau": None}}, None, 0.2).speed == 10.0
    assert sea_state.wind_of({"wind": {"u10": None, "tau": 0.177625}}, None, 0.2).speed == pytest.approx(10.0)
    assert far_sea.wind_speed_of(0.21 * 10.0**2 / 9.80665) == pytest.approx(10.0, rel=2e-3)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Three frames of the standing sea with a ship in it, as a run leaves them."""
    made = tmp_path_factory.mktemp("sea")
    (made / "frames").mkdir()
    from scipy.spatial import ConvexHull

    box = np.array([[x, y, z] for x in (-2.0, 2.0) for y in (-1.0, 2.0) for z in (-5.0, 5.0)])
    look = {"ship_look": "box", "ship_helm": np.zeros(0), "ship_submerged": 1.0 / 3.0}
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


@pytest.fixture(scope="module")
def picture(folder):
    """Pictures of the frames, each drawn once."""
    import imageio.v2 as imageio

    @cache
    def drawn(**options):
        [file] = render.render_run(folder, size=(320, 180), film=False, **options)
        return np.asarray(imageio.imread(file)).astype(float)

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
def test_the_ship_is_mirrored_in_a_final_picture(picture):
    """Smooth edges change no mean over 20 x 20 pixels by much; the mirrored hull does."""

    def blocks(quality):
        return picture(**quality, ripples=False).reshape(9, 20, 16, 20, 3).mean(axis=(1, 3))

    change = np.abs(blocks({"quality": "final"}) - blocks({})).max(axis=2)
    assert change.max() > 10.0 > 4.0 > np.median(change)


def test_frames_keep_the_waves_of_a_sea_in_closed_form_and_nothing_of_particles():
    sea = spectrum()
    assert set(frames.plane_waves(SimpleNamespace(plane_waves=sea, answers=False))) == {
        "sea_amplitude",
        "sea_wavevector",
        "sea_phase",
        "sea_ramp",
    }
    assert frames.plane_waves(SimpleNamespace(plane_waves=None)) == {}
    assert frames.plane_waves(SimpleNamespace(plane_waves=sea, answers=True))["sea_answers"]


def test_foam_covers_what_is_asked_for():
    surface = sea_surface.SeaSurface(GRID, state(), 12_000)
    gentle = surface.at(standing(7.3)).convergence
    for wanted in (0.01, 0.05, 0.2):
        assert surface.foam(gentle, wanted)[surface.near].mean() == pytest.approx(wanted, rel=0.1)
    assert not surface.foam(gentle, 0.0).any()
