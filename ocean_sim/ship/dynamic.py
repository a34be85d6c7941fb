"""A ship in water that moves along with it: `hydrostatic` with added mass, its Coriolis term, and damping by waves."""

from typing import ClassVar, Literal

from ocean_sim.basin import Basin
from ocean_sim.fluid import Fluid
from ocean_sim.ship.body.seakeeping import SeakeepingConfig, SeakeepingShip


class Config(SeakeepingConfig):
    """Buoyancy and weight, added mass, wind, propeller, rudder and damping."""

    compared: ClassVar[bool] = True
    fineness: ClassVar[int] = 2
    kind: Literal["dynamic"] = "dynamic"

    def build(self, name: str, basin: Basin, fluid: Fluid) -> SeakeepingShip:
        return SeakeepingShip(name, self, basin, fluid)
