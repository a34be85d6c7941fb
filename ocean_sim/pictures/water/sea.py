"""The sea in a picture: the basin's surface, the far sea around it, the sky above, shaded per pixel."""

from typing import Any

import numpy as np

from ocean_sim import waves
from ocean_sim.basin.points import grid_points, middles_of
from ocean_sim.pictures.frame_files import Frame, ship_keys
from ocean_sim.pictures.ships import ship_glsl
from ocean_sim.pictures.ships.ship import MIRROR_SHRINKING, Mirror, ShadedShip
from ocean_sim.pictures.ships.ship_model import ShipModel
from ocean_sim.pictures.stage import sky as sky_module
from ocean_sim.pictures.stage.camera import Vessel
from ocean_sim.pictures.stage.plotter import Content, Stage
from ocean_sim.pictures.stage.render_order import Order
from ocean_sim.pictures.water import far_sea, foam, water_glsl, waterline
from ocean_sim.pictures.water.sea_state import SeaNow, SeaState
from ocean_sim.pictures.water.water_mesh import spline_matrix
from ocean_sim.pictures.water.water_shading import SEA_EXPOSURE, slope_variance
from ocean_sim.surface import cell_triangles, sheet
from ocean_sim.waves.orbits import surface_fall

NODE_TRAITS = "nrm", "att", "car"  # normal; white, crest, variance of slopes; place by which foam finds its grain
BASIN_NODES = {"draft": 6_000, "final": 90_000}  # of the drawn surface within the basin
SMOOTHED_PIXELS = 1.5  # pixels across which a final picture is smoothed
RIPPLE_LENGTHS = 0.02, 3.0  # [m] between which the longest ripple lies
WHITE_REACH = 6  # cells from white water, of the grid that it is kept on, from which a spline through it shows none
GATHERING_LENGTH = 7.0  # [m] apart at which white water gathers along a crest
HULL_PIXELS = (96, 96)  # of the map of distances to a hull and of its foam


class Dome:
    """Sphere around the eye that shows the sky and moves with the eye."""

    def __init__(self, stage: Stage, image: Any) -> None:
        dome = stage.pyvista.Icosphere(radius=1.0, nsub=3)
        self.directions = np.asarray(dome.points, dtype=np.float32)
        self.shaded = water_glsl.Shaded(dome, water_glsl.SKY_PROGRAM, "", {"sky": image})
        self.shaded.set(exposure=SEA_EXPOSURE)

    def move_to(self, eye: np.ndarray) -> None:
        """Centre the sphere on an eye (3,) [m]."""
        self.shaded.mesh.points = (eye + 2.0 * far_sea.SEA_RADIUS * self.directions).astype(np.float32)
        self.shaded.set(eyeW=eye)


