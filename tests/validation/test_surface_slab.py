"""The slab with a wave on it: both surfaces keep the promises of the coarse one, and a thick sheet smooths."""

import numpy as np
import pytest

from ocean_sim.validation.surface_slab import AMPLITUDE, DEPTH, RIGID_DEPTH, K, problems, smoothing_loss, wave_positions

KINDS = ("cloth", "marching_cubes")


@pytest.fixture(scope="module")
def errors():
    (problem,) = problems(coarse=True)
    runs = {kind: (kind, {}) for kind in KINDS} | {"thick": ("cloth", {"surface.thickness": 0.5})}
    found = {
        name: problem.run("surface_slab", kind, {"runtime.threads": 1} | sets) for name, (kind, sets) in runs.items()
    }
    return {name: {row["quantity"]: row for row in rows} for name, (rows, _) in found.items()}


@pytest.mark.parametrize("kind", KINDS)
def test_a_surface_shows_the_water_but_for_what_smoothing_takes(errors, kind):
    assert all(row["ok"] for row in errors[kind].values())
    assert errors[kind]["height of the wave [m]"]["error"] < 0.0


def test_a_thicker_sheet_takes_more_of_the_wave(errors):
    """Negative control: two and a half spacings instead of two."""
    thick, usual = (errors[name]["height of the wave [m]"]["error"] for name in ("thick", "cloth"))
    assert thick < usual - 3.0


def test_the_upper_water_keeps_its_density_and_the_bed_its_place():
    y = np.linspace(-DEPTH, 0.0, 241)
    moved = wave_positions(np.stack([np.zeros_like(y), y, np.zeros_like(y)], axis=1))[:, 1]
    assert moved[0] == -DEPTH and moved[-1] == pytest.approx(AMPLITUDE)
    np.testing.assert_allclose(np.diff(moved[y > -RIGID_DEPTH]), y[1] - y[0], rtol=1e-9)
    assert (np.diff(moved) > 0.0).all()


def test_smoothing_is_of_second_order():
    assert smoothing_loss(0.2, 0.2) == pytest.approx(4.0 * smoothing_loss(0.1, 0.1))
    assert smoothing_loss(0.1, 0.0) == pytest.approx((K * 0.2) ** 2 / 20.0)
