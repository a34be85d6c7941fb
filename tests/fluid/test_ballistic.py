"""Particles without interaction: exact parabolas, bounces by restitution and Coulomb's friction, counted limits."""

import numpy as np
import pytest

from ocean_sim.conventions import GRAVITY
from tests.fluid.conftest import box, by_id


def test_parabolas_are_exact_for_any_step(water):
    fluid = water("ballistic", basin={"walls": "none", "floor": "none"}, particles=50)
    x = np.random.default_rng(0).uniform(-0.4, 0.4, (fluid.particles.n, 3))
    v = np.random.default_rng(1).normal(0.0, 2.0, x.shape)
    put_ballistic(fluid, x, v)
    for dt in (0.1, 0.03, 0.27):
        fluid.advance(dt)
    t = 0.4
    expected = x + v * t + 0.5 * np.array([0.0, -GRAVITY, 0.0]) * t**2
    np.testing.assert_allclose(by_id(fluid, fluid.particles.position.to_numpy()), expected, atol=1e-12)


def put_ballistic(fluid, x, v) -> None:
    fluid.particles.position.from_numpy(x)
    fluid.particles.velocity.from_numpy(v)
    fluid.particles.id.from_numpy(np.arange(len(x), dtype=np.int32))
    fluid.advance(0.0)


def test_the_floor_returns_the_restitution_and_takes_coulombs_friction(water):
    basin = {"gravity": [0.0, 0.0, 0.0], "restitution": 0.162, "friction": 0.146}
    fluid = water("ballistic", basin=basin, **box(2, 1, 1))
    x = np.array([[0.0, -0.44, 0.0], [0.2, -0.44, 0.0]])
    put_ballistic(fluid, x, np.array([[3.0, -2.0, 0.0], [0.1, -2.0, 0.0]]))
    fluid.advance(0.02)
    v = by_id(fluid, fluid.particles.velocity.to_numpy())
    kick = 0.146 * (1.0 + 0.162) * 2.0
    np.testing.assert_allclose(v[0], [3.0 - kick, 0.162 * 2.0, 0.0], rtol=1e-12)
    np.testing.assert_allclose(v[1], [0.0, 0.162 * 2.0, 0.0], atol=1e-12)


def test_the_motion_limit_counts_what_it_holds_back(water):
    fluid = water("ballistic", basin={"walls": "none", "floor": "none"}, **box(3, 1, 1), motion_limit=2.0)
    reach = 2.0 * fluid.particles.spacing
    v = np.array([[0.0, 0.0, 0.0], [50.0, 0.0, 0.0], [0.0, 0.0, -50.0]])
    put_ballistic(fluid, np.zeros((3, 3)), v)
    assert fluid.status.clipped == 0
    fluid.advance(0.05)
    moved = np.linalg.norm(by_id(fluid, fluid.particles.position.to_numpy()), axis=1)
    assert fluid.status.clipped == 2
    assert moved.max() == pytest.approx(reach, rel=1e-9)
