"""A pressure that moves over calm open water: its wave resistance and its wake.

Havelock's integral (1932, Proc. R. Soc. A 138) for a Gaussian pressure of 2 kPa, 3 m along and 1.5 m across its track,
in deep water: R = k0^3 / (pi rho g) times the integral over 0..pi/2 of sec^5 t |p(k0 sec^2 t)|^2, k0 = g / U^2. Behind
it the crests across the track are 2 pi U^2 / g apart, and the waves stay within 19.47 degrees of it (Kelvin 1887); near
the pressure some energy lies beyond, in the zone in which the waves decay as Airy's function, at any resolution.
"""

import numpy as np

from ocean_sim.conventions import GRAVITY, WATER_DENSITY
from ocean_sim.fluid.open_sea.wave_tile import Layer
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, absolute_error, percent_error
from ocean_sim.validation.shared.sea import SPECTRAL_SCHEMES, nearest_image, sea_of, smooth_ramp, tile_scene

TOWING_SPEEDS = (4.0, 5.0, 6.0)  # [m/s]
TILE_SIDE, TILE_CELLS, TIME_STEP = 128.0, 128, 0.2  # [m], cells, [s]
PRESSURE_PEAK, WIDTH_ALONG, WIDTH_ACROSS = 2000.0, 3.0, 1.5  # [Pa], [m], [m]
RAMP_TIME, END_TIME, JUDGED_SHARE = 10.0, 120.0, 0.2  # [s], [s], share of the run at its end
CUSP_ANGLE = np.arcsin(1.0 / 3.0)
FREE_SHARE = 0.35  # of the side, from the pressure to the rim


def problems(coarse: bool) -> list[Problem]:
    resistance = tuple(
        Promise(f"wave resistance at {u:g} m/s [N]", "%", "Havelock 1932", {"spectral_sea": 0.5}) for u in TOWING_SPEEDS
    )
    length = Promise("distance of crests across the track [m]", "%", "2 pi U^2 / g", {"spectral_sea": 1.5})
    inside = Promise("wave energy outside the cusp angle", "%", "Kelvin 1887", {"spectral_sea": 5.0})

    def measure(simulation: Simulation) -> Finding:
        numbers, wakes = [], []
        for u in TOWING_SPEEDS:
            value, wake = tow_pressure(simulation, u)
            numbers.append(percent_error(value, havelock_resistance(u)))
            wakes.append(wake)
        u = TOWING_SPEEDS[0]
        x, along, apart = track_crests(simulation, wakes[0], u)
        outside = 100.0 * energy_outside_cusp(simulation, wakes[0], u)
        numbers += [percent_error(apart, 2.0 * np.pi * u**2 / GRAVITY), absolute_error(outside)]
        curve = Curve("on the track at 4 m/s", x, along)
        return Finding(numbers, [curve], [], ("behind the pressure [m]", "elevation [m]"))

    promises = (*resistance, length, inside)
    return [Problem(tile_scene(TILE_SIDE, TILE_CELLS), promises, measure, schemes=SPECTRAL_SCHEMES)]


def havelock_resistance(u: float) -> float:
    """Wave resistance [N] of the pressure at a speed `u` [m/s], by Havelock's integral."""
    t, k0 = np.linspace(0.0, np.pi / 2 - 1e-4, 200_001), GRAVITY / u**2
    k = k0 / np.cos(t) ** 2
    spread = (k * np.cos(t) * WIDTH_ALONG) ** 2 + (k * np.sin(t) * WIDTH_ACROSS) ** 2
    pushed = np.pi * WIDTH_ALONG * WIDTH_ACROSS * PRESSURE_PEAK * np.exp(-0.25 * spread)
    return float(k0**3 / (np.pi * WATER_DENSITY * GRAVITY) * np.trapezoid(pushed**2 / np.cos(t) ** 5, t))


def tow_pressure(simulation: Simulation, u: float) -> tuple[float, np.ndarray]:
    """Tow the pressure at a speed `u` [m/s]: mean steady resistance [N], and elevation (cells, rows) [m] at the end."""
    tile = sea_of(simulation).tile
    layer, steps, found = Layer(tile), round(END_TIME / TIME_STEP), []
    for n in range(1, steps + 1):
        centre = np.array([u * n * TIME_STEP, 0.0])
        x, z = nearest_image(tile, centre)
        patch = PRESSURE_PEAK * np.exp(-((x / WIDTH_ALONG) ** 2) - (z / WIDTH_ACROSS) ** 2)
        layer.advance(TIME_STEP, tile.to_modes(smooth_ramp(n * TIME_STEP / RAMP_TIME) * patch / WATER_DENSITY), centre)
        if n > (1.0 - JUDGED_SHARE) * steps:
            slope = tile.to_values(tile.slopes(tile.to_modes(layer.eta))[0])
            found.append((patch * slope).sum() * tile.cell**2)
    return float(np.mean(found)), layer.eta


def track_crests(simulation: Simulation, eta: np.ndarray, u: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Elevations on the track behind a pressure of speed `u` [m/s], and their wavelength, from elevations `eta` (cells,
    rows) [m]: distances behind it (n,) [m], elevations there (n,) [m], and wavelength [m]."""
    tile = sea_of(simulation).tile
    behind = np.arange(2.0 * np.pi * u**2 / GRAVITY, FREE_SHARE * TILE_SIDE, 0.01)
    line = tile.interpolate(eta, np.stack([u * END_TIME - behind, np.zeros(len(behind))], axis=1))
    zeros = behind[np.flatnonzero(line[1:] * line[:-1] < 0.0)]
    return behind, line, 2.0 * float((zeros[-1] - zeros[0]) / (len(zeros) - 1))


def energy_outside_cusp(simulation: Simulation, eta: np.ndarray, u: float) -> float:
    """Share of a wake's energy outside Kelvin's cusp angle; `eta`: elevations (cells, rows) [m]; speed `u` [m/s]."""
    tile = sea_of(simulation).tile
    x, z = nearest_image(tile, np.array([u * END_TIME, 0.0]))
    length = 2.0 * np.pi * u**2 / GRAVITY
    wake = (x < 0.0) & (np.hypot(x, z) > length) & (np.maximum(abs(x), abs(z)) < FREE_SHARE * TILE_SIDE)
    beyond = np.arctan2(abs(z), -x) > CUSP_ANGLE + np.arctan(tile.cell / length)
    energy = eta**2 * wake
    return float(energy[beyond].sum() / energy.sum())
