"""Added mass of a hull by rule from its sections, and the joint motion of hull and water.

By rule: half the added mass of flat plates as broad as the sections at the still water in heave and pitch (Newman 1977,
Marine Hydrodynamics, table 4.3), with Pabst's factor for a length that is not infinite (Pabst 1930), in pitch that of
each half of the ship; half of circles as deep as the sections in sway and yaw; a twentieth of the mass in surge (Fossen
2021, Handbook of Marine Craft Hydrodynamics, 6.5).

In roll a section and its mirror image at the still water turn about their middle in unbounded water, the limit of quick
roll (Newman 1977, 6.17): an ellipse rho pi / 8 (a^2 - b^2)^2, a plate the same with b = 0 (table 4.3), a rectangle by
RECTANGLE_FACTORS; sections between an ellipse and a rectangle by their fullness.

Slamming: the momentum of hull and water is kept while the added mass grows, (m + A) V (von Karman 1929, NACA TN 321).
Sections count as half plates of their wetted breadth, broader by the water that rises beside them: Wagner's (1932, ZAMM
12) added mass is (pi / 2)^2 times von Karman's at a small deadrise, and less by DEADRISE_FACTOR a radian. A step has
the impulse of all that it wets, so its acceleration is a mean over the step; its peak grows as steps become shorter, up
to a limit that it is near once a slam takes many steps (figures: docs/theory/ship.md). The added mass grows no further
than that of the hull afloat. Leaving the water changes nothing: it falls off the hull.

A hull that lies half as deep or one and a half times as deep as afloat is a blunt body in heave (Hoerner 1965,
Fluid-Dynamic Drag, 3): BLUNT_DRAG on its waterplane, all of it from twice as deep and wholly out.
"""

from math import pi, sqrt

import numpy as np

from ocean_sim.model import Model, quantity
from ocean_sim.ship.body.rigid_body import RigidBody
from ocean_sim.ship.body.small_linalg import (
    Rows,
    Three,
    Vector,
    cross,
    matrix_times,
    minus,
    plus,
    solve_3x3,
    times,
    times_each,
    transpose_times,
)
from ocean_sim.ship.naval.hydrostatics import Hydrostatics

DRAUGHT_RATIOS = (0.0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.75, 1.0)  # draughts over breadth
RECTANGLE_FACTORS = (1.0, 1.092, 1.148, 1.185, 1.180, 1.186, 1.347, 1.845, 6.147, 18.77)
"""Added inertia of rectangles that turn about the still water over that of a plate, by 600 panels of potential flow."""
WAGNER_FACTOR = (pi / 2.0) ** 2
DEADRISE_FACTOR = 0.75  # [1/rad], ours
"""Fitted to the forces of similarity solutions of wedges as Zhao & Faltinsen (1993, J. Fluid Mech. 246) are quoted for
them, not checked against the paper; of 10 to 30 degrees within 5 %, of 40 degrees 16 % below."""
BLUNT_DRAG = 1.1  # coefficient of drag


class AddedMass(Model):
    """Added mass about the centre of mass, body axes; values that are null come by rule from the hull."""

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
        """(6,) added mass [kg] and inertia [kg m2] in the order of `Motions`; those not given in the config by rule."""
        given = [self.sway, self.heave, self.surge, self.pitch, self.yaw, self.roll]
        return np.array([rule if value is None else value for value, rule in zip(given, by_rule(hull))])


def by_rule(hull: Hydrostatics) -> np.ndarray:
    """(6,) added mass [kg] and inertia [kg m2] of a hull at its draught, by rule from its sections."""
    z, breadth, draught = hull.stations
    ds, rho = float(hull.voxels.size[2]), hull.density
    z = z - hull.matter.centre[2]
    length, broad = hull.length, float(breadth.max())
    plate, circle = rho * pi / 8.0 * breadth**2 * ds, rho * pi / 2.0 * draught**2 * ds  # of each slice [kg]
    return np.array(
        [
            circle.sum(),
            pabst_factor(length / broad) * plate.sum(),
            0.05 * hull.matter.mass,
            pabst_factor(length / 2.0 / broad) * (plate * z**2).sum(),
            (circle * z**2).sum(),
            (rho * pi / 256.0 * equivalent_breadth_4(hull, breadth, draught) * ds).sum(),
        ]
    )


