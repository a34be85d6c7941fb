"""Linear waves on a tile of open sea: what they keep, what the rim of a ship's tile returns, and a random sea.

Without rim the step is exact: energy and phase stay for a hundred periods. Waves that an oscillating pressure sends out
are compared with those on a tile eight times as large: the difference is what the rim has sent back. A sea from
JONSWAP's spectrum with spread directions has the height, mean period and direction that were asked for.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from ocean_sim import waves
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Finding, Problem, Promise, relative
from ocean_sim.validation.shared.sea import SCHEMES, G, going, risen, scene, sea_of

if TYPE_CHECKING:
    from ocean_sim.fluid.open_sea.wave_tile import Tile

PERIODS, STEPS = 100, 40
ON_TILE = (6, 8)  # waves on the tile, of which it is asked how much comes back
LARGE, FREE = 8, 0.35  # times as large; of the side, from the pressure to the rim
RANDOM = {"significant_wave_height": 1.5, "peak_period": 6.0, "heading_deg": 30.0, "spreading": 10.0, "seed": 3}
CUT_OFF = 2.2  # [peak frequencies]: what a tile of twelve waves in 256 cells holds at order 3
APART, ASKED, TIMES = 2.0e4, 16000, 10  # [m] in which so many points are asked, so often
BRIEF = 1.0e-3  # [s] in which a surface rises


def problems(coarse: bool) -> list[Problem]:
    return [kept(), returned(), *(random(order) for order in (1, 3))]


def kept() -> Problem:
    energy = Promise("energy after 100 periods, change", "1", "none is lost", {"spectral_sea": 1e-6})
    phase = Promise("phase after 100 periods, error [rad]", "rad", "omega^2 = g k", {"spectral_sea": 1e-9})

    def measure(simulation: Simulation) -> Finding:
        from ocean_sim.fluid.open_sea.wave_tile import Layer

        tile = sea_of(simulation).tile
        layer, still = Layer(tile, rim=False), np.zeros(tile.k.shape)
        mode, random_ = (6, 5), np.random.default_rng(1).normal(size=tile.shape)
        e = tile.to_modes(random_) * np.exp(-((tile.k * tile.cell * 4.0) ** 2))
        e[0, 0] = 0.0
        going(layer, tile.to_values(e))
        first, omega = tile.energy(layer.eta, layer.phi), tile.omega[mode]
        before, dt = tile.to_modes(layer.eta)[mode], 2.0 * np.pi / omega / STEPS
        for _ in range(PERIODS * STEPS):
            layer.advance(dt, still, np.zeros(2))
        turn = float(abs(np.angle(tile.to_modes(layer.eta)[mode] / before)))
        change = tile.energy(layer.eta, layer.phi) / first - 1.0
        return Finding({energy.quantity: (change, 0.0, change), phase.quantity: (turn, 0.0, turn)})

    return Problem(scene(100.0, 64), (energy, phase), measure, "kept", schemes=SCHEMES, only=True)


def returned() -> Problem:
    promises = tuple(
        Promise(f"returned by the rim, {n} waves on the tile", "%", "none on a wide sea", {"spectral_sea": 2.0})
        for n in ON_TILE
    )

    def measure(simulation: Simulation) -> Finding:
        from ocean_sim.fluid.open_sea.wave_tile import Tile

        small = sea_of(simulation).tile
        large = Tile(LARGE * small.side, LARGE * small.cells, 1, small.depth, small.gravity)
        found = {}
        for n, promise in zip(ON_TILE, promises):
            k = 2.0 * np.pi * n / small.side
            near, far = radiated(small, k, True), radiated(large, k, False)
            sent = np.abs(far[: len(far) // 4]).mean()
            back = 100.0 * float(np.sqrt(np.mean(np.abs(near - far) ** 2)) / sent)
            found[promise.quantity] = (back, 0.0, back)
        return Finding(found)

    return Problem(scene(100.0, 256, slice_=True), promises, measure, "returned", schemes=SCHEMES, only=True)


def radiated(tile: "Tile", k: float, rim: bool) -> np.ndarray:
    """Complex amplitude [m] around an oscillating pressure as long as a wave of wavenumber k, where no rim is."""
    from ocean_sim.fluid.open_sea.wave_tile import Layer

    layer, omega = Layer(tile, rim), np.sqrt(G * k)
    dt, source = 2.0 * np.pi / omega / STEPS, tile.to_modes(np.exp(-((tile.nodes()[0] * k / 1.5) ** 2))[:, None])
    found = []
    for n in range(1, 30 * STEPS + 1):
        layer.advance(dt, risen(n / (4.0 * STEPS)) * np.cos(omega * n * dt) * source, np.zeros(2))
        if n > 28 * STEPS:
            found.append(layer.eta[:, 0] * np.exp(1j * omega * n * dt))
    middle, half = tile.cells // 2, round(FREE * tile.cells / (1 if rim else LARGE))
    return 2.0 * np.mean(found, axis=0)[middle - half : middle + half]


def random(order: int) -> Problem:
    name = f"a random sea, order {order}"
    height = Promise(f"{name}: 4 sqrt(m0) [m]", "%", "asked for", {"spectral_sea": 1.0})
    period = Promise(f"{name}: T_m02 [s]", "%", "of the spectrum asked for", {"spectral_sea": 1.0})
    towards = Promise(f"{name}: direction [deg]", "deg", "asked for", {"spectral_sea": 1.0})
    spectrum: dict[str, float] = RANDOM | {"cut_off": CUT_OFF}
    asked = waves.SpreadSpectrum.model_validate(spectrum)
    side = 12.0 * G * asked.peak_period**2 / (2.0 * np.pi)

    def measure(simulation: Simulation) -> Finding:
        eta, rise, slope = surface(simulation, order)
        h = 4.0 * float(np.sqrt(np.mean(eta**2)))
        t = 2.0 * np.pi * float(np.sqrt(np.mean(eta**2) / np.mean(rise**2)))
        flux = -(rise[:, None] * slope).mean(axis=0)
        ahead = float(np.degrees(np.arctan2(*flux)))
        f = np.linspace(waves.LOWEST_FREQUENCY, asked.cut_off, waves.SPECTRUM_POINTS) / asked.peak_period
        s = asked.density(f)
        mean = float(np.sqrt(np.trapezoid(s, f) / np.trapezoid(s * f**2, f)))
        off = (ahead - RANDOM["heading_deg"] + 180.0) % 360.0 - 180.0
        return Finding(
            {
                height.quantity: relative(h, RANDOM["significant_wave_height"]),
                period.quantity: relative(t, mean),
                towards.quantity: (ahead, RANDOM["heading_deg"], off),
            }
        )

    of_order: dict[str, Any] = {"order": order, "spectrum": spectrum}
    return Problem(scene(side, 256, **of_order), (height, period, towards), measure, name, schemes=SCHEMES, only=True)


def surface(simulation: Simulation, order: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Elevation [m], how fast it rises [m/s], and its slopes (m, 2): at many points and times of a sea in closed form,
    at each cell of a nonlinear one as it begins."""
    fluid = sea_of(simulation)
    if fluid.steep is not None:
        from ocean_sim.fluid.spectral_sea import DRAWN, snapped

        sea = fluid.nonlinear(snapped(fluid.config.sea_of(simulation.basin, DRAWN), fluid.tile))
        tile = sea.tile
        e, p = tile.to_modes(sea.eta), tile.to_modes(sea.phi)
        modes = np.array([e, tile.k * np.tanh(tile.k * tile.depth) * p, *tile.slopes(e)])
        eta, rise, along, across = tile.to_values(modes).reshape(4, -1)
        return eta, rise, np.stack([along, across], axis=1)
    found = []
    draw = np.random.default_rng(5)
    for _ in range(TIMES):
        fluid.advance(float(draw.uniform(5.0, 50.0)))
        points = draw.uniform(-0.5 * APART, 0.5 * APART, (ASKED, 2))
        here, time = fluid.elevations(points), fluid.time
        ahead = [(fluid.elevations(points + step) - here) / 0.01 for step in ([0.01, 0.0], [0.0, 0.01])]
        rise = (waves.elevation(fluid.plane_waves, points, time + BRIEF) - here) / BRIEF
        found.append((here, rise, np.stack(ahead, axis=1)))
    return tuple(np.concatenate(part) for part in zip(*found))  # type: ignore[return-value]
