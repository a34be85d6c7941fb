"""One scene run twice in ways that must agree: what is compared, within what, and books that every run must close.
A comparison answers in words for each start of the scene, with none where the two agree; None where it does not suit
the scene.

Twins have the same fixed step, at most a half of what is stable, and STEPS steps, so that chaos has no time to part
them. Nearly all of their time is compiling: what is built once is run from several starts, which differ in numbers that
no kernel holds.
"""

import random
from collections.abc import Callable
from copy import deepcopy
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ocean_sim.conventions import Diverged
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.observers.health import Config as HealthConfig
from ocean_sim.observers.health import Health
from ocean_sim.reading.scene import SceneConfig, load, observer_names
from ocean_sim.simulation import Simulation
from ocean_sim.state.snapshot import Restorer, Snapshot
from ocean_sim.verbs.check import preflight

STEPS = 12
QUIET = dict.fromkeys(name for name in observer_names() if name not in ("manifest", "accuracy"))
PLAIN = ("basin", "fluid", "time_step", "runtime", "accuracy", "manifest", "title", "seed", "duration", "resolution")
SWAPPED = {"x_min": "x_max", "x_max": "x_min"}
SLOW = 0.01  # spacings that eddies carry water in a step
MIRROR = np.array([-1.0, 1.0, 1.0])


class Start(NamedTuple):
    """How a scene begins, in numbers that no kernel holds; without any, as it says itself."""

    pace: float = 1.0  # its time step, over that of the scene
    eddies: int | None = None  # the draw of eddies that are added to the velocity of its water


def starts(config: SceneConfig, count: int, draw: str) -> list[Start]:
    """As the scene begins, and otherwise; only that of a scene without particles, which compiles little."""
    drawn = random.Random(draw)
    others = [Start(drawn.uniform(0.5, 1.0), drawn.getrandbits(31)) for _ in range(count - 1)]
    return [Start(), *(others if config.preflight.particles else [])]


class State(NamedTuple):
    """Particles by their number, and ships, after the steps of a run; the reason instead where it stopped."""

    stopped: str
    position: np.ndarray  # (n, 3) [m]
    velocity: np.ndarray  # (n, 3) [m/s]
    ships: np.ndarray  # (k, 13) position, orientation, velocity, angular momentum
    moved: float  # [m] the farthest way of a particle, 0 without
    wrong: tuple[str, ...]  # books that do not close


def quiet(config: SceneConfig, **changes: Any) -> SceneConfig:
    """The scene with few watchers, at a step that is half of what is stable."""
    keys = {key: value for key, value in config.resolved().items() if key not in QUIET}
    keys |= QUIET | {"accuracy": {"every": 1.0}, "render": None}
    keys["runtime"] = keys["runtime"] | {"threads": 1}
    step = 0.5 * min(preflight(config)["stable_time_step"], 0.02)
    return load(keys | {"time_step": {"kind": "fixed", "dt": step}}, {"duration": 10.0, **changes})


def state(simulation: Simulation, start: np.ndarray | None, stopped: str, wrong: list[str]) -> State:
    """What is compared."""
    none = np.zeros((0, 3))
    rows = [
        np.concatenate([s.body.position, s.body.orientation, s.body.velocity, s.body.angular_momentum])
        for s in simulation.ships.values()
    ]
    ships = np.array(rows) if rows else np.zeros((0, 13))
    water = simulation.fluid.of_particles
    if water is None:
        return State(stopped, none, none, ships, 0.0, tuple(wrong))
    x, v = (sorted_by_id(water, field) for field in (water.particles.position, water.particles.velocity))
    moved = 0.0 if start is None or len(start) != len(x) else float(np.abs(x - start).max())
    return State(stopped, x, v, ships, moved, tuple(wrong))


def sorted_by_id(water: Any, vectors: Any) -> np.ndarray:
    count = water.particles.count.now
    return vectors.to_numpy()[:count][np.argsort(water.particles.id.to_numpy()[:count])].astype(np.float64)


