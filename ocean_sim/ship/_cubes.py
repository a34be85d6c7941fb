"""Forces on the cubes of a hull, summed over fixed blocks: buoyancy, what waves add, and wind."""

from dataclasses import dataclass
from math import cos, sin
from typing import Any

import numpy as np
import taichi as ti
import taichi.math as tm

from ocean_sim.ship._hydrostatics import Hydrostatics
from ocean_sim.ship._rigid_body import RigidBody

BLOCK = 128  # cubes that are summed one after the other
BUOYANCY, WAVE, DRAG, LIFT, VOLUME, SPEED, TURN, PULL, TWIST, FACE, SPREAD, CUT = (
    0,
    6,
    12,
    18,
    24,
    25,
    28,
    31,
    34,
    37,
    40,
    43,
)
SUMS = 44
POSE = 21  # place, turn, velocity, angular velocity, spread of a cube, cosine and sine of the heading


@dataclass(frozen=True)
class Wetted:
    """What the cubes say together; forces [N] and torques about the centre of mass [N m] are (2, 3), world axes."""

    buoyancy: np.ndarray
    wave: np.ndarray
    wind_drag: np.ndarray
    wind_lift: np.ndarray
    volume: float  # under water [m3]
    velocity: np.ndarray  # (6,) of the water at the faces across each motion, body axes [m/s], [rad/s]
    acceleration: np.ndarray  # (6,) [m/s2], [rad/s2]


@ti.func
def vector(numbers: ti.template(), first: ti.template()):
    """Three numbers in a row."""
    return ti.cast(tm.vec3(numbers[first], numbers[first + 1], numbers[first + 2]), float)


