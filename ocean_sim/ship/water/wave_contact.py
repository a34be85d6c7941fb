"""Contact of particles with a hull (thesis 4.2), by which a ship acts back on the particles.

The hull pushes the particles as still water in its place would (`MovingHull.push`): as a wall would that shows every
particle the pressure p = rho g (height of the water - y) of the nearest point of the hull, a = -(2 p / rho) times the
integral of grad W over the hull (both pressures of the symmetric gradient are p). This push is one of the forces of the
water's own step. Given after the step, water at rest would be moved by all other forces and turned back each time:
density would follow a speed that is not there, and no force would do the work that is counted.

Particles that still come nearer collide, and that alone is new to the ship. The water bears this push and the
collisions; the ship is carried by its own law and the collisions. Afloat and at rest the push balances the water's own
pressure, collisions do nothing in the mean, and the draught is that without contact: Archimedes is counted once. Added
mass and damping of a kind stay as they are, so slamming comes on top of them.

Collisions are solved together, not one by one (n particles would push a light ship n times). With J = (n, r x n) of a
particle at r from the centre of mass, U the ship's velocities and e the restitution, every particle that comes nearer
leaves with n . v' = J U' - e (n . v - J U), and (M + c A) (U' - U) = c b with A = m sum J J^T, c the response and
b = m (1 + e) sum J (n . v - J U). Impulses that would pull are none. Coulomb friction follows; how fast a particle
slips is reduced by M / (M + mass of the particles that touch the ship), so that friction does not turn a light ship.
"""

from collections.abc import Callable

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.basin.solids.shape import SolidShape
from ocean_sim.basin.solids.voxels import Distance
from ocean_sim.columns import Columns
from ocean_sim.fluid import ParticleFluid
from ocean_sim.kernel_library import ti, tm
from ocean_sim.model import Model, quantity
from ocean_sim.runtime import Array2, Template, in_kernels
from ocean_sim.ship import Load
from ocean_sim.ship.body.rigid_body import RigidBody
from ocean_sim.ship.water.water_samples import POSE_COLUMNS, SurroundingSea, SurroundingWater, row_vector, write_pose

TASK_ITERATIONS = 512  # a parallel loop is never cut finer than this
SERIAL_PARTICLES = 20_000  # particles, up to so many of which one thread is quicker than several
CUBES_A_SPACING = 3.0  # cubes of the distance to a spacing
CONTACT_MARGIN = 0.2  # [spacings] before the hull, where a particle's centre stops
LISTED_DISTANCE = 0.5  # [spacings] before the hull, where a collision may yet move it to
SAG_RIM = 3.0  # [spacings] around the hull, where a sheet over the particles sags into its hole
EXIT_STEPS = 3  # off the hull and back to the walls
MATRIX_PAIRS = tuple((i, j) for i in range(6) for j in range(i, 6))
MATRIX_INDICES = np.array([[MATRIX_PAIRS.index((min(i, j), max(i, j))) for j in range(6)] for i in range(6)])
FOUND_COLUMNS = Columns(touching=1, b=6, a=len(MATRIX_PAIRS))  # particles that touch, b and A
PUSH_COLUMNS = Columns(impulse=3, moment=3, work=1)  # on the water [N s], [N m s], [J]
# A body, its motion before the step, and the share of the slip that friction may take.
CONTACT_COLUMNS = Columns(**POSE_COLUMNS, velocity_before=3, spin_before=3, slip=1)
# A body, and the box around it: its middle from there, half its sides [m].
BOX_COLUMNS = Columns(**POSE_COLUMNS, middle=3, half=3)


