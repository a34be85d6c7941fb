"""Base class of the shapes of solid bodies, and meshes that stand in a basin."""

from abc import abstractmethod
from dataclasses import replace
from functools import cached_property
from math import cos, radians, sin
from typing import ClassVar

import numpy as np

from ocean_sim.basin.solids.mesh import BadMesh, ClosedMesh, closed_mesh, section_prism
from ocean_sim.files.input_file import Unreadable, read_bytes
from ocean_sim.model import Model, Vector3

Box3 = tuple[np.ndarray, np.ndarray]
Boxes = list[Box3]  # lower and upper corner of each [m]
UNIT_METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "in": 0.0254}
# Axis of a file along z of the basin, by the file's axis that points up: x stays where it can.
ALONG_Z = {"x": "z", "-x": "z", "y": "z", "-y": "-z", "z": "-y", "-z": "y"}


class SolidShape(Model):
    """Base class of the shapes of solid bodies: bounds, inside test, and corners or a mesh."""

    rounded: ClassVar[bool] = False  # whether the faces that it is drawn with only approach it

    def content(self) -> bytes:
        """Bytes that identify the shape, by which its voxels and lattices are cached."""
        return self.model_dump_json().encode()

    @abstractmethod
    def bounds(self) -> Box3:
        """Lower and upper corner of the box around the shape [m]."""

    def inside(self, x: np.ndarray) -> np.ndarray:
        """(...) True for points `x` (..., 3) [m] that lie inside."""
        raise NotImplementedError

    def vertices(self) -> np.ndarray | None:
        """(n, 3) points [m] whose convex hull is the shape; None if it is not given by points."""
        return None

    def fill_lattice(self, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
        """(len(x), len(y), len(z)) True for the points of a lattice [m] that lie inside."""
        return self.inside(np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1))

    def closed_mesh(self) -> ClosedMesh | None:
        """The mesh in the axes of the shape; None if the shape is not a mesh. Raises BadMesh."""
        return None


class PlacedMesh(SolidShape):
    """A mesh of a file in a `unit`, with its axis `up` upwards, turned by a heading about the file's origin, which lies
    at the point `at` [m] of the basin; if `is_section`, a prism on its section at z = 0."""

    file: str
    unit: str
    up: str
    at: Vector3
    heading_deg: float
    is_section: bool

    def content(self) -> bytes:
        return super().content() + read_bytes(self.file)

    @cached_property
    def mesh(self) -> ClosedMesh:
        """The mesh in the axes of the basin. Raises BadMesh."""
        try:
            read = closed_mesh(self.file, read_bytes(self.file), UNIT_METRES[self.unit], self.up, ALONG_Z[self.up])
        except Unreadable as error:
            raise BadMesh(error) from None
        c, s = cos(radians(self.heading_deg)), sin(radians(self.heading_deg))
        turn = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
        placed = replace(read, vertices=(read.vertices - read.file_origin) @ turn.T + self.at)
        found = section_prism(placed) if self.is_section else placed
        if found is None:
            low, high = (bound[2] for bound in placed.bounds)
            raise BadMesh(Unreadable(self.file, f"the slice, z = 0, misses this mesh from z = {low:g} to {high:g} m"))
        return found

    @cached_property
    def faults(self) -> list[str]:
        """Sentences on why the file holds no closed mesh, or no section at z = 0 if one is needed; empty if it does."""
        try:
            self.closed_mesh()
        except BadMesh as error:
            return error.problems
        return []

    def closed_mesh(self) -> ClosedMesh:
        return self.mesh

    def bounds(self) -> Box3:
        return self.mesh.bounds
