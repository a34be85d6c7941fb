"""Ships in a scene: forces, what moves, who steers, what is logged, and what is refused."""

from dataclasses import fields, replace

import numpy as np
import pytest

from ocean_sim.conventions import Diverged
from ocean_sim.files import csv_file
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.observers import motion as motion_observer
from ocean_sim.observers.manifest import state_sha256
from ocean_sim.reading.scene import load, observer_names
from ocean_sim.result import Result, run
from ocean_sim.ship import PARTS, Load
from ocean_sim.ship.body import rigid_body as rigid
from ocean_sim.ship.dynamic import SeakeepingShip
from ocean_sim.simulation import Simulation

QUIET = {name: None for name in observer_names() if name != "manifest"} | {"runtime.threads": 1}
BARGE = {"hull": "barge20", "cells_per_draught": 4}


def calm(ship: dict, **keys) -> dict:
    return {
        "duration": 1.0,
        "basin": {"length": 100.0, "width": 100.0, "depth": 50.0, "walls": "none"},
        "fluid": {"kind": "linear_waves", "height": 0.0, "period": 5.0},
        "time_step": {"kind": "fixed", "dt": 0.02},
        "ship": ship,
        **keys,
    }


def state(body: rigid.RigidBody) -> dict:
    """What the body is replaced by."""
    return {field.name: getattr(body, field.name) for field in fields(body)}


def load_at(simulation: Simulation, **changes):
    """The load with another state."""
    ship = simulation.ships["ship"]
    ship.body = replace(ship.body, **changes)
    return ship.load(simulation.wind_on_ship, simulation.fluid, simulation.fluid)


@pytest.fixture(scope="module")
def barge():
    """A dynamic barge in calm water that tests may push about; the state it begins with."""
    config = load(calm({"kind": "dynamic", **BARGE}), QUIET | {"runtime.precision": "f64"})
    with Simulation(config) as simulation:
        assert simulation.ship is simulation.ships["ship"]
        yield simulation, simulation.ship.body


@pytest.mark.anchor
def test_afloat_nothing_acts(barge):
    simulation, rest = barge
    load = load_at(simulation, **state(rest))
    weight = rest.mass * 9.81
    assert load.parts[PARTS.index("buoyancy"), 0, 1] == pytest.approx(weight, rel=1e-6)
    np.testing.assert_allclose(load.force, np.zeros(3), atol=1e-6 * weight)
    np.testing.assert_allclose(load.torque, np.zeros(3), atol=1e-6 * weight)


def test_deep_under_water_it_is_pushed_with_its_whole_volume_and_in_the_air_by_nothing(barge):
    simulation, rest = barge
    sunk = load_at(simulation, **state(rest) | {"position": np.array([0.0, -20.0, 0.0])})
    assert sunk.parts[PARTS.index("buoyancy"), 0, 1] == pytest.approx(2.0 * rest.mass * 9.81, rel=1e-6)
    flying = load_at(simulation, **state(rest) | {"position": np.array([0.0, 20.0, 0.0])})
    np.testing.assert_allclose(flying.force, [0.0, -rest.mass * 9.81, 0.0], rtol=1e-9, atol=1e-6)


@pytest.mark.parametrize("heading", [0.0, 50.0, 137.0])
def test_a_heeled_and_trimmed_ship_is_righted_whatever_its_heading(barge, heading):
    simulation, rest = barge
    yaw = np.radians(heading)
    heeled = load_at(simulation, **state(rest) | {"orientation": rigid.euler_quaternion(0.0, yaw, 0.1)})
    own = rigid.axis_rotation(1, yaw).T @ heeled.torque
    added = simulation.ships["ship"].added[5] / (simulation.ships["ship"].added[5] + rest.inertia_body[2, 2])
    assert own[2] / (1.0 - added) == pytest.approx(-rest.mass * 9.81 * 1.166667 * 0.1, rel=0.03)
    assert abs(own[0]) < 1e-3 * abs(own[2])


