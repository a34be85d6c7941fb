"""Water that moves with a hull, by rule from its sections, and the motion of hull and water together.

By rule: half the added mass of flat plates as broad as the sections at the still water in heave, pitch and roll
(Newman 1977, Marine Hydrodynamics, table 4.3), with Pabst's factor for a length that is not infinite (Pabst 1930), in
pitch that of each half of the ship; half of circles as deep as the sections in sway and yaw; a twentieth of the mass
in surge (Fossen 2021, Handbook of Marine Craft Hydrodynamics, 6.5).
"""

from math import pi, sqrt

import numpy as np

from ocean_sim.model import Model, quantity
from ocean_sim.ship.shared.hydrostatics import Hydrostatics
from ocean_sim.ship.shared.rigid_body import RigidBody, cross, solved


class AddedMass(Model):
    """Added mass about the centre of mass, body axes; what is null comes by rule from the hull."""

    sway: float | None = quantity("kg", None, ge=0.0)
    heave: float | None = quantity("kg", None, ge=0.0)
    surge: float | None = quantity("kg", None, ge=0.0)
    pitch: float | None = quantity("kg m2", None, ge=0.0)
    yaw: float | None = quantity("kg m2", None, ge=0.0)
    roll: float | None = quantity("kg m2", None, ge=0.0)

    def diagonal(self, hull: Hydrostatics) -> np.ndarray:
        """(6,) in the order of `Motions`."""
        given = [self.sway, self.heave, self.surge, self.pitch, self.yaw, self.roll]
        return np.array([rule if value is None else value for value, rule in zip(given, by_rule(hull))])


def by_rule(hull: Hydrostatics) -> np.ndarray:
    """(6,) added mass [kg] and inertia [kg m2] of a hull at its draught."""
    z, breadth, draught = hull.stations
    ds, rho = float(hull.voxels.size[2]), hull.density
    z = z - hull.matter.centre[2]
    length, broad = ds * np.count_nonzero(breadth > 0.0), float(breadth.max())
    plate, circle = rho * pi / 8.0 * breadth**2 * ds, rho * pi / 2.0 * draught**2 * ds  # of each slice [kg]
    return np.array(
        [
            circle.sum(),
            slenderness(length / broad) * plate.sum(),
            0.05 * hull.matter.mass,
            slenderness(length / 2.0 / broad) * (plate * z**2).sum(),
            (circle * z**2).sum(),
            (rho * pi / 256.0 * breadth**4 * ds).sum(),
        ]
    )


def slenderness(ratio: float) -> float:
    """Pabst's factor of a plate so many times as long as broad (or as broad as long)."""
    r = max(ratio, 1.0 / ratio)
    return r / sqrt(1.0 + r * r) * (1.0 - 0.425 * r / (1.0 + r * r))


def reaction(
    body: RigidBody, added: np.ndarray, force: np.ndarray, torque: np.ndarray, drift: np.ndarray, surge: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """What the water that is moved does back, (2, 3) each in world axes: to a hull that moves, and by moving itself.

    Kirchhoff's equations with a diagonal added mass (6,) in body axes, the rest of the load [N], [N m] in world axes,
    and the water's own velocity and acceleration (6,) in body axes. They are solved together with the hull, so a light
    body is no harder than a heavy one.
    """
    r = body.matrix
    line, turn = added[:3], added[3:]
    v, omega = r.T @ body.velocity, body.rates
    v_r, omega_r = v - drift[:3], omega - drift[3:]
    spin = body.inertia_body @ omega
    momentum = line * v_r
    along = cross(omega, momentum)
    around = cross(omega, turn * omega_r) + cross(v_r, momentum)
    carried = (added * surge).reshape(2, 3)
    rate = (r.T @ force + carried[0] - along - body.mass * cross(omega, v)) / (body.mass + line)
    whole = body.inertia_body + np.diag(turn)
    twist = solved(whole, r.T @ torque + carried[1] - around - cross(omega, spin))
    moved = -np.array([line * rate + along, turn * twist + around])
    return moved @ r.T, carried @ r.T
