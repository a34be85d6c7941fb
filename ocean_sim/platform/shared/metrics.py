"""How well a platform reproduces a ride: gain, delay, false cues, and motion sickness."""

from typing import NamedTuple

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.platform import LIMITS, Commands
from ocean_sim.platform.shared import kinematics
from ocean_sim.platform.shared.kinematics import Hexapod
from ocean_sim.platform.shared.motion_log import Ride, turned

LONGEST_DELAY = 2.0  # [s]
LITTLE = 1e-9  # rms below which nothing moves


class Metric(NamedTuple):
    quantity: str
    value: float  # NaN where it is not defined
    unit: str


def metrics(ride: Ride, done: Commands, hexapod: Hexapod, every: float) -> list[Metric]:
    """The metrics of a ride and of the platform's commands; felt against the scaled motion of the ship, both at the
    time of a row: all poses are known here, those that follow too."""
    felt, scaled = felt_by(done.pose, every), np.hstack([done.cue.force, done.cue.rate])
    names = [f"force_{axis}" for axis in "xyz"] + [f"rate_{axis}" for axis in "xyz"]
    found = []
    for k, name in enumerate(names):
        unit = "m/s2" if name.startswith("force") else "rad/s"
        found += compared(name, unit, felt[:, k] - resting(name), scaled[:, k] - resting(name), every)
    share = float((done.limited > 0).mean())
    found.append(Metric("share_limited", share, "1"))
    found += [Metric(f"share_limited_{bit}", float((done.limited & bit > 0).mean()), "1") for bit in LIMITS]
    found.append(Metric("stroke_used", float(hexapod.usage(done.pose).max()) + 0.0, "1"))
    found.append(Metric("leg_speed_max", float(np.abs(done.leg_velocity).max()), "m/s"))
    acceleration = np.abs(np.diff(done.leg_velocity, axis=0)).max(initial=0.0) / every
    found.append(Metric("leg_acceleration_max", float(acceleration), "m/s2"))
    ship = turned(ride.attitude, ride.specific_force)[:, 2] - GRAVITY
    platform = np.diff(done.pose[:, 2], n=2, prepend=[0.0, 0.0]) / every**2
    found.append(Metric("heave_gain", gain(platform, ship, every), "1"))
    found.append(Metric("motion_sickness_dose_ship", dose(ship, every), "m/s1.5"))
    found.append(Metric("motion_sickness_dose_platform", dose(platform, every), "m/s1.5"))
    return found


def felt_by(pose: np.ndarray, every: float) -> np.ndarray:
    """(n, 6) specific force [m/s2] and rate [rad/s] on a platform in (n, 6) poses, by central differences; it is not
    accelerated in the first and the last."""
    known = np.vstack([2.0 * pose[0] - pose[1], pose, 2.0 * pose[-1] - pose[-2]])
    acceleration = np.diff(known[:, :3], n=2, axis=0) / every**2
    return np.hstack(kinematics.felt(pose, acceleration, (known[2:, 3:] - known[:-2, 3:]) / (2.0 * every)))


def resting(name: str) -> float:
    """What is felt in neutral without any motion."""
    return GRAVITY if name == "force_z" else 0.0


def compared(name: str, unit: str, felt: np.ndarray, scaled: np.ndarray, every: float) -> list[Metric]:
    """One motion, felt against scaled."""
    against = felt * np.sign(scaled) < 0.0
    return [
        Metric(f"{name}_scaled_rms", rms(scaled), unit),
        Metric(f"{name}_felt_rms", rms(felt), unit),
        Metric(f"{name}_error_rms", rms(felt - scaled), unit),
        Metric(f"{name}_correlation", correlation(felt, scaled), "1"),
        Metric(f"{name}_delay", delay(felt, scaled, every), "s"),
        Metric(f"{name}_false_cue", float(np.abs(felt[against]).max(initial=0.0)), unit),
    ]


def rms(signal: np.ndarray) -> float:
    return float(np.sqrt(np.mean(signal**2)))


def correlation(one: np.ndarray, other: np.ndarray) -> float:
    """Of the deviations from the means; NaN where one does not move."""
    a, b = one - one.mean(), other - other.mean()
    size = rms(a) * rms(b)
    return float(np.mean(a * b) / size) if rms(a) > LITTLE and rms(b) > LITTLE else float("nan")


def delay(felt: np.ndarray, scaled: np.ndarray, every: float) -> float:
    """By which `felt` has to be brought forward for the best correlation [s]; negative where it leads."""
    products = delayed_products(felt, scaled, every)
    if np.isnan(products[0]):
        return float("nan")
    return float((np.argmax(products) - len(products) // 2) * every)


def gain(felt: np.ndarray, given: np.ndarray, every: float) -> float:
    """Of the part of `felt` that follows `given` at the delay that suits it best; shocks and other motions are none of
    it, which the ratio of their rms would count."""
    products = delayed_products(felt, given, every)
    return float(products.max() / np.sum((given - given.mean()) ** 2))


def delayed_products(felt: np.ndarray, given: np.ndarray, every: float) -> np.ndarray:
    """(2 m + 1,) sums of products of the deviations from the means, `felt` brought forward by -m to m steps, at most
    LONGEST_DELAY; NaN where one does not move."""
    from scipy.signal import correlate

    a, b = felt - felt.mean(), given - given.mean()
    if not (rms(a) > LITTLE and rms(b) > LITTLE):
        return np.array([np.nan])
    n = len(a)
    most = min(n - 1, round(LONGEST_DELAY / every))
    return correlate(a, b, mode="full", method="fft")[n - 1 - most : n + most]


def dose(vertical: np.ndarray, every: float) -> float:
    """Motion sickness dose value [m/s^1.5] of a vertical acceleration [m/s2]: ISO 2631-1, weighting W_f."""
    from scipy.signal import sosfilt

    return float(np.sqrt(np.sum(sosfilt(sickness_weighting(every), vertical) ** 2) * every))


def sickness_weighting(every: float) -> np.ndarray:
    """Second-order sections of W_f (ISO 2631-1:1997, annex A): limits at 0.08 and 0.63 Hz, transition at 0.25 Hz,
    upward step from 0.0625 to 0.1 Hz."""
    from scipy.signal import bilinear_zpk, zpk2sos

    def pair(frequency: float, quality: float) -> np.ndarray:
        omega = 2.0 * np.pi * frequency
        return np.roots([1.0, omega / quality, omega**2]).astype(complex)

    transition, low_step, high_step = pair(0.25, 0.86), pair(0.0625, 0.80), pair(0.1, 0.80)
    low, high = pair(0.08, 0.5**0.5), pair(0.63, 0.5**0.5)
    gain = np.prod(high).real * np.prod(transition).real  # all but the steps, which go from (f5 / f6)^2 to 1 at first
    zeros = np.concatenate([[0.0, 0.0], low_step])
    return zpk2sos(*bilinear_zpk(zeros, np.concatenate([low, high, transition, high_step]), gain, 1.0 / every))
