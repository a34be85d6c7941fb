"""Kernels against right-hand sides in NumPy: particles out of order between walls, over an obstacle."""

import numpy as np
import pytest

from ocean_sim.fluid.sph.smoothing import Stencil
from tests.fluid import reference_rhs as reference
from tests.fluid.conftest import by_id, put

pytestmark = pytest.mark.usefixtures("taichi_as_released")

GRAVITY = np.array([0.0, -9.81, 0.0])
OBSTACLE = {"min": [-0.1, -0.5], "max": [0.1, -0.4], "slip": "no_slip"}
BASIN = {"length": 1.1, "width": None, "depth": 0.5, "walls": {"x": "no_slip"}, "obstacles": [OBSTACLE]}
NUMBERS = {"spacing": 0.05, "collision_distance": 0.05, "kinematic_viscosity": 0.02, "reference_speed": 2.0}
DT = 1.0e-4  # [s]


def disturbed(water, kind: str, **keys):
    """About 200 particles, each moved by up to a third of the spacing, stored out of order and stirred, after two steps
    by which bodies remember accelerations."""
    fluid = water(kind, basin=BASIN, **NUMBERS, **keys)
    rng, n = np.random.default_rng(8), fluid.particles.n
    x = by_id(fluid, fluid.particles.position.to_numpy()) + rng.uniform(-0.016, 0.016, (n, 3)) * [1.0, 1.0, 0.0]
    put(fluid, rng.permutation(x), rng.normal(0.0, 0.5, (n, 3)) * [1.0, 1.0, 0.0])
    for _ in range(2):
        fluid.advance(DT)
    return fluid


def arrays(fluid, *fields) -> np.ndarray:
    """Fields as columns, in the order of ids."""
    return by_id(fluid, np.stack([field.to_numpy()[: fluid.particles.n] for field in fields], axis=-1))


def now(fluid, nu: float | None = None) -> reference.Water:
    """The fluid as the reference takes it."""
    boundary, p = fluid.boundary, fluid.particles
    body = reference.Samples(
        np.stack([part.to_numpy() for part in boundary.position], axis=1),
        boundary.share.to_numpy(),
        np.stack([part.to_numpy() for part in boundary.normal], axis=1),
        True,
    )
    sides = [reference.Side(0, -0.55, True), reference.Side(0, 0.55, True), reference.Side(1, -0.5, False)]
    return reference.Water(
        x=arrays(fluid, *p.position),
        v=arrays(fluid, *p.velocity),
        gravity=GRAVITY,
        mass=p.mass,
        dimension=2,
        support=fluid.smoothing.support,
        spacing=p.spacing,
        sides=sides,
        body=body,
        nu=fluid.kinematic_viscosity if nu is None else nu,
        c=fluid.sound_speed,
        past=arrays(fluid, *fluid.last_acceleration) if fluid.last_acceleration else np.zeros(3),
    )


def same(found: np.ndarray, wanted: np.ndarray) -> bool:
    return bool(np.abs(found - wanted).max() < 1e-9 * np.abs(wanted).max())


def test_mueller_is_its_formulas(water):
    fluid = disturbed(water, "mueller")
    before, density = now(fluid), arrays(fluid, fluid.particles.density)[:, 0]
    fluid.advance(DT)
    gained = (arrays(fluid, *fluid.particles.velocity) - before.v) / DT

    def agrees(left_out: str = "") -> bool:
        wanted = reference.mueller(before, fluid.stiffness, left_out)
        return same(gained, wanted["acceleration"]) and same(density, wanted["density"])

    assert agrees()
    for term in ("pressure", "viscosity", "body"):
        assert not agrees(left_out=term), term


def test_delta_sph_is_its_formulas(water):
    alpha = 0.05
    fluid = disturbed(water, "delta_sph", artificial_viscosity=alpha, exponent=7)
    middle = now(fluid)
    excess, rate = (arrays(fluid, part)[:, 0] for part in (fluid.excess, fluid.rate))
    shares = arrays(fluid, fluid.fresh[0])[:, 0]
    fluid.advance(DT)
    h, c = 0.4 * middle.support, middle.c
    middle.x = middle.x + 0.5 * DT * middle.v
    excess = excess + 0.5 * DT * rate
    damped = reference.equation_of_state(excess, c, 7) + min(0.7 * c * h, 0.42 * h**2 / DT) * rate
    pressing = damped / (reference.RHO_0 + excess) ** 2
    assert (pressing < 0.0).any() and (pressing > 0.0).any(), "some water is under tension"
    gained = (arrays(fluid, *fluid.particles.velocity) - middle.v) / DT

    def momentum(left_out: str = "") -> bool:
        return same(gained, reference.delta_momentum(middle, pressing, alpha, left_out))

    assert momentum()
    for term in ("pressure", "artificial_stress", "viscosity", "artificial_viscosity", "riemann_dissipation", "body"):
        assert not momentum(left_out=term), term

    end, found = now(fluid), arrays(fluid, fluid.rate)[:, 0]

    def continuity(left_out: str = "") -> bool:
        return same(found, reference.delta_continuity(end, excess, shares, 0.1, left_out)["rate"])

    assert continuity() and np.ptp(shares) > 0.5
    for term in ("continuity", "density_diffusion", "hydrostatic", "body"):
        assert not continuity(left_out=term), term
    sums = reference.delta_continuity(end, excess, shares, 0.1)
    graded = np.clip((sums["filled"] - 0.90) / 0.07, 0.0, 1.0)
    np.testing.assert_allclose(arrays(fluid, fluid.fresh[0])[:, 0], graded, atol=1e-9)

    a, b = Stencil(fluid.smoothing, fluid.spacing).surface_deficit
    lack = (a - b * sums["edge"]) * sums["edge"]
    leak = reference.delta_leak(end, excess, sums["filled"], sums["edge"], lack)
    unleaked = excess + 0.5 * DT * found
    assert (leak > 0.0).sum() > 10 and (leak == 0.0).sum() > 20
    np.testing.assert_allclose(arrays(fluid, fluid.excess)[:, 0], (1.0 - DT * leak) * unleaked, rtol=1e-9, atol=1e-9)


def test_dfsph_is_its_formulas(water):
    keys = {"max_density_iterations": 0, "max_divergence_iterations": 0}
    fluid = disturbed(water, "dfsph", **keys)
    fluid.held_pressure.from_numpy(np.random.default_rng(9).uniform(0.0, 5000.0, fluid.held_pressure.shape[0]))
    before, pressure = now(fluid, fluid.config.viscosity(fluid.basin)), arrays(fluid, fluid.held_pressure)[:, 0]
    density = arrays(fluid, fluid.particles.density)[:, 0]
    fluid.advance(DT)
    gained = (arrays(fluid, *fluid.particles.velocity) - before.v) / DT

    def agrees(left_out: str = "") -> bool:
        wanted = reference.dfsph(before, pressure, left_out)
        return same(gained, wanted["acceleration"]) and same(density, wanted["density"])

    assert agrees()
    for term in ("pressure", "viscosity", "body"):
        assert not agrees(left_out=term), term
