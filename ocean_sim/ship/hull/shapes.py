"""Shapes of hulls, and their triangles as they are drawn. Axes of a hull: x to port, y up from the keel, z to the bow,
origin amidships at the keel."""

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from ocean_sim.basin.solids.mesh import BadMesh, ClosedMesh, closed_mesh
from ocean_sim.basin.solids.shape import Box3, SolidShape
from ocean_sim.conventions import AxisName
from ocean_sim.files.cache_file import cached_arrays
from ocean_sim.files.input_file import FileName, Unreadable, read_bytes
from ocean_sim.model import Vector3, quantity

DRAWN_STATIONS, DRAWN_WATERLINES, SIDE_HALVINGS = 41, 25, 24  # of a shape that is drawn by its sections


def box_on_keel(breadth: float, height: float, length: float) -> Box3:
    """Lower and upper corner (3,) [m] of a box that stands on y = 0, in the middle of x and z."""
    half = np.array([breadth / 2, 0.0, length / 2])
    return -half, half + [0.0, height, 0.0]


class Box(SolidShape):
    """A barge: a box."""

    kind: Literal["box"]
    length: float = quantity("m", gt=0.0)
    """Along z."""
    breadth: float = quantity("m", gt=0.0)
    """Along x."""
    height: float = quantity("m", gt=0.0)
    """Height from keel to deck."""

    def bounds(self) -> Box3:
        return box_on_keel(self.breadth, self.height, self.length)

    def inside(self, x: np.ndarray) -> np.ndarray:
        lower, upper = self.bounds()
        return np.all((x >= lower) & (x <= upper), axis=-1)


class Wigley(SolidShape):
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
    """Height from keel to deck."""

    def bounds(self) -> Box3:
        return box_on_keel(self.breadth, self.height, self.length)

    def inside(self, x: np.ndarray) -> np.ndarray:
        below = np.clip(1.0 - x[..., 1] / self.draught, 0.0, 1.0)
        half = self.breadth / 2 * (1.0 - (2.0 * x[..., 2] / self.length) ** 2) * (1.0 - below**2)
        return (np.abs(x[..., 0]) <= half) & (x[..., 1] >= 0.0) & (x[..., 1] <= self.height)


class Cylinder(SolidShape):
    """A circular cylinder that lies along z."""

    rounded: ClassVar[bool] = True
    kind: Literal["cylinder"]
    length: float = quantity("m", gt=0.0)
    """Along z."""
    radius: float = quantity("m", gt=0.0)
    """Radius of the circle."""

    def bounds(self) -> Box3:
        return box_on_keel(2.0 * self.radius, 2.0 * self.radius, self.length)

    def inside(self, x: np.ndarray) -> np.ndarray:
        return (np.hypot(x[..., 0], x[..., 1] - self.radius) <= self.radius) & (np.abs(x[..., 2]) <= self.length / 2)


class Sphere(SolidShape):
    """A ball; its lowest point is its keel."""

    rounded: ClassVar[bool] = True
    kind: Literal["sphere"]
    radius: float = quantity("m", gt=0.0)
    """Radius of the ball."""

    def bounds(self) -> Box3:
        return box_on_keel(*[2.0 * self.radius] * 3)

    def inside(self, x: np.ndarray) -> np.ndarray:
        return np.linalg.norm(x - [0.0, self.radius, 0.0], axis=-1) <= self.radius


