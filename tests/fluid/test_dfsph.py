"""Incompressible water: what the two solvers promise, momentum, still water, and what becomes of it without them."""

import numpy as np
import pytest

from ocean_sim.conventions import GRAVITY
from tests.fluid.conftest import box, put

OPEN = {"length": 1.0, "width": 1.0, "depth": 0.5, "walls": "none", "floor": "none"}
TANK = {"length": 0.8, "width": 0.4, "depth": 0.4}
COLUMN = [{"min": [-0.4, -0.4, -0.2], "max": [0.0, 0.0, 0.2]}]


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_lattice_has_the_rest_density_inside_and_at_walls(water, dimension):
    fluid = water("dfsph", basin={"length": 1.0, "depth": 1.0, "width": 1.0 if dimension == 3 else None})
    x, rho = fluid.particles.position.to_numpy(), fluid.particles.density.to_numpy()
    np.testing.assert_allclose(rho[x[:, 1] < -0.25], 1000.0, rtol=1e-9)
    assert rho[x[:, 1] > -0.1].max() < 900.0, "a surface lacks neighbours, and says so"


def rushing_together(water, **keys):
    """A shaken block without gravity whose halves run into each other, after one step."""
    basin = OPEN | {"gravity": [0.0, 0.0, 0.0]}
    fluid = water("dfsph", basin=basin, reference_speed=2.0, ledger=True, **keys, **box(6, 6, 6, spacing=0.05))
    x = fluid.particles.position.to_numpy()
    x += 0.05 * fluid.particles.spacing * np.random.default_rng(3).uniform(-1.0, 1.0, x.shape)
    v = np.zeros_like(x)
    v[:, 0] = x[:, 0].mean() - x[:, 0]
    put(fluid, x, v)
    fluid.before = fluid.particles.velocity.to_numpy().sum(axis=0)
    fluid.advance(5e-3)
    return fluid


def test_the_solvers_end_within_their_tolerances_and_say_so(water):
    fluid = rushing_together(water, density_tolerance=1e-5, divergence_tolerance=1e-5)
    assert fluid.solver_error["density"] <= 1e-5 and fluid.solver_error["divergence"] <= 1e-5
    assert fluid.iterations["density"] > 0 and fluid.iterations["divergence"] > 0
    assert fluid.unsolved == {"density": 0, "divergence": 0}
    excess = np.maximum(fluid.particles.density.to_numpy() / 1000.0 - 1.0, 0.0)
    assert excess.mean() < 2e-4, "the density found is the density wanted, up to the square of the step"


def test_a_limit_of_iterations_that_is_met_is_counted(water):
    fluid = rushing_together(
        water,
        density_tolerance=1e-7,
        divergence_tolerance=1e-7,
        max_density_iterations=2,
        max_divergence_iterations=1,
    )
    assert fluid.iterations == {"density": 2, "divergence": 1}
    assert fluid.unsolved == {"density": 1, "divergence": 1}
    assert fluid.solver_error["density"] > 1e-7 and fluid.solver_error["divergence"] > 1e-7


def test_momentum_is_kept_to_rounding(water):
    fluid = rushing_together(water, kinematic_viscosity=0.01)
    gained = np.abs(fluid.particles.velocity.to_numpy()).sum()
    np.testing.assert_allclose(fluid.particles.velocity.to_numpy().sum(axis=0), fluid.before, atol=1e-13 * gained)
    assert np.abs(fluid.impulse["pressure"]).max() < 1e-13 * gained * fluid.particles.mass


def test_still_water_holds_the_hydrostatic_pressure(water):
    """To 0.4 s and with some viscosity: without it the lattice gives way in time, and the water simmers."""
    keys = {"kinematic_viscosity": 0.01, "divergence_tolerance": 1e-4, "ledger": True}
    fluid = water("dfsph", basin={"length": 0.8, "width": 0.8, "depth": 0.8}, **keys)
    for _ in range(40):
        fluid.advance(0.01)
    y = fluid.particles.position.to_numpy()[:, 1]
    error = (fluid.particles.pressure.to_numpy() + 1000.0 * GRAVITY * y) / (1000.0 * GRAVITY * 0.8)
    assert np.sqrt((error**2).mean()) < 0.02
    assert abs(error[y < -0.7].mean()) < 0.02
    weight = fluid.particles.mass * fluid.particles.n * GRAVITY
    assert fluid.impulse["walls"][1] == pytest.approx(weight * 0.4, rel=0.02)


def collapsed(water, **keys):
    """A column of water that falls into a tank, after 0.2 s: mean of what is denser than at rest."""
    fluid = water("dfsph", basin=TANK, spacing=0.05, fill=COLUMN, kinematic_viscosity=0.005, **keys)
    for _ in range(80):
        fluid.advance(2.5e-3)
    assert fluid.status.finite
    return float(np.maximum(fluid.particles.density.to_numpy() / 1000.0 - 1.0, 0.0).mean())


def test_a_falling_column_is_not_compressed(water):
    assert collapsed(water) < 2e-3


def test_without_its_solvers_water_is_compressed(water):
    """Negative control."""
    assert collapsed(water, max_density_iterations=0, max_divergence_iterations=0) > 0.05
