"""A tile of open sea that repeats itself, and the linear waves on it: elevation and surface potential.

The tile rests in the water, and a ship sails across it: what leaves at one side comes in at the other, but for the rim
opposite the ship, which stays with her and calms it. Seen from the ship the water streams past and its waves end at the
edge of her tile. So nothing is ever shifted, and no coordinate grows: positions count modulo the side.

A step of linear theory is exact, whatever its length: each mode turns by omega, omega^2 = g k tanh kh. Pressure on the
surface acts in two halves, where it is before and where it is after the step; the second one where the ship has gone
to, or the waves that she makes are of first order in the step only.
"""

from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, NamedTuple

import numpy as np

from ocean_sim.waves import MANY, profiles

RIM = 0.15  # of the side, at each edge of the tile, in which waves are calmed
PER_TILE = 6.0  # waves on a tile, for which the rim is made
CALMING = 0.8  # their decay over their frequency, at the edge itself


@dataclass(frozen=True, eq=False)
class Tile:
    """A rectangle of sea of `cells` x `rows` square cells, in the axes of the water."""

    left_out: ClassVar[tuple[str, ...]] = (
        "kx",
        "kz",
        "k",
        "omega",
        "directed",
        "smooth",
        "turning",
    )  # made again when asked for

    side: float  # along x [m]
    cells: int  # along x
    rows: int  # along z; 1 in 2-D
    depth: float  # [m]
    gravity: float  # [m/s2]
    part: float = 1.0  # of the wavenumbers along z that there are modes of; what is left out is taken as empty

    @property
    def columns(self) -> int:
        """Modes along z."""
        return int(self.part * (self.rows // 2)) + 1

    @property
    def cell(self) -> float:
        """Side of a cell [m]."""
        return self.side / self.cells

    @property
    def shape(self) -> tuple[int, int]:
        return self.cells, self.rows

    @property
    def width(self) -> float:
        """Along z [m]."""
        return self.cell * self.rows

    @cached_property
    def kx(self) -> np.ndarray:
        """(cells, 1) [rad/m]."""
        return 2.0 * np.pi * np.fft.fftfreq(self.cells, self.cell)[:, None]

    @cached_property
    def kz(self) -> np.ndarray:
        """(1, columns) [rad/m]."""
        return 2.0 * np.pi * np.fft.rfftfreq(self.rows, self.cell)[None, : self.columns]

    @cached_property
    def k(self) -> np.ndarray:
        """(cells, columns) [rad/m]."""
        return np.hypot(self.kx, self.kz)

    @cached_property
    def omega(self) -> np.ndarray:
        """The same [rad/s]."""
        return np.sqrt(self.gravity * self.k * np.tanh(self.k * self.depth))

    @cached_property
    def smooth(self) -> np.ndarray:
        """What a Gaussian as broad as a cell leaves of each mode."""
        return np.exp(-0.5 * (self.k * self.cell) ** 2)

    @cached_property
    def turning(self) -> dict[float, tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """By step [s]: cos omega dt, and sin omega dt times omega / g and g / omega; the last one that was asked
        for."""
        return {}

    def turned(self, e: np.ndarray, p: np.ndarray, dt: float) -> tuple[np.ndarray, np.ndarray]:
        """Modes of elevation and potential dt [s] later where nothing acts; the mean level stays."""
        if dt not in self.turning:
            self.turning.clear()
            omega, g = self.omega, self.gravity
            s = np.sin(omega * dt)
            back = np.divide(g * s, omega, out=np.zeros(omega.shape), where=omega > 0.0)
            self.turning[dt] = np.cos(omega * dt), omega / g * s, back
        c, up, back = self.turning[dt]
        return e * c + p * up, p * c - e * back

    @cached_property
    def directed(self) -> np.ndarray:
        """1 for every mode that has a direction, 0 for the shortest along either axis, whose slope is unknown."""
        clear = np.ones(self.k.shape)
        if self.cells % 2 == 0:
            clear[self.cells // 2] = 0.0
        if self.rows % 2 == 0 and self.part == 1.0:
            clear[:, self.rows // 2] = 0.0
        return clear

    def waves(self, values: np.ndarray) -> np.ndarray:
        """(..., cells, columns) the modes of (..., cells, rows) values; on one thread, so that its bytes are the same
        with any number of them."""
        from scipy.fft import fft, rfft, rfft2

        if self.part == 1.0:
            return rfft2(values, workers=1)
        return fft(rfft(values, axis=-1, workers=1)[..., : self.columns], axis=-2, workers=1)

    def values(self, modes: np.ndarray) -> np.ndarray:
        """The values of modes."""
        from scipy.fft import ifft, irfft, irfft2

        if self.part == 1.0:
            return irfft2(modes, s=self.shape, workers=1)
        return irfft(ifft(modes, axis=-2, workers=1), n=self.rows, axis=-1, workers=1)

    def slopes(self, modes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The modes of the slopes along x and z."""
        clear = self.directed * modes
        return 1j * self.kx * clear, 1j * self.kz * clear

    def nodes(self) -> tuple[np.ndarray, np.ndarray]:
        """Where the values stand along x and z [m]: in the middle of each cell, around the origin."""
        x = (np.arange(self.cells) + 0.5) * self.cell - 0.5 * self.side
        z = (np.arange(self.rows) + 0.5) * self.cell - 0.5 * self.width
        return x, z

    def corner(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(m, 2) points x, z [m] -> whole cells and the shares of the way to the next, (m, 2) each."""
        at = (points + 0.5 * np.array([self.side, self.width])) / self.cell - 0.5
        whole = np.floor(at)
        return whole.astype(int), at - whole

    def spread(self, points: np.ndarray, amounts: np.ndarray) -> np.ndarray:
        """The modes of amounts (m,) at points x, z (m, 2) [m], over the area of a cell and smoothed over one."""
        whole, share = self.corner(points)
        i, k = whole.T % np.array([[self.cells], [self.rows]])
        (right, top), (left, bottom) = share.T, 1.0 - share.T
        over, beyond = (i + 1) % self.cells, (k + 1) % self.rows
        cells = np.concatenate(
            [i * self.rows + k, over * self.rows + k, i * self.rows + beyond, over * self.rows + beyond]
        )
        shares = np.concatenate([left * bottom, right * bottom, left * top, right * top]) * np.tile(amounts, 4)
        total = np.bincount(cells, shares, self.cells * self.rows)
        return self.smooth / self.cell**2 * self.waves(total.reshape(self.shape))

    def at(self, values: np.ndarray, points: np.ndarray) -> np.ndarray:
        """(m,) values between cells, by a cubic along each axis (Keys 1981, IEEE Trans. ASSP 29), at points (m, 2)."""
        whole, share = self.corner(points)
        along, across = cubic(share[:, 0]), cubic(share[:, 1]) if self.rows > 1 else [np.ones(len(points))]
        first = -1 if self.rows > 1 else 0
        found = np.zeros(len(points))
        for i, weight in enumerate(along):
            row = (whole[:, 0] + i - 1) % self.cells
            for k, other in enumerate(across):
                column = (whole[:, 1] + k + first) % self.rows
                found += weight * other * values[row, column]
        return found

    def energy(self, eta: np.ndarray, phi: np.ndarray) -> float:
        """Of linear waves over the density [m4/s2 m]: that of the height and that of the motion."""
        e, p = self.waves(eta), self.waves(phi)
        twice = np.full(self.k.shape[1], 2.0)
        twice[0] = 1.0
        if self.rows % 2 == 0 and self.part == 1.0:
            twice[-1] = 1.0
        each = self.gravity * np.abs(e) ** 2 + self.omega**2 / self.gravity * np.abs(p) ** 2
        return 0.5 * float((twice * each).sum()) * self.cell**2 / (self.cells * self.rows)


class Shown(NamedTuple):
    """What a tile shows now: modes of the elevation, of the potential at the still surface, and of its growth."""

    e: np.ndarray
    potential: np.ndarray
    growth: np.ndarray


class OnTile:
    """Waves on a tile that can be asked for, at times [s] and points x, z (m, 2) in the axes of the water [m]."""

    tile: Tile

    @abstractmethod
    def shown(self, time: float) -> Shown:
        """All of it."""

    def seen(self, points: np.ndarray) -> np.ndarray:
        """(m,) whether there is anything at points: everywhere."""
        return np.ones(len(points), dtype=bool)

    def elevation(self, points: np.ndarray, time: float) -> np.ndarray:
        """(m,) [m]"""
        return self.tile.at(self.tile.values(self.shown(time).e), points)

    def heads(self, points: np.ndarray, y: np.ndarray, time: float) -> np.ndarray:
        """(m,) pressure over rho g [m], without the hydrostatic part, at heights y (m,) [m] of the unstretched column:
        summed mode by mode, so nothing is interpolated."""
        growth, found = self.shown(time).growth, np.zeros(len(points))
        for n, level, _ in self.modes(points, y):
            found[n] = -(level * growth).real.sum() / self.tile.gravity
        return found

    def velocities(self, points: np.ndarray, y: np.ndarray, time: float) -> np.ndarray:
        """(m, 3) [m/s] at the same places; of many that are all on the surface as their elevation is."""
        tile, potential, found = self.tile, self.shown(time).potential, np.zeros((len(points), 3))
        if len(points) >= MANY and not y.any():
            rising = tile.omega**2 / tile.gravity * tile.directed * potential
            along, across, up = (tile.at(tile.values(of), points) for of in (*tile.slopes(potential), rising))
            return np.stack([along, up, across], axis=1)
        for n, level, upright in self.modes(points, y):
            along = (level * potential).imag
            found[n] = -(tile.kx * along).sum(), (upright * potential).real.sum(), -(tile.kz * along).sum()
        return found

    def modes(self, points: np.ndarray, y: np.ndarray) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
        """The number of each of the points, and there of every mode what goes around along the still surface, and k
        times what goes upright, both as parts of that at the surface."""
        tile, first = self.tile, np.array([axis[0] for axis in self.tile.nodes()])
        twice = np.where((np.arange(tile.k.shape[1]) == 0) | (2 * np.arange(tile.k.shape[1]) == tile.rows), 1.0, 2.0)
        scale = twice * tile.directed / (tile.cells * tile.rows)
        heights, which = np.unique(y, return_inverse=True)  # few where the surface is asked for
        for k, height in enumerate(heights):
            c, s = profiles(tile.k, height, tile.depth)
            upright = tile.k * s
            for n in np.flatnonzero(which == k).tolist():
                x, z = points[n] - first
                wave = scale * np.exp(1j * tile.kx * x) * np.exp(1j * tile.kz * z)
                yield n, c * wave, upright * wave


def cubic(s: np.ndarray) -> list[np.ndarray]:
    """Weights of the four values around a share s of the way from the second to the third."""
    return [
        0.5 * s * (-1.0 + s * (2.0 - s)),
        0.5 * (2.0 + s * s * (3.0 * s - 5.0)),
        0.5 * s * (1.0 + s * (4.0 - 3.0 * s)),
        0.5 * s * s * (s - 1.0),
    ]


class Layer:
    """Linear waves on a tile around one centre, which what pushes them keeps up with."""

    left_out: ClassVar[tuple[str, ...]] = ("calming", "calmed")

    def __init__(self, tile: Tile, rim: bool = True) -> None:
        self.tile, self.rim = tile, rim
        self.eta, self.phi = np.zeros(tile.shape), np.zeros(tile.shape)  # [m], [m2/s]
        self.centre = np.zeros(2)  # x, z in the axes of the water [m]
        self.pressed = np.zeros((*tile.k.shape, 2))  # modes of the pressure, real and imaginary parts
        self.press(np.zeros(tile.k.shape))

    @property
    def pressure(self) -> np.ndarray:
        """Modes of the pressure over the density that acts now [m2/s2]; without its mean, as the mean level stays."""
        return self.pressed.view(complex)[..., 0]

    def press(self, pressure: np.ndarray) -> None:
        """Modes of the pressure from now on."""
        self.pressed = np.array(pressure, dtype=complex).view(float).reshape(*pressure.shape, 2)
        self.pressed[0, 0] = 0.0

    @cached_property
    def calming(self) -> np.ndarray:
        """(cells, rows) decay of waves around the origin [1/s]."""
        return rate(self.tile)

    @cached_property
    def calmed(self) -> dict[float, np.ndarray]:
        """By step [s]: what the rim around the origin leaves of them; the last one that was asked for."""
        return {}

    def begin(self, pressure: np.ndarray, centre: np.ndarray, dt: float) -> None:
        """At rest under the modes of a pressure over the density [m2/s2]: lower by as much as it weighs, but for what
        steps of dt [s] take of the shortest waves: so it stays at rest."""
        tile, half = self.tile, 0.5 * dt * self.tile.omega
        rest = np.divide(half, np.tan(half), out=np.ones(half.shape), where=half > 0.0) / tile.gravity
        self.press(pressure)
        self.centre = centre
        self.eta, self.phi = tile.values(-rest * self.pressure), np.zeros(tile.shape)

    def advance(self, dt: float, pressure: np.ndarray, centre: np.ndarray) -> None:
        """A step of dt [s] after which the modes of a pressure over the density act, around a centre."""
        tile = self.tile
        e, p = self.after(dt)
        self.press(pressure)
        self.centre = centre
        self.eta, self.phi = tile.values(e), tile.values(p - 0.5 * dt * self.pressure)
        if self.rim:
            if dt not in self.calmed:
                self.calmed.clear()
                self.calmed[dt] = np.exp(-dt * self.calming)
            calm = np.roll(self.calmed[dt], np.round(centre / tile.cell).astype(int), axis=(0, 1))
            self.eta *= calm
            self.phi *= calm
            self.eta -= self.eta.mean()

    def after(self, dt: float) -> tuple[np.ndarray, np.ndarray]:
        """The modes of elevation and potential dt [s] later, but for what acts then."""
        tile = self.tile
        return tile.turned(tile.waves(self.eta), tile.waves(self.phi) - 0.5 * dt * self.pressure, dt)

    def seen(self, points: np.ndarray) -> np.ndarray:
        """(m,) whether points x, z (m, 2) [m] lie on the tile around its centre."""
        half = 0.5 * np.array([self.tile.side, self.tile.width if self.tile.rows > 1 else np.inf])
        return np.all(np.abs(points - self.centre) < half, axis=1)


def rate(tile: Tile) -> np.ndarray:
    """(cells, rows) decay of waves [1/s] in the rim of a tile around its centre: it grows as the square of the way to
    the edge, to the frequency of waves of which PER_TILE fit on the tile."""
    x, z = tile.nodes()
    far = np.abs(x)[:, None] / (0.5 * tile.side) + 0.0 * z
    if tile.rows > 1:
        far = np.maximum(far, np.abs(z) / (0.5 * tile.width))
    k = 2.0 * np.pi * PER_TILE / tile.side
    omega = np.sqrt(tile.gravity * k * np.tanh(k * tile.depth))
    return CALMING * omega * np.clip((far - (1.0 - 2.0 * RIM)) / (2.0 * RIM), 0.0, 1.0) ** 2
