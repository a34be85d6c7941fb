"""Limits at which water breaks: time steps and one more setting are taken past them; every point ends with a verdict.

stopped: `health`, or the scheme itself, ended the run with a reason. degraded: it went on, but the water gained more
than 1 % of its mass times the square of its reference speed from nowhere (under a wind: beyond what the wind gave it),
or its mean density rose too far above that at rest: 5 %, or three times the compression that the scene allows. stable:
neither. A run whose process gave no answer has no verdict, which is a bug.

A map is a picture: time step against another setting, the verdict at every point, and the theoretical limits.
"""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ocean_sim.files.atomic_file import new_figure
from ocean_sim.files.yaml_file import SceneError, read_mapping
from ocean_sim.model import Model
from ocean_sim.palette import BLUE, ORANGE, RED
from ocean_sim.parts import compared
from ocean_sim.reading.scene import SceneConfig, load
from ocean_sim.result import Result
from ocean_sim.studies import reads_key
from ocean_sim.studies.shared.pareto import label_log_axis
from ocean_sim.studies.shared.scene_run import PICTURE_OBSERVERS, run_order, unwrapped_table
from ocean_sim.studies.shared.study import Point

PLAN: dict[str, Any] = read_mapping(Path(__file__).with_suffix(".yaml")).plain()
COLUMN_SCENE, AFLOAT_SCENE, STEP_FACTORS = PLAN["column"], PLAN["afloat"], PLAN["step_factors"]
AFLOAT_BOX_MASS = 640.0  # [kg] of the water in the box afloat
MIN_STEPS, MAX_STEPS = 20, {True: 4000, False: 20_000}  # steps of a run
MAX_ENERGY_GAIN, MAX_COMPRESSION, MAX_OVER_ALLOWED = 0.01, 0.05, 3.0
MAX_RUN_SECONDS = {True: 300.0, False: 3600.0}  # wall time [s] of a run
VERDICT_WORDS = ("stable", "degraded", "stopped", "none")
VERDICT_LOOKS = {"stable": (BLUE, "o"), "degraded": (ORANGE, "^"), "stopped": (RED, "X"), "none": ("black", "s")}
LIMIT_LINES = {"acoustic": ("h / c", "-"), "viscous": ("h² / nu", "--"), "force": ("sqrt(h / a)", ":")}


class Axis(Model):
    """Quantity that a stability map varies: name, scene key, unit, and values for the quick and the full study."""

    name: str
    key: str
    unit: str
    quick: list[float]
    full: list[float]
    of: str = "fluid"
    quick_steps: list[float] = STEP_FACTORS["quick"]

    def settings(self, value: float) -> dict[str, Any]:
        """Scene settings, by key, that give the varied quantity this value."""
        if self.name == "wind":
            everywhere = [{"kind": "box", "half_size": [1e4, 1e4, 1e4]}]
            volume = {"include": everywhere, "acceleration": [value, 0.0, 0.0]}
            return {"wind": {"kind": "gusts", "volumes": [volume]}} if value else {}
        return {self.key: value * AFLOAT_BOX_MASS if self.name == "mass ratio" else value}


EXTREME_AXES = tuple(Axis(**keys) for keys in PLAN["axes"])


@dataclass(frozen=True)
class Spot(Point):
    """One run of a stability map: a scheme, a value of the varied setting, and a time step."""

    axis: Axis
    scheme: str
    value: float
    factor: float
    dt: float  # [s]
    limits: dict[str, float]  # [s] lengths and speeds alone, without any safety factor
    scene: SceneConfig

    def rows(self, answer: dict[str, Any], run: Result) -> list[dict[str, Any]]:
        """Table row, in a list, of this run with results `answer`: setting, time step, limits, verdict, clock times."""
        accuracy, driven = unwrapped_table(run, "accuracy"), self.axis.name == "wind"
        outcome, why, numbers = verdict_of(answer, accuracy, self.scene, driven)
        point = {"map": self.axis.name, "scheme": self.scheme, "key": self.axis.key, "value": self.value}
        steps = {"dt_over_courant": self.factor, "dt_s": self.dt} | {f"{k}_s": v for k, v in self.limits.items()}
        clock = {"simulated_s": answer.get("simulated_s"), "wall_s": answer.get("wall_s")}
        return [point | steps | {"verdict": outcome, "reason": why} | numbers | clock]


def grid_points(quick: bool, scene: str | None = None) -> list[Spot]:
    """All runs of all stability maps, of the study's own scenes, or of a user's `scene` (SceneError if that is
    invalid). `quick`: fewer values and time steps, shorter runs."""
    return [spot for axis in EXTREME_AXES for spot in _axis_points(axis, quick, scene)]


