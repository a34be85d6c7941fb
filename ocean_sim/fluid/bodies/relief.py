"""Heights of a bed of any shape, for kernels."""

import numpy as np

from ocean_sim.basin.ground import Ground
from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.runtime import in_kernels

NODES_A_SPACING = 2.0  # between which a bed that particles bounce from is plane


@in_kernels
class Relief:
    """Heights of a bed at even nodes, bilinear between them."""

    def __init__(self, ground: Ground, spacing: float) -> None:
        """`spacing`: of the particles [m]."""
        size = np.array([ground.x[-1] - ground.x[0], ground.z[-1] - ground.z[0]])
        counts = np.maximum(1, np.ceil(NODES_A_SPACING * size / spacing)).astype(int)
        counts[1] = counts[1] if ground.dimension == 3 else 1
        nodes = [np.linspace(nodes[0], nodes[-1], n + 1) for nodes, n in zip((ground.x, ground.z), counts)]
        heights = ground.heights(np.stack(np.meshgrid(*nodes, indexing="ij"), axis=-1).reshape(-1, 2))
        self.height = ti.field(float, shape=counts + 1)  # [m]
        self.height.from_numpy(heights.reshape(counts + 1).astype(to_numpy_type(self.height.dtype)))
        self.first, self.last = tm.vec2(ground.x[0], ground.z[0]), tm.ivec2(counts - 1)
        self.per_step = tm.vec2(counts / size)  # [1/m]

    @ti.func
    def distance(self, x):
        """Distance [m] of x [m] from the bed as if it were plane there, negative inside; and the bed's normal."""
        at = (tm.vec2(x.x, x.z) - self.first) * self.per_step
        c = tm.clamp(int(ti.floor(at)), 0, self.last)
        f = tm.clamp(at - c, 0.0, 1.0)
        low = tm.vec2(self.height[c.x, c.y], self.height[c.x + 1, c.y])
        high = tm.vec2(self.height[c.x, c.y + 1], self.height[c.x + 1, c.y + 1])
        here = tm.mix(low, high, f.y)
        normal = tm.vec3(
            (here.x - here.y) * self.per_step.x, 1.0, tm.mix(low.x - high.x, low.y - high.y, f.x) * self.per_step.y
        ).normalized()
        return (x.y - tm.mix(here.x, here.y, f.x)) * normal.y, normal