def test_added_mass_makes_it_slower_by_its_share(barge):
    """A force of one newton on m + A: the acceleration from the total load."""
    simulation, rest = barge
    higher = load_at(simulation, **state(rest) | {"position": rest.position + np.array([0.0, 0.1, 0.0])})
    stiffness = 1000.0 * 9.81 * 160.0
    whole = rest.mass + simulation.ships["ship"].added[1]
    assert higher.force[1] / rest.mass == pytest.approx(-0.1 * stiffness / whole, rel=1e-3)


class Lifted(SeakeepingShip):
    """A ship with a force of its own."""

    parts = (*PARTS, "lift")

    def forces(self, now):
        return super().forces(now) | {"lift": np.array([[0.0, 1000.0, 0.0], [0.0, 0.0, 0.0]])}


def test_a_ship_may_add_a_force_of_its_own_and_name_it(barge):
    """It moves the water along with the hull, as every other force does, and has columns in motion.csv."""
    simulation, rest = barge
    ship = Lifted("ship", simulation.scene.ships["ship"], simulation.basin, simulation.fluid)
    load = ship.load(simulation.wind_on_ship, simulation.fluid, simulation.fluid)
    assert load.parts[-1, 0, 1] == 1000.0 and load.parts.shape == (9, 2, 3)
    assert load.force[1] == pytest.approx(1000.0 * rest.mass / (rest.mass + ship.added[1]), rel=1e-3)
    ours, own = motion_observer.log_columns(PARTS), motion_observer.log_columns(ship.parts)
    assert tuple(name for name in own if "lift_" not in name or "wind" in name) == ours
    assert own[own.index("torque_rudder_z_Nm") + 1] == "force_lift_x_N"
    with pytest.raises(ValueError, match="a ship with a force 'lift' must name it in `parts`"):
        Load.of({"lift": load.parts[0]})


def test_motion_is_damped(barge):
    simulation, rest = barge
    sinking = load_at(simulation, **state(rest) | {"velocity": np.array([0.0, -1.0, 0.0])})
    assert sinking.force[1] > 0.0
    sliding = load_at(simulation, **state(rest) | {"velocity": np.array([1.0, 0.0, 0.0])})
    assert sliding.force[0] < 0.0
    turning = load_at(simulation, **state(rigid.with_spin(rest, np.array([0.0, 0.2, 0.0]))))
    assert turning.torque[1] < 0.0


def test_under_way_it_feels_a_centripetal_force(barge):
    """With added mass in sway and surge apart, way and yaw together push sideways (C(v) of 4.26)."""
    simulation, rest = barge
    r = 0.1
    turning = rigid.with_spin(rest, np.array([0.0, r, 0.0]))
    both = load_at(simulation, **state(turning) | {"velocity": np.array([0.0, 0.0, 3.0])}).parts[
        PARTS.index("damping"), 0
    ]
    alone = load_at(simulation, **state(turning)).parts[PARTS.index("damping"), 0]
    assert abs(both[0] - alone[0]) > 0.2 * simulation.ships["ship"].added[2] * 3.0 * r


@pytest.mark.anchor
def test_the_same_bytes_with_one_thread_or_two():
    states = []
    for threads in (1, 2):
        ship = {"kind": "dynamic", **BARGE, "attitude_deg": [2.0, 0.0, 5.0]}
        fluid = {"kind": "linear_waves", "height": 0.5, "period": 4.0}
        with Simulation(load(calm(ship, fluid=fluid), QUIET | {"runtime.threads": threads})) as simulation:
            for _ in range(5):
                simulation.step()
            states.append(
                np.concatenate([simulation.ships["ship"].body.position, simulation.ships["ship"].last.parts.ravel()])
            )
    np.testing.assert_array_equal(*states)


