"""Linear (Airy) waves on water of finite depth: dispersion, spectra, and seas as sums of plane waves.

Formulae as in Dean & Dalrymple (1991), Water Wave Mechanics for Engineers and Scientists, chapters 3, 4 and 6. Linear
theory ends at the still surface; the column up to the real surface is stretched (Wheeler 1970, J. Petroleum Tech. 22):
the values of linear theory at y' = h (y - eta) / (h + eta) hold at y. So pressure is zero on the surface itself, and
nothing grows without bound under a crest; the velocity is free of divergence to second order in the steepness.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import cos, pi, radians, sin, sqrt
from typing import Annotated, Any, ClassVar, Literal, Protocol

import numpy as np
from pydantic import Discriminator, Tag, model_validator

from ocean_sim.conventions import GRAVITY
from ocean_sim.files.input_file import FileName, display_path
from ocean_sim.model import Faults, Model, quantity
from ocean_sim.random_numbers import numpy_uniform
from ocean_sim.waves.directional import DirectionalSpectrum, Spreading
from ocean_sim.waves.spectrum_files import read_spectrum

SPECTRUM_WAVES = 200  # plane waves that stand for a spectrum
RAMP_PERIODS = 2.0  # [periods] time in which waves grow from calm water
LOWEST_FREQUENCY = 0.5  # [peak frequencies] low end of a band; up to 4 it covers all but 0.5 % of the variance
SPECTRUM_POINTS = 4000  # points at which a spectrum is integrated over the band
FREQUENCY_STREAM, PHASE_STREAM, DIRECTION_STREAM = 0x3_0000, 0x3_0001, 0x3_0002  # streams of random numbers
GOLDEN_RATIO = 0.5 * (sqrt(5.0) - 1.0)  # whose multiples fill (0, 1) evenly however many there are
Values = float | np.ndarray  # one value, or an array of any shape
BREAKING_STEEPNESS = 0.142  # height over wavelength, over tanh(kh), at which a wave breaks (Miche 1944)
MIN_LATTICE_POINTS = 256  # points from which the test for a lattice pays
ANGLES_AT_ONCE = 2**15  # angles of waves at points that are computed together


def wavenumber(omega: Values, depth: float, gravity: float = GRAVITY) -> np.ndarray:
    """Wavenumber k [rad/m] that solves omega^2 = g k tanh(k h), for omega [rad/s] > 0, depth h [m], gravity g [m/s2],
    by Newton's method from the closed form of Guo (2002, Coastal Engineering 45), which is right to 0.75 %."""
    x = np.clip(np.asarray(omega, dtype=float) * sqrt(depth / gravity), 1e-100, 1e100)  # its powers are numbers
    kh = x**2 * (-np.expm1(-(x**2.4908))) ** (-1.0 / 2.4908)
    for _ in range(4):
        t = np.tanh(kh)
        kh = kh - (kh * t - x**2) / (t + kh * (1.0 - t**2))
    return kh / depth


def angular_frequency(k: Values, depth: float, gravity: float = GRAVITY) -> np.ndarray:
    """Angular frequency [rad/s] of waves of wavenumber k [rad/m] on a depth [m] under gravity [m/s2]."""
    k = np.asarray(k, dtype=float)
    return np.sqrt(gravity * k * np.tanh(k * depth))


def phase_speed(k: Values, depth: float, gravity: float = GRAVITY) -> np.ndarray:
    """Speed [m/s] of the crests of waves of wavenumber k [rad/m] on a depth [m]."""
    return angular_frequency(k, depth, gravity) / k


def group_speed(k: Values, depth: float, gravity: float = GRAVITY) -> np.ndarray:
    """Speed [m/s] at which waves of wavenumber k [rad/m] carry energy on a depth h [m]: c/2 (1 + 2kh / sinh 2kh)."""
    q = 2.0 * np.minimum(np.asarray(k, dtype=float) * depth, 300.0)
    return 0.5 * phase_speed(k, depth, gravity) * (1.0 + q / np.sinh(q))


def breaking_height(period: float, depth: float, gravity: float = GRAVITY) -> float:
    """Height [m] at which waves of a period [s] break on a depth [m] (Miche 1944): 0.142 wavelengths times tanh kh."""
    k = float(wavenumber(2.0 * pi / period, depth, gravity))
    return BREAKING_STEEPNESS * 2.0 * pi / k * float(np.tanh(k * depth))


def piston_transfer(kh: Values) -> np.ndarray:
    """Wave height over stroke of a piston wavemaker, far away, at k h (Biesel & Suquet 1951; Dean & Dalrymple 6.25)."""
    q = 2.0 * np.minimum(np.asarray(kh, dtype=float), 300.0)
    return 2.0 * (np.cosh(q) - 1.0) / (np.sinh(q) + q)


