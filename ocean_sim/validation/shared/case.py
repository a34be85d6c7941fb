"""A validation case: promised numbers, set-ups to run, and the verdict on a run under a scheme."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ocean_sim.conventions import Diverged
from ocean_sim.parts import kinds
from ocean_sim.reading.scene import SceneConfig, load, observer_names
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.tables import coarse_tolerances, too_long_for_gate

ROW_KEYS = ("case", "scheme", "quantity", "value", "reference", "error", "unit", "tolerance", "ok", "source")
COARSE_BASIS = "coarse: the measured error plus a quarter"

Number = tuple[float | None, float | None, float | None]
"""Value, reference and error of a quantity (`Promise`); None where it could not be measured or has no reference."""


@dataclass(frozen=True)
class Promise:
    """A quantity that a case measures: name, unit of its error, source of its reference, and tolerance by scheme."""

    quantity: str
    unit: str
    source: str
    tolerance: Mapping[str, float] = field(default_factory=dict)
    """Tolerance by scheme; the error of any other scheme is only reported."""

    def row(self, case: str, scheme: str, value: float | None, reference: float | None, error: float | None) -> dict:
        """Row (keys ROW_KEYS) of the results table for a run of `case` (its name) under a scheme, with measured value,
        reference and error (in `unit`). An `error` of None exceeds any tolerance."""
        tolerance = self.tolerance.get(scheme)
        ok = tolerance is None or (error is not None and bool(abs(error) <= tolerance))
        numbers = [None if number is None else float(number) for number in (value, reference, error)]
        cells = (case, scheme, self.quantity, *numbers, self.unit, tolerance, ok, self.source)
        return dict(zip(ROW_KEYS, cells, strict=True))

    def coarsened(self, case: str) -> "Promise":
        """Copy with the tolerances in data/coarse.csv for this quantity in a coarse `case`; itself if it has none."""
        own = coarse_tolerances().get((case, self.quantity))
        if own is None:
            return self
        return replace(self, tolerance={**self.tolerance, **own}, source=f"{self.source}; {COARSE_BASIS}")


@dataclass(frozen=True)
class Curve:
    """A curve to plot: label and coordinates, drawn as a line or as `points`."""

    label: str
    x: np.ndarray
    y: np.ndarray
    points: bool = False


@dataclass(frozen=True)
class Finding:
    """Results of a run: `numbers`, one for each `Promise` (a quantity; none if it diverged), and curves to plot."""

    numbers: Sequence[Number]
    measured: list[Curve] = field(default_factory=list)
    expected: list[Curve] = field(default_factory=list)
    axes: tuple[str, str] = ("", "")
    equal_axes: bool = False  # one scale for both, as a track on the water needs


@dataclass(frozen=True)
class Problem:
    """One set-up of a validation case: its scene, quantities (`Promise`), and the function that measures them."""

    scene: dict[str, Any]
    promises: tuple[Promise, ...]
    measure: Callable[[Simulation], Finding]  # runs a simulation that has just been built, and measures it
    name: str = ""  # name of the set-up, if its case has several
    slow: bool = False
    slot: str = "fluid"  # slot of the scene that the scheme is a kind of
    schemes: tuple[str, ...] = ("delta_sph",)
    """Schemes that run by default. Every kind of fluid can run what `delta_sph` runs; else no other scheme can."""

    def load(self, scheme: str, overrides: Mapping[str, Any] | None = None) -> SceneConfig:
        """Read the scene with this scheme, and with settings `overrides` (value by key), but without observers."""
        part = self.scene[self.slot] | {"kind": scheme}
        return load_without_observers(self.scene | {self.slot: part}, overrides)

    def schemes_for(self, asked: list[str]) -> list[str]:
        """Schemes among those `asked` that fit the set-up; its default schemes if none are asked for."""
        fitting = kinds("fluid") if "delta_sph" in self.schemes else self.schemes
        return [scheme for scheme in asked if scheme in fitting] if asked else list(self.schemes)

    def run(self, case: str, scheme: str, overrides: Mapping[str, Any] | None = None) -> tuple[list[dict], Finding]:
        """Run under a scheme, with settings `overrides` (value by key), and measure: rows of the results table for
        `case` (its name), and Finding; no numbers if the run diverged."""
        try:
            with Simulation(self.load(scheme, overrides)) as simulation:
                found = self.measure(simulation)
        except Diverged as failure:
            missing = [promise.row(case, scheme, None, None, None) for promise in self.promises]
            return [row | {"source": f"{row['source']}; the run diverged: {failure}"} for row in missing], Finding(())
        pairs = zip(self.promises, found.numbers, strict=True)
        return [promise.row(case, scheme, *number) for promise, number in pairs], found

    def coarsened(self, case: str) -> "Problem":
        """Copy with tolerances of the coarse `case` of this name; slow if listed as too long for a gate, or without."""
        promises = tuple(promise.coarsened(case) for promise in self.promises)
        judged = any(scheme in promise.tolerance for promise in promises for scheme in self.schemes)
        slow = self.slow or not judged or (case, self.name) in too_long_for_gate()
        return replace(self, promises=promises, slow=slow)


def load_without_observers(scene: dict[str, Any], overrides: Mapping[str, Any] | None = None) -> SceneConfig:
    """Read a scene, with settings `overrides` by key, and drop all observers except the manifest."""
    return load(scene | {name: None for name in observer_names() if name != "manifest"}, dict(overrides or {}))


def other_simulation(simulation: Simulation, scene: dict[str, Any]) -> Simulation:
    """Simulation of another scene, without observers, with the runtime settings of the given one."""
    return Simulation(load_without_observers(scene | {"runtime": simulation.scene.resolved()["runtime"]}))


def percent_error(value: float, reference: float) -> Number:
    """Number (value, reference, error) with the error in percent of the reference."""
    return value, reference, 100.0 * (value / reference - 1.0)


def absolute_error(value: float, reference: float = 0.0) -> Number:
    """Number (value, reference, error) with the error value - reference."""
    return value, reference, value - reference


def reported(value: float) -> Number:
    """Number (value, None, None) of a quantity that has neither reference nor error."""
    return value, None, None


def free_space(length: float, depth: float) -> dict[str, Any]:
    """Scene keys of a basin of a length and depth [m] without gravity, walls or floor."""
    return {"length": length, "depth": depth, "gravity": [0.0, 0.0, 0.0], "walls": "none", "floor": "none"}