@pytest.mark.anchor
def test_a_ship_in_a_long_wave_follows_its_slope():
    """Twenty lengths long: heave 1, pitch k a; a hull that is pushed straight up would pitch BM / GM = 1.1 times."""
    period = np.sqrt(2.0 * np.pi * 400.0 / 9.81)
    fluid = {"kind": "linear_waves", "height": 1.0, "period": period}
    basin = {"length": 400.0, "width": 400.0, "depth": 400.0, "walls": "none"}
    for kind in ("hydrostatic", "dynamic"):
        config = load(calm({"kind": kind, **BARGE}, fluid=fluid, basin=basin), QUIET | {"time_step.dt": 0.1})
        with Simulation(config) as simulation:
            rows = []
            while simulation.time < 3.0 * period:
                simulation.step()
                rows.append(
                    (
                        simulation.time,
                        simulation.ships["ship"].body.position[1] - 0.5,
                        simulation.ships["ship"].body.angles[0],
                    )
                )
        t, heave, pitch = np.array(rows).T
        late = t > 2.0 * period
        wave = np.exp(2j * np.pi / period * t[late])
        found = [2.0 * abs(np.mean((y[late] - y[late].mean()) * wave)) for y in (heave, pitch)]
        assert found[0] / 0.5 == pytest.approx(1.0, abs=0.05)
        assert found[1] / (0.5 * 2.0 * np.pi / 400.0) == pytest.approx(1.0, abs=0.05)


def test_water_that_rises_along_a_hull_does_not_pitch_about_her():
    """In a wave of 27 lengths water pitches by k times its heave, a quarter period earlier, and no more, however much
    more of her broad stern is wet than of her bow."""
    k = 2.0 * np.pi / 400.0
    period = float(2.0 * np.pi / np.sqrt(9.81 * k))
    fluid = {"kind": "linear_waves", "height": 1.0, "period": period, "ramp": 0.0}
    basin = {"length": 400.0, "width": 400.0, "depth": 400.0, "walls": "none"}
    scene = calm({"kind": "yacht", "free": []}, fluid=fluid, basin=basin)
    with Simulation(load(scene, QUIET | {"time_step": {"kind": "fixed", "dt": period / 24.0}})) as simulation:
        water = np.zeros((24, 6))
        for row in water:
            simulation.step()
            row[:] = -simulation.ship.relative
    heave, pitch = water[:, 1], water[:, 3]
    np.testing.assert_allclose(pitch, k * np.roll(heave, -6), atol=0.02 * k * heave.max())


@pytest.fixture(scope="module")
def logged(tmp_path_factory):
    """A yacht that steers to port from rest, its forces and its motion at the helm, in three frames; in the last its
    orders come from a file."""
    folder = tmp_path_factory.mktemp("yacht")
    ship = {
        "kind": "yacht",
        "cells_per_draught": 3.0,
        "heading_deg": 90.0,
        "controls": [{"time": 0.0, "throttle": 1.0}, {"time": 2.0, "throttle": 1.0, "rudder": 0.4}],
    }
    results = {}
    track = folder / "track.csv"
    track.write_text("time_s,throttle,rudder_rad\n0.0,1.0,0.0\n2.0,1.0,0.4\n")
    for frame in ("ship", "ned", "flu"):
        if frame == "flu":
            ship = ship | {"controls": {"file": str(track)}}
        keys = {"motion": {"every": 0.05, "point": "helm", "frame": frame}}
        over = {name: value for name, value in QUIET.items() if name != "motion"}
        config = load(calm(ship, **keys, duration=6.0), over)
        run(config, folder / frame)
        results[frame] = Result(folder / frame).motion
    return results


def test_motion_has_its_columns_at_its_rate(logged):
    motion = logged["ship"]
    assert tuple(motion) == motion_observer.log_columns(PARTS)
    np.testing.assert_allclose(motion["time_s"], 0.05 * np.arange(121), atol=1e-9)
    np.testing.assert_array_equal(motion["seq"], np.arange(121))


def test_every_part_is_logged_and_they_sum_to_the_total(logged):
    motion = logged["ship"]
    for what, unit in (("force", "N"), ("torque", "Nm")):
        for axis in "xyz":
            parts = np.stack([motion[f"{what}_{part}_{axis}_{unit}"] for part in PARTS])
            error = np.abs(parts.sum(axis=0) - motion[f"{what}_total_{axis}_{unit}"])
            assert error.max() <= 1e-6 * max(1.0, np.abs(parts).max())
    assert motion["force_propeller_x_N"][-1] == pytest.approx(
        14400.0 * np.cos(motion["yaw_rad"][-1] - np.pi / 2), rel=0.02
    )


