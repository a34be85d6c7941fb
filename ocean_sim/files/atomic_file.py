"""Atomic writes: a file appears whole or not at all, also on a full disk."""

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from errno import ENOSPC
from pathlib import Path
from shutil import disk_usage
from typing import Any

RESERVE_FILE, RESERVE_BYTES = ".reserve", 1 << 20  # a file, and its size [bytes]: more than the last words of a run
DRAFT_PATTERN = r"\..+\.\d+\.tmp(\..+)?"  # names of unfinished files, with the number of the process that writes them


@contextmanager
def atomic_write(path: Path) -> Iterator[Path]:
    """Yield the path of a temporary file next to `path`; at the end of the block it is renamed to `path`, or deleted if
    the block fails. The target of a symbolic link is replaced; a pipe or a device is yielded itself."""
    if path.exists() and not path.is_file():
        with file_named_in_errors(path):
            yield path
        return
    if path.is_symlink():
        path = path.resolve()
    draft = path.with_name(f".{path.stem}.{os.getpid()}.tmp{path.suffix}")
    try:
        with file_named_in_errors(path, draft):
            yield draft
            os.replace(draft, path)
    finally:
        draft.unlink(missing_ok=True)


def write_file(path: Path, content: str | bytes | memoryview) -> None:
    """Write a text, as UTF-8, or bytes into a file; its folder is created if missing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_write(path) as draft:
        draft.write_bytes(content.encode() if isinstance(content, str) else content)


def write_facts(path: Path, data: dict[str, Any]) -> None:
    """Write `data` as an indented JSON file."""
    write_file(path, json.dumps(data, indent=2) + "\n")


def new_figure(width: float, height: float, layout: Any = "constrained") -> Any:
    """An empty Matplotlib figure of this size [inch], to be saved by `save_figure`; `layout`: name of its engine."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout=layout)


def save_figure(figure: Any, path: Path, dpi: int = 100) -> None:
    """Save a Matplotlib figure as a picture file with `dpi` pixels per inch; its folder is created if missing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_write(path) as draft:
        figure.savefig(draft, dpi=dpi)


class file_named_in_errors:
    """Context manager that puts `path` into an OSError that names no file, or names `draft`, the temporary file."""

    def __init__(self, path: str | Path, draft: str | Path | None = None) -> None:
        self.path, self.unknown = path, (None, str(draft))

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: type | None, failure: BaseException | None, where: object) -> None:
        if isinstance(failure, OSError) and failure.filename in self.unknown:
            failure.filename = str(self.path)


def require_disk_space(path: Path, size: int) -> None:
    """Raise OSError if the disk of `path` has less than `size` bytes free: HDF5 and VTK do not report a full disk."""
    if disk_usage(path.parent).free < size:
        raise OSError(ENOSPC, os.strerror(ENOSPC), str(path))


@contextmanager
def reserve_disk_space(folder: Path) -> Iterator[None]:
    """Occupy RESERVE_BYTES on a folder's disk during the block; freed at its end, they leave room for last messages."""
    path = folder / RESERVE_FILE
    try:
        with suppress(OSError), path.open("wb") as file:  # a disk as full as that will not be written to for long
            file.write(bytes(RESERVE_BYTES))
        yield
    finally:
        path.unlink(missing_ok=True)
