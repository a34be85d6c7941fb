"""A square of water that spins in free space: all its pressure is negative, and it must not tear.

Colagrossi (2005, thesis, University of Rome La Sapienza): side L, v = w (y, -x), no gravity, no walls; in the centre
p = -0.14734 rho w^2 L^2 at first. A scheme that clamps pressure at zero cannot hold it together.
"""

from math import sqrt

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise
from ocean_sim.validation.shared.state import State, sampled, set_state, state

SIDE, SPIN, END = 1.0, 1.0, 2.0  # L [m], w [1/s], w t
CORE = 0.25  # [L] radius around the centre in which voids are sought
LARGEST = 2.0  # [spacings] a lattice has voids of 1.41
SOURCE = "Colagrossi 2005"
PROMISES = (
    Promise("w t at the first void beyond 2 spacings", "1", f"none to w t = 2; {SOURCE}", {"delta_sph": 0.0}),
    Promise("largest void [spacings]", "spacings", f"none beyond 2; {SOURCE}"),
    Promise("angular momentum over its first", "%", "kept, where nothing acts from outside"),
    Promise("kinetic energy over its first", "%", "nearly kept"),
)


def problems(coarse: bool) -> list[Problem]:
    scene = {
        "duration": END / SPIN,
        "basin": {
            "length": 6.0 * SIDE,
            "depth": 3.0 * SIDE,
            "gravity": [0.0, 0.0, 0.0],
            "walls": "none",
            "floor": "none",
        },
        "fluid": {
            "spacing": SIDE / (25 if coarse else 80),
            "reference_speed": SPIN * SIDE,
            "fill": [{"min": [-SIDE / 2, -SIDE / 2], "max": [SIDE / 2, SIDE / 2]}],
        },
    }
    return [Problem(scene, PROMISES, measure)]


def measure(simulation: Simulation) -> Finding:
    """Set the patch spinning, and measure its voids."""
    start = state(simulation).position
    velocity = SPIN * np.stack([start[:, 1], -start[:, 0], 0.0 * start[:, 0]], axis=1)
    set_state(simulation, start, velocity, simulation.fluid.rest_density * SPIN**2 * first_pressure(start))
    return compared(list(sampled(simulation, END / SPIN, END / SPIN / 40)))


def first_pressure(position: np.ndarray) -> np.ndarray:
    """Pressure at the start over rho w^2 [m2]: the solution of laplacian p = 2 rho w^2 that vanishes on the sides."""
    odd = np.arange(1, 80, 2)
    x, y = (np.sin(np.pi * np.outer(position[:, k] / SIDE + 0.5, odd)) for k in (0, 1))
    m, n = np.meshgrid(odd, odd, indexing="ij")
    return np.einsum("im,mn,in->i", x, -32.0 * SIDE**2 / (np.pi**4 * m * n * (m**2 + n**2)), y)


def void(water: State) -> float:
    """Diameter of the largest empty circle around the centre of the patch [spacings]."""
    from scipy.spatial import cKDTree

    middle = water.position.mean(axis=0)
    ticks = np.arange(-CORE * SIDE, CORE * SIDE, 0.25 * water.spacing)
    x, y = (values.ravel() for values in np.meshgrid(ticks, ticks))
    inside = x**2 + y**2 < (CORE * SIDE) ** 2
    probes = np.stack([x[inside] + middle[0], y[inside] + middle[1]], axis=1)
    nearest, _ = cKDTree(water.position[:, :2]).query(probes)
    return 2.0 * float(nearest.max()) / water.spacing


def compared(patches: list[State]) -> Finding:
    """A patch at several moments: when it tears, and what it keeps."""
    times = np.array([SPIN * patch.time for patch in patches])
    voids = np.array([void(patch) for patch in patches])
    torn = np.flatnonzero(voids > LARGEST)
    first = float(times[torn[0]]) if torn.size else END
    spin = 100.0 * (patches[-1].angular_momentum / patches[0].angular_momentum - 1.0)
    energy = 100.0 * (patches[-1].kinetic_energy / patches[0].kinetic_energy - 1.0)
    numbers = (
        (first, END, first - END),
        (float(voids.max()), sqrt(2.0), float(voids.max()) - sqrt(2.0)),
        (1.0 + spin / 100.0, 1.0, spin),
        (1.0 + energy / 100.0, 1.0, energy),
    )
    return Finding(
        {promise.quantity: number for promise, number in zip(PROMISES, numbers, strict=True)},
        [Curve("largest void", times, voids)],
        [Curve("tears", np.array([0.0, END]), np.array([LARGEST, LARGEST]))],
        ("w t", "void [spacings]"),
    )
