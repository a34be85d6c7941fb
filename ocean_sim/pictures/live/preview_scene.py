"""Arrays of a preview: water, ship, particles, lines. It knows no window."""

from typing import NamedTuple, Protocol

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.basin.points import grid, pairs
from ocean_sim.fluid import Fluid
from ocean_sim.parts import Scene
from ocean_sim.pictures.live.preview_eye import Eye
from ocean_sim.pictures.ships.ship_model import Model, modelled
from ocean_sim.pictures.stage.sky import SUN, unit
from ocean_sim.pictures.water import water_shading
from ocean_sim.pictures.water.water_mesh import WaterMesh
from ocean_sim.pictures.water.water_mesh import triangles as mesh_triangles
from ocean_sim.ship import Ship
from ocean_sim.surface import Surface
from ocean_sim.wind import Wind

NODES = 5_000  # of the drawn surface, about
MOST = 60_000  # particles that are drawn: of more, every second, third, ...
LEAST_FASTEST = 0.5  # [m/s] the least speed that has the brightest colour
TOP, BED = np.array([0.10, 0.40, 0.50]), np.array([0.02, 0.07, 0.12])  # the cut side of the water
ZENITH, HORIZON, GROUND = np.array([0.25, 0.45, 0.70]), np.array([0.80, 0.87, 0.92]), np.array([0.34, 0.40, 0.45])
DECK = np.array([0.93, 0.89, 0.80])
BASIN, AIR, ARROW = np.array([0.20, 0.28, 0.34]), np.array([0.98, 0.78, 0.22]), np.array([0.86, 0.16, 0.10])
# Dark blue over grey to yellow, lightness rising evenly, distinct to colour-blind eyes (Nunez et al. 2018, cividis).
SPEEDS = np.array([[0.0, 0.14, 0.31], [0.26, 0.31, 0.42], [0.49, 0.48, 0.47], [0.73, 0.68, 0.45], [1.0, 0.91, 0.30]])


class Subject(Protocol):
    """Parts of a simulation that its pictures and its panel read."""

    scene: Scene
    basin: Basin
    wind: Wind
    fluid: Fluid
    surface: Surface | None
    ships: dict[str, Ship]
    time: float  # [s]


class Patch(NamedTuple):
    """Triangles with a colour at every corner."""

    vertices: np.ndarray  # (n, 3) [m]
    triangles: np.ndarray  # (m, 3)
    colours: np.ndarray  # (n, 3) display RGB, 0 to 1


class Balls(NamedTuple):
    """Particles, coloured by speed."""

    positions: np.ndarray  # (n, 3) [m]
    colours: np.ndarray  # (n, 3)
    radius: float  # [m]
    every: int  # one of so many is drawn
    fastest: float  # [m/s] the speed of the last colour


