"""Mean drift of moored hulls in regular waves: a barge by Capytaine's table, and a section that was measured.

The barge, free in surge or sway, heave and pitch or roll, on soft lines, settles where their pull is the mean force of
the run: the table's, and what is left of the second order in the first-order forces. The tolerance is 10 % of the
table's; at 1.2 rad/s, where that is below 5 % of what a wall would feel, the error is only reported. The section of
Sundsdal et al. (2025) settles on its springs by the force of linear potential flow in its flume; wanted are 25 % of the
measured mean offset where the record is longer than a natural period of the springs (7.5 s), a choice made when first
figures were known, with a friction of 0.2 to 0.5 N there against forces of 0.2 to 0.4 N.
"""

from math import pi
from typing import Any

import numpy as np

from ocean_sim.files import csv_file
from ocean_sim.simulation import Simulation
from ocean_sim.validation import section_in_waves as section
from ocean_sim.validation.shared import ship as ships
from ocean_sim.validation.shared.case import Finding, Problem, Promise, percent_error
from ocean_sim.validation.shared.tables import table, table_path

BARGE_FREQUENCIES, JUDGED_FREQUENCY = (1.2, 1.5, 1.8, 2.1), 1.5  # [rad/s], and from which on errors count
WAVE_AMPLITUDE, LINE_STIFFNESS, LINE_DAMPING = 0.1, 4000.0, 3.0e4  # [m], [N/m], [N s/m]
BARGE_TOLERANCE, SECTION_TOLERANCE, NATURAL_PERIOD = 10.0, 25.0, 7.5  # [%], [%], [s]
BARGE_WAVES, SECTION_WAVES = 60, 120  # waves of a run: the lines swing no more
SEAS = {"head": (180.0, 2, ["surge", "heave", "pitch"]), "beam": (90.0, 0, ["sway", "heave", "roll"])}


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: the barge in head and beam waves, and the section; none if coarse."""
    return [] if coarse else [*map(barge_problem, SEAS), section_problem()]


def barge_problem(sea: str) -> Problem:
    """Set-up of the barge in a `head` or `beam` sea."""
    heading, axis, free = SEAS[sea]
    spring = {"stiffness": LINE_STIFFNESS / 2.0, "damping": LINE_DAMPING, "slack_length": 80.0, "from": [0.0, 2.5, 0.0]}
    ends = (np.roll([0.5, side, 0.0], axis - 1).tolist() for side in (100.0, -100.0))
    ship: dict[str, Any] = {"hull": "barge20", "cells_per_draught": 8, "free": free}
    ship |= {"moorings": [spring | {"to": end} for end in ends], "drift": {"table": str(table_path("barge20_drift"))}}
    names = {omega: f"barge, {sea} sea, {omega:g} rad/s: mean force [N]" for omega in BARGE_FREQUENCIES}
    limits = {omega: {"dynamic": BARGE_TOLERANCE} if omega >= JUDGED_FREQUENCY else {} for omega in BARGE_FREQUENCIES}
    promises = tuple(Promise(names[omega], "%", "Capytaine, far field", limits[omega]) for omega in BARGE_FREQUENCIES)

    def measure(simulation: Simulation) -> Finding:
        data = table("barge20_drift")
        own, force = data["heading_deg"] == heading, data["surge_N_m2"] + data["sway_N_m2"]  # one of them is 0
        exact = WAVE_AMPLITUDE**2 * np.interp(BARGE_FREQUENCIES, data["omega_rad_s"][own], force[own])
        offsets = [
            settled_offset(simulation, WAVE_AMPLITUDE, 2.0 * pi / omega, heading, axis, BARGE_WAVES)
            for omega in BARGE_FREQUENCIES
        ]
        return Finding([percent_error(LINE_STIFFNESS * x, float(f)) for x, f in zip(offsets, exact, strict=True)])

    scene = ships.at_sea(ship, 20.0, 0.01, heading_deg=heading)
    return Problem(scene, promises, measure, f"barge, {sea} sea", slot="ship", schemes=("dynamic",))


def section_problem() -> Problem:
    """Set-up of a ship's section, free in sway and heave, in the waves in which its mean offset was measured."""
    data = csv_file.read_columns(table_path("sundsdal2025_section"))
    own = data["scenario"] == "sway+heave"
    columns = np.stack([data["sway_mean_mm"], data["incident_mm"]])
    seen = {float(t): columns[:, own & (data["T_s"] == t)].mean(axis=1).tolist() for t in np.unique(data["T_s"][own])}
    long = data["T_s"][own & (data["cycles"] * data["T_s"] > NATURAL_PERIOD)]
    limits = {period: {"dynamic": SECTION_TOLERANCE} if period in long else {} for period in seen}
    names = {period: f"section, T {period:g} s: mean sway [mm]" for period in seen}
    promises = tuple(Promise(names[period], "%", section.SOURCE_TEXT, limits[period]) for period in seen)

    def measure(simulation: Simulation) -> Finding:
        found = [settled_offset(simulation, 1e-3 * a, t, 90.0, 0, SECTION_WAVES) for t, (_, a) in seen.items()]
        return Finding([percent_error(1e3 * x, mean) for x, (mean, _) in zip(found, seen.values(), strict=True)])

    ship = section.section_keys(12) | {"free": ["sway", "heave"], "moorings": section.sway_springs()}
    ship |= {"radiation": str(table_path("section_radiation")), "damping": {"cross_flow": 0.0}}
    scene = ships.at_sea(ship | {"drift": {"table": str(table_path("section_drift"))}}, 1.0, 0.01, heading_deg=90.0)
    scene["basin"]["depth"] = section.DEPTH
    return Problem(scene, promises, measure, "section", slot="ship", schemes=("dynamic",))


def settled_offset(
    simulation: Simulation, amplitude: float, period: float, heading: float, axis: int, count: int
) -> float:
    """Mean position [m] of the ship along x (`axis` 0) or z (2) at the end of `count` regular waves of amplitude [m],
    period [s] and heading [deg]."""
    rest = float(ships.floating_ship(simulation).first_body.position[1])
    rows = ships.record_in_waves(simulation, rest, 2.0 * amplitude, period, heading, count)
    return float(rows[1 + axis].mean())