def pierson_moskowitz(frequency: Values, peak_frequency: float, alpha: float, gravity: float = GRAVITY) -> np.ndarray:
    """Spectral density [m2 s] of Pierson & Moskowitz (1964) at frequencies [Hz], with peak fp, `peak_frequency` [Hz];
    its variance is alpha g^2 / (5 (2 pi)^4 fp^4)."""
    f = np.asarray(frequency, dtype=float)
    scale = alpha * gravity**2 / (2.0 * pi) ** 4
    return scale * f**-5.0 * np.exp(-1.25 * (peak_frequency / f) ** 4)


def jonswap(
    frequency: Values, peak_frequency: float, alpha: float, gamma: float = 3.3, gravity: float = GRAVITY
) -> np.ndarray:
    """Spectral density [m2 s] of JONSWAP (Hasselmann et al. 1973) at frequencies [Hz]: `pierson_moskowitz` of the same
    arguments, its peak raised by the factor gamma, over a relative width of 0.07 below the peak and 0.09 above it."""
    ratio = np.asarray(frequency, dtype=float) / peak_frequency
    width = np.where(ratio <= 1.0, 0.07, 0.09)
    peak = gamma ** np.exp(-0.5 * ((ratio - 1.0) / width) ** 2)
    return peak * pierson_moskowitz(frequency, peak_frequency, alpha, gravity)


def ramp_share(time: float, ramp: float) -> float:
    """Share of their full height that waves have at a time [s] if they grow over a ramp [s] from time 0 on: s - sin(2
    pi s) / (2 pi), with s from 0 to 1 over the ramp.

    Its rate is Hann's window, which has no part at the frequency of a wave with two or more whole periods in the ramp:
    a body that floats at rest at first then moves to and fro about one place, whatever the phase of the wave."""
    s = min(max(time / ramp, 0.0), 1.0) if ramp > 0.0 else 1.0
    return s - sin(2.0 * pi * s) / (2.0 * pi)


def ramp_rate(time: float, ramp: float) -> float:
    """Time derivative [1/s] of `ramp_share` at a time [s] for a ramp [s]."""
    s = time / ramp if ramp > 0.0 else 1.0
    return (1.0 - cos(2.0 * pi * s)) / ramp if 0.0 < s < 1.0 else 0.0


def cut_short(duration: float, ramp: float) -> Iterator[str]:
    """Yield a warning if a run of this duration [s] ends before its waves are at full height, after their ramp [s]."""
    if duration < ramp:
        share = 100.0 * ramp_share(duration, ramp)
        grow = f"the waves grow from calm water over the first {ramp:.4g} s, and the run ends at {duration:.4g} s"
        yield f"{grow}, when they have {share:.2g} % of their height; take a longer duration or a shorter ramp"


