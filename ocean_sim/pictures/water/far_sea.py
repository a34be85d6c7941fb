"""The sea around a basin out to the horizon: plane waves of the same spectrum, on a fan of rays and rings."""

from dataclasses import replace
from math import pi
from typing import NamedTuple

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.random_numbers import numpy_uniform
from ocean_sim.surface import cell_triangles
from ocean_sim.waves import Components

SEA_RADIUS = 14000.0  # [m] where the drawn sea ends, behind the fog
BLEND_MARGIN = 0.2  # of the basin's shorter side: where its own waves give way to the far ones, within its walls
NODES_PER_WAVE = (2.0, 3.0)  # at which a wave is not drawn, and is fully drawn
PIXELS_PER_WAVE = (1.2, 4.0)  # across which the slopes of a wave fade into the width of the glint
# Ranges of wavenumbers, and of headings in a quarter, in each of which a wave stands for modes of a basin
WAVENUMBER_SHELLS, HEADING_SECTORS = 20, 6
MAX_MODE = 0.8  # of half a wave a cell: shorter modes are noise of the particles
MAX_WAVES = 96  # plane waves of a sea that are drawn far away
RAY_COUNTS = 120, 320  # least and most of the fan in which the far sea is drawn
FIRST_RING = 0.35  # [heights of the eye] away, or nearer, where the first ring lies
# Spacing of rings over their distance, and in the farthest over the one before
RING_SPACING, FAR_RING_GROWTH = 0.03, 1.09
# [m] to which waves but this share of the variance, the shortest, are drawn
WAVE_REACHES = ((400.0, 0.06), (1000.0, 0.20))
PEAK_PERIOD = 0.90  # energy period over that of the peak, of JONSWAP's spectrum
# [m] around the eye within which nodes are looked at that lie evenly, and how many
SAMPLE_REACH, SAMPLE_COUNT = 400.0, 4096
GOLDEN_SHARE = 0.6180339887  # by which a number of a node goes on, so that rays are met as often as each other
BELT_RINGS = 8  # rings of which the same waves are drawn
TURN_STEP = np.radians(8.0)  # by which the eye turns before the fan does
QUARTER_STREAM, PHASE_STREAM, PLACE_STREAM = 0x5_0000, 0x5_0001, 0x5_0002  # streams of random numbers


def blend_weight(nodes: np.ndarray, low: float, high: float, margin: float) -> np.ndarray:
    """Weight (n,) at positions `nodes` (n,) [m]: 1 between `low` and `high`, falling to 0 over a margin [m] at both."""
    inside = np.clip(np.minimum(nodes - low, high - nodes) / margin, 0.0, 1.0)
    return inside * inside * (3.0 - 2.0 * inside)


class SeaSample(NamedTuple):
    """Heights of the sea and its convergence (downward acceleration of the surface over gravity) on a grid (nx, nz)."""

    height: np.ndarray  # [m]
    convergence: np.ndarray  # of the water near the surface


class PlaneWaves:
    """Sum of plane waves at the nodes of a rectangular grid, evaluated by matrix products."""

    def __init__(self, sea: Components, x: np.ndarray, z: np.ndarray) -> None:
        """`x`, `z`: coordinates of the grid's nodes [m]."""
        self.sea = sea
        kx, kz = sea.wavevector.T
        self.along_x, self.along_z = np.exp(1j * x[:, None] * kx), np.exp(1j * z[:, None] * kz)

    def at(self, turning: np.ndarray) -> SeaSample:
        """Heights [m] and convergence (downward acceleration over gravity) at the nodes. `turning` (n,): complex
        amplitudes [m] of the waves at one time, from `complex_amplitudes`."""
        x, z = self.along_x * turning, self.along_z.T
        # The real part of a product of complex matrices is two products of real ones.
        height = x.real @ z.real - x.imag @ z.imag
        k = self.sea.wavenumber
        convergence = (x.real * k) @ z.real - (x.imag * k) @ z.imag
        return SeaSample(height, convergence)


def complex_amplitudes(sea: Components, time: float, origin: np.ndarray) -> np.ndarray:
    """Complex amplitudes (n,) [m] of plane waves at a time [s], with phases relative to an origin x, z (2,) [m]."""
    phase = np.mod(sea.phase + sea.wavevector @ origin - sea.omega * time, 2.0 * pi)
    return sea.amplitude * np.exp(1j * phase)


