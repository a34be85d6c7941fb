"""`ocean-sim resume`: what is refused and why, and runs that are killed at any moment."""

import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from hashlib import sha256
from pathlib import Path
from random import Random

import pytest

from ocean_sim.__main__ import run_command_line
from ocean_sim.kernel_library import LIBRARY_NAME
from ocean_sim.reading.scene import load
from ocean_sim.result import Result
from ocean_sim.result import run as run_scene
from ocean_sim.state import checkpoint_file
from tests.processes import wait_for

QUIET = ["--set", "render=null", "--set", "report=null", "--set", "runtime.threads=1"]
SEA = """duration: 0.4
basin: {length: 20.0, width: 20.0, depth: 5.0, walls: none}
fluid: {kind: linear_waves, height: 0.5, period: 3.0}
gauges: {elevation: {here: [0.1, 0.2]}, every: 0.02}
checkpoint: {every: 0.1}
frames: {every: 0.1}
"""
LONG = SEA.replace("every: 0.02", "every: 0.001") + "time_step: {kind: fixed, dt: 0.0005}\n"
TANK = """duration: 4.0
basin: {length: 2.0, depth: 0.5}
fluid: {kind: mueller, spacing: 0.1, kinematic_viscosity: 0.01}
gauges: {elevation: {here: [0.1]}, pressure: {bed: [0.1, -0.4]}, every: 0.02}
tracers: {ids: [0, 50], every: 0.02}
checkpoint: {every: 0.1}
frames: {every: 0.1}
"""
BEACH = (
    TANK.replace("depth: 0.5", "depth: 0.5, floor: {profile: [[-1.0, -0.5], [0.0, -0.5], [1.0, 0.1]]}")
    .replace("elevation", "runup: {shore: {}}, elevation")
    .replace("mueller, spacing: 0.1, kinematic_viscosity: 0.01", "delta_sph, spacing: 0.05")
)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The folder of a finished run with checkpoints."""
    folder = tmp_path_factory.mktemp("sea")
    (folder / "sea.yaml").write_text(SEA)
    assert run_command_line(["run", str(folder / "sea.yaml"), "--out", str(folder / "run"), *QUIET]) == 0
    return folder / "run"


@pytest.fixture
def there(run, tmp_path):
    """A copy of that run as it was when it was killed, in its midst or later."""
    shutil.copytree(run, tmp_path / "there")
    edit(tmp_path / "there", outcome="running")
    return tmp_path / "there"


@pytest.fixture
def ask(capsys):
    """What a command line answers: exit code, standard output, standard error."""

    def asked(*words: object) -> tuple[int, str, str]:
        capsys.readouterr()
        code = run_command_line([str(word) for word in words])
        said = capsys.readouterr()
        assert "Traceback" not in said.out + said.err
        return code, said.out, said.err

    return asked


def edit(folder: Path, **facts) -> None:
    """Other words in a manifest."""
    path = folder / "manifest.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | facts))


def contents(folder: Path) -> dict[str, bytes]:
    """What a run folder holds, but for what says when it was stopped."""
    own = ("manifest.json", "timings.csv")
    files = [path for path in folder.rglob("*") if path.is_file() and path.suffix != ".h5" and path.name not in own]
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def newest(folder: Path) -> Path:
    return next(checkpoint_file.checkpoint_files(folder))


def test_a_finished_run_says_so(run, ask):
    code, out, err = ask("resume", run)
    assert (code, err) == (0, "") and "this run is finished, at t = 0.4" in out
    code, out, err = ask("resume", run, "--json")
    assert (code, err, json.loads(out)["outcome"]) == (0, "", "done")
    assert ask("resume", run, "--until", "0.3")[0] == ask("resume", "--help")[0] == 0


def test_a_finished_run_goes_on_when_asked(run, there, ask, tmp_path):
    edit(there, outcome="done")
    code, out, err = ask("resume", there, "--until", "0.6")
    assert (code, err) == (0, "") and "going on from t = 0.4" in out
    (tmp_path / "long.yaml").write_text(SEA.replace("0.4", "0.6"))
    assert ask("run", tmp_path / "long.yaml", "--out", tmp_path / "long", *QUIET)[0] == 0
    assert contents(there) == contents(tmp_path / "long")
    manifest = json.loads((there / "manifest.json").read_text())
    assert manifest["outcome"] == "done" and manifest["scene"]["duration"] == 0.6 and len(manifest["resumed_s"]) == 1


def test_frames_that_have_been_deleted_are_kept_anew(there, ask):
    frames = {path.name for path in (there / "frames").iterdir()}
    edit(there, outcome="done")
    shutil.rmtree(there / "frames")
    code, _, err = ask("resume", there, "--until", "0.6")
    assert (code, err) == (0, "") and json.loads((there / "manifest.json").read_text())["outcome"] == "done"
    made = {path.name for path in (there / "frames").iterdir()}
    assert made & frames == {"grid.npz"} and "frame_00006.npz" in made


def test_a_run_of_which_a_named_file_has_changed_is_refused_until_it_is_put_back(ask, tmp_path):
    """Its ship knows what the file held: the checkpoint has it, and a table of the new content would be half used."""
    controls, scene, run = tmp_path / "c.csv", tmp_path / "ship.yaml", tmp_path / "run"
    first = "time_s,throttle,rudder_rad\n0,1.0,0\n10,1.0,0\n"
    controls.write_text(first)
    scene.write_text(f"{SEA}ship: {{kind: otter, controls: {{file: c.csv}}}}\n")
    assert ask("run", scene, "--out", run, *QUIET)[0] == 0
    name = str(controls)
    assert json.loads((run / "manifest.json").read_text())["inputs"] == {name: sha256(first.encode()).hexdigest()}
    controls.write_text(first.replace("1.0", "0.5"))
    before = contents(run)
    for words in ([], ["--anyway"]):
        code, _, err = ask("resume", run, "--until", "0.6", *words)
        assert code == 2 and "c.csv has changed since this run began; put back what it held" in err
    assert contents(run) == before
    controls.unlink()
    assert ask("resume", run, "--until", "0.6")[0] == 2
    controls.write_text(first)
    assert ask("resume", run, "--until", "0.6")[0] == 0


def test_a_damaged_checkpoint_gives_way_to_the_one_before(run, there, ask):
    """Wherever a bit has turned, or the file ends; what was written since the one before is made again."""
    whole = newest(there).read_bytes()
    spots = {"bit": len(whole) // 3, "head": 20, "metadata": 520, "end": len(whole) - 1}
    for name, k in spots.items():
        newest(there).write_bytes(whole[:k] + bytes([whole[k] ^ 16]) + whole[k + 1 :])
        with pytest.raises(checkpoint_file.UnreadableCheckpoint, match="its content does not match its hash"):
            checkpoint_file.read_checkpoint(newest(there))
        assert name
    newest(there).write_bytes(whole[: len(whole) // 2])
    damaged = newest(there).name
    with (there / "gauges.csv").open("a") as torn:
        torn.write("0.42,0.1\n0.44,")
    code, _, err = ask("resume", there)
    assert (code, err.count("\n")) == (0, 1) and f"{damaged} is damaged, or not a checkpoint" in err and "taking" in err
    assert contents(there) == contents(run)


def test_what_cannot_be_resumed_is_refused_in_a_sentence(there, ask, tmp_path):
    def refused(*words: object) -> str:
        before = contents(there)
        code, out, err = ask("resume", *words)
        assert (code, err.count("\n")) == (2, 1) and out.count("\n") in (0, 2), (code, out, err)
        assert contents(there) == before
        return err

    assert "this is not a run folder" in refused(tmp_path / "nothing")
    (tmp_path / "early").mkdir()
    (tmp_path / "early" / "events.jsonl").touch()
    assert "this run ended before its first step" in refused(tmp_path / "early")
    assert "the last checkpoint is at t = 0.4" in refused(there, "--until", "0.3")
    assert refused(there, "--until", "-1").startswith("--until -1: duration: -1.0 is not greater than 0")
    scene = json.loads((there / "manifest.json").read_text())["scene"]
    edit(there, scene=scene | {"seed": 5, "fluid": scene["fluid"] | {"height": 0.4}})
    sentence = refused(there)
    assert "fluid.height is 0.5 in the checkpoint and 0.4 here, seed is 0 in the checkpoint and 5 here" in sentence
    edit(there, scene=scene | {"fluid": {"kind": "custard"}})
    assert "its scene is not one of this version" in refused(there)
    edit(there, scene=scene)
    kept = checkpoint_file.read_checkpoint(newest(there))
    checkpoint_file.write_checkpoint(kept._replace(made=kept.made | {"taichi": "1.6.0"}), there)
    assert 'another version: taichi is "1.6.0" in the checkpoint and' in refused(there)
    other = {"taichi": "quadrants", "quadrants": "taichi"}[LIBRARY_NAME]
    checkpoint_file.write_checkpoint(
        kept._replace(made={name: kept.made[name] for name in kept.made if name != LIBRARY_NAME} | {other: "1.0"}),
        there,
    )
    sentence = refused(there)
    assert f"another library: {other} 1.0 compiled its kernels, and OCEAN_SIM_LIBRARY is {LIBRARY_NAME}; " in sentence
    assert sentence.endswith("; without OCEAN_SIM_LIBRARY it goes on as it began\n") and "null" not in sentence
    checkpoint_file.write_checkpoint(kept, there)
    gauges = (there / "gauges.csv").read_bytes()
    (there / "gauges.csv").write_bytes(gauges[:-20])
    assert refused(there).startswith(f"{there}: gauges.csv is shorter than it was when the checkpoint was made")
    (there / "gauges.csv").write_bytes(gauges)
    for path in checkpoint_file.checkpoint_files(there):
        path.write_bytes(b"")
    assert "is damaged, or not a checkpoint" in refused(there)
    for path in checkpoint_file.checkpoint_files(there):
        path.unlink()
    assert "there is no checkpoint to go on from; its files checkpoint_*.h5 are gone" in refused(there)
    (there / "manifest.json").write_text("{")
    assert "this is not the manifest of a run" in refused(there)


def test_another_program_is_refused_by_the_names_of_its_files_and_anyway_marks_every_file(there, ask):
    """The version alone says nothing of what was edited. A table keeps its rows, and says from which on they are of
    another program."""
    last, kept = (
        list(checkpoint_file.checkpoint_files(there))[1],
        checkpoint_file.read_checkpoint(list(checkpoint_file.checkpoint_files(there))[1]),
    )
    newest(there).unlink()
    then = {name: each for name, each in kept.made["sources"].items() if name != "ship/thesis.py"}
    then |= {"fluid/dfsph.py": "0", "old.py": "1"}
    checkpoint_file.write_checkpoint(kept._replace(made=kept.made | {"sources": then}), there)
    before = contents(there)
    code, out, err = ask("resume", there)
    assert (code, out) == (2, "") and "the checkpoint is of other sources: fluid/dfsph.py, old.py, ship/the" in err
    assert "--anyway continues" in err and contents(there) == before
    assert ask("resume", there, "--anyway")[0] == 0 and last.exists()
    marked = "by another program: other sources: fluid/dfsph.py, old.py, ship/thesis.py"
    manifest = json.loads((there / "manifest.json").read_text())
    assert manifest["changed"] == [{"from_s": round(kept.time, 9), "what": marked.partition(": ")[2]}]
    assert marked in manifest["warnings"][-1] and len(manifest["sources_sha256"]) == 64
    for name in ("accuracy.csv", "gauges.csv"):  # timings.csv is begun anew
        rows = (there / name).read_text().splitlines()
        mark = next(k for k, row in enumerate(rows) if marked in row)
        assert rows[mark].startswith(f"# from t = {kept.time:.9g} s on ")
        times = [float(row.split(",")[0]) for row in rows[mark + 1 :]]
        assert min(times) > kept.time - 0.1 and len(Result(there).table(name[:-4])["time_s"]) > len(times)
    assert any(event["event"] == "the program has changed" for event in Result(there).events)
    without = (there / "gauges.csv").read_text().replace(f"# from t = {kept.time:.9g} s on {marked}\n", "")
    assert without.encode() == before["gauges.csv"]


def test_a_full_disk_is_told_and_leaves_earlier_checkpoints_whole(there):
    kept, before = checkpoint_file.read_checkpoint(newest(there)), sorted(path.name for path in there.iterdir())
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (3000, limits[1]))
    try:
        with pytest.raises(OSError, match="File too large"):
            checkpoint_file.write_checkpoint(kept._replace(time=1.0), there)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert sorted(path.name for path in there.iterdir()) == before
    assert checkpoint_file.read_checkpoint(newest(there)).steps == kept.steps


class Stopper:
    """A watcher that sends this process a signal once."""

    every = 0.0

    def __init__(self, number: int, step: int) -> None:
        self.number, self.step = number, step

    def observe(self, simulation) -> None:
        if simulation.steps == self.step:
            signal.raise_signal(self.number)

    def close(self) -> None:
        pass


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_run_that_is_told_to_stop_keeps_its_state_first(number, run, ask, tmp_path):
    """The step that it is in ends; `resume` begins there, and who heard of signals before hears of them again."""
    before, folder = signal.getsignal(number), tmp_path / "run"
    scene = load(json.loads((run / "manifest.json").read_text())["scene"])
    with pytest.raises(KeyboardInterrupt):
        run_scene(scene, folder, (Stopper(number, 7),))
    assert signal.getsignal(number) is before
    manifest, kept = json.loads((folder / "manifest.json").read_text()), checkpoint_file.read_checkpoint(newest(folder))
    assert (manifest["outcome"], manifest["reason"]) == ("stopped", "interrupted")
    assert kept.steps == manifest["steps"] == 8
    assert ask("resume", folder)[0] == 0
    assert contents(folder) == contents(run)


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_the_command_says_how_to_go_on(number, tmp_path):
    scene = SEA.replace("duration: 0.4", "duration: 500.0").replace("every: 0.1", "every: 50.0")
    (tmp_path / "sea.yaml").write_text(scene)
    child = begun("run", str(tmp_path / "sea.yaml"), "--out", str(tmp_path / "run"), *QUIET)
    waited(lambda: any((tmp_path / "run").glob("checkpoint_*")), child)
    child.send_signal(number)
    _, err = child.communicate(timeout=120)
    time = f"t = {checkpoint_file.time_of(newest(tmp_path / 'run')):.3f} s"
    cure = f"`ocean-sim resume {tmp_path / 'run'}` continues it from {time}"
    assert child.returncode == 1 and f"stopped at {time}" in err and cure in err, err


def begun(*words: str) -> "subprocess.Popen[str]":
    """The command line in a process of its own."""
    command = [sys.executable, "-m", "ocean_sim", *words]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def waited(done, child: "subprocess.Popen[str]") -> None:
    wait_for("a checkpoint, or the end of the run", lambda: done() or child.poll() is not None)


def killed(child: "subprocess.Popen[str]", folder: Path, progress: int, chance: Random) -> bool:
    """Kill a process at a random moment once it has made some checkpoints; whether it was still running."""
    seen: set[str] = set()

    def far_enough() -> bool:
        seen.update(path.name for path in folder.glob("checkpoint_*.h5"))
        return len(seen) > progress

    waited(far_enough, child)
    time.sleep(chance.uniform(0.0, 0.1))
    child.send_signal(signal.SIGKILL)
    child.communicate()
    return child.returncode == -signal.SIGKILL


def last_row(path: Path) -> float:
    """Time [s] of the last whole row."""
    return float(path.read_text().rsplit("\n", 1)[0].rsplit("\n", 1)[-1].split(",")[0])


@pytest.mark.anchor
@pytest.mark.parametrize(
    "kills, text",
    [(3, LONG), pytest.param(50, TANK, marks=pytest.mark.slow), pytest.param(5, BEACH, marks=pytest.mark.slow)],
)
def test_a_run_that_is_killed_again_and_again_leaves_the_bytes_of_one_that_is_not(kills, text, tmp_path):
    """Without a word of warning, at random moments; no more than one interval is lost each time. 50 take minutes;
    OCEAN_SIM_KILLS takes another number."""
    kills = int(os.environ.get("OCEAN_SIM_KILLS", kills))
    (tmp_path / "tank.yaml").write_text(text)
    scene, chance = str(tmp_path / "tank.yaml"), Random(11)
    until = ["--until", str(0.2 * kills + 0.4)]
    whole = begun("run", scene, "--out", str(tmp_path / "whole"), *QUIET, *until)
    child, folder = begun("run", scene, "--out", str(tmp_path / "run"), *QUIET, *until), tmp_path / "run"
    count = 0
    for _ in range(kills):
        count += killed(child, folder, chance.randint(1, 2), chance)
        kept = checkpoint_file.read_checkpoint(newest(folder))
        assert last_row(folder / "gauges.csv") - kept.time < 0.1 + 0.02
        child = begun("resume", str(folder))
    _, err = child.communicate()
    assert child.returncode == 0, err
    whole.communicate()
    assert contents(folder) == contents(tmp_path / "whole")
    assert count > 0.5 * kills, f"only {count} of {kills} came before the end"
