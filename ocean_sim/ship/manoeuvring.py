"""A ship of a published manoeuvring model: one with MMG coefficients, or the Otter, a catamaran of 2 m.

The Otter: T. I. Fossen, PythonVehicleSimulator (MIT), otter.py, and Fossen (2021), Handbook of Marine Craft
Hydrodynamics and Motion Control, 2nd ed., Wiley; cross-flow drag by Hoerner's curve. Both hold in calm water and for
small heel and trim; current, first-order waves and wind are added.

The ship is carried by the motion of the plane waves' water, averaged over a box. Relative to this water she moves as in
calm water, so first-order motions are superposed on her manoeuvre. With velocities averaged over the volume and heights
over the waterplane the force on a box is exactly that of undisturbed waves (Froude & Krylov): their pressure on its
bottom is what the height weighs plus its mass times their mean acceleration. Added mass and damping act on the motion
relative to that mean. Roll is driven by the mean slope alone.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import reduce
from math import exp, hypot, pi, sqrt
from typing import ClassVar, Literal

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.conventions import AIR_DENSITY, from_frame, to_frame
from ocean_sim.fluid import Arriving, Fluid, Limits
from ocean_sim.model import Faults, Model, Vector3, quantity
from ocean_sim.parts import LedgerRow, SceneFacts
from ocean_sim.ship import Load, Ship
from ocean_sim.ship.body.rigid_body import axis_rotation, euler_quaternion
from ocean_sim.ship.body.vessel import Actuators, Vessel, VesselConfig
from ocean_sim.ship.forces.mmg import MmgCoefficients, MmgHull
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
STOPPING_RUDDER = pi * 35.0 / 180.0  # [rad] rudder order at which one propeller stops at half throttle on both
HOERNER_DRAG = (
    (0.0109, 0.1766, 0.3530, 0.4519, 0.4728, 0.4929, 0.4933, 0.5585, 0.6464, 0.8336)
    + (0.9880, 1.3081, 1.6392, 1.8600, 2.3129, 2.6000, 3.0088, 3.4508, 3.7379, 4.0031),
    (1.9661, 1.9657, 1.8976, 1.7872, 1.5837, 1.2786, 1.2108, 1.0836, 0.9986, 0.8796)
    + (0.8284, 0.7599, 0.6914, 0.6571, 0.6307, 0.5962, 0.5868, 0.5859, 0.5599, 0.5593),
)  # breadth over twice the draught, coefficient of drag


class Windage(Model):
    """Forces q A_F c_x cos g ahead, q A_L c_y sin g to port and moment q A_L L c_n sin 2g to starboard, q = rho_a V^2 /
    2, of a real wind V relative to her that goes to g, to port of her heading (Fossen 2021, 10.1)."""

    frontal: float = quantity("m2", gt=0.0)
    """A_F: area above the water, seen from ahead."""
    lateral: float = quantity("m2", gt=0.0)
    """A_L: area above the water, seen from abeam."""
    coefficients: Vector3 = quantity("1", (0.7, 0.85, 0.1))
    """c_x, c_y, c_n: the middle of what Fossen gives (0.5 to 0.9, 0.7 to 0.95, 0.05 to 0.2)."""

    def wind_load(self, ahead: float, port: float, length: float) -> np.ndarray:
        """(6,) load [N], [N m], SNAME axes, of a wind with the relative velocity `ahead` (towards the bow) and `port`
        [m/s] on a ship of a `length` [m]."""
        (c_x, c_y, c_n), speed = self.coefficients, hypot(ahead, port)
        front, side = (0.5 * AIR_DENSITY * area for area in (self.frontal, self.lateral))
        turn = side * length * c_n * 2.0 * ahead * port  # away from a wind on the bow
        return np.array([front * c_x * speed * ahead, -side * c_y * speed * port, 0.0, 0.0, 0.0, turn])


class Config(VesselConfig):
    """Start and crew of a ship that moves by a manoeuvring model, and the numbers of that model."""

    needs_surface: ClassVar[bool] = False
    kind: Literal["manoeuvring"] = "manoeuvring"
    mmg: MmgCoefficients | None = None
    """Coefficients of the standard MMG model; null: the Otter's model, which has its own."""
    windage: Windage | None = None
    """Areas on which a wind of kind `stress` acts; null: none does."""

    @property
    def feels_wind(self) -> bool:
        return self.windage is not None

    def problems(self, preflight: SceneFacts) -> Faults:
        yield from self.basin_problems(preflight.tank)
        if self.mmg is not None and self.mmg.size[2] >= (deep := preflight.tank.depth):
            yield ("mmg",), f"the ship draws {self.mmg.size[2]:g} m, the water is {deep:g} m deep"

    def warnings(self, preflight: SceneFacts) -> Iterator[str]:
        yield from super().warnings(preflight)
        model = "the Otter's model" if self.mmg is None else "her MMG model"
        seas = "plane waves, not those on tiles (order 3), carry her to first order, superposed, without drift"
        seas = "waves do not move her" if preflight.fluid.made_of_particles else seas
        wind = "no wind acts on her (windage is null)" if self.windage is None else "a stress acts on her by windage"
        yield f"{model} is of calm water: {seas}; a current does; {wind}"

    def ledger(self, preflight: SceneFacts) -> list[LedgerRow]:
        model = "the Otter's model" if self.mmg is None else "an MMG model"
        return [LedgerRow("ship", f"the matrices of {model}", 0, "ship.kind is manoeuvring")]

    def build(self, name: str, basin: Basin, fluid: Fluid) -> Ship:
        return Manoeuvring(name, self, basin, fluid)


