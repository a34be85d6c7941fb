"""`ocean-sim validate`: problems with known answers, in a table, a CSV file and a picture a case."""

import signal
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from fnmatch import filter as matching
from math import ceil
from multiprocessing import active_children, get_context, parent_process
from pathlib import Path
from typing import Any

import typer

from ocean_sim.files.atomic_file import atomic_write, new_figure, save_figure
from ocean_sim.files.csv_file import write_table
from ocean_sim.machine import available_cores, exit_after
from ocean_sim.parts import kinds
from ocean_sim.reading.translation import choice_sentence
from ocean_sim.validation import case_names, problems
from ocean_sim.validation.shared.case import COARSE_BASIS, ROW_KEYS, Curve, Finding, Problem
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.options import Sets, completion

TOO_LONG, NOT_COARSE = "takes too long for a gate", "has no coarse set-up"
PANELS_IN_ROW = 4
LINE_STYLES, MARKER_STYLES = ("-", "--", ":", "-."), (".", "^", "s", "x", "+")


def validate(
    cases: list[str] | None = typer.Argument(
        None,
        help="Cases, or patterns such as 'open_*'; by default all (ocean-sim list cases).",
        autocompletion=completion(case_names),
    ),
    schemes: list[str] | None = typer.Option(
        None, "--scheme", help="A kind of fluid or ship; give it twice to compare two. By default delta_sph."
    ),
    slow: bool = typer.Option(
        False, "--slow", help="Also run the set-ups that take minutes; with --coarse, those too long for a gate."
    ),
    coarse: bool = typer.Option(
        False, "--coarse", help="A gate for CI: twice the spacing or more, tolerances of its own, no long cases."
    ),
    sets: Sets = None,
    out: Path = typer.Option(Path("runs/validate"), help="Where validate.csv and the pictures go."),
    junit: Path | None = typer.Option(None, help="Also write a report in JUnit's XML, which CI services read."),
    workers: int | None = typer.Option(None, min=1, help="Cases at a time; by default one per core."),
) -> int:
    """Run cases under schemes and report; the exit code is 1 where a promise was missed."""
    with console.claim(out, "validate.csv", "*.png"):
        cases, schemes, sets = cases or [], schemes or [], sets or []
        if junit is not None and junit.is_dir():
            raise console.Refused(f"--junit {junit}: this is a folder, not a file")
        wanted = [name for case in cases for name in matching(case_names(), case) or [case]] or case_names()
        known_schemes = [*kinds("fluid"), *kinds("ship")]
        for what, given, known in (("case", wanted, case_names()), ("scheme", schemes, known_schemes)):
            for name in given:
                if name not in known:
                    raise console.Refused(f"there is no {what} {name!r}{choice_sentence(name, known)[0]}")
        overrides = console.set_values(sets)
        plan = {case: scheme_pairs(case, schemes, slow, coarse) for case in wanted}
        for case in (name for name in cases if name in wanted):  # a pattern takes what there is
            if not problems(case, slow=slow, coarse=coarse):
                if not problems(case, slow=True, coarse=coarse):
                    raise console.Refused(f"{case} {NOT_COARSE}: leave --coarse out")
                cure = f"{TOO_LONG}: add --slow" if coarse else "takes minutes: add --slow (or --coarse)"
                raise console.Refused(f"{case} {cure}")
        for problem, scheme in [pair for pairs in plan.values() for pair in pairs]:
            problem.load(scheme, overrides)  # what is wrong is reported before anything runs
        rows: list[dict[str, Any]] = []
        orders = [(case, schemes, slow, coarse, sets, out) for case, pairs in plan.items() if pairs]
        for found in case_answers(orders, workers or available_cores()):
            rows += found
            columns = ["scheme", "quantity", "value", "reference", "error", "tolerance", "", "source"]
            console.table(f"\n{found[0]['case']}", columns, [row_line(row) for row in found])
        write_table(out / "validate.csv", ROW_KEYS, ([row[key] for key in ROW_KEYS] for row in rows))
        missed = [row for row in rows if not row["ok"]]
        console.answer(rows)
        for sentence in omission_sentences(plan, schemes, coarse):
            console.say(f"\n{sentence}")
        promised = sum(row["tolerance"] is not None for row in rows)
        kept = f"{promised - len(missed)} of {promised} tolerances kept"
        kept += f", {sum(COARSE_BASIS in row['source'] for row in rows)} for regressions only" if coarse else ""
        console.say(f"\n{kept}; {out / 'validate.csv'} and pictures")
        if junit is not None:
            write_junit(junit, rows)
            console.say(str(junit))
        return 1 if missed else 0


