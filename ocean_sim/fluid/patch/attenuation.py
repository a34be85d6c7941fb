"""Numerical attenuation and delay of waves by a scheme, as measured."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import exp, pi, sqrt, tanh

import numpy as np

from ocean_sim import waves
from ocean_sim.fluid.bodies.walls import zones
from ocean_sim.fluid.sph.initial_state import StandingWave, patch_waves
from ocean_sim.fluid.sph.lattice import Lattice


@dataclass(frozen=True)
class Attenuation:
    """Viscosity nu that a scheme adds, divided by its smoothing length times sound speed; for standing waves

        even + (flat sqrt(coth(k depth)) + steep (H / dx)^1.5 k dx) dx / depth

    with the wavenumber k, the height H from trough to crest, and the spacing dx. The amplitude then falls at the rate
    2 nu k^2. Fitted to waves in slices of 6 to 32 layers, k depth 0.5 to 3.1, H 0.5 to 4 dx and at most a third of the
    depth, without viscosity of their own, over 6 periods. The fit of `delta_sph` gives 0.67 to 1.5 times the rate of
    four waves in five, and 0.35 to 2.4 times the rates of all 39.
    """

    even: float
    flat: float = 0.0
    steep: float = 0.0
    travelling: "Attenuation | None" = None
    """Fit for travelling waves; None: this one serves for them too."""

    def share(self, k: float, depth: float, height: float, spacing: float, standing: bool) -> float:
        """Numerical viscosity on waves of wavenumber k [rad/m], as a share of smoothing length times sound speed;
        `height` of the waves, `depth`, particle `spacing` [m]; `standing`: True for standing waves."""
        if self.travelling is not None and not standing:
            return self.travelling.share(k, depth, height, spacing, standing)
        of_layers = self.flat / sqrt(tanh(k * depth)) + self.steep * (height / spacing) ** 1.5 * k * spacing
        return self.even + of_layers * spacing / depth


@dataclass(frozen=True)
class Delay:
    """Share by which a scheme lengthens the period of waves, low / (1 + high (H / dx)^3) (k dx)^2 (wavenumber k, height
    H, spacing dx). `low`, `high` are fitted to travelling waves: 10 and 20 layers, k depth pi, H 0.6 to 1.9 dx."""

    low: float
    high: float = 0.0

    def share(self, k: np.ndarray, height: float, spacing: float) -> np.ndarray:
        """Share (n,) by which periods grow; k (n,) [rad/m]: wavenumbers; `height` of the sea and `spacing` [m]."""
        return self.low / (1.0 + self.high * (height / spacing) ** 3) * (k * spacing) ** 2


@dataclass(frozen=True)
class Train:
    """Waves of one sea, travelling or standing, to be attenuated by a scheme."""

    sea: waves.Components
    standing: bool

    @property
    def height(self) -> float:
        """Wave height from trough to crest [m]; the significant height of random waves."""
        if self.sea.random:
            return self.sea.significant_height
        return 2.0 * float(self.sea.amplitude.sum())

    def variance_below(self, length: float) -> float:
        """Share of the variance of random waves in components shorter than `length` [m]; 0 for regular waves."""
        if not self.sea.random:
            return 0.0
        variance, lengths = self.sea.amplitude**2, 2.0 * pi / self.sea.wavenumber
        return float(variance[lengths < (1.0 - 1e-9) * length].sum() / variance.sum())

    def height_loss(self, viscosity: float) -> tuple[float, float]:
        """Shares of the wave height lost by a viscosity [m2/s] in one period, and over one wavelength travelled."""
        sea, k = self.sea, 2.0 * pi / self.sea.wavelength
        rate, speed = 2.0 * viscosity * k**2, float(waves.group_speed(k, sea.depth, sea.gravity))
        return 1.0 - exp(-rate * sea.period), 1.0 - exp(-rate * sea.wavelength / speed)


def wave_trains(lattice: Lattice) -> Iterator[Train]:
    """Yield the waves of a scene: those of its sea, wavemaker or initial state, and those from absorbing sides."""
    basin, initial = lattice.basin, lattice.config.initial
    if any(waves.basin_faults(basin)):
        return
    sea = patch_waves(basin, lattice.spacing)
    if sea is not None:
        yield Train(sea, False)
    elif basin.piston is not None:
        if (made := basin.piston.path.sea) is not None:
            yield Train(made, False)
    elif initial is not None and (began := initial.sea(basin)) is not None:
        yield Train(began, isinstance(initial, StandingWave))
    yield from (Train(zone.given, False) for zone in zones(lattice) if zone.given is not None)
