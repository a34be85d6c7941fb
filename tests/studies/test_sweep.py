"""A sweep: the runs that a plan means, what is wrong with a plan, and what becomes of a run whose process dies."""

import csv
import json
import os
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Thread
from types import SimpleNamespace

import pytest

from ocean_sim.__main__ import run_command_line
from ocean_sim.files.yaml_file import SceneError, parse_mapping
from ocean_sim.parts import PACKAGE
from ocean_sim.studies.shared import study
from ocean_sim.studies.sweep import read_plan
from tests.processes import wait_for, wait_for_end

SEA = """basin: {length: 40.0, width: 40.0, depth: 7.5}
fluid: {kind: linear_waves, height: 0.5, period: 4.0}
duration: 0.4
gauges: {every: 0.02, elevation: {centre: [0.0, 0.0]}}
runtime: {threads: 1}
"""
PLAN = """scene: sea.yaml
set: {duration: 0.5}
list: [{fluid.height: 0.5}, {fluid.height: 0.6, fluid.period: 5.0}]
grid:
  fluid.heading_deg: [0.0, 45.0]
  duration: [0.3, 0.4]
seeds: [1, 2]
"""
TASK = '''"""A run that writes what its order holds, waits where that asks for it, or fails."""
import os, sys, time
def answer(order, folder):
    (folder / "begun.tmp").write_text(str(os.getpid()))
    (folder / "begun.tmp").rename(folder / "begun")
    if order.get("wait"):
        time.sleep(order["wait"])
    if order.get("fall"):
        sys.exit(order["fall"])
    return {"outcome": "done", "number": order["number"]}
'''


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("sea.yaml").write_text(SEA)
    Path("plan.yaml").write_text(PLAN)
    Path("a_task.py").write_text(TASK)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    return tmp_path


def orders(count: int, **more) -> list[dict]:
    return [{"task": "a_task", "number": k} | more for k in range(count)]


def wrong(text: str) -> list[str]:
    Path("plan.yaml").write_text(text)
    with pytest.raises(SceneError) as error:
        read_plan(Path("plan.yaml"))
    return [str(problem) for problem in error.value.problems]


def test_a_plan_means_every_combination_in_its_own_order():
    runs = read_plan(Path("plan.yaml"))
    assert len(runs) == 16
    assert [run.settings["seed"] for run in runs[:2]] == [1, 2]
    assert {run.scene.duration for run in runs} == {0.3, 0.4}  # the grid stands further down than `set`
    assert [run.scene.fluid.height for run in runs] == 8 * [0.5] + 8 * [0.6]
    assert all(run.scene.seed == run.settings["seed"] and "render" not in run.scene.observers for run in runs)


def test_equal_scenes_have_one_address_and_others_another():
    first, *_, last = read_plan(Path("plan.yaml"), threads=1)
    other = read_plan(Path("plan.yaml"), threads=2)[0]
    assert study.run_address(first.order) == study.run_address(other.order)
    assert study.run_address(first.order) != study.run_address(last.order)


NAMED = {  # by what names a file: the scene around its name, and two contents of it
    "controls": ("ship: {kind: otter, controls: {file: f}}", "time_s,throttle,rudder_rad\n0,0.%d,0\n9,0,0\n"),
    "components": (
        "fluid: {kind: spectral_sea, cells: 32, components: f}",
        "amplitude_m,period_s,heading_deg,phase_deg\n0.%d1,4,0,0\n",
    ),
    "schedule": ("wind: {kind: stress, schedule: {file: f}}", "time_s,speed_m_s,heading_deg\n0,%d,0\n9,5,0\n"),
    "hull": ("ship: {kind: hydrostatic, hull: {shape: {kind: mesh, file: f.stl}, mass: 10}}", "%d"),
    "motion": ("basin: {motion: {file: f}}", "time_s,x_m\n0,0\n1,0.%d\n2,0\n3,0\n"),
    "gate": (
        "basin: {obstacles: [{min: [0, -1], max: [0.2, 0], motion: {file: f}}]}",
        "time_s,x_m\n0,0\n1,0.%d\n2,0\n3,0\n",
    ),
    "initial": ("fluid: {initial: {kind: file, path: f}}", "x,y,u,v\n0.1,-0.1,0,%d\n"),
    "radiation": (
        "ship: {kind: dynamic, hull: yacht, radiation: f}",
        "omega_rad_s,heave_added_kg,heave_damping_kg_s\n"
        + "".join(f"{0.2 * k},%d00,{(40 - k) ** 2}\n" for k in range(1, 41)),
    ),
}


