"""The surface around the smoothed share of water, by marching cubes (thesis 3.1 and 5.2.1, Algorithms 2 to 4).

Follows the water wherever it goes: crests that break, drops, the bed where it falls dry. Nothing is built until it
is read: the field when a mesh or a height is asked for, the heights from the first kernel on that calls `elevation`.

The share of water around a point is gathered from particles (Algorithm 3): 1 in the water and 0 in the air, poly6 in
shape (2.13). Flat walls and the bed are mirrors and periodic sides repeat the water, so it does not seem to thin out
next to them: the point is mirrored or shifted, not the water.
"""

from math import pi
from typing import TYPE_CHECKING, ClassVar, Literal, Self

import numpy as np

from ocean_sim.basin import OPEN, Basin
from ocean_sim.conventions import Diverged
from ocean_sim.fluid import Fluid, with_particles
from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.model import Faults, quantity
from ocean_sim.parts import LedgerRow, SceneFacts, SurfaceConfig
from ocean_sim.runtime import Template, in_kernels
from ocean_sim.surface import AREA_AND_VOLUME, Mesh, Surface
from ocean_sim.surface.shared.heights import Heights
from ocean_sim.surface.shared.isosurface import MAX_NODES, TASK_ITERATIONS, Counts, Isosurface, Nodes

if TYPE_CHECKING:
    from ocean_sim.fluid import Particles

NODE_SPACINGS, RADIUS_SPACINGS = 0.5, 2.0  # [spacings of the particles] between nodes, and of the radius
MEASURED_COLUMNS = AREA_AND_VOLUME | {
    "surface_ambiguous": "share of the cells with surface whose wet corners are kept apart by choice",
    "surface_outside": "particles above the grid",
}
MAX_RADIUS = 6.0  # [spacings] radius at most: a node then counts 900 particles
ROW_GROUPS = 32  # of rows of nodes, each a task of its own; set here, never by the number of threads
RUN_NODES = 4  # nodes along x that are gathered for at once
AXIS_IMAGES = 5  # of a point on each axis: itself, in either side or a period on, and in both sides or two periods on


class Config(SurfaceConfig):
    """Triangles around the water, from the rows near water of a grid over the whole basin."""

    compared: ClassVar[bool] = True
    fineness: ClassVar[int] = 1
    kind: Literal["marching_cubes"] = "marching_cubes"
    spacing: float | None = quantity("m", None, gt=0.0)
    """Distance between nodes, made a little smaller to fit the basin (the listing's stride); null: half the spacing of
    the particles."""
    radius: float | None = quantity("m", None, gt=0.0)
    """Distance from a node within which a particle counts (the listing's isosurface radius); null: two spacings of the
    particles."""
    isovalue: float | None = quantity("1", None, gt=0.0, lt=1.0)
    """Smoothed share of water at the surface; null: that at the end of flat water."""
    height: float | None = quantity("m", None, gt=0.0)
    """Height of the grid above the still water (the listing's range); null: the depth of the bed."""
    most_nodes: int = quantity("nodes", 2**23, ge=1, le=MAX_NODES)
    """Largest number of nodes near water that are kept at a time; more stop the run."""
    most_triangles: int = quantity("triangles", 4_000_000, ge=1)
    """Largest number of triangles of a mesh; more stop the run."""

    def completed(self, preflight: SceneFacts) -> Self:
        assert preflight.spacing is not None
        found = {
            "spacing": self.spacing or NODE_SPACINGS * preflight.spacing,
            "radius": self.radius or RADIUS_SPACINGS * preflight.spacing,
            "height": self.height or preflight.tank.depth,
        }
        return self.model_copy(update=found)

    def problems(self, preflight: SceneFacts) -> Faults:
        if preflight.tank.dimension == 2:
            yield ("kind",), "marching cubes need a basin with a width; in 2-D use surface: cloth"
        elif preflight.tank.closed:
            yield ("kind",), "a basin without a free surface has none to draw; leave it out"

    def mismatches(self, preflight: SceneFacts) -> Faults:
        apart = preflight.spacing
        assert apart is not None
        if self.radius is not None and not 1.2 * apart <= self.radius <= MAX_RADIUS * apart:
            span = f"{self.radius:g} m must be 1.2 to {MAX_RADIUS:g} spacings of the particles, {apart:.4g} m"
            yield ("radius",), f"{span}: less shows them one by one, more smooths the waves away"
        if (count := self.completed(preflight).count(preflight.tank)) > MAX_NODES:
            yield ("spacing",), f"makes {count:.3g} nodes, more than the {MAX_NODES} there can be"
        fine = self.spacing or NODE_SPACINGS * apart
        if (wet := preflight.particles * (apart / fine) ** 3) > self.most_nodes:
            yield ("most_nodes",), f"{self.most_nodes} is less than the {wet:.3g} or so that the water at rest fills"

    def nodes(self, basin: Basin) -> Nodes:
        """Grid of nodes over the whole basin, up to `height`."""
        assert self.spacing is not None and self.height is not None, "completed() says how fine and how high it is"
        low, up = [*basin.lower], [*basin.upper]
        for side in basin.sides:
            if side.piston is not None:
                retreat = side.piston.path.retreat
                (up if side.upper else low)[side.axis] += retreat if side.upper else -retreat
        up[1] = self.height
        return Nodes(tuple(low), tuple(up), self.spacing)  # type: ignore[arg-type]

    def count(self, basin: Basin) -> float:
        """Approximate number of nodes of the grid, without making it."""
        assert self.spacing is not None and self.height is not None
        extents = np.subtract(basin.upper, basin.lower) + [0.0, self.height - basin.upper[1], 0.0]
        return float(np.prod(extents / self.spacing + 2.0))

    def ledger(self, preflight: SceneFacts) -> list[LedgerRow]:
        completed, word, particles = self.completed(preflight), preflight.word, preflight.particles
        assert completed.radius is not None and preflight.spacing is not None
        nodes = completed.nodes(preflight.tank)
        grid = Isosurface.bytes(nodes, self.most_nodes, word) + word * nodes.inner[0] * nodes.inner[2]
        bins = DensityMap.bytes(particles, nodes, completed.radius, word)
        why, most = f"surface.spacing {nodes.cell:g} m", min(nodes.count, self.most_nodes)
        return [
            LedgerRow("surface", f"at most {most} of {nodes.count} nodes", grid, why),
            LedgerRow("surface", f"{particles} particles in bins", bins, f"surface.radius {completed.radius:g} m"),
        ]

    def build(self, basin: Basin, fluid: Fluid) -> Surface:
        return MarchingCubes(self, basin, with_particles(fluid).particles)


