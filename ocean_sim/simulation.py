"""The simulation: one step of Algorithm 8, and the loop around it that calls the observers."""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from math import floor
from pathlib import Path
from typing import TYPE_CHECKING

from ocean_sim import runtime
from ocean_sim.conventions import Diverged
from ocean_sim.fluid import Limits
from ocean_sim.observers import Observer

if TYPE_CHECKING:
    from ocean_sim.reading.scene import SceneConfig


class Simulation:
    """A scene that has been built and can be stepped; use it as a context manager.

    Raises BackendMissing where the machine lacks what `runtime` asks for. Its fields are gone once it is closed, and
    where another simulation is started with another `runtime`, or with about a hundred open.
    """

    left_out = ("observers", "stage", "backend", "fields")  # what a checkpoint of it does not hold

    def __init__(self, scene: "SceneConfig", folder: Path | None = None) -> None:
        """`folder`: where observers write; without it there are only those that write nothing."""
        self.scene = scene
        self.backend = runtime.start(scene.runtime)
        with runtime.Fields() as self.fields:
            self.build(scene, folder)

    def build(self, scene: "SceneConfig", folder: Path | None) -> None:
        """Make the parts, in the order in which they read each other, and then the observers."""
        self.basin = scene.place()
        self.wind = scene.wind.build(self.basin, scene.seed)
        accounts = "accuracy" in scene.observers  # whether the fluid sums the impulse of each term
        self.fluid = scene.fluid.build(self.basin, scene.seed, ledger=accounts, wind=self.wind.on("fluid"))
        self.surface = scene.surface.build(self.basin, self.fluid) if scene.surface is not None else None
        self.ship = scene.ship.build(self.basin, self.fluid) if scene.ship is not None else None
        self.wind_on_ship = self.wind.on("ship")
        self.time_step = scene.time_step.build()
        self.stage: Callable[[str], AbstractContextManager] = lambda name: nullcontext()
        self.time, self.steps = 0.0, 0
        self.begun = False  # whether observers have seen the first state
        self.next_dt = self.time_step.next(self)  # [s] the coming step is known before it is taken
        self.outcome, self.reason = "running", ""
        self.observers: list[Observer] = [
            config.build(folder, self) for config in scene.observers.values() if folder is not None or not config.writes
        ]

    def limits(self) -> Limits:
        """What the time step must stay a fraction of, for the water and the ship."""
        water = self.fluid.limits()
        return water if self.ship is None else water.and_of(self.ship.limits())

    def step(self) -> None:
        """Algorithm 8 of the thesis; rendering and logging are done by observers."""
        runtime.must_run(self.backend)
        if self.fields.freed:
            raise RuntimeError("this simulation is closed, and its memory is freed; step it inside its `with` block")
        dt = self.next_dt
        with self.stage("wind"):
            self.wind.advance(dt)  # Algorithm 1
        with self.stage("fluid"):
            self.fluid.advance(dt)  # (2.27)
        if self.surface is not None:
            with self.stage("surface"):
                self.surface.follow(self.fluid.particles, dt)  # Algorithms 3 and 5
        if self.ship is not None:
            with self.stage("ship"):
                load = self.ship.load(self.wind_on_ship, self.fluid, self.surface or self.fluid)  # (4.27)
                self.ship.advance(load, dt)  # (4.22) to (4.25)
        self.time += dt
        self.steps += 1
        self.next_dt = self.time_step.next(self)

    def run(self, until: float) -> None:
        """Step until this time [s] is reached; raises Diverged where the run leaves the physical world."""
        try:
            if not self.begun:
                self.begun = True
                self._watch(self.observers)
            while self.time < until * (1.0 - 1e-12):
                before = self.time
                self.step()
                self._watch([o for o in self.observers if self._due(o.every, before)])
        except Diverged as failure:
            when = "" if "t = " in str(failure) else f"; t = {self.time:.4f} s, step {self.steps}"
            self.outcome, self.reason = "stopped", f"{failure}{when}"
            raise Diverged(self.reason) from None
        except KeyboardInterrupt:
            self.outcome, self.reason = "stopped", "interrupted"
            raise
        self.outcome = "done"

    def _due(self, every: float, before: float) -> bool:
        """Whether a multiple of `every` lies between the last state and the coming one: then the states on both sides
        of it are shown, and a sampled file can be interpolated onto it."""
        return every == 0.0 or floor((self.time + self.next_dt) / every) > floor(before / every)

    def _watch(self, observers: list[Observer]) -> None:
        with self.stage("observers"):
            for observer in observers:
                observer.observe(self)

    def close(self) -> None:
        """Close all observers, and free the memory of all fields. Each observer gets its turn whatever another raises,
        also an interrupt, and the first failure is raised at last."""
        failures: list[BaseException] = []
        for observer in self.observers:
            try:
                observer.close()
            except BaseException as failure:
                failures.append(failure)
        self.observers = []
        self.fields.free()
        if failures:
            raise failures[0]

    def __enter__(self) -> "Simulation":
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()
