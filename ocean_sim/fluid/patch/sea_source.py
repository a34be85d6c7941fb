"""What the table of a sea around a patch is written from: its levels, and the sum of plane waves on them."""

from collections.abc import Iterator
from typing import ClassVar, NamedTuple, Protocol

import numpy as np

from ocean_sim import waves
from ocean_sim.fluid.patch.relaxation_zone import Band
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
