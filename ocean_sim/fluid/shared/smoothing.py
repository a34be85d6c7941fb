"""Smoothing kernels of Mueller, Charypar & Gross (2003), eqs. 20-22, and of Wendland (1995), C2, normalised in two and
three dimensions.

`support` is the distance at which a kernel ends, h in that paper. Each kernel is a constant times a shape; pair laws
sum shapes, and the constant is multiplied in once, when the sum is finished.
"""

from dataclasses import dataclass
from math import pi

import taichi as ti
import taichi.math as tm

from ocean_sim.runtime import Template


@ti.func
def positive(x):
    """x where it is positive, else 0: one instruction, and out of range means weight zero."""
    return ti.select(x > 0.0, x, 0.0)


@ti.data_oriented
@dataclass(frozen=True, eq=False)
class Smoothing:
    """The three kernels for one dimension (2 or 3) and support [m]."""

    dimension: int
    support: float

    @property
    def poly6_constant(self) -> float:
        """W_poly6 = constant (h^2 - r^2)^3; integrates to 1 [m^-9 in 3-D]."""
        return {2: 4.0 / (pi * self.support**8), 3: 315.0 / (64.0 * pi * self.support**9)}[self.dimension]

    @property
    def spiky_constant(self) -> float:
        """W_spiky = constant (h - r)^3; integrates to 1 [m^-6 in 3-D]."""
        return {2: 10.0 / (pi * self.support**5), 3: 15.0 / (pi * self.support**6)}[self.dimension]

    @property
    def viscosity_constant(self) -> float:
        """Laplacian of W_viscosity = constant (h - r) [m^-6 in 3-D]."""
        return {2: 40.0 / (pi * self.support**5), 3: 45.0 / (pi * self.support**6)}[self.dimension]

    @property
    def wendland_constant(self) -> float:
        """W_wendland = constant (1 - r/h)^4 (1 + 4 r/h); integrates to 1 [m^-3 in 3-D]."""
        return {2: 7.0 / (pi * self.support**2), 3: 21.0 / (2.0 * pi * self.support**3)}[self.dimension]

    @property
    def wendland_slope(self) -> float:
        """grad W_wendland = -slope (1 - r/h)^3 x_ij [m^-5 in 3-D]."""
        return 20.0 * self.wendland_constant / self.support**2

    @ti.func
    def between(self, own, other, first: Template):
        """own - other of the three components from `first` on; in a slice nothing is spent on the third, which is 0."""
        return tm.vec3(
            [own[first + k] - other[first + k] if ti.static(k < self.dimension) else 0.0 for k in ti.static(range(3))]
        )

    @ti.func
    def W_wendland(self, r):
        q = positive(1.0 - r / self.support)
        return self.wendland_constant * q * q * q * q * (5.0 - 4.0 * q)

    @ti.func
    def share(self, r):
        """1 - r/h within the support, else 0."""
        return positive(1.0 - r / self.support)

    @ti.func
    def shape_grad_wendland(self, r):
        """(1 - r/h)^3 of the distance: no division by r, so two particles in one position are no trouble."""
        q = self.share(r)
        return q * q * q

    @ti.func
    def pair_gradient(self, x_ij):
        """x_ij times the shape of grad W_wendland."""
        return self.shape_grad_wendland(ti.sqrt(x_ij.dot(x_ij))) * x_ij

    @ti.func
    def shape_poly6(self, r2):
        """(h^2 - r^2)^3 of the squared distance."""
        w = positive(self.support * self.support - r2)
        return w * w * w

    @ti.func
    def W_poly6(self, r2):
        return self.poly6_constant * self.shape_poly6(r2)

    @ti.func
    def grad_W_poly6(self, x_ij, r2):
        w = positive(self.support * self.support - r2)
        return -6.0 * self.poly6_constant * w * w * x_ij

    @ti.func
    def W_spiky(self, r):
        q = positive(self.support - r)
        return self.spiky_constant * q * q * q

    @ti.func
    def grad_W_spiky(self, x_ij, r):
        q = positive(self.support - r)
        return -3.0 * self.spiky_constant * q * q / r * x_ij

    @ti.func
    def W_viscosity(self, r):
        """Its Laplacian is linear in r and its value and slope end at zero; singular at r = 0 (in 2-D like log r)."""
        h = self.support
        q = r / h
        value = 0.0
        if ti.static(self.dimension == 3):
            value = 15.0 / (2.0 * pi * h**3) * (-0.5 * q**3 + q**2 + 0.5 / q - 1.0)
        else:
            value = 10.0 / (3.0 * pi * h**2) * (-4.0 / 3.0 * q**3 + 3.0 * q**2 - 2.0 * ti.log(q) - 5.0 / 3.0)
        return ti.select(q < 1.0, value, 0.0)

    @ti.func
    def laplacian_W_viscosity(self, r):
        return self.viscosity_constant * positive(self.support - r)
