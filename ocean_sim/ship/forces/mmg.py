"""The standard MMG model of a manoeuvring ship: forces of hull, propeller and rudder in surge, sway and yaw.

Yasukawa & Yoshimura (2015, J. Mar. Sci. Technol. 20). SNAME axes about midships: x ahead, y to starboard, z down.
Lengths are over L, forces over rho L d U^2 / 2, moments over that times L, v' = v / U, r' = r L / U; U counts as at
least |r| L / 2, or the polynomials would have no bound in a turn on the spot. Heave, roll and pitch are added: those of
a box of her length, draught and displacement (Jensen, Mansour & Olsen 2004, Ocean Eng. 31), which rolls by her GM.
"""

from math import asin, copysign, exp, hypot, pi, sin, sqrt
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from ocean_sim.model import Model, Positive3, Vector2, Vector3, quantity
from ocean_sim.ship.forces.propulsion import Rudder

PROPELLER_POSITION = -0.48  # ahead of midships, over L
Terms = dict[Annotated[str, Field(pattern=r"^(v*|b*)r*$", min_length=1)], float]


class ScrewCoefficients(Model):
    """Thrust (1 - t) rho n^2 D^4 (k0 + k1 J + k2 J^2), J = (1 - w) u / (n D), ahead alone, where (1 - w) / (1 - w0) = 1
    + (1 - exp(-C1 |b|)) (C2 - 1) with b the drift angle at the propeller."""

    diameter: float = quantity("m", gt=0.0)
    """D."""
    revolutions: float = quantity("1/s", gt=0.0)
    """n at full throttle, to which it is proportional, with a delay of 2 s; 0 astern."""
    thrust: Vector3 = quantity("1")
    """k0, k1, k2."""
    hull: Vector2 = quantity("1")
    """Thrust deduction t and wake fraction w0."""
    wake_change: Vector3 = quantity("1", (0.0, 1.0, 1.0))
    """C1, and C2 where b is below 0 and where it is above."""


class RudderCoefficients(Rudder):
    """Rudder behind a propeller: force of `Rudder` in a flow that hull and propeller straighten, effect on the hull."""

    height: float = quantity("m", gt=0.0)
    """Span."""
    interaction: Vector3 = quantity("1")
    """t_R: lost share of the force along the ship; a_H: side force on the hull over that of the rudder; x_H: where."""
    straightening: Vector3 = quantity("1")
    """gamma_R where b_R = drift angle - l_R r' is below 0, and where it is above: share of b_R that is left; l_R."""
    stream: Vector2 = quantity("1")
    """epsilon: 1 - w at the rudder over that at the propeller; kappa: share of the far slipstream's speed."""


class MmgCoefficients(Model):
    """Coefficients of one ship in the standard MMG model."""

    size: Positive3 = quantity("m")
    """Length L between perpendiculars, breadth, draught d."""
    volume: float = quantity("m3", gt=0.0)
    """Displacement."""
    centre: Vector2 = quantity("m")
    """Centre of mass: x_G ahead of midships, and KG over the keel."""
    gm: float = quantity("m", gt=0.0)
    """Metacentric height."""
    radii: Vector2 = quantity("m")
    """Radii of gyration: in roll, with the water that moves along, and in yaw, without."""
    roll_damping: float = quantity("1", 0.05, ge=0.0)
    """Share of critical damping."""
    added: Vector3 = quantity("1")
    """m_x and m_y over rho L^2 d / 2, J_z over rho L^4 d / 2: added mass in surge and sway, added inertia in yaw."""
    resistance: float = quantity("1", ge=0.0)
    """R_0: resistance straight ahead."""
    hull: dict[Literal["surge", "sway", "yaw"], Terms] = {}
    """Forces ahead and to starboard and moment to starboard: `vvr` of v' v' r', `br` of drift angle [rad] and r'."""
    propeller: ScrewCoefficients
    rudder: RudderCoefficients


