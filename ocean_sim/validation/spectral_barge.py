"""A barge in regular waves of a `spectral_sea`, against the same barge in the same closed-form waves.

What she makes is kept on a tile of her own and never acts on her: her law of motion has it already, as added mass and
damping. So her answers are those of `linear_waves`.
"""

from dataclasses import replace

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Finding, Problem, Promise, relative
from ocean_sim.validation.shared.sea import SCHEMES, sea_of
from ocean_sim.validation.shared.ship import at_sea
from ocean_sim.validation.ship_rao import LENGTH, answers

OMEGAS = (0.8, 1.2)  # [rad/s]
HEADINGS = {"head": 180.0, "beam": 90.0}
OF = "linear_waves, the same waves"


def problems(coarse: bool) -> list[Problem]:
    return [problem(sea, 4 if coarse else 8) for sea in HEADINGS]


def problem(sea: str, cells: int) -> Problem:
    turn, heading = "pitch" if sea == "head" else "roll", HEADINGS[sea]
    free = ["surge", "heave", "pitch"] if sea == "head" else ["sway", "heave", "roll"]
    ship = {"kind": "dynamic", "hull": "barge20", "cells_per_draught": cells, "free": free}
    scene = at_sea(ship, LENGTH["barge20"], 0.01, heading_deg=heading)
    scene["fluid"] = scene["fluid"] | {"tile": 200.0}
    promises = {
        (omega, motion): Promise(
            f"{sea} sea, {omega:g} rad/s: {motion} [{'m/m' if motion == 'heave' else 'deg/m'}]",
            "%",
            OF,
            {"spectral_sea": 1.0},
        )
        for omega in OMEGAS
        for motion in ("heave", turn)
    }
    made = Promise(f"{sea} sea: how far the barge moves the water's surface [m]", "m", "above zero")

    def measure(simulation: Simulation) -> Finding:
        found, ours = {}, measured(simulation, heading)
        highest = float(np.abs(sea_of(simulation).made[0].layer.eta).max())
        plain = replace(bare, scene=bare.scene | {"fluid": without(bare.scene["fluid"])})
        with Simulation(plain.load("linear_waves")) as other:
            theirs = measured(other, heading)
        for (omega, motion), promise in promises.items():
            k = 0 if motion == "heave" else 1 if motion == "pitch" else 2
            found[promise.quantity] = relative(ours[omega][k], theirs[omega][k])
        return Finding(found | {made.quantity: (highest, None, None)})

    bare = Problem(scene, (*promises.values(), made), measure, f"{sea} sea", schemes=SCHEMES, only=True)
    return bare


def measured(simulation: Simulation, heading: float) -> dict[float, tuple[float, float, float]]:
    """Heave [m/m], pitch and roll [deg/m] at each frequency."""
    return {omega: answers(simulation, omega, LENGTH["barge20"], heading) for omega in OMEGAS}


def without(fluid: dict) -> dict:
    """The keys that water in closed form has, too."""
    return {key: value for key, value in fluid.items() if key != "tile"}
