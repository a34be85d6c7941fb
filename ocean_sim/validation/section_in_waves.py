"""A ship's section that floats across a flume in beam waves, free in heave and roll, as Sundsdal et al. measured it.

Breadth 0.400 m, draught 0.200 m, bilges of 0.0512 m, 46.8 kg, waves of 24 mm (NTNU 2025). The closed form has added
mass, damping and the force of scattered waves from a table of linear potential flow in two dimensions; nothing is
fitted. Wanted, before anything was run: 5 % of heave off its resonance at 1.17 s; near it, and of roll, nothing is
promised. Particles, that press on the section in a patch of open sea three wavelengths long, are wanted within 10 % of
heave and 20 % of roll.

Off resonance the closed form misses: -5.7 % at 1.072 s, -6.9 % at 1.036 s, -19 % at 0.897 s, where the section hardly
moves. So do particles: heave is 37 % too low at 1.158 s with 8 and with 12 spacings in the draught (ten here), so that
is not the resolution's, and 43 % at 0.897 s with 8, where the same patch without a hull has its wave within 5 %. At
1.21 s it is 1.4 % too high with 8. Roll is 28 to 47 % too low. Why is not known.
"""

from functools import partial
from math import cos, pi, sin
from typing import Any

import numpy as np

from ocean_sim import waves
from ocean_sim.files import csv_file
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative
from ocean_sim.validation.shared.ship import G, at_sea, floating, pose, track
from ocean_sim.validation.shared.tables import table_path

LENGTH, BREADTH, HEIGHT, DRAUGHT, BILGE = 0.586, 0.400, 0.256, 0.200, 0.0512  # [m]
MASS, KG, ROLL_RADIUS = 46.8, 0.107, 0.36 * BREADTH  # [kg], [m], [m]
DEPTH, AMPLITUDE = 1.00, 0.012  # [m]
PERIODS = (1.21, 1.158, 1.072, 1.036, 0.897)  # [s]
PASSING, JUDGED, STEPS = 20, 4, 60  # waves, those that are looked at, steps in each
MOTIONS = {"heave": "a", "roll": "k a"}  # and what they are over
RESONANCE, NEAR, WANTED = 1.17, 0.05, 5.0  # of heave [s], how near is near it, and off it [%]
BY_PARTICLES = (1.158, 1.21, 0.897)  # [s]
PRESSED = {"heave": 10.0, "roll": 20.0}  # [%]
FINE, PATCH, RUN = 10, 3.0, 14.0  # spacings in the draught, [wavelengths], [periods]
CORNERS = 8  # of a bilge
SOURCE = "Sundsdal et al. (2025), measured"


def problems(coarse: bool) -> list[Problem]:
    found = [in_closed_form(coarse)]
    return found if coarse else found + [by_particles(period) for period in BY_PARTICLES]


def in_closed_form(coarse: bool) -> Problem:
    """All periods, one after the other."""
    periods = PERIODS[1:3] if coarse else PERIODS
    promises = {
        (period, motion): Promise(
            f"T {period:g} s: {motion} [{over}]",
            "%",
            SOURCE,
            {"dynamic": WANTED} if motion == "heave" and abs(period / RESONANCE - 1.0) > NEAR else {},
        )
        for period in periods
        for motion, over in MOTIONS.items()
    }

    def measure(simulation: Simulation) -> Finding:
        seen = measured()
        numbers, found = {}, []
        for period in periods:
            answer = answers(simulation, period)
            found.append(answer)
            for motion, value in zip(MOTIONS, answer):
                numbers[promises[period, motion].quantity] = relative(value, seen[period][motion])
        at, all_at = np.array(periods), np.array(sorted(seen))
        curves = [Curve(motion, at, np.array(found)[:, k], points=True) for k, motion in enumerate(MOTIONS)]
        expected = [
            Curve(f"{motion}, measured", all_at, np.array([seen[t][motion] for t in all_at])) for motion in MOTIONS
        ]
        return Finding(numbers, curves, expected, ("T [s]", "heave / a, roll / k a"))

    table = {"radiation": str(table_path("section_radiation")), "damping": {"cross_flow": 0.0}}
    scene = at_sea(section(8 if coarse else 12) | table, 1.0, 0.01, heading_deg=90.0)
    scene["basin"]["depth"] = DEPTH
    return Problem(scene, tuple(promises.values()), measure, "closed form", slot="ship", schemes=("dynamic",))


