"""Common part of washouts by filters: scales, tilt and turns; each kind adds how the platform is displaced.

Reid and Nahon, UTIAS Report 296 (1985). Gravity is removed from the specific force in level axes that head as the ship
does. The rest is scaled and displaces the platform, as the kind says; its slow part along x and y tilts the platform,
slower than people notice. Rates of turn are scaled and high-passed. An angle without a high-pass is followed as it is,
and then shows its own part of gravity.
"""

from collections.abc import Sequence
from typing import Annotated, ClassVar, Protocol

import numpy as np
from pydantic import Field

from ocean_sim.conventions import GRAVITY
from ocean_sim.files.cache_file import cached_arrays
from ocean_sim.model import Model, Positive, Vector3, quantity
from ocean_sim.platform import INPUT_LIMIT, TILT_RATE_LIMIT, Cue
from ocean_sim.platform.shared.motion_log import Ride, euler_rates, turn_to_level

Frequencies = Annotated[tuple[Positive | None, Positive | None, Positive], Field(strict=False)]


class WashingConfig(Model):
    """Config keys that washouts by filters have: scales, tilt, high-pass of angles, and input limits."""

    look_ahead: ClassVar[None] = None

    force_scale: Vector3 = quantity("1")
    """Scale of acceleration along x, y and z."""
    rotation_scale: Vector3 = quantity("1")
    """Scale of roll, pitch and yaw."""
    tilt_frequency: float = quantity("rad/s", gt=0.0)
    """Corner frequency of the low-pass before the tilt, critically damped."""
    tilt_rate_deg: float = quantity("deg/s", 3.0, gt=0.0)
    """Fastest tilt: the threshold at which people notice a turn."""
    rotation_frequency: Frequencies = quantity("rad/s")
    """Corner frequency of the critically damped high-pass of roll, pitch and yaw; null follows the angle itself."""
    acceleration_limit: float = quantity("m/s2", 10.0, gt=0.0)
    """Scaled accelerations are clipped here."""
    rate_limit_deg: float = quantity("deg/s", 60.0, gt=0.0)
    """Scaled rates about axes with a high-pass are clipped here; an angle that is followed itself is not."""