def scheme_pairs(case: str, schemes: list[str], slow: bool, coarse: bool) -> list[tuple[Problem, str]]:
    """Pairs (set-up, scheme) of a case, sorted by scheme: those that will run; `slow`, `coarse`: see `problems`."""
    found = problems(case, slow=slow, coarse=coarse)
    pairs = [(problem, scheme) for problem in found for scheme in problem.schemes_for(schemes)]
    return sorted(pairs, key=lambda pair: (schemes or pair[0].schemes).index(pair[1]))


Order = tuple[str, list[str], bool, bool, list[str], Path]
"""A case, its schemes, --slow, --coarse, --set and where its picture goes: plain data, for another process."""


def case_answer(order: Order) -> list[dict[str, Any]]:
    """Run the case of an `Order` (job description) under its schemes, draw its picture; a table row for each result."""
    case, schemes, slow, coarse, sets, out = order
    overrides, rows, runs = console.set_values(sets), [], []
    for problem, scheme in scheme_pairs(case, schemes, slow, coarse):
        found, finding = problem.run(case, scheme, overrides)
        rows += found
        runs.append((problem, scheme, finding))
    console.draw_if_able(draw_case, out / f"{case}.png", case, runs)
    return rows


def case_answers(orders: list[Order], workers: int) -> Iterator[list[dict[str, Any]]]:
    """Yield the result rows of each case in `orders` (job descriptions), run in `workers` processes (1: in this)."""
    workers = min(workers, len(orders))
    if workers < 2:
        yield from map(case_answer, orders)
        return
    threads = f"runtime.threads={max(1, available_cores() // workers)}"
    shared = [(*order[:4], [threads, *order[4]], order[5]) for order in orders]
    with ProcessPoolExecutor(workers, get_context("spawn"), prepare_worker) as pool:
        futures = [pool.submit(case_answer, order) for order in shared]
        try:
            for future in futures:
                yield future.result()
        except BrokenProcessPool:
            why = "a process that ran a case died, as happens where memory runs out; try --workers 1"
            raise console.Failed(why) from None
        except BaseException:  # what still runs after Ctrl-C or an error is of no use
            for child in active_children():
                child.terminate()
            raise


