"""Steep waves on a tile: the high-order spectral method to third order in the slope.

Dommermuth & Yue (1987, J. Fluid Mech. 184) and West et al. (1987, J. Geophys. Res. 92), whose way to cut the products
of the vertical velocity keeps the energy. With eta the elevation, phi the potential on the surface and W the vertical
velocity there,

    eta_t = -grad phi . grad eta + (1 + |grad eta|^2) W,    phi_t = -g eta - 1/2 |grad phi|^2 + 1/2 (1 + |grad eta|^2)
    W^2.

A step is Runge and Kutta's of fourth order around the exact turn of the linear modes. Of the shortest modes along each
axis half are left empty: then no product of three waves is taken for another one (k_max = 2/(M+1) of Nyquist's).
Started from a linear sea, what is not linear grows like 1 - exp(-(t/T)^4) (Dommermuth 2000, Wave Motion 32), or waves
would be thrown off that no sea has.
"""

from dataclasses import replace
from functools import cached_property
from math import exp, pi
from typing import ClassVar, NamedTuple

import numpy as np

from ocean_sim import waves
from ocean_sim.fluid.open_sea.wave_tile import Tile

ROUNDED = 1.0 + 1e-9
KEPT = 0.5  # of the wavenumbers along each axis: 2 / (M + 1) with M = 3
STEPS_PER_WAVE = 40  # of the highest wave
PART = 0.8  # [rad] by which a wave of SHORT cells turns in a step
SHORT = 4.0  # cells

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

    def calm(self, sea: "HighOrder", dt: float) -> None:
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

    def crests(self, sea: "HighOrder") -> tuple[np.ndarray, np.ndarray, np.ndarray]:
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

    def diffused(self, sea: "HighOrder", nu: np.ndarray, field: np.ndarray) -> np.ndarray:
        """div (2 nu grad field), which changes no mean; in the modes that the sea keeps."""
        tile = self.tile
        fluxes = [2.0 * nu * tile.values(slope) for slope in tile.slopes(tile.waves(field))]
        (xx, _), (_, zz) = (tile.slopes(tile.waves(flux)) for flux in fluxes)
        return tile.values(sea.clear * (xx + zz))


