"""The drawn and felt surface of the water: every module of this folder is a kind that a scene may name; what they share
lies in `shared`."""

from typing import Protocol

import numpy as np

from ocean_sim.fluid import Particles
from ocean_sim.surface.shared.mesh import Mesh


class Surface(Protocol):
    """The surface of the water. It reads the particles and never writes them; `elevation` is callable from a kernel.
    `shared/heights.py` is a grid of heights to build one on."""

    measured: dict[str, str]  # further columns of accuracy.csv, and what they hold

    def follow(self, particles: Particles, dt: float) -> None:
        """Take in that the particles have moved on by dt [s]."""

    def elevation(self, x, z):
        """ti.func: height of the surface [m] above the still water, continuous in x and z [m]; the bed where it is dry.
        Points beyond the basin have the height at its side."""

    def elevations(self, points: np.ndarray) -> np.ndarray:
        """The same from Python: (m, 2) points x, z [m] -> (m,) heights [m]."""

    def mesh(self) -> Mesh:
        """The surface as triangles, made when asked for."""

    def measures(self) -> list[float]:
        """The numbers of the columns `measured` now, in their order."""
