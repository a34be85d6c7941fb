"""A surface as triangles, as pictures, exports and measurements take it."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles that face away from the water; without any where the basin is a slice."""

    vertices: np.ndarray  # (n, 3) [m]
    triangles: np.ndarray  # (m, 3) corners, numbers of vertices, anticlockwise seen from outside the water
    normals: np.ndarray  # (n, 3) unit normals at the vertices, away from the water

    @property
    def vector_areas(self) -> np.ndarray:
        """(m, 3) area times outward normal of each triangle [m2]."""
        a, b, c = (self.vertices[self.triangles[:, k]].astype(float) for k in range(3))
        return 0.5 * np.cross(b - a, c - a)

    @property
    def area(self) -> float:
        """Area of all triangles [m2]."""
        return float(np.linalg.norm(self.vector_areas, axis=1).sum())

    def volume(self, bed: float = 0.0) -> float:
        """Volume inside a closed mesh, or between a sheet and a flat bed at this height [m3]: the flux of (0, y - bed,
        0), which passes neither upright sides nor the bed."""
        height = self.vertices[:, 1].astype(float)[self.triangles].mean(axis=1) - bed
        return float((height * self.vector_areas[:, 1]).sum())
