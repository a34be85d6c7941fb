"""The waves of a moving pressure as another ship feels them: their height abeam, at one and three lengths.

In axes that move with a pressure p at a speed U along x, steady linear waves in deep water are
eta = 1 / (2 pi^2 rho U^2) Re of the integral over t in -pi/2..pi/2 of sec^2 t times that over k in 0..inf of
k p(k, t) exp(i k w) / (k - k0 + i 0), with w = x cos t + z sin t and k0 = g / U^2 sec^2 t: the pole lies where waves
only follow (Havelock 1932, Proc. R. Soc. A 138; Wehausen & Laitone 1960, Surface Waves, 21). Along a ray in the plane
of k that turns towards the side where exp(i k w) decays the integrand is smooth; where w < 0 it passes the pole, whose
residue is the wake. The pressure is a Gaussian of 2 kPa, 3 m along and 1.5 m across its track, as a tile spreads it.
"""

from types import SimpleNamespace

import numpy as np

from ocean_sim.conventions import GRAVITY, WATER_DENSITY
from ocean_sim.fluid import Displacing
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, absolute_error, percent_error
from ocean_sim.validation.shared.sea import SPECTRAL_SCHEMES, sea_of, smooth_ramp, tile_scene
from ocean_sim.validation.spectral_wake import PRESSURE_PEAK, WIDTH_ACROSS, WIDTH_ALONG

SHIP_SPEED, SHIP_LENGTH, BEAM_DISTANCES = 5.0, 10.0, (1, 3)  # [m/s], [m], lengths
TILE_SIDE, TILE_CELLS, TIME_STEP = 320.0, 160, 0.2  # [m], cells, [s]
RAMP_TIME, END_TIME = 10.0, 90.0  # [s]
CLEAR_SHARE = 0.33  # of the side, behind the pressure, without a rim
ANGLE_NODES, RADIUS_NODES, CUT_SPACING = 200, 80, 0.5  # nodes of the integrals, to 0.004 mm; [m] along a cut
RAY_ANGLE, RAY_END = np.pi / 8.0, 7.0  # [rad]; over the width of the Gaussian


def problems(coarse: bool) -> list[Problem]:
    promises = tuple(
        Promise(f"height of the wake {n} x {SHIP_LENGTH:g} m abeam [m]", "%", "Havelock 1932", {"spectral_sea": 5.0})
        for n in BEAM_DISTANCES
    )
    own = Promise("the wake where its own ship is shown the water [m]", "m", "nothing", {"spectral_sea": 0.0})

    def measure(simulation: Simulation) -> Finding:
        tile = sea_of(simulation).tile
        # widths of the pressure as the tile spreads it
        widths = [np.sqrt(width**2 + (2.0 + 1.0 / 3.0) * tile.cell**2) for width in (WIDTH_ALONG, WIDTH_ACROSS)]
        x = np.arange(-CLEAR_SHARE * TILE_SIDE, 0.05 * TILE_SIDE, CUT_SPACING)
        by_another, by_itself, at = passing_waters(simulation)
        numbers, measured, expected = [], [], []
        for n in BEAM_DISTANCES:
            cut = np.stack([at + x, np.full(len(x), n * SHIP_LENGTH)], axis=1)
            eta, exact = by_another.elevations(cut), np.array([elevation_at(a, n * SHIP_LENGTH, *widths) for a in x])
            numbers.append(percent_error(float(np.ptp(eta)), float(np.ptp(exact))))
            measured.append(Curve(f"{n} lengths abeam", x, eta))
            expected.append(Curve(f"Havelock, {n} lengths", x, exact))
            still = float(np.abs(by_itself.elevations(cut)).max())
        return Finding([*numbers, absolute_error(still)], measured, expected, ("ahead [m]", "elevation [m]"))

    bare = tile_scene(TILE_SIDE, TILE_CELLS, step=TIME_STEP) | {"time_step": {"kind": "fixed", "dt": TIME_STEP}}
    return [Problem(bare, (*promises, own), measure, schemes=SPECTRAL_SCHEMES)]


