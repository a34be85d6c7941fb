"""Plain numbers against NumPy: the same algebra, to rounding."""

import numpy as np
import pytest

from ocean_sim.ship.body import small_linalg
from ocean_sim.ship.forces.damping import CrossFlow

ROUNDING = 1e-13  # a few hundred units in the last place of numbers about 1


@pytest.fixture
def drawn():
    """A matrix that is far from singular, and two vectors, of a fixed seed."""
    rng = np.random.default_rng(1998)
    return rng.normal(size=(3, 3)) + 3.0 * np.eye(3), rng.normal(size=3), rng.normal(size=3)


def test_vectors_and_matrices_are_numpys(drawn):
    m, a, b = drawn
    rows, x, y = m.tolist(), a.tolist(), b.tolist()
    for found, wanted in (
        (small_linalg.plus(x, y), a + b),
        (small_linalg.minus(x, y), a - b),
        (small_linalg.times(0.7, x), 0.7 * a),
        (small_linalg.times_each(x, y), a * b),
        (small_linalg.dot(x, y), a @ b),
        (small_linalg.cross(x, y), np.cross(a, b)),
        (small_linalg.matrix_times(rows, x), m @ a),
        (small_linalg.transpose_times(rows, x), m.T @ a),
        (small_linalg.solve_3x3(rows, x), np.linalg.solve(m, a)),
    ):
        np.testing.assert_allclose(found, wanted, rtol=0.0, atol=ROUNDING)


def test_a_quaternion_turns_as_its_matrix_does(drawn):
    _, a, b = drawn
    q = small_linalg.unit_quaternion((0.3, *a.tolist()))
    pure = small_linalg.quaternion_product(
        small_linalg.quaternion_product(q, (0.0, *b.tolist())), (q[0], -q[1], -q[2], -q[3])
    )
    assert small_linalg.matrix_times(small_linalg.rotation_matrix(q), b.tolist()) == pytest.approx(
        pure[1:], abs=ROUNDING
    )
    whole = small_linalg.quaternion_product(
        small_linalg.turn_quaternion((0.2, 0.0, 0.0)), small_linalg.turn_quaternion((0.3, 0.0, 0.0))
    )
    assert whole == pytest.approx(small_linalg.turn_quaternion((0.5, 0.0, 0.0)), abs=ROUNDING)


@pytest.mark.parametrize("speed", [-1.3, 0.0, 0.4])
@pytest.mark.parametrize("rate", [-0.5, -0.02, 0.0, 1e-300, 0.02, 0.5])
def test_cross_flow_is_the_sum_over_its_sections(speed, rate):
    z = np.linspace(-7.0, 6.0, 27)
    c = 900.0 * np.exp(-((z / 5.0) ** 2))
    across = speed + rate * z
    drag = c * np.abs(across) * across
    force, moment = CrossFlow(z, c).strip_drag(speed, rate)
    assert force == pytest.approx(drag.sum(), abs=ROUNDING * np.abs(drag).sum())
    assert moment == pytest.approx((drag * z).sum(), abs=7.0 * ROUNDING * np.abs(drag).sum())
