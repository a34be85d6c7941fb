"""Right-hand sides of the three schemes in NumPy, each sum over all pairs, from the formulas of docs/theory/sph.md.

`Water` holds the particles and what they meet. `left_out` names a term that is left out: the negative control of each.
"""

from dataclasses import dataclass, field
from itertools import product

import numpy as np

RHO_0 = 1000.0  # [kg/m3] density at rest


@dataclass
class Side:
    """A flat side, which mirrors the water."""

    axis: int
    position: float  # [m]
    sticks: bool


@dataclass
class Samples:
    """A solid body at rest: where its samples are, how many particles each counts for, the outward normal there."""

    position: np.ndarray  # (s, 3) [m]
    share: np.ndarray  # (s,)
    normal: np.ndarray  # (s, 3)
    sticks: bool


@dataclass
class Water:
    """Particles (n) and what they meet, in SI units."""

    x: np.ndarray
    v: np.ndarray
    gravity: np.ndarray
    mass: float
    dimension: int
    support: float
    spacing: float
    sides: list[Side]
    body: Samples
    nu: float
    c: float
    past: np.ndarray = field(default_factory=lambda: np.zeros(3))  # (n, 3) remembered acceleration [m/s2]

    def images(self, free_slip: bool = False) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Particles and their images in every set of sides: number of the particle, place and velocity. The velocity is
        reversed across a side, and along one to which water sticks, unless `free_slip`."""
        name, x, v = np.arange(len(self.x)), self.x, self.v
        for side in self.sides:
            x_image, v_image = x.copy(), v.copy()
            x_image[:, side.axis] = 2.0 * side.position - x[:, side.axis]
            turned = slice(None) if side.sticks and not free_slip else side.axis
            v_image[:, turned] *= -1.0
            name, x, v = np.concatenate([name, name]), np.vstack([x, x_image]), np.vstack([v, v_image])
        return name, x, v

    def head(self, name: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Rise of p / rho from each particle to its image, g . (x_image - x) [m2/s2]."""
        return (x - self.x[name]) @ self.gravity

    def samples(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Places of the samples and of their images in every set of sides, how many particles each counts for, and
        normals."""
        x, share, normal = self.body.position, self.body.share, self.body.normal
        for side in self.sides:
            x_image, flip = x.copy(), np.where(np.arange(3) == side.axis, -1.0, 1.0)
            x_image[:, side.axis] = 2.0 * side.position - x[:, side.axis]
            x, share, normal = np.vstack([x, x_image]), np.tile(share, 2), np.vstack([normal, normal * flip])
        return x, share, normal

    def sample_head(self, d: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """Rise of p / rho from each particle to each sample at d, (g - a_i) . d + (a_i . n) n . d [m2/s2]."""
        along = np.einsum("isk,ik->is", d, self.gravity - self.past)
        return along + (self.past @ normal.T) * np.einsum("isk,sk->is", d, normal)

    def sample_velocity(self, count: int) -> np.ndarray:
        """(n, s, 3) velocity by which samples rub: the particle's own reversed where it sticks, its own else."""
        return np.repeat((-1.0 if self.body.sticks else 1.0) * self.v[:, None], count, axis=1)


def polynomial_kernel(q: np.ndarray) -> np.ndarray:
    """-W' / r without its constant: (1 - q)^5 (1 + 11 q (1 - q))."""
    t = np.maximum(1.0 - q, 0.0)
    return t**5 * (1.0 + 11.0 * q * t)


def kernel_value(q: np.ndarray) -> np.ndarray:
    """W / H^2 without the same constant: the integral of q times it from q to 1."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    half = 0.5 * np.maximum(1.0 - q, 0.0)[..., None]
    s = q[..., None] + half * (nodes + 1.0)
    return (half * weights * s * polynomial_kernel(s)).sum(axis=-1)


def kernel_constant(dimension: int, support: float) -> float:
    """Constant of -W' / r, with which W integrates to 1: the integral of -r W' over space is the dimension."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    q = 0.5 * (nodes + 1.0)
    moment = (0.5 * weights * q ** (dimension + 1) * polynomial_kernel(q)).sum() * support ** (dimension + 2)
    return dimension / (2.0 * np.pi * (dimension - 1) * moment)


def pairs(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """x_ij of all pairs, (n, m, 3), and their squared lengths."""
    x_ij = a[:, None] - b[None]
    return x_ij, (x_ij**2).sum(axis=2)


def mueller(water: Water, k: float, left_out: str = "") -> dict[str, np.ndarray]:
    """(2.13), (2.15), (2.16), (2.18) and gravity: density and acceleration."""
    w, H, m = water, water.support, water.mass
    poly6 = {2: 4.0 / (np.pi * H**8), 3: 315.0 / (64.0 * np.pi * H**9)}[w.dimension]
    spiky = {2: 10.0 / (np.pi * H**5), 3: 15.0 / (np.pi * H**6)}[w.dimension]
    laplacian = {2: 40.0 / (np.pi * H**5), 3: 45.0 / (np.pi * H**6)}[w.dimension]
    name, x, v = w.images()
    xs, share, normal = w.samples()
    x_ij, r2 = pairs(w.x, x)
    x_is, r2_s = pairs(w.x, xs)
    cubed = [poly6 * np.maximum(H**2 - square, 0.0) ** 3 for square in (r2, r2_s)]
    rho = m * (cubed[0].sum(axis=1) + cubed[1] @ share)
    p = np.maximum(k * (rho - RHO_0), 0.0)

    def force(x_ij, r2, p_j, rho_j, v_ji):
        r = np.sqrt(r2 + 1.0e-12)
        grad = -3.0 * spiky * np.maximum(H - r, 0.0) ** 2 / r  # over x_ij
        press = -m * (p[:, None] + p_j) / (2.0 * rho_j) * grad
        rub = RHO_0 * w.nu * m / rho_j * laplacian * np.maximum(H - r, 0.0)
        return ("pressure" != left_out) * press[..., None] * x_ij + ("viscosity" != left_out) * rub[..., None] * v_ji

    total = force(x_ij, r2, p[name] + RHO_0 * w.head(name, x), rho[name], v[None] - w.v[:, None]).sum(axis=1)
    p_s = p[:, None] + RHO_0 * w.sample_head(-x_is, normal)
    solid = force(x_is, r2_s, p_s, np.full_like(p_s, RHO_0), w.sample_velocity(len(xs)) - w.v[:, None])
    if left_out != "body":
        total += (share[:, None] * solid).sum(axis=1)
    return {"density": rho, "acceleration": total / rho[:, None] + w.gravity}


def equation_of_state(excess: np.ndarray, c: float, gamma: int) -> np.ndarray:
    """p = c^2 rho0 / gamma ((rho / rho0)^gamma - 1) of the density less that at rest."""
    return c**2 * RHO_0 / gamma * ((1.0 + excess / RHO_0) ** gamma - 1.0)


def delta_momentum(water: Water, pressing: np.ndarray, alpha: float, left_out: str = "") -> np.ndarray:
    """Acceleration (n, 3) of `delta_sph`; `pressing`: damped pressure over the square of the density."""
    w, h, c = water, 0.4 * water.support, water.c
    scale = w.mass * kernel_constant(w.dimension, w.support)

    def spacing_weight(r):
        q = np.maximum(1.0 - r / (3.5 * w.spacing), 0.0)
        return q**4 * (5.0 - 4.0 * q)

    def force(x_ij, r2, P_j, v_ij):
        r, P_i = np.sqrt(r2), pressing[:, None]
        along = ("pressure" != left_out) * (P_i + P_j)
        u_ij = -(v_ij * x_ij).sum(axis=2) / (r2 + 1.0e-6 * h**2)
        met = np.maximum(u_ij, 0.0)
        tension = 0.6 * (spacing_weight(r) / spacing_weight(w.spacing)) ** 4
        tension *= np.clip(np.sqrt(r2) * u_ij / (1e-4 * c), 0.0, 1.0)
        along += ("artificial_stress" != left_out) * tension * (np.maximum(-P_i, 0.0) + np.maximum(-P_j, 0.0))
        along += ("viscosity" != left_out) * 2.0 * (w.dimension + 2.0) * w.nu / RHO_0 * u_ij
        along += ("artificial_viscosity" != left_out) * alpha * h * c / RHO_0 * met
        along += ("riemann_dissipation" != left_out) * np.minimum(0.5 * r * met, c) * r * met / RHO_0
        return (along * polynomial_kernel(r / w.support))[..., None] * x_ij

    name, x, v = w.images()
    x_ij, r2 = pairs(w.x, x)
    total = force(x_ij, r2, pressing[name] + w.head(name, x) / RHO_0, w.v[:, None] - v[None]).sum(axis=1)
    xs, share, normal = w.samples()
    x_is, r2_s = pairs(w.x, xs)
    P_s = np.maximum(pressing[:, None] + w.sample_head(-x_is, normal) / RHO_0, -pressing[:, None])
    solid = force(x_is, r2_s, P_s, w.v[:, None] - w.sample_velocity(len(xs)))
    if left_out != "body":
        total += (share[:, None] * solid).sum(axis=1)
    return scale * total + w.gravity


def delta_continuity(
    water: Water, excess: np.ndarray, part: np.ndarray, delta: float, left_out: str = ""
) -> dict[str, np.ndarray]:
    """Rate of the density of `delta_sph`, the share M of a kernel that is filled, and the rate of the leak; `excess`:
    density less that at rest; `part`: share g of each particle in the diffusion."""
    w, h, still = water, 0.4 * water.support, RHO_0 / water.c**2 * water.gravity
    scale = w.mass * kernel_constant(w.dimension, w.support)

    def rates(x_ij, r2, v_ij, excess_j, part_j):
        weight = polynomial_kernel(np.sqrt(r2) / w.support)
        squeezed = ("continuity" != left_out) * -(v_ij * x_ij).sum(axis=2)
        beyond = excess_j - excess[:, None] + ("hydrostatic" != left_out) * x_ij @ still
        spread = 2.0 * delta * h * w.c / RHO_0 * np.minimum(part[:, None], part_j) * beyond
        return weight * (squeezed + ("density_diffusion" != left_out) * spread), weight * r2, weight[..., None] * x_ij

    name, x, v = w.images(free_slip=True)
    x_ij, r2 = pairs(w.x, x)
    rate, filled, lever = rates(
        x_ij, r2, w.v[:, None] - v[None], excess[name] + RHO_0 / w.c**2 * w.head(name, x), part[name][None]
    )
    xs, share, _ = w.samples()
    x_is, r2_s = pairs(w.x, xs)
    solid, filled_s, lever_s = rates(
        x_is, r2_s, np.repeat(w.v[:, None], len(xs), axis=1), excess[:, None] - x_is @ still, part[:, None]
    )
    on = "body" != left_out
    last = int(w.support / w.spacing) + 1
    lattice = w.spacing * np.array(list(product(range(-last, last + 1), repeat=w.dimension)), dtype=float)
    q = np.linalg.norm(lattice, axis=1) / w.support
    whole = (polynomial_kernel(q) * q**2).sum() * w.support**2
    filled = (filled.sum(axis=1) + on * (filled_s @ share)) / whole
    lever = lever.sum(axis=1) + on * np.einsum("ijk,j->ik", lever_s, share)
    edge = scale * w.support / RHO_0 * np.linalg.norm(lever, axis=1)
    held = np.clip(1.0 + excess / (1e-3 * RHO_0), 0.0, 1.0)
    drawn = solid @ share + (1.0 - held) * np.maximum(-(solid @ share), 0.0)
    return {"rate": scale * (rate.sum(axis=1) + on * drawn), "filled": filled, "edge": edge}


def delta_leak(water: Water, excess: np.ndarray, filled: np.ndarray, edge: np.ndarray, lack: np.ndarray) -> np.ndarray:
    """Rate (n,) [1/s] at which an excess of the density decays; `lack`: share of a kernel beyond a flat surface."""
    thinner = 1.0 + excess / RHO_0 - filled - lack
    share = np.clip((np.abs(thinner) - 0.015 - 0.06 * edge) / 0.25, 0.0, 1.0)
    packing = np.where(thinner * excess > 0.0, share * water.c / water.support, 0.0)
    tense = np.clip((-excess / RHO_0 - 3e-4) / 1e-3, 0.0, 1.0) * np.clip((edge - 0.1) / 0.5, 0.0, 1.0)
    return np.maximum(packing, tense * water.c / water.spacing)


def dfsph(water: Water, p: np.ndarray, left_out: str = "") -> dict[str, np.ndarray]:
    """Density, acceleration under all forces and the pressures p, and rate of compression of `dfsph`. Sums are such
    that the lattice is at rest, and its gradient of one is one."""
    w, H = water, water.support
    side = (w.mass / RHO_0) ** (1.0 / w.dimension)
    last = int(H / side) + 1
    lattice = side * np.array(list(product(range(-last, last + 1), repeat=w.dimension)), dtype=float)
    q = np.linalg.norm(lattice, axis=1) / H
    slope = 1.0 / (H**2 * side**w.dimension * kernel_value(q)[q < 1.0].sum())
    gain = slope * side**w.dimension * (polynomial_kernel(q) * lattice[:, 0] ** 2).sum()
    name, x, v = w.images()
    x_ij, r2 = pairs(w.x, x)
    xs, share, _ = w.samples()
    x_is, r2_s = pairs(w.x, xs)
    value, value_s = kernel_value(np.sqrt(r2) / H), kernel_value(np.sqrt(r2_s) / H)

    def force(x_ij, r2, p_j, v_ij):
        weight = slope / gain * polynomial_kernel(np.sqrt(r2) / H)
        press = ("pressure" != left_out) * w.mass / RHO_0**2 * (p[:, None] + p_j)
        closing = -(v_ij * x_ij).sum(axis=2) / (r2 + 1.0e-6 * H**2)
        rub = ("viscosity" != left_out) * 2.0 * w.nu * w.mass / RHO_0 * (w.dimension + 2.0) * closing
        return (weight * (press + rub))[..., None] * x_ij

    total = force(x_ij, r2, p[name] + RHO_0 * w.head(name, x), w.v[:, None] - v[None]).sum(axis=1)
    solid = force(x_is, r2_s, np.zeros_like(r2_s), w.v[:, None] - w.sample_velocity(len(xs)))
    if left_out != "body":
        total += (share[:, None] * solid).sum(axis=1)
    return {
        "density": w.mass * slope * H**2 * (value.sum(axis=1) + value_s @ share),
        "acceleration": total + w.gravity,
    }
