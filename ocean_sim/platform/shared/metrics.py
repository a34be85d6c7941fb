"""Metrics of a platform on a ride: gain, delay, false cues, and motion sickness."""

from typing import NamedTuple

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.platform import LIMIT_TEXTS, Commands
from ocean_sim.platform.shared import kinematics, leg_programme
from ocean_sim.platform.shared.kinematics import Hexapod
from ocean_sim.platform.shared.motion_log import Ride, turn_to_level

LONGEST_DELAY = 2.0  # [s]
MIN_RMS = 1e-9  # of a motion


class Metric(NamedTuple):
    """One measure of a platform's ride, a row of metrics.csv: name, value, unit."""

    quantity: str
    value: float  # NaN where it is not defined
    unit: str


def ride_metrics(ride: Ride, done: Commands, hexapod: Hexapod, every: float) -> list[Metric]:
    """Metrics of the motion that a platform has `done`, in rows `every` [s] apart, for the ship motion `ride`: felt
    against scaled motion, share of limited rows, legs, motion sickness."""
    felt, scaled = felt_motions(done.pose, every), np.hstack([done.cue.force, done.cue.rate])
    names = [f"force_{axis}" for axis in "xyz"] + [f"rate_{axis}" for axis in "xyz"]
    found = []
    for k, name in enumerate(names):
        unit = "m/s2" if name.startswith("force") else "rad/s"
        found += compare_motion(name, unit, felt[:, k] - rest_value(name), scaled[:, k] - rest_value(name), every)
    share = float((done.limited > 0).mean())
    found.append(Metric("share_limited", share, "1"))
    found += [Metric(f"share_limited_{bit}", float((done.limited & bit > 0).mean()), "1") for bit in LIMIT_TEXTS]
    found.append(Metric("stroke_used", float(hexapod.usage(done.pose).max()) + 0.0, "1"))
    found.append(Metric("leg_speed_max", float(np.abs(done.leg_velocity).max()), "m/s"))
    acceleration = np.abs(np.diff(done.leg_velocity, axis=0)).max(initial=0.0) / every
    found.append(Metric("leg_acceleration_max", float(acceleration), "m/s2"))
    ship = turn_to_level(ride.attitude, ride.specific_force)[:, 2] - GRAVITY
    platform = np.diff(done.pose[:, 2], n=2, prepend=[0.0, 0.0]) / every**2
    found.append(Metric("heave_gain", motion_gain(platform, ship, every), "1"))
    found.append(Metric("motion_sickness_dose_ship", sickness_dose(ship, every), "m/s1.5"))
    found.append(Metric("motion_sickness_dose_platform", sickness_dose(platform, every), "m/s1.5"))
    return found


def possible_shares(done: Commands, best: Commands, every: float) -> list[Metric]:
    """Metrics: rms of the error that the senses feel, over their thresholds, in commands `done` and in the `best`
    possible; ratios best over done, of all motion and of each component. `every`: time between rows [s]."""
    scaled, sizes = np.hstack([done.cue.force, done.cue.rate]), []
    for ride in (best, done):
        sensed = leg_programme.sensed_error(felt_motions(ride.pose, every) - scaled, every)[0]
        sizes.append([rms(sensed), *(rms(column) for column in sensed.T)])
    names = ("all", *(f"force_{axis}" for axis in "xyz"), *(f"rate_{axis}" for axis in "xyz"))
    found = [Metric(f"share_of_possible_{name}", b / d, "1") for name, b, d in zip(names, *sizes)]
    return [Metric("sensed_error", sizes[1][0], "1"), Metric("sensed_error_best", sizes[0][0], "1"), *found]


def felt_motions(pose: np.ndarray, every: float) -> np.ndarray:
    """Specific force [m/s2] and rate [rad/s] (n, 6), platform axes, at poses `every` [s], by central differences."""
    known = np.vstack([2.0 * pose[0] - pose[1], pose, 2.0 * pose[-1] - pose[-2]])
    acceleration = np.diff(known[:, :3], n=2, axis=0) / every**2
    return np.hstack(kinematics.felt_motion(pose, acceleration, (known[2:, 3:] - known[:-2, 3:]) / (2.0 * every)))


def rest_value(name: str) -> float:
    """Value of the motion component `name` (as `rate_x`) on a platform at rest in neutral: g for `force_z`, else 0."""
    return GRAVITY if name == "force_z" else 0.0