def grown_waves(sea: Components, time: float) -> Components:
    """Copy of a sea whose amplitudes are those reached at a time [s] while its waves grow; the copy grows no more."""
    return replace(sea, amplitude=sea.ramp_share(time) * sea.amplitude, ramp=0.0)


def strongest_waves(sea: Components, most: int = MAX_WAVES) -> Components:
    """Copy of a sea with only its `most` strongest waves, scaled to keep the variance of the sea."""
    if len(sea.amplitude) <= most:
        return sea
    kept = np.sort(np.argsort(sea.amplitude)[::-1][:most])
    scale = np.sqrt((sea.amplitude**2).sum() / (sea.amplitude[kept] ** 2).sum())
    return replace(sea, amplitude=scale * sea.amplitude[kept], wavevector=sea.wavevector[kept], phase=sea.phase[kept])


def shortest_lengths(sea: Components) -> list[float]:
    """Shortest wavelengths [m] to draw within each distance of WAVE_REACHES from the eye. They are rounded down to
    quarters of an octave, so that similar seas share a mesh."""
    order = np.argsort(sea.wavenumber)[::-1]
    held = np.cumsum(sea.amplitude[order] ** 2)
    lengths = 2.0 * pi / np.maximum(sea.wavenumber[order], 1e-9)
    if held[-1] <= 0.0:
        return [SEA_RADIUS for _ in WAVE_REACHES]
    found = [float(lengths[np.searchsorted(held, share * held[-1])]) for _, share in WAVE_REACHES]
    return [2.0 ** (float(np.floor(4.0 * np.log2(length) + 1e-9)) / 4.0) for length in found]


def ring_distances(lengths: list[float], first: float) -> np.ndarray:
    """Distances (n,) [m] of mesh rings around an eye, from `first` to the horizon. Within each distance of WAVE_REACHES
    their spacing resolves waves of the length [m] given in `lengths`."""
    caps = [length / NODES_PER_WAVE[1] for length in lengths]
    distances = [first]
    step = max(RING_SPACING * first, 0.02)
    while distances[-1] < SEA_RADIUS:
        near = next((cap for (reach, _), cap in zip(WAVE_REACHES, caps, strict=True) if distances[-1] < reach), None)
        step = FAR_RING_GROWTH * step if near is None else min(max(RING_SPACING * distances[-1], 0.02), near)
        distances.append(distances[-1] + step)
    return np.array(distances)


