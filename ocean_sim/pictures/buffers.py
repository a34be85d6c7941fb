"""What a GGUI scene reads its points, colours and triangles from: Taichi fields that grow."""

from typing import Any

import numpy as np

from ocean_sim.kernel_library import ti
from ocean_sim.pictures.preview_scene import Patch


class Buffer:
    """A Taichi field for the window that grows with what is put into it."""

    def __init__(self, length: int, kind: Any = ti.f32) -> None:
        self.length, self.kind = length, kind
        self.field: Any = None

    def put(self, values: np.ndarray) -> int:
        """Take (n, length), or (n,) where length is 0; gives n. What lies beyond repeats the last: the window draws
        some of it, whatever count it is given."""
        n = len(values)
        if self.field is None or self.field.shape[0] < n:
            room = max(64, 2 ** int(np.ceil(np.log2(max(n, 1))))) if self.field is not None else max(n, 1)
            self.field = ti.Vector.field(self.length, self.kind, room) if self.length else ti.field(self.kind, room)
            self.host = np.zeros((room, self.length) if self.length else room, np.float32 if self.length else np.int32)
        self.host[:n] = values
        self.host[n:] = values[-1] if n else 0
        self.field.from_numpy(self.host)
        return n


class Mesh:
    """Triangles on the graphics side.

    One unit transform places them: without any, GGUI's shader takes what lies in a buffer that
    nobody filled, times nothing, and where that is no number the triangles are gone from the picture.
    """

    def __init__(self) -> None:
        self.transform = ti.Matrix.field(4, 4, ti.f32, 1)
        self.transform[0] = np.eye(4).tolist()
        self.vertices, self.normals, self.colours, self.corners = Buffer(3), Buffer(3), Buffer(3), Buffer(0, ti.i32)
        self.triangles: np.ndarray | None = None
        self.n = self.m = 0

    def put(self, patch: Patch) -> None:
        self.n = self.vertices.put(patch.vertices)
        self.colours.put(patch.colours)
        if self.normals.field is None or self.normals.field.shape != self.vertices.field.shape:
            self.normals = Buffer(3)
            self.normals.put(np.tile([0.0, 1.0, 0.0], (self.vertices.field.shape[0], 1)))  # of no use to plain colours
        if self.triangles is None or not np.array_equal(self.triangles, patch.triangles):
            self.m, self.triangles = self.corners.put(patch.triangles.ravel()), patch.triangles

    def show(self, scene: Any, wires: bool = False) -> None:
        scene.mesh_instance(
            self.vertices.field,
            transforms=self.transform,
            indices=self.corners.field,
            normals=self.normals.field,
            per_vertex_color=self.colours.field,
            two_sided=True,
            index_count=self.m,
            vertex_count=self.n,
            show_wireframe=wires,
        )
