"""Prescribed motion: derivatives that belong together, free water on straight lines, strokes from tables."""

from math import cos, pi, sin

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

import ocean_sim
from ocean_sim import waves
from ocean_sim.basin import Config as BasinConfig
from ocean_sim.basin.motion import Frame, Motion, TankMotion, Wavemaker, turned
from ocean_sim.conventions import GRAVITY
from ocean_sim.files.yaml_file import SceneError

SLICE = BasinConfig(length=10.0, depth=0.5).build()
BAY = BasinConfig(length=10.0, width=5.0, depth=0.5).build()
DOWN = np.array([0.0, -GRAVITY, 0.0])


def motion(**keys):
    return TypeAdapter(Motion).validate_python(keys)


def assert_derivatives(law, times, step=1e-5) -> None:
    """Velocity and acceleration are the differences of displacement and velocity."""
    for t in times:
        (x0, v0, _), (_, v, a), (x1, v1, _) = law(t - step), law(t), law(t + step)
        assert (x1 - x0) / (2 * step) == pytest.approx(v, abs=1e-7)
        assert (v1 - v0) / (2 * step) == pytest.approx(a, abs=1e-6)


@pytest.mark.parametrize("ramp", [0.0, None, 3.3])
def test_harmonic_motion_has_its_derivatives_and_its_amplitude(ramp):
    law = motion(kind="harmonic", axis="x", amplitude=0.1, period=2.0, ramp=ramp).build().law
    assert_derivatives(law, np.linspace(0.1, 6.0, 40))
    assert law(4.5) == pytest.approx((0.1, 0.0, -0.1 * pi**2))
    assert law(0.0) == pytest.approx((0.0, 0.1 * pi if ramp == 0.0 else 0.0, 0.0), abs=1e-15)


@pytest.mark.parametrize("phase", [90.0, -37.0, 180.0, 400.0])
def test_a_phase_is_a_shift_in_time_that_starts_without_a_jump(phase):
    keys = {"kind": "harmonic", "axis": "roll_z", "amplitude": 0.1, "period": 2.0}
    law, steady = motion(phase_deg=phase, **keys).build().law, motion(ramp=0.0, **keys).build().law
    assert_derivatives(law, np.linspace(0.1, 6.0, 40))
    for t in (2.0, 3.3, 7.9):  # the motion has grown after one period
        assert law(t) == pytest.approx(steady(t + 2.0 * phase / 360.0), abs=1e-12)
    assert law(0.0) == (0.0, 0.0, 0.0) and max(map(abs, law(1e-4))) < 1e-3 * 0.1 * pi**2
    at_once = motion(phase_deg=90.0, ramp=0.0, **keys).build().law
    assert at_once(0.0) == pytest.approx((0.1, 0.0, -0.1 * pi**2), abs=1e-15)


def test_a_motion_without_a_phase_is_to_the_bit_what_it_was():
    law = motion(kind="harmonic", axis="x", amplitude=0.1, period=1.7, ramp=0.0).build().law
    omega = 2.0 * pi / 1.7
    for t in np.linspace(0.0, 20.0, 1001):
        assert law(t)[:2] == (0.1 * sin(omega * t), 0.1 * omega * cos(omega * t))


HARMONIC = {"axis": "x", "amplitude": 0.1, "period": 2.0}


def test_what_moves_a_tank_is_named_or_told_by_its_keys():
    assert motion(**HARMONIC) == motion(kind="harmonic", **HARMONIC)
    assert motion(file="sway.csv") == motion(kind="file", file="sway.csv")
    for built in (motion(**HARMONIC), motion(file="sway.csv", axis="x")):
        assert motion(**built.model_dump()) == built  # as a scene is dumped and read again


@pytest.mark.parametrize(
    "keys, key, said",
    [
        (HARMONIC | {"file": "a.csv"}, "basin.motion", "the motion of a file has no amplitude and no period"),
        ({"kind": "file", "file": "a.csv", "ramp": 1.0}, "basin.motion", "has no ramp; those are of kind: harmonic"),
        ({"kind": "harmonic", "file": "a.csv"}, "basin.motion", "a harmonic motion has no file"),
        ({"kind": "harmonc", **HARMONIC}, "basin.motion.kind", "did you mean 'harmonic'?"),
        ({"kind": "shaken", **HARMONIC}, "basin.motion.kind", "there are harmonic, file"),
        ({"kind": "file"}, "basin.motion.file", "missing key"),
    ],
)
def test_a_motion_that_contradicts_itself_gets_one_sentence(keys, key, said):
    basin = {"length": 1.0, "depth": 0.4, "motion": keys}
    with pytest.raises(SceneError) as error:
        ocean_sim.load({"basin": basin, "fluid": {"kind": "delta_sph", "spacing": 0.05}})
    (problem,) = error.value.problems
    assert problem.key == key and said in problem.message


