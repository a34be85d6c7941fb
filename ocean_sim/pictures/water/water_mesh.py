"""A smooth block of water from heights on a coarse grid: its surface, its cut sides, and their normals."""

import numpy as np

from ocean_sim.basin.points import grid_points
from ocean_sim.surface import cell_triangles

SIDE_ROWS = 9  # rows of vertices from the surface to the bed


def spline_matrix(cells: int, factor: int) -> np.ndarray:
    """Matrix (cells * factor + 1, cells) that takes values at cell centres to a cubic spline at nodes from wall to
    wall. The spline is mirrored in the walls, so that water meets them level."""
    from scipy.ndimage import map_coordinates

    nodes = np.linspace(-0.5, cells - 0.5, cells * factor + 1)
    return np.stack([map_coordinates(unit, [nodes], order=3, mode="reflect") for unit in np.eye(cells)], axis=1)


class WaterMesh:
    """Mesh of a block of water: its surface, and cut sides down to the bed; only heights change from frame to frame."""

    def __init__(self, x: np.ndarray, z: np.ndarray, lower: np.ndarray, upper: np.ndarray, nodes: int) -> None:
        """`x`, `z`: cell centres of the heights [m]; `lower`, `upper`: basin's corners [m]; `nodes`: about how many."""
        factor = int(np.clip(np.sqrt(nodes / (len(x) * len(z))), 1, 12))
        self.along_x, self.along_z = spline_matrix(len(x), factor), spline_matrix(len(z), factor)
        self.x = np.linspace(lower[0], upper[0], len(self.along_x))
        self.z = np.linspace(lower[2], upper[2], len(self.along_z))
        self.bed = float(lower[1])
        self.slope_x = np.gradient(self.along_x, self.x, axis=0)
        self.slope_z = np.gradient(self.along_z, self.z, axis=0)
        self.nodes = grid_points(self.x, self.z)
        self.surface_triangles = cell_triangles(len(self.x), len(self.z))
        rim = np.arange(len(self.nodes)).reshape(len(self.x), len(self.z))
        self.rims = (rim[:, -1], rim[::-1, 0], rim[-1, ::-1], rim[0, :])  # +z, -z, +x, -x, seen from outside
        across, sizes = np.eye(3)[[2, 2, 0, 0]] * [[1], [-1], [1], [-1]], [len(rim) * SIDE_ROWS for rim in self.rims]
        self.side_normals = np.repeat(across, sizes, axis=0)
        counts = np.cumsum([0, *sizes])
        self.side_triangles = np.concatenate([cell_triangles(SIDE_ROWS, len(r)) + n for r, n in zip(self.rims, counts)])
        self.side_depth = np.concatenate([np.repeat(np.linspace(0.0, 1.0, SIDE_ROWS), len(rim)) for rim in self.rims])

    def surface(self, elevation: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Surface nodes (n, 3) [m] on a cubic spline through the cells' `elevation` (nx, nz) [m], and unit normals."""
        height = (self.along_x @ elevation @ self.along_z.T).reshape(-1)
        slope_x = (self.slope_x @ elevation @ self.along_z.T).reshape(-1)
        slope_z = (self.along_x @ elevation @ self.slope_z.T).reshape(-1)
        normals = np.stack([-slope_x, np.ones_like(height), -slope_z], axis=-1)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        return np.column_stack([self.nodes[:, 0], height, self.nodes[:, 1]]), normals

    def sides(self, surface: np.ndarray) -> np.ndarray:
        """Nodes (m, 3) [m] of the four cut sides: from the rim of the `surface` nodes (n, 3) [m] down to the bed."""
        down = np.linspace(0.0, 1.0, SIDE_ROWS)[:, None]
        parts = []
        for rim in self.rims:
            top = surface[rim]
            part = np.tile(top, (SIDE_ROWS, 1, 1))
            part[:, :, 1] = top[:, 1] + (self.bed - top[:, 1]) * down
            parts.append(part.reshape(-1, 3))
        return np.concatenate(parts)
