"""`ocean-sim run`: preflight, progress, summary."""

from collections.abc import Callable, Iterable
from itertools import count
from pathlib import Path
from typing import Any

import typer

from ocean_sim.conventions import figures
from ocean_sim.files.run_files import MANIFEST_FILE, Claim, FolderClaimed, foreign_names
from ocean_sim.files.yaml_file import Location, Node, node_of
from ocean_sim.observers.shared.run_report import event_details
from ocean_sim.reading.scene import SceneConfig, load, scene_path
from ocean_sim.result import FIRST_FILE, Result, claim_run_folder, simulate
from ocean_sim.state import checkpoint_file
from ocean_sim.verbs.check import preflight, preflight_lines
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.history import keep_picture_ratio, keep_run_times
from ocean_sim.verbs.shared.options import Out, Profile, Quiet, Scene, Sets
from ocean_sim.verbs.shared.progress import Progress, kernel_notice

OFFSET_STATED = 0.1  # [spacings] by which a surface has left the highest particles, from which on it is said
USUAL_EVENTS = ("start", "limit", "end", "stop", "done")  # that are not news


def run(
    scene: Scene,
    profile: Profile = None,
    sets: Sets = None,
    out: Out = None,
    until: float | None = typer.Option(None, help="Simulated time [s], instead of the scene's duration."),
    overwrite: bool = typer.Option(False, help="Replace a run that is already in --out."),
    frame: str | None = typer.Option(None, help="Axes of motion.csv: ship, ned or flu."),
    quiet: Quiet = False,
) -> None:
    """Simulate a scene and write its run folder."""
    axes = [] if frame is None else [f"motion.frame={frame}"]
    overrides = console.set_values([*(sets or []), *axes])
    if until is not None:
        overrides["duration"] = until_node(until)
    config = load(scene, overrides, profile)
    console.must_compute_with(config.runtime.library)
    with run_folder(scene_path(scene).stem, out, overwrite, config.files()) as folder:
        progress = Progress(config.duration, quiet)
        if not quiet:
            found = preflight(config)
            lines = preflight_lines(found, config, ", listed at the end")
            console.say("\n".join([lines, *(f"warning: {told}" for told in found["urgent"])]))
            console.say(f"writing {folder}\n{kernel_notice()}")
        try:
            report_run(lambda: simulate(config, folder, (progress,)), progress, config, folder, quiet)
        finally:
            told = [] if quiet else [f"- {each}" for each in (*found["notes"], *found["warnings"])]
            if told:
                console.say("\n".join(["\nwhat to know when you read these numbers:", *told]))
        begin = [folder / name for name in ("report.html", "preview.png") if (folder / name).exists()]
        if begin and not quiet:
            console.say(f"\nopen {' or '.join(map(str, begin))} first")


def report_run(
    made: Callable[[], Result], progress: Progress, config: SceneConfig, folder: Path, quiet: bool = False
) -> None:
    """Carry out a run by calling `made`, store its time per step, print its results; raises Stopped if interrupted."""
    try:
        result = made()
    except KeyboardInterrupt:
        raise stopped_run(progress, folder) from None
    keep_run_times(config, progress)
    keep_picture_ratio(config, progress.drawing.film_time)
    facts = progress.summary() | {"outcome": result.manifest.get("outcome"), "warnings": config.warnings()}
    facts |= run_facts(result, config)
    console.reply(facts, str(folder) if quiet else run_summary(facts))


def stopped_run(progress: Progress, folder: Path) -> console.Stopped:
    """Error to raise for an interrupted run: tells the simulated time reached, the files, and how to continue."""
    progress.close()
    if progress.over:
        later = f"`ocean-sim render {folder}` draws them"
        return console.Stopped(f"stopped while its pictures were drawn; {folder} holds everything else; {later}")
    left = f"{folder} holds what was written" if any(folder.glob("[!.]*")) else "nothing was written"
    time, cure, kept = progress.time, "", next(checkpoint_file.checkpoint_files(folder), None)
    if kept is not None:
        since = checkpoint_file.time_of(kept)
        time, cure = max(time, since), f"; `ocean-sim resume {folder}` continues it from t = {since:.3f} s"
    return console.Stopped(f"stopped at t = {time:.3f} s; {left}{cure}")


