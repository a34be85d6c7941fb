"""The case of a rough channel: its closed form, runs that keep its promises, and some over another bed."""

import numpy as np
import pytest

from ocean_sim.basin import Floor
from ocean_sim.validation import problems, rough_channel

SPACING, QUICK = 0.02, {"runtime.threads": 1}


def test_the_profile_bears_the_weight_meets_the_law_and_has_the_mean_speed():
    z = np.linspace(0.0, rough_channel.DEPTH, 2001)
    u = rough_channel.steady_profile(z, SPACING)
    slope = rough_channel.VISCOSITY * rough_channel.DENSITY * np.gradient(u, z, edge_order=2)
    assert slope[-1] == pytest.approx(0.0, abs=1e-6) and slope[0] == pytest.approx(rough_channel.STRESS)
    assert np.trapezoid(u, z) / rough_channel.DEPTH == pytest.approx(rough_channel.mean_speed(SPACING), rel=1e-6)
    next_to_it = float(rough_channel.steady_profile(0.5 * SPACING, SPACING))
    assert rough_channel.bed_stress(next_to_it, 0.5 * SPACING) == pytest.approx(rough_channel.STRESS)
    drag = Floor(roughness=rough_channel.ROUGHNESS).drag(0.5 * SPACING)
    assert rough_channel.DENSITY * drag * next_to_it**2 == pytest.approx(rough_channel.STRESS)


def test_the_grains_lie_below_the_lowest_particles():
    for coarse in (False, True):
        (problem,) = problems("rough_channel", slow=True, coarse=coarse)
        scene = problem.load("delta_sph")
        assert scene.preflight.tank.rough_bed == Floor(roughness=rough_channel.ROUGHNESS)
        assert not [sentence for sentence in scene.warnings() if "grains" in sentence]


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["delta_sph", "dfsph"])
def test_a_coarse_run_keeps_its_promises(scheme):
    (problem,) = problems("rough_channel", slow=True, coarse=True)
    rows, _ = problem.run("rough_channel", scheme, QUICK)
    assert [row["quantity"] for row in rows if not row["ok"]] == []
    assert sum(row["tolerance"] is not None for row in rows) == 3


@pytest.mark.slow
@pytest.mark.parametrize("bed", [{"roughness": 6e-3}, {"roughness": 1.5e-3}])
def test_over_another_bed_stress_by_the_law_and_speed_are_red(bed):
    """The negative control; what the weight demands of the bed, it bears whatever its law."""
    (problem,) = problems("rough_channel", slow=True, coarse=True)
    rows, _ = problem.run("rough_channel", "dfsph", QUICK | {f"basin.floor.{key}": value for key, value in bed.items()})
    assert [row["ok"] for row in rows[:3]] == [False, True, False]
