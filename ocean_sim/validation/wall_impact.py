"""The pressure of a dam break on a wall, at two heights: a measurement and a finer computation.

Tank 5.366 H long, column 2 H x H, H = 0.6 m. Measured by Buchner (2002, thesis, TU Delft) around y = 0.2 H; computed
by De Courcy et al. (2024, CMAME 420, 116700) with delta-SPH at H / 400, here the sensor at y = 0.05 H. Time is
t* = t sqrt(g / H), pressure p* = p / (rho g H). Arrival and impulse are judged; a peak at one instant is chance.
"""

from dataclasses import dataclass

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Number, Problem, Promise, percent_error
from ocean_sim.validation.shared.state import record_run
from ocean_sim.validation.shared.tables import table

HEIGHT, TANK_LENGTH = 0.6, 5.366  # H [m], [H]
TIME_SCALE = float(np.sqrt(GRAVITY / HEIGHT))  # [1/s] t* / t of both tables
DENSITY = 1000.0  # [kg/m3]
END_TIME = 5.5  # t*, before the wave that runs back
ARRIVAL_PRESSURE = 0.25  # p*, after a moving mean
MEAN_TIME = 0.05  # t* of the moving mean
SENSOR_POINTS = 9  # over the height of a sensor


@dataclass(frozen=True)
class Sensor:
    """Pressure sensor of a reference: its range of heights on the wall, and the table of its record."""

    name: str
    low: float  # [H]
    high: float  # [H]
    file: str


SENSORS = (
    Sensor("Buchner 2002", 0.125, 0.275, "buchner2002_P_5366H_02H"),
    Sensor("De Courcy et al. 2024", 0.043, 0.057, "decourcy2024_numerical_P2"),
)
PROMISES = tuple(
    Promise(f"{quantity}, {sensor.name}", "%", f"{sensor.name}, digitised; t* = t sqrt(g / H)", {"delta_sph": limit})
    for sensor in SENSORS
    for quantity, limit in (("arrival t*", 3.0), (f"impulse p* t* to t* = {END_TIME:g}", 10.0))
)


def problems(coarse: bool) -> list[Problem]:
    left = -TANK_LENGTH * HEIGHT / 2
    fill = [{"min": [left, -HEIGHT], "max": [left + 2.0 * HEIGHT, 0.0]}]
    scene = {
        "duration": END_TIME / TIME_SCALE,
        "basin": {"length": TANK_LENGTH * HEIGHT, "depth": HEIGHT},
        "fluid": {"spacing": HEIGHT / (20 if coarse else 80), "rest_density": DENSITY, "fill": fill},
    }
    return [Problem(scene, PROMISES, measure)]


def measure(simulation: Simulation) -> Finding:
    wall, duration = simulation.basin.upper[0], simulation.scene.duration
    heights = np.stack([np.linspace(sensor.low, sensor.high, SENSOR_POINTS) for sensor in SENSORS]) * HEIGHT
    points = np.stack([np.full(heights.size, wall), heights.ravel() - HEIGHT, np.zeros(heights.size)], axis=1)
    channels = lambda _: simulation.fluid.pressures(points).reshape(heights.shape).mean(axis=1)
    times, pressures = record_run(simulation, duration / 800, channels)
    return compare_pressures(TIME_SCALE * times, pressures / (DENSITY * GRAVITY * HEIGHT))


def arrival_and_impulse(time: np.ndarray, pressure: np.ndarray) -> tuple[float, float]:
    """Arrival time t* and impulse (p* integrated over t*) of a pressure p* (n,) at times t* (n,), after smoothing."""
    even = np.arange(0.0, END_TIME, 0.01)
    order = np.argsort(time, kind="stable")
    width = round(MEAN_TIME / 0.01)
    smooth = np.convolve(np.interp(even, time[order], pressure[order], left=0.0), np.ones(width) / width, "same")
    there = np.flatnonzero(smooth > ARRIVAL_PRESSURE)
    arrival = float(even[there[0]]) if there.size else END_TIME
    return arrival, float(np.trapezoid(np.where(even >= arrival, smooth, 0.0), even))


def compare_pressures(time: np.ndarray, pressure: np.ndarray) -> Finding:
    """Compare pressures p* (n, 2), a column for each of SENSORS, at times t* (n,) with the tables."""
    numbers: list[Number] = []
    measured, expected = [], []
    for k, sensor in enumerate(SENSORS):
        data = table(sensor.file)
        found = arrival_and_impulse(time, pressure[:, k])
        numbers += map(percent_error, found, arrival_and_impulse(data["tstar"], data["pstar"]))
        measured.append(Curve(f"y = {0.5 * (sensor.low + sensor.high):.2g} H", time, pressure[:, k]))
        expected.append(Curve(sensor.name, data["tstar"], data["pstar"], points=True))
    return Finding(numbers, measured, expected, ("t* = t sqrt(g / H)", "p* = p / (rho g H)"))