class Travelling(Protocol):
    """Interface of a filter from acceleration of the ship to displacement (travel) of the platform along an axis."""

    def displace(self, acceleration: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Displacements (n,) [m] for scaled accelerations (n,) [m/s2], and (n,) True where an acceleration was cut."""


class Filter:
    """Digital filter of a transfer function (Tustin) for samples `every` [s], which keeps its state between calls."""

    def __init__(self, zeros: Sequence[float], poles: Sequence[complex], gain: float, every: float) -> None:
        """`zeros`, `poles` [rad/s], `gain`: of the transfer function; `every`: time between samples [s]."""
        self.sections = design_sections(zeros, poles, gain, every)
        self.state = np.zeros((len(self.sections), 2))

    def apply(self, signal: np.ndarray) -> np.ndarray:
        """Filtered signal (n,), continuing that of the last call: direct form II transposed, section after section."""
        values, ends = signal.tolist(), []
        for section, (one, two) in zip(self.sections.tolist(), self.state.tolist()):
            b_0, b_1, b_2, _, a_1, a_2 = section
            for k, x in enumerate(values):
                y = b_0 * x + one
                one, two = b_1 * x - a_1 * y + two, b_2 * x - a_2 * y
                values[k] = y
            ends.append((one, two))
        self.state = np.array(ends)
        return np.array(values)


def design_sections(zeros: Sequence[float], poles: Sequence[complex], gain: float, every: float) -> np.ndarray:
    """Second-order sections (m, 6), for rows `every` [s], of the filter gain prod(s - zeros) / prod(s - poles), s in
    [rad/s]; cached on disk, as SciPy's import is slow."""
    import scipy

    def design() -> dict[str, np.ndarray]:
        from scipy.signal import bilinear_zpk, zpk2sos

        return {"sections": zpk2sos(*bilinear_zpk(zeros, poles, gain, 1.0 / every))}

    asked = [np.asarray(part, dtype=complex).tolist() for part in (zeros, poles, [gain, every])]
    return cached_arrays("filters", repr([np.__version__, scipy.__version__, asked]).encode(), design)["sections"]


def second_order(frequency: float, damping: float) -> list[complex]:
    """Poles [rad/s] of s^2 + 2 zeta omega s + omega^2: omega is the frequency [rad/s], zeta the damping ratio."""
    root = np.sqrt(complex(damping**2 - 1.0))
    return [frequency * (-damping + root), frequency * (-damping - root)]


class Tilt:
    """Angle by which a platform tilts so that gravity imitates the slow part of a specific force; rate-limited."""

    def __init__(self, frequency: float, rate: float, every: float) -> None:
        """`frequency`: low-pass corner [rad/s]; `rate`: largest tilt rate [rad/s]; `every`: time between rows [s]."""
        self.slow = Filter([], second_order(frequency, 1.0), frequency**2, every)
        self.step, self.angle = rate * every, 0.0

    def follow_force(self, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Angles (n,) asin(f / g) [rad], f the slow part of `force` (n,) [m/s2]; and (n,) True where rate-limited."""
        wanted = np.arcsin(np.clip(self.slow.apply(force) / GRAVITY, -1.0, 1.0)).tolist()
        angle, step, angles, held = self.angle, self.step, [], []
        for target in wanted:
            turn = target - angle
            held.append(abs(turn) > step)
            angle = target if abs(turn) <= step else angle + (step if turn > 0.0 else -step)
            angles.append(angle)
        self.angle = angle
        return np.array(angles), np.array(held, dtype=bool)


class Washing:
    """Washout of one ride: scaling, tilt coordination, turns, and one filter of displacement along each axis."""

    plans_legs = False

    def __init__(self, config: WashingConfig, every: float, travels: Sequence[Travelling]) -> None:
        """`every`: time between rows [s]; `travels`: filters from acceleration to displacement, along x, y and z."""
        self.config, self.travels = config, travels
        self.tilts = [Tilt(config.tilt_frequency, np.radians(config.tilt_rate_deg), every) for _ in range(2)]
        # s^2 / (s^2 + 2 omega s + omega^2) of a rate, integrated once
        self.turns = [
            None if omega is None else Filter([0.0], second_order(omega, 1.0), 1.0, every)
            for omega in config.rotation_frequency
        ]

    def follow(self, ride: Ride, ahead: object = None) -> Cue:
        """Requested poses, and motion to be felt, for the next rows of ship motion: filtered displacements and turns,
        plus tilt angles. `ahead`, what is known of the rows after them, is not used."""
        config = self.config
        limited = np.zeros(len(ride.time), dtype=int)
        level = turn_to_level(ride.attitude, ride.specific_force) - [0.0, 0.0, GRAVITY]
        acceleration = self.clip_input(level * config.force_scale, config.acceleration_limit, limited)
        rates = euler_rates(ride) * config.rotation_scale * [turn is not None for turn in self.turns]
        rates = self.clip_input(rates, float(np.radians(config.rate_limit_deg)), limited)
        pose = np.zeros((len(ride.time), 6))
        for k, travel in enumerate(self.travels):
            pose[:, k], cut = travel.displace(acceleration[:, k])
            limited[cut] |= INPUT_LIMIT
        for k, turn in enumerate(self.turns):
            pose[:, 3 + k] = ride.attitude[:, k] * config.rotation_scale[k] if turn is None else turn.apply(rates[:, k])
        push = self.lasting_force(ride)
        for k, axis, sign in ((3, 1, 1.0), (4, 0, -1.0)):  # a push lifts the side that it points to
            angle, held = self.tilts[k - 3].follow_force(push[:, axis])
            pose[:, k] += sign * angle
            limited[held] |= TILT_RATE_LIMIT
        return Cue(pose, limited, *scaled_motion(ride, config.force_scale, config.rotation_scale))

    def clip_input(self, wanted: np.ndarray, limit: float, limited: np.ndarray) -> np.ndarray:
        """Copy of `wanted` (n, 3) clipped to +-`limit`; sets the bit INPUT_LIMIT in `limited` (n,) of clipped rows."""
        limited[(np.abs(wanted) > limit).any(axis=1)] |= INPUT_LIMIT
        return np.clip(wanted, -limit, limit)

    def lasting_force(self, ride: Ride) -> np.ndarray:
        """Scaled specific force (n, 2) [m/s2] along x, y, the slow part of which a tilt imitates. Where the platform
        follows the ship's roll or pitch unfiltered, gravity's part is subtracted, since that angle already shows it."""
        force, own = ride.specific_force[:, :2].copy(), rest_force(ride.attitude)
        if self.turns[1] is None:
            force[:, 0] -= own[:, 0]
        if self.turns[0] is None:
            force[:, 1] -= own[:, 1]
        limit = self.config.acceleration_limit
        return np.clip(force * self.config.force_scale[:2], -limit, limit)


def scaled_motion(ride: Ride, force_scale: Vector3, rotation_scale: Vector3) -> tuple[np.ndarray, np.ndarray]:
    """Specific force (n, 3) [m/s2] and rate (n, 3) [rad/s] to be felt: those of the ship, times scales by axis."""
    inertial = (ride.specific_force - rest_force(ride.attitude)) * force_scale
    return inertial + rest_force(ride.attitude * rotation_scale), ride.rate * rotation_scale


def rest_force(attitude: np.ndarray) -> np.ndarray:
    """Specific force (n, 3) [m/s2] of a body at rest, in body axes at attitudes (n, 3) [rad]: g upward."""
    (sr, sp, _), (cr, cp, _) = np.sin(attitude).T, np.cos(attitude).T
    return GRAVITY * np.column_stack([-sp, cp * sr, cp * cr])
