"""Steep waves on a tile: the high-order spectral method to third order in the slope.

Dommermuth & Yue (1987, J. Fluid Mech. 184) and West et al. (1987, J. Geophys. Res. 92), whose way to cut the products
of the vertical velocity keeps the energy. With eta the elevation, phi the potential on the surface and W the vertical
velocity there,

    eta_t = -grad phi . grad eta + (1 + |grad eta|^2) W,    phi_t = -g eta - 1/2 |grad phi|^2 + 1/2 (1 + |grad eta|^2)
    W^2.

A step is Runge and Kutta's of fourth order around the exact turn of the linear modes. The shorter half of the modes
along each axis stays empty, so no product of three waves aliases (k_max = 2/(M+1) of Nyquist's). The nonlinear terms
set in over a linear sea as 1 - exp(-(t/T)^4), which throws off no spurious waves (Dommermuth 2000, Wave Motion 32).

Crests break at the onset of Barthelemy et al. (2018, J. Fluid Mech. 841): u/C above 0.85 on the crest, u the velocity
of the water there and C the speed of the crest, both along the waves. C follows from the local wavenumber, the rate at
which the phase of the surface and of its quarter-wave shift grows along the waves. An eddy viscosity then acts on
elevation and surface potential alike (Tian, Perlin & Choi 2010, Phys. Fluids 22), within a quarter of a wave and for a
quarter of a period; the mean level and the mean momentum stay, and the loss of energy is booked. The water turns white
where crests break and then fades (Monahan & Zietlow 1969, J. Geophys. Res. 74).
"""

from dataclasses import replace
from functools import cached_property
from math import exp, pi
from typing import NamedTuple

import numpy as np

from ocean_sim import waves
from ocean_sim.fluid.open_sea.wave_tile import Tile

ROUNDING_FACTOR = 1.0 + 1e-9  # on the highest wavenumber
RESOLVED_SHARE = 0.5  # share of the wavenumbers along each axis that is resolved: 2 / (M + 1) with M = 3
STEPS_PER_WAVE = 40  # steps in a period of the highest wave
STEP_ANGLE = 0.8  # [rad] turn in a step of a wave of STEP_WAVE_CELLS cells
STEP_WAVE_CELLS = 4.0  # length of that wave [cells]

BREAKING_ONSET = 0.85  # u/C on a crest that begins to break
EDDY_VISCOSITY_RATIO = 0.02  # viscosity over C / k: of the size that Tian et al. find
BREAKING_PERIODS = 0.25  # [periods] duration of the viscosity after the onset
BREAKING_REACH = 0.25  # [local wavelengths] reach of the viscosity around the crest
FOAM_FADE_TIME = 3.85  # [s] in which white water falls to a third: the mean in salt water
CREST_SHARE = 0.3  # share of the highest elevation above which a crest counts


class SurfaceState(NamedTuple):
    """Slopes and velocities of the sea surface on a tile, (cells, rows) each."""

    slope_x: np.ndarray
    slope_z: np.ndarray
    phi_x: np.ndarray  # slopes of the potential on the surface [m/s]
    phi_z: np.ndarray
    w: tuple[np.ndarray, np.ndarray, np.ndarray]  # vertical velocity on it, by order [m/s]


