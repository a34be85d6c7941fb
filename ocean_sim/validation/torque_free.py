"""A body that spins in the air, its moments of inertia 1, 2 and 3: a minute against Jacobi's elliptic functions.

Spin (1, 0, 1) rad/s: the reference pose is a solution by DOP853 at a tolerance of 1e-13, which agrees with the
elliptic functions to 8e-14. Energy and angular momentum stay.
"""

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, absolute_error
from ocean_sim.validation.shared.ship import COMPARED_SHIPS, at_sea, follow_body, set_pose, ship_of

SPIN_DURATION, TIME_STEP, AIR_HEIGHT = 60.0, 1.0 / 60.0, 1.0e5  # [s], [s], [m]
REFERENCE_ORIENTATION = np.array([-0.84949542, 0.21516101, -0.09205273, -0.47285259])


def problems(coarse: bool) -> list[Problem]:
    shape = {"kind": "box", "length": 1.0, "breadth": 1.0, "height": 1.0}
    hull = {"shape": shape, "mass": 500.0, "inertia": [1.0, 2.0, 3.0]}
    ship = {"hull": hull, "cells_per_draught": 2, "rates": [1.0, 0.0, 1.0]}
    promises = (
        Promise("attitude after 60 s [deg]", "deg", "elliptic functions", dict.fromkeys(COMPARED_SHIPS, 0.5)),
        Promise("energy of the spin", "1", "kept", dict.fromkeys(COMPARED_SHIPS, 1e-4)),
        Promise("angular momentum", "1", "kept", dict.fromkeys(COMPARED_SHIPS, 1e-9)),
    )
    scene = at_sea(ship, 5.0, TIME_STEP, SPIN_DURATION)
    return [Problem(scene, promises, measure, slot="ship", schemes=("hydrostatic",))]


def measure(simulation: Simulation) -> Finding:
    """Run for a minute; measure errors of orientation [deg], energy and angular momentum (relative) at the end."""
    ship = ship_of(simulation)
    set_pose(simulation, position=np.array([0.0, AIR_HEIGHT, 0.0]), angular_momentum=ship.body.angular_momentum)
    energy = lambda b: 0.5 * float(b.angular_velocity @ b.angular_momentum)
    first, momentum = energy(ship.body), ship.body.angular_momentum
    rows = [(t, *b.rates) for t, b in follow_body(simulation, SPIN_DURATION - 0.5 * TIME_STEP)]
    body = ship.body
    apart = 2.0 * np.degrees(np.arccos(min(1.0, abs(float(body.orientation @ REFERENCE_ORIENTATION)))))
    lost = float(np.linalg.norm(body.angular_momentum - momentum) / np.linalg.norm(momentum))
    numbers = [absolute_error(value) for value in (apart, energy(body) / first - 1.0, lost)]
    t, *rates = np.array(rows).T
    return Finding(numbers, [Curve(f"rate {k + 1}", t, r) for k, r in enumerate(rates)], [], ("t [s]", "rate [rad/s]"))