@pytest.mark.parametrize("key", NAMED)
def test_every_file_that_a_scene_names_is_part_of_an_address(key, tmp_path):
    """One that has another content is another run; the same content, copied elsewhere in time, is not."""
    import trimesh

    written, text = NAMED[key]
    flat = key in ("motion", "gate", "initial")
    base = {
        "basin": {"length": 2.0, "depth": 1.0} if flat else {"length": 40.0, "width": 40.0, "depth": 7.5},
        "fluid": {"kind": "delta_sph", "spacing": 0.1} if flat else {"kind": "linear_waves"},
        "duration": 0.4,
    }
    if not flat:
        base["basin"]["walls"] = "periodic" if key == "components" else "none"
        base["fluid"] |= {} if key == "components" else {"height": 0.1, "period": 4.0}
    for name, part in parse_mapping(written, key).plain().items():
        base[name] = base.get(name, {}) | part
    Path("one.yaml").write_text(json.dumps(base))
    Path("plan.yaml").write_text("scene: one.yaml\nseeds: [1]\n")

    def address(size: int) -> str:
        if key == "hull":
            trimesh.creation.box([1.0 + size, 1.0, 3.0]).export("f.stl")
        else:
            Path("f").write_text(text.replace("%d", str(size)))
        [run] = read_plan(Path("plan.yaml"))
        assert list(run.order["inputs"]) == [str(tmp_path / ("f.stl" if key == "hull" else "f"))]
        return study.run_address(run.order)

    first = address(1)
    assert address(2) != first and address(1) == first


def test_a_key_that_signs_packets_is_no_input_and_is_in_no_manifest():
    Path("key").write_text("secret of thirty-two characters!")
    ship = "ship: otter\nplatform: {kind: hexapod, geometry: hexapod_a, washout: ship}\nstream: {key: key}\n"
    Path("sea.yaml").write_text(SEA + ship)
    Path("plan.yaml").write_text("scene: sea.yaml\nseeds: [1]\n")
    assert read_plan(Path("plan.yaml"))[0].order["inputs"] == {}


def test_a_second_sweep_runs_again_what_names_a_file_that_has_changed(capsys):
    """And a run that begins when its file is another than planned is none: it is a failure that is tried again."""
    controls = "time_s,throttle,rudder_rad\n0,%s,0\n10,%s,0\n"
    ship = "ship: {kind: otter, controls: {file: c.csv}}\nmotion: {every: 0.05}\n"
    Path("sea.yaml").write_text(SEA.replace("}\nduration", "}\nhealth: null\nduration") + ship)
    Path("plan.yaml").write_text("scene: sea.yaml\nseeds: [1]\n")
    surges = []
    for throttle in ("1.0", "-1.0"):
        Path("c.csv").write_text(controls % (throttle, throttle))
        assert run_command_line(["sweep", "plan.yaml", "--out", "out", "--workers", "1", "--json"]) == 0
        surges.append(json.loads(capsys.readouterr().out)[0]["surge_rms_m"])
    assert surges[0] != surges[1]
    order = read_plan(Path("plan.yaml"), 1)[0].order
    Path("c.csv").write_text(controls % ("0.5", "0.5"))
    [(_, answer)] = study.run_answers([order], Path("late"), 1)
    assert answer["outcome"] == "failed"
    assert answer["reason"] == "a file that the scene names has changed since this run was planned"
    assert not any(Path("late").rglob("answer.json"))


def test_a_scene_is_looked_for_next_to_the_plan():
    Path("plans").mkdir()
    Path("plans/sea.yaml").write_text(SEA.replace("0.4\ngauges", "0.3\ngauges"))
    Path("sea.yaml").write_text(SEA)
    Path("plans/plan.yaml").write_text("scene: sea.yaml\n")
    assert read_plan(Path("plans/plan.yaml"))[0].scene.duration == 0.3
    Path("plans/sea.yaml").unlink()
    assert read_plan(Path("plans/plan.yaml"))[0].scene.duration == 0.4
    Path("sea.yaml").unlink()
    with pytest.raises(SceneError, match="looked for next to the plan and in /"):
        read_plan(Path("plans/plan.yaml"))