@ti.data_oriented
class Cubes:
    """The cubes of a hull in its body axes, from the centre of mass."""

    def __init__(self, hull: Hydrostatics) -> None:
        cubes, matter = hull.voxels, hull.matter
        self.n, self.cubes = len(cubes.share), cubes
        self.blocks = -(-self.n // BLOCK)
        self.weight = hull.density * hull.gravity  # [N/m3]
        self.gravity = hull.gravity
        self.arm = ti.Vector.field(3, float, shape=self.n)  # [m]
        self.area = ti.Vector.field(3, float, shape=self.n)  # outward [m2]
        self.volume = ti.field(float, shape=self.n)  # inside the hull [m3]
        self.mass_density = matter.mass / cubes.volume  # [kg/m3]
        real = self.volume.to_numpy().dtype
        self.arm.from_numpy((cubes.centre - matter.centre).astype(real))
        self.area.from_numpy(cubes.area.astype(real))
        self.volume.from_numpy((cubes.share * cubes.size.prod()).astype(real))
        self.pose, self.rows = np.zeros(POSE), np.zeros((self.blocks, SUMS))

    @staticmethod
    def bytes(n: int, word: int) -> int:
        """Memory that n cubes take."""
        return n * 7 * word + (n // BLOCK + 1) * SUMS * 8

    def wetted(self, body: RigidBody, around: Any, water: Any, wind: Any) -> Wetted:
        """What water and wind do to the hull where it is."""
        turn = body.matrix
        heading = float(body.angles[1])
        self.pose[:3], self.pose[3:12] = body.position, turn.ravel()
        self.pose[12:15], self.pose[15:18] = body.velocity, body.angular_velocity
        self.pose[18:] = self.cubes.spread(turn[1]), cos(heading), sin(heading)
        self.sum_up(around, water, wind, self.pose, self.rows)
        total = self.rows.sum(axis=0)
        faces = np.maximum(total[FACE : SPREAD + 3], 1e-12)

        def motion(level: int) -> np.ndarray:
            return total[level : level + 6] / faces

        volume = float(total[VOLUME])
        aside = turn @ self.cubes.aside(turn[1], float(total[CUT]))
        total[BUOYANCY + 3 : BUOYANCY + 6] += self.weight * np.array([-aside[2], 0.0, aside[0]])
        parts = (total[k : k + 6].reshape(2, 3) for k in (BUOYANCY, WAVE, DRAG, LIFT))
        return Wetted(*parts, volume, motion(SPEED), self.gravity * motion(PULL))

    @ti.kernel
    def sum_up(
        self,
        around: ti.template(),
        water: ti.template(),
        wind: ti.template(),
        pose: ti.types.ndarray(ndim=1),
        rows: ti.types.ndarray(ndim=2),
    ):
        at, turned = vector(pose, 0), ti.Matrix.rows([vector(pose, 3), vector(pose, 6), vector(pose, 9)])
        around.look(water, at, turned, ti.cast(pose[19], float), ti.cast(pose[20], float))
        for block in range(self.blocks):
            position, velocity, omega = vector(pose, 0), vector(pose, 12), vector(pose, 15)
            turn = ti.Matrix.rows([vector(pose, 3), vector(pose, 6), vector(pose, 9)])
            total = ti.Vector.zero(ti.f64, SUMS)
            for k in range(block * BLOCK, ti.min((block + 1) * BLOCK, self.n)):
                self.add(total, k, around, wind, ti.cast(pose[18], float), position, turn, velocity, omega)
            self.keep(rows, block, total)

    @ti.func
    def keep(self, rows: ti.template(), block, total):
        for c in ti.static(range(SUMS // 2)):
            rows[block, c] = total[c]
            rows[block, SUMS // 2 + c] = total[SUMS // 2 + c]

    @ti.func
    def add(
        self,
        total: ti.template(),
        k,
        water: ti.template(),
        wind: ti.template(),
        tall,
        position,
        turn: ti.template(),
        velocity,
        omega,
    ):
        arm = turn @ self.arm[k]
        x = position + arm
        depth = water.elevation(x.x, x.z) - x.y
        share = depth / tall + 0.5
        wet = tm.clamp(share, 0.0, 1.0)
        volume = wet * self.volume[k]
        self.put(total, BUOYANCY, arm, tm.vec3(0.0, self.weight * volume, 0.0))
        if wet > 0.0:
            pull = water.push(x, depth)
            self.put(total, WAVE, arm, self.weight * volume * pull)
            self.count(total, VOLUME, volume)
            if share < 1.0:
                self.count(total, CUT, self.volume[k])
            if ti.static(water.below):
                own, face = self.arm[k], wet * abs(self.area[k])
                under = depth + 0.5 * tall  # where its lower face is
                self.put_motion(total, SPEED, own, face, turn.transpose() @ water.velocity(x, under))
                self.put_motion(total, PULL, own, face, turn.transpose() @ water.push(x, under))
                spread = tm.vec3(face.y * own.z * own.z, face.x * own.z * own.z, face.y * own.x * own.x)
                for c in ti.static(range(3)):
                    self.count(total, FACE + c, face[c])
                    self.count(total, SPREAD + c, spread[c])
        bare = (1.0 - wet) * (turn @ self.area[k])
        mass = self.mass_density * self.volume[k]
        blown = wind.force(k, x, velocity + omega.cross(arm), bare, mass)
        self.put(total, DRAG, arm, tm.vec3(blown.x, 0.0, blown.z))
        self.put(total, LIFT, arm, tm.vec3(0.0, blown.y, 0.0))

    @ti.func
    def count(self, total: ti.template(), column: ti.template(), number):
        total[column] += ti.cast(number, ti.f64)

    @ti.func
    def put(self, total: ti.template(), column: ti.template(), arm, force):
        torque = arm.cross(force)
        for c in ti.static(range(3)):
            self.count(total, column + c, force[c])
            self.count(total, column + 3 + c, torque[c])

    @ti.func
    def put_motion(self, total: ti.template(), column: ti.template(), own, face, moved):
        """Of water at a cube: its motion, and how it turns about pitch, yaw and roll, by the area it meets."""
        for c in ti.static(range(3)):
            self.count(total, column + c, face[c] * moved[c])
        self.count(total, column + 3, -face.y * own.z * moved.y)
        self.count(total, column + 4, face.x * own.z * moved.x)
        self.count(total, column + 5, face.y * own.x * moved.y)
