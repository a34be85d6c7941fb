"""What a zone of damped water before a wall sends back of a linear wave, and how strong its damping should be.

In the zone dv/dt = -grad p / rho + g - r s^PROFILE v, where s goes from 0 where the zone begins to 1 at the wall behind
it, which reflects. A wave of frequency omega is p exp(-i omega t), with

    div(grad p / (r s^PROFILE - i omega)) = 0,   dp/dy = omega (omega + i r s^PROFILE) / g p on the still surface,

and no flow through bed and wall. The zone is cut into layers of equal damping; across a layer p is a sum of modes, each
an exponential along the zone times a profile over the depth (for r = 0 the wave itself and those that die out beside
a wall), found by Galerkin's method with the first MODES Legendre polynomials. Pressure and flux are matched from layer
to layer, beginning at the wall.

The zone is best when no wave notices where it begins, and nearly all of it is gone on the way to the wall and back: its
height falls by exp(-(integral of r s^PROFILE dx) / group speed). In zones of one wavelength and more least comes back
near r = 2 k times the group speed, whatever their length. For k h from 0.5 to 3 that is at most 1.1 % of a regular wave
from one wavelength and 0.45 % from two, and 0.5 % of a JONSWAP sea from two (2.3 % from one). A damping with s^2 leaves
1.9 % from one wavelength and 0.2 % from two, at its best rate for all of these, 2.4 k times the group speed; with s it
is 1.9 % and 1.0 %, at 1.2. A zone that is shorter than half a wavelength has to be stronger, 7 group speeds over its
length, and still sends 8 to 17 % back from 0.35 wavelengths, 13 to 34 % from a quarter.
"""

import numpy as np
from numpy.polynomial import legendre

from ocean_sim.waves import Components, group_speed, wavenumber

PROFILE = 1.5  # the damping grows with this power of the distance from where the zone begins
RATE = 2.0  # [k times group speed] of the damping at the side, for the least reflection
CROWDED = 7.0  # [group speed over the length of the zone] the same where the zone is shorter than half a wavelength
LAYERS = 60
MODES = 6
RESOLVED = 32  # frequencies at which a band is looked at
DEEP = 6.0  # [1/k] no wave feels what lies further down


def damping_rate(k: float, depth: float, gravity: float, length: float) -> float:
    """Rate [1/s] at the side of a zone [m] that sends least back of waves of a wavenumber [rad/m]."""
    return max(RATE * k, CROWDED / length) * float(group_speed(k, depth, gravity))


def reflection(omega: np.ndarray, depth: float, gravity: float, length: float, rate: float) -> np.ndarray:
    """(n,) height over that of the coming wave of what a zone [m] of a rate [1/s] at the wall behind it sends back, of
    waves of (n,) omega [rad/s] that meet it head on."""
    omega = np.asarray(omega, dtype=float)[:, None]  # by layer in the second place, the first being water without zone
    h = np.minimum(depth, DEEP / wavenumber(omega, depth, gravity))[:, :, None, None]
    s = (np.arange(LAYERS) + 0.5) / LAYERS
    r = rate * np.append(0.0, s**PROFILE)
    # Orthonormal polynomials over a depth of 1: integrals of products of their slopes, and their values at the surface.
    nodes, weights = legendre.leggauss(MODES + 1)
    top = np.sqrt(2.0 * np.arange(MODES) + 1.0)
    slopes = 2.0 * top * np.stack([legendre.legval(nodes, legendre.legder(row)) for row in np.eye(MODES)], axis=1)
    stiffness = slopes.T @ (0.5 * weights[:, None] * slopes)
    rise = (omega * (omega + 1j * r) / gravity)[:, :, None, None]
    squared, shape = np.linalg.eig(stiffness / h**2 - rise / h * np.outer(top, top))
    decay = np.sqrt(squared.astype(complex))  # a mode that goes towards the wall is exp(-decay x)
    decay = np.where((decay.real < 1e-6 * np.abs(decay)) & (decay.imag > 0.0), -decay, decay)
    flux = (1.0 / (r - 1j * omega))[:, :, None, None] * shape * decay[:, :, None, :]
    thickness, one = length / LAYERS, np.eye(MODES)
    back = np.broadcast_to(one.astype(complex), (len(omega), MODES, MODES))  # modes that return over those that come
    for j in range(LAYERS, 0, -1):
        there = np.exp(-thickness * decay[:, j])
        nearer = there[:, :, None] * back * there[:, None, :]
        pressure, through = shape[:, j] @ (one + nearer), flux[:, j] @ (one - nearer)
        admittance = through @ np.linalg.inv(pressure)
        before, passed = admittance @ shape[:, j - 1], flux[:, j - 1]
        back = np.linalg.solve(passed + before, passed - before)
    wave = np.argmin(squared[:, 0].real, axis=-1)
    return np.abs(back[np.arange(len(omega)), wave, wave])


def reflected(sea: Components, length: float, rate: float) -> tuple[float, float]:
    """Height over that of the coming wave of what a zone sends back: of the highest wave of a sea, and of all of it by
    the root of the energy."""
    omega, energy = sea.omega, sea.amplitude**2
    grid = np.geomspace(omega.min(), omega.max(), RESOLVED) if sea.random else omega[:1]
    back = np.interp(omega, grid, reflection(grid, sea.depth, sea.gravity, length, rate))
    peak = reflection(omega[[sea.highest]], sea.depth, sea.gravity, length, rate)
    return float(peak[0]), float(np.sqrt((energy * back**2).sum() / energy.sum()))
