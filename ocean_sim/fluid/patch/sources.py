"""Sources of the SeaTable of a patch: its levels, and a linear or a nonlinear sea that fills them."""

from collections.abc import Iterator
from dataclasses import replace
from typing import ClassVar, NamedTuple

import numpy as np

from ocean_sim import waves
from ocean_sim.fluid.open_sea.wave_tile import Tile
from ocean_sim.fluid.patch.relaxation_zone import RelaxationBand, tile_cells
from ocean_sim.waves import Components

TABLE_LEVELS = 10  # levels at and below the still level; one more lies above it
NODE_VALUES = 6  # values of a node: velocity [m/s] and its feed [m/s2]


def wave_counts(band: RelaxationBand, sea: Components) -> np.ndarray:
    """Number (n, 2) of periods of each wave along the sides of the patch."""
    return np.round(sea.wavevector * np.array(band.lattice.basin.periods)[::2] / (2.0 * np.pi)).astype(int)


class Depths(NamedTuple):
    """Levels of a SeaTable: ever farther apart down to `deepest`, and one `above` the still level [m]."""

    deepest: float
    above: float
    bed: float  # the depth of the water

    def profiles(self, k: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Yield, level by level, the horizontal and vertical velocity of waves with wavenumbers k (n,) [rad/m], over
        the amplitude g k / omega of the velocity at the still level."""
        for level in range(TABLE_LEVELS):
            yield waves.profiles(k, -self.deepest * (level / (TABLE_LEVELS - 1)) ** 2, self.bed)
        (c, s), slope = waves.profiles(k, 0.0, self.bed), np.tanh(k * self.bed)
        yield c + k * self.above * slope, s + k * self.above


class PlaneWaveSource:
    """Linear sea, a sum of plane waves, as source of a SeaTable, before its ramp is applied."""

    left_out: ClassVar[tuple[str, ...]] = ("shapes", "places")

    def __init__(self, band: RelaxationBand, sea: Components, depths: Depths, count: tuple[int, ...]) -> None:
        self.sea, self.count = sea, count
        self.places = tuple(wave_counts(band, sea)[:, axis] % count[axis] for axis in range(2))
        k, (kx, kz) = sea.wavenumber, sea.wavevector.T
        speed, lower = sea.amplitude * sea.gravity * k / sea.omega, band.lattice.basin.lower
        shape = np.array([np.stack([kx / k * c, -1j * s, kz / k * c]) for c, s in depths.profiles(k)])
        velocity = speed * shape * np.exp(1j * (kx * lower[0] + kz * lower[2]))
        self.shapes = np.concatenate([velocity, band.feed * velocity], axis=1)
        """(levels, values, n) contribution of each wave at the lower corner of the patch and phase 0."""

    def modes(self, time: float) -> np.ndarray:
        """Complex modes (levels, values, nodes x, nodes z) of velocity and feed at a time [s], never decreasing."""
        found = np.zeros((TABLE_LEVELS + 1, NODE_VALUES, *self.count), dtype=np.complex128)
        origin_phase = np.exp(1j * np.mod(self.sea.phase - self.sea.omega * time, 2.0 * np.pi))
        found[:, :, self.places[0], self.places[1]] = self.shapes * origin_phase
        return found


class SteepSource:
    """Nonlinear sea on a tile over the patch, one cell a particle spacing, as source of a SeaTable. The feed is the
    share f of the velocity of each wave. Of modes E of the elevation and P of the potential, waves along the wavevector
    have the potential P / 2 - i g E / (2 omega) and take f, waves against it the conjugate of f; the sum is Re f P + Im
    f g E / omega."""

    left_out: ClassVar[tuple[str, ...]] = ("shapes", "feed_factors", "origin_phase", "places")

    def __init__(self, band: RelaxationBand, sea: Components, depths: Depths, count: tuple[int, ...]) -> None:
        from ocean_sim.fluid.open_sea.high_order import nonlinear_sea, tile_step  # a linear sea does without it

        assert band.nonlinear is not None
        basin, (cells, rows) = band.lattice.basin, tile_cells(band)
        tile = Tile(basin.periods[0], cells, rows, basin.depth, sea.gravity)
        self.sea = nonlinear_sea(replace(sea, ramp=0.0), tile, *band.nonlinear, sea.period)
        self.step, self.count = tile_step(tile), count
        self.feed_factors = feed_factors(band, sea, self.sea.tile)
        tile = self.sea.tile
        kx, kz, k = 1j * tile.kx + 0.0 * tile.kz, 1j * tile.kz + 0.0 * tile.kx, tile.k
        self.shapes = [np.stack([kx * c, k * s, kz * c]) for c, s in depths.profiles(k)]
        first = [axis[0] for axis in tile.nodes()]
        lower = (basin.lower[0], basin.lower[2] if rows > 1 else first[1])
        self.origin_phase = np.exp(kx * (lower[0] - first[0]) + kz * (lower[1] - first[1])) / (cells * rows)
        along = np.round(np.fft.fftfreq(cells) * cells).astype(int)
        self.places = (along % count[0])[:, None], (np.arange(tile.columns) % count[1])[None, :]

    def modes(self, time: float) -> np.ndarray:
        """Advance the nonlinear sea to a time [s], and return its modes and their feed."""
        left = time - self.sea.time
        for _ in range(steps := int(np.ceil(left / self.step - 1e-9))):
            self.sea.advance(left / steps)
        e, below, _ = self.sea.potentials()
        # Until it has set in, the potential at the still level is that of a linear sea.
        part = self.sea.nonlinear_share(time)
        potential = part * below + (1.0 - part) * self.sea.tile.to_modes(self.sea.phi)
        real, crossed = self.feed_factors
        both = self.sea.resolved_modes * self.origin_phase * np.array([potential, real * potential + crossed * e])
        found = np.zeros((len(self.shapes), NODE_VALUES, *self.count), dtype=np.complex128)
        for level, shape in enumerate(self.shapes):
            for n, of in enumerate(both):
                three = found[level, 3 * n : 3 * n + 3]
                three[:, self.places[0], self.places[1]] = shape * of
        found[..., 1 : self.sea.tile.columns] *= 2.0  # so that the real part of their complex Fourier sum is the field
        return found


def feed_factors(band: RelaxationBand, sea: Components, tile: Tile) -> tuple[np.ndarray, np.ndarray]:
    """Factors Re f and Im f g / omega (cells, columns) of a tile's modes, from the waves' feed f by wavenumber."""
    order = np.argsort(sea.wavenumber)
    k, f = sea.wavenumber[order], band.feed[order]
    real, imaginary = (np.interp(tile.k, k, of) for of in (f.real, f.imag))
    return real, np.divide(imaginary * tile.gravity, tile.omega, out=np.zeros(tile.k.shape), where=tile.omega > 0.0)
