"""Forces on the cubes of a hull, summed over fixed blocks: buoyancy, wave force, and wind."""

from typing import NamedTuple

import numpy as np

from ocean_sim.columns import Columns, vec3
from ocean_sim.fluid import Fluid
from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.runtime import Array, Array2, Integers, Template, in_kernels, runs_alone
from ocean_sim.ship.body.rigid_body import RigidBody
from ocean_sim.ship.naval.hydrostatics import Hydrostatics
from ocean_sim.ship.water.water_samples import (
    HIGHEST_LEVEL,
    ROW_COLUMNS,
    SurroundingSea,
    SurroundingWater,
    pose,
    row_matrix,
    row_vector,
    write_pose,
)
from ocean_sim.surface import Surface
from ocean_sim.wind import Wind

BLOCK_CUBES = 128  # cubes that are summed one after the other
SUM_COLUMNS = Columns(
    buoyancy=6,  # forces and torques [N], [N m]
    wave=6,
    wind_drag=6,
    wind_lift=6,
    volume=1,  # under water [m3]
    velocity=6,  # of the water, times the area that it meets, and times how far that lies ahead and to port
    acceleration=6,  # over gravity, likewise
    face=10,  # `FACE_COLUMNS` of the areas that the water meets
    cut=1,  # volume of the cubes that the surface cuts [m3]
)


FACE_COLUMNS = Columns(
    area=3,  # across sway, heave and surge [m2]
    arm=3,  # that across heave times z (pitch), across sway times z (yaw), across heave times x (roll) [m3]
    spread=3,  # likewise, times the squares [m4]
    skew=1,  # across heave, times x z [m4]
)


class Wetted(NamedTuple):
    """Sums over cubes: loads (2, 3) [N], [N m], world axes; wet volume; velocity and acceleration of the water."""

    buoyancy: np.ndarray
    wave: np.ndarray
    wind_drag: np.ndarray
    wind_lift: np.ndarray
    volume: float  # under water [m3]
    velocity: np.ndarray  # (6,) of the water about the centre of mass, as one body, body axes [m/s], [rad/s]
    acceleration: np.ndarray  # (6,) [m/s2], [rad/s2]