@in_kernels
class MovingHull:
    """Hull at the pose of the last step, for kernels: distance from it, and its push on the particles."""

    def __init__(
        self, distance: Distance, bounds: np.ndarray, reach: float, periods: tuple[float, ...], gravity: float
    ) -> None:
        """`bounds` (2, 3): box around the hull from its centre of mass [m]; `reach` of the push [m]; `periods` of the
        basin [m], 0 across closed sides. Set `water` after construction."""
        self.distance, self.reach, self.periods, self.gravity = distance, reach, periods, gravity
        self.middle, self.half = tm.vec3(bounds.mean(axis=0)), tm.vec3(0.5 * np.ptp(bounds, axis=0))  # [m]
        self.pose = ti.field(float, shape=BOX_COLUMNS.size)
        self.water: SurroundingWater | SurroundingSea

    @ti.func
    def take_pose(self, table: Template):
        """Set the pose from the first row of a table; call it at the top of a kernel."""
        ti.loop_config(serialize=True)
        for _ in range(1):
            for c in ti.static(range(BOX_COLUMNS.middle)):
                self.pose[c] = ti.cast(table[0, c], float)
            turn = self.rotation()
            middle, half = turn @ self.middle, abs(turn) @ self.half
            for c in ti.static(range(3)):
                self.pose[BOX_COLUMNS.middle + c], self.pose[BOX_COLUMNS.half + c] = middle[c], half[c]

    @ti.func
    def pose_vector(self, first: Template):
        """Vector (3,) in three columns of the stored pose; `first`: number of the first of them."""
        return tm.vec3(self.pose[first], self.pose[first + 1], self.pose[first + 2])

    @ti.func
    def rotation(self):
        """Rotation matrix (3, 3) from the axes of the hull to those of the world."""
        return ti.Matrix.rows(
            [
                self.pose_vector(BOX_COLUMNS.turn),
                self.pose_vector(BOX_COLUMNS.turn + 3),
                self.pose_vector(BOX_COLUMNS.turn + 6),
            ]
        )

    @ti.func
    def offset_to(self, x):
        """Vector (3,) [m] from the centre of mass to the point x [m]; the shortest one if the basin is periodic."""
        d = x - self.pose_vector(BOX_COLUMNS.position)
        for k, period in ti.static(enumerate(self.periods)):
            if ti.static(period > 0.0):
                d[k] -= period * ti.round(d[k] / period)
        return d

    @ti.func
    def is_near(self, d, more):
        """True if the point d [m] from the centre of mass lies within the box around the hull, grown by `more` [m]."""
        return (abs(d - self.pose_vector(BOX_COLUMNS.middle)) < self.pose_vector(BOX_COLUMNS.half) + more).all()

    @ti.func
    def point_velocity(self, d):
        """Velocity of the hull [m/s] at a position d from the centre of mass [m], world axes."""
        return self.pose_vector(BOX_COLUMNS.velocity) + self.pose_vector(BOX_COLUMNS.spin).cross(d)

    @ti.func
    def sample(self, d, turn: Template):
        """Normal, distance [m], -(integral of grad W over the hull) [1/m] at d from its centre of mass [m], world axes;
        `turn`: rotation from hull to world."""
        normal, away, thinning = self.distance.at(turn.transpose() @ d)
        return turn @ normal, away, turn @ thinning

    @ti.func
    def distance_to(self, x):
        """Distance [m] of the point x [m] from the hull, negative inside."""
        _normal, away, _thinning = self.distance.at(self.rotation().transpose() @ self.offset_to(x))
        return away

    @ti.func
    def push(self, x, ahead):
        """Acceleration [m/s2] of water at x [m] by the hull's push, the pressure that still water in her place would
        have, `ahead` [s] after the time of her stored pose."""
        d, a = self.offset_to(x), tm.vec3(0.0)
        if self.is_near(d, self.reach):
            d -= ahead * self.point_velocity(d)
            turn = self.rotation()
            normal, away, thinning = self.sample(d, turn)
            if away < self.reach:
                face = self.pose_vector(BOX_COLUMNS.position) + d - away * normal
                depth = tm.max(self.water.elevation(face.x, face.z) - face.y, 0.0)
                a = 2.0 * self.gravity * depth * thinning
        return a


class Contact(Model):
    """Collisions of particles with the hull."""

    restitution: float = quantity("1", 0.0, ge=0.0, le=1.0)
    """Share of the normal speed that is returned."""
    friction: float = quantity("1", 0.0, ge=0.0)
    """Coulomb friction: tangential over normal impulse, at most."""
    response: float = quantity("1", 1.0, ge=0.0, le=1.0)
    """Share of the collisions' impulse that the ship feels; below 1 momentum is lost."""


