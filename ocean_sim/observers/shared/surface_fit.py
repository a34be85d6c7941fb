"""How well a surface fits the particles under it: its distance from the highest of them, and what it
measures of itself."""

from typing import TYPE_CHECKING

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.fluid import ParticleFluid
from ocean_sim.kernel_library import ti
from ocean_sim.runtime import Array2, Integers, in_kernels, runs_alone

if TYPE_CHECKING:  # it is imported only where there is one
    from ocean_sim.surface import Surface

COLUMN = 2.0  # [spacings] least width of a column in which the highest particle is looked for
LOW = -1.0e30  # [m] under all particles
MEANING = {
    "surface_offset": "mean height of the surface over the highest particle of every column two spacings wide, half a "
    "spacing above its centre; spray counts",
    "surface_fit": "root of the mean square of the same",
}


@in_kernels
class Tops:
    """The highest particle of every column that holds any, half a spacing above its centre."""

    def __init__(self, basin: Basin, fluid: ParticleFluid) -> None:
        self.particles = fluid.particles
        self.low, self.size = np.array(basin.lower)[[0, 2]], np.subtract(basin.upper, basin.lower)[[0, 2]]
        self.counts = np.maximum(1, (self.size / (COLUMN * fluid.spacing) + 1.0e-6).astype(int)).tolist()
        columns = self.counts[0] * self.counts[1]
        self.half = 0.5 * fluid.spacing  # [m]
        self.top = np.zeros((columns, 3), dtype=fluid.particles.position.precision)  # [m]
        self.which = np.zeros(columns, dtype=np.int32)

    def points(self) -> np.ndarray:
        """(m, 3) where they are now [m]."""
        self.find(self.top, self.which)
        return self.top[self.which >= 0].astype(float) + [0.0, self.half, 0.0]

    @ti.kernel
    def find(self, top: Array2, which: Integers):
        p = self.particles.position
        ti.loop_config(serialize=ti.static(runs_alone()))
        for c in range(which.shape[0]):
            top[c, 1], which[c] = LOW, -1
        ti.loop_config(serialize=ti.static(runs_alone()))
        for i in range(self.particles.count.there()):
            ti.atomic_max(top[self.column(i), 1], p.y[i])
        ti.loop_config(serialize=ti.static(runs_alone()))
        for i in range(self.particles.count.there()):
            c = self.column(i)
            if p.y[i] == top[c, 1]:
                ti.atomic_max(which[c], i)
        ti.loop_config(serialize=ti.static(runs_alone()))
        for c in range(which.shape[0]):
            if which[c] >= 0:
                top[c, 0], top[c, 2] = p.x[which[c]], p.z[which[c]]

    @ti.func
    def column(self, i):
        """In which a particle is, those beyond the basin in the nearest."""
        p, found = self.particles.position, 0
        for k, x in ti.static(enumerate((p.x, p.z))):
            size, count = ti.static(float(self.size[k]) or 1.0, self.counts[k])
            at = int((ti.cast(x[i], ti.f64) - self.low[k]) / size * count)
            found = found * count + ti.max(0, ti.min(at, count - 1))
        return found


def fit(surface: "Surface", top: np.ndarray) -> tuple[float, float]:
    """Mean and root mean square of the height of a surface over (m, 3) points [m]."""
    away = surface.elevations(top[:, [0, 2]]) - top[:, 1]
    return float(away.mean()), float(np.sqrt(np.square(away).mean()))


class SurfaceFit:
    """Numbers of a row of accuracy.csv: the fit, and what the surface measures of itself."""

    def __init__(self, surface: "Surface", basin: Basin, fluid: ParticleFluid) -> None:
        self.surface, self.tops = surface, Tops(basin, fluid)
        self.meaning = MEANING | {name.rsplit("_m", 1)[0]: meaning for name, meaning in surface.measured.items()}
        self.columns = ["surface_offset_m", "surface_fit_m", *surface.measured]

    def values(self) -> list[float]:
        """In the order of the columns."""
        return [*fit(self.surface, self.tops.points()), *self.surface.measures()]
