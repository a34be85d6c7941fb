"""Response amplitude operators of a ship from records of her motion and of the waves at her mean place.

In an irregular sea a response is the cross spectrum of wave and motion over the spectrum of the wave, by Welch's method
(1967, IEEE Trans. Audio Electroacoust. 15), with its coherence (Bendat & Piersol 2010, Random Data, 4th ed., section
6.1); in a regular one it is the ratio of first harmonics. Translations are per wave amplitude, rotations per wave slope
(wavenumber times amplitude). A phase is that by which a motion leads the crest where the ship is, but for her surge and
sway in waves.

Closed form: heave and pitch of a box of her length, waterplane and displacement in deep water (Jensen, Mansour & Olsen
2004, Ocean Eng. 31, 61-85).
"""

from typing import NamedTuple

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.ship.naval.hydrostatics import Hydrostatics
from ocean_sim.waves import Components

MOTION_NAMES = ("surge", "sway", "heave", "roll", "pitch", "yaw")
MIN_SEGMENTS = 4  # of a record, each half over the next
MAX_SEGMENT_PERIODS, MIN_SEGMENT_PERIODS = 24.0, 8.0  # periods of the spectral peak in a segment
MIN_WAVE_SHARE = 0.05  # of the greatest density of the waves, below which there is nothing to divide by
ROWS_PER_PERIOD = 40  # rows that are used in a period of the spectral peak
TRUSTED_COHERENCE = 0.8


class Response(NamedTuple):
    """Complex response (m, 6), in the order of MOTION_NAMES, at m encounter frequencies; coherence; wave spectrum."""

    omega: np.ndarray  # (m,) encounter frequency [rad/s]
    wave_density: np.ndarray  # (m,) [m2 s], over frequency in Hz; of a regular wave NaN
    ratio: np.ndarray  # (m, 6) complex: translations [m/m], rotations [rad/rad]
    coherence: np.ndarray  # (m, 6), 0 to 1