@in_kernels
class MarchingCubes:
    """Surface on which the smoothed share of water is `isovalue`; mesh and column heights are found when read."""

    left_out = ("followed", "read_by_kernel")  # of checkpoints: what this simulation's kernels are compiled for

    def __init__(self, config: Config, basin: Basin, particles: "Particles") -> None:
        assert config.radius is not None
        self.config, self.basin, self.nodes = config, basin, config.nodes(basin)
        self.map = DensityMap(particles, basin, self.nodes, config.radius)
        x, y, z = (period > 0.0 for period in basin.periods)
        self.periodic = (x, y, z)
        self.isovalue = config.isovalue or flat_share(config.radius, particles.spacing)
        self.isosurface = Isosurface(self.nodes, self.periodic, config.most_nodes, dry=-self.isovalue)
        lower, upper = np.array(self.nodes.lower)[[0, 2]], np.array(self.nodes.upper)[[0, 2]]
        columns = (self.nodes.inner[0], self.nodes.inner[2])
        self.heights = Heights(lower, upper, columns, (x, z), inset=0.5)  # highest water of each column
        self.bed, self.top = self.nodes.lower[1], self.nodes.upper[1]
        self.outside = 0  # particles that the grid does not reach, in the field that was built last
        self.moment, self.sampled, self.levelled = 0, -1, -1  # steps taken; those that field and heights show
        self.followed, self.read_by_kernel = False, False  # whether it has seen a step; whether a kernel reads heights
        self.measured = MEASURED_COLUMNS
        self.goes_on = sum(
            1 << 2 * axis + side
            for axis in range(3)
            for side in range(2)
            if self.periodic[axis] or any((s.axis, s.upper) == (axis, bool(side)) for s in basin.sides)
        )

    def follow(self, particles: "Particles", dt: float) -> None:
        """Note that the particles have moved by one step. Heights, now out of date, are recomputed at once if a kernel
        calls `elevation`, and in the first step, which may compile one: that needs heights up to date."""
        self.moment += 1
        if self.read_by_kernel or not self.followed:
            self.update_heights()
        self.followed = True

    def update_field(self) -> None:
        """Recompute the share of water at the nodes if particles have moved since it was last computed."""
        if self.sampled != self.moment:
            self.outside = self.map.sort_particles()
            self.map.mark_rows(self.isosurface.rows)
            self.isosurface.rows.keep_rows()
            self.map.fill_rows(self.isosurface.rows, self.isosurface.value, self.isovalue)
            self.sampled = self.moment

    def update_heights(self) -> None:
        """Recompute the column heights if particles have moved since they were last computed."""
        if self.levelled != self.moment:
            self.update_field()
            self.find_heights()
            self.levelled = self.moment

    def mesh(self) -> Mesh:
        """Closed surface of the water: also along walls and bed."""
        return self.cut_surface(0)[0]

    def free_surface(self) -> Mesh:
        """Surface between water and air alone, open at walls and bed."""
        return self.cut_surface(self.goes_on)[0]

    def measures(self) -> list[float]:
        """Area [m2], volume [m3], share of ambiguous cubes, and number of particles above the grid."""
        mesh, counts = self.cut_surface(self.goes_on)
        return [mesh.area, mesh.volume(self.bed), counts.ambiguous_share, float(self.outside)]

    def cut_surface(self, open_sides: int) -> tuple[Mesh, Counts]:
        """Triangulate the surface and return mesh and counts. `open_sides`: bits of the sides at which it stays open
        (see `Isosurface.pad_field`). Raises Diverged for more than `most_triangles` triangles."""
        self.update_field()
        self.isosurface.pad_field(open_sides)
        counts = self.isosurface.count_surface()
        if counts.triangles > (most := self.config.most_triangles):
            many = f"the surface has {counts.triangles} triangles, more than surface.most_triangles {most}"
            raise Diverged(f"{many}; try a larger surface.spacing, or see whether the water has come apart")
        return self.isosurface.mesh(counts), counts

    @ti.kernel
    def find_heights(self):
        """Set the height of each column to the highest point where water ends in air, or to the bed if it is dry."""
        ny, value = ti.static(self.nodes.inner[1], self.isosurface.value)
        for n in self.heights.height:
            i, k = n // self.heights.count[1], n % self.heights.count[1]
            height, j = self.bed, ny
            while j > 0:
                here = value[self.isosurface.node_at(i + 1, j, k + 1)]
                if here >= 0.0:
                    height = self.top
                    if j < ny:
                        above = value[self.isosurface.node_at(i + 1, j + 1, k + 1)]
                        height = self.bed + self.nodes.width[1] * (j - 0.5 + here / (here - above))
                    j = 0
                j -= 1
            self.heights.height[n] = height

    def read_by_a_kernel(self) -> bool:
        """Note that the kernel being compiled reads heights; always True. Raises RuntimeError if they are outdated."""
        self.read_by_kernel = True
        if self.levelled != self.moment:
            raise RuntimeError("heights are out of date: call `update_heights` before the first kernel that reads them")
        return True

    @ti.func
    def elevation(self, x, z):
        """Height [m] of the highest water at x, z [m], bilinear between columns of nodes; the bed's where it is dry."""
        ti.static(self.read_by_a_kernel())
        return self.heights.height_at(x, z)

    def elevations(self, points: np.ndarray) -> np.ndarray:
        self.update_heights()
        return self.heights.elevations(points)


