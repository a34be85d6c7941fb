"""The command line: what it answers, in which form, and with which exit code."""

import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from ocean_sim import kernel_library, machine, runtime
from ocean_sim.__main__ import HIDDEN_VERBS, VERBS, describe_error, run_command_line
from ocean_sim.conventions import Diverged
from ocean_sim.reading.scene import observer_names
from ocean_sim.verbs import doctor
from ocean_sim.verbs import render as render_verb
from ocean_sim.verbs.run import run_facts, run_folder, surface_remarks
from ocean_sim.verbs.shared import console
from tests.processes import wait_for

SMALL = """title: A small tank
duration: 0.05
basin: {length: 2.0, width: 2.0, depth: 1.0}
fluid: {kind: mueller, spacing: 0.25}
render: null
frames: null
"""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("small.yaml").write_text(SMALL)
    return tmp_path


def test_a_run_leaves_its_folder_and_says_what_it_was(ask):
    code, out, _ = ask("run", "small.yaml", "--out", "there")
    assert code == 0
    assert "A small tank\nvalid\n" in out and "256 particles in steps of " in out
    assert "256 particles, " in out and "time step limited by" in out
    assert {"manifest.json", "events.jsonl", "accuracy.csv"} <= {path.name for path in Path("there").iterdir()}


def test_a_run_answers_programs(ask):
    code, out, err = ask("run", "small.yaml", "--json", "--until", "0.02", "--set", "health.every=0.01")
    facts = json.loads(out)
    assert (code, err, facts["particles"], facts["folder"]) == (0, "", 256, "runs/small")
    assert 0.02 <= facts["simulated_s"] < 0.03
    assert facts["steps"] > 0 and sum(facts["limited_by"].values()) == pytest.approx(1.0)
    manifest = json.loads(Path("runs/small/manifest.json").read_text())
    assert manifest["scene"]["duration"] == 0.02


def test_a_run_never_writes_over_another_unless_asked(ask):
    with run_folder("sea", None, False) as folder:
        assert folder == Path("runs/sea")
    Path("runs/sea").mkdir(parents=True)
    Path("runs/sea/manifest.json").write_text('{"files": ["film.mp4"]}')
    Path("runs/sea/film.mp4").write_text("old")
    Path("runs/sea/mine.txt").write_text("mine")
    with run_folder("sea", None, False) as folder:
        assert folder == Path("runs/sea-2")
    code, _, err = ask("run", "small.yaml", "--out", "runs/sea")
    assert (code, err) == (2, "--out runs/sea: there is a run here already; name another folder, or add --overwrite\n")
    with run_folder("sea", Path("runs/sea"), True) as folder:
        assert folder == Path("runs/sea")
    assert [path.name for path in Path("runs/sea").iterdir()] == ["mine.txt"]
    assert ask("run", "small.yaml", "--out", "small.yaml")[0] == 2


@pytest.mark.parametrize(
    "words",
    [
        *(["run", "small.yaml"], ["run", "small.yaml", "--overwrite"], ["sweep", "plan.yaml"], ["validate", "couette"]),
        *(["tradeoff"], ["tradeoff", "small.yaml"], ["stability", "small.yaml"], ["platform", "no.csv"]),
    ],
)
def test_a_folder_of_other_things_is_left_alone(ask, words):
    Path("plan.yaml").write_text("scene: small.yaml\nseeds: [1]\n")
    mine = Path("mine")
    mine.mkdir()
    for name in (".profile", "a.txt", "b.csv", "c.txt"):
        (mine / name).write_text(name)
    code, _, err = ask(*words, "--out", "mine")
    sentence = "--out mine: this folder holds other things (.profile, a.txt, b.csv, ...); name a new folder\n"
    assert (code, err) == (2, sentence)
    assert {path.name: path.read_text() for path in mine.iterdir()} == {
        name: name for name in (".profile", "a.txt", "b.csv", "c.txt")
    }