def equivalent_breadth_4(hull: Hydrostatics, breadth: np.ndarray, draught: np.ndarray) -> np.ndarray:
    """(n,) breadth^4 [m4] of flat plates whose added roll inertia is that of sections of a `breadth`, `draught` [m]."""
    full = min(hull.needed_volume, hull.voxels.volume) / float((breadth * draught).sum() * hull.voxels.size[2])
    share = min(max((full - pi / 4.0) / (1.0 - pi / 4.0), 0.0), 1.0)
    deep = np.minimum(draught / np.maximum(breadth, 1e-9), DRAUGHT_RATIOS[-1])
    beyond = np.interp(deep, DRAUGHT_RATIOS, RECTANGLE_FACTORS) - (1.0 - 4.0 * deep**2) ** 2  # an ellipse
    return (breadth**2 - 4.0 * draught**2) ** 2 + share * beyond * breadth**4


def pabst_factor(ratio: float) -> float:
    """Pabst's factor on the added mass of a plate of finite length; `ratio`: length over breadth, or its inverse."""
    r = max(ratio, 1.0 / ratio)
    return r / sqrt(1.0 + r * r) * (1.0 - 0.425 * r / (1.0 + r * r))


def water_reaction(
    body: RigidBody,
    added: np.ndarray,
    between: np.ndarray | None,
    force: np.ndarray,
    torque: np.ndarray,
    drift: np.ndarray,
    surge: np.ndarray,
    free: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Reactions of added mass to the hull's motion and to the water's, (2, 3) force [N], torque [N m] each, world axes.

    Kirchhoff's equations, solved together with the hull's, so that a hull lighter than its added mass stays stable. In
    body axes, (6,): added mass `added`, coupled by `between` (6, 6), symmetric with diagonal 0; velocity `drift` and
    acceleration `surge` of the water. `force`, `torque`: all other loads. Motions not `free` (6,) have no acceleration.
    The axes turn, so the relative velocity also changes by omega x `drift` (Fossen 2021, 10.3)."""
    r, inertia, water = body.rows, body.inertia_body.tolist(), added.tolist()
    v, omega = body.own_velocity, body.own_spin
    (stream, swirl), (pull, pull_turn) = line_and_turn(drift), line_and_turn(surge)
    v_r, omega_r = minus(v, stream), minus(omega, swirl)
    momentum, turning = water_momentum(water, between, v_r, omega_r)
    carried, carried_turn = water_momentum(water, between, pull, pull_turn)
    # Of it, as the axes turn.
    kept, kept_turn = water_momentum(water, between, cross(omega, stream), cross(omega, swirl))
    along = plus(cross(omega, momentum), kept)
    around = plus(plus(cross(omega, turning), cross(v_r, momentum)), kept_turn)
    push = minus(minus(plus(transpose_times(r, force.tolist()), carried), along), times(body.mass, cross(omega, v)))
    gyration = cross(omega, matrix_times(inertia, omega))
    twisting = minus(minus(plus(transpose_times(r, torque.tolist()), carried_turn), around), gyration)
    moving = None if between is None else between * np.outer(free, free)
    rate, twist = joint_acceleration(body.mass, inertia, water, moving, push, twisting)
    answer, answer_turn = water_momentum(water, moving, rate, twist)
    moved = matrix_times(r, plus(answer, along)), matrix_times(r, plus(answer_turn, around))
    return -np.array(moved), np.array([matrix_times(r, carried), matrix_times(r, carried_turn)])


def line_and_turn(motion: np.ndarray) -> tuple[list[float], list[float]]:
    """Linear and angular part of a motion (6,), as two lists of three Python floats."""
    six = motion.tolist()
    return six[:3], six[3:]


def water_momentum(water: list[float], between: np.ndarray | None, line: Vector, turn: Vector) -> tuple[Three, Three]:
    """Linear and angular momentum of added mass `water` (6,), with coupling `between` (6, 6), at a linear and an
    angular velocity `line` and `turn`. Given accelerations instead, their rates of change."""
    own = times_each(water[:3], line), times_each(water[3:], turn)
    if between is None:
        return own
    more = line_and_turn(between @ [*line, *turn])
    return plus(own[0], more[0]), plus(own[1], more[1])


def joint_acceleration(
    mass: float, inertia: Rows, water: list[float], between: np.ndarray | None, push: Vector, twisting: Vector
) -> tuple[Vector, Vector]:
    """Linear [m/s2] and angular [rad/s2] acceleration of a hull together with its added mass `water` (6,), coupled by
    `between` (6, 6), under a force `push` [N] and a torque `twisting` [N m]."""
    x, y, z = water[3:]
    (p, q, r), (s, t, u), (v, w, o) = inertia
    whole = (p + x, q, r), (s, t + y, u), (v, w, o + z)
    heavy = [mass + more for more in water[:3]]
    if between is None:
        (a, b, c), (k, l, m) = push, heavy
        return (a / k, b / l, c / m), solve_3x3(whole, twisting)
    both = between + np.diag(heavy + [0.0, 0.0, 0.0])
    both[3:, 3:] += whole
    return line_and_turn(np.linalg.solve(both, [*push, *twisting]))


class Slamming:
    """Added mass in heave of one hull as she enters the water, and the slamming force, which is due to its growth."""

    def __init__(self, hull: Hydrostatics, usual: float) -> None:
        """`usual`: added mass in heave of the hull afloat [kg]."""
        self.volumes, self.masses = entry_curve(hull)
        self.mass, self.usual = hull.matter.mass, usual
        self.volume = min(hull.needed_volume, hull.voxels.volume)  # afloat [m3]
        self.drag = 0.5 * hull.density * BLUNT_DRAG * hull.waterplane
        self.entering, self.moved = False, usual  # since it left the water [kg]

    def added(self, volume: float) -> float:
        """Added mass in heave [kg] of the entering hull at a volume under water [m3]; at most its value afloat."""
        return min(float(np.interp(volume, self.volumes, self.masses)), self.usual)

    def push(self, volume: float, speed: float, dt: float) -> float:
        """Slamming force upwards [N] in a step of dt [s] that begins with a `volume` under water [m3] and a vertical
        `speed` V relative to the water [m/s]; V becomes V (m + A before) / (m + A now), A being the added mass."""
        if volume == 0.0:
            self.entering, self.moved = True, 0.0
        if not self.entering:
            return 0.0
        before, now = self.moved, max(self.moved, self.added(volume))
        self.moved, self.entering = now, volume < self.volume
        return -self.mass * min(speed, 0.0) * (now - before) / (self.mass + now) / dt

    def heave_drag(self, volume: float, speed: float) -> float:
        """Upward drag [N] at an upward speed [m/s], if the wet volume [m3] is below 0.5 or over 1.5 of that afloat."""
        depth = volume / self.volume
        unusual = min(max(2.0 * abs(depth - 1.0) - 1.0, 0.0), 1.0)
        return -self.drag * unusual * min(1.0, 2.0 * depth) * abs(speed) * speed


def entry_curve(hull: Hydrostatics) -> tuple[np.ndarray, np.ndarray]:
    """Volumes under water [m3] of an upright hull that enters the water, and her added mass in heave [kg] at each."""
    v = hull.voxels
    lower = v.centre[:, 1:].min(axis=0)
    layer, slice_ = np.round((v.centre[:, 1:] - lower) / v.size[1:]).astype(int).T
    breadth = np.zeros((int(layer.max()) + 1, int(slice_.max()) + 1))
    np.add.at(breadth, (layer, slice_), v.share * v.size[0])
    volumes = np.cumsum(breadth.sum(axis=1)) * v.size[1] * v.size[2]
    deadrise = np.arctan2(2.0 * v.size[1], np.maximum(np.diff(breadth, axis=0, prepend=0.0), 1e-9))
    breadth = 0.5 * (breadth + np.append(breadth[1:], breadth[-1:], axis=0))  # at the top of each layer
    spread = np.maximum(WAGNER_FACTOR * (1.0 - DEADRISE_FACTOR * deadrise), 0.0)
    wetted = np.minimum(spread * breadth**2, breadth.max(axis=0) ** 2)
    plates = hull.density * pi / 8.0 * np.maximum.accumulate(wetted, axis=0).sum(axis=1) * v.size[2]
    length = np.maximum(np.count_nonzero(breadth, axis=1) * v.size[2], v.size[2])
    slender = np.array([pabst_factor(a / b) for a, b in zip(length, np.maximum(breadth.max(axis=1), 1e-9))])
    return np.append(0.0, volumes), np.append(0.0, np.maximum.accumulate(slender * plates))
