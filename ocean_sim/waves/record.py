"""Heights, periods and spectrum of the waves in a record of the water's height at one point.

Waves are counted between zero up-crossings of the record less its mean, as in IAHR (1989), List of Sea-State
Parameters; on request less the straight line through it, and with a hysteresis. Crests and troughs between samples are
those of the parabola through the three nearest. Spectral moments are those of the whole record under a Hann window,
scaled to the record's own variance, up to five peak frequencies: the second moment of a sea grows with where it is cut
off.

The peak is found in Welch's estimate (1967), by Hann segments which overlap by half: as many, up to eight, as leave
each of them several periods of the peak. A record too short to be divided is one segment, and one too short even for
that has no peak period. Between frequencies the peak is that of the parabola through the logarithms of the greatest
density and its neighbours (Gasior & Gonzalez 2004, AIP Conf. Proc. 732): a Hann lobe is nearly a Gaussian one.
"""

import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from ocean_sim.files import csv_file
from ocean_sim.files.input_file import Checked, Rule
from ocean_sim.waves import exchange

ELEVATION_SUFFIX = "_m"  # of an elevation gauge's column
MIN_SAMPLES = 16  # samples of a record
CUT_OFF_PEAKS = 5.0  # [peak frequencies] up to which moments are taken
MAX_SEGMENTS = 8  # of the record at most, in Welch's estimate
SEGMENT_PERIODS = 6.0  # periods of the peak in each of several segments, at least
RECORD_PERIODS = 3.0  # periods of the peak in the record, at least: those of a Hann window and of its image stand apart
MIN_IRREGULAR_WAVES = 20  # waves in a record that statistics of irregular waves need at least
# Sampling error beyond which a record is one of regular waves, which have none: a few frequencies.
REGULAR_ERROR = 0.2
STILL_RANGE = 1e-9  # [m] a range within which a record counts as constant
MAX_ELEVATION = 50.0  # [m] from the median; 29 m is the highest measured (Holliday et al. 2006, Geophys. Res. Lett. 33)
OUTLIER_RATIO = 10.0  # times the usual distance from the median: a wave is within 6
TREND_RATIO = 2.0**0.5  # times the height of the waves alone: beyond it half of the variance is a trend or a tide
GAP_INTERVALS = 1.5  # intervals of a record from one sample to the next: beyond it one is missing
SLOWEST_WAVE = 300.0  # [s] period beyond which the water's level moves, not its waves

LIKE_A_SEA = Rule(
    f"heights are in metres, within {MAX_ELEVATION:g} m of each other, and none stands for a value that is missing"
)
RECORD_FILES = "A wave record, `ocean-sim waves FILE`: a table over time, or OpenFAST's .Elev"
CHECKS = (Checked(RECORD_FILES, (exchange.ELEV_RULE, LIKE_A_SEA)),)


class Unmeasurable(ValueError):
    """Error of a record of heights that cannot be measured; the message gives the reason."""


@dataclass(frozen=True)
class Sea:
    """Sea state measured from a record: wave heights, periods, number of waves; None if a number needs more waves."""

    hs_m: float | None  # mean height of the highest third of the waves
    hm0_m: float  # four times the standard deviation
    tz_s: float | None  # mean time between zero up-crossings
    tp_s: float | None  # period at the peak of the spectrum; None where the record is shorter than three of them
    tm01_s: float | None  # m0 / m1; None where there is no peak period
    tm02_s: float | None  # sqrt(m0 / m2); None where there is no peak period
    waves: int  # from one zero up-crossing to the next
    hmax_m: float | None  # height of the highest wave

    def numbers(self) -> dict[str, float | None]:
        return asdict(self)