class Breaking:
    """Breaking crests of a nonlinear sea: cells that break now, energy lost so far, and foam left by breaking."""

    def __init__(self, tile: Tile, ahead: np.ndarray, period: float) -> None:
        """Start without breaking; `ahead` (2,): unit vector along the waves; `period` [s]: of the highest waves."""
        self.tile, self.ahead, self.period = tile, ahead, period
        self.left = np.zeros(tile.shape)  # time for which each cell still breaks [s]
        self.lost = 0.0  # energy over the density [m5/s2], since the start
        self.white = np.zeros(tile.shape)  # share of each cell that foam covers

    @cached_property
    def mode_signs(self) -> np.ndarray:
        """Sign of each Fourier mode's direction: 1 along the waves, -1 against them, 0 where it is undefined."""
        along = self.ahead[0] * np.broadcast_to(self.tile.kx, self.tile.k.shape) + self.ahead[1] * self.tile.kz
        return np.sign(along) * self.tile.directed_modes

    def dissipate(self, sea: "HighOrder", dt: float) -> None:
        """Find crests that begin to break, and damp all breaking cells of the sea by eddy viscosity for dt [s]."""
        k, speed, ratio = self.crest_state(sea)
        onset = ratio > BREAKING_ONSET
        reach = np.pi * 2.0 * BREAKING_REACH / k
        self.left = np.maximum(self.left - dt, 0.0)
        for i, j in np.argwhere(onset):
            n = max(1, round(float(reach[i, j]) / self.tile.cell))  # cells around the crest that break with it
            rows = np.arange(-n, n + 1) if self.tile.rows > 1 else np.zeros(1, dtype=int)
            at = np.ix_((i + np.arange(-n, n + 1)) % self.tile.cells, (j + rows) % self.tile.rows)
            self.left[at] = np.maximum(self.left[at], BREAKING_PERIODS * self.period)
        breaks = self.left > 0.0
        self.white = np.where(breaks, 1.0, self.white * np.exp(-dt / FOAM_FADE_TIME))
        if breaks.any():
            before = sea.energy()
            nu = np.where(breaks, np.minimum(EDDY_VISCOSITY_RATIO * speed / k, 0.2 * self.tile.cell**2 / dt), 0.0)
            sea.eta, sea.phi = (field + dt * self.diffusion(sea, nu, field) for field in (sea.eta, sea.phi))
            self.lost += before - sea.energy()

    def crest_state(self, sea: "HighOrder") -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Local wavenumber [rad/m], crest speed C [m/s], and water speed over C (0 off crests), each (cells, rows)."""
        tile, (c, s) = self.tile, self.ahead
        e, p = tile.to_modes(sea.eta), tile.to_modes(sea.phi)
        now, (ex, ez) = sea.surface_state(e, p), tile.slopes(e)
        quarter = -1j * self.mode_signs  # a quarter wave later
        ahead = c * ex + s * ez
        other, slope, other_slope = tile.to_values(np.array([quarter * e, ahead, quarter * ahead]))
        envelope = np.maximum(sea.eta**2 + other**2, 1e-300)
        least, most = 4.0 * np.pi / max(tile.side, tile.width), np.pi / (2.0 * tile.cell)
        k = np.clip((sea.eta * other_slope - other * slope) / envelope, least, most)
        speed = np.sqrt(tile.gravity / k * np.tanh(k * tile.depth))
        u = c * now.phi_x + s * now.phi_z - sum(now.w) * (c * now.slope_x + s * now.slope_z)
        step_x, step_z = (int(np.round(part)) for part in self.ahead)
        behind = np.roll(sea.eta, (step_x, step_z), axis=(0, 1))
        before = np.roll(sea.eta, (-step_x, -step_z), axis=(0, 1))
        crest = (sea.eta >= behind) & (sea.eta > before) & (sea.eta > CREST_SHARE * float(sea.eta.max()))
        return k, speed, np.where(crest, u / speed, 0.0)

    def diffusion(self, sea: "HighOrder", nu: np.ndarray, field: np.ndarray) -> np.ndarray:
        """Rate of change (cells, rows) of a field by a viscosity nu (cells, rows) [m2/s]: div (2 nu grad field)."""
        tile = self.tile
        fluxes = [2.0 * nu * tile.to_values(slope) for slope in tile.slopes(tile.to_modes(field))]
        (xx, _), (_, zz) = (tile.slopes(tile.to_modes(flux)) for flux in fluxes)
        return tile.to_values(sea.resolved_modes * (xx + zz))


class HighOrder:
    """Nonlinear sea on a tile (periodic grid): its elevation `eta` and surface potential `phi`, advanced in time."""

    def __init__(self, tile: Tile, onset: float, breaking: Breaking | None = None) -> None:
        """Start with calm water; `onset`: time scale [s] on which the nonlinear terms set in, 0 for at once."""
        self.tile, self.onset, self.breaking, self.time = tile, onset, breaking, 0.0
        self.eta, self.phi = np.zeros(tile.shape), np.zeros(tile.shape)

    @cached_property
    def rate_cache(self) -> dict[float, tuple[np.ndarray, np.ndarray]]:
        """Fourier modes of the present state's nonlinear rates, cached by time [s], since they are read twice."""
        return {}

    @cached_property
    def resolved_modes(self) -> np.ndarray:
        """Mask (cells, columns) of Fourier modes: 1 if resolved, 0 if kept at zero against aliasing."""
        most = RESOLVED_SHARE * np.pi / self.tile.cell * ROUNDING_FACTOR
        return ((np.abs(self.tile.kx) < most) & (self.tile.kz < most)).astype(float)

    @cached_property
    def vertical_factor(self) -> np.ndarray:
        """Factor k tanh kh [1/m] of each mode from a potential to its vertical derivative at the still surface."""
        return self.resolved_modes * self.tile.k * np.tanh(self.tile.k * self.tile.depth)

    def begin(self, eta: np.ndarray, phi: np.ndarray) -> None:
        """Start at time 0 with elevation `eta` [m] and surface potential `phi` [m2/s], (cells, rows) each."""
        tile = self.tile
        self.time = 0.0
        self.rate_cache.clear()
        self.eta, self.phi = (tile.to_values(self.resolved_modes * tile.to_modes(field)) for field in (eta, phi))

    def advance(self, dt: float) -> None:
        """Advance elevation and potential by dt [s] (Runge-Kutta of fourth order), then damp breaking crests."""
        tile, t = self.tile, self.time
        e, p = tile.to_modes(self.eta), tile.to_modes(self.phi)
        half, full = 0.5 * dt, dt
        a = self.rate_cache.pop(t, None) or self.nonlinear_rates(e, p, t)
        eh, ph = tile.evolve(e, p, half)
        ah = tile.evolve(*a, half)
        b = self.nonlinear_rates(eh + half * ah[0], ph + half * ah[1], t + half)
        c = self.nonlinear_rates(eh + half * b[0], ph + half * b[1], t + half)
        bc = b[0] + c[0], b[1] + c[1]
        once = tile.evolve(eh, ph, half)
        ch = tile.evolve(*c, half)
        d = self.nonlinear_rates(once[0] + full * ch[0], once[1] + full * ch[1], t + full)
        first, middle = tile.evolve(*ah, half), tile.evolve(*bc, half)
        e, p = (x + dt / 6.0 * (f + 2.0 * m + last) for x, f, m, last in zip(once, first, middle, d))
        self.eta, self.phi = tile.to_values(e), tile.to_values(p)
        self.time = t + dt
        if self.breaking is not None:
            self.breaking.dissipate(self, dt)

    def nonlinear_rates(self, e: np.ndarray, p: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray]:
        """Fourier modes of the nonlinear part of eta_t and phi_t at a time [s], from modes e of eta, p of phi."""
        return self.surface_rates(self.surface_state(e, p), time)

    def surface_rates(self, now: SurfaceState, time: float) -> tuple[np.ndarray, np.ndarray]:
        """Fourier modes of the nonlinear part of eta_t and phi_t at a time [s], from the surface state `now`."""
        w1, w2, w3 = now.w
        steep = now.slope_x**2 + now.slope_z**2
        eta = w2 + w3 + steep * w1 - now.phi_x * now.slope_x - now.phi_z * now.slope_z
        phi = 0.5 * w1**2 + w1 * w2 - 0.5 * (now.phi_x**2 + now.phi_z**2)
        part = self.tile.to_modes(np.array([eta, phi])) * (self.resolved_modes * self.nonlinear_share(time))
        part[0, 0, 0] = 0.0  # the mean level stays
        return part[0], part[1]

    def nonlinear_share(self, time: float) -> float:
        """Factor of the nonlinear terms at a time [s]: 0 at the start, rising to 1 on the time scale `onset`."""
        return 1.0 - exp(-((time / self.onset) ** 4)) if self.onset else 1.0

    def surface_state(self, e: np.ndarray, p: np.ndarray) -> SurfaceState:
        """Slopes and velocities of the surface, from Fourier modes e of its elevation and p of its potential."""
        tile, (ex, ez), (px, pz) = self.tile, self.tile.slopes(e), self.tile.slopes(p)
        modes = np.array([e, ex, ez, px, pz, self.vertical_factor * p])
        eta, slope_x, slope_z, phi_x, phi_z, w1 = tile.to_values(modes)
        return SurfaceState(slope_x, slope_z, phi_x, phi_z, (w1, *self.higher_orders(eta, p, w1)[1:]))

    def higher_orders(
        self, eta: np.ndarray, p: np.ndarray, w1: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Potential at the still level (Fourier modes), and vertical velocity on the surface to orders 2 and 3. From
        elevation `eta` [m], modes p of the surface potential, and first-order vertical velocity `w1` [m/s]."""
        tile, up = self.tile, self.vertical_factor
        k2 = self.resolved_modes * tile.k**2
        twice, thrice = tile.to_values(np.array([k2 * p, k2 * up * p]))
        p2 = -self.resolved_modes * tile.to_modes(eta * w1)
        up_2, twice_2 = tile.to_values(np.array([up * p2, k2 * p2]))
        square = 0.5 * eta**2
        p3 = -self.resolved_modes * tile.to_modes(eta * up_2 + square * twice)
        up_3 = tile.to_values(up * p3)
        return p + p2 + p3, up_2 + eta * twice, up_3 + eta * twice_2 + square * thrice

    def potentials(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Fourier modes (cells, columns) of the elevation, the potential at the still level and its rate of change."""
        tile, g = self.tile, self.tile.gravity
        e, p = tile.to_modes(self.eta), tile.to_modes(self.phi)
        now = self.surface_state(e, p)
        self.rate_cache[self.time] = eta_n, phi_n = self.surface_rates(now, self.time)
        eta_t, phi_t = tile.to_values(np.array([eta_n + self.vertical_factor * p, phi_n - g * e]))
        # At a place that does not move with the surface.
        growth = self.resolved_modes * tile.to_modes(phi_t - sum(now.w) * eta_t)
        flat = self.higher_orders(self.eta, p, now.w[0])[0]
        return e, flat, self.higher_orders(self.eta, growth, tile.to_values(self.vertical_factor * growth))[0]

    def energy(self) -> float:
        """Energy divided by the density [m5/s2]: 1/2 the integral of phi eta_t + g eta^2."""
        tile = self.tile
        e, p = tile.to_modes(self.eta), tile.to_modes(self.phi)
        eta_t = tile.to_values(self.nonlinear_rates(e, p, self.time)[0] + self.vertical_factor * p)
        return 0.5 * float((self.phi * eta_t + tile.gravity * self.eta**2).sum()) * tile.cell**2


def tile_step(tile: Tile) -> float:
    """Time step [s] of waves on a tile (a periodic grid): those STEP_WAVE_CELLS cells long turn by STEP_ANGLE [rad]."""
    k = 2.0 * pi / (STEP_WAVE_CELLS * tile.cell)
    return STEP_ANGLE / float(waves.angular_frequency(k, tile.depth, tile.gravity))


def nonlinear_sea(sea: waves.Components, tile: Tile, onset: float, breaking: bool, period: float) -> HighOrder:
    """Make a nonlinear sea from waves periodic on a tile. `onset`: time scale [s] on which nonlinear terms set in;
    `breaking`: True if crests may break; `period` [s]: of the highest waves, 0 if none may break."""
    of_tile = replace(tile, part=RESOLVED_SHARE)
    # The mean direction of energy transport is that of the waves.
    ahead = (sea.amplitude[:, None] ** 2 * sea.wavevector / sea.wavenumber[:, None]).sum(axis=0)
    ahead /= max(float(np.linalg.norm(ahead)), 1e-30)
    crests = Breaking(of_tile, ahead, period) if breaking and period else None
    steep = HighOrder(of_tile, onset, crests)
    points = np.stack([axis.ravel() for axis in np.meshgrid(*of_tile.nodes(), indexing="ij")], axis=1)
    late = replace(sea, amplitude=sea.amplitude * sea.gravity / sea.omega, phase=sea.phase - 0.5 * pi)
    steep.begin(*(waves.elevation(of, points).reshape(of_tile.shape) for of in (sea, late)))
    return steep
