"""A dam break that hits a box: heights of the water at four positions and pressures at eight on the box.

Measured at MARIN (Kleefsman, Fekken, Veldman, Iwanowski & Buchner 2005, J. Comput. Phys. 206; SPHERIC test 2) in a tank
of 3.22 x 1 x 1 m: water 1.228 m long and 0.55 m deep behind a gate, and a box of 0.161 x 0.161 x 0.403 m 1.1675 m
behind it. One run, of unknown uncertainty. Probes are identified by their position, not by their label: H4 is in the
reservoir, H1, H2 and H3 follow the wave. Arrivals are when 20 mm or 500 Pa are first passed in the record of every
millisecond; the table of all channels holds means over 10 ms, in which a blow begins up to 10 ms early.

Under `delta_sph` at H0 / 20: the reservoir empties to 1.2 % of H0, P1 and P3 begin within 4.4 %, P2 6.1 % late, their
impulses are within 6.8, 0.9 and 13 % of 2 s rho g H0. P4, 20 mm under the front edge, begins 9.2 % late, its impulse is
too small by 27 %: water that leaves the edge is held back by suction where air would come in. The front passes H1 12 %
late, as a sheet that is 20 mm thick at once, where the measured one has grown for 40 ms; it passes H3 26 % early, which
is read off the jet over the box; the length of a wire that is wet passes 20 mm as early. Arrivals at P4 and H3 are
chance: with twice the dissipation between particles that meet they are 18 % late and 12 % early.

At H0 / 30 P1 to P3 begin within 4.9 %, P4 6.4 % late; H1 is passed 9.9 % late, H2 1.9 %, H3 5.4 % early.
"""

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative
from ocean_sim.validation.shared.state import sampled
from ocean_sim.validation.shared.tables import table

LENGTH, WIDTH, DEPTH, RESERVOIR = 3.22, 1.0, 0.55, 1.228  # [m]
BOX, BOX_WIDTH, FACE = 0.161, 0.403, 2.3955  # side and width of the box, and how far its face is from the reservoir [m]
HEIGHTS = {"H1": 1.732, "H2": 2.228, "H3": 2.724, "H4": 0.582}  # distance from the end of the reservoir [m]
ALONG = (0.021, 0.061, 0.101, 0.141)  # of P1 to P4 above the bed, of P5 to P8 behind the front edge [m]
PRESSURES = tuple(f"P{k}" for k in range(1, 9))
END, EVERY = 2.0, 0.005  # [s]
WET, HIT = 0.02, 500.0  # [m], [Pa] that arrival is
SCALE = 1000.0 * 9.81 * DEPTH  # [Pa]
TABLE = "spheric02_kleefsman_10ms"
SOURCE = "Kleefsman et al. 2005, measured"
ARRIVALS = {"H1": 0.218, "H2": 0.368, "H3": 0.920}  # [s]
ARRIVALS |= {"P1": 0.393, "P2": 0.410, "P3": 0.423, "P4": 0.429, "P5": 1.097, "P7": 1.069}
SPRAYED = ("P5", "P7")  # where drops arrive first
PROMISES = (
    Promise("H4, largest error to 2 s over H0", "%", f"{SOURCE}; 5 %", {"delta_sph": 5.0}),
    *(Promise(f"{name}, root mean square error to 2 s over H0", "%", SOURCE) for name in HEIGHTS),
    *(Promise(f"{name}, largest error to 2 s over H0", "%", SOURCE) for name in ("H1", "H2", "H3")),
    *(
        Promise(f"{name} arrival [s]", "%", f"{SOURCE}; 5 %", {"delta_sph": 5.0})
        for name in ARRIVALS
        if name not in SPRAYED
    ),
    *(Promise(f"{name} arrival [s]", "%", f"{SOURCE}; drops") for name in SPRAYED),
    *(Promise(f"{name} impulse to 2 s [Pa s]", "% of 2 s rho g H0", SOURCE) for name in PRESSURES),
)


