"""What slows a hull down: linear in heave, pitch and roll, quadratic in surge and across, and lift at the stern."""

from math import pi, sqrt

import numpy as np

from ocean_sim.conventions import Motions
from ocean_sim.model import Model, quantity
from ocean_sim.ship.shared.hydrostatics import Hydrostatics


class Damping(Model):
    """Shares of critical damping, and coefficients of drag; the defaults are ours, of a bare hull of common form."""

    heave: float = quantity("1", 0.12, ge=0.0)
    """Of critical: mostly the waves that it makes."""
    pitch: float = quantity("1", 0.06, ge=0.0)
    """Of critical."""
    roll: float = quantity("1", 0.05, ge=0.0)
    """Of critical: mostly eddies, so a bare guess for any hull."""
    surge: float | None = quantity("N s2/m2", None, ge=0.0)
    """Resistance over the square of the speed; null: a coefficient of 0.1 on the largest section."""
    cross_flow: float = quantity("1", 0.8, ge=0.0)
    """Coefficient of drag of the sections as water crosses them (Hoerner 1965, Fluid-Dynamic Drag)."""
    roll_quadratic: float = quantity("N m s2", 0.0, ge=0.0)
    """Moment over the square of the roll rate."""

    def beside(self, motions: list[str]) -> "Damping":
        """The same where the waves of some motions are told otherwise: of these what was given, and no default."""
        return self.model_copy(update={name: 0.0 for name in motions if name not in self.model_fields_set})


class Resistance:
    """The damping of one hull."""

    def __init__(self, config: Damping, hull: Hydrostatics, added: np.ndarray) -> None:
        """`added`: (6,) added mass, part of what oscillates."""
        whole, stiffness = hull.inertia, hull.stiffness
        extra = Motions(*added)
        self.linear = np.zeros(6)
        for number, motion in ((1, "heave"), (3, "pitch"), (5, "roll")):
            inertia = whole[motion] + getattr(extra, motion)
            self.linear[number] = 2.0 * getattr(config, motion) * sqrt(inertia * abs(stiffness[motion]))
        z, breadth, draught = hull.stations
        self.z = z - hull.matter.centre[2]
        self.crossing = 0.5 * hull.density * config.cross_flow * draught * float(hull.voxels.size[2])
        section = float((breadth * draught).max())
        self.surge = 0.05 * hull.density * section if config.surge is None else config.surge
        self.roll = config.roll_quadratic
        self.low = hull.keel + float(draught.max()) / 2.0 - hull.matter.centre[1]  # where water crosses [m]
        self.stern = float(self.z[draught > 0.0].min())
        self.lift = pi / 2.0 * hull.density * float(draught.mean()) ** 2  # of a slender body that ends in a stern

    def load(self, motion: np.ndarray) -> np.ndarray:
        """(2, 3) force [N] and torque [N m] in body axes at a velocity relative to the water (6,), body axes."""
        sway, _, surge, _, yaw, roll = motion.tolist()
        middle = sway - roll * self.low  # where water crosses amidships (4.15)
        across = middle + yaw * self.z
        drag = self.crossing * np.abs(across) * across
        lift = -self.lift * max(surge, 0.0) * (middle + yaw * self.stern)
        side = lift - float(drag.sum())
        turning = lift * self.stern - float((drag * self.z).sum())
        more = [
            side,
            0.0,
            -self.surge * abs(surge) * surge,
            0.0,
            turning,
            -side * self.low - self.roll * abs(roll) * roll,
        ]
        return (more - self.linear * motion).reshape(2, 3)
