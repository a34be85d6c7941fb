"""Smoothing kernels of Mueller, Charypar & Gross (2003), eqs. 20-22, and kernels whose gradient is a polynomial, that
of Wendland (1995), C2, among them; normalised in two and three dimensions.

`support` is the distance at which a kernel ends, h in that paper. Each kernel is a constant times a shape; pair laws
sum shapes, and the constant is multiplied in once, when the sum is finished.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from math import factorial, pi

import numpy as np

from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import Template, in_kernels

NOTABLE_RIGIDITY = 0.01  # share of a wave's period that is worth saying


@ti.func
def positive(x):
    """The larger of x and 0, in one instruction; it makes kernels zero beyond their support."""
    return ti.select(x > 0.0, x, 0.0)


@ti.func
def lesser(a, b):
    """The lesser of two numbers, in one instruction; `ti.min` also tests whether either is NaN."""
    return ti.select(a < b, a, b)


@ti.func
def polynomial(t, power: Template, terms: Template):
    """Value of t^power (terms[0] + terms[1] t + ...)."""
    total = float(terms[-1])
    for term in ti.static(terms[-2::-1]):
        total = total * t + term
    for _ in ti.static(range(power)):
        total *= t
    return total


@dataclass(frozen=True)
class Kernel:
    """Kernel with grad W = -slope t^power (terms[0] + terms[1] t + ...) x, t = 1 - r/support, zero where t < 0."""

    power: int
    terms: tuple[float, ...]
    length: float = 0.5
    """Smoothing length h over support: that of limits of the time step and of what damps. Between kernels it is as the
    shortest waves are that they resolve, so that the same steps and constants are stable."""

    def gradient(self, t: np.ndarray) -> np.ndarray:
        """Factor f of grad W = -slope f x, with a constant `slope` and distance vector x, at t (n,) = 1 - r/support."""
        return t**self.power * np.polynomial.Polynomial(self.terms)(t)

    @property
    def value_terms(self) -> tuple[float, ...]:
        """Coefficients of W = slope support^2 t^(power + 1) (value_terms[0] + value_terms[1] t + ...), by integrating
        (1 - t) times `gradient` from the end of the support inwards."""
        inwards = np.polynomial.Polynomial(self.terms) * np.polynomial.Polynomial([1.0, -1.0])
        return tuple(float(term) / (self.power + k + 1) for k, term in enumerate(inwards.coef))

    def value(self, t: np.ndarray) -> np.ndarray:
        """Factor f of W = slope support^2 f, with a constant `slope`, at t (n,) = 1 - r/support."""
        return t ** (self.power + 1) * np.polynomial.Polynomial(self.value_terms)(t)

    def curvature(self, t: np.ndarray) -> np.ndarray:
        """Factor f of W'' = slope f, with a constant `slope`, at t (n,) = 1 - r/support."""
        polynomial = np.polynomial.Polynomial(self.terms)
        falls = self.power * t ** (self.power - 1) * polynomial(t) + t**self.power * polynomial.deriv()(t)
        return (1.0 - t) * falls - self.gradient(t)

    def slope(self, dimension: int, support: float) -> float:
        """Constant [m^-5], in 2-D [m^-4], of grad W = -slope `gradient` x: W of this `support` [m] integrates to 1."""
        d = dimension
        moments = (
            term * factorial(self.power + k) * factorial(d + 1) / factorial(self.power + k + d + 2)
            for k, term in enumerate(self.terms)
        )
        return d / ({2: 2.0 * pi, 3: 4.0 * pi}[d] * support ** (d + 2) * sum(moments))


WENDLAND = Kernel(3, (1.0,))
"""W = constant (1 - r/support)^4 (1 + 4 r/h), Wendland's C2."""
NEUTRAL_KERNEL = Kernel(5, (1.0, 11.0, -11.0), length=0.4)
"""grad W = -slope (1 - q)^5 (1 + 11 q (1 - q)) x, under which a lattice of particles is as water is: at supports of 3.8
to 4.2 spacings it bears no shear, along its axes or their diagonals, and hardly a pattern of particles lies lower, in
2-D and in 3-D. Fitted so that both shear moduli (Stencil.rigidity) and the softest mode vanish while waves of two
spacings are smoothed to 2 %: the less they are, the more room water takes that has lost its lattice."""
NEUTRAL_RATIO = 4.0  # [spacings] 44 neighbours in 2-D, 250 in 3-D


