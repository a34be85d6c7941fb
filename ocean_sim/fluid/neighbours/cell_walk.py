"""The walk over neighbours for processors.

The unit of work is a cell, a support wide, or a sub-cell of a large one. Its candidates are the particles within one
support of the bounding box of its own particles. They are found once a step and kept. A pair law is then summed over
them in one long loop without branches. Sums are gathered and never scattered, so the number of threads changes no sum.
"""

from ocean_sim.columns import vec3
from ocean_sim.fluid.bodies.emitter import MOST_PARTICLES
from ocean_sim.fluid.budget.momentum_budget import Accounts
from ocean_sim.fluid.neighbours.grid import Grid
from ocean_sim.fluid.neighbours.grid_size import FILLER_X, VECTOR_LENGTH, GridSize
from ocean_sim.fluid.neighbours.images import mirror_position
from ocean_sim.fluid.neighbours.kept_pairs import KeptPairs, PairBlocks, flip_code
from ocean_sim.fluid.neighbours.thread_tasks import TASK_ITERATIONS, Tasks
from ocean_sim.fluid.sph.law import NO_COLUMN
from ocean_sim.fluid.sph.particles import Particles, staggered_field
from ocean_sim.fluid.sph.smoothing import Smoothing, positive
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import Template, in_kernels

UNSHIFTED_CODE = 13  # code of what is seen where it is, through no periodic side


