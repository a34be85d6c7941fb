"""Sums over all particles, against NumPy's in float64."""

import numpy as np

from tests.fluid.conftest import put


def test_they_are_the_sums_of_the_particles(water):
    fluid = water("mueller", spacing=1.0 / 7.0, basin={"length": 1.0, "width": 1.0, "depth": 1.0})
    rng, particles = np.random.default_rng(3), fluid.particles
    x, v = rng.uniform(-0.4, 0.3, (particles.n, 3)), rng.normal(size=(particles.n, 3))
    put(fluid, x, v)
    particles.density.from_numpy(rng.uniform(900.0, 1100.0, particles.n))
    x, v, rho = (f.to_numpy().astype(float) for f in (particles.position, particles.velocity, particles.density))
    found, excess = fluid.totals(), rho / particles.rest_density - 1.0
    near = {"rtol": 1e-12, "atol": 1e-12}
    np.testing.assert_allclose(found.density, rho.sum(), **near)
    np.testing.assert_allclose(found.compression, np.maximum(excess, 0.0).sum(), **near)
    np.testing.assert_allclose(found.most_compressed, max(excess.max(), 0.0), **near)
    np.testing.assert_allclose(found.deficit, np.maximum(-excess, 0.0).sum(), **near)
    np.testing.assert_allclose(found.squared_speed, (v * v).sum(), **near)
    np.testing.assert_allclose(found.position, x.sum(axis=0), **near)
    np.testing.assert_allclose(found.velocity, v.sum(axis=0), **near)
    np.testing.assert_allclose(found.turning, np.cross(x, v).sum(axis=0), **near)
    np.testing.assert_array_equal(found.lower, x.min(axis=0))
    np.testing.assert_array_equal(found.upper, x.max(axis=0))
    assert found.finite


def test_what_is_not_a_number_is_seen(water):
    fluid = water("mueller", spacing=0.25, basin={"length": 1.0, "width": 1.0, "depth": 1.0})
    for field in (fluid.particles.density, fluid.particles.velocity.y, fluid.particles.position.x):
        before = field.to_numpy()
        field[5] = float("nan")
        assert not fluid.totals().finite
        field.from_numpy(before)
        assert fluid.totals().finite