class PreviewScene:
    """The arrays of one simulation; what never changes is made once."""

    def __init__(self, simulation: Subject) -> None:
        self.simulation = simulation
        basin, fluid = simulation.basin, simulation.fluid
        self.lower, self.upper = np.array(basin.lower, dtype=float), np.array(basin.upper, dtype=float)
        self.flat, self.spacing = basin.dimension == 2, fluid.spacing
        self.x, self.z = grid(basin, self.spacing)
        self.points = pairs(self.x, self.z)
        self.has_surface = not basin.closed and (fluid.particles is None or fluid.sound_speed > 0.0)
        surface = simulation.surface
        self.folds = surface is not None and not self.flat and bool((surface.mesh().normals[:, 1] <= 0.0).any())
        self.sheet = self.net = None
        if self.has_surface and not self.flat and not self.folds:
            self.sheet = WaterMesh(self.x, self.z, self.lower, self.upper, NODES)
            self.net = WaterMesh(self.x, self.z, self.lower, self.upper, len(self.points))
        drawn = {name: ship.drawn() for name, ship in simulation.ships.items()}
        self.hulls = {name: ShadedShip(self.model(name, *shape)) for name, shape in drawn.items() if shape is not None}
        self.lengths = {
            name: 0.0 if shape is None else float(np.ptp(shape[0], axis=0).max()) for name, shape in drawn.items()
        }  # [m] of each ship
        self.fastest = LEAST_FASTEST

    def model(self, name: str, vertices: np.ndarray, triangles: np.ndarray) -> Model:
        """What a ship looks like on her hull."""
        ship, scene = self.simulation.ships[name], self.simulation.scene
        look = scene.ships[name].look(scene.preflight)
        look_name, submerged = ("", 0.5) if look is None else (look.name, look.submerged)
        return modelled(vertices, triangles, submerged, look_name, ship.points.get("helm", np.zeros(0)))

    @property
    def contents(self) -> tuple[str, ...]:
        """Which of surface, particles and both this simulation can show."""
        surface = self.has_surface and not self.flat
        particles = self.simulation.fluid.particles is not None
        return tuple(
            name
            for name, there in (("surface", surface), ("particles", particles), ("both", surface and particles))
            if there
        )

    @property
    def cameras(self) -> tuple[str, ...]:
        """The available cameras: a helm needs a ship, a slice is seen from the side."""
        helm = ("helm",) if self.simulation.ships else ()
        return ("side",) if self.flat else ("third_person", *helm, "top", "side")

    @property
    def box(self) -> tuple[np.ndarray, np.ndarray]:
        """Corners of what a camera takes in [m]: the water, and some air above it."""
        air = max(0.25 * self.simulation.basin.depth, 0.3 * max(self.lengths.values(), default=0.0))
        return self.lower, np.array([self.upper[0], air, self.upper[2]])

    def heights(self) -> np.ndarray:
        """Heights of the surface at points all over the basin [m]; none where there is no surface."""
        shown = self.simulation.surface or self.simulation.fluid
        return shown.elevations(self.points) if self.has_surface else np.zeros(0)

    def water(self, heights: np.ndarray, eye: np.ndarray, solid: bool) -> Patch | None:
        """The surface, coloured for an eye: `solid` with the cut sides of the water, else a net to look through."""
        sheet = self.sheet if solid else self.net
        if sheet is None:
            return self.shell(heights, eye) if self.folds else None
        points, normals = sheet.surface(heights.reshape(len(self.x), len(self.z)))
        colours = self.coloured(points, normals, heights, eye)
        if not solid:
            return Patch(points, sheet.surface_triangles, colours)
        walls = sheet.sides(points)
        deep = sheet.side_depth[:, None] ** 0.6
        return Patch(
            np.concatenate([points, walls]),
            np.concatenate([sheet.surface_triangles, sheet.side_triangles + len(points)]),
            np.concatenate([colours, TOP + (BED - TOP) * deep]),
        )

    def shell(self, heights: np.ndarray, eye: np.ndarray) -> Patch | None:
        """A closed surface; what faces sideways or down is as dark as the cut side of the water."""
        surface = self.simulation.surface
        assert surface is not None  # it folds
        mesh = surface.mesh()
        if len(mesh.triangles) == 0:
            return None
        points, normals = mesh.vertices.astype(float), mesh.normals.astype(float)
        deep = np.clip(-points[:, 1:2] / self.simulation.basin.depth, 0.0, 1.0) ** 0.6
        up = np.clip(2.5 * normals[:, 1:2], 0.0, 1.0)
        colours = up * self.coloured(points, normals, heights, eye) + (1.0 - up) * (TOP + (BED - TOP) * deep)
        return Patch(points, mesh.triangles, colours)

    def coloured(self, points: np.ndarray, normals: np.ndarray, heights: np.ndarray, eye: np.ndarray) -> np.ndarray:
        """(n, 3) display colours of points of the surface."""
        crest = max(2.5 * float(np.std(heights)), 0.02 * self.simulation.basin.depth)
        height = np.clip(points[:, 1] / crest, -1.0, 1.0)
        return water_shading.display(water_shading.surface(points, normals, height, eye)) / 255.0

    def afloat(self) -> Patch | None:
        """All hulls where they are now."""
        bodies = {name: self.simulation.ships[name].body for name in self.hulls}
        posed = [hull.posed(bodies[name].position, bodies[name].matrix) for name, hull in self.hulls.items()]
        if not posed:
            return None
        before = np.cumsum([0, *(len(patch.vertices) for patch in posed)])
        return Patch(
            np.concatenate([patch.vertices for patch in posed]),
            np.concatenate([patch.triangles + np.int32(first) for patch, first in zip(posed, before)]),
            np.concatenate([patch.colours for patch in posed]),
        )

    def particles(self, small: bool) -> Balls | None:
        """Positions of the particles, coloured by speed, `small` under a net; the scale of the colours grows with the
        fastest and never shrinks."""
        particles = self.simulation.fluid.particles
        if particles is None:
            return None
        every = -(-particles.n // MOST)
        # By identity: in storage order another part of the water would be left out in every picture.
        drawn = slice(None) if every == 1 else particles.id.to_numpy() % every == 0
        positions = particles.position.to_numpy()[drawn]
        speed = np.linalg.norm(particles.velocity.to_numpy()[drawn], axis=1)
        self.fastest = max(self.fastest, float(np.quantile(speed, 0.999)) if len(speed) else 0.0)
        return Balls(
            positions, speed_colours(speed / self.fastest), (0.15 if small else 0.3) * self.spacing, every, self.fastest
        )

    def lines(self) -> tuple[np.ndarray, np.ndarray]:
        """(n, 2, 3) ends [m] and (n, 3) colours: the outline of the water at rest, the wind, in 2-D the surface."""
        top = np.array([self.upper[0], 0.0, self.upper[2]])
        corners = np.array([[(self.lower, top)[b][a] for a, b in enumerate(k)] for k in np.ndindex(2, 2, 2)])
        pairs_of = [(i, i ^ bit) for i in range(8) for bit in (1, 2, 4) if i < i ^ bit]
        parts = [(corners[np.array(pairs_of)], BASIN)]
        wind = self.simulation.wind.drawing()
        parts.append((self.clipped(wind.lines), AIR))
        parts.append((self.arrows(wind.tails, wind.arrows), ARROW))
        if self.flat and self.has_surface:
            line = np.stack([self.x, self.heights(), 0.0 * self.x], axis=1)
            parts.append((np.stack([line[:-1], line[1:]], axis=1), DECK))
        colours = np.concatenate([np.tile(colour, (len(ends), 1)) for ends, colour in parts])
        return np.concatenate([ends for ends, _ in parts]), colours

    def clipped(self, edges: np.ndarray) -> np.ndarray:
        """The edges of the air above the water, up to the top of the picture: a volume may reach far beyond."""
        low, high = 0.0, self.box[1][1]
        inside = edges.copy()
        inside[..., 1] = np.clip(edges[..., 1], low, high)
        if self.flat:
            inside[..., 2] = 0.0
        return inside[np.linalg.norm(inside[:, 1] - inside[:, 0], axis=1) > 1e-6]

    def arrows(self, feet: np.ndarray, pushes: np.ndarray) -> np.ndarray:
        """Shaft and four barbs of every arrow over the basin, above the water; length 1 is a tenth of the basin."""
        size = self.upper - self.lower
        inside = ((feet > self.lower) & (feet < self.upper) | (size <= 0.0))[:, [0, 2]].all(axis=1)
        feet, pushes = feet[inside], 0.1 * size.max() * pushes[inside]
        if self.flat:
            pushes = pushes * [1.0, 1.0, 0.0]
        long = np.linalg.norm(pushes, axis=1)
        feet, pushes, long = (a[long > 1e-3 * size.max()] for a in (feet, pushes, long))
        begin = feet * [1.0, 0.0, 1.0] + [0.0, 0.6 * self.box[1][1], 0.0]
        tip, along = begin + pushes, pushes / long[:, None]
        across = np.cross(along, [0.0, 1.0, 0.0])
        lying = np.linalg.norm(across, axis=1) < 1e-6
        across[lying] = [1.0, 0.0, 0.0]
        across /= np.linalg.norm(across, axis=1, keepdims=True)
        barb = 0.28 * long[:, None]
        upright = np.cross(along, across)
        barbs = [tip + barb * (-along + side * 0.4 * out) for out in (across, upright) for side in (-1.0, 1.0)]
        return np.concatenate([np.stack([a, tip], axis=1) for a in (begin, *barbs)])


class ShadedShip:
    """Triangles of a ship, each with corners of its own, as bright as the sun makes it."""

    def __init__(self, model: Model) -> None:
        self.corners = model.mesh.corners.reshape(-1, 3).astype(float)
        self.normals = model.mesh.normals.reshape(-1, 3).astype(float)
        self.paint = np.repeat(np.clip(model.mesh.colour, 0.0, 1.0) ** (1.0 / 2.2), 3, axis=0)
        self.triangles = np.arange(len(self.corners), dtype=np.int32).reshape(-1, 3)

    def posed(self, position: np.ndarray, turn: np.ndarray) -> Patch:
        """At a pose: position [m] and (3, 3) body to world."""
        light = 0.45 + 0.55 * np.clip((self.normals @ turn.T) @ SUN, 0.0, 1.0)
        return Patch(self.corners @ turn.T + position, self.triangles, self.paint * light[:, None])


def speed_colours(share: np.ndarray) -> np.ndarray:
    """(n,) shares of the highest speed -> (n, 3) display colours."""
    at = np.clip(share, 0.0, 1.0) * (len(SPEEDS) - 1)
    k = np.minimum(at.astype(int), len(SPEEDS) - 2)
    return SPEEDS[k] + (SPEEDS[k + 1] - SPEEDS[k]) * (at - k)[:, None]


def backdrop(eye: Eye, aspect: float) -> tuple[np.ndarray, np.ndarray]:
    """Sky and ground behind everything: (n, 2) corners of triangles in parts of the picture, y upwards, and (n, 3)
    display colours. Flat triangles cost a quarter of what a dome around the eye costs."""
    x, y = np.linspace(0.0, 1.0, 9), np.linspace(0.0, 1.0, 41)
    forward = unit(eye.target - eye.position)
    right = unit(np.cross(forward, eye.up))
    high, half = np.cross(right, forward), np.tan(np.radians(eye.angle / 2))
    grid_x, grid_y = np.meshgrid(x, y, indexing="ij")
    across, up = (2.0 * grid_x - 1.0)[..., None] * half * aspect, (2.0 * grid_y - 1.0)[..., None] * half
    colours = sky(unit(forward + across * right + up * high).reshape(-1, 3))
    corners = mesh_triangles(len(x), len(y)).ravel()
    return np.stack([grid_x, grid_y], axis=-1).reshape(-1, 2)[corners], colours[corners]


def sky(direction: np.ndarray) -> np.ndarray:
    """(n, 3) display colours in (n, 3) unit directions: a sky, and below the horizon a quiet ground."""
    high = direction[:, 1:2]
    above = ZENITH + (HORIZON - ZENITH) * np.exp(-np.maximum(high, 0.0) / 0.35)
    below = GROUND + (HORIZON - GROUND) * np.exp(np.minimum(high, 0.0) / 0.12)
    warm = 0.12 * np.clip(direction @ SUN, 0.0, 1.0)[:, None] ** 8 * np.array([1.0, 0.8, 0.4])
    return np.clip(np.where(high >= 0.0, above, below) + warm, 0.0, 1.0)