class Outline(SolidShape):
    """The convex hull of points, as the thesis makes its yacht (5.3)."""

    kind: Literal["outline"]
    points: list[Vector3] = Field(min_length=4)
    """Vertices [m]; each with x > 0 also stands for its mirror image on starboard."""

    def vertices(self) -> np.ndarray:
        port = np.array(self.points, dtype=float)
        return np.concatenate([port, port[port[:, 0] > 0.0] * [-1.0, 1.0, 1.0]])

    def bounds(self) -> Box3:
        x = self.vertices()
        return x.min(axis=0), x.max(axis=0)

    def fill_lattice(self, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
        from scipy.spatial import ConvexHull

        low, high = np.full((len(x), len(z)), -np.inf), np.full((len(x), len(z)), np.inf)
        for across, up, along, offset in ConvexHull(self.vertices()).equations:
            room = 1e-9 - offset - across * x[:, None] - along * z
            if up > 0.0:
                high = np.minimum(high, room / up)
            elif up < 0.0:
                low = np.maximum(low, room / up)
            else:
                high[room < 0.0] = -np.inf
        heights = y[:, None]
        return (heights >= low[:, None]) & (heights <= high[:, None])


class MeshFile(SolidShape):
    """A closed mesh in an STL, OBJ or PLY file, turned so that its longest axis is the ship's."""

    kind: Literal["mesh"]
    file: FileName
    """Path of the file."""
    scale: float | None = quantity("1", None, gt=0.0)
    """Metres per unit of the file; null guesses metres or millimetres from its size."""
    up: AxisName | None = None
    """The file's axis that points up, -z where z points down; null guesses."""
    bow: AxisName | None = None
    """The file's axis that points to the bow; null takes the longest."""

    def content(self) -> bytes:
        return super().content() + read_bytes(self.file)

    def closed_mesh(self) -> ClosedMesh:
        try:
            return closed_mesh(self.file, read_bytes(self.file), self.scale, self.up, self.bow)
        except Unreadable as error:
            raise BadMesh(error) from None

    def bounds(self) -> Box3:
        return self.closed_mesh().bounds


Shape = Annotated[Box | Wigley | Cylinder | Sphere | Outline | MeshFile, Field(discriminator="kind")]


def drawn_mesh(shape: SolidShape) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) vertices [m] in the hull's axes, (m, 3) outward triangles of a shape's mesh, or of its convex hull."""
    mesh = shape.closed_mesh()
    if mesh is not None:
        return mesh.vertices, mesh.faces
    found = cached_arrays("drawn", shape.content(), lambda: convex_triangles(shape))
    return found["vertices"], found["triangles"]


def convex_triangles(shape: SolidShape) -> dict[str, np.ndarray]:
    """Convex hull of a shape: `vertices` (n, 3) [m], its corners or points all over it; outward `triangles` (m, 3)."""
    from scipy.spatial import ConvexHull

    vertices = shape.vertices()
    points = section_points(shape) if vertices is None else vertices
    hull = ConvexHull(points)
    a, b, c = (points[hull.simplices[:, k]] for k in range(3))
    inwards = (np.cross(b - a, c - a) * hull.equations[:, :3]).sum(axis=1) < 0.0
    return {"vertices": points, "triangles": np.where(inwards[:, None], hull.simplices[:, ::-1], hull.simplices)}


def section_points(shape: SolidShape) -> np.ndarray:
    """(n, 3) points on both sides of a shape [m] over a grid of heights and stations, found by bisection."""
    lower, upper = shape.bounds()
    tiny = 1e-6 * (upper - lower)
    y, z = (
        0.5 * (lower[k] + upper[k]) - (0.5 * (upper[k] - lower[k]) - tiny[k]) * np.cos(np.linspace(0.0, np.pi, count))
        for k, count in ((1, DRAWN_WATERLINES), (2, DRAWN_STATIONS))
    )  # close together at the ends, where a hull is round
    y, z = (grid.ravel() for grid in np.meshgrid(y, z, indexing="ij"))
    least, most = np.zeros(len(y)), np.full(len(y), upper[0])
    for _ in range(SIDE_HALVINGS):
        middle = 0.5 * (least + most)
        within = shape.inside(np.stack([middle, y, z], axis=1))
        least, most = np.where(within, middle, least), np.where(within, most, middle)
    there = shape.inside(np.stack([np.zeros(len(y)), y, z], axis=1))
    port = np.stack([most, y, z], axis=1)[there]
    return np.concatenate([port, port * [-1.0, 1.0, 1.0]])


def convex_corners(shape: SolidShape) -> np.ndarray:
    """(n, 3) corners of the convex hull of a shape [m], in its axes."""

    def made() -> dict[str, np.ndarray]:
        from scipy.spatial import ConvexHull

        vertices = drawn_mesh(shape)[0]
        return {"corners": vertices[ConvexHull(vertices).vertices]}

    return cached_arrays("outlines", shape.content(), made)["corners"]