@in_kernels
@dataclass(frozen=True, eq=False)
class Smoothing:
    """Smoothing kernels for one dimension (2 or 3) and support [m]; `kernel` is that of the pressure gradient."""

    dimension: int
    support: float
    kernel: Kernel = WENDLAND

    @property
    def poly6_constant(self) -> float:
        """Constant of W_poly6 = constant (h^2 - r^2)^3 [m^-9], in 2-D [m^-8]."""
        return {2: 4.0 / (pi * self.support**8), 3: 315.0 / (64.0 * pi * self.support**9)}[self.dimension]

    @property
    def spiky_constant(self) -> float:
        """Constant of W_spiky = constant (h - r)^3 [m^-6], in 2-D [m^-5]."""
        return {2: 10.0 / (pi * self.support**5), 3: 15.0 / (pi * self.support**6)}[self.dimension]

    @property
    def viscosity_constant(self) -> float:
        """Constant of the Laplacian of W_viscosity, constant (h - r) [m^-6], in 2-D [m^-5]."""
        return {2: 40.0 / (pi * self.support**5), 3: 45.0 / (pi * self.support**6)}[self.dimension]

    @property
    def length(self) -> float:
        """Smoothing length h [m]: see Kernel.length."""
        return self.kernel.length * self.support

    @property
    def slope(self) -> float:
        """Constant of grad W = -slope shape_gradient x_ij, if W integrates to 1 [m^-5], in 2-D [m^-4]."""
        return self.kernel.slope(self.dimension, self.support)

    @ti.func
    def difference(self, own, other, first: Template):
        """Vector own - other of three columns of field values from `first` on; in 2-D its third component is 0."""
        return tm.vec3(
            [own[first + k] - other[first + k] if ti.static(k < self.dimension) else 0.0 for k in ti.static(range(3))]
        )

    @ti.func
    def support_share(self, r):
        """1 - r/support within the support, else 0; r [m]."""
        return positive(1.0 - r / self.support)

    @ti.func
    def shape_gradient(self, r):
        """Factor f of grad W = -slope f x_ij at a distance r [m], with a constant `slope`; finite at r = 0."""
        return polynomial(self.support_share(r), self.kernel.power, self.kernel.terms)

    @ti.func
    def shape_value(self, r):
        """Factor f of W = slope support^2 f at a distance r [m], with a constant `slope`."""
        return polynomial(self.support_share(r), self.kernel.power + 1, self.kernel.value_terms)

    @ti.func
    def pair_gradient(self, x_ij):
        """Vector f x_ij of grad W = -slope f x_ij for a pair x_ij [m] apart, with a constant `slope`."""
        return self.shape_gradient(ti.sqrt(x_ij.dot(x_ij))) * x_ij

    @ti.func
    def shape_poly6(self, r2):
        """Kernel W_poly6 without its constant, (h^2 - r^2)^3, at a squared distance r2 [m2]."""
        w = positive(self.support * self.support - r2)
        return w * w * w

    @ti.func
    def W_poly6(self, r2):
        """Value of W_poly6 at a squared distance r2 [m2]."""
        return self.poly6_constant * self.shape_poly6(r2)