def gauge_elevations(path: Path, begin: float) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Times (n,) [s] of a gauges.csv or an .Elev file from `begin` [s] on, and the heights (n,) [m] of each elevation
    gauge by name, but for those that fall dry (NaN); raises ValueError if there are none, or values that no sea has."""
    if path.suffix.lower() == ".elev":
        time, height = exchange.of_openfast(path)
        table = {f"WaveElev{ELEVATION_SUFFIX}": height}
    else:
        table = csv_file.Table(path)
        time = table.series()[0]
    names = [name for name in table if name.endswith(ELEVATION_SUFFIX)]
    if not names:
        raise ValueError(f"{path}: has no elevation gauge (a column <name>{ELEVATION_SUFFIX}); pressures are not waves")
    first = int(np.searchsorted(time, begin))
    if first == len(time):
        raise ValueError(f"{path}: ends at {time[-1]:.12g} s, before --begin {begin:g}")
    if isinstance(table, csv_file.Table):
        names = [name for name in names if not np.isnan(table[name][first:]).any()] or names
        table.finite(*names, since=first)
    for name in names:
        if (row := stand_in_row(table[name][first:])) is not None:
            found = f"{name} is {table[name][first + row]:g} in row {first + row + 1}"
            raise LIKE_A_SEA.broken(path, f"{found}, about {np.median(table[name]):.3g} in others")
    return time[first:], {name.removesuffix(ELEVATION_SUFFIX): table[name][first:] for name in names}


def stand_in_row(heights: np.ndarray) -> int | None:
    """Index of the first of heights (n,) [m] that is a stand-in for a missing one: a row of nines, or far from the
    median in a record that jumps; None if all are plausible."""
    off = np.abs(heights - np.median(heights))
    nines = np.array([re.fullmatch("999+", f"{abs(h):g}".replace(".", "")) is not None for h in heights])
    far = (off > MAX_ELEVATION) & bool((np.abs(np.diff(heights)) > MAX_ELEVATION).any())
    rows = np.flatnonzero(far | nines & (off >= OUTLIER_RATIO * np.median(off)))
    return int(rows[0]) if len(rows) else None


def even_samples(time: np.ndarray, height: np.ndarray) -> tuple[float, np.ndarray]:
    """Sampling interval [s] of a record, and its heights [m] at equal intervals, interpolated if it is sampled
    unevenly; raises Unmeasurable if it is too short or has faulty times or values."""
    if not np.isfinite([time, height]).all():
        raise Unmeasurable("has values that are not numbers")
    if len(time) < MIN_SAMPLES:
        raise Unmeasurable(f"is too short: {len(time)} samples, at least {MIN_SAMPLES} are needed")
    steps = np.diff(time)
    if not (steps > 0.0).all():
        raise Unmeasurable("has times that do not increase")
    interval = float(np.median(steps))
    if np.abs(steps - interval).max() > 1e-3 * interval:
        even = time[0] + interval * np.arange(int((time[-1] - time[0]) / interval + 1e-6) + 1)
        return interval, np.interp(even, time, height)
    return float((time[-1] - time[0]) / (len(time) - 1)), np.asarray(height, dtype=float)


def missing_samples(time: np.ndarray) -> str | None:
    """Sentence on samples that are missing between the times (n,) [s] of a record; None if none are."""
    steps = np.diff(time) / np.median(np.diff(time))
    gaps = np.flatnonzero(steps > GAP_INTERVALS)
    if not len(gaps):
        return None
    count, k = int(np.rint(steps[gaps] - 1.0).sum()), int(gaps[0])
    return f"missing samples, filled by straight lines: {count}, the first after {time[k]:.12g} s (row {k + 1})"


def linear_trend(interval: float, values: np.ndarray) -> float:
    """Slope [m/s] of the least-squares straight line through heights `values` (n,) [m] sampled every `interval` [s]."""
    t = interval * (np.arange(len(values)) - 0.5 * (len(values) - 1))
    return float(t @ values / (t @ t))


@dataclass(frozen=True)
class Treatment:
    """Options for the treatment of a record before its waves are counted: detrending and hysteresis."""

    detrended: bool = False
    """True to take off the straight line through it, not its mean alone: where a tank fills, or a gauge drifts."""
    hysteresis: float = 0.0
    """Depth below zero, and then height above it, that the record must reach for an up-crossing to count [m]: smaller
    noise makes no waves."""

    def deviation(self, values: np.ndarray) -> np.ndarray:
        """Record `values` (n,) [m] less its mean, or less the straight line through it if `detrended`."""
        from scipy.signal import detrend

        return detrend(values, type="linear" if self.detrended else "constant")

    def notes(self) -> dict[str, str]:
        """Notes on those options that differ from the default, by name, for a table of results."""
        found = {"detrended": "less the straight line through each record"} if self.detrended else {}
        return found | ({"hysteresis": f"{self.hysteresis:g} m"} if self.hysteresis else {})


AS_IT_WAS = Treatment()


def slow_part(interval: float, values: np.ndarray, treatment: Treatment) -> str | None:
    """Sentence on a trend or tide in `values` (n,) [m] that is TREND_RATIO times as high as their waves, or None."""
    treated = treatment.deviation(values)
    level = Treatment(detrended=True).deviation(values)
    if not treatment.detrended and treated.std() > max(TREND_RATIO * level.std(), STILL_RANGE):
        factor = f"{treated.std() / level.std():.2g} times" if level.std() > STILL_RANGE else "all of"
        slope = f"a trend of {linear_trend(interval, values):.3g} m/s"
        return f"{slope} makes the height {factor} that of its waves; take --detrend"
    amplitudes = np.fft.rfft(treated)
    amplitudes[np.fft.rfftfreq(len(treated), interval) < 1.0 / SLOWEST_WAVE] = 0.0
    waves = np.fft.irfft(amplitudes, len(treated)).std()
    if STILL_RANGE < TREND_RATIO * waves < treated.std():
        slow = f"what is slower than {SLOWEST_WAVE:g} s, as a tide, makes the height {treated.std() / waves:.2g} times"
        return f"{slow} that of its waves; --detrend takes off a straight line, so measure parts with little tide"
    return None


def up_crossings(interval: float, deviation: np.ndarray, hysteresis: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] from the first sample to the zero up-crossings of a record less its mean (n,) [m], sampled every
    `interval` [s], and indices of the samples before; of several within -/+ `hysteresis` [m] only the last counts."""
    before = np.flatnonzero((deviation[:-1] < 0.0) & (deviation[1:] >= 0.0))
    beyond = np.flatnonzero((deviation < -hysteresis) | (deviation >= hysteresis))
    risen = beyond[1:][(deviation[beyond[:-1]] < 0.0) & (deviation[beyond[1:]] >= 0.0)]
    before = before[np.searchsorted(before, risen) - 1]
    low, high = deviation[before], deviation[before + 1]
    return interval * (before - low / (high - low)), before


