"""Set-up: a steady wind on a closed, shallow, laminar basin piles the water up at the lee end, and drives a surface
drift with a return flow below.

Far from the ends, over a bed without slip, u = tau / mu (3 z^2 / 4h - z / 2) at the height z above the bed: at the
surface tau h / (4 mu), at most tau h / (12 mu) the other way at z = h/3; the surface slopes by 3 tau / (2 rho g h). The
slope is read from the pressure on the bed. The drift is that of the parabola through the water below a support
from the surface: the wind is handed to particles that lie half a spacing and more below it.

The case ends after 5 s, while the particles still lie in rows. Then the rows break up, and what is left of the drift
depends on the stress over the pressure: under delta_sph, over the theory's in 3-5, 8-10, 13-15 and 18-20 s,
- 5 Pa and 0.01 m2/s, 10 layers: +9, +1, -9, -10 %, slope of the bed -1, -2, -10, -9 %; 24 layers: +8, +8, +6, +3 %,
  slope 0, +3, +3, +2 %;
- the same on 12 layers: +6, +1, 0, -6 %, slope 0, -1, +2, +1 %; over a bed that slips, where the flow is
  tau h / mu (z^2 / 2 h^2 - 1/6), the water of the uppermost fifth of 24 layers: +10, +6, +3, -1 %, of 10: +7, -13, -13,
  -23 %; slope of the bed over its tau / (rho g h) on 24 layers: +3, +2, +1, -1 %, on 10: +2, -5, -6, +5 %;
- 0.5 Pa and 0.001 m2/s, the same flow by the theory, 10 layers: +15, -49, -101, -115 %: it stops.
Particles without rows bear a shear of 0.5 to 1e-3 of the pressure that they are under, as a packing of grains does,
whatever flows: between 15 and 20 s, 10 layers, viscosity carries 0.2 to 0.6 Pa less than the theory's stress at any
height (sums over pairs), and what presses carries the rest. A divergence that has no error in a shear flow on any
disorder (-11 % for -12), and a bulk viscosity of 0.2 in place of 0.7 h c (-12 %) do not change it.
"""

from dataclasses import replace

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative
from ocean_sim.validation.shared.state import sampled
from ocean_sim.validation.shared.wind import blowing, stilled

LENGTH, DEPTH, VISCOSITY, STRESS = 1.0, 0.1, 1e-2, 5.0  # [m], [m], [m2/s], [Pa]
DENSITY, G = 1000.0, 9.81  # [kg/m3], [m/s2]
SLOPE = 1.5 * STRESS / (DENSITY * G * DEPTH)
DRIFT = STRESS * DEPTH / (4.0 * DENSITY * VISCOSITY)  # [m/s]
MIDDLE = 0.25  # [m] from the middle, where the flow is parallel
SOURCE = "laminar flow between bed and wind"
PROMISES = (
    Promise("slope of the pressure on the bed", "%", f"3 tau / (2 rho g h); {SOURCE}", {"delta_sph": 5.0}),
    Promise("slope of the surface", "%", f"3 tau / (2 rho g h); {SOURCE}"),
    Promise("drift at the surface [m/s]", "%", f"tau h / (4 mu); {SOURCE}", {"delta_sph": 10.0}),
    Promise("greatest return flow [m/s]", "%", f"tau h / (12 mu); {SOURCE}"),
    Promise("still air: slope of the pressure on the bed, over that under the wind", "%", "no wind, no slope"),
)


def problems(coarse: bool) -> list[Problem]:
    return [problem(10)] if coarse else [problem(10), problem(20, slow=True)]


def problem(layers: int, slow: bool = False) -> Problem:
    """The basin with so many particles over its depth."""
    scene = {
        "duration": 5.0,
        "basin": {"length": LENGTH, "depth": DEPTH, "floor": "no_slip"},
        "fluid": {"spacing": DEPTH / layers, "kinematic_viscosity": VISCOSITY},
        "wind": blowing(STRESS, ramp=1.0),
    }
    name = f"{layers} layers"
    promises = tuple(replace(promise, quantity=f"{name}: {promise.quantity}") for promise in PROMISES)
    return Problem(scene, promises, lambda simulation: measure(simulation, promises), name, slow)


def slopes(simulation: Simulation, begin: float, until: float) -> tuple[float, float, np.ndarray]:
    """Mean slopes of the pressure on the bed (over rho g) and of the surface, and (n, 3) x, height above the bed and
    u of the particles in the middle."""
    x = np.linspace(-MIDDLE, MIDDLE, 21)
    bed = np.stack([x, np.full_like(x, -DEPTH), np.zeros_like(x)], axis=1)
    pressure, height, flow = [], [], []
    for water in sampled(simulation, until, 0.1):
        if water.time >= begin:
            pressure.append(simulation.fluid.pressures(bed) / (DENSITY * G))
            height.append(simulation.fluid.elevations(bed[:, ::2]))
            here = np.abs(water.position[:, 0]) < MIDDLE
            flow.append(np.stack([water.position[here, 1] + DEPTH, water.velocity[here, 0]], axis=1))
    on_bed, on_top = (float(np.polyfit(x, np.mean(values, axis=0), 1)[0]) for values in (pressure, height))
    return on_bed, on_top, np.concatenate(flow)


def measure(simulation: Simulation, promises: tuple[Promise, ...]) -> Finding:
    """Means over the last fifth of the run, and a short look at the same water without wind."""
    until = simulation.scene.duration
    on_bed, on_top, flow = slopes(simulation, 0.8 * until, until)
    with stilled(simulation) as without:
        calm, _, _ = slopes(without, 0.1 * until, 0.2 * until)
    z, u = flow.T / np.array([[DEPTH], [DRIFT]])
    inside = z < 1.0 - simulation.scene.preflight.support / DEPTH
    # The bed holds the water: u = a z + b z^2.
    a, b = np.linalg.lstsq(np.stack([z, z * z], axis=1)[inside], u[inside], rcond=None)[0]
    numbers = (
        relative(on_bed, SLOPE),
        relative(on_top, SLOPE),
        relative((a + b) * DRIFT, DRIFT),
        relative(a * a / (4.0 * b) * DRIFT, DRIFT / 3.0),
        (calm, 0.0, 100.0 * calm / SLOPE),
    )
    edges = np.linspace(0.0, 1.0, 21)
    bins = np.digitize(z, edges)
    mean = np.array([u[bins == k].mean() if (bins == k).any() else np.nan for k in range(1, len(edges))])
    middle = 0.5 * (edges[1:] + edges[:-1])
    return Finding(
        {promise.quantity: number for promise, number in zip(promises, numbers, strict=True)},
        [Curve("mean flow", mean, middle, points=True)],
        [Curve("laminar", 3.0 * middle**2 - 2.0 * middle, middle)],
        ("u over tau h / (4 mu)", "z / h"),
    )