@in_kernels
class Cubes:
    """Cubes of a hull in Taichi fields, in body axes from the centre of mass, and kernels that sum forces over them."""

    def __init__(self, hull: Hydrostatics) -> None:
        """Copy the cubes of the hull to fields, ordered by height from the lowest, in blocks of BLOCK_CUBES."""
        cubes, matter = hull.voxels, hull.matter
        self.n, self.cubes = len(cubes.share), cubes
        self.blocks = -(-self.n // BLOCK_CUBES)
        upwards = np.argsort(cubes.centre[:, 1], kind="stable")  # so that whole blocks stay dry
        arm = (cubes.centre - matter.centre)[upwards]
        edges = range(0, self.n, BLOCK_CUBES)
        lower, upper = np.minimum.reduceat(arm, edges), np.maximum.reduceat(arm, edges)
        self.weight = hull.density * hull.gravity  # [N/m3]
        self.gravity = hull.gravity
        self.arm = ti.Vector.field(3, float, shape=self.n)  # [m]
        self.area = ti.Vector.field(3, float, shape=self.n)  # outward [m2]
        self.volume = ti.field(float, shape=self.n)  # inside the hull [m3]
        self.key = ti.field(int, shape=self.n)  # by which a wind distinguishes them
        self.box = ti.Vector.field(3, float, shape=(self.blocks, 2))  # around a block: middle and half its sides [m]
        self.mass_density = matter.mass / cubes.volume  # [kg/m3]
        self.size: list[float] = cubes.size.tolist()  # [m]
        self.size_squared = tm.vec3(cubes.size_squared)  # of their sides [m2]
        real = to_numpy_type(self.volume.dtype)
        volume = (cubes.share * cubes.size.prod())[upwards]
        box = np.stack([0.5 * (lower + upper), 0.5 * (upper - lower)], axis=1).reshape(-1, 3)
        numbers = (np.ascontiguousarray(array, dtype=real) for array in (arm, cubes.area[upwards], volume, box))
        self.upload_cubes(*numbers, upwards.astype(np.int32))
        self.found = np.zeros((self.n, 4))
        # The pose, and the sums of each block.
        self.table = np.zeros((1 + self.blocks, max(ROW_COLUMNS.size, SUM_COLUMNS.size)))

    @ti.kernel
    def upload_cubes(self, arm: Array2, area: Array2, volume: Array, box: Array2, key: Integers):
        """Copy to fields, of each cube, position `arm` from the centre of mass [m], hull `area` [m2], `volume` [m3],
        number `key`, by which winds draw random forces; of each block of BLOCK_CUBES, `box`: middle, half size [m]."""
        ti.loop_config(serialize=ti.static(runs_alone()))
        for k in range(self.n):
            self.arm[k] = tm.vec3(arm[k, 0], arm[k, 1], arm[k, 2])
            self.area[k] = tm.vec3(area[k, 0], area[k, 1], area[k, 2])
            self.volume[k], self.key[k] = volume[k], key[k]
        ti.loop_config(serialize=ti.static(runs_alone()))
        for b in range(2 * self.blocks):
            self.box[b // 2, b % 2] = tm.vec3(box[b, 0], box[b, 1], box[b, 2])

    @staticmethod
    def bytes(n: int, word: int) -> int:
        """Memory [bytes] of the fields of n cubes with floats of `word` bytes."""
        return n * (7 * word + 4) + (n // BLOCK_CUBES + 1) * (SUM_COLUMNS.size * 8 + 6 * word)

    def sum_forces(
        self, body: RigidBody, around: SurroundingWater | SurroundingSea, water: Surface | Fluid, wind: Wind
    ) -> Wetted:
        """Loads of water and wind on the hull at the pose of `body`; `around`: the lattice that samples `water`."""
        table = self.table
        write_pose(table[0], body)
        around.place(body, table[0])
        table[0, ROW_COLUMNS.since], table[0, ROW_COLUMNS.step] = wind.clock.since, wind.clock.step
        self.sum_blocks(around, water, wind, table)
        total = table[1:].sum(axis=0)
        dx, dz = self.cubes.cut_offset(body.rows, self.weight * float(total[SUM_COLUMNS.cut]))
        total[SUM_COLUMNS.buoyancy + 3] -= dz
        total[SUM_COLUMNS.buoyancy + 5] += dx
        velocity = acceleration = np.zeros(6)
        if isinstance(around, SurroundingSea):
            faces = total[SUM_COLUMNS.face : SUM_COLUMNS.cut].tolist()
            velocity = as_one_body(total[SUM_COLUMNS.velocity : SUM_COLUMNS.acceleration].tolist(), faces, self.size)
            pull = total[SUM_COLUMNS.acceleration : SUM_COLUMNS.face].tolist()
            acceleration = self.gravity * as_one_body(pull, faces, self.size)
        parts = total[: SUM_COLUMNS.volume].reshape(4, 2, 3)
        return Wetted(parts[0], parts[1], parts[2], parts[3], float(total[SUM_COLUMNS.volume]), velocity, acceleration)

    def displaced_water(
        self, body: RigidBody, around: SurroundingWater | SurroundingSea
    ) -> tuple[np.ndarray, np.ndarray]:
        """x, z, depth (m, 3) [m] and volume (m,) [m3] of the cubes' wet parts at the pose of `body`."""
        write_pose(self.table[0], body)
        middle = around.middle_now()
        self.table[0, [pose.position, pose.position + 2]] -= middle
        self.find_immersed(around, self.table, self.found)
        wet = self.found[self.found[:, 3] > 0.0]
        return wet[:, :3] + [*middle, 0.0], wet[:, 3]

    @ti.kernel
    def find_immersed(self, around: Template, table: Array2, found: Array2):
        """Write x, z, depth [m] and volume [m3] of each cube's wet part to `found` (n, 4); `around`: lattice of water
        samples; first row of `table`: the hull's pose (POSE_COLUMNS). All x, z are from the lattice's middle."""
        ti.loop_config(serialize=ti.static(runs_alone()))
        for block in range(self.blocks):
            position, turn = row_vector(table, pose.position), row_matrix(table)
            up = tm.vec3(turn[1, 0], turn[1, 1], turn[1, 2])
            tall = ti.sqrt((self.size_squared * up).dot(up))  # as far as each reaches upwards [m]
            for k in range(block * BLOCK_CUBES, ti.min((block + 1) * BLOCK_CUBES, self.n)):
                x = position + turn @ self.arm[k]
                depth = around.elevation(x.x, x.z) - x.y
                share = tm.clamp(depth / tall + 0.5, 0.0, 1.0)
                found[k, 0], found[k, 1], found[k, 2] = x.x, x.z, depth + 0.5 * tall * (1.0 - share)
                found[k, 3] = share * self.volume[k]

    @ti.kernel
    def sum_blocks(self, around: Template, water: Template, wind: Template, table: Array2):
        """Sample `water`, a surface or fluid, on the lattice `around`, and write the sums of its and the wind's loads
        on each block of cubes (SUM_COLUMNS) to `table` from row 1 on; row 0: hull, clock, lattice (ROW_COLUMNS)."""
        around.read_water(water, table)
        wind.set_clock(ti.cast(table[0, ROW_COLUMNS.since], float), ti.cast(table[0, ROW_COLUMNS.step], float))
        ti.loop_config(serialize=ti.static(runs_alone()))
        for block in range(self.blocks):
            position, turn = row_vector(table, pose.position), row_matrix(table)
            velocity, omega = row_vector(table, pose.velocity), row_vector(table, pose.spin)
            middle = tm.vec3(
                ti.cast(table[0, ROW_COLUMNS.middle], float), 0.0, ti.cast(table[0, ROW_COLUMNS.middle + 1], float)
            )
            up = tm.vec3(turn[1, 0], turn[1, 1], turn[1, 2])
            tall = ti.sqrt((self.size_squared * up).dot(up))  # as far as each reaches upwards [m]
            total = ti.Vector.zero(ti.f64, SUM_COLUMNS.size)
            lowest = position.y + up.dot(self.box[block, 0]) - abs(up).dot(self.box[block, 1]) - 0.5 * tall
            if ti.static(wind.blows) or lowest < around.frame[HIGHEST_LEVEL]:
                for k in range(block * BLOCK_CUBES, ti.min((block + 1) * BLOCK_CUBES, self.n)):
                    self.add_cube(total, k, around, wind, tall, position, middle, turn, velocity, omega)
            for c in ti.static(range(SUM_COLUMNS.size // 2)):
                table[1 + block, c] = total[c]
                table[1 + block, SUM_COLUMNS.size // 2 + c] = total[SUM_COLUMNS.size // 2 + c]

    @ti.func
    def add_cube(
        self,
        total: Template,
        k,
        water: Template,
        wind: Template,
        tall,
        position,
        middle,
        turn: Template,
        velocity,
        omega,
    ):
        """Add loads on cube k to sums `total` (SUM_COLUMNS) of its block of BLOCK_CUBES. `water`: lattice of samples
        around `middle` [m]; `tall`: height of a turned cube [m]; of the hull: `position` from there, `turn` (to world),
        `velocity` [m/s] and angular velocity `omega` [rad/s]."""
        arm = turn @ self.arm[k]
        x, wet = position + arm, 0.0
        if x.y - 0.5 * tall < water.frame[HIGHEST_LEVEL]:
            wet = self.add_water(total, k, water, tall, arm, x, turn)
        if ti.static(wind.blows):
            bare = (1.0 - wet) * (turn @ self.area[k])
            mass = self.mass_density * self.volume[k]
            blown = wind.force(self.key[k], x + middle, velocity + omega.cross(arm), bare, tm.vec3(0.0), mass)
            if (blown != 0.0).any():  # most cubes lie outside most gusts
                self.add_force(total, SUM_COLUMNS.wind_drag, arm, tm.vec3(blown.x, 0.0, blown.z))
                self.add_force(total, SUM_COLUMNS.wind_lift, arm, tm.vec3(0.0, blown.y, 0.0))

    @ti.func
    def add_water(self, total: Template, k, water: Template, tall, arm, x, turn: Template):
        """Add loads of water on cube k to sums `total` of its block; return its wet share. `water`: lattice of samples;
        `tall`: its height [m]; `arm`, `x`: its position from the centre of mass, and in space [m]; `turn`: to world."""
        corner = water.cell_at(x.x, x.z)
        eta, slope = water.surface_at(corner)
        depth = eta - x.y
        share = depth / tall + 0.5
        wet = tm.clamp(share, 0.0, 1.0)
        if wet > 0.0:
            volume, pull = wet * self.volume[k], slope
            self.add_force(total, SUM_COLUMNS.buoyancy, arm, tm.vec3(0.0, self.weight * volume, 0.0))
            if ti.static(water.samples_depth):
                pull = vec3(water.motion_at(corner, eta, depth), 3)
            self.add_force(total, SUM_COLUMNS.wave, arm, self.weight * volume * pull)
            self.add_number(total, SUM_COLUMNS.volume, volume)
            if share < 1.0:
                self.add_number(total, SUM_COLUMNS.cut, self.volume[k])
            if ti.static(water.samples_depth):
                own, face = self.arm[k], wet * abs(self.area[k])
                under = depth + 0.5 * tall  # where its lower face is
                moved = water.motion_at(corner, eta, under)
                self.add_motion(total, SUM_COLUMNS.velocity, own, face, turn.transpose() @ vec3(moved, 0))
                self.add_motion(total, SUM_COLUMNS.acceleration, own, face, turn.transpose() @ vec3(moved, 3))
                met, along = tm.vec3(face.y, face.x, face.y), tm.vec3(own.z, own.z, own.x)
                for c in ti.static(range(3)):
                    self.add_number(total, SUM_COLUMNS.face + FACE_COLUMNS.area + c, face[c])
                    self.add_number(total, SUM_COLUMNS.face + FACE_COLUMNS.arm + c, met[c] * along[c])
                    self.add_number(total, SUM_COLUMNS.face + FACE_COLUMNS.spread + c, met[c] * along[c] * along[c])
                self.add_number(total, SUM_COLUMNS.face + FACE_COLUMNS.skew, face.y * own.x * own.z)
        return wet

    @ti.func
    def add_number(self, total: Template, column: Template, number):
        """Add a number to a column of `total`, in f64."""
        total[column] += ti.cast(number, ti.f64)

    @ti.func
    def add_force(self, total: Template, column: Template, arm, force):
        """Add a force [N] at `arm` from the centre of mass [m], and its torque, to six columns of `total`."""
        torque = arm.cross(force)
        for c in ti.static(range(3)):
            self.add_number(total, column + c, force[c])
            self.add_number(total, column + 3 + c, torque[c])

    @ti.func
    def add_motion(self, total: Template, column: Template, own, face, moved):
        """Add one cube's terms to the sums `total` (from `column` on) to which `as_one_body` fits the motion of a rigid
        body: the water's motion `moved` (3,) times the cube's wet area `face` (3,) [m2] across each axis, and moments
        of that; `own`: its position from the centre of mass [m]; body axes."""
        for c in ti.static(range(3)):
            self.add_number(total, column + c, face[c] * moved[c])
        self.add_number(total, column + 3, -face.y * own.z * moved.y)
        self.add_number(total, column + 4, face.x * own.z * moved.x)
        self.add_number(total, column + 5, face.y * own.x * moved.y)


def as_one_body(moved: list[float], faces: list[float], size: list[float]) -> np.ndarray:
    """(6,) velocity (or acceleration) of a rigid body that fits the water's over all cubes best, by least squares.
    `moved` (6,): sums of the water's motion times wet areas, and their moments about the centre of mass; `faces` (10,):
    sums of these areas (FACE_COLUMNS); `size`: sides of a cube [m]."""
    x, y, z, turned_x, turned_y, turned_z = moved
    area_x, area_y, area_z = (max(area, 1e-12) for area in faces[:3])
    ahead, ahead_x, aside = faces[3] / area_y, faces[4] / area_x, faces[5] / area_y
    dx, _, dz = (1e-4 * side**2 for side in size)  # matters where only one row of cubes is wet
    along = faces[6] + area_y * (dz - ahead**2)
    along_x = faces[7] + area_x * (dz - ahead_x**2)
    across = faces[8] + area_y * (dx - aside**2)
    skew = faces[9] - area_y * ahead * aside
    turned_x, turned_y, turned_z = turned_x + ahead * y, turned_y - ahead_x * x, turned_z - aside * y
    both = along * across - skew**2
    pitch = (turned_x * across + turned_z * skew) / both
    yaw = turned_y / along_x
    roll = (turned_z * along + turned_x * skew) / both
    heave = y / area_y + pitch * ahead - roll * aside
    return np.array([x / area_x - yaw * ahead_x, heave, z / area_z, pitch, yaw, roll])
