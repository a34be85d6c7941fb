"""What holds the water in: sides that particles bounce from, zones that absorb waves, a limit of what a step moves."""

from itertools import product

import numpy as np
import taichi as ti
import taichi.math as tm
from taichi.lang.util import to_numpy_type

from ocean_sim.basin import OPEN, Basin
from ocean_sim.fluid.shared.images import SIDE, Images
from ocean_sim.fluid.shared.lattice import Lattice
from ocean_sim.fluid.shared.water import free_fall_speed
from ocean_sim.runtime import Template

ABSORBING_PART = 0.25  # of the basin that the zone before an absorbing side takes
ABSORBING_RATE = 2.5  # [sqrt(|g| / depth)] at the side; falls with the square of the distance, to 0 at the zone's end
GONE = np.array([3 * [OPEN], 3 * [-OPEN]])  # lowest and highest corner [m] of what is not there


def absorbing_zones(basin: Basin) -> tuple[tuple[int, float, float, float], ...]:
    """Of each absorbing side: axis, where its zone begins and ends [m], and the damping rate at its end [1/s]."""
    rate = ABSORBING_RATE * free_fall_speed(basin) / basin.depth
    zones = []
    for side in basin.sides:
        if side.absorbing:
            length = ABSORBING_PART * (basin.upper[side.axis] - basin.lower[side.axis])
            zones.append(
                (side.axis, side.position - length if side.upper else side.position + length, side.position, rate)
            )
    return tuple(zones)


@ti.data_oriented
class Walls:
    """Flat walls and floor, met half a spacing (`collision_distance`) before them."""

    def __init__(self, lattice: Lattice, images: Images) -> None:
        gap = lattice.config.collision_distance * lattice.spacing
        low, up = lattice.basin.stops()
        self.low, self.up, self.gap = tuple(x + gap for x in low), tuple(x - gap for x in up), gap
        self.images = images
        self.pistons = tuple((s, side.axis, side.upper) for s, side, _ in images.pistons)
        self.axes = range(lattice.basin.dimension)
        self.restitution = lattice.basin.config.restitution
        self.friction = lattice.basin.config.friction
        self.obstacles, self.gates = len(lattice.basin.obstacles), lattice.basin.gates
        if self.obstacles:
            self.faces = ti.field(float, shape=(self.obstacles, 2, 3))
            self.first = np.array(lattice.basin.obstacles) + np.array([[-gap], [gap]])  # (n, 2, 3) at time 0 [m]
            self.faces.from_numpy(self.first.astype(to_numpy_type(self.faces.dtype)))
        if self.gates:
            self.speed = ti.field(float, shape=(self.obstacles, 3))  # [m/s]
            self.advance(0.0)
        limit = lattice.config.motion_limit
        self.zones = absorbing_zones(lattice.basin)
        self.limited = limit is not None
        self.limit = (limit or 0.0) * lattice.spacing  # [m]

    def advance(self, time: float) -> None:
        """Put the faces of obstacles that move where they are at a time [s]; one that has left stops nothing."""
        for b, gate in self.gates:
            moved = gate.at(time)
            faces = GONE if moved is None else self.first[b] + moved.way
            for side, k in product(range(2), range(3)):
                self.faces[b, side, k] = faces[side, k]
            for k in range(3):
                self.speed[b, k] = 0.0 if moved is None else moved.velocity[k]

    @ti.func
    def bounced(self, x, v):
        """Position and velocity after the walls: stopped at the wall, normal velocity returned with the restitution,
        tangential velocity reduced by Coulomb friction, at most to rest."""
        for k in ti.static(self.axes):
            low, up, wall = self.low[k], self.up[k], 0.0
            for s, axis, upper in ti.static(self.pistons):
                if ti.static(axis == k):
                    wall = 0.5 * self.images.side[s, SIDE.twice_velocity + axis]
                    if ti.static(upper):
                        up = self.images.side[s, SIDE.position] - self.gap
                    else:
                        low = self.images.side[s, SIDE.position] + self.gap
            inside = tm.clamp(x[k], low, up)
            if inside != x[k]:
                v = self.returned(v, k, wall, ti.select(x[k] > inside, 1.0, -1.0))
                x[k] = inside
        if ti.static(self.obstacles > 0):
            for b in range(self.obstacles):
                x, v = self.kept_out(b, x, v)
        return x, v

    @ti.func
    def returned(self, v, k: Template, wall, outward):
        """Velocity after meeting a wall across axis k that moves with `wall` [m/s]; `outward`: 1 where it stops what
        goes up the axis, -1 where what goes down."""
        speed = outward * (v[k] - wall)
        if speed > 0.0:
            returned = wall - self.restitution * (v[k] - wall)
            if ti.static(self.friction > 0.0):
                along = v
                along[k] = 0.0
                kick = self.friction * (1.0 + self.restitution) * speed
                v = along * tm.max(0.0, 1.0 - kick / tm.max(along.norm(), 1e-12))
            v[k] = returned
        return v

    @ti.func
    def kept_out(self, b, x, v):
        """Position and velocity after obstacle b: out through its nearest face that lies in the basin."""
        least, face, across = OPEN, -1, 0.0
        for k in ti.static(self.axes):
            below, above = x[k] - self.faces[b, 0, k], self.faces[b, 1, k] - x[k]
            if below <= 0.0 or above <= 0.0:
                least = -OPEN
            if below < least and self.faces[b, 0, k] >= self.low[k]:
                least, face, across = below, k, self.faces[b, 0, k]
            if above < least and self.faces[b, 1, k] <= self.up[k]:
                least, face, across = above, k, self.faces[b, 1, k]
        if least > 0.0:
            for k in ti.static(self.axes):
                if face == k:
                    wall = 0.0
                    if ti.static(len(self.gates) > 0):
                        wall = self.speed[b, k]
                    v = self.returned(v, k, wall, ti.select(across > x[k], -1.0, 1.0))
                    x[k] = across
        return x, v

    @ti.func
    def relaxed(self, x, v, dt):
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