@dataclass(frozen=True)
class Components:
    """A sea as a sum of plane waves, each amplitude cos(k . (x, z) - omega t + phase)."""

    amplitude: np.ndarray  # (n,) [m]
    wavevector: np.ndarray  # (n, 2) along x and z [rad/m]
    phase: np.ndarray  # (n,) [rad]
    depth: float  # [m]
    gravity: float = GRAVITY  # [m/s2]
    ramp: float = 0.0  # [s] from time 0 on in which they grow from nothing

    @cached_property
    def wavenumber(self) -> np.ndarray:
        """Wavenumbers (n,) of the waves [rad/m]."""
        return np.hypot(*self.wavevector.T)

    @cached_property
    def omega(self) -> np.ndarray:
        """Angular frequencies (n,) of the waves [rad/s]."""
        return angular_frequency(self.wavenumber, self.depth, self.gravity)

    @property
    def highest(self) -> int:
        """Index of the wave with the greatest amplitude."""
        return int(np.argmax(self.amplitude))

    @property
    def wavelength(self) -> float:
        """Wavelength of the highest wave [m]."""
        return 2.0 * pi / float(self.wavenumber[self.highest])

    @property
    def period(self) -> float:
        """Period of the highest wave [s]."""
        return 2.0 * pi / float(self.omega[self.highest])

    @property
    def heading_deg(self) -> float:
        """Heading of the highest wave [deg]: 0 along +z, 90 along +x."""
        return float(np.degrees(np.arctan2(*self.wavevector[self.highest])))

    @property
    def significant_height(self) -> float:
        """Significant wave height [m]: four standard deviations of the elevation."""
        return 4.0 * float(np.sqrt(0.5 * (self.amplitude**2).sum()))

    @property
    def random(self) -> bool:
        """True if the sea is irregular: its waves have more than one frequency."""
        return bool(np.ptp(self.omega) > 0.0)

    def select(self, there: np.ndarray) -> "Components":
        """Copy of the sea with only those waves for which `there` (n,) is True, and the longest wave."""
        kept = there | (np.arange(len(there)) == np.argmin(self.wavenumber))
        return replace(self, amplitude=self.amplitude[kept], wavevector=self.wavevector[kept], phase=self.phase[kept])

    def ramp_share(self, time: float) -> float:
        return ramp_share(time, self.ramp)

    def ramp_rate(self, time: float) -> float:
        return ramp_rate(time, self.ramp)

    def angles(self, points: np.ndarray, time: float) -> Iterator[tuple[slice, np.ndarray]]:
        """Yield, for batches of waves, the slice that selects n of them and their phase angles k . (x, z) - omega t +
        phase [rad], (n, m), at a time [s] and m points, whose first column is x [m] and last column z [m]."""
        x, z = points[:, 0], points[:, -1]
        n = max(1, ANGLES_AT_ONCE // max(1, len(points)))
        for some in (slice(first, first + n) for first in range(0, len(self.amplitude), n)):
            (kx, kz), turned = self.wavevector[some].T, self.phase[some] - self.omega[some] * time
            yield some, np.outer(kx, x) + np.outer(kz, z) + turned[:, None]


def combine(seas: Sequence[Components], depth: float, gravity: float = GRAVITY) -> Components:
    """Combine several seas on water of one depth [m] into a single sum of waves; calm water if `seas` is empty."""
    if not seas:
        return Components(np.zeros(1), np.array([[1.0, 0.0]]), np.zeros(1), depth, gravity)
    columns = zip(*((sea.amplitude, sea.wavevector, sea.phase) for sea in seas))
    amplitude, wavevector, phase = (np.concatenate(column) for column in columns)
    return Components(amplitude, wavevector, phase, depth, gravity)


def merge_waves(sea: Components, wavevector: np.ndarray) -> Components:
    """Copy of a sea in which its n waves have new wavevectors (n, 2) [rad/m]. Waves with equal new wavevectors become
    one wave, with the sum of their variances and the phase of the greatest."""
    unique, which = np.unique(wavevector.round(9), axis=0, return_inverse=True)
    members = [np.flatnonzero(which.ravel() == k) for k in range(len(unique))]
    greatest = [own[np.argmax(sea.amplitude[own])] for own in members]
    amplitude = np.array([np.linalg.norm(sea.amplitude[own]) for own in members])
    return replace(sea, amplitude=amplitude, wavevector=wavevector[greatest], phase=sea.phase[greatest])


def fit_periods(sea: Components, periods: Sequence[float]) -> Components:
    """Copy of a sea that is periodic over lengths [m] along x and z, 0 for an axis without a period: each wave is moved
    to the nearest wavevector with a whole number of wavelengths in them."""
    wavevector, steepest = sea.wavevector.copy(), np.abs(sea.wavevector).argmax(axis=1)
    for axis, period in enumerate(periods):
        if period:
            unit = 2.0 * pi / period
            number = np.round(wavevector[:, axis] / unit)
            lost = (number == 0.0) & (steepest == axis)  # along this axis a wave must have one crest
            number = np.where(lost, np.sign(sea.wavevector[:, axis]), number)
            wavevector[:, axis] = number * unit
    return merge_waves(sea, wavevector)


def profiles(k: Values, y: Values, depth: float) -> tuple[np.ndarray, np.ndarray]:
    """Factors cosh k(y+h) / cosh kh, sinh k(y+h) / cosh kh of orbital motion at heights y [m], for a depth h [m]."""
    rise, mirrored, bed = np.exp(k * y), np.exp(-2.0 * k * (y + depth)), np.exp(-2.0 * k * depth)
    return rise * (1.0 + mirrored) / (1.0 + bed), rise * (1.0 - mirrored) / (1.0 + bed)


def weighted_sum(weight: np.ndarray, waves: np.ndarray) -> np.ndarray:
    """Sum (m,) over n waves of `waves` (n, m) times `weight` (n,), in the same order for any number of threads."""
    return np.einsum("n,nm->m", weight, waves)


def orbital_sum(sea: Components, points: np.ndarray, time: float, moved: bool) -> np.ndarray:
    """Velocities (m, 3) [m/s], or if `moved` displacements [m], at points (m, 3) [m], a time [s], by linear theory."""
    total = np.zeros((len(points), 3))
    for some, angle in sea.angles(points, time):
        k, omega, (c, s) = sea.wavenumber[some], sea.omega[some], (np.cos(angle), np.sin(angle))
        level, upright = profiles(k[:, None], points[:, 1], sea.depth)
        level, upright = (-level * s, upright * c) if moved else (level * c, upright * s)
        reach = sea.amplitude[some] * sea.gravity / omega ** (2 if moved else 1)
        along = [weighted_sum(sea.wavevector[some, axis] * reach, level) for axis in (0, 1)]
        total += np.stack([along[0], weighted_sum(k * reach, upright), along[1]], axis=1)
    return sea.ramp_share(time) * total


def elevation(sea: Components, points: np.ndarray, time: float = 0.0) -> np.ndarray:
    """Heights (m,) of the water [m] at points x, z (m, 2) or x, y, z (m, 3) [m] and a time [s]."""
    rows = lattice_rows(points)
    if rows is not None:
        columns = len(points) // rows
        parts = [(sea.amplitude, np.zeros_like(sea.amplitude))]
        return sea.ramp_share(time) * _on_lattice(sea, parts, points[::columns, 0], points[:columns, -1], time)[:, 0]
    eta = np.zeros(len(points))
    for some, angle in sea.angles(points, time):
        eta += weighted_sum(sea.amplitude[some], np.cos(angle))
    return sea.ramp_share(time) * eta


def lattice_rows(points: np.ndarray) -> int | None:
    """Number of rows of equal x if points (m, 2 or 3) form a full grid of x and z, z varying fastest. None if they do
    not, or if the grid is too small for the faster sum over a grid."""
    if len(points) < MIN_LATTICE_POINTS:
        return None
    x, z = points[:, 0], points[:, -1]
    columns = int(np.argmax(x != x[0])) or len(x)
    if len(x) % columns or columns == 1:
        return None
    across, along = x.reshape(-1, columns), z.reshape(-1, columns)
    return len(across) if (across == across[:, :1]).all() and (along == along[:1]).all() else None


def _on_lattice(
    sea: Components, parts: list[tuple[np.ndarray, np.ndarray]], x: np.ndarray, z: np.ndarray, time: float
) -> np.ndarray:
    """Sums over n waves of p cos(angle) + q sin(angle) at a time [s] on a grid x (r,) by z (c,) [m], z fastest: (r c,
    k), a column for each of the k pairs p, q (n,) in `parts`. Cosines are computed per row and column only."""
    a = np.outer(x, sea.wavevector[:, 0])
    b = np.outer(sea.wavevector[:, 1], z) + (sea.phase - sea.omega * time)[:, None]
    (cos_a, sin_a), (cos_b, sin_b) = (np.cos(a), np.sin(a)), (np.cos(b), np.sin(b))

    def summed_up(cosine: np.ndarray, sine: np.ndarray) -> np.ndarray:
        total = np.einsum("in,nj->ij", cos_a * cosine + sin_a * sine, cos_b)
        return (total - np.einsum("in,nj->ij", sin_a * cosine - cos_a * sine, sin_b)).ravel()

    return np.stack([summed_up(cosine, sine) for cosine, sine in parts], axis=1)


def stretched_height(sea: Components, points: np.ndarray, eta: np.ndarray) -> np.ndarray:
    """Heights y' (m,) [m] at which linear theory holds for points (m, 3), under elevations `eta` (m,) [m] (Wheeler)."""
    return np.minimum(sea.depth * (points[:, 1] - eta) / np.maximum(sea.depth + eta, 1e-9 * sea.depth), 0.0)


def linear_velocity(sea: Components, points: np.ndarray, time: float = 0.0) -> np.ndarray:
    """Water velocity (m, 3) [m/s] at points (m, 3) [m], a time [s], by unstretched linear theory, a potential flow."""
    rows = None if points[:, 1].any() else lattice_rows(points)
    if rows is not None:
        columns = len(points) // rows
        none, (kx, kz) = np.zeros_like(sea.amplitude), sea.wavevector.T
        along = sea.amplitude * sea.gravity / sea.omega
        parts = [(along * kx, none), (none, sea.amplitude * sea.omega), (along * kz, none)]
        return sea.ramp_share(time) * _on_lattice(sea, parts, points[::columns, 0], points[:columns, 2], time)
    return orbital_sum(sea, points, time, moved=False)


def displacement(sea: Components, points: np.ndarray, time: float = 0.0) -> np.ndarray:
    """Displacement (m, 3) [m] at time [s] of water that rests at points (m, 3) [m]; linear theory, divergence-free."""
    return orbital_sum(sea, points, time, moved=True)


def pressure_head(sea: Components, points: np.ndarray, time: float = 0.0) -> np.ndarray:
    """Wave pressure over rho g (m,) [m], without hydrostatics, at points (m, 3) [m] and a time [s]; linear theory."""
    head = np.zeros(len(points))
    for some, angle in sea.angles(points, time):
        c, _ = profiles(sea.wavenumber[some, None], points[:, 1], sea.depth)
        head += weighted_sum(sea.amplitude[some], c * np.cos(angle))
    return sea.ramp_share(time) * head


def velocity(sea: Components, points: np.ndarray, time: float = 0.0) -> np.ndarray:
    """Water velocity (m, 3) [m/s] at points (m, 3) [m], a time [s]; Wheeler stretching, above water the surface's."""
    y = stretched_height(sea, points, elevation(sea, points, time))
    return linear_velocity(sea, np.stack([points[:, 0], y, points[:, 2]], axis=1), time)


def surface_velocity(sea: Components, points: np.ndarray, time: float = 0.0) -> np.ndarray:
    """Water velocity (m, 3) [m/s] of the surface at `points` x, z (m, 2) [m] and a time [s]."""
    return linear_velocity(sea, np.insert(points, 1, 0.0, axis=1), time)


def heading_vector(heading_deg: float | None, dimension: int) -> np.ndarray:
    """Unit vector (2,), x and z, of a heading [deg]: 0 along +z, 90 along +x; None: +z, or +x if `dimension` is 2."""
    heading = radians((90.0 if dimension == 2 else 0.0) if heading_deg is None else heading_deg)
    return np.array([sin(heading), 0.0 if dimension == 2 else cos(heading)])


def regular_wave(
    height: float, period: float, towards: np.ndarray, depth: float, gravity: float = GRAVITY
) -> Components:
    """One plane wave of a height [m] and period [s] along a unit vector `towards` (x, z); crest at origin at time 0."""
    k = float(wavenumber(2.0 * pi / period, depth, gravity))
    return Components(np.array([height / 2.0]), k * towards[None, :], np.zeros(1), depth, gravity)


class Spectrum(Model):
    """Long-crested random waves given by a spectrum."""

    height_name: ClassVar[str] = "significant_wave_height"
    kind: Literal["jonswap", "pierson_moskowitz"] = "jonswap"
    """`pierson_moskowitz`: a sea that has grown as far as its wind lets it; `jonswap`: one that still
    grows, with a higher peak."""
    significant_wave_height: float = quantity("m", gt=0.0)
    """Four times the standard deviation of the elevation."""
    peak_period: float = quantity("s", gt=0.0)
    """Period at which the spectrum is highest."""
    gamma: float | None = quantity("1", None, ge=1.0, le=20.0)
    """Factor by which JONSWAP raises the peak; by default 3.3."""
    heading_deg: float | None = quantity("deg", None)
    """Direction of travel: 0 along +z, 90 along +x; by default 0, in 2-D 90."""
    seed: int = quantity("1", 0, ge=0, lt=2**31)
    """Seed of the phases."""
    cut_off: float = quantity("1", 4.0, ge=1.2, le=10.0)
    """Highest frequency over that of the peak; the waves below it carry all the variance. Deep-water waves of twice
    the frequency are a quarter as long, and particles 1/40 of the peak's wavelength apart resolve none much shorter."""

    def contradictions(self) -> Iterator[str]:
        if self.kind == "pierson_moskowitz" and self.gamma not in (None, 1.0):
            yield f"a Pierson-Moskowitz spectrum has no gamma, got {self.gamma:g}; kind: jonswap has"

    @property
    def enhancement(self) -> float:
        """Peak enhancement factor gamma: 1 for Pierson-Moskowitz; for JONSWAP 3.3, unless `gamma` is given."""
        return 1.0 if self.kind == "pierson_moskowitz" else 3.3 if self.gamma is None else self.gamma

    def density(self, frequency: Values) -> np.ndarray:
        """Spectral density S(f) [m2 s] at frequencies [Hz]; its integral over the band of the waves is Hs^2 / 16."""
        peak = 1.0 / self.peak_period
        band = np.linspace(LOWEST_FREQUENCY, self.cut_off, SPECTRUM_POINTS) * peak
        raw = np.trapezoid(jonswap(band, peak, 1.0, self.enhancement), band)
        return self.significant_wave_height**2 / 16.0 / raw * jonswap(frequency, peak, 1.0, self.enhancement)

    def components(
        self, towards: np.ndarray, depth: float, gravity: float = GRAVITY, count: int = SPECTRUM_WAVES
    ) -> Components:
        """Sea of `count` plane waves along a unit vector `towards` (x, z) on a depth [m], one for each of as many equal
        slices of the frequency band. A wave has its variance and a random frequency in it: the sea has no period."""
        peak = 1.0 / self.peak_period
        edges = np.linspace(LOWEST_FREQUENCY, self.cut_off, count + 1) * peak
        n = np.arange(count)
        frequency = edges[:-1] + np.diff(edges) * numpy_uniform(self.seed, FREQUENCY_STREAM, n, 0)
        fine = np.linspace(LOWEST_FREQUENCY, self.cut_off, SPECTRUM_POINTS) * peak
        density = self.density(fine)
        grown = np.append(0.0, np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(fine)))
        variance = np.diff(np.interp(edges, fine, grown))
        k = wavenumber(2.0 * pi * frequency, depth, gravity)
        phase = 2.0 * pi * numpy_uniform(self.seed, PHASE_STREAM, n, 0)
        return Components(np.sqrt(2.0 * variance), k[:, None] * towards, phase, depth, gravity)


