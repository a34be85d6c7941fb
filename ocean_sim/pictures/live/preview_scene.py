"""Arrays and cameras of a preview: water, ships and particles, without a window."""

from math import cos, radians, sin, tan
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ocean_sim.basin.points import grid, grid_points
from ocean_sim.pictures.frame_files import grid_arrays
from ocean_sim.pictures.live.panel import Panel
from ocean_sim.pictures.live.scene_lines import box_top, surface_heights
from ocean_sim.pictures.ships.ship_model import kept_models
from ocean_sim.pictures.stage.camera import VIEW_ANGLE, Camera, eye_before, helm_camera
from ocean_sim.pictures.stage.obstacles import sand_mesh
from ocean_sim.pictures.stage.sky import unit_vector
from ocean_sim.pictures.water import water_shading
from ocean_sim.pictures.water.water_mesh import WaterMesh

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation

SURFACE_NODES = 5_000  # of the drawn surface, about
HELM_NEAR = 0.2  # [m] the least distance that is drawn at the helm
LONG_BASIN = 6.0  # lengths of a ship; in a longer basin the camera follows it
FOLLOWED_SIZE = 2.5  # lengths of a ship that a camera which follows it sees
FILLED_SHARE = 0.95  # of the free part of the picture that the box fills along one side
MAX_PARTICLES = 60_000  # that are drawn: of more, every second, third, ...
MIN_FASTEST_SPEED = 0.5  # [m/s] the least speed that has the brightest colour
SIDE_COLOURS = np.array([[0.10, 0.40, 0.50], [0.02, 0.07, 0.12]])  # top and bed of the water's cut side, display RGB
# Dark blue over grey to yellow, lightness rising evenly, distinct to colour-blind eyes (Nunez et al. 2018, cividis).
SPEED_COLOURS = np.array(
    [[0.0, 0.14, 0.31], [0.26, 0.31, 0.42], [0.49, 0.48, 0.47], [0.73, 0.68, 0.45], [1.0, 0.91, 0.30]]
)


class Patch(NamedTuple):
    """Triangles to draw in a preview window, with a colour at every corner."""

    vertices: np.ndarray  # (n, 3) [m]
    triangles: np.ndarray  # (m, 3)
    colours: np.ndarray  # (n, 3) display RGB, 0 to 1


