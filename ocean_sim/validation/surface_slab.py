"""A slab of particles with a frozen wave on it: distance between a fitted surface and the water.

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
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, absolute_error, percent_error
from ocean_sim.validation.shared.state import particle_state, set_state

WAVELENGTH, AMPLITUDE, WAVE_COUNT = 2.0, 0.1, 2  # [m], [m], along the slab
DEPTH, WIDTH, RIGID_DEPTH = 1.2, 0.8, 0.6  # [m]; the upper RIGID_DEPTH moves as a whole
K = 2.0 * pi / WAVELENGTH  # [1/m]
FRAME_INTERVAL, SETTLING_FRAMES = 1.0 / 60.0, 30  # [s], frames
POLY6_RADIUS, NODE_SPACING = 2.0, {"cloth": 1.0, "marching_cubes": 0.5}  # [spacings], defaults of both kinds
HIGHER_ORDER_ALLOWANCE = 3.0  # [%] beyond the leading order
SOURCE_TEXT = "exact surface of a sheared lattice; lost by smoothing (k R)^2 / 20 + (k d)^2 / 12"
LEVEL_SOURCE = "mean offset below a tenth of a spacing, as for a ball of particles drawn by pysplashsurf 0.14.1"


def problems(coarse: bool) -> list[Problem]:
    spacing = 0.2 if coarse else 0.1
    scene = {
        "duration": FRAME_INTERVAL,
        "basin": {"length": WAVE_COUNT * WAVELENGTH, "width": WIDTH, "depth": DEPTH, "walls": {"x": "periodic"}},
        "fluid": {"kind": "delta_sph", "spacing": spacing},
        "surface": {},
    }
    lost = {kind: 100.0 * smoothing_loss(spacing, apart * spacing) for kind, apart in NODE_SPACING.items()}
    lost = {kind: share + HIGHER_ORDER_ALLOWANCE for kind, share in lost.items()}
    promises = (
        Promise("height of the wave [m]", "%", SOURCE_TEXT, lost),
        Promise("mean level [spacings]", "spacings", LEVEL_SOURCE, dict.fromkeys(NODE_SPACING, 0.1)),
        Promise("rms distance from the water [spacings]", "spacings", SOURCE_TEXT),
    )
    return [Problem(scene, promises, measure, slot="surface", schemes=tuple(NODE_SPACING))]


def smoothing_loss(spacing: float, apart: float) -> float:
    """Share of a wave's height that smoothing takes, for a spacing of particles and of mesh nodes (`apart`) [m]."""
    return (K * POLY6_RADIUS * spacing) ** 2 / 20.0 + (K * apart) ** 2 / 12.0


def wave_positions(position: np.ndarray) -> np.ndarray:
    """Positions (n, 3) [m] of particles, sheared vertically so that their surface is the wave a cos k x."""
    moved = position.copy()
    share = np.clip((position[:, 1] + DEPTH) / (DEPTH - RIGID_DEPTH), 0.0, 1.0)
    moved[:, 1] += share * AMPLITUDE * np.cos(K * position[:, 0])
    return moved


def measure(simulation: Simulation) -> Finding:
    """Shear the slab of particles into a wave, let the fitted surface settle, and compare both along the middle."""
    start = particle_state(simulation).position
    set_state(simulation, wave_positions(start), np.zeros_like(start))
    surface: Any = simulation.surface
    particles = with_particles(simulation.fluid).particles
    for _ in range(SETTLING_FRAMES):
        surface.follow(particles, FRAME_INTERVAL)
    half = 0.5 * WAVE_COUNT * WAVELENGTH
    x = np.linspace(-half, half, 2001)[:-1]
    wave, shown = np.cos(K * x), surface.elevations(np.stack([x, np.full_like(x, 0.03)], axis=1))
    spacing = particles.spacing
    apart = float(np.sqrt(np.mean((shown - AMPLITUDE * wave) ** 2))) / spacing
    height = percent_error(4.0 * float(np.mean(shown * wave)), 2.0 * AMPLITUDE)
    numbers = (height, absolute_error(float(shown.mean()) / spacing), absolute_error(apart))
    expected = [Curve("water", x, AMPLITUDE * wave)]
    return Finding(numbers, [Curve("surface", x, shown)], expected, ("x [m]", "elevation [m]"))
