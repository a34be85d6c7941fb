"""Directional wave spectra: tables of variance density over frequency and the direction from which waves come.

Directions are clockwise from north. A buoy gives the first two Fourier moments c_n = sum D e^(i n theta) of the
distribution D of the variance over directions theta.
"""

from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from ocean_sim.conventions import GRAVITY

Spreading = Literal["mem", "fourier"]
MOMENT_DIRECTIONS = np.arange(0.0, 360.0)  # [deg] at which a distribution is computed from its moments
MAX_COHERENCE, MAX_SECOND = 0.998, 0.98  # length of c1, and of c2 - c1^2 over its bound 1 - |c1|^2, that is resolved
SMOOTHING_DEG, SMOOTHING_BANDS = 10.0, 0.7  # by which a table is smoothed before its partitions are found
SADDLE_RATIO = 0.65  # height of a saddle over the lower of its two peaks, from which they are one partition
MIN_PARTITION_SHARE = 0.01  # share of the variance below which a partition is noise


class SeaState(NamedTuple):
    """Integral parameters of a directional spectrum."""

    hm0_m: float  # 4 sqrt(m0)
    tp_s: float  # one over the frequency of the highest variance density
    tm02_s: float  # sqrt(m0 / m2)
    from_deg: float  # mean direction
    spread_deg: float  # sqrt(2 (1 - r1)), the circular standard deviation (Kuik, van Vledder & Holthuijsen 1988)


@dataclass(frozen=True, eq=False)
class DirectionalSpectrum:
    """Variance density at rising frequencies (n,) [Hz] and directions (m,) [deg] at equal steps. The spectrum of a buoy
    has density (n, 1) [m2/Hz] and Fourier moments instead of directions, until `spread` is called."""

    frequency: np.ndarray
    direction: np.ndarray
    density: np.ndarray  # (n, m) [m2/(Hz rad)]
    moments: np.ndarray | None = None  # (2, n): c1 and c2
    remark: str = ""  # on bands whose moments no distribution has

    @property
    def step(self) -> float:
        """Step between directions [rad] over which density is summed; 1 for the spectrum of a buoy, which has moments
        instead of directions until `spread` is called."""
        return float(np.radians(np.median(np.diff(self.direction)))) if self.moments is None else 1.0

    @property
    def edges(self) -> np.ndarray:
        """Edges (n + 1,) [Hz] of bands, halfway between the frequencies: sums over bands are trapezoidal."""
        f = np.pad(self.frequency, 1, "edge")
        return 0.5 * (f[1:] + f[:-1])

    @property
    def variance(self) -> np.ndarray:
        """Variance (n,) [m2] of each band."""
        return self.step * self.density.sum(axis=1) * np.diff(self.edges)

    @property
    def moment(self) -> np.ndarray:
        """First Fourier moment (n,), complex, of the directions in each band, times the band's variance [m2]."""
        return self.step * (self.density @ np.exp(1j * np.radians(self.direction))) * np.diff(self.edges)

    @property
    def significant_height(self) -> float:
        """Significant wave height 4 sqrt(m0) [m]."""
        return 4.0 * float(self.variance.sum()) ** 0.5

    @property
    def peak_period(self) -> float:
        """Period [s] of the highest variance density."""
        return 1.0 / float(self.frequency[self.density.sum(axis=1).argmax()])

    @property
    def steepness(self) -> float:
        """Significant wave height over the length of waves in deep water with the mean period Tm02."""
        return 8.0 * np.pi / GRAVITY * float(self.variance @ self.frequency**2) / float(self.variance.sum()) ** 0.5

    def state(self) -> SeaState:
        """Integral parameters of this spectrum."""
        m0, m2 = float(self.variance.sum()), float(self.variance @ self.frequency**2)
        mean = self.moment.sum() / m0
        angle, spread = np.degrees([np.angle(mean), max(0.0, 2.0 - 2.0 * abs(mean)) ** 0.5]).tolist()
        return SeaState(self.significant_height, self.peak_period, (m0 / m2) ** 0.5, angle % 360.0, spread)

    def spread(self, method: Spreading) -> "DirectionalSpectrum":
        """Copy with density over directions instead of moments, by the maximum entropy method or by Fourier series."""
        if self.moments is None:
            return self
        distribution = maximum_entropy if method == "mem" else fourier_series
        shares = distribution(np.exp(-1j * np.radians(MOMENT_DIRECTIONS)), *self.moments[:, :, None])
        shares /= shares.sum(axis=1, keepdims=True) * np.radians(1.0)
        (first, second), there = self.moments, self.density[:, 0] > 0.0
        n = (there & (np.abs(second - first**2) > 1.0 - np.abs(first) ** 2)).sum() if method == "mem" else 0
        remark = f"no distribution has the moments of {n} of {there.sum()} bands: a2, b2 are the nearest possible ones"
        return DirectionalSpectrum(self.frequency, MOMENT_DIRECTIONS, self.density * shares, remark=remark * bool(n))

    def partitions(self) -> list["DirectionalSpectrum"]:
        """Division of this spectrum into spectra around its peaks (Hanson & Phillips 2001), the highest waves first."""
        labels, least = partition_labels(self), MIN_PARTITION_SHARE**0.5 * self.significant_height
        parts = [replace(self, density=np.where(labels == k, self.density, 0.0)) for k in np.unique(labels)]
        high = [part for part in parts if part.significant_height >= least]
        return sorted(high, key=lambda part: -part.significant_height)


