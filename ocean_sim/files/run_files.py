"""The files of a run folder, as its manifest lists them: those that give way to another run, and no others.

An entry is a path below the folder, in which * stands for digits and dots: `frames/frame_*.npz`.
"""

import re
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any

from ocean_sim.conventions import Refused
from ocean_sim.files import input_file
from ocean_sim.files.claim import MANIFEST
from ocean_sim.files.whole_file import write_facts

UNLISTED_FILES = [  # what a run may have left whose manifest has no list, of an earlier version
    *("events.jsonl", "accuracy.csv", "timings.csv", "gauges.csv", "motion.csv", "platform.csv", "tracers.csv"),
    *("frames/grid.npz", "frames/frame_*.npz", "preview/*.png", "checkpoint_*.h5", "report.html", "replay.html"),
    *("film.mp4", "moments.png", "preview.png", "strip.png", "still_*.png", "touched.txt", MANIFEST),
]


def read_manifest(folder: Path) -> dict[str, Any]:
    """The manifest of a run; empty where there is none that can be read."""
    return input_file.facts(folder / MANIFEST)


def listed(manifest: dict[str, Any]) -> list[str]:
    """The entries of a manifest."""
    files = manifest.get("files")
    return [MANIFEST, *(name for name in files if isinstance(name, str))] if isinstance(files, list) else UNLISTED_FILES


def matching(folder: Path, entries: Iterable[str]) -> set[Path]:
    """The files of a folder that fit entries; none of them leads out of it."""
    names: dict[Path, list[str]] = {}
    for path in map(Path, entries):
        if not path.is_absolute() and ".." not in path.parts:
            names.setdefault(folder / path.parent, []).append(re.escape(path.name).replace(r"\*", r"[\d.]+"))
    return {
        path
        for parent, patterns in names.items()
        for path in (parent.iterdir() if parent.is_dir() else ())
        if re.fullmatch("|".join(patterns), path.name) and not path.is_dir()
    }


def clear(folder: Path, coming: Iterable[str] = ()) -> None:
    """Delete the files of the run in a folder, and the folders that this leaves empty. Raises Refused, before any is
    deleted, where a file of somebody else has the name of one that is `coming`."""
    ours = matching(folder, listed(read_manifest(folder)))
    for other in sorted(matching(folder, coming) - ours):
        raise Refused(f"{other}: this file is not of the run that is there, and the new run would replace it; move it")
    for path in sorted(ours, key=lambda path: path.name == MANIFEST):  # which is last: it tells what is left
        path.unlink()
    for parent in {path.parent for path in ours} - {folder}:
        with suppress(OSError):  # there is something in it
            parent.rmdir()


def add(folder: Path, files: Iterable[Path]) -> None:
    """List files that were made of a run in its folder, where it has a manifest."""
    if manifest := read_manifest(folder):
        new = {file.relative_to(folder).as_posix() for file in files if file.is_relative_to(folder)}
        write_facts(folder / MANIFEST, manifest | {"files": sorted({*listed(manifest), *new})})
