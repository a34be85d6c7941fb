"""What a kernel makes of a lattice of particles, by which a scheme can be made exact on it."""

from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from ocean_sim.fluid.sph.smoothing import Smoothing

NOTABLE = 0.01  # share of a wave's period that is worth saying


@dataclass(frozen=True)
class Stencil:
    """What a kernel makes of a lattice of particles; its constant is such that their density is at rest."""

    smoothing: Smoothing
    spacing: float  # [m]

    @cached_property
    def offsets(self) -> np.ndarray:
        """Places of the neighbours on the lattice, and of the particle itself [m]."""
        last = int(self.smoothing.support / self.spacing) + 1
        return self.spacing * np.array(list(product(range(-last, last + 1), repeat=self.smoothing.dimension)), float)

    @cached_property
    def t(self) -> np.ndarray:
        """1 - r/support of each of them, where it is positive."""
        return np.maximum(1.0 - np.linalg.norm(self.offsets, axis=1) / self.smoothing.support, 0.0)

    @cached_property
    def value(self) -> np.ndarray:
        """W over slope support^2."""
        return self.smoothing.kernel.value(self.t)

    @cached_property
    def gradient(self) -> np.ndarray:
        """grad W over -slope x."""
        return self.smoothing.kernel.gradient(self.t)

    @property
    def volume(self) -> float:
        """Of a particle [m3], in 2-D [m2]."""
        return self.spacing**self.smoothing.dimension

    @property
    def slope(self) -> float:
        """grad W over -x `gradient` [m^-5], in 2-D [m^-4]."""
        return 1.0 / (self.smoothing.support**2 * self.volume * float(self.value.sum()))

    @property
    def filled(self) -> float:
        """What the lattice makes of a gradient of one where W integrates to 1: about 1, and less next to a surface."""
        return self.gain * self.smoothing.slope / self.slope

    @property
    def gain(self) -> float:
        """What the lattice makes of a gradient of one; forces are divided by it."""
        return self.slope * self.volume * float(self.gradient @ self.offsets[:, 0] ** 2)

    @property
    def lacking(self) -> float:
        """What the top row of a lattice lacks of its density, over the gradient of the share of water there [m]."""
        above = self.offsets[:, 1] > 0.5 * self.spacing
        lack = self.smoothing.support**2 * float(self.value[above].sum())
        return lack / float(self.gradient[above] @ self.offsets[above, 1])

    @property
    def skin(self) -> float:
        """Mean depth of what a half-space of the lattice exposes [m]: row m of it lacks what is m rows further up."""
        up = np.maximum(self.offsets[:, 1], 0.0)
        exposed = self.gradient * up  # by the row that is seen from `up` below: each counts for all rows less deep
        rows = np.rint(up / self.spacing)
        return self.spacing * float(exposed @ (0.5 * rows**2)) / float(exposed @ rows)

    @property
    def neighbours(self) -> int:
        """How many there are."""
        return int((self.t > 0.0).sum()) - 1

    @property
    def squares(self) -> float:
        """Sum of the squared gradients [m^-8], in 2-D [m^-6]."""
        return self.slope**2 * float(self.gradient**2 @ (self.offsets**2).sum(axis=1))

    @property
    def stiffest(self) -> float:
        """Largest eigenvalue of A / A_ii, of plane waves along the axes of the lattice and its diagonals."""
        largest = 0.0
        for wave in product(np.linspace(0.0, np.pi, 13), repeat=self.smoothing.dimension):
            gradients = (self.slope * self.gradient * np.sin(self.offsets @ wave / self.spacing)) @ self.offsets
            largest = max(largest, float(gradients @ gradients) / self.squares)
        return largest

    @property
    def bonds(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Places of the neighbours over the spacing, and W'' and W' / r there, in the kernel's own unit."""
        there = (self.t > 0.0) & (self.t < 1.0)
        return self.offsets[there] / self.spacing, self.smoothing.kernel.bent(self.t[there]), -self.gradient[there]

    @property
    def rigidity(self) -> float:
        """Shear modulus of the lattice over the pressure that it is under, the mean of shear along its axes and along
        their diagonals; 0 in water. Small waves are borne by it too: their period is shorter by this share.

        Of one pressure everywhere: pairs repel as by a potential W (Born & Huang 1954), and sum (W'' - W' / r)
        (a . x)^2 (b . x)^2 / r^2 + W' / r (b . x)^2 over the neighbours is the modulus of shear along a on planes
        across b, where the sum of -W' / r (b . x)^2 is the pressure.
        """
        x, along, across = self.bonds
        r2 = (x**2).sum(axis=1)
        pairs = (x[:, 0] ** 2, x[:, 1] ** 2), (0.5 * (x[:, 0] + x[:, 1]) ** 2, 0.5 * (x[:, 0] - x[:, 1]) ** 2)
        moduli = [((along - across) * a * b / r2 + across * b).sum() for a, b in pairs]
        return float(np.mean(moduli) / -(across * x[:, 0] ** 2).sum())

    @property
    def softest(self) -> float:
        """Smallest eigenvalue of the lattice's elasticity under one pressure everywhere, over the typical largest.
        Where it is negative, still water does not stay on its lattice: rounding errors grow until it is none.

        Pairs then push each other along grad W, as atoms do that repel by a potential W, so these are the eigenvalues
        of the dynamical matrix of such a crystal (Born & Huang 1954, Dynamical Theory of Crystal Lattices) over those
        of a wave's 2 sum(1 - cos k), which leaves sound out.
        """
        x, along, across = self.bonds
        d = self.smoothing.dimension
        stiffness = ((along - across) / (x**2).sum(axis=1))[:, None, None] * x[:, :, None] * x[:, None, :]
        stiffness += across[:, None, None] * np.eye(d)
        waves = np.array([wave for wave in product(np.linspace(0.0, np.pi, 13), repeat=d) if any(wave)])
        matrices = np.einsum("kn,nij->kij", 1.0 - np.cos(waves @ x.T), stiffness)
        scaled = np.linalg.eigvalsh(matrices) / (1.0 - np.cos(waves)).sum(axis=1)[:, None]
        return float(scaled.min() / np.median(scaled[:, -1]))


def of_rigidity(smoothing: Smoothing, spacing: float) -> list[str]:
    """What to know of waves in water that starts on a lattice of this spacing [m]."""
    share, ratio = Stencil(smoothing, spacing).rigidity, smoothing.support / spacing
    if abs(share) < NOTABLE:
        return []
    way = "fast: the lattice that the water starts from bears shear" if share > 0.0 else "slow: the lattice is unstable"
    return [f"small waves run about {abs(share):.1%} {way} at a support of {ratio:g} spacings, however fine the water"]
