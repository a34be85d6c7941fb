"""The ghost of a ship that a predictive washout looks ahead by, and what moves the platform while it is late."""

from concurrent.futures import Future
from types import SimpleNamespace

import numpy as np
import pytest

from ocean_sim.conventions import Failed
from ocean_sim.files import csv_file
from ocean_sim.observers.platform_log import PlatformLog
from ocean_sim.observers.shared.csv_rows import TakesCommands
from ocean_sim.observers.shared.planner import Planner, plan_for
from ocean_sim.platform import LATE_PLAN
from ocean_sim.platform.hexapod import Config
from ocean_sim.platform.shared.motion_log import read_log
from ocean_sim.platform.washout.predictive import Predictive
from ocean_sim.reading.scene import load
from ocean_sim.result import run as run_scene
from ocean_sim.simulation import NO_FOLDER, Simulation
from ocean_sim.state.snapshot import Snapshot
from ocean_sim.verbs.resume import continue_run, newest_checkpoint
from ocean_sim.verbs.shared.progress import Progress
from ocean_sim.viewer.session import Session
from tests.platform.test_best_ride import DT, predictive, waves
from tests.viewer.test_session import RIG, Desk, Source

pytest.importorskip("clarabel")
SHORT = ("horizon=1.2", "period=0.4")
PLAN = {"kind": "predictive", "horizon": 1.2, "period": 0.4}
PLAN |= {"force_scale": [0.5, 0.5, 0.5], "rotation_scale": [1.0, 1.0, 0.6]}
SCENE = {
    "duration": 2.0,
    "basin": {"length": 400.0, "width": 400.0, "depth": 50.0, "walls": "none"},
    "fluid": {"kind": "linear_waves", "height": 1.5, "period": 4.0, "heading_deg": 150.0, "ramp": 0.5},
    "ship": {
        "kind": "yacht",
        "cells_per_draught": 3.0,
        "velocity": [0.0, 0.0, 4.0],
        "controls": [{"time": 0.0, "throttle": 0.8}, {"time": 1.0, "throttle": 0.8, "rudder": 0.3}],
    },
    "platform": {"kind": "hexapod", "washout": PLAN},
    "motion": {"every": DT},
    "runtime": {"threads": 1},
    **dict.fromkeys(("frames", "render", "report", "accuracy")),
}


