"""Interface of shapes of solid bodies, and meshes that stand in a basin."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from ocean_sim.basin.solids.mesh import ClosedMesh

Box3 = tuple[np.ndarray, np.ndarray]


class SolidShape(ABC):
    """Base class of shapes of solid bodies: bounds, inside test or mesh, and bytes that identify them."""

    @abstractmethod
    def content(self) -> bytes:
        """Bytes that identify the shape, and name its voxels and lattices in the cache."""

    @abstractmethod
    def bounds(self) -> Box3:
        """Lower and upper corner of the box around the shape [m]."""

    def inside(self, x: np.ndarray) -> np.ndarray:
        """True for points (..., 3) [m] that lie inside."""
        raise NotImplementedError

    def fill_lattice(self, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
        """(len(x), len(y), len(z)) True for the points of a lattice [m] that lie inside."""
        return self.inside(np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1))

    def closed_mesh(self) -> ClosedMesh | None:
        """The mesh in the body's axes; None if the shape is not a mesh. Raises BadMesh."""
        return None


@dataclass(frozen=True, eq=False)
class PlacedMesh(SolidShape):
    """A closed mesh where it stands."""

    mesh: ClosedMesh

    def content(self) -> bytes:
        return self.mesh.vertices.tobytes() + self.mesh.faces.tobytes()

    def bounds(self) -> Box3:
        return self.mesh.bounds

    def closed_mesh(self) -> ClosedMesh:
        return self.mesh
