"""A ship's section that floats across a flume in beam waves, free in heave and roll, as Sundsdal et al. measured it.

Breadth 0.400 m, draught 0.200 m, bilges of 0.0512 m, 46.8 kg, waves of 24 mm (NTNU 2025); measured once free in sway
and heave, held by springs, and once in heave and roll. The closed form has added mass, damping and the force of
scattered waves from a table of linear potential flow in two dimensions, with the slots of 7 mm that the section leaves
to the walls of the flume; nothing is fitted. The tolerance, set before any run, is 5 % of heave off its resonance; in
resonance, and of roll and sway, errors are only reported. In resonance the damping exceeds mass and stiffness together,
omega B > |C - omega^2 (M + A)|: half of the power or more. Particles that press on the section in a patch of open sea
three wavelengths long have tolerances of 10 % of heave and 20 % of roll.

The lattice of points at which a ship samples the water accounts for 2 % of the closed form at 0.897 s.
"""

from functools import partial
from math import pi
from typing import Any

import numpy as np

from ocean_sim import waves
from ocean_sim.conventions import GRAVITY, WATER_DENSITY
from ocean_sim.files import csv_file
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared import ship as ships
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, percent_error
from ocean_sim.validation.shared.tables import table_path

LENGTH, BREADTH, HEIGHT, DRAUGHT, BILGE = 0.586, 0.400, 0.256, 0.200, 0.0512  # [m]
MASS, KG, ROLL_RADIUS = 46.8, 0.107, 0.36 * BREADTH  # [kg], [m], [m]
DEPTH, AMPLITUDE = 1.00, 0.012  # [m]
SPRING_STIFFNESS, SPRING_DAMPING, ANCHOR_DISTANCE = 60.0, 8.70, 100.0  # in sway [N/m], [N s/m]; [m]
MOTION_SCALES = {"heave": "a", "roll": "k a"}
FREE_MOTIONS = {"heave+roll": ("heave", "roll"), "sway+heave": ("sway", "heave")}  # of each scenario
MEASURED_COLUMNS = {"sway": "Sway", "heave": "heave_acc", "roll": "roll_acc"}  # accelerometers if there are any
HEAVE_TOLERANCE = 5.0  # [%] off resonance
PARTICLE_PERIODS = (1.158, 1.21, 0.897)  # [s]
PARTICLE_TOLERANCES = {"heave": 10.0, "roll": 20.0}  # [%]
DRAUGHT_SPACINGS, PATCH_LENGTH, RUN_PERIODS = 10, 3.0, 14.0  # [wavelengths] of the patch
SOURCE_TEXT = "Sundsdal et al. (2025), measured"


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: the ship's section in closed-form waves, on particles; coarse: closed form only, two periods."""
    if coarse:
        return [closed_form_problem("heave+roll", True)]
    closed_form = [closed_form_problem(scenario) for scenario in FREE_MOTIONS]
    return closed_form + [particle_problem(period) for period in PARTICLE_PERIODS]


def closed_form_problem(scenario: str, coarse: bool = False) -> Problem:
    """Set-up of a scenario (key of FREE_MOTIONS) in closed-form waves: a run for each wave period (`coarse`: two)."""
    seen, freed = measured_amplitudes(scenario), FREE_MOTIONS[scenario]
    periods = sorted(seen, reverse=True)[1:3] if coarse else sorted(seen, reverse=True)
    pairs = [(period, motion) for period in periods for motion in freed if motion in seen[period]]
    promises = []
    for period, motion in pairs:
        limits = {"dynamic": HEAVE_TOLERANCE} if motion == "heave" and not is_resonant(period) else {}
        quantity = f"{scenario}, T {period:g} s: {motion} [{'k a' if motion == 'roll' else 'a'}]"
        promises.append(Promise(quantity, "%", SOURCE_TEXT, limits))

    def measure(simulation: Simulation) -> Finding:
        found = {period: wave_response(simulation, period) for period in periods}
        numbers = [percent_error(found[period][motion], seen[period][motion]) for period, motion in pairs]
        curves, expected = [], []
        for motion in freed:
            curves.append(Curve(motion, np.array(periods), np.array([found[t][motion] for t in periods]), points=True))
            at = [t for t in sorted(seen) if motion in seen[t]]
            expected.append(Curve(f"{motion}, measured", np.array(at), np.array([seen[t][motion] for t in at])))
        label = " / a, ".join(freed) + (" / k a" if "roll" in freed else " / a")
        return Finding(numbers, curves, expected, ("T [s]", label))

    extra = {"radiation": str(table_path("section_radiation")), "damping": {"cross_flow": 0.0}}
    ship = section_keys(8 if coarse else 12) | extra | {"free": list(freed)}
    if "sway" in freed:
        ship["moorings"] = sway_springs()
    scene = ships.at_sea(ship, 1.0, 0.01, heading_deg=90.0)
    scene["basin"]["depth"] = DEPTH
    return Problem(scene, tuple(promises), measure, f"closed form, {scenario}", slot="ship", schemes=("dynamic",))