def compare_motion(name: str, unit: str, felt: np.ndarray, scaled: np.ndarray, every: float) -> list[Metric]:
    """Six metrics of a motion component `name`, in `unit`: rms of `felt` (n,), on the platform, of `scaled` (n,), to be
    felt, and of their difference; correlation, delay, largest false cue. `every`: between rows [s]."""
    against = felt * np.sign(scaled) < 0.0
    return [
        Metric(f"{name}_scaled_rms", rms(scaled), unit),
        Metric(f"{name}_felt_rms", rms(felt), unit),
        Metric(f"{name}_error_rms", rms(felt - scaled), unit),
        Metric(f"{name}_correlation", correlation(felt, scaled), "1"),
        Metric(f"{name}_delay", best_delay(felt, scaled, every), "s"),
        Metric(f"{name}_false_cue", float(np.abs(felt[against]).max(initial=0.0)), unit),
    ]


def rms(signal: np.ndarray) -> float:
    return float(np.sqrt(np.mean(signal**2)))


def correlation(one: np.ndarray, other: np.ndarray) -> float:
    """Correlation coefficient of signals `one` and `other` (n,), or NaN if one of them is constant."""
    a, b = one - one.mean(), other - other.mean()
    size = rms(a) * rms(b)
    return float(np.mean(a * b) / size) if rms(a) > MIN_RMS and rms(b) > MIN_RMS else float("nan")


def best_delay(felt: np.ndarray, scaled: np.ndarray, every: float) -> float:
    """Delay [s] of `felt` after `scaled`, rows `every` [s], of best correlation; < 0: it leads; NaN: one is flat."""
    products = delayed_products(felt, scaled, every)
    if np.isnan(products[0]):
        return float("nan")
    return float((np.argmax(products) - len(products) // 2) * every)


def motion_gain(felt: np.ndarray, given: np.ndarray, every: float) -> float:
    """Gain from signal `given` (n,) to `felt` (n,), in rows `every` [s]: cross-correlation at the best delay over the
    sum of squares of `given`."""
    products = delayed_products(felt, given, every)
    return float(products.max() / np.sum((given - given.mean()) ** 2))


def delayed_products(felt: np.ndarray, given: np.ndarray, every: float) -> np.ndarray:
    """Cross-correlation (2 m + 1,) of `felt` (n,), -m to m rows `every` [s] after `given` (n,); one NaN if one is
    flat."""
    from scipy.signal import correlate

    a, b = felt - felt.mean(), given - given.mean()
    if not (rms(a) > MIN_RMS and rms(b) > MIN_RMS):
        return np.array([np.nan])
    n = len(a)
    most = min(n - 1, round(LONGEST_DELAY / every))
    return correlate(a, b, mode="full", method="fft")[n - 1 - most : n + most]


def sickness_dose(vertical: np.ndarray, every: float) -> float:
    """Motion sickness dose value [m/s^1.5] (ISO 2631-1, W_f) of vertical acceleration (n,) [m/s2], rows `every` [s]."""
    from scipy.signal import sosfilt

    return float(np.sqrt(np.sum(sosfilt(sickness_weighting(every), vertical) ** 2) * every))


def sickness_weighting(every: float) -> np.ndarray:
    """Filter W_f of ISO 2631-1:1997, annex A, as second-order sections for rows `every` [s]: limits at 0.08 and 0.63
    Hz, transition at 0.25 Hz, upward step from 0.0625 to 0.1 Hz."""
    from scipy.signal import bilinear_zpk, zpk2sos

    def pole_pair(frequency: float, quality: float) -> np.ndarray:
        omega = 2.0 * np.pi * frequency
        return np.roots([1.0, omega / quality, omega**2]).astype(complex)

    transition, low_step, high_step = pole_pair(0.25, 0.86), pole_pair(0.0625, 0.80), pole_pair(0.1, 0.80)
    low, high = pole_pair(0.08, 0.5**0.5), pole_pair(0.63, 0.5**0.5)
    gain = np.prod(high).real * np.prod(transition).real  # all but the steps, which go from (f5 / f6)^2 to 1 at first
    zeros = np.concatenate([[0.0, 0.0], low_step])
    return zpk2sos(*bilinear_zpk(zeros, np.concatenate([low, high, transition, high_step]), gain, 1.0 / every))
