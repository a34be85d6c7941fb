"""Fields of the particles, one a component, sorted by cell: their order changes from step to step, `id` does not."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ocean_sim.fluid.sph.initial_state import start_state
from ocean_sim.fluid.sph.lattice import Lattice
from ocean_sim.kernel_library import ScalarField, ti, tm, to_numpy_type
from ocean_sim.runtime import Array, Array2, Integers, in_kernels, runs_alone

PAGE_BYTES, CACHE_LINE_BYTES = 4096, 64
GAP_TYPE = ti.i32


def staggered_field(dtype: Any, n: int) -> Any:
    """Field of n numbers of type `dtype`; a gap behind it keeps fields of a particle from competing for cache lines."""
    field = ti.field(dtype, shape=n)
    size = n * np.dtype(to_numpy_type(field.dtype)).itemsize
    if size >= PAGE_BYTES and (gap := (CACHE_LINE_BYTES - size) % (2 * CACHE_LINE_BYTES)):
        ti.field(GAP_TYPE, shape=gap // np.dtype(to_numpy_type(GAP_TYPE)).itemsize)
    return field


class Snapshot(NamedTuple):
    """State of n particles at one time, in the order of storage (by cell)."""

    position: np.ndarray  # (n, 3) [m]
    velocity: np.ndarray  # (n, 3) [m/s]
    id: np.ndarray  # (n,)
    pressure: np.ndarray  # (n,) [Pa]


@in_kernels
class Count:
    """Number of particles now (`now`) and at most (`most`); they differ if an emitter adds some."""

    def __init__(self, now: int, most: int) -> None:
        self.now, self.most, self.grows = now, most, most > now
        if self.grows:
            self.field = ti.field(int, shape=())
            self.set(now)

    def set(self, now: int) -> None:
        self.now = now
        self.field[None] = now

    @ti.func
    def there(self):
        """Number of particles now, for use in a kernel."""
        n = ti.cast(self.most, int)
        if ti.static(self.grows):
            n = self.field[None]
        return n


class Growing(ScalarField):
    """Field of one number per particle, with room for future particles, which are left out of its NumPy arrays."""

    def __init__(self, field: ScalarField, count: Count) -> None:
        super().__init__(field.vars[0])
        self.count = count

    def to_numpy(self, dtype: type | None = None) -> np.ndarray:
        return super().to_numpy(dtype)[: self.count.now]

    def from_numpy(self, arr: np.ndarray) -> None:
        values = super().to_numpy()
        values[: self.count.now] = arr
        super().from_numpy(values)


def numbers(dtype: type, count: Count) -> ti.Field:
    """Make a field of one number per particle, with room for the largest number of particles."""
    field = staggered_field(dtype, count.most)
    return Growing(field, count) if count.grows else field


@in_kernels
class Components:
    """Vector field of particles, stored as three scalar fields x, y, z."""

    def __init__(self, n: int, count: Count | None = None) -> None:
        """Make fields of n vectors; `count`: present number of particles, if an emitter changes it."""
        self.x, self.y, self.z = (staggered_field(float, n) for _ in range(3))
        self.count = count

    def __iter__(self) -> Iterator[ti.Field]:
        return iter((self.x, self.y, self.z))

    @ti.func
    def at(self, i):
        """Vector (x, y, z) of particle i, by its index."""
        return tm.vec3(self.x[i], self.y[i], self.z[i])

    @ti.func
    def put(self, i, vector):
        """Write the vector of particle i, by its index."""
        for k, component in ti.static(enumerate((self.x, self.y, self.z))):
            component[i] = ti.cast(vector[k], float)

    def to_numpy(self) -> np.ndarray:
        """Vectors (n, 3) of all particles, in storage order."""
        rows: np.ndarray = np.empty((*self.x.shape, 3), dtype=self.precision)
        self.copy_to(rows)
        return rows if self.count is None else rows[: self.count.now]

    @ti.kernel
    def copy_to(self, rows: Array2):
        ti.loop_config(serialize=ti.static(runs_alone()))
        for i in self.x:
            rows[i, 0], rows[i, 1], rows[i, 2] = self.x[i], self.y[i], self.z[i]

    def from_numpy(self, values: np.ndarray) -> None:
        """Set the vectors of all particles to `values` (n, 3)."""
        self.copy_from(np.ascontiguousarray(values, dtype=self.precision))

    @ti.kernel
    def copy_from(self, rows: Array2):
        for i in range(rows.shape[0]):
            self.x[i], self.y[i], self.z[i] = rows[i, 0], rows[i, 1], rows[i, 2]

    @property
    def precision(self) -> type:
        """The NumPy type of `float` in this run: float32 or float64."""
        return to_numpy_type(self.x.dtype)


@in_kernels
@dataclass(frozen=True, eq=False)
class Particles:
    """Taichi fields of all particles: state that a step reads and a snapshot saves."""

    n: int  # the most there will be; `count` says how many there are
    count: Count
    mass: float  # [kg] of each; in 2-D [kg/m]
    rest_density: float  # [kg/m3]
    spacing: float  # [m]
    position: Components  # [m]
    velocity: Components  # [m/s]
    id: ti.Field  # number of the particle in the first lattice
    density: ti.Field  # [kg/m3]
    pressure: ti.Field  # [Pa]

    @ti.kernel
    def begin(self, position: Array2, velocity: Array2, pressure: Array, density: float):
        """Set position (n, 3) [m], velocity (n, 3) [m/s], pressure (n,) [Pa], density [kg/m3] and ids."""
        ti.loop_config(serialize=ti.static(runs_alone()))
        for i in range(position.shape[0]):
            self.position.x[i], self.position.y[i], self.position.z[i] = position[i, 0], position[i, 1], position[i, 2]
            self.velocity.x[i], self.velocity.y[i], self.velocity.z[i] = velocity[i, 0], velocity[i, 1], velocity[i, 2]
            self.pressure[i], self.id[i] = pressure[i], i
        ti.loop_config(serialize=ti.static(runs_alone()))
        for i in self.density:
            self.density[i] = density

    def snapshot(self) -> Snapshot:
        """Copy position, velocity, id and pressure of all particles in one kernel launch."""
        n, real = self.count.now, self.position.precision
        position: np.ndarray = np.empty((n, 3), dtype=real)
        velocity: np.ndarray = np.empty((n, 3), dtype=real)
        number: np.ndarray = np.empty(n, dtype=np.int32)
        pressure: np.ndarray = np.empty(n, dtype=real)
        self.copy_to(position, velocity, number, pressure)
        return Snapshot(position, velocity, number, pressure)

    @ti.kernel
    def copy_to(self, position: Array2, velocity: Array2, number: Integers, pressure: Array):
        ti.loop_config(serialize=ti.static(runs_alone()))
        for i in range(number.shape[0]):
            x, v = self.position, self.velocity
            position[i, 0], position[i, 1], position[i, 2] = x.x[i], x.y[i], x.z[i]
            velocity[i, 0], velocity[i, 1], velocity[i, 2] = v.x[i], v.y[i], v.z[i]
            number[i], pressure[i] = self.id[i], self.pressure[i]

    def in_box(self, middle: np.ndarray, scale: np.ndarray, most: float, every: int) -> np.ndarray:
        """Rows (m, 4) of every `every`-th particle: (x - `middle`) * `scale` rounded, within +-`most`; speed [m/s]."""
        rows: np.ndarray = np.empty((-(-self.count.now // every), 4), self.position.precision)
        self.put_in_box(rows, self.count.now, tm.vec3(*middle), tm.vec3(*scale), most, every)
        return rows

    @ti.kernel
    def put_in_box(self, rows: Array2, count: int, middle: tm.vec3, scale: tm.vec3, most: float, every: int):
        for i in range(count):
            k = self.id[i]
            if k % every == 0:
                share = ti.round((self.position.at(i) - middle) * scale)
                for a in ti.static(range(3)):
                    rows[k // every, a] = ti.select(tm.isnan(share[a]), 0.0, tm.clamp(share[a], -most, most))
                rows[k // every, 3] = tm.length(self.velocity.at(i))


def seeded(lattice: Lattice) -> Particles:
    """Make the particles of a lattice in the scene's initial state, with the first layer of an emitter."""
    n, jet, config, basin = lattice.n, lattice.jet, lattice.config, lattice.basin
    count = Count(n if jet is None else jet.particle_count(0.0), n)
    vectors = Components(n, count), Components(n, count)  # position, velocity
    scalars = numbers(int, count), numbers(float, count), numbers(float, count)  # id, density, pressure
    particles = Particles(n, count, lattice.mass, config.rest_density, lattice.spacing, *vectors, *scalars)
    places, surface = lattice.positions(), lattice.column_ends()[1]
    position, velocity, pressure = start_state(config.initial, places, basin, config.rest_density, surface)
    if jet is not None:
        x, v = jet.emitted_state(jet.first, count.now, 0.0, np.zeros(3))
        position, velocity = np.concatenate([position, x]), np.concatenate([velocity, v])
        pressure = np.concatenate([pressure, np.zeros(len(x))])
    dtype = particles.position.precision
    position, velocity = (np.ascontiguousarray(rows, dtype=dtype) for rows in (position, velocity))
    particles.begin(position, velocity, pressure.astype(dtype), particles.rest_density)
    return particles
