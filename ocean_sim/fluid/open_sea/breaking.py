"""Crests that break: where the water on a crest moves faster than 0.85 of the crest itself, an eddy viscosity takes
energy.

The onset is that of Barthelemy et al. (2018, J. Fluid Mech. 841): u/C on the crest, u the velocity of the water on it
and C the speed of the crest, both along the waves. C follows from the local wavenumber, the rate at which the phase of
the surface and of its quarter-wave shift grows along the waves. The viscosity acts on elevation and surface potential
alike (Tian, Perlin & Choi 2010, Phys. Fluids 22), on the crest and a quarter wave around it and for a quarter of a
period after the onset; the mean level and the mean momentum stay. What it takes is booked. Where crests break the water
is white, and then less and less (Monahan & Zietlow 1969, J. Geophys. Res. 74).
"""

from functools import cached_property
from typing import ClassVar, NamedTuple, Protocol

import numpy as np

from ocean_sim.fluid.open_sea.wave_tile import Tile

ONSET = 0.85  # u/C on a crest that begins to break
EDDY = 0.02  # viscosity over C / k: of the size that Tian et al. find
LASTS = 0.25  # [periods] for which it stays after the onset
AROUND = 0.25  # [local wavelengths] as far as it reaches
FADES = 3.85  # [s] in which white water falls to a third: the mean in salt water
CREST = 0.3  # of the highest elevation, above which a crest counts as one


class Surface(NamedTuple):
    """What the surface does, by values (cells, rows)."""

    slope_x: np.ndarray
    slope_z: np.ndarray
    phi_x: np.ndarray  # slopes of the potential on the surface [m/s]
    phi_z: np.ndarray
    w: tuple[np.ndarray, np.ndarray, np.ndarray]  # vertical velocity on it, by order [m/s]


class Sea(Protocol):
    """A nonlinear sea on a tile."""

    eta: np.ndarray  # (cells, rows) [m]
    phi: np.ndarray  # on the surface [m2/s]

    @property
    def clear(self) -> np.ndarray:
        """1 for each mode that is kept, 0 for the others."""
        ...

    def surface(self, e: np.ndarray, p: np.ndarray) -> Surface:
        """Of modes of the elevation and surface potential."""
        ...

    def energy(self) -> float:
        """Over the density [m5/s2]."""
        ...


class Breaking:
    """Where crests break, since when, and what it has cost."""

    left_out: ClassVar[tuple[str, ...]] = ("forward",)

    def __init__(self, tile: Tile, ahead: np.ndarray, period: float) -> None:
        """`ahead`: unit vector along x and z where the waves go to; `period` of the highest of them [s]."""
        self.tile, self.ahead, self.period = tile, ahead, period
        self.left = np.zeros(tile.shape)  # for how long it lasts yet, in each cell [s]
        self.lost = 0.0  # energy over the density [m5/s2], since the start
        self.white = np.zeros(tile.shape)  # share of each cell that foam covers

    @cached_property
    def forward(self) -> np.ndarray:
        """1 for each mode that goes along with the waves, -1 for one that goes against them, 0 where that is not
        known."""
        along = self.ahead[0] * np.broadcast_to(self.tile.kx, self.tile.k.shape) + self.ahead[1] * self.tile.kz
        return np.sign(along) * self.tile.directed

    def calm(self, sea: Sea, dt: float) -> None:
        """Take from the sea what breaks in a step of dt [s]."""
        k, speed, ratio = self.crests(sea)
        onset = ratio > ONSET
        reach = np.pi * 2.0 * AROUND / k
        self.left = np.maximum(self.left - dt, 0.0)
        for i, j in np.argwhere(onset):
            self.spread(i, j, float(reach[i, j]))
        breaks = self.left > 0.0
        self.white = np.where(breaks, 1.0, self.white * np.exp(-dt / FADES))
        if breaks.any():
            before = sea.energy()
            nu = np.where(breaks, np.minimum(EDDY * speed / k, 0.2 * self.tile.cell**2 / dt), 0.0)
            sea.eta, sea.phi = (field + dt * self.diffused(sea, nu, field) for field in (sea.eta, sea.phi))
            self.lost += before - sea.energy()

    def crests(self, sea: Sea) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(cells, rows) local wavenumber along the waves [rad/m], speed of the crests [m/s], and u/C where there is a
        crest, 0 elsewhere."""
        tile, (c, s) = self.tile, self.ahead
        e, p = tile.waves(sea.eta), tile.waves(sea.phi)
        now, (ex, ez) = sea.surface(e, p), tile.slopes(e)
        quarter = -1j * self.forward  # a quarter wave later
        other, slope, other_slope = tile.values(np.array([quarter * e, c * ex + s * ez, quarter * (c * ex + s * ez)]))
        envelope = np.maximum(sea.eta**2 + other**2, 1e-300)
        least, most = 4.0 * np.pi / max(tile.side, tile.width), np.pi / (2.0 * tile.cell)
        k = np.clip((sea.eta * other_slope - other * slope) / envelope, least, most)
        speed = np.sqrt(tile.gravity / k * np.tanh(k * tile.depth))
        u = c * now.phi_x + s * now.phi_z - sum(now.w) * (c * now.slope_x + s * now.slope_z)
        step_x, step_z = (int(np.round(part)) for part in self.ahead)
        behind = np.roll(sea.eta, (step_x, step_z), axis=(0, 1))
        before = np.roll(sea.eta, (-step_x, -step_z), axis=(0, 1))
        crest = (sea.eta >= behind) & (sea.eta > before) & (sea.eta > CREST * float(sea.eta.max()))
        return k, speed, np.where(crest, u / speed, 0.0)

    def spread(self, i: int, j: int, reach: float) -> None:
        """The cells within a reach [m] of a crest that begins to break."""
        n = max(1, round(reach / self.tile.cell))
        rows = np.arange(-n, n + 1) if self.tile.rows > 1 else np.zeros(1, dtype=int)
        at = np.ix_((i + np.arange(-n, n + 1)) % self.tile.cells, (j + rows) % self.tile.rows)
        self.left[at] = np.maximum(self.left[at], LASTS * self.period)

    def diffused(self, sea: Sea, nu: np.ndarray, field: np.ndarray) -> np.ndarray:
        """div (2 nu grad field), which changes no mean; in the modes that the sea keeps."""
        tile = self.tile
        fluxes = [2.0 * nu * tile.values(slope) for slope in tile.slopes(tile.waves(field))]
        (xx, _), (_, zz) = (tile.slopes(tile.waves(flux)) for flux in fluxes)
        return tile.values(sea.clear * (xx + zz))