def ship_motions(position: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Motions (n, 6) in the order of MOTION_NAMES, along axes of the mean heading. `position`: surge, sway, heave (n,
    3) [m] along fixed axes, x forward, y to port, z up; `angles`: roll, pitch, yaw (n, 3) [rad]."""
    yaw = np.unwrap(angles[:, 2])
    cos, sin = np.cos(yaw.mean()), np.sin(yaw.mean())
    across = position[:, :2] @ np.array([[cos, -sin], [sin, cos]])
    return np.column_stack([across, position[:, 2], angles[:, :2], yaw])


def mean_path(time: np.ndarray, place: np.ndarray, period: float) -> tuple[np.ndarray, np.ndarray]:
    """Path (n, 2) [m]: `place` (n, 2) at times (n,) [s] smoothed over `period` [s]; and mean velocity (2,) [m/s]."""
    from scipy.ndimage import gaussian_filter1d

    base = np.column_stack([np.ones_like(time), time])
    fit = np.linalg.lstsq(base, place, rcond=None)[0]
    slow = gaussian_filter1d(place - base @ fit, period / (time[1] - time[0]), axis=0, mode="nearest")
    return base @ fit + slow, fit[1]


def waves_at(sea: Components, time: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Elevation [m] and slope, (n, 2), of a sea at full height, at `place` x, z (n, 2) [m] and times (n,) [s]. The
    slope is the sum of each wave's elevation times its wavenumber, so it is in phase with the crests."""
    found = np.zeros((2, len(time)))
    for a, k, omega, phase, size in zip(sea.amplitude, sea.wavevector, sea.omega, sea.phase, sea.wavenumber):
        found += np.outer([a, a * size], np.cos(place @ k - omega * time + phase))
    return found.T


def least_record(period: float) -> float:
    """Shortest record [s] that gives cross spectra, for waves whose spectral peak the ship meets every `period` [s]."""
    return 0.5 * (MIN_SEGMENTS + 1) * MIN_SEGMENT_PERIODS * period


def irregular_response(waves: np.ndarray, motions: np.ndarray, every: float, period: float) -> Response:
    """Response by cross spectra of `waves` (n, 2), elevation [m] and slope, and `motions` (n, 6), sampled `every` [s].
    `period` [s]: of the spectral peak; the record is at least as long as `least_record` says."""
    from scipy.signal import csd, detrend

    longest = 2.0 * len(waves) * every / (MIN_SEGMENTS + 1)
    segment = int(min(longest, MAX_SEGMENT_PERIODS * period) / every)
    reference, moved = detrend(waves, axis=0)[:, [0, 0, 0, 1, 1, 1]], detrend(motions, axis=0)
    pairs = (reference, moved), (reference, reference), (moved, moved)
    found = [csd(one, other, 1.0 / every, nperseg=segment, axis=0) for one, other in pairs]
    waved = found[1][1][:, 0].real
    there = np.flatnonzero(waved >= MIN_WAVE_SHARE * waved[1:].max())
    there = there[there > 0]  # frequency 0 is the mean
    cross, own, motion = (density[there] for _, density in found)
    coherence = np.abs(cross) ** 2 / np.maximum((own * motion).real, 1e-300)
    return Response(2.0 * np.pi * found[0][0][there], waved[there], cross / own.real, coherence)


def regular_response(waves: np.ndarray, motions: np.ndarray, time: np.ndarray, omega: float) -> Response:
    """Response to a regular wave of encounter frequency `omega` [rad/s], by harmonics fitted to whole records at times
    (n,) [s]: `waves` (n, 2), elevation [m] and slope; `motions` (n, 6), in the order of MOTION_NAMES."""
    base = np.column_stack([np.cos(omega * time), np.sin(omega * time), np.ones_like(time), time])
    values = np.hstack([waves, motions])
    fit = np.linalg.lstsq(base, values, rcond=None)[0]
    rest = values - base[:, 2:] @ fit[2:]
    explained = rest.var(axis=0) - (values - base @ fit).var(axis=0)
    explained /= np.maximum(rest.var(axis=0), 1e-300)
    harmonic = fit[0] - 1j * fit[1]
    ratio = harmonic[2:] / harmonic[[0, 0, 0, 1, 1, 1]]
    return Response(np.array([omega]), np.array([np.nan]), ratio[None], np.clip(explained[2:], 0.0, 1.0)[None])


def box_response(still: Hydrostatics, omega: np.ndarray, speed: float, along: float) -> np.ndarray:
    """Closed form of heave [m/m], pitch [rad/rad] (m, 2) at encounter frequencies `omega` (m,) [rad/s], `speed` [m/s],
    `along` the cosine of the waves' heading to hers; NaN where several waves have one frequency of encounter."""
    number = np.geomspace(1e-3, 60.0, 2000) / still.length  # [rad/m]
    wave = np.sqrt(GRAVITY * number)
    met = wave - number * speed * along
    if (np.diff(met) <= 0.0).any():
        return np.full((len(omega), 2), np.nan)
    length, breadth, draught = still.length, still.waterplane / still.length, still.needed_volume / still.waterplane
    alpha, effective = met / wave, np.maximum(number * abs(along), 1e-9 / length)
    across = 2.0 * np.sin(0.5 * number * breadth * alpha**2) * np.exp(-number * draught * alpha**2)
    damped = across**2 / (number * breadth * alpha**3)
    push = np.exp(-effective * draught) * np.hypot(1.0 - number * draught, damped)
    resonance = np.hypot(1.0 - 2.0 * number * draught * alpha**2, across**2 / (number * breadth * alpha**2))
    half = 0.5 * effective * length
    heave = push * np.sin(half) / half / resonance
    pitch = push * 6.0 * (np.sin(half) - half * np.cos(half)) / (half**2 * length) / resonance / number
    return np.column_stack([np.interp(omega, met, np.abs(each)) for each in (heave, pitch)])