@in_kernels
class CellWalk:
    """Neighbour walk for processors. For each sub-cell (GridSize.parts) it lists candidates (possible neighbours),
    copies their fields to the scratch (a column for each field), and sums pair laws over them."""

    def __init__(self, particles: Particles, grid: Grid, accounts: Accounts, size: GridSize) -> None:
        self.position, self.grid, self.accounts = particles.position, grid, accounts
        self.groups, self.capacity, self.segment = size.groups, size.capacity, size.segment
        self.width = size.width
        self.images = grid.images
        self.periods, self.periodic = tm.vec3(grid.basin.periods), any(grid.basin.periods)
        self.candidates = ti.field(int, shape=size.occupied)
        self.candidate = ti.field(int, shape=self.groups * self.segment)
        self.scratch = tuple(staggered_field(float, self.groups * self.width) for _ in range(size.reads))
        self.size, self.keeps = size, False  # whether pairs are kept

    def keep_pairs(self, smoothing: Smoothing, neighbours: int, tasks: Tasks) -> KeptPairs:
        """Make the store of pairs that `walk` with `find` fills; `neighbours`, `tasks`: for ParticleWalk alone."""
        self.keeps, self.blocks = True, PairBlocks(self.position, self.grid, self.scratch, smoothing, self.size)
        self.name = ti.field(int, shape=self.groups * self.width)
        return self.blocks

    @ti.func
    def part_bounds(self, k):
        """Centre and half sides [m] of the box around the particles of sub-cell k (numbered among occupied ones)."""
        x, y, z = ti.static(self.position.x, self.position.y, self.position.z)
        first = self.grid.first[k]
        lo = tm.vec3(x[first], y[first], z[first])  # outside all loops, without which those of `list_near` are slow
        up = lo
        for i in range(first + 1, self.grid.first[k + 1]):
            lo, up = tm.min(lo, tm.vec3(x[i], y[i], z[i])), tm.max(up, tm.vec3(x[i], y[i], z[i]))
        return 0.5 * (lo + up), 0.5 * (up - lo)

    @ti.func
    def is_near(self, x, middle, half):
        """1 if x [m] lies within one support of the box with centre `middle` and half sides `half` [m], else 0."""
        squared = 0.0
        for k in ti.static(self.grid.axes):
            away = positive(ti.abs(x[k] - middle[k]) - half[k])
            squared += away * away
        return int(squared < self.grid.support * self.grid.support)

    @ti.func
    def list_near(self, begin, end, code, shift, middle, half, first):
        """List in `candidate`, from `first` on, those of particles `begin` to `end` - 1 that, moved by `shift` [m], lie
        near a box (centre `middle`, `half` sides [m]), each as index + `code` of the shift; return their number."""
        x, y, z = ti.static(self.position.x, self.position.y, self.position.z)
        for a in range(end - begin):
            at = begin + a
            self.candidate[first + a] = self.is_near(tm.vec3(x[at], y[at], z[at]) + shift, middle, half)
        return self.compact(self.candidate, first, end - begin, begin + code)

    @ti.func
    def compact(self, names: Template, first, n, name):
        """Turn n marks (0 or 1) in the field `names`, from index `first` on, into a list there of the marked: a mark of
        1 at `first` + a becomes an entry `name` + a. Return the number of entries."""
        kept = 0
        for a in range(n):
            marked = names[first + a]
            names[first + kept] = name + a
            kept += marked
        return kept

    @ti.func
    def find_candidates(self, c, code, middle, half, first, room):
        """List in `candidate`, from `first` on, the particles in and around cell c near a box (centre `middle`, `half`
        sides [m]), each as index + `code` (for no periodic shift); return their number, -1 if above `room`."""
        grid = self.grid
        m, full = 0, 0
        for dz in range(-1, 2):
            for dy in range(-1, 2):
                row = c + (dz * grid.cells[1] + dy) * grid.cells[0]
                begin, end = grid.start[row - 1], grid.start[row + 2]
                if m + end - begin > room:
                    full = 1
                    end = begin
                m += self.list_near(begin, end, code, tm.vec3(0.0), middle, half, first + m)
        return ti.select(full == 1, -1, m)

    @ti.func
    def find_periodic_candidates(self, indices, middle, half, first, room):
        """List in `candidate`, from `first` on, the particles in and around the cell with these `indices`, beside a
        periodic side, near a box (centre `middle`, `half` sides [m]), each as index + MOST_PARTICLES times the code of
        its repeat there (`code_shift`); return their number, -1 if above `room` entries."""
        grid = self.grid
        m, full = 0, 0
        for d in range(27):
            there, code = indices + tm.ivec3(d % 3, d // 3 % 3, d // 9) - 1, UNSHIFTED_CODE
            for k, period in ti.static(enumerate(self.grid.basin.periods)):
                if ti.static(period > 0.0):
                    around = int(there[k] > grid.cells[k] - 2) - int(there[k] < 1)
                    there[k] -= around * (grid.cells[k] - 2)
                    code += around * 3**k
            c, shift = grid.cell_at(there), self.code_shift(code)
            begin, end = grid.start[c], grid.start[c + 1]
            if m + end - begin > room:
                full = 1
                end = begin
            m += self.list_near(begin, end, code * MOST_PARTICLES, shift, middle, half, first + m)
        return ti.select(full == 1, -1, m)

    @ti.func
    def is_interior(self, c):
        """True if all neighbour cells of cell c lie in the basin, none beyond a periodic side."""
        indices, inside = self.grid.indices_of(c), True
        for k in ti.static(range(3)):
            if ti.static(self.grid.basin.periods[k] > 0.0):
                inside = inside and indices[k] > 1 and indices[k] < self.grid.cells[k] - 2
        return inside

    @ti.func
    def code_shift(self, code):
        """Shift [m] from a particle to its periodic repeat, by its code: three base-3 digits, 13 for no shift."""
        return self.periods * (tm.ivec3(code % 3, code // 3 % 3, code // 9) - 1)

    @ti.func
    def find_images(self, mirror, middle, half, scratch, n, gap, m, first):
        """List in `candidate`, from `first` on, those of m candidates whose image by matrix `mirror` lies near a box
        (centre `middle`, `half` sides [m]), by number (0 to m - 1); return how many. The scratch holds the candidates:
        from entry `scratch` on n particles, `gap` dummies (fillers), m - n images in sides mirrored before."""
        x, y, z = ti.static(self.scratch[0], self.scratch[1], self.scratch[2])
        for a in range(m):
            at = scratch + a + ti.select(a < n, 0, gap)
            seen = mirror_position(mirror, tm.vec3(x[at], y[at], z[at]))
            self.candidate[first + a] = self.is_near(seen, middle, half)
        return self.compact(self.candidate, first, m, 0)

    @ti.func
    def walk(self, law: Template, find: Template):
        """Sum law.pair over the candidates (possible neighbours) of each particle, mirror images included, then call
        law.finish; call it at a kernel's top level. `find`: True to list candidates anew by the positions in law.reads,
        False to reuse the lists. Images are summed by themselves if law.options.apart."""
        for g in range(self.groups * TASK_ITERATIONS):
            if g % TASK_ITERATIONS == 0:
                self.walk_group(g // TASK_ITERATIONS, law, find)

    @ti.func
    def walk_group(self, group, law: Template, find: Template):
        """Sum the pair `law` over the neighbours of each particle of a task (`group` of sub-cells), and call
        law.finish; `find`: True to list candidates (possible neighbours) anew, False to reuse the lists."""
        kept = group * self.segment  # where the list of the next part begins
        if ti.static(find):
            self.accounts.overflow[group, 0] = 0
            if ti.static(self.keeps):
                self.blocks.begin(group)
        law.begin(group)
        for k in range(self.grid.first_part(group), self.grid.first_part(group + 1)):
            room = ti.min(self.capacity, (group + 1) * self.segment - kept - self.images.sides)
            middle, half = tm.vec3(0.0), tm.vec3(0.0)
            if ti.static(find):
                middle, half = self.part_bounds(k)
                self.list_candidates(k, middle, half, group, kept, room)
            n = self.gather_part(k, law, find, group, kept)
            m, end = self.append_images(k, law, find, middle, half, group, n, kept + n, room)
            self.sum_up(k, law, find, group, n, m)
            kept = end

    @ti.func
    def list_candidates(self, k, middle, half, group, first, room):
        """List in `candidate`, from `first` on, the candidates (possible neighbours) of sub-cell k, near its box
        (centre `middle`, `half` sides [m]); if they exceed `room`, record an overflow in the task's row `group`."""
        c = self.grid.occupied[k]
        if ti.static(not self.periodic):
            self.candidates[k] = self.find_candidates(c, 0, middle, half, first, room)
        elif self.is_interior(c):
            self.candidates[k] = self.find_candidates(c, UNSHIFTED_CODE * MOST_PARTICLES, middle, half, first, room)
        else:
            self.candidates[k] = self.find_periodic_candidates(self.grid.indices_of(c), middle, half, first, room)
        if self.candidates[k] < 0:
            self.candidates[k] = 0
            self.accounts.overflow[group, 0] = self.accounts.overflow[group, 0] + 1

    @ti.func
    def gather_part(self, k, law: Template, find: Template, group, first):
        """Copy the fields law.reads of the candidates of sub-cell k, listed in `candidate` from `first` on, to the
        scratch of task `group`, and their indices if `find`; return their number."""
        scratch, n = group * self.width, self.candidates[k]
        if ti.static(not self.periodic):
            self.gather_unshifted(law, find, scratch, first, n, 0)
        elif self.is_interior(self.grid.occupied[k]):
            self.gather_unshifted(law, find, scratch, first, n, UNSHIFTED_CODE * MOST_PARTICLES)
        else:
            for a in range(n):
                j = self.candidate[first + a]
                shift = self.code_shift(j // MOST_PARTICLES)
                j = j % MOST_PARTICLES
                if ti.static(find and self.keeps):
                    self.name[scratch + a] = j
                for t, field in ti.static(enumerate(law.reads)):
                    self.scratch[t][scratch + a] = field[j] + (shift[t] if ti.static(t < 3) else 0.0)
        return n

    @ti.func
    def gather_unshifted(self, law: Template, find: Template, scratch, first, n, code):
        """Copy the fields law.reads of n candidates, listed from `first` on as index + `code` and not shifted
        periodically, to the scratch from entry `scratch` on; their indices too if `find`."""
        for a in range(n):
            j = self.candidate[first + a] - code
            if ti.static(find and self.keeps):
                self.name[scratch + a] = j
            for t, field in ti.static(enumerate(law.reads)):
                self.scratch[t][scratch + a] = field[j]

    @ti.func
    def append_images(self, k, law: Template, find: Template, middle, half, group, n, entry, room):
        """Append images of sub-cell k's n candidates in flat sides to the scratch of task `group`, if its list has
        `room`. Return n + their number, and the end of their list in `candidate`: from `entry` on, for each side, how
        many, and which. `find`: True to list those near a box (centre `middle`, `half` sides [m]), else reuse it."""
        scratch, last, m, gap = group * self.width, (group + 1) * self.segment, n, self.image_gap(law, n)
        if ti.static(self.images.sides > 0):
            indices = self.grid.indices_of(self.grid.occupied[k])
            if room > 0 and self.grid.at_rim(indices, self.images.deepest):
                for side in range(self.images.sides):
                    if self.images.is_adjacent(side, indices):
                        mirror = self.images.mirror(side)
                        if ti.static(find):
                            found, fits = 0, entry + 1 + m + self.images.sides <= last
                            if fits:
                                found = self.find_images(mirror, middle, half, scratch, n, gap, m, entry + 1)
                                fits = m + found <= self.capacity
                            if not fits:
                                found = 0
                                self.accounts.overflow[group, 0] = self.accounts.overflow[group, 0] + 1
                            self.candidate[entry] = found
                        run = self.candidate[entry]
                        self.add_images(law, find, mirror, scratch, n, gap, m, entry + 1, run)
                        m, entry = m + run, entry + 1 + run
        return m, entry

    @ti.func
    def add_images(self, law: Template, find: Template, mirror, scratch, n, gap, m, first, run):
        """Append to the scratch images by matrix `mirror` of the `run` candidates whose numbers `candidate` lists from
        `first` on. From entry `scratch` on it holds m candidates: n particles, `gap` dummies (fillers), m - n earlier
        images. `find`: True to name the images, too, if pairs are kept."""
        for b in range(run):
            a, to = self.candidate[first + b], scratch + gap + m + b
            a += scratch + ti.select(a < n, 0, gap)
            if ti.static(find and self.keeps):
                self.name[to] = self.name[a] ^ flip_code(mirror)
            other = ti.Vector([self.scratch[t][a] for t in ti.static(range(law.row.size))])
            image = law.image(other, mirror)
            for t in ti.static(range(law.row.size)):
                self.scratch[t][to] = image[t]

    @ti.func
    def padded_count(self, law: Template, count):
        """Number of entries summed for `count` candidates: filled up to whole vectors if the law is `padded`, as a
        remainder would be summed one by one, with four times the instructions each."""
        whole = (count + VECTOR_LENGTH - 1) // VECTOR_LENGTH * VECTOR_LENGTH
        return whole if ti.static(law.options.padded) else count

    @ti.func
    def image_gap(self, law: Template, n):
        """Number of dummies (vector fillers) between n candidates and their images; 0 if `law` sums both together."""
        return self.padded_count(law, n) - n if ti.static(law.options.apart) else 0

    @ti.func
    def fill_up(self, law: Template, scratch, begin, end):
        """Fill scratch entries `begin` to `end` - 1 with dummies, particles out of reach, which add nothing to sums."""
        for a in range(begin, end):
            for t in ti.static(range(law.row.size)):
                self.scratch[t][a] = FILLER_X if ti.static(t == law.row.position) else self.scratch[t][scratch]

    @ti.func
    def has_tension(self, column: Template, begin, end):
        """1 if scratch field `column` (candidates' pressures) is negative in an entry `begin` to `end` - 1, else 0."""
        least = 0.0
        for a in range(begin, end):
            least = ti.min(least, column[a])
        return int(least < 0.0)

    @ti.func
    def candidate_sums(self, law: Template, pair: Template, own, begin, middle, end, find: Template, to):
        """Sums of `pair` (a ti.func of `law`) for a particle of values `own`: over candidates in scratch entries
        `begin` to `middle` - 1, and, if law.options.apart, over images in `middle` to `end` - 1. With `find`, grad W
        over the distance vector of each pair kept is stored in PairBlocks.shape from index `to` on."""
        total, beyond = ti.Vector.zero(float, law.terms.size), ti.Vector.zero(float, law.terms.size)
        for a in range(begin, middle):
            total += self.candidate_term(law, pair, own, a, find, to + a - begin)
        if ti.static(law.options.apart):
            for a in range(middle, end):
                beyond += self.candidate_term(law, pair, own, a, find, to + a - begin)
        return total, beyond

    @ti.func
    def candidate_term(self, law: Template, pair: Template, own, a, find: Template, to):
        """Value of `pair` (a ti.func of `law`) for field values `own` of a particle and the candidate in scratch entry
        a; with `find`, grad W over the distance vector of a pair kept is stored in PairBlocks.shape at index `to`."""
        other = ti.Vector([self.scratch[t][a] for t in ti.static(range(law.row.size))])
        if ti.static(find and self.keeps):
            self.blocks.keep_shape(vec3(own, law.row.position) - vec3(other, law.row.position), to)
        return pair(own, other)

    @ti.func
    def sum_up(self, k, law: Template, find: Template, group, n, m):
        """Sum `law` for each particle of sub-cell k over n candidates and m - n mirror images in the scratch of task
        `group`, and call law.finish; `find`: also keep the pairs, if pairs are kept."""
        # Layout of the scratch: particles up to `images`, then their images up to `end`, each filled up if padded.
        scratch = group * self.width
        images, end = scratch + n + self.image_gap(law, n), scratch + self.padded_count(law, m)
        middle = end
        if ti.static(law.options.apart):
            middle, end = images, images + self.padded_count(law, m - n)
        if ti.static(law.options.padded):
            self.fill_up(law, scratch, scratch + n, images)
            self.fill_up(law, scratch, images + m - n, end)
        column = ti.static(law.options.tension_column)
        tense = self.has_tension(self.scratch[column], scratch, end) if ti.static(column != NO_COLUMN) else 1
        # Kept pairs: reserve room for the shapes of this part before its particles are summed.
        to, further = 0, 0  # where the shapes of a particle's pairs go, and how far from there those of the next
        if ti.static(find and self.keeps):
            ti.static_assert(law.options.apart and law.options.padded, "pairs are kept of whole vectors")
            to, further, room = self.blocks.keep_part(k, group, self.name, n, images, m, end)
            self.accounts.overflow[group, 0] = self.accounts.overflow[group, 0] + 1 - room
        for i in range(self.grid.first[k], self.grid.first[k + 1]):
            own = ti.Vector([field[i] for field in ti.static(law.reads)])
            total, beyond = ti.Vector.zero(float, law.terms.size), ti.Vector.zero(float, law.terms.size)
            if tense == 1:
                total, beyond = self.candidate_sums(law, law.pair, own, scratch, middle, end, find, to)
            elif ti.static(law.options.tension_column != NO_COLUMN):
                pair = ti.static(law.options.pair_without_tension)
                total, beyond = self.candidate_sums(law, pair, own, scratch, middle, end, find, to)
            law.finish(i, own, total, beyond, group)
            to += further