class GaussianPressure(Displacing):
    """A moving pressure of Gaussian shape, in the form of a body that displaces water of the same weight."""

    def __init__(self) -> None:
        ticks = np.arange(-3.0, 3.01, 0.125)
        x, z = np.meshgrid(ticks * WIDTH_ALONG, ticks * WIDTH_ACROSS, indexing="ij")
        self.points = np.stack([x.ravel(), z.ravel(), np.zeros(x.size)], axis=1)
        shape = np.exp(-((self.points[:, :2] / [WIDTH_ALONG, WIDTH_ACROSS]) ** 2).sum(axis=1))
        self.whole = PRESSURE_PEAK / (WATER_DENSITY * GRAVITY) * shape * (0.125 * WIDTH_ALONG) * (0.125 * WIDTH_ACROSS)
        self.body, self.share = SimpleNamespace(position=np.zeros(3)), 0.0

    def displaced(self) -> tuple[np.ndarray, np.ndarray]:
        """Points (n, 3) x, z, depth [m] and displaced volumes (n,) [m3] at the present position."""
        return self.points + self.body.position[[0, 2, 1]], self.share * self.whole


def passing_waters(simulation: Simulation) -> tuple:
    """Run with a moving pressure. Return the sea as another ship feels it and as the pressure does (each without the
    waves that it makes itself), and the last x [m] of the pressure."""
    patch, other = GaussianPressure(), GaussianPressure()
    by_itself, by_another = sea_of(simulation).add_ships([patch, other])
    while simulation.time < END_TIME - 0.5 * TIME_STEP:
        patch.share = smooth_ramp(simulation.time / RAMP_TIME)
        patch.body.position = np.array([SHIP_SPEED * simulation.time, 0.0, 0.0])
        simulation.step()
    return by_another, by_itself, float(patch.body.position[0] + SHIP_SPEED * TIME_STEP)


def elevation_at(x: float, z: float, long: float, broad: float) -> float:
    """Elevation [m] by Havelock's integral, `x` ahead of and `z` beside a pressure ~ exp(-(x / long)^2 - (z / broad)^2)
    that moves at SHIP_SPEED; all lengths [m]. Its force [N] is pi WIDTH_ALONG WIDTH_ACROSS PRESSURE_PEAK."""
    edge = np.arctan2(-x, z)  # w changes its sign here
    total = 0.0
    for low, high in ((-0.5 * np.pi, edge), (edge, 0.5 * np.pi)):
        nodes, weights = np.polynomial.legendre.leggauss(ANGLE_NODES)
        t, weight = low + 0.5 * (high - low) * (nodes + 1.0), 0.5 * (high - low) * weights
        w, k0 = x * np.cos(t) + z * np.sin(t), GRAVITY / (SHIP_SPEED * np.cos(t)) ** 2
        width = np.hypot(long * np.cos(t), broad * np.sin(t))
        ahead = w > 0.0
        # The ray turns to the side on which exp(i k w) decays; behind, it passes the pole, whose residue is the wake.
        s, ds = np.polynomial.legendre.leggauss(RADIUS_NODES)
        ray = np.exp(1j * np.where(ahead, RAY_ANGLE, -RAY_ANGLE))[:, None]
        k = 0.5 * RAY_END * (s + 1.0) / width[:, None] * ray
        dk = 0.5 * RAY_END * ds / width[:, None] * ray
        decay = np.exp(-0.25 * (k * width[:, None]) ** 2 + 1j * k * w[:, None])
        inner = (dk * k * decay / (k - k0[:, None])).sum(axis=1)
        residue = k0 * np.exp(-0.25 * (k0 * width) ** 2 + 1j * k0 * w)
        whole = (inner - np.where(ahead, 0.0, 2j * np.pi * residue)) / np.cos(t) ** 2
        total += float((weight * whole).sum().real)
    pushed = np.pi * WIDTH_ALONG * WIDTH_ACROSS * PRESSURE_PEAK
    return pushed * total / (2.0 * np.pi**2 * WATER_DENSITY * SHIP_SPEED**2)
