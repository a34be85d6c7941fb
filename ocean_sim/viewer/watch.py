"""Live frames of a simulation for open pages, made by an observer that only reads the simulation."""

from collections import defaultdict, deque
from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from ocean_sim.basin.points import grid_points, middles
from ocean_sim.observers.shared.csv_rows import TakesCommands
from ocean_sim.parts import PeriodicConfig
from ocean_sim.pictures.frame_files import grid_arrays, middle_cell
from ocean_sim.pictures.live.scene_lines import box_top, scene_lines, surface_heights
from ocean_sim.platform import Commands
from ocean_sim.simulation import Observer, Simulation
from ocean_sim.viewer.protocol import FULL_SCALE, box_scale, packet
from ocean_sim.viewer.still import StaticScene

if TYPE_CHECKING:
    from ocean_sim.basin import Basin
    from ocean_sim.fluid import Particles
    from ocean_sim.viewer.server import Server

# [1/s] of wall time; while no page is open, for the past of one that opens late
MAX_FRAME_RATE, UNSEEN_FRAME_RATE = 20.0, 4.0
MAX_CELLS = 128  # heights along a side
MAX_PARTICLES = 60_000  # that are shown: of more, every second, third, ...
RARE_FRAME_INTERVAL = 4  # frames between two that draw the wind and measure the largest speed
MIN_TOP_SPEED = 0.5  # [m/s] least speed of the brightest colour
MAX_PLOTTED_SHIPS = 4
# [s] between kept poses of the ships, and their number: 40 s of wake at a moment of the last minute
TRAIL_INTERVAL, TRAIL_LENGTH = 0.25, 400
SPLASH_REACH = 6.0  # four standard deviations of a random sea
STAGE_NAMES = ("wind", "fluid", "surface", "ship", "observers")


