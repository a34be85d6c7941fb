"""Heights of the water on a grid of upright columns over the basin, bilinear between them."""

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.runtime import Array, Array2, FieldCopy, in_kernels, runs_alone, values_at
from ocean_sim.surface import Mesh, sheet


def column_counts(basin: Basin, spacing: float) -> tuple[int, int]:
    """Numbers of columns along x and z, about `spacing` [m] apart, the outermost on the sides; 1 along z in 2-D."""
    extents = np.subtract(basin.upper, basin.lower)
    cells = [max(1, round(float(extents[axis]) / spacing)) for axis in (0, 2)]
    return cells[0] + 1, cells[1] + 1 if basin.dimension == 3 else 1


@in_kernels
class Heights:
    """Heights of water [m] on a grid of columns, where (i, k) has number i nz + k; constant beyond the sides."""

    def __init__(
        self,
        lower: np.ndarray,
        upper: np.ndarray,
        count: tuple[int, int],
        periodic: tuple[bool, bool],
        inset: float = 0.0,
    ) -> None:
        """`lower`, `upper`: corners x, z [m] of the area; `count`: columns along x and z; `periodic`: True for an axis
        that repeats; `inset`: distance of the outermost columns from the sides, 0 or 0.5 of the column spacing."""
        self.count, self.periodic, self.inset = count, periodic, inset
        between = [n - 1 + int(2 * inset) for n in count]
        widths = [(high - low) / max(1, n) for low, high, n in zip(lower, upper, between, strict=True)]
        self.low, self.width = tm.vec2(lower), tm.vec2([width or 1.0 for width in widths])  # no width in 2-D
        self.lower, self.upper = lower, upper
        self.cells = tuple(max(1, m if wraps else n - 1) for n, m, wraps in zip(count, between, periodic, strict=True))
        self.height = ti.field(float, shape=count[0] * count[1])
        self.copy = FieldCopy(self.height)

    @classmethod
    def over_basin(cls, basin: Basin, count: tuple[int, int]) -> "Heights":
        """Heights on `count` columns along x and z over the basin, the outermost on its sides."""
        lower, upper = np.array(basin.lower)[[0, 2]], np.array(basin.upper)[[0, 2]]
        return cls(lower, upper, count, (basin.periods[0] > 0.0, basin.periods[2] > 0.0))

    @ti.func
    def column_place(self, n):
        """Position x, z [m] of column n."""
        i, k = n // self.count[1], n % self.count[1]
        return self.low + self.width * (tm.vec2(i, k) + self.inset)

    @ti.func
    def height_at(self, x, z):
        """Height [m] at a point x, z [m], bilinear between columns."""
        at = (tm.vec2(x, z) - self.low) / self.width - self.inset
        for axis in ti.static(range(2)):
            if ti.static(self.periodic[axis]):
                at[axis] -= self.cells[axis] * ti.floor(at[axis] / self.cells[axis])
        at = tm.clamp(at, 0.0, tm.vec2(self.cells))
        i, k = ti.min(int(at.x), self.cells[0] - 1), ti.min(int(at.y), self.cells[1] - 1)
        f, g = at.x - i, at.y - k
        here, on = i * self.count[1], (i + 1) % self.count[0] * self.count[1]
        k_on = (k + 1) % self.count[1]
        near = tm.mix(self.height[here + k], self.height[here + k_on], g)
        return tm.mix(near, tm.mix(self.height[on + k], self.height[on + k_on], g), f)

    @ti.kernel
    def fill_heights(self, points: Array2, heights: Array):
        """Write the height [m] at each of the points x, z (m, 2) [m] to `heights` (m,)."""
        ti.loop_config(serialize=ti.static(runs_alone()))
        for n in range(points.shape[0]):
            heights[n] = self.height_at(points[n, 0], points[n, 1])

    def elevations(self, points: np.ndarray) -> np.ndarray:
        """Heights (m,) [m] at points x, z (m, 2) [m]."""
        return values_at(points, to_numpy_type(self.height.dtype), self.fill_heights)

    def mesh(self) -> Mesh:
        """Mesh of the surface, two triangles between four columns; only if its outermost columns are on the sides."""
        x, z = (np.linspace(low, up, n) for low, up, n in zip(self.lower, self.upper, self.count, strict=True))
        return sheet(x, z, self.copy.values().astype(float).reshape(self.count))
