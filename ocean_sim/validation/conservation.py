"""Momentum and angular momentum of water without external forces: conserved to round-off, step by step.

A square of water without walls, gravity or viscosity whose particles start with random velocities; every step is
judged against the sum of m |a| dt, the impulse that its particles exchanged.
"""

import numpy as np

from ocean_sim.parts import water_schemes
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, absolute_error, free_space
from ocean_sim.validation.shared.state import particle_state, random_shifts, set_state

START_SPEED = 0.1  # [m/s]
STEP_COUNT = 50
SOURCE_TEXT = "Newton's third law; round-off of the arithmetic"
LIMITS = {"f32": 1e-6, "f64": 1e-13}  # momentum lost over momentum exchanged


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: the square of water in single and double precision; coarse: 2.5 times the particle spacing."""
    return [square_problem(precision, coarse) for precision in LIMITS]


def square_problem(precision: str, coarse: bool) -> Problem:
    """Set-up of the square of water in a precision, `f32` or `f64`; `coarse`: 2.5 times the particle spacing."""
    fill = [{"min": [-0.5, -0.5], "max": [0.5, 0.5]}]
    scene = {
        "duration": 1.0,
        "basin": free_space(4.0, 2.0),
        "fluid": {"spacing": 0.05 if coarse else 0.02, "reference_speed": START_SPEED, "fill": fill},
        "runtime": {"precision": precision},
    }
    tolerance = {scheme: LIMITS[precision] for scheme, config in water_schemes() if config.conserves_momentum}
    promises = (
        Promise(f"{precision}: momentum lost in a step, worst", "sum m |a| dt", SOURCE_TEXT, tolerance),
        Promise(f"{precision}: angular momentum lost in a step, worst", "sum m |x| |a| dt", SOURCE_TEXT, tolerance),
    )
    return Problem(scene, promises, measure, precision)


def measure(simulation: Simulation) -> Finding:
    """Run STEP_COUNT steps from random velocities; measure the largest losses of momentum and angular momentum in a
    step, each relative to the sum of the amounts exchanged among particles."""
    before = particle_state(simulation)
    set_state(simulation, before.position, random_shifts(simulation, before.position, START_SPEED))
    before = particle_state(simulation)
    linear, angular = [], []
    for _ in range(STEP_COUNT):
        simulation.step()
        after = particle_state(simulation)
        kick = np.linalg.norm(after.velocity - before.velocity, axis=1)
        arm = np.linalg.norm(after.position, axis=1)
        linear.append(np.linalg.norm(after.momentum - before.momentum) / (after.mass * kick.sum()))
        change = abs(after.angular_momentum - before.angular_momentum)
        angular.append(change / (after.mass * float((arm * kick).sum())))
        before = after
    steps = np.arange(1, STEP_COUNT + 1)
    curves = [Curve("momentum", steps, np.array(linear)), Curve("angular momentum", steps, np.array(angular))]
    numbers = [absolute_error(max(values)) for values in (linear, angular)]
    return Finding(numbers, curves, [], ("step", "lost, over what was exchanged"))
