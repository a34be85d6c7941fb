"""Output of the command line: sentences, tables, JSON."""

import json
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from io import BufferedWriter, FileIO, TextIOWrapper
from pathlib import Path
from types import ModuleType
from typing import Any, ClassVar

from pydantic_core import to_jsonable_python

from ocean_sim.conventions import Failed, Lacking, Refused
from ocean_sim.files.atomic_file import file_named_in_errors
from ocean_sim.files.run_files import Claim, claim_folder
from ocean_sim.files.yaml_file import Node, Problem, SceneError, parse_setting, shorten
from ocean_sim.machine import installed_version, missing_extra

__all__ = ["Failed", "Lacking", "Refused"]  # which verbs raise


json_asked = False  # by `--json`: then the answer, as JSON, is all that goes to standard output
complaints: set[str] = set()  # what has been said once
COMMAND_VARIABLE = "OCEAN_SIM_COMMAND"  # in the environment: how the program was called
MAX_COMPLAINT_BYTES = 2000  # bytes of a message about what went wrong
NAMED_OUTPUT = file_named_in_errors("standard output")


class Outlet(FileIO):
    """Standard stream that discards output once nobody reads it (as after `| head`), so that the command goes on."""

    over: ClassVar = False  # the command has ended, and what went wrong is told

    def write(self, data: Any) -> int:
        """Write bytes to the stream and return their number; bytes that nobody reads are discarded."""
        try:
            return super().write(data)
        except OSError as failure:
            if self.over or isinstance(failure, BrokenPipeError):
                return len(data)
            raise


class Stopped(Failed):
    """Error: the user has interrupted a run or a study; the message tells how far it came."""


class Anew(BaseException):
    """Request to restart the command with another kernel library; not an Exception, so that no handler catches it."""

    def __init__(self, library: str) -> None:
        super().__init__(library)
        self.library = library

    def begin(self, arguments: list[str]) -> None:
        """Replace this process by the same command (`arguments`) with the other kernel library, Taichi or Quadrants, as
        a process can use only one; does not return."""
        from ocean_sim import kernel_library

        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        environment = os.environ | {kernel_library.LIBRARY_VARIABLE: self.library}
        os.execve(sys.executable, [sys.executable, "-m", "ocean_sim", *arguments], environment)


