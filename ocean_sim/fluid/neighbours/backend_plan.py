"""Plans of the walk over neighbours, one for processors and one for graphics cards."""

from dataclasses import dataclass
from typing import ClassVar

from ocean_sim.fluid.budget.momentum_budget import TERM_NAMES, Accounts
from ocean_sim.fluid.neighbours.cell_walk import CellWalk
from ocean_sim.fluid.neighbours.grid import Grid
from ocean_sim.fluid.neighbours.grid_size import GridSize, Plan
from ocean_sim.fluid.neighbours.kept_pairs import slot_count
from ocean_sim.fluid.neighbours.particle_walk import ParticleWalk, WideAccounts, WideGrid, level_sizes
from ocean_sim.parts import LedgerRow
from ocean_sim.runtime import GRAPHICS_BACKENDS, GRAPHICS_CARD_CHOICES

Walk = CellWalk | ParticleWalk


@dataclass(frozen=True)
class ParticlePlan(Plan):
    """Plan for graphics cards: each particle is a task of its own, for one thread."""

    stride: ClassVar[int] = 1
    samples: ClassVar[int] = 1

    def task_count(self, n: int) -> int:
        return n

    def chunk_count(self, n: int) -> int:
        """One chunk for all particles: atomic counters replace chunks."""
        return 1

    def parts_per_axis(self, full: float, dimension: int) -> int:
        return 1

    def sorting_integers(self, n: int, cells: int) -> int:
        return n + sum(level_sizes(cells)[1:])

    def list_bytes(self, size: GridSize, word: int) -> int:
        return 0

    def pair_bytes(self, size: GridSize, neighbours: int, word: int) -> int:
        return size.lattice.n * (8 + slot_count(neighbours) * (4 + 3 * word))  # of PairSlots

    def highest_index(self, size: GridSize, neighbours: int) -> int:
        return size.lattice.n * (slot_count(neighbours) if neighbours else 1)

    def account_bytes(self, n: int, word: int, impulses: bool) -> int:
        return n * (5 * word + 8 + (8 * 4 * len(TERM_NAMES) if impulses else 0))


CELL_PLAN, PARTICLE_PLAN = Plan(Grid, Accounts, CellWalk), ParticlePlan(WideGrid, WideAccounts, ParticleWalk)
PLANS: dict[str, Plan] = {"cpu": CELL_PLAN, "auto": CELL_PLAN} | dict.fromkeys(
    (*GRAPHICS_CARD_CHOICES, *GRAPHICS_BACKENDS), PARTICLE_PLAN
)
"""Plans by backend. Before a backend is started, `auto` counts as the processor and `gpu` as a card."""


def mesh_ledger(size: GridSize, word: int) -> list[LedgerRow]:
    """Row of the memory ledger for the distances from meshes with floats of `word` bytes; empty without meshes."""
    spacing, meshes = size.lattice.spacing, size.lattice.basin.meshes.values()
    sizes = [mesh.net_bytes(spacing, word) + 6 * word for mesh in meshes]
    return [LedgerRow("basin", "distances from meshes", sum(sizes), "basin.obstacles")] if sizes else []


def account_ledger(size: GridSize, word: int, impulses: bool) -> list[LedgerRow]:
    """Row of the memory ledger for the momentum budget, if the plan has a row for each particle; else empty."""
    taken = size.plan.account_bytes(size.lattice.n, word, impulses)
    return [LedgerRow("fluid", "accounts", taken, "a row for each particle")] if taken else []