def wave_motion(
    waves: Arriving, yaw: float, velocity: np.ndarray, box: tuple[float, float, float], depth: float
) -> np.ndarray:
    """Mean motion of waves over a ship's box, as (3, 6) in SNAME axes: velocity of the water [m/s], [rad/s], its rate
    of change seen from the ship, and surface height and slope [m], [rad]. `yaw`: heading [rad]; `velocity` (3,): hers
    through the water [m/s]; `box`: length, breadth, draught [m]; `depth` of the water [m]."""
    (length, breadth, draught), k, angle = box, waves.wavenumber, waves.heading - yaw
    along, aside = k * np.cos(angle), k * np.sin(angle)
    across = np.sinc(aside * breadth / (2.0 * np.pi))
    mean, x = np.sinc(along * length / (2.0 * np.pi)) * across, np.maximum(np.abs(along) * length / 2.0, 1e-3)
    tilt = 3.0 * (np.sin(x) - x * np.cos(x)) / x**3 * across  # slope fitted along her
    echo, end, bed = np.exp(-2.0 * k * depth), np.exp(-k * draught), np.exp(k * (draught - 2.0 * depth))
    speed = waves.omega / ((1.0 - echo) * k * draught)
    level, upright = speed * (1.0 - end + bed - echo), speed * (1.0 - end - bed + echo)  # over the draught
    none, turn = 0.0 * k, level * tilt * np.sin(angle)
    flow = [level * mean * np.cos(angle), -level * mean * np.sin(angle), 1j * upright * mean, none]
    flow += [along * upright * tilt, -1j * along * turn]
    place = [none, none, -mean, 1j * aside * mean, 1j * along * tilt, none]
    seen = -1j * waves.encounter_frequencies(velocity) * np.array(flow)
    return (np.array([flow, seen, place]) * waves.amplitude * np.exp(1j * waves.angle)).real.sum(axis=2)


