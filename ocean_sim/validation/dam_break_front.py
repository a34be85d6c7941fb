"""The front of a collapsing column of water, against three experiments.

Column a wide and 2 a high; Martin & Moyce (1952, Phil. Trans. A 244, 312-324) and Koshizuka & Oka (1996, Nucl. Sci.
Eng. 123, 421-434). The experiments differ among each other by 4 to 8 %, so a smaller error earns no credit.

Both experiments read the edge of the water off film, taken through the side of the tank: a sheet deep enough to be
seen over the width of the tank, not a drop that runs ahead of it. What is judged is therefore the front of water one
spacing deep: the foremost particle with another within a spacing behind it. The foremost particle is only reported.
"""

from math import sqrt

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.simulation import Simulation
from ocean_sim.validation._case import Curve, Finding, Problem, Promise
from ocean_sim.validation._state import watched
from ocean_sim.validation._tables import table

WIDTH = 1.0  # a [m]
TANK = 5.0  # [a]
BEGIN, END = 0.8, 3.1  # the stretch of scaled time that all experiments share
TABLES = {
    "Martin & Moyce, a = 2.25 in": "dambreak_front_martin_moyce_n2_2_a225in",
    "Martin & Moyce, a = 1.125 in": "dambreak_front_martin_moyce_n2_2_a1125in",
    "Koshizuka & Oka": "dambreak_front_koshizuka_oka1996",
}
TOLERANCE = {"delta_sph": 8.0, "dfsph": 8.0}
PROMISES = tuple(
    Promise(
        f"mean distance of the front, {name} [a]",
        "%",
        "experiment; they differ by 4 to 8 %",
        TOLERANCE,
    )
    for name in TABLES
)
FOREMOST = tuple(
    Promise(f"mean distance of the foremost particle, {name} [a]", "%", "experiment; a lone drop counts")
    for name in TABLES
)


def problems(coarse: bool) -> list[Problem]:
    left = -TANK * WIDTH / 2
    scene = {
        "duration": END / sqrt(2.0 * GRAVITY / WIDTH),
        "basin": {"length": TANK * WIDTH, "depth": 2.0 * WIDTH},
        "fluid": {
            "spacing": WIDTH / (20 if coarse else 40),
            "fill": [{"min": [left, -2.0 * WIDTH], "max": [left + WIDTH, 0.0]}],
        },
    }
    return [Problem(scene, PROMISES + FOREMOST, measure)]


def scaled_time(time: np.ndarray, g: float, width: float) -> np.ndarray:
    """T = t sqrt(2 g / a), the time axis of the experiments."""
    return time * np.sqrt(2.0 * g / width)


def fronts(position: np.ndarray, spacing: float) -> tuple[float, float]:
    """x [m] of the front of water one spacing deep, and that of the foremost particle."""
    x = np.sort(position[:, 0])
    followed = x[1:][np.diff(x) <= 1.001 * spacing]  # a lattice counts, whatever the rounding
    return float(followed[-1] if followed.size else x[-1]) + spacing / 2, float(x[-1]) + spacing / 2


def measure(simulation: Simulation) -> Finding:
    """Both fronts over time."""
    left = simulation.basin.lower[0]
    times, seen = [], []
    for water in watched(simulation, simulation.scene.duration, simulation.scene.duration / 60):
        times.append(water.time)
        seen.append(fronts(water.position, water.spacing))
    time, (front, foremost) = scaled_time(np.array(times), GRAVITY, WIDTH), (np.array(seen).T - left) / WIDTH
    found, alone = compared(time, front), compared(time, foremost, FOREMOST, "foremost particle")
    return Finding({**found.numbers, **alone.numbers}, found.measured + alone.measured, found.expected, found.axes)


def compared(
    time: np.ndarray, front: np.ndarray, promises: tuple[Promise, ...] = PROMISES, name: str = "front"
) -> Finding:
    """A front Z(T) against every experiment, at the experiment's own times."""
    numbers, expected = {}, []
    for promise, (whose, file) in zip(promises, TABLES.items(), strict=True):
        data = table(file)
        expected.append(Curve(whose, data["T"][data["T"] < END], data["Z"][data["T"] < END], points=True))
        at = (data["T"] >= BEGIN) & (data["T"] <= END)
        seen, known = np.interp(data["T"][at], time, front), data["Z"][at]
        error = 100.0 * float(np.mean(np.abs(seen / known - 1.0)))
        numbers[promise.quantity] = (float(seen.mean()), float(known.mean()), error)
    return Finding(numbers, [Curve(name, time, front)], expected, ("T = t sqrt(2 g / a)", "Z = x / a"))