def test_a_run_takes_an_empty_folder_and_what_a_run_left_before_its_manifest(ask):
    left = Path("left")
    left.mkdir()
    with run_folder("sea", left, False) as folder:
        assert folder == left
    for name in ("accuracy.csv", "events.jsonl", ".lock", ".reserve", ".still_1.7.tmp.png"):
        (left / name).write_text("")
    with run_folder("sea", left, False) as folder:
        assert folder == left
    Path("runs/sea").mkdir(parents=True)
    Path("runs/sea/mine.txt").write_text("mine")
    with run_folder("sea", None, False) as folder:
        assert folder == Path("runs/sea-2")


def test_a_wrong_scene_is_exit_code_2_with_every_problem(ask):
    Path("wrong.yaml").write_text(SMALL.replace("spacing: 0.25", "spacng: 0.25, spacing: 0.0"))
    sentences = [
        "wrong.yaml:4:24: fluid.spacng: unknown key; did you mean 'spacing'?",
        "wrong.yaml:4:47: fluid.spacing: 0.0 is not greater than 0 [m]",
    ]
    for verb in ("run", "check"):
        code, out, err = ask(verb, "wrong.yaml")
        assert (code, out, err.splitlines()) == (2, "", sentences)
        code, out, err = ask(verb, "wrong.yaml", "--json")
        answer = json.loads(out)
        assert (code, err, answer["error"], len(answer["problems"])) == (2, "", "the scene has 2 problems", 2)
        assert answer["problems"][0] == {
            "file": "wrong.yaml",
            "line": 4,
            "column": 24,
            "key": "fluid.spacng",
            "message": "unknown key; did you mean 'spacing'?",
            "suggestion": "spacing",
        }
    assert not Path("runs").exists()


def test_settings_and_profiles_that_are_wrong_are_exit_code_2(ask):
    assert ask("run", "small.yaml", "--set", "fluid.spacing")[2].startswith("--set fluid.spacing: expected key=value")
    assert ask("check", "small.yaml", "--set", "fluid.spacing=-1")[0] == 2
    assert ask("check", "small.yaml", "--profile", "nothing")[0] == 2
    assert ask("check", "nothing.yaml")[0] == 2
    assert ask("run", "small.yaml", "--until", "-1")[2] == "--until -1: duration: -1.0 is not greater than 0 [s]\n"


def test_a_wrong_command_line_is_exit_code_2(ask):
    assert ask("chek")[0] == 2
    assert ask("check")[0] == 2
    assert ask("check", "small.yaml", "--nothing")[0] == 2
    code, out, _ = ask("chek", "--json")
    assert code == 2 and "chek" in json.loads(out)["error"]
    assert ask("--help")[0] == 0


def test_what_an_extra_would_bring_is_said_in_a_sentence(monkeypatch, capsys, tmp_path):
    everything = machine.installed_version
    absent = ("vtk", "pyvista")
    monkeypatch.setattr(machine, "installed_version", lambda name: None if name in absent else everything(name))
    sentence = "pyvista and vtk are not installed; `pip install '.[pictures]'` in the checkout brings what is missing"
    assert machine.missing_extra("pictures") == sentence
    missing = ModuleNotFoundError("No module named 'vtkmodules'", name="vtkmodules.util")
    assert describe_error(missing) == (3, sentence, [])
    monkeypatch.setattr(console, "complaints", set())
    drawn: list[str] = []
    assert not console.draw_if_able(drawn.append, "a") and not console.draw_if_able(drawn.append, "b") and not drawn
    assert capsys.readouterr().err == f"no pictures: {sentence}\n"
    monkeypatch.undo()
    assert console.draw_if_able(drawn.append, "c") and drawn == ["c"]


def test_every_verb_has_help(ask):
    for verb in VERBS:
        code, out, _ = ask(verb, "--help")
        assert code == 0 and f"Usage: ocean-sim {verb}" in out


