"""Smoothing kernels: normalised, differentiated right, in two and three dimensions."""

from dataclasses import dataclass
from math import pi

import numpy as np
import pytest

from ocean_sim.basin import Config as BasinConfig
from ocean_sim.fluid import delta_sph, dfsph
from ocean_sim.fluid.sph.smoothing import NEUTRAL_KERNEL, WENDLAND, Kernel, Smoothing, Stencil
from ocean_sim.kernel_library import ti
from tests.fluid.lattice_modes import softest_mode

pytestmark = pytest.mark.usefixtures("taichi_as_released")

SUPPORT = 0.7


def tabulated(smoothing: Smoothing, r: np.ndarray) -> dict[str, np.ndarray]:
    """The kernels of Mueller, Charypar & Gross (2003) at distances r [m], with the constants of `mueller`: poly6 as it
    is compiled, the others in NumPy; of spiky also the radial part of the gradient, of viscosity the Laplacian."""
    h, q, poly6 = smoothing.support, r / smoothing.support, np.empty_like(r)
    inside = np.maximum(h - r, 0.0)

    @ti.kernel
    def fill(r: ti.types.ndarray(), values: ti.types.ndarray()):
        for k in range(r.shape[0]):
            values[k] = smoothing.W_poly6(r[k] ** 2)

    fill(r, poly6)
    with np.errstate(divide="ignore"):
        if smoothing.dimension == 3:
            viscosity = 15.0 / (2.0 * pi * h**3) * (-0.5 * q**3 + q**2 + 0.5 / q - 1.0)
        else:
            viscosity = 10.0 / (3.0 * pi * h**2) * (-4.0 / 3.0 * q**3 + 3.0 * q**2 - 2.0 * np.log(q) - 5.0 / 3.0)
    return {
        "poly6": poly6,
        "spiky": smoothing.spiky_constant * inside**3,
        "grad_spiky": -3.0 * smoothing.spiky_constant * inside**2,
        "viscosity": np.where(q < 1.0, viscosity, 0.0),
        "laplacian": smoothing.viscosity_constant * inside,
    }


def volume_integral(dimension: int, r: np.ndarray, W: np.ndarray) -> float:
    """Of a radial function over all space, midpoint rule."""
    shell = 2.0 * pi * r if dimension == 2 else 4.0 * pi * r**2
    return float((W * shell).sum() * (r[1] - r[0]))


def integrates_to_one(smoothing: Smoothing) -> None:
    r = (np.arange(20_000) + 0.5) * SUPPORT * 1.2 / 20_000
    values = tabulated(smoothing, r)
    for name in ("poly6", "spiky", "viscosity"):
        assert volume_integral(smoothing.dimension, r, values[name]) == pytest.approx(1.0, abs=1e-4), name


@pytest.mark.parametrize("dimension", [2, 3])
def test_every_kernel_integrates_to_one(taichi_cpu, dimension):
    integrates_to_one(Smoothing(dimension, SUPPORT))


@pytest.mark.parametrize("kernel", [WENDLAND, NEUTRAL_KERNEL, Kernel(4, (1.0, -0.5))])
@pytest.mark.parametrize("dimension", [2, 3])
def test_kernels_of_a_polynomial_gradient_are_normalised_and_belong_together(taichi_cpu, kernel, dimension):
    smoothing = Smoothing(dimension, SUPPORT, kernel)
    r, d = (np.arange(20_000) + 0.5) * SUPPORT * 1.2 / 20_000, 1e-6
    gradient, value = np.empty_like(r), np.empty_like(r)

    @ti.kernel
    def fill(r: ti.types.ndarray(), gradient: ti.types.ndarray(), value: ti.types.ndarray()):
        for k in range(r.shape[0]):
            gradient[k], value[k] = smoothing.shape_gradient(r[k]), smoothing.shape_value(r[k])

    fill(r, gradient, value)
    W = smoothing.slope * SUPPORT**2 * value
    assert volume_integral(dimension, r, W) == pytest.approx(1.0, abs=1e-6)
    np.testing.assert_allclose(np.gradient(W, r)[1:-1], (-smoothing.slope * gradient * r)[1:-1], atol=1e-4 * W.max())
    t = np.linspace(0.1, 0.9, 9)
    np.testing.assert_allclose(kernel.value(1.0 - np.minimum(r / SUPPORT, 1.0)), value, atol=1e-15)
    np.testing.assert_allclose(kernel.gradient(1.0 - np.minimum(r / SUPPORT, 1.0)), gradient, atol=1e-14)
    slopes = [-(1.0 - s) * kernel.gradient(s) for s in (t - d, t + d)]  # W' over slope support
    np.testing.assert_allclose(kernel.curvature(t), (slopes[0] - slopes[1]) / (2.0 * d), atol=1e-7)


def test_wendlands_kernel_is_his():
    q = np.linspace(0.0, 1.0, 11)
    for dimension, constant in ((2, 7.0 / pi), (3, 21.0 / (2.0 * pi))):
        W = WENDLAND.slope(dimension, 1.0) * WENDLAND.value(1.0 - q)
        np.testing.assert_allclose(W, constant * (1.0 - q) ** 4 * (1.0 + 4.0 * q), atol=1e-14)


