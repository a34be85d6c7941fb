"""The sea around a basin out to the horizon: plane waves of the same spectrum on a grid that widens with distance."""

from dataclasses import dataclass
from math import pi

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.random_numbers import numpy_uniform
from ocean_sim.waves import Components

OUT = 14000.0  # [m] where the drawn sea ends, behind the fog
GENTLE, STEEP = 1.03, 1.085  # spacing over the one before, in the margin around the basin and beyond it
MARGIN = 0.5  # of the basin's shorter side: where its own waves give way to the far ones
NODES_PER_WAVE = (3.0, 6.0)  # at which a wave is not drawn, and is fully drawn
COMPONENTS = 160  # plane waves that stand for the spectrum of a basin
ASTREAM, PHASES, PLACES = 0x5_0000, 0x5_0001, 0x5_0002  # streams of random numbers


def axis(inner: np.ndarray, margin: float, out: float = OUT) -> np.ndarray:
    """Nodes [m] along one side: the inner ones, a margin around them, and on to the horizon ever wider apart."""
    step, beyond = float(inner[1] - inner[0]), []
    distance = 0.0
    while distance < out:
        step *= GENTLE if distance < margin else STEEP
        distance += step
        beyond.append(distance)
    return np.concatenate([inner[0] - np.array(beyond)[::-1], inner, inner[-1] + np.array(beyond)])


def mirrored(nodes: np.ndarray, low: float, high: float) -> np.ndarray:
    """Where in `low` to `high` nodes lie when both ends are mirrors."""
    turned = np.mod(nodes - low, 2.0 * (high - low))
    return low + np.minimum(turned, 2.0 * (high - low) - turned)


def blend_weight(nodes: np.ndarray, low: float, high: float, margin: float) -> np.ndarray:
    """1 from `low` to `high`, 0 beyond a margin [m] outside, smooth between."""
    out = np.clip(np.maximum(low - nodes, nodes - high) / margin, 0.0, 1.0)
    return 1.0 - out * out * (3.0 - 2.0 * out)


@dataclass(frozen=True)
class SeaSample:
    """A sea at the nodes of a grid (nx, nz)."""

    height: np.ndarray  # [m]
    convergence: np.ndarray  # of the water near the surface
    variance: np.ndarray  # of the slopes along each axis of the waves that the grid is too wide for


class FarSea:
    """Plane waves at the nodes of a tensor grid, by products of matrices; waves too short for the grid fade out."""

    def __init__(self, sea: Components, x: np.ndarray, z: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> None:
        """Between `lower` and `upper` (x, z) [m] no wave fades."""
        self.sea = sea
        self.along_x, self.fade_x = waves_along(x, sea.wavevector[:, 0], lower[0], upper[0])
        self.along_z, self.fade_z = waves_along(z, sea.wavevector[:, 1], lower[1], upper[1])
        k2 = 0.5 * (sea.amplitude * sea.wavenumber) ** 2
        drawn = (self.fade_x**2 * k2) @ (self.fade_z**2).T
        self.variance = 0.5 * np.maximum(k2.sum() - drawn, 0.0)

    def at(self, time: float, origin: np.ndarray) -> SeaSample:
        """The sea at a time [s], on nodes around an origin x, z [m]."""
        sea, share = self.sea, self.sea.grown(time)
        phase = np.mod(sea.phase + sea.wavevector @ origin - sea.omega * time, 2.0 * pi)
        turning = share * sea.amplitude * np.exp(1j * phase)
        x = self.along_x * turning
        z = self.along_z.T
        # The real part of a product of complex matrices is two products of real ones.
        height = x.real @ z.real - x.imag @ z.imag
        k = self.sea.wavenumber
        convergence = (x.real * k) @ z.real - (x.imag * k) @ z.imag
        return SeaSample(height, convergence, share**2 * self.variance)


def waves_along(nodes: np.ndarray, k: np.ndarray, low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    """(nodes, waves) exp(i k x) times how much of each wave is drawn, and that share; all of it within the basin."""
    spacing = np.gradient(nodes)[:, None]
    per_wave = 2.0 * pi / np.maximum(np.abs(k), 1e-9) / spacing
    least, enough = NODES_PER_WAVE
    share = np.clip((per_wave - least) / (enough - least), 0.0, 1.0)
    share = np.where(((nodes >= low) & (nodes <= high))[:, None], 1.0, share)
    return share * np.exp(1j * nodes[:, None] * k), share


def of_frames(
    elevations: list[np.ndarray], size: tuple[float, float], depth: float, towards: np.ndarray, seed: int = 0
) -> Components:
    """Plane waves with the spectrum of heights (nx, nz) in a basin, their variance the heights' own.

    `size`: of the basin along x and z [m]; `towards` (2,): unit vector the waves go to. Between walls a wave and its
    mirror images are one: each mode of the basin becomes one wave at one of its four headings, the likelier the nearer
    it is to `towards`, of a random wavenumber in its bin.
    """
    from scipy.fft import dctn

    power = np.mean([dctn(e - e.mean(), type=2, norm="ortho") ** 2 / e.size for e in elevations], axis=0)
    nx, nz = power.shape
    power[0, 0] = 0.0
    p, q = np.unravel_index(np.argsort(power, axis=None)[::-1][:COMPONENTS], power.shape)
    short = np.hypot(p / nx, q / nz) < 0.8  # the shortest are noise of the particles
    p, q = p[short], q[short]
    kept = power[p, q]
    if not len(p) or kept.sum() <= 0.0:
        return Components(np.zeros(1), np.array([[1.0, 0.0]]), np.zeros(1), depth)
    kept = kept * power.sum() / kept.sum()
    n = np.arange(len(p))
    shift = numpy_uniform(seed, PLACES, n, 0) - 0.5
    kx = np.pi * np.maximum(p + shift * (p > 0), 0.0) / size[0]
    kz = np.pi * np.maximum(q + (numpy_uniform(seed, PLACES, n, 1) - 0.5) * (q > 0), 0.0) / size[1]
    sign_x = np.where(numpy_uniform(seed, ASTREAM, n, 0) < 0.5 + 0.5 * towards[0], 1.0, -1.0)
    sign_z = np.where(numpy_uniform(seed, ASTREAM, n, 1) < 0.5 + 0.5 * towards[1], 1.0, -1.0)
    wavevector = np.stack([sign_x * kx, sign_z * kz], axis=1)
    phase = 2.0 * pi * numpy_uniform(seed, PHASES, n, 0)
    return Components(np.sqrt(2.0 * kept), wavevector, phase, depth)


def wind_speed_of(height: float) -> float:
    """Speed [m/s] of the wind that raises a full sea of this significant height [m]: H = 0.21 U^2 / g (Pierson &
    Moskowitz 1964, J. Geophys. Res. 69)."""
    return float(np.sqrt(GRAVITY * max(height, 0.0) / 0.21))