def test_help_groups_the_verbs_and_cuts_no_line(ask):
    out = ask("--help")[1]
    sections = re.findall(r"^(\w+):$", out, re.MULTILINE)
    assert sections == ["Options", "Scenes", "Run", "Look", "Analyse", "Trust", "Maintain"]
    assert "..." not in out.partition("\n")[2] and max(map(len, out.splitlines())) < 80
    assert all(f"{line}\n" in out for verb, line in VERBS.items() if verb not in HIDDEN_VERBS)


def test_a_list_of_verbs_imports_none_of_them():
    script = "import sys; from ocean_sim import __main__ as m; m.run_command_line(['--help']); print(*sys.modules)"
    child = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    imported = child.stdout.splitlines()[-1].split()
    assert all(f"\n  {verb} " in child.stdout for verb in set(VERBS) - {*HIDDEN_VERBS})
    assert not {"taichi", "ocean_sim.reading.scene", "ocean_sim.verbs.run"} & set(imported)


@pytest.mark.parametrize(
    "error, code, sentence",
    [
        (Diverged("density reached 1e9 kg/m^3"), 1, "diverged: density reached 1e9 kg/m^3"),
        (OSError(28, "No space left on device", "gauges.csv"), 1, "No space left on device: gauges.csv"),
        (ImportError("libX11.so.6: cannot open shared object file"), 3, "Taichi needs the system library libX11"),
        (console.Lacking("no OpenGL"), 3, "no OpenGL"),
        (KeyboardInterrupt(), 1, "stopped"),
        (ZeroDivisionError("division by zero"), 1, "this should not happen (ZeroDivisionError: division by zero)"),
    ],
)
def test_every_failure_has_a_sentence_and_an_exit_code(ask, monkeypatch, error, code, sentence):
    def fail(*_: object) -> None:
        raise error

    monkeypatch.setattr("ocean_sim.verbs.check.preflight", fail)
    assert ask("check", "small.yaml")[0] == code
    assert ask("check", "small.yaml")[2].strip().startswith(sentence)
    assert json.loads(ask("check", "small.yaml", "--json")[1])["problems"] == []


def test_debug_shows_the_traceback(capsys, monkeypatch):
    monkeypatch.setattr("ocean_sim.verbs.check.preflight", lambda config: 1 / 0)
    assert run_command_line(["check", "small.yaml", "--debug"]) == 1
    assert "ZeroDivisionError" in capsys.readouterr().err


def test_a_missing_backend_is_exit_code_3(ask, monkeypatch):
    from ocean_sim import runtime

    def missing(config: object) -> None:
        raise runtime.BackendMissing("runtime.arch: cuda was asked for")

    monkeypatch.setattr(runtime, "start", missing)
    assert ask("run", "small.yaml", "--set", "runtime.arch=cuda", "--json")[0] == 3


def test_check_says_what_a_scene_takes_before_anything_is_allocated(ask):
    code, out, err = ask("check", "small.yaml", "--json", "--set", "time_step={kind: fixed, dt: 0.001}")
    answer = json.loads(out)
    assert (code, err, answer["ok"], answer["problems"], answer["particles"]) == (0, "", True, [], 256)
    assert (answer["time_step"], answer["limited_by"]) == (0.001, "fixed")
    assert answer["stable_limited_by"] == "acoustic" and answer["warnings"] == []
    assert 10.0 < answer["memory_mb"] < 2000.0 and "estimated_wall_s" in answer
    assert {"part", "what", "bytes", "why", "kernels"} == set(answer["ledger"][0])
    code, out, _ = ask("check", "small.yaml", "--set", "time_step={kind: fixed, dt: 0.1}")
    assert "\nvalid; 1 warning\n" in out and "warning: the time step of 0.1 s is " in out
    code, out, _ = ask("check", "small.yaml", "--set", "fluid.kind=ballistic")
    assert code == 0 and "\nvalid\n" in out and "what is allocated" not in out
    assert "what is allocated" in ask("check", "small.yaml", "--ledger")[1]
    code, out, _ = ask("check", "small.yaml")
    assert "pressures below 0 Pa are set to 0 (minimum_pressure)" in out and "= 1.00%" in out


