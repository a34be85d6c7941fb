"""Who is near whom: the walk over neighbours, written once.

The unit of work is a cell, as wide as the support: the particles within one support of the bounding box of its
particles are its candidates, found once a step and kept; a pair law is then summed over them in one long loop without
branches. Everything is gathered, nothing is scattered, so the result does not depend on the number of threads.
"""

from dataclasses import dataclass

import taichi as ti
import taichi.math as tm

from ocean_sim.basin import OPEN
from ocean_sim.fluid._grid import Grid, GridSize
from ocean_sim.fluid._images import INDEX, Images
from ocean_sim.fluid._ledger import GROUPS, Ledger
from ocean_sim.fluid._particles import Particles
from ocean_sim.fluid._smoothing import positive


@dataclass(frozen=True)
class ListSize:
    """How long the candidate lists are, known before anything is allocated."""

    grid: GridSize
    reads: int  # the most fields that a pair law of this fluid reads of a neighbour

    @property
    def at_rest(self) -> float:
        """Candidates of a full cell in water at rest: a box of three supports (in a slice a square)."""
        return (3.0 * self.grid.support / self.grid.lattice.spacing) ** self.grid.lattice.basin.dimension

    @property
    def capacity(self) -> int:
        """Candidates that one cell may have: water compressed four times, and a good deal for splashes."""
        return int(4.0 * self.at_rest) + 256

    @property
    def segment(self) -> int:
        """Candidates that one group of cells may have: twice those of water at rest, whose cells are full."""
        full = (self.grid.support / self.grid.lattice.spacing) ** self.grid.lattice.basin.dimension
        return int(2.0 * self.grid.lattice.n / GROUPS * self.at_rest / full) + 4 * self.capacity

    def bytes(self, word: int) -> int:
        """Of lists and scratch, where `word` is the size of a `float` [bytes]."""
        return 4 * (2 * self.grid.occupied + GROUPS * self.segment) + word * GROUPS * self.capacity * self.reads


@ti.data_oriented
class Neighbours:
    """The candidates of every occupied cell, in segments of one list, one a group of cells."""

    def __init__(self, particles: Particles, grid: Grid, ledger: Ledger, size: ListSize) -> None:
        self.position, self.grid, self.ledger = particles.position, grid, ledger
        self.capacity, self.segment = size.capacity, size.segment
        self.images = Images(grid.basin)
        self.particles, self.candidates = (ti.field(int, shape=size.grid.occupied) for _ in range(2))
        self.candidate = ti.field(int, shape=GROUPS * self.segment)
        self.scratch = tuple(ti.field(float, shape=GROUPS * self.capacity) for _ in range(size.reads))

    @ti.func
    def find(self, c, first, room):
        """Keep the particles, then the images, within one support of the bounding box of cell c, from `first` on.

        Returns how many particles and how many in all; more than `room` are not kept: the second number is negative.
        """
        grid, images = self.grid, self.images
        x, y, z = ti.static(self.position.x, self.position.y, self.position.z)
        lo, up = tm.vec3(OPEN), tm.vec3(-OPEN)
        for i in range(grid.start[c], grid.start[c + 1]):
            lo, up = tm.min(lo, tm.vec3(x[i], y[i], z[i])), tm.max(up, tm.vec3(x[i], y[i], z[i]))
        m, full = 0, 0
        for dz in range(-1, 2):
            for dy in range(-1, 2):
                row = c + (dz * grid.cells[1] + dy) * grid.cells[0]
                begin, end = grid.start[row - 1], grid.start[row + 2]
                if m + end - begin > room:
                    full = 1
                    end = begin
                for j in range(begin, end):
                    ex = positive(ti.max(lo.x - x[j], x[j] - up.x))
                    ey = positive(ti.max(lo.y - y[j], y[j] - up.y))
                    ez = positive(ti.max(lo.z - z[j], z[j] - up.z))
                    self.candidate[first + m] = j
                    m += int(ex * ex + ey * ey + ez * ez < grid.support * grid.support)
        particles = m
        place = grid.place_of(c)
        low, high = images.beside(place, grid.cells)
        if low.sum() + high.sum() > 0:
            for sz, sy, sx in ti.ndrange((-low.z, high.z + 1), (-low.y, high.y + 1), (-low.x, high.x + 1)):
                sides = tm.ivec3(sx, sy, sz)
                if sides.dot(sides) > 0:
                    sign, offset = images.mirror(sides)
                    reach = 1 - abs(sides)  # along a mirrored axis only the layer of c has images in reach
                    for dz in range(-reach.z, reach.z + 1):
                        for dy in range(-reach.y, reach.y + 1):
                            row = c + (dz * grid.cells[1] + dy) * grid.cells[0]
                            begin, end = grid.start[row - reach.x], grid.start[row + 1 + reach.x]
                            if m + end - begin > room:
                                full = 1
                                end = begin
                            for j in range(begin, end):
                                image = sign * tm.vec3(x[j], y[j], z[j]) + offset
                                away = tm.max(tm.max(lo - image, image - up), 0.0)
                                self.candidate[first + m] = images.entry(j, sides)
                                m += int(away.dot(away) < grid.support * grid.support)
        return tm.ivec2(particles, ti.select(full == 1, -1, m))

    @ti.func
    def walk(self, group, law: ti.template(), find: ti.template()):
        """For every particle i of the group's cells: sum law.pair over its candidates, particles and images apart, then
        law.finish it."""
        grid = self.grid
        scratch = group * self.capacity
        kept, last = group * self.segment, (group + 1) * self.segment
        if ti.static(find):
            self.ledger.overflow[group] = 0
        law.begin(group)
        occupied = grid.occupied_count[None]
        for k in range(group * occupied // GROUPS, (group + 1) * occupied // GROUPS):
            c = grid.occupied[k]
            if ti.static(find):
                found = self.find(c, kept, ti.min(self.capacity, last - kept))
                if found[1] < 0:
                    self.ledger.overflow[group] = self.ledger.overflow[group] + 1
                    found = tm.ivec2(0)
                self.particles[k], self.candidates[k] = found[0], found[1]
            n, m = self.particles[k], self.candidates[k]
            for a in range(n):
                j = self.candidate[kept + a]
                for t, field in ti.static(enumerate(law.reads)):
                    self.scratch[t][scratch + a] = field[j]
            for a in range(n, m):
                entry = self.candidate[kept + a]
                sign, offset = self.images.mirror(self.images.sides(entry))
                image = law.image(ti.Vector([field[entry & INDEX] for field in ti.static(law.reads)]), sign, offset)
                for t in ti.static(range(len(law.reads))):
                    self.scratch[t][scratch + a] = image[t]
            for i in range(grid.start[c], grid.start[c + 1]):
                own = ti.Vector([field[i] for field in ti.static(law.reads)])
                total, beyond = ti.Vector.zero(float, law.sums), ti.Vector.zero(float, law.sums)
                for a in range(scratch, scratch + n):
                    other = ti.Vector([self.scratch[t][a] for t in ti.static(range(len(law.reads)))])
                    total += law.pair(own, other)
                for a in range(scratch + n, scratch + m):
                    other = ti.Vector([self.scratch[t][a] for t in ti.static(range(len(law.reads)))])
                    beyond += law.pair(own, other)
                law.finish(i, own, total, beyond, group)
            kept += m