class Watch(Observer, TakesCommands):
    """Observer that sends the newest state to a server's open pages, at most MAX_FRAME_RATE times a second."""

    def __init__(self, simulation: Simulation, server: "Server") -> None:
        """Send the static part of the simulation to the server, and prepare frames."""
        self.simulation, self.server = simulation, server
        self.last = -1.0  # wall time of the last frame [s]
        self.seq, self.fastest = 0, MIN_TOP_SPEED
        self.setting = setting_of(simulation)
        lengths = [float(np.ptp(model.hull.vertices, axis=0).max()) for model in self.setting.models.values()]
        self.top = box_top(simulation, max(lengths, default=0.0))  # height of the air that lines go up to [m]
        self.points = grid_points(self.setting.x, self.setting.z)
        low, high = self.setting.box
        self.box = {"low": low.tolist(), "high": high.tolist()}
        self.middle, self.scale = box_scale(low, high)
        if simulation.fluid.particles is not None:
            self.points = self.points.astype(simulation.fluid.particles.position.precision)
        self.gauges = np.array([*self.setting.gauges.values()], dtype=float).reshape(-1, 2)
        self.follows = simulation.fluid.in_closed_form is not None and not self.setting.flat
        scene = simulation.scene
        motion = scene.observers.get("motion")
        self.commands: np.ndarray | None = None  # pose (6) and leg lengths (6) of the platform, if there is one
        if scene.platform is not None and simulation.ships and motion is not None:
            assert isinstance(motion, PeriodicConfig)
            neutral = scene.platform.build(motion.every).neutral_legs
            self.commands = np.concatenate([np.zeros(6), neutral]).astype(np.float32)
        self.trail: deque[np.ndarray] = deque(maxlen=TRAIL_LENGTH)  # time [s] and poses, for a page that opens late
        self.stage_times: dict[str, float] = defaultdict(float)  # since the last frame [s]
        self.stage_costs = dict.fromkeys(STAGE_NAMES, 0.0)  # [ms] a step
        self.mark = (perf_counter(), simulation.time, simulation.steps)
        self.pace = 0.0
        self.measure_stages(simulation)
        names = "name", "label", "unit", "group"
        self.setting.scalars = [dict(zip(names, row[:-1])) for row in self.plotted_rows(np.zeros(1))]
        server.begin(self.setting.packet())

    def measure_stages(self, simulation: Simulation) -> None:
        """Measure the real time of each stage of a step from now on, without disturbing another such measurement."""
        inner, taken = simulation.stage, self.stage_times

        @contextmanager
        def stage(name: str) -> Iterator[None]:
            with inner(name):
                entered = perf_counter()
                yield
                taken[name] += perf_counter() - entered

        simulation.stage = stage  # type: ignore[method-assign, assignment]

    def take_commands(self, rows: Commands) -> None:
        self.commands = np.concatenate([rows.pose[-1], rows.legs[-1]]).astype(np.float32)

    def observe(self, simulation: Simulation) -> None:
        now = perf_counter()
        if self.setting.models and not (self.trail and simulation.time < self.trail[-1][0] + TRAIL_INTERVAL):
            self.trail.append(np.array([simulation.time, *self.poses().ravel()], np.float32))
        rate = MAX_FRAME_RATE if self.server.watchers else UNSEEN_FRAME_RATE
        if self.server.fresh or now - self.last >= 1.0 / rate:
            self.show(now)

    def show(self, now: float) -> None:
        """Send a frame of the present state to the server; `now`: real time [s]."""
        self.last = now
        wall, time, steps = self.mark
        done = self.simulation.steps - steps
        if done:
            self.pace = (self.simulation.time - time) / max(now - wall, 1e-9)
            self.stage_costs = {name: 1e3 * self.stage_times[name] / done for name in STAGE_NAMES}
        self.stage_times.clear()
        self.mark = (now, self.simulation.time, self.simulation.steps)
        self.server.show(self.frame(), self.simulation.time)
        self.seq += 1

    def frame(self) -> bytes:
        """Packet of kind `frame` with the present state of the simulation."""
        simulation = self.simulation
        arrays: dict[str, np.ndarray] = {}
        boxes: dict[str, Any] = {}
        origin, heights = self.origin(), np.zeros(1)
        if self.setting.surface:
            points = self.points + origin if self.follows else self.points
            heights = surface_heights(simulation, points)
            arrays["height"] = heights.astype(np.float16)
            white = simulation.fluid.foam(points)
            if white is not None:
                arrays["foam"] = np.rint(255.0 * np.clip(white, 0.0, 1.0)).astype(np.uint8)
        if self.setting.models:
            arrays["poses"] = self.poses()
            if self.is_rare_frame and self.trail:
                arrays["trail"] = np.array(self.trail)
        if simulation.fluid.particles is not None:
            arrays |= self.particle_arrays(simulation.fluid.particles)
            boxes["particles"] = self.box
        if self.commands is not None:
            arrays["platform"] = self.commands
        if self.is_rare_frame or self.setting.flat:
            ends, hues = scene_lines(simulation, self.top)
            arrays["lines"] = ends.astype(np.float32)
            arrays["hues"] = np.rint(255.0 * hues).astype(np.uint8)
        numbers = np.array([row[-1] for row in self.plotted_rows(heights)], np.float32)
        arrays["scalars"] = np.nan_to_num(numbers, nan=np.nan, posinf=0.0, neginf=0.0)
        place, fastest = [round(float(v), 4) for v in origin], round(self.fastest, 4)
        header = {"time": round(simulation.time, 6), "seq": self.seq, "origin": place, "fastest": fastest}
        return packet("frame", arrays, boxes, **header)

    def poses(self) -> np.ndarray:
        """Positions [m] and quaternions of the drawn ships (ships, 7)."""
        bodies = [self.simulation.ships[name].body for name in self.setting.models]
        return np.array([[*body.position, *body.orientation] for body in bodies], np.float32)

    @property
    def is_rare_frame(self) -> bool:
        """True if the next frame also holds arrays that are sent only now and then, such as lines of wind and basin."""
        return self.seq % RARE_FRAME_INTERVAL == 0 or self.server.fresh

    def origin(self) -> np.ndarray:
        """Middle x, z (2,) [m] of the shown heights: near the ships, in whole cells, on an unbounded sea; else 0."""
        ships = self.simulation.ships.values()
        if not (self.follows and ships):
            return np.zeros(2)
        return middle_cell(ships, np.array([places[1] - places[0] for places in (self.setting.x, self.setting.z)]))

    def particle_arrays(self, particles: "Particles") -> dict[str, np.ndarray]:
        """Particles to show, by id: `particles` (n, 3), positions in whole numbers of -32767 to 32767 across the box
        that the static part names; `speed` (n,), 0 to 255 at `fastest`."""
        rows = particles.in_box(self.middle, self.scale, FULL_SCALE, particle_stride(particles.n))
        places, speed = rows[:, :3].astype(np.int16), rows[:, 3]
        if self.is_rare_frame and len(speed):
            last = -1 - len(speed) // 500
            self.fastest = max(self.fastest, float(np.partition(speed, last)[last]))
        pace = np.minimum(speed.dtype.type(255.0 / self.fastest) * speed, 255.0).astype(np.uint8)
        return {"particles": places, "speed": pace}

    def plotted_rows(self, heights: np.ndarray) -> list[tuple[str, str, str, str, float]]:
        """Numbers to plot now: rows of name, label, unit, group and value. `heights` (n,) [m]: of the water."""
        simulation, fluid, ground = self.simulation, self.simulation.fluid, self.simulation.basin.ground
        levels = fluid.elevations(self.gauges)
        levels = levels if ground is None else ground.wet_heights(self.gauges, levels)
        rows = [(f"eta_{name}", name, "m", "elevation", level) for name, level in zip(self.setting.gauges, levels)]
        rows.append(("height", "significant wave height", "m", "height", 4.0 * float(without_splashes(heights).std())))
        for name, ship in [*simulation.ships.items()][:MAX_PLOTTED_SHIPS]:
            body, (throttle, rudder) = ship.body, ship.orders
            whose = f" {name}" if len(simulation.ships) > 1 else ""
            pitch, yaw, roll = np.degrees(body.angles)
            rows += [
                (f"heave_{name}", f"heave{whose}", "m", "heave", body.position[1]),
                (f"roll_{name}", f"roll{whose}", "deg", "angles", roll),
                (f"pitch_{name}", f"pitch{whose}", "deg", "angles", pitch),
                (f"yaw_{name}", f"heading{whose}", "deg", "yaw", yaw),
                (f"speed_{name}", f"speed ahead{whose}", "m/s", "speed", float(body.velocity @ body.matrix[:, 2])),
                (f"throttle_{name}", f"throttle{whose}", "%", "throttle", 100.0 * throttle),
                (f"rudder_{name}", f"rudder{whose}", "deg", "rudder", np.degrees(rudder)),
            ]
        if self.commands is not None:
            rows += [(f"leg{k}", f"leg {k}", "m", "legs", leg) for k, leg in enumerate(self.commands[6:], 1)]
        if fluid.particles is not None:
            excess = 100.0 * (fluid.status.max_density / fluid.rest_density - 1.0)
            rows.append(("compression", "largest density error", "%", "compression", excess))
        rows.append(("pace", "simulated over wall time", "x", "pace", self.pace))
        rows.append(("dt", "time step", "ms", "dt", 1e3 * simulation.next_dt))
        return rows + [(f"cost_{name}", name, "ms/step", "cost", self.stage_costs[name]) for name in STAGE_NAMES]