class SpreadSpectrum(Spectrum):
    """Random waves given by a spectrum, whose directions may spread about their heading."""

    spreading: float | None = quantity("1", None, gt=0.0)
    """s of cos^2s(angle / 2), the share of the energy that goes at an angle to the heading (Longuet-Higgins, Cartwright
    & Smith 1963): about 10 for a wind sea, 50 for swell; null: long crests. Of a spectrum from a `file`, the method by
    which a buoy's moments become directions: `mem`, the most entropy, by default, or `fourier`, their series."""

    def components(
        self, towards: np.ndarray, depth: float, gravity: float = GRAVITY, count: int = SPECTRUM_WAVES
    ) -> Components:
        """Sea as by `Spectrum.components`, but each wave in its own direction, about the mean direction `towards`."""
        sea = super().components(towards, depth, gravity, count)
        if self.spreading is None:
            return sea
        angle = np.linspace(-pi, pi, SPECTRUM_POINTS)
        share = np.cumsum(np.cos(0.5 * angle) ** (2.0 * self.spreading))
        n = np.arange(count)
        drawn = (GOLDEN_RATIO * n + numpy_uniform(self.seed, DIRECTION_STREAM, n, 0) / count) % 1.0
        turn = np.interp(drawn, share / share[-1], angle)
        turn -= np.angle((sea.amplitude**2 * np.exp(1j * turn)).sum())
        c, s = np.cos(turn), np.sin(turn)
        ahead = np.stack([towards[0] * c + towards[1] * s, towards[1] * c - towards[0] * s], axis=1)
        return Components(sea.amplitude, sea.wavenumber[:, None] * ahead, sea.phase, depth, gravity)