def flat_share(radius: float, spacing: float) -> float:
    """Smoothed share of water half a spacing above a cubic lattice of particles, where flat water ends; mean over x, z.

    A layer u radii below counts 315/256 (1 - u^2)^4 (integral of the poly6 kernel) times spacing over radius."""
    u = (np.arange(int(radius / spacing) + 1) + 0.5) * spacing / radius
    return float(315.0 / 256.0 * spacing / radius * (np.maximum(1.0 - u * u, 0.0) ** 4).sum())


def point_images(basin: Basin, nodes: Nodes) -> np.ndarray:
    """Mirror images and periodic copies of a point: image = sign * x + offset. Returns sign and offset [m] as (3,
    AXIS_IMAGES, 2), for each axis and image; the offset OPEN marks an image that does not exist."""
    still = {(side.axis, side.upper) for side in basin.sides if side.piston is None}
    found = np.full((3, AXIS_IMAGES, 2), (1.0, OPEN))
    found[:, 0, 1] = 0.0
    for k, (low, up, period) in enumerate(zip(nodes.lower, nodes.upper, basin.periods)):
        if period > 0.0:
            found[k, 1:, 1] = [period, -period, 2.0 * period, -2.0 * period]
        else:
            for n, (position, upper) in enumerate(((low, False), (up, True))):
                if (k, upper) in still:
                    found[k, 1 + n] = -1.0, 2.0 * position
            if {(k, False), (k, True)} <= still:
                found[k, 3:, 1] = 2.0 * (up - low), 2.0 * (low - up)
    return found


