"""Drag, lift and the drag coefficient: (2.20) to (2.23)."""

import numpy as np
import pytest

from ocean_sim.conventions import AIR_DENSITY
from ocean_sim.kernel_library import ti, tm
from ocean_sim.wind.shared.air_load import C_d, drag, drag_coefficient, lift, stress

WINDS = np.random.default_rng(1).normal(size=(200, 3)) * 12.0  # [m/s]
AREA, C_L = 2.5, 1.0e-3  # [m2], lift coefficient


@pytest.fixture(scope="module")
def loads(taichi_cpu):
    """Drag and lift [N] of winds (n, 3)."""

    @ti.kernel
    def evaluate(
        wind: ti.types.ndarray(dtype=ti.f64, ndim=2),
        drags: ti.types.ndarray(dtype=ti.f64, ndim=2),
        lifts: ti.types.ndarray(dtype=ti.f64, ndim=2),
    ):
        for i in range(wind.shape[0]):
            w = tm.vec3(wind[i, 0], wind[i, 1], wind[i, 2])
            d, up = drag(w, AREA), lift(w, AREA, C_L)
            for k in ti.static(range(3)):
                drags[i, k], lifts[i, k] = d[k], up[k]

    def both(winds):
        winds = np.ascontiguousarray(np.atleast_2d(winds), dtype=float)
        drags, lifts = np.zeros_like(winds), np.zeros_like(winds)
        evaluate(winds, drags, lifts)
        return drags, lifts

    return both


def test_the_drag_coefficient_is_continuous_at_7_5():
    assert drag_coefficient(7.5) == pytest.approx(1.2875e-3, rel=1e-12)
    assert drag_coefficient(np.nextafter(7.5, 0.0)) == pytest.approx(
        drag_coefficient(np.nextafter(7.5, 8.0)), rel=1e-12
    )


@pytest.mark.parametrize("u10", [0.0, 2.0, 5.0, 7.4999, 7.5, 10.0, 20.0, 50.0])
def test_both_branches_of_the_drag_coefficient(u10):
    printed = 1.2875e-3 if u10 < 7.5 else (0.8 + 0.065 * u10) * 1e-3  # (2.21)
    assert drag_coefficient(u10) == pytest.approx(printed, rel=1e-12)


def test_the_coefficient_is_the_same_in_a_kernel(taichi_cpu):
    @ti.kernel
    def coefficient(u: float) -> float:
        return C_d(u)

    for u in (0.0, 5.0, 7.5, 7.6, 30.0):
        assert coefficient(u) == pytest.approx(drag_coefficient(u), rel=1e-14)


@pytest.mark.parametrize("u10, pascal", [(2.0, 0.00630875), (10.0, 0.177625), (20.0, 1.029), (50.0, 12.4031)])
def test_stress_of_wu_1982(u10, pascal):
    assert stress(u10) == pytest.approx(pascal, rel=1e-5)


def test_drag_is_the_stress_times_the_area_downwind(loads):
    drags, _ = loads(WINDS)
    speed = np.linalg.norm(WINDS, axis=1)
    expected = np.array([stress(u) for u in speed])[:, None] * AREA * WINDS / speed[:, None]
    np.testing.assert_allclose(drags, expected, rtol=1e-12)


def test_drag_and_lift_are_quadratic_where_the_coefficient_is_constant(loads):
    once, twice = loads([2.0, 0.5, -1.0]), loads([4.0, 1.0, -2.0])
    for a, b in zip(once, twice):
        np.testing.assert_allclose(b, 4.0 * a, rtol=1e-12)


def test_lift_is_across_the_wind_and_upwards(loads):
    _, lifts = loads(WINDS)
    size = np.linalg.norm(lifts, axis=1) * np.linalg.norm(WINDS, axis=1)
    assert np.abs((lifts * WINDS).sum(axis=1) / size).max() < 1e-6
    assert (lifts[:, 1] > 0.0).all()
    in_the_plane_of_wind_and_vertical = lifts[:, 0] * WINDS[:, 2] - lifts[:, 2] * WINDS[:, 0]
    assert np.abs(in_the_plane_of_wind_and_vertical / size).max() < 1e-12


def test_lift_of_a_level_wind_points_straight_up(loads):
    _, lifts = loads([6.0, 0.0, 8.0])
    np.testing.assert_allclose(lifts[0], [0.0, 0.5 * AIR_DENSITY * 100.0 * AREA * C_L, 0.0], atol=1e-15)


def test_no_wind_and_a_vertical_wind_give_finite_loads(loads):
    drags, lifts = loads([[0.0, 0.0, 0.0], [0.0, 5.0, 0.0]])
    assert np.all(drags[0] == 0.0) and np.all(lifts == 0.0)
    np.testing.assert_allclose(drags[1], [0.0, stress(5.0) * AREA, 0.0])