class Books:
    """What `health` says of the water of a simulation from now on, after a look at every particle."""

    def __init__(self, simulation: Simulation) -> None:
        self.health = Health(HealthConfig(), None, simulation)
        self.health.observe(simulation)

    def check(self) -> list[str]:
        """Which do not close; raises Diverged where a run would be stopped. `mueller` heats water, and so does water
        less deep than a support radius; both are told."""
        if self.health.n > 0 and (sentence := next(self.health.violations(), "")):
            raise Diverged(sentence)
        scene = self.health.simulation.scene
        heats = scene.fluid.kind == "mueller" or scene.basin.depth <= (scene.preflight.support or 0.0)
        return [what for what in self.health.reported if not (heats and what == "energy that no work has given")]


def eddies(config: SceneConfig, x: np.ndarray, draw: int) -> np.ndarray:
    """(n, 3) velocity [m/s] at places (n, 3) [m] that compresses nothing and that periodic sides go on with: each
    component varies along another axis."""
    numbers = np.random.default_rng(draw)
    basin, speed = config.basin, SLOW * spacing_of(config) / config.time_step.dt
    along = np.array([x[:, 1] / basin.depth, x[:, 0] / basin.length, x[:, 0] / basin.length]).T
    wave = np.sin(2.0 * np.pi * (numbers.integers(1, 4, 3) * along + numbers.random(3)))
    return speed * numbers.uniform(-1.0, 1.0, 3) * wave * [1.0, 1.0, config.basin.width is not None]


