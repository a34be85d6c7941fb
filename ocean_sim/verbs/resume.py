"""`ocean-sim resume`: continue a run from its last checkpoint, with the same results as without the break."""

import json
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import typer

from ocean_sim.files import input_file
from ocean_sim.files.atomic_file import reserve_disk_space
from ocean_sim.files.csv_file import split_lines
from ocean_sim.files.input_file import display_path
from ocean_sim.files.run_files import MANIFEST_FILE, Claim
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.kernel_library import LIBRARY_NAME, LIBRARY_VARIABLE, QUADRANTS, TAICHI
from ocean_sim.machine import source_hashes, stop_if_asked, stoppable
from ocean_sim.reading.scene import SceneConfig, load
from ocean_sim.result import FIRST_FILE, Result, simulate
from ocean_sim.simulation import Simulation
from ocean_sim.state import checkpoint_file
from ocean_sim.verbs.run import report_run, until_node
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.options import Quiet
from ocean_sim.verbs.shared.progress import Progress, kernel_notice

MAX_SHOWN_DIFFERENCES = 3  # differences that are named


def resume(
    run: Path = typer.Argument(help="A run folder with checkpoints."),
    until: float | None = typer.Option(None, help="Simulated time [s], instead of the scene's duration."),
    anyway: bool = typer.Option(False, "--anyway", help="Go on even if the program has changed since."),
    quiet: Quiet = False,
) -> None:
    """Go on with a run."""
    if not (run / MANIFEST_FILE).is_file():
        if (run / FIRST_FILE).is_file():
            raise console.Refused(f"{run}: this run ended before its first step; `run --overwrite` starts it again")
        raise console.Refused(f"{run}: this is not a run folder (there is no {MANIFEST_FILE})")
    with Claim(run):
        resume_claimed(run, until, anyway, quiet)


def resume_claimed(folder: Path, until: float | None, anyway: bool, quiet: bool) -> None:
    """Resume the run in a folder that this process has claimed, to simulated time `until` [s] (None: its scene's);
    `anyway`: even if the program has changed since. Raises Refused if that is not possible."""
    manifest = manifest_of(folder)
    config = scene_of(folder, manifest, until)
    if manifest.get("outcome") == "done" and (until is None or until <= manifest["simulated_s"] * (1.0 + 1e-12)):
        facts = {key: manifest.get(key) for key in ("outcome", "steps", "simulated_s")} | {"folder": str(folder)}
        more = "; --until continues it" if any(checkpoint_file.checkpoint_files(folder)) else ""
        console.reply(facts, f"{folder}: this run is finished, at t = {manifest['simulated_s']:.3f} s{more}")
        return
    now, then = config.inputs(), manifest.get("inputs")
    if isinstance(then, dict) and (differing := [name for name in now if then.get(name) != now[name]]):
        cure = "put back what it held, or `run` the scene again"
        raise console.Refused(f"{folder}: {display_path(differing[0])} has changed since this run began; {cure}")
    console.must_compute_with(library_of(manifest, config), f"{folder}, by what its kernels were compiled with", "")
    if never_begun(folder, config):
        kept, changed = None, ""
    else:
        kept = newest_checkpoint(folder, config)
        changed = check_checkpoint(folder, kept, manifest["scene"], until, anyway)
    progress = Progress(config.duration, quiet, 0.0 if kept is None else kept.time)
    if not quiet:
        nothing = "it ended before its first checkpoint: it starts at t = 0"
        start = nothing if kept is None else f"going on from t = {kept.time:.3f} s"
        console.say(f"{folder}: {start}\n{kernel_notice()}")

    def made() -> Result:
        if kept is None:
            return simulate(config, folder, (progress,))
        return continue_run(config, kept, folder, progress, changed)

    report_run(made, progress, config, folder, quiet)


def continue_run(
    config: SceneConfig, kept: checkpoint_file.Checkpoint, folder: Path, progress: Progress, changed: str = ""
) -> Result:
    """Continue a run from the checkpoint `kept`; `changed`: text on how the program has changed since. The simulation
    is built in a temporary folder, so that the run folder is untouched until the checkpoint is restored."""
    from ocean_sim.observers.checkpoint import restore
    from ocean_sim.state.snapshot import FileShortened, Mismatch

    away = TemporaryDirectory(prefix="ocean-sim-")
    with stoppable(), away as elsewhere, Simulation(config, Path(elsewhere)) as simulation:
        if kept.made.get("backend") != simulation.backend.arch:
            simulation.observers.clear()  # they have nothing to write
            backends = f"{kept.made.get('backend')}, and this one on {simulation.backend.arch}"
            raise console.Refused(f"{folder}: the checkpoint was made on {backends}")
        try:
            restore(simulation, kept, folder, changed)
        except FileShortened as problem:
            raise console.Refused(f"{folder}: {problem}") from None
        except Mismatch as problem:
            raise console.Refused(f"{folder}: the checkpoint does not fit this program: {problem}") from None
        simulation.observers.append(progress)
        stop_if_asked()
        with reserve_disk_space(folder):
            simulation.run(config.duration)
    return Result(folder)


def manifest_of(folder: Path) -> dict[str, Any]:
    """The manifest of a run folder as a dict; raises Refused if it is damaged or not from a run."""
    path = folder / MANIFEST_FILE
    try:
        manifest = input_file.read_json(path)
        if not isinstance(manifest["scene"], dict):
            raise TypeError
        return manifest
    except (ValueError, KeyError, TypeError):
        raise console.Refused(f"{path}: this is not the manifest of a run") from None