@in_kernels
class DensityMap:
    """Smoothed share of water at points, summed over particles that are sorted into bins at least one radius wide."""

    def __init__(self, particles: "Particles", basin: Basin, nodes: Nodes, radius: float) -> None:
        """`nodes`: grid whose box bins of particles fill; `radius`: of the smoothing kernel, which is 0 beyond [m]."""
        self.particles, self.nodes, self.radius = particles, nodes, radius
        self.n, self.squared = particles.n, radius * radius
        self.constant = particles.mass / particles.rest_density * 315.0 / (64.0 * pi * radius**9)
        self.bins = self.bins_of(nodes, radius)
        self.lower, self.upper, self.width = tm.vec3(nodes.lower), tm.vec3(nodes.upper), tm.vec3(nodes.width)
        self.per_bin = tm.vec3(np.divide(self.bins, np.subtract(nodes.upper, nodes.lower)).tolist())
        self.x, self.y, self.z = (ti.field(float, shape=self.n) for _ in range(3))
        self.bin = ti.field(int, shape=self.n)
        bins = self.bins[0] * self.bins[1] * self.bins[2]
        self.start, self.next = ti.field(int, shape=bins + 1), ti.field(int, shape=bins + 1)  # the last is outside
        self.image = ti.field(float, shape=(3, AXIS_IMAGES, 2))
        self.image.from_numpy(point_images(basin, nodes).astype(to_numpy_type(self.image.dtype)))

    @staticmethod
    def bins_of(nodes: Nodes, radius: float) -> tuple[int, int, int]:
        """Numbers of bins along x, y and z in the box of `nodes`, each bin at least `radius` [m] wide."""
        nx, ny, nz = (max(1, int((up - low) / radius + 1.0e-9)) for low, up in zip(nodes.lower, nodes.upper))
        return nx, ny, nz

    @classmethod
    def bytes(cls, n: int, nodes: Nodes, radius: float, word: int) -> int:
        """Memory [bytes] of the fields for n particles in bins of `radius` [m] or more; `word`: bytes of a `float`."""
        return (3 * word + 4) * n + 8 * (int(np.prod(cls.bins_of(nodes, radius))) + 1) + word * 6 * AXIS_IMAGES

    @ti.func
    def bin_of(self, x):
        """Indices (3,) of the bin of a point x [m]; a point beyond the box belongs to the bin at its side."""
        return ti.cast(tm.clamp((x - self.lower) * self.per_bin, 0.0, tm.vec3(self.bins) - 0.5), int)

    @ti.func
    def bin_at(self, i, j, k):
        """Number of the bin with indices i, j, k."""
        return (k * self.bins[1] + j) * self.bins[0] + i

    @ti.kernel
    def sort_particles(self) -> int:
        """Sort the particles in the box by bin (stable counting sort); returns the number of those outside."""
        p, bins = self.particles.position, ti.static(self.bins[0] * self.bins[1] * self.bins[2])
        outside = 0
        ti.loop_config(serialize=True)
        for _ in range(1):
            for c in range(bins + 1):
                self.next[c] = 0
            for i in range(self.particles.count.there()):
                x = tm.vec3(p.x[i], p.y[i], p.z[i])
                cell = self.bin_of(x)
                inside = (x >= self.lower).all() and (x <= self.upper).all()
                c = ti.select(inside, tm.clamp(self.bin_at(cell.x, cell.y, cell.z), 0, bins), bins)
                self.bin[i] = c
                self.next[c] = self.next[c] + 1
            total = 0
            for c in range(bins + 1):
                self.start[c] = total
                total += self.next[c]
                self.next[c] = self.start[c]
            outside = total - self.start[bins]
            for i in range(self.particles.count.there()):
                to = self.next[self.bin[i]]
                self.next[self.bin[i]] = to + 1
                self.x[to], self.y[to], self.z[to] = p.x[i], p.y[i], p.z[i]
        return outside

    @ti.func
    def shares_along(self, x, step, run: Template):
        """Shares of water (run,) at `run` points in a row along x, `step` [m] apart, the first at x (3,) [m]."""
        total = ti.Vector.zero(float, run)
        for c in range(AXIS_IMAGES):
            z = self.image[2, c, 0] * x.z + self.image[2, c, 1]
            if self.in_reach(z, z, 2):
                for b in range(AXIS_IMAGES):
                    y = self.image[1, b, 0] * x.y + self.image[1, b, 1]
                    if self.in_reach(y, y, 1):
                        for a in range(AXIS_IMAGES):
                            sign = self.image[0, a, 0]
                            first = sign * x.x + self.image[0, a, 1]
                            last = first + sign * (run - 1) * step
                            if self.in_reach(first, last, 0):
                                total += self.gather_bins(tm.vec3(first, y, z), tm.vec3(last, y, z), sign * step, run)
        return self.constant * total

    @ti.func
    def in_reach(self, first, last, axis: Template):
        """True if the stretch `first` to `last` [m] of an axis comes within a radius of the box with the particles."""
        low, high = self.lower[axis] - self.radius, self.upper[axis] + self.radius
        return tm.max(first, last) > low and tm.min(first, last) < high

    @ti.func
    def gather_bins(self, x, last, step, run: Template):
        """Sums (run,) of (radius^2 - r^2)^3 [m6] over the particles within one radius of each point of a row from x to
        `last` [m], `step` [m] apart; r is the distance."""
        total, here, there = ti.Vector.zero(float, run), self.bin_of(x), self.bin_of(last)
        low = tm.max(tm.min(here, there) - 1, 0)
        high = tm.min(tm.max(here, there) + 1, tm.ivec3(self.bins) - 1)
        for k in range(low.z, high.z + 1):
            for j in range(low.y, high.y + 1):
                for n in range(self.start[self.bin_at(low.x, j, k)], self.start[self.bin_at(high.x, j, k) + 1]):
                    dx, dy, dz = self.x[n] - x.x, self.y[n] - x.y, self.z[n] - x.z
                    left = self.squared - (dy * dy + dz * dz)
                    for m in ti.static(range(run)):
                        along = dx - m * step
                        w = left - along * along
                        w = ti.select(w > 0.0, w, 0.0)
                        total[m] += w * w * w
        return total

    @ti.kernel
    def mark_rows(self, rows: Template):
        """Mark in `rows` each row of nodes along x within one radius plus one node spacing of any particle, so that all
        neighbours of wet nodes are marked. A row beyond a side of the box counts as the next one inside."""
        for row in rows.near:
            inner = tm.clamp(tm.ivec2(row % rows.across, row // rows.across) - 1, 0, tm.ivec2(self.nodes.inner[1:]) - 1)
            y = self.lower.y + self.width.y * (inner.x + 0.5)
            z = self.lower.z + self.width.z * (inner.y + 0.5)
            rows.near[row] = int(self.particles_near(y, z))

    @ti.func
    def particles_near(self, y, z):
        """True if bins at the row of nodes y, z [m], rows beside it, or mirror or periodic images hold particles."""
        found = 0
        for c in range(AXIS_IMAGES):
            along = self.image[2, c, 0] * z + self.image[2, c, 1]
            if self.in_reach(along - self.width.z, along + self.width.z, 2):
                for b in range(AXIS_IMAGES):
                    up = self.image[1, b, 0] * y + self.image[1, b, 1]
                    if self.in_reach(up - self.width.y, up + self.width.y, 1):
                        margin = tm.vec3(0.0, self.width.y, self.width.z)
                        low = tm.max(self.bin_of(tm.vec3(self.lower.x, up, along) - margin) - 1, 0)
                        high = self.bin_of(tm.vec3(self.lower.x, up, along) + margin) + 1
                        high = tm.min(high, tm.ivec3(self.bins) - 1)
                        for k in range(low.z, high.z + 1):
                            for j in range(low.y, high.y + 1):
                                last = self.start[self.bin_at(self.bins[0], j, k)]
                                found |= int(self.start[self.bin_at(0, j, k)] < last)
        return found == 1

    @ti.kernel
    def fill_rows(self, rows: Template, value: Template, level: float):
        """Write share of water minus `level` to `value`, the field at the nodes, for all stored `rows` in the box."""
        for g in range(ROW_GROUPS * TASK_ITERATIONS):
            if g % TASK_ITERATIONS == 0:
                self.fill_group(g // TASK_ITERATIONS, rows, value, level)

    @ti.func
    def fill_group(self, group, rows: Template, value: Template, level):
        """Do one thread's part of `fill_rows`, which writes share of water minus `level` to the nodes' `value`: every
        ROW_GROUPS-th of the stored `rows` (Rows) of nodes along x, beginning with number `group`."""
        nx, ny, nz = ti.static(self.nodes.inner)
        for turn in range((rows.count[None] - group + ROW_GROUPS - 1) // ROW_GROUPS):
            n = group + turn * ROW_GROUPS
            j, k = rows.row_indices(n)
            if 0 < j <= ny and 0 < k <= nz:
                first = n * rows.length + 1
                for part in range((nx + RUN_NODES - 1) // RUN_NODES):
                    i = part * RUN_NODES
                    x = self.lower + self.width * (tm.vec3(i, j - 1, k - 1) + 0.5)
                    shares = self.shares_along(x, self.width.x, RUN_NODES)
                    for m in ti.static(range(RUN_NODES)):
                        if i + m < nx:
                            value[first + i + m] = shares[m] - level
