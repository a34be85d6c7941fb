"""`ocean-sim figure` and `gallery`: the figures of the thesis, each by its script in a process of its own, as CSV and
PNG; and the pictures of the README."""

import ast
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import typer

from ocean_sim.machine import missing_extra
from ocean_sim.parts import PACKAGE, library
from ocean_sim.reading.translation import choice_sentence
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.bar import Bar
from ocean_sim.verbs.shared.options import completion

PROGRESS_LINE = re.compile(r" *(\d+)%  (.*)")  # how a script reports its progress
ALL_FIGURES = "all"  # of the thesis, and its errata; our own studies are drawn by their names


def figure_scripts() -> dict[str, Path]:
    """Path of each figure's script, in the order of the thesis: `6-3` is figures/fig6_3.py."""
    scripts = library("figures").glob("[!_]*.py")
    found = {re.sub(r"^fig(\d+)_(\d+)$", r"\1-\2", path.stem).replace("_", "-"): path for path in scripts}
    # By chapter and number; names without numbers come last.
    order = lambda name: ([int(part) if part.isdigit() else 99 for part in name.split("-")], name)
    return {name: found[name] for name in sorted(found, key=order)}


def figure_sentence(path: Path) -> str:
    """First paragraph of a script's docstring, on one line."""
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return " ".join(text.split("\n\n")[0].split())


def figure(
    names: list[str] = typer.Argument(
        help="Figures such as 6-3, or `all` of the thesis (ocean-sim list figures).",
        autocompletion=completion(lambda: (*figure_scripts(), ALL_FIGURES)),
    ),
    fast: bool = typer.Option(False, "--fast", help="Coarse and short, for a quick look."),
    out: Path = typer.Option(Path("runs/figures"), help="Where data (CSV) and pictures (PNG) go."),
) -> int:
    """Draw figures one after the other and report; the exit code is 1 where one failed, and the others are there."""
    with console.claim(out):
        known = figure_scripts()
        if missing := missing_extra("pictures"):
            raise console.Lacking(f"figures are pictures: {missing}")
        for name in names:
            if name not in known and name != ALL_FIGURES:
                raise console.Refused(f"there is no figure {name!r}{choice_sentence(name, [*known, ALL_FIGURES])[0]}")
        theirs = [name for name in known if name[0].isdigit() or name == "errata"] if ALL_FIGURES in names else []
        wanted = list(dict.fromkeys([*theirs, *(name for name in names if name != ALL_FIGURES)]))
        bar = Bar(len(wanted))
        done: list[dict[str, Any]] = []
        try:
            for name in wanted:
                console.say(f"[{len(done) + 1}/{len(wanted)}] {figure_sentence(known[name])}")
                show = lambda share, text: bar.show(len(done) + share, text)
                done.append(draw_figure(name, known[name], fast, out, show))
                last = done[-1]
                what = ", ".join(map(str, last["files"])) if last["ok"] else f"FAILED: {last['error']}"
                console.say(f"      {console.duration(last['wall_s'])}  {what}")
        finally:
            bar.close()
        failed = [row["figure"] for row in done if not row["ok"]]
        console.answer(done)
        if failed and not console.json_asked:
            console.complain(f"{len(failed)} of {len(done)} figures failed: {', '.join(failed)}")
        return 1 if failed else 0


def draw_figure(name: str, script: Path, fast: bool, out: Path, show: Callable[[float, str], None]) -> dict[str, Any]:
    """Run a figure's script (coarse if `fast`) in a child process and move its files to `out`; `show(share, text)`
    receives its progress, 0 to 1. Returns the figure's name, success, wall time [s], files and error message."""
    began = perf_counter()
    paths = os.pathsep.join([str(PACKAGE.parent), *filter(None, [os.environ.get("PYTHONPATH")])])
    with TemporaryDirectory(prefix=".figure-", dir=out) as folder:
        command = [sys.executable, str(script), "--out", folder, *(["--fast"] if fast else [])]
        environment = os.environ | {"PYTHONPATH": paths}
        streams: Any = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
        last = ""
        with subprocess.Popen(command, text=True, errors="replace", env=environment, **streams) as child:
            try:
                for line in child.stderr or ():
                    share = PROGRESS_LINE.fullmatch(line.rstrip("\n"))
                    if share is not None:
                        show(int(share[1]) / 100.0, f"{name}: {share[2]}")
                    elif line.strip():
                        last = line.strip()
            except BaseException:
                child.kill()
                raise
        code = child.returncode
        files = [path.replace(out / path.name) for path in sorted(Path(folder).iterdir())] if code == 0 else []
    error = "" if files else last or (f"its process died ({code})" if code else "it wrote nothing")
    return {"figure": name, "ok": bool(files), "wall_s": perf_counter() - began, "files": files, "error": error}


def gallery(
    names: list[str] | None = typer.Argument(None, help="Pictures; by default those that are out of date."),
    check: bool = typer.Option(False, "--check", help="Only list those that are out of date, with their commands."),
    every: bool = typer.Option(False, "--all", help="Make all of them."),
    out: Path | None = typer.Option(None, help="Where to write; by default figures/gallery of this checkout."),
) -> int:
    """Make pictures that are old, or those named; `check`: only list them. The exit code is 1 where some are old."""
    program = console.checkout_module("figures.gallery.redraw", "gallery: the program that makes the pictures is")
    return program.redraw(names or [], check, every, out)