class Fan:
    """Mesh of the far sea around an eye, with nodes on rays and rings. Heights include every wave that the rings
    resolve; slopes of waves too narrow for the pixels are left out, and widen the sun's glint instead."""

    def __init__(self, sea: Components) -> None:
        """Begin a mesh of the sea without nodes, which `turn_to` places. `sea`: plane waves; amplitudes may change."""
        self.sea = sea
        self.looked: tuple[float, ...] = ()
        self.nodes = np.zeros((0, 2))  # around the eye [m]
        self.triangles = np.zeros((0, 3), dtype=int)  # of those that are seen
        self.evenly = np.zeros(0, int)  # numbers of nodes near the eye, as many to each square metre
        self.belts: list[tuple[slice, np.ndarray, np.ndarray]] = []  # rings, their waves, and cosine and sine of these

    def turn_to(
        self, height: float, heading: float, half: float, lowest: float, pixel: float, row: float, amplitude: np.ndarray
    ) -> bool:
        """Place nodes on rays from the eye and rings around it, about a `heading` [rad, from +x to +z]; True if they
        changed. `height`: of the eye over water [m]; `amplitude` (n,): of waves [m]. Angles of view [rad]: `half` to
        either side, `lowest` below the horizon, of a `pixel` (for slopes), of a `row` of its samples (one ring)."""
        whole = half > 0.5 * pi
        bucket = 0.0 if whole else TURN_STEP * round(heading / TURN_STEP)
        step = 2.0 ** (np.round(2.0 * np.log2(max(height, 0.5))) / 2.0)  # heights that are alike look alike
        lengths = shortest_lengths(replace(self.sea, amplitude=amplitude))
        angles = float(np.ceil(half / TURN_STEP)), float(np.ceil(lowest / TURN_STEP))
        seen = (bucket, step, *angles, pixel, row, *lengths)
        if seen == self.looked:
            return False
        self.looked = seen
        reach = pi if whole else min((seen[2] + 0.5) * TURN_STEP, pi)
        below = min(max((seen[3] + 0.5) * TURN_STEP, 0.05), 0.49 * pi)
        first = max(min(FIRST_RING * step, 0.7 * step / float(np.tan(below))), 0.3)
        distance = ring_distances(lengths, first)
        far, length = WAVE_REACHES[-1][0], lengths[-1]
        rays = int(np.clip(2.0 * reach * far * NODES_PER_WAVE[1] / length, *RAY_COUNTS))
        angle = bucket + np.linspace(-reach, reach, rays + 1)
        away = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        self.shape = len(distance), len(angle)
        self.nodes = (distance[:, None, None] * away).reshape(-1, 2)
        self.distance = distance
        area = np.cumsum(np.gradient(distance) * distance * (distance < SAMPLE_REACH))
        n = np.arange(SAMPLE_COUNT)
        ring = np.searchsorted(area, (n + 0.5) / SAMPLE_COUNT * area[-1])
        self.evenly = ring * len(angle) + (np.modf(GOLDEN_SHARE * n)[0] * len(angle)).astype(int)
        band = np.floor(np.arctan2(step, distance) / row)
        starts = np.flatnonzero(np.diff(band, prepend=np.inf))
        ends = np.append(starts[1:], len(distance))
        self.bands = np.minimum(starts[:, None] + np.arange((ends - starts).max()), ends[:, None] - 1)
        self.triangles = cell_triangles(len(starts), len(angle))
        sea, (least, enough) = self.sea, NODES_PER_WAVE
        length = 2.0 * pi / np.maximum(sea.wavenumber, 1e-9)
        spacing = np.maximum(np.gradient(distance), distance * (angle[1] - angle[0]))
        self.drawn = np.clip((length / spacing[:, None] - least) / (enough - least), 0.0, 1.0)
        far = np.hypot(distance, step)
        footprint = pixel * far / np.maximum(step / far, 0.003)  # of a pixel, along its ray
        least, enough = PIXELS_PER_WAVE
        seen_slopes = self.drawn * np.clip((length / footprint[:, None] - least) / (enough - least), 0.0, 1.0)
        self.sloping = seen_slopes
        towards = (away @ sea.wavevector.T).astype(np.float32)
        self.belts = []
        for first_ring in range(0, len(distance), BELT_RINGS):
            belt = slice(first_ring, first_ring + BELT_RINGS)
            drawn = np.flatnonzero(self.drawn[belt].any(axis=0))
            phase = distance[belt, None, None].astype(np.float32) * towards[:, drawn]
            self.belts.append((belt, drawn, np.concatenate([np.cos(phase), np.sin(phase)], axis=-1)))
        return True

    def visible_rings(self, height: np.ndarray, eye: float) -> np.ndarray:
        """Index (bands, rays) of the ring seen on each ray in each row of pixels (band): of the rings there, the one
        that hides the others. `height` (rings, rays): of the water [m]; `eye`: height of the eye [m]."""
        rise = (height - eye) / self.distance[:, None]
        highest = rise[self.bands].argmax(axis=1)
        return np.take_along_axis(self.bands, highest, axis=1)

    def lost_variance(self, amplitude: np.ndarray) -> np.ndarray:
        """Variance (rings,) of the slopes, along one axis, of the waves too short to draw at each ring of nodes around
        the eye. `amplitude` (n,): of all waves [m]."""
        return 0.25 * (1.0 - self.sloping**2) @ (amplitude * self.sea.wavenumber) ** 2

    def convergence_deviation(self, amplitude: np.ndarray) -> tuple[float, np.ndarray]:
        """Standard deviation of the convergence (downward acceleration over gravity) of (a) all waves; (b) those that
        the nodes of each ring around the eye resolve (rings,). `amplitude` (n,): of the waves now [m]."""
        each = 0.5 * (amplitude * self.sea.wavenumber) ** 2
        return max(float(np.sqrt(each.sum())), 1e-12), np.sqrt(self.drawn**2 @ each)

    def at(self, turning: np.ndarray) -> np.ndarray:
        """Height [m], slopes along x and z, and convergence (downward acceleration over gravity) of the sea at its
        nodes (rings, rays, 4). `turning` (n,): complex amplitudes [m] at the eye, from `complex_amplitudes`."""
        kx, kz = self.sea.wavevector.T
        level, slope = turning * self.drawn, turning * self.sloping
        columns = np.stack([level, 1j * kx * slope, 1j * kz * slope, self.sea.wavenumber * level], axis=-1)
        columns = columns.astype(np.complex64)
        found = np.zeros((*self.shape, 4), np.float32)
        for belt, drawn, waves in self.belts:
            here = columns[belt, drawn]
            np.matmul(waves, np.concatenate([here.real, -here.imag], axis=1), out=found[belt])
        return found


