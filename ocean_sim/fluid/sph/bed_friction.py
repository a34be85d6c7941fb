"""Friction of a bed between free slip and no slip: its shear stress on the water next to it.

The layer next to the bed is as thick as a row of the lattice. A particle in it bears the stress on a share of the bed:
its volume over that thickness, and ever less of it where the layer gives way to the next. So on a lattice, be it a
quarter of a row too high or too low, the first row bears all and the second nothing, and in any water the shares sum to
the bed in the mean. Velocity and height are the particle's own: nothing depends on the order of particles.
"""

from ocean_sim.basin import KARMAN, LOWEST, RoughBed
from ocean_sim.fluid.sph.lattice import Lattice
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import in_kernels

ALL, NONE = 0.75, 1.25  # [rows] heights up to which a particle bears its whole share, and from which it bears none


@in_kernels
class Bed:
    """A bed that rubs."""

    def __init__(self, bed: RoughBed, lattice: Lattice) -> None:
        self.level, self.row, self.z0 = lattice.basin.lower[1], lattice.row, bed.z0  # [m]
        self.logarithmic, self.in_row = bed.roughness is not None, bed.drag(0.5 * self.row)

    @ti.func
    def drag(self, z):
        """tau / (rho |u| u) at a height z [m]."""
        coefficient = float(self.in_row)
        if ti.static(self.logarithmic):
            share = KARMAN / ti.log(tm.max(z, LOWEST * self.row) / self.z0)
            coefficient = share * share
        return coefficient

    @ti.func
    def push(self, x, v, dt):
        """Acceleration [m/s2] over dt of a particle at x [m] that would leave the step with v [m/s] but for the bed.

        Of du/dt = -k |u| u, k = drag share / row, the solution u / (1 + k |u| dt): no step turns the water round.
        """
        z, along = x.y - self.level, tm.vec3(v.x, 0.0, v.z)
        share = tm.clamp((NONE - z / self.row) / (NONE - ALL), 0.0, 1.0)
        rate = self.drag(z) * share / self.row * along.norm()
        return -rate / (1.0 + rate * dt) * along
