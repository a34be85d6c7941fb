"""Heights between columns."""

import numpy as np
import pytest

from ocean_sim.surface.shared.heights import Heights


@pytest.mark.parametrize("inset", [0.0, 0.5])
@pytest.mark.parametrize("periodic", [False, True])
def test_a_plane_between_columns_and_level_or_repeated_beyond_the_sides(taichi_cpu, inset, periodic):
    count, lower, upper = (5, 4), np.array([-1.0, 0.0]), np.array([1.0, 3.0])
    heights = Heights(lower, upper, count, (periodic, periodic), inset)
    x, z = ((np.arange(n) + inset) / (n - 1 + 2 * inset) * (b - a) + a for n, a, b in zip(count, lower, upper))
    heights.height.from_numpy((2.0 * x[:, None] + z[None, :]).ravel())
    inside = np.random.default_rng(1).uniform((x[0], z[0]), (x[-1], z[-1]), (50, 2))
    np.testing.assert_allclose(heights.elevations(inside), 2.0 * inside[:, 0] + inside[:, 1], atol=1e-12)
    beyond = inside + (upper - lower if periodic else 0.0)
    np.testing.assert_allclose(heights.elevations(beyond), heights.elevations(inside), atol=1e-12)
    if not periodic:
        assert heights.elevations(np.array([[9.0, 9.0]])) == pytest.approx(2.0 * x[-1] + z[-1])


def test_a_point_just_below_the_first_column_of_a_period_has_its_height(taichi_cpu):
    """There rounding makes a whole period of the distance from the first column."""
    heights = Heights(np.zeros(2), np.ones(2), (4, 4), (True, True), 0.5)
    heights.height.from_numpy(np.arange(1.0, 17.0))
    below = np.nextafter(0.125, 0.0)
    assert heights.elevations(np.array([[below, below]])) == pytest.approx(1.0)
