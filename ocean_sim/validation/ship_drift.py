"""A free yacht in regular waves: its drift does not depend on the phase at the start, and waves do not turn it.

The spread is that between the slowest and the fastest drift from eight phases of a head sea of 1 m and 5 s, over the
twelve periods after eighteen (weighed by Hann's window, as the ship meets the waves a little later each time). The
drift itself is only reported; without the key `drift` it is an artefact of first-order forces. In 100 s, waves of 5 and
6 s from abeam turn the yacht by less than half a quarter: only the flow by its drift, which acts off its middle, turns
it.
"""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ocean_sim import waves
from ocean_sim.conventions import GRAVITY
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, absolute_error, reported
from ocean_sim.validation.shared.ship import COMPARED_SHIPS, UPRIGHT, at_sea, floating_ship, follow_body, set_pose

HEIGHT, PERIOD, PERIOD_STEPS = 1.0, 5.0, 60  # [m], [s], steps in a period
PHASE_COUNT, PASSED_PERIODS, JUDGED_PERIODS = 8, 18, 12  # phases at the start, periods before and of the record
MAX_SPREAD = 0.02  # [m/s]
BEAM_PERIODS, BEAM_DURATION, MAX_YAW = (5.0, 6.0), 100.0, 45.0  # [s], [s], [deg]
DAMPING = {"heave": 0.15, "pitch": 0.15, "roll": 0.08, "surge": 400.0}


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: drift in a head sea from eight phases (coarse: four), and yaw in two beam seas."""
    ship = {"hull": "yacht", "cells_per_draught": 4, "damping": DAMPING}
    limits = dict.fromkeys(COMPARED_SHIPS, MAX_SPREAD)
    spread = Promise("drift in a head sea, over phases [m/s]", "m/s", "one drift", limits)
    mean = Promise("drift in a head sea [m/s]", "m/s", "reported")
    scene = at_sea(ship, 15.0, PERIOD / PERIOD_STEPS, height=HEIGHT, period=PERIOD, heading_deg=180.0)
    look = partial(measure_drift, phases=4 if coarse else PHASE_COUNT)
    found = [Problem(scene, (spread, mean), look, "phases", slot="ship", schemes=COMPARED_SHIPS)]
    for period in BEAM_PERIODS:
        name = f"largest yaw in a beam sea of {period:g} s [deg]"
        yaw = Promise(name, "deg", "half of a quarter", dict.fromkeys(COMPARED_SHIPS, MAX_YAW))
        scene = at_sea(ship, 15.0, 0.05, height=HEIGHT, period=period, heading_deg=90.0)
        found.append(Problem(scene, (yaw,), measure_yaw, f"beam {period:g}", slot="ship", schemes=COMPARED_SHIPS))
    return found


def measure_drift(simulation: Simulation, phases: int) -> Finding:
    """Run from each of `phases` initial wave phases; measure spread and mean of drift speed [m/s] along the ship."""
    fluid: Any = simulation.fluid  # of kind linear_waves
    rest = np.array([0.0, floating_ship(simulation).first_body.position[1], 0.0])
    train = waves.regular_wave(HEIGHT, PERIOD, waves.heading_vector(180.0, 3), simulation.basin.depth, GRAVITY)
    at, speeds = 2.0 * np.pi * np.arange(phases) / phases, []
    until, judged = (PASSED_PERIODS + JUDGED_PERIODS) * PERIOD - 1e-9, JUDGED_PERIODS * PERIOD_STEPS
    for phase in at:
        set_pose(simulation, position=rest, orientation=UPRIGHT)
        fluid.begin(replace(train, phase=np.array([phase])))
        simulation.time = 0.0
        v = [body.velocity[2] for _, body in follow_body(simulation, until)]
        speeds.append(float(np.average(v[-judged:], weights=np.hanning(judged))))
    found = np.array(speeds)
    numbers = [absolute_error(float(np.ptp(found))), reported(float(found.mean()))]
    curve = Curve("drift", np.degrees(at), found, points=True)
    return Finding(numbers, [curve], [], ("phase [deg]", "drift [m/s]"))


def measure_yaw(simulation: Simulation) -> Finding:
    """Run in waves from abeam; measure the largest yaw [deg]."""
    t, yaw = np.array([(t, body.angles[1]) for t, body in follow_body(simulation, BEAM_DURATION)]).T
    yaw = np.degrees(np.unwrap(yaw))
    return Finding([absolute_error(float(np.abs(yaw).max()))], [Curve("yaw", t, yaw)], [], ("t [s]", "yaw [deg]"))
