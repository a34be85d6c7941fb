"""Other processes, as Linux tells of them, and waits for events."""

import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path


def alive(process: int) -> bool:
    """Whether it runs; one that has ended may still be listed until its parent asks."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def wait_for(event: str, happened: Callable[[], object]) -> None:
    """Return once an event has happened; fails by its name after five minutes, which a loaded machine does not take."""
    end = time.monotonic() + 300.0
    while not happened():
        assert time.monotonic() < end, f"waited 300 s for this: {event}"
        time.sleep(0.01)


def wait_for_end(*processes: int) -> None:
    """Return once these processes have ended."""
    wait_for(f"the end of {processes}", lambda: not any(alive(n) for n in processes))


def children(process: int) -> Iterator[int]:
    """Those that its threads have started; it, or one of them, may end while it is looked at."""
    with suppress(FileNotFoundError, ProcessLookupError):
        for file in Path(f"/proc/{process}/task").glob("*/children"):
            yield from map(int, file.read_text().split())
