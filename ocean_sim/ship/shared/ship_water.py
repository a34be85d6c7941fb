"""What ships need of the water, beyond what everybody does."""

from typing import TYPE_CHECKING, Any, Protocol

from ocean_sim.fluid import Fluid

if TYPE_CHECKING:
    from ocean_sim.fluid.shared.boundary import Boundary
    from ocean_sim.fluid.shared.grid import Grid
    from ocean_sim.fluid.shared.walls import Walls
    from ocean_sim.ship.shared.wave_contact import WaveContact


class ShipWater(Fluid, Protocol):
    """Water that carries ships; what follows `config` is there only where there are particles."""

    config: Any  # of its kind, with `rest_density` [kg/m3]
    sunk: float  # hydrostatic offset: how far below the level that was asked for the surface settles [m]
    grid: "Grid"
    walls: "Walls"
    boundary: "Boundary"

    def meet(self, contact: "WaveContact") -> None:
        """From the first step on feel the push of a hull."""
        ...


def hydrostatic_offset(water: ShipWater) -> float:
    """How far below the level that was asked for the surface settles, as the water's own weight compresses it [m]."""
    return 0.0 if water.particles is None else water.sunk
