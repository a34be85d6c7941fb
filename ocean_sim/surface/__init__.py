"""The drawn and felt surface of the water: every module of this folder without a leading underscore is a kind a scene
may name."""

from typing import Any, Protocol

import numpy as np

from ocean_sim.surface.shared.mesh import Mesh


class Surface(Protocol):
    """The surface of the water. It reads the particles and never writes them; `elevation` is callable from a kernel."""

    def follow(self, particles: Any, dt: float) -> None:
        """Take in that the particles have moved on by dt [s]."""
        ...

    def elevation(self, x, z):
        """ti.func: height of the surface [m] above the still water, continuous in x and z; the bed where it is dry.
        Points beyond the basin have the height at its side."""
        ...

    def elevations(self, points: np.ndarray) -> np.ndarray:
        """The same from Python: (m, 2) points x, z [m] -> (m,) heights [m]."""
        ...

    def mesh(self) -> Mesh:
        """The surface as triangles, made when asked for."""
        ...

    measured: dict[str, str]  # columns of accuracy.csv, and what they hold

    def measures(self) -> list[float]:
        """The numbers of those columns now."""
        ...
