"""No wind: its term compiles to nothing."""

from typing import Literal

from ocean_sim.basin import Basin
from ocean_sim.parts import LedgerRow, Preflight, WindConfig
from ocean_sim.wind import StillAir, Target, Wind


class Config(WindConfig):
    """Air at rest that does nothing."""

    kind: Literal["still"] = "still"

    @property
    def still(self) -> bool:
        return True

    @property
    def acts_on(self) -> tuple[Target, ...]:
        return ()

    def warnings(self, preflight: Preflight) -> list[str]:
        return []

    def ledger(self, preflight: Preflight) -> list[LedgerRow]:
        return []

    def build(self, basin: Basin, seed: int) -> Wind:
        return StillAir()
