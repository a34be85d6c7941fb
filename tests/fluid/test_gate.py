"""Obstacles that move and leave: what a gate gives the water gets, and what it holds back stays until it has gone."""

import json
from pathlib import Path

import numpy as np
import pytest

from ocean_sim import load
from ocean_sim.__main__ import run_command_line
from ocean_sim.basin.motion import Gate
from ocean_sim.conventions import GRAVITY
from ocean_sim.fluid.bodies.boundary import MOTION_COLUMNS
from ocean_sim.observers.shared.checks import distance_outside
from ocean_sim.reading.scene import SceneError
from ocean_sim.simulation import Simulation
from tests.conftest import quickly
from tests.fluid.conftest import by_id, put, undone
from tests.fluid.test_boundary import FREE, step_to

PLATE = {"min": [0.05, -0.4], "max": [0.25, -0.1]}
SPEED = np.array([-1.0, 0.3, 0.0])
QUIET = dict.fromkeys(("render", "report", "timings", "preview"))


def swept(water, kind: str, slip: str = "free_slip", drift: np.ndarray | None = None, steps: int = 100):
    """A block of water at rest into which a plate has run for 0.1 s, away from all sides and without gravity; seen
    from axes that `drift` [m/s]."""
    way = np.zeros(3) if drift is None else drift
    motion = {"velocity": (SPEED - way).tolist()}
    basin = FREE | {"obstacles": [PLATE | {"slip": slip, "motion": motion}]}
    keys = {"spacing": 0.05, "reference_speed": 4.0, "kinematic_viscosity": 0.005, "collision_distance": 0.001}
    fluid = water(kind, basin=basin, accounts=True, fill=[{"min": [-0.35, -0.4], "max": [0.0, -0.1]}], **keys)
    fluid.particles.pressure.fill(0.0)
    x = by_id(fluid, fluid.particles.position.to_numpy())
    put(fluid, x, np.tile(-way, (len(x), 1)))
    for _ in range(steps):
        fluid.advance(0.1 / steps)
    return fluid


@pytest.mark.parametrize("kind", quickly("delta_sph", "mueller", "dfsph"))
def test_a_plate_gives_its_momentum_and_work_to_the_water(water, kind):
    """Without gravity the water has what the plate gave, by its samples and its faces, and of a steady plate work is
    velocity times impulse."""
    fluid = swept(water, kind)
    momentum = fluid.particles.mass * fluid.particles.velocity.to_numpy().sum(axis=0)
    assert momentum[0] < -0.1 * fluid.particles.mass * fluid.particles.n
    impulse, work = fluid.impulse, fluid.work
    scale = np.abs(momentum).max()
    np.testing.assert_allclose(impulse["obstacles"] + impulse["walls"], momentum, atol=1e-12 * scale)
    assert impulse["obstacles"][0] < 0.5 * momentum[0]
    assert work["obstacles"] == pytest.approx(impulse["obstacles"] @ SPEED, rel=1e-12)


def unexplained(fluid) -> float:
    """Energy that the water has and no force has given [J], of that which it would have lost or gained else."""
    velocity = fluid.particles.velocity.to_numpy()
    energy = 0.5 * fluid.particles.mass * float((velocity**2).sum()) + fluid.internal_energy()
    return energy - sum(work for term, work in fluid.work.items() if term not in ("pressure", "gravity"))


@pytest.mark.slow
def test_the_work_of_a_plate_is_such_that_axes_do_not_matter(water):
    """The water explains its energy as well from axes in which the plate stands still, and does no work, as from those
    in which it moves, but for half a step of its way: a step takes it where it is at the end, and forces act in the
    middle: of first order from 400 steps on (at 100 the second undoes half of it). Negative control: without that work
    it does not."""
    off = []
    for steps in (100, 400, 1600):
        moving, standing = (swept(water, "delta_sph", "no_slip", drift, steps) for drift in (None, SPEED))
        start = 0.5 * standing.particles.mass * standing.particles.n * SPEED @ SPEED
        scale = moving.work["obstacles"]
        assert standing.work["obstacles"] == pytest.approx(0.0, abs=1e-9 * scale)
        off.append(abs(unexplained(moving) - unexplained(standing) + start) / scale)
    assert max(off) < 0.03 and off[2] < 0.6 * off[1]
    assert abs(unexplained(moving) + scale - unexplained(standing) + start) > 0.5 * scale


def held(water, thick: float, motion: dict | None, until: float, at: float = 0.0):
    """Water 0.5 m long and 0.5 m deep behind a gate so many spacings thick, which stands at x = 0 or farther away [m],
    after so long [s]."""
    gate = {"min": [at, -0.5], "max": [at + thick * 0.05, 0.2]}
    basin = {"width": None, "obstacles": [] if motion is None else [gate | {"motion": motion}]}
    keys = {"spacing": 0.05, "kinematic_viscosity": 1e-3}
    fluid = water("delta_sph", basin=basin, fill=[{"min": [-0.5, -0.5], "max": [0.0, 0.0]}], **keys)
    step_to(fluid, until)
    return fluid