def test_a_wrong_constant_is_noticed(taichi_cpu):
    """Negative control: the constants of three dimensions used in two."""

    @ti.data_oriented
    @dataclass(frozen=True, eq=False)
    class Wrong(Smoothing):
        @property
        def poly6_constant(self) -> float:
            return 315.0 / (64.0 * pi * self.support**9)

    with pytest.raises(AssertionError):
        integrates_to_one(Wrong(2, SUPPORT))


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_gradient_of_spiky_equals_finite_differences(taichi_cpu, dimension):
    smoothing, d = Smoothing(dimension, SUPPORT), 1e-6
    r = np.linspace(0.05, 0.95, 50) * SUPPORT
    before, here, behind = (tabulated(smoothing, r + s) for s in (-d, 0.0, d))
    slope = (behind["spiky"] - before["spiky"]) / (2.0 * d)
    np.testing.assert_allclose(here["grad_spiky"], slope, rtol=1e-5, atol=1e-5 * np.abs(slope).max())


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_laplacian_is_that_of_the_viscosity_kernel_and_never_negative(taichi_cpu, dimension):
    smoothing, d = Smoothing(dimension, SUPPORT), 1e-4
    r = np.linspace(0.1, 0.95, 50) * SUPPORT
    before, here, behind = (tabulated(smoothing, r + s)["viscosity"] for s in (-d, 0.0, d))
    laplacian = (behind - 2.0 * here + before) / d**2 + (dimension - 1) / r * (behind - before) / (2.0 * d)
    stated = tabulated(smoothing, r)["laplacian"]
    np.testing.assert_allclose(stated, laplacian, rtol=1e-4, atol=1e-4 * stated.max())
    assert (tabulated(smoothing, np.linspace(0.0, 2.0, 500) * SUPPORT)["laplacian"] >= 0.0).all()


def lattice(dimension: int, spacing: float, half: int) -> np.ndarray:
    axis = np.arange(-half, half + 1) * spacing
    grid = np.meshgrid(*[axis] * dimension, indexing="ij")
    points = np.zeros((grid[0].size, 3))
    points[:, :dimension] = np.stack([g.ravel() for g in grid], axis=1)
    return points


def interpolated(dimension: int, spacing: float, ratio: float, field) -> tuple[float, float]:
    """(2.5) with poly6 at an uneven point of a lattice: the interpolated and the exact value."""
    point = np.array([0.31, 0.17, 0.0 if dimension == 2 else 0.23]) * spacing
    x = lattice(dimension, spacing, int(ratio) + 2)
    W = tabulated(Smoothing(dimension, ratio * spacing), np.linalg.norm(x - point, axis=1))["poly6"]
    return float((spacing**dimension * field(x) * W).sum()), float(field(point[None])[0])


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_constant_interpolates_to_itself(taichi_cpu, dimension):
    for ratio in (2.0, 3.0, 4.0):
        value, exact = interpolated(dimension, 0.1, ratio, lambda x: np.full(len(x), 3.0))
        assert value == pytest.approx(exact, rel=0.02)


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_error_of_interpolation_falls_with_the_square_of_the_support(taichi_cpu, dimension):
    def smooth(x):
        return np.cos(1.3 * x[:, 0]) * np.cos(0.7 * x[:, 1])

    errors = [abs(np.subtract(*interpolated(dimension, spacing, 5.0, smooth))) for spacing in (0.16, 0.08, 0.04)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert (orders > 1.7).all(), orders


@pytest.mark.parametrize("scheme", [delta_sph, dfsph])
@pytest.mark.parametrize("width", [None, 1.0])
def test_the_lattice_that_water_starts_from_is_as_water_is_under_the_neutral_kernel(width, scheme):
    """Where it is stable it is rigid, under other kernels, and where it bears no shear it gives way."""
    basin = BasinConfig(length=1.0, width=width, depth=0.5).build()
    stencil = Stencil(scheme.Config(spacing=0.1).smoothing(basin), 0.1)
    assert abs(softest_mode(stencil)) < 0.006 and abs(stencil.rigidity) < 0.001
    assert stencil.filled_gain == pytest.approx(1.0, abs=0.002)
    for ratio in np.arange(2.0, 4.1, 0.1):
        other = Stencil(Smoothing(basin.dimension, ratio * 0.1), 0.1)
        assert abs(other.rigidity) > 0.004 or softest_mode(other) < -0.01


@pytest.mark.parametrize(("dimension", "ratio"), [(2, 3.6), (2, 3.0), (2, 2.6), (3, 2.6), (3, 2.4), (3, 3.2)])
def test_it_is_not_at_others(dimension, ratio):
    assert softest_mode(Stencil(Smoothing(dimension, ratio * 0.1), 0.1)) < -0.01


@pytest.mark.parametrize("dimension, ratio, share", [(3, 2.82, 0.0456), (3, 2.0, 0.1114), (2, 4.0, 0.0066)])
def test_the_rigidity_is_what_shear_adds_to_the_sum_of_the_kernel(dimension, ratio, share):
    """Second differences of the sum over a lattice that is sheared along its axes and along its diagonals; the kernel's
    slope along an axis is the pressure's."""
    stencil, small = Stencil(Smoothing(dimension, ratio), 1.0), 1e-3

    def density(along: np.ndarray, across: np.ndarray, shear: float) -> float:
        places = stencil.offsets + shear * (stencil.offsets @ across)[:, None] * along
        return float(WENDLAND.value(np.maximum(1.0 - np.linalg.norm(places, axis=1) / ratio, 0.0)).sum())

    x, y = np.eye(dimension)[:2]
    pairs = (x, y), ((x + y) / np.sqrt(2.0), (x - y) / np.sqrt(2.0))
    curved = [(density(*p, small) - 2.0 * density(*p, 0.0) + density(*p, -small)) / small**2 for p in pairs]
    pressure = float(stencil.gradient @ stencil.offsets[:, 0] ** 2) / ratio**2
    assert stencil.rigidity == pytest.approx(np.mean(curved) / pressure, rel=1e-3)
    assert stencil.rigidity == pytest.approx(share, abs=1e-4)


def test_much_support_makes_a_lattice_water():
    assert abs(Stencil(Smoothing(3, 6.0), 1.0).rigidity) < 0.002
