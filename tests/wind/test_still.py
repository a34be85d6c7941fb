"""No wind."""

import numpy as np

from ocean_sim.runtime import allocated_bytes


def test_still_air_pushes_nothing_and_owns_nothing(build, force):
    before = allocated_bytes()
    wind = build("still")
    wind.advance(0.1)
    assert np.all(force(wind, np.ones((5, 3)), velocity=(3.0, 0.0, 0.0), area=(0.0, 1.0, 0.0)) == 0.0)
    assert not wind.needs_area and wind.on("fluid") is wind
    assert allocated_bytes() == before
