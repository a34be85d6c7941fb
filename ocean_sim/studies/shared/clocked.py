"""A simulation with a clock: the cost of its steps, without compilation."""

from time import perf_counter, process_time
from typing import Any

from ocean_sim.fluid import with_particles
from ocean_sim.simulation import Simulation

WARM_UP_STEPS = 3  # steps in which kernels are still compiled or loaded
FRAME_SECONDS = 1.0 / 60.0  # [s]
TIMED_PARTS, BLOCK_STEPS = 3, 7  # parts in which a run is timed; steps of the blocks that are dealt to them in turn


class Clocked(Simulation):
    """Simulation that records the simulated, wall and processor time of each step, excluding the work of observers."""

    def __init__(self, *given: Any) -> None:
        self.spent: list[tuple[float, float, float]] = []
        super().__init__(*given)

    def step(self) -> None:
        """Advance by one time step, and record its simulated, wall and processor time [s]."""
        dt, wall, cpu = float(self.next_dt), perf_counter(), process_time()
        super().step()
        self.spent.append((dt, perf_counter() - wall, process_time() - cpu))

    def frame(self) -> None:
        """Advance the drawn water surface by 1/60 s and triangulate it; recorded like a step."""
        surface = self.surface
        assert surface is not None
        wall, cpu = perf_counter(), process_time()
        surface.follow(with_particles(self.fluid).particles, FRAME_SECONDS)
        surface.mesh()
        self.spent.append((FRAME_SECONDS, perf_counter() - wall, process_time() - cpu))

    def costs(self) -> list[dict[str, float]]:
        """Costs (see `median_cost`) of TIMED_PARTS interleaved parts of the run; a disturbance rarely hits two."""
        parts = [
            [step for k, step in enumerate(self.spent[WARM_UP_STEPS:]) if k // BLOCK_STEPS % TIMED_PARTS == n]
            for n in range(TIMED_PARTS)
        ]
        return [median_cost(steps) for steps in parts if steps]

    def cost(self) -> dict[str, float | None]:
        """Costs (see `median_cost`) of all steps after the first WARM_UP_STEPS; all are None without such steps."""
        steps = self.spent[WARM_UP_STEPS:]
        return median_cost(steps) if steps else dict.fromkeys(("wall_per_s", "cpu_per_s", "time_step_s"))  # type: ignore[return-value]


def median_cost(steps: list[tuple[float, float, float]]) -> dict[str, float]:
    """Wall and processor time per simulated second, and mean time step [s], of steps (simulated, wall, processor)."""
    simulated, wall, cpu = (sum(column) for column in zip(*steps))
    return {"wall_per_s": wall / simulated, "cpu_per_s": cpu / simulated, "time_step_s": simulated / len(steps)}
