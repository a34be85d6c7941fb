"""The ship as the water mirrors it: drawn from the eye's mirror image below the water into a picture of its own."""

from typing import Any

import numpy as np

from ocean_sim.pictures import water_glsl
from ocean_sim.pictures.stage import Stage

SHARE = 2  # pixels of the picture along each side of a pixel of the mirror's
NEAR = 0.1  # [m] before the mirrored eye


class Mirror:
    """A second plotter with the ships, seen from a mirrored eye; what lies under water is cut off."""

    def __init__(self, stage: Stage, ships: list[water_glsl.Shaded], image: Any) -> None:
        """`image`: the texture that the mirror's picture goes to."""
        from vtkmodules.vtkCommonDataModel import vtkPlane

        width, height = stage.size
        self.stage, self.image = stage, image
        self.size = width // SHARE, height // SHARE
        self.plotter = stage.empty(self.size)
        self.plotter.set_background("black")
        self.water = vtkPlane()
        self.water.SetNormal(0.0, 1.0, 0.0)
        for ship in ships:
            twin = ship.twin()
            twin.GetMapper().AddClippingPlane(self.water)
            self.plotter.add_actor(twin, reset_camera=False, render=False)

    def show(self, level: float) -> np.ndarray:
        """Draws the ship mirrored at a level [m]; returns the matrix (4, 4) from the world to the mirror's picture."""
        eye, forward, up = self.stage.camera[:3]
        flip = np.array([1.0, -1.0, 1.0])
        camera, above = self.plotter.camera, self.stage.plotter.camera
        below = eye * flip + [0.0, 2.0 * level, 0.0]
        camera.position, camera.focal_point = tuple(below), tuple(below + forward * flip)
        camera.up, camera.view_angle = tuple(-up * flip), above.view_angle
        camera.clipping_range = (NEAR, above.clipping_range[1])
        self.water.SetOrigin(0.0, level, 0.0)
        self.plotter.render()
        seen = self.plotter.screenshot(None, return_img=True, transparent_background=True)
        water_glsl.fill(self.image.GetInput(), seen[::-1])
        aspect = self.size[0] / self.size[1]
        matrix = camera.GetCompositeProjectionTransformMatrix(aspect, -1.0, 1.0)
        return np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])

    def close(self) -> None:
        self.plotter.close()