def test_a_plan_that_is_wrong_says_where():
    assert wrong("scene: sea.yaml\ngird: {seed: [1]}\n") == ["plan.yaml:2:1: gird: unknown key; did you mean 'grid'?"]
    assert wrong("set: {seed: 1}\n") == ["plan.yaml:1:1: scene: missing key"]
    assert wrong("scene: sea.yaml\ngrid: {seed: []}\n") == ["plan.yaml:2:14: grid.seed: this list is empty"]
    assert wrong("scene: sea.yaml\ngrid:\n  seed: 3\n") == [
        "plan.yaml:3:9: grid.seed: expected a list, got 3, as in [..., ...]"
    ]
    found = wrong("scene: sea.yaml\ngrid:\n  fluid.height: [0.5, -1.0, high]\n  fluid.hight: [1.0]\n")
    assert [line.split(": ")[0] for line in found] == ["plan.yaml:3:23", "plan.yaml:3:29", "plan.yaml:4:17"]
    assert "did you mean 'height'" in found[2]
    assert wrong("scene: see.yaml\n")[0].startswith("plan.yaml:1:8: scene: see.yaml: there is no such file or scene")
    assert wrong("scene: sea.yaml\nprofile: cii\n")[0].startswith("plan.yaml:2:10: profile: no profile 'cii'")
    assert "10000 are the most" in wrong(f"scene: sea.yaml\nseeds: {list(range(10001))}\n")[0]
    Path("sea.yaml").write_text(SEA.replace("depth: 7.5", "depth: -7.5"))
    assert wrong(PLAN)[0].startswith("sea.yaml:1:43: basin.depth")


def test_a_wrong_plan_is_exit_code_2_and_leaves_nothing(capsys):
    Path("plan.yaml").write_text("scene: sea.yaml\nseeds: []\n")
    assert run_command_line(["sweep", "plan.yaml"]) == 2
    assert "plan.yaml:2:8: seeds: this list is empty" in capsys.readouterr().err
    assert not Path("runs").exists()


@pytest.mark.slow
def test_a_killed_worker_is_a_failure_and_the_others_go_on():
    def kill_the_second() -> None:
        wait_for("the second run", (begun / "begun").exists)
        for child in list(study._running):
            if Path(child.args[-1]) == begun.resolve():
                os.kill(child.pid, signal.SIGKILL)

    asked = orders(4, wait=1.5)
    begun = Path("out") / study.run_address(asked[1])
    Thread(target=kill_the_second).start()
    found = dict(study.run_answers(asked, Path("out"), workers=2))
    assert [found[k]["outcome"] for k in range(4)] == ["done", "failed", "done", "done"]
    assert "SIGKILL" in found[1]["reason"]
    kept = {k: os.stat(Path("out") / study.run_address(asked[k]) / "answer.json").st_mtime_ns for k in (0, 2, 3)}
    again = dict(study.run_answers(asked, Path("out"), workers=2))  # the same call repeats the failed one alone
    assert [again[k]["outcome"] for k in range(4)] == 4 * ["done"]
    for k, when in kept.items():
        assert os.stat(Path("out") / study.run_address(asked[k]) / "answer.json").st_mtime_ns == when


def test_a_run_that_falls_or_takes_too_long_says_so():
    ((_, fallen),) = study.run_answers(orders(1, fall="no space left"), Path("out"), workers=1)
    assert (fallen["outcome"], fallen["reason"]) == ("failed", "no space left")
    ((_, slow),) = study.run_answers(orders(1, wait=60.0), Path("out"), workers=1, limit=1.0)
    assert slow["outcome"] == "failed" and "1 s of wall time" in slow["reason"]


def test_equal_orders_are_run_once_and_torn_answers_again():
    asked = [*orders(1), *orders(1)]
    place = Path("out") / study.run_address(asked[0])
    place.mkdir(parents=True)
    (place / "answer.json").write_text('{"outcome": "do')
    found = sorted(study.run_answers(asked, Path("out"), workers=2))
    assert [k for k, _ in found] == [0, 1] and found[0][1] == found[1][1] == {"outcome": "done", "number": 0}
    assert len(list(Path("out").iterdir())) == 1


