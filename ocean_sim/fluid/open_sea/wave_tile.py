"""A periodic tile of open sea, and the linear waves on it: elevation and surface potential.

The tile rests in the water, and a ship sails across it. Waves that leave at one side come in at the other, but a rim
opposite the ship travels with her and damps them: seen from her, waves end at the edge of her tile. So nothing is ever
shifted, and no coordinate grows: positions count modulo the side.

A step of linear theory is exact at any length: each mode turns by omega, omega^2 = g k tanh kh. Pressure on the surface
acts in two halves, before and after the step, the second where the ship is by then; with one alone her waves would be
of first order in the step.
"""

from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ocean_sim.waves import MIN_LATTICE_POINTS, profiles

RIM_SHARE = 0.15  # share of the side, at each edge of the tile, in which waves are damped
PER_TILE = 6.0  # waves on a tile, for which the rim is made
UPPER_NODE, LOWER_NODE = 0.5 - 1.0 / 12**0.5, 0.5 + 1.0 / 12**0.5  # of Gauss's rule, over a depth
RIM_DAMPING_RATIO = 0.8  # decay of these waves over their frequency, at the edge itself


@dataclass(frozen=True, eq=False)
class Tile:
    """Periodic rectangle of sea of `cells` x `rows` square cells, in axes that move with the current."""

    side: float  # along x [m]
    cells: int  # along x
    rows: int  # along z; 1 in 2-D
    depth: float  # [m]
    gravity: float  # [m/s2]
    part: float = 1.0  # of the wavenumbers along z that there are modes of; what is left out is taken as empty

    @property
    def columns(self) -> int:
        """Number of Fourier modes along z (of the real transform)."""
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
        """Side along z [m]."""
        return self.cell * self.rows

    @cached_property
    def kx(self) -> np.ndarray:
        """Wavenumbers (cells, 1) of the modes along x [rad/m]."""
        return 2.0 * np.pi * np.fft.fftfreq(self.cells, self.cell)[:, None]

    @cached_property
    def kz(self) -> np.ndarray:
        """Wavenumbers (1, columns) of the modes along z [rad/m]."""
        return 2.0 * np.pi * np.fft.rfftfreq(self.rows, self.cell)[None, : self.columns]

    @cached_property
    def k(self) -> np.ndarray:
        """Magnitudes (cells, columns) of the wavevectors [rad/m]."""
        return np.hypot(self.kx, self.kz)

    @cached_property
    def omega(self) -> np.ndarray:
        """Angular frequencies (cells, columns) of linear waves [rad/s]."""
        return np.sqrt(self.gravity * self.k * np.tanh(self.k * self.depth))

    @cached_property
    def smoothing(self) -> np.ndarray:
        """Factor (cells, columns) of each Fourier mode that smooths a field by a Gaussian one cell wide."""
        return np.exp(-0.5 * (self.k * self.cell) ** 2)

    @cached_property
    def turn_cache(self) -> dict[float, tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Factors of `evolve`, cached for the last dt: cos(omega dt), sin(omega dt) times omega / g and g / omega."""
        return {}

    def evolve(self, e: np.ndarray, p: np.ndarray, dt: float) -> tuple[np.ndarray, np.ndarray]:
        """Fourier modes e of elevation and p of potential, dt [s] later without pressure; the mean level stays."""
        if dt not in self.turn_cache:
            self.turn_cache.clear()
            omega, g = self.omega, self.gravity
            s = np.sin(omega * dt)
            back = np.divide(g * s, omega, out=np.zeros(omega.shape), where=omega > 0.0)
            self.turn_cache[dt] = np.cos(omega * dt), omega / g * s, back
        c, up, back = self.turn_cache[dt]
        return e * c + p * up, p * c - e * back

    @cached_property
    def directed_modes(self) -> np.ndarray:
        """Mask (cells, columns): 0 for the shortest Fourier modes along an axis, whose slope is undefined, else 1."""
        clear = np.ones(self.k.shape)
        if self.cells % 2 == 0:
            clear[self.cells // 2] = 0.0
        if self.rows % 2 == 0 and self.part == 1.0:
            clear[:, self.rows // 2] = 0.0
        return clear

    def to_modes(self, values: np.ndarray) -> np.ndarray:
        """Fourier modes (..., cells, columns) of values (..., cells, rows); on one thread, for reproducible bytes."""
        from scipy.fft import fft, rfft, rfft2

        if self.part == 1.0:
            return rfft2(values, workers=1)
        return fft(rfft(values, axis=-1, workers=1)[..., : self.columns], axis=-2, workers=1)

    def to_values(self, modes: np.ndarray) -> np.ndarray:
        """Values (..., cells, rows) of Fourier modes (..., cells, columns)."""
        from scipy.fft import ifft, irfft, irfft2

        if self.part == 1.0:
            return irfft2(modes, s=self.shape, workers=1)
        return irfft(ifft(modes, axis=-2, workers=1), n=self.rows, axis=-1, workers=1)

    def slopes(self, modes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Fourier modes of the derivatives along x and z of a field with these modes."""
        clear = self.directed_modes * modes
        return 1j * self.kx * clear, 1j * self.kz * clear

    def nodes(self) -> tuple[np.ndarray, np.ndarray]:
        """Coordinates of the cells' centres along x (cells,) and z (rows,) [m], around the origin."""
        x = (np.arange(self.cells) + 0.5) * self.cell - 0.5 * self.side
        z = (np.arange(self.rows) + 0.5) * self.cell - 0.5 * self.width
        return x, z

    def cell_corner(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Indices (m, 2) of the node below each point x, z (m, 2) [m], and shares (m, 2) of the way to the next."""
        at = (points + 0.5 * np.array([self.side, self.width])) / self.cell - 0.5
        whole = np.floor(at)
        return whole.astype(int), at - whole

    def spread_modes(self, points: np.ndarray, amounts: np.ndarray) -> np.ndarray:
        """Fourier modes of the density [amount/m2] of amounts (m,) at points x, z (m, 2) [m], spread over a cell."""
        whole, share = self.cell_corner(points)
        i, k = whole.T % np.array([[self.cells], [self.rows]])
        (right, top), (left, bottom) = share.T, 1.0 - share.T
        over, beyond = (i + 1) % self.cells, (k + 1) % self.rows
        near, far = i * self.rows, over * self.rows
        cells = np.concatenate([near + k, far + k, near + beyond, far + beyond])
        shares = np.concatenate([left * bottom, right * bottom, left * top, right * top]) * np.tile(amounts, 4)
        total = np.bincount(cells, shares, self.cells * self.rows)
        return self.smoothing / self.cell**2 * self.to_modes(total.reshape(self.shape))

    def displaced_modes(self, points: np.ndarray, volumes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Fourier modes of displaced volume per area [m], by `volumes` [m3] at `points` x, z, depth (m, 3): (a) itself;
        (b) as the surface feels it, times cosh k (h - depth) / cosh kh, made linear in depth by two nodes (Gauss's)."""
        depth, deepest = points[:, 2], max(float(points[:, 2].max(initial=0.0)), 1e-9)
        low = (depth / deepest - UPPER_NODE) / (LOWER_NODE - UPPER_NODE)
        upper, lower = (self.spread_modes(points[:, :2], part * volumes) for part in (1.0 - low, low))
        over, under = (profiles(self.k, -node * deepest, self.depth)[0] for node in (UPPER_NODE, LOWER_NODE))
        return upper + lower, over * upper + under * lower

    def interpolate(self, values: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Values (m,) at points x, z (m, 2) [m], by a cubic along each axis (Keys 1981, IEEE Trans. ASSP 29)."""
        whole, share = self.cell_corner(points)
        along, across = (cubic_weights(part) for part in share.T)
        found, first = np.zeros(len(points)), -1
        if self.rows == 1:
            across, first = [np.ones(len(points))], 0
        for i, weight in enumerate(along):
            row = (whole[:, 0] + i - 1) % self.cells
            for k, other in enumerate(across):
                column = (whole[:, 1] + k + first) % self.rows
                found += weight * other * values[row, column]
        return found

    def energy(self, eta: np.ndarray, phi: np.ndarray) -> float:
        """Energy of linear waves divided by the density [m5/s2], from elevation eta [m] and potential phi [m2/s]."""
        e, p = self.to_modes(eta), self.to_modes(phi)
        twice = np.full(self.k.shape[1], 2.0)
        twice[0] = 1.0
        if self.rows % 2 == 0 and self.part == 1.0:
            twice[-1] = 1.0
        each = self.gravity * np.abs(e) ** 2 + self.omega**2 / self.gravity * np.abs(p) ** 2
        return 0.5 * float((twice * each).sum()) * self.cell**2 / (self.cells * self.rows)


class TileModes(NamedTuple):
    """Fourier modes (cells, columns) on a tile (periodic grid): elevation, potential at the still level, its rate."""

    e: np.ndarray
    potential: np.ndarray
    growth: np.ndarray


class OnTile:
    """Interface of waves on a `tile` (grid) at times [s], points x, z (m, 2) [m] in axes that move with the current."""

    tile: Tile

    @abstractmethod
    def modes_at(self, time: float) -> TileModes:
        """Fourier modes of the waves at a time [s]."""

    def covers(self, points: np.ndarray) -> np.ndarray:
        """Mask (m,) of the points that these waves reach: by default all of them."""
        return np.ones(len(points), dtype=bool)

    def elevation(self, points: np.ndarray, time: float) -> np.ndarray:
        """Elevations (m,) [m] at points x, z (m, 2) [m] and a time [s], interpolated between cells."""
        return self.tile.interpolate(self.tile.to_values(self.modes_at(time).e), points)

    def heads(self, points: np.ndarray, y: np.ndarray, time: float) -> np.ndarray:
        """Pressure heads (m,) [m] of waves at a `time` [s], x, z (m, 2) and Wheeler-stretched heights y (m,) [m]."""
        growth, found = self.modes_at(time).growth, np.zeros(len(points))
        for n, level, _ in self.point_modes(points, y):
            found[n] = -(level * growth).real.sum() / self.tile.gravity
        return found

    def velocities(self, points: np.ndarray, y: np.ndarray, time: float) -> np.ndarray:
        """Velocities (m, 3) [m/s] at a `time` [s], x, z (m, 2) and Wheeler-stretched heights y (m,) [m]: summed by
        modes, but interpolated between cells for many points on the surface."""
        tile, potential, found = self.tile, self.modes_at(time).potential, np.zeros((len(points), 3))
        if len(points) >= MIN_LATTICE_POINTS and not y.any():
            rising = tile.omega**2 / tile.gravity * tile.directed_modes * potential
            modes = *tile.slopes(potential), rising
            along, across, up = (tile.interpolate(tile.to_values(of), points) for of in modes)
            return np.stack([along, up, across], axis=1)
        for n, level, upright in self.point_modes(points, y):
            along = (level * potential).imag
            found[n] = -(tile.kx * along).sum(), (upright * potential).real.sum(), -(tile.kz * along).sum()
        return found

    def point_modes(self, points: np.ndarray, y: np.ndarray) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
        """Yield each point's index and factors (cells, columns) whose products with Fourier modes sum to values at its
        x, z, y [m]: for horizontal velocity and pressure; for vertical velocity, k [1/m] included."""
        tile, first = self.tile, np.array([axis[0] for axis in self.tile.nodes()])
        twice = np.where((np.arange(tile.k.shape[1]) == 0) | (2 * np.arange(tile.k.shape[1]) == tile.rows), 1.0, 2.0)
        scale = twice * tile.directed_modes / (tile.cells * tile.rows)
        heights, which = np.unique(y, return_inverse=True)  # few where the surface is asked for
        for k, height in enumerate(heights):
            c, s = profiles(tile.k, height, tile.depth)
            upright = tile.k * s
            for n in np.flatnonzero(which == k).tolist():
                x, z = points[n] - first
                wave = scale * np.exp(1j * tile.kx * x) * np.exp(1j * tile.kz * z)
                yield n, c * wave, upright * wave


def cubic_weights(s: np.ndarray) -> list[np.ndarray]:
    """Four weights (m,) of adjacent values in cubic interpolation, at shares s (m,) from second to third."""
    return [
        0.5 * s * (-1.0 + s * (2.0 - s)),
        0.5 * (2.0 + s * s * (3.0 * s - 5.0)),
        0.5 * s * (1.0 + s * (4.0 - 3.0 * s)),
        0.5 * s * s * (s - 1.0),
    ]


class Layer:
    """Linear waves on a tile (periodic grid) around the ship or wind that makes them, added to other waves."""

    def __init__(self, tile: Tile, rim: bool = True) -> None:
        self.tile, self.rim = tile, rim
        self.eta, self.phi = np.zeros(tile.shape), np.zeros(tile.shape)  # [m], [m2/s]
        self.centre = np.zeros(2)  # x, z in the axes of the water [m]
        self.pressure = np.zeros(tile.k.shape, dtype=complex)
        """Fourier modes of the present pressure / density [m2/s2]; without mean, as the mean level stays."""

    def set_pressure(self, pressure: np.ndarray) -> None:
        """Set the pressure on the surface by Fourier modes of pressure / density [m2/s2]; its mean is dropped."""
        self.pressure = np.array(pressure, dtype=complex)
        self.pressure[0, 0] = 0.0

    @cached_property
    def damping_rate(self) -> np.ndarray:
        """Decay rate (cells, rows) [1/s] in the tile's rim: RIM_DAMPING_RATIO omega (depth in the rim, 0 to 1)^2."""
        tile, (x, z) = self.tile, self.tile.nodes()
        far = np.abs(x)[:, None] / (0.5 * tile.side) + 0.0 * z
        if tile.rows > 1:
            far = np.maximum(far, np.abs(z) / (0.5 * tile.width))
        k = 2.0 * np.pi * PER_TILE / tile.side
        omega = np.sqrt(tile.gravity * k * np.tanh(k * tile.depth))
        return RIM_DAMPING_RATIO * omega * np.clip((far - (1.0 - 2.0 * RIM_SHARE)) / (2.0 * RIM_SHARE), 0.0, 1.0) ** 2

    @cached_property
    def damping_cache(self) -> dict[float, np.ndarray]:
        """Factors (cells, rows) by which a step damps waves in the tile's rim, cached for the last step's dt [s]."""
        return {}

    def begin(self, pressure: np.ndarray, centre: np.ndarray, dt: float) -> None:
        """Start at rest under `pressure` / density (Fourier modes [m2/s2]), tile at `centre` [m]; dt [s]: of a step."""
        tile, half = self.tile, 0.5 * dt * self.tile.omega
        rest = np.divide(half, np.tan(half), out=np.ones(half.shape), where=half > 0.0) / tile.gravity
        self.set_pressure(pressure)
        self.centre = centre
        self.eta, self.phi = tile.to_values(-rest * self.pressure), np.zeros(tile.shape)

    def advance(self, dt: float, pressure: np.ndarray, centre: np.ndarray) -> None:
        """Advance by dt [s], half under old, half under new `pressure` / density (modes [m2/s2]); damp the tile's edges
        around its new `centre` x, z (2,) [m]."""
        tile = self.tile
        e, p = self.propagate(dt)
        self.set_pressure(pressure)
        self.centre = centre
        self.eta, self.phi = tile.to_values(e), tile.to_values(p - 0.5 * dt * self.pressure)
        if self.rim:
            if dt not in self.damping_cache:
                self.damping_cache.clear()
                self.damping_cache[dt] = np.exp(-dt * self.damping_rate)
            calm = np.roll(self.damping_cache[dt], np.round(centre / tile.cell).astype(int), axis=(0, 1))
            self.eta *= calm
            self.phi *= calm
            self.eta -= self.eta.mean()

    def propagate(self, dt: float) -> tuple[np.ndarray, np.ndarray]:
        """Fourier modes of elevation and potential dt [s] later: half of the step's pressure acts, then the waves run
        freely; `advance` lets the other half act."""
        tile = self.tile
        return tile.evolve(tile.to_modes(self.eta), tile.to_modes(self.phi) - 0.5 * dt * self.pressure, dt)

    def covers(self, points: np.ndarray) -> np.ndarray:
        """Mask (m,) of the points x, z (m, 2) [m] that lie on the tile around its present centre."""
        half = 0.5 * np.array([self.tile.side, self.tile.width if self.tile.rows > 1 else np.inf])
        return np.all(np.abs(points - self.centre) < half, axis=1)
