"""Shapes of hulls. Axes of a hull: x to port, y up from the keel, z to the bow, origin amidships at the keel."""

from abc import abstractmethod
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from ocean_sim.files.input_file import FileName, content
from ocean_sim.model import Model, Vector3, quantity

Box3 = tuple[np.ndarray, np.ndarray]


class HullShape(Model):
    """What every shape has."""

    is_mesh: ClassVar[bool] = False  # whether it is `closed`, and knows no `inside`
    rounded: ClassVar[bool] = False  # whether the faces that it is drawn with only approach it

    def content(self) -> bytes:
        """What its voxels depend on."""
        return self.model_dump_json().encode()

    @abstractmethod
    def bounds(self) -> Box3:
        """Corners of the box around it [m]."""

    def inside(self, x: np.ndarray) -> np.ndarray:
        """Whether points (..., 3) [m] lie inside."""
        raise NotImplementedError

    def vertices(self) -> np.ndarray | None:
        """(n, 3) points [m] whose convex hull it is; None where sections of it must be found."""
        return None

    def closed(self) -> Any:
        """The mesh in the hull's axes (trimesh); raises BadMesh. None where it is none."""
        return None


def upright(breadth: float, height: float, length: float) -> Box3:
    """Corners of a box on its keel, in the middle of x and z [m]."""
    half = np.array([breadth / 2, 0.0, length / 2])
    return -half, half + [0.0, height, 0.0]


class Box(HullShape):
    """A barge: a box."""

    kind: Literal["box"]
    length: float = quantity("m", gt=0.0)
    """Along z."""
    breadth: float = quantity("m", gt=0.0)
    """Along x."""
    height: float = quantity("m", gt=0.0)
    """From keel to deck."""

    def bounds(self) -> Box3:
        return upright(self.breadth, self.height, self.length)

    def inside(self, x: np.ndarray) -> np.ndarray:
        lower, upper = self.bounds()
        return np.all((x >= lower) & (x <= upper), axis=-1)


class Wigley(HullShape):
    """Wigley's parabolic hull y = B/2 (1 - (2z/L)^2) (1 - (y/T)^2), wall-sided above its draught."""

    rounded: ClassVar[bool] = True
    kind: Literal["wigley"]
    length: float = quantity("m", gt=0.0)
    """Along z, at the waterline L."""
    breadth: float = quantity("m", gt=0.0)
    """Along x, amidships B."""
    draught: float = quantity("m", gt=0.0)
    """Draught of the parabolic part."""
    height: float = quantity("m", gt=0.0)
    """From keel to deck."""

    def bounds(self) -> Box3:
        return upright(self.breadth, self.height, self.length)

    def inside(self, x: np.ndarray) -> np.ndarray:
        below = np.clip(1.0 - x[..., 1] / self.draught, 0.0, 1.0)
        half = self.breadth / 2 * (1.0 - (2.0 * x[..., 2] / self.length) ** 2) * (1.0 - below**2)
        return (np.abs(x[..., 0]) <= half) & (x[..., 1] >= 0.0) & (x[..., 1] <= self.height)


class Cylinder(HullShape):
    """A circular cylinder that lies along z."""

    rounded: ClassVar[bool] = True
    kind: Literal["cylinder"]
    length: float = quantity("m", gt=0.0)
    """Along z."""
    radius: float = quantity("m", gt=0.0)
    """Radius of the circle."""

    def bounds(self) -> Box3:
        half = np.array([self.radius, 0.0, self.length / 2])
        return -half, half + [0.0, 2.0 * self.radius, 0.0]

    def inside(self, x: np.ndarray) -> np.ndarray:
        return (np.hypot(x[..., 0], x[..., 1] - self.radius) <= self.radius) & (np.abs(x[..., 2]) <= self.length / 2)


class Sphere(HullShape):
    """A ball; its lowest point is its keel."""

    rounded: ClassVar[bool] = True
    kind: Literal["sphere"]
    radius: float = quantity("m", gt=0.0)
    """Radius of the ball."""

    def bounds(self) -> Box3:
        half = np.array([self.radius, 0.0, self.radius])
        return -half, half + [0.0, 2.0 * self.radius, 0.0]

    def inside(self, x: np.ndarray) -> np.ndarray:
        return np.linalg.norm(x - [0.0, self.radius, 0.0], axis=-1) <= self.radius


class Outline(HullShape):
    """The convex hull of points, as the thesis makes its yacht (5.3)."""

    kind: Literal["outline"]
    points: list[Vector3] = Field(min_length=4)
    """Vertices [m]; each with x > 0 also stands for its mirror image on starboard."""

    def vertices(self) -> np.ndarray:
        """(n, 3), both sides [m]."""
        port = np.array(self.points, dtype=float)
        return np.concatenate([port, port[port[:, 0] > 0.0] * [-1.0, 1.0, 1.0]])

    def bounds(self) -> Box3:
        x = self.vertices()
        return x.min(axis=0), x.max(axis=0)

    def inside(self, x: np.ndarray) -> np.ndarray:
        from scipy.spatial import ConvexHull

        planes = ConvexHull(self.vertices()).equations
        within = np.ones(x.shape[:-1], dtype=bool)
        for plane in planes:
            within &= x @ plane[:3] + plane[3] <= 1e-9
        return within


class MeshFile(HullShape):
    """A closed mesh in an STL, OBJ or PLY file, turned so that its longest axis is the ship's."""

    is_mesh: ClassVar[bool] = True
    kind: Literal["mesh"]
    file: FileName
    """Path of the file."""
    scale: float | None = quantity("1", None, gt=0.0)
    """Metres per unit of the file; null guesses metres or millimetres from its size."""
    up: Literal["x", "y", "z"] | None = None
    """The file's axis that points up; null guesses."""
    bow: Literal["x", "y", "z", "-x", "-y", "-z"] | None = None
    """The file's axis that points to the bow; null takes the longest."""

    def content(self) -> bytes:
        return super().content() + content(self.file)

    def closed(self) -> Any:
        from ocean_sim.ship.shared.mesh import closed_mesh

        return closed_mesh(self)

    def bounds(self) -> Box3:
        lower, upper = self.closed().bounds
        return np.array(lower), np.array(upper)


Shape = Annotated[Box | Wigley | Cylinder | Sphere | Outline | MeshFile, Field(discriminator="kind")]
