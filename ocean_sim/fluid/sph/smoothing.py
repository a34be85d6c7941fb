"""Smoothing kernels of Mueller, Charypar & Gross (2003), eqs. 20-22, and kernels whose gradient is a polynomial, that
of Wendland (1995), C2, among them; normalised in two and three dimensions.

`support` is the distance at which a kernel ends, h in that paper. Each kernel is a constant times a shape; pair laws
sum shapes, and the constant is multiplied in once, when the sum is finished.
"""

from dataclasses import dataclass
from math import factorial, pi

import numpy as np

from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import Template, in_kernels


@ti.func
def positive(x):
    """x where it is positive, else 0: one instruction, and out of range means weight zero."""
    return ti.select(x > 0.0, x, 0.0)


@ti.func
def smaller(a, b):
    """Of two numbers: one instruction, where `ti.min` also asks whether either is not a number."""
    return ti.select(a < b, a, b)


@ti.func
def polynomial(t, power: Template, terms: Template):
    """t^power (terms[0] + terms[1] t + ...)."""
    total = float(terms[-1])
    for term in ti.static(terms[-2::-1]):
        total = total * t + term
    for _ in ti.static(range(power)):
        total *= t
    return total


@dataclass(frozen=True)
class Kernel:
    """A kernel with grad W = -slope t^power (terms[0] + terms[1] t + ...) x, t = 1 - r/support inside the support."""

    power: int
    terms: tuple[float, ...]
    length: float = 0.5
    """Smoothing length h over support: that of limits of the time step and of what damps. Between kernels it is as the
    shortest waves are that they resolve, so that the same steps and constants are stable."""

    def gradient(self, t: np.ndarray) -> np.ndarray:
        """grad W over -slope x."""
        return t**self.power * np.polynomial.Polynomial(self.terms)(t)

    @property
    def value_terms(self) -> tuple[float, ...]:
        """Of W = slope support^2 t^(power + 1) (value_terms[0] + value_terms[1] t + ...): the integral of (1 - t) times
        `gradient` from the end of the support inwards."""
        inwards = np.polynomial.Polynomial(self.terms) * np.polynomial.Polynomial([1.0, -1.0])
        return tuple(float(term) / (self.power + k + 1) for k, term in enumerate(inwards.coef))

    def value(self, t: np.ndarray) -> np.ndarray:
        """W over slope support^2."""
        return t ** (self.power + 1) * np.polynomial.Polynomial(self.value_terms)(t)

    def bent(self, t: np.ndarray) -> np.ndarray:
        """W'' over slope: with r = h (1 - t), W' is -r `gradient`."""
        polynomial = np.polynomial.Polynomial(self.terms)
        falls = self.power * t ** (self.power - 1) * polynomial(t) + t**self.power * polynomial.deriv()(t)
        return (1.0 - t) * falls - self.gradient(t)

    def slope(self, dimension: int, support: float) -> float:
        """That with which W integrates to 1 [m^-5], in 2-D [m^-4]: the integral of -r W' is the dimension."""
        d = dimension
        moments = (
            term * factorial(self.power + k) * factorial(d + 1) / factorial(self.power + k + d + 2)
            for k, term in enumerate(self.terms)
        )
        return d / ({2: 2.0 * pi, 3: 4.0 * pi}[d] * support ** (d + 2) * sum(moments))


WENDLAND = Kernel(3, (1.0,))
"""W = constant (1 - r/support)^4 (1 + 4 r/h), Wendland's C2."""
NEUTRAL = Kernel(5, (1.0, 11.0, -11.0), length=0.4)
"""grad W = -slope (1 - q)^5 (1 + 11 q (1 - q)) x, under which a lattice of particles is as water is: at supports of 3.8
to 4.2 spacings it bears no shear, along its axes or their diagonals, and hardly a pattern of particles lies lower, in
2-D and in 3-D. Fitted so that both shear moduli and the softest mode vanish (Stencil.rigidity, Stencil.softest)
while waves of two spacings are smoothed to 2 %: the less they are, the more room water takes that has lost its
lattice."""
NEUTRAL_RATIO = 4.0  # [spacings] 44 neighbours in 2-D, 250 in 3-D


@in_kernels
@dataclass(frozen=True, eq=False)
class Smoothing:
    """The kernels for one dimension (2 or 3) and support [m]; that of the gradient of pressure is the scheme's."""

    dimension: int
    support: float
    kernel: Kernel = WENDLAND

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
    def length(self) -> float:
        """Smoothing length h [m]: see Kernel.length."""
        return self.kernel.length * self.support

    @property
    def slope(self) -> float:
        """grad W = -slope shape_gradient x_ij [m^-5 in 3-D]."""
        return self.kernel.slope(self.dimension, self.support)

    @ti.func
    def between(self, own, other, first: Template):
        """own - other of the three components from `first` on; in 2-D nothing is spent on the third, which is 0."""
        return tm.vec3(
            [own[first + k] - other[first + k] if ti.static(k < self.dimension) else 0.0 for k in ti.static(range(3))]
        )

    @ti.func
    def share(self, r):
        """1 - r/support within the support, else 0."""
        return positive(1.0 - r / self.support)

    @ti.func
    def shape_gradient(self, r):
        """grad W over -slope x_ij, of the distance: no division by r, so two particles in one position are no
        trouble."""
        return polynomial(self.share(r), self.kernel.power, self.kernel.terms)

    @ti.func
    def shape_value(self, r):
        """W over slope support^2."""
        return polynomial(self.share(r), self.kernel.power + 1, self.kernel.value_terms)

    @ti.func
    def pair_gradient(self, x_ij):
        """x_ij times the shape of grad W."""
        return self.shape_gradient(ti.sqrt(x_ij.dot(x_ij))) * x_ij

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
