"""A free yacht in regular waves: its drift does not depend on the phase at the start, and waves do not turn it.

From eight phases of a head sea of 1 m and 5 s, over the twelve periods after eighteen (weighed by Hann's window, as the
ship meets the waves a little later each time): how far the slowest and the fastest drift are apart. The drift itself is
only reported, as second-order forces are not modelled. From abeam, in 100 s, waves of 5 and 6 s turn the yacht by less
than half a quarter: nothing but its drift, which meets it off its middle, turns it.
"""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ocean_sim import waves
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise
from ocean_sim.validation.shared.ship import OF_WATER, G, at_sea, floating, pose, track

HEIGHT, PERIOD, STEPS = 1.0, 5.0, 60  # [m], [s], steps in a period
PHASES, SETTLED, JUDGED = 8, 18, 12  # phases that it begins in, periods that pass, periods that are looked at
LIMIT = 0.02  # [m/s]
BEAM, LASTS, TURNED = (5.0, 6.0), 100.0, 45.0  # [s], [s], [deg]
DAMPING = {"heave": 0.15, "pitch": 0.15, "roll": 0.08, "surge": 400.0}


def problems(coarse: bool) -> list[Problem]:
    ship = {"hull": "yacht", "cells_per_draught": 4, "damping": DAMPING}
    spread = Promise("drift in a head sea, over phases [m/s]", "m/s", "one drift", dict.fromkeys(OF_WATER, LIMIT))
    mean = Promise("drift in a head sea [m/s]", "m/s", "reported")
    scene = at_sea(ship, 15.0, PERIOD / STEPS, height=HEIGHT, period=PERIOD, heading_deg=180.0)
    look = partial(drifting, spread=spread, mean=mean, phases=4 if coarse else PHASES)
    found = [Problem(scene, (spread, mean), look, "phases", slot="ship", schemes=OF_WATER)]
    for period in BEAM:
        name = f"largest yaw in a beam sea of {period:g} s [deg]"
        yaw = Promise(name, "deg", "half of a quarter", dict.fromkeys(OF_WATER, TURNED))
        scene = at_sea(ship, 15.0, 0.05, height=HEIGHT, period=period, heading_deg=90.0)
        turn = partial(turning, promise=yaw)
        found.append(Problem(scene, (yaw,), turn, f"beam {period:g}", slot="ship", schemes=OF_WATER))
    return found


def drifting(simulation: Simulation, spread: Promise, mean: Promise, phases: int) -> Finding:
    """Mean speed along the ship from each phase."""
    fluid: Any = simulation.fluid  # of kind linear_waves
    rest = np.array([0.0, floating(simulation).first_body.position[1], 0.0])
    train = waves.regular(HEIGHT, PERIOD, waves.direction(180.0, 3), simulation.basin.depth, G)
    at, speeds = 2.0 * np.pi * np.arange(phases) / phases, []
    for phase in at:
        pose(simulation, position=rest, orientation=np.array([1.0, 0.0, 0.0, 0.0]))
        fluid.begin(replace(train, phase=np.array([phase])))
        simulation.time = 0.0
        v = [body.velocity[2] for _, body in track(simulation, (SETTLED + JUDGED) * PERIOD - 1e-9)]
        speeds.append(float(np.average(v[-JUDGED * STEPS :], weights=np.hanning(JUDGED * STEPS))))
    found = np.array(speeds)
    apart = float(np.ptp(found))
    numbers = {spread.quantity: (apart, 0.0, apart), mean.quantity: (float(found.mean()), None, None)}
    curve = Curve("drift", np.degrees(at), found, points=True)
    return Finding(numbers, [curve], [], ("phase [deg]", "drift [m/s]"))


def turning(simulation: Simulation, promise: Promise) -> Finding:
    """How far waves from abeam turn it."""
    t, yaw = np.array([(t, body.angles[1]) for t, body in track(simulation, LASTS)]).T
    yaw = np.degrees(np.unwrap(yaw))
    most = float(np.abs(yaw).max())
    return Finding({promise.quantity: (most, 0.0, most)}, [Curve("yaw", t, yaw)], [], ("t [s]", "yaw [deg]"))
