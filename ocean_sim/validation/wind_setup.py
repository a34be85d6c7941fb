"""Set-up: a steady wind on a closed, shallow, laminar basin piles the water up at the lee end, and drives a surface
drift with a return flow below.

Far from the ends, over a bed without slip, u = tau / mu (3 z^2 / 4h - z / 2) at the height z above the bed: at the
surface tau h / (4 mu), at most tau h / (12 mu) the other way at z = h/3; the surface slopes by 3 tau / (2 rho g h). The
slope is read from the pressure on the bed. The drift is that of the parabola through the water below a support
from the surface, as the wind acts on particles that lie half a spacing and more below it.

The case ends after 5 s, while the particles still lie in rows. Particles without rows bear a shear of 5e-4 to 0.5 of
their pressure, as a packing of grains does, so that the drift then depends on the stress over the pressure.
"""

from dataclasses import replace

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, percent_error
from ocean_sim.validation.shared.state import sampled_states
from ocean_sim.validation.wind_stress import wind_keys, without_wind

LENGTH, DEPTH, VISCOSITY, STRESS = 1.0, 0.1, 1e-2, 5.0  # [m], [m], [m2/s], [Pa]
DENSITY, G = 1000.0, 9.81  # [kg/m3], [m/s2]
SURFACE_SLOPE = 1.5 * STRESS / (DENSITY * G * DEPTH)
SURFACE_DRIFT = STRESS * DEPTH / (4.0 * DENSITY * VISCOSITY)  # [m/s]
PARALLEL_HALF_LENGTH = 0.25  # [m] from the middle, where the flow is parallel
SOURCE_TEXT = "laminar flow between bed and wind"
PROMISES = (
    Promise("slope of the pressure on the bed", "%", f"3 tau / (2 rho g h); {SOURCE_TEXT}", {"delta_sph": 5.0}),
    Promise("slope of the surface", "%", f"3 tau / (2 rho g h); {SOURCE_TEXT}"),
    Promise("drift at the surface [m/s]", "%", f"tau h / (4 mu); {SOURCE_TEXT}", {"delta_sph": 10.0}),
    Promise("greatest return flow [m/s]", "%", f"tau h / (12 mu); {SOURCE_TEXT}"),
    Promise("still air: slope of the pressure on the bed, over that under the wind", "%", "no wind, no slope"),
)


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: the basin with 10 layers of particles and, unless coarse, with 20 (slow)."""
    return [basin_problem(10)] if coarse else [basin_problem(10), basin_problem(20, slow=True)]


def basin_problem(layers: int, slow: bool = False) -> Problem:
    """Set-up of the basin with a number of layers of particles over its depth; `slow`: True if it takes minutes."""
    scene = {
        "duration": 5.0,
        "basin": {"length": LENGTH, "depth": DEPTH, "floor": "no_slip"},
        "fluid": {"spacing": DEPTH / layers, "kinematic_viscosity": VISCOSITY},
        "wind": wind_keys(STRESS, ramp=1.0),
    }
    name = f"{layers} layers"
    promises = tuple(replace(promise, quantity=f"{name}: {promise.quantity}") for promise in PROMISES)
    return Problem(scene, promises, measure, name, slow)


def mean_slopes(simulation: Simulation, begin: float, until: float) -> tuple[float, float, np.ndarray]:
    """Run to `until` [s], and average from `begin` [s] on: slope of bed pressure / (rho g), slope of the surface, and
    rows (n, 2) of height over the bed [m] and speed [m/s] of particles in the middle."""
    x = np.linspace(-PARALLEL_HALF_LENGTH, PARALLEL_HALF_LENGTH, 21)
    bed = np.stack([x, np.full_like(x, -DEPTH), np.zeros_like(x)], axis=1)
    pressure, height, flow = [], [], []
    for water in sampled_states(simulation, until, 0.1):
        if water.time >= begin:
            pressure.append(simulation.fluid.pressures(bed) / (DENSITY * G))
            height.append(simulation.fluid.elevations(bed[:, ::2]))
            here = np.abs(water.position[:, 0]) < PARALLEL_HALF_LENGTH
            flow.append(np.stack([water.position[here, 1] + DEPTH, water.velocity[here, 0]], axis=1))
    on_bed, on_top = (float(np.polyfit(x, np.mean(values, axis=0), 1)[0]) for values in (pressure, height))
    return on_bed, on_top, np.concatenate(flow)


def measure(simulation: Simulation) -> Finding:
    """Run with and without wind, and compare slopes and surface drift over the last fifth with laminar flow."""
    until = simulation.scene.duration
    on_bed, on_top, flow = mean_slopes(simulation, 0.8 * until, until)
    with without_wind(simulation) as without:
        calm, _, _ = mean_slopes(without, 0.1 * until, 0.2 * until)
    z, u = flow.T / np.array([[DEPTH], [SURFACE_DRIFT]])
    inside = z < 1.0 - simulation.scene.preflight.support / DEPTH
    # The bed holds the water: u = a z + b z^2.
    a, b = np.linalg.lstsq(np.stack([z, z * z], axis=1)[inside], u[inside], rcond=None)[0]
    numbers = (
        percent_error(on_bed, SURFACE_SLOPE),
        percent_error(on_top, SURFACE_SLOPE),
        percent_error((a + b) * SURFACE_DRIFT, SURFACE_DRIFT),
        percent_error(a * a / (4.0 * b) * SURFACE_DRIFT, SURFACE_DRIFT / 3.0),
        (calm, 0.0, 100.0 * calm / SURFACE_SLOPE),
    )
    edges = np.linspace(0.0, 1.0, 21)
    bins = np.digitize(z, edges)
    mean = np.array([u[bins == k].mean() if (bins == k).any() else np.nan for k in range(1, len(edges))])
    middle = 0.5 * (edges[1:] + edges[:-1])
    measured = [Curve("mean flow", mean, middle, points=True)]
    expected = [Curve("laminar", 3.0 * middle**2 - 2.0 * middle, middle)]
    return Finding(numbers, measured, expected, ("u over tau h / (4 mu)", "z / h"))