class SeaSurface:
    """Surface of the sea around an eye: an even grid of nodes over the basin, and a fan of nodes beyond. Near the sides
    of the basin its waves are blended into those of the far sea. Only heights and the origin change."""

    def __init__(self, grid: Any, state: SeaState, nodes: int) -> None:
        """`grid`: arrays in the run's grid.npz; `state`: sea over time; `nodes`: approximate number in the basin."""
        self.state = state
        self.lower, self.upper = grid["lower"][[0, 2]], grid["upper"][[0, 2]]
        self.margin = far_sea.BLEND_MARGIN * float((self.upper - self.lower).min())
        cells = len(grid["x"]), len(grid["z"])
        factor = int(np.clip(np.sqrt(nodes / (cells[0] * cells[1])), 1, 24))
        factor += factor % 2  # the points whose heights are known are nodes
        self.x, self.z = (np.linspace(self.lower[k], self.upper[k], n * factor + 1) for k, n in enumerate(cells))
        self.own = [spline_matrix(n, factor) for n in cells]
        sides = zip((self.x, self.z), self.lower, self.upper, strict=True)
        self.share = np.outer(*(far_sea.blend_weight(nodes, low, up, self.margin) for nodes, low, up in sides))
        self.far, self.fan = far_sea.PlaneWaves(state.beyond, self.x, self.z), far_sea.Fan(state.beyond)
        self.exact = None if state.exact is None else far_sea.PlaneWaves(state.exact, self.x, self.z)
        self.nodes = grid_points(self.x, self.z)
        self.grain = self.grain_at(np.zeros(2))
        self.wanted = 0.0  # share of white water

    def grain_at(self, origin: np.ndarray) -> np.ndarray:
        """Factor (nx, nz), 1 on average, that makes foam patchy, at the nodes of a basin around x, z `origin` [m]."""
        return foam.gathering_noise((self.nodes + origin).T / GATHERING_LENGTH).reshape(len(self.x), len(self.z))

    def at(self, frame: Frame, now: SeaNow, answer: np.ndarray | None = None) -> far_sea.SeaSample:
        """Heights [m] and convergence (downward acceleration over gravity) at the basin's nodes (nx, nz) in a frame;
        `now`: sea around. `answer`: heights [m] on its grid beyond exact plane waves, by ships, wind, nonlinearity."""
        far = self.far.at(far_sea.complex_amplitudes(now.waves, frame.time, frame.origin))
        (x, z), mine = self.own, self.share
        if self.exact is not None and self.state.exact is not None:
            sea = far_sea.grown_waves(self.state.exact, frame.time)
            near = self.exact.at(far_sea.complex_amplitudes(sea, frame.time, frame.origin))
            if answer is not None:
                near = near._replace(height=near.height + x @ answer @ z.T)
            return far_sea.SeaSample(far.height + mine * (near.height - far.height), near.convergence)
        step = (self.upper - self.lower) / frame.elevation.shape
        convergence = surface_fall(frame.elevation, step[0], step[1])
        # Seas that know nothing of each other: weights whose squares add up to one keep the height of the waves.
        rest = (1.0 - mine) / np.hypot(mine, 1.0 - mine)
        mine = mine / np.hypot(mine, 1.0 - mine)
        level = now.level
        return far_sea.SeaSample(
            level + mine * (x @ (frame.elevation - level) @ z.T) + rest * far.height,
            mine * (x @ convergence @ z.T) + rest * far.convergence,
        )

    def far_samples(self, frame: Frame, eye: np.ndarray, now: SeaNow) -> np.ndarray:
        """Height [m], slopes along x and z, and convergence (downward acceleration over gravity) of the far sea `now`,
        at nodes on rings around an eye (3,) [m] and rays from it (rings, rays, 4)."""
        found = self.fan.at(far_sea.complex_amplitudes(now.waves, frame.time, eye[[0, 2]]))
        found[..., 0] += now.level
        return found

    def foam(self, convergence: np.ndarray, cover: float | None = None) -> np.ndarray:
        """Share (nx, nz) of white water, highest where `convergence` (downward acceleration over gravity) is; `cover`
        on average, by default the share of crests that break."""
        self.wanted = foam.crest_cover(convergence) if cover is None else cover
        return foam.white_shares(convergence * self.grain, self.wanted)

    def far_foam(
        self, found: np.ndarray, rings: np.ndarray, nodes: np.ndarray, eye: np.ndarray, amplitude: np.ndarray
    ) -> np.ndarray:
        """Share (bands, rays) of white water at `nodes` x, z (bands * rays, 2) [m] of the far sea: on each ray from the
        `eye`, in each row of pixels (band), on ring `rings` (bands, rays). `found`: as `far_samples`; `amplitude` (m,):
        of waves [m]. Each ring has the basin's mean share, and varies less the more waves are too short to draw."""
        if self.wanted <= 0.0:
            return np.zeros(rings.shape)
        fan = self.fan
        whole, drawn = fan.convergence_deviation(amplitude)
        told = np.clip(drawn / whole, 1e-3, 1.0)
        gathered = found[..., 3] / (told * whole)[:, None]
        near = fan.nodes[fan.evenly] + eye[[0, 2]]
        known = np.sort(gathered.flat[fan.evenly] * foam.gathering_noise(near.T / GATHERING_LENGTH))
        gathering = foam.gathering_noise(nodes.T / GATHERING_LENGTH).reshape(rings.shape)
        here = np.take_along_axis(gathered, rings, axis=0) * gathering
        white = foam.white_shares(here, self.wanted, known)
        return self.wanted + told[rings] * (white - self.wanted)

    def blended_foam(self, fresh: np.ndarray, kept: np.ndarray, grain: np.ndarray) -> np.ndarray:
        """Share (nx, nz) of white water at the basin's nodes: inside, that `kept` in a frame, on its grid; at the
        sides, `fresh` (nx, nz) on converging crests. `grain` (n, 2): positions [m] in the noise that bends edges."""
        return self.laced_foam(kept, grain) + (1.0 - self.share) * fresh

    def on_nodes(self, kept: np.ndarray) -> np.ndarray:
        """Values `kept` in a frame, on its grid, interpolated to nodes (nx, nz) and faded to 0 at the basin's sides."""
        x, z = self.own
        return self.share * (x @ kept @ z.T)

    def laced_foam(self, kept: np.ndarray, grain: np.ndarray) -> np.ndarray:
        """Share (nx, nz) of white water at the nodes, from that `kept` in a frame, on its grid; noise bends edges by
        about a cell. `grain` (n, 2): position [m] at which each node reads the noise, which drifts with the water."""
        from scipy.ndimage import map_coordinates, maximum_filter

        cell, white = (self.upper - self.lower) / kept.shape, np.zeros(self.share.shape)
        near = maximum_filter(kept, 2 * WHITE_REACH + 1) > foam.MIN_SHARE
        rows, columns = (
            np.clip((nodes - self.lower[k]) / cell[k], 0, kept.shape[k] - 1).astype(int)
            for k, nodes in enumerate((self.x, self.z))
        )
        some = near[np.ix_(rows, columns)]
        at = ((self.nodes[some.ravel()] - self.lower) / cell).T - 0.5
        of_x, of_z = (grain[some.ravel()] / cell).T
        at += foam.edge_bends(of_x, of_z, self.state.angle)
        white[some] = map_coordinates(kept, at, order=3, mode="nearest")
        return self.share * np.clip(white, 0.0, 1.0)