class MmgHull:
    """One ship of the MMG model: masses, stiffness and loads (6,) in SNAME axes about midships at the still water."""

    payload, payload_mass = np.zeros(3), 0.0  # her mass is in equilibrium with the buoyancy
    propeller_delay, level = 2.0, True  # [s]; her axes turn with the heading alone

    def __init__(self, config: MmgCoefficients, density: float, gravity: float) -> None:
        self.config, self.density, self.blade = config, density, config.rudder
        self.length, _, self.draught = self.box = length, _, draught = config.size
        (ahead, kg), (roll, yaw) = config.centre, config.radii
        self.mass, self.centre = mass, _ = density * config.volume, np.array([ahead, 0.0, draught - kg])
        self.inertia = mass * np.diag([roll**2, length**2 / 16.0, yaw**2])
        scale = 0.5 * density * length**2 * draught
        self.added = scale * np.array(config.added) * [1.0, 1.0, length**2]
        own = mass * np.array([1.0, 1.0, 2.0, roll**2, length**2 / 6.0, yaw**2 + ahead**2])  # a box moves as much water
        self.whole = np.diag(own + np.array([*self.added[:2], 0.0, 0.0, 0.0, self.added[2]]))
        self.lever = self.whole[1, 5] = self.whole[5, 1] = mass * ahead
        spring = mass * gravity * np.array([0.0, 0.0, 1.0 / draught, config.gm, length**2 / (12.0 * draught), 0.0])
        self.spring, broad = np.diag(spring), config.volume / (length * draught)  # breadth of the box
        share = (2.0 * sin(broad / (4.0 * draught)) * exp(-0.5)) ** 2 * draught / broad  # of critical, where 2 k d = 1
        shares = np.array([0.0, 0.0, share, config.roll_damping, share, 0.0])
        self.damping = 2.0 * shares * np.sqrt(np.diag(self.whole) * spring)
        self.time_scale = 0.16 * pi * sqrt(2.0 * draught / gravity)  # [s] of heave
        hull = [config.hull.get(motion, {}) for motion in ("surge", "sway", "yaw")]
        self.terms = [[(*map(name.count, "vbr"), c) for name, c in terms.items()] for terms in hull]

    def scaled_motion(self, nu: np.ndarray) -> tuple[float, float, float]:
        """Speed U [m/s] that scales forces, and dimensionless v' and r', at a velocity through the water `nu` (6,): u,
        v, w [m/s] and p, q, r [rad/s] in SNAME axes."""
        u, v, *_, r = nu.tolist()
        speed = max(hypot(u, v), 0.5 * self.length * abs(r), 1e-6)
        return speed, v / speed, r * self.length / speed

    def drag_load(self, nu: np.ndarray) -> np.ndarray:
        """(6,) force [N] and moment [N m] on the bare hull at a velocity `nu` (6,): Yasukawa & Yoshimura 2015, eqs. 7
        and 8, and linear damping of heave, roll and pitch."""
        speed, aside, turning = self.scaled_motion(nu)
        drift = -asin(aside)
        ahead, across, turn = (sum(c * aside**v * drift**b * turning**r for v, b, r, c in row) for row in self.terms)
        ahead -= copysign(self.config.resistance, nu[0])
        load = -self.damping * nu
        scale = 0.5 * self.density * self.length * self.draught * speed**2
        load[[0, 1, 5]] += scale * np.array([ahead, across, turn * self.length])
        return load

    def centripetal_load(self, nu: np.ndarray) -> np.ndarray:
        """(6,) centripetal load of hull, added mass at `nu` less Munk's moment (Yasukawa & Yoshimura 2015, eq. 4)."""
        u, v, r = nu[0], nu[1], nu[5]
        across = -(self.mass + self.added[1]) * v * r - self.lever * r**2
        return np.array([across, (self.mass + self.added[0]) * u * r, 0.0, 0.0, 0.0, self.lever * u * r])

    def ordered_revolutions(self, throttle: float, rudder: float) -> np.ndarray:
        """(1,) revolutions [1/s] of the propeller at a `throttle` from -1 to 1; the rudder has no effect on them."""
        return np.array([max(throttle, 0.0) * self.config.propeller.revolutions])

    def inflow_speed(self, nu: np.ndarray) -> float:
        """Speed (1 - w) u [m/s] of water at the propeller at `nu`, 0 astern (Yasukawa & Yoshimura 2015, eq. 16)."""
        screw, (_, aside, turning) = self.config.propeller, self.scaled_motion(nu)
        angle = asin(-aside) - PROPELLER_POSITION * turning
        fading, below, above = screw.wake_change
        change = (1.0 - exp(-fading * abs(angle))) * ((above if angle > 0.0 else below) - 1.0)
        return (1.0 - screw.hull[1]) * (1.0 + change) * max(nu[0], 0.0)

    def bare_thrust(self, inflow: float, revolutions: float) -> float:
        """Open-water thrust [N] at `inflow` [m/s], `revolutions` [1/s] (Yasukawa & Yoshimura 2015, eqs. 10 to 12)."""
        (k_0, k_1, k_2), diameter = self.config.propeller.thrust, self.config.propeller.diameter
        tip = revolutions * diameter
        return self.density * diameter**2 * (k_0 * tip**2 + k_1 * tip * inflow + k_2 * inflow**2)

    def stream_speed(self, inflow: float, thrust: float) -> float:
        """Flow speed [m/s] at the rudder by propeller inflow [m/s], thrust [N] (Yasukawa & Yoshimura 2015, eq. 24)."""
        (ratio, kept), diameter = self.blade.stream, self.config.propeller.diameter
        far = sqrt(inflow**2 + 8.0 * max(thrust, 0.0) / (pi * self.density * diameter**2))
        share = diameter / self.blade.height
        return ratio * sqrt(share * (inflow + kept * (far - inflow)) ** 2 + (1.0 - share) * inflow**2)

    def driving_loads(self, nu: np.ndarray, revolutions: np.ndarray, rudder: float) -> dict[str, np.ndarray]:
        """(6,) loads [N], [N m] of `propeller` and `rudder`, at a velocity `nu` (6,), revolutions (1,) [1/s] and a
        `rudder` [rad] to port (Yasukawa & Yoshimura 2015, eqs. 9, 18-23)."""
        (below, above, arm), (lost, pushed, where) = self.blade.straightening, self.blade.interaction
        speed, aside, turning = self.scaled_motion(nu)
        inflow = self.inflow_speed(nu)
        thrust = self.bare_thrust(inflow, float(revolutions[0]))
        angle = asin(-aside) - arm * turning
        across = speed * (above if angle > 0.0 else below) * angle
        port, _, ahead = self.blade.blade_force(rudder, across, self.stream_speed(inflow, thrust), self.density)
        turn = -(self.blade.position[2] + pushed * where * self.length) * port
        steered = np.array([(1.0 - lost) * ahead, -(1.0 + pushed) * port, 0.0, 0.0, 0.0, turn])
        return {"propeller": np.eye(6)[0] * (1.0 - self.config.propeller.hull[0]) * thrust, "rudder": steered}