class FileSpectrum(Model):
    """Random waves of a directional spectrum that was measured or computed, from a file."""

    height_name: ClassVar[str] = "file"
    file: FileName
    """A file of spectra: of NDBC (.data_spec and the four next to it, or those of a year, as 41010w2019.txt), CDIP
    (sp), Spotter (CSV), SWAN or WAVEWATCH III (2-D, text) or ERA5 (netCDF 3)."""
    time: str | None = None
    """Date and time of the spectrum in UTC (ISO 8601), of which `ocean-sim sea FILE` lists all; null: the only one of
    the file."""
    point: int = quantity("1", 1, ge=1)
    """Number of the point in a file with several, as it counts them, from 1 on."""
    spreading: Spreading | None = None
    """Method by which a buoy's moments become directions: `mem`, the most entropy (Lygre & Krogstad 1986), or
    `fourier`, their series clipped at 0 (Longuet-Higgins, Cartwright & Smith 1963); null: `mem`."""
    north_deg: float | None = quantity("deg", None)
    """Heading of north in the world, 0 along +z and 90 along +x; null: 0, with east along -x. In 2-D all waves travel
    along +x."""
    seed: int = quantity("1", 0, ge=0, lt=2**31)
    """Seed of the phases, and of frequencies and directions within the file's bands."""

    @model_validator(mode="after")
    def _legible(self) -> "FileSpectrum":
        self.table.state()
        return self

    @cached_property
    def table(self) -> DirectionalSpectrum:
        """Spectrum in the file over frequency and direction; raises Unreadable."""
        return read_spectrum(self.file, self.time, self.point)[1].spread(self.spreading or "mem")

    @property
    def significant_wave_height(self) -> float:
        """Four times the standard deviation of the elevation [m]."""
        return self.table.significant_height

    @property
    def peak_period(self) -> float:
        """Period at which the spectrum is highest [s]."""
        return self.table.peak_period

    @property
    def heading_deg(self) -> None:
        """No heading: the directions of the waves are in the file."""

    def statement(self, dimension: int) -> str:
        """Sentence for the user on how the file's compass directions become headings in a 2-D or 3-D scene."""
        axes = {0.0: "+z", 90.0: "+x", 180.0: "-z", 270.0: "-x"}
        headings = (((self.north_deg or 0.0) + turn) % 360.0 for turn in (0.0, -90.0))
        north, east = (axes.get(heading, f"heading {heading:g}") for heading in headings)
        place = f"north is {north}, east is {east}" if dimension == 3 else "in 2-D all waves travel along +x"
        mean = f"waves from {self.table.state().from_deg:.0f} deg on average"
        return f"{display_path(self.file)}: {'; '.join(filter(None, (mean, place, self.table.remark)))}"

    def components(
        self, towards: np.ndarray, depth: float, gravity: float = GRAVITY, count: int = SPECTRUM_WAVES
    ) -> Components:
        """Sea of about `count` plane waves, at least one. Waves from one band of the file share its variance equally
        and have its mean direction; in 2-D, where the unit vector `towards` lies along x, all waves follow it."""
        table, variance = self.table, self.table.variance
        widths = np.where(variance > 0.0, np.diff(table.edges), 0.0)
        number = np.rint(0.5 * count * (variance / variance.sum() + widths / widths.sum())).astype(int)
        number = np.where(variance > 0.0, np.maximum(number, 1), 0)
        band, n = np.repeat(np.arange(len(number)), number), np.arange(number.sum())
        streams = FREQUENCY_STREAM, DIRECTION_STREAM, PHASE_STREAM
        along, turned, phase = (numpy_uniform(self.seed, stream, n, 0) for stream in streams)
        inside = (n - (np.cumsum(number) - number)[band] + along) / number[band]
        omega = 2.0 * pi * (table.edges[band] + widths[band] * inside)
        shares = (GOLDEN_RATIO * n + turned / number[band]) % 1.0
        grown = np.pad(np.cumsum(table.density, axis=1), ((0, 0), (1, 0)))
        sides = np.radians(table.direction[0]) + table.step * (np.arange(grown.shape[1]) - 0.5)
        coming = np.array([np.interp(q * grown[k, -1], grown[k], sides) for q, k in zip(shares, band)])
        mean = np.bincount(band, np.cos(coming), len(number)) + 1j * np.bincount(band, np.sin(coming), len(number))
        heading = radians(self.north_deg or 0.0) - pi - coming - np.angle(table.moment * mean.conj())[band]
        ahead = np.stack([np.sin(heading), np.cos(heading)], axis=1) if towards[1] else towards
        wavevector = wavenumber(omega, depth, gravity)[:, None] * ahead
        amplitude = np.sqrt(2.0 * (variance / number.clip(1))[band])
        return Components(amplitude, wavevector, 2.0 * pi * phase, depth, gravity)


