"""Division of a kernel's particles, or other items, into tasks.

On a processor threads share few tasks, each long. Taichi divides a parallel loop into tasks of at least TASK_ITERATIONS
iterations, so a plain loop over 16 or 64 items would run on one thread. Therefore a loop runs over TASK_ITERATIONS
times the tasks, and one iteration in TASK_ITERATIONS does the work of a task:

    for g in range(tasks * TASK_ITERATIONS):
        if g % TASK_ITERATIONS == 0:
            work(g // TASK_ITERATIONS)

On a graphics card each iteration is a thread, and each particle a task. Only one thread writes to the scratch and the
sums of a task, so results depend neither on the number of threads nor on their order. The sums of different tasks lie
ROW_PADDING numbers apart, since threads that write to the same line of a processor's cache wait for each other.
"""

from math import isqrt

from ocean_sim.fluid.sph.particles import Count
from ocean_sim.kernel_library import ti
from ocean_sim.runtime import Template, in_kernels

TASK_ITERATIONS = 512
ROW_PADDING = 32  # two lines of a cache
MAX_SEQUENTIAL_ROWS = 64  # rows that are summed one after the other; more are first summed in blocks


@in_kernels
class Tasks:
    """Division of particles, in storage order, into groups of equal size, each the task of one thread."""

    def __init__(self, particles: Count, groups: int, stride: int) -> None:
        """Divide the particles into `groups`; `stride`: iterations of a parallel loop for each group."""
        self.particles, self.groups, self.stride = particles, groups, stride
        self.iterations = groups * stride
        self.single = groups == particles.most

    @ti.func
    def first_particle(self, group):
        """Index of the first particle of task `group`; for `group` = number of tasks, the number of all particles."""
        n = self.particles.there()
        first = ti.min(group, n)
        if ti.static(not self.single):
            first = group * n // self.groups
        return first


@in_kernels
class Rows:
    """Table of numbers with a row for each task; column sums do not depend on the threads."""

    def __init__(self, count: int, columns: int) -> None:
        self.columns = columns
        self.rows = ti.field(float, shape=(count, columns + (ROW_PADDING if count <= MAX_SEQUENTIAL_ROWS else 0)))
        self.block = isqrt(count) if count > MAX_SEQUENTIAL_ROWS else 1
        self.last = self.rows
        if self.block > 1:
            self.last = ti.field(float, shape=(-(-count // self.block), columns))

    @ti.func
    def add(self, row, column: Template, number):
        self.rows[row, column] = self.rows[row, column] + number

    @ti.func
    def clear(self, row):
        for k in ti.static(range(self.columns)):
            self.rows[row, k] = 0.0

    @ti.func
    def sum_into(self, sums: Template):
        """Write the sum of each column over all tasks to the array `sums`; call it at a kernel's top level."""
        if ti.static(self.block > 1):
            for b in range(self.last.shape[0]):
                for k in ti.static(range(self.columns)):
                    total = 0.0
                    for row in range(b * self.block, ti.min((b + 1) * self.block, self.rows.shape[0])):
                        total += self.rows[row, k]
                    self.last[b, k] = total
        for k in ti.static(range(self.columns)):
            sums[k] = 0.0
        ti.loop_config(serialize=True)
        for b in range(self.last.shape[0]):
            for k in ti.static(range(self.columns)):
                sums[k] += self.last[b, k]