def test_motion_from_a_file_is_smooth_and_has_its_derivatives(tmp_path):
    t = np.linspace(0.0, 4.0, 81)
    path = tmp_path / "roll.csv"
    np.savetxt(
        path, np.stack([t, 0.1 * np.sin(pi * t)], axis=1), delimiter=",", header="time_s,roll_z_rad", comments=""
    )
    recorded = motion(file=str(path), about=[0.0, -0.5])
    assert not recorded.problems(SLICE)
    built = recorded.build()
    assert built.axis == "roll_z"
    assert_derivatives(built.law, np.linspace(0.11, 3.9, 40))
    x, v, a = built.law(1.23)
    assert x == pytest.approx(0.1 * np.sin(pi * 1.23), abs=1e-6)
    assert v == pytest.approx(0.1 * pi * np.cos(pi * 1.23), abs=1e-4)
    assert a == pytest.approx(-0.1 * pi**2 * np.sin(pi * 1.23), abs=5e-3)
    assert built.law(9.0) == (pytest.approx(0.0, abs=1e-12), 0.0, 0.0)
    np.testing.assert_allclose(built.at(1.23).pivot, [0.0, -0.5, 0.0])


def test_what_a_file_lacks_is_said(tmp_path):
    path = tmp_path / "roll.csv"
    assert "there is no such file" in motion(file=str(path)).problems(SLICE)[0][1]
    path.write_text("time_s,pitch\n0,0\n1,0\n2,0\n3,0\n")
    assert "no column of an axis" in motion(file=str(path)).problems(SLICE)[0][1]
    path.write_text("time_s,x,roll_z\n0,0,0\n1,0,0\n2,0,0\n3,0,0\n")
    assert "`axis` says which" in motion(file=str(path)).problems(SLICE)[0][1]
    assert motion(file=str(path), axis="x").build().axis == "x"
    path.write_text("time_s,x\n0,0\n1,0\n1,0\n3,0\n")
    assert "times rise from row to row" in motion(file=str(path)).problems(SLICE)[0][1]


def place_in_tank(built: TankMotion, world: np.ndarray, time: float) -> np.ndarray:
    """(3,) where a point of the world is in the axes of the tank."""
    frame = built.at(time)
    return turned(world - frame.pivot - frame.displacement, -frame.angle) + frame.pivot


