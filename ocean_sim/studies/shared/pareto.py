"""Pictures of error against cost: points of one colour and mark a scheme, the Pareto front, and failed runs."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ocean_sim.files.atomic_file import new_figure, save_figure
from ocean_sim.palette import SERIES
from ocean_sim.studies.scene_tradeoff import Budget, measure_label
from ocean_sim.studies.tradeoff import Trial, pareto_front

MARK_SHAPES = ("o", "s", "^", "D", "v", "P")
COST_LABELS = {"wall_per_s": "wall seconds", "cpu_per_s": "processor seconds (the machine was busy)"}
CROWDED_AXIS_RATIO = 100.0  # ends of an axis so far apart need no number within a decade
PICTURE_DPI = 110  # of the pictures
# Of a name from its point [points].
NAME_SHIFTS = [(x, y) for y in (4, -9, 12, -17, 20, -25, 28, -33, 36, -41) for x in (5, -5)]
MARK_RADIUS_PIXELS = 4.0  # pixels that a mark takes to each side
MIN_DRAWN_ERROR = 1e-6  # an error of nothing still has a position on a logarithmic axis


def draw_pareto(path: Path, trial: Trial, rows: list[dict[str, Any]], speed: str) -> None:
    """Draw errors in `rows` of a case, `trial`, into a picture file over time (column `speed`) and particles if any."""
    of = f" of {trial.work}" if trial.work else ""
    axes_of = {speed: f"{COST_LABELS[speed]}{of} per simulated second, one thread", "particles": "particles"}
    if not any(row.get("particles") for row in rows):
        del axes_of["particles"]
    figure = new_figure(7.2 * len(axes_of), 5.4)
    for k, (key, label) in enumerate(axes_of.items()):
        axes = figure.add_subplot(1, len(axes_of), k + 1)
        draw_panel(axes, key, trial, rows)
        axes.set_xlabel(label)
        if k == 0:
            axes.legend(fontsize="x-small", loc="best")
    figure.suptitle(f"{trial.case}: {trial.quantity}", fontsize="medium")
    shift_apart(figure)
    save_figure(figure, path, PICTURE_DPI)


def draw_panel(axes: Any, key: str, trial: Trial, rows: list[dict[str, Any]]) -> None:
    """Draw errors of a case, `trial`, in `rows` over column `key`: Pareto front, failed runs, experimental scatter."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    there = [row for row in rows if row.get(key)]
    done = [row for row in there if row.get("error") is not None]
    high = [*map(drawn_error, done), *([trial.scatter] if trial.scatter is not None else [])]
    for set_limits, values in ((axes.set_xlim, [row[key] for row in there]), (axes.set_ylim, high)):
        if values:
            set_limits(min(values) / 1.6, max(values) * 1.9)
    scatter_points(axes, key, trial, done)
    list_failures(axes, key, trial.schemes, [row for row in there if row.get("error") is None])
    best = [done[i] for i in pareto_front([(row[key], drawn_error(row)) for row in done])]
    at, error = [row[key] for row in best], [drawn_error(row) for row in best]
    axes.step(at, error, where="post", color="black", lw=0.8, zorder=1, label="front: none is cheaper and better")
    if trial.scatter is not None:
        axes.axhspan(MIN_DRAWN_ERROR, trial.scatter, color="0.9", zorder=0, label="scatter of experiments")
    unit = next((row["unit"] for row in done if row["unit"] != "1"), "")
    axes.set_ylabel(f"error{f' [{unit}]' if unit else ''}")
    axes.grid(alpha=0.25, which="both", lw=0.4)
    label_log_axis(axes.xaxis)
    label_log_axis(axes.yaxis)


def label_log_axis(axis: Any) -> None:
    """Label a logarithmic Matplotlib axis, x or y, with a few readable numbers; its ends must be set."""
    from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    subs = (1.0, 2.0, 5.0) if high < CROWDED_AXIS_RATIO * low else (1.0,)
    axis.set_major_locator(LogLocator(subs=subs, numticks=9))
    axis.set_major_formatter(FormatStrFormatter("%g"))
    axis.set_minor_formatter(NullFormatter())


def drawn_error(row: dict[str, Any]) -> float:
    """Absolute error of a row, but at least MIN_DRAWN_ERROR, so that a logarithmic axis can show it."""
    return max(abs(row["error"]), MIN_DRAWN_ERROR)


