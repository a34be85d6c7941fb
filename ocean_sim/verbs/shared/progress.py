"""Progress of a run and of its pictures on the command line."""

from collections import Counter, deque
from contextlib import suppress
from time import perf_counter
from typing import Any

from ocean_sim.conventions import figures
from ocean_sim.machine import kernel_cache
from ocean_sim.simulation import OutcomeObserver, Simulation
from ocean_sim.verbs.shared import console
from ocean_sim.verbs.shared.bar import FILM_CURE, Bar, Drawing

MIN_TIMED_STEPS, MAX_TIMED_STEPS = 20, 400  # from whose later half a step is timed


def kernel_notice() -> str:
    """Sentence on loading or compiling kernels, and on kernels that Taichi has dropped from its cache meanwhile."""
    cache = kernel_cache()
    count, note = sum(1 for _ in cache.glob("*.tic")), cache.with_suffix(".count")
    if count == 0:
        return f"compiling kernels (a first run; they are kept in {cache})"
    dropped = 0
    with suppress(OSError, ValueError):  # no note yet, or one that cannot be written
        dropped = int(note.read_text()) - count if note.exists() else 0
        note.write_text(f"{count}\n")
    if dropped > 0:
        return f"loading kernels; {dropped} unused for longest were dropped from {cache}, as it had reached its limit"
    return "loading kernels"


class Progress(OutcomeObserver):
    """Observer that shows simulated time, speed and time left, and counts which limits have set the time steps."""

    def __init__(self, duration: float, quiet: bool, since: float = 0.0) -> None:
        """`duration`: simulated time at the end [s]; `since`: simulated time at which this process starts [s]."""
        self.bar, self.drawing = Bar(duration, quiet), Drawing(quiet, FILM_CURE)
        self.duration, self.since, self.attending = duration, since, False
        self.began = perf_counter()
        self.first: tuple[float, float] | None = None  # wall and simulated time [s] after the first step
        self.ends: deque[float] = deque(maxlen=MAX_TIMED_STEPS + 1)  # wall times [s] of the last steps
        self.time, self.steps, self.particles, self.wall, self.pictures = 0.0, 0, 0, 0.0, 0
        self.limits: Counter[str] = Counter()
        self.unsolved: dict[str, int] = {}  # steps of each solver that ended above its tolerance

    def observe(self, simulation: Simulation) -> None:
        """Record time, steps and which limit, as `viscous`, set the last step; redraw the bar if it is due."""
        now = perf_counter()
        self.time, self.steps = simulation.time, simulation.steps
        self.wall = now - self.began
        if not self.attending:
            self.attending = True
            for observer in simulation.observers:  # they call `draw` for each picture finished, also after the run
                observer.show_progress(self.draw)
        self.particles = simulation.fluid.count
        self.unsolved = {name: solver.unsolved for name, solver in simulation.fluid.solvers.items()}
        if self.steps == 0:
            return
        self.limits[simulation.time_step.limited_by] += 1
        if self.first is None:
            self.first = (now, self.time)
        self.ends.append(now)
        if self.over or self.bar.due(now):
            self.bar.show(self.time, f"t = {self.time:.2f} of {self.duration:g} s{self.pace()}")

    @property
    def over(self) -> bool:
        """True if the run has reached its duration."""
        return self.time >= self.duration * (1.0 - 1e-12)

    def pace(self) -> str:
        """End of the progress line: speed as a multiple of real time, and time left; empty before a second step."""
        if self.over:
            return ", writing and drawing what is left"
        if self.factor <= 0.0:
            return ""
        left = (self.duration - self.time) / self.factor
        drawn = f", {self.pictures} picture{'s' if self.pictures > 1 else ''} drawn" if self.pictures else ""
        return f", {figures(self.factor, 2)} x real time, {console.duration(left)} left{drawn}"

    def draw(self, done: int, total: int) -> None:
        """Record that `done` of `total` pictures are drawn; during the run the total is unknown, and 0."""
        self.pictures = done
        if total:
            self.bar.close()
            self.drawing(done, total)

    @property
    def factor(self) -> float:
        """Real-time factor: simulated over wall time since the first step of this process."""
        if self.first is None:
            return 0.0
        wall = self.began + self.wall - self.first[0]
        return (self.time - self.first[1]) / wall if wall > 0.0 else 0.0

    @property
    def step_time(self) -> float | None:
        """Mean wall time [s] of the later half of `ends`, after what compiles late; None if these are too few."""
        if len(self.ends) <= MIN_TIMED_STEPS:
            return None
        half = len(self.ends) // 2
        return (self.ends[-1] - self.ends[half]) / (len(self.ends) - 1 - half)

    def summary(self) -> dict[str, Any]:
        """Particles, steps, times, share of steps by limit, as JSON data; call it once all files are finished."""
        start = self.wall if self.first is None else self.first[0] - self.began
        after = perf_counter() - self.began - self.wall
        wall = {"start": start, "steps": self.wall - start, "pictures": after, "total": self.wall + after}
        return {
            "particles": self.particles,
            "steps": self.steps,
            "simulated_s": self.time,
            "since_s": self.since,
            "wall_s": wall,
            "real_time_factor": self.factor,
            "limited_by": {name: count / self.limits.total() for name, count in self.limits.most_common()},
            "unsolved": self.unsolved,
        }

    def close(self) -> None:
        self.bar.close()
        self.drawing.close()
