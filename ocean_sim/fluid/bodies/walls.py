"""What holds the water in: sides that particles bounce from, zones that absorb waves, a limit of what a step moves."""

from itertools import product

import numpy as np

from ocean_sim.basin import OPEN
from ocean_sim.fluid.bodies.absorption import Zone, zones
from ocean_sim.fluid.neighbours.images import SIDE, Images
from ocean_sim.fluid.open_sea.plane_waves import PlaneWaves
from ocean_sim.fluid.sph.lattice import Lattice
from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.runtime import Template, in_kernels
from ocean_sim.waves.absorption import PROFILE

GONE = np.array([3 * [OPEN], 3 * [-OPEN]])  # lowest and highest corner [m] of what is not there


@in_kernels
class Target:
    """The motion that the water of a zone is relaxed towards."""

    def __init__(self, zone: Zone) -> None:
        self.current, self.waving = tm.vec3(zone.current), zone.given is not None
        if zone.given is not None:
            self.waves = PlaneWaves(zone.given)

    def turn(self, time: float) -> None:
        """Take it at a time [s]."""
        if self.waving:
            self.waves.turn(time)

    @ti.func
    def velocity(self, x):
        """[m/s] at x [m]."""
        v = self.current
        if ti.static(self.waving):
            v += self.waves.velocity(x)
        return v


@in_kernels
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
        limit = lattice.config.motion_limit
        self.zones = tuple((zone.axis, zone.begin, zone.end, zone.rate, Target(zone)) for zone in zones(lattice))
        self.limited = limit is not None
        self.limit = (limit or 0.0) * lattice.spacing  # [m]
        self.advance(0.0)

    def advance(self, time: float) -> None:
        """Put the faces of obstacles that move where they are at a time [s], and the targets of zones; an obstacle that
        has left stops nothing."""
        for *_, target in self.zones:
            target.turn(time)
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
        """Velocity after dt in the zones before absorbing sides: dv/dt = rate s^PROFILE (target - v), s from 0 where a
        zone begins to 1 at its side, solved over dt."""
        for axis, begin, end, rate, target in ti.static(self.zones):
            s = (x[axis] - begin) / (end - begin)
            if s > 0.0:
                v += (1.0 - ti.exp(-dt * rate * tm.min(s, 1.0) ** PROFILE)) * (target.velocity(x) - v)
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
