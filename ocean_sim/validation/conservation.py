"""Momentum and angular momentum of water without external forces: conserved to round-off, step by step.

A square of water without walls, gravity or viscosity whose particles start with random velocities; every step is
judged against the sum of m |a| dt, the impulse that its particles exchanged.
"""

import numpy as np

from ocean_sim.parts import water_schemes
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise
from ocean_sim.validation.shared.state import set_state, shaken, state

SPEED = 0.1  # [m/s]
STEPS = 50
SOURCE = "Newton's third law; round-off of the arithmetic"
LIMITS = {"f32": 1e-6, "f64": 1e-13}


def problems(coarse: bool) -> list[Problem]:
    return [problem(precision, coarse) for precision in LIMITS]


def problem(precision: str, coarse: bool) -> Problem:
    """The same in single or double precision."""
    scene = {
        "duration": 1.0,
        "basin": {
            "length": 4.0,
            "depth": 2.0,
            "gravity": [0.0, 0.0, 0.0],
            "walls": "none",
            "floor": "none",
        },
        "fluid": {
            "spacing": 0.05 if coarse else 0.02,
            "reference_speed": SPEED,
            "fill": [{"min": [-0.5, -0.5], "max": [0.5, 0.5]}],
        },
        "runtime": {"precision": precision},
    }
    tolerance = {scheme: LIMITS[precision] for scheme, config in water_schemes() if config.conserves_momentum}
    promises = (
        Promise(f"{precision}: momentum lost in a step, worst", "sum m |a| dt", SOURCE, tolerance),
        Promise(f"{precision}: angular momentum lost in a step, worst", "sum m |x| |a| dt", SOURCE, tolerance),
    )
    return Problem(scene, promises, lambda simulation: measure(simulation, promises), precision)


def measure(simulation: Simulation, promises: tuple[Promise, ...]) -> Finding:
    """The worst of a number of steps."""
    before = state(simulation)
    set_state(simulation, before.position, shaken(simulation, before.position, SPEED))
    before = state(simulation)
    linear, angular = [], []
    for _ in range(STEPS):
        simulation.step()
        after = state(simulation)
        kick = np.linalg.norm(after.velocity - before.velocity, axis=1)
        arm = np.linalg.norm(after.position, axis=1)
        linear.append(np.linalg.norm(after.momentum - before.momentum) / (after.mass * kick.sum()))
        turned = abs(after.angular_momentum - before.angular_momentum)
        angular.append(turned / (after.mass * float((arm * kick).sum())))
        before = after
    numbers = {
        promise.quantity: (max(values), 0.0, max(values))
        for promise, values in zip(promises, (linear, angular), strict=True)
    }
    steps = np.arange(1, STEPS + 1)
    curves = [Curve("momentum", steps, np.array(linear)), Curve("angular momentum", steps, np.array(angular))]
    return Finding(numbers, curves, [], ("step", "lost, over what was exchanged"))
