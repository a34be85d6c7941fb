"""How far a place is from a hull, on a lattice around it: made once from its cubes, and kept with them."""

from typing import Any

import numpy as np
import taichi as ti
import taichi.math as tm

from ocean_sim.cache_file import kept
from ocean_sim.ship._solid import cells
from ocean_sim.ship._voxels import voxels

MOST = 3e5  # cubes of a lattice; a long hull in fine water has coarser ones
SMOOTH = 0.5  # [cubes] over which steps of cubes are smoothed


def signed(shape: Any, side: float, reach: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Distances [m] at (i, j, k), negative inside; the place of the first in the hull's axes, and the steps (3,) [m].
    `side` of a cube, `reach` of the lattice over the hull [m]."""
    lower, upper = shape.bounds()
    side = max(side, float((upper - lower + 2.0 * reach).prod() / MOST) ** (1.0 / 3.0))
    cubes = voxels(shape, side, 1.0)
    size = cubes.size
    margin = np.ceil(reach / size).astype(int) + 1

    def made() -> dict[str, np.ndarray]:
        from scipy.ndimage import distance_transform_edt, gaussian_filter

        counts = np.round((upper - lower) / size).astype(int)
        full = np.zeros(counts + 2 * margin, dtype=bool)
        where = cells(cubes, lower)[cubes.share > 0.5]
        full[tuple((where + margin).T)] = True
        # A face lies half way between the middles of a full cube and of an empty one.
        half = 0.5 * size.mean()
        outside = distance_transform_edt(~full, sampling=size) - half
        inside = distance_transform_edt(full, sampling=size) - half
        return {"distance": gaussian_filter(np.where(full, -inside, outside), SMOOTH, mode="nearest")}

    content = shape.content() + f"{size.tolist()} {margin.tolist()} {SMOOTH}".encode()
    return kept("distances", content, made)["distance"], lower + (0.5 - margin) * size, size


@ti.data_oriented
class Distance:
    """Signed distance from a hull, and the outward normal, in body axes from the centre of mass."""

    def __init__(self, shape: Any, centre: np.ndarray, side: float, reach: float) -> None:
        values, first, step = signed(shape, side, reach)
        self.lower = first - centre  # [m]
        self.upper = self.lower + (np.array(values.shape) - 1) * step
        self.first, self.per_step, self.last = tm.vec3(self.lower), tm.vec3(1.0 / step), tm.ivec3(values.shape) - 2
        self.distance = ti.field(float, shape=values.shape)
        self.distance.from_numpy(values.astype(self.distance.to_numpy().dtype))
        self.far = float(reach)

    @ti.func
    def at(self, place):
        """Outward unit normal and distance [m]; beyond the lattice at least its reach."""
        a = (place - self.first) * self.per_step
        c = tm.clamp(int(ti.floor(a)), 0, self.last)
        out = tm.vec4(0.0, 1.0, 0.0, self.far)
        if (a >= 0.0).all() and (a <= self.last + 1).all():
            f = a - c
            value, slope = 0.0, tm.vec3(0.0)
            for di, dj, dk in ti.static(ti.ndrange(2, 2, 2)):
                x = f.x if ti.static(di == 1) else 1.0 - f.x
                y = f.y if ti.static(dj == 1) else 1.0 - f.y
                z = f.z if ti.static(dk == 1) else 1.0 - f.z
                here = self.distance[c.x + di, c.y + dj, c.z + dk]
                value += x * y * z * here
                slope += here * tm.vec3((2 * di - 1) * y * z, (2 * dj - 1) * x * z, (2 * dk - 1) * x * y)
            slope *= self.per_step
            n = slope / tm.max(slope.norm(), 1e-6)
            out = tm.vec4(n.x, n.y, n.z, value)
        return out
