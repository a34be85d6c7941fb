"""Prescribed motion: derivatives that belong together, free water on straight lines, strokes from tables."""

from math import cos, pi, sin

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

import ocean_sim
from ocean_sim import waves
from ocean_sim.basin import Config as BasinConfig
from ocean_sim.basin.motion import AnyWavemaker, Frame, Motion, Piston, TankMotion, turned
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
        (HARMONIC | {"file": "a.csv"}, "basin.motion", "kind: harmonic has no file; kind: file has"),
        ({"kind": "file", "file": "a.csv", "ramp": 1.0}, "basin.motion", "kind: file has no ramp; kind: harmonic has"),
        ({"kind": "harmonic", "file": "a.csv"}, "basin.motion", "kind: harmonic has no file; kind: file has"),
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
    assert not [*recorded.problems(SLICE)]
    built = recorded.build()
    assert built.axis == "roll_z"
    assert_derivatives(built.law, np.linspace(0.11, 3.9, 40))
    x, v, a = built.law(1.23)
    assert x == pytest.approx(0.1 * np.sin(pi * 1.23), abs=1e-6)
    assert v == pytest.approx(0.1 * pi * np.cos(pi * 1.23), abs=1e-4)
    assert a == pytest.approx(-0.1 * pi**2 * np.sin(pi * 1.23), abs=5e-3)
    assert built.law(9.0) == (pytest.approx(0.0, abs=1e-12), 0.0, 0.0)
    np.testing.assert_allclose(built.at(1.23).pivot, [0.0, -0.5, 0.0])


def lacking(path):
    """Sentence on what the file of a motion lacks."""
    [(_, sentence)] = motion(file=str(path)).problems(SLICE)
    return sentence


def test_what_a_file_lacks_is_said(tmp_path):
    path = tmp_path / "roll.csv"
    assert "there is no such file" in lacking(path)
    path.write_text("time_s,pitch\n0,0\n1,0\n2,0\n3,0\n")
    assert "no column of an axis" in lacking(path)
    path.write_text("time_s,x,roll_z\n0,0,0\n1,0,0\n2,0,0\n3,0,0\n")
    assert "`axis` says which" in lacking(path)
    assert motion(file=str(path), axis="x").build().axis == "x"
    path.write_text("time_s,x\n0,0\n1,0\n1,0\n3,0\n")
    assert "times rise from row to row" in lacking(path)


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


def piston(depth=0.5, **keys):
    """Piston of a wavemaker with these keys, in water of this depth [m]."""
    return Piston(TypeAdapter(AnyWavemaker).validate_python(keys), depth, GRAVITY)


def faults(basin, side="reflecting", **keys):
    """Sentences on what is wrong with a wavemaker with these keys."""
    return [sentence for _, sentence in piston(**keys).maker.problems(basin, side)]


@pytest.mark.parametrize("depth, period, transfer", TRANSFER)
def test_the_stroke_is_biesels(depth, period, transfer):
    made = piston(depth, height=0.03, period=period)
    stroke = made.path.advance + made.path.retreat
    assert 0.03 / stroke == pytest.approx(transfer, abs=6e-4)
    moved = [made.at(t)[0] for t in np.linspace(5.0 * period, 6.0 * period, 2001)]
    assert np.ptp(moved) == pytest.approx(stroke, rel=1e-5)


def test_a_piston_has_its_derivatives_and_moves_into_the_basin():
    left = piston(height=0.05, period=1.5)
    right = piston(height=0.05, period=1.5, wall="x_max", ramp=4.0)
    for made in (left, right):
        assert_derivatives(made.at, np.linspace(0.05, 6.0, 40))
        assert made.at(0.0) == pytest.approx((0.0, 0.0, 0.0), abs=1e-15)
    t = 6.0 + 1.5 / 4.0  # S/2 sin(omega t) is farthest in
    assert left.at(t)[0] == pytest.approx(left.path.advance) and right.at(t)[0] == pytest.approx(-right.path.advance)


def test_the_piston_of_a_spectrum_makes_its_waves():
    """The speed of the piston is in phase with the waves that leave it."""
    spectrum = {"significant_wave_height": 0.04, "peak_period": 1.5, "seed": 2}
    made = piston(spectrum=spectrum)
    assert_derivatives(made.at, np.linspace(0.05, 6.0, 20))
    sea = made.path.sea
    assert 4.0 * np.linalg.norm(sea.amplitude) / 2.0**0.5 == pytest.approx(0.04)
    stroke = made.path.advance + made.path.retreat
    assert (2.0 * sea.amplitude / waves.piston_transfer(0.5 * sea.wavenumber)).sum() == pytest.approx(stroke)
    times = np.arange(10.0, 200.0, 0.25)
    speed = [made.at(t)[1] for t in times]
    waves_there = [waves.elevation(sea, np.zeros((1, 2)), t)[0] for t in times]
    assert np.corrcoef(speed, waves_there)[0, 1] > 0.95