def stays_and_presses(fluid, thick: float, off: float, stir: float) -> None:
    """Nothing has leaked into the air behind the gate, which bears what a wall does."""
    x = fluid.particles.position.to_numpy()
    assert len(x) == 100 and (x[:, 0] < 0.0).all()
    points = np.array([[0.0, -0.25, 0.0], [0.0, -0.4, 0.0]])
    np.testing.assert_allclose(fluid.pressures(points), -1000.0 * GRAVITY * points[:, 1], rtol=off)
    assert fluid.pressures(points + [thick * 0.05 + 0.1, 0.0, 0.0]).max() == 0.0
    assert fluid.status.max_speed < stir * np.sqrt(GRAVITY * 0.5)
    force = fluid.boundary.forces()[0][0, 0]
    assert force == pytest.approx(0.5 * 1000.0 * GRAVITY * 0.5**2, rel=0.5 * off + 0.01)


START, END = 2.01, 2.26  # [s] of the lift of the gate below


@pytest.fixture(scope="module")
def closed(water):
    """Water behind a gate of two spacings that has been closed for 2 s, and is lifted soon after for 0.25 s."""
    motion = {"velocity": [0.0, 1.0, 0.0], "acceleration": [0.0, 2.0, 0.0], "start": START, "end": END}
    return held(water, 2.0, motion, 2.0)


def test_water_behind_a_closed_gate_stays_and_presses_as_deep_water_does(closed):
    """Over air, for 2 s: nothing leaks, and a gate of two spacings bears what a wall does. Water next to samples of a
    body stirs at 0.01 to 0.03 sqrt(g h) for as long as was tried, 10 s."""
    stays_and_presses(closed, 2.0, 0.03, 0.03)


@pytest.mark.slow
def test_a_gate_of_one_spacing_holds_it_too_but_the_water_before_it_stirs(water):
    stays_and_presses(held(water, 1.0, {}, 2.0), 1.0, 0.15, 0.08)


def test_it_runs_out_below_a_gate_that_is_lifted_and_freely_once_that_has_left(closed):
    """Half open the gate lets water through at its foot and nowhere else; its samples go with it on its way, t + t^2,
    and at its end none is in any cell and feels anything. Negative control of the closed gate: then water leaves."""
    with undone(closed) as fluid:
        body, middle, times, seen = fluid.boundary, np.array([0.05, -0.15, 0.0]), [], []
        while fluid.time < START + 0.17:
            fluid.advance(0.001)
            times.append(fluid.time - START)
            seen.append(body.motion[0, MOTION_COLUMNS.position : MOTION_COLUMNS.position + 3] - middle)
        t, seen = np.maximum(times, 0.0), np.array(seen)
        np.testing.assert_allclose(seen, np.stack([0.0 * t, t + t * t, 0.0 * t], axis=1), atol=1e-12)
        assert 0.19 < seen[-1, 1] < 0.21 and body.speed == pytest.approx(1.0 + 2.0 * t[-1])
        x = fluid.particles.position.to_numpy()
        through = x[:, 0] > 0.1
        assert through.any() and x[through, 1].max() < -0.25 and (x[:, 0] < 0.0).any()
        assert not distance_outside(x, fluid.grid.basin, fluid.time, 0.05).any()
        assert body.start.to_numpy()[-1] == body.n and body.forces()[0].any()
        while fluid.time < END:
            fluid.advance(0.001)
        assert body.speed == 0.0 and body.start.to_numpy()[-1] == 0 and not body.forces()[0].any()
        before = body.impulses()
        step_to(fluid, END + 0.3)
        np.testing.assert_array_equal(body.impulses(), before)
        assert before[0, 1] != 0.0
        assert (fluid.particles.position.to_numpy()[:, 0] > 0.1).mean() > 0.3


@pytest.mark.slow
def test_a_gate_that_has_left_is_as_none(water):
    """One that stood in the air and leaves with the first step: the water moves as in a basin without it."""
    with_it = held(water, 2.0, {"end": 1e-9}, 0.0, at=0.2)
    without = held(water, 2.0, None, 0.0)
    for _ in range(200):
        with_it.advance(0.0015)
        without.advance(0.0015)
    here, there = (by_id(f, f.particles.position.to_numpy()) for f in (with_it, without))
    assert there[:, 0].max() > 0.1
    np.testing.assert_allclose(here, there, atol=1e-9)


