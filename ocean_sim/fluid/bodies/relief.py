"""Heights of a bed of any shape, for kernels."""

from math import ceil

import numpy as np

from ocean_sim.basin.ground import Ground
from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.runtime import in_kernels

NODES_A_SPACING = 2.0  # between which a bed that particles bounce from is plane
SLACK_NODES = 3.0  # by which samples may be nearer than nodes: within a cell, between heights, across a period


@in_kernels
class Relief:
    """Heights of a bed at even nodes, bilinear between them, and how far up its samples reach."""

    def __init__(self, ground: Ground, spacing: float, support: float) -> None:
        """`spacing`: of the particles [m]; `support`: reach of the samples [m]."""
        from scipy.ndimage import grey_dilation

        size = np.array([ground.x[-1] - ground.x[0], ground.z[-1] - ground.z[0]])
        counts = np.maximum(1, np.ceil(NODES_A_SPACING * size / spacing)).astype(int)
        counts[1] = counts[1] if ground.dimension == 3 else 1
        nodes = [np.linspace(nodes[0], nodes[-1], n + 1) for nodes, n in zip((ground.x, ground.z), counts)]
        heights = ground.heights(np.stack(np.meshgrid(*nodes, indexing="ij"), axis=-1).reshape(-1, 2))
        heights = heights.reshape(counts + 1)
        steps = size / counts
        across = [np.arange(-n, n + 1) for n in (ceil(SLACK_NODES + support / step) for step in steps)]
        across[1] = across[1] if ground.dimension == 3 else np.zeros(1)
        away = [step * np.maximum(np.abs(nodes) - SLACK_NODES, 0.0) for nodes, step in zip(across, steps)]
        ball = np.sqrt(np.maximum(support**2 - np.add.outer(away[0] ** 2, away[1] ** 2), 0.0))
        reached = grey_dilation(heights, structure=ball, mode="wrap" if any(ground.periodic) else "nearest")
        self.height, self.reach = ti.field(float, shape=counts + 1), ti.field(float, shape=counts + 1)  # [m]
        for field, values in ((self.height, heights), (self.reach, reached)):
            field.from_numpy(values.astype(to_numpy_type(field.dtype)))
        self.first, self.last = tm.vec2(ground.x[0], ground.z[0]), tm.ivec2(counts - 1)
        self.per_step = tm.vec2(counts / size)  # [1/m]

    @ti.func
    def cell(self, x):
        """Place of x [m] in steps from the first node, and the indices of the cell under it."""
        at = (tm.vec2(x.x, x.z) - self.first) * self.per_step
        return at, tm.clamp(int(ti.floor(at)), 0, self.last)

    @ti.func
    def is_reached(self, x):
        """True if samples of the bed may lie within their reach of x [m]."""
        _at, c = self.cell(x)
        return x.y < self.reach[c.x, c.y]

    @ti.func
    def distance(self, x):
        """Distance [m] of x [m] from the bed as if it were plane there, negative inside; and the bed's normal."""
        at, c = self.cell(x)
        f = tm.clamp(at - c, 0.0, 1.0)
        low = tm.vec2(self.height[c.x, c.y], self.height[c.x + 1, c.y])
        high = tm.vec2(self.height[c.x, c.y + 1], self.height[c.x + 1, c.y + 1])
        here = tm.mix(low, high, f.y)
        normal = tm.vec3(
            (here.x - here.y) * self.per_step.x, 1.0, tm.mix(low.x - high.x, low.y - high.y, f.x) * self.per_step.y
        ).normalized()
        return (x.y - tm.mix(here.x, here.y, f.x)) * normal.y, normal
