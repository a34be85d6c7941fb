"""The surface around the smoothed share of water, by marching cubes (thesis 3.1 and 5.2.1, Algorithms 2 to 4).

Follows the water wherever it goes: crests that break, drops, the bed where it falls dry. Nothing is built until it
is read: the field when a mesh or a height is asked for, the heights from the first kernel on that calls `elevation`.
"""

from typing import TYPE_CHECKING, ClassVar, Literal, Self

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.conventions import Diverged
from ocean_sim.fluid import Fluid, with_particles
from ocean_sim.kernel_library import ti, tm
from ocean_sim.model import quantity
from ocean_sim.parts import LedgerRow, Preflight, Problems, SurfaceConfig
from ocean_sim.runtime import Array, in_kernels
from ocean_sim.surface import AREA_AND_VOLUME, Mesh, Surface
from ocean_sim.surface.shared.density_map import DensityMap, flat_share
from ocean_sim.surface.shared.heights import Heights
from ocean_sim.surface.shared.isosurface import Counts, Isosurface
from ocean_sim.surface.shared.nodes import MAX_NODES, Nodes

if TYPE_CHECKING:
    from ocean_sim.fluid import Particles

NODE_SPACINGS, RADIUS_SPACINGS = 0.5, 2.0  # [spacings of the particles] between nodes, and of the radius
MEASURED_COLUMNS = AREA_AND_VOLUME | {
    "surface_ambiguous": "share of the cells with surface whose wet corners are kept apart by choice",
    "surface_outside": "particles above the grid",
}
MAX_RADIUS = 6.0  # [spacings] radius at most: a node then counts 900 particles