def test_it_heads_along_x_and_positive_rudder_turns_to_port(logged):
    motion = logged["ship"]
    assert motion["yaw_rad"][0] == pytest.approx(np.pi / 2)
    assert motion["sway_velocity_m_s"][-1] > 1.0
    assert motion["yaw_rad"][-1] > np.pi / 2 + 0.01 and motion["yaw_rate_rad_s"][-1] > 0.0
    assert motion["rudder_rad"][-1] == pytest.approx(np.radians(5.0) * 6.0, rel=0.4)  # limited in rate
    assert motion["force_rudder_z_N"][-1] > 0.0  # to starboard of a ship along x is +z


def test_one_g_is_felt_upwards_and_the_thrust_too_from_the_first_row_on(logged):
    motion = logged["ship"]
    felt = np.stack([motion[f"specific_force_{axis}_m_s2"] for axis in "xyz"])
    np.testing.assert_allclose(felt[:2, 0], [0.0, 9.81], atol=0.05)
    assert motion["force_propeller_x_N"][0] == pytest.approx(14400.0)
    assert felt[2, 0] == pytest.approx(14400.0 / 30000.0, abs=0.15)
    assert felt[2, 20] == pytest.approx(14400.0 / 30000.0, abs=0.15)


def test_accelerations_are_of_the_time_of_their_row(tmp_path):
    """A row for each step: second differences of positions are what the step adds to the velocity, to what nine digits
    show. A step late, they were off by a tenth of their range here."""
    waves = {"kind": "linear_waves", "height": 1.0, "period": 4.0, "ramp": 0.0}
    over = {name: value for name, value in QUIET.items() if name != "motion"}
    config = load(calm({"kind": "dynamic", **BARGE}, fluid=waves, motion={"every": 0.1}, duration=4.0), over)
    run(load(config.resolved(), {"time_step.dt": 0.1}), tmp_path)
    motion = Result(tmp_path).motion
    for name in ("heave", "surge"):
        x, a = motion[f"{name}_m"], motion[f"{name}_acceleration_m_s2"]
        found = np.diff(x, 2) / 0.01
        assert np.abs(found - a[1:-1]).max() < 1e-5 and np.abs(found - a[2:]).max() > 0.05 * np.ptp(a)
        speed = np.gradient(x, 0.1)[1:-1] - motion[f"{name}_velocity_m_s"][1:-1]
        assert np.abs(speed).max() < 0.1 * (0.05 * np.abs(a).max())  # of what half a step adds


def swung(t):
    """A heave [m] and a roll [rad] in closed form; both accelerate by -4 of what they are."""
    return np.array([np.sin(2.0 * t), 0.3 * np.sin(2.0 * t + 1.0)])


def ridden(barge, folder, step):
    """Rows every 0.01 s of a barge that swings so and is seen every `step` [s]: with the mean velocities of the step
    that led there, and what accelerates it then."""
    simulation, rest = barge
    ship, inertia = simulation.ship, rest.inertia_body[2, 2]
    log = motion_observer.Motion(motion_observer.Config(), folder, simulation)
    for t in np.arange(round(4.0 / step) + 1) * step:
        (heave, roll), (speed, rate) = swung(t), (swung(t) - swung(t - step)) / step
        ship.body = replace(
            rest,
            position=np.array([0.0, heave, 0.0]),
            orientation=rigid.euler_quaternion(0.0, 0.0, roll),
            velocity=np.array([0.0, speed, 0.0]),
            angular_momentum=np.array([0.0, 0.0, inertia * rate]),
        )
        simulation.time = t
        log.observe(simulation)
        ship.acceleration, ship.turning = np.array([0.0, -4.0 * heave, 0.0]), np.array([0.0, 0.0, -4.0 * roll])
    log.close()
    return csv_file.read_columns(folder / "motion.csv")