def scatter_points(axes: Any, key: str, trial: Trial, rows: list[dict[str, Any]]) -> None:
    """Draw rows over column `key`, by scheme of `trial`: default settings full and joined by lines, others hollow."""
    for n, scheme in enumerate(trial.schemes):
        own = [row for row in rows if row["scheme"] == scheme]
        look = {"color": SERIES[n % len(SERIES)], "marker": MARK_SHAPES[n % len(MARK_SHAPES)]}
        plain = sorted((row for row in own if not row["changed"]), key=lambda row: row[key])
        if plain:
            at, errors = [row[key] for row in plain], [drawn_error(row) for row in plain]
            axes.plot(at, errors, label=scheme, ms=8, lw=1.2, **look)
        other = [row for row in own if row["changed"]]
        look["markerfacecolor"] = "white"
        axes.plot([row[key] for row in other], [drawn_error(row) for row in other], ls="none", ms=6, **look)
        for row in sorted(other, key=lambda row: row[key]) if key in COST_LABELS else ():
            name, value = row["changed"].split("=")
            name_points(axes, f"{name.split('.')[-1]}={value}", (row[key], drawn_error(row)), fontsize=5, alpha=0.8)
    if any(row["changed"] for row in rows):
        axes.plot([], [], "o", color="0.4", markerfacecolor="white", ms=6, label="hollow: one setting changed")


def name_points(axes: Any, name: str, at: tuple[float, float], **look: Any) -> None:
    """Write a name near the point `at` (data coordinates); `shift_apart` places it later; `look`: text properties."""
    line = {"arrowstyle": "-", "lw": 0.3, "color": "0.6", "shrinkA": 0.0, "shrinkB": 2.0}
    axes.annotate(name, at, NAME_SHIFTS[0], textcoords="offset points", arrowprops=line, in_layout=False, **look)


def shift_apart(figure: Any) -> None:
    """Move the names of points in a figure until they cover neither each other nor points; they stay in their panel."""
    from matplotlib.text import Annotation, Text
    from matplotlib.transforms import Bbox

    figure.set_dpi(PICTURE_DPI)
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    for axes in figure.axes:
        names = [child for child in axes.get_children() if isinstance(child, Annotation) and child.arrow_patch]
        points = [axes.transData.transform(name.xy) for name in names]
        taken = [Bbox([at - MARK_RADIUS_PIXELS, at + MARK_RADIUS_PIXELS]) for at in points]
        if axes.get_legend() is not None:
            taken.append(axes.get_legend().get_window_extent())
        for name in names:
            for shift in NAME_SHIFTS:
                name.set(ha="left" if shift[0] > 0 else "right", x=shift[0], y=shift[1])
                text = Text.get_window_extent(name)  # without its line
                if not text.count_overlaps(taken) and axes.bbox.contains(*text.min) and axes.bbox.contains(*text.max):
                    break
            taken.append(text)


def list_failures(axes: Any, key: str, schemes: Sequence[str], rows: list[dict[str, Any]]) -> None:
    """Draw failed runs, `rows` without error, as crosses by scheme at their value of column `key` along the top."""
    for n, scheme in enumerate(schemes):
        own = [row[key] for row in rows if row["scheme"] == scheme and row.get(key)]
        if own:
            look = {"color": SERIES[n % len(SERIES)], "marker": "x", "ms": 8, "mew": 2, "ls": "none"}
            at = axes.get_xaxis_transform()
            axes.plot(own, [0.97 - 0.04 * n] * len(own), transform=at, label=f"{scheme}, failed", **look)


def draw_scene(path: Path, rows: list[dict[str, Any]], names: list[str], budget: Budget | None) -> None:
    """Draw a scene's settings, `rows`, to a file: a panel of time against each error of `names`, spread and budget."""
    names = [name for name in names if any(row.get(name) is not None for row in rows)]
    wide = min(3, len(names))
    high = -(-len(names) // wide)
    figure = new_figure(5.4 * wide, 4.4 * high)
    key = "wall_per_s"
    if budget is not None:
        key, rows = "time", [row | {"time": budget.seconds(row)} for row in rows]
    for k, name in enumerate(names):
        axes = figure.add_subplot(high, wide, k + 1)
        axes.set_xscale("log")
        done = [row for row in rows if row.get(name) is not None and row[key]]
        for row in sorted(done, key=lambda row: row[key]):
            colour, mark = (SERIES[1], "s") if row["reference"] else (SERIES[0], "o")
            at, spread = (row[key], row[name]), row[f"{name}_spread"] or 0.0
            axes.errorbar(*at, yerr=spread, fmt=mark, color=colour, capsize=3)
            name_points(axes, row["setting"].replace("--set ", ""), at, fontsize=6)
        edge = [done[i] for i in pareto_front([(row[key], row[name]) for row in done])]
        axes.step([r[key] for r in edge], [r[name] for r in edge], where="post", color="black", lw=0.8, zorder=1)
        lost = [row | {"scheme": "settings"} for row in rows if row["outcome"] != "done"]
        list_failures(axes, key, ("settings",), lost)
        if budget is not None:
            most = budget.most * 60.0 / 1e3 if budget.name.endswith("ms") else budget.most
            axes.axvline(most, color=SERIES[2], ls="--", lw=1.2, label=f"budget {budget.name}")
            axes.legend(fontsize="x-small")
        axes.set_xlabel("wall seconds per simulated second" if budget is None else "seconds that the budget limits")
        axes.set_ylabel(f"{measure_label(name)}, against the reference (square)")
        axes.grid(alpha=0.3)
        label_log_axis(axes.xaxis)
    shift_apart(figure)
    save_figure(figure, path, PICTURE_DPI)
