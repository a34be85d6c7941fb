"""Cores, memory, packages and processes of this machine, and the hashes of this program."""

import hashlib
import os
import resource
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

EXTRA_PACKAGES = {
    "pictures": ("pyvista", "vtk", "imageio", "imageio-ffmpeg", "matplotlib"),
    "cluster": ("distributed",),
}
STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGXCPU)
stop_requested = threading.Event()  # to end
KILL_TIMEOUT = 1.0  # [s] that a process may take to end that has been killed
# [bytes], of versions 2 and 1
CGROUP_LIMIT_FILES = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")
MEMORY_FILES = "/proc/meminfo", "/proc/self/status"
SOURCE_SUFFIXES = (".py", ".csv")  # suffixes of the program's files that its numbers depend on


def available_cores() -> int:
    """Number of processor cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def cache_directory() -> Path:
    """The user's cache for compiled kernels and probes: $XDG_CACHE_HOME/ocean-sim, by default ~/.cache/ocean-sim."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "ocean-sim"


def kernel_cache() -> Path:
    """Folder of the kernels that this copy of the program has compiled, named by the path of the copy."""
    copy = hashlib.sha256(os.fsencode(Path(__file__).parent)).hexdigest()[:8]
    return cache_directory() / "kernels" / copy


def memory_limit() -> int:
    """Physical memory [bytes] of this machine, or the limit of this process or of its container if that is lower."""
    limits = [os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"), resource_limit("RLIMIT_AS")]
    for file in CGROUP_LIMIT_FILES:
        with suppress(OSError, ValueError):  # there is no such bound
            limits.append(int(Path(file).read_text()))
    return min(limits)


def available_memory() -> int:
    """Memory [bytes] that this process has or can still get, swap included; `memory_limit` on systems without /proc."""
    try:
        lines = [line.split() for file in MEMORY_FILES for line in Path(file).read_text().splitlines()]
    except OSError:
        return memory_limit()
    told = {words[0]: int(words[1]) for words in lines if len(words) == 3 and words[2] == "kB"}
    return min(memory_limit(), 1024 * (told["MemAvailable:"] + told["SwapFree:"] + told["VmRSS:"]))


def resource_limit(name: str) -> int:
    """Limit of a resource of this process, by a name in module `resource`, as RLIMIT_AS; sys.maxsize if unlimited."""
    limit = resource.getrlimit(getattr(resource, name))[0]
    return sys.maxsize if limit == resource.RLIM_INFINITY else limit


@cache
def processor_facts() -> dict[str, str]:
    """Entries of the first processor in /proc/cpuinfo, text by name; empty on systems other than Linux."""
    try:
        first = Path("/proc/cpuinfo").read_text(encoding="utf-8").partition("\n\n")[0]
    except OSError:
        return {}
    return {name.strip(): value.strip() for name, _, value in (line.partition(":") for line in first.splitlines())}


def max_vector_width() -> int | None:
    """Largest number of f32 lanes in the vector registers of this processor; None if unknown."""
    flags = processor_facts().get("flags", "").split()
    return next((n for flag, n in (("avx512f", 16), ("avx2", 8), ("sse2", 4)) if flag in flags), None)


def installed_version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def missing_extra(extra: str) -> str | None:
    """Sentence on the missing packages of an optional extra, such as `pictures`; None if all are installed."""
    missing = [package for package in EXTRA_PACKAGES[extra] if installed_version(package) is None]
    if not missing:
        return None
    *first, last = missing
    lacks = f"{', '.join(first)} and {last} are not installed" if first else f"{last} is not installed"
    return f"{lacks}; `pip install '.[{extra}]'` in the checkout brings what is missing"


def extra_with(module: str) -> str | None:
    """Optional extra of this package (as in `pip install '.[extra]'`) that brings a module; None if none does."""
    package = {"vtkmodules": "vtk", "imageio_ffmpeg": "imageio-ffmpeg", "dask": "distributed"}.get(module, module)
    return next((extra for extra, packages in EXTRA_PACKAGES.items() if package in packages), None)


@cache
def source_hashes() -> dict[str, str]:
    """SHA-256 (16 hex digits) of each source file on which results depend, by its path in the package."""
    package = Path(__file__).parent
    files = sorted(path for path in package.rglob("*") if path.suffix in SOURCE_SUFFIXES and path.is_file())
    return {path.relative_to(package).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()[:16] for path in files}


def program_hash() -> str:
    """SHA-256 of all source files on which results depend, together."""
    return hashlib.sha256("".join(f"{name} {each}\n" for name, each in source_hashes().items()).encode()).hexdigest()


def request_stop(*_: object) -> None:
    """Signal handler that `stoppable` installs: note that the process is to end, and raise KeyboardInterrupt."""
    stop_requested.set()
    raise KeyboardInterrupt


def stop_if_asked() -> None:
    """Raise KeyboardInterrupt if a signal asked a `stoppable` process to end, as Taichi may swallow the first one."""
    if stop_requested.is_set():
        raise KeyboardInterrupt


@contextmanager
def stoppable() -> Iterator[None]:
    """Turn signals that ask this process to end into a KeyboardInterrupt inside the block: SIGINT (Ctrl-C), SIGTERM,
    SIGXCPU (processor time is spent), SIGHUP unless `nohup` ignores it. Only a main thread receives signals."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    heard = [number for number in STOP_SIGNALS if signal.getsignal(number) is not signal.SIG_IGN]
    before = {number: signal.signal(number, request_stop) for number in heard}
    if request_stop not in before.values():  # this is the outermost
        stop_requested.clear()
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler or signal.SIG_DFL)


@contextmanager
def parent_pipe() -> Iterator[int]:
    """Yield a pipe that breaks when this process ends: standard input of a child that calls `exit_with_parent`."""
    theirs, ours = os.pipe()
    try:
        yield theirs
    finally:
        os.close(theirs)
        os.close(ours)


def kill_session(child: subprocess.Popen[str]) -> None:
    """Kill a child process that leads a session, and its descendants; wait at most KILL_TIMEOUT for them to end."""
    patience = time.monotonic() + KILL_TIMEOUT
    with suppress(ProcessLookupError, PermissionError):  # none is left
        os.killpg(child.pid, signal.SIGKILL)
        child.wait()
        while time.monotonic() < patience:
            os.killpg(child.pid, 0)
            time.sleep(0.002)
    child.wait()


def yield_to_others(by: int) -> None:
    """Lower this process's priority: add `by` to its niceness, and set that of a session it leads to `by`."""
    os.nice(by)
    if os.getsid(0) == os.getpid():  # this session is its own
        with suppress(OSError):
            Path("/proc/self/autogroup").write_text(str(by))


def exit_with_parent() -> threading.Event:
    """End this process and its group when its standard input (`parent_pipe`) breaks. Returns an event that is set once
    the parent writes a byte there, as to say that the run has ended."""
    spoken = threading.Event()

    def listen() -> None:
        while os.read(sys.stdin.fileno(), 1):
            spoken.set()

    exit_after(listen)
    return spoken


def exit_after(wait: Callable[[], object]) -> None:
    """End this process, and its process group if it leads one, as soon as `wait` returns in another thread."""

    def end() -> None:
        wait()
        if os.getpgrp() == os.getpid():
            os.killpg(0, signal.SIGKILL)
        os._exit(1)

    threading.Thread(target=end, daemon=True).start()