def test_rows_are_the_same_however_many_moments_are_looked_at_together(barge, tmp_path, monkeypatch):
    """To the last bit: nothing is summed over moments, and a run whose rows are waited for has those of any other."""
    found = []
    for moments in (2, 7, 32):
        monkeypatch.setattr(motion_observer, "MOMENTS_PER_BATCH", moments)
        folder = tmp_path / f"{moments}"
        folder.mkdir()
        ridden(barge, folder, 0.07)
        found.append((folder / "motion.csv").read_bytes())
    assert len(found[0].splitlines()) > 400 and found[0] == found[1] == found[2]


def test_poses_between_steps_are_fourth_order_and_their_velocity_does_not_leap(barge, tmp_path):
    """By straight lines they were second-order, and their velocity leapt by a step's acceleration, which shook a
    platform: at the shorter step second differences of rows were up to 8 times too large."""
    error = []
    for step in (0.08, 0.16):
        folder = tmp_path / f"{step}"
        folder.mkdir()
        rows = ridden(barge, folder, step)
        exact = swung(rows["time_s"])
        found = np.array([rows["heave_m"], rows["roll_rad"]])
        most = np.abs(exact).max(axis=1)
        error.append(np.abs(found - exact).max(axis=1) / most)
        bent = np.diff(found, 2) / 0.01**2
        assert (np.abs(bent + 4.0 * exact[:, 1:-1]).max(axis=1) < 0.03 * 4.0 * most).all()
    assert (error[0] < 1e-5).all()
    np.testing.assert_allclose(error[1] / error[0], 16.0, rtol=0.2)


def test_velocities_and_rates_are_of_the_time_of_their_row(barge, tmp_path):
    """Third-order in the step, as of a cubic whose ends are exact to that order. Those that led to a pose, which are of
    half a step before, were off by a step's acceleration: first-order, 8 and 16 % here."""
    error = []
    for step in (0.08, 0.16):
        folder = tmp_path / f"{step}"
        folder.mkdir()
        rows = ridden(barge, folder, step)
        after = rows["time_s"] > step  # at the first time only the velocity that it sets out with is known
        exact = (2.0 * np.array([[1.0], [0.3]]) * np.cos(2.0 * rows["time_s"] + np.array([[0.0], [1.0]])))[:, after]
        found = np.array([rows["heave_velocity_m_s"], rows["roll_rate_rad_s"]])[:, after]
        error.append(np.abs(found - exact).max(axis=1) / np.abs(exact).max(axis=1))
    assert (error[0] < 5e-4).all(), error
    np.testing.assert_allclose(error[1] / error[0], 8.0, rtol=0.2)


def test_a_spring_swings_as_its_closed_form_from_the_first_row_on(barge, tmp_path):
    """Stepped as ships are, with the velocity half a step before t = 0 to begin with: second-order in the step, in the
    velocity as in the place."""
    simulation, rest = barge
    ship, error = simulation.ship, []
    for step in (0.05, 0.1):
        folder = tmp_path / f"{step}"
        folder.mkdir()
        log = motion_observer.Motion(motion_observer.Config(every=step), folder, simulation)
        begin = np.array([0.0, 2.0 * np.cos(step), 0.0])
        body = replace(rest, position=np.zeros(3), velocity=begin, angular_momentum=np.zeros(3))
        for k in range(round(4.0 / step) + 1):
            ship.body, simulation.time = body, k * step
            log.observe(simulation)
            ship.acceleration, ship.turning = -4.0 * body.position, np.zeros(3)
            body = rigid.advance_body(body, body.mass * ship.acceleration, np.zeros(3), step)
        log.close()
        rows = csv_file.read_columns(folder / "motion.csv")
        t = rows["time_s"]
        exact = np.array([np.sin(2.0 * t), 2.0 * np.cos(2.0 * t)])
        found = np.array([rows["heave_m"], rows["heave_velocity_m_s"]])
        error.append(np.abs(found - exact)[:, :-1].max(axis=1))
    assert (error[0] < 0.01).all(), error
    np.testing.assert_allclose(error[1] / error[0], 4.0, rtol=0.2)


