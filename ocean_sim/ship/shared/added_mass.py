"""Water that moves with a hull, by rule from its sections, and the motion of hull and water together.

By rule: half the added mass of flat plates as broad as the sections at the still water in heave and pitch
(Newman 1977, Marine Hydrodynamics, table 4.3), with Pabst's factor for a length that is not infinite (Pabst 1930), in
pitch that of each half of the ship; half of circles as deep as the sections in sway and yaw; a twentieth of the mass
in surge (Fossen 2021, Handbook of Marine Craft Hydrodynamics, 6.5).

In roll a section and its mirror image at the still water turn about their middle in unbounded water, which is what a
quick roll is (Newman 1977, 6.17): an ellipse rho pi / 8 (a^2 - b^2)^2, a plate the same with b = 0 (table 4.3), a
rectangle as RECTANGLES says; sections between an ellipse and a rectangle by their fullness. Of a barge of 8 x 2 m that
is 1 % above the panel method at the natural frequency, a plate 14 % below.
"""

from math import pi, sqrt

import numpy as np

from ocean_sim.model import Model, quantity
from ocean_sim.ship.shared.hydrostatics import Hydrostatics
from ocean_sim.ship.shared.plain import (
    Rows,
    Three,
    Vector,
    cross,
    minus,
    plus,
    scaled,
    solved,
    times,
    turned,
    turned_back,
)
from ocean_sim.ship.shared.rigid_body import RigidBody

DEPTHS = (0.0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.75, 1.0)  # draughts over breadth
RECTANGLES = (1.0, 1.092, 1.148, 1.185, 1.180, 1.186, 1.347, 1.845, 6.147, 18.77)
"""Added inertia of rectangles that turn about the still water over that of a plate, by 600 panels of potential flow."""


class AddedMass(Model):
    """Added mass about the centre of mass, body axes; what is null comes by rule from the hull."""

    sway: float | None = quantity("kg", None, ge=0.0)
    """Along x."""
    heave: float | None = quantity("kg", None, ge=0.0)
    """Along y."""
    surge: float | None = quantity("kg", None, ge=0.0)
    """Along z."""
    pitch: float | None = quantity("kg m2", None, ge=0.0)
    """About x."""
    yaw: float | None = quantity("kg m2", None, ge=0.0)
    """About y."""
    roll: float | None = quantity("kg m2", None, ge=0.0)
    """About z."""

    def diagonal(self, hull: Hydrostatics) -> np.ndarray:
        """(6,) in the order of `Motions`."""
        given = [self.sway, self.heave, self.surge, self.pitch, self.yaw, self.roll]
        return np.array([rule if value is None else value for value, rule in zip(given, by_rule(hull))])


def by_rule(hull: Hydrostatics) -> np.ndarray:
    """(6,) added mass [kg] and inertia [kg m2] of a hull at its draught."""
    z, breadth, draught = hull.stations
    ds, rho = float(hull.voxels.size[2]), hull.density
    z = z - hull.matter.centre[2]
    length, broad = hull.length, float(breadth.max())
    plate, circle = rho * pi / 8.0 * breadth**2 * ds, rho * pi / 2.0 * draught**2 * ds  # of each slice [kg]
    return np.array(
        [
            circle.sum(),
            slenderness(length / broad) * plate.sum(),
            0.05 * hull.matter.mass,
            slenderness(length / 2.0 / broad) * (plate * z**2).sum(),
            (circle * z**2).sum(),
            (rho * pi / 256.0 * turning(hull, breadth, draught) * ds).sum(),
        ]
    )


def turning(hull: Hydrostatics, breadth: np.ndarray, draught: np.ndarray) -> np.ndarray:
    """(n,) [m4] breadth^4 of plates that are as hard to roll as sections of the fullness of the whole hull."""
    full = min(hull.wanted, hull.voxels.volume) / float((breadth * draught).sum() * hull.voxels.size[2])
    share = min(max((full - pi / 4.0) / (1.0 - pi / 4.0), 0.0), 1.0)
    deep = np.minimum(draught / np.maximum(breadth, 1e-9), DEPTHS[-1])
    beyond = np.interp(deep, DEPTHS, RECTANGLES) - (1.0 - 4.0 * deep**2) ** 2  # an ellipse
    return (breadth**2 - 4.0 * draught**2) ** 2 + share * beyond * breadth**4