def test_list_gives_everything_one_sentence_and_imports_no_kind(ask):
    rows = json.loads(ask("list", "--json")[1])
    assert all(row["sentence"] for row in rows if row["slot"] != "surface")
    names = {(row["slot"], row["name"]) for row in rows}
    assert {("wind", "wide"), ("fluid", "mueller"), ("profiles", "ci"), ("scenes", "bench/dam_break_6k")} <= names
    assert {name for slot, name in names if slot == "observers"} == set(observer_names())
    assert {row["slot"] for row in json.loads(ask("list", "wind", "--json")[1])} == {"wind"}
    assert ask("list", "winds")[::2] == (2, "there is nothing called 'winds' to list; did you mean 'wind'?\n")
    script = (
        "import sys; from ocean_sim import __main__ as m; m.run_command_line(['list']); print('taichi' in sys.modules)"
    )
    child = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert child.stdout.endswith("False\n")


def test_schema_is_printed(ask):
    assert json.loads(ask("schema")[1])["required"] == ["basin", "fluid"]


def test_doctor_looks_and_never_fails(ask, monkeypatch):
    monkeypatch.setattr(doctor, "run_probe", lambda script: {"ok": False, "detail": "the process that tried it died"})
    code, out, _ = ask("doctor", "--json")
    answer = json.loads(out)
    assert code == 0 and set(answer["backends"]) == {"cpu", "cuda", "vulkan", "metal"}
    assert answer["opengl"] == {"ok": False, "detail": "the process that tried it died"}
    assert ask("doctor")[0] == 0


@pytest.mark.parametrize(
    ("room", "said", "ok", "told"),
    [
        (16, "taichi 8", True, "taichi works on 8 numbers at once"),
        (4, "taichi 4", True, "taichi works on 4 numbers at once"),
        (None, "taichi 4", True, "taichi works on 4 numbers at once"),
        (16, "taichi 4", False, "with runtime.library=quadrants, after `pip install quadrants`"),
        (16, "quadrants 4", False, "works on 4 numbers at once, not 16"),
    ],
)
def test_doctor_tells_of_a_compiler_that_does_not_know_the_processor(monkeypatch, room, said, ok, told):
    monkeypatch.setattr(doctor, "run_probe", lambda script: {"ok": True, "detail": said})
    monkeypatch.setattr(machine, "max_vector_width", lambda: room)
    monkeypatch.setattr(machine, "installed_version", lambda package: None)
    found = doctor.vector_row()
    assert found["ok"] is ok and found["detail"].endswith(told)
    monkeypatch.setattr(machine, "installed_version", lambda package: "1.3")
    assert "pip" not in doctor.vector_row()["detail"]


def test_the_width_of_a_kernel_is_read_from_what_the_compiler_makes():
    fact = doctor.run_probe(doctor.VECTOR_PROBE)
    library, width = fact["detail"].split()
    assert fact["ok"] and library == kernel_library.LIBRARY_NAME and int(width) in (4, 8, 16)
    if machine.max_vector_width() in (8, 16):
        assert (int(width) > 4) == kernel_library.knows_processor()


def test_processors_that_the_compiler_is_too_old_for_are_known_by_their_family(monkeypatch):
    monkeypatch.setattr(kernel_library, "LIBRARY_NAME", kernel_library.TAICHI)
    for vendor, family, known in (("AuthenticAMD", 25, True), ("AuthenticAMD", 26, False), ("GenuineIntel", 26, True)):
        told = {"vendor_id": vendor, "cpu family": str(family)}
        monkeypatch.setattr(kernel_library, "processor_facts", lambda told=told: told)
        assert kernel_library.knows_processor() is known
    monkeypatch.setattr(kernel_library, "processor_facts", dict)
    assert kernel_library.knows_processor()


def test_a_probe_survives_the_death_of_its_child():
    assert doctor.run_probe("import os; os.kill(os.getpid(), 11)") == {
        "ok": False,
        "detail": "the process that tried it died (signal 11)",
    }
    assert doctor.run_probe("print('well')") == {"ok": True, "detail": "well"}


