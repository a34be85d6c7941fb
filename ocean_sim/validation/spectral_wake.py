"""A pressure that moves over calm open water: its wave resistance, and the wake that it leaves.

Havelock's integral (1932, Proc. R. Soc. A 138) for a Gaussian pressure of 2 kPa, 3 m along and 1.5 m across its track,
in deep water: R = k0^3 / (pi rho g) times the integral over 0..pi/2 of sec^5 t |p(k0 sec^2 t)|^2, k0 = g / U^2. Behind
it the crests across the track are 2 pi U^2 / g apart, and the waves stay within 19.47 degrees of it (Kelvin 1887); near
the pressure some energy lies beyond, in the zone where the waves die away as Airy's function, whatever the cells.
"""

import numpy as np

from ocean_sim.conventions import WATER_DENSITY
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative
from ocean_sim.validation.shared.sea import SCHEMES, G, image, risen, scene, sea_of

SPEEDS = (4.0, 5.0, 6.0)  # [m/s]
SIDE, CELLS, STEP = 128.0, 128, 0.2  # [m], cells, [s]
PRESSURE, LONG, BROAD = 2000.0, 3.0, 1.5  # [Pa], [m], [m]
RISE, END, JUDGED = 10.0, 120.0, 0.2  # [s], [s], the last part of it
CUSP = np.arcsin(1.0 / 3.0)
FREE = 0.35  # of the side, from the pressure to the rim


def problems(coarse: bool) -> list[Problem]:
    resistance = tuple(
        Promise(f"wave resistance at {u:g} m/s [N]", "%", "Havelock 1932", {"spectral_sea": 0.5}) for u in SPEEDS
    )
    length = Promise("distance of crests across the track [m]", "%", "2 pi U^2 / g", {"spectral_sea": 1.5})
    inside = Promise("wave energy outside the cusp angle", "%", "Kelvin 1887", {"spectral_sea": 5.0})

    def measure(simulation: Simulation) -> Finding:
        found = {}
        for u, promise in zip(SPEEDS, resistance):
            value, wake = towed(simulation, u)
            found[promise.quantity] = relative(value, havelock(u))
            if u == SPEEDS[0]:
                x, along, apart = crests(simulation, wake, u)
                found[length.quantity] = relative(apart, 2.0 * np.pi * u**2 / G)
                out = 100.0 * outside(simulation, wake, u)
                found[inside.quantity] = (out, 0.0, out)
                curve = Curve("on the track at 4 m/s", x, along)
        return Finding(found, [curve], [], ("behind the pressure [m]", "elevation [m]"))

    return [Problem(scene(SIDE, CELLS), (*resistance, length, inside), measure, schemes=SCHEMES, only=True)]


def havelock(u: float) -> float:
    """The resistance [N]."""
    t, k0 = np.linspace(0.0, np.pi / 2 - 1e-4, 200_001), G / u**2
    k = k0 / np.cos(t) ** 2
    spread = (k * np.cos(t) * LONG) ** 2 + (k * np.sin(t) * BROAD) ** 2
    pushed = np.pi * LONG * BROAD * PRESSURE * np.exp(-0.25 * spread)
    return float(k0**3 / (np.pi * WATER_DENSITY * G) * np.trapezoid(pushed**2 / np.cos(t) ** 5, t))


def towed(simulation: Simulation, u: float) -> tuple[float, np.ndarray]:
    """Mean resistance [N] of the steady state, and the elevation at its end (cells, rows) [m]."""
    from ocean_sim.fluid.open_sea.wave_tile import Layer

    tile = sea_of(simulation).tile
    layer, steps, found = Layer(tile), round(END / STEP), []
    for n in range(1, steps + 1):
        centre = np.array([u * n * STEP, 0.0])
        x, z = image(tile, centre)
        patch = PRESSURE * np.exp(-((x / LONG) ** 2) - (z / BROAD) ** 2)
        layer.advance(STEP, tile.to_modes(risen(n * STEP / RISE) * patch / WATER_DENSITY), centre)
        if n > (1.0 - JUDGED) * steps:
            slope = tile.to_values(tile.slopes(tile.to_modes(layer.eta))[0])
            found.append((patch * slope).sum() * tile.cell**2)
    return float(np.mean(found)), layer.eta


def crests(simulation: Simulation, eta: np.ndarray, u: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Places behind the pressure [m], the elevation on the track there [m], and the wavelength between its zeros
    [m]."""
    tile = sea_of(simulation).tile
    behind = np.arange(2.0 * np.pi * u**2 / G, FREE * SIDE, 0.01)
    points = np.stack([u * END - behind, np.zeros(len(behind))], axis=1)
    line = tile.interpolate(eta, points)
    k = np.flatnonzero(line[1:] * line[:-1] < 0.0)
    zeros = behind[k]
    return behind, line, 2.0 * float((zeros[-1] - zeros[0]) / (len(zeros) - 1))


def outside(simulation: Simulation, eta: np.ndarray, u: float) -> float:
    """Share of the wake's energy, from a wavelength behind the pressure on, that lies outside the cusp angle and that
    of a cell seen from there."""
    tile = sea_of(simulation).tile
    x, z = image(tile, np.array([u * END, 0.0]))
    length = 2.0 * np.pi * u**2 / G
    wake = (x < 0.0) & (np.hypot(x, z) > length) & (np.maximum(abs(x), abs(z)) < FREE * SIDE)
    beyond = np.arctan2(abs(z), -x) > CUSP + np.arctan(tile.cell / length)
    energy = eta**2 * wake
    return float(energy[beyond].sum() / energy.sum())
