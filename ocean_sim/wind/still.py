"""No wind: its term compiles to nothing."""

from typing import Literal

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.kernel_library import ti, tm
from ocean_sim.parts import LedgerRow, Preflight, WindConfig
from ocean_sim.runtime import in_kernels
from ocean_sim.wind import Wind
from ocean_sim.wind.shared.drawing import NOTHING, Drawing


class Config(WindConfig):
    """Air at rest that does nothing."""

    kind: Literal["still"] = "still"

    @property
    def stylised(self) -> bool:
        return False

    @property
    def still(self) -> bool:
        return True

    def ledger(self, preflight: Preflight) -> list[LedgerRow]:
        return []

    def build(self, basin: Basin, seed: int) -> Wind:
        return Still()


@in_kernels
class Still:
    """Air at rest."""

    needs_area: bool = False
    needs_bend: bool = False
    blows: bool = False
    since: float = 0.0
    step: float = 0.0

    def on(self, target: str) -> "Still":
        """The wind that a target feels."""
        return self

    def follow(self, middle: np.ndarray) -> None:
        """Still air is the same everywhere."""

    def advance(self, dt: float) -> None:
        pass

    def strengthen(self, factor: float) -> None:
        pass

    def drawing(self) -> Drawing:
        """Nothing."""
        return NOTHING

    @ti.func
    def set_clock(self, since, step):
        pass

    @ti.func
    def force(self, key, position, velocity, area, bend, mass):
        return tm.vec3(0.0)
