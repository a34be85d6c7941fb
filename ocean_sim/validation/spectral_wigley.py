"""Wigley's hull under way on calm, deep water: cuts through her waves, and their resistance, by thin-ship theory.

A thin hull with half its breadth y(x, d) at a depth d makes the waves of sources on its middle plane (Michell 1898,
Phil. Mag. 45). With F(k, t) the integral of 2 y exp(-k d - i k x cos t) over that plane, k = k0 sec^2 t, k0 = g / U^2,
the waves that follow her are eta = g / (pi U^2) times the integral of k sec^2 t F sin(k (x cos t + z sin t)) over the
directions t in -pi/2..pi/2 in which they go astern, and their resistance is rho g k0^3 / pi times that of sec^5 t F^2
over t in 0..pi/2. Waves that stay with the hull are left out: the cuts begin half a length behind her.
"""

import numpy as np

from ocean_sim.conventions import GRAVITY, WATER_DENSITY
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, percent_error
from ocean_sim.validation.shared.sea import SPECTRAL_SCHEMES, sea_of, tile_scene
from ocean_sim.validation.shared.ship import UPRIGHT, floating_ship, set_pose

LENGTH, BREADTH, DRAUGHT, HEIGHT = 10.0, 1.0, 0.625, 1.0  # [m]
BLOCK_COEFFICIENT = 4.0 / 9.0
SHIP = {
    "kind": "hydrostatic",
    "hull": {
        "shape": {"kind": "wigley", "length": LENGTH, "breadth": BREADTH, "draught": DRAUGHT, "height": HEIGHT},
        "mass": BLOCK_COEFFICIENT * LENGTH * BREADTH * DRAUGHT * WATER_DENSITY,
        "centre_of_mass": [0.0, DRAUGHT, 0.0],
    },
}
CUTS, CUT_START, CUT_END, CUT_POINTS = (2.5, 5.0), 10.0, 15.0, 240  # [m] abeam; astern of amidships
TILE_SIDE, TIME_STEP, RAMP_TIME, END_TIME = 48.0, 0.1, 8.0, 40.0  # [m], [s]
JUDGED_SHARE = 0.25  # of the run, at its end
ANGLE_NODES, LAST_ANGLE = 40_001, 0.5 * np.pi - 1e-3  # of the integrals


def problems(coarse: bool) -> list[Problem]:
    return [wave_problem(0.4, 256)] if coarse else [wave_problem(froude, 512) for froude in (0.25, 0.316, 0.4)]


def wave_problem(froude: float, cells: int) -> Problem:
    """Set-up of the hull at a Froude number `froude`, on a tile of `cells` grid cells along a side."""
    name = f"Fn {froude:g}"
    heights = tuple(
        Promise(f"{name}: rms of the cut {z:g} m abeam [m]", "%", "thin ship", {"spectral_sea": 10.0}) for z in CUTS
    )
    resistance = Promise(f"{name}: wave resistance [N]", "%", "Michell 1898", {"spectral_sea": 10.0})

    def measure(simulation: Simulation) -> Finding:
        u = froude * float(np.sqrt(GRAVITY * LENGTH))
        astern = np.linspace(CUT_START, CUT_END, CUT_POINTS)
        felt, cuts = tow_hull(simulation, u, astern)
        thin = [np.array([elevation_behind(x, z, u) for x in -astern]) for z in CUTS]
        numbers = [percent_error(float(np.std(cut)), float(np.std(known))) for cut, known in zip(cuts, thin)]
        measured, expected = (
            [Curve(f"{z:g} m abeam{what}", astern, cut) for z, cut in zip(CUTS, some)]
            for what, some in (("", cuts), (", thin ship", thin))
        )
        found = [*numbers, percent_error(felt, michell_resistance(u))]
        return Finding(found, measured, expected, ("astern of amidships [m]", "elevation [m]"))

    keys = tile_scene(TILE_SIDE, cells, step=TIME_STEP)
    scene = keys | {"ship": SHIP, "time_step": {"kind": "fixed", "dt": TIME_STEP}}
    return Problem(scene, (*heights, resistance), measure, name, schemes=SPECTRAL_SCHEMES)


def tow_hull(simulation: Simulation, u: float, astern: np.ndarray) -> tuple[float, list[np.ndarray]]:
    """Tow the hull at a speed `u` [m/s]: mean wave resistance [N], and for each of CUTS the elevations (n,) [m] at the
    end, at distances `astern` (n,) [m] of amidships."""
    rest = float(floating_ship(simulation).body.position[1])
    water, resistance, z = sea_of(simulation), [], 0.0
    while simulation.time < END_TIME - 0.5 * TIME_STEP:
        set_pose(simulation, position=np.array([0.0, rest, z]), orientation=UPRIGHT)
        simulation.step()
        (made,), tile = water.made, water.tile
        if simulation.time > (1.0 - JUDGED_SHARE) * END_TIME:
            slope = tile.to_values(tile.slopes(tile.to_modes(made.layer.eta))[1])
            push = tile.to_values(made.layer.pressure) * slope
            resistance.append(WATER_DENSITY * float(push.sum()) * tile.cell**2)
        reached, z = z, z + u * TIME_STEP * min(1.0, simulation.time / RAMP_TIME)
    cuts = [np.stack([np.full(astern.size, abeam), reached - astern], axis=1) for abeam in CUTS]
    return float(np.mean(resistance)), [made.elevation(cut, made.time) for cut in cuts]


def wave_source(t: np.ndarray, u: float) -> tuple[np.ndarray, np.ndarray]:
    """Wavenumbers k [rad/m] and source strengths F [m3], in closed form, of the waves that a hull at a speed `u` [m/s]
    sends in directions `t` (n,) [rad] from its track; both (n,)."""
    k = GRAVITY / (u * np.cos(t)) ** 2
    half, down = 0.5 * LENGTH * k * np.cos(t), k * DRAUGHT
    along = 2.0 * LENGTH * (np.sin(half) - half * np.cos(half)) / half**3
    below = DRAUGHT / down * (1.0 - 2.0 / down**2 + np.exp(-down) * (2.0 / down + 2.0 / down**2))
    return k, BREADTH * along * below


def michell_resistance(u: float) -> float:
    """Wave resistance [N] of the thin hull at a speed `u` [m/s]."""
    t = np.linspace(0.0, LAST_ANGLE, ANGLE_NODES)
    _, source = wave_source(t, u)
    return float(WATER_DENSITY * GRAVITY**4 / (np.pi * u**6) * np.trapezoid(source**2 / np.cos(t) ** 5, t))


def elevation_behind(x: float, z: float, u: float) -> float:
    """Elevation [m] of the thin hull's wake at speed `u` [m/s], `x` ahead of amidships (< 0), `z` abeam [m]."""
    t = np.linspace(-LAST_ANGLE, np.arctan2(-x, z), ANGLE_NODES)
    k, source = wave_source(t, u)
    wave = k * source * np.sin(k * (x * np.cos(t) + z * np.sin(t))) / np.cos(t) ** 2
    return float(GRAVITY / (np.pi * u**2) * np.trapezoid(wave, t))
