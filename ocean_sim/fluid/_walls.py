"""What holds the water in: sides that particles bounce from, zones that calm waves, and a limit of motion in a step."""

import taichi as ti
import taichi.math as tm

from ocean_sim.basin import Basin
from ocean_sim.fluid._images import DRIFT, PLACE, Images
from ocean_sim.fluid._water import Lattice, free_fall_speed

ABSORBING_PART = 0.25  # of the basin that the zone before an absorbing side takes
ABSORBING_RATE = 2.5  # [sqrt(|g| / depth)] at the side; falls with the square of the distance, to 0 at the zone's end


def absorbing_zones(basin: Basin) -> tuple[tuple[int, float, float, float], ...]:
    """Of each absorbing side: axis, where its zone begins and ends [m], and the damping rate at its end [1/s]."""
    rate = ABSORBING_RATE * free_fall_speed(basin) / basin.depth
    zones = []
    for side in basin.sides:
        if side.absorbing:
            length = ABSORBING_PART * (basin.upper[side.axis] - basin.lower[side.axis])
            zones.append((side.axis, side.place - length if side.upper else side.place + length, side.place, rate))
    return tuple(zones)


@ti.data_oriented
class Walls:
    """Flat walls and floor, met half a spacing (`collision_distance`) before them."""

    def __init__(self, lattice: Lattice, images: Images) -> None:
        gap = lattice.config.collision_distance * lattice.spacing
        low, up = lattice.basin.stops()
        self.low, self.up, self.gap = tuple(x + gap for x in low), tuple(x - gap for x in up), gap
        self.images = images
        self.pistons = tuple((s, side.axis, side.upper) for s, side in images.pistons)
        self.axes = range(lattice.basin.dimension)
        self.restitution = lattice.basin.config.restitution
        self.friction = lattice.basin.config.friction
        limit = lattice.config.motion_limit
        self.zones = absorbing_zones(lattice.basin)
        self.limited = limit is not None
        self.limit = (limit or 0.0) * lattice.spacing  # [m]

    @ti.func
    def bounced(self, x, v):
        """Place and velocity after the walls: stopped at the wall, normal velocity returned with the restitution,
        tangential velocity reduced by Coulomb friction, at most to rest."""
        for k in ti.static(self.axes):
            low, up, wall = self.low[k], self.up[k], 0.0
            for s, axis, upper in ti.static(self.pistons):
                if ti.static(axis == k):
                    wall = 0.5 * self.images.side[s, DRIFT + axis]
                    if ti.static(upper):
                        up = self.images.side[s, PLACE] - self.gap
                    else:
                        low = self.images.side[s, PLACE] + self.gap
            inside = tm.clamp(x[k], low, up)
            if inside != x[k]:
                outward = ti.select(x[k] > inside, v[k] - wall, wall - v[k])
                if outward > 0.0:
                    returned = wall - self.restitution * (v[k] - wall)
                    if ti.static(self.friction > 0.0):
                        along = v
                        along[k] = 0.0
                        kick = self.friction * (1.0 + self.restitution) * outward
                        v = along * tm.max(0.0, 1.0 - kick / tm.max(along.norm(), 1e-12))
                    v[k] = returned
                x[k] = inside
        return x, v

    @ti.func
    def calmed(self, x, v, dt):
        """Velocity after dt in the zones before absorbing sides: dv/dt = -rate s^2 v, s from 0 where a zone begins to 1
        at its side, stepped backwards in time."""
        for axis, begin, end, rate in ti.static(self.zones):
            s = tm.clamp((x[axis] - begin) / (end - begin), 0.0, 1.0)
            v /= 1.0 + dt * rate * s * s
        return v

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