@pytest.mark.parametrize("wall, inward", [("x_min", 1.0), ("x_max", -1.0)])
@pytest.mark.parametrize("ratio", [0.01, 0.2, 0.5, 0.77])
def test_the_piston_of_a_solitary_wave_moves_with_the_water_before_it(ratio, wall, inward):
    """Goring (1979): stroke sqrt(16 H d / 3), time 2 / (kappa c) (3.80 + H / d), xi' = c eta / (d + eta)."""
    d, h, start = 0.5, 0.5 * ratio, 0.7
    made = piston(d, kind="solitary", height=h, start=start, wall=wall)
    c, kappa = (GRAVITY * (d + h)) ** 0.5, (0.75 * h / d**3) ** 0.5
    stroke, end = made.path.advance, start + 2.0 / (kappa * c) * (3.80 + 0.999 * ratio)
    assert stroke == pytest.approx((16.0 * h * d / 3.0) ** 0.5, rel=1.001e-3)
    assert made.path.retreat == 0.0 and made.path.sea is None
    assert made.at(start - 1e-9) == (0.0, 0.0, 0.0) and made.at(end + 0.01) == (inward * stroke, 0.0, 0.0)
    assert made.at(end - 0.01)[1] != 0.0 and abs(made.at(end - 0.01)[0]) < stroke
    times = np.linspace(start + 1e-4, end - 1e-2, 200)
    assert_derivatives(made.at, times)
    for t in times:
        x, v, _ = made.at(t)
        from_crest = c * (t - 0.5 * (start + end)) - (inward * x - 0.5 * stroke)
        eta = h / np.cosh(kappa * from_crest) ** 2
        assert inward * v == pytest.approx(c * eta / (d + eta), rel=5e-3)


def test_a_recorded_wall_counts_from_its_place_at_time_0(tmp_path):
    t = np.linspace(-1.0, 4.0, 101)
    path = tmp_path / "piston.csv"
    np.savetxt(path, np.stack([t, 0.3 - 0.1 * np.cos(pi * t)], 1), delimiter=",", header="time_s,x_m", comments="")
    made = piston(file=str(path), wall="x_max")
    assert_derivatives(made.at, np.linspace(0.11, 3.9, 40) + 0.003)
    assert made.at(0.0)[0] == 0.0 and made.at(1.0)[0] == pytest.approx(-0.2, abs=1e-5)
    assert made.at(9.0) == (pytest.approx(0.0, abs=1e-12), 0.0, 0.0)
    assert made.path.advance == pytest.approx(0.2, abs=1e-5) and made.path.retreat == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    "seconds, metres, told",
    [
        (1e3, 1.0, ["are its times in milliseconds?"]),
        (1.0, 20.0, ["is x_m in metres, and time_s"]),
        (1.0, 1.0, []),
    ],
)
def test_a_recorded_wall_in_other_units_is_warned_of(tmp_path, seconds, metres, told):
    t, path = np.linspace(0.0, 3.0, 61), tmp_path / "piston.csv"
    rows = np.stack([seconds * t, 0.05 * metres * np.sin(pi * t) ** 2], 1)
    np.savetxt(path, rows, delimiter=",", header="time_s,x_m", comments="")
    config = flume(file=str(path))
    found = list(config.basin.wavemaker.warnings(config.preflight.tank, 3.0))
    assert len(found) == len(told) and all(sentence in warning for sentence, warning in zip(told, found))


FLUME = {"basin": {"length": 4.0, "depth": 0.2, "walls": {"x_max": "absorbing"}}, "duration": 3.0}
FLUME |= {"fluid": {"kind": "delta_sph", "spacing": 0.04}}


def flume(**keys):
    return ocean_sim.load(FLUME | {"basin": FLUME["basin"] | {"wavemaker": keys}})


def test_a_wavemaker_is_named_or_told_by_its_keys_and_read_again_as_it_was_dumped(tmp_path):
    (tmp_path / "path.csv").write_text("time_s,x_m\n0,0\n0.1,0\n0.9,0.05\n1,0.05\n")
    file = str(tmp_path / "path.csv")
    kinds = {
        "train": {"height": 0.02, "period": 1.2},
        "solitary": {"height": 0.04, "start": 0.1},
        "file": {"file": file},
    }
    for kind, keys in kinds.items():
        scene = flume(**keys)
        dumped = scene.resolved()
        assert dumped["basin"]["wavemaker"]["kind"] == kind
        assert ocean_sim.load(dumped).resolved() == dumped == flume(kind=kind, **keys).resolved()
        moves = [
            sentence for sentence in scene.fluid.statements(scene.preflight) if "the wavemaker moves up to" in sentence
        ]
        assert len(moves) == (kind != "train")


