"""What the table of a sea around a patch is written from: its levels, and the sum of plane waves on them."""

from collections.abc import Iterator
from dataclasses import replace
from typing import ClassVar, NamedTuple, Protocol

import numpy as np

from ocean_sim import waves
from ocean_sim.fluid.open_sea.wave_tile import Tile
from ocean_sim.fluid.patch.relaxation_zone import Band, cells_of
from ocean_sim.waves import Components

LEVELS = 10  # at and below the still level; the last number is a level above it
VALUES = 6  # of a node: velocity [m/s] and what is fed of it [m/s2]


def numbers(band: Band, sea: Components) -> np.ndarray:
    """(n, 2) crests of each wave along the sides of the patch."""
    return np.round(sea.wavevector * np.array(band.lattice.basin.periods)[::2] / (2.0 * np.pi)).astype(int)


class Depths(NamedTuple):
    """Where the levels of a table lie: ever farther apart down to `deepest`, and one `above` the still level [m]."""

    deepest: float
    above: float
    bed: float  # the depth of the water

    def profiles(self, k: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Of waves (n,) [rad/m] at each level: of their velocity along the way and upwards."""
        for level in range(LEVELS):
            yield waves.profiles(k, -self.deepest * (level / (LEVELS - 1)) ** 2, self.bed)
        (c, s), slope = waves.profiles(k, 0.0, self.bed), np.tanh(k * self.bed)
        yield c + k * self.above * slope, s + k * self.above


class Source(Protocol):
    """What a table is written from: the sea without its ramp."""

    def modes(self, time: float) -> np.ndarray:
        """(levels, values, nodes along x, along z) complex: their Fourier sum over the nodes is what the table holds at
        a time [s], which never goes back."""
        ...


class PlaneWaveSource:
    """The sum of plane waves."""

    left_out: ClassVar[tuple[str, ...]] = ("shapes", "places")

    def __init__(self, band: Band, sea: Components, depths: Depths, count: tuple[int, ...]) -> None:
        self.sea, self.count = sea, count
        self.places = tuple(numbers(band, sea)[:, axis] % count[axis] for axis in range(2))
        k, (kx, kz) = sea.wavenumber, sea.wavevector.T
        speed, lower = sea.amplitude * sea.gravity * k / sea.omega, band.lattice.basin.lower
        shape = np.array([np.stack([kx / k * c, -1j * s, kz / k * c]) for c, s in depths.profiles(k)])
        velocity = speed * shape * np.exp(1j * (kx * lower[0] + kz * lower[2]))
        self.shapes = np.concatenate([velocity, band.feed * velocity], axis=1)
        """(levels, values, n): what each wave adds at the lower corner of the patch and phase 0."""

    def modes(self, time: float) -> np.ndarray:
        found = np.zeros((LEVELS + 1, VALUES, *self.count), dtype=np.complex128)
        turn = np.exp(1j * np.mod(self.sea.phase - self.sea.omega * time, 2.0 * np.pi))
        found[:, :, self.places[0], self.places[1]] = self.shapes * turn
        return found


class SteepSource:
    """The nonlinear sea, at the last time that was asked for, without its ramp.

    What is fed of a wave follows from its share f of the velocity. Of modes E of the elevation and P of the potential,
    the waves along their wavevector have the potential P / 2 - i g E / (2 omega); these get f, those against it its
    conjugate: Re f P + Im f g E / omega.
    """

    left_out: ClassVar[tuple[str, ...]] = ("shapes", "fed", "turn", "places")

    def __init__(self, band: Band, sea: Components, depths: Depths, count: tuple[int, ...]) -> None:
        from ocean_sim.fluid.open_sea.high_order import evolving, step_of  # a linear sea does without it

        assert band.nonlinear is not None
        basin, (cells, rows) = band.lattice.basin, cells_of(band)
        tile = Tile(basin.periods[0], cells, rows, basin.depth, sea.gravity)
        self.sea = evolving(replace(sea, ramp=0.0), tile, *band.nonlinear, sea.period)
        self.step, self.count = step_of(tile), count
        self.fed = fed(band, sea, self.sea.tile)
        tile = self.sea.tile
        kx, kz, k = 1j * tile.kx + 0.0 * tile.kz, 1j * tile.kz + 0.0 * tile.kx, tile.k
        self.shapes = [np.stack([kx * c, k * s, kz * c]) for c, s in depths.profiles(k)]
        first = [axis[0] for axis in tile.nodes()]
        lower = (basin.lower[0], basin.lower[2] if rows > 1 else first[1])
        self.turn = np.exp(kx * (lower[0] - first[0]) + kz * (lower[1] - first[1])) / (cells * rows)
        along = np.round(np.fft.fftfreq(cells) * cells).astype(int)
        self.places = (along % count[0])[:, None], (np.arange(tile.columns) % count[1])[None, :]

    def modes(self, time: float) -> np.ndarray:
        left = time - self.sea.time
        for _ in range(steps := int(np.ceil(left / self.step - 1e-9))):
            self.sea.advance(left / steps)
        e, below, _ = self.sea.potentials()
        part = self.sea.part(time)  # until it has set in, the potential at the still level is that of a linear sea
        potential = part * below + (1.0 - part) * self.sea.tile.waves(self.sea.phi)
        real, crossed = self.fed
        both = self.sea.clear * self.turn * np.array([potential, real * potential + crossed * e])
        found = np.zeros((len(self.shapes), VALUES, *self.count), dtype=np.complex128)
        for level, shape in enumerate(self.shapes):
            for n, of in enumerate(both):
                three = found[level, 3 * n : 3 * n + 3]
                three[:, self.places[0], self.places[1]] = shape * of
        return whole(found, self.sea.tile)


def fed(band: Band, sea: Components, tile: Tile) -> tuple[np.ndarray, np.ndarray]:
    """For each mode: Re f, and Im f g / omega; f as that of the waves of the sea that are about as long."""
    order = np.argsort(sea.wavenumber)
    k, f = sea.wavenumber[order], band.feed[order]
    real, imaginary = (np.interp(tile.k, k, of) for of in (f.real, f.imag))
    return real, np.divide(imaginary * tile.gravity, tile.omega, out=np.zeros(tile.k.shape), where=tile.omega > 0.0)


def whole(modes: np.ndarray, tile: Tile) -> np.ndarray:
    """Modes whose sum has the real part that those of a half plane stand for: all but the first column twice."""
    modes[..., 1 : tile.columns] *= 2.0
    return modes