class PreviewScene:
    """Arrays that a preview draws of a running simulation; those that never change are computed once."""

    def __init__(self, simulation: "Simulation") -> None:
        self.simulation = simulation
        basin, fluid, surface = simulation.basin, simulation.fluid, simulation.surface
        self.lower, self.upper = np.array(basin.lower, dtype=float), np.array(basin.upper, dtype=float)
        self.flat, self.spacing = basin.dimension == 2, fluid.spacing
        self.x, self.z = grid(basin, self.spacing)
        self.points = grid_points(self.x, self.z)
        self.has_surface = not self.flat and not basin.closed and (fluid.particles is None or fluid.sound_speed > 0.0)
        folds = surface is not None and not self.flat and bool((surface.mesh().normals[:, 1] <= 0.0).any())
        self.sheet = WaterMesh(self.x, self.z, self.lower, self.upper, SURFACE_NODES) if not folds else None
        self.models = kept_models(grid_arrays(simulation, self.x, self.z))
        self.lengths = {name: model.length for name, model in self.models.items()}  # [m]
        self.fastest = MIN_FASTEST_SPEED
        self.sand: Patch | None = None  # the bed, if it has a shape
        if basin.ground is not None:
            vertices, triangles, colours = sand_mesh(basin.ground, self.spacing)
            self.sand = Patch(vertices, triangles, colours / 255.0)

    @property
    def contents(self) -> tuple[str, ...]:
        """Names of the contents that this simulation can show, out of `surface`, `particles` and `both`."""
        particles = self.simulation.fluid.particles is not None
        shown = {"surface": self.has_surface, "particles": particles, "both": self.has_surface and particles}
        return tuple(name for name, available in shown.items() if available)

    @property
    def cameras(self) -> tuple[str, ...]:
        """Names of the cameras available: `helm` only with a ship, `side` alone in 2-D."""
        helm = ("helm",) if self.simulation.ships else ()
        return ("side",) if self.flat else ("third_person", *helm, "top", "side")

    @property
    def box(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner (3,) [m] of the box to show: the water and some air above it."""
        top = box_top(self.simulation, max(self.lengths.values(), default=0.0))
        return self.lower, np.array([self.upper[0], top, self.upper[2]])

    def camera(self, panel: Panel, aspect: float, covered: float) -> Camera:
        """Camera that the panel chooses: at the helm, before the whole box or, in a long basin, before the ship.
        `aspect`: width over height of the picture, whose left share `covered` the panel hides."""
        ship, length = self.simulation.ships.get(panel.ship), self.lengths.get(panel.ship, 0.0)
        if panel.camera == "helm" and ship is not None:
            helm = ship.points.get("helm", np.array([0.0, 0.25 * (length or 4.0), 0.0]))
            return helm_camera(ship.body.position, ship.body.matrix, helm, HELM_NEAR)
        lower, upper = self.box
        middle, size = 0.5 * (lower + upper), upper - lower
        if ship is not None and length and max(size[0], size[2]) > LONG_BASIN * length:
            middle, size = ship.body.position * [1.0, 0.0, 1.0], np.full(3, FOLLOWED_SIZE * length)
        forward, up = np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, -1.0])
        if panel.camera != "top":
            azimuth, height = (0.0, 0.0) if panel.camera == "side" else (panel.azimuth, panel.height)
            forward = -np.array([cos(height) * sin(azimuth), sin(height), cos(height) * cos(azimuth)])
            up = np.array([0.0, 1.0, 0.0])
        right = unit_vector(np.cross(forward, up))
        up = np.cross(right, forward)
        corners = middle + 0.5 * size * (2.0 * np.array(list(np.ndindex(2, 2, 2))) - 1.0)
        tangent = tan(radians(VIEW_ANGLE / 2))
        free = FILLED_SHARE * tangent * aspect * (1.0 - covered), FILLED_SHARE * tangent
        aside = tangent * aspect * covered  # tangent at which the middle of the free part lies
        eye = eye_before(corners, (right, up, forward), free, aside)
        reach = float((middle - eye) @ forward)
        eye -= (panel.distance - 1.0) * reach * (forward + aside * right)
        return Camera(eye, forward, up, None, near=0.02 * panel.distance * reach)

    def water_patch(self, eye: np.ndarray, solid: bool) -> Patch | None:
        """Water surface, coloured for an eye (3,) [m]; None without a surface. `solid`: True to add cut sides below."""
        if not self.has_surface:
            return None
        heights = surface_heights(self.simulation, self.points)
        if self.sheet is None:
            return self.folded_patch(heights, eye)
        points, normals = self.sheet.surface(heights.reshape(len(self.x), len(self.z)))
        colours = self.surface_colours(points, normals, heights, eye)
        if not solid:
            return Patch(points, self.sheet.surface_triangles, colours)
        sides = water_shading.colour_scale(self.sheet.side_depth**0.6, SIDE_COLOURS)
        triangles = np.concatenate([self.sheet.surface_triangles, self.sheet.side_triangles + len(points)])
        return Patch(np.concatenate([points, self.sheet.sides(points)]), triangles, np.concatenate([colours, sides]))

    def folded_patch(self, heights: np.ndarray, eye: np.ndarray) -> Patch | None:
        """Coloured triangles of a water surface that overturns, for an eye (3,) [m], darker where it faces down; None
        if it has none. `heights`: as in `surface_colours`."""
        surface = self.simulation.surface
        assert surface is not None  # only a surface folds
        mesh = surface.mesh()
        if len(mesh.triangles) == 0:
            return None
        points, normals = mesh.vertices.astype(float), mesh.normals.astype(float)
        depth = np.clip(-points[:, 1] / self.simulation.basin.depth, 0.0, 1.0)
        up, sides = np.clip(2.5 * normals[:, 1:2], 0.0, 1.0), water_shading.colour_scale(depth**0.6, SIDE_COLOURS)
        colours = up * self.surface_colours(points, normals, heights, eye) + (1.0 - up) * sides
        return Patch(points, mesh.triangles, colours)

    def surface_colours(
        self, points: np.ndarray, normals: np.ndarray, heights: np.ndarray, eye: np.ndarray
    ) -> np.ndarray:
        """Display RGB (n, 3), 0 to 1, of surface points (n, 3) [m] with `normals` (n, 3), for an eye (3,) [m].
        `heights` of the whole surface [m]: their standard deviation tells crests from troughs."""
        crest = max(2.5 * float(np.std(heights)), 0.02 * self.simulation.basin.depth)
        height = np.clip(points[:, 1] / crest, -1.0, 1.0)
        return water_shading.display_colours(water_shading.surface_light(points, normals, height, eye)) / 255.0

    def ship_patch(self) -> Patch | None:
        """Triangles of all ships at their present poses, in the light of sun and sky; None without ships."""
        if not self.models:
            return None
        bodies = {name: self.simulation.ships[name].body for name in self.models}
        placed = [self.models[name].placed(body.position, body.matrix) for name, body in bodies.items()]
        vertices, colours = (np.concatenate(arrays) for arrays in zip(*placed))
        return Patch(vertices, np.arange(len(vertices)).reshape(-1, 3), colours / 255.0)

    def particle_balls(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Positions (n, 3) [m] and colours by speed (n, 3), display RGB 0 to 1, of the particles; None without any.
        Updates `fastest`, the speed of the brightest colour, which never falls."""
        particles = self.simulation.fluid.particles
        if particles is None:
            return None
        every = -(-particles.n // MAX_PARTICLES)
        # By identity: in storage order another part of the water would be left out in every picture.
        drawn = slice(None) if every == 1 else particles.id.to_numpy() % every == 0
        speed = np.linalg.norm(particles.velocity.to_numpy()[drawn], axis=1)
        self.fastest = max(self.fastest, float(np.quantile(speed, 0.999)) if len(speed) else 0.0)
        colours = water_shading.colour_scale(speed / self.fastest, SPEED_COLOURS)
        return particles.position.to_numpy()[drawn], colours