def test_bench_measures_in_a_process_of_its_own(ask):
    code, out, _ = ask("bench", "small.yaml", "--json", "--repeats", "1", "--threads", "1")
    assert code == 0, out
    (row,) = json.loads(out)
    assert (row["scene"], row["particles"], row["threads"]) == ("small.yaml", 256, 1)
    positive = ("ms_per_step", "particle_steps_per_s", "particle_steps_per_cpu_s", "real_time_factor", "first_step_s")
    assert all(row[name] > 0.0 for name in (*positive, "peak_memory_mb"))
    assert row["ms_per_step_min"] <= row["ms_per_step"] <= row["ms_per_step_max"]
    assert "fluid" in row["stages"]


def test_a_thread_that_ends_before_it_is_pinned_harms_nothing(monkeypatch):
    def gone(thread: int, cores: set[int]) -> None:
        bound.append(thread)
        raise ProcessLookupError(3, "No such process")

    bound: list[int] = []
    monkeypatch.setattr(runtime.os, "sched_setaffinity", gone)
    runtime._pin_threads(set(), threads=1, one=True)
    assert bound


def test_bench_tells_what_its_child_found_wrong(ask):
    code, _, err = ask("bench", "small.yaml", "--set", "fluid.spacing=0.0")
    assert (code, err) == (2, "--set fluid.spacing=0.0: fluid.spacing: 0.0 is not greater than 0 [m]\n")


def test_render_and_export_want_a_finished_run(ask):
    assert ask("render", "nothing")[::2] == (2, "nothing: this is not a run folder (there is no manifest.json)\n")
    assert ask("render", "nothing", "--camera", "tp")[0] == 2
    Path("bare").mkdir()
    Path("bare/manifest.json").write_text("{}")
    assert "kept no frames" in ask("render", "bare")[2]
    assert ask("export", "bare")[0] == 2
    assert ask("export", "bare", "--surface", "stl")[::2] == (2, "--surface stl: choose ply, vtp or vtkhdf\n")


def test_a_frame_that_is_cut_short_is_named(ask):
    Path("cut/frames").mkdir(parents=True)
    Path("cut/manifest.json").write_text('{"scene": {}}')
    frame, grid = Path("cut/frames/frame_00000.npz"), Path("cut/frames/grid.npz")
    for path in (frame, grid):
        np.savez(path, time=0.0, x=np.zeros(1000), z=np.zeros(1))
    for path in (frame, grid):  # first that with which nothing is drawn, then that which is read first
        path.write_bytes(path.read_bytes()[:500])
        for verb in ("render", "report"):
            assert ask(verb, "cut")[::2] == (2, f"{path}: this is not a whole npz file of numbers\n")


def test_render_without_opengl_is_exit_code_3(ask, monkeypatch):
    from ocean_sim.observers import render
    from ocean_sim.pictures.stage import opengl

    def missing(*_: object, **__: object) -> None:
        raise opengl.OpenGLMissing

    monkeypatch.setattr(render, "render_run", missing)
    monkeypatch.setattr(render, "obstacle_to_pictures", lambda *_: None)
    monkeypatch.setattr(render, "config_options", lambda config, folder: config.model_dump())
    monkeypatch.setattr(render_verb, "require_frames", lambda folder: None)
    code, _, err = ask("render", "bare")
    assert code == 3 and "install" in err


def test_render_says_which_pictures_it_replaced(ask, monkeypatch):
    from ocean_sim.observers import render

    Path("bare").mkdir()
    Path("bare/preview.png").touch()
    monkeypatch.setattr(render, "render_run", lambda *_, **__: [Path("bare/preview.png"), Path("bare/film.mp4")])
    monkeypatch.setattr(render, "obstacle_to_pictures", lambda *_: None)
    monkeypatch.setattr(render, "config_options", lambda config, folder: config.model_dump())
    monkeypatch.setattr(render_verb, "require_frames", lambda folder: None)
    assert ask("render", "bare") == (0, "bare/preview.png\nbare/film.mp4\n", "replaced in bare: preview.png\n")


