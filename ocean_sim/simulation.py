"""The simulation: one step of Algorithm 8, and the loop around it that calls the observers."""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext, suppress
from math import floor
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Self

from ocean_sim import runtime
from ocean_sim.conventions import Diverged, Unsuited, in_words, number
from ocean_sim.fluid import Limits, with_particles
from ocean_sim.model import Model
from ocean_sim.parts import ObserverConfig
from ocean_sim.ship import Ship

if TYPE_CHECKING:
    from ocean_sim.reading.scene import SceneConfig

NO_FOLDER = Path()  # given as folder to observers that write nothing
Progress = Callable[[int, int], None]  # pieces of a long task: done, total


class Observer:
    """Base of all observers: reads a simulation and writes files of its own; never changes the physics."""

    every: float = 0.0
    """Simulated time between calls [s]; 0 is after every step."""
    left_out: ClassVar[tuple[str, ...]] = ()
    """Attributes that a checkpoint of it does not hold."""

    def __init_subclass__(cls, of: type[ObserverConfig] | None = None) -> None:
        """Register this observer with `of`, its Config class, whose `build` then constructs it."""
        if of is not None:
            of.observer = cls

    def observe(self, simulation: "Simulation") -> None:
        """Observe the present state; called at time 0 and after each step that the interval `every` selects."""

    def resumed(self, changed: str) -> None:
        """Hook after a checkpoint is restored; `changed`: how the program differs from the one that saved it."""

    def show_progress(self, progress: Progress) -> None:
        """Receive the callback to which an observer reports the progress of a long task; ignored by default."""

    def record_event(self, name: str, **facts: object) -> None:
        """Write an event of the run, of this name; ignored by default."""

    def close(self) -> None:
        """Finish the files of the observer; called once, also after a run that failed."""


class OutcomeObserver(Observer):
    """Observer whose files state how a run ended. It is closed last, since other observers may fail to close."""

    def amend(self) -> None:
        """Write the outcome once more; called if an observer fails that is closed after this one."""