def is_resonant(period: float) -> bool:
    """True if at a wave period [s] the damping of heave exceeds mass and stiffness together."""
    table, omega = csv_file.Table(table_path("section_radiation")), 2.0 * pi / period
    names = ("heave_added_kg", "heave_damping_kg_s")
    added, damping = (float(np.interp(omega, table["omega_rad_s"], table[name])) for name in names)
    return omega * damping > abs(WATER_DENSITY * GRAVITY * BREADTH * LENGTH - omega**2 * (MASS + added))


def sway_springs() -> list[dict[str, Any]]:
    """Ship keys of two mooring lines that act as springs in sway, and are so long that they hardly resist heave."""
    half = {"stiffness": SPRING_STIFFNESS / 2.0, "damping": SPRING_DAMPING / 2.0}
    half |= {"slack_length": ANCHOR_DISTANCE - 1.0}
    ends = [(side * BREADTH / 2.0, side * (BREADTH / 2.0 + ANCHOR_DISTANCE)) for side in (1.0, -1.0)]
    return [{"from": [near, KG, 0.0], "to": [far, KG - DRAUGHT, 0.0]} | half for near, far in ends]


def particle_problem(period: float) -> Problem:
    """Set-up of the ship's section, free in heave and roll, on particles in open sea, in beam waves of a period [s]."""
    length = 2.0 * pi / float(waves.wavenumber(2.0 * pi / period, DEPTH, GRAVITY))
    limits = {motion: {"pressure": PARTICLE_TOLERANCES[motion]} for motion in MOTION_SCALES}
    promises = tuple(
        Promise(f"T {period:g} s, particles: {motion} [{over}]", "%", SOURCE_TEXT, limits[motion])
        for motion, over in MOTION_SCALES.items()
    )
    scene = {
        "duration": RUN_PERIODS * period,
        "basin": {"length": PATCH_LENGTH * length, "depth": DEPTH, "walls": "periodic"},
        "fluid": {"kind": "delta_sph", "spacing": length / round(length / DRAUGHT * DRAUGHT_SPACINGS)},
        "sea": {"kind": "linear_waves", "height": 2.0 * AMPLITUDE, "period": period},
        "ship": section_keys(12),
    }
    look = partial(measure_particles, period=period)
    return Problem(scene, promises, look, f"particles, {period:g} s", True, "ship", ("pressure",))


def measure_particles(simulation: Simulation, period: float) -> Finding:
    """Run in waves of a period [s]; compare heave over wave amplitude, and roll over wave slope, with measured ones."""
    rows = [(t, b.position[1], b.angles[2]) for t, b in ships.follow_body(simulation, simulation.scene.duration)]
    t, heave, roll = np.array(rows).T
    late = t > t[-1] - ships.JUDGED_WAVES * period
    omega = 2.0 * pi / period
    over = np.array([AMPLITUDE, AMPLITUDE * float(waves.wavenumber(omega, DEPTH, GRAVITY))])
    found = ships.first_harmonics(t[late], np.stack([heave, roll], axis=1)[late], omega) / over
    seen = measured_amplitudes()[period]
    numbers = [percent_error(float(value), seen[motion]) for value, motion in zip(found, MOTION_SCALES, strict=True)]
    curves = [Curve("heave", t / period, (heave - heave[0]) / AMPLITUDE), Curve("roll", t / period, roll / over[1])]
    return Finding(numbers, curves, [], ("t / T", "heave / a, roll / k a"))


def section_keys(cells: int) -> dict[str, Any]:
    """Scene keys of a ship with the measured section, free in heave and roll, with `cells` cubes over its draught."""
    whole = ships.ship_of_section(BREADTH, HEIGHT, BILGE, LENGTH, MASS, KG, ROLL_RADIUS, cells)
    return whole | {"free": ["heave", "roll"]}


def measured_amplitudes(scenario: str = "heave+roll") -> dict[float, dict[str, float]]:
    """Published amplitudes by wave period [s] and motion: roll over wave slope k a, others over wave amplitude a.
    `scenario`: motions that were free, a key of FREE_MOTIONS."""
    table = csv_file.read_columns(table_path("sundsdal2025_section"))
    found: dict[float, dict[str, float]] = {}
    for motion in FREE_MOTIONS[scenario]:
        values = table[MEASURED_COLUMNS[motion]]
        own = (table["scenario"] == scenario) & (values > 0.0)  # lost repetitions are 0
        for period in np.unique(table["T_s"][own]):
            found.setdefault(float(period), {})[motion] = float(values[own & (table["T_s"] == period)].mean())
    return found


def wave_response(simulation: Simulation, period: float) -> dict[str, float]:
    """Run in a regular wave of a period [s]; amplitudes by motion: sway, heave over amplitude a, roll over k a."""
    rest, omega = KG - ships.floating_ship(simulation).hydrostatics.draught, 2.0 * pi / period
    t, sway, heave, _, _, _, roll = ships.record_in_waves(simulation, rest, 2.0 * AMPLITUDE, period, 90.0)
    sway, heave, roll = ships.first_harmonics(t, np.stack([sway, heave, roll], axis=1), omega) / AMPLITUDE
    return {"sway": float(sway), "heave": float(heave), "roll": float(roll / waves.wavenumber(omega, DEPTH, GRAVITY))}
