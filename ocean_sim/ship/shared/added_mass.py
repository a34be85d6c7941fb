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
from ocean_sim.ship.shared.rigid_body import RigidBody, cross, solved

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
) -> tuple[np.ndarray, np.ndarray]:
    """What the water that is moved does back, (2, 3) each in world axes: to a hull that moves, and by moving itself.

    Kirchhoff's equations with the added mass (6,) of each motion in body axes, and what there is `between` them, (6, 6)
    symmetric with a diagonal of 0; the rest of the load [N], [N m] in world axes, and the water's own velocity and
    acceleration (6,) in body axes; the axes turn with the hull, so there the relative velocity of hull and water
    changes by omega x (the water's own) as well (Fossen 2021, 10.3). They are solved together with the hull, so a
    light body is no harder than a heavy one.
    """
    r = body.matrix
    line, turn = added[:3], added[3:]
    v, omega = r.T @ body.velocity, body.rates
    v_r, omega_r = v - drift[:3], omega - drift[3:]
    spin = body.inertia_body @ omega
    momentum, turning = line * v_r, turn * omega_r
    carried = (added * surge).reshape(2, 3)
    if between is not None:
        more = (between @ np.concatenate([v_r, omega_r])).reshape(2, 3)
        momentum, turning = momentum + more[0], turning + more[1]
        carried = carried + (between @ surge).reshape(2, 3)
    turned = np.concatenate([cross(omega, drift[:3]), cross(omega, drift[3:])])  # of the water, as the axes turn
    kept = added * turned if between is None else added * turned + between @ turned
    along = cross(omega, momentum) + kept[:3]
    around = cross(omega, turning) + cross(v_r, momentum) + kept[3:]
    push = r.T @ force + carried[0] - along - body.mass * cross(omega, v)
    twisting = r.T @ torque + carried[1] - around - cross(omega, spin)
    whole = body.inertia_body + np.diag(turn)
    if between is None:
        rate, twist = push / (body.mass + line), solved(whole, twisting)
        moved = -np.array([line * rate + along, turn * twist + around])
    else:
        inertia = between + np.diag(np.append(body.mass + line, np.zeros(3)))
        inertia[3:, 3:] += whole
        rates = np.linalg.solve(inertia, np.concatenate([push, twisting]))
        moved = -(np.array([along, around]) + (added * rates + between @ rates).reshape(2, 3))
    return moved @ r.T, carried @ r.T
