"""The obstacles of a basin in a picture: boxes of concrete."""

import numpy as np

from ocean_sim.pictures.frame_files import Frame
from ocean_sim.pictures.stage.plotter import Stage
from ocean_sim.pictures.stage.sky import painted_light
from ocean_sim.pictures.water import water_shading

CONCRETE_COLOUR = np.array([0.42, 0.40, 0.37])  # linear RGB
INSET_SHARE = 2.0e-3  # of the basin: a face that lies in a side of the basin is not drawn in the same plane


def box_faces(low: np.ndarray, up: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners (24, 3) [m] of the six rectangles of a box, four each in order around it, and their normals (24, 3)."""
    corners, normals = [], []
    for axis in range(3):
        first, second = (axis + 1) % 3, (axis + 2) % 3
        for side, end in ((-1.0, low), (1.0, up)):
            turn = [(low, low), (up, low), (up, up), (low, up)]
            for a, b in turn:
                corner = np.empty(3)
                corner[axis], corner[first], corner[second] = end[axis], a[first], b[second]
                corners.append(corner)
            normals += [side * np.eye(3)[axis]] * 4
    return np.array(corners), np.array(normals)


class Obstacles:
    """Those that are fixed are drawn once, gates anew in every picture."""

    def __init__(self, stage: Stage, fixed: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> None:
        """Lower and upper corners (n, 2, 3) [m] in a basin from `lower` to `upper` [m]."""
        inset = INSET_SHARE * (upper - lower)
        self.stage, self.lower = stage, lower + inset
        self.upper = np.array([upper[0] - inset[0], np.inf, upper[2] - inset[2]])  # it may stand out of the water
        self.add("obstacles", fixed)

    def show(self, frame: Frame) -> None:
        self.add("gates", frame.gates)

    def add(self, name: str, boxes: np.ndarray) -> None:
        """Draw these boxes (n, 2, 3) [m] in place of those that were drawn under this name."""
        plotter = self.stage.plotter
        plotter.remove_actor(name, render=False)
        if len(boxes):
            found = [box_faces(np.maximum(low, self.lower), np.minimum(up, self.upper)) for low, up in boxes]
            points, normals = (np.concatenate(part) for part in zip(*found))
            quads = np.arange(len(points)).reshape(-1, 4)
            shape = self.stage.pyvista.PolyData.from_regular_faces(points.astype(np.float32), quads)
            paint = np.broadcast_to(CONCRETE_COLOUR, points.shape)
            shape["colour"] = water_shading.display_colours(painted_light(normals, paint, np.zeros((len(points), 1))))
            plotter.add_mesh(
                shape,
                scalars="colour",
                rgb=True,
                lighting=False,
                smooth_shading=False,
                name=name,
                reset_camera=False,
                render=False,
            )
