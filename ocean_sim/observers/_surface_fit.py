"""How well a surface fits the particles under it: its distance from where they end, its area, the water below it."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ocean_sim.observers._counted import spacing
from ocean_sim.observers._points import grid, pairs

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation

POINTS = 256  # about so many: the particles' own height is dear
TOLD = {
    "surface_offset": "mean of the surface's height minus the height at which the particles' smoothed share of water "
    "falls through one half",
    "surface_fit": "root of the mean square of the same",
    "surface_volume": "water between surface and bed",
}


class SurfaceFit:
    """Numbers of a row of accuracy.csv; without area and volume in a slice."""

    def __init__(self, simulation: "Simulation") -> None:
        basin = simulation.basin
        self.bed, self.flat = basin.lower[1], basin.dimension == 2
        size = np.subtract(basin.upper, basin.lower)
        apart = size[0] / POINTS if self.flat else np.sqrt(size[0] * size[2] / POINTS)
        self.points = pairs(*grid(basin, max(float(apart), spacing(simulation.fluid))))
        self.columns = ["surface_offset_m", "surface_fit_m"]
        self.columns += [] if self.flat else ["surface_area_m2", "surface_volume_m3"]

    def values(self, simulation: "Simulation") -> list[float]:
        """In the order of the columns."""
        surface: Any = simulation.surface
        away = surface.elevations(self.points) - simulation.fluid.elevations(self.points)
        fit = [float(away.mean()), float(np.sqrt(np.square(away).mean()))]
        if self.flat:
            return fit
        mesh = surface.mesh()
        return [*fit, mesh.area, mesh.volume(self.bed)]