@in_kernels
class WaveContact:
    """Contact of a hull with particles, found through the cells of the fluid's grid; call `collide_step` each step."""

    def __init__(
        self, config: Contact, shape: SolidShape, centre: np.ndarray, basin: Basin, fluid: ParticleFluid, gravity: float
    ) -> None:
        """`config`: keys of collisions; `shape` of the hull, `centre` of mass from her origin [m]; gravity [m/s2]."""
        self.config, self.particles, self.grid, self.walls = config, fluid.particles, fluid.grid, fluid.walls
        self.mass, self.spacing, self.quantum = self.particles.mass, self.particles.spacing, self.grid.quantum
        self.gravity, spacing, reach = tm.vec3(basin.gravity), self.spacing, float(self.grid.support)
        self.margin = CONTACT_MARGIN * spacing  # [m]
        self.rim = SAG_RIM * spacing  # [m] around the hull, where the water's height cannot be asked
        distance = Distance(shape, centre, spacing / CUBES_A_SPACING, reach, max(reach, self.rim))
        self.hull = MovingHull(distance, np.array(shape.bounds()) - centre, reach, basin.periods, gravity)
        self.layers, self.serial = self.grid.cells[2], self.particles.n <= SERIAL_PARTICLES
        self.near, self.count = ti.field(int, shape=self.particles.n), ti.field(int, shape=self.layers)
        # One table: each costs a kernel its time.
        self.table = np.zeros((1 + self.layers, max(CONTACT_COLUMNS.size, FOUND_COLUMNS.size)))
        self.impulse = np.zeros((2, 3))  # on the ship by collisions, and its moments about its positions [N s], [N m s]
        self.lost = np.zeros((2, 3))  # what the water gave beyond that
        self.given, self.work = np.zeros(3), 0.0  # to the water by collisions [N s], [J]

    def begin(self, body: RigidBody) -> None:
        """Store the hull's first pose, and compile the collision kernel before the run by a call without collisions."""
        write_pose(self.table[0], body)
        self.push_particles(self.table)

    def collide_step(self, load: Load, after: Callable[[Load], RigidBody], dt: float) -> tuple[Load, RigidBody]:
        """Collide particles with the hull in a step of dt [s], and move them off her. Returns `load` with the
        collisions in its cause `wave`, and the body after the step; `after(load)`: the body that a load leads to."""
        trial, table = after(load), self.table
        write_pose(table[0], trial)
        self.find_touching(table)
        touching = table[1:, FOUND_COLUMNS.touching].sum()
        if touching == 0.0:
            return load, trial
        total = table[1:, : FOUND_COLUMNS.size].sum(axis=0)
        response = self.config.response
        a = total[FOUND_COLUMNS.a :][MATRIX_INDICES]
        turn = trial.matrix
        own = np.zeros((6, 6))
        own[:3, :3] = trial.mass * np.eye(3)
        own[3:, 3:] = turn @ trial.inertia_body @ turn.T
        change = own @ np.linalg.solve(own + response * a, response * total[FOUND_COLUMNS.b : FOUND_COLUMNS.a])
        write_pose(table[0], after(load.plus("wave", change.reshape(2, 3) / dt)))
        table[0, CONTACT_COLUMNS.velocity_before : CONTACT_COLUMNS.spin_before] = trial.velocity
        table[0, CONTACT_COLUMNS.spin_before : CONTACT_COLUMNS.slip] = trial.angular_velocity
        table[0, CONTACT_COLUMNS.slip] = trial.mass / (trial.mass + self.mass * touching)
        self.push_particles(table)
        pushed = table[1, : PUSH_COLUMNS.size]
        met = -pushed[: PUSH_COLUMNS.work].reshape(2, 3)
        self.impulse += response * met
        self.lost += (1.0 - response) * met
        self.given += pushed[: PUSH_COLUMNS.moment]
        self.work += float(pushed[PUSH_COLUMNS.work])
        load = load.plus("wave", response * met / dt)
        return load, after(load)

    @ti.kernel
    def find_touching(self, table: Array2):
        """List particles near the hull in `near`; sum up, by layer of grid cells, those that touch it, in `table` from
        row 1 on (FOUND_COLUMNS): number, and b and A in (M + c A) dU = c b, dU being the change of her velocities by
        collisions (module docstring); row 0: her pose (POSE_COLUMNS)."""
        self.hull.take_pose(table)
        if ti.static(self.serial):
            ti.loop_config(serialize=True)
            for layer in range(self.layers):
                self.find_in_layer(layer, table)
        else:
            for t in range(self.layers * TASK_ITERATIONS):
                if t % TASK_ITERATIONS == 0:
                    self.find_in_layer(t // TASK_ITERATIONS, table)

    @ti.func
    def cell_range(self, k: Template):
        """First grid cell along axis k that the box around the hull reaches, and number of cells. A margin covers
        particles that have left their cell, as some schemes sort them in the middle of a step."""
        pose = ti.static(self.hull.pose)
        position, centre = pose[ti.static(BOX_COLUMNS.position + k)], pose[ti.static(BOX_COLUMNS.middle + k)]
        middle = position + centre - self.grid.lower[k]
        half, last = pose[ti.static(BOX_COLUMNS.half + k)] + 2.0 * self.spacing, ti.static(self.grid.cells[k] - 2)
        first = int(ti.floor((middle - half) * self.grid.per_width[k])) + 1
        end = int(ti.floor((middle + half) * self.grid.per_width[k])) + 1
        if ti.static(self.hull.periods[k] > 0.0):
            end = ti.min(end, first + last - 1)
        else:
            first, end = tm.clamp(first, 1, last), tm.clamp(end, 1, last)
            if ti.static(k == 1):
                if end == last:  # and with it what flies above the grid
                    first = ti.min(first, last + 1 - self.grid.sky)
        return first, end - first + 1

    @ti.func
    def home_cell(self, cell, k: Template):
        """Index along axis k, inside the grid, of the cell with index `cell`, which may lie beyond a periodic side."""
        if ti.static(self.hull.periods[k] > 0.0):
            n = ti.static(self.grid.cells[k] - 2)
            cell = (cell - 1) - n * int(ti.floor((cell - 1) / n)) + 1
        return cell

    @ti.func
    def find_in_layer(self, layer, table: Template):
        """List particles near the hull and sum up collisions of those that touch it (`find_touching`), in the layer of
        grid cells with index `layer` along z; the sums (FOUND_COLUMNS) go to row 1 + `layer` of `table`."""
        total, count = ti.Vector.zero(ti.f64, FOUND_COLUMNS.size), 0
        first_x, across = self.cell_range(0)
        first_y, down = self.cell_range(1)
        first_z, along = self.cell_range(2)
        listed = self.grid.start[self.grid.cell_at(tm.ivec3(0, 0, layer))]
        for z in range(first_z, first_z + along):
            if self.home_cell(z, 2) == layer:
                for y in range(first_y, first_y + down):
                    for x in range(first_x, first_x + across):
                        c = self.grid.cell_at(tm.ivec3(self.home_cell(x, 0), self.home_cell(y, 1), layer))
                        for i in range(self.grid.start[c], self.grid.start[c + 1]):
                            count += self.list_particle(total, i, listed + count)
        self.count[layer] = count
        for c in ti.static(range(FOUND_COLUMNS.size)):
            table[1 + layer, c] = total[c]

    @ti.func
    def list_particle(self, total: Template, i, to):
        """Return 1 and write the number i of a particle to list `near` at index `to` if it is close to the hull, else
        0; if it touches her, add its collision to the sums `total` (FOUND_COLUMNS, `find_touching`)."""
        near, d = 0, self.hull.offset_to(self.particles.position.at(i))
        if self.hull.is_near(d, self.spacing):
            normal, away, _thinning = self.hull.sample(d, self.hull.rotation())
            if away < LISTED_DISTANCE * self.spacing:
                self.near[to] = i
                near = 1
            if away < self.margin:
                self.add_touching(total, normal, d, self.particles.velocity.at(i) - self.hull.point_velocity(d))
        return near

    @ti.func
    def add_touching(self, total: Template, normal, d, v):
        """Add a particle at d [m] from the hull's centre, with velocity v [m/s] relative to her there and `normal` out
        of her, to sums `total` over particles that touch her: number, b and A of their collision (FOUND_COLUMNS)."""
        total[FOUND_COLUMNS.touching] += 1.0
        speed = v.dot(normal)
        if speed < 0.0:
            moment = d.cross(normal)
            j = ti.cast(tm.vec3(normal), ti.f64)
            k = ti.cast(moment, ti.f64)
            six = ti.Vector([j.x, j.y, j.z, k.x, k.y, k.z])
            gain = ti.cast(self.mass * (1.0 + ti.static(self.config.restitution)) * speed, ti.f64)
            for c in ti.static(range(6)):
                total[FOUND_COLUMNS.b + c] += gain * six[c]
            for c, pair in ti.static(enumerate(MATRIX_PAIRS)):
                total[FOUND_COLUMNS.a + c] += self.mass * six[pair[0]] * six[pair[1]]

    @ti.kernel
    def push_particles(self, table: Array2):
        """Collide particles listed in `near` with the hull after the step; write impulse, moment and work on the water
        (PUSH_COLUMNS) to row 1 of `table`; row 0: the hull (CONTACT_COLUMNS)."""
        self.hull.take_pose(table)
        ti.loop_config(serialize=True)
        for _ in range(1):
            first = row_vector(table, CONTACT_COLUMNS.velocity_before)
            spin = row_vector(table, CONTACT_COLUMNS.spin_before)
            slipping = ti.cast(table[0, CONTACT_COLUMNS.slip], float)
            total = ti.Vector.zero(ti.f64, PUSH_COLUMNS.size)
            for layer in range(self.layers):
                listed = self.grid.start[self.grid.cell_at(tm.ivec3(0, 0, layer))]
                for k in range(listed, listed + self.count[layer]):
                    self.collide_particle(total, self.near[k], first, spin, slipping)
            for c in ti.static(range(PUSH_COLUMNS.size)):
                table[1, c] = total[c]

    @ti.func
    def collide_particle(self, total: Template, i, first, spin, slipping):
        """Collide particle i with the hull, move it off; add to sums `total` (PUSH_COLUMNS). `first`, `spin`: linear
        and angular velocity of the hull before collisions; `slipping`: factor on the change of velocity by friction."""
        x, v = self.particles.position.at(i), self.particles.velocity.at(i)
        d = self.hull.offset_to(x)
        normal, away, _thinning = self.hull.sample(d, self.hull.rotation())
        if away < self.margin:
            before = (v - first - spin.cross(d)).dot(normal)
            slip = v - self.hull.point_velocity(d)
            speed = slip.dot(normal)
            bounce = tm.max(-ti.static(self.config.restitution) * before, 0.0) - speed
            if bounce > 0.0:
                kick = bounce * normal
                along = slip - speed * normal
                rub = ti.static(self.config.friction) * bounce / tm.max(along.norm(), 1e-12)
                kick -= tm.min(rub, 1.0) * slipping * along
                new = v + kick
                self.particles.velocity.put(i, new)
                impulse = ti.cast(self.mass, ti.f64) * (ti.cast(new, ti.f64) - ti.cast(v, ti.f64))
                moment = ti.cast(d, ti.f64).cross(impulse)
                for c in ti.static(range(3)):
                    total[PUSH_COLUMNS.impulse + c] += impulse[c]
                    total[PUSH_COLUMNS.moment + c] += moment[c]
                total[PUSH_COLUMNS.work] += 0.5 * impulse.dot(ti.cast(new + v, ti.f64))
            total[PUSH_COLUMNS.work] -= ti.cast(self.mass * self.gravity.dot(self.move_off(i, x)), ti.f64)

    @ti.func
    def move_off(self, i, x):
        """Move particle i from x [m] off the hull, not through walls, by multiples of `quantum`, which float positions
        hold exactly; return its shift [m]."""
        start, turn = x, self.hull.rotation()
        for _ in range(EXIT_STEPS):
            normal, away, _thinning = self.hull.sample(self.hull.offset_to(x), turn)
            way = tm.max(self.margin - away, 0.0)
            x += self.quantum * ti.ceil(way * normal / self.quantum - 0.5)
            for k in ti.static(self.walls.axes):
                x[k] = tm.clamp(x[k], self.walls.low[k], self.walls.up[k])
        self.particles.position.put(i, x)
        return x - start
