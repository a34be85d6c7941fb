"""What a case consists of, and how it is run under a scheme and judged."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ocean_sim.conventions import Diverged
from ocean_sim.parts import kinds
from ocean_sim.reading.scene import SceneConfig, load, observer_names
from ocean_sim.simulation import Simulation

KEYS = ("case", "scheme", "quantity", "value", "reference", "error", "unit", "tolerance", "ok", "source")


@dataclass(frozen=True)
class Promise:
    """A number to be measured: the unit of its error, the largest error of each scheme, and where both come from."""

    quantity: str
    unit: str
    source: str
    tolerance: Mapping[str, float] = field(default_factory=dict)
    """By scheme; a scheme that is not named is only reported."""

    def row(self, case: str, scheme: str, value: float | None, reference: float | None, error: float | None) -> dict:
        """One row of the table; what could not be measured misses its tolerance."""
        tolerance = self.tolerance.get(scheme)
        ok = tolerance is None or (error is not None and bool(abs(error) <= tolerance))
        numbers = {"value": value, "reference": reference, "error": error}
        plain = {key: None if number is None else float(number) for key, number in numbers.items()}
        return (
            {"case": case, "scheme": scheme, "quantity": self.quantity}
            | plain
            | {
                "unit": self.unit,
                "tolerance": tolerance,
                "ok": ok,
                "source": self.source,
            }
        )


@dataclass(frozen=True)
class Curve:
    """A line (or, where it is not one, points) of a plot."""

    label: str
    x: np.ndarray
    y: np.ndarray
    points: bool = False


@dataclass(frozen=True)
class Finding:
    """What a run showed: (value, reference, error) of each promised quantity, and the curves of its plot."""

    numbers: Mapping[str, tuple[float | None, float | None, float | None]]
    measured: list[Curve] = field(default_factory=list)
    expected: list[Curve] = field(default_factory=list)
    axes: tuple[str, str] = ("", "")


@dataclass(frozen=True)
class Problem:
    """One set-up of a case."""

    scene: dict[str, Any]
    promises: tuple[Promise, ...]
    measure: Callable[[Simulation], Finding]
    """Runs a simulation that has just been built, and looks at it."""
    name: str = ""
    """Which of several set-ups of its case."""
    slow: bool = False
    slot: str = "fluid"
    """What a scheme is a kind of."""
    schemes: tuple[str, ...] = ("delta_sph",)
    """Those that are run by default."""
    only: bool = False
    """Whether no other scheme has what it is about."""

    def load(self, scheme: str, overrides: Mapping[str, Any] | None = None) -> SceneConfig:
        """The scene under a scheme, without observers."""
        quiet = {name: None for name in observer_names() if name != "manifest"}
        part = self.scene[self.slot] | {"kind": scheme}
        return load(self.scene | quiet | {self.slot: part}, dict(overrides or {}))

    def under(self, asked: list[str]) -> list[str]:
        """The schemes to run: of those asked for the ones that fit, else its own; a ship's case knows which fit it."""
        fitting = kinds("fluid") if self.slot == "fluid" and not self.only else self.schemes
        return [scheme for scheme in asked if scheme in fitting] if asked else list(self.schemes)

    def run(self, case: str, scheme: str, overrides: Mapping[str, Any] | None = None) -> tuple[list[dict], Finding]:
        """The rows of the table and what they were read from; a run that diverged gives rows that say so."""
        try:
            with Simulation(self.load(scheme, overrides)) as simulation:
                found = self.measure(simulation)
        except Diverged as failure:
            missing = [promise.row(case, scheme, None, None, None) for promise in self.promises]
            return [row | {"source": f"{row['source']}; the run diverged: {failure}"} for row in missing], Finding({})
        return [promise.row(case, scheme, *found.numbers[promise.quantity]) for promise in self.promises], found


def relative(value: float, reference: float) -> tuple[float, float, float]:
    """Value, reference and error [%]."""
    return value, reference, 100.0 * (value / reference - 1.0)