def prepare_worker() -> None:
    """Let this worker process end with its parent, and silently on Ctrl-C; the pool calls this in each worker."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    parent = parent_process()
    assert parent is not None
    exit_after(parent.join)


def omission_sentences(plan: dict[str, list[tuple[Problem, str]]], schemes: list[str], coarse: bool) -> Iterator[str]:
    """Yield sentences on set-ups of cases that are left out, and why; `plan`: (set-up, scheme) pairs run, by case."""
    slow: dict[str, list[str]] = {}
    for case, pairs in plan.items():
        ran = {problem.name for problem, _ in pairs}
        every = problems(case, slow=True, coarse=coarse)
        more = dict.fromkeys(p.name for p in every if p.schemes_for(schemes) and p.name not in ran)
        if more:
            slow[case] = list(more) if pairs else []
        elif coarse and not every:
            yield f"{case} {NOT_COARSE}"
        elif not pairs:
            yield f"{case}: nothing to run under these schemes"
    if slow:
        why = "they take too long for a gate, or have no tolerance" if coarse else "they take minutes"
        names = [f"{case} ({'; '.join(more)})" if more else case for case, more in slow.items()]
        yield f"left out, as {why} (--slow adds them): {', '.join(names)}"


def row_line(row: dict[str, Any]) -> list[str]:
    unit = "" if row["unit"] == "1" or row["error"] is None else f" {row['unit']}"
    verdict = "reported" if row["tolerance"] is None else "ok" if row["ok"] else "MISSED"
    value, reference, error = (console.cell(row[key], "-") for key in ("value", "reference", "error"))
    numbers = [value, reference, error + unit, console.cell(row["tolerance"])]
    return [row["scheme"], row["quantity"], *numbers, verdict, row["source"]]


def write_junit(path: Path, rows: list[dict[str, Any]]) -> None:
    """Write the rows as JUnit XML: a suite per case and a test per row, marked as skipped if it has no tolerance."""
    from xml.etree.ElementTree import Element, ElementTree, SubElement, indent

    suites = Element("testsuites", tests=str(len(rows)), failures=str(sum(not row["ok"] for row in rows)))
    for case in dict.fromkeys(row["case"] for row in rows):
        own = [row for row in rows if row["case"] == case]
        failures = str(sum(not row["ok"] for row in own))
        suite = SubElement(suites, "testsuite", name=case, tests=str(len(own)), failures=failures)
        for row in own:
            test = SubElement(suite, "testcase", classname=f"{case}.{row['scheme']}", name=row["quantity"])
            shown = " ".join(filter(None, row_line(row)[2:]))
            if row["tolerance"] is None:
                SubElement(test, "skipped", message=shown)
            elif not row["ok"]:
                SubElement(test, "failure", message=shown)
    indent(suites)
    path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_write(path) as draft:
        ElementTree(suites).write(draft, encoding="utf-8", xml_declaration=True)


def draw_case(path: Path, case: str, runs: list[tuple[Problem, str, Finding]]) -> None:
    """Draw runs (set-up, scheme, finding) of a case into a file; no file if no run has curves or diverged."""
    panels = list(dict.fromkeys(problem.name for problem, _, found in runs if found.measured or not found.numbers))
    if not panels:
        return
    across = min(len(panels), PANELS_IN_ROW)
    down = ceil(len(panels) / across)
    schemes = list(dict.fromkeys(scheme for _, scheme, _ in runs))
    figure = new_figure(6.4 * across, 4.8 * down)
    for k, name in enumerate(panels):
        axes = figure.add_subplot(down, across, k + 1)
        here = [(scheme, found) for problem, scheme, found in runs if problem.name == name]
        for scheme, found in here:
            for n, curve in enumerate(found.measured):
                plot_curve(axes, curve, f"{scheme}: {curve.label}", f"C{schemes.index(scheme)}", n)
        shown = next((found for _, found in here if found.measured), None)
        if shown is None:
            axes.text(0.5, 0.5, "diverged", ha="center", transform=axes.transAxes)
        else:
            for n, curve in enumerate(shown.expected):
                plot_curve(axes, curve, curve.label, "black", n)
            axes.set(xlabel=shown.axes[0], ylabel=shown.axes[1])
            axes.set_aspect("equal" if shown.equal_axes else "auto", "datalim")
            axes.legend(fontsize="x-small")
        axes.set_title(f"{case}: {name}" if name else case)
        axes.grid(alpha=0.3)
    save_figure(figure, path)


def plot_curve(axes: Any, curve: Curve, label: str, colour: str, n: int) -> None:
    """Plot a curve as a line or points on Matplotlib axes; `n`: index in LINE_STYLES or MARKER_STYLES."""
    dots = {"linestyle": "none", "marker": MARKER_STYLES[n % len(MARKER_STYLES)], "markersize": 3}
    line = {"linestyle": LINE_STYLES[n % len(LINE_STYLES)], "linewidth": 1.2}
    axes.plot(curve.x, curve.y, label=label, color=colour, **(dots if curve.points else line))
