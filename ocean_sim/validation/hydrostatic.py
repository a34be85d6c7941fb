"""Still water: hydrostatic pressure and no motion.

Set-up of Adami, Hu & Adams (2012, J. Comput. Phys. 231): 2 x 0.9 m, |g| = 1 m/s2, Re 100, sound ten times as fast as
sqrt(g H). The slow set-up is a tank of water at rest for a minute.
"""

from math import sqrt

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, absolute_error
from ocean_sim.validation.shared.state import State, record_run, sampled_states

DENSITY = 1000.0  # [kg/m3]
SOURCE = "p = rho g (H - z); Adami, Hu & Adams 2012"
PEER = f"{SOURCE}; a peer with wall particles: L2 0.34 %, bed -0.9 %, speed 1.8e-3"

ADAMI_PROMISES = (
    Promise("pressure, L2 over rho g H", "%", PEER, {"delta_sph": 0.5, "dfsph": 1.0}),
    Promise("pressure at the bed [Pa]", "%", PEER, {"delta_sph": 1.0, "dfsph": 1.0}),
    Promise("largest speed over sqrt(g H)", "1", PEER, {"delta_sph": 2e-3}),
)
LONG_PROMISES = (
    Promise("60 s: kinetic energy over m g H", "1", "still water has none", {"delta_sph": 1e-4, "dfsph": 1e-4}),
    Promise("60 s: creep of the centre of mass over H", "%", "still water stays", {"delta_sph": 0.5, "dfsph": 0.5}),
    Promise("60 s: particles outside", "1", "walls hold", {"delta_sph": 0.0, "dfsph": 0.0}),
)


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: the tank of Adami et al. (coarse: three times the spacing), and a slow tank, 60 s at rest."""
    spacing = 0.06 if coarse else 0.02
    adami = {
        "duration": 2.0,
        "basin": {"length": 2.04 if coarse else 2.0, "depth": 0.9, "gravity": [0.0, -1.0, 0.0]},
        "fluid": {"spacing": spacing, "rest_density": DENSITY, "kinematic_viscosity": sqrt(0.9) * 0.9 / 100.0},
    }
    long = {
        "duration": 60.0,
        "basin": {"length": 1.0, "depth": 0.5},
        "fluid": {"spacing": 0.02, "rest_density": DENSITY, "kinematic_viscosity": 1e-6},
    }
    last = lambda run: [*sampled_states(run, run.scene.duration, run.scene.duration / 8)][-1]
    return [
        Problem(adami, ADAMI_PROMISES, lambda run: compare_pressure(last(run), depth=0.9, g=1.0)),
        Problem(long, LONG_PROMISES, measure_long, name="60 s", slow=True),
    ]


def compare_pressure(water: State, depth: float, g: float) -> Finding:
    """Compare pressure and speed of the water with those at rest, for a depth [m] and downward gravity `g` [m/s2]."""
    scale = DENSITY * g * depth
    y, exact = water.position[:, 1], -DENSITY * g * water.position[:, 1]
    l2 = 100.0 * float(np.sqrt(np.mean((water.pressure - exact) ** 2))) / scale
    row = y < -depth + water.spacing
    bed, bed_exact = 0.0, DENSITY * g * (depth - water.spacing / 2)  # where the bed is dry
    if row.any():
        bed, bed_exact = float(water.pressure[row].mean()), float(exact[row].mean())
    speed = water.max_speed / sqrt(g * depth)
    order = np.argsort(y)
    numbers = [absolute_error(l2), (bed, bed_exact, 100.0 * (bed - bed_exact) / scale), absolute_error(speed)]
    measured = [Curve("particles", water.pressure / scale, y, points=True)]
    expected = [Curve("rho g (H - z)", exact[order] / scale, y[order])]
    return Finding(numbers, measured, expected, ("p / (rho g H)", "y [m]"))


def measure_long(simulation: Simulation) -> Finding:
    """Run water at rest for a minute; measure kinetic energy, rise of its centre of mass, and escaped particles."""
    depth, g = simulation.basin.depth, -simulation.basin.gravity[1]
    low, up = np.array(simulation.basin.lower), np.array(simulation.basin.upper)

    def motion(water: State) -> tuple[float, float, int]:
        """Kinetic energy over m g H, height of the centre of mass [m], and number of particles outside the tank."""
        energy = water.kinetic_energy / (water.mass * len(water.position) * g * depth)
        out = (water.position < low) | (water.position > up)
        return energy, water.position[:, 1].mean(), out[:, :2].any(axis=1).sum()

    times, values = record_run(simulation, 1.0, motion)
    energy, centre, outside = values.T
    creep = 100.0 * (centre[-1] - centre[max(1, len(times) // 12)]) / depth
    numbers = [absolute_error(value) for value in (energy[-1], creep, outside.max())]
    return Finding(numbers, [Curve("kinetic energy", times[1:], energy[1:])], [], ("time [s]", "KE / (m g H)"))