def spectrum_class(value: Any) -> str:
    """Pydantic tag of a spectrum, the name of its class; `value`: a mapping of its keys, or the object itself."""
    named = isinstance(value, dict) and "file" in value
    return "FileSpectrum" if named or isinstance(value, FileSpectrum) else "SpreadSpectrum"


AnySpectrum = Annotated[
    Annotated[FileSpectrum, Tag("FileSpectrum")] | Annotated[SpreadSpectrum, Tag("SpreadSpectrum")],
    Discriminator(spectrum_class),
]


class WaveTrain(Model):
    """Waves that are regular, by `height` and `period`, or random, by `spectrum`."""

    may_be_calm: ClassVar[bool] = False
    """True if there may be neither."""

    height: float | None = quantity("m", None, gt=0.0)
    """Height from trough to crest."""
    period: float | None = quantity("s", None, gt=0.0)
    """Period of a regular wave."""
    spectrum: Spectrum | None = None
    """Random waves, instead of `height` and `period`."""

    def contradictions(self) -> Iterator[str]:
        absent = (2,) if self.spectrum is not None else (0, 2) if self.may_be_calm else (0,)
        if [self.height, self.period].count(None) not in absent:
            neither = ", or neither" if self.may_be_calm else ""
            yield f"give either height [m] and period [s] of a regular wave, or a spectrum{neither}"

    @property
    def scale(self) -> tuple[float, float]:
        """Height [m] and period [s] of the regular wave, or significant height and peak period of the spectrum."""
        if self.spectrum is not None:
            return self.spectrum.significant_wave_height, self.spectrum.peak_period
        assert self.height is not None and self.period is not None
        return self.height, self.period

    @property
    def height_key(self) -> tuple[str, ...]:
        """Path of the config key that gives the height of the waves, for messages."""
        return ("height",) if self.spectrum is None else ("spectrum", self.spectrum.height_name)

    def train(self, towards: np.ndarray, depth: float, gravity: float, count: int = SPECTRUM_WAVES) -> Components:
        """Plane waves of this train along unit vector `towards` (x, z) on a depth [m]: `count` waves for a spectrum."""
        if self.spectrum is not None:
            return self.spectrum.components(towards, depth, gravity, count)
        return regular_wave(*self.scale, towards, depth, gravity)


