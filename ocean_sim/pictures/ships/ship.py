"""Ships in a picture, and their mirror image in the water."""

from typing import Any

import numpy as np

from ocean_sim.pictures.ships import ship_glsl
from ocean_sim.pictures.ships.ship_model import ShipModel
from ocean_sim.pictures.stage.plotter import Stage
from ocean_sim.pictures.stage.sky import Sky, painted_light
from ocean_sim.pictures.water import water_glsl, water_shading
from ocean_sim.pictures.water.water_shading import FOG_DISTANCE, SEA_EXPOSURE

MIRROR_SHRINKING = 2  # pixels of the picture along each side of a pixel of the mirror's
MIRROR_NEAR = 0.1  # [m] before the mirrored eye


class DrawnShip:
    """A ship in a picture, coloured at her corners in the light of sun and sky, and moved from frame to frame."""

    def __init__(self, stage: Stage, model: ShipModel) -> None:
        mesh = model.mesh
        self.corners, self.normals = mesh.corners.reshape(-1, 3), mesh.normals.reshape(-1, 3)
        self.paint, self.gloss = np.repeat(mesh.colour, 3, axis=0), np.repeat(mesh.gloss, 3)[:, None]
        triangles = np.arange(len(self.corners)).reshape(-1, 3)
        self.shape = stage.pyvista.PolyData.from_regular_faces(self.corners.astype(np.float32), triangles)
        self.shape["colour"] = np.zeros((len(self.corners), 3), np.uint8)
        stage.plotter.add_mesh(self.shape, scalars="colour", rgb=True, lighting=False, smooth_shading=False)

    def show(self, position: np.ndarray, turn: np.ndarray, eye: np.ndarray) -> None:
        """Move the ship's centre of mass to a position (3,) [m]; `turn`: (3, 3) from body to world; `eye`: unused."""
        self.shape.points = (self.corners @ turn.T + position).astype(np.float32)
        self.shape["colour"] = water_shading.display_colours(
            painted_light(self.normals @ turn.T, self.paint, self.gloss)
        )


class ShadedShip:
    """A ship in a picture at sea, shaded at each pixel in the light of its sun and sky."""

    def __init__(self, stage: Stage, model: ShipModel, sky: Sky, above: dict[str, Any]) -> None:
        """`above`: textures of the sky, by their sampler names."""
        mesh = model.mesh
        self.sky, self.corners, self.normals = sky, mesh.corners.reshape(-1, 3), mesh.normals.reshape(-1, 3)
        shape = stage.pyvista.PolyData.from_regular_faces(
            self.corners.astype(np.float32), np.arange(len(self.corners)).reshape(-1, 3)
        )
        gloss, seen = np.repeat(mesh.gloss, 3), ship_glsl.sky_shares(self.corners, self.normals)
        traits = self.normals, np.repeat(mesh.colour, 3, axis=0), np.stack([gloss, seen, 0.0 * gloss], axis=1)
        for name, values in zip(ship_glsl.SHIP_TRAITS, traits, strict=True):
            shape.point_data[name] = values.astype(np.float32)
        self.shade = ship_glsl.ShadowMap(mesh.corners, float(np.linalg.norm(self.corners, axis=1).max()))
        self.map = water_glsl.make_texture(np.zeros((2, 2, 3), np.float32))
        textures = above | {"shade": self.map}
        self.shaded = water_glsl.Shaded(
            shape, ship_glsl.SHIP_PROGRAM, ship_glsl.SHIP_FUNCTIONS, textures, ship_glsl.SHIP_TRAITS
        )
        self.shaded.set(exposure=SEA_EXPOSURE, fogReach=FOG_DISTANCE, useFog=1.0, **water_glsl.sky_uniforms(sky))
        stage.plotter.add_actor(self.shaded.actor, reset_camera=False, render=False)

    def show(self, position: np.ndarray, turn: np.ndarray, eye: np.ndarray) -> None:
        """Move the centre of mass to a position (3,) [m]; `turn`: (3, 3) from body to world; `eye`: of the viewer."""
        mesh = self.shaded.mesh
        mesh.points = (self.corners @ turn.T + position).astype(np.float32)
        mesh.point_data["nrm"] = (self.normals @ turn.T).astype(np.float32)
        depth, right, up = self.shade.map(turn, self.sky.sun)
        water_glsl.fill_image(self.map.GetInput(), depth)
        self.position, self.depth, self.across = position, depth, {"sunRight": right, "sunUp": up}
        self.shaded.set(shipAt=position, shipLength=self.shade.length, eyeW=eye, **self.across)


class Mirror:
    """Mirror image of the ships in the water: a second plotter with a mirrored eye, which cuts off submerged parts."""

    def __init__(self, stage: Stage, ships: list[water_glsl.Shaded], image: Any) -> None:
        """`ships`: actors to mirror; `image`: texture that receives the mirror image."""
        from vtkmodules.vtkCommonDataModel import vtkPlane

        width, height = stage.size
        self.stage, self.image = stage, image
        self.size = width // MIRROR_SHRINKING, height // MIRROR_SHRINKING
        self.plotter = stage.empty(self.size)
        self.plotter.set_background("black")
        self.water = vtkPlane()
        self.water.SetNormal(0.0, 1.0, 0.0)
        for ship in ships:
            twin = ship.twin()
            twin.GetMapper().AddClippingPlane(self.water)
            self.plotter.add_actor(twin, reset_camera=False, render=False)

    def show(self, level: float) -> np.ndarray:
        """Draw the ships mirrored at a water level [m]; returns the projection (4, 4) from world to mirror image."""
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
        aspect = self.size[0] / self.size[1]
        matrix = camera.GetCompositeProjectionTransformMatrix(aspect, -1.0, 1.0)
        return np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])

    def close(self) -> None:
        self.plotter.close()
