"""No wind: its term compiles to nothing."""

from typing import ClassVar, Literal

from ocean_sim.basin import Basin
from ocean_sim.parts import LedgerRow, SceneFacts, WindConfig
from ocean_sim.wind import StillAir, Target, Wind


class Config(WindConfig):
    """Air at rest that does nothing."""

    still: ClassVar[bool] = True
    acts_on: ClassVar[tuple[Target, ...]] = ()
    kind: Literal["still"] = "still"

    def warnings(self, preflight: SceneFacts) -> tuple[str, ...]:
        return ()

    def ledger(self, preflight: SceneFacts) -> list[LedgerRow]:
        return []

    def build(self, basin: Basin, seed: int) -> Wind:
        return StillAir()
