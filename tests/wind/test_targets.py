"""Targets: the water, the ship, both or none of them; what a wind does not act on feels still air."""

import numpy as np
import pytest

KINDS = {
    "stress": {"u10": 20.0},
    "gusts": {"volumes": [{"include": [{"kind": "sphere", "radius": 9.0}], "acceleration": [1.0, 0.0, 0.0]}]},
    "vortex": {"acceleration": 1.0},
}
POINT, UPWARDS = [[5.0, -0.1, 1.0]], (0.0, 1.0, 0.0)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("targets", [[], ["fluid"], ["ship"], ["fluid", "ship"]])
def test_only_targets_feel_the_wind(build, force, kind, targets):
    wind = build(kind, targets=targets, **KINDS[kind])
    wind.advance(0.01)
    for target in ("fluid", "ship"):
        felt = force(wind.on(target), POINT, area=UPWARDS)
        assert bool(np.abs(felt).max() > 0.0) == (target in targets)
        assert wind.on(target).needs_area == (kind == "stress" and target in targets)