class Modes:
    """Plane waves that continue a basin's standing waves (modes) into the sea around it. One wave replaces all modes in
    a range of wavenumbers and headings, with their mean wavenumber and total variance. Its heading is turned at random
    into one of four quarters, most likely that of the wind."""

    def __init__(
        self, shape: tuple[int, ...], size: tuple[float, float], depth: float, towards: np.ndarray, seed: int = 0
    ) -> None:
        """`shape`: of the grid of heights in the basin; `size`: of the basin along x, z [m]; `depth`: of the water [m];
        `towards`: unit vector x, z to which the wind blows; `seed`: of the random headings and phases."""
        p, q = np.indices(shape)
        self.kept = (np.hypot(p / shape[0], q / shape[1]) < MAX_MODE) & (p + q > 0)
        p, q = p[self.kept], q[self.kept]
        kx, kz = pi * p / size[0], pi * q / size[1]
        if not len(p):
            self.numbers = np.zeros(0, int)
            self.sea = Components(np.zeros(1), np.array([[1.0, 0.0]]), np.zeros(1), depth)
            return
        k = np.hypot(kx, kz)
        spread = max(np.log(k.max() / k.min()), 1e-9)
        shell = np.minimum(WAVENUMBER_SHELLS * np.log(k / k.min()) / spread, WAVENUMBER_SHELLS - 1).astype(int)
        sector = np.minimum(HEADING_SECTORS * np.arctan2(kz, kx) / (0.5 * pi), HEADING_SECTORS - 1).astype(int)
        _, self.numbers = np.unique(shell * HEADING_SECTORS + sector, return_inverse=True)
        many = np.bincount(self.numbers)
        n = np.arange(len(many))
        p, q = (np.bincount(self.numbers, weights=each) / many for each in (p, q))
        kx = pi * np.maximum(p + (numpy_uniform(seed, PLACE_STREAM, n, 0) - 0.5) * (p > 0), 0.0) / size[0]
        kz = pi * np.maximum(q + (numpy_uniform(seed, PLACE_STREAM, n, 1) - 0.5) * (q > 0), 0.0) / size[1]
        sign_x = np.where(numpy_uniform(seed, QUARTER_STREAM, n, 0) < 0.5 + 0.5 * towards[0], 1.0, -1.0)
        sign_z = np.where(numpy_uniform(seed, QUARTER_STREAM, n, 1) < 0.5 + 0.5 * towards[1], 1.0, -1.0)
        phase = 2.0 * pi * numpy_uniform(seed, PHASE_STREAM, n, 0)
        self.sea = Components(np.ones(len(n)), np.stack([sign_x * kx, sign_z * kz], axis=1), phase, depth)

    def variances(self, elevation: np.ndarray) -> np.ndarray:
        """Variances (n,) [m2] of the plane waves, from the heights `elevation` (nx, nz) [m] in the basin: in the ratio
        of the power of the basin modes that each wave stands for; their sum is the variance of the heights."""
        from scipy.fft import dctn

        power = dctn(elevation - elevation.mean(), type=2, norm="ortho") ** 2 / elevation.size
        kept = np.bincount(self.numbers, weights=power[self.kept], minlength=len(self.sea.amplitude))
        return kept * power.sum() / max(float(kept.sum()), 1e-30)


def wind_speed_from_height(height: float) -> float:
    """Wind speed U [m/s] at which a fully grown sea has this significant height H [m]: H = 0.21 U^2 / g (Pierson &
    Moskowitz 1964, J. Geophys. Res. 69)."""
    return float(np.sqrt(GRAVITY * max(height, 0.0) / 0.21))


def wind_speed_from_sea(sea: Components, time: float) -> float:
    """Wind speed [m/s] at 10 m that would raise a random sea to its height at a time [s]; 0 for regular waves.

    Height H and peak omega_p grow with the fetch F, X = g F / U^2, as H g / U^2 = 0.0016 X^(1/2), omega_p U / g = 22
    X^(-1/3) (Hasselmann et al. 1973, Dtsch. Hydrogr. Z. A8 12); X is eliminated. A low, long swell gives little."""
    energy = sea.amplitude**2
    if not sea.random or energy.sum() <= 0.0:
        return 0.0
    peak = PEAK_PERIOD * energy.sum() / (energy / sea.omega).sum()
    height = sea.ramp_share(time) * sea.significant_height
    return float((height * GRAVITY / (0.0016 * (22.0 * GRAVITY / peak) ** 1.5)) ** 2)