def scene_of(folder: Path, manifest: dict[str, Any], until: float | None) -> SceneConfig:
    """The scene in a run's manifest, its duration replaced by `until` [s] if given; raises Refused or SceneError."""
    try:
        return load(manifest["scene"], {} if until is None else {"duration": until_node(until)})
    except SceneError as error:
        if until is not None and any(problem.file.startswith("--until") for problem in error.problems):
            raise
        why = "is not one of this version, or names a file that is not there any more"
        raise console.Refused(f"{folder}: its scene {why}: {error}") from None


def library_of(manifest: dict[str, Any], config: SceneConfig) -> str | None:
    """Kernel library, Taichi or Quadrants, that a run needs by its scene or its manifest; None if neither has one."""
    versions = manifest.get("versions")
    known = [name for name in (TAICHI, QUADRANTS) if isinstance(versions, dict) and name in versions]
    return config.runtime.library or next(iter(known), None)


def never_begun(folder: Path, config: SceneConfig) -> bool:
    """True if a run with checkpoints ended before the first one, and wrote nothing but its initial state."""
    if "checkpoint" not in config.observers or any(checkpoint_file.checkpoint_files(folder)):
        return False
    tables = (split_lines(input_file.read_text(path)) for path in folder.glob("*.csv"))
    return not any(len(table.rows) > 1 for table in tables) and len([*folder.glob("frames/frame_*")]) < 2


def newest_checkpoint(folder: Path, config: SceneConfig) -> checkpoint_file.Checkpoint:
    """The newest readable checkpoint of a run; raises Refused if there is none."""
    paths, reason = [*checkpoint_file.checkpoint_files(folder)], ""
    if not paths:
        gone = "its files checkpoint_*.h5 are gone; start it again"
        cure = gone if "checkpoint" in config.observers else "name `checkpoint` in a scene to have them"
        raise console.Refused(f"{folder}: there is no checkpoint to go on from; {cure}")
    for path in paths:
        try:
            kept = checkpoint_file.read_checkpoint(path)
        except checkpoint_file.UnreadableCheckpoint as problem:
            reason = reason or str(problem)
            continue
        if reason:
            console.complain(f"{reason}; taking {path.name}")
        return kept
    raise console.Refused(f"{folder}: {reason}; no other can be read")


def check_checkpoint(
    folder: Path, kept: checkpoint_file.Checkpoint, scene: dict[str, Any], until: float | None, anyway: bool
) -> str:
    """Differences, in words, of this program from the one that saved the checkpoint `kept`. Raises Refused (a) if there
    are any, unless `anyway`, (b) if `scene` differs in more than its duration, (c) if it is later than `until` [s]."""
    changed = program_changes(kept.made)
    if changed and not anyway:
        cure = "its results may differ; --anyway continues, and marks every file"
        if other_library(kept.made):
            cure = f"{cure}; without {LIBRARY_VARIABLE} it goes on as it began"
        raise console.Refused(f"{folder}: the checkpoint is of {changed}; {cure}")
    other = scene_differences(kept.scene | {"duration": None}, scene | {"duration": None})
    if other:
        raise console.Refused(f"{folder}: the checkpoint belongs to another scene than manifest.json: {other}")
    if until is not None and until < kept.time:
        raise console.Refused(f"--until {until:g}: the last checkpoint is at t = {kept.time:.3f} s already")
    return changed


def program_changes(made: dict[str, Any]) -> str:
    """Text on how this program differs from `made`, a checkpoint's versions and source hashes; empty if it does not."""
    from ocean_sim.observers.checkpoint import versions

    now, then, library = versions(), made.get("sources") or {}, other_library(made)
    compared = [name for name in now if name != LIBRARY_NAME or not library]
    kept, used = ({name: each.get(name) for name in compared} for each in (made, now))
    versions_differ = scene_differences(kept, used)
    files = [name for name in sorted({*then, *source_hashes()}) if then.get(name) != source_hashes().get(name)]
    more = f" and {len(files) - MAX_SHOWN_DIFFERENCES} more" if len(files) > MAX_SHOWN_DIFFERENCES else ""
    other = f"another library: {library} compiled its kernels, and {LIBRARY_VARIABLE} is {LIBRARY_NAME}"
    differ = [other] if library else []
    differ += [f"another version: {versions_differ}"] if versions_differ else []
    differ += [f"other sources: {', '.join(files[:MAX_SHOWN_DIFFERENCES])}{more}"] if files else []
    return ", and of ".join(differ)


def other_library(made: dict[str, Any]) -> str:
    """Kernel library and version in a checkpoint's versions, `made`, if this process uses another one; else empty."""
    used = (name for name in (TAICHI, QUADRANTS) if name in made and LIBRARY_NAME not in made)
    return next((f"{name} {made[name]}" for name in used), "")


def scene_differences(kept: Any, now: Any) -> str:
    """Text on where nested dicts, a checkpoint's `kept` and `now`, differ, MAX_SHOWN_DIFFERENCES at most; or empty."""
    found = list(differing_keys(kept, now, ""))
    more = f", and {len(found) - MAX_SHOWN_DIFFERENCES} more" if len(found) > MAX_SHOWN_DIFFERENCES else ""
    return ", ".join(found[:MAX_SHOWN_DIFFERENCES]) + more


def differing_keys(kept: Any, now: Any, key: str) -> Any:
    """Yield a sentence for each key in which the nested dicts `kept` and `now` differ; `key`: dotted path to both."""
    if isinstance(kept, dict) and isinstance(now, dict):
        for name in sorted({*kept, *now}):
            yield from differing_keys(kept.get(name), now.get(name), f"{key}.{name}".lstrip("."))
    elif kept != now:
        yield f"{key} is {json.dumps(kept):.60} in the checkpoint and {json.dumps(now):.60} here"
