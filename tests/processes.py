"""Other processes, as Linux tells of them."""

import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path


def alive(process: int) -> bool:
    """Whether it runs; one that has ended may still be listed until its parent asks."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def end(*processes: int) -> bool:
    """Whether they all end within 10 s."""
    patience = time.monotonic() + 10.0
    while any(alive(n) for n in processes) and time.monotonic() < patience:
        time.sleep(0.01)
    return not any(alive(n) for n in processes)


def children(process: int) -> Iterator[int]:
    """Those that its threads have started; it, or one of them, may end while it is looked at."""
    with suppress(FileNotFoundError, ProcessLookupError):
        for file in Path(f"/proc/{process}/task").glob("*/children"):
            yield from map(int, file.read_text().split())
