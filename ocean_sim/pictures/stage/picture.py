"""Pictures of a run, one after another: sky, water, ships, text."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ocean_sim.parts import key_of
from ocean_sim.pictures.frame_files import FREEBOARD_SHARE, Frame, FrameLog, kept_ground, ship_keys
from ocean_sim.pictures.ships.ship import ShadedShip
from ocean_sim.pictures.ships.ship_model import kept_model
from ocean_sim.pictures.stage import overlays, sky
from ocean_sim.pictures.stage.camera import FRAME_MARGIN, Camera, Operator, Vessel
from ocean_sim.pictures.stage.obstacles import NO_BOXES, Obstacles, sand_mesh
from ocean_sim.pictures.stage.particles import Particles
from ocean_sim.pictures.stage.plotter import Content, Stage
from ocean_sim.pictures.stage.render_order import DEFAULT_SIZE, Order, RenderFailed
from ocean_sim.pictures.stage.streaks import Streaks
from ocean_sim.pictures.stage.wind_marks import WindMarks, arrow_legend
from ocean_sim.pictures.water import far_sea, sea_state, tank_walls, water_glsl
from ocean_sim.pictures.water.sea import Sea
from ocean_sim.pictures.water.water_shading import TANK_EXPOSURE, display_colours
from ocean_sim.pictures.water.water_surface import SURFACE_NODES, Water

# Along each side of a pixel; where there is one, edges are smoothed
PIXEL_SAMPLES = {"draft": 1, "final": 2}
SHEET_PICTURES, SHEET_SHRINKING = 6, 2  # pictures in a sheet of moments, and pixels along a side of one of its
SHEET_COLUMNS, SHEET_GAP = 3, 6  # of a sheet, and [pixels] between its pictures
WORDS_HEIGHT = 160  # [pixels] around a long slice: bars and the time
MAP_CAMERAS = "top", "side"  # cameras that see the whole way of a ship that leaves the basin
WIND_ROOM, WIND_FRAMES = 0.25, 60  # of the basin's sides: seen beyond them at most; frames whose wind is looked at


def is_foreseeable(grid: Any, order: Order) -> bool:
    """True if every picture can be drawn while the run continues. Two kinds cannot: particles, coloured by the speeds
    of the whole run, and cameras that show the way of ship or wind, or the film's time. `grid`: arrays in grid.npz."""
    whole_way = order.camera in MAP_CAMERAS and ("sea_answers" in grid or order.wind)
    return not (order.particles or not bool(grid["has_surface"]) or order.camera == "orbit" or whole_way)