def skew_matrix(a: np.ndarray) -> np.ndarray:
    """(3, 3) matrix S of a vector a (3,), with S b = a x b for any b."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def shift_matrix(arm: np.ndarray) -> np.ndarray:
    """(6, 6) matrix from the linear and angular velocity (6,) of a body at one point to those at `arm` (3,) [m]."""
    whole = np.eye(6)
    whole[:3, 3:] = skew_matrix(arm).T
    return whole


class Otter:
    """Mass, stiffness and damping of the Otter, in SNAME axes about its origin amidships at the still water."""

    payload_mass, propeller_delay, time_scale, blade, level = PAYLOAD_MASS, 0.1, 0.08, None, False  # [kg], [s], [s]

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
        self.box = HULL_LENGTH, OVERALL_BREADTH, self.draught
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

    def driving_loads(self, nu: np.ndarray, revolutions: np.ndarray, rudder: float) -> dict[str, np.ndarray]:
        """(6,) load `propeller`: force [N] and torque [N m] of both propellers about the model's origin, SNAME axes, at
        (2,) `revolutions` [rad/s], port and starboard; velocity `nu` (6,) and `rudder` are not used."""
        n = revolutions
        port, starboard = np.where(n > 0.0, AHEAD_COEFFICIENT, ASTERN_COEFFICIENT) * n * np.abs(n)
        return {"propeller": np.array([port + starboard, 0.0, 0.0, 0.0, 0.0, PONTOON_OFFSET * (port - starboard)])}

    def ordered_revolutions(self, throttle: float, rudder: float) -> np.ndarray:
        """(2,) speed [rad/s] of the port and the starboard propeller, ordered by throttle and rudder."""
        share = np.clip(throttle + np.array([-1.0, 1.0]) * rudder / STOPPING_RUDDER, -1.0, 1.0)
        return np.where(share > 0.0, MAX_REVOLUTIONS, MAX_ASTERN_REVOLUTIONS) * share


class Manoeuvring(Vessel):
    """Ship moved by a manoeuvring model; her rigid body is hull and payload, about their common centre of mass."""

    prompt: ClassVar[bool] = True

    def __init__(self, name: str, config: Config, basin: Basin, fluid: Fluid) -> None:
        model: Otter | MmgHull = Otter()
        if config.mmg is not None:
            model = MmgHull(config.mmg, fluid.rest_density, -basin.gravity[1])
        self.model, self.windage, self.depth = model, config.windage, basin.depth
        centre = from_frame("ned", model.centre)
        keel = np.array([centre[0], model.draught + centre[1], centre[2]])
        inertia = from_frame("ned", from_frame("ned", model.inertia).T)
        matter = Matter(model.mass, keel, inertia)
        body = config.body_at_start(matter, float(centre[1]), euler_quaternion(0.0, 0.0, 0.0))
        super().__init__(name, config, body, Actuators(config, None, model.blade, keel), basin.lower[1])
        self.arm = centre  # of the centre of mass from the model's origin, our axes [m]
        self.revolutions = np.zeros_like(model.ordered_revolutions(0.0, 0.0))  # of the propellers, from port

    def load(self, wind: Wind, fluid: Fluid, surface: Surface | Fluid) -> Load:
        """Forces and torques of the model about the centre of mass, by the velocity relative to current and waves of
        `fluid` (Fossen 2021, ch. 10); `surface` is not used. Waves add their acceleration, a steady current none."""
        model, body = self.model, self.centred_body
        pitch, yaw, roll = body.angles
        r, omega, turning, inertia = body.matrix, body.rates, body.rates, body.inertia_body
        if model.level:  # so that waves do not tilt the forces of the manoeuvre
            r = axis_rotation(1, yaw)
            tilt = r.T @ body.matrix
            omega, inertia = tilt @ omega, tilt @ inertia @ tilt.T
            turning = omega * [0.0, 1.0, 0.0]
        u, w = fluid.current
        through = body.velocity - np.array([u, 0.0, w])
        sea, (x, _, z) = fluid.in_closed_form, body.position.tolist()
        flow, surge, place = np.zeros((3, 6))
        if sea is not None:
            flow, surge, place = wave_motion(sea.arriving(x, z), yaw, through, model.box, self.depth)
        origin = r.T @ through - np.cross(omega, self.arm)
        spin = to_frame("ned", omega)
        nu = np.concatenate([to_frame("ned", origin), spin]) - flow
        low = -(body.position - r @ self.arm)[1]
        displacement = np.array([0.0, 0.0, low, roll, -pitch, 0.0]) - place
        weight = to_frame("ned", r.T @ np.array([0.0, -model.payload_mass * G, 0.0]))
        parts = {
            "gravity": np.concatenate([weight, np.cross(model.payload, weight)]),
            "buoyancy": -model.spring @ displacement,
            "damping": model.drag_load(nu) - model.centripetal_load(np.concatenate([nu[:3], spin])),
            **model.driving_loads(nu, self.revolutions, self.orders[1]),
        }
        if self.windage is not None:
            port, _, ahead = r.T @ (np.insert(wind.real_velocity, 1, 0.0) - body.velocity)
            parts["wind_drag"] = self.windage.wind_load(ahead, port, model.box[0])
        rate = np.linalg.solve(model.whole, sum(parts.values())) + surge
        twist = from_frame("ned", rate[3:]) + np.cross(turning, omega)
        line = from_frame("ned", rate[:3]) + np.cross(turning, from_frame("ned", nu[:3]))
        line += np.cross(twist, self.arm) + np.cross(omega, np.cross(omega, self.arm))
        turn = inertia @ twist + np.cross(omega, inertia @ omega)
        shared = {name: self.about_centre(load) for name, load in parts.items()}
        others = [load for name, load in shared.items() if name != "damping"]
        whole = np.stack([body.mass * line, turn])
        shared["damping"] = reduce(np.subtract, others, whole)  # with the added mass, and waves
        return Load.of({name: load @ r.T for name, load in shared.items()}, self.parts)

    def about_centre(self, load: np.ndarray) -> np.ndarray:
        """(2, 3) force [N], torque [N m] about the centre of mass, body axes, of a SNAME load (6,) about the origin."""
        force, torque = from_frame("ned", load[:3]), from_frame("ned", load[3:])
        return np.stack([force, torque - np.cross(self.arm, force)])

    def advance(self, load: Load, dt: float) -> None:
        """Take a leapfrog step of dt [s]; propellers follow the mean of the orders before and after it with a delay."""
        body, before, (of, *gained) = self.body, self.model.ordered_revolutions(*self.orders), self.gained
        if of is not body or not np.any(gained):  # it begins: its velocities are still of the time of its place
            slower, less = load.force / body.mass * dt / 2.0, load.torque * dt / 2.0
            self.body = replace(body, velocity=body.velocity - slower, angular_momentum=body.angular_momentum - less)
        super().advance(load, dt)
        mean = (before + self.model.ordered_revolutions(*self.orders)) / 2.0
        self.revolutions = mean + (self.revolutions - mean) * exp(-dt / self.model.propeller_delay)

    def limits(self) -> Limits:
        return Limits(force=self.model.time_scale)