def problems(coarse: bool) -> list[Problem]:
    low, bed = -LENGTH / 2, -DEPTH
    box = {
        "min": [low + FACE, bed, -BOX_WIDTH / 2],
        "max": [low + FACE + BOX, bed + BOX, BOX_WIDTH / 2],
    }
    scene = {
        "duration": END,
        "basin": {"length": LENGTH, "width": WIDTH, "depth": DEPTH, "obstacles": [box]},
        "fluid": {
            "spacing": DEPTH / (8 if coarse else 20),
            "kinematic_viscosity": 1e-6,
            "fill": [{"min": [low, bed, -WIDTH / 2], "max": [low + RESERVOIR, 0.0, WIDTH / 2]}],
        },
    }
    return [Problem(scene, PROMISES, measure, slow=not coarse)]


def gauges() -> np.ndarray:
    """(8, 3) positions of P1 to P8 in the basin [m]."""
    front = [(FACE, up, 0.0) for up in ALONG]
    top = [(FACE + behind, BOX, 0.0) for behind in ALONG]
    return np.array(front + top) - (LENGTH / 2, DEPTH, 0.0)


def measure(simulation: Simulation) -> Finding:
    """All channels over time."""
    fluid, times, heights, pressures = simulation.fluid, [], [], []
    probes = np.array([(away - LENGTH / 2, 0.0) for away in HEIGHTS.values()])
    for water in sampled(simulation, simulation.scene.duration, EVERY):
        times.append(water.time)
        heights.append(fluid.elevations(probes) + DEPTH)
        pressures.append(fluid.pressures(gauges()))
    channels = dict(zip(HEIGHTS, np.array(heights).T)) | dict(zip(PRESSURES, np.array(pressures).T))
    return compared(np.array(times), channels)


def arrival(time: np.ndarray, channel: np.ndarray, least: float) -> float:
    """When a channel first passes `least` [s]; the end of the run where it never does."""
    even = np.arange(0.0, END, EVERY)
    level = np.interp(even, time, channel)
    there = np.flatnonzero(level > least)
    if not there.size:
        return END
    k = max(int(there[0]), 1)
    before, after = level[k - 1 : k + 1]
    return float(even[k] - EVERY * (after - least) / (after - before))


def compared(time: np.ndarray, channels: dict[str, np.ndarray]) -> Finding:
    """The channels at these times [s] against the table."""
    data = table(TABLE)
    found: dict[str, tuple[float, float | None, float | None]] = {}
    within = (data["t"] <= END) & (data["t"] <= time[-1] + EVERY)
    for name in HEIGHTS:
        off = np.interp(data["t"][within], time, channels[name]) - data[name][within]
        worst = 100.0 * float(np.abs(off).max()) / DEPTH
        found[f"{name}, largest error to 2 s over H0"] = (worst, 0.0, worst)
        spread = 100.0 * float(np.sqrt(np.mean(off**2))) / DEPTH
        found[f"{name}, root mean square error to 2 s over H0"] = (spread, 0.0, spread)
    for name, measured in ARRIVALS.items():
        least = WET if name.startswith("H") else HIT
        found[f"{name} arrival [s]"] = relative(arrival(time, channels[name], least), measured)
    for name in PRESSURES:
        mine = float(np.trapezoid(channels[name], time))
        theirs = float(np.trapezoid(data[name][within], data["t"][within]))
        found[f"{name} impulse to 2 s [Pa s]"] = (mine, theirs, 100.0 * (mine - theirs) / (END * SCALE))
    shown = ("H1", "H2", "H3", "H4", "P1", "P3", "P5", "P7")
    unit = {name: DEPTH if name.startswith("H") else SCALE for name in shown}
    return Finding(
        found,
        [Curve(name, time, channels[name] / unit[name]) for name in shown],
        [Curve(f"{name} measured", data["t"][within], data[name][within] / unit[name], points=True) for name in shown],
        ("time [s]", "height / H0, pressure / (rho g H0)"),
    )
