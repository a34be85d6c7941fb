"""Files that appear whole or not at all."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

UNFINISHED = r"\..+\.\d+\.tmp(\..+)?"  # names of unfinished files, with the number of the process that writes them


def unfinished(path: Path) -> Path:
    """The name of a file next to `path`, of the same suffix, while this process writes it."""
    return path.with_name(f".{path.stem}.{os.getpid()}.tmp{path.suffix}")


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """A file next to `path`, of the same suffix, to be written: renamed to `path` once that is done, removed where it
    fails."""
    draft = unfinished(path)
    try:
        yield draft
        os.replace(draft, path)
    finally:
        draft.unlink(missing_ok=True)
