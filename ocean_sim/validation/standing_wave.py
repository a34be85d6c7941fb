"""A standing wave in a tank: its period and its decay.

Set-up of Colagrossi, Souto-Iglesias, Antuono & Marrone (2013, Phys. Rev. E 87, 023302): g = 1 m/s2, H = 1 m, tank and
wave 2 m long, amplitude 0.05 m, free slip. The amplitude falls as exp(-2 nu k^2 t) (Lamb, Hydrodynamics, art. 348).
That is the leading order for small viscosity; at Re 250 the full relation (art. 349, deep water) decays 10 %
slower, and its period is 0.5 % longer than without viscosity. At its steepness, k a = 0.16, its period is 0.3 % longer
than that of linear theory (Tadjbakhsh & Keller 1960).
The set-up with nominal viscosity 0 measures the viscosity that a scheme adds by itself.
"""

from dataclasses import dataclass
from math import exp, pi, sqrt, tanh

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Number, Problem, Promise, absolute_error, percent_error
from ocean_sim.validation.shared.state import State, particle_state, record_run, set_state

SET_UP_SOURCE = "Colagrossi et al. 2013"
DECAY_SOURCE = f"exp(-2 nu k^2 t), Lamb art. 348; {SET_UP_SOURCE}"
VISCOUS_SOURCE = "viscous dispersion relation, Lamb art. 349"
STEEP_SOURCE = f"{VISCOUS_SOURCE}; of its amplitude, Tadjbakhsh & Keller 1960"


@dataclass(frozen=True)
class StandingWave:
    """Standing-wave mode of a tank that reaches from x = -length/2 to length/2, with the still level at y = 0."""

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
        """Angular frequency [1/s] by the dispersion relation."""
        return sqrt(self.gravity * self.k * tanh(self.k * self.depth))

    @property
    def period(self) -> float:
        """Period [s] by the dispersion relation, without viscosity."""
        return 2.0 * pi / self.omega

    def viscosity(self, reynolds: float) -> float:
        """Kinematic viscosity [m2/s] for a Reynolds number sqrt(g h) h / nu."""
        return sqrt(self.gravity * self.depth) * self.depth / reynolds

    def leading_rate(self, viscosity: float) -> float:
        """Decay rate [1/s] to leading order in the viscosity [m2/s]: 2 nu k^2 (Lamb, Hydrodynamics, art. 348)."""
        return 2.0 * viscosity * self.k**2

    def viscous_root(self, viscosity: float) -> complex:
        """Complex rate n [1/s] of a wave exp(n t) in deep water of a viscosity [m2/s]: the root near i w of (n + 2 nu
        k^2)^2 + w^2 = 4 nu^2 k^4 sqrt(1 + n / (nu k^2)) (Lamb, art. 349). -1 / real part is the decay time, 2 pi /
        imaginary part the period."""
        if viscosity == 0.0:
            return 1j * self.omega
        shear = viscosity * self.k**2
        n = 1j * self.omega
        for _ in range(100):
            n = -2.0 * shear + 1j * np.sqrt(self.omega**2 - 4.0 * shear**2 * np.sqrt(1.0 + n / shear))
        return complex(n)

    def steep_period(self, root: complex, times: np.ndarray) -> float:
        """Period [s] that `fit_damped_cosine` finds at times (n,) [s] in a wave exp(root t) of this steepness.

        At a steepness k a the frequency of linear theory rises by a share w2 (k a)^2 / 2 w0, with w0^2 = tanh(k h) and
        w2 = (9 w0^-7 - 12 w0^-3 - 3 w0 - 2 w0^5) / 32 (Tadjbakhsh & Keller 1960, J. Fluid Mech. 8); in deep water it
        falls by (k a)^2 / 8.
        """
        from scipy.integrate import cumulative_trapezoid

        w0 = sqrt(tanh(self.k * self.depth))
        w2 = (9.0 * w0**-7 - 12.0 * w0**-3 - 3.0 * w0 - 2.0 * w0**5) / 32.0
        steep = self.k * self.amplitude * np.exp(root.real * times)
        frequency = root.imag * (1.0 + 0.5 * w2 / w0 * steep**2)
        phase = cumulative_trapezoid(frequency, times, initial=0.0)
        return self.fit_damped_cosine(times, np.cos(phase) * np.exp(root.real * times))[0]

    def unit_flow(self, position: np.ndarray) -> np.ndarray:
        """Velocity (n, 3) [m/s] at positions (n, 3) [m] in a linear wave of amplitude 1 m when its surface is level."""
        x, y = position[:, 0] + 0.5 * self.length, position[:, 1] + self.depth
        scale = self.gravity * self.k / self.omega / np.cosh(self.k * self.depth)
        along, up = -np.sin(self.k * x) * np.cosh(self.k * y), np.cos(self.k * x) * np.sinh(self.k * y)
        return scale * np.stack([along, up, np.zeros_like(x)], axis=1)

    def amplitude_ratio(self, rate: float) -> float:
        """Ratio of amplitudes one period apart, later over earlier, for a decay rate [1/s]."""
        return exp(-rate * self.period)

    def finding(self, numbers: tuple[Number, ...], times: np.ndarray, share: np.ndarray, rate: float) -> Finding:
        """Finding with these numbers, and curves over times (n,) [s]: velocity over its first amplitude `share` (n,),
        and linear theory with a decay `rate` [1/s]."""
        measured = [Curve("wave", times / self.period, share)]
        theory = np.cos(self.omega * times) * np.exp(-rate * times)
        expected = [Curve("linear theory", times / self.period, theory)]
        return Finding(numbers, measured, expected, ("t / T", "velocity over its first amplitude"))

    def amplitude_share(self, water: State) -> float:
        """Ratio of the mode's velocity amplitude to that at the start; negative if it moves the opposite way."""
        mode = self.unit_flow(np.minimum(water.position, [np.inf, 0.0, np.inf]))
        return float((water.velocity * mode).sum() / (mode * mode).sum()) / self.amplitude

    def follow_mode(self, simulation: Simulation) -> tuple[np.ndarray, np.ndarray]:
        """Start the wave in water at rest and run; returns times (n,) [s], and `amplitude_share` (n,) at them."""
        start = particle_state(simulation).position
        set_state(simulation, start, self.amplitude * self.unit_flow(start))
        return record_run(simulation, self.period / 60, self.amplitude_share)

    def fit_damped_cosine(self, times: np.ndarray, signal: np.ndarray) -> tuple[float, float]:
        """Period [s] and decay rate [1/s] of a cos(w t + b) exp(-c t), fitted to a signal (n,) at times (n,) [s] from a
        quarter of a period on: before, the signal holds the sound of the start."""
        from scipy.optimize import curve_fit

        def model(t: np.ndarray, a: float, b: float, omega: float, rate: float) -> np.ndarray:
            return a * np.cos(omega * t + b) * np.exp(-rate * t)

        settled = times > 0.25 * self.period
        (_, _, omega, rate), _ = curve_fit(model, times[settled], signal[settled], p0=(1.0, 0.0, self.omega, 0.01))
        return 2.0 * pi / abs(omega), rate