class Built:
    """A scene that is built once and run from any of its starts."""

    def __init__(self, config: SceneConfig) -> None:
        self.config, self.simulation = config, Simulation(config)
        self.first = Snapshot(self.simulation, Path())
        self.fresh = True

    def put(self, held: Snapshot, start: Start) -> None:
        """Into this state, with the time step of the start."""
        Restorer(self.simulation, held.tree, {name: values.copy() for name, values in held.arrays.items()}, Path())
        self.paced(start)

    def paced(self, start: Start) -> None:
        self.simulation.time_step.adjust(dt=start.pace * self.config.time_step.dt)
        self.simulation.next_dt = self.simulation.time_step.next(self.simulation.limits())
        self.fresh = False

    def begin(self, start: Start, side: np.ndarray | float = 1.0) -> None:
        """At a start; `side` is MIRROR for the mirror image of its eddies."""
        if self.fresh:
            self.paced(start)
        else:
            self.put(self.first, start)
        if start.eddies is not None:
            fields = self.simulation.fluid.of_particles.particles
            x, v = fields.position.to_numpy(), fields.velocity.to_numpy()
            fields.velocity.from_numpy((v + side * eddies(self.config, x * side, start.eddies)).astype(v.dtype))
            self.simulation.fluid.begin()

    def on(self, steps: int = STEPS) -> State:
        """The state so many steps further on; looked at half way, too, where a checkpoint would be."""
        simulation = self.simulation
        water = simulation.fluid.of_particles
        start = None if water is None else sorted_by_id(water, water.particles.position)
        try:
            books = Books(simulation)
            for k in range(1, steps + 1):
                simulation.step()
                if k == STEPS // 2:
                    books.check()
            return state(simulation, start, "", books.check())
        except Diverged as stopped:
            return state(simulation, start, str(stopped), [])

    def half_way(self) -> Snapshot | State:
        """What a checkpoint half way holds; the last state where it does not come so far."""
        try:
            for _ in range(STEPS // 2):
                self.simulation.step()
            return Snapshot(self.simulation, Path())
        except Diverged as stopped:
            return state(self.simulation, None, str(stopped), [])


class Twins:
    """A scene with its starts, and what is built and known of it; close it when all is compared."""

    def __init__(self, config: SceneConfig, starts: list[Start]) -> None:
        self.config, self.starts = config, starts
        self.open: Built | None = None

    def built(self, config: SceneConfig) -> Built:
        """One of the ways to build the scene; only the last of them is kept, because the next may restart Taichi."""
        if self.open is None or self.open.config is not config:
            self.close()
            self.open = Built(config)
        return self.open

    def close(self) -> None:
        if self.open is not None:
            self.open.simulation.close()
            self.open = None

    def ran(self, config: SceneConfig, side: np.ndarray | float = 1.0) -> list[State]:
        """The state at the end from each start."""
        built, found = self.built(config), []
        for start in self.starts:
            built.begin(start, side)
            found.append(built.on())
        return found

    @cached_property
    def plain(self) -> SceneConfig:
        """The scene in single precision, on one thread."""
        return quiet(self.config, **{"runtime.precision": "f32"})

    @cached_property
    def ends(self) -> list[State]:
        """What one of the twins comes to, from each start."""
        return self.ran(self.plain)


def parted(a: State, b: State) -> float:
    """How far the same particles, or ships, are from each other [m]; infinite where there are not as many."""
    if a.position.shape != b.position.shape or a.ships.shape != b.ships.shape:
        return float("inf")
    ways = [np.abs(a.position - b.position), np.abs(a.ships[:, :3] - b.ships[:, :3])]
    return max(float(way.max(initial=0.0)) for way in ways)


def spacing_of(config: SceneConfig) -> float:
    return config.preflight.spacing or 0.1


def precision(twins: Twins) -> list[str]:
    """f32 against f64."""
    single, double = twins.ends, twins.ran(quiet(twins.config, **{"runtime.precision": "f64"}))
    spacing = spacing_of(twins.config)
    return [judged(twins.config, a, b, 0.01 * spacing + 0.02 * b.moved) for a, b in zip(single, double, strict=True)]


def threads(twins: Twins) -> list[str]:
    """One thread and two: the same bytes."""
    one, two = twins.ends, twins.ran(quiet(twins.config, **{"runtime.precision": "f32", "runtime.threads": 2}))
    return [judged(twins.config, a, b, 0.0) for a, b in zip(one, two, strict=True)]


def step(twins: Twins) -> list[str] | None:
    """A step and half of it, which order and noise of a wind at every step may part."""
    if "noise" in str(twins.config.resolved().get("wind")):
        return None
    whole, built, found = twins.ends, twins.built(twins.plain), []
    for a, start in zip(whole, twins.starts, strict=True):
        built.begin(start._replace(pace=0.5 * start.pace))
        b = built.on(2 * STEPS)
        found.append(judged(twins.config, a, b, 0.02 * spacing_of(twins.config) + 0.5 * max(a.moved, b.moved)))
    return found


def checkpointed(twins: Twins) -> list[str]:
    """Put into another simulation half way, and not: the same bytes."""
    whole, first, held = twins.ends, twins.built(twins.plain), []
    for start in twins.starts:
        first.begin(start)
        held.append(first.half_way())
    twins.close()
    second, found = twins.built(twins.plain), []
    for start, a, half in zip(twins.starts, whole, held, strict=True):
        if isinstance(half, Snapshot):
            second.put(half, start)
            half = second.on(STEPS - STEPS // 2)
        found.append(judged(twins.config, a, half, 0.0))
    return found


def water_alone(config: SceneConfig, basin: tuple[str, ...], fluid: tuple[str, ...]) -> dict[str, Any] | None:
    """The resolved scene with nothing but its particles in double precision, without these keys of basin and fluid;
    None where there are no particles."""
    if not config.preflight.particles:
        return None
    keys = {key: value for key, value in quiet(config).resolved().items() if key in PLAIN} | QUIET | {"render": None}
    keys["runtime"] = keys["runtime"] | {"precision": "f64"}
    for slot, without in (("basin", basin), ("fluid", fluid)):
        keys[slot] = {key: value for key, value in keys[slot].items() if key not in without}
    return keys


def loaded(keys: dict[str, Any]) -> SceneConfig | None:
    """The scene, unless what was left out was needed."""
    try:
        return quiet(load(keys))
    except SceneError:
        return None


def mirrored(twins: Twins) -> list[str] | None:
    """Its water left to right, with walls, bed and obstacles that rest."""
    config = twins.config
    keys = water_alone(config, ("motion", "wavemaker", "lid"), ("initial", "emitter"))
    one = None if keys is None else loaded(keys)
    if one is None or any(box.get("velocity") or box.get("motion") for box in keys["basin"].get("obstacles") or []):
        return None
    other = deepcopy(one.resolved())
    for boxes in (other["fluid"].get("fill") or [], other["basin"].get("obstacles") or []):
        for box in boxes:
            low, high = box["min"][0], box["max"][0]
            box["min"][0], box["max"][0] = -high, -low
    for vector in (other["fluid"].get("body_force"), other["basin"].get("gravity")):
        if vector:
            vector[0] = -vector[0]
    floor = other["basin"].get("floor")
    if isinstance(floor, dict):
        if floor.get("grid"):
            return None
        floor["profile"] = [[-x, y] for x, y in (floor.get("profile") or [])[::-1]] or None
    walls = other["basin"].get("walls")
    if isinstance(walls, dict):
        other["basin"]["walls"] = {SWAPPED.get(side, side): kind for side, kind in walls.items()}
    here = twins.ran(one)
    return [
        judged(config, *overlaid(a, b), 1e-6 * spacing_of(config))
        for a, b in zip(here, twins.ran(load(other), MIRROR), strict=True)
    ]


def overlaid(a: State, b: State) -> tuple[State, State]:
    """A state, and the mirror image of another, both in the order of their places: particles have other numbers."""
    if a.stopped or b.stopped:
        return a, b
    flipped = b.position * MIRROR
    order = [np.lexsort(np.round(x, 6).T) for x in (a.position, flipped)]
    return a._replace(position=a.position[order[0]]), b._replace(position=flipped[order[1]])


def shifted(twins: Twins) -> list[str] | None:
    """Its water a few spacings along, between periodic sides and over an even bed."""
    keys = water_alone(twins.config, ("motion", "wavemaker", "lid", "obstacles"), ("emitter",))
    if keys is None:
        return None
    walls = keys["basin"].get("walls", "reflecting")
    sides = dict.fromkeys(("x_min", "x_max", "z_min", "z_max"), walls) if isinstance(walls, str) else walls
    across = {side: kind for side, kind in sides.items() if side[0] != "x" and "width" in keys["basin"]}
    scene = loaded(keys | {"basin": keys["basin"] | {"walls": across | {"x": "periodic"}}})
    if scene is None:
        return None
    basin, way, found = scene.preflight.tank, 3.0 * spacing_of(scene), []
    here, built = twins.ran(scene), twins.built(scene)
    particles = built.simulation.fluid.of_particles.particles
    for start, a in zip(twins.starts, here, strict=True):
        built.begin(start)
        x = particles.position.to_numpy()
        low, period = basin.lower[0], basin.periods[0]
        x[:, 0] = (x[:, 0] + way - low) % period + low
        particles.position.from_numpy(x)
        built.simulation.fluid.begin()
        b = built.on()
        if not (a.stopped or b.stopped):
            back = b.position - [way, 0.0, 0.0]
            back[:, 0] += period * np.round((a.position[:, 0] - back[:, 0]) / period)
            b = b._replace(position=back)
        found.append(judged(twins.config, a, b, 1e-6 * spacing_of(twins.config)))
    return found


def judged(config: SceneConfig, a: State, b: State, within: float) -> str:
    """How two runs disagree, in words; empty where they do not."""
    wrong = [f"{which}: {what}" for which, one in (("first", a), ("second", b)) for what in one.wrong]
    if bool(a.stopped) != bool(b.stopped):
        wrong.append(f"one stops and the other does not: {a.stopped or b.stopped}")
    elif not a.stopped and not parted(a, b) <= within:
        wrong.append(f"{parted(a, b):.3g} m apart, within {within:.3g} m")
    return "; ".join(wrong)


COMPARISONS: dict[str, Callable[[Twins], list[str] | None]] = {
    f.__name__: f for f in (precision, threads, step, checkpointed, mirrored, shifted)
}
