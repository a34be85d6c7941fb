"""The Otter, a catamaran of 2 m that steers by two propellers: a published manoeuvring model, in still water.

Model and numbers: T. I. Fossen, PythonVehicleSimulator (MIT), otter.py, and Fossen (2021), Handbook of Marine Craft
Hydrodynamics and Motion Control, 2nd ed., Wiley; cross-flow drag by Hoerner's curve. It knows neither waves nor wind,
and holds for small heel and trim.
"""

from dataclasses import replace
from math import exp, pi, sqrt
from typing import ClassVar, Literal

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.conventions import from_frame, to_frame
from ocean_sim.fluid import Fluid, Limits
from ocean_sim.parts import LedgerRow, Preflight, Problems
from ocean_sim.ship import Load, Ship
from ocean_sim.ship.body.rigid_body import euler_quaternion
from ocean_sim.ship.body.vessel import Actuators, Vessel, VesselConfig
from ocean_sim.ship.naval.hydrostatics import Matter
from ocean_sim.surface import Surface
from ocean_sim.wind import Wind

G, WATER_DENSITY, CROSSED_DENSITY = 9.81, 1025.0, 1026.0  # [m/s2], [kg/m3]; the second is that of its cross-flow drag
HULL_LENGTH, OVERALL_BREADTH = 2.0, 1.08  # [m]
PONTOON_BREADTH, PONTOON_OFFSET = 0.25, 0.395  # [m] of one hull, and its distance from the middle
HULL_MASS, PAYLOAD_MASS = 55.0, 25.0  # [kg]
AHEAD_COEFFICIENT, ASTERN_COEFFICIENT = 0.02216 / 2.0, 0.01289 / 2.0  # thrust over revolutions squared [N s2]
MAX_REVOLUTIONS = sqrt(0.5 * 24.4 * G / AHEAD_COEFFICIENT)  # [rad/s]
MAX_ASTERN_REVOLUTIONS = sqrt(0.5 * 13.6 * G / ASTERN_COEFFICIENT)  # [rad/s] astern
PROPELLER_DELAY = 0.1  # [s] of the propellers
STOPPING_RUDDER = pi * 35.0 / 180.0  # [rad] rudder order at which one propeller stops at half throttle on both
HOERNER_DRAG = (
    (0.0109, 0.1766, 0.3530, 0.4519, 0.4728, 0.4929, 0.4933, 0.5585, 0.6464, 0.8336)
    + (0.9880, 1.3081, 1.6392, 1.8600, 2.3129, 2.6000, 3.0088, 3.4508, 3.7379, 4.0031),
    (1.9661, 1.9657, 1.8976, 1.7872, 1.5837, 1.2786, 1.2108, 1.0836, 0.9986, 0.8796)
    + (0.8284, 0.7599, 0.6914, 0.6571, 0.6307, 0.5962, 0.5868, 0.5859, 0.5599, 0.5593),
)  # breadth over twice the draught, coefficient of drag


class Config(VesselConfig):
    """Start and crew of the ship; all other numbers are those of the model."""

    needs_surface: ClassVar[bool] = False
    kind: Literal["manoeuvring"] = "manoeuvring"

    def problems(self, preflight: Preflight) -> Problems:
        return self.basin_problems(preflight.tank)

    def warnings(self, preflight: Preflight) -> list[str]:
        calm = "the Otter's model is of calm water: neither waves nor wind act on it"
        return [*super().warnings(preflight), calm]

    def ledger(self, preflight: Preflight) -> list[LedgerRow]:
        return [LedgerRow("ship", "the matrices of the Otter's model", 0, "ship.kind is manoeuvring")]

    def build(self, name: str, basin: Basin, fluid: Fluid) -> Ship:
        return Manoeuvring(name, self, basin)


