"""Pictures of stability: time step against another setting, a verdict at every point, and the theoretical limits."""

from typing import Any

from ocean_sim.palette import BLUE, ORANGE, RED
from ocean_sim.studies.shared.pareto import label_log_axis

VERDICT_LOOKS = {"stable": (BLUE, "o"), "degraded": (ORANGE, "^"), "stopped": (RED, "X"), "none": ("black", "s")}
LIMIT_LINES = {"acoustic": ("h / c", "-"), "viscous": ("h² / nu", "--"), "force": ("sqrt(h / a)", ":")}


def draw_map(name: str, rows: list[dict[str, Any]]) -> Any:
    """Matplotlib figure of one stability map: time step against setting `name`, a panel for each scheme."""
    from matplotlib.figure import Figure

    schemes = list(dict.fromkeys(row["scheme"] for row in rows))
    values = sorted({row["value"] for row in rows})
    figure = Figure(figsize=(5.0 * len(schemes) + 1.2, 1.6 + 0.6 * len(values) + 1.2), layout="constrained")
    axes = None
    for k, scheme in enumerate(schemes):
        axes = figure.add_subplot(1, len(schemes), k + 1, sharey=axes)
        here = [row for row in rows if row["scheme"] == scheme]
        axes.set_xscale("log")
        low, high = min(row["dt_s"] for row in here) / 2.0, max(row["dt_s"] for row in here) * 3.0
        for limit, (label, style) in LIMIT_LINES.items():
            ends = {values.index(row["value"]): row[f"{limit}_s"] for row in here if row.get(f"{limit}_s")}
            at = sorted(ends) if any(low < end < high for end in ends.values()) else []
            axes.plot([ends[n] for n in at], at, ls=style, marker="|", color="0.45", lw=1.1, label=label)
        for verdict, (colour, mark) in VERDICT_LOOKS.items():
            own = [row for row in here if row["verdict"] == verdict]
            if own or verdict != "none":
                at = [values.index(row["value"]) for row in own]
                axes.plot([row["dt_s"] for row in own], at, mark, color=colour, ms=9, label=verdict)
        axes.set_xlim(low, high)
        label_log_axis(axes.xaxis)
        axes.set_yticks(range(len(values)), [f"{value:g}" for value in values])
        axes.set_ylim(-0.6, len(values) - 0.4)
        axes.set_xlabel("time step [s]")
        axes.set_title(scheme, fontsize="medium")
        axes.grid(alpha=0.25)
        if k == 0:
            axes.set_ylabel(name)
    handles, labels = axes.get_legend_handles_labels() if axes is not None else ([], [])
    figure.legend(handles, labels, loc="outside upper center", ncols=7, fontsize="small")
    return figure