class HeadedTrain(WaveTrain):
    """Wave train that travels along a heading."""

    heading_deg: float | None = quantity("deg", None)
    """Direction of travel of regular waves: 0 along +z, 90 along +x; by default 0, in 2-D 90."""

    def contradictions(self) -> Iterator[str]:
        yield from super().contradictions()
        if self.spectrum is not None and self.heading_deg is not None:
            yield "the heading of random waves is spectrum.heading_deg"

    @property
    def heading(self) -> float | None:
        """Heading of the waves [deg], 0 along +z and 90 along +x; None if no heading is given."""
        return self.heading_deg if self.spectrum is None else self.spectrum.heading_deg

    @property
    def heading_key(self) -> tuple[str, ...]:
        """Path of the config key that gives the heading of the waves, for messages."""
        return ("heading_deg",) if self.spectrum is None else ("spectrum", "heading_deg")

    def faults(self, basin: "Tank") -> Faults:
        """Yield faults (key path, sentence) of these waves in a basin: they would break, or have a wrong heading."""
        yield from ((self.height_key, sentence) for sentence in basin_faults(basin, *self.scale))
        yield from self.direction_faults(basin)

    def direction_faults(self, basin: "Tank") -> Faults:
        """Yield faults (key path, sentence) of directions that waves cannot have in a basin."""
        yield from ((self.heading_key, sentence) for sentence in heading_faults(self.heading, basin))

    def sea(self, basin: "Tank", count: int = SPECTRUM_WAVES) -> Components:
        """Plane waves of this train on the water of a basin; a spectrum becomes `count` waves."""
        return self.train(heading_vector(self.heading, basin.dimension), basin.depth, downward_gravity(basin), count)