def test_a_run_that_stops_has_the_rows_of_one_that_goes_on_but_for_its_last_step(tmp_path):
    """What acts on a ship at the end of a step is known a step later; nothing else waits for it."""
    names = ("motion", "gauges")
    over = {name: value for name, value in QUIET.items() if name not in names}
    waves = {"kind": "linear_waves", "height": 1.0, "period": 5.0, "ramp": 0.0}
    keys = {"fluid": waves, "motion": {"every": 0.01}, "gauges": {"elevation": {"here": [0.0, 9.0]}, "every": 0.01}}
    step = {"kind": "fixed", "dt": 0.037}
    found = []
    for until in (0.7, 1.0):
        folder = tmp_path / f"{until}"
        run(load(calm({"kind": "hydrostatic", **BARGE}, **keys, time_step=step, duration=until), over), folder)
        found.append({name: (folder / f"{name}.csv").read_text().splitlines() for name in ("motion", "gauges")})
    short, long = ({name: [row for row in rows if row[0] != "#"] for name, rows in of.items()} for of in found)
    assert len(short["gauges"]) == 72 and short["gauges"] == long["gauges"][:72]
    time = [float(row.split(",")[0]) for row in short["motion"][1:]]
    same = [ours == theirs for ours, theirs in zip(short["motion"][1:], long["motion"][1:])]
    assert time[-1] == 0.7 and same == [t <= 18 * 0.037 for t in time]


@pytest.mark.parametrize("attitude", [(0.0, 179.0, 0.0), (88.0, 20.0, 5.0)])
def test_angles_between_two_steps_turn_the_short_way_around(attitude, tmp_path):
    """Five rows a step, through south and with the bow straight down: both leapt, by 72 degrees and more."""
    ship = {"kind": "hydrostatic", **BARGE, "attitude_deg": attitude, "rates": [0.3, 0.3, 0.0]}
    over = {name: value for name, value in QUIET.items() if name != "motion"}
    keys = {"duration": 1.0, "motion": {"every": 0.01}, "time_step": {"kind": "fixed", "dt": 0.05}}
    run(load(calm(ship | {"position": [0.0, 30.0, 0.0]}, **keys), over), tmp_path)
    motion = Result(tmp_path).motion
    poses = zip(*(motion[f"{name}_rad"] for name in ("pitch", "yaw", "roll")))
    turns = np.array([rigid.euler_quaternion(*pose) for pose in poses])
    told = np.column_stack([motion[name] for name in ("qw", "qx", "qy", "qz")])
    assert 1.0 - np.abs((turns * told).sum(axis=1)).min() < 1e-9
    assert np.abs((turns[1:] * turns[:-1]).sum(axis=1)).min() > np.cos(0.5 * 0.02)
    assert np.ptp(motion["yaw_rad"]) > 2.0


def test_ned_is_the_same_motion_in_other_axes(logged):
    ours, ned = logged["ship"], logged["ned"]
    np.testing.assert_allclose(ned["heave_m"], -ours["heave_m"], atol=1e-9)
    np.testing.assert_allclose(ned["surge_m"], ours["surge_m"], atol=1e-9)
    np.testing.assert_allclose(ned["yaw_rad"], -ours["yaw_rad"], atol=1e-9)
    np.testing.assert_allclose(ned["specific_force_z_m_s2"], -ours["specific_force_y_m_s2"], atol=1e-9)
    np.testing.assert_allclose(ned["specific_force_x_m_s2"], ours["specific_force_z_m_s2"], atol=1e-9)
    np.testing.assert_allclose(ned["qz"], -ours["qy"], atol=1e-9)


def test_flu_is_the_same_motion_in_turned_axes_and_a_file_steers_as_rows_do(logged):
    ours, flu = logged["ship"], logged["flu"]
    for name in ("throttle", "rudder_rad", "heave_m", "sway_m", "surge_m", "yaw_rad", "pitch_rad", "roll_rad", "qw"):
        np.testing.assert_allclose(flu[name], ours[name], atol=1e-9)
    for theirs, own in zip("xyz", "zxy"):
        np.testing.assert_allclose(flu[f"q{theirs}"], ours[f"q{own}"], atol=1e-9)
        for column in ("specific_force_{}_m_s2", "force_total_{}_N", "torque_rudder_{}_Nm"):
            np.testing.assert_allclose(flu[column.format(theirs)], ours[column.format(own)], rtol=1e-6, atol=1e-6)


