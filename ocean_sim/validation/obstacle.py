"""A dam break that hits a box: heights of the water at four positions and pressures at eight on the box.

Measured at MARIN (Kleefsman, Fekken, Veldman, Iwanowski & Buchner 2005, J. Comput. Phys. 206; SPHERIC test 2) in a tank
of 3.22 x 1 x 1 m: water 1.228 m long and 0.55 m deep behind a gate, and a box of 0.161 x 0.161 x 0.403 m 1.1675 m
behind it. One run, of unknown uncertainty. Probes are identified by their position, not by their label: H4 is in the
reservoir, H1, H2 and H3 follow the wave. The arrival is the first time above 20 mm or 500 Pa in the record of every
millisecond; the table of all channels holds means over 10 ms, in which a blow begins up to 10 ms early. Arrivals at P4
and H3 are chance: they depend on drops and on the jet over the box.
"""

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Number, Problem, Promise, absolute_error, percent_error
from ocean_sim.validation.shared.state import record_run
from ocean_sim.validation.shared.tables import table

LENGTH, WIDTH, DEPTH, RESERVOIR = 3.22, 1.0, 0.55, 1.228  # [m]
BOX_SIDE, BOX_WIDTH, FACE_DISTANCE = 0.161, 0.403, 2.3955  # [m]; of its face from the end of the reservoir
HEIGHT_GAUGES = {"H1": 1.732, "H2": 2.228, "H3": 2.724, "H4": 0.582}  # distance from the end of the reservoir [m]
SENSOR_OFFSETS = (0.021, 0.061, 0.101, 0.141)  # of P1 to P4 above the bed, of P5 to P8 behind the front edge [m]
PRESSURE_SENSORS = tuple(f"P{k}" for k in range(1, 9))
END_TIME, SAMPLE_INTERVAL = 2.0, 0.005  # [s]
ARRIVAL_HEIGHT, ARRIVAL_PRESSURE = 0.02, 500.0  # [m], [Pa]
PRESSURE_SCALE = 1000.0 * 9.81 * DEPTH  # [Pa]
CHANNEL_TABLE = "spheric02_kleefsman_10ms"
SOURCE_TEXT = "Kleefsman et al. 2005, measured"
ARRIVAL_TIMES = {"H1": 0.218, "H2": 0.368, "H3": 0.920}  # [s]
ARRIVAL_TIMES |= {"P1": 0.393, "P2": 0.410, "P3": 0.423, "P4": 0.429, "P5": 1.097, "P7": 1.069}
SPRAYED_SENSORS = ("P5", "P7")  # drops arrive there first
PROMISES = (
    Promise("H4, largest error to 2 s over H0", "%", f"{SOURCE_TEXT}; 5 %", {"delta_sph": 5.0}),
    *(Promise(f"{name}, root mean square error to 2 s over H0", "%", SOURCE_TEXT) for name in HEIGHT_GAUGES),
    *(Promise(f"{name}, largest error to 2 s over H0", "%", SOURCE_TEXT) for name in ("H1", "H2", "H3")),
    *(
        Promise(f"{name} arrival [s]", "%", f"{SOURCE_TEXT}; 5 %", {"delta_sph": 5.0})
        for name in ARRIVAL_TIMES
        if name not in SPRAYED_SENSORS
    ),
    *(Promise(f"{name} arrival [s]", "%", f"{SOURCE_TEXT}; drops") for name in SPRAYED_SENSORS),
    *(Promise(f"{name} impulse to 2 s [Pa s]", "% of 2 s rho g H0", SOURCE_TEXT) for name in PRESSURE_SENSORS),
)


