"""A patch of open sea: its table, band, feed, accounts, and what a scene may say of it."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ocean_sim import waves
from ocean_sim.basin import shifts
from ocean_sim.conventions import Diverged
from ocean_sim.files.csv_file import read_columns
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.fluid.patch.relaxation_zone import RelaxationBand, relaxation_band, stokes_shift
from ocean_sim.fluid.patch.sea_patch import Depths, PlaneWaveSource, SteepSource, table_nodes
from ocean_sim.fluid.sph import initial_state
from ocean_sim.fluid.sph.initial_state import patch_waves
from ocean_sim.kernel_library import ti
from ocean_sim.observers.shared.checks import kinetic_and_potential
from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.state import particle_state
from tests.conftest import quickly
from tests.water_energy import total_energy

G, LENGTH = 9.81, 2.0  # [m/s2], [m] of the wave
PERIOD = 2.0 * np.pi / float(waves.angular_frequency(2.0 * np.pi / LENGTH, 1.0, G))
QUIET = dict.fromkeys(("accuracy", "health", "timings"))
SLICE = {"length": 3.0 * LENGTH, "depth": 1.0, "walls": "periodic", "gravity": [0.0, -G, 0.0]}
REGULAR = {"kind": "linear_waves", "height": 0.1, "period": PERIOD}
SPREAD = {"significant_wave_height": 0.1, "peak_period": PERIOD, "cut_off": 2.0, "spreading": 10.0, "seed": 2}


def patch(sea=REGULAR, basin=SLICE, spacing=0.1, kind="delta_sph", **keys):
    scene = {"duration": 1.0, "basin": basin, "fluid": {"kind": kind, "spacing": spacing}, "sea": sea}
    return load(scene | QUIET | keys)


def band_of(scene) -> RelaxationBand:
    found = relaxation_band(scene.fluid.lattice(scene.preflight.tank))
    assert found is not None
    return found


def refused(**keys) -> str:
    with pytest.raises(SceneError) as error:
        patch(**keys)
    return str(error.value)


@ti.kernel
def read(table: ti.template(), points: ti.types.ndarray(ndim=2), values: ti.types.ndarray(ndim=2)):  # type: ignore[valid-type]
    for n in range(points.shape[0]):
        found = table.sample(ti.math.vec3(points[n, 0], points[n, 1], points[n, 2]))
        for c in ti.static(range(6)):
            values[n, c] = found[c]


def test_the_table_holds_the_velocity_of_a_spread_sea_below_the_still_level():
    """Against the sum over all waves, at a time between two writings."""
    basin = SLICE | {"width": 2.0 * LENGTH}
    scene = patch({"kind": "linear_waves", "spectrum": SPREAD}, basin, 0.25)
    with Simulation(scene) as simulation:
        table, time = simulation.fluid.rim.table, 0.613
        table.advance(time)
        random = np.random.default_rng(1)
        points = random.uniform([-3.0, -1.0, -2.0], [3.0, 0.0, 2.0], (200, 3)).astype(np.float32)
        values = np.zeros((200, 6), dtype=np.float32)
        read(table, points, values)
    sea = patch_waves(scene.preflight.tank, 0.25)
    right = waves.linear_velocity(sea, points.astype(float), time)
    assert np.abs(values[:, :3] - right).max() < 0.02 * np.abs(right).max()
    assert np.sqrt(((values[:, :3] - right) ** 2).mean()) < 0.005 * np.sqrt((right**2).mean())


def test_above_the_still_level_velocity_goes_on_along_its_slope():
    with Simulation(patch()) as simulation:
        table = simulation.fluid.rim.table
        points = np.array([[0.3, y, 0.0] for y in (0.0, 0.02, 0.04)], dtype=np.float32)
        values = np.zeros((3, 6), dtype=np.float32)
        read(table, points, values)
    assert values[1, :2] == pytest.approx(0.5 * (values[0, :2] + values[2, :2]), abs=1e-6)
    rise = (values[2, 0] - values[0, 0]) / 0.04 / values[0, 0]
    k = 2.0 * np.pi / LENGTH
    assert rise == pytest.approx(k * np.tanh(k), rel=0.01)


WIDE = {"length": 4.0, "width": 2.0, "depth": 1.0, "walls": "periodic"}


@pytest.mark.parametrize(
    "kind, basin, spacing, within",
    [
        ("delta_sph", SLICE, 0.1, 0.0),
        pytest.param("mueller", SLICE, 0.1, 0.0, marks=pytest.mark.slow),
        pytest.param("dfsph", SLICE, 0.1, 1e-4, marks=pytest.mark.slow),
        pytest.param("delta_sph", WIDE, 0.2, 0.0, marks=pytest.mark.slow),
    ],
)
def test_a_rim_that_steers_nothing_changes_no_bit(kind, basin, spacing, within):
    """Neither relaxed nor fed, water that starts as the sea is water with these waves as its initial state; in `dfsph`
    to rounding, since its sum of all terms is compiled in another order."""
    started = {"kind": "regular_wave", "height": 0.1, "period": PERIOD}
    found = []
    for keys in (
        {"sea": REGULAR | {"feed": 0.0, "rim": {"rate": 0.0}}, "spacing": spacing},
        {"sea": None, "fluid": {"kind": kind, "spacing": spacing, "initial": started}},
    ):
        with Simulation(patch(basin=basin, kind=kind, **keys)) as simulation:
            simulation.run(0.3)
            found.append(particle_state(simulation).position)
    assert np.abs(found[0] - found[1]).max() <= within


@pytest.mark.parametrize("kind", quickly("delta_sph", "dfsph", "mueller"))
def test_impulses_add_up_to_the_momentum_and_the_sea_has_its_own(kind):
    scene = patch(kind=kind, accuracy={}, duration=0.2)
    with Simulation(scene) as simulation:
        before = particle_state(simulation).momentum
        simulation.run(0.2)
        given = simulation.fluid.impulse
        gained = particle_state(simulation).momentum - before
    assert "sea" in given and np.abs(given["sea"]).max() > 0.0
    assert sum(given.values()) == pytest.approx(gained, abs=2e-5 * np.abs(given["gravity"]).max())


def test_without_a_sea_no_account_speaks_of_one():
    scene = load(
        {"duration": 0.1, "basin": SLICE, "fluid": {"kind": "delta_sph", "spacing": 0.1}} | QUIET | {"accuracy": {}}
    )
    with Simulation(scene) as simulation:
        assert "sea" not in simulation.fluid.impulse and "bed" not in simulation.fluid.impulse


@pytest.mark.anchor
def test_the_rim_calms_water_where_the_sea_is_calm_and_lies_opposite_the_ship():
    """Water that all moves is at rest first at the seam, half a patch from the ship, wherever she is."""
    scene = patch({"kind": "linear_waves", "rim": {"rate": 20.0}}, fluid={"kind": "delta_sph", "spacing": 0.1})
    for x in (0.0, 7.1):  # 7.1 m is 1.1 m on the patch
        ship = SimpleNamespace(body=SimpleNamespace(position=np.array([x, 0.0, 0.0])))
        with Simulation(scene) as simulation:
            water = simulation.fluid
            water.particles.velocity.from_numpy(np.tile([0.1, 0.0, 0.0], (water.count, 1)).astype(np.float32))
            water.add_ships([ship])
            simulation.run(0.3)
            now = particle_state(simulation)
            far = np.abs((now.position[:, 0] - x + 3.0) % 6.0 - 3.0)
            assert now.velocity[far > 2.8, 0].mean() < 0.02 < 0.07 < now.velocity[far < 1.0, 0].mean()


@pytest.mark.parametrize(
    "basin, sea", [(SLICE, "calm"), pytest.param(SLICE | {"walls": "absorbing"}, None, marks=pytest.mark.slow)]
)
def test_what_slows_incompressible_water_leaves_still_water_still(basin, sea):
    """Neither the rim nor the zone before an absorbing side slows the fall of a step that pressure holds up: what it
    held of that, more at the seam than beside it, would stir the water, by up to g dt."""
    with Simulation(patch(sea, basin, kind="dfsph")) as simulation:
        simulation.run(0.5)
        speed = np.linalg.norm(particle_state(simulation).velocity, axis=1)
        assert np.sqrt((speed**2).mean()) < 0.01 * G * simulation.next_dt


@pytest.mark.parametrize("kappa, right", [(0.18, 0.80), (0.07, 0.92), (0.03, 0.96), (0.015, 0.98)])
def test_the_model_of_one_line_meets_trials_without_a_feed(kappa, right):
    """Loss per wavelength against the height at a ship at rest, on three wavelengths with a rim of 3/4 at twice the
    frequency: figures of a trial that met simulations within 0.02."""
    scene = patch()
    found = band_of(scene)
    group = float(waves.group_speed(2.0 * np.pi / LENGTH, 1.0, G))
    losses = np.array([kappa * group / LENGTH + 0.0j])
    model = RelaxationBand(found.lattice, 0.75 * LENGTH, 2.0 * 2.0 * np.pi / PERIOD, found.sea, losses, 0.0 * losses)
    assert abs(model.height_at_ship(0.0)) == pytest.approx(right, abs=0.015)


def test_a_feed_of_twice_the_loss_holds_the_sea_up_at_any_speed():
    found = band_of(patch())
    assert found.losses is not None and found.feed == pytest.approx(2.0 * found.losses)
    for speed in (-1.5, 0.0, 0.7, 1.0, 1.3):
        assert found.height_at_ship(speed) == pytest.approx(1.0, abs=1e-9)
    unfed = band_of(patch(REGULAR | {"feed": 0.0}))
    assert abs(unfed.height_at_ship(1.0)) == 0.0 and any("keeps up" in sentence for sentence in unfed.warnings(1.0))


def moving(until: float) -> float:
    """Kinetic energy over that of linear theory, in the mean of the last third, of a JONSWAP sea on a slice: 20
    particles to the highest waves, a tenth of the variance in waves of fewer than ten."""
    spectrum = {"significant_wave_height": 1.2, "peak_period": 5.07, "cut_off": 2.0, "seed": 7}
    basin = {"length": 120.0, "depth": 20.0, "walls": "periodic", "gravity": [0.0, -G, 0.0]}
    with Simulation(patch({"kind": "linear_waves", "spectrum": spectrum}, basin, 2.0, duration=until)) as simulation:
        sea, water = simulation.fluid.sea, simulation.fluid
        linear, found = 0.25 * 1000.0 * G * float((sea.amplitude**2).sum()) * 120.0, []
        while simulation.time < until:
            simulation.run(simulation.time + 0.5)
            if simulation.time > until / 1.5:
                found.append(kinetic_and_potential(simulation, water.totals())[0])
    return float(np.mean(found)) / linear


@pytest.mark.slow
def test_waves_too_short_for_particles_hold_no_energy_up(monkeypatch):
    """They are left out (1.16); fed, they grow too high (1.56)."""
    assert moving(20.0) < 1.25
    monkeypatch.setattr(initial_state, "MIN_WAVE_SPACINGS", 4.0)
    assert moving(20.0) > 1.45


@pytest.mark.slow
def test_a_coarse_random_sea_keeps_its_energy_for_a_minute():
    """1.16; with short waves 1.36, and 1.68 at the end."""
    assert 0.9 < moving(60.0) < 1.25


def test_waves_are_fitted_to_the_patch_and_statements_say_so():
    sea = REGULAR | {"period": 1.04 * PERIOD}
    scene = patch(sea)
    found = patch_waves(scene.preflight.tank, 0.1)
    assert found.wavelength == pytest.approx(LENGTH)
    said = " ".join(scene.fluid.statements(scene.preflight))
    assert "fitted to the patch" in said and f"{PERIOD:.4g} s" in said and "heading" not in said
    square = {"length": 20.0 * LENGTH, "width": 20.0 * LENGTH, "depth": 2.0 * LENGTH, "walls": "periodic"}
    oblique = patch(REGULAR | {"heading_deg": 120.0, "period": 3.0 * PERIOD}, square, LENGTH)
    said = " ".join(oblique.fluid.statements(oblique.preflight))
    assert "heading 116.6 deg" in said  # two waves along x and one back along z


def test_check_says_which_waves_were_asked_for_and_which_patch_would_keep_them():
    """Waves of 4.5 m on a patch of 6 m would be a third longer; their own patch takes them as they are."""
    asked = 2.0 * np.pi / float(waves.angular_frequency(2.0 * np.pi / 4.5, 1.0, G))
    found = band_of(patch(REGULAR | {"period": asked}))
    assert f"6 m and 2.219 s (asked for: 4.5 m and {asked:.4g} s)" in next(found.statements())
    (told,) = [sentence for sentence in found.warnings(1.0) if "do not fit" in sentence]
    assert "basin.length: 13.5 would keep them" in told
    fit = band_of(patch(REGULAR | {"period": asked}, SLICE | {"length": 13.5}))
    assert "asked for" not in next(fit.statements()) and not [*fit.warnings(1.0)]


def test_check_finds_both_sides_of_a_patch_for_oblique_waves():
    """The patch that it names takes them as they are; heading and length count."""
    keys = {"sea": REGULAR | {"heading_deg": 30.0}}
    square = {"length": 6.0, "width": 6.0, "depth": 1.0, "walls": "periodic"}
    (told, *_) = band_of(patch(basin=square, spacing=0.25, **keys)).warnings(1.0)
    sides = {name: float(re.findall(rf"basin.{name}: ([0-9.]+)", told)[0]) for name in ("length", "width")}
    fit = band_of(patch(basin=square | sides, spacing=0.25, **keys))
    assert fit.sea.heading_deg == pytest.approx(30.0, abs=0.1) and fit.sea.wavelength == pytest.approx(LENGTH, rel=1e-3)
    assert not [*fit.warnings(1.0)]


def test_a_rim_that_is_too_weak_is_told_by_how_much_goes_through():
    """exp(- integral of half its rate over both sides / group speed), and all of it without a rate."""
    group = float(waves.group_speed(2.0 * np.pi / LENGTH, 1.0, G))
    for rate in (0.0, 2.0):
        found = band_of(patch(REGULAR | {"rim": {"rate": rate}}))
        assert found.wake_transmission == pytest.approx(np.exp(-rate * 0.75 * LENGTH / 2.5 / group), rel=1e-6)
        assert any("meets her own wake" in sentence for sentence in found.warnings(1.0))
    assert not [*band_of(patch()).warnings(1.0), *band_of(patch("calm")).warnings(1.0)]
    weak = band_of(patch({"kind": "linear_waves", "rim": {"rate": 0.0}}))
    assert any("100% of the height" in sentence for sentence in weak.warnings(1.0))


@pytest.mark.parametrize("sea", ["calm", REGULAR])
def test_check_says_that_particles_are_no_live_sea(sea):
    assert any("for a live ship take fluid.kind: spectral_sea" in said for said in band_of(patch(sea)).statements())


def test_defaults_follow_from_the_highest_waves_and_stay_open_in_the_dump():
    scene = patch()
    found = band_of(scene)
    assert found.width == pytest.approx(0.75 * LENGTH) and found.rate == pytest.approx(3.0 * np.pi / PERIOD)
    assert scene.resolved()["sea"]["rim"] == {"width": None, "rate": None, "velocity": [0.0, 0.0]}
    assert load(scene.resolved()).resolved() == scene.resolved()


HULL = {"shape": {"kind": "box", "length": 0.6, "breadth": 0.6, "height": 0.8}, "mass": 144.0}
AFLOAT = {"kind": "pressure", "hull": HULL, "free": []}


def test_the_sea_grows_over_two_periods_where_a_ship_is_in_it_else_it_is_there_at_once():
    assert band_of(patch()).sea.ramp == 0.0 and "grows" not in " ".join(band_of(patch()).statements())
    for ramp in (None, 0.0):
        with Simulation(patch(REGULAR | {"ramp": ramp}, ship=AFLOAT)) as simulation:
            assert simulation.fluid.sea.ramp == pytest.approx(2.0 * PERIOD if ramp is None else 0.0)
            assert (np.abs(particle_state(simulation).velocity).max() == 0.0) == (ramp is None)


@pytest.mark.slow
def test_a_sea_begun_at_once_would_draw_a_ship_down():
    """A ship held fast in it bears, in the mean of the first periods, her weight and no more. Begun at once, the sea
    draws her down by a fifteenth of it, for ever: what a crest has brought under her stays there."""
    means = {}
    for ramp in (None, 0.0):
        with Simulation(patch(REGULAR | {"ramp": ramp}, ship=AFLOAT)) as simulation:
            rows = []
            while simulation.time < 3.0 * PERIOD:
                simulation.step()
                rows.append((simulation.next_dt, simulation.ships["ship"].last.force[1]))
        dt, beyond = np.array(rows).T  # her weight
        means[ramp] = float((dt * beyond).sum() / dt.sum()) / (G * 1000.0 * 0.24)
    assert abs(means[None]) < 0.02 and means[0.0] < -0.05


@pytest.mark.parametrize("kind", quickly("linear_waves", "spectral_sea"))
def test_a_sea_that_has_grown_is_the_sea(kind):
    """Its height and phase on the whole patch, by the velocities: half way, and a period after its ramp."""
    sea = REGULAR | {"kind": kind, "ramp": 2.0 * PERIOD, "height": 0.05}
    k, omega = 2.0 * np.pi / LENGTH, 2.0 * np.pi / PERIOD
    with Simulation(patch(sea, spacing=0.0625, duration=4.0)) as simulation:
        for until, share in ((PERIOD, 0.5), (3.0 * PERIOD, 1.0)):
            simulation.run(until)
            water = particle_state(simulation)
            deep = (water.position[:, 1] < -0.05) & (water.position[:, 1] > -0.5)
            x, y = water.position[deep, 0], water.position[deep, 1]
            angle, c = k * x - omega * simulation.time, 0.025 * G * k / omega * waves.profiles(k, y, 1.0)[0]
            base = np.stack([c * np.cos(angle), -c * np.sin(angle), np.ones_like(c)], axis=1)
            real, imaginary, _ = np.linalg.lstsq(base, water.velocity[deep, 0], rcond=None)[0]
            assert abs(complex(real, imaginary)) == pytest.approx(share, abs=0.02)
            assert abs(np.degrees(np.arctan2(imaginary, real))) < 8.0


def sailed(x: float, until: float = 0.5) -> np.ndarray:
    """(n, 9) place from where she began [m], velocity, and force on her [N] in every step of a box that drifts along a
    patch from x [m], in f64."""
    ship = AFLOAT | {"position": [x, 0.0], "velocity": [1.0, 0.0, 0.0], "free": ["sway", "heave", "roll"]}
    rows = []
    with Simulation(patch(ship=ship, duration=until, runtime={"precision": "f64"})) as simulation:
        floating = simulation.ships["ship"]
        while simulation.time < until:
            simulation.step()
            place = floating.body.position - [x, 0.0, 0.0]
            rows.append(np.concatenate([place, floating.body.velocity, floating.last.force]))
    return np.array(rows)


def test_a_ship_does_not_see_the_seam():
    """She begins a wave further along and crosses it, or lies across it: the same forces as in the middle."""
    here, across = sailed(0.8), sailed(0.8 + LENGTH)
    assert 0.8 + LENGTH + 0.3 > 3.0 and here[-1, 0] > 0.2
    assert np.abs(across - here)[:, :6].max() < 1e-6 and np.abs(here[:, 6:]).max() > 100.0
    assert np.abs(across - here)[:, 6:].max() < 1e-3


@pytest.mark.parametrize("kind", ["pressure", "hydrostatic"])
def test_a_ship_that_begins_across_the_seam_makes_as_much_room(kind):
    """As in the middle; and no water stays inside her."""
    basin = {"length": 4.0, "width": 4.0, "depth": 1.0, "walls": "periodic"}
    left = []
    for place in ([0.0, 0.0], [2.0, 2.0], [1.9, -1.7]):
        ship = {"kind": kind, "hull": HULL, "position": place, "heading_deg": 30.0}
        found = patch(basin=basin, ship=ship, surface={"kind": "cloth"}).preflight
        x = found.lattice.positions()
        solid, near = found.solids["ship"], x + shifts(x, np.array(place), found.tank.periods)
        own = (near - solid.origin) @ solid.turn + solid.centre
        assert not solid.shape.inside(0.98 * (own - solid.centre) + solid.centre).any()
        left.append(len(x))
    assert left[0] - 40 * 40 * 10 == pytest.approx(-144, rel=0.05)  # of 144 kg
    assert max(left) - min(left) <= (2 if kind == "pressure" else 0)


def test_the_work_of_a_ship_on_the_water_is_what_the_water_takes_from_her():
    """She falls 0.15 m into it; without her work the books would be open by nearly all of it."""
    ship = AFLOAT | {"position": [0.0, 0.15, 0.0], "free": ["heave"]}
    with Simulation(patch("calm", ship=ship, accuracy={})) as simulation:
        floating, began = simulation.ships["ship"], total_energy(simulation)
        height, taken = floating.body.position[1], floating.body.mass * G
        simulation.run(0.4)
        work, body = simulation.fluid.work, floating.body
        taken = taken * (height - body.position[1]) - body.kinetic_energy()
        assert work["ship"] == pytest.approx(taken, rel=0.02) and taken > 100.0
        given = sum(energy for term, energy in work.items() if term not in ("gravity", "pressure"))
        assert total_energy(simulation) - began == pytest.approx(given, abs=0.05 * taken)


def in_a_slice(**places: float) -> dict:
    return {name: AFLOAT | {"position": [x, 0.0]} for name, x in places.items()}


def test_two_ships_meet_across_the_seam_too_and_are_told_when_one_lies_in_the_rim(tmp_path):
    """Where they begin, and where they have come to after some tiles."""
    assert "the hulls of a and b reach 0.2 m into each other" in refused(ships=in_a_slice(a=-2.8, b=2.8))
    assert not any("inside the rim" in said for said in patch(ships=in_a_slice(a=-0.5, b=1.5)).warnings())
    apart = patch(ships=in_a_slice(a=-1.6, b=2.4), health={})
    assert any("a and b begin 0.5 m inside the rim" in sentence for sentence in apart.warnings())
    with Simulation(apart, tmp_path) as simulation:
        simulation.run(0.003)
        b = simulation.ships["b"]
        b.body = replace(b.body, position=b.body.position + [3.0 * 6.0 + 1.7, 0.0, 0.0])
        with pytest.raises(Diverged, match=r"the hulls of a and b reach 0\.3"):
            simulation.run(0.1)
    assert "too far apart for their patch" in (tmp_path / "events.jsonl").read_text()


def test_a_name_is_enough_for_a_calm_sea():
    scene = patch("calm")
    assert scene.sea.kind == "linear_waves" and band_of(scene).sea is None


@pytest.mark.parametrize(
    "keys, sentence",
    [
        ({"basin": SLICE | {"walls": "reflecting"}}, "set basin.walls: periodic"),
        (
            {"kind": "ballistic"},
            "water of kind ballistic cannot be a patch of open sea; take delta_sph or dfsph or mueller",
        ),
        ({"sea": REGULAR | {"rim": {"width": 4.0}}}, "leaves no water free; at most 3 m"),
        ({"sea": REGULAR | {"rim": {"velocity": [1.0, 1.0]}}}, "in 2-D it is only along x"),
        ({"sea": REGULAR | {"height": 1.0}}, "would break"),
        ({"sea": REGULAR | {"heading_deg": 0.0}}, "in 2-D"),
        (
            {"fluid": {"kind": "mueller", "spacing": 0.1, "fill": [{"min": [-3.0, -1.0], "max": [3.0, -0.5]}]}},
            "starts as the sea; leave fill out",
        ),
        ({"sea": "stormy"}, "stormy"),
    ],
)
def test_what_is_no_patch_of_a_sea_is_said_in_a_sentence(keys, sentence):
    assert sentence in refused(**keys)


def test_water_in_closed_form_is_no_patch():
    scene = {"basin": SLICE, "fluid": {"kind": "linear_waves", "height": 0.1, "period": PERIOD}, "sea": "calm"}
    with pytest.raises(SceneError, match="cannot be a patch of open sea"):
        load(scene | QUIET)


def sources(sea, basin=SLICE, spacing=0.1):
    """What tables of these waves are written from where they stay linear, and where they are nonlinear; and which
    sea."""
    found = band_of(patch(sea, basin, spacing))
    depths = Depths(1.0, 0.1, 1.0)
    count = table_nodes(found, found.sea)
    return PlaneWaveSource(found, found.sea, depths, count), SteepSource(found, found.sea, depths, count), found.sea


@pytest.mark.parametrize(
    "sea, basin, spacing",
    [(REGULAR, SLICE, 0.1), ({"spectrum": SPREAD}, SLICE | {"width": 2.0 * LENGTH}, 0.25)],
)
def test_before_a_nonlinear_sea_sets_in_it_is_the_sum_of_its_waves(sea, basin, spacing):
    """On all levels, what is fed of it included."""
    sea = sea | {"kind": "spectral_sea", "onset": 1e6}
    for time in (0.0, 0.7):
        linear, steep, _ = sources(sea, basin, spacing)
        values = [np.fft.ifft2(source.modes(time), norm="forward").real for source in (linear, steep)]
        assert np.abs(values[0] - values[1]).max() < 1e-6 * np.abs(values[0]).max()
        assert np.abs(values[0][:, 3:]).max() > 0.0


def test_a_nonlinear_sea_is_faster_by_stokes():
    """A regular wave of ka 0.16 over two periods, against its own speed to third order; linear waves are slower."""
    linear, steep, sea = sources(REGULAR | {"kind": "spectral_sea", "onset": 0.0})
    time = 2.0 * PERIOD
    ratio = steep.modes(time)[0, 0, 3, 0] / linear.modes(time)[0, 0, 3, 0]
    ahead = -np.angle(ratio)
    right = sea.omega[0] * stokes_shift(sea) * time
    assert ahead == pytest.approx(right, rel=0.05) and right > 0.1


def test_a_nonlinear_sea_resolves_its_defaults_and_feeds_without_stokes():
    scene = patch(REGULAR | {"kind": "spectral_sea"})
    linear, found = band_of(patch()), band_of(scene)
    assert found.nonlinear.onset == pytest.approx(5.0 * PERIOD) and found.losses.imag[0] < linear.losses.imag[0]
    said = " ".join(scene.fluid.statements(scene.preflight))
    assert "nonlinear to third order on 60 cells" in said
    assert load(scene.resolved()).resolved() == scene.resolved()
    assert patch({"kind": "spectral_sea", "order": 1} | REGULAR | {"kind": "spectral_sea"}).sea.nonlinear is None


@pytest.mark.slow
def test_gauges_ride_with_the_patch_beside_fixed_ones(tmp_path):
    """The point that they ride with moves as fast as the crests, around the whole patch: each reads its own phase."""
    speed = LENGTH / PERIOD
    sea = REGULAR | {"rim": {"velocity": [speed, 0.0]}}
    along = {"crest": {"at": [0.0], "rides": True}, "down": {"at": [0.25 * LENGTH], "rides": True}, "fixed": [0.0]}
    depth = {"at": [0.0, -0.5], "rides": True}
    keys = {"elevation": along, "pressure": {"ahead": depth}, "every": 0.1 * PERIOD}
    scene = patch(sea, gauges=keys, duration=0.5 * PERIOD, **dict.fromkeys(("report", "render")))
    assert load(scene.resolved()).resolved() == scene.resolved()
    with Simulation(scene, tmp_path) as simulation:
        simulation.run(0.5 * PERIOD)
        read_off = simulation.fluid.elevations(np.array([[0.5 * LENGTH, 0.0]]))[0]
    table = read_columns(tmp_path / "gauges.csv")
    assert table["crest_m"][0] == table["fixed_m"][0]
    assert table["crest_m"][-1] == pytest.approx(read_off, abs=2e-3)
    assert np.abs(table["crest_m"] - 0.05).max() < 0.015 < np.abs(table["fixed_m"] - 0.05).max()
    assert np.abs(table["down_m"]).max() < 0.015
    assert np.ptp(table["ahead_Pa"]) < 0.1 * table["ahead_Pa"].mean()
    assert "[0.0] m from the middle of what it rides with" in (tmp_path / "gauges.csv").read_text()


def test_gauges_ride_on_an_open_sea_alone():
    gauge = {"gauges": {"elevation": {"a": {"at": [0.0], "rides": True}}}}
    assert "rides only over a patch of open sea" in refused(sea=None, **gauge)