def test_a_sea_a_ship_and_a_platform_run_to_their_files(tmp_path):
    ship = {"kind": "yacht", "cells_per_draught": 3.0, "controls": [{"time": 0.0, "throttle": 1.0}]}
    platform = {"kind": "hexapod", "geometry": "hexapod_a", "washout": "ship"}
    over = {name: value for name, value in QUIET.items() if name not in ("motion", "platform_log", "frames")}
    fluid = {"kind": "linear_waves", "height": 0.8, "period": 4.0, "ramp": 0.0}
    keys = {"motion": {"every": 0.01, "point": "helm"}, "frames": {"every": 0.5, "spacing": 10.0}}
    run(load(calm(ship, fluid=fluid, platform=platform, duration=1.0, **keys), over), tmp_path)
    motion = Result(tmp_path).motion
    platform_log = csv_file.read_columns(tmp_path / "platform.csv")
    assert len(motion["time_s"]) == 101 and len(platform_log["time_s"]) >= 100
    assert np.ptp(motion["heave_m"]) > 0.02 and np.ptp(platform_log["leg1_m"]) > 1e-3
    with np.load(tmp_path / "frames" / "grid.npz") as grid, np.load(tmp_path / "frames" / "frame_00002.npz") as frame:
        drawn = grid["ship_vertices"] @ frame["ship_turn"].T + frame["ship_position"]
        assert np.ptp(grid["ship_vertices"][:, 2]) == pytest.approx(14.7, rel=1e-3)
        assert drawn[:, 1].min() < -0.5 and drawn[:, 1].max() > 1.0
    assert "state_sha256" in (tmp_path / "manifest.json").read_text()


def test_the_hash_of_the_state_knows_the_ship(barge):
    simulation, rest = barge
    simulation.ships["ship"].body = rest
    before = state_sha256(simulation)
    simulation.ships["ship"].body = replace(rest, position=rest.position + 1e-9)
    assert state_sha256(simulation) != before


def test_an_autopilot_turns_to_its_course():
    ship = {"kind": "otter", "controls": {"autopilot": {"heading_deg": 60.0, "throttle": 0.6}}}
    with Simulation(load(calm(ship), QUIET)) as simulation:
        while simulation.time < 15.0:
            simulation.step()
        assert np.degrees(simulation.ships["ship"].body.angles[1]) == pytest.approx(60.0, abs=3.0)


def test_wind_pushes_a_ship_downwind_and_only_where_it_is_a_target():
    box = {"kind": "box", "centre": [0.0, 0.0, 0.0], "half_size": [60.0, 60.0, 60.0]}
    for targets, blown in ((["ship"], True), (["fluid"], False)):
        wind = {"kind": "gusts", "volumes": [{"include": [box], "wind_speed": 20.0, "heading_deg": 90.0}]}
        with Simulation(load(calm({"kind": "hydrostatic", **BARGE}, wind=wind | {"targets": targets}), QUIET)) as sim:
            sim.step()
            parts = dict(zip(PARTS, sim.ships["ship"].last.parts, strict=True))
            exposed = 20.0 * 8.0 + 2.0 * 2.0 * 28.0  # deck and sides above the water [m2]
            drag = 1.225 * (0.8 + 0.065 * 20.0) * 1e-3 * 20.0**2 * exposed
            assert parts["wind_drag"][0, 0] == pytest.approx(drag if blown else 0.0, rel=0.15)
            assert (parts["wind_lift"][0, 1] > 0.0) == blown


MOVED = {"length": 99.0, "width": 99.0, "depth": 9.0, "motion": {"axis": "y", "amplitude": 0.5, "period": 2.0}}