def problems(coarse: bool) -> list[Problem]:
    low, bed = -LENGTH / 2, -DEPTH
    box = {
        "min": [low + FACE_DISTANCE, bed, -BOX_WIDTH / 2],
        "max": [low + FACE_DISTANCE + BOX_SIDE, bed + BOX_SIDE, BOX_WIDTH / 2],
    }
    fill = [{"min": [low, bed, -WIDTH / 2], "max": [low + RESERVOIR, 0.0, WIDTH / 2]}]
    scene = {
        "duration": END_TIME,
        "basin": {"length": LENGTH, "width": WIDTH, "depth": DEPTH, "obstacles": [box]},
        "fluid": {"spacing": DEPTH / (8 if coarse else 20), "kinematic_viscosity": 1e-6, "fill": fill},
    }
    return [Problem(scene, PROMISES, measure, slow=not coarse)]


def measure(simulation: Simulation) -> Finding:
    fluid, front = simulation.fluid, [(FACE_DISTANCE, up, 0.0) for up in SENSOR_OFFSETS]
    top = [(FACE_DISTANCE + behind, BOX_SIDE, 0.0) for behind in SENSOR_OFFSETS]
    sensors = np.array(front + top) - (LENGTH / 2, DEPTH, 0.0)  # P1 to P8
    probes = np.array([(away - LENGTH / 2, 0.0) for away in HEIGHT_GAUGES.values()])
    channels = lambda _: [*(fluid.elevations(probes) + DEPTH), *fluid.pressures(sensors)]
    times, values = record_run(simulation, SAMPLE_INTERVAL, channels)
    return compare_channels(times, dict(zip((*HEIGHT_GAUGES, *PRESSURE_SENSORS), values.T)))


def arrival_time(time: np.ndarray, channel: np.ndarray, threshold: float) -> float:
    """Time [s] at which a signal `channel` (n,), at times (n,) [s], first exceeds a threshold; END_TIME if never."""
    even = np.arange(0.0, END_TIME, SAMPLE_INTERVAL)
    level = np.interp(even, time, channel)
    there = np.flatnonzero(level > threshold)
    if not there.size:
        return END_TIME
    k = max(int(there[0]), 1)
    before, after = level[k - 1 : k + 1]
    return float(even[k] - SAMPLE_INTERVAL * (after - threshold) / (after - before))


def compare_channels(time: np.ndarray, channels: dict[str, np.ndarray]) -> Finding:
    """Compare recorded `channels` (n,), heights [m], pressures [Pa] by name, at times (n,) [s], with measured ones."""
    data = table(CHANNEL_TABLE)
    found: dict[str, Number] = {}
    within = (data["t"] <= END_TIME) & (data["t"] <= time[-1] + SAMPLE_INTERVAL)
    for name in HEIGHT_GAUGES:
        off = np.interp(data["t"][within], time, channels[name]) - data[name][within]
        worst, rms = float(np.abs(off).max()), float(np.sqrt(np.mean(off**2)))
        found[f"{name}, largest error to 2 s over H0"] = absolute_error(100.0 * worst / DEPTH)
        found[f"{name}, root mean square error to 2 s over H0"] = absolute_error(100.0 * rms / DEPTH)
    for name, arrival in ARRIVAL_TIMES.items():
        threshold = ARRIVAL_HEIGHT if name.startswith("H") else ARRIVAL_PRESSURE
        found[f"{name} arrival [s]"] = percent_error(arrival_time(time, channels[name], threshold), arrival)
    for name in PRESSURE_SENSORS:
        mine = float(np.trapezoid(channels[name], time))
        theirs = float(np.trapezoid(data[name][within], data["t"][within]))
        found[f"{name} impulse to 2 s [Pa s]"] = (mine, theirs, 100.0 * (mine - theirs) / (END_TIME * PRESSURE_SCALE))
    shown = ("H1", "H2", "H3", "H4", "P1", "P3", "P5", "P7")
    unit = {name: DEPTH if name.startswith("H") else PRESSURE_SCALE for name in shown}
    numbers = [found[promise.quantity] for promise in PROMISES]
    measured = [Curve(name, time, channels[name] / unit[name]) for name in shown]
    known = data["t"][within]
    expected = [Curve(f"{name} measured", known, data[name][within] / unit[name], points=True) for name in shown]
    return Finding(numbers, measured, expected, ("time [s]", "height / H0, pressure / (rho g H0)"))
