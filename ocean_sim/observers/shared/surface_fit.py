"""How well a surface fits the particles under it: its distance from the highest of them, and what it
measures of itself."""

from typing import TYPE_CHECKING

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.fluid import with_particles

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation
    from ocean_sim.surface import Surface

COLUMN = 2.0  # [spacings] least width of a column in which the highest particle is looked for
MEANING = {
    "surface_offset": "mean height of the surface over the highest particle of every column two spacings wide, half a "
    "spacing above its centre; spray counts",
    "surface_fit": "root of the mean square of the same",
}


def highest(position: np.ndarray, basin: Basin, spacing: float) -> np.ndarray:
    """(m, 3) the highest particle of every column that holds any, half a spacing above its centre [m]."""
    low, size = np.array(basin.lower), np.subtract(basin.upper, basin.lower)
    counts = np.maximum(1, (size[[0, 2]] / (COLUMN * spacing) + 1.0e-6).astype(int))
    share = (position - low)[:, [0, 2]] / np.where(size[[0, 2]] > 0.0, size[[0, 2]], 1.0)
    column = np.clip((share * counts).astype(int), 0, counts - 1) @ [counts[1], 1]
    order = np.lexsort((position[:, 1], column))
    last = np.append(np.diff(column[order]) != 0, True)
    return position[order[last]] + [0.0, 0.5 * spacing, 0.0]


def fit(surface: "Surface", top: np.ndarray) -> tuple[float, float]:
    """Mean and root mean square of the height of a surface over (m, 3) points [m]."""
    away = surface.elevations(top[:, [0, 2]]) - top[:, 1]
    return float(away.mean()), float(np.sqrt(np.square(away).mean()))


class SurfaceFit:
    """Numbers of a row of accuracy.csv: the fit, and what the surface measures of itself."""

    def __init__(self, surface: "Surface") -> None:
        self.meaning = MEANING | {name.rsplit("_m", 1)[0]: meaning for name, meaning in surface.measured.items()}
        self.columns = ["surface_offset_m", "surface_fit_m", *surface.measured]

    def values(self, simulation: "Simulation") -> list[float]:
        """In the order of the columns."""
        surface = simulation.surface
        assert surface is not None
        position = with_particles(simulation.fluid).particles.position.to_numpy().astype(float)
        top = highest(position, simulation.basin, simulation.fluid.spacing)
        return [*fit(surface, top), *surface.measures()]
