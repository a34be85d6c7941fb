"""The sea around a basin out to the horizon: plane waves of the same spectrum, on a fan of rays and rings."""

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.pictures.water_mesh import triangles
from ocean_sim.random_numbers import numpy_uniform
from ocean_sim.waves import Components

OUT = 14000.0  # [m] where the drawn sea ends, behind the fog
MARGIN = 0.2  # of the basin's shorter side: where its own waves give way to the far ones, within its walls
NODES_PER_WAVE = (2.0, 3.0)  # at which a wave is not drawn, and is fully drawn
PIXELS_PER_WAVE = (1.2, 4.0)  # across which the slopes of a wave fade into the width of the glint
COMPONENTS = 160  # plane waves that stand for the spectrum of a basin
STRONGEST = 96  # plane waves of a sea that are drawn far away
RAYS = 120, 320  # least and most of the fan in which the far sea is drawn
NEAREST = 0.35  # [heights of the eye] away, or nearer, where the first ring lies
WIDENING, BEYOND = 0.03, 1.09  # spacing of rings over their distance, and in the farthest over the one before
REACHES = ((400.0, 0.06), (1000.0, 0.20))  # [m] to which waves but this share of the variance, the shortest, are drawn
TURN = np.radians(8.0)  # by which the eye turns before the fan does
ASTREAM, PHASES, PLACES = 0x5_0000, 0x5_0001, 0x5_0002  # streams of random numbers


def blend_weight(nodes: np.ndarray, low: float, high: float, margin: float) -> np.ndarray:
    """1 in the middle, 0 at `low` and `high` and beyond them, smooth in a margin [m] inside."""
    inside = np.clip(np.minimum(nodes - low, high - nodes) / margin, 0.0, 1.0)
    return inside * inside * (3.0 - 2.0 * inside)


@dataclass(frozen=True)
class SeaSample:
    """A sea at the nodes of a grid (nx, nz)."""

    height: np.ndarray  # [m]
    convergence: np.ndarray  # of the water near the surface
    variance: np.ndarray  # of the slopes along each axis of the waves that the grid is too wide for


class PlaneWaves:
    """A sea at the nodes of a tensor grid, by products of matrices."""

    def __init__(self, sea: Components, x: np.ndarray, z: np.ndarray) -> None:
        self.sea = sea
        self.along_x, self.along_z = (
            np.exp(1j * nodes[:, None] * k) for nodes, k in zip((x, z), sea.wavevector.T, strict=True)
        )

    def at(self, turning: np.ndarray) -> SeaSample:
        """The sea of complex amplitudes (n,) at the nodes' origin (see `turning`)."""
        x, z = self.along_x * turning, self.along_z.T
        # The real part of a product of complex matrices is two products of real ones.
        height = x.real @ z.real - x.imag @ z.imag
        k = self.sea.wavenumber
        convergence = (x.real * k) @ z.real - (x.imag * k) @ z.imag
        return SeaSample(height, convergence, np.zeros_like(height))


def turning(sea: Components, time: float, origin: np.ndarray, share: float) -> np.ndarray:
    """(n,) complex amplitudes [m] of plane waves at a time [s] around an origin x, z [m]."""
    phase = np.mod(sea.phase + sea.wavevector @ origin - sea.omega * time, 2.0 * pi)
    return share * sea.amplitude * np.exp(1j * phase)


def strongest(sea: Components, most: int = STRONGEST) -> Components:
    """The strongest of many plane waves, with the variance of all."""
    if len(sea.amplitude) <= most:
        return sea
    kept = np.sort(np.argsort(sea.amplitude)[::-1][:most])
    scale = np.sqrt((sea.amplitude**2).sum() / (sea.amplitude[kept] ** 2).sum())
    return replace(sea, amplitude=scale * sea.amplitude[kept], wavevector=sea.wavevector[kept], phase=sea.phase[kept])


def shortest(sea: Components) -> list[float]:
    """Of the waves that are drawn to each of REACHES, the length of the shortest [m]."""
    order = np.argsort(sea.wavenumber)[::-1]
    held = np.cumsum(sea.amplitude[order] ** 2)
    lengths = 2.0 * pi / np.maximum(sea.wavenumber[order], 1e-9)
    return [float(lengths[np.searchsorted(held, share * held[-1])]) if held[-1] > 0.0 else OUT for _, share in REACHES]


