"""The surface of the water, for pictures, gauges and ships. Every module of this folder is a kind of surface that a
scene may name under `surface.kind`."""

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from ocean_sim.fluid import Particles

AREA_AND_VOLUME = {"surface_area_m2": "of what faces the air", "surface_volume_m3": "water between surface and bed"}


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangle mesh of the water's surface, its faces away from the water; without triangles in 2-D."""

    vertices: np.ndarray  # (n, 3) [m]
    triangles: np.ndarray  # (m, 3) corners, numbers of vertices, anticlockwise seen from outside the water
    normals: np.ndarray  # (n, 3) unit normals at the vertices, away from the water

    @property
    def vector_areas(self) -> np.ndarray:
        """Area vector (m, 3) [m2] of each triangle: outward unit normal times area."""
        a, b, c = (self.vertices[self.triangles[:, k]].astype(float) for k in range(3))
        return 0.5 * np.cross(b - a, c - a)

    @property
    def folds(self) -> bool:
        """True if some triangle does not face up, so that a point x, z may have several heights."""
        return bool((self.vector_areas[:, 1] <= 0.0).any())

    @property
    def vertex_areas(self) -> np.ndarray:
        """Outward area vectors (n, 3) [m2] at vertices: each the sum over the triangles around it."""
        around, n = self.triangles.ravel(), len(self.vertices)
        return np.stack([np.bincount(around, np.repeat(axis, 3), n) for axis in self.vector_areas.T], axis=1)

    @property
    def area(self) -> float:
        """Area of all triangles [m2]."""
        return float(np.linalg.norm(self.vector_areas, axis=1).sum())

    def volume(self, bed: float = 0.0) -> float:
        """Volume [m3] inside a closed mesh, or between a sheet and a flat bed at height `bed` [m]. It is the flux
        through the mesh of (0, y - bed, 0), which upright sides and the bed do not contribute to."""
        height = self.vertices[:, 1].astype(float)[self.triangles].mean(axis=1) - bed
        return float((height * self.vector_areas[:, 1]).sum())


def sheet(x: np.ndarray, z: np.ndarray, height: np.ndarray) -> Mesh:
    """Mesh of heights (nx, nz) [m] on the grid of `x` (nx,) and `z` (nz,) [m]: two triangles a cell, with normals."""
    along = [np.gradient(height, at, axis=k) if len(at) > 1 else 0.0 * height for k, at in enumerate((x, z))]
    normals = np.stack([-along[0], np.ones_like(height), -along[1]], axis=-1).reshape(-1, 3)
    positions = np.meshgrid(x, z, indexing="ij")
    return Mesh(
        vertices=np.stack([positions[0], height, positions[1]], axis=-1).reshape(-1, 3),
        triangles=cell_triangles(*height.shape),
        normals=normals / np.linalg.norm(normals, axis=1, keepdims=True),
    )


@lru_cache(maxsize=4)  # a sheet that moves keeps them
def cell_triangles(nx: int, nz: int) -> np.ndarray:
    """Vertex numbers (m, 3) of two triangles for each cell of a grid of nx x nz points; cached, and so read-only."""
    number = np.arange(nx * nz, dtype=np.int32).reshape(nx, nz)
    a, b, c, d = (part.ravel() for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    corners = np.concatenate([np.stack([a, d, b], axis=1), np.stack([b, d, c], axis=1)])
    corners.flags.writeable = False
    return corners


class Surface(Protocol):
    """Interface of every kind of water surface. A surface reads the particles and never writes them; kernels may call
    `elevation`. `shared/heights.py` offers a grid of heights to build one on."""

    measured: dict[str, str]  # further columns of accuracy.csv, and what they hold

    def follow(self, particles: "Particles", dt: float) -> None:
        """Bring the surface up to date after the particles have moved by one time step `dt` [s]; called once a step."""

    def elevation(self, x, z):
        """ti.func: height of the surface [m] above the still water, continuous in x and z [m]; the bed where it is dry.
        Points beyond the basin have the height at its side."""

    def elevations(self, points: np.ndarray) -> np.ndarray:
        """Heights (m,) [m] above the still water at points x, z (m, 2) [m], from Python."""

    def mesh(self) -> Mesh:
        """Triangle mesh of the surface, computed anew at each call."""

    def measures(self) -> list[float]:
        """Values for the extra columns of accuracy.csv, in the order in which `measured` names them."""
