"""The particles: one field a component, in the order of their cells, which changes from step to step; `id` stays."""

from dataclasses import dataclass

import numpy as np
import taichi as ti
from taichi.lang.util import to_numpy_type

from ocean_sim.fluid._initial import started
from ocean_sim.fluid._water import Lattice


@ti.data_oriented
class Components:
    """A vector per particle as three fields of one number each."""

    def __init__(self, n: int) -> None:
        self.x, self.y, self.z = (ti.field(float, shape=n) for _ in range(3))

    def __iter__(self):
        return iter((self.x, self.y, self.z))

    def to_numpy(self) -> np.ndarray:
        """(n, 3), in storage order."""
        rows = np.empty((*self.x.shape, 3), dtype=self.precision)
        self.copy_to(rows)
        return rows

    @ti.kernel
    def copy_to(self, rows: ti.types.ndarray(ndim=2)):
        for i in self.x:
            rows[i, 0], rows[i, 1], rows[i, 2] = self.x[i], self.y[i], self.z[i]

    def from_numpy(self, values: np.ndarray) -> None:
        """Takes (n, 3)."""
        self.copy_from(np.ascontiguousarray(values, dtype=self.precision))

    @ti.kernel
    def copy_from(self, rows: ti.types.ndarray(ndim=2)):
        for i in self.x:
            self.x[i], self.y[i], self.z[i] = rows[i, 0], rows[i, 1], rows[i, 2]

    @property
    def precision(self) -> type:
        """The NumPy type of `float` in this run: float32 or float64."""
        return to_numpy_type(self.x.dtype)


@ti.data_oriented
@dataclass(frozen=True, eq=False)
class Particles:
    """What a step reads and a snapshot saves."""

    n: int
    mass: float  # [kg] of each; in a slice [kg/m]
    rest_density: float  # [kg/m3]
    spacing: float  # [m]
    position: Components  # [m]
    velocity: Components  # [m/s]
    id: ti.Field  # number of the particle in the first lattice
    density: ti.Field  # [kg/m3]
    pressure: ti.Field  # [Pa]


def seeded(lattice: Lattice) -> Particles:
    """Particles in the state that their water starts from."""
    n = lattice.n
    particles = Particles(
        n=n,
        mass=lattice.mass,
        rest_density=lattice.config.rest_density,
        spacing=lattice.spacing,
        position=Components(n),
        velocity=Components(n),
        id=ti.field(int, shape=n),
        density=ti.field(float, shape=n),
        pressure=ti.field(float, shape=n),
    )
    config, basin = lattice.config, lattice.basin
    position, velocity, pressure = started(
        config.initial, lattice.positions(), basin, config.rest_density, lattice.ends()[1]
    )
    particles.position.from_numpy(position)
    particles.velocity.from_numpy(velocity)
    particles.pressure.from_numpy(pressure.astype(to_numpy_type(particles.pressure.dtype)))
    particles.id.from_numpy(np.arange(n, dtype=np.int32))
    particles.density.fill(lattice.config.rest_density)
    return particles
