"""Waves and wind on a ship of a manoeuvring model.

She is carried by the motion of the plane waves' water, averaged over a box. Relative to this water she moves as in calm
water, so first-order motions are superposed on her manoeuvre. With velocities averaged over the volume and heights over
the waterplane the force on a box is exactly that of undisturbed waves (Froude & Krylov): their pressure on its bottom
is what the height weighs plus its mass times their mean acceleration. Added mass and damping act on the motion relative
to that mean. Roll is driven by the mean slope alone.
"""

from math import hypot

import numpy as np

from ocean_sim.conventions import AIR_DENSITY
from ocean_sim.fluid import Arriving
from ocean_sim.model import Model, Vector3, quantity


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
