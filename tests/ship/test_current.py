"""A ship, waves and a current: only her velocity through the water counts."""

import numpy as np
import pytest

from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation

THROUGH = 2.0  # velocity through the water [m/s]


def ride(heading: float, current: tuple[float, float], height: float = 1.0, **ship) -> np.ndarray:
    """(7,) height and velocity [m, m/s] less that of the current, and the rates of turn [rad/s], after 6 s."""
    scene = {
        "duration": 6.0,
        "basin": {"length": 200.0, "width": 200.0, "depth": 20.0, "walls": "none"},
        "fluid": {
            "kind": "spectral_sea",
            "ramp": 0.0,
            "current": list(current),
            "height": height,
            "period": 7.0,
            "heading_deg": heading,
        },
        "ship": ship or {"kind": "barge20", "velocity": [0.0, 0.0, THROUGH]},
        "time_step": {"kind": "fixed", "dt": 0.05},
    }
    off = ("accuracy", "timings", "frames", "render", "report", "motion")
    with Simulation(load(scene, dict.fromkeys(off))) as simulation:
        simulation.run(until=6.0)
        body = simulation.ship.body
        x, _, z = body.velocity
        return np.array([body.position[1], x - current[0], body.velocity[1], z - current[1], *body.rates])


@pytest.mark.parametrize("heading", [180.0, 60.0])
def test_what_counts_is_the_velocity_through_the_water(heading):
    """In water that flows as in still water: the lattice that she reads is carried by the current, and her added mass
    is accelerated by what she does relative to the water, in axes that turn with her."""
    still = ride(heading, (0.0, 0.0))
    assert np.abs(still).max() > 0.1
    np.testing.assert_allclose(ride(heading, (0.0, -THROUGH)), still, atol=1e-3)
    np.testing.assert_allclose(ride(heading, (1.0, 0.7)), still, atol=1e-3)


def test_a_ship_in_calm_water_goes_with_the_current_and_does_not_turn():
    """A hull whose bow and stern differ, too: water that flows alike everywhere does not turn."""
    adrift = ride(0.0, (0.7, -0.4), height=0.0, kind="yacht")
    np.testing.assert_allclose(adrift[1:], 0.0, atol=1e-6)
