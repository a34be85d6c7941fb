"""The particles as a frame of the page has them: positions in a box and speeds, by identity, made in one kernel."""

from typing import TYPE_CHECKING

import numpy as np

from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.runtime import Array2, in_kernels
from ocean_sim.viewer.protocol import FULL, scaled

if TYPE_CHECKING:
    from ocean_sim.fluid import Particles

MOST = 60_000  # particles that are shown: of more, every second, third, ...


@in_kernels
class ShownParticles:
    """Of every particle that is shown, where it is in the box and how fast it is."""

    def __init__(self, particles: "Particles", low: np.ndarray, high: np.ndarray) -> None:
        """`low`, `high`: (3,) corners of the box [m]."""
        x, v = particles.position, particles.velocity
        self.x, self.v, self.id = (x.x, x.y, x.z), (v.x, v.y, v.z), particles.id
        self.count = particles.count
        self.every = every_shown(particles.n)
        middle, scale = scaled(low, high)
        self.middle, self.scale = tm.vec3(*middle), tm.vec3(*scale)
        self.rows: np.ndarray = np.empty((-(-particles.n // self.every), 4), to_numpy_type(self.x[0].dtype))

    def now(self) -> tuple[np.ndarray, np.ndarray]:
        """(m, 3) int16 as `protocol.boxed` has them, and (m,) speeds [m/s]."""
        self.fill(self.rows, self.count.now)
        there = self.rows[: -(-self.count.now // self.every)]
        return there[:, :3].astype(np.int16), there[:, 3]

    @ti.kernel
    def fill(self, rows: Array2, count: int):  # type: ignore[no-untyped-def]
        for i in range(count):
            k = self.id[i]
            if k % ti.static(self.every) == 0:
                row = k // ti.static(self.every)
                x = tm.vec3(self.x[0][i], self.x[1][i], self.x[2][i])
                v = tm.vec3(self.v[0][i], self.v[1][i], self.v[2][i])
                share = ti.round((x - self.middle) * self.scale)
                for a in ti.static(range(3)):
                    inside = tm.clamp(share[a], -float(FULL), float(FULL))
                    rows[row, a] = ti.select(tm.isnan(share[a]), 0.0, inside)
                rows[row, 3] = tm.length(v)


def every_shown(n: int) -> int:
    """One of so many particles is shown."""
    return max(1, -(-n // MOST))