def apparent_acceleration(frame: Frame, gravity: np.ndarray, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """(m, 3) acceleration [m/s2] of free water at (m, 3) positions and velocities in the axes of the tank:
    g' - a - alpha x r - omega x (omega x r) - 2 omega x v, with r from the pivot."""
    r, omega = position - frame.pivot, frame.rate
    euler = np.cross(frame.angular_acceleration, r)
    centrifugal = np.cross(omega, np.cross(omega, r))
    return frame.push(gravity) - euler - centrifugal - 2.0 * np.cross(omega, velocity)


@pytest.mark.parametrize("axis", ["x", "y", "z", "roll_x", "roll_y", "roll_z"])
def test_free_water_flies_a_parabola_in_the_world(axis):
    """Seen from the tank, the second difference of its path is the apparent acceleration."""
    about = [0.2, -0.3, 0.1]
    built = motion(kind="harmonic", axis=axis, amplitude=0.4, period=1.7, about=about).build()
    start, speed, t, step = np.array([0.7, 0.2, -0.5]), np.array([0.3, 1.0, -0.8]), 2.1, 1e-4
    path = [place_in_tank(built, start + speed * s + 0.5 * DOWN * s * s, s) for s in (t - step, t, t + step)]
    velocity, acceleration = (path[2] - path[0]) / (2 * step), (path[2] - 2 * path[1] + path[0]) / step**2
    expected = apparent_acceleration(built.at(t), DOWN, path[1][None], velocity[None])[0]
    np.testing.assert_allclose(acceleration, expected, atol=2e-6)
    frame = built.at(t)
    without_coriolis = apparent_acceleration(frame, DOWN, path[1][None], 0.0 * velocity[None])[0]
    assert axis in "xyz" or np.abs(without_coriolis - expected).max() > 0.01


def test_water_that_turns_steadily_with_its_tank_feels_the_centrifugal_force():
    still = np.zeros(3)
    spinning = Frame(still, still, still, still, np.array([0.0, 2.0, 0.0]), still, still)
    felt = apparent_acceleration(spinning, DOWN, np.array([[0.5, 0.0, 0.0]]), np.zeros((1, 3)))
    np.testing.assert_allclose(felt, [[0.5 * 4.0, -GRAVITY, 0.0]])


# Height over stroke of a piston: Biesel & Suquet (1951), Dean & Dalrymple (1991); depth [m], period [s], H/S.
TRANSFER = [(0.25, 1.14935, 0.981789), (0.5, 1.0, 1.714), (0.5, 1.2, 1.417), (0.5, 1.5, 1.082), (0.5, 2.0, 0.769)]


@pytest.mark.parametrize("depth, period, transfer", TRANSFER)
def test_the_stroke_is_biesels(depth, period, transfer):
    piston = Wavemaker(height=0.03, period=period).build(depth, GRAVITY)
    assert 0.03 / piston.stroke == pytest.approx(transfer, abs=6e-4)
    moved = [piston.at(t)[0] for t in np.linspace(5.0 * period, 6.0 * period, 2001)]
    assert np.ptp(moved) == pytest.approx(piston.stroke, rel=1e-5)


def test_a_piston_has_its_derivatives_and_moves_into_the_basin():
    left = Wavemaker(height=0.05, period=1.5).build(0.5, GRAVITY)
    right = Wavemaker(height=0.05, period=1.5, wall="x_max", ramp=4.0).build(0.5, GRAVITY)
    for piston in (left, right):
        assert_derivatives(piston.at, np.linspace(0.05, 6.0, 40))
        assert piston.at(0.0) == pytest.approx((0.0, 0.0, 0.0), abs=1e-15)
    t = 6.0 + 1.5 / 4.0  # S/2 sin(omega t) is farthest in
    assert left.at(t)[0] == pytest.approx(left.stroke / 2.0) and right.at(t)[0] == pytest.approx(-right.stroke / 2.0)


def test_the_piston_of_a_spectrum_makes_its_waves():
    """Each wave by its own stroke, and what leaves the piston is in phase with its speed."""
    spectrum = {"significant_wave_height": 0.04, "peak_period": 1.5, "seed": 2}
    piston = Wavemaker(spectrum=spectrum).build(0.5, GRAVITY)
    assert_derivatives(piston.at, np.linspace(0.05, 6.0, 20))
    kh = piston.sea.wavenumber * 0.5
    made = waves.Components(
        piston.amplitude * waves.piston_transfer(kh), piston.sea.wavevector, piston.sea.phase, 0.5, GRAVITY
    )
    assert 4.0 * np.linalg.norm(made.amplitude) / 2.0**0.5 == pytest.approx(0.04)
    times = np.arange(10.0, 200.0, 0.25)
    speed = [piston.at(t)[1] for t in times]
    waves_there = [waves.elevation(made, np.zeros((1, 2)), t)[0] for t in times]
    assert np.corrcoef(speed, waves_there)[0, 1] > 0.95


def test_a_motion_that_was_written_down_is_read_again():
    written = motion(kind="harmonic", axis="x", amplitude=0.1, period=2.0).model_dump(mode="json")
    assert not motion(**written).problems(SLICE) and not motion(**written).problems(BAY)


def test_what_cannot_be_is_said():
    assert motion(kind="harmonic", axis="roll_x", amplitude=0.1, period=2.0).problems(SLICE)
    assert not motion(kind="harmonic", axis="roll_x", amplitude=0.1, period=2.0).problems(BAY)
    assert motion(kind="harmonic", axis="x", amplitude=0.1, period=2.0, about=[0.0, 0.0]).problems(BAY)
    assert "would break" in Wavemaker(height=0.6, period=1.5).problems(SLICE, "reflecting")[0][1]
    assert "no walls along z" in Wavemaker(height=0.05, period=1.5, wall="z_min").problems(SLICE, "reflecting")[0][1]
    ring = BasinConfig(length=10.0, depth=0.5, walls="periodic").build()
    assert "x_min is periodic" in Wavemaker(height=0.05, period=1.5).problems(ring, "periodic")[0][1]
    spectrum = {"significant_wave_height": 0.04, "peak_period": 1.5, "heading_deg": 10.0}
    assert "leave this out" in Wavemaker(spectrum=spectrum).problems(SLICE, "reflecting")[0][1]
    with pytest.raises(ValidationError):
        motion(kind="harmonic", axis="roll", amplitude=0.1, period=2.0)
    with pytest.raises(ValidationError, match="either height"):
        Wavemaker(wall="x_min")


@pytest.mark.parametrize("begin", [100.0, 1709294400.0, -100.0])
def test_rows_that_a_run_does_not_reach_are_said(tmp_path, begin):
    """Of every file with times that a scene names; a run that reaches into its rows is told nothing."""
    from ocean_sim.basin.motion import Gate
    from ocean_sim.ship.forces.propulsion import Helm

    place = "ends at -9" if begin < 0.0 else f"begins at {begin:.12g} s, when the run of 5 s is over"
    for first, said in ((begin, place), (0.0, None)):
        times = first + 0.1 * np.arange(51)
        for name, columns in {"tank": "x_m", "gate": "y_m", "orders": "throttle,rudder_rad"}.items():
            rows = "".join(f"{t:.3f}{',0.01' * len(columns.split(','))}\n" for t in times)
            (tmp_path / f"{name}.csv").write_text(f"time_s,{columns}\n{rows}")
        tank = motion(file=str(tmp_path / "tank.csv")).warnings(5.0)
        gate = Gate(file=str(tmp_path / "gate.csv")).warnings(5.0)
        orders = Helm.model_validate({"controls": {"file": str(tmp_path / "orders.csv")}}).late_orders(5.0)
        for found in (tank, gate, orders):
            assert any(said in sentence for sentence in found) if said else not found


def test_a_tank_that_rolls_by_half_a_turn_is_warned_of_and_columns_may_be_in_degrees(tmp_path):
    """A file's amplitude of 4 under `roll_z` are radians; under `roll_z_deg` 0.0698 rad."""
    times = np.linspace(0.0, 2.0, 41)
    moved = 4.0 * np.sin(np.pi * times) ** 2
    for name, warned in (("roll_z", True), ("roll_z_deg", False)):
        file = tmp_path / f"{name}.csv"
        file.write_text(f"time_s,{name}\n" + "".join(f"{t},{x}\n" for t, x in zip(times, moved)))
        recorded = motion(file=str(file))
        assert any("half a turn" in w for w in recorded.warnings(2.0)) is warned
        assert np.abs(recorded.rows()[2]).max() == pytest.approx(4.0 if warned else np.radians(4.0), rel=1e-9)
    assert any("half a turn" in w for w in motion(axis="roll_z", amplitude=4.0, period=2.0).warnings(2.0))
    assert not motion(axis="roll_z", amplitude=1.0, period=2.0).warnings(2.0)
    assert not motion(axis="x", amplitude=4.0, period=2.0).warnings(2.0)


@pytest.mark.parametrize(
    ("gravity", "said"),
    [
        ([0.0, 0.0, -9.81], "more to a side"),
        ([0.0, -981.0, 0.0], "another unit"),
        ([0.0, -0.981, 0.0], "another unit"),
        ([0.0, 9.81, 0.0], "upwards"),
        ([1.0, -9.7, 0.0], ""),
        ([0.0, -1.62, 0.0], ""),
        ([0.0, 0.0, 0.0], ""),
    ],
)
def test_gravity_of_another_convention_is_warned_of(gravity, said):
    fluid = {"kind": "ballistic", "spacing": 0.2}
    made = ocean_sim.load({"basin": {"length": 1.0, "width": 1.0, "depth": 0.5, "gravity": gravity}, "fluid": fluid})
    found = [w for w in made.warnings() if w.startswith(("gravity of", "gravity points"))]
    assert len(found) == bool(said) and all(said in w for w in found)


def test_a_slice_has_no_gravity_along_z():
    basin = {"length": 1.0, "depth": 0.5, "gravity": [0.0, 0.0, -9.81]}
    with pytest.raises(SceneError, match=r"basin\.gravity: a slice, in x-y, has no gravity along z; y is up"):
        ocean_sim.load({"basin": basin, "fluid": {"kind": "ballistic", "spacing": 0.2}})


def test_a_recorded_roll_that_may_be_in_radians_and_an_axis_given_twice_are_said(tmp_path):
    """0.07 under `roll_z_deg` are hardly degrees; under `roll_z_rad` they are 4 degrees."""
    times = np.linspace(0.0, 2.0, 41)
    for names, warned in ((["roll_z_deg"], True), (["roll_z_rad"], False), (["roll_z_deg", "roll_z_rad"], None)):
        rows = [[t, *[0.07 * np.sin(np.pi * t) ** 2] * len(names)] for t in times]
        file = tmp_path / "roll.csv"
        file.write_text("\n".join([",".join(["time_s", *names]), *(",".join(map(str, row)) for row in rows)]))
        if warned is None:
            (problem,) = motion(file=str(file)).problems(SLICE)
            assert "columns roll_z_deg and roll_z_rad" in problem[1]
        else:
            assert any("is roll_z_deg in radians?" in w for w in motion(file=str(file)).warnings(2.0)) is warned