def until_node(until: float) -> Node:
    """Value of the option `--until` [s] as a node, to replace the duration of the scene."""
    return node_of(until, Location(f"--until {until:g}"))


def run_folder(stem: str, out: Path | None, overwrite: bool, coming: Iterable[str] = ()) -> Claim:
    """Claim `out`, or else the first unused of runs/STEM, runs/STEM-2, ...; Refused if a run or others lie there."""
    if out is None:
        folders = (Path("runs") / (stem if k == 1 else f"{stem}-{k}") for k in count(1))
        return next(filter(None, map(unused_folder, folders)))
    return claim_run_folder(coming, out, overwrite, f"--out {out}", "add --overwrite")


def unused_folder(folder: Path) -> Claim | None:
    """Claim (lock) a folder; None if it holds a run or other files, or another process has claimed it."""
    try:
        claim = None if (folder / MANIFEST_FILE).exists() or foreign_names(folder, FIRST_FILE) else Claim(folder)
    except FolderClaimed:
        return None
    if claim is not None and (folder / MANIFEST_FILE).exists():  # it has begun and ended meanwhile
        claim.close()
        return None
    return claim


def run_facts(result: Any, config: SceneConfig) -> dict[str, Any]:
    """Main results and file names of a finished run, as JSON data."""
    accuracy = result.accuracy if "accuracy" in config.observers else {}
    columns = {name: f"compression_{name}" for name in ("mean", "max")}
    worst = {name: accuracy[column].max() for name, column in columns.items() if column in accuracy}
    return {
        "worst_compression": worst,
        "remarks": surface_remarks(accuracy, config.preflight.spacing) if accuracy else [],
        "events": [event for event in result.events if event.get("event") not in USUAL_EVENTS],
        "folder": str(result.folder),
        "files": sorted(path.name + ("/" if path.is_dir() else "") for path in result.folder.glob("[!.]*")),
        "notes": config.notes,
    }


def surface_remarks(columns: dict[str, Any], spacing: float | None) -> list[str]:
    """Sentences on a drawn surface that has left particles `spacing` [m] apart, by the `columns` of accuracy.csv."""
    offset = columns.get("surface_offset_m", [0.0])
    apart = abs(offset[-1] - offset[0])
    if spacing is None or apart <= OFFSET_STATED * spacing:
        return []
    return [
        f"the surface lies {offset[-1]:.3g} m over the highest particles in the mean, at the start {offset[0]:.3g} "
        f"m: it has left them by {apart / spacing:.2g} spacings (surface_offset_m in accuracy.csv)"
    ]


def run_summary(facts: dict[str, Any]) -> str:
    """Text printed at the end of a run, from the facts of `run_facts` and `Progress.summary`."""
    factor, limits = f"{figures(facts['real_time_factor'], 2)} x real time after the start", facts["limited_by"]
    end, since = f"{facts['simulated_s']:.3g} s simulated", facts["since_s"]
    span = f"t = {since:.3g} s to {end}" if since else end
    lines = [
        f"{facts['particles'] or 'no'} particles, {facts['steps']} steps{' in all' if since else ''}, {span} in "
        f"{console.duration(facts['wall_s']['start'] + facts['wall_s']['steps'])}, start included; {factor}",
        f"time step limited by {', '.join(f'{name} {share:.0%}' for name, share in limits.items())}",
    ]
    if worst := facts["worst_compression"]:
        named = ", ".join(f"{name} {share:.2%}" for name, share in worst.items())
        lines.append(f"worst density error (compression): {named}")
    lines += [
        f"{count} of {facts['steps']} steps ended with a {name} above fluid.{name}_tolerance, after as many iterations "
        f"as fluid.max_{name}_iterations allows"
        for name, count in facts["unsolved"].items()
        if count
    ]
    lines += facts["remarks"]
    told = facts["events"][:5]
    lines += [f"event at t = {e.get('time_s', 0.0):.3f} s: {e.get('event')} ({event_details(e)})" for e in told]
    lines += ["docs/guide/health.md says what events mean"] if facts["events"] else []
    if len(facts["events"]) > 5:
        lines.append(f"... and {len(facts['events']) - 5} more events in events.jsonl")
    return "\n".join([*lines, f"{facts['folder']}: {' '.join(facts['files'])}"])