def test_a_cluster_gets_the_orders_that_are_left(monkeypatch):
    asked_for = []

    class Client:
        def __init__(self, address, timeout):
            if address == "tcp://nowhere:1":
                raise OSError("timed out")
            asked_for.append(address)

        def __enter__(self):
            return self

        def __exit__(self, *exception):
            pass

        def get_executor(self, pure):
            return ThreadPoolExecutor(2)

    monkeypatch.setitem(sys.modules, "distributed", SimpleNamespace(Client=Client, LocalCluster=None))
    found = dict(study.run_answers(orders(2), Path("out"), 1, "tcp://there:8786"))
    assert asked_for == ["tcp://there:8786"] and [found[k]["number"] for k in (0, 1)] == [0, 1]
    with pytest.raises(study.Lacking, match="no Dask scheduler answers at tcp://nowhere:1"):
        list(study.run_answers(orders(3), Path("out"), 1, "tcp://nowhere:1"))
    assert len(list(study.run_answers(orders(2), Path("out"), 1, "tcp://nowhere:1"))) == 2  # nothing is left to be run


def test_two_workers_of_a_real_cluster_one_of_which_is_killed():
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        pid = next(iter(cluster.workers.values())).pid
        asked = orders(4, wait=2.0)

        def kill() -> None:
            wait_for("the first run", lambda: list(Path("out").glob("*/begun")))
            os.kill(pid, signal.SIGKILL)

        Thread(target=kill).start()
        found = dict(study.run_answers(asked, Path("out"), 2, cluster.scheduler_address))
    assert [found[k]["outcome"] for k in range(4)] == 4 * ["done"]


@pytest.mark.parametrize("sign", [signal.SIGTERM, signal.SIGINT, signal.SIGKILL])
def test_no_run_outlives_the_study(sign, tmp_path):
    script = f"""
from pathlib import Path
from ocean_sim.studies.shared import study
list(study.run_answers({orders(5, wait=60.0)!r}, Path("out"), workers=2))
"""
    path = os.pathsep.join([str(PACKAGE.parent), str(tmp_path)])
    study = subprocess.Popen([sys.executable, "-c", script], env=os.environ | {"PYTHONPATH": path}, stderr=-1)
    wait_for("two runs", lambda: len(list(Path("out").glob("*/begun"))) == 2 or study.poll() is not None)
    pids = list(Path("out").glob("*/begun"))
    study.send_signal(sign)
    study.communicate(timeout=300)
    assert study.returncode != 0 and len(pids) == 2
    wait_for_end(*(int(path.read_text()) for path in pids))
    assert len(list(Path("out").glob("*/begun"))) == 2  # none was begun after


def test_another_package_has_other_answers(monkeypatch):
    (order,) = orders(1)
    before = study.run_address(order)
    monkeypatch.setattr(study, "program_hash", lambda: "edited")
    assert study.run_address(order) != before


def test_a_sweep_leaves_a_table_whose_failures_are_rows(capsys):
    plan = "scene: sea.yaml\ngrid: {fluid.height: [0.5, 1.0]}\n"
    Path("plan.yaml").write_text(plan)
    assert run_command_line(["sweep", "plan.yaml", "--workers", "2", "--out", "out", "--json"]) == 0
    shown = json.loads(capsys.readouterr().out)
    rows = list(csv.DictReader(Path("out/results.csv").open()))
    assert [row["fluid.height"] for row in rows] == ["0.5", "1.0"] and [row["outcome"] for row in rows] == 2 * ["done"]
    assert [row["run"] for row in shown] == [row["run"] for row in rows]
    assert float(rows[1]["centre_hm0_m"]) == pytest.approx(2.0 * float(rows[0]["centre_hm0_m"]), rel=1e-4)
    assert (Path("out") / rows[0]["run"] / "manifest.json").exists()
    before = Path("out/results.csv").read_bytes()
    assert run_command_line(["sweep", "plan.yaml", "--out", "out"]) == 0
    assert "2 of 2 runs done" in capsys.readouterr().out and Path("out/results.csv").read_bytes() == before


def test_a_cluster_needs_its_package(capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert run_command_line(["sweep", "plan.yaml", "--scheduler", "tcp://127.0.0.1:1"]) == 3
    assert "pip install distributed" in capsys.readouterr().err