def fourier_series(turn: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Directional distribution (n, m) with moments `first`, `second` (n, 1), where `turn` (m,) is e^(-i theta): Fourier
    series cut off below 0 (Longuet-Higgins, Cartwright & Smith 1963), and rotated back to its mean direction."""
    for _ in range(2):
        shares = np.maximum(1.0 + 2.0 * (first * turn + second * turn**2).real, 0.0)
        mean = (shares * turn.conj()).sum(axis=1, keepdims=True)
        turn = turn * np.exp(1j * np.angle(first * mean.conj()))
    return shares


def maximum_entropy(turn: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Directional distribution (n, m) of most entropy with moments `first` and `second` (n, 1) (Lygre & Krogstad 1986),
    averaged over cells around theta, as peaks may be narrower, where `turn` (m,) is e^(-i theta). Moments too large for
    any distribution are reduced, the second towards c1^2, by the bound |c2 - c1^2| <= 1 - |c1|^2."""
    first, second = first / np.sinc(1.0 / len(turn)), second / np.sinc(2.0 / len(turn))  # which the cells take off
    first = first / np.maximum(1.0, np.abs(first) / MAX_COHERENCE)
    phi_2 = (second - first**2) / (1.0 - np.abs(first) ** 2)
    phi_2 /= np.maximum(1.0, np.abs(phi_2) / MAX_SECOND)
    phi_1 = first - phi_2 * first.conj()
    # 1 + 2 sum_n c_n turn^n = -1 + 2 sum_k share_k / (1 - pole_k turn), which has a logarithm as its integral.
    apart = np.sqrt(phi_1**2 + 4.0 * phi_2)
    apart = np.where(np.abs(apart) < 1e-6, 1e-6, apart)
    side, grown = np.exp(1j * np.pi / len(turn)), np.full((len(first), len(turn)), np.pi / len(turn))
    for gap in (apart, -apart):
        pole = 0.5 * (phi_1 + gap)
        share = (pole + first - phi_1) / gap
        grown = grown + (share * np.log((1.0 - pole * turn / side) / (1.0 - pole * turn * side))).imag
    return np.maximum(grown, 0.0)


def partition_labels(spectrum: DirectionalSpectrum) -> np.ndarray:
    """(n, m) number of the spectral peak to which each cell of the table belongs, by steepest ascent in the smoothed
    table. A peak that a high saddle joins to a higher one counts as the same."""
    from scipy.ndimage import gaussian_filter

    widths = SMOOTHING_BANDS, np.radians(SMOOTHING_DEG) / spectrum.step
    height = gaussian_filter(spectrum.density, widths, mode=("nearest", "wrap"))
    n, m = height.shape

    def neighbours(values: np.ndarray) -> np.ndarray:
        padded = np.pad(values, ((1, 1), (0, 0)), constant_values=-1)
        ways = [(0, 0), *((i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j)]
        return np.stack([np.roll(padded, -j, axis=1)[1 + i : n + 1 + i] for i, j in ways])

    around = neighbours(height)
    upward = np.take_along_axis(neighbours(np.arange(n * m).reshape(n, m)), around.argmax(axis=0)[None], axis=0).ravel()
    upward[height.ravel() <= 0.0] = height.argmax()  # without energy: anywhere
    while (upward[upward] != upward).any():
        upward = upward[upward]
    peaks, labels = np.unique(upward, return_inverse=True)
    top, labels = height.ravel()[peaks], labels.reshape(n, m)
    while True:
        saddle = np.zeros((len(peaks), len(peaks)))
        np.maximum.at(saddle, (labels, neighbours(labels)), np.minimum(height, around))
        ratio = np.triu(np.maximum(saddle, saddle.T), 1) / np.minimum.outer(top, top)
        pair = sorted(np.unravel_index(ratio.argmax(), ratio.shape), key=lambda k: top[k])
        if ratio.max() < SADDLE_RATIO:
            return labels
        labels[labels == pair[0]] = pair[1]
