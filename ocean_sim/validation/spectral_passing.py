"""The waves of a moving pressure where another ship feels them: their height abeam, at one and three lengths.

In axes that move with a pressure p at a speed U along x, steady linear waves in deep water are
eta = 1 / (2 pi^2 rho U^2) Re of the integral over t in -pi/2..pi/2 of sec^2 t times that over k in 0..inf of
k p(k, t) exp(i k w) / (k - k0 + i 0), with w = x cos t + z sin t and k0 = g / U^2 sec^2 t: the pole lies where waves
only follow (Havelock 1932, Proc. R. Soc. A 138; Wehausen & Laitone 1960, Surface Waves, 21). Along a ray in the plane
of k that turns towards the side where exp(i k w) decays the integrand is smooth; where w < 0 it passes the pole, whose
residue is the wake. The pressure is a Gaussian of 2 kPa, 3 m along and 1.5 m across its track, as a tile spreads it.
"""

from types import SimpleNamespace

import numpy as np

from ocean_sim.conventions import WATER_DENSITY
from ocean_sim.fluid import Displacing
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative
from ocean_sim.validation.shared.sea import SCHEMES, G, risen, scene, sea_of

U, LENGTH, ABEAM = 5.0, 10.0, (1, 3)  # [m/s], [m], lengths
SIDE, CELLS, STEP = 320.0, 160, 0.2  # [m], cells, [s]
PRESSURE, LONG, BROAD = 2000.0, 3.0, 1.5  # [Pa], [m], [m]
RISE, END = 10.0, 90.0  # [s]
CLEAR = 0.33  # of the side, from the pressure on, in which waves are free
ANGLES, RADII, APART = 200, 80, 0.5  # nodes of the integrals, to 0.004 mm; [m] between the points of a cut
TURN, FAR = np.pi / 8.0, 7.0  # [rad] of the ray; where a Gaussian of the width 1 ends


def problems(coarse: bool) -> list[Problem]:
    promises = {
        n: Promise(f"height of the wake {n} x {LENGTH:g} m abeam [m]", "%", "Havelock 1932", {"spectral_sea": 5.0})
        for n in ABEAM
    }
    own = Promise("the wake where its own ship is shown the water [m]", "m", "nothing", {"spectral_sea": 0.0})

    def measure(simulation: Simulation) -> Finding:
        tile = sea_of(simulation).tile
        widths = [np.sqrt(width**2 + (2.0 + 1.0 / 3.0) * tile.cell**2) for width in (LONG, BROAD)]  # as it is spread
        x = np.arange(-CLEAR * SIDE, 0.05 * SIDE, APART)
        by_another, by_itself, at = passed(simulation)
        found, measured, expected = {}, [], []
        for n, promise in promises.items():
            cut = np.stack([at + x, np.full(len(x), n * LENGTH)], axis=1)
            eta, exact = by_another.elevations(cut), steady(x, n * LENGTH, *widths)
            found[promise.quantity] = relative(float(np.ptp(eta)), float(np.ptp(exact)))
            measured.append(Curve(f"{n} lengths abeam", x, eta))
            expected.append(Curve(f"Havelock, {n} lengths", x, exact))
            still = float(np.abs(by_itself.elevations(cut)).max())
        return Finding(found | {own.quantity: (still, 0.0, still)}, measured, expected, ("ahead [m]", "elevation [m]"))

    bare = scene(SIDE, CELLS, step=STEP) | {"time_step": {"kind": "fixed", "dt": STEP}}
    return [Problem(bare, (*promises.values(), own), measure, schemes=SCHEMES, only=True)]


class Patch(Displacing):
    """A pressure of Gaussian shape, as the volume that something displaces which presses like that."""

    def __init__(self) -> None:
        x, z = np.meshgrid(*(np.arange(-3.0, 3.01, 0.125) * width for width in (LONG, BROAD)), indexing="ij")
        self.points = np.stack([x.ravel(), z.ravel()], axis=1)
        shape = np.exp(-((self.points / [LONG, BROAD]) ** 2).sum(axis=1))
        self.whole = PRESSURE / (WATER_DENSITY * G) * shape * (0.125 * LONG) * (0.125 * BROAD)
        self.body, self.share = SimpleNamespace(position=np.zeros(3)), 0.0

    def displaced(self) -> tuple[np.ndarray, np.ndarray]:
        return self.points + self.body.position[[0, 2]], self.share * self.whole


def passed(simulation: Simulation) -> tuple:
    """The water as another ship feels it, and as the one does that has passed; and where that is along x [m]."""
    patch, other = Patch(), Patch()
    by_itself, by_another = sea_of(simulation).add_ships([patch, other])
    while simulation.time < END - 0.5 * STEP:
        patch.share = risen(simulation.time / RISE)
        patch.body.position = np.array([U * simulation.time, 0.0, 0.0])
        simulation.step()
    return by_another, by_itself, float(patch.body.position[0] + U * STEP)


def steady(x: np.ndarray, z: float, long: float, broad: float) -> np.ndarray:
    """(n,) elevation [m] at places x ahead of a Gaussian pressure of these widths, z beside its track [m]."""
    return np.array([at_point(each, z, long, broad) for each in x])


def at_point(x: float, z: float, long: float, broad: float) -> float:
    """The same at one point."""
    edge = np.arctan2(-x, z)  # where w changes its sign
    total = 0.0
    for low, high in ((-0.5 * np.pi, edge), (edge, 0.5 * np.pi)):
        nodes, weights = np.polynomial.legendre.leggauss(ANGLES)
        t, weight = low + 0.5 * (high - low) * (nodes + 1.0), 0.5 * (high - low) * weights
        w, k0 = x * np.cos(t) + z * np.sin(t), G / (U * np.cos(t)) ** 2
        width = np.hypot(long * np.cos(t), broad * np.sin(t))
        ahead = w > 0.0
        s, ds = np.polynomial.legendre.leggauss(RADII)
        ray = np.exp(1j * np.where(ahead, TURN, -TURN))[:, None]
        k = 0.5 * FAR * (s + 1.0) / width[:, None] * ray
        dk = 0.5 * FAR * ds / width[:, None] * ray
        inner = (dk * k * np.exp(-0.25 * (k * width[:, None]) ** 2 + 1j * k * w[:, None]) / (k - k0[:, None])).sum(
            axis=1
        )
        residue = k0 * np.exp(-0.25 * (k0 * width) ** 2 + 1j * k0 * w)
        whole = (inner - np.where(ahead, 0.0, 2j * np.pi * residue)) / np.cos(t) ** 2
        total += float((weight * whole).sum().real)
    pushed = np.pi * LONG * BROAD * PRESSURE
    return pushed * total / (2.0 * np.pi**2 * WATER_DENSITY * U**2)
