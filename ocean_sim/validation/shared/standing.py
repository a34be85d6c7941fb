"""Standing waves in a closed tank with walls of free slip: the closed form, and what a run makes of it."""

from dataclasses import dataclass
from math import exp, pi, sqrt, tanh

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Promise
from ocean_sim.validation.shared.state import sampled, set_state, state

VISCOUS = "viscous dispersion relation, Lamb art. 349"
STEEP = f"{VISCOUS}; of its amplitude, Tadjbakhsh & Keller 1960"


@dataclass(frozen=True)
class StandingWave:
    """A mode of a tank from -length/2 to length/2, the still water at y = 0."""

    length: float  # [m]
    depth: float  # [m]
    mode: int  # half waves in the tank
    amplitude: float  # [m]
    gravity: float  # [m/s2]

    @property
    def k(self) -> float:
        """Wavenumber [1/m]."""
        return self.mode * pi / self.length

    @property
    def omega(self) -> float:
        """[1/s] by the dispersion relation."""
        return sqrt(self.gravity * self.k * tanh(self.k * self.depth))

    @property
    def period(self) -> float:
        """[s]"""
        return 2.0 * pi / self.omega

    def viscosity(self, reynolds: float) -> float:
        """nu [m2/s] at a Reynolds number sqrt(g h) h / nu."""
        return sqrt(self.gravity * self.depth) * self.depth / reynolds

    def leading_rate(self, viscosity: float) -> float:
        """Decay rate [1/s] to leading order in the viscosity [m2/s]: 2 nu k^2 (Lamb, Hydrodynamics, art. 348)."""
        return 2.0 * viscosity * self.k**2

    def viscous_root(self, viscosity: float) -> complex:
        """n [1/s] of a wave exp(n t) in deep water of a viscosity [m2/s]: the root near i w of (n + 2 nu k^2)^2 + w^2 =
        4 nu^2 k^4 sqrt(1 + n / (nu k^2)) (Lamb, art. 349). -1 / real part is its decay time, 2 pi / imaginary part its
        period."""
        if viscosity == 0.0:
            return 1j * self.omega
        shear = viscosity * self.k**2
        n = 1j * self.omega
        for _ in range(100):
            n = -2.0 * shear + 1j * np.sqrt(self.omega**2 - 4.0 * shear**2 * np.sqrt(1.0 + n / shear))
        return complex(n)

    def finite_period(self, root: complex, times: np.ndarray) -> float:
        """Period [s] that `damped_cosine` finds in a wave exp(root t) of linear theory that has this amplitude at the
        start: as steep as it still is, k a, its frequency is higher by a share w2 (k a)^2 / 2 w0 with w0^2 = tanh(k h)
        and w2 = (9 w0^-7 - 12 w0^-3 - 3 w0 - 2 w0^5) / 32 (Tadjbakhsh & Keller 1960, J. Fluid Mech. 8); in deep water
        lower by (k a)^2 / 8."""
        from scipy.integrate import cumulative_trapezoid

        w0 = sqrt(tanh(self.k * self.depth))
        w2 = (9.0 * w0**-7 - 12.0 * w0**-3 - 3.0 * w0 - 2.0 * w0**5) / 32.0
        steep = self.k * self.amplitude * np.exp(root.real * times)
        frequency = root.imag * (1.0 + 0.5 * w2 / w0 * steep**2)
        phase = cumulative_trapezoid(frequency, times, initial=0.0)
        return self.damped_cosine(times, np.cos(phase) * np.exp(root.real * times))[0]

    def flow(self, position: np.ndarray) -> np.ndarray:
        """Velocity of the wave of amplitude 1 m as it passes through the level, in linear theory [m/s]."""
        x, y = position[:, 0] + 0.5 * self.length, position[:, 1] + self.depth
        scale = self.gravity * self.k / self.omega / np.cosh(self.k * self.depth)
        along, up = -np.sin(self.k * x) * np.cosh(self.k * y), np.cos(self.k * x) * np.sinh(self.k * y)
        return scale * np.stack([along, up, np.zeros_like(x)], axis=1)

    def signal(self, times: np.ndarray, rate: float) -> np.ndarray:
        """Velocity over its first amplitude at times [s], with a decay rate [1/s]."""
        return np.cos(self.omega * times) * np.exp(-rate * times)

    def amplitude_kept(self, rate: float) -> float:
        """Amplitude over that of a period before, with a decay rate [1/s]."""
        return exp(-rate * self.period)

    def finding(
        self,
        promises: tuple[Promise, ...],
        numbers: tuple[tuple[float, float, float], ...],
        times: np.ndarray,
        share: np.ndarray,
        rate: float,
    ) -> Finding:
        """What was promised of a run, and its curve next to that of a decay rate [1/s]."""
        return Finding(
            {promise.quantity: number for promise, number in zip(promises, numbers, strict=True)},
            [Curve("wave", times / self.period, share)],
            [Curve("linear theory", times / self.period, self.signal(times, rate))],
            ("t / T", "velocity over its first amplitude"),
        )

    def run(self, simulation: Simulation) -> tuple[np.ndarray, np.ndarray]:
        """Start the wave in water at rest: times [s], and the part of the velocity that is the wave's, over its first
        amplitude."""
        start = state(simulation).position
        set_state(simulation, start, self.amplitude * self.flow(start))
        times, share = [], []
        for water in sampled(simulation, simulation.scene.duration, self.period / 60):
            mode = self.flow(np.minimum(water.position, [np.inf, 0.0, np.inf]))
            times.append(water.time)
            share.append(float((water.velocity * mode).sum() / (mode * mode).sum()) / self.amplitude)
        return np.array(times), np.array(share)

    def damped_cosine(self, times: np.ndarray, signal: np.ndarray) -> tuple[float, float]:
        """Period [s] and decay rate [1/s] of the a cos(w t + b) exp(-c t) nearest to a signal, from a quarter of a
        period on: before, it holds the sound of the start."""
        from scipy.optimize import curve_fit

        def model(t: np.ndarray, a: float, b: float, omega: float, rate: float) -> np.ndarray:
            return a * np.cos(omega * t + b) * np.exp(-rate * t)

        settled = times > 0.25 * self.period
        (_, _, omega, rate), _ = curve_fit(model, times[settled], signal[settled], p0=(1.0, 0.0, self.omega, 0.01))
        return 2.0 * pi / abs(omega), rate


DEEP = StandingWave(length=2.0, depth=1.0, mode=2, amplitude=0.05, gravity=1.0)
"""Colagrossi, Souto-Iglesias, Antuono & Marrone (2013, Phys. Rev. E 87, 023302): k h is pi."""
