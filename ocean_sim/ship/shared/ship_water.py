"""What ships need of the water, beyond what everybody does."""

from typing import TYPE_CHECKING, Any, Protocol, cast

from ocean_sim.fluid import Fluid

if TYPE_CHECKING:
    from ocean_sim.fluid.shared.boundary import Boundary
    from ocean_sim.fluid.shared.grid import Grid
    from ocean_sim.fluid.shared.walls import Walls
    from ocean_sim.ship.shared.wave_contact import WaveContact


class ParticleWater(Fluid, Protocol):
    """Water that is made of particles."""

    sunk: float  # how far below the level that was asked for the surface settles, as its own weight compresses it [m]
    grid: "Grid"
    walls: "Walls"
    boundary: "Boundary"

    def meet(self, contact: "WaveContact") -> None:
        """From the first step on feel the push of a hull."""
        ...


def of_particles(fluid: Fluid) -> ParticleWater | None:
    """The water where it is made of particles; None where it is a closed form."""
    return None if fluid.particles is None else cast(ParticleWater, fluid)


def settling(fluid: Fluid) -> float:
    """How far below the level that was asked for its surface settles [m]."""
    water = of_particles(fluid)
    return 0.0 if water is None else water.sunk


def rest_density(fluid: Fluid) -> float:
    """Of the water [kg/m3]; a closed form has it in its keys."""
    water = of_particles(fluid)
    return float(cast(Any, fluid).config.rest_density if water is None else water.particles.rest_density)
