"""Time steps: the shortest limit rules and says so; a fixed step stays."""

import pytest

from ocean_sim.fluid import Limits
from ocean_sim.time_step import courant, fixed


@pytest.mark.parametrize(
    ("limits", "ruling", "dt"),
    [
        ({"acoustic": 0.01, "viscous": 1.0, "force": 1.0}, "acoustic", 0.006),
        ({"acoustic": 0.01, "viscous": 0.02, "force": 1.0}, "viscous", 0.0025),
        ({"acoustic": 0.01, "viscous": 1.0, "force": 0.008}, "force", 0.002),
        ({}, "longest", 0.05),
    ],
)
def test_the_shortest_limit_rules(limits, ruling, dt):
    step = courant.Config().build()
    assert step.next(Limits(**limits)) == pytest.approx(dt)
    assert step.limited_by == ruling


def test_a_fixed_step_stays():
    step = fixed.Config(dt=0.003).build()
    assert step.next(Limits(acoustic=1e-9)) == 0.003
    assert step.limited_by == "fixed"