class HighOrder:
    """Elevation and surface potential of a nonlinear sea that repeats itself."""

    left_out: ClassVar[tuple[str, ...]] = ("up", "clear", "known")

    def __init__(self, tile: Tile, onset: float, breaking: Breaking | None = None) -> None:
        """`onset`: time scale on which what is not linear sets in [s]; 0: from the beginning."""
        self.tile, self.onset, self.breaking, self.time = tile, onset, breaking, 0.0
        self.eta, self.phi = np.zeros(tile.shape), np.zeros(tile.shape)

    @cached_property
    def known(self) -> dict[float, tuple[np.ndarray, np.ndarray]]:
        """By time [s]: what `rates` gives of the state now, where it is known."""
        return {}

    @cached_property
    def clear(self) -> np.ndarray:
        """1 for each mode that is kept, 0 for the others."""
        most = KEPT * np.pi / self.tile.cell * ROUNDED
        return ((np.abs(self.tile.kx) < most) & (self.tile.kz < most)).astype(float)

    @cached_property
    def up(self) -> np.ndarray:
        """d/dz at the still surface of each mode [1/m]."""
        return self.clear * self.tile.k * np.tanh(self.tile.k * self.tile.depth)

    def begin(self, eta: np.ndarray, phi: np.ndarray) -> None:
        """This elevation [m] and surface potential [m2/s] at time 0."""
        tile = self.tile
        self.time = 0.0
        self.known.clear()
        self.eta, self.phi = (tile.values(self.clear * tile.waves(field)) for field in (eta, phi))

    def advance(self, dt: float) -> None:
        """A step of dt [s]."""
        tile, t = self.tile, self.time
        e, p = tile.waves(self.eta), tile.waves(self.phi)
        half, full = 0.5 * dt, dt
        a = self.known.pop(t, None) or self.rates(e, p, t)
        eh, ph = tile.turned(e, p, half)
        ah = tile.turned(*a, half)
        b = self.rates(eh + half * ah[0], ph + half * ah[1], t + half)
        c = self.rates(eh + half * b[0], ph + half * b[1], t + half)
        bc = b[0] + c[0], b[1] + c[1]
        once = tile.turned(eh, ph, half)
        ch = tile.turned(*c, half)
        d = self.rates(once[0] + full * ch[0], once[1] + full * ch[1], t + full)
        first, middle = tile.turned(*ah, half), tile.turned(*bc, half)
        e, p = (x + dt / 6.0 * (f + 2.0 * m + last) for x, f, m, last in zip(once, first, middle, d))
        self.eta, self.phi = tile.values(e), tile.values(p)
        self.time = t + dt
        if self.breaking is not None:
            self.breaking.calm(self, dt)

    def rates(self, e: np.ndarray, p: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray]:
        """Modes of what is not linear in the growth of elevation and potential."""
        return self.grown(self.surface(e, p), time)

    def grown(self, now: Surface, time: float) -> tuple[np.ndarray, np.ndarray]:
        """The same of a surface."""
        w1, w2, w3 = now.w
        steep = now.slope_x**2 + now.slope_z**2
        eta = w2 + w3 + steep * w1 - now.phi_x * now.slope_x - now.phi_z * now.slope_z
        phi = 0.5 * w1**2 + w1 * w2 - 0.5 * (now.phi_x**2 + now.phi_z**2)
        part = self.tile.waves(np.array([eta, phi])) * (self.clear * self.part(time))
        part[0, 0, 0] = 0.0  # the mean level stays
        return part[0], part[1]

    def part(self, time: float) -> float:
        """Of what is not linear, at a time [s]."""
        return 1.0 - exp(-((time / self.onset) ** 4)) if self.onset else 1.0

    def surface(self, e: np.ndarray, p: np.ndarray) -> Surface:
        """Slopes and vertical velocity of modes of the elevation and surface potential."""
        tile, (ex, ez), (px, pz) = self.tile, self.tile.slopes(e), self.tile.slopes(p)
        eta, slope_x, slope_z, phi_x, phi_z, w1 = tile.values(np.array([e, ex, ez, px, pz, self.up * p]))
        return Surface(slope_x, slope_z, phi_x, phi_z, (w1, *self.higher(eta, p, w1)[1:]))

    def higher(self, eta: np.ndarray, p: np.ndarray, w1: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of a harmonic function with modes p on the surface and derivative w1 there to first order: the modes of its
        value at the still surface, and its vertical derivative on the surface to second and to third order."""
        tile, up = self.tile, self.up
        k2 = self.clear * tile.k**2
        twice, thrice = tile.values(np.array([k2 * p, k2 * up * p]))
        p2 = -self.clear * tile.waves(eta * w1)
        up_2, twice_2 = tile.values(np.array([up * p2, k2 * p2]))
        square = 0.5 * eta**2
        p3 = -self.clear * tile.waves(eta * up_2 + square * twice)
        up_3 = tile.values(up * p3)
        return p + p2 + p3, up_2 + eta * twice, up_3 + eta * twice_2 + square * thrice

    def potentials(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Modes of the elevation, of the potential at the still surface, and of its growth in time."""
        tile, g = self.tile, self.tile.gravity
        e, p = tile.waves(self.eta), tile.waves(self.phi)
        now = self.surface(e, p)
        self.known[self.time] = eta_n, phi_n = self.grown(now, self.time)
        eta_t, phi_t = tile.values(np.array([eta_n + self.up * p, phi_n - g * e]))
        growth = self.clear * tile.waves(phi_t - sum(now.w) * eta_t)  # at a place that does not move with the surface
        flat = self.higher(self.eta, p, now.w[0])[0]
        return e, flat, self.higher(self.eta, growth, tile.values(self.up * growth))[0]

    def energy(self) -> float:
        """Over the density [m5/s2]: 1/2 the integral of phi eta_t + g eta^2."""
        tile = self.tile
        e, p = tile.waves(self.eta), tile.waves(self.phi)
        eta_t = tile.values(self.rates(e, p, self.time)[0] + self.up * p)
        return 0.5 * float((self.phi * eta_t + tile.gravity * self.eta**2).sum()) * tile.cell**2


def step_of(tile: Tile) -> float:
    """Time in which the shortest waves that count turn by PART [s]."""
    return PART / float(waves.angular_frequency(2.0 * pi / (SHORT * tile.cell), tile.depth, tile.gravity))


def evolving(sea: waves.Components, tile: Tile, onset: float, breaking: bool, period: float) -> HighOrder:
    """The nonlinear sea that these waves grow into, on a tile that holds them; `period`: of the highest [s], 0 where
    none may break."""
    of_tile = replace(tile, part=KEPT)
    crests = Breaking(of_tile, heading(sea), period) if breaking and period else None
    steep = HighOrder(of_tile, onset, crests)
    points = np.stack([axis.ravel() for axis in np.meshgrid(*of_tile.nodes(), indexing="ij")], axis=1)
    late = replace(sea, amplitude=sea.amplitude * sea.gravity / sea.omega, phase=sea.phase - 0.5 * pi)
    steep.begin(*(waves.elevation(of, points).reshape(of_tile.shape) for of in (sea, late)))
    return steep


def heading(sea: waves.Components) -> np.ndarray:
    """(2,) unit vector along x and z where the energy of waves goes to."""
    ahead = (sea.amplitude[:, None] ** 2 * sea.wavevector / sea.wavenumber[:, None]).sum(axis=0)
    return ahead / max(float(np.linalg.norm(ahead)), 1e-30)
