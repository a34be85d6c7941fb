"""A barge in regular waves of a `spectral_sea`, against the same barge in `linear_waves`: equal to the last digit,
unless the waves that she makes act on her a second time. Her law of motion has them already, as added mass and damping.
"""

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Finding, Problem, Promise, other_simulation, percent_error, reported
from ocean_sim.validation.shared.sea import SPECTRAL_SCHEMES, sea_of
from ocean_sim.validation.shared.ship import at_sea
from ocean_sim.validation.ship_rao import HULL_LENGTH, wave_response

WAVE_FREQUENCIES = (0.8, 1.2)  # [rad/s]
SEA_HEADINGS = {"head": 180.0, "beam": 90.0}
SOURCE_TEXT = "linear_waves, the same waves"


def problems(coarse: bool) -> list[Problem]:
    return [barge_problem(sea, 4 if coarse else 8) for sea in SEA_HEADINGS]


def barge_problem(sea: str, cells: int) -> Problem:
    """Set-up of the barge, sampled by `cells` cubes over its draught, in a `head` or `beam` sea."""
    turn, heading = "pitch" if sea == "head" else "roll", SEA_HEADINGS[sea]
    free = ["surge", "heave", "pitch"] if sea == "head" else ["sway", "heave", "roll"]
    ship = {"kind": "dynamic", "hull": "barge20", "cells_per_draught": cells, "free": free}
    closed_form = at_sea(ship, HULL_LENGTH["barge20"], 0.01, heading_deg=heading)
    scene = closed_form | {"fluid": closed_form["fluid"] | {"tile": 200.0}}
    promises = tuple(
        Promise(f"{sea} sea, {omega:g} rad/s: {motion} [{unit}]", "%", SOURCE_TEXT, {"spectral_sea": 1.0})
        for omega in WAVE_FREQUENCIES
        for motion, unit in (("heave", "m/m"), (turn, "deg/m"))
    )
    made = Promise(f"{sea} sea: how far the barge moves the water's surface [m]", "m", "above zero")

    def measure(simulation: Simulation) -> Finding:
        ours = frequency_responses(simulation, heading)
        highest = float(np.abs(sea_of(simulation).made[0].layer.eta).max())
        with other_simulation(simulation, closed_form) as other:
            theirs = frequency_responses(other, heading)
        motions = (0, 1 if turn == "pitch" else 2)
        numbers = [percent_error(ours[omega][k], theirs[omega][k]) for omega in WAVE_FREQUENCIES for k in motions]
        return Finding([*numbers, reported(highest)])

    return Problem(scene, (*promises, made), measure, f"{sea} sea", schemes=SPECTRAL_SCHEMES)


def frequency_responses(simulation: Simulation, heading: float) -> dict[float, tuple[float, float, float]]:
    """Heave [m/m], pitch and roll [deg/m] of the barge in waves of a heading [deg], by frequency [rad/s]."""
    return {omega: wave_response(simulation, omega, HULL_LENGTH["barge20"], heading) for omega in WAVE_FREQUENCIES}
