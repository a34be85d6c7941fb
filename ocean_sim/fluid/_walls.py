"""What holds the water in: walls and floor that particles bounce from, and how far one may move in a step."""

import taichi as ti
import taichi.math as tm

from ocean_sim.fluid._water import Lattice


@ti.data_oriented
class Walls:
    """Flat walls and floor, met half a spacing (`collision_distance`) before them."""

    def __init__(self, lattice: Lattice) -> None:
        gap = lattice.config.collision_distance * lattice.spacing
        low, up = lattice.basin.stops()
        self.low, self.up = tuple(x + gap for x in low), tuple(x - gap for x in up)
        self.axes = range(lattice.basin.dimension)
        self.restitution = lattice.basin.config.restitution
        self.friction = lattice.basin.config.friction
        limit = lattice.config.motion_limit
        self.limited = limit is not None
        self.limit = (limit or 0.0) * lattice.spacing  # [m]

    @ti.func
    def bounced(self, x, v):
        """Place and velocity after the walls: stopped at the wall, normal velocity returned with the restitution,
        tangential velocity reduced by Coulomb friction, at most to rest."""
        for k in ti.static(self.axes):
            inside = tm.clamp(x[k], self.low[k], self.up[k])
            if inside != x[k]:
                outward = ti.select(x[k] > inside, v[k], -v[k])
                if outward > 0.0:
                    returned = -self.restitution * v[k]
                    if ti.static(self.friction > 0.0):
                        along = v
                        along[k] = 0.0
                        kick = self.friction * (1.0 + self.restitution) * outward
                        v = along * tm.max(0.0, 1.0 - kick / tm.max(along.norm(), 1e-12))
                    v[k] = returned
                x[k] = inside
        return x, v

    @ti.func
    def held_back(self, v, dt):
        """Velocity that moves no further than the motion limit in dt, and whether it was too fast."""
        fast = 0
        if ti.static(self.limited):
            way = v.norm() * dt
            if way > self.limit:
                v *= self.limit / way
                fast = 1
        return v, fast
