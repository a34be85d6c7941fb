"""Pictures of error against cost: points of one colour and mark a scheme, the front of the best, and what failed."""

from pathlib import Path
from typing import Any

from ocean_sim.studies.scene_tradeoff import Budget
from ocean_sim.studies.tradeoff import Trial, front

# Okabe & Ito (2008): colours that people with any colour vision tell apart; marks say it again.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
MARKS = ("o", "s", "^", "D", "v", "P")
SPEEDS = {"wall_per_s": "wall seconds", "cpu_per_s": "processor seconds (the machine was busy)"}
LEAST = 1e-6  # an error of nothing still has a place on a logarithmic axis


def draw(path: Path, trial: Trial, rows: list[dict[str, Any]], speed: str) -> None:
    """One case: its error against the time in the column `speed`, and against the number of particles if any."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    axes_of = {speed: f"{SPEEDS[speed]} per simulated second, one thread", "particles": "particles"}
    if not any(row.get("particles") for row in rows):
        del axes_of["particles"]
    figure = Figure(figsize=(7.2 * len(axes_of), 5.4), layout="constrained")
    FigureCanvasAgg(figure)
    for k, (key, label) in enumerate(axes_of.items()):
        axes = figure.add_subplot(1, len(axes_of), k + 1)
        axes.set_xscale("log")
        axes.set_yscale("log")
        there = [row for row in rows if row.get(key)]
        done = [row for row in there if row.get("error") is not None]
        limits(axes, key, trial, there, done)
        scattered(axes, key, trial, done)
        failed(axes, key, trial.schemes, [row for row in there if row.get("error") is None])
        best = [done[i] for i in front([(row[key], height(row)) for row in done])]
        at, error = [row[key] for row in best], [height(row) for row in best]
        axes.step(at, error, where="post", color="black", lw=0.8, zorder=1)
        margins(axes, trial)
        unit = next((row["unit"] for row in done if row["unit"] != "1"), "")
        axes.set_xlabel(label)
        axes.set_ylabel(f"error{f' [{unit}]' if unit else ''}")
        axes.grid(alpha=0.25, which="both", lw=0.4)
        if k == 0:
            axes.legend(fontsize="x-small", loc="best")
    figure.suptitle(f"{trial.case}: {trial.quantity}", fontsize="medium")
    figure.savefig(path, dpi=110)


def height(row: dict[str, Any]) -> float:
    return max(abs(row["error"]), LEAST)


def limits(axes: Any, key: str, trial: Trial, there: list[dict[str, Any]], done: list[dict[str, Any]]) -> None:
    """Room for all points, for peers, and for what failed."""
    wide, high = [row[key] for row in there], [*map(height, done), *trial.peers.values()]
    high += [trial.scatter] if trial.scatter is not None else []
    for each, values in ((axes.set_xlim, wide), (axes.set_ylim, high)):
        if values:
            each(min(values) / 1.6, max(values) * 1.9)


def scattered(axes: Any, key: str, trial: Trial, rows: list[dict[str, Any]]) -> None:
    """Full marks: a scheme as it comes, joined over its resolutions; hollow ones: with another setting."""
    for n, scheme in enumerate(trial.schemes):
        own = [row for row in rows if row["scheme"] == scheme]
        look = {"color": COLOURS[n % len(COLOURS)], "marker": MARKS[n % len(MARKS)]}
        plain = sorted((row for row in own if not row["changed"]), key=lambda row: row[key])
        if plain:
            axes.plot([row[key] for row in plain], [height(row) for row in plain], label=scheme, ms=8, lw=1.2, **look)
        other = [row for row in own if row["changed"]]
        look["markerfacecolor"] = "white"
        axes.plot([row[key] for row in other], [height(row) for row in other], ls="none", ms=6, **look)
        for row in other if key in SPEEDS else ():
            name, value = row["changed"].split("=")
            said = f"{name.split('.')[-1]}={value}"
            axes.annotate(said, (row[key], height(row)), (4, 3), textcoords="offset points", fontsize=5, alpha=0.8)


def failed(axes: Any, key: str, schemes: tuple[str, ...], rows: list[dict[str, Any]]) -> None:
    """Crosses along the upper edge: there is no error to place them by."""
    for n, scheme in enumerate(schemes):
        own = [row[key] for row in rows if row["scheme"] == scheme and row.get(key)]
        if own:
            look = {"color": COLOURS[n % len(COLOURS)], "marker": "x", "ms": 8, "mew": 2, "ls": "none"}
            at = axes.get_xaxis_transform()
            axes.plot(own, [0.97 - 0.04 * n] * len(own), transform=at, label=f"{scheme}, failed", **look)


def margins(axes: Any, trial: Trial) -> None:
    """The scatter of the experiments, and what peers reached."""
    if trial.scatter is not None:
        axes.axhspan(LEAST, trial.scatter, color="0.9", zorder=0, label="scatter of experiments")
    at = axes.get_yaxis_transform()
    for name, error in trial.peers.items():
        axes.axhline(error, color="0.4", ls=":", lw=0.9)
        axes.text(0.99, error, f"{name} particles", transform=at, ha="right", va="bottom", fontsize=6)


def draw_scene(path: Path, rows: list[dict[str, Any]], names: list[str], budget: Budget | None) -> None:
    """Settings of one scene: a panel for each error, with the spread of the seeds, and the budget."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    wide = min(3, len(names))
    high = -(-len(names) // wide)
    figure = Figure(figsize=(5.4 * wide, 4.4 * high), layout="constrained")
    FigureCanvasAgg(figure)
    key = budget.column if budget is not None else "wall_per_s"
    for k, name in enumerate(names):
        axes = figure.add_subplot(high, wide, k + 1)
        axes.set_xscale("log")
        done = [row for row in rows if row.get(name) is not None and row[key]]
        for row in done:
            colour, mark = (COLOURS[1], "s") if row["reference"] else (COLOURS[0], "o")
            at, spread = (row[key], row[name]), row[f"{name}_spread"] or 0.0
            axes.errorbar(*at, yerr=spread, fmt=mark, color=colour, capsize=3)
            said = row["setting"].replace("--set ", "")
            axes.annotate(said, at, (5, 5), textcoords="offset points", fontsize=6)
        edge = [done[i] for i in front([(row[key], row[name]) for row in done])]
        axes.step([r[key] for r in edge], [r[name] for r in edge], where="post", color="black", lw=0.8, zorder=1)
        failed(axes, key, ("settings",), [row | {"scheme": "settings"} for row in rows if row["outcome"] != "done"])
        if budget is not None:
            most = budget.most * 60.0 / 1e3 if budget.name.endswith("ms") else budget.most
            axes.axvline(most, color=COLOURS[2], ls="--", lw=1.2, label=f"budget {budget.name}")
            axes.legend(fontsize="x-small")
        axes.set_xlabel("wall seconds of the run" if key == "wall_s" else "wall seconds per simulated second")
        axes.set_ylabel(f"{name}, beside the reference (square)")
        axes.grid(alpha=0.3)
    figure.savefig(path, dpi=110)
