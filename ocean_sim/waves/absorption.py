"""Reflection of a linear wave by a zone of damped water before a wall, and the best rate of the damping.

In the zone dv/dt = -grad p / rho + g - r s^q v with q = DAMPING_POWER, where s grows from 0 at the edge of the zone to
1 at the reflecting wall behind it. A wave of frequency omega is p exp(-i omega t), with

    div(grad p / (r s^q - i omega)) = 0,   dp/dy = omega (omega + i r s^q) / g p on the still surface,

and no flow through bed and wall. The zone is cut into layers of equal damping; across a layer p is a sum of modes, each
an exponential along the zone times a profile over the depth (for r = 0 the wave itself and those that die out beside a
wall), by Galerkin's method with the first DEPTH_MODES Legendre polynomials. Pressure and flux are matched from layer to
layer, beginning at the wall.

A good zone begins so gently that no wave is reflected at its edge, and damps a wave away on its way to the wall and
back: the height falls by exp(-(integral of r s^q dx) / group speed) each way. Zones of one wavelength and more reflect
least near r = 2 k times the group speed, whatever their length. For k h from 0.5 to 3 they then reflect at most 1.1 %
of a regular wave from one wavelength and 0.45 % from two, and 0.5 % of a JONSWAP sea from two (2.3 % from one). A zone
shorter than half a wavelength needs 7 group speeds over its length, and still reflects 8 to 17 % from 0.35 wavelengths
and 13 to 34 % from a quarter.
"""

import numpy as np
from numpy.polynomial import legendre

from ocean_sim.waves import Components, group_speed, wavenumber

DAMPING_POWER = 1.5  # the damping grows with this power of the distance from where the zone begins
LEAST_REFLECTION_RATE = 2.0  # [k times group speed] rate at the side for the least reflection
SHORT_ZONE_RATE = 7.0  # [group speed over length of the zone] that of a zone shorter than half a wavelength
ZONE_LAYERS = 60  # layers of equal damping
DEPTH_MODES = 6  # modes over the depth
BAND_FREQUENCIES = 32  # frequencies at which the reflection of a sea is computed
MAX_DEPTH = 6.0  # [1/k] depth below which no wave is felt


def damping_rate(k: float, depth: float, gravity: float, length: float) -> float:
    """Damping rate [1/s] at the wall that makes a zone of a length [m] reflect waves of wavenumber k [rad/m] least."""
    return max(LEAST_REFLECTION_RATE * k, SHORT_ZONE_RATE / length) * float(group_speed(k, depth, gravity))


def wave_reflection(omega: np.ndarray, depth: float, gravity: float, length: float, rate: float) -> np.ndarray:
    """Ratios (n,) of reflected to incident height of waves of frequencies omega (n,) [rad/s] on a depth [m], head on to
    a damping zone of a length [m] whose damping rate at the wall is `rate` [1/s]."""
    omega = np.asarray(omega, dtype=float)[:, None]  # by layer in the second place, the first being water without zone
    h = np.minimum(depth, MAX_DEPTH / wavenumber(omega, depth, gravity))[:, :, None, None]
    s = (np.arange(ZONE_LAYERS) + 0.5) / ZONE_LAYERS
    r = rate * np.append(0.0, s**DAMPING_POWER)
    # Orthonormal polynomials over a depth of 1: integrals of products of their slopes, and their values at the surface.
    nodes, weights = legendre.leggauss(DEPTH_MODES + 1)
    top = np.sqrt(2.0 * np.arange(DEPTH_MODES) + 1.0)
    slopes = 2.0 * top * np.stack([legendre.legval(nodes, legendre.legder(row)) for row in np.eye(DEPTH_MODES)], axis=1)
    stiffness = slopes.T @ (0.5 * weights[:, None] * slopes)
    rise = (omega * (omega + 1j * r) / gravity)[:, :, None, None]
    squared, shape = np.linalg.eig(stiffness / h**2 - rise / h * np.outer(top, top))
    decay = np.sqrt(squared.astype(complex))  # a mode that goes towards the wall is exp(-decay x)
    decay = np.where((decay.real < 1e-6 * np.abs(decay)) & (decay.imag > 0.0), -decay, decay)
    flux = (1.0 / (r - 1j * omega))[:, :, None, None] * shape * decay[:, :, None, :]
    thickness, one = length / ZONE_LAYERS, np.eye(DEPTH_MODES)
    # From the wall outwards: the admittance that the layers behind show to each layer gives its reflected modes.
    back = np.broadcast_to(one.astype(complex), (len(omega), DEPTH_MODES, DEPTH_MODES))  # over modes that come
    for j in range(ZONE_LAYERS, 0, -1):
        there = np.exp(-thickness * decay[:, j])
        nearer = there[:, :, None] * back * there[:, None, :]
        pressure, through = shape[:, j] @ (one + nearer), flux[:, j] @ (one - nearer)
        admittance = through @ np.linalg.inv(pressure)
        before, passed = admittance @ shape[:, j - 1], flux[:, j - 1]
        back = np.linalg.solve(passed + before, passed - before)
    wave = np.argmin(squared[:, 0].real, axis=-1)
    return np.abs(back[np.arange(len(omega)), wave, wave])


def sea_reflection(sea: Components, length: float, rate: float) -> tuple[float, float]:
    """Ratios of reflected to incident height for a damping zone of a length [m] and a damping rate [1/s] at its wall:
    of the highest wave of a sea, and of the whole sea (root of the energy ratio)."""
    omega, energy = sea.omega, sea.amplitude**2
    grid = np.geomspace(omega.min(), omega.max(), BAND_FREQUENCIES) if sea.random else omega[:1]
    back = np.interp(omega, grid, wave_reflection(grid, sea.depth, sea.gravity, length, rate))
    peak = wave_reflection(omega[[sea.highest]], sea.depth, sea.gravity, length, rate)
    return float(peak[0]), float(np.sqrt((energy * back**2).sum() / energy.sum()))