def test_an_interrupted_run_keeps_what_was_written(folder):
    scene = SMALL.replace("duration: 0.05", "duration: 1000.0")
    Path("long.yaml").write_text(scene)
    child = subprocess.Popen(
        [sys.executable, "-m", "ocean_sim", "run", "long.yaml", "--out", "long"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    events = folder / "long" / "accuracy.csv"
    rows = lambda: re.findall(r"^\d", events.read_text(), re.M) if events.exists() else []
    wait_for("three rows", lambda: len(rows()) > 2 or child.poll() is not None)
    os.kill(child.pid, signal.SIGINT)
    _, err = child.communicate(timeout=300.0)
    assert child.returncode == 1
    assert err.startswith("stopped at t = ") and "Traceback" not in err
    assert json.loads((folder / "long" / "manifest.json").read_text())["outcome"] == "stopped"


def test_what_a_run_wrote_is_read_without_its_comments(folder):
    from ocean_sim.reading.scene import load
    from ocean_sim.result import Result

    (folder / "gauges.csv").write_text("# frame: world\n# seed: 0\ntime_s,centre_m\n0,0.5\n0.05,\n")
    (folder / "events.jsonl").write_text('{"event": "start"}\n{"event": "clipped", "particles": 3}\n')
    result = Result(folder)
    assert list(result.gauges) == ["time_s", "centre_m"]
    assert result.gauges["time_s"].tolist() == [0.0, 0.05]
    assert [event["event"] for event in result.events] == ["start", "clipped"]
    config = load("small.yaml", {"accuracy": None})
    assert run_facts(result, config)["events"] == [{"event": "clipped", "particles": 3}]


def test_null_takes_away_what_was_set_below_its_key_before():
    """As the demo's own `--set render.every=0.1` before a user's `--set render=null`."""
    kept = console.set_values(["render.every=0.1", "frames.every=0.1", "render=null"])
    assert {key: node.data for key, node in kept.items()} == {"frames.every": 0.1, "render": None}
    assert list(console.set_values(["frames=null", "frames.every=0.1"])) == ["frames", "frames.every"]


@pytest.mark.parametrize("slot", ["render", "frames"])
def test_the_demo_s_own_settings_give_way_to_null(slot):
    script = [word for key in ("render.every=0.1", "frames.every=0.1") for word in ("--set", key)]
    assert run_command_line(["check", "showcase", *script, "--set", f"{slot}=null"]) == 0


def test_a_run_that_is_stopped_before_it_has_written_anything_names_no_folder(ask, monkeypatch):
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("ocean_sim.verbs.run.simulate", interrupted)
    code, _, err = ask("run", "small.yaml", "--out", "early")
    assert (code, err) == (1, "stopped at t = 0.000 s; nothing was written\n") and not Path("early").exists()
    code, out, err = ask("run", "small.yaml", "--out", "early", "--json")
    assert (code, err, json.loads(out)["error"]) == (1, "", "stopped at t = 0.000 s; nothing was written")


def test_a_run_that_leaves_the_physical_world_tells_programs_why(ask):
    code, out, err = ask(
        "run", "small.yaml", "--out", "far", "--until", "5", "--set", "time_step={kind: fixed, dt: 0.1}", "--json"
    )
    reason = json.loads(Path("far/manifest.json").read_text())["reason"]
    assert (code, err, json.loads(out)) == (
        1,
        "",
        {"error": f"diverged: {reason}", "problems": []},
    ) and "t = " in reason


def test_the_end_of_a_run_says_where_its_surface_has_left_the_water():
    """In the showcase's wind the cloth rises by 0.17 m over the water in 12 s."""
    (surface,) = surface_remarks({"surface_offset_m": np.array([-0.02, 0.17])}, 1.25)
    assert "0.15 spacings" in surface
    close = {"surface_offset_m": np.array([-0.02, 0.09])}
    assert not surface_remarks(close, 1.25) and not surface_remarks({}, None)