def swept_box(lower: np.ndarray, upper: np.ndarray, ways: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Corners [m] of the box that a basin from `lower` to `upper` sweeps as it moves with the mean position of its
    ships; `ways`: their tracks (n, 3) [m]."""
    middle = np.mean(ways, axis=0) * [1.0, 0.0, 1.0]
    return lower + middle.min(axis=0), upper + middle.max(axis=0)


def windy_box(lower: np.ndarray, upper: np.ndarray, frames: list[Frame]) -> np.ndarray:
    """Corners (2, 3) [m] of a box around a basin and the wind volumes of frames, at most WIND_ROOM beyond the basin."""
    ends, room = [end for frame in frames for end in frame.wind_lines.reshape(-1, 3)], WIND_ROOM * (upper - lower)
    return np.clip([np.min([lower, *ends], axis=0), np.max([upper, *ends], axis=0)], lower - room, upper + room)


def fitting_size(lower: np.ndarray, upper: np.ndarray, flat: bool) -> tuple[int, int]:
    """Width and height [pixels] of pictures of a box [m]; as high as it and words need if it is `flat` and long."""
    (width, most), (long, high, _) = DEFAULT_SIZE, upper - lower
    seen = width / FRAME_MARGIN * high / long  # [pixels]
    return width, min(most, 2 * round(0.5 * (seen + WORDS_HEIGHT))) if flat else most


class Picture:
    """Everything in the pictures of a run, built once; for each frame only points and colours change."""

    def __init__(self, grid: Any, order: Order, first: Frame, fastest: float, log: FrameLog) -> None:
        """`grid`: arrays in the run's grid.npz (basin, hulls ...); `order`: options of the pictures; `first`: first
        frame; `fastest`: speed [m/s] of the brightest colour; `log`: times of the frames and tracks of the ships."""
        self.order, self.grid = order, grid
        self.lower, self.upper = grid["lower"].copy(), grid["upper"].copy()
        self.sides = self.lower[[0, 2]].copy(), self.upper[[0, 2]].copy()
        self.upper[1] = max(FREEBOARD_SHARE * float(grid["depth"]), float(first.elevation.max()))
        if (ground := kept_ground(grid)) is not None:
            self.upper[1] = max(self.upper[1], float(ground.y.max()))
        plates = grid.get("plates", NO_BOXES)  # of wavemakers, behind which the walls stand
        walls = np.min([self.lower, *plates[:, 0]], axis=0), np.max([self.upper, *plates[:, 1]], axis=0)
        flat = self.flat = bool(self.lower[2] == self.upper[2])
        away = "sea_answers" in grid  # ships are free to leave the basin
        if away and order.camera in MAP_CAMERAS and log.tracks:
            ways = [track.position for track in log.tracks.values()]
            self.lower, self.upper = swept_box(self.lower, self.upper, ways)
        models = {key: kept_model(grid, key) for key in ship_keys(grid, "_vertices")}
        vessels = {
            key: Vessel(model.length, model.helm, log.tracks[key], float(model.mesh.corners[..., 1].max()))
            for key, model in models.items()
            if key in log.tracks
        }
        vessel = next(iter(vessels.values()), None) if order.ship is None else vessels.get(key_of(order.ship))
        scene = sea_state.run_scene(Path(order.folder))
        open_sea = sea_state.is_open_sea(scene, first, float(grid["depth"])) and bool(grid["has_surface"])
        in_tank = flat or first.folds or ground is not None or not open_sea
        at_sea = order.far_sea and not (in_tank or order.particles)
        aim = {"eye": order.eye, "target": order.target}
        given = {"vessel": vessel, "away": away, "at_sea": at_sea, "whole": in_tank}
        camera, size = "side" if flat else order.camera, order.size or fitting_size(self.lower, self.upper, flat)
        lower, upper = self.lower, self.upper
        if order.wind and camera == "top":
            shown = [] if order.film else [log.nearest(time) for time in order.stills]
            frames = shown or log.files[:: max(1, len(log.files) // WIND_FRAMES)]
            lower, upper = windy_box(lower, upper, [Frame(path) for path in frames])
        self.operator = Operator(camera, lower, upper, size[0] / size[1], log.span, **aim, **given)
        stage = self.stage = Stage(size, self.operator.at(first.time), PIXEL_SAMPLES[order.quality])
        self.plotter = stage.plotter
        middle, size = 0.5 * (self.lower + self.upper), self.upper - self.lower
        self.reach = float(max(np.linalg.norm(stage.camera.eye - middle), np.linalg.norm(size)))  # [m]
        from_above = order.camera == "top"  # a map
        self.at_sea = at_sea and not from_above and stage.camera.parallel_height is None
        if not self.at_sea:
            self.backdrop()
        if order.particles or not bool(grid["has_surface"]):
            if first.position is None:
                raise RenderFailed("these frames hold no particles to draw; run with frames.particles: true")
            self.content: Content = Particles(stage, first, float(grid["spacing"]), fastest)
        elif self.at_sea:
            self.content = Sea(stage, order, vessels, grid, sea_state.SeaState(scene, grid, log))
        elif first.folds:
            from ocean_sim.pictures.water import tank

            tank_walls.add_panels(stage, *walls, float(grid["depth"]))
            self.content = tank.Shell(stage, grid, self.upper, order.foam)
        else:
            self.content = Water(stage, grid, SURFACE_NODES[order.quality])
        if ground is not None:
            stage.add(*sand_mesh(ground, float(grid["spacing"])), culling="back")
        if in_tank:
            self.zones = grid.get("zones", NO_BOXES) - [0.0, 0.0, flat * float(grid["spacing"])]  # behind flat water
            tank_walls.add_edges(stage, *walls, self.zones)
        self.obstacles = Obstacles(stage, grid, *walls)
        if isinstance(self.content, Sea):
            self.ships, (over, exposure) = self.content.add_ships(models), self.content.look
        else:
            over, exposure = sky.clear_sky_image(), TANK_EXPOSURE
            above = water_glsl.sky_textures(over) if models else {}
            self.ships = {key: ShadedShip(stage, model, over, above, False) for key, model in models.items()}
        self.streaks = Streaks(stage, over, exposure) if order.foam and not order.particles else None
        self.outline = overlays.Outline(stage, grid["lower"], grid["upper"]) if order.outline else None
        self.wind = WindMarks(stage, grid["lower"], grid["upper"]) if order.wind else None
        self.aim()

    def aim(self) -> None:
        """Set VTK's camera to the present `Camera` of the stage."""
        camera, plotter = self.stage.camera, self.plotter
        plotter.camera.position, plotter.camera.focal_point = tuple(camera.eye), tuple(camera.eye + camera.forward)
        plotter.camera.up, plotter.camera.view_angle = tuple(camera.up), camera.angle
        reach = self.reach
        near, far = (0.005 * reach, 4.0 * far_sea.SEA_RADIUS) if self.at_sea else (0.01 * reach, 12.0 * reach)
        plotter.camera.clipping_range = (camera.near or near, far)
        if camera.parallel_height is not None:
            plotter.enable_parallel_projection()
            plotter.camera.parallel_scale = camera.parallel_height

    def backdrop(self) -> None:
        """Add the background: a dome of sky; for a side view, a gradient; for a map, the ground's colour."""
        camera, pyvista = self.stage.camera, self.stage.pyvista
        if camera.from_above and camera.parallel_height is not None:
            self.plotter.set_background(display_colours(sky.sky_and_ground(camera.forward[None]))[0] / 255.0)
            return
        if camera.parallel_height is not None:
            ahead = np.array([[0.0, 0.02, -1.0], [0.0, 0.2, -0.98]])
            low, high = display_colours(sky.sky_and_ground(ahead)) / 255.0
            self.plotter.set_background(low, top=high)
            return
        radius = 6.0 * self.reach
        dome = pyvista.Sphere(radius=1.0, theta_resolution=90, phi_resolution=361, direction=(0.0, 1.0, 0.0))
        directions = sky.unit_vector(np.asarray(dome.points, dtype=float))
        dome.points = (camera.eye + radius * directions).astype(np.float32)
        dome["colour"] = display_colours(sky.sky_and_ground(directions))
        self.dome = self.plotter.add_mesh(dome, scalars="colour", rgb=True, lighting=False, smooth_shading=False)
        self.first_eye = camera.eye
        if camera.forward[1] > -0.9:
            tank_walls.add_ground(self.stage, self.lower, self.upper)

    def draw(self, frame: Frame) -> np.ndarray:
        """Draw a frame; returns the picture (height, width, 3), 8-bit RGB."""
        self.move(self.operator.at(frame.time))
        for key, pose in frame.ships.items():
            self.ships[key].show(*pose, self.stage.camera.eye)
        self.obstacles.show(frame)
        if self.streaks is not None:
            self.streaks.show(frame.drops)
        self.content.show(frame)
        if self.outline is not None:
            self.outline.show(frame.origin, self.heights_at(frame, self.outline.around + frame.origin))
        if self.wind is not None:
            self.wind.show(frame, self.heights_at(frame, frame.wind_tails[:, [0, 2]].astype(float)))
        self.stage.render()
        image = sample_means(self.plotter.screenshot(None, return_img=True), self.stage.samples)
        if not (self.order.caption or self.order.scale_bar):
            return image
        over = overlays.Overlay(image)
        if self.order.caption:
            over.write(f"t = {frame.time:.2f} s", 17, over.low - 14)
        if self.order.scale_bar or self.flat:
            target = next(iter(frame.ships.values()), (0.5 * (self.lower + self.upper) * [1.0, 0.0, 1.0],))[0]
            each = overlays.metre_pixels(self.stage, target)
            over.scale_bar(each)
            if self.flat:
                over.name_zones(self.zones, self.stage.camera.eye, each)
            if self.wind is not None:
                length, text = arrow_legend(frame, self.wind.length)
                over.arrow_bar(round(length * each), text)
            if isinstance(self.content, Water) and self.stage.camera.from_above:
                over.height_bar(self.content.most)
        return np.asarray(over.image)

    def heights_at(self, frame: Frame, positions: np.ndarray) -> np.ndarray:
        """Drawn water heights (n,) [m] at positions x, z (n, 2) [m]; in a tank those of the nearest grid points."""
        if isinstance(self.content, Sea):
            return self.content.heights_at(positions)
        share = (positions - self.sides[0]) / np.maximum(self.sides[1] - self.sides[0], 1e-9)
        index = [np.clip((share[:, k] * n).astype(int), 0, n - 1) for k, n in enumerate(frame.elevation.shape)]
        return frame.elevation[index[0], index[1]]

    def move(self, camera: Camera) -> None:
        """Set the view to another camera, and centre the sky on its eye."""
        if camera is self.stage.camera:
            return
        self.stage.camera = camera
        if camera.parallel_height is None and not self.at_sea:
            self.dome.position = tuple(camera.eye - self.first_eye)
        self.aim()

    def close(self) -> None:
        self.stage.close()


def sample_means(image: np.ndarray, samples: int) -> np.ndarray:
    """Picture (height, width, 3), 8-bit RGB, made smaller: each pixel is the mean of samples x samples pixels."""
    from PIL import Image

    return np.array(Image.fromarray(np.ascontiguousarray(image)).reduce(samples))


class Moments:
    """Contact sheet of a film in progress: evenly spaced pictures of it; keeps at most twice the number shown."""

    def __init__(self) -> None:
        self.kept: list[np.ndarray] = []
        self.seen, self.every = 0, 1  # pictures of the film, and how many of them for each that is kept

    def see(self, image: np.ndarray) -> None:
        """Take in the next picture (height, width, 3); every n-th is stored, made smaller; n grows with the film."""
        if self.seen % self.every == 0:
            if len(self.kept) == 2 * SHEET_PICTURES:
                self.kept, self.every = self.kept[::2], 2 * self.every
            if self.seen % self.every == 0:
                self.kept.append(sample_means(image, SHEET_SHRINKING))
        self.seen += 1

    def sheet(self) -> np.ndarray:
        """Contact sheet (height, width, 3) of pictures evenly spaced over the film so far; a short one repeats some."""
        chosen = [self.kept[round(k)] for k in np.linspace(0, len(self.kept) - 1, SHEET_PICTURES)]
        rows = [picture_row(chosen[k : k + SHEET_COLUMNS], SHEET_GAP) for k in range(0, SHEET_PICTURES, SHEET_COLUMNS)]
        return picture_row([row.swapaxes(0, 1) for row in rows], SHEET_GAP).swapaxes(0, 1)


def picture_row(pictures: Sequence[np.ndarray], gap: int) -> np.ndarray:
    """Picture (height, width, 3) of pictures of equal height in a row, with `gap` white pixels between them."""
    between = np.full((pictures[0].shape[0], gap, 3), 255, np.uint8)
    return np.concatenate([part for picture in pictures for part in (picture, between)][:-1], axis=1)