def slenderness(ratio: float) -> float:
    """Pabst's factor of a plate so many times as long as broad (or as broad as long)."""
    r = max(ratio, 1.0 / ratio)
    return r / sqrt(1.0 + r * r) * (1.0 - 0.425 * r / (1.0 + r * r))


def reaction(
    body: RigidBody,
    added: np.ndarray,
    between: np.ndarray | None,
    force: np.ndarray,
    torque: np.ndarray,
    drift: np.ndarray,
    surge: np.ndarray,
    free: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """What the water that is moved does back, (2, 3) each in world axes: to a hull that moves, and by moving itself.

    Kirchhoff's equations with the added mass (6,) of each motion in body axes, and what there is `between` them, (6, 6)
    symmetric with a diagonal of 0; the rest of the load [N], [N m] in world axes, and the water's own velocity and
    acceleration (6,) in body axes; the axes turn with the hull, so there the relative velocity of hull and water
    changes by omega x (the water's own) as well (Fossen 2021, 10.3). They are solved together with the hull, so a
    light body is no harder than a heavy one. Motions that are not `free` (6,) have no acceleration that others could
    feel.
    """
    r, inertia, water = body.rows, body.inertia_body.tolist(), added.tolist()
    v, omega = body.own_velocity, body.own_spin
    (stream, swirl), (pull, pull_turn) = halves(drift), halves(surge)
    v_r, omega_r = minus(v, stream), minus(omega, swirl)
    momentum, turning = swept(water, between, v_r, omega_r)
    carried, carried_turn = swept(water, between, pull, pull_turn)
    kept, kept_turn = swept(water, between, cross(omega, stream), cross(omega, swirl))  # of it, as the axes turn
    along = plus(cross(omega, momentum), kept)
    around = plus(plus(cross(omega, turning), cross(v_r, momentum)), kept_turn)
    push = minus(minus(plus(turned_back(r, force.tolist()), carried), along), times(body.mass, cross(omega, v)))
    gyration = cross(omega, turned(inertia, omega))
    twisting = minus(minus(plus(turned_back(r, torque.tolist()), carried_turn), around), gyration)
    moving = None if between is None else between * np.outer(free, free)
    rate, twist = sped_up(body.mass, inertia, water, moving, push, twisting)
    answer, answer_turn = swept(water, moving, rate, twist)
    moved = turned(r, plus(answer, along)), turned(r, plus(answer_turn, around))
    return -np.array(moved), np.array([turned(r, carried), turned(r, carried_turn)])


def halves(motion: np.ndarray) -> tuple[list[float], list[float]]:
    """Of (6,) along and about the axes, as plain numbers."""
    six = motion.tolist()
    return six[:3], six[3:]


def swept(water: list[float], between: np.ndarray | None, line: Vector, turn: Vector) -> tuple[Three, Three]:
    """Momentum and angular momentum of the water that moves along at such velocities, or their rates at such
    accelerations."""
    own = scaled(water[:3], line), scaled(water[3:], turn)
    if between is None:
        return own
    more = halves(between @ [*line, *turn])
    return plus(own[0], more[0]), plus(own[1], more[1])


def sped_up(
    mass: float, inertia: Rows, water: list[float], between: np.ndarray | None, push: Vector, twisting: Vector
) -> tuple[Vector, Vector]:
    """Acceleration [m/s2] and angular one [rad/s2] of hull and water together under a force [N] and a torque [N m]."""
    x, y, z = water[3:]
    (p, q, r), (s, t, u), (v, w, o) = inertia
    whole = (p + x, q, r), (s, t + y, u), (v, w, o + z)
    heavy = [mass + more for more in water[:3]]
    if between is None:
        (a, b, c), (k, l, m) = push, heavy
        return (a / k, b / l, c / m), solved(whole, twisting)
    both = between + np.diag(heavy + [0.0, 0.0, 0.0])
    both[3:, 3:] += whole
    return halves(np.linalg.solve(both, [*push, *twisting]))