def test_particles_without_interaction_bounce_from_a_moving_box(water):
    """A wall that comes at 2 m/s sends what rests away at 2 (1 + e) m/s."""
    basin = FREE | {"restitution": 0.5, "obstacles": [PLATE | {"motion": {"velocity": [-2.0, 0.0, 0.0]}}]}
    fluid = water("ballistic", basin=basin, spacing=0.1, fill=[{"min": [-0.2, -0.3], "max": [-0.1, -0.2]}])
    for _ in range(10):
        fluid.advance(0.01)
    assert fluid.particles.velocity.to_numpy()[0, 0] == pytest.approx(-3.0, rel=1e-6)


def test_the_way_of_a_gate_may_be_a_table(tmp_path):
    t = np.linspace(0.0, 0.4, 9)
    (tmp_path / "gate.csv").write_text("time_s,y_m\n" + "".join(f"{a},{2.0 * a**3}\n" for a in t))
    gate = Gate(file=str(tmp_path / "gate.csv"), start=0.1, end=0.6)
    for time in (0.05, 0.2, 0.33, 0.55):
        moved, s = gate.at(time), np.clip(time - 0.1, 0.0, 0.4)
        np.testing.assert_allclose(moved.way, [0.0, 2.0 * s**3, 0.0], atol=1e-12)
        np.testing.assert_allclose(moved.velocity, [0.0, 6.0 * s**2 * (0.0 < s < 0.4), 0.0], atol=1e-12)
    assert gate.at(0.6) is None
    assert gate.fastest(0.5) == pytest.approx(0.96, rel=0.01)


STANDING = {"min": [0.1, -0.5], "max": [0.2, 0.1]}


@pytest.mark.parametrize(
    ("motion", "sentence"),
    [
        ({"velocity": [0.0, 1.0, 0.0], "start": 0.5, "end": 0.4}, "before it starts to move"),
        ({"velocity": [1.0, 0.0, 0.0]}, "reaches out of the basin along x at 0.30"),
        ({"velocity": [-1.0, 0.0, 0.0]}, "crosses obstacles.0 at 0.2"),
        ({"velocity": [0.0, -1.0, 0.0]}, "reaches out of the basin along y"),
        ({"velocity": [0.0, 0.0, 1.0], "end": 0.1}, "no motion along z"),
        ({"velocity": [0.0, 1.0, 0.0], "file": "gate.csv"}, "either the file of its way, or velocity"),
        ({"file": "no such gate.csv"}, "there is no such file"),
        ({"start": -1.0}, "is not at least 0"),
        ({"speed": 1.0}, "unknown key"),
    ],
)
def test_gates_that_cannot_be_are_said(motion, sentence):
    boxes = [{"min": [-0.3, -0.5], "max": [-0.1, 0.1]}, STANDING | {"motion": motion}]
    scene = {"basin": {"length": 1.0, "depth": 0.5, "obstacles": boxes}, "duration": 1.0}
    with pytest.raises(SceneError, match=sentence):
        load(scene | {"fluid": {"kind": "mueller", "spacing": 0.1}})


def scene(**motion) -> dict:
    """A dam of 2000 particles that a gate frees."""
    gate = {"min": [-0.2, -0.5], "max": [-0.16, 0.1], "motion": {"velocity": [0.0, 2.0, 0.0], "end": 0.3} | motion}
    fill = [{"min": [-0.5, -0.5], "max": [-0.2, 0.0]}]
    basin = {"length": 1.0, "depth": 0.5, "obstacles": [gate]}
    fluid = {"kind": "delta_sph", "spacing": 0.02 / 2**0.5, "fill": fill}
    return QUIET | {"basin": basin, "fluid": fluid, "duration": 0.03, "accuracy": {"every": 0.01}}


def test_check_says_when_a_gate_is_gone_and_that_one_is_too_thin():
    known = load(scene()).preflight
    assert "obstacles.0 moves from 0 s on, at up to 2 m/s, and has left at 0.3 s" in known.fluid.statements(known)
    assert not [w for w in load(scene()).warnings() if "thin" in w]
    thin = load(scene(), {"fluid.spacing": 0.04})
    assert [w for w in thin.warnings() if w.startswith("obstacles.0 is 1 spacings thin")]
    assert [w for w in load(scene(velocity=[0.0, 9.0, 0.0])).warnings() if "faster than the reference speed" in w]


