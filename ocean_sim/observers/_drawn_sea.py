"""The sea in a picture: the basin's surface, the far sea around it, the sky above, shaded per pixel."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ocean_sim.observers import _far_sea, _foam, _ripples, _sky, _water_glsl
from ocean_sim.observers._camera import VIEW_ANGLE
from ocean_sim.observers._kept_frames import Frame
from ocean_sim.observers._sea_state import SeaState
from ocean_sim.observers._water_mesh import spline, triangles
from ocean_sim.observers._water_shading import EXPOSURE, FOG, Terms, slope_variance

if TYPE_CHECKING:
    from ocean_sim.observers._picture import Picture

NODES = {"draft": 25_000, "final": 90_000}  # of the drawn surface within the basin
SMOOTHED = 1.5  # pixels across which a final picture is smoothed
HULL_PIXELS, HULL_REACH = (96, 96), 3.0  # of the map of distances to a hull; [m] around it
CONTACT, CONTACT_WIDTH = 0.75, 0.30  # share of foam at a hull, and [m] in which it falls to a third


class Sky:
    """A dome with the sky on it, wherever the eye is."""

    def __init__(self, picture: "Picture", sky: _sky.Sky, image: Any) -> None:
        dome = picture.pyvista.Icosphere(radius=1.0, nsub=3)
        self.directions = np.asarray(dome.points, dtype=np.float32)
        self.shaded = _water_glsl.Shaded(dome, _water_glsl.SKY, "", {"sky": image}, attributes=False)
        self.shaded.set(exposure=EXPOSURE, fogReach=FOG, useFog=1.0, **_water_glsl.lit_by(sky))
        picture.plotter.add_actor(self.shaded.actor, reset_camera=False, render=False)

    def stand(self, eye: np.ndarray) -> None:
        self.shaded.mesh.points = (eye + 2.0 * _far_sea.OUT * self.directions).astype(np.float32)
        self.shaded.set(eyeW=eye)


class Sea:
    """A surface that is the basin's inside it, blends into the far sea around it, and ends behind the fog."""

    def __init__(self, picture: "Picture", grid: Any, state: SeaState) -> None:
        order, self.picture = picture.order, picture
        self.state, self.ground = state, grid
        lower, upper = grid["lower"], grid["upper"]
        self.lower, self.upper = lower[[0, 2]], upper[[0, 2]]
        self.margin = _far_sea.MARGIN * float((self.upper - self.lower).min())
        cells = len(grid["x"]), len(grid["z"])
        factor = int(np.clip(np.sqrt(NODES[order.quality] / (cells[0] * cells[1])), 1, 12))
        self.inner = [np.linspace(self.lower[k], self.upper[k], n * factor + 1) for k, n in enumerate(cells)]
        self.x, self.z = (_far_sea.axis(inner, self.margin) for inner in self.inner)
        self.shape = len(self.x), len(self.z)
        ends = self.lower, self.upper
        if state.exact is None:
            self.own = [self.stretched(spline(n, factor), k) for k, n in enumerate(cells)]
            self.share = np.outer(
                *(_far_sea.belonging(a, lo, hi, self.margin) for a, lo, hi in zip((self.x, self.z), *ends))
            )
            self.far = _far_sea.FarSea(state.estimated, self.x, self.z, self.lower, self.lower)
        else:
            self.far = _far_sea.FarSea(state.exact, self.x, self.z, *ends)
        places = np.stack(np.meshgrid(self.x, self.z, indexing="ij"), axis=-1).reshape(-1, 2)
        self.points = np.insert(places, 1, 0.0, axis=1).astype(np.float32)
        mesh = picture.pyvista.PolyData.from_regular_faces(self.points, triangles(*self.shape))
        for name in ("nrm", "att"):
            mesh.point_data[name] = np.zeros((len(places), 3), np.float32)
        self.sky = _sky.cloudy() if order.sky else _sky.clear()
        image = _water_glsl.texture(self.sky.image, smaller=True, repeat=True)
        self.gaps = _water_glsl.texture(np.zeros((*HULL_PIXELS, 3), np.float32))
        self.mirrored = _water_glsl.texture(np.zeros((2, 2, 4), np.uint8))
        textures = {"sky": image, "hull": self.gaps, "mirror": self.mirrored}
        self.shaded = _water_glsl.Shaded(mesh, _water_glsl.WATER, _water_glsl.WATER_FUNCTIONS, textures, attributes=True)
        self.dome = Sky(picture, self.sky, image)
        picture.plotter.add_actor(self.shaded.actor, reset_camera=False, render=False)
        height = order.size[1] * (SMOOTHED if order.quality == "final" else 1.0)
        wind = state.wind
        variance = slope_variance(wind.speed) if order.ripples else 0.0
        self.shaded.set(
            exposure=EXPOSURE,
            fogReach=FOG,
            pixel=2.0 * np.tan(np.radians(VIEW_ANGLE / 2.0)) / height,
            windAngle=wind.angle,
            rippleVariance=variance,
            rippleLongest=float(np.clip(2.0 * state.resolved, 0.02, 3.0)),
            useHull=0.0,
            useMirror=0.0,
            hullBox=np.zeros(3),
            hullSize=np.ones(3),
            hullFoam=np.array([CONTACT, CONTACT_WIDTH, 0.0]),
            mirrorAt=np.zeros(3),
            mirrorView=np.eye(4),
            **_water_glsl.lit_by(self.sky),
            **_water_glsl.switched(Terms(foam=order.foam)),
        )

    def stretched(self, inner: np.ndarray, k: int) -> np.ndarray:
        """(nodes, cells): from the heights of cells to all nodes along one side, mirrored in the walls and zero beyond
        the margin."""
        nodes = (self.x, self.z)[k]
        low, high = self.lower[k], self.upper[k]
        place = (_far_sea.mirrored(nodes, low, high) - low) / (high - low) * (len(inner) - 1)
        left = np.minimum(place.astype(int), len(inner) - 2)
        share = (place - left)[:, None]
        weights = (1.0 - share) * inner[left] + share * inner[left + 1]
        near = (nodes > low - self.margin) & (nodes < high + self.margin)
        return weights * near[:, None]

    def raised(self, frame: Frame) -> _far_sea.Raised:
        """Heights, convergence and lost slopes at all nodes: the basin's own inside it, a blend in the margin."""
        far = self.far.at(frame.time)
        if self.state.exact is not None:
            return far
        x, z = self.own
        size = self.upper - self.lower
        cells = frame.elevation.shape
        drawn_together = _foam.convergence(frame.elevation, size[0] / cells[0], size[1] / cells[1])
        # Seas that know nothing of each other: weights whose squares add up keep the height of the waves.
        mine = self.share / np.sqrt(self.share**2 + (1.0 - self.share) ** 2)
        rest = np.sqrt(1.0 - mine**2)
        level = self.state.level
        return _far_sea.Raised(
            level + mine * (x @ (frame.elevation - level) @ z.T) + rest * far.height,
            mine * (x @ drawn_together @ z.T) + rest * far.convergence,
            rest**2 * far.variance,
        )

    def show(self, frame: Frame) -> None:
        now = self.raised(frame)
        height = now.height
        self.height = height
        slope_x, slope_z = np.gradient(height, self.x, axis=0), np.gradient(height, self.z, axis=1)
        normal = np.stack([-slope_x, np.ones_like(height), -slope_z], axis=-1)
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        near = [(n >= lo - self.margin) & (n <= hi + self.margin) for n, lo, hi in zip((self.x, self.z), self.lower, self.upper)]
        known = now.convergence[np.ix_(*near)]
        share = _foam.shares(now.convergence, _foam.cover(known), known)
        crest = (height - self.state.level) / max(0.5 * self.state.height, 1e-3)
        self.points[:, 1] = height.ravel()
        mesh = self.shaded.mesh
        mesh.points = self.points
        mesh.point_data["nrm"] = normal.reshape(-1, 3).astype(np.float32)
        mesh.point_data["att"] = np.stack([share, crest, now.variance], axis=-1).reshape(-1, 3).astype(np.float32)
        mesh.Modified()
        eye = self.picture.camera.eye
        self.shaded.set(eyeW=eye, time=frame.time)
        self.dome.stand(eye)