def rings(sea: Components, first: float) -> np.ndarray:
    """Distances [m] of rings around an eye, out to the horizon: close enough for the waves of the sea, but for the
    shortest ones, as far as REACHES."""
    caps = [length / NODES_PER_WAVE[1] for length in shortest(sea)]
    distances = [first]
    step = max(WIDENING * first, 0.02)
    while distances[-1] < OUT:
        near = next((cap for (reach, _), cap in zip(REACHES, caps, strict=True) if distances[-1] < reach), None)
        step = BEYOND * step if near is None else min(max(WIDENING * distances[-1], 0.02), near)
        distances.append(distances[-1] + step)
    return np.array(distances)


class Fan:
    """The far sea as an eye sees it: nodes on rays around it and on rings that are close enough for its waves. Heights
    are whole as far as the rings hold them; slopes fade where a wave is narrower than a few pixels, and what fades
    widens the glint."""

    def __init__(self, sea: Components) -> None:
        self.sea = sea
        self.looked: tuple[float, ...] = ()
        self.nodes = np.zeros((0, 2))  # around the eye [m]
        self.triangles = np.zeros((0, 3), dtype=int)

    def look(self, height: float, heading: float, half: float, lowest: float, pixel: float) -> bool:
        """Turn towards a heading [rad, from +x to +z]; whether the nodes are new ones.

        `height`: of the eye over the water [m]; `half`: the angle to either side that it sees, `lowest`: that of its
        lowest ray below the horizon [rad]; `pixel`: the angle of a pixel [rad].
        """
        whole = half > 0.5 * pi
        bucket = 0.0 if whole else TURN * round(heading / TURN)
        step = 2.0 ** (np.round(2.0 * np.log2(max(height, 0.5))) / 2.0)  # heights that are alike look alike
        seen = (bucket, step, float(np.ceil(half / TURN)), float(np.ceil(lowest / TURN)), pixel)
        if seen == self.looked:
            return False
        self.looked = seen
        reach = pi if whole else min((seen[2] + 0.5) * TURN, pi)
        below = min(max((seen[3] + 0.5) * TURN, 0.05), 0.49 * pi)
        first = max(min(NEAREST * step, 0.7 * step / float(np.tan(below))), 0.3)
        distance = rings(self.sea, first)
        far, length = REACHES[-1][0], shortest(self.sea)[-1]
        rays = int(np.clip(2.0 * reach * far * NODES_PER_WAVE[1] / length, *RAYS))
        angle = bucket + np.linspace(-reach, reach, rays + 1)
        away = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        self.shape = len(distance), len(angle)
        self.nodes = (distance[:, None, None] * away).reshape(-1, 2)
        self.triangles = triangles(*self.shape)
        sea, (least, enough) = self.sea, NODES_PER_WAVE
        phase = (self.nodes @ sea.wavevector.T).astype(np.float32).reshape(*self.shape, -1)
        self.waves = np.concatenate([np.cos(phase), np.sin(phase)], axis=-1)
        length = 2.0 * pi / np.maximum(sea.wavenumber, 1e-9)
        spacing = np.maximum(np.gradient(distance), distance * (angle[1] - angle[0]))
        self.drawn = np.clip((length / spacing[:, None] - least) / (enough - least), 0.0, 1.0)
        far = np.hypot(distance, step)
        footprint = pixel * far / np.maximum(step / far, 0.003)  # of a pixel, along its ray
        least, enough = PIXELS_PER_WAVE
        seen_slopes = self.drawn * np.clip((length / footprint[:, None] - least) / (enough - least), 0.0, 1.0)
        self.sloping = seen_slopes
        k2 = 0.5 * (sea.amplitude * sea.wavenumber) ** 2
        self.lost = 0.5 * ((1.0 - seen_slopes**2) * k2).sum(axis=1)
        return True

    def at(self, turning: np.ndarray) -> np.ndarray:
        """(rings, rays, 4) height [m], slopes along x and z, and convergence of the sea of complex amplitudes (n,) at
        the eye (see `turning`)."""
        kx, kz = self.sea.wavevector.T
        level, slope = turning * self.drawn, turning * self.sloping
        columns = np.stack([level, 1j * kx * slope, 1j * kz * slope, self.sea.wavenumber * level], axis=-1)
        return self.waves @ np.concatenate([columns.real, -columns.imag], axis=1).astype(np.float32)


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
