"""A square of water that spins in free space: all its pressure is negative, yet it must not tear.

Colagrossi (2005, thesis, University of Rome La Sapienza): side L, v = w (y, -x), no gravity, no walls; in the centre
p = -0.14734 rho w^2 L^2 at first. A scheme that clamps pressure at zero cannot hold it together.
"""

from math import sqrt

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, absolute_error, free_space
from ocean_sim.validation.shared.state import State, particle_state, sampled_states, set_state

SIDE, SPIN_RATE, END_TIME = 1.0, 1.0, 2.0  # L [m], w [1/s], w t
CORE_RADIUS = 0.25  # [L] around the centre, searched for voids
MAX_VOID = 2.0  # [spacings]; a lattice has voids of 1.41
SOURCE_TEXT = "Colagrossi 2005"
PROMISES = (
    Promise("w t at the first void beyond 2 spacings", "1", f"none to w t = 2; {SOURCE_TEXT}", {"delta_sph": 0.0}),
    Promise("largest void [spacings]", "spacings", f"none beyond 2; {SOURCE_TEXT}"),
    Promise("angular momentum over its first", "%", "kept, where nothing acts from outside"),
    Promise("kinetic energy over its first", "%", "nearly kept"),
)


def problems(coarse: bool) -> list[Problem]:
    fill = [{"min": [-SIDE / 2, -SIDE / 2], "max": [SIDE / 2, SIDE / 2]}]
    scene = {
        "duration": END_TIME / SPIN_RATE,
        "basin": free_space(6.0 * SIDE, 3.0 * SIDE),
        "fluid": {"spacing": SIDE / (25 if coarse else 80), "reference_speed": SPIN_RATE * SIDE, "fill": fill},
    }
    return [Problem(scene, PROMISES, measure)]


def measure(simulation: Simulation) -> Finding:
    """Set the patch spinning, run, and measure voids, angular momentum and kinetic energy."""
    start = particle_state(simulation).position
    velocity = SPIN_RATE * np.stack([start[:, 1], -start[:, 0], 0.0 * start[:, 0]], axis=1)
    set_state(simulation, start, velocity, simulation.fluid.rest_density * SPIN_RATE**2 * initial_pressure(start))
    return compare_patches(list(sampled_states(simulation, END_TIME / SPIN_RATE, END_TIME / SPIN_RATE / 40)))


def initial_pressure(position: np.ndarray) -> np.ndarray:
    """Initial pressure (n,) over rho w^2 [m2] at positions (n, 3) [m]: laplacian p = 2 rho w^2, zero on the sides."""
    odd = np.arange(1, 80, 2)
    x, y = (np.sin(np.pi * np.outer(position[:, k] / SIDE + 0.5, odd)) for k in (0, 1))
    m, n = np.meshgrid(odd, odd, indexing="ij")
    return np.einsum("im,mn,in->i", x, -32.0 * SIDE**2 / (np.pi**4 * m * n * (m**2 + n**2)), y)


def void_diameter(water: State) -> float:
    """Diameter [spacings] of the largest circle without particles near the centre of the patch."""
    from scipy.spatial import cKDTree

    middle = water.position.mean(axis=0)
    ticks = np.arange(-CORE_RADIUS * SIDE, CORE_RADIUS * SIDE, 0.25 * water.spacing)
    x, y = (values.ravel() for values in np.meshgrid(ticks, ticks))
    inside = x**2 + y**2 < (CORE_RADIUS * SIDE) ** 2
    probes = np.stack([x[inside] + middle[0], y[inside] + middle[1]], axis=1)
    nearest, _ = cKDTree(water.position[:, :2]).query(probes)
    return 2.0 * float(nearest.max()) / water.spacing


def compare_patches(patches: list[State]) -> Finding:
    """Compare states of a patch at successive times: first tear, largest void, and conserved quantities."""
    times = np.array([SPIN_RATE * patch.time for patch in patches])
    voids = np.array([void_diameter(patch) for patch in patches])
    torn = np.flatnonzero(voids > MAX_VOID)
    spin = 100.0 * (patches[-1].angular_momentum / patches[0].angular_momentum - 1.0)
    energy = 100.0 * (patches[-1].kinetic_energy / patches[0].kinetic_energy - 1.0)
    numbers = (
        absolute_error(float(times[torn[0]]) if torn.size else END_TIME, END_TIME),
        absolute_error(float(voids.max()), sqrt(2.0)),
        (1.0 + spin / 100.0, 1.0, spin),
        (1.0 + energy / 100.0, 1.0, energy),
    )
    expected = [Curve("tears", np.array([0.0, END_TIME]), np.array([MAX_VOID, MAX_VOID]))]
    return Finding(numbers, [Curve("largest void", times, voids)], expected, ("w t", "void [spacings]"))