@dataclass(frozen=True)
class Stencil:
    """Sums of a kernel over a cubic lattice of particles, whose density fixes the kernel's constant."""

    smoothing: Smoothing
    spacing: float  # [m]

    @cached_property
    def offsets(self) -> np.ndarray:
        """Positions (n, d) [m] of a particle's neighbours on the lattice, itself included, relative to it."""
        last = int(self.smoothing.support / self.spacing) + 1
        return self.spacing * np.array(list(product(range(-last, last + 1), repeat=self.smoothing.dimension)), float)

    @cached_property
    def t(self) -> np.ndarray:
        """1 - r/support (n,) of each lattice point in `offsets`; 0 beyond the support."""
        return np.maximum(1.0 - np.linalg.norm(self.offsets, axis=1) / self.smoothing.support, 0.0)

    @cached_property
    def value(self) -> np.ndarray:
        """Factor f (n,) of W = slope support^2 f, with a constant `slope`, at each lattice point in `offsets`."""
        return self.smoothing.kernel.value(self.t)

    @cached_property
    def gradient(self) -> np.ndarray:
        """Factor f (n,) of grad W = -slope f x, with a constant `slope`, at each lattice point x in `offsets`."""
        return self.smoothing.kernel.gradient(self.t)

    @property
    def volume(self) -> float:
        """Volume of a particle [m3], in 2-D [m2]."""
        return self.spacing**self.smoothing.dimension

    @property
    def slope(self) -> float:
        """Constant of W and grad W = -slope f x with W summing to rest density on the lattice [m^-5], in 2-D [m^-4]."""
        return 1.0 / (self.smoothing.support**2 * self.volume * float(self.value.sum()))

    @property
    def filled_gain(self) -> float:
        """Ratio of the gradient that a sum over the lattice gives to the true one if W integrates to 1: about 1."""
        return self.gain * self.smoothing.slope / self.slope

    @property
    def gain(self) -> float:
        """Ratio of the gradient that a sum over the lattice gives to the true gradient; forces are divided by it."""
        return self.slope * self.volume * float(self.gradient @ self.offsets[:, 0] ** 2)

    @property
    def top_deficit(self) -> float:
        """Relative density deficit in the top row of a lattice over the gradient of the smoothed share of water there
        [m]. Times the gradient at a particle it is the deficit by a flat surface with air above; more is by gaps."""
        above = self.offsets[:, 1] > 0.5 * self.spacing
        lack = self.smoothing.support**2 * float(self.value[above].sum())
        return lack / float(self.gradient[above] @ self.offsets[above, 1])

    @property
    def surface_deficit(self) -> tuple[float, float]:
        """Coefficients a, b of a e - b e^2, the share of a particle's kernel above a flat surface, exact in the two top
        rows of a lattice; e is the support times the gradient of the share of water, 0 deep inside."""
        up, weight = self.offsets[:, 1], self.gradient * (self.offsets**2).sum(axis=1)
        edges: list[float] = []
        ratios: list[float] = []
        for row in (0.5, 1.5):
            above = up > row * self.spacing
            edge = self.smoothing.support * self.smoothing.slope * self.volume * float(self.gradient[above] @ up[above])
            edges.append(edge)
            ratios.append(float(weight[above].sum() / weight.sum()) / edge if edge > 0.0 else ratios[0])
        bend = (ratios[1] - ratios[0]) / (edges[0] - edges[1])
        return ratios[0] + bend * edges[0], bend

    def row_on_bed(self, mirrored: bool) -> float:
        """Sum of r^2 f [m2] (`gradient` f, distance r) over a full layer of neighbours and, if `mirrored`, its image in
        the bed; where a sum over particles is less, Bed.push finds gaps."""
        lowest = -1.5 if mirrored else -0.5
        rows = (self.offsets[:, 1] < 0.5 * self.spacing) & (self.offsets[:, 1] > lowest * self.spacing)
        return float(self.gradient[rows] @ (self.offsets[rows] ** 2).sum(axis=1))

    @property
    def skin_depth(self) -> float:
        """Mean depth [m] of particles below a flat surface, weighted by the area of each exposed to the air."""
        up = np.maximum(self.offsets[:, 1], 0.0)
        exposed = self.gradient * up  # by the row that is seen from `up` below: each counts for all rows less deep
        rows = np.rint(up / self.spacing)
        return self.spacing * float(exposed @ (0.5 * rows**2)) / float(exposed @ rows)

    @property
    def neighbours(self) -> int:
        """Number of neighbours of a particle within its support."""
        return int((self.t > 0.0).sum()) - 1

    @property
    def gradient_squares(self) -> float:
        """Sum of grad W squared over the neighbours [m^-8], in 2-D [m^-6]."""
        return self.slope**2 * float(self.gradient**2 @ (self.offsets**2).sum(axis=1))

    @property
    def stiffest_mode(self) -> float:
        """Largest eigenvalue of the pressure solver's A / A_ii, over plane waves along lattice axes and diagonals."""
        largest = 0.0
        for wave in product(np.linspace(0.0, np.pi, 13), repeat=self.smoothing.dimension):
            gradients = (self.slope * self.gradient * np.sin(self.offsets @ wave / self.spacing)) @ self.offsets
            largest = max(largest, float(gradients @ gradients) / self.gradient_squares)
        return largest

    @property
    def lattice_bonds(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Neighbours' positions divided by the spacing, and W'' and W' / r there, without the kernel's constant."""
        there = (self.t > 0.0) & (self.t < 1.0)
        return self.offsets[there] / self.spacing, self.smoothing.kernel.curvature(self.t[there]), -self.gradient[there]

    @property
    def rigidity(self) -> float:
        """Shear modulus of the lattice over its pressure, mean of shear along axes and diagonals; 0 in water. It
        shortens the period of small waves by about this share. Pairs under a uniform pressure repel as by a potential W
        (Born & Huang 1954): shear along a on planes across b has the modulus sum (W'' - W' / r) (a . x)^2 (b . x)^2 /
        r^2 + W' / r (b . x)^2 over the neighbours, if the pressure is the sum of -W' / r (b . x)^2."""
        x, along, across = self.lattice_bonds
        r2 = (x**2).sum(axis=1)
        pairs = (x[:, 0] ** 2, x[:, 1] ** 2), (0.5 * (x[:, 0] + x[:, 1]) ** 2, 0.5 * (x[:, 0] - x[:, 1]) ** 2)
        moduli = [((along - across) * a * b / r2 + across * b).sum() for a, b in pairs]
        return float(np.mean(moduli) / -(across * x[:, 0] ** 2).sum())


def rigidity_notes(smoothing: Smoothing, spacing: float) -> Iterator[str]:
    """Yield a sentence if shear resistance of the starting lattice of this `spacing` [m] notably changes wave speed."""
    share, ratio = Stencil(smoothing, spacing).rigidity, smoothing.support / spacing
    way = "fast: the lattice that the water starts from bears shear" if share > 0.0 else "slow: the lattice is unstable"
    if abs(share) >= NOTABLE_RIGIDITY:
        yield f"small waves run about {abs(share):.1%} {way} at a support of {ratio:g} spacings, however fine the water"