@pytest.mark.parametrize(
    "keys, key, said",
    [
        (
            {"height": 0.04, "period": 1.0, "start": 1.0},
            "basin.wavemaker",
            "kind: train has no start; kind: solitary has",
        ),
        ({"kind": "solitary", "height": 0.04, "period": 1.0}, "basin.wavemaker", "kind: solitary has no period"),
        ({"file": "a.csv", "ramp": 1.0}, "basin.wavemaker", "kind: train has no file; kind: file has"),
        ({"kind": "soliton", "height": 0.04}, "basin.wavemaker.kind", "did you mean 'solitary'?"),
        ({"kind": ["file"]}, "basin.wavemaker.kind", "is not a choice"),
        ({"height": 0.04}, "basin.wavemaker", "give either height [m] and period [s]"),
        ({"kind": "solitary"}, "basin.wavemaker.height", "missing key"),
        ({"kind": "solitary", "height": -0.04}, "basin.wavemaker.height", "is not greater than 0 [m]"),
        (
            {"kind": "solitary", "height": 0.16},
            "basin.wavemaker.height",
            "would break: on 0.2 m of water it is lower than",
        ),
        ({"kind": "solitary", "height": 0.04, "wall": "z_min"}, "basin.wavemaker.wall", "no walls along z"),
        ({"kind": "solitary", "height": 0.04, "wall": "x_max"}, "basin.wavemaker.wall", "x_max is absorbing"),
        ({"file": "nowhere.csv"}, "basin.wavemaker.file", "there is no such file"),
        ({"file": "y.csv"}, "basin.wavemaker.file", "it has no column x_m, but 'time_s, y_m'"),
        ({"file": "mm.csv"}, "basin.wavemaker", "m into a basin that is 4 m long; paths are in metres"),
    ],
)
def test_a_wavemaker_that_cannot_be_gets_one_sentence(tmp_path, monkeypatch, keys, key, said):
    monkeypatch.chdir(tmp_path)
    for name, column in (("mm", "x_m"), ("y", "y_m")):
        (tmp_path / f"{name}.csv").write_text(f"time_s,{column}\n0,0\n0.1,0\n0.9,50\n1,50\n")
    with pytest.raises(SceneError) as error:
        flume(**keys)
    (problem,) = error.value.problems
    assert problem.key == key and said in problem.message


def test_a_doubtful_wavemaker_is_warned_of(tmp_path):
    said = "the run ends at 3 s, and the wavemaker moves until"
    for keys, warning in (
        ({"height": 0.04}, None),
        ({"height": 0.04, "start": 1.0}, said),
        ({"height": 0.11}, "holds up to about 0.5"),
    ):
        found = [w for w in flume(kind="solitary", **keys).warnings() if "wavemaker" in w]
        assert len(found) == (warning is not None) and all(warning in w for w in found)
    path = tmp_path / "late.csv"
    path.write_text("time_s,x_m\n" + "".join(f"{t},{0.01 * t}\n" for t in range(5, 10)))
    assert any("the wavemaker never moves" in w for w in flume(file=str(path)).warnings())


def test_a_motion_that_was_written_down_is_read_again():
    written = motion(kind="harmonic", axis="x", amplitude=0.1, period=2.0).model_dump(mode="json")
    assert not [fault for basin in (SLICE, BAY) for fault in motion(**written).problems(basin)]


def test_what_cannot_be_is_said():
    assert [*motion(kind="harmonic", axis="roll_x", amplitude=0.1, period=2.0).problems(SLICE)]
    assert not [*motion(kind="harmonic", axis="roll_x", amplitude=0.1, period=2.0).problems(BAY)]
    assert [*motion(kind="harmonic", axis="x", amplitude=0.1, period=2.0, about=[0.0, 0.0]).problems(BAY)]
    assert "would break" in faults(SLICE, height=0.6, period=1.5)[0]
    assert "no walls along z" in faults(SLICE, height=0.05, period=1.5, wall="z_min")[0]
    ring = BasinConfig(length=10.0, depth=0.5, walls="periodic").build()
    assert "x_min is periodic" in faults(ring, "periodic", height=0.05, period=1.5)[0]
    spectrum = {"significant_wave_height": 0.04, "peak_period": 1.5, "heading_deg": 10.0}
    assert "leave this out" in faults(SLICE, spectrum=spectrum)[0]
    with pytest.raises(ValidationError):
        motion(kind="harmonic", axis="roll", amplitude=0.1, period=2.0)
    with pytest.raises(ValidationError, match="either height"):
        piston(wall="x_min")


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
            assert any(said in sentence for sentence in found) if said else not [*found]


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
    assert not [*motion(axis="roll_z", amplitude=1.0, period=2.0).warnings(2.0)]
    assert not [*motion(axis="x", amplitude=4.0, period=2.0).warnings(2.0)]


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
