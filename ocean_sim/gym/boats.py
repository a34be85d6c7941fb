"""Many boats at once in seas of plane waves: course by Nomoto's law, heave, roll and pitch as oscillators in the waves.

Nomoto et al. (1957, Int. Shipbuild. Prog. 4): T r' + r = K delta, K and 1/T in proportion to the speed. Heave, roll and
pitch have a natural period and a damping ratio each, and are driven by elevation and slopes of the waves, averaged over
the boat's length and breadth (sin(a)/a) at half her draught (Smith effect). Coupling and short waves, as strip and
panel methods have them, are left out; a scene with a ship has them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ocean_sim import waves

WAVE_COUNT = 20  # of a random sea


@dataclass(frozen=True)
class Boat:
    """Parameters of a boat: size, periods, damping, speed and rudder; by default those of a yacht of 15 m and 30 t."""

    length: float = 15.0  # [m]
    breadth: float = 4.6  # [m]
    draught: float = 1.0  # [m]
    periods: tuple[float, float, float] = (2.5, 3.5, 2.6)  # of heave, roll and pitch [s]
    damping: tuple[float, float, float] = (0.2, 0.08, 0.2)  # of critical
    cruise: float = 5.0  # speed at half throttle [m/s]
    speeding: float = 8.0  # time in which the speed follows [s]
    turning: float = 0.4  # K: rate of turn over the angle of the rudder at cruise [1/s]
    turning_time: float = 2.0  # T at cruise [s]
    rudder: float = 0.6  # the largest angle [rad]
    rudder_rate: float = 0.3  # [rad/s]
    yawing: float = 0.3  # rate of turn that waves give, over the rate at which the slope across her turns


class Boats:
    """Motion of n equal boats, each in a sea of m plane waves of her own."""

    def __init__(self, boat: Boat, n: int, m: int, depth: float) -> None:
        """`n` boats with `m` waves each, in water of one depth [m]; `begin` sets their seas."""
        self.boat, self.depth = boat, depth
        self.amplitude, self.phase, self.omega = np.zeros((n, m)), np.zeros((n, m)), np.ones((n, m))
        self.wavevector = np.ones((n, m, 2))
        self.felt = np.zeros((n, m))  # amplitude at the depth of half the draught [m]
        self.time, self.place = np.zeros(n), np.zeros((n, 2))  # [s], x and z [m]
        self.heading, self.yaw_rate, self.speed = np.zeros(n), np.zeros(n), np.zeros(n)
        self.helm = np.zeros(n)  # angle of the rudder [rad]
        self.state, self.velocity = np.zeros((n, 3)), np.zeros((n, 3))  # heave [m], roll and pitch [rad], and rates

    @property
    def heave(self) -> np.ndarray:
        """Heave (n,) [m] of the boats, positive upward."""
        return self.state[:, 0]

    @property
    def angles(self) -> np.ndarray:
        """Roll and pitch (n, 2) [rad] of the boats."""
        return self.state[:, 1:]

    @property
    def rates(self) -> np.ndarray:
        """Rates of roll and pitch (n, 2) [rad/s]."""
        return self.velocity[:, 1:]

    def begin(self, which: np.ndarray, seas: Sequence[waves.Components], heading: np.ndarray, speed: float) -> None:
        """Start the boats in the mask `which` (n,) at the origin with `speed` [m/s], without heave, roll or pitch.
        `seas` and `heading` [rad] belong to these boats, in order."""
        for k, sea in zip(np.flatnonzero(which), seas):
            self.amplitude[k], self.phase[k], self.omega[k] = sea.amplitude, sea.phase, sea.omega
            self.wavevector[k] = sea.wavevector
            self.felt[k] = sea.amplitude * np.exp(-0.5 * sea.wavenumber * self.boat.draught)
        self.time[which], self.place[which], self.heading[which], self.speed[which] = 0.0, 0.0, heading, speed
        self.yaw_rate[which], self.helm[which], self.state[which], self.velocity[which] = 0.0, 0.0, 0.0, 0.0

    def bow_direction(self) -> np.ndarray:
        """Unit vectors (n, 2), x and z, from each boat to her bow."""
        return np.stack([np.sin(self.heading), np.cos(self.heading)], axis=1)

    def wave_phases(self, place: np.ndarray, later: float) -> np.ndarray:
        """Phases (n, m) [rad] of each boat's waves, `later` [s] from now, at a `place` x, z (n, 2) [m] per boat."""
        x, z = place[:, 0, None], place[:, 1, None]
        k = self.wavevector
        turns = k[:, :, 0] * x + k[:, :, 1] * z - self.omega * (self.time[:, None] + later) + self.phase
        turns /= 2.0 * np.pi
        turns -= np.floor(turns)  # small, so that single precision, which is several times quicker, is enough
        return np.float32(2.0 * np.pi) * turns.astype(np.float32)

    def elevation_at_bow(self, later: float) -> np.ndarray:
        """Elevation (n,) [m] under the bow `later` [s] from now, if the boat keeps her course and speed."""
        bow = self.place + self.bow_direction() * (0.5 * self.boat.length + self.speed * later)[:, None]
        return (self.amplitude * np.cos(self.wave_phases(bow, later))).sum(axis=1)

    def wave_forcing(self) -> tuple[np.ndarray, np.ndarray]:
        """Heave [m], roll, pitch [rad] (n, 3) of boats at rest in the waves of this moment, about which they oscillate;
        and the yaw rate (n,) [rad/s] caused by waves."""
        ahead, boat = self.bow_direction(), self.boat
        along = (self.wavevector * ahead[:, None]).sum(axis=2)
        across = self.wavevector[:, :, 0] * ahead[:, 1, None] - self.wavevector[:, :, 1] * ahead[:, 0, None]  # to port
        felt = self.felt * mean_over(along * (0.5 * boat.length)) * mean_over(across * (0.5 * boat.breadth))
        angle = self.wave_phases(self.place, 0.0)
        c, s = felt * np.cos(angle), felt * np.sin(angle)
        slope_up_port, slope_up_bow = -(across * s).sum(axis=1), -(along * s).sum(axis=1)
        yaw = -(across * along * c).sum(axis=1) * boat.length * self.boat.yawing
        return np.stack([c.sum(axis=1), slope_up_port, -slope_up_bow], axis=1), yaw

    def advance(self, helm: np.ndarray, throttle: np.ndarray, dt: float) -> None:
        """Step by dt [s] with helm (n,), -1 to 1 (port), and throttle (n,), 0 to 1. Heave, roll and pitch are solved
        exactly for waves that do not change during the step."""
        boat = self.boat
        wanted, waving = self.wave_forcing()
        self.helm += np.clip(helm * boat.rudder - self.helm, -boat.rudder_rate * dt, boat.rudder_rate * dt)
        pace = np.maximum(self.speed / boat.cruise, 0.05)
        target = boat.turning * pace * self.helm + waving
        self.yaw_rate += (target - self.yaw_rate) * -np.expm1(-dt * pace / boat.turning_time)
        self.speed += (boat.cruise * np.sqrt(2.0 * throttle) - self.speed) * -np.expm1(-dt / boat.speeding)
        omega, zeta = 2.0 * np.pi / np.array(boat.periods), np.array(boat.damping)
        damped, decay = omega * np.sqrt(1.0 - zeta**2), np.exp(-zeta * omega * dt)
        c, s = decay * np.cos(damped * dt), decay * np.sin(damped * dt)
        off = self.state - wanted
        swing = (self.velocity + zeta * omega * off) / damped
        self.state = wanted + c * off + s * swing
        self.velocity = -zeta * omega * (c * off + s * swing) + damped * (c * swing - s * off)
        self.heading = self.heading + self.yaw_rate * dt
        self.place = self.place + self.bow_direction() * (self.speed * dt)[:, None]
        self.time += dt


def random_sea(height: float, period: float, heading_deg: float, depth: float, seed: int) -> waves.Components:
    """Random sea of plane waves: significant height [m], peak period [s], mean direction [deg], water depth [m]."""
    sea = waves.Spectrum(significant_wave_height=1.0, peak_period=period, heading_deg=heading_deg, seed=seed)
    whole = sea.components(waves.heading_vector(heading_deg, 3), depth, count=WAVE_COUNT)
    return replace(whole, amplitude=height * whole.amplitude)


def mean_over(half: np.ndarray) -> np.ndarray:
    """Mean of a wave over a length, divided by its value in the middle: sin(a) / a. `half`: a, half its phase [rad]."""
    a = half.astype(np.float32)
    a = np.where(np.abs(a) < 1e-4, np.float32(1e-4), a)
    return np.sin(a) / a