@pytest.mark.parametrize("person", [False, True])
def test_the_ghost_moves_as_the_ship_will_while_the_helm_is_held(person, tmp_path, monkeypatch):
    """A script goes on, and a person's orders are held. In its first step a log does not know the step before."""
    monkeypatch.setattr(Predictive, "foresee", lambda self, ride, question: ride)
    scene = load(SCENE | {"platform_log": None})
    for folder in ("ship", "ghost"):
        (tmp_path / folder).mkdir()
    with Simulation(scene, tmp_path / "ship") as ship, Simulation(scene) as other:
        other.conclude()
        ship.run(0.5)
        if person:
            ship.ship.hand_over().give(0.5, -0.4)
        state = Snapshot({"simulation": ship}, NO_FOLDER)
        ship.run(2.0)
        order = (0, 1.6, DT, (), state.tree, state.arrays)
        ahead = plan_for(order, other, scene.platform.build(DT).washout, tmp_path / "ghost")
    true = read_log(tmp_path / "ship" / "motion.csv").ride
    assert 0.5 <= ahead.time[0] <= 0.6
    ahead = ahead.rows(*np.searchsorted(ahead.time, [0.61, 1.61]))
    rows = np.searchsorted(true.time + 1e-9, ahead.time)
    assert len(rows) == 50
    for name in ("time", "specific_force", "rate", "attitude"):
        np.testing.assert_allclose(getattr(ahead, name), getattr(true, name)[rows], atol=2e-8)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Folder of a run whose platform looks ahead by a ghost."""
    folder = tmp_path_factory.mktemp("run")
    run_scene(load(SCENE | {"checkpoint": {"every": 0.5}}), folder)
    return folder


def test_a_run_moves_the_platform_as_its_finished_log_does(run):
    """For as long as the log knows what the ghost knew: up to a horizon and a period before its end. Waves rise over
    0.5 s, since of its first row a ghost knows rates less well (by 5e-4 rad/s without)."""
    table = csv_file.read_columns_if_any(run / "platform.csv")
    found = np.column_stack([table[name] for name in ("x_m", "y_m", "z_m", "roll_rad", "pitch_rad", "yaw_rad")])
    log = read_log(run / "motion.csv")
    wanted = predictive(*SHORT).follow(log.ride).pose
    known = log.ride.time < 0.8
    assert np.abs(found[:, 2]).max() > 0.01 and not table["limited"].any()
    np.testing.assert_allclose(found[known], wanted[known], atol=1e-5)


def test_a_run_that_goes_on_asks_its_ghost_again(run, tmp_path):
    """And gives the bytes of one that was never stopped."""
    config = load(SCENE | {"checkpoint": {"every": 0.5}})
    run_scene(load(SCENE | {"checkpoint": {"every": 0.5}, "duration": 1.3}), tmp_path)
    continue_run(config, newest_checkpoint(tmp_path, config), tmp_path, Progress(2.0, True, 1.3))
    for name in ("motion.csv", "platform.csv"):
        assert (tmp_path / name).read_bytes() == (run / name).read_bytes(), name


def test_a_ghost_is_not_waited_for_in_real_time():
    said, plan = [], (np.zeros(1), np.zeros(1))

    class Rig(TakesCommands):
        paced = True

        def record_event(self, name, **facts):
            said.append((name, facts["what"]))

    ghost = Planner.__new__(Planner)
    ghost.simulation = SimpleNamespace(observers=[Rig()])
    ghost.order, ghost.coming = (3,), Future()
    assert ghost.answer(3, False) is None and ghost.order is not None
    ghost.coming.set_result(plan)
    assert ghost.answer(4, False) is None and ghost.order is None  # which is for a period that is over
    ghost.order, ghost.coming = (5,), Future()
    assert ghost.answer(5, True) is None  # and nothing is said, as the plan before still moves the platform
    ghost.coming.set_result(plan)
    assert ghost.answer(5, True) is plan
    assert [what for _, what in said] == [
        f"plan {number} came too late: the classical washout moves the platform" for number in (3, 4)
    ]


class Prophet:
    """A planner that knows the ride, or guesses it (None), but has no plan for some periods."""

    def __init__(self, ride, without, *sets):
        self.ride, self.without, self.planner, self.order = ride, without, predictive(*SHORT, *sets).washout, None

    def ask(self, number, until, every, question):
        self.order = question

    def answer(self, number, dispensable):
        return None if number in self.without else self.planner.foresee(self.ride, self.order)


def test_the_classical_washout_moves_the_platform_where_the_last_plan_stops():
    """A late plan leaves the one before in force for as long as that does not stop."""
    ride = waves(8.0, 2.0)
    whole, machine = predictive(*SHORT).follow(ride), predictive(*SHORT)
    ghost, parts = Prophet(ride, {8, 9}), []
    for k in range(0, len(ride.time), 5):
        parts.append(machine.follow(ride.rows(k, k + 5), ghost))
    pose = np.vstack([part.pose for part in parts])
    late = np.concatenate([part.limited for part in parts]) & LATE_PLAN > 0
    assert ride.time[late][0] == pytest.approx(3.6) and ride.time[late][-1] == pytest.approx(4.0 - DT)
    np.testing.assert_allclose(pose[~late & (ride.time < 3.2)], whole.pose[~late & (ride.time < 3.2)], atol=1e-9)
    asked = np.vstack([part.cue.pose for part in parts])
    safe = Config().build(DT).washout.follow(ride).pose
    np.testing.assert_allclose(asked[late], safe[late], atol=1e-12)
    jolt = np.abs(np.diff(pose[:, 2], n=2)).max() / DT**2
    assert jolt < 1.1 * max(np.abs(np.diff(whole.pose[:, 2], n=2)).max() / DT**2, 3.0)  # [m/s2]
    legs = machine.hexapod.legs(pose)
    assert machine.hexapod.low - 1e-9 < legs.min() and legs.max() < machine.hexapod.high + 1e-9
    assert machine.on_plan and not parts[-1].limited.any()  # the plans have it again
    np.testing.assert_allclose(pose[-5:], asked[-5:], atol=1e-9)


@pytest.mark.parametrize("preview", ["linear", "hold"])
def test_what_lies_ahead_may_be_guessed(preview, tmp_path):
    """Of the past alone, in a run and in its finished log, whose rows come in any parts: with the same poses."""
    guess = {"preview": preview, "horizon": 1.2, "period": 0.4}
    run_scene(load(SCENE | {"platform": {"kind": "hexapod", "washout": PLAN | guess}}), tmp_path)
    ride, sets = read_log(tmp_path / "motion.csv").ride, (*SHORT, f"preview={preview}")
    whole, machine = predictive(*sets).follow(ride), predictive(*sets)
    parts = [machine.follow(ride.rows(k, k + 37)).pose for k in range(0, len(ride.time), 37)]
    assert np.array_equal(np.vstack(parts), whole.pose) and not whole.limited.any()
    table = csv_file.read_columns_if_any(tmp_path / "platform.csv")
    assert np.abs(whole.pose[:, 2]).max() > 0.01
    np.testing.assert_allclose(table["z_m"], whole.pose[:, 2], atol=1e-6)
    other = predictive(*sets).follow(ride.rows(0, 50)).pose
    assert np.array_equal(other, whole.pose[:50])


def test_the_ship_is_not_run_ahead_in_particles():
    with pytest.raises(Failed, match="predictive runs the ship ahead, for which particles are too slow"):
        load("showcase", {"platform": {"kind": "hexapod", "washout": "predictive"}})
    guess = {"kind": "predictive", "preview": "linear", "force_scale": [0.5] * 3, "rotation_scale": [1.0] * 3}
    washout = load("showcase", {"platform": {"kind": "hexapod", "washout": guess}}).resolved()["platform"]["washout"]
    assert (washout["horizon"], washout["period"]) == (3.0, 0.12)


def test_a_page_shows_a_platform_that_looks_ahead(tmp_path):
    """And the ghost's process ends with the page's simulation."""
    plan = "washout: {kind: predictive, horizon: 1.2, period: 0.4, force_scale: [1, 1, 1], rotation_scale: [1, 1, 1]}"
    (tmp_path / "rig.yaml").write_text(RIG.replace("washout: ship", plan))
    source = Source.of(str(tmp_path / "rig.yaml"), None, {"runtime.threads": 1, "runtime.precision": "f64"})
    with Session(source, Desk(), tmp_path, list) as one:
        [ghost] = [each.planner for each in one.simulation.observers if isinstance(each, PlatformLog)]
        while one.simulation.time < 0.3:
            one.step()
        assert one.watch.commands[:6].any() and ghost.child.poll() is None
    assert ghost.child.poll() is not None
