"""Budget of a step: extremes, and the impulse of every force term, summed per group of cells and added in the order of
groups; and sums over all particles."""

from math import isfinite

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.columns import Columns
from ocean_sim.conventions import Diverged
from ocean_sim.fluid import Status, Totals
from ocean_sim.fluid.neighbours.grid import Grid
from ocean_sim.fluid.neighbours.thread_tasks import ROW_PADDING, TASK_ITERATIONS
from ocean_sim.fluid.sph.particles import Particles
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import Doubles2, Doubles3, Template, in_kernels, runs_alone

TERM_NAMES = ("pressure", "viscosity", "wind", "gravity", "walls", "ship", "diffusion", "bed", "sea", "leak")
PRESSURE, VISCOSITY, WIND, GRAVITY, WALLS, SHIP, DIFFUSION, BED, SEA, LEAK = range(len(TERM_NAMES))
ENERGY_TERMS = (DIFFUSION, LEAK)  # they give no impulse
SUMMARY_SIZE = 9  # numbers that a step reports
WORK_COLUMN = 3  # number of a column, behind the impulse
UNREACHABLE_DENSITY = 1.0e30  # [kg/m3] more than any density
SUM_BLOCKS = 16
SUM_COLUMNS = Columns(density=1, compression=1, deficit=1, squared_speed=1, position=3, velocity=3, turning=3)
MAX_COLUMNS = Columns(compression=1, low=3, high=3)  # behind the sums; `low` is the highest of what is below 0
FAR_COORDINATE = 1.0e30  # [m]


def absent_terms(basin: Basin) -> tuple[int, ...]:
    """Indices in TERM_NAMES of force terms that cannot act in this basin, such as bed friction on a smooth bed."""
    return (*(() if basin.rough_bed is not None else (BED,)), *(() if basin.sea is not None else (SEA,)))


def impulse_terms(absent: tuple[int, ...]) -> tuple[int, ...]:
    """Indices in TERM_NAMES of terms with impulse: not those of energy (diffusion, leak of density) or `absent`."""
    return tuple(term for term in range(len(TERM_NAMES)) if term not in (*absent, *ENERGY_TERMS))