def skew_matrix(a: np.ndarray) -> np.ndarray:
    """(3, 3) matrix S of a vector a (3,), with S b = a x b for any b."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def shift_matrix(arm: np.ndarray) -> np.ndarray:
    """(6, 6) matrix from the velocity (6,), linear and angular, of a body at one point to that `arm` (3,) [m] away."""
    whole = np.eye(6)
    whole[:3, 3:] = skew_matrix(arm).T
    return whole


class Otter:
    """Mass, stiffness and damping of the Otter, in SNAME axes about its origin amidships at the still water."""

    def __init__(self) -> None:
        self.mass = HULL_MASS + PAYLOAD_MASS
        self.payload = np.array([0.05, 0.0, -0.35])
        self.centre = (HULL_MASS * np.array([0.2, 0.0, -0.2]) + PAYLOAD_MASS * self.payload) / self.mass
        volume = self.mass / WATER_DENSITY
        self.draught = volume / (2.0 * 0.4 * PONTOON_BREADTH * HULL_LENGTH)
        gyration = np.array([0.4 * OVERALL_BREADTH, 0.25 * HULL_LENGTH, 0.25 * HULL_LENGTH])
        own, load = skew_matrix(self.centre), skew_matrix(self.payload)
        self.inertia = HULL_MASS * np.diag(gyration**2) - HULL_MASS * own @ own - PAYLOAD_MASS * load @ load
        at_centre = np.zeros((6, 6))
        at_centre[:3, :3], at_centre[3:, 3:] = self.mass * np.eye(3), self.inertia
        self.shift = shift_matrix(self.centre)
        diagonal = np.diag(self.inertia)
        self.added = np.array(
            [0.1 * HULL_MASS, 1.5 * HULL_MASS, HULL_MASS, 0.2 * diagonal[0], 0.8 * diagonal[1], 1.7 * diagonal[2]]
        )
        self.whole = self.shift.T @ at_centre @ self.shift + np.diag(self.added)
        plane = 0.75 * HULL_LENGTH * PONTOON_BREADTH
        roll = HULL_LENGTH * PONTOON_BREADTH**3 / 6.0 * (6.0 * 0.75**3 / (1.75 * 2.5)) + 2.0 * plane * PONTOON_OFFSET**2
        pitch = 0.8 / 6.0 * PONTOON_BREADTH * HULL_LENGTH**3
        kb = (2.5 * self.draught - 0.5 * volume / (HULL_LENGTH * PONTOON_BREADTH)) / 3.0
        above = kb - (self.draught - self.centre[2])
        spring = WATER_DENSITY * G * np.array([2.0 * plane, roll + volume * above, pitch + volume * above])
        at_flotation = np.diag([0.0, 0.0, *spring, 0.0])
        flotation = shift_matrix(np.array([-0.2, 0.0, 0.0]))
        self.spring = flotation.T @ at_flotation @ flotation
        m = np.diag(self.whole)
        omega = np.sqrt(spring / m[2:5])
        swing = 2.0 * np.array([0.3, 0.2, 0.4]) * omega * m[2:5]
        self.damping = np.array([24.4 * G / (6.0 * 0.5144), m[1], *swing, m[5]])
        self.across = float(np.interp(PONTOON_BREADTH / (2.0 * self.draught), *HOERNER_DRAG))

    def drag_load(self, nu: np.ndarray) -> np.ndarray:
        """(6,) drag [N], [N m] at a velocity `nu` (6,) relative to the water: linear, quadratic in yaw, cross-flow."""
        load = -self.damping * nu
        load[5] -= 10.0 * self.damping[5] * abs(nu[5]) * nu[5]
        x = np.linspace(-HULL_LENGTH / 2.0, HULL_LENGTH / 2.0, 21)
        speed = nu[1] + x * nu[5]
        strip = -0.5 * CROSSED_DENSITY * self.draught * self.across * np.abs(speed) * speed * HULL_LENGTH / 20.0
        load[1] += strip.sum()
        load[5] += (x * strip).sum()
        return load

    def centripetal_load(self, nu: np.ndarray) -> np.ndarray:
        """(6,) Coriolis and centripetal load C(nu) nu [N], [N m] of hull and added mass (Fossen 2021, 3.3)."""
        own = np.zeros((6, 6))
        own[:3, :3], own[3:, 3:] = self.mass * skew_matrix(nu[3:]), -skew_matrix(self.inertia @ nu[3:])
        moved = self.added * nu
        water = np.zeros((6, 6))
        water[:3, 3:] = water[3:, :3] = -skew_matrix(moved[:3])
        water[3:, 3:] = -skew_matrix(moved[3:])
        return (self.shift.T @ own @ self.shift + water) @ nu


class Manoeuvring(Vessel):
    """Ship that moves by the Otter model; its rigid body is hull and payload, about their common centre of mass."""

    prompt: ClassVar[bool] = True

    def __init__(self, name: str, config: Config, basin: Basin) -> None:
        self.model = model = Otter()
        centre = from_frame("ned", model.centre)
        keel = np.array([centre[0], model.draught + centre[1], centre[2]])
        inertia = from_frame("ned", from_frame("ned", model.inertia).T)
        matter = Matter(model.mass, keel, inertia)
        body = config.body_at_start(matter, float(centre[1]), euler_quaternion(0.0, 0.0, 0.0))
        super().__init__(name, config, body, Actuators(config, None, None, keel), basin.lower[1])
        self.arm = centre  # of the centre of mass from the model's origin, our axes [m]
        self.revolutions = np.zeros(2)  # port and starboard [rad/s]

    def load(self, wind: Wind, fluid: Fluid, surface: Surface | Fluid) -> Load:
        """All forces and torques of the model about the centre of mass, by the velocity relative to the water (Fossen
        2021, ch. 10). A steady current changes no acceleration in world axes."""
        model, body = self.model, self.centred_body
        r, omega = body.matrix, body.rates
        u, w = fluid.current
        origin = r.T @ (body.velocity - np.array([u, 0.0, w])) - np.cross(omega, self.arm)
        nu = np.concatenate([to_frame("ned", origin), to_frame("ned", omega)])
        pitch, _, roll = body.angles
        low = -(body.position - r @ self.arm)[1]
        displacement = np.array([0.0, 0.0, low, roll, -pitch, 0.0])
        weight = to_frame("ned", r.T @ np.array([0.0, -PAYLOAD_MASS * G, 0.0]))
        parts = {
            "gravity": np.concatenate([weight, np.cross(model.payload, weight)]),
            "buoyancy": -model.spring @ displacement,
            "damping": model.drag_load(nu) - model.centripetal_load(nu),
            "propeller": self.propeller_load(),
        }
        rate = np.linalg.solve(model.whole, sum(parts.values()))
        spin, twist = from_frame("ned", nu[3:]), from_frame("ned", rate[3:])
        line = from_frame("ned", rate[:3]) + np.cross(spin, origin)
        line += np.cross(twist, self.arm) + np.cross(spin, np.cross(spin, self.arm))
        turn = body.inertia_body @ twist + np.cross(spin, body.inertia_body @ spin)
        whole = np.stack([body.mass * line, turn])
        shared = {name: self.about_centre(load) for name, load in parts.items()}
        shared["damping"] = whole - shared["gravity"] - shared["buoyancy"] - shared["propeller"]  # and the added mass
        return Load.of({name: load @ r.T for name, load in shared.items()}, self.parts)

    def about_centre(self, load: np.ndarray) -> np.ndarray:
        """(2, 3) force [N], torque [N m] about the centre of mass, body axes, of a (6,) load about the origin."""
        force, torque = from_frame("ned", load[:3]), from_frame("ned", load[3:])
        return np.stack([force, torque - np.cross(self.arm, force)])

    def propeller_load(self) -> np.ndarray:
        """(6,) force [N] and torque [N m] of both propellers about the model's origin, SNAME axes."""
        n = self.revolutions
        port, starboard = np.where(n > 0.0, AHEAD_COEFFICIENT, ASTERN_COEFFICIENT) * n * np.abs(n)
        return np.array([port + starboard, 0.0, 0.0, 0.0, 0.0, PONTOON_OFFSET * (port - starboard)])

    @property
    def ordered_revolutions(self) -> np.ndarray:
        """(2,) speed [rad/s] of the port and the starboard propeller, ordered by the crew's throttle and rudder."""
        throttle, rudder = self.orders
        share = np.clip(throttle + np.array([-1.0, 1.0]) * rudder / STOPPING_RUDDER, -1.0, 1.0)
        return np.where(share > 0.0, MAX_REVOLUTIONS, MAX_ASTERN_REVOLUTIONS) * share

    def advance(self, load: Load, dt: float) -> None:
        """Take a step of dt [s], second-order (leapfrog): velocities stay half a step behind the position, and the
        propellers follow the mean of the orders before and after the step, with a delay."""
        body, before, (of, *gained) = self.body, self.ordered_revolutions, self.gained
        if of is not body or not np.any(gained):  # it begins: its velocities are still of the time of its place
            slower, less = load.force / body.mass * dt / 2.0, load.torque * dt / 2.0
            self.body = replace(body, velocity=body.velocity - slower, angular_momentum=body.angular_momentum - less)
        super().advance(load, dt)
        mean = (before + self.ordered_revolutions) / 2.0
        self.revolutions = mean + (self.revolutions - mean) * exp(-dt / PROPELLER_DELAY)

    def limits(self) -> Limits:
        return Limits(force=0.08)
