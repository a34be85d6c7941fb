"""A hull that falls into the water: what it sets in motion as it enters, and what holds it back far from its draught.

The momentum of hull and water is kept while the water that moves along grows, (m + A) V (von Karman 1929, NACA TN 321):
sections as half plates of their wetted breadth, broader by the water that rises beside them. By that Wagner's (1932,
ZAMM 12) added mass is (pi / 2)^2 times von Karman's at a small deadrise, and less for a larger one, by RISE a radian.
RISE is ours: fitted to the forces of similarity solutions of wedges as Zhao & Faltinsen (1993, J. Fluid Mech. 246) are
quoted for them, not checked against the paper; of 10 to 30 degrees within 5 %, of 40 degrees 16 % below. A step has the
impulse of all that it wets, so that its acceleration is a mean over the step and its peak grows as steps become
shorter, up to a limit that it is near once a slam takes many steps (figures: docs/theory/ship.md). The water's mass
grows no further than what moves along with the hull afloat. Going out of the water changes nothing: it falls off the
hull.

A hull that lies half as deep or one and a half times as deep as afloat is a blunt body in heave (Hoerner 1965,
Fluid-Dynamic Drag, 3): BLUNT on its waterplane, all of it from twice as deep and wholly out.
"""

from math import pi

import numpy as np

from ocean_sim.ship.shared.added_mass import slenderness
from ocean_sim.ship.shared.hydrostatics import Hydrostatics

WAGNER = (pi / 2.0) ** 2
RISE = 0.75  # [1/rad]
BLUNT = 1.1  # coefficient of drag


class Slamming:
    """The water that one hull sets in motion as it enters, by the volume that is under water."""

    def __init__(self, hull: Hydrostatics, usual: float) -> None:
        """`usual`: what moves along in heave afloat [kg]."""
        self.volumes, self.masses = entry(hull)
        self.mass, self.usual = hull.matter.mass, usual
        self.volume = min(hull.wanted, hull.voxels.volume)  # afloat [m3]
        self.drag = 0.5 * hull.density * BLUNT * hull.waterplane
        self.entering, self.moved = False, usual  # since it left the water [kg]

    def added(self, volume: float) -> float:
        """What moves along [kg] with so much under water [m3]."""
        return min(float(np.interp(volume, self.volumes, self.masses)), self.usual)

    def push(self, volume: float, speed: float, dt: float) -> float:
        """Force upwards [N] in a step of dt [s] that begins with so much under water [m3], at a vertical speed relative
        to the water [m/s]; it leaves V (m + A before) / (m + A now)."""
        if volume == 0.0:
            self.entering, self.moved = True, 0.0
        if not self.entering:
            return 0.0
        before, now = self.moved, max(self.moved, self.added(volume))
        self.moved, self.entering = now, volume < self.volume
        return -self.mass * min(speed, 0.0) * (now - before) / (self.mass + now) / dt

    def held_back(self, volume: float, speed: float) -> float:
        """Drag in heave, upwards [N], with so much under water [m3] at a vertical speed relative to it [m/s]."""
        depth = volume / self.volume
        unusual = min(max(2.0 * abs(depth - 1.0) - 1.0, 0.0), 1.0)
        return -self.drag * unusual * min(1.0, 2.0 * depth) * abs(speed) * speed


def entry(hull: Hydrostatics) -> tuple[np.ndarray, np.ndarray]:
    """Volumes under water [m3] of an upright hull, layer by layer of its cubes, and what it has set in motion [kg]."""
    v = hull.voxels
    lower = v.centre[:, 1:].min(axis=0)
    layer, slice_ = np.round((v.centre[:, 1:] - lower) / v.size[1:]).astype(int).T
    breadth = np.zeros((int(layer.max()) + 1, int(slice_.max()) + 1))
    np.add.at(breadth, (layer, slice_), v.share * v.size[0])
    volumes = np.cumsum(breadth.sum(axis=1)) * v.size[1] * v.size[2]
    deadrise = np.arctan2(2.0 * v.size[1], np.maximum(np.diff(breadth, axis=0, prepend=0.0), 1e-9))
    breadth = 0.5 * (breadth + np.append(breadth[1:], breadth[-1:], axis=0))  # at the top of each layer
    wetted = np.minimum(np.maximum(WAGNER * (1.0 - RISE * deadrise), 0.0) * breadth**2, breadth.max(axis=0) ** 2)
    plates = hull.density * pi / 8.0 * np.maximum.accumulate(wetted, axis=0).sum(axis=1) * v.size[2]
    length = np.maximum(np.count_nonzero(breadth, axis=1) * v.size[2], v.size[2])
    slender = np.array([slenderness(a / b) for a, b in zip(length, np.maximum(breadth.max(axis=1), 1e-9))])
    return np.append(0.0, volumes), np.append(0.0, np.maximum.accumulate(slender * plates))