class Sea(Content):
    """Water in a picture at sea: the basin's surface, blended into the far sea, which ends in fog at the horizon."""

    def __init__(self, stage: Stage, order: Order, vessels: dict[str, Vessel], grid: Any, state: SeaState) -> None:
        """`vessels`: ships by key; `grid`: arrays in the run's grid.npz; `state`: sea around the basin over time."""
        self.stage, self.order, self.state = stage, order, state
        self.surface = SeaSurface(grid, state, BASIN_NODES[order.quality])
        sky = self.sky = sky_module.cloudy_sky() if order.sky else sky_module.clear_sky_image()
        self.above, self.look = water_glsl.sky_textures(sky), (sky, SEA_EXPOSURE)
        self.hulls = {key: waterline.Hull(grid, key) for key in ship_keys(grid, "_vertices")}
        rows, columns = HULL_PIXELS
        self.vessels, self.points = vessels, (grid["x"], grid["z"])
        self.gap = np.zeros((max(len(self.hulls), 1), rows, columns, 3), np.float32)  # [m] and share, for each ship
        self.gaps = water_glsl.make_texture(self.gap.reshape(-1, columns, 3))
        self.mirrored = water_glsl.make_texture(np.zeros((2, 2, 4), np.uint8), smaller=True)
        pixels = ship_glsl.SHADOW_PIXELS
        self.shadow = np.zeros((max(len(self.hulls), 1), pixels, pixels, 3), np.float32)  # [m]
        self.shadows = water_glsl.make_texture(self.shadow.reshape(-1, ship_glsl.SHADOW_PIXELS, 3))
        textures = self.above | {"hull": self.gaps, "mirror": self.mirrored, "shade": self.shadows}
        dark = "".join(water_glsl.shader("sea_shadow", ship_glsl, k=k) for k in range(len(self.hulls)))
        body = water_glsl.water_program(len(self.hulls), "carW.xz", dark)
        functions = water_glsl.WATER_FUNCTIONS + ship_glsl.SHADOW_FUNCTIONS
        corners = cell_triangles(len(self.surface.x), len(self.surface.z))
        inner, empty = self.mesh_of(self.surface.nodes, corners), stage.pyvista.PolyData()
        self.near = water_glsl.Shaded(inner, body, functions, textures, NODE_TRAITS)
        self.far = water_glsl.Shaded(empty, water_glsl.shader("sea_beyond") + body, functions, textures, NODE_TRAITS)
        self.dome = Dome(stage, self.above["sky"])
        terms = {"Fresnel": order.fresnel, "Reflection": order.reflection, "Body": order.body, "Foam": order.foam}
        shown = water_glsl.neutral_uniforms(len(self.hulls)) | water_glsl.sky_uniforms(sky)
        shown |= {f"use{name}": float(there) for name, there in terms.items()}
        shown["glintKind"] = water_glsl.GLINTS[order.glint]
        shown["hullFoam"] = np.array([waterline.RESTING_FOAM, waterline.CONTACT_WIDTH, 0.0])
        shown["windAngle"] = state.angle
        shown["rippleLongest"] = np.clip(2.0 * state.resolved, *RIPPLE_LENGTHS)
        self.set(**shown)
        self.origin = np.zeros(2)  # x, z of the nodes' [m]
        self.beyond = np.zeros(0, bool)  # triangles of the far sea that are not hidden in the basin
        self.ships: list[ShadedShip] = []
        self.mirror: Mirror | None = None
        self.raises = "sea_answers" not in grid  # the water of the run knows of no wave at a bow

    def mesh_of(self, nodes: np.ndarray, corners: np.ndarray) -> Any:
        """Level PyVista mesh of nodes x, z (n, 2) [m] and triangles `corners` (m, 3). NODE_TRAITS, which shaders read
        at the nodes (normal, whiteness and so on), are all 0."""
        points = np.insert(nodes, 1, 0.0, axis=1)
        return self.stage.mesh(points, corners, **dict.fromkeys(NODE_TRAITS, np.zeros(points.shape)))

    def set(self, **values: Any) -> None:
        """Set uniforms of the water's shaders, both in the basin and on the far sea."""
        for part in (self.near, self.far):
            part.set(**values)

    def set_nodes(
        self, part: water_glsl.Shaded, points: np.ndarray, normals: np.ndarray, traits: np.ndarray, grain: np.ndarray
    ) -> None:
        """Set the nodes of a `part` of the sea (basin or far sea): points (n, 3) [m], normals, `traits` (n, 3)
        (whiteness, height, slope variance), and x, z (n, 2) [m] where the fine pattern of foam is read (`grain`)."""
        part.mesh.points = points.astype(np.float32)
        values = normals, traits, np.insert(foam.grain_places(grain, self.state.angle), 1, 0.0, axis=1)
        for name, value in zip(NODE_TRAITS, values, strict=True):
            part.mesh.point_data[name] = value.astype(np.float32)

    def add_ships(self, models: dict[str, ShipModel]) -> dict[str, ShadedShip]:
        """Add the ships, lit by this sky, then the water that mirrors them, and the sky to the picture; returns the
        ships. Nearer objects come first, so that hidden pixels are not shaded."""
        ships = {key: ShadedShip(self.stage, model, self.sky, self.above, True) for key, model in models.items()}
        self.ships = [*ships.values()]
        for part in (self.near, self.far, self.dome.shaded):
            self.stage.plotter.add_actor(part.actor, reset_camera=False, render=False)
        if ships:
            self.mirror = Mirror(self.stage, [ship.shaded for ship in self.ships], self.mirrored)
        return ships

    def show(self, frame: Frame) -> None:
        """Change water, sky, shadows and mirror image to a frame."""
        self.now = self.state.at(frame.time)
        self.set(rippleVariance=slope_variance(self.now.wind) if self.order.ripples else 0.0)
        self.show_basin(frame)
        self.show_beyond(frame)
        order, eye = self.order, self.stage.camera.eye
        pixel = self.pixel
        fine = pixel / SMOOTHED_PIXELS if order.quality == "final" else pixel
        self.set(eyeW=eye, time=frame.time, pixel=fine, mirrorPixel=MIRROR_SHRINKING * pixel)
        self.dome.move_to(eye)
        levels = [self.update_hull(k, key, *frame.ships[key]) for k, key in enumerate(self.hulls)]
        if levels:
            water_glsl.fill_image(self.gaps.GetInput(), self.gap.reshape(-1, HULL_PIXELS[1], 3))
        self.update_shadows()
        if self.mirror is not None and levels:
            self.set(useMirror=1.0, mirrorView=self.mirror.show(float(np.mean(levels))))

    def update_shadows(self) -> None:
        """Update the maps of the shadows that the ships cast on the water."""
        for k, ship in enumerate(self.ships):
            self.shadow[k] = ship.depth
            low, high = ship_glsl.shadow_bounds(ship.depth[..., 0], ship.shade.length)
            known = {"At": ship.position, "Size": ship.shade.length, "Low": low, "High": high}
            self.set(**{f"shade{name}{k}": value for name, value in known.items()} | ship.across)
        if self.ships:
            water_glsl.fill_image(self.shadows.GetInput(), self.shadow.reshape(-1, ship_glsl.SHADOW_PIXELS, 3))

    @property
    def pixel(self) -> float:
        """Angle of view that one pixel covers [rad]."""
        angle = np.radians(self.stage.plotter.camera.view_angle)
        return 2.0 * float(np.tan(angle / 2.0)) / self.stage.size[1]

    def crest_shares(self, height: np.ndarray) -> np.ndarray:
        """Water heights [m] above the mean level, over half the significant height: 0 at rest, 1 on a crest."""
        return (height - self.now.level) / max(0.5 * self.now.height, 1e-3)

    def show_basin(self, frame: Frame) -> None:
        """Update heights (with ship waves) and foam of the water inside the basin."""
        surface, answer = self.surface, frame.answer
        if answer is not None:
            x, z = (points + start for points, start in zip(self.points, frame.origin, strict=True))
            for key, vessel in self.vessels.items():
                answer = waterline.limited_answer(answer, vessel, self.hulls[key].beam, x, z, frame.time)
        height, convergence = surface.at(frame, self.now, answer)
        for key, vessel in self.vessels.items() if self.raises and self.state.exact is not None else ():
            behind = waterline.kelvin_height(vessel, self.hulls[key].beam, frame.time, surface.nodes + frame.origin)
            height = height + surface.share * behind.reshape(height.shape)
        self.frame, self.height = frame, height
        if self.raises:
            ships = [self.wetted_hull(key, *frame.ships[key]) for key in self.vessels]
            raised = sum(ship.bow_wave_height(surface.nodes + frame.origin) for ship in ships if ship.wet)
            self.height = height = height + surface.share * np.reshape(raised + np.zeros(height.size), height.shape)
        if not np.array_equal(frame.origin, self.origin):
            self.origin = frame.origin
            surface.grain = surface.grain_at(frame.origin)
        asked = self.order.foam_cover
        cover = frame.cover if asked is None else asked
        called = foam.wanted_cover(convergence, self.now.raising) if cover is None else cover
        fresh = surface.foam(convergence, called)
        nodes = surface.nodes + self.origin
        white, grain = fresh, nodes
        if frame.carried is not None:
            moved = [surface.on_nodes(frame.carried[..., k]).ravel() for k in range(2)]
            grain = nodes - np.stack(moved, axis=-1)
        if frame.foam is not None:
            white = surface.blended_foam(fresh, frame.foam, grain)
            if asked is not None:
                left = 0.0 if frame.left is None else surface.laced_foam(frame.left, grain)
                white = np.maximum(foam.white_shares(white + 1e-3 * fresh, asked), left)
        white = np.where(white < foam.MIN_SHARE, 0.0, np.minimum(white, 1.0))
        traits = np.stack([white, self.crest_shares(height), np.zeros_like(white)], axis=-1)
        drawn = sheet(surface.x, surface.z, height)
        self.set_nodes(self.near, drawn.vertices + frame.place, drawn.normals, traits.reshape(-1, 3), grain)

    def wetted_hull(self, key: str, position: np.ndarray, turn: np.ndarray) -> waterline.WettedHull:
        """Hull of the ship `key` at a position (3,) [m], in the water drawn now; `turn`: (3, 3) from body to world."""
        speed = self.vessels[key].speed(self.frame.time) if key in self.vessels else 0.0
        return self.hulls[key].wetted_hull(position, turn, speed, self.heights_at)

    def show_beyond(self, frame: Frame) -> None:
        """Update heights and foam of the water outside the basin, on a fan of nodes around the eye."""
        surface, camera = self.surface, self.stage.camera
        fan = surface.fan
        aspect = self.stage.size[0] / self.stage.size[1]
        half, lowest = camera.spread(aspect)
        heading = float(np.arctan2(camera.forward[2], camera.forward[0]))
        amplitude, eye = self.now.waves.amplitude, camera.eye
        row = self.pixel / self.stage.samples
        new = fan.turn_to(float(eye[1]) - self.now.level, heading, half, lowest, self.pixel, row, amplitude)
        found = surface.far_samples(frame, eye, self.now)
        rings = fan.visible_rings(found[..., 0], float(eye[1]))
        height, slope_x, slope_z, _ = np.moveaxis(np.take_along_axis(found, rings[..., None], 0), -1, 0)
        nodes = np.take_along_axis(fan.nodes.reshape(*fan.shape, 2), rings[..., None], 0).reshape(-1, 2) + eye[[0, 2]]
        if new:
            self.far.mesh.DeepCopy(self.mesh_of(nodes, fan.triangles))
            self.beyond = np.ones(len(fan.triangles), bool)
        white = np.zeros(rings.shape)
        if self.order.foam:
            white = surface.far_foam(found, rings, nodes, eye, amplitude)
        traits = np.stack([white, self.crest_shares(height), fan.lost_variance(amplitude)[rings]], axis=-1)
        normals = np.stack([-slope_x, np.ones_like(height), -slope_z], axis=-1).reshape(-1, 3)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        self.set_nodes(self.far, np.insert(nodes, 1, height.ravel(), axis=1), normals, traits.reshape(-1, 3), nodes)
        lap = 0.5 * np.array([surface.x[1] - surface.x[0], surface.z[1] - surface.z[0]])  # that no gap is seen
        low, high = surface.lower + self.origin + lap, surface.upper + self.origin - lap
        x, z = nodes.T
        outside = (x <= low[0]) | (x >= high[0]) | (z <= low[1]) | (z >= high[1])
        beyond = np.logical_or.reduce([outside[corner] for corner in fan.triangles.T])
        if not np.array_equal(beyond, self.beyond):
            self.far.mesh.regular_faces = fan.triangles[beyond]
            self.beyond = beyond
        self.far.set(innerLow=np.insert(low, 1, 0.0), innerHigh=np.insert(high, 1, 0.0))

    def heights_at(self, positions: np.ndarray) -> np.ndarray:
        """Drawn heights (n,) [m] of the water at positions x, z (n, 2) [m]."""
        from scipy.interpolate import RegularGridInterpolator

        surface = self.surface
        at = RegularGridInterpolator((surface.x, surface.z), self.height, bounds_error=False)(positions - self.origin)
        outside = np.isnan(at)
        if outside.any():
            at[outside] = self.now.level + waves.elevation(self.now.waves, positions[outside], self.frame.time)
        return at

    def update_hull(self, k: int, key: str, position: np.ndarray, turn: np.ndarray) -> float:
        """Update the water around the ship `key`, number k in the shaders: foam at her waterline, the hole for her
        hull, her mirror image; `position`, `turn` as in `wetted_hull`. Returns the mean water height around her [m]."""
        hull, ship = self.hulls[key], self.wetted_hull(key, position, turn)
        self.set(**{f"useHull{k}": float(ship.wet)})
        if ship.wet:
            low, high = ship.foam_area()
            rows, columns = HULL_PIXELS
            x, z = middles_of(low[0], high[0], columns), middles_of(low[1], high[1], rows)
            places = np.stack(np.meshgrid(x, z), axis=-1).reshape(-1, 2)
            gap = waterline.distance_to_line(places, ship.line)
            self.gap[k, ..., 0] = gap.astype(np.float32).reshape(rows, columns)
            self.gap[k, ..., 1] = ship.breaking(places, gap).astype(np.float32).reshape(rows, columns)
            self.set(**{f"hullBox{k}": np.append(low, 0.0), f"hullSize{k}": np.append(high - low, 1.0)})
        mirrored = {"At": position, "Size": 0.5 * hull.beam, "Reach": hull.length}
        self.set(**{f"mirror{name}{k}": value for name, value in mirrored.items()})
        return float(self.heights_at(ship.line.reshape(-1, 2) if ship.wet else position[None, [0, 2]]).mean())
