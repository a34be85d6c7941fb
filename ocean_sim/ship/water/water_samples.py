"""Samples of the water around a hull, on a small lattice that turns with its heading.

The water is sampled at a few hundred nodes instead of at every cube, linear between nodes, so still water is exact.
Where a hull keeps particles out, the surface over them falls into the hole that it leaves: nodes at which it comes near
the hull are filled straight across from the water on both sides, those at the edge of the lattice near another hull
with the nearest clear one. In a closed form the lattice lies still in the water for a moment, a fraction of the waves'
period, and is carried by a current, before it is laid anew around the hull. Positions count from its middle, so that no
digits are lost far from the origin.

Kernels receive a rigid body as a row of numbers.
"""

from collections.abc import Sequence
from math import hypot
from typing import ClassVar

import numpy as np

from ocean_sim.basin.solids.voxels import Distance
from ocean_sim.columns import Columns
from ocean_sim.fluid import ClosedForm, Contact, Hull
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import Template, in_kernels
from ocean_sim.ship.body.rigid_body import RigidBody

NODES_ALONG, NODES_ACROSS = 25, 13
DEPTH_LEVELS = 4  # half a draught apart, downwards from the surface
LATTICE_REACH = 1.1  # of the hull's half sizes
LATTICE_SLACK = 0.08  # of the lattice's half sizes, by which a hull may leave its middle
HIGHEST_LEVEL = 4  # of the frame: the highest level [m]
POSE_COLUMNS = {"position": 3, "turn": 9, "velocity": 3, "spin": 3}  # [m], body to world, [m/s], [rad/s], world axes
pose = Columns(**POSE_COLUMNS)
# What kernels are handed: a body, the clock of the wind [s], and of the lattice its middle x, z [m], sine and cosine of
# its heading, how much of its time has gone, and how far the waves have grown.
ROW_COLUMNS = Columns(**POSE_COLUMNS, since=1, step=1, middle=2, heading=2, late=1, share=1)


def write_pose(row: np.ndarray, body: RigidBody) -> None:
    """Write pose and velocities of a body, world axes, to a row of numbers, as POSE_COLUMNS say."""
    across, up, ahead = body.rows
    row[: pose.size] = *body.position.tolist(), *across, *up, *ahead, *body.velocity.tolist(), *body.spin


@ti.func
def row_vector(table: Template, first: Template):
    """Vector of three numbers of the first row of a table, from column `first` on."""
    return ti.cast(tm.vec3(table[0, first], table[0, first + 1], table[0, first + 2]), float)


@ti.func
def row_matrix(table: Template):
    """Rotation matrix in the first row of a table, from body to world axes."""
    return ti.Matrix.rows([row_vector(table, pose.turn + 3 * k) for k in ti.static(range(3))])


