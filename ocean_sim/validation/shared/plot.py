"""One picture a case: measured over expected curves, a panel for each of its set-ups."""

from math import ceil
from pathlib import Path
from typing import Any

from ocean_sim.files.atomic_file import save_figure
from ocean_sim.validation.shared.case import Curve, Finding, Problem

PANELS_IN_ROW = 4
LINE_STYLES, MARKER_STYLES = ("-", "--", ":", "-."), (".", "^", "s", "x", "+")


def draw(path: Path, case: str, runs: list[tuple[Problem, str, Finding]]) -> None:
    """Draw runs (set-up, scheme, finding) of a case into a file; none is written if no run has curves or diverged."""
    from matplotlib.figure import Figure

    panels = list(dict.fromkeys(problem.name for problem, _, found in runs if found.measured or not found.numbers))
    if not panels:
        return
    across = min(len(panels), PANELS_IN_ROW)
    down = ceil(len(panels) / across)
    schemes = list(dict.fromkeys(scheme for _, scheme, _ in runs))
    figure = Figure(figsize=(6.4 * across, 4.8 * down), layout="constrained")
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
            axes.legend(fontsize="x-small")
        axes.set_title(f"{case}: {name}" if name else case)
        axes.grid(alpha=0.3)
    save_figure(figure, path)


def plot_curve(axes: Any, curve: Curve, label: str, colour: str, n: int) -> None:
    """Plot a curve as a line or points on Matplotlib axes; `n`: index of its style in LINE_STYLES or MARKER_STYLES."""
    dots = {"linestyle": "none", "marker": MARKER_STYLES[n % len(MARKER_STYLES)], "markersize": 3}
    line = {"linestyle": LINE_STYLES[n % len(LINE_STYLES)], "linewidth": 1.2}
    axes.plot(curve.x, curve.y, label=label, color=colour, **(dots if curve.points else line))