def by_particles(period: float) -> Problem:
    """One period, in a patch of open sea."""
    k = float(waves.wavenumber(2.0 * pi / period, DEPTH, G))
    length = 2.0 * pi / k
    promises = tuple(
        Promise(f"T {period:g} s, particles: {motion} [{over}]", "%", SOURCE, {"pressure": PRESSED[motion]})
        for motion, over in MOTIONS.items()
    )
    scene = {
        "duration": RUN * period,
        "basin": {"length": PATCH * length, "depth": DEPTH, "walls": "periodic", "gravity": [0.0, -G, 0.0]},
        "fluid": {"kind": "delta_sph", "spacing": length / round(length / DRAUGHT * FINE)},
        "sea": {"kind": "linear_waves", "height": 2.0 * AMPLITUDE, "period": period},
        "ship": section(12),
    }
    look = partial(pressed, promises=promises, period=period)
    return Problem(scene, promises, look, f"particles, {period:g} s", True, "ship", ("pressure",))


def pressed(simulation: Simulation, promises: tuple[Promise, ...], period: float) -> Finding:
    """Heave over the amplitude, and roll over k times it, of the last periods."""
    rows = [(t, b.position[1], b.angles[2]) for t, b in track(simulation, simulation.scene.duration)]
    t, heave, roll = np.array(rows).T
    late = t > t[-1] - JUDGED * period
    omega = 2.0 * pi / period
    base = np.stack([np.cos(omega * t), np.sin(omega * t), np.ones_like(t), t], axis=1)[late]
    over = {"heave": AMPLITUDE, "roll": AMPLITUDE * float(waves.wavenumber(omega, DEPTH, G))}
    fits = {motion: np.linalg.lstsq(base, y[late], rcond=None)[0] for motion, y in (("heave", heave), ("roll", roll))}
    values = {motion: float(np.hypot(*fit[:2])) / over[motion] for motion, fit in fits.items()}
    seen = measured()[period]
    numbers = {promise.quantity: relative(values[motion], seen[motion]) for promise, motion in zip(promises, MOTIONS)}
    curves = [
        Curve("heave", t / period, (heave - heave[0]) / AMPLITUDE),
        Curve("roll", t / period, roll / over["roll"]),
    ]
    return Finding(numbers, curves, [], ("t / T", "heave / a, roll / k a"))


def section(cells: int) -> dict[str, Any]:
    """The ship of a scene."""
    angles = np.linspace(0.0, pi / 2.0, CORNERS + 1)
    inner = BREADTH / 2.0 - BILGE
    side = [(BREADTH / 2.0, HEIGHT)] + [(inner + BILGE * cos(a), BILGE - BILGE * sin(a)) for a in angles]
    points = [[float(x), float(y), end * LENGTH / 2.0] for x, y in side for end in (1.0, -1.0)]
    long = MASS * (LENGTH**2 + HEIGHT**2) / 12.0
    return {
        "hull": {
            "shape": {"kind": "outline", "points": points},
            "mass": MASS,
            "centre_of_mass": [0.0, KG, 0.0],
            "inertia": [long, long, MASS * ROLL_RADIUS**2],
        },
        "free": ["heave", "roll"],
        "cells_per_draught": cells,
    }


def measured() -> dict[float, dict[str, float]]:
    """First harmonics over the amplitude, and over k times it, by period; by accelerometers, mean of repetitions."""
    table = csv_file.columns(table_path("sundsdal2025_section"))
    own = table["scenario"] == "heave+roll"
    found = {}
    for period in np.unique(table["T_s"][own]):
        rows = own & (table["T_s"] == period)
        found[float(period)] = {m: float(table[f"{m}_acc"][rows].mean()) for m in MOTIONS}
    return found


def answers(simulation: Simulation, period: float) -> tuple[float, float]:
    """Heave over the amplitude, and roll over k times it, in a regular wave of a period [s]."""
    fluid: Any = simulation.fluid  # of kind linear_waves
    clock: Any = simulation.time_step  # of kind fixed
    ship, omega = floating(simulation), 2.0 * pi / period
    rest = np.array([0.0, ship.hull.body.position[1], 0.0])
    pose(simulation, position=rest, orientation=np.array([1.0, 0.0, 0.0, 0.0]))
    fluid.begin(waves.regular(2.0 * AMPLITUDE, period, waves.direction(90.0, 3), DEPTH, G))
    simulation.time, simulation.next_dt = 0.0, period / STEPS
    clock.config = clock.config.model_copy(update={"dt": period / STEPS})
    rows = [(t, b.position[1], b.angles[2]) for t, b in track(simulation, PASSING * period - 1e-9)]
    t, heave, roll = np.array(rows[-JUDGED * STEPS :]).T
    wave = np.exp(1j * omega * t)
    heave, roll = (2.0 * abs(np.mean((y - y.mean()) * wave)) / AMPLITUDE for y in (heave, roll))
    return float(heave), float(roll / waves.wavenumber(omega, DEPTH, G))
