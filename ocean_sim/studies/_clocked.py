"""A simulation with a clock: what its steps cost, compilation left out."""

from time import perf_counter, process_time
from typing import Any

from ocean_sim.simulation import Simulation

WARM_UP = 3  # steps in which kernels are still compiled or loaded


class Clocked(Simulation):
    """Keeps simulated, wall and processor time of every step; what observers do between steps is not counted."""

    def __init__(self, *given: Any) -> None:
        self.spent: list[tuple[float, float, float]] = []
        super().__init__(*given)

    def __enter__(self) -> "Clocked":
        return self

    def step(self) -> None:
        dt, wall, cpu = float(self.next_dt), perf_counter(), process_time()
        super().step()
        self.spent.append((dt, perf_counter() - wall, process_time() - cpu))

    def cost(self) -> dict[str, float | None]:
        """Wall and processor seconds per simulated second, and the mean time step [s]; None of too short a run."""
        steps = self.spent[WARM_UP:]
        simulated, wall, cpu = (sum(column) for column in zip(*steps)) if steps else (0.0, 0.0, 0.0)
        if simulated <= 0.0:
            return {"wall_per_s": None, "cpu_per_s": None, "time_step_s": None}
        return {"wall_per_s": wall / simulated, "cpu_per_s": cpu / simulated, "time_step_s": simulated / len(steps)}
