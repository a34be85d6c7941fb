"""Wall time of each stage of a step: the only file of a run with clock values."""

from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter
from typing import ClassVar, NamedTuple

from ocean_sim.kernel_library import ti
from ocean_sim.model import quantity
from ocean_sim.observers.shared.csv_rows import CsvFile, Multiples, heading, legend
from ocean_sim.parts import PeriodicConfig
from ocean_sim.simulation import NO_FOLDER, Observer, Simulation


class Config(PeriodicConfig):
    turn: ClassVar[int] = -4
    leaves: ClassVar[str] = "timings.csv"
    writes: ClassVar[bool] = False
    every: float = quantity("s", 0.5, gt=0.0)
    """Simulated time between rows."""


class Mark(NamedTuple):
    """Clock values at one moment: wall and simulated time, steps, and the wall time of each stage so far [s]."""

    wall: float
    time: float
    steps: int
    stages: dict[str, float]


class Timings(Observer, of=Config):
    """Measures the wall time of each stage of every step (pressure, ships ...); timings.csv holds means per row. The
    first step compiles kernels: its time is given as `first_step_s`, and no mean contains it."""

    left_out = ("stage_times", "began", "first_step", "first_step_s", "start", "last")  # values of a clock

    def __init__(self, config: Config, folder: Path, simulation: Simulation) -> None:
        self.every, self.simulation = config.every, simulation
        self.folder = None if folder is NO_FOLDER else folder
        self.multiples = Multiples(config.every)
        parts = {"surface": simulation.surface is not None, "ship": bool(simulation.ships)}
        self.names = ["wind", "fluid", *(name for name, there in parts.items() if there), "observers"]
        self.stage_times: dict[str, float] = defaultdict(float)  # since the first step [s]
        self.began: float | None = None
        self.first_step = simulation.steps  # number of the step that compiles
        self.first_step_s = float("nan")
        self.start: Mark | None = None  # when the first step was over
        self.last: Mark | None = None
        self.csv: CsvFile | None = None
        # On a processor each launch waits by itself
        self.sync = (lambda: None) if simulation.backend.arch in ("cpu", "x64", "arm64") else ti.sync
        simulation.stage = self.stage  # type: ignore[method-assign, assignment]

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Context manager that adds up the wall time of a stage (part) of a step; replaces `simulation.stage`."""
        self.sync()
        entered = perf_counter()
        if self.start is None:
            self.warm_up(name, entered)
        yield
        self.sync()
        if self.start is not None:
            self.stage_times[name] += perf_counter() - entered

    def warm_up(self, name: str, now: float) -> None:
        """Note the first step's start, at its first stage `name`, not `observers`, and end; `now`: wall time [s]."""
        if self.began is not None and self.simulation.steps > self.first_step:
            self.first_step_s = now - self.began
            self.start = self.last = self.take_mark(now)
        elif self.began is None and name != "observers":
            self.began, self.first_step = now, self.simulation.steps

    def take_mark(self, now: float) -> Mark:
        return Mark(now, self.simulation.time, self.simulation.steps, dict(self.stage_times))

    def observe(self, simulation: Simulation) -> None:
        if self.multiples.reached(simulation.time):
            self.write_row()

    def write_row(self) -> None:
        """Write a row of means since the last row, unless there was no step since or the run has no folder."""
        now = self.take_mark(perf_counter())
        if self.folder is None or self.last is None or self.start is None or now.steps == self.last.steps:
            return
        if self.csv is None:
            rate = f"every {self.every:g} s, at the first step after it; means since the row before"
            head = heading(self.simulation, rate, **legend("timings", first_step=self.first_step_s))
            stages = [f"{name}_ms_per_step" for name in (*self.names, "other")]
            columns = ["time_s", "steps", "wall_s", "real_time_factor", *stages]
            self.csv = CsvFile(self.folder / "timings.csv", head, columns)
        factor, means = self.stage_means(self.last, now)
        self.csv.row([now.time, now.steps, now.wall - self.start.wall, factor, *means.values()])
        self.last = now

    def stage_means(self, before: Mark, after: Mark) -> tuple[float, dict[str, float]]:
        """Real-time factor between two marks, and mean wall time [ms/step] of each stage by name. Stage `other` is the
        rest: choosing the time step, progress bars, the loop itself."""
        wall, steps = after.wall - before.wall, after.steps - before.steps
        taken = {name: after.stages.get(name, 0.0) - before.stages.get(name, 0.0) for name in self.names}
        taken["other"] = max(0.0, wall - sum(taken.values()))
        return (after.time - before.time) / wall, {name: 1e3 * seconds / steps for name, seconds in taken.items()}

    def close(self) -> None:
        self.write_row()
        if self.csv is not None:
            self.csv.close()