def open_streams() -> None:
    """Prepare the standard streams, so that closed ones, closed pipes and unknown characters raise no error."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        stream = getattr(sys, name)
        if stream is None:
            stream = Path(os.devnull).open(mode)
        elif mode == "w" and isinstance(stream, TextIOWrapper):
            raw, by_line = Outlet(stream.fileno(), "wb", closefd=False), stream.line_buffering
            stream = TextIOWrapper(BufferedWriter(raw), stream.encoding, "backslashreplace", line_buffering=by_line)
        setattr(sys, name, stream)
        setattr(sys, f"__{name}__", stream)  # Taichi takes two that differ for a notebook


def say(text: str = "") -> None:
    """Print a line to standard output, with control characters escaped; nothing if the user asked for JSON."""
    if not json_asked:
        with NAMED_OUTPUT:
            print(escape_controls(as_called(text)), flush=True)


def complain(text: str) -> None:
    """Print a message, cut to MAX_COMPLAINT_BYTES, to standard error; a closed stream is ignored."""
    with suppress(OSError):  # there may be nobody to tell
        print(shorten(escape_controls(as_called(text)), MAX_COMPLAINT_BYTES), file=sys.stderr, flush=True)


def as_called(text: str) -> str:
    """Text whose quoted commands (`ocean-sim ...`) begin with the name by which the user called the program."""
    return text.replace("`ocean-sim ", f"`{os.environ.get(COMMAND_VARIABLE, 'ocean-sim')} ")


def escape_controls(text: str) -> str:
    """Text whose unprintable characters, except line breaks, are escape sequences, so that no terminal obeys them."""
    return "".join(c if c.isprintable() or c == "\n" else c.encode("unicode_escape").decode() for c in text)


def answer(data: Any) -> None:
    """Print `data` as JSON, NaN and infinity as null, to standard output, if the user asked for JSON; else nothing."""
    if json_asked:
        with NAMED_OUTPUT:
            plain = to_jsonable_python(data, inf_nan_mode="null", fallback=lambda number: number.item())  # of NumPy
            print(json.dumps(plain, indent=2, ensure_ascii=False, allow_nan=False), flush=True)


def reply(data: Any, text: str) -> None:
    """Print the result of a command: `data` as JSON if the user asked for JSON, else `text`."""
    answer(data)
    say(text)


def table(title: str, columns: list[str], rows: list[list[str]]) -> None:
    """Print a table from rows of cell texts, numbers aligned to the right; nothing if the user asked for JSON."""
    if json_asked:
        return
    from rich.console import Console
    from rich.table import Table

    look: dict[str, Any] = {"box": None, "pad_edge": False, "padding": (0, 2, 0, 0), "show_header": any(columns)}
    shown = Table(title=title or None, title_justify="left", **look)
    for k, column in enumerate(columns):
        numbers = bool(rows) and all(row[k][:1].isdigit() or row[k] == "" for row in rows)
        shown.add_column(column, justify="right" if numbers else "left", overflow="fold")
    for row in rows:
        shown.add_row(*row)
    with NAMED_OUTPUT:
        Console(width=None if sys.stdout.isatty() else 140, markup=False, highlight=False).print(shown)


def cell(value: Any, missing: str = "") -> str:
    """Text of a table cell: numbers to four digits, None as `missing`."""
    return missing if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)


def problem_count(problems: list[Any]) -> str:
    """Sentence on the number of problems of a scene: `the scene has 2 problems`."""
    return "the scene has a problem" if len(problems) == 1 else f"the scene has {len(problems)} problems"


def set_values(sets: list[str] | None) -> dict[str, Node]:
    """Values of `--set KEY=VALUE` by dotted key; null also removes earlier ones below its key. Raises SceneError."""
    values: dict[str, Node] = {}
    problems: list[Problem] = []
    for text in sets or ():
        try:
            key, node = parse_setting(text)
            if node.data is None:
                values = {known: value for known, value in values.items() if not known.startswith(f"{key}.")}
            values[key] = node
        except SceneError as error:
            problems += error.problems
    if problems:
        raise SceneError(problems)
    return values


def claim(out: Path, *ours: str) -> Claim:
    """Claim (lock) the folder of `--out`; it may hold files that match the patterns `ours`; see `claim_folder`."""
    return claim_folder(out, *ours, named=f"--out {out}")


def draw_if_able(draw: Callable[..., object], *about: Any) -> bool:
    """Call `draw(*about)` and return True; without the extra `pictures`, print a complaint (once) and return False."""
    missing = missing_extra("pictures")
    if missing is None:
        draw(*about)
    elif missing not in complaints:
        complaints.add(missing)
        complain(f"no pictures: {missing}")
    return missing is None


def checkout_module(name: str, what: str) -> ModuleType:
    """Import a module that exists only in a checkout of the project, beside the package. Elsewhere raises Refused;
    `what` begins the message."""
    from ocean_sim.parts import PACKAGE

    checkout, path = PACKAGE.parent, Path(name.replace(".", "/"))
    if not (checkout / path).with_suffix(".py").is_file():
        raise Refused(f"{what} in a checkout of the project, in {path.parent}/; use that")
    sys.path.insert(0, str(checkout))
    return import_module(name)


def duration(seconds: float) -> str:
    """A time span in s, as text: `12.3 s`, `4 min 5 s` or `2 h 3 min`."""
    if seconds < 60.0:
        return f"{seconds:.1f} s"
    if seconds < 3600.0:
        return f"{int(seconds // 60)} min {int(seconds % 60)} s"
    return f"{int(seconds // 3600)} h {int(seconds % 3600 // 60)} min"


def must_compute_with(
    library: str | None, asked: str = "runtime.library", cure: str = ", or leave the key out"
) -> None:
    """Raise Anew (restart) if this process computes with another kernel library (Taichi, Quadrants) than `library`,
    unless the environment fixes it. Raise Lacking, with a message that begins with `asked`, the setting, and ends with
    `cure`, its remedy, if `library` is not installed."""
    from ocean_sim import kernel_library

    if library in (None, kernel_library.LIBRARY_NAME) or kernel_library.LIBRARY_VARIABLE in os.environ:
        return
    if installed_version(library) is None:
        raise Lacking(f"{asked}: {library} is not installed here; pip install {library}{cure}")
    raise Anew(library)
