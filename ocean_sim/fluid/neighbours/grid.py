"""A uniform grid of cells at least a support wide, and a stable counting sort into cells, of large ones into sub-cells.

Chunks of particles are counted apart and placed in order, so the result depends neither on the number of chunks nor on
that of threads. Particles beyond the grid belong to its border cells. A jet above the grid would crowd these, so it
belongs to the layers over still water, down and up again with its height. Neither moves two particles further apart, so
every pair is within reach of neighbouring cells.

Far from the origin a position in single precision is coarse (4e-6 m at 60 m) and would lose a short way. So particles
move by whole quanta, which positions hold without rounding; the rest of a way is kept for the next step.
"""

import numpy as np

from ocean_sim.columns import Columns
from ocean_sim.fluid.neighbours.grid_size import GridSize
from ocean_sim.fluid.neighbours.images import Images
from ocean_sim.fluid.neighbours.thread_tasks import TASK_ITERATIONS
from ocean_sim.fluid.sph.particles import Components, Particles, staggered_field
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import Template, in_kernels

STATE_COLUMNS = Columns(position=3, velocity=3, id=1)  # what `state` and `moved` begin with


@in_kernels
class Grid:
    """Uniform grid of cells over the basin, and the stable counting sort of particles into them."""

    def __init__(self, particles: Particles, size: GridSize, carried: tuple[ti.Field, ...] = ()) -> None:
        """Make the grid of these particles; `carried`: fields besides their state that the sort moves along."""
        self.size = size
        self.images = Images(size)
        self.support, self.n, self.basin = size.support, particles.n, size.lattice.basin
        self.particles = particles.count
        self.lower, self.per_width = tm.vec3(self.basin.lower), tm.vec3([1.0 / width for _, width in size.inner_cells])
        self.cells, self.cell_count, self.chunks = size.cells, size.cell_count, size.chunks
        self.sky, self.top = size.sky, self.cells[1] - 1  # layers over still water, and where the last of them ends
        self.parts_per_axis, self.parts = size.parts_per_axis, size.parts
        self.quantum = size.quantum(float(np.finfo(particles.position.precision).eps))  # [m]
        self.axes = range(self.basin.dimension)
        self.left = tuple(staggered_field(float, self.n) for _ in self.axes)  # [m] of a particle's way, not yet gone
        self.state = (*particles.position, *particles.velocity, particles.id, *carried, *self.left)
        self.moved = (
            *(*Components(self.n), *Components(self.n), staggered_field(int, self.n)),
            *(staggered_field(float, self.n) for _ in (*carried, *self.left)),
        )
        # Carried numbers on their way to the sort.
        self.carried = self.moved[STATE_COLUMNS.size : STATE_COLUMNS.size + len(carried)]
        self.part = staggered_field(int, self.n)  # of which cell: its number times `parts`, and more
        self.count = ti.field(int, shape=size.count_numbers)
        self.start = ti.field(int, shape=self.cell_count + 1)
        self.occupied = ti.field(int, shape=size.occupied)  # cells of the parts in which there are particles
        self.first = ti.field(int, shape=size.occupied + 1)  # particle of each of these
        self.occupied_count = ti.field(int, shape=())

    def fullest_place(self) -> np.ndarray:
        """Mean position (3,) [m] of the particles in the cell with most of them, for an error message."""
        start = self.start.to_numpy()
        c = int(np.argmax(np.diff(start)))
        axes = self.state[: STATE_COLUMNS.velocity]
        return np.array([axis.to_numpy()[start[c] : start[c + 1]].mean() for axis in axes])

    @ti.func
    def indices_at(self, x):
        """Indices along x, y, z of the cell that holds x [m]; padding cells count."""
        return self.cell_of(self.cell_coordinates(x))

    @ti.func
    def cell_coordinates(self, x):
        """Position x [m] in cell widths from the corner of the grid, whose outermost cells stay empty. Heights above
        the grid fold down and up again through its `sky` top layers, so that a high jet crowds no cell."""
        place = (x - self.lower) * self.per_width + 1.0
        above = place.y - self.top
        if above > 0.0:
            along = above - 2.0 * self.sky * ti.floor(above / (2.0 * self.sky))
            place.y = self.top - (self.sky - ti.abs(along - self.sky))
        return place

    @ti.func
    def cell_of(self, place):
        """Indices of the cell that holds `place` [cell widths]; beyond the grid, of the nearest border cell."""
        return tm.clamp(ti.cast(place, int), 1, tm.ivec3(self.cells) - 2)

    @ti.func
    def part_at(self, x):
        """Number of the sub-cell that holds x [m]: the cell's number times `parts`, plus the number within the cell."""
        place = self.cell_coordinates(x)
        indices = self.cell_of(place)
        part = self.cell_at(indices)
        if ti.static(self.parts > 1):
            within = place - ti.cast(indices, float)  # 0 to 1, but beyond the grid
            for k in ti.static(self.axes):
                own = tm.clamp(ti.cast(self.parts_per_axis * within[k], int), 0, self.parts_per_axis - 1)
                part = self.parts_per_axis * part + own
        return part

    @ti.func
    def first_part(self, group):
        """Index of a task's first sub-cell among occupied ones; their number if `group` is the number of tasks."""
        return group * self.occupied_count[None] // ti.static(self.size.groups)

    @ti.func
    def cell_at(self, indices):
        """Number of the cell with these indices along x, y, z."""
        return (indices.z * self.cells[1] + indices.y) * self.cells[0] + indices.x

    @ti.func
    def indices_of(self, c):
        """Indices of cell c: the inverse of cell_at."""
        nx, ny = ti.static(self.cells[0], self.cells[1])
        return tm.ivec3(c % nx, c // nx % ny, c // (nx * ny))

    @ti.func
    def at_rim(self, indices, layers: Template):
        """True if the cell with these indices lies in the outermost `layers` at any side of the grid."""
        return (indices <= layers).any() or (indices >= tm.ivec3(self.cells) - 1 - layers).any()

    @ti.func
    def wrap_position(self, x):
        """Position x [m] moved by whole periods into the basin along periodic axes."""
        for k, period in ti.static(enumerate(self.basin.periods)):
            if ti.static(period > 0.0):
                x[k] -= period * ti.floor((x[k] - self.lower[k]) / period)
        return x

    @ti.func
    def stage_state(self, i, x, v):
        """Store the next position x [m], velocity v [m/s] and sub-cell (sort key) of particle i for the next sort."""
        x = self.wrap_position(x)
        self.part[i] = self.part_at(x)
        self.stage_motion(i, x, v)
        for moved, state in ti.static(zip(self.moved[STATE_COLUMNS.id :], self.state[STATE_COLUMNS.id :])):
            moved[i] = state[i]

    @ti.func
    def stage_motion(self, i, x, v):
        """Store the next position x [m] and velocity v [m/s] of particle i, but not the cell by which it is sorted."""
        for k in ti.static(range(3)):
            self.moved[STATE_COLUMNS.position + k][i], self.moved[STATE_COLUMNS.velocity + k][i] = x[k], v[k]

    @ti.func
    def whole_quanta(self, i, way):
        """Return `way` [m] of particle i plus its stored rest, in whole multiples of `quantum`; store the new rest."""
        now = tm.vec3(0.0)
        for k in ti.static(self.axes):
            whole = way[k] + self.left[k][i]
            now[k] = self.quantum * ti.floor(whole / self.quantum + 0.5)
            self.left[k][i] = whole - now[k]
        return now

    @ti.func
    def sort(self):
        """Sort staged states (stage_state) by cell, stably by counting, into particles' fields; at a kernel's top."""
        if ti.static(self.chunks == 1):
            ti.loop_config(serialize=True)
            for _ in range(1):
                self.count_chunk(0)
                self.scan_counts()
                self.place_chunk(0)
        else:
            for b in range(self.chunks * TASK_ITERATIONS):
                if b % TASK_ITERATIONS == 0:
                    self.count_chunk(b // TASK_ITERATIONS)
            ti.loop_config(serialize=True)
            for _ in range(1):
                self.scan_counts()
            for b in range(self.chunks * TASK_ITERATIONS):
                if b % TASK_ITERATIONS == 0:
                    self.place_chunk(b // TASK_ITERATIONS)

    @ti.func
    def count_chunk(self, b):
        """Count, in `count`, the particles of chunk b (a run of particles in storage order) in each sub-cell."""
        first = b * self.cell_count * self.parts
        for c in range(self.cell_count * self.parts):
            self.count[first + c] = 0
        n = self.particles.there()
        for i in range(b * n // self.chunks, (b + 1) * n // self.chunks):
            k = first + self.part[i]
            self.count[k] = self.count[k] + 1

    @ti.func
    def scan_counts(self):
        """Turn counts by sub-cell and chunk (particle run) to first indices (prefix sum); list occupied sub-cells."""
        total, occupied = 0, 0
        for c in range(self.cell_count):
            self.start[c] = total
            for part in range(c * self.parts, (c + 1) * self.parts):
                first = total
                for b in range(self.chunks):
                    k = b * self.cell_count * self.parts + part
                    here = self.count[k]
                    self.count[k] = total
                    total += here
                if total > first:
                    self.occupied[occupied], self.first[occupied] = c, first
                    occupied += 1
        self.start[self.cell_count] = self.first[occupied] = total
        self.occupied_count[None] = occupied

    @ti.func
    def place_chunk(self, b):
        """Move next states of chunk b (a run of particles) to sorted places; `count` has each sub-cell's next one."""
        n = self.particles.there()
        for i in range(b * n // self.chunks, (b + 1) * n // self.chunks):
            k = b * self.cell_count * self.parts + self.part[i]
            to = self.count[k]
            self.count[k] = to + 1
            for moved, state in ti.static(zip(self.moved, self.state)):
                state[to] = moved[i]