class OpenTrain(HeadedTrain):
    """Wave train on a sea without sides, whose directions may spread."""

    spectrum: AnySpectrum | None = None  # type: ignore[assignment]
    """Random waves, instead of `height` and `period`; also those of a `file`."""

    def direction_faults(self, basin: "Tank") -> Faults:
        yield from super().direction_faults(basin)
        given = dict(self.spectrum) if basin.dimension == 2 and self.spectrum is not None else {}
        for key in ("spreading", "north_deg"):
            if given.get(key) is not None:
                yield ("spectrum", key), f"in 2-D waves have one direction; leave {key} out"


class GrowingTrain(OpenTrain):
    """Wave train on a sea without sides that grows from calm water over a ramp."""

    ramp: float | None = quantity("s", None, ge=0.0)
    """Time over which the waves grow from calm water; null: two periods of the highest; 0: they are there at once."""

    def with_ramp(self, sea: Components) -> Components:
        """Copy of a sea whose waves grow from zero height over this train's ramp, from time 0 on."""
        return replace(sea, ramp=RAMP_PERIODS * sea.period if self.ramp is None else self.ramp)


class Tank(Protocol):
    """Interface of a basin with the properties that linear wave theory needs."""

    @property
    def dimension(self) -> int:
        """Number of dimensions: 3, or 2 for a vertical slice."""

    @property
    def depth(self) -> float:
        """Depth of the still water [m]."""

    @property
    def gravity(self) -> tuple[float, float, float]:
        """Vector of the acceleration of gravity [m/s2]."""

    @property
    def closed(self) -> bool:
        """True if the basin has no free surface."""


def downward_gravity(basin: Tank) -> float:
    """Magnitude of gravity [m/s2] of a basin, for which gravity must point straight down."""
    return -basin.gravity[1]


def basin_faults(basin: Tank, height: float = 0.0, period: float | None = None) -> Iterator[str]:
    """Yield a sentence if this basin cannot have waves, or a wave of a height [m] and period [s] would break in it."""
    if basin.gravity[0] or basin.gravity[2] or not basin.gravity[1] < 0.0:
        yield f"waves need gravity straight down, here it is {list(basin.gravity)} m/s2"
    elif basin.closed:
        yield "waves need a free surface; this basin has none"
    elif period is not None and height > (most := breaking_height(period, basin.depth, downward_gravity(basin))):
        wave = f"a wave of {period:g} s and {height:g} m would break"
        yield f"{wave}: on {basin.depth:g} m of water it is at most {most:.3g} m high"


def heading_faults(heading_deg: float | None, basin: Tank) -> Iterator[str]:
    """Yield a sentence if waves cannot have this heading [deg] (None: default) in this basin: in 2-D only along x."""
    if basin.dimension == 2 and heading_deg is not None and abs(cos(radians(heading_deg))) > 1e-9:
        yield f"in 2-D waves go along +x (heading 90 degrees) or -x (270), got {heading_deg:g}"
