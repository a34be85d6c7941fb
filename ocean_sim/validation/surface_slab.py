"""A slab of particles with a frozen wave on it: how well a surface fits the water.

Columns of the lattice are moved up and down by a cos k x, as in a shear, so that the water near its surface keeps its
density and has that surface exactly; further down the shift fades away towards the bed. A surface smooths: poly6 of
radius R takes (k R)^2 / 20 of a wave's height, and straight lines between nodes d apart take (k d)^2 / 12 (both to the
leading order, from the second moments of the two weights).
"""

from math import pi
from typing import Any

import numpy as np

from ocean_sim.fluid import with_particles
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative
from ocean_sim.validation.shared.state import set_state, state

WAVELENGTH, AMPLITUDE, WAVES = 2.0, 0.1, 2  # [m], [m], along the slab
DEPTH, WIDTH, WHOLE = 1.2, 0.8, 0.6  # [m]; the upper WHOLE moves as a whole
K = 2.0 * pi / WAVELENGTH  # [1/m]
FRAME, SETTLING = 1.0 / 60.0, 30  # [s], frames
RADIUS, APART = 2.0, {"cloth": 1.0, "marching_cubes": 0.5}  # [spacings] of both kinds, as they come
SLACK = 3.0  # [%] for what the leading order leaves out
SOURCE = "exact surface of a sheared lattice; lost by smoothing (k R)^2 / 20 + (k d)^2 / 12"
ABOUT = "mean offset below a tenth of a spacing, as for a ball of particles drawn by pysplashsurf 0.14.1"


def problems(coarse: bool) -> list[Problem]:
    spacing = 0.2 if coarse else 0.1
    scene = {
        "duration": FRAME,
        "basin": {"length": WAVES * WAVELENGTH, "width": WIDTH, "depth": DEPTH, "walls": {"x": "periodic"}},
        "fluid": {"kind": "delta_sph", "spacing": spacing},
        "surface": {},
    }
    lost = {kind: 100.0 * smoothed(spacing, apart * spacing) + SLACK for kind, apart in APART.items()}
    promises = (
        Promise("height of the wave [m]", "%", SOURCE, lost),
        Promise("mean level [spacings]", "spacings", ABOUT, dict.fromkeys(APART, 0.1)),
        Promise("rms distance from the water [spacings]", "spacings", SOURCE),
    )
    return [
        Problem(
            scene,
            promises,
            lambda simulation: measure(simulation, promises),
            slot="surface",
            schemes=tuple(APART),
        )
    ]


def smoothed(spacing: float, apart: float) -> float:
    """Share of a wave's height that is lost over particles `spacing` apart to nodes `apart` [m]."""
    return (K * RADIUS * spacing) ** 2 / 20.0 + (K * apart) ** 2 / 12.0


def wavy(position: np.ndarray) -> np.ndarray:
    """The particles with the wave on them."""
    moved = position.copy()
    share = np.clip((position[:, 1] + DEPTH) / (DEPTH - WHOLE), 0.0, 1.0)
    moved[:, 1] += share * AMPLITUDE * np.cos(K * position[:, 0])
    return moved


def measure(simulation: Simulation, promises: tuple[Promise, ...]) -> Finding:
    """The surface along the middle of the slab, when it has had time to settle on it."""
    start = state(simulation).position
    set_state(simulation, wavy(start), np.zeros_like(start))
    surface: Any = simulation.surface
    particles = with_particles(simulation.fluid).particles
    for _ in range(SETTLING):
        surface.follow(particles, FRAME)
    half = 0.5 * WAVES * WAVELENGTH
    x = np.linspace(-half, half, 2001)[:-1]
    wave, shown = np.cos(K * x), surface.elevations(np.stack([x, np.full_like(x, 0.03)], axis=1))
    spacing = particles.spacing
    offset = float(shown.mean()) / spacing
    apart = float(np.sqrt(np.mean((shown - AMPLITUDE * wave) ** 2))) / spacing
    numbers = (
        relative(4.0 * float(np.mean(shown * wave)), 2.0 * AMPLITUDE),
        (offset, 0.0, offset),
        (apart, 0.0, apart),
    )
    return Finding(
        {promise.quantity: number for promise, number in zip(promises, numbers, strict=True)},
        [Curve("surface", x, shown)],
        [Curve("water", x, AMPLITUDE * wave)],
        ("x [m]", "elevation [m]"),
    )