class Config(SurfaceConfig):
    """Triangles around the water, from the rows near water of a grid over the whole basin."""

    compared: ClassVar[bool] = True
    fineness: ClassVar[int] = 1
    kind: Literal["marching_cubes"] = "marching_cubes"
    spacing: float | None = quantity("m", None, gt=0.0)
    """Distance between nodes, made a little smaller to fit the basin (the listing's stride); null: half the spacing of
    the particles."""
    radius: float | None = quantity("m", None, gt=0.0)
    """How far from a node a particle counts (the listing's isosurface radius); null: two spacings of the particles."""
    isovalue: float | None = quantity("1", None, gt=0.0, lt=1.0)
    """Smoothed share of water at the surface; null: what it is where flat water ends."""
    height: float | None = quantity("m", None, gt=0.0)
    """How far above the still water the grid ends (the listing's range); null: as far as the bed lies below."""
    most_nodes: int = quantity("nodes", 2**23, ge=1, le=MAX_NODES)
    """Largest number of nodes near water that are kept at a time; more stop the run."""
    most_triangles: int = quantity("triangles", 4_000_000, ge=1)
    """Largest number of triangles of a mesh; more stop the run."""

    def completed(self, preflight: Preflight) -> Self:
        assert preflight.spacing is not None
        found = {
            "spacing": self.spacing or NODE_SPACINGS * preflight.spacing,
            "radius": self.radius or RADIUS_SPACINGS * preflight.spacing,
            "height": self.height or preflight.tank.depth,
        }
        return self.model_copy(update=found)

    def problems(self, preflight: Preflight) -> Problems:
        basin = preflight.tank
        if basin.dimension == 2:
            return [(("kind",), "marching cubes need a basin with a width; in 2-D use surface: cloth")]
        if basin.closed:
            return [(("kind",), "a basin without a free surface has none to draw; leave it out")]
        return []

    def mismatches(self, preflight: Preflight) -> Problems:
        found, apart = Problems(), preflight.spacing
        assert apart is not None
        if self.radius is not None and not 1.2 * apart <= self.radius <= MAX_RADIUS * apart:
            span = f"{self.radius:g} m must be 1.2 to {MAX_RADIUS:g} spacings of the particles, {apart:.4g} m"
            found.append((("radius",), f"{span}: less shows them one by one, more smooths the waves away"))
        if (count := self.completed(preflight).count(preflight.tank)) > MAX_NODES:
            found.append((("spacing",), f"makes {count:.3g} nodes, more than the {MAX_NODES} there can be"))
        fine = self.spacing or NODE_SPACINGS * apart
        if (wet := preflight.particles * (apart / fine) ** 3) > self.most_nodes:
            message = f"{self.most_nodes} is less than the {wet:.3g} or so that the water at rest fills"
            found.append((("most_nodes",), message))
        return found

    def nodes(self, basin: Basin) -> Nodes:
        """The grid: the whole basin, up to `height`."""
        assert self.spacing is not None and self.height is not None, "completed() says how fine and how high it is"
        low, up = [*basin.lower], [*basin.upper]
        for side in basin.sides:
            if side.piston is not None:
                reach = side.piston.reach
                (up if side.upper else low)[side.axis] += reach if side.upper else -reach
        up[1] = self.height
        return Nodes(tuple(low), tuple(up), self.spacing)  # type: ignore[arg-type]

    def count(self, basin: Basin) -> float:
        """About how many nodes the grid has, however many that may be."""
        assert self.spacing is not None and self.height is not None
        extents = np.subtract(basin.upper, basin.lower) + [0.0, self.height - basin.upper[1], 0.0]
        return float(np.prod(extents / self.spacing + 2.0))

    def ledger(self, preflight: Preflight) -> list[LedgerRow]:
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
    """The field on the grid, its surface and the heights of its columns, each computed when it is read."""

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
        """Take in that the particles have moved on by dt [s]; heights are computed at once if a kernel reads
        them, and in the first step that it sees, in which one may be compiled."""
        self.moment += 1
        if self.read_by_kernel or not self.followed:
            self.update_heights()
        self.followed = True

    def update_field(self) -> None:
        """Make the field current."""
        if self.sampled != self.moment:
            self.outside = self.map.sort_particles()
            self.map.mark_rows(self.isosurface.rows)
            self.isosurface.rows.keep_rows()
            self.map.fill_rows(self.isosurface.rows, self.isosurface.value, self.isovalue)
            self.sampled = self.moment

    def update_heights(self) -> None:
        """Make the heights current."""
        if self.levelled != self.moment:
            self.update_field()
            self.find_heights()
            self.levelled = self.moment

    def mesh(self) -> Mesh:
        """The water's whole skin, closed along walls and bed."""
        return self.cut_surface(0)[0]

    def free_surface(self) -> Mesh:
        """The side that faces the air: the skin without its parts along walls and bed, open there."""
        return self.cut_surface(self.goes_on)[0]

    def measures(self) -> list[float]:
        mesh, counts = self.cut_surface(self.goes_on)
        return [mesh.area, mesh.volume(self.bed), counts.ambiguous_share, float(self.outside)]

    def cut_surface(self, goes_on: int) -> tuple[Mesh, Counts]:
        """The surface, going on through the sides whose bits are set; raises Diverged where it is too large."""
        self.update_field()
        self.isosurface.pad_field(goes_on)
        counts = self.isosurface.count_surface()
        if counts.triangles > self.config.most_triangles:
            raise Diverged(
                f"the surface has {counts.triangles} triangles, more than surface.most_triangles "
                f"{self.config.most_triangles}; try a larger surface.spacing, or see whether the water has come apart"
            )
        return self.isosurface.mesh(counts), counts

    def spray(self) -> np.ndarray:
        """(n,) whether a particle, in storage order, is lonely: outside the surface drawn."""
        self.update_field()
        lonely = np.empty(self.map.particles.count.now, dtype=np.int32)
        self.find_spray(lonely)
        return lonely.astype(bool)

    @ti.kernel
    def find_spray(self, lonely: Array):
        for i in range(lonely.shape[0]):
            p = self.map.particles.position
            lonely[i] = int(self.map.shares_along(tm.vec3(p.x[i], p.y[i], p.z[i]), 0.0, 1)[0] < self.isovalue)

    @ti.kernel
    def find_heights(self):
        """Down each column to the first node in the water, then up in proportion to where the field is zero."""
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
        """Called while a kernel is compiled that reads the heights; raises RuntimeError where they are out of date."""
        self.read_by_kernel = True
        if self.levelled != self.moment:
            raise RuntimeError("the heights are out of date: call `level` before the first kernel that reads them")
        return True

    @ti.func
    def elevation(self, x, z):
        """Highest water of the column [m], bilinear between columns of nodes; the bed where it is dry."""
        ti.static(self.read_by_a_kernel())
        return self.heights.height_at(x, z)

    def elevations(self, points: np.ndarray) -> np.ndarray:
        """(m, 2) points x, z [m] -> (m,) heights [m]."""
        self.update_heights()
        return self.heights.elevations(points)
