"""A body that spins in the air, its moments of inertia 1, 2 and 3: a minute against Jacobi's elliptic functions.

Spin (1, 0, 1) rad/s: the reference pose is a solution by DOP853 at a tolerance of 1e-13, which agrees with the
elliptic functions to 8e-14. Energy and angular momentum stay.
"""

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise
from ocean_sim.validation.shared.ship import OF_WATER, at_sea, pose, ship_of, track

SECONDS, DT, HIGH = 60.0, 1.0 / 60.0, 1.0e5  # [s], [s], [m]
POSE = np.array([-0.84949542, 0.21516101, -0.09205273, -0.47285259])


def problems(coarse: bool) -> list[Problem]:
    box = {
        "shape": {"kind": "box", "length": 1.0, "breadth": 1.0, "height": 1.0},
        "mass": 500.0,
        "inertia": [1.0, 2.0, 3.0],
    }
    ship = {"hull": box, "cells_per_draught": 2, "rates": [1.0, 0.0, 1.0]}
    promises = (
        Promise("attitude after 60 s [deg]", "deg", "elliptic functions", dict.fromkeys(OF_WATER, 0.5)),
        Promise("energy of the spin", "1", "kept", dict.fromkeys(OF_WATER, 1e-4)),
        Promise("angular momentum", "1", "kept", dict.fromkeys(OF_WATER, 1e-9)),
    )
    scene = at_sea(ship, 5.0, DT, SECONDS)
    return [Problem(scene, promises, lambda s: measure(s, promises), slot="ship", schemes=("hydrostatic",))]


def measure(simulation: Simulation, promises: tuple[Promise, ...]) -> Finding:
    """Pose, energy and momentum at the end."""
    ship = ship_of(simulation)
    pose(simulation, position=np.array([0.0, HIGH, 0.0]), angular_momentum=ship.body.angular_momentum)
    energy = lambda b: 0.5 * float(b.angular_velocity @ b.angular_momentum)
    first, momentum = energy(ship.body), ship.body.angular_momentum
    rows = [(t, *b.rates) for t, b in track(simulation, SECONDS - 0.5 * DT)]
    body = ship.body
    apart = 2.0 * np.degrees(np.arccos(min(1.0, abs(float(body.orientation @ POSE)))))
    drift = energy(body) / first - 1.0
    lost = float(np.linalg.norm(body.angular_momentum - momentum) / np.linalg.norm(momentum))
    numbers = {p.quantity: (v, 0.0, v) for p, v in zip(promises, (apart, drift, lost), strict=True)}
    t, *rates = np.array(rows).T
    return Finding(numbers, [Curve(f"rate {k + 1}", t, r) for k, r in enumerate(rates)], [], ("t [s]", "rate [rad/s]"))