def _axis_points(axis: Axis, quick: bool, scene: str | None) -> Iterator[Spot]:
    """Yield the runs (`Spot`) of the map of time step against the setting `axis`, fewer if `quick`. A user's `scene`
    has none if its water has no particles or the setting is a ship's."""
    afloat, theirs = axis.of == "ship", None if scene is None else load(scene).fluid
    if theirs is not None and (afloat or not theirs.made_of_particles):
        return  # a hull has a mass of its own, and water without particles cannot become unstable
    schemes = ("delta_sph",) if afloat else compared("fluid") if theirs is None else (theirs.kind,)
    for scheme in (scheme for scheme in schemes if reads_key(scheme, axis.key)):
        column = COLUMN_SCENE | {"fluid": COLUMN_SCENE["fluid"] | {"kind": scheme}}
        base: Any = scene or (AFLOAT_SCENE if afloat else column)
        own: dict[str, Any] = dict.fromkeys(PICTURE_OBSERVERS) | {"time_step": {"kind": "courant"}}
        for value in axis.quick if quick else axis.full:
            try:
                calm = load(base, own | axis.settings(value))
            except SceneError:
                if scene is None:
                    raise
                continue  # this water has no such setting
            limits = calm.fluid.still_limits(calm.preflight)
            step = calm.time_step.build().next(limits)
            finite = {name: limit for name, limit in asdict(limits).items() if np.isfinite(limit)}
            for factor in axis.quick_steps if quick else STEP_FACTORS["full"]:
                dt = factor * step
                short = {"duration": min(max(calm.duration, MIN_STEPS * dt), MAX_STEPS[quick] * dt)}
                fixed = {"time_step": {"kind": "fixed", "dt": dt}}
                scene_at = load(base, own | axis.settings(value) | fixed | short)
                yield Spot(run_order(scene_at, 1), axis, scheme, value, factor, dt, finite, scene_at)


def verdict_of(
    answer: dict[str, Any], accuracy: dict[str, np.ndarray], scene: SceneConfig, driven: bool
) -> tuple[str, str, dict[str, float]]:
    """Verdict (one of VERDICT_WORDS) on a run, its reason, and by name its energy gain and greatest mean compression.
    `answer`: outcome and reason; `accuracy`: columns of accuracy.csv; `driven`: True if wind drives the water."""
    gain = energy_gain(accuracy, scene, driven)
    dense = float(np.max(accuracy.get("compression_mean", [0.0]), initial=0.0))
    numbers = {"energy_gain": gain, "compression_mean": dense}
    if answer["outcome"] not in ("done", "stopped"):
        return "none", answer["reason"], numbers
    if answer["outcome"] == "stopped":
        return "stopped", answer["reason"], numbers
    allowed = max(MAX_COMPRESSION, MAX_OVER_ALLOWED * scene.fluid.compression_asked)
    if not gain <= MAX_ENERGY_GAIN:
        why = f"energy from nowhere: {100.0 * gain:.3g} % of m v^2 (bound {100.0 * MAX_ENERGY_GAIN:g} %)"
        return "degraded", why, numbers
    if not dense <= allowed:
        return "degraded", f"mean compression {100.0 * dense:.3g} % (bound {100.0 * allowed:.3g} %)", numbers
    return "stable", "", numbers


def energy_gain(accuracy: dict[str, np.ndarray], scene: SceneConfig, driven: bool) -> float:
    """Greatest energy gained without work, over mass times squared reference speed; 0 if `accuracy` (accuracy.csv) is
    empty. Only the wind's work, if `driven`, is subtracted: walls at rest do none, though single forces may seem to."""
    if not len(accuracy.get("kinetic_energy_J", ())):
        return 0.0
    names = ("kinetic_energy_J", "potential_energy_J", "internal_energy_J")
    total = np.sum([accuracy[name] for name in names], axis=0)
    excess = total - total[0] - (accuracy["work_wind_J"] if driven else 0.0)
    tank, fluid, spacing = scene.preflight.tank, scene.fluid, scene.preflight.spacing
    assert spacing is not None
    mass = fluid.rest_density * scene.preflight.particles * spacing**tank.dimension
    return float(excess.max()) / (mass * fluid.speed(tank) ** 2)


def map_summary(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Summary rows, one per scheme and value of the setting: longest stable and shortest unstable step, and limits."""
    found = []
    for key in dict.fromkeys((row["map"], row["scheme"], row["value"]) for row in rows):
        here = [row for row in rows if (row["map"], row["scheme"], row["value"]) == key]
        first = min((row["dt_over_courant"] for row in here if row["verdict"] != "stable"), default=None)
        held = [row["dt_over_courant"] for row in here if first is None or row["dt_over_courant"] < first]
        longest = max(held, default=None)
        step = here[0]["dt_s"] / here[0]["dt_over_courant"]
        line = {"map": key[0], "scheme": key[1], "value": key[2], "courant_s": step, "stable_to": longest}
        verdict = next((r["verdict"] for r in here if r["dt_over_courant"] == first), "")
        line |= {"first_break": first, "verdict": verdict}
        for name in ("acoustic", "viscous", "force"):
            limit = here[0].get(f"{name}_s")
            line[f"{name}_number"] = longest * step / limit if limit and longest else None
        found.append(line)
    return found


def draw_map(name: str, rows: list[dict[str, Any]]) -> Any:
    """Matplotlib figure of one stability map: time step against setting `name`, a panel for each scheme."""
    schemes = list(dict.fromkeys(row["scheme"] for row in rows))
    values = sorted({row["value"] for row in rows})
    figure = new_figure(5.0 * len(schemes) + 1.2, 1.6 + 0.6 * len(values) + 1.2)
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
