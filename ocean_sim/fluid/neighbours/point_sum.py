"""Sums over the water around any point: particles, their repeats beyond periodic sides, their images in flat sides.

The point is mirrored, not the water: an image lies from the point as its particle lies from the mirrored point, turned
round. Every set of sides within reach is a mirror of its own, so corners are mirrored in all of theirs.
"""

from collections.abc import Iterable

from ocean_sim.fluid.neighbours.grid import Grid
from ocean_sim.fluid.neighbours.images import (
    SIDE_COLUMNS,
    identity_mirror,
    join_mirrors,
    mirror_direction,
    mirror_position,
)
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import Template, in_kernels


@in_kernels
class PointSum:
    """Sum over all water within a support of any point. The summand `law` has `sums`, a column count, and ti.func
    `term(own, j, d, mirror)`: `own` is passed on; particle j's image by matrix `mirror` lies d [m] from the point."""

    def __init__(self, position: Iterable[ti.Field], grid: Grid, start: ti.Field | None = None) -> None:
        """Prepare sums over points x, y, z [m] sorted by cell; `start`: first index of each cell (None: grid's)."""
        self.position, self.grid, self.start = tuple(position), grid, grid.start if start is None else start
        self.periods, self.across = grid.basin.periods, grid.basin.periods[0] > 0.0
        self.images = grid.images

    @ti.func
    def total(self, x, law: Template, own):
        """Sum of law.term around x [m] over particles and their mirror images; `own` is handed to law.term."""
        return self.subset_total(0, x, law, own)

    @ti.func
    def image_total(self, x, law: Template, own):
        """Sum of law.term around x [m] over mirror images only; `own` is handed to law.term."""
        return self.subset_total(1, x, law, own)

    @ti.func
    def water_total(self, x, law: Template, own):
        """Sum of law.term around x [m] over particles only, without mirror images; `own` is handed to law.term."""
        return self.mirror_total(self.grid.wrap_position(x), identity_mirror(), law, own)

    @ti.func
    def subset_total(self, first, x, law: Template, own):
        """Sum of law.term around x [m] over all sets of sides in reach (bit k: side k): for each, over images in all
        its sides in turn. `first`: 0 to begin with the empty set (particles), else 1; `own` is handed to law.term."""
        here = self.grid.wrap_position(x)
        reach = self.sides_in_reach(here)
        total = ti.Vector.zero(float, law.sums)
        for subset in range(first, reach + 1):
            if subset & reach == subset:
                total += self.mirror_total(here, self.mirror(subset), law, own)
        return total

    @ti.func
    def mirror(self, subset):
        """Mirror matrix of reflections in succession in all sides whose bits are set in the integer `subset`."""
        mirror = identity_mirror()
        if ti.static(self.images.sides > 0):
            for side in range(self.images.sides):
                if subset >> side & 1:
                    mirror = join_mirrors(mirror, self.images.mirror(side))
        return mirror

    @ti.func
    def sides_in_reach(self, x):
        """Set of the sides, one bit a side, that lie within a support of x [m]."""
        reach = 0
        if ti.static(self.images.sides > 0):
            for side in range(self.images.sides):
                away = x[int(self.images.side[side, SIDE_COLUMNS.axis])] - self.images.side[side, SIDE_COLUMNS.position]
                reach |= int(ti.abs(away) < self.grid.support) << side
        return reach

    @ti.func
    def mirror_total(self, x, mirror, law: Template, own):
        """Sum of law.term over particles whose images by matrix `mirror` lie around x [m]; `own` goes to law.term."""
        grid = self.grid
        px, py, pz = ti.static(self.position[0], self.position[1], self.position[2])
        y = mirror_position(mirror, x)  # flat mirrors at right angles are their own inverse
        home = grid.indices_at(y)
        total = ti.Vector.zero(float, law.sums)
        for row in range(9):
            for part in range(ti.static(3 if self.across else 1)):
                first = tm.ivec3(part - 1, row % 3 - 1, row // 3 - 1)
                there, shift = self.periodic_home(home + first)
                c, middle = grid.cell_at(there), grid.lower + (there - 0.5) / grid.per_width
                for j in range(self.start[c], self.start[c + ti.static(1 if self.across else 3)]):
                    e = self.nearest_repeat(tm.vec3(px[j], py[j], pz[j]), middle) + shift - y
                    total += law.term(own, j, mirror_direction(mirror, e), mirror)
        return total

    @ti.func
    def nearest_repeat(self, x, middle):
        """Periodic repeat of x [m] nearest to the `middle` [m] of its cell, which x may have left since the sort."""
        for k, period in ti.static(enumerate(self.periods)):
            if ti.static(period > 0.0):
                x[k] -= period * ti.round((x[k] - middle[k]) / period)
        return x

    @ti.func
    def periodic_home(self, indices):
        """Indices of the cell in the basin whose periodic repeat is the cell `indices`, and the shift [m] to it."""
        shift = tm.vec3(0.0)
        for k, period in ti.static(enumerate(self.periods)):
            if ti.static(period > 0.0):
                around = int(indices[k] > self.grid.cells[k] - 2) - int(indices[k] < 1)
                indices[k] -= around * (self.grid.cells[k] - 2)
                shift[k] = around * period
        return indices, shift
