"""One scene run twice in ways that must agree: what is compared, within what, and books that every run must close.
A comparison answers in words, with none where the two agree; None where it does not suit the scene.

Twins have the same fixed step, a half of what is stable, and STEPS steps, so that chaos has no time to part them.
"""

from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ocean_sim.conventions import Diverged
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.observers.health import Config as HealthConfig
from ocean_sim.observers.health import Health
from ocean_sim.reading.scene import SceneConfig, load, observer_names
from ocean_sim.simulation import Simulation
from ocean_sim.state.walk import Restorer, Snapshot
from ocean_sim.verbs.check import preflight

STEPS = 12
QUIET = dict.fromkeys(name for name in observer_names() if name not in ("manifest", "accuracy"))
PLAIN = ("basin", "fluid", "time_step", "runtime", "accuracy", "manifest", "title", "seed", "duration", "resolution")
SWAPPED = {"x_min": "x_max", "x_max": "x_min"}


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
        """Which do not close; raises Diverged where a run would be stopped. `mueller` does heat water, and says so."""
        if self.health.n > 0 and (sentence := next(self.health.violations(), "")):
            raise Diverged(sentence)
        heats = self.health.simulation.scene.fluid.kind == "mueller"
        return [what for what in self.health.reported if not (heats and what == "energy that no work has given")]


def ran(config: SceneConfig, steps: int = STEPS, begin: Callable[[Simulation], None] | None = None) -> State:
    """The state after so many steps; `begin` changes the first."""
    with Simulation(config) as simulation:
        if begin is not None:
            begin(simulation)
        water, books = simulation.fluid.of_particles, Books(simulation)
        start = None if water is None else sorted_by_id(water, water.particles.position)
        try:
            for _ in range(steps):
                simulation.step()
            return state(simulation, start, "", books.check())
        except Diverged as stopped:
            return state(simulation, start, str(stopped), [])


def parted(a: State, b: State) -> float:
    """How far the same particles, or ships, are from each other [m]; infinite where there are not as many."""
    if a.position.shape != b.position.shape or a.ships.shape != b.ships.shape:
        return float("inf")
    ways = [np.abs(a.position - b.position), np.abs(a.ships[:, :3] - b.ships[:, :3])]
    return max(float(way.max(initial=0.0)) for way in ways)


def spacing_of(config: SceneConfig) -> float:
    return config.preflight.spacing or 0.1


def precision(config: SceneConfig) -> str:
    """f32 against f64."""
    single, double = (ran(quiet(config, **{"runtime.precision": p})) for p in ("f32", "f64"))
    return judged(config, single, double, 0.01 * spacing_of(config) + 0.02 * double.moved)


def threads(config: SceneConfig) -> str:
    """One thread and two: the same bytes."""
    one, two = (ran(quiet(config, **{"runtime.threads": n})) for n in (1, 2))
    return judged(config, one, two, 0.0)


def step(config: SceneConfig) -> str | None:
    """A step and half of it, which order and noise of a wind at every step may part."""
    if "noise" in str(config.resolved().get("wind")):
        return None
    whole = quiet(config)
    halves = quiet(config, **{"time_step.dt": 0.5 * whole.time_step.dt})
    a, b = ran(whole), ran(halves, 2 * STEPS)
    return judged(config, a, b, 0.02 * spacing_of(config) + 0.5 * max(a.moved, b.moved))


def checkpointed(config: SceneConfig) -> str:
    """Put into another simulation half way, and not: the same bytes."""
    scene = quiet(config)
    whole = ran(scene)
    with Simulation(scene) as first:
        try:
            for _ in range(STEPS // 2):
                first.step()
        except Diverged as stopped:
            return judged(config, whole, state(first, None, str(stopped), []), 0.0)
        held = Snapshot(first, Path())

        def restored(simulation: Simulation) -> None:
            Restorer(simulation, held.tree, {name: values.copy() for name, values in held.arrays.items()}, Path())

        return judged(config, whole, ran(scene, STEPS - STEPS // 2, restored), 0.0)


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


def mirrored(config: SceneConfig) -> str | None:
    """Its water left to right, with walls and obstacles that rest."""
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
    walls = other["basin"].get("walls")
    if isinstance(walls, dict):
        other["basin"]["walls"] = {SWAPPED.get(side, side): kind for side, kind in walls.items()}
    a, b = ran(one), ran(load(other))
    if a.stopped or b.stopped:
        return judged(config, a, b, 0.0)
    flipped = b.position * [-1.0, 1.0, 1.0]
    order = [np.lexsort(np.round(x, 6).T) for x in (a.position, flipped)]
    mirror = b._replace(position=flipped[order[1]], ships=b.ships)
    return judged(config, a._replace(position=a.position[order[0]]), mirror, 1e-6 * spacing_of(config))


def shifted(config: SceneConfig) -> str | None:
    """Its water a few spacings along, between periodic sides and over an even bed."""
    keys = water_alone(config, ("motion", "wavemaker", "lid", "obstacles"), ("emitter",))
    if keys is None:
        return None
    walls = keys["basin"].get("walls", "reflecting")
    sides = dict.fromkeys(("x_min", "x_max", "z_min", "z_max"), walls) if isinstance(walls, str) else walls
    across = {side: kind for side, kind in sides.items() if side[0] != "x" and "width" in keys["basin"]}
    scene = loaded(keys | {"basin": keys["basin"] | {"walls": across | {"x": "periodic"}}})
    if scene is None:
        return None
    basin, way = scene.preflight.tank, 3.0 * spacing_of(scene)

    def along(simulation: Simulation) -> None:
        particles = simulation.fluid.of_particles.particles
        x = particles.position.to_numpy()
        low, period = basin.lower[0], basin.periods[0]
        x[:, 0] = (x[:, 0] + way - low) % period + low
        particles.position.from_numpy(x)
        simulation.fluid.begin()

    a, b = ran(scene), ran(scene, begin=along)
    if a.stopped or b.stopped:
        return judged(config, a, b, 0.0)
    back = b.position - [way, 0.0, 0.0]
    back[:, 0] += basin.periods[0] * np.round((a.position[:, 0] - back[:, 0]) / basin.periods[0])
    return judged(config, a, b._replace(position=back), 1e-6 * spacing_of(config))


def judged(config: SceneConfig, a: State, b: State, within: float) -> str:
    """How two runs disagree, in words; empty where they do not."""
    wrong = [f"{which}: {what}" for which, one in (("first", a), ("second", b)) for what in one.wrong]
    if bool(a.stopped) != bool(b.stopped):
        wrong.append(f"one stops and the other does not: {a.stopped or b.stopped}")
    elif not a.stopped and not parted(a, b) <= within:
        wrong.append(f"{parted(a, b):.3g} m apart, within {within:.3g} m")
    return "; ".join(wrong)


COMPARISONS = {f.__name__: f for f in (precision, threads, step, checkpointed, mirrored, shifted)}