@in_kernels
class Accounts:
    """Momentum budget: extremes of motion and density, impulse and work. Each group of particles (a thread's task) has
    a row with its number, `group`. Rows are added in order, so that no result depends on the order of threads."""

    def __init__(self, groups: int, impulses: bool, absent: tuple[int, ...], apart: int = ROW_PADDING) -> None:
        """Make `groups` rows of `apart` numbers. `impulses`: also sum impulse, work of TERM_NAMES but `absent` ones."""
        self.groups, self.impulses = groups, impulses
        self.idle = absent  # terms that nothing in the scene gives
        self.overflow, self.clipped = (ti.field(int, shape=(groups, apart)) for _ in range(2))
        self.speed2, self.acceleration2, self.sum = (ti.field(float, shape=(groups, apart)) for _ in range(3))
        self.thin, self.dense = (ti.field(float, shape=(groups, apart)) for _ in range(2))
        self.thinner, self.inner = (ti.field(float, shape=(groups, apart)) for _ in range(2))
        if impulses:
            self.terms = tuple(term for term in range(len(TERM_NAMES)) if term not in absent)
            self.impulse_terms = impulse_terms(absent)
            rows = (groups, len(TERM_NAMES) + apart // (2 * (WORK_COLUMN + 1)), WORK_COLUMN + 1)
            self.given = ti.field(ti.f64, shape=rows)  # impulse, and work
            self.sums_copy = np.zeros(rows)

    @ti.func
    def begin_motion(self, group):
        """Reset largest speed and acceleration in row `group` (a thread's particles), before a step counts these."""
        self.speed2[group, 0] = self.acceleration2[group, 0] = self.sum[group, 0] = 0.0

    @ti.func
    def begin_density(self, group):
        """Reset least and largest density in row `group` (a thread's particles), before a step counts these."""
        self.thin[group, 0], self.dense[group, 0] = UNREACHABLE_DENSITY, 0.0
        self.thinner[group, 0] = self.inner[group, 0] = 0.0

    @ti.func
    def count_motion(self, group, v, a, fast):
        """Raise row `group`'s maxima to speed of v [m/s], acceleration a [m/s2]; `fast`: 1 if `motion_limit` cut v."""
        v2, a2 = v.dot(v), a.dot(a)
        self.speed2[group, 0] = ti.max(self.speed2[group, 0], v2)
        self.acceleration2[group, 0] = ti.max(self.acceleration2[group, 0], a2)
        self.sum[group, 0] = self.sum[group, 0] + v2
        self.clipped[group, 0] = self.clipped[group, 0] + fast

    @ti.func
    def count_density(self, group, density):
        """Extend least and largest density in row `group` (a thread's particles) to a particle's density [kg/m3]."""
        self.thin[group, 0] = ti.min(self.thin[group, 0], density)
        self.dense[group, 0] = ti.max(self.dense[group, 0], density)

    @ti.func
    def count_packing(self, group, thinner):
        """Add `thinner` (Continuity.swelling) of a particle far from surfaces to row `group`, and count it there."""
        self.thinner[group, 0] = self.thinner[group, 0] + thinner
        self.inner[group, 0] = self.inner[group, 0] + 1.0

    @ti.func
    def count_impulse(self, group, term: Template, impulse, v):
        """Add impulse [N s] and work v . impulse [J] of a `term` to row `group`; v [m/s]: particle's mean velocity."""
        if ti.static(term not in self.idle):  # as the kernel is compiled; sums of other terms stay zero
            four = ti.Vector([impulse.x, impulse.y, impulse.z, impulse.dot(v)])
            for k in ti.static(range(WORK_COLUMN + 1)):
                self.given[group, term, k] = self.given[group, term, k] + ti.cast(four[k], ti.f64)

    @ti.func
    def count_impulses(self, group, terms: Template, kick, accelerations: Template, v):
        """Add to row `group` the impulses by `terms`, `kick` (mass times dt [kg s]) times each of `accelerations`
        [m/s2], and their works at the particle's mean velocity v [m/s]."""
        for term, a in ti.static(zip(terms, accelerations)):
            self.count_impulse(group, term, kick * a, v)

    @ti.func
    def count_work(self, group, term: Template, work):
        """Add the work [J] of a `term` (its index in TERM_NAMES) without impulse on a particle to row `group`."""
        self.given[group, term, WORK_COLUMN] = self.given[group, term, WORK_COLUMN] + ti.cast(work, ti.f64)

    @ti.func
    def block_extremes(self, begin, end):
        """Return the numbers of `summarise` (extremes, sums, counts) over the rows of groups `begin` to `end` - 1."""
        speed2, acceleration2, thin, dense, total, clipped, crowded = 0.0, 0.0, UNREACHABLE_DENSITY, 0.0, 0.0, 0, 0
        thinner, inner = 0.0, 0.0
        for g in range(begin, end):
            speed2, acceleration2 = ti.max(speed2, self.speed2[g, 0]), ti.max(acceleration2, self.acceleration2[g, 0])
            thin, dense = ti.min(thin, self.thin[g, 0]), ti.max(dense, self.dense[g, 0])
            total += self.sum[g, 0] + self.dense[g, 0]
            clipped += self.clipped[g, 0]
            crowded += self.overflow[g, 0]
            thinner, inner = thinner + self.thinner[g, 0], inner + self.inner[g, 0]
        return speed2, acceleration2, thin, dense, total, clipped, crowded, thinner, inner

    @ti.func
    def summarise(self, summary: Template):
        """Fill `summary` (9,): largest squared speed, squared acceleration; least, largest density; sum of squared
        speeds and groups' largest densities (finite if all are); number of particles slowed by `motion_limit`, of cells
        with overfull neighbour lists; sum of `thinner` in `count_packing` and number of its particles."""
        ti.loop_config(serialize=True)
        for _ in range(1):
            for k, number in ti.static(enumerate(self.block_extremes(0, self.groups))):
                summary[k] = number

    def status(self, summary: np.ndarray, grid: Grid) -> Status:
        """Status (extremes of speed, density) by `summary` (summarise); raise Diverged if neighbour lists overflow."""
        speed2, acceleration2, thin, dense, total, clipped, crowded, thinner, inner = summary.tolist()
        if crowded:
            x, y, z = grid.fullest_place()
            opening = f"{int(crowded)} cells have more neighbours than their lists hold: the water is packed"
            middle = f"up to {dense:.0f} kg/m3, most of all around ({x:.4g}, {y:.4g}, {z:.4g}) m; try a smaller"
            raise Diverged(f"{opening} {middle} compression (stiffer water), a smaller time step or more viscosity")
        speed, acceleration, swelling = speed2**0.5, acceleration2**0.5, thinner / max(inner, 1.0)
        return Status(speed, acceleration, thin, dense, int(clipped), isfinite(total), swelling, int(inner))

    @ti.kernel
    def copy_sums(self, to: Doubles3):
        """Copy impulse and work (4) of each group of particles (a thread's) and term to `to` (groups, terms, 4)."""
        ti.loop_config(serialize=ti.static(runs_alone()))
        for group, term, k in self.given:
            to[group, term, k] = self.given[group, term, k]

    def totals(self) -> dict[str, np.ndarray]:
        """Impulse x, y, z [N s] and work [J] since the start, (4,), by name of the force term; empty if not summed."""
        if not self.impulses:
            return {}
        self.copy_sums(self.sums_copy)
        total = self.sums_copy.sum(axis=0)
        return {TERM_NAMES[term]: total[term] for term in self.terms}


@in_kernels
class Summing:
    """Adder of Totals over all particles in float64, in SUM_BLOCKS blocks: the same sums on any number of threads."""

    def __init__(self, particles: Particles) -> None:
        self.particles = particles
        self.table = np.zeros((SUM_BLOCKS, SUM_COLUMNS.size + MAX_COLUMNS.size))

    def totals(self) -> Totals:
        """Sums of density, position, velocity and more (Totals) over all particles now, and their bounding box."""
        self.add_up(self.table)
        with np.errstate(invalid="ignore"):  # infinite both ways is NaN
            total, most = self.table[:, : SUM_COLUMNS.size].sum(axis=0), self.table[:, SUM_COLUMNS.size :].max(axis=0)
        return Totals(
            density=float(total[SUM_COLUMNS.density]),
            compression=float(total[SUM_COLUMNS.compression]),
            most_compressed=float(most[MAX_COLUMNS.compression]),
            deficit=float(total[SUM_COLUMNS.deficit]),
            squared_speed=float(total[SUM_COLUMNS.squared_speed]),
            position=total[SUM_COLUMNS.position : SUM_COLUMNS.velocity],
            velocity=total[SUM_COLUMNS.velocity : SUM_COLUMNS.turning],
            turning=total[SUM_COLUMNS.turning :],
            lower=-most[MAX_COLUMNS.low : MAX_COLUMNS.high],
            upper=most[MAX_COLUMNS.high :],
        )

    @ti.kernel
    def add_up(self, table: Doubles2):
        """Fill the table (a row for each block of particles) with sums (SUM_COLUMNS) and maxima (MAX_COLUMNS)."""
        for b in range(SUM_BLOCKS * TASK_ITERATIONS):
            if b % TASK_ITERATIONS == 0:
                self.add_block(b // TASK_ITERATIONS, table)

    @ti.func
    def add_block(self, block, table: Template):
        """Write sums (SUM_COLUMNS) and maxima (MAX_COLUMNS) over one block of particles to its row of the table."""
        n = self.particles.count.there()
        total, compressed = ti.Vector.zero(ti.f64, SUM_COLUMNS.size), ti.cast(0.0, ti.f64)
        low, high = tm.vec3(FAR_COORDINATE), tm.vec3(-FAR_COORDINATE)
        each = (n + SUM_BLOCKS - 1) // SUM_BLOCKS
        for i in range(block * each, ti.min((block + 1) * each, n)):
            x, v = self.particles.position.at(i), self.particles.velocity.at(i)
            low, high = tm.min(low, x), tm.max(high, x)
            at = ti.Vector([ti.cast(x[k], ti.f64) for k in ti.static(range(3))])
            way = ti.Vector([ti.cast(v[k], ti.f64) for k in ti.static(range(3))])
            density = ti.cast(self.particles.density[i], ti.f64)
            excess = density / ti.static(self.particles.rest_density) - 1.0
            compressed = ti.max(compressed, excess)
            total[SUM_COLUMNS.density] += density
            total[SUM_COLUMNS.compression] += ti.max(excess, 0.0)
            total[SUM_COLUMNS.deficit] += ti.max(-excess, 0.0)
            total[SUM_COLUMNS.squared_speed] += way.dot(way)
            turning = at.cross(way)
            for k in ti.static(range(3)):
                total[SUM_COLUMNS.position + k] += at[k]
                total[SUM_COLUMNS.velocity + k] += way[k]
                total[SUM_COLUMNS.turning + k] += turning[k]
        for c in ti.static(range(SUM_COLUMNS.size)):
            table[block, c] = total[c]
        table[block, SUM_COLUMNS.size + MAX_COLUMNS.compression] = compressed
        for k in ti.static(range(3)):
            table[block, SUM_COLUMNS.size + MAX_COLUMNS.low + k] = -low[k]
            table[block, SUM_COLUMNS.size + MAX_COLUMNS.high + k] = high[k]