def without_splashes(heights: np.ndarray) -> np.ndarray:
    """Water `heights` (n,) [m] within SPLASH_REACH median distances of the median: no splashes, no hollows of hulls."""
    away = np.abs(heights - np.median(heights))
    return heights[away <= SPLASH_REACH * np.median(away)]


def setting_of(simulation: Simulation) -> StaticScene:
    """Static part of a simulation for its pages: water, basin and ships."""
    scene, basin, fluid = simulation.scene, simulation.basin, simulation.fluid
    grid = grid_arrays(simulation, *height_grid(basin, fluid.spacing))
    surface = not basin.closed and (fluid.particles is None or fluid.sound_speed > 0.0)
    shown = 0 if fluid.particles is None else -(-fluid.particles.n // particle_stride(fluid.particles.n))
    return StaticScene(grid, scene.resolved(), scene.title or "Untitled scene", fluid.plane_waves, surface, shown)


def particle_stride(n: int) -> int:
    """Stride that thins n particles for a page, to at most MAX_PARTICLES."""
    return max(1, -(-n // MAX_PARTICLES))


def height_grid(basin: "Basin", spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates x, z, each (n,) [m], of heights: cell centres, `spacing` or more apart, at most MAX_CELLS a side."""
    sides = ((float(basin.lower[k]), float(basin.upper[k])) for k in (0, 2))
    x, z = (middles(low, high, max(spacing, (high - low) / MAX_CELLS)) for low, high in sides)
    return x, np.zeros(1) if basin.dimension == 2 else z