def parabola_top(values: np.ndarray) -> float:
    """Maximum of `values` (n,), also between samples: top of the parabola through the greatest and its neighbours."""
    k = int(values.argmax())
    if not 0 < k < len(values) - 1:
        return float(values[k])
    left, top, right = values[k - 1 : k + 2]
    bend = left - 2.0 * top + right
    return float(top - (right - left) ** 2 / (8.0 * bend)) if bend < 0.0 else float(top)


def zero_crossing_waves(
    interval: float, deviation: np.ndarray, hysteresis: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Heights from trough to crest [m] and periods [s] of all waves between zero up-crossings of a record less its mean
    (n,) [m], sampled every `interval` [s]; `hysteresis` as in `up_crossings`."""
    times, before = up_crossings(interval, deviation, hysteresis)
    heights = [
        parabola_top(deviation[begin : end + 2]) + parabola_top(-deviation[begin : end + 2])
        for begin, end in pairwise(before)
    ]
    return np.array(heights), np.diff(times)


def welch_density(
    interval: float, deviation: np.ndarray, segments: int = MAX_SEGMENTS
) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [Hz] and spectral density [m2 s] of a record less its mean, `deviation` (n,) [m], every `interval`
    [s], by Welch's method on overlapping segments; the lowest frequency above 0 is one over a segment's length."""
    from scipy.signal import welch as estimate

    length = max(MIN_SAMPLES // 2, 2 * len(deviation) // (segments + 1))
    return estimate(deviation, 1.0 / interval, nperseg=min(length, len(deviation)), detrend="constant")


def spectral_peak(frequency: np.ndarray, density: np.ndarray) -> float:
    """Peak frequency [Hz]: top of a parabola through the logarithms of the greatest density and its neighbours."""
    k = 1 + int(density[1:].argmax())
    if k + 1 >= len(density) or density[k - 1 : k + 2].min() <= 0.0:
        return float(frequency[k])
    left, top, right = np.log(density[k - 1 : k + 2])
    bend = left - 2.0 * top + right
    shift = 0.5 * (left - right) / bend if bend < 0.0 and k > 1 else 0.0
    return float(frequency[k] + shift * (frequency[1] - frequency[0]))


def segment_count(interval: float, deviation: np.ndarray) -> int:
    """Number of Welch segments: as many, up to MAX_SEGMENTS, as hold SEGMENT_PERIODS peak periods each; else 1."""
    for count in range(MAX_SEGMENTS, 1, -1):
        frequency, density = welch_density(interval, deviation, count)
        if spectral_peak(frequency, density) >= SEGMENT_PERIODS * frequency[1]:
            return count
    return 1


def peak_frequency(interval: float, deviation: np.ndarray) -> float | None:
    """Peak frequency [Hz] of a record as in `welch_density`; None if it holds fewer than RECORD_PERIODS periods."""
    frequency, density = welch_density(interval, deviation, segment_count(interval, deviation))
    found = spectral_peak(frequency, density)
    return found if found >= RECORD_PERIODS * frequency[1] else None


def record_spectra(
    time: np.ndarray, heights: Mapping[str, np.ndarray], treatment: Treatment = AS_IT_WAS
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Frequencies [Hz], and the spectral density [m2 s] of each of several records of heights (n,) [m] at the same
    times (n,) [s], less mean or (`treatment`) trend; all with the segment length of the one that needs the longest."""
    even = {name: even_samples(time, height) for name, height in heights.items()}
    records = {name: (interval, treatment.deviation(values)) for name, (interval, values) in even.items()}
    moving = [record for record in records.values() if np.ptp(record[1]) > STILL_RANGE]
    count = min((segment_count(*record) for record in moving), default=MAX_SEGMENTS)
    estimates = {name: welch_density(*record, count) for name, record in records.items()}
    frequency = next(iter(estimates.values()))[0]
    return frequency, {name: density for name, (_, density) in estimates.items()}


def spectral_moments(interval: float, deviation: np.ndarray, up_to: float) -> tuple[float, float, float]:
    """Moments m0, m1, m2 [m2, m2/s, m2/s2] of the spectrum up to a frequency [Hz]; record as in `welch_density`."""
    n = len(deviation)
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(n) / n)
    power = np.abs(np.fft.rfft(window * deviation)) ** 2
    frequency = np.fft.rfftfreq(n, interval)
    power[0] = 0.0
    power *= deviation.var() / power.sum()
    below = frequency <= up_to
    m0, m1, m2 = (float((power * frequency**order)[below].sum()) for order in range(3))
    return m0, m1, m2


def sampling_error(deviation: np.ndarray) -> float:
    """Relative standard error of the significant height of a record (n,) of a Gaussian sea less its mean: half that of
    m0, sqrt(integral of S^2 / (m0^2 T)), T being its length (Bendat & Piersol 2010, Random Data, 4th ed., section 8.2);
    a periodogram squared is 2 S^2 on average."""
    power = np.abs(np.fft.rfft(deviation)) ** 2
    return 0.5 * float((0.5 * (power**2).sum()) ** 0.5 / power.sum())


def measure_record(time: np.ndarray, height: np.ndarray, treatment: Treatment = AS_IT_WAS) -> Sea:
    """Measure the sea state of a record of heights (n,) [m] at times (n,) [s] with a `treatment`, by default none
    (detrending, hysteresis); raises Unmeasurable if it is faulty or too short. A constant record has heights of 0 and
    no waves; a record without a whole wave between two zero up-crossings has only hm0_m."""
    interval, values = even_samples(time, height)
    deviation = treatment.deviation(values)
    if np.ptp(deviation) <= STILL_RANGE:
        return Sea(0.0, 0.0, None, None, None, None, 0, 0.0)
    heights, periods = zero_crossing_waves(interval, deviation, treatment.hysteresis)
    if not len(heights):
        return Sea(None, 4.0 * float(deviation.std()), None, None, None, None, 0, None)
    steps = np.diff(time)
    if steps.max() > 0.5 * periods.mean():
        k = int(steps.argmax())
        gap = f"has a gap of {steps[k]:.3g} s after {time[k]:.12g} s"
        raise Unmeasurable(f"{gap}, more than half of its mean wave of {periods.mean():.3g} s")
    f_peak = peak_frequency(interval, deviation)
    m0, m1, m2 = (0.0, 0.0, 0.0) if f_peak is None else spectral_moments(interval, deviation, CUT_OFF_PEAKS * f_peak)
    waves = len(heights)
    highest_third = np.sort(heights)[::-1][: max(1, round(waves / 3.0))]
    return Sea(
        hs_m=float(highest_third.mean()),
        hm0_m=4.0 * float(deviation.std()),
        tz_s=float(periods.mean()),
        tp_s=None if f_peak is None else 1.0 / f_peak,
        tm01_s=m0 / m1 if m1 > 0.0 else None,
        tm02_s=(m0 / m2) ** 0.5 if m2 > 0.0 else None,
        waves=waves,
        hmax_m=float(heights.max()),
    )
