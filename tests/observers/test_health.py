import json
from types import SimpleNamespace

import numpy as np
import pytest

from ocean_sim import simulation as loop
from ocean_sim.conventions import Diverged
from ocean_sim.observers import health
from ocean_sim.observers.shared import checks
from ocean_sim.reading.scene import load
from ocean_sim.time_step.fixed import Config as Fixed
from tests.conftest import quickly


def build(watched, folder=None, **config):
    simulation = watched()
    simulation.observers = [health.Config(**config).build(folder, simulation)]
    return simulation, simulation.observers[0]


def events(folder):
    return [json.loads(line) for line in (folder / "events.jsonl").read_text().splitlines()]


def test_a_quiet_run_has_a_quiet_diary(tmp_path, watched):
    simulation, _ = build(watched, tmp_path)
    simulation.run(until=1.0)
    rises = ["energy that no work has given", "energy from nowhere"]  # this sea does, and nothing lifts it
    reported = ["start", "limit", *rises, "done"]
    assert [event["event"] for event in events(tmp_path)] == reported
    assert events(tmp_path)[-1]["time_s"] == 1.0


def test_it_needs_no_folder_and_writes_nothing_without_one(watched, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    simulation, _ = build(watched, loop.NO_FOLDER)
    simulation.run(until=0.1)
    assert not list(tmp_path.iterdir())


def upset(simulation, what):
    simulation.steps, simulation.time = 50, 0.5
    particles, status = simulation.fluid.particles, simulation.fluid.status
    if what == "nan":
        particles.position.values[3], status.finite = np.nan, False
    if what == "nan unseen by the fluid":
        particles.velocity.values[3, 1] = np.nan
    if what == "speed":
        particles.velocity.values[5], status.max_speed = (0.0, 60.0, 0.0), 60.0
    if what == "density":
        particles.density.values[7], status.max_density = 1900.0, 1900.0
    if what == "density is no number":
        status.max_density = float("nan")
    if what == "position":
        particles.position.values[2] = (1.0e3, 0.0, 0.0)
    if what == "through the bed":
        particles.position.values[4, 1] = -2.001
    if what == "infinite position":
        particles.position.values[2] = (np.inf, 0.0, 0.0)


@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize(
    "what, words",
    [
        ("nan", "stopped being a number for 1 of"),
        ("nan unseen by the fluid", "stopped being a number for 1 of"),
        ("speed", r"a particle reached 60 m/s \(bound 50 m/s\) at \("),
        ("density", r"density reached 1900 kg/m\^3, 1.9 x the rest density \(bound 1.5\) at \("),
        ("density is no number", "density reached nan"),
        ("position", r"1 of \d+ particles are outside the walls, the farthest by 997 m"),
        ("through the bed", r"1 of \d+ particles are outside the walls, the farthest by 0.001 m \(none may be\) at \("),
        ("infinite position", "stopped being a number"),
    ],
)
def test_what_is_not_physical_stops_the_run_with_a_sentence(watched, what, words):
    simulation, observer = build(watched)
    upset(simulation, what)
    with pytest.raises(Diverged, match=words) as stop:
        observer.observe(simulation)
    assert "t = 0.5000 s, step 50" in str(stop.value) and "try" in str(stop.value)


def test_energy_from_nowhere_stops_the_run_and_energy_of_the_wind_does_not(watched):
    for wind, stops in ((SimpleNamespace(still=True), True), (SimpleNamespace(still=False), False)):
        simulation = watched()
        simulation.scene.wind = wind
        simulation.observers = [health.Config(max_energy_gain=0.001).build(None, simulation)]
        if stops:
            with pytest.raises(Diverged, match=r"gained energy from nowhere.*try"):
                simulation.run(until=1.0)
        else:
            simulation.run(until=1.0)


def test_energy_from_nowhere_is_seen_between_the_looks_at_positions_and_told_before_it_stops(tmp_path, watched):
    """Steps so long that fifty of them would be seconds."""
    simulation, observer = build(watched, tmp_path)
    observer.observe(simulation)
    heat = np.zeros_like(simulation.fluid.particles.velocity.values)
    for step, share, stops in ((1, 0.03, False), (2, 0.5, True)):
        simulation.steps, simulation.time = step, 0.5 * step
        heat[:, 0] = np.sqrt(2.0 * share) * simulation.fluid.reference_speed
        simulation.fluid.particles.velocity.values[:] = heat
        if stops:
            with pytest.raises(Diverged, match="gained energy from nowhere"):
                observer.observe(simulation)
        else:
            observer.observe(simulation)
    reported = [event for event in events(tmp_path) if event["event"] == "energy from nowhere"]
    assert len(reported) == 1 and reported[0]["over_m_v2"] == pytest.approx(0.03, rel=0.01)


def test_a_side_that_is_open_lets_particles_go_a_diagonal_far(watched):
    simulation = watched(walls={"x_min": "none"})
    observer = health.Config().build(None, simulation)
    simulation.steps = 50
    position = simulation.fluid.particles.position.values
    position[0] = (-5.0, -1.0, 0.0)
    observer.observe(simulation)
    position[0] = (-20.0, -1.0, 0.0)
    with pytest.raises(Diverged, match="1 particles left the basin, the farthest by 17 m"):
        observer.observe(simulation)
    position[0] = (3.1, -1.0, 0.0)
    with pytest.raises(Diverged, match=r"outside the walls, the farthest by 0\.1 m"):
        observer.observe(simulation)


def test_a_particle_that_rounding_puts_on_a_wall_is_inside(watched):
    simulation, observer = build(watched)
    simulation.steps = 50
    simulation.fluid.particles.position.values[0, 0] = np.nextafter(np.float32(3.0), np.float32(4.0))
    observer.observe(simulation)


def test_water_without_particles_has_nothing_to_go_wrong(tmp_path, watched):
    simulation = watched()
    simulation.fluid.particles = None
    simulation.fluid.advance = lambda dt: None
    simulation.observers = [health.Config().build(tmp_path, simulation)]
    simulation.run(until=1.0)
    assert [event["event"] for event in events(tmp_path)] == ["start", "limit", "done"]
    assert events(tmp_path)[0]["particles"] == 0


def test_a_fluid_without_pressure_has_no_density_bound(watched):
    simulation, observer = build(watched)
    simulation.fluid.sound_speed = 0.0
    upset(simulation, "density")
    observer.observe(simulation)


def test_the_advice_follows_the_cause(tmp_path, watched):
    simulation, observer = build(watched, tmp_path)
    assert "courant_number" in observer.suggest_cure()
    simulation.scene.time_step = Fixed(dt=0.05)
    assert "below its acoustic limit (here 0.01 s)" in observer.suggest_cure()
    simulation.fluid.sound_speed = 20.0**0.5
    assert "stiffness 20 m^2/s^2 holds only 0.02 m of water" in observer.suggest_cure()
    (tmp_path / "frames").mkdir()
    (tmp_path / "frames" / "frame_00004.npz").touch()
    assert observer.name_last_frame().endswith("frames/frame_00004.npz")


def test_clipping_is_summed_up_not_repeated(tmp_path, watched):
    simulation, observer = build(watched, tmp_path)
    for step in range(1, 101):
        simulation.time, simulation.steps, simulation.fluid.status.clipped = 0.01 * step, step, 2 * step
        observer.observe(simulation)
    simulation.outcome, simulation.reason = "stopped", "too hot"
    observer.close()
    reported = [event for event in events(tmp_path) if event["event"] == "clipped"]
    assert len(reported) <= 3 and reported[-1]["since_start"] == 200
    assert sum(event["particles"] for event in reported) == 200
    assert events(tmp_path)[-1] == {"time_s": 1.0, "step": 100, "event": "stopped", "reason": "too hot"}


def looked_at(simulation, folder):
    """The events after another look at all particles."""
    simulation.steps = health.STEPS_BETWEEN_CHECKS
    simulation.observers[0].observe(simulation)
    return [event for event in events(folder) if event["event"] not in ("start", "limit")]


def test_a_particle_that_is_there_twice_is_told_once(tmp_path, watched):
    simulation, _ = build(watched, tmp_path)
    simulation.observers[0].observe(simulation)
    assert not looked_at(simulation, tmp_path)
    ids = simulation.fluid.particles.id.values
    ids[3] = ids[4]
    looked_at(simulation, tmp_path)
    (event,) = looked_at(simulation, tmp_path)
    assert event["event"] == "particles from nowhere" and (event["lost"], event["twice"]) == (1, 1)


def test_energy_that_no_work_has_given_is_told_where_the_wind_drives(tmp_path, watched):
    """Particles that are faster without a force; work of the wind that gives as much is none of that."""
    for worked, said in ((0.0, ["energy that no work has given"]), (1.0, [])):
        simulation = watched()
        simulation.scene.wind = SimpleNamespace(still=False)
        folder = tmp_path / f"{worked:g}"
        folder.mkdir()
        simulation.observers = [health.Config().build(folder, simulation)]
        simulation.observers[0].observe(simulation)
        fluid = simulation.fluid
        fast = 1.5 * fluid.reference_speed
        fluid.particles.velocity.values[:, 0] += fast
        gained = 0.5 * fluid.particles.mass * fluid.particles.n * fast**2
        fluid.work["wind"] += worked * gained
        fluid.impulse["wind"][0] += fluid.particles.mass * fluid.particles.n * fast
        assert [event["event"] for event in looked_at(simulation, folder)] == said


def blown(faults, basin=None, fluid=None, **keys):
    """What health reports of incompressible water in a wind whose particles, from a step on, move at random at so
    much of the reference speed: for each of these faults, after the same run."""
    scene = {
        "basin": {"length": 1.0, "depth": 0.3} | (basin or {}),
        "fluid": {"kind": "dfsph", "spacing": 0.05} | (fluid or {}),
        "wind": {"kind": "stress", "u10": 10.0},
        "render": None,
        "runtime": {"threads": 1},
    }
    with loop.Simulation(load(scene | keys)) as simulation:
        observers = [health.Config().build(loop.NO_FOLDER, simulation) for _ in faults]
        for observer in observers:
            observer.observe(simulation)
        fluid = simulation.fluid
        for _ in range(100):
            simulation.step()
        v = fluid.particles.velocity.to_numpy()
        noise = np.random.default_rng(1).normal(size=(len(v), 2))
        for fault, observer in zip(faults, observers):
            stirred = v.copy()
            stirred[:, :2] += fault * fluid.reference_speed * (noise - noise.mean(axis=0))
            fluid.particles.velocity.from_numpy(stirred)
            observer.observe(simulation)
        return [observer.reported for observer in observers]


@pytest.mark.parametrize(
    "keys", quickly({}, {"basin": {"walls": "periodic"}, "sea": "calm"}, {"fluid": {"body_force": [1.0, 0.0, 0.0]}})
)
def test_so_it_is_in_water_that_solves_for_its_pressure(keys):
    assert blown([0.3, 0.0], **keys) == [["energy that no work has given"], []]


@pytest.mark.parametrize("width", quickly(None, 0.5))
def test_waves_of_a_patch_are_what_a_gain_counts_beside(width):
    """A gain of 2.5e-3 of m U^2: more than these waves have, and than the weight of still water stores."""
    sea = {"kind": "linear_waves", "height": 0.02, "period": 0.75, "heading_deg": 90.0}
    patch, water = {"length": 1.8, "width": width, "walls": "periodic"}, {"kind": "delta_sph"}
    assert blown([0.05, 0.0], patch, water, sea=sea) == [["energy that no work has given"], []]
    assert blown([0.05, 0.0], patch, water, sea="calm") == [["energy that no work has given"], []]


@pytest.mark.slow
@pytest.mark.parametrize("height", [1.0, 4.97])
def test_waves_in_a_patch_have_no_more_energy_than_the_sea_gives(height):
    """Waves of 40 m on 40 spacings: of k a = 0.08 and 0.39, for two and a half periods."""
    scene = {
        "basin": {"length": 80.0, "depth": 20.0, "walls": "periodic"},
        "sea": {"kind": "linear_waves", "height": height, "period": 5.07, "heading_deg": 90.0},
        "fluid": {"kind": "delta_sph", "spacing": 1.0},
        "render": None,
        "runtime": {"threads": 1},
    }
    with loop.Simulation(load(scene)) as simulation:
        observer = health.Config().build(loop.NO_FOLDER, simulation)
        observer.observe(simulation)
        while simulation.time < 12.5:
            simulation.step()
            observer.observe(simulation)
        assert observer.reported == []


@pytest.mark.parametrize(
    "water",
    quickly(
        {"kind": "mueller", "stiffness": 20.0, "kinematic_viscosity": 2.0e-3},
        {"kind": "delta_sph", "reference_speed": 2.0},
        {"kind": "dfsph", "reference_speed": 2.0},
        {"kind": "ballistic"},
    ),
)
@pytest.mark.parametrize("speed", quickly(0.3, 0.0))
def test_water_without_weight_has_a_speed_and_an_energy_to_compare_with(water, speed):
    """None of it falls or is compressed by weight; where it moves, it rises without being swollen. It begins off the
    bed, which would hold it back: in steps of sound, a sudden pull costs a tenth of its energy unbooked."""
    basin = {"length": 1.0, "depth": 0.5, "gravity": [0.0, 0.0, 0.0]}
    water = water | {"spacing": 0.05, "fill": [{"min": [-0.25, -0.4], "max": [0.25, -0.2]}]}
    scene = {"basin": basin, "fluid": water, "render": None, "runtime": {"threads": 1}}
    with loop.Simulation(load(scene)) as simulation:
        velocity = simulation.fluid.particles.velocity
        velocity.from_numpy(np.full_like(velocity.to_numpy(), (0.0, speed, 0.0)))
        observer = health.Config().build(loop.NO_FOLDER, simulation)
        for _ in range(101):
            observer.observe(simulation)
            simulation.step()
        assert observer.reported == []


DRIFT = {"kind": "absorbing", "target": {"current": [1.0, 0.0, 0.0]}}


@pytest.mark.parametrize(
    "basin", quickly({"wavemaker": {"wall": "x_min", "height": 0.05, "period": 1.0}}, {"walls": {"x": DRIFT}})
)
def test_but_not_where_what_walls_give_cannot_be_told(basin):
    assert blown([0.3], basin=basin) == [[]]


def test_water_that_sides_absorb_towards_a_current_is_driven():
    """It is no fault that it gains energy, and that its two halves differ."""
    basin = {"length": 3.0, "depth": 0.3, "walls": {"x": DRIFT}}
    scene = {"basin": basin, "fluid": {"kind": "delta_sph", "spacing": 0.05}, "render": None, "runtime": {"threads": 1}}
    with loop.Simulation(load(scene)) as simulation:
        observer = health.Config().build(loop.NO_FOLDER, simulation)
        observer.observe(simulation)
        for _ in range(health.STEPS_BETWEEN_CHECKS):
            simulation.step()
        assert not observer.judges_energy and not observer.symmetry.twins
        observer.observe(simulation)
        assert observer.reported == []


@pytest.mark.parametrize("kind", quickly("delta_sph", "mueller", "dfsph"))
def test_a_column_in_the_middle_falls_alike_to_both_sides_and_one_that_does_not_is_told(kind):
    """A fault pushes the particles of one half a little, away from where they should be."""
    fluid = {"kind": kind, "spacing": 0.05, "fill": [{"min": [-0.3, -0.5], "max": [0.3, 0.1]}]}
    scene = load({"basin": {"length": 2.0, "depth": 0.5}, "fluid": fluid, "runtime": {"threads": 1}, "render": None})
    with loop.Simulation(scene) as simulation:
        observers = [health.Config().build(loop.NO_FOLDER, simulation) for _ in range(2)]
        for observer in observers:
            observer.observe(simulation)
        for _ in range(health.STEPS_BETWEEN_CHECKS):
            simulation.step()
        position = simulation.fluid.particles.position
        for observer, push, told in zip(observers, (0.0, 0.03), (False, True)):
            x = position.to_numpy()
            x[:, 0] += np.where(x[:, 0] > 0.0, push * 0.05, 0.0)
            position.from_numpy(x)
            observer.observe(simulation)
            assert ("symmetry lost" in observer.reported) is told


def test_water_thrown_up_between_walls_is_no_fault():
    """A collapsed column of 144 particles climbs both walls: it lies high over its place for 0.2 s, hardly a particle
    of it is far from a surface, and its books close."""
    fluid = {"kind": "delta_sph", "spacing": 0.05, "fill": [{"min": [-0.3, -0.5], "max": [0.3, 0.1]}]}
    scene = load({"basin": {"length": 2.0, "depth": 0.5}, "fluid": fluid, "runtime": {"threads": 1}, "render": None})
    with loop.Simulation(scene) as simulation:
        observer, levels = health.Config().build(loop.NO_FOLDER, simulation), []
        while simulation.time < 1.3:
            observer.observe(simulation)
            simulation.step()
            position = simulation.fluid.particles.position.to_numpy()
            levels.append(checks.level_ratio(position, 0.05, simulation.basin, simulation.time))
        assert observer.reported == [] and max(levels) > observer.config.max_level_ratio


@pytest.mark.parametrize(
    "basin", quickly({"obstacles": [{"min": [0.5, -0.5], "max": [0.6, -0.2]}]}, {"walls": {"x_max": "no_slip"}})
)
def test_a_tank_with_two_different_halves_has_no_symmetry_to_lose(basin):
    scene = {"basin": {"length": 2.0, "depth": 0.5, **basin}, "fluid": {"kind": "ballistic", "spacing": 0.1}}
    for uneven, pairs in ((scene, 0), (scene | {"basin": {"length": 2.0, "depth": 0.5}}, 1)):
        with loop.Simulation(load(uneven | {"render": None})) as simulation:
            observer = health.Config().build(loop.NO_FOLDER, simulation)
            observer.observe(simulation)
            assert len(observer.symmetry.twins) == pairs
