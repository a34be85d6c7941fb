"""Contact of a hull with walls and bed: impulses on its outermost points, with the restitution and friction of the
basin.

The hull stops at one layer of particles from a side, which it could not press out.
"""

from collections.abc import Callable
from dataclasses import replace
from math import sqrt

import numpy as np

from ocean_sim.basin import OPEN, Basin
from ocean_sim.basin.solids.shape import SolidShape
from ocean_sim.ship import Load
from ocean_sim.ship.body import small_linalg
from ocean_sim.ship.body.rigid_body import RigidBody, cross
from ocean_sim.ship.hull.shapes import convex_corners

IMPULSE_SWEEPS = 8  # over the points that touch
MAX_TOUCHING = 8  # points of a side that are looked at: the deepest


class Sides:
    """Contact of one hull with walls and bed, by impulses on the corners of the hull."""

    def __init__(
        self, shape: SolidShape, centre: np.ndarray, basin: Basin, room: float = 0.0, axes: tuple[int, ...] = (0, 1, 2)
    ) -> None:
        """`centre`: centre of mass from the hull's origin [m]; `room`: distance that the hull keeps from each side [m];
        `axes`: those across which sides are considered."""
        self.points = convex_corners(shape) - centre  # body axes [m]
        self.middle: list[float] = (0.5 * (self.points.max(axis=0) + self.points.min(axis=0))).tolist()
        self.half: list[float] = (0.5 * np.ptp(self.points, axis=0)).tolist()  # of the box around them [m]
        self.radius = float(np.linalg.norm(self.points, axis=1).max())  # [m]
        self.stops = [(k, way, side[k] + way * room) for way, side in zip((1.0, -1.0), basin.stops()) for k in axes]
        self.ground, self.room = basin.ground if 1 in axes else None, room
        shaped = self.ground is not None
        self.stops = [stop for stop in self.stops if abs(stop[2]) < OPEN and not (shaped and stop[:2] == (1, 1.0))]
        self.highest = -OPEN if self.ground is None else float(self.ground.y.max()) + room  # of a bed with a shape [m]
        self.restitution, self.friction = basin.config.restitution, basin.config.friction
        self.impulse = np.zeros(3)  # on the ship [N s]
        self.bed = False  # whether the last step met it

    def may_touch(self, body: RigidBody, dt: float) -> bool:
        """True if the hull may reach a side within a step of dt [s]."""
        velocity, turn = body.velocity.tolist(), body.rows
        speed, rate = (sqrt(small_linalg.dot(v, v)) for v in (velocity, body.spin))
        along = 2.0 * dt * (speed + self.radius * rate)
        position = small_linalg.plus(body.position.tolist(), small_linalg.matrix_times(turn, self.middle))
        reach = small_linalg.matrix_times([[abs(part) for part in row] for row in turn], self.half)
        stops = [*self.stops, (1, 1.0, self.highest)]
        return any(way * (position[axis] - side) < reach[axis] + along for axis, way, side in stops)

    def penetrations(self, body: RigidBody) -> list[tuple[int, float, np.ndarray]]:
        """All sides, each as axis across it, inward direction (1 or -1), and depth (n,) [m] of corners beyond it."""
        positions = self.points @ body.matrix.T + body.position
        found = [(axis, way, way * (side - positions[:, axis])) for axis, way, side in self.stops]
        if self.ground is not None:
            found.append((1, 1.0, self.ground.heights(positions[:, [0, 2]]) + self.room - positions[:, 1]))
        return found

    def inward(self, axis: int, way: float, at: np.ndarray) -> np.ndarray:
        """(3,) unit normal into the basin, at a point (3,) [m], of the side across `axis` that faces `way`, 1 or -1."""
        if self.ground is None or (axis, way) != (1, 1.0):
            return way * np.eye(3)[axis]
        return self.ground.normals(at[None, [0, 2]])[0]

    def moved_inside(self, body: RigidBody) -> RigidBody:
        """Copy of `body`, moved back by the depth of its deepest corner, until the hull only touches the sides."""
        move = np.zeros(3)
        for axis, way, depth in self.penetrations(body):
            move[axis] += way * max(0.0, float(depth.max()))
        return replace(body, position=body.position + move) if move.any() else body

    def with_impulses(self, load: Load, after: Callable[[Load], RigidBody], dt: float) -> Load:
        """Copy of `load` whose cause `wave`, which has all contact forces, gains the impulses of walls and bed over a
        step dt [s]; `after(load)`: the body at the end of the step."""
        body = after(load)
        normals, arms = [], []
        self.bed = False
        for axis, way, depth in self.penetrations(body):
            self.bed |= axis == 1 and way > 0.0 and bool(depth.max() > 0.0)
            deep = np.argsort(-depth, kind="stable")[:MAX_TOUCHING]
            for k in deep[depth[deep] > 0.0]:
                arms.append(body.matrix @ self.points[k])
                normals.append(self.inward(axis, way, body.position + arms[-1]))
        if not normals:
            return load
        total = self.contact_impulses(body, np.array(normals), np.array(arms))
        self.impulse += total[0]
        return load.plus("wave", total / dt)

    def contact_impulses(self, body: RigidBody, normals: np.ndarray, arms: np.ndarray) -> np.ndarray:
        """(2, 3) impulse [N s] and moment [N m s] by which sides with `normals` (n, 3) stop the hull's points at `arms`
        (n, 3) [m] from the centre of mass, by sequential impulses: point after point, in several sweeps."""
        turn = body.matrix
        inverse_inertia = turn @ np.linalg.inv(body.inertia_body) @ turn.T
        velocity, omega = body.velocity.copy(), body.angular_velocity.copy()
        came = ((velocity + np.cross(omega, arms)) * normals).sum(axis=1)
        wanted = self.restitution * np.maximum(-came, 0.0)
        held = np.zeros(len(arms))
        total = np.zeros((2, 3))
        for _ in range(IMPULSE_SWEEPS):
            for k, (n, arm) in enumerate(zip(normals, arms)):
                slip = velocity + cross(omega, arm)
                more = max(-held[k], (wanted[k] - slip @ n) * effective_mass(body.mass, inverse_inertia, arm, n))
                held[k] += more
                push = more * n
                along = slip - (slip @ n) * n
                speed = sqrt(float(along @ along))
                if self.friction > 0.0 and speed > 1e-12 and more > 0.0:
                    t = along / speed
                    mass = effective_mass(body.mass, inverse_inertia, arm, t)
                    push = push - min(self.friction * more, speed * mass) * t
                moment = cross(arm, push)
                velocity += push / body.mass
                omega += inverse_inertia @ moment
                total += [push, moment]
        return total


def effective_mass(mass: float, inverse_inertia: np.ndarray, arm: np.ndarray, along: np.ndarray) -> float:
    """Mass [kg] felt by a push at `arm` [m] `along` a unit vector; `inverse_inertia` (3, 3) [1/(kg m2)]; world axes."""
    lever = cross(arm, along)
    return float(1.0 / (1.0 / mass + lever @ inverse_inertia @ lever))