@pytest.mark.parametrize(
    "ship, keys, sentence",
    [
        ({"kind": "dynamic", "hull": "barg20"}, {}, "there is no hull 'barg20'"),
        ({"kind": "dynamic", "hull": "barge20", "position": [80.0, 0.0]}, {}, "x = 80 m is outside the basin"),
        ({"kind": "dynamic", "hull": {"shape": {"kind": "sphere", "radius": 1.0}}}, {}, "has no mass"),
        ({"kind": "dynamic", "hull": "barge20", "free": ["hove"]}, {}, "free"),
        ({"kind": "dynamic", "hull": "barge20", "inertia": [1e6, 0.0, 1e6]}, {}, "inertia must be above 0"),
        ({"kind": "dynamic", "hull": "barge20", "inertia": [1e6, 3e6, 1e6]}, {}, "at most the sum of the other two"),
        ({"kind": "otter", "controls": [{"time": 1.0}, {"time": 0.5}]}, {}, "times of the rows must increase"),
        ({"kind": "dynamic", **BARGE}, {"motion": {"point": "mast"}}, "the ship has no point 'mast'"),
        ({"kind": "dynamic", **BARGE}, {"fluid": {"kind": "mueller", "spacing": 10.0}}, "add a `surface`"),
        ({"kind": "dynamic", **BARGE}, {"basin": {"length": 99.0, "depth": 9.0}}, "a ship needs a basin with a width"),
        ({"kind": "dynamic", **BARGE}, {"basin": {"length": 99.0, "width": 99.0, "depth": 1.0}}, "the ship draws 2 m"),
        ({"kind": "dynamic", **BARGE}, {"basin": MOVED}, "an acceleration of its water, which a ship does not feel"),
    ],
)
def test_what_cannot_be_is_refused_with_a_sentence(ship, keys, sentence):
    with pytest.raises(SceneError) as refused:
        load(calm(ship, **keys))
    assert any(sentence in str(problem) for problem in refused.value.problems), refused.value


def test_a_body_force_that_the_ship_does_not_feel_is_told():
    water = {"kind": "mueller", "spacing": 1.0}
    heavier = water | {"body_force": [0.0, -3.0, 0.0]}
    told = [load(calm({"kind": "dynamic", **BARGE}, fluid=f, surface="cloth")).warnings() for f in (water, heavier)]
    assert [any("the ship does not feel it" in warning for warning in one) for one in told] == [False, True]


def test_motion_without_a_ship_is_refused():
    without = calm({"kind": "dynamic", **BARGE}, motion={})
    del without["ship"]
    with pytest.raises(SceneError, match="there is no ship whose motion could be logged"):
        load(without)


@pytest.mark.parametrize(
    "keys",
    [
        {"attitude_deg": [0.0, 0.0, 180.0]},
        {"position": [0.0, 5.0, 0.0]},
        {"position": [0.0, -10.0, 0.0]},
        {"rates": [0.5, 0.5, 0.5]},
        {"mass": 32e3},
        {"mass": 630e3},
    ],
)
def test_a_ship_in_distress_stays_in_the_physical_world(keys):
    """Capsized, dropped, under water, tumbling, light, nearly sunk: four times the usual step."""
    config = load(calm({"kind": "dynamic", **BARGE, **keys}), QUIET | {"time_step.dt": 0.1})
    with Simulation(config) as simulation:
        first = abs(simulation.ships["ship"].body.position[1])
        for _ in range(150):
            simulation.step()
        body = simulation.ships["ship"].body
        assert np.isfinite(body.position).all() and np.linalg.norm(body.velocity) < 25.0
        assert abs(body.position[1]) < max(first, 4.0)


def test_a_ship_that_is_too_heavy_sinks_to_the_bed_and_the_run_says_so():
    config = load(calm({"kind": "dynamic", **BARGE, "mass": 3200e3}), QUIET | {"time_step.dt": 0.1})
    assert "it sinks" in " ".join(config.warnings())
    with Simulation(config) as simulation, pytest.raises(Diverged, match="sunk to the bed, 50 m down"):
        simulation.run(60.0)
