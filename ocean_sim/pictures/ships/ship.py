"""Ships in a picture, and their mirror image in the water."""

from typing import Any

import numpy as np

from ocean_sim.pictures.ships import ship_glsl
from ocean_sim.pictures.ships.ship_model import ShipModel
from ocean_sim.pictures.stage.plotter import Stage
from ocean_sim.pictures.stage.sky import Sky
from ocean_sim.pictures.water import water_glsl
from ocean_sim.pictures.water.water_shading import FOG_DISTANCE, SEA_EXPOSURE

MIRROR_SHRINKING = 2  # pixels of the picture along each side of a pixel of the mirror's
SAMPLER_DISTANCE = 1.4  # distance that VTK's sampler is given over that within which it leaves no gap
MIRROR_NEAR = 0.1  # [m] before the mirrored eye


class ShadedShip:
    """Ship in a picture, shaded at each pixel in the light of sun and sky; moved from frame to frame."""

    def __init__(self, stage: Stage, model: ShipModel, sky: Sky, above: dict[str, Any], hazy: bool) -> None:
        """`above`: textures of the sky, by the names of their samplers in the shader; `hazy`: True for haze."""
        mesh = model.mesh
        self.sky, self.corners, self.normals = sky, mesh.corners.reshape(-1, 3), mesh.normals.reshape(-1, 3)
        gloss, seen = np.repeat(mesh.gloss, 3), ship_glsl.sky_shares(self.corners, self.normals)
        traits = self.normals, np.repeat(mesh.colour, 3, axis=0), np.stack([gloss, seen, 0.0 * gloss], axis=1)
        named = dict(zip(ship_glsl.SHIP_TRAITS, traits, strict=True))
        shape = stage.mesh(self.corners, np.arange(len(self.corners)).reshape(-1, 3), **named)
        reach = float(np.linalg.norm(self.corners, axis=1).max())
        self.shade = ship_glsl.ShadowMap(spread_points(shape.clean(), 2.0 * reach / ship_glsl.SHADOW_PIXELS), reach)
        self.map = water_glsl.make_texture(np.zeros((2, 2, 3), np.float32))
        textures = above | {"shade": self.map}
        program = ship_glsl.SHIP_PROGRAM, ship_glsl.SHIP_FUNCTIONS
        self.shaded = water_glsl.Shaded(shape, *program, textures, ship_glsl.SHIP_TRAITS)
        self.shaded.set(exposure=SEA_EXPOSURE, fogReach=FOG_DISTANCE, useFog=hazy, **water_glsl.sky_uniforms(sky))
        stage.plotter.add_actor(self.shaded.actor, reset_camera=False, render=False)

    def show(self, position: np.ndarray, turn: np.ndarray, eye: np.ndarray) -> None:
        """Move the centre of mass to a position (3,) [m]; `turn`: (3, 3) from body to world; `eye`: viewer (3,) [m]."""
        mesh = self.shaded.mesh
        mesh.points = (self.corners @ turn.T + position).astype(np.float32)
        mesh.point_data["nrm"] = (self.normals @ turn.T).astype(np.float32)
        depth, right, up = self.shade.map(turn, self.sky.sun)
        water_glsl.fill_image(self.map.GetInput(), depth)
        self.position, self.depth, self.across = position, depth, {"sunRight": right, "sunUp": up}
        self.shaded.set(shipAt=position, shipLength=self.shade.length, eyeW=eye, **self.across)


def spread_points(mesh: Any, step: float) -> np.ndarray:
    """Points (n, 3) [m], single precision, on a PyVista mesh: no spot on it is farther than `step` [m] from one."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersModeling import vtkPolyDataPointSampler

    sampler = vtkPolyDataPointSampler()
    sampler.SetInputData(mesh)
    sampler.SetDistance(SAMPLER_DISTANCE * step)
    sampler.Update()
    return vtk_to_numpy(sampler.GetOutput().GetPoints().GetData())


class Mirror:
    """Mirror image of the ships, less submerged parts, in the water; a second plotter draws it from a mirrored eye."""

    def __init__(self, stage: Stage, ships: list[water_glsl.Shaded], image: Any) -> None:
        """`ships`: actors to mirror; `image`: texture that receives the mirror image."""
        from vtkmodules.vtkCommonDataModel import vtkPlane

        width, height = stage.size
        self.stage, self.image = stage, image
        self.size = width // MIRROR_SHRINKING, height // MIRROR_SHRINKING
        self.plotter = stage.new_plotter(self.size)
        self.plotter.set_background("black")
        self.water = vtkPlane()
        self.water.SetNormal(0.0, 1.0, 0.0)
        for ship in ships:
            twin = ship.twin()
            twin.GetMapper().AddClippingPlane(self.water)
            self.plotter.add_actor(twin, reset_camera=False, render=False)

    def show(self, level: float) -> np.ndarray:
        """Draw the ships mirrored at a water level [m]; returns the matrix (4, 4) from world to mirror image."""
        eye, forward, up = self.stage.camera[:3]
        flip = np.array([1.0, -1.0, 1.0])
        camera, above = self.plotter.camera, self.stage.plotter.camera
        below = eye * flip + [0.0, 2.0 * level, 0.0]
        camera.position, camera.focal_point = tuple(below), tuple(below + forward * flip)
        camera.up, camera.view_angle = tuple(-up * flip), above.view_angle
        camera.clipping_range = (MIRROR_NEAR, above.clipping_range[1])
        self.water.SetOrigin(0.0, level, 0.0)
        self.plotter.render()
        seen = self.plotter.screenshot(None, return_img=True, transparent_background=True)
        water_glsl.fill_image(self.image.GetInput(), seen[::-1])
        return water_glsl.projection(camera, self.size[0] / self.size[1])