DEEP_WAVE = StandingWave(length=2.0, depth=1.0, mode=2, amplitude=0.05, gravity=1.0)
"""Colagrossi, Souto-Iglesias, Antuono & Marrone (2013, Phys. Rev. E 87, 023302): k h is pi."""


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: the wave at Re 250, inviscid, and (slow) at Re 2500; coarse: with twice the spacing."""
    return [
        wave_problem(250.0, coarse, {"delta_sph": 10.0}),
        wave_problem(None, coarse, {}),
        wave_problem(2500.0, coarse, {}, slow=True),
    ]


def wave_problem(reynolds: float | None, coarse: bool, decay: dict[str, float], slow: bool = False) -> Problem:
    """Set-up of the wave at a Reynolds number sqrt(g H) H / nu (None: inviscid). `coarse`: twice the spacing; `decay`:
    tolerances by scheme; `slow`: takes minutes."""
    name = f"Re {reynolds:g}" if reynolds else "nu 0"
    viscosity = DEEP_WAVE.viscosity(reynolds) if reynolds else 0.0
    scene = {
        "duration": 4.0 * DEEP_WAVE.period,
        "basin": {"length": DEEP_WAVE.length, "depth": DEEP_WAVE.depth, "gravity": [0.0, -DEEP_WAVE.gravity, 0.0]},
        "fluid": {"spacing": 0.04 if coarse else 0.02, "kinematic_viscosity": viscosity},
    }
    promises = (
        Promise(f"{name}: period [s]", "%", STEEP_SOURCE, {"delta_sph": 1.0, "dfsph": 2.0}),
        Promise(f"{name}: period over that without viscosity [s]", "%", f"w^2 = g k tanh(k H); {SET_UP_SOURCE}"),
        Promise(f"{name}: decay rate [1/s]", "%" if reynolds else "1/s", VISCOUS_SOURCE, decay),
        Promise(f"{name}: decay rate over its leading order [1/s]", "%" if reynolds else "1/s", DECAY_SOURCE),
        Promise(f"{name}: amplitude per period", "%", DECAY_SOURCE, decay),
        Promise(f"{name}: effective viscosity [m2/s]", "m2/s", f"decay rate / (2 k^2); {SET_UP_SOURCE}"),
    )
    return Problem(scene, promises, lambda run: compare_wave(*DEEP_WAVE.follow_mode(run), viscosity), name, slow)


def compare_wave(times: np.ndarray, share: np.ndarray, viscosity: float) -> Finding:
    """Compare period and decay of `share` (n,), `amplitude_share` at times (n,), with theory for a viscosity [m2/s]."""
    period, rate = DEEP_WAVE.fit_damped_cosine(times, share)
    expected, root = DEEP_WAVE.leading_rate(viscosity), DEEP_WAVE.viscous_root(viscosity)
    per_period, wanted = DEEP_WAVE.amplitude_ratio(rate), DEEP_WAVE.amplitude_ratio(expected)
    numbers = (
        percent_error(period, DEEP_WAVE.steep_period(root, times)),
        percent_error(period, DEEP_WAVE.period),
        percent_error(rate, -root.real) if viscosity else absolute_error(rate),
        percent_error(rate, expected) if viscosity else absolute_error(rate),
        percent_error(per_period, wanted),
        absolute_error(rate / DEEP_WAVE.leading_rate(1.0), viscosity),
    )
    return DEEP_WAVE.finding(numbers, times, share, expected)
