"""Heave, pitch and roll of a barge and of Wigley's hull in small regular waves, against linear potential flow.

Every kind's error is reported against the frequency; only `dynamic` promises, with coefficients by rule or the memory
of a table from the same potential flow: heave 5 %, pitch 10 % up to 1.2 rad/s, where the barge is as long as half a
wave, and roll 10 % outside 0.9 to 1.1 rad/s, where viscosity dominates; waves longer than six hulls 3 %. Roll is
compared with 5 % of critical damping added.
"""

from typing import Any

import numpy as np

from ocean_sim import waves
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative
from ocean_sim.validation.shared.ship import G, at_sea, floating, pose, track
from ocean_sim.validation.shared.tables import table, table_path

LENGTH = {"barge20": 20.0, "wigley": 3.0}
WAVES = {  # [rad/s]
    ("barge20", "head"): (0.4, 0.8, 1.0, 1.2, 1.5),
    ("barge20", "beam"): (0.4, 0.8, 1.2, 1.5),
    ("wigley", "head"): (1.5, 2.5, 3.5),
}
LIMITS = {"heave": 5.0, "pitch": 10.0, "roll": 10.0}  # [%]
LONG, SHORT = 3.0, 1.2  # [%], [rad/s]
PERIODS, JUDGED, STEPS = 20, 4, 60  # waves that pass while they grow and then, those that are looked at, steps in each
STEEPNESS = 0.002  # amplitude over the hull's length
GIVEN = {"added_mass": {"roll": 1167.8e3}}  # [kg m2] of the barge, by the same potential flow
SOURCE = "Capytaine, linear potential flow"


def problems(coarse: bool) -> list[Problem]:
    found = []
    for (hull, sea), omegas in WAVES.items():
        for schemes, keys in ((("hydrostatic",), {}), (("dynamic",), GIVEN if sea == "beam" else {})):
            few = omegas[1:3] if coarse else omegas
            found.append(problem(hull, sea, few, schemes, keys, 4 if coarse else 8))
        if hull == "barge20":
            memory: dict[str, Any] = {"radiation": str(table_path("barge20_radiation"))} | (
                GIVEN if sea == "beam" else {}
            )
            found.append(problem(hull, sea, few, ("dynamic",), memory, 4 if coarse else 8))
    return found


def problem(
    hull: str, sea: str, omegas: tuple[float, ...], schemes: tuple[str, ...], keys: dict[str, Any], cells: int
) -> Problem:
    """A hull in waves from ahead or from the side."""
    name, turn = f"{hull}, {sea} sea", "pitch" if sea == "head" else "roll"
    name += ", memory" if "radiation" in keys else ""
    free = ["surge", "heave", "pitch"] if sea == "head" else ["sway", "heave", "roll"]
    kg = {"centre_of_mass": [0.0, 0.17, 0.0]} if hull == "wigley" else {}
    ship = {"hull": hull, "cells_per_draught": cells, "free": free} | kg | keys
    promises = {
        (omega, motion): Promise(
            f"{name}, {omega:g} rad/s: {motion} [{'m/m' if motion == 'heave' else 'deg/m'}]",
            "%",
            SOURCE,
            {"dynamic": limit} if (limit := allowed(hull, omega, motion)) else {},
        )
        for omega in omegas
        for motion in ("heave", turn)
    }

    def measure(simulation: Simulation) -> Finding:
        reference, numbers = table(f"{hull}_rao"), {}
        for omega in omegas:
            heave, pitch, roll = answers(simulation, omega, LENGTH[hull], 180.0 if sea == "head" else 90.0)
            for motion, value in (("heave", heave), (turn, pitch if turn == "pitch" else roll)):
                exact = float(np.interp(omega, reference["omega_rad_s"], reference[f"{sea}_{motion}"]))
                numbers[promises[omega, motion].quantity] = relative(value, exact)
        curves = {
            motion: np.array([numbers[promises[omega, motion].quantity] for omega in omegas])
            for motion in ("heave", turn)
        }
        at = np.array(omegas)
        return Finding(
            numbers,
            [Curve(f"{motion}, error", at, rows[:, 2], points=True) for motion, rows in curves.items()],
            [Curve("none", at, 0.0 * at)],
            ("omega [rad/s]", "error [%]"),
        )

    return Problem(
        at_sea(ship, LENGTH[hull], 0.01, heading_deg=180.0 if sea == "head" else 90.0),
        tuple(promises.values()),
        measure,
        name,
        slot="ship",
        schemes=schemes,
    )


def allowed(hull: str, omega: float, motion: str) -> float | None:
    """Largest error that `dynamic` promises [%]."""
    length = 2.0 * np.pi * G / omega**2
    if length > 6.0 * LENGTH[hull]:
        return LONG
    short = SHORT * np.sqrt(LENGTH["barge20"] / LENGTH[hull])
    return LIMITS[motion] if omega <= short + 1e-9 and not (motion == "roll" and 0.9 <= omega <= 1.1) else None


def answers(simulation: Simulation, omega: float, length: float, heading: float) -> tuple[float, float, float]:
    """Heave [m/m], pitch and roll [deg/m] in a regular wave, by the part of the motion at its frequency."""
    fluid: Any = simulation.fluid  # of kind linear_waves
    clock: Any = simulation.time_step  # of kind fixed
    ship, period = floating(simulation), 2.0 * np.pi / omega
    rest = np.array([0.0, ship.first_body.position[1], 0.0])
    pose(simulation, position=rest, orientation=np.array([1.0, 0.0, 0.0, 0.0]))
    depth = simulation.basin.depth
    amplitude = STEEPNESS * length
    fluid.begin(waves.regular(2.0 * amplitude, period, waves.direction(heading, 3), depth, G))
    simulation.time, simulation.next_dt = 0.0, period / STEPS
    clock.config = clock.config.model_copy(update={"dt": period / STEPS})
    rows = [(t, b.position[1], *b.angles) for t, b in track(simulation, PERIODS * period - 1e-9)]
    t, heave, pitch, _, roll = np.array(rows[-JUDGED * STEPS :]).T
    wave = np.exp(1j * omega * t)
    heave, pitch, roll = (2.0 * abs(np.mean((y - y.mean()) * wave)) / amplitude for y in (heave, pitch, roll))
    return float(heave), float(np.degrees(pitch)), float(np.degrees(roll))