def test_check_answers_for_a_scene_with_a_gate(tmp_path, capsys):
    (tmp_path / "gate.yaml").write_text(json.dumps(scene()))
    assert run_command_line(["check", str(tmp_path / "gate.yaml"), "--ledger"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "samples of solid bodies" in said and "has left at 0.3 s" in said


def kept(folder: Path, threads: int) -> dict[str, bytes]:
    """What a run with a gate leaves, by name, with so many threads, from its dump."""
    folder.mkdir()
    made = load(scene() | {"frames": {"every": 0.01}})
    with Simulation(load(made.resolved(), {"runtime.threads": threads}), folder) as simulation:
        simulation.run(made.duration)
    files = [path for path in folder.rglob("*") if path.is_file() and path.name != "manifest.json"]
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def test_a_run_shows_its_gate_in_accounts_and_frames(tmp_path):
    table = kept(tmp_path / "run", 1)["accuracy.csv"]
    assert b"work_obstacles_J" in table and b"impulse_obstacles_y_Ns" in table
    frame = np.load(tmp_path / "run" / "frames" / "frame_00002.npz")
    np.testing.assert_allclose(frame["gates"][0, :, 1], 2.0 * frame["time"] + [-0.5, 0.1], rtol=1e-6)
    assert len(np.load(tmp_path / "run" / "frames" / "grid.npz")["obstacles"]) == 0
    assert (
        load(
            {
                "basin": {"length": 1.0, "depth": 0.5, "obstacles": [STANDING]},
                "fluid": {"kind": "mueller", "spacing": 0.1},
            }
        ).resolved()["basin"]["obstacles"][0]["motion"]
        is None
    )


@pytest.mark.slow
def test_a_run_with_a_gate_reloads_to_the_same_bytes_on_two_threads(tmp_path):
    assert kept(tmp_path / "1", 1) == kept(tmp_path / "2", 2)


def test_an_obstacle_may_have_a_velocity_and_an_end_of_its_own():
    basin = {"length": 2.0, "depth": 1.0, "obstacles": [PLATE | {"velocity": [0.0, 1.5, 0.0], "until": 0.5}]}
    scene = {"basin": basin, "fluid": {"kind": "delta_sph", "spacing": 0.1}} | QUIET
    obstacle = load(scene).basin.obstacles[0]
    assert obstacle.gate == Gate(velocity=(0.0, 1.5, 0.0), end=0.5)
    both = PLATE | {"velocity": [0.0, 1.5, 0.0], "motion": {"end": 0.5}}
    with pytest.raises(SceneError, match="give either motion, or velocity"):
        load(scene | {"basin": basin | {"obstacles": [both]}})


def plates(*obstacles: dict) -> dict:
    """Plates 0.1 m thick in a slice, by their left sides [m]."""
    at = [
        {"min": [o["x"], -0.3], "max": [o["x"] + 0.1, 0.2]} | {k: v for k, v in o.items() if k != "x"}
        for o in obstacles
    ]
    basin = {"length": 2.0, "depth": 0.5, "obstacles": at}
    return {"duration": 0.5, "basin": basin, "fluid": {"kind": "delta_sph", "spacing": 0.05}}


RIGHT, LEFT = {"velocity": [1.0, 0.0, 0.0]}, {"velocity": [-1.0, 0.0, 0.0]}


@pytest.mark.parametrize("way", [lambda keys: keys, lambda keys: {"motion": keys}])
def test_plates_may_go_side_by_side_and_where_one_has_left(way):
    load(plates({"x": -0.6} | way(RIGHT), {"x": -0.3} | way(RIGHT)))
    load(plates({"x": -0.6} | RIGHT, {"x": -0.3, "until": 0.15}))
    load(plates({"x": -0.6} | RIGHT, {"x": -0.3, "motion": {"end": 0.15}}))


@pytest.mark.parametrize(("one", "other"), [(RIGHT, LEFT), ({"motion": RIGHT}, LEFT), (RIGHT, {"motion": LEFT})])
def test_plates_that_run_into_each_other_are_refused_with_the_time(one, other):
    """0.8 m apart, at 1 m/s each: at 0.4 s."""
    with pytest.raises(SceneError, match=r"its path crosses obstacles\.0 at 0.4 s"):
        load(plates({"x": -0.6} | one, {"x": 0.3} | other))


def test_a_path_through_a_thin_plate_is_seen_between_two_looks():
    """In 100 s the plate is looked at every 0.25 s, in which it goes 2.5 mm; the other is 0.2 mm thin."""
    made = plates({"x": -0.6, "velocity": [0.01, 0.0, 0.0]}) | {"duration": 100.0}
    made["basin"]["obstacles"].append({"min": [0.1, -0.3], "max": [0.1002, 0.2]})
    with pytest.raises(SceneError, match=r"its path crosses obstacles\.1 at 60 s"):
        load(made)


def test_check_says_that_a_fixed_obstacle_is_too_thin():
    assert [
        w for w in load(plates({"x": 0.0}), {"fluid.spacing": 0.08}).warnings() if "obstacles.0 is 1.2 spacings" in w
    ]
    assert not [w for w in load(plates({"x": 0.0})).warnings() if "thin" in w]