class Simulation:
    """A built scene that can be stepped; use it as a context manager.

    Raises BackendMissing if the machine lacks the backend of `runtime`. Its fields are freed when it is closed, when
    another simulation starts with a different `runtime`, and when about a hundred are open.
    """

    left_out = ("observers", "stage", "backend", "fields")  # what a checkpoint of it does not hold

    def __init__(self, scene: "SceneConfig", folder: Path | None = None) -> None:
        """`folder`: run folder of the observers; without one only observers that write nothing are built."""
        self.scene = scene
        if not isinstance(scene, Model):
            raise Unsuited(f"a simulation takes a scene that ocean_sim.load has read, not {scene!r:.60}")
        folder = None if folder is None else Path(folder)
        scene.inputs()  # raises where a file has changed of which the scene may know the content
        self.backend = runtime.start(scene.runtime)
        require_doubles(scene, self.backend)
        with runtime.Fields() as self.fields:
            self.build(scene, folder)

    def build(self, scene: "SceneConfig", folder: Path | None) -> None:
        """Build the parts of the scene, each after those on which it depends, and then the observers."""
        self.basin = scene.preflight.basin
        self.wind = scene.wind.build(self.basin, scene.seed)
        accounts = scene.preflight.sums_impulses and self.backend.doubles
        self.fluid = scene.fluid.build(self.basin, scene.seed, accounts=accounts, wind=self.wind.on("fluid"))
        surface = scene.preflight.surface
        self.surface = surface.build(self.basin, self.fluid) if surface is not None else None
        self.ships = {name: ship.build(name, self.basin, self.fluid) for name, ship in scene.ships.items()}
        self.water_at_ships = self.fluid.add_ships(list(self.ships.values()))  # as each ship feels it
        self.wind_on_ship = self.wind.on("ship")
        self.time_step = scene.time_step.build()
        self.stage: Callable[[str], AbstractContextManager] = lambda name: nullcontext()
        self.time, self.steps = 0.0, 0
        self.begun = False  # whether observers have seen the first state
        self.next_dt = self.time_step.next(self.limits())  # [s] the coming step is known before it is taken
        self.outcome, self.reason = "running", ""
        self.observers: list[Observer] = []
        try:
            for config in scene.observers.values():
                if folder is not None or not config.writes:
                    self.observers.append(config.build(folder or NO_FOLDER, self))
        except BaseException as failure:
            self.note(failure)
            self.conclude()  # its own failures come second
            raise

    @property
    def ship(self) -> Ship | None:
        """The only ship; None without ships. Raises ValueError if there are several, which `ships` holds by name."""
        if len(self.ships) > 1:
            raise ValueError(f"there are several ships: {', '.join(self.ships)}; take one of simulation.ships")
        return next(iter(self.ships.values()), None)

    def limits(self) -> Limits:
        """Limits of the time step: of each, the smallest among the water and all ships."""
        limits = self.fluid.limits()
        for ship in self.ships.values():
            limits = limits.and_of(ship.limits())
        return limits

    def step(self) -> None:
        """Advance by one time step (Algorithm 8 of the thesis); rendering and logging are done by observers."""
        runtime.require_running(self.backend)
        if self.fields.freed:
            raise RuntimeError("this simulation is closed, and its memory is freed; step it inside its `with` block")
        dt = self.next_dt
        with self.stage("wind"):
            if self.basin.sea is not None:
                self.wind.follow(self.fluid.patch_centre)
            self.wind.advance(dt)  # Algorithm 1
        with self.stage("fluid"):
            self.fluid.advance(dt)  # (2.27)
        if self.surface is not None:
            with self.stage("surface"):
                self.surface.follow(with_particles(self.fluid).particles, dt)  # Algorithms 3 and 5
        if self.ships:
            with self.stage("ship"):
                afloat = list(zip(self.ships.values(), self.water_at_ships, strict=True))
                loads = [ship.load(self.wind_on_ship, water, self.surface or water) for ship, water in afloat]  # (4.27)
                for (ship, _), load in zip(afloat, loads, strict=True):
                    ship.advance(load, dt)  # (4.22) to (4.25)
        self.time += dt
        self.steps += 1
        self.next_dt = self.time_step.next(self.limits())

    def run(self, until: float) -> None:
        """Step until this time [s] is reached, and call the observers; raises Diverged for an unphysical state."""
        until = number("until", until, "s", 0.0)
        try:
            if not self.begun:
                self.begun = True
                self._observe(self.observers)
            while self.time < until * (1.0 - 1e-12):
                before = self.time
                self.step()
                self._observe([o for o in self.observers if self._due(o.every, before)])
        except Diverged as failure:
            self.note(failure)
            raise Diverged(self.reason) from None
        except BaseException as failure:
            self.note(failure)
            raise
        self.outcome = "done"

    def note(self, failure: BaseException) -> None:
        """Set outcome and reason of a run ended by `failure`: `stopped` (diverged, or by a person) or `failed`."""
        if isinstance(failure, Diverged):
            when = "" if "t = " in str(failure) else f"; t = {self.time:.4f} s, step {self.steps}"
            self.outcome, self.reason = "stopped", f"{failure}{when}"
        elif isinstance(failure, KeyboardInterrupt):
            self.outcome, self.reason = "stopped", "interrupted"
        else:
            self.outcome, self.reason = "failed", in_words(failure)

    def _due(self, every: float, before: float) -> bool:
        """True if an observation is due: a multiple of `every` [s] lies between `before` and the next step's end."""
        return every == 0.0 or floor((self.time + self.next_dt) / every) > floor(before / every)

    def _observe(self, observers: list[Observer]) -> None:
        """Call these observers with the present state; the timings count this as the stage `observers`."""
        with self.stage("observers"):
            for observer in observers:
                observer.observe(self)

    def close(self) -> None:
        """Close all observers, and free the memory of all fields; then raise the first exception of an observer."""
        failures = self.conclude()
        self.fields.free()
        if failures:
            raise failures[0]

    def conclude(self) -> list[BaseException]:
        """Close all observers, even if one raises; return the exceptions. The first replaces the outcome `done`."""
        failures: list[BaseException] = []
        concluded: list[OutcomeObserver] = []
        for observer in sorted(self.observers, key=lambda observer: isinstance(observer, OutcomeObserver)):
            try:
                observer.close()
            except BaseException as failure:
                failures.append(failure)
                if self.outcome == "done" and not isinstance(failure, KeyboardInterrupt):
                    self.note(failure)
                    with suppress(OSError):  # the failure that came first is told
                        for earlier in reversed(concluded):
                            earlier.amend()
            if isinstance(observer, OutcomeObserver):
                concluded.append(observer)
        self.observers = []
        return failures

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type | None, failure: BaseException | None, where: object) -> None:
        """Close the simulation; an exception of the block becomes its outcome, and precedes those of closing."""
        if failure is not None and self.outcome == "running":
            self.note(failure)
        try:
            self.close()
        except Exception:
            if failure is None:  # else that one came first, and is the one to tell
                raise


def require_doubles(scene: "SceneConfig", backend: runtime.Backend) -> None:
    """Raise BackendMissing, with the keys that cause it, if a scene needs double precision and the backend has none."""
    if backend.doubles:
        return
    tank, wind = scene.preflight.tank, scene.wind
    counting = {
        "runtime.precision": scene.runtime.precision == "f64",
        "accuracy": "accuracy" in scene.observers,
        "ship": bool(scene.ships),
        "sea": tank.sea is not None,
        "basin.obstacles": bool(tank.config.obstacles),
        "basin.walls": any(side.absorbing is not None for side in tank.sides),
        "health": "health" in scene.observers and scene.fluid.made_of_particles,
        "fluid.kind": scene.fluid.counts_in_doubles,
        "wind": wind.needs_area,
    }
    found = [key for key, counts in counting.items() if counts]
    if found:
        raise runtime.BackendMissing(
            f"runtime.arch: {backend.arch}: this graphics card, or its driver, has no double precision, in which "
            f"{', '.join(found)} of this scene would count; leave that out, or set runtime.arch=cpu"
        )