class SampleLattice:
    """Lattice of nodes around a hull, turned with her heading, and the height of the water at each node."""

    samples_depth: ClassVar[bool]  # True if the water is asked under its surface, too
    middle: tuple[float, float] = (0.0, 0.0)  # x, z from which kernels count places [m]
    level: ti.Field  # [m]
    frame: ti.Field  # x, z of the middle [m], cosine and sine of the heading, highest level [m]

    def size_lattice(self, length: float, breadth: float, height: float, rim: float = 0.0) -> None:
        """Allocate the fields of a lattice over a hull of this size along z, x, y [m], and `rim` [m] beyond."""
        self.half = tuple(LATTICE_REACH * np.hypot(side / 2, height) + rim for side in (length, breadth))  # [m]
        self.step = (2.0 * self.half[0] / (NODES_ALONG - 1), 2.0 * self.half[1] / (NODES_ACROSS - 1))  # [m]
        self.level = ti.field(float, shape=(NODES_ALONG, NODES_ACROSS))
        self.frame = ti.field(float, shape=5)

    @staticmethod
    def bytes(word: int) -> int:
        """Memory [bytes] of the lattice's fields with floats of `word` bytes."""
        return word * (NODES_ALONG * NODES_ACROSS + HIGHEST_LEVEL + 1)

    def place(self, body: RigidBody, row: np.ndarray) -> None:
        """Lay a lattice that serves some steps (`SurroundingSea`) around the hull `body`; write its middle, heading,
        and her position from there to `row` (ROW_COLUMNS). Here nothing: `read_water` lays one around her each time."""

    def middle_now(self) -> np.ndarray:
        """(2,) x, z [m] of the lattice's middle once the hulls have been moved in the present time step."""
        return np.array(self.middle)

    @ti.func
    def node_place(self, n, sine, cosine):
        """Indices of node n along and across the lattice, and x, z from its middle [m]; sine, cosine of heading."""
        i, k = n // NODES_ACROSS, n % NODES_ACROSS
        along, across = i * self.step[0] - self.half[0], k * self.step[1] - self.half[1]
        return i, k, along * sine + across * cosine, along * cosine - across * sine

    @ti.func
    def keep_frame(self, x, z, sine, cosine):
        """Store in `frame` middle x, z [m], sine, cosine of heading, highest level [m]; call it at a kernel's top."""
        ti.loop_config(serialize=True)
        for _ in range(1):
            self.frame[0], self.frame[1], self.frame[2], self.frame[3] = x, z, cosine, sine
            self.frame[HIGHEST_LEVEL] = self.level[0, 0]
            for n in range(1, NODES_ALONG * NODES_ACROSS):
                level = self.level[n // NODES_ACROSS, n % NODES_ACROSS]
                self.frame[HIGHEST_LEVEL] = ti.max(self.frame[HIGHEST_LEVEL], level)

    @ti.func
    def cell_at(self, x, z):
        """Cell of x, z [m] in the lattice: its indices along and across, and position in it, 0 to 1 each way."""
        dx, dz = x - self.frame[0], z - self.frame[1]
        a = (dx * self.frame[3] + dz * self.frame[2] + self.half[0]) / self.step[0]
        b = (dx * self.frame[2] - dz * self.frame[3] + self.half[1]) / self.step[1]
        i = tm.clamp(int(ti.floor(a)), 0, NODES_ALONG - 2)
        k = tm.clamp(int(ti.floor(b)), 0, NODES_ACROSS - 2)
        return i, k, tm.clamp(a - i, 0.0, 1.0), tm.clamp(b - k, 0.0, 1.0)

    @ti.func
    def elevation(self, x, z):
        """Elevation [m] of the water at x, z [m], bilinear between nodes."""
        return self.surface_at(self.cell_at(x, z))[0]

    @ti.func
    def surface_at(self, corner: Template):
        """Elevation [m] of the water at a `corner` of `cell_at` (cell, and position in it); then minus the slope (3,)
        of the surface there, which is the horizontal force of long waves per weight of displaced water."""
        i, k, a, b = corner
        here, left = self.level[i, k], self.level[i, k + 1]
        ahead, across = self.level[i + 1, k], self.level[i + 1, k + 1]
        near, far = (1.0 - b) * here + b * left, (1.0 - b) * ahead + b * across
        slope, aside = (far - near) / self.step[0], ((1.0 - a) * (left - here) + a * (across - ahead)) / self.step[1]
        c, s = self.frame[2], self.frame[3]
        return (1.0 - a) * near + a * far, -tm.vec3(slope * s + aside * c, 0.0, slope * c - aside * s)


@in_kernels
class SurroundingWater(SampleLattice):
    """Height of the water around a hull, of particles or closed form, sampled anew each time loads are computed."""

    samples_depth = False
    left_out: ClassVar[tuple[str, ...]] = ("others",)  # the water keeps them

    def __init__(
        self,
        length: float,
        breadth: float,
        height: float,
        hollow: Distance | None = None,
        rim: float = 0.0,
        others: Sequence[Contact] = (),
    ) -> None:
        """Size of the hull (z, x, y) [m]. `hollow`: distance function of a hull that keeps particles out; their surface
        sags within `rim` [m] of her and is replaced there; `others`: contacts of all such hulls, hers included."""
        self.size_lattice(length, breadth, height, rim)
        self.hollow = hollow is not None
        if hollow is not None:
            self.hull, self.rim, self.others = hollow, rim, others
            self.is_clear = ti.field(int, shape=(NODES_ALONG, NODES_ACROSS))

    def other_hulls(self) -> list[Hull]:
        """All hulls but this one that keep particles out."""
        return [other.hull for other in self.others if other.hull.distance is not self.hull]

    @ti.func
    def read_water(self, water: Template, table: Template):
        """Store elevations of `water`, a surface or fluid, at nodes around a hull in `level`. Row 0 of `table`: the
        hull's pose (POSE_COLUMNS). Call it at the top of a kernel."""
        position, turn = row_vector(table, pose.position), row_matrix(table)
        ahead, heading = tm.vec2(turn[0, 2], turn[2, 2]), tm.vec2(0.0, 1.0)
        if ahead.norm() > 0.0:
            heading = ahead.normalized()
        ti.loop_config(serialize=True)  # a surface is read in less time than a parallel task takes to start
        for n in range(NODES_ALONG * NODES_ACROSS):
            i, k, dx, dz = self.node_place(n, heading.x, heading.y)
            node = tm.vec3(position.x + dx, 0.0, position.z + dz)
            node.y = water.elevation(node.x, node.z)
            self.level[i, k] = node.y
            if ti.static(self.hollow):
                _normal, away, _thinning = self.hull.at(turn.transpose() @ (node - position))
                clear = away >= self.rim or k == 0 or k == NODES_ACROSS - 1
                for hull in ti.static(self.other_hulls()):
                    clear = clear and hull.distance_to(node) >= self.rim
                self.is_clear[i, k] = int(clear)
        if ti.static(self.hollow):
            # Fill the hole of the hull straight across, from clear node to clear node.
            ti.loop_config(serialize=True)
            for i in range(NODES_ALONG):
                last = -1
                for k in range(NODES_ACROSS):
                    if self.is_clear[i, k] == 1:
                        low, rise = self.level[i, k], 0.0
                        if last >= 0:
                            low, rise = self.level[i, last], self.level[i, k] - self.level[i, last]
                        for inner in range(last + 1, k):
                            self.level[i, inner] = low + rise * (inner - last) / (k - last)
                        last = k
                for inner in range(last + 1, NODES_ACROSS):
                    self.level[i, inner] = self.level[i, ti.max(last, 0)]
        self.keep_frame(position.x, position.z, heading.x, heading.y)


@in_kernels
class SurroundingSea(SampleLattice):
    """Closed-form water around a hull: its height, and on levels below still water its velocity and acceleration."""

    samples_depth = True

    def __init__(
        self, length: float, breadth: float, height: float, draught: float, gravity: float, sea: ClosedForm
    ) -> None:
        """Size along z, x, y and draught of the hull [m], gravity [m/s2], and the sea to sample."""
        self.size_lattice(length, breadth, height)
        self.gravity, self.layer = gravity, 0.5 * draught
        self.depths = tuple(float(d) for d in self.layer * np.arange(DEPTH_LEVELS))  # [m]
        self.window = sea.window((NODES_ALONG, NODES_ACROSS), self.step, self.depths)
        self.heading = (0.0, 1.0)  # sine and cosine
        self.laid = (0.0, 0.0)  # x, z of the middle when the lattice was laid [m]
        # Velocity [m/s], and acceleration over gravity.
        self.moved = ti.Vector.field(6, float, shape=(NODES_ALONG, NODES_ACROSS, DEPTH_LEVELS))

    @staticmethod
    def bytes(word: int) -> int:
        return SampleLattice.bytes(word) + 6 * word * NODES_ALONG * NODES_ACROSS * DEPTH_LEVELS

    def place(self, body: RigidBody, row: np.ndarray) -> None:
        x, _, z = body.position.tolist()
        late, share, holds = self.window.now()
        flow = self.window.current
        carried = late * self.window.span
        middle = (self.laid[0] + carried * flow[0], self.laid[1] + carried * flow[1])
        if not holds or self.is_astray(x - middle[0], z - middle[1]):
            # Lay the lattice anew around the place of the hull half way through its time of use.
            s, c = float(body.matrix[0, 2]), float(body.matrix[2, 2])
            size, half = hypot(s, c), 0.5 * self.window.span
            self.heading = (s / size, c / size) if size else (0.0, 1.0)
            u, w = half * (body.velocity[0] - flow[0]), half * (body.velocity[2] - flow[1])
            self.laid = (x, z) if self.is_astray(u, w) else (x + u, z + w)
            self.window.lay(self.laid, self.heading)
            middle, late = self.laid, 0.0
        self.middle = middle
        row[pose.position], row[pose.position + 2] = x - middle[0], z - middle[1]
        row[ROW_COLUMNS.middle : ROW_COLUMNS.size] = *middle, *self.heading, late, share

    def middle_now(self) -> np.ndarray:
        """(2,) x, z [m] of the lattice's middle after the step, carried on by the current."""
        water = self.window.water
        return super().middle_now() + (water.time - water.before) * np.array(water.current)

    def is_astray(self, x: float, z: float) -> bool:
        """True if a hull at x, z [m] from the lattice's middle is so far off that the lattice must be laid anew."""
        (s, c), (ahead, aside) = self.heading, self.half
        return abs(x * s + z * c) > LATTICE_SLACK * ahead or abs(x * c - z * s) > LATTICE_SLACK * aside

    @ti.func
    def read_water(self, water: Template, table: Template):
        """Store elevation, motion of a ClosedForm `water` at the nodes in `level`, `moved`: plane waves, and waves on
        grids. Row 0 of `table`: place of the lattice (ROW_COLUMNS). Call it at the top of a kernel."""
        sine, cosine = ti.cast(table[0, ROW_COLUMNS.heading], float), ti.cast(table[0, ROW_COLUMNS.heading + 1], float)
        late, share = ti.cast(table[0, ROW_COLUMNS.late], float), ti.cast(table[0, ROW_COLUMNS.share], float)
        for n in range(NODES_ALONG * NODES_ACROSS):
            i, k, dx, dz = self.node_place(n, sine, cosine)
            x, z = table[0, ROW_COLUMNS.middle] + dx, table[0, ROW_COLUMNS.middle + 1] + dz
            self.level[i, k] = share * self.window.elevation(i, k, late) + water.rise(x, z)
            for l in range(DEPTH_LEVELS):
                speed, pull = self.window.moving(i, k, l, late)
                more, pulled = water.moving(x, z, l * self.layer)
                for c in ti.static(range(3)):
                    self.moved[i, k, l][c] = share * speed[c] + more[c]
                    self.moved[i, k, l][3 + c] = (share * pull[c] + pulled[c]) / self.gravity
        self.keep_frame(0.0, 0.0, sine, cosine)

    @ti.func
    def motion_at(self, corner: Template, eta, depth):
        """(6,) velocity (x, y, z) [m/s] of the water and its acceleration divided by gravity, at `depth` [m] below a
        surface of elevation `eta` [m]; `corner`: cell of the lattice and position in it, from `cell_at`."""
        h = ti.static(self.window.depth)
        stretched = h * depth / ti.max(h + eta, 1e-6 * h)  # Wheeler's
        level = tm.clamp(stretched / self.layer, 0.0, DEPTH_LEVELS - 1.0)
        l = ti.min(int(level), DEPTH_LEVELS - 2)
        i, k, a, b = corner
        return (1.0 - (level - l)) * self.on_level(i, k, a, b, l) + (level - l) * self.on_level(i, k, a, b, l + 1)

    @ti.func
    def on_level(self, i, k, a, b, l):
        """(6,) velocity [m/s], acceleration over g (x, y, z) on depth level l, shares a, b across cell i, k."""
        near = (1.0 - b) * self.moved[i, k, l] + b * self.moved[i, k + 1, l]
        return (1.0 - a) * near + a * ((1.0 - b) * self.moved[i + 1, k, l] + b * self.moved[i + 1, k + 1, l])
