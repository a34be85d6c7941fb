"""Heave, pitch and roll of a barge and of Wigley's hull in small regular waves, against linear potential flow.

The error of every kind is reported over the frequency; only `dynamic` has tolerances, with coefficients by rule or the
memory of a table from the same potential flow: heave 5 %, pitch 10 % up to 1.2 rad/s, where the barge is as long as
half a wave, and roll 10 % outside 0.9 to 1.1 rad/s, where viscosity dominates; waves longer than six hulls 3 %. Roll is
compared with 5 % of critical damping added.
"""

from itertools import product
from typing import Any

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, percent_error
from ocean_sim.validation.shared.ship import at_sea, floating_ship, record_in_waves
from ocean_sim.validation.shared.tables import table, table_path

HULL_LENGTH = {"barge20": 20.0, "wigley": 3.0}
WAVE_FREQUENCIES = {  # [rad/s] by hull and direction of the sea
    ("barge20", "head"): (0.4, 0.8, 1.0, 1.2, 1.5),
    ("barge20", "beam"): (0.4, 0.8, 1.2, 1.5),
    ("wigley", "head"): (1.5, 2.5, 3.5),
}
MOTION_TOLERANCES = {"heave": 5.0, "pitch": 10.0, "roll": 10.0}  # [%]
LONG_TOLERANCE, MAX_FREQUENCY = 3.0, 1.2  # [%] in waves longer than six hulls; [rad/s] of the barge
STEEPNESS = 0.002  # amplitude over the hull's length
ROLL_KEYS = {"added_mass": {"roll": 1167.8e3}}  # [kg m2] of the barge, by the same potential flow
SOURCE_TEXT = "Capytaine, linear potential flow"


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: barge and Wigley hull in head or beam seas, by scheme; coarse: two frequencies, fewer cells."""
    found = []
    for (hull, sea), omegas in WAVE_FREQUENCIES.items():
        for schemes, keys in ((("hydrostatic",), {}), (("dynamic",), ROLL_KEYS if sea == "beam" else {})):
            few = omegas[1:3] if coarse else omegas
            found.append(hull_problem(hull, sea, few, schemes, keys, 4 if coarse else 8))
        if hull == "barge20":
            memory: dict[str, Any] = {"radiation": str(table_path("barge20_radiation"))}
            memory |= ROLL_KEYS if sea == "beam" else {}
            found.append(hull_problem(hull, sea, few, ("dynamic",), memory, 4 if coarse else 8))
    return found


def hull_problem(
    hull: str, sea: str, omegas: tuple[float, ...], schemes: tuple[str, ...], keys: dict[str, Any], cells: int
) -> Problem:
    """Set-up of a hull, `cells` cubes over its draught, in a `head` or `beam` sea of frequencies `omegas` [rad/s], with
    further ship `keys`; `schemes`: kinds of ship to run."""
    name, turn = f"{hull}, {sea} sea", "pitch" if sea == "head" else "roll"
    name += ", memory" if "radiation" in keys else ""
    free = ["surge", "heave", "pitch"] if sea == "head" else ["sway", "heave", "roll"]
    kg = {"centre_of_mass": [0.0, 0.17, 0.0]} if hull == "wigley" else {}
    ship = {"hull": hull, "cells_per_draught": cells, "free": free} | kg | keys
    unit, promises = {"heave": "m/m", turn: "deg/m"}, []
    for omega, motion in product(omegas, unit):
        limits = {"dynamic": limit} if (limit := allowed_error(hull, omega, motion)) else {}
        promises.append(Promise(f"{name}, {omega:g} rad/s: {motion} [{unit[motion]}]", "%", SOURCE_TEXT, limits))

    def measure(simulation: Simulation) -> Finding:
        reference, numbers = table(f"{hull}_rao"), []
        for omega in omegas:
            heave, pitch, roll = wave_response(simulation, omega, HULL_LENGTH[hull], 180.0 if sea == "head" else 90.0)
            for motion, value in (("heave", heave), (turn, pitch if turn == "pitch" else roll)):
                exact = float(np.interp(omega, reference["omega_rad_s"], reference[f"{sea}_{motion}"]))
                numbers.append(percent_error(value, exact))
        at, errors = np.array(omegas), np.array([error for _, _, error in numbers]).reshape(-1, 2)
        measured = [Curve(f"{motion}, error", at, each, points=True) for motion, each in zip(unit, errors.T)]
        return Finding(numbers, measured, [Curve("none", at, 0.0 * at)], ("omega [rad/s]", "error [%]"))

    scene = at_sea(ship, HULL_LENGTH[hull], 0.01, heading_deg=180.0 if sea == "head" else 90.0)
    return Problem(scene, tuple(promises), measure, name, slot="ship", schemes=schemes)


def allowed_error(hull: str, omega: float, motion: str) -> float | None:
    """Tolerance [%] of scheme `dynamic` for a motion of a hull at frequency `omega` [rad/s], or None for none."""
    length = 2.0 * np.pi * GRAVITY / omega**2
    if length > 6.0 * HULL_LENGTH[hull]:
        return LONG_TOLERANCE
    highest = MAX_FREQUENCY * np.sqrt(HULL_LENGTH["barge20"] / HULL_LENGTH[hull])
    viscous = motion == "roll" and 0.9 <= omega <= 1.1
    return None if omega > highest + 1e-9 or viscous else MOTION_TOLERANCES[motion]


def wave_response(simulation: Simulation, omega: float, length: float, heading: float) -> tuple[float, float, float]:
    """Run in regular waves of frequency `omega` [rad/s] and heading [deg]; `length`: of the hull [m]. Return amplitudes
    of heave [m], pitch and roll [deg] per metre of wave amplitude."""
    rest, amplitude = floating_ship(simulation).first_body.position[1], STEEPNESS * length
    rows = record_in_waves(simulation, rest, 2.0 * amplitude, 2.0 * np.pi / omega, heading)
    t, _, heave, _, pitch, _, roll = rows
    wave = np.exp(1j * omega * t)
    heave, pitch, roll = (2.0 * abs(np.mean((y - y.mean()) * wave)) / amplitude for y in (heave, pitch, roll))
    return float(heave), float(np.degrees(pitch)), float(np.degrees(roll))
