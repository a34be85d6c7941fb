"""Linear waves on a tile of open sea: conservation, reflection by the rim of a ship's tile, and a random sea.

Without rim the step is exact: energy and phase stay for a hundred periods. Waves that an oscillating pressure sends out
are compared with those on a tile eight times as large: the difference is the reflection of the rim. A sea from
JONSWAP's spectrum with spread directions has the height, mean period and direction of its keys.
"""

import numpy as np

from ocean_sim import waves
from ocean_sim.conventions import GRAVITY
from ocean_sim.fluid.open_sea.wave_tile import Layer, Tile
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Finding, Problem, Promise, absolute_error, percent_error
from ocean_sim.validation.shared.sea import SPECTRAL_SCHEMES, sea_of, smooth_ramp, tile_scene, travel_ahead

PERIOD_COUNT, PERIOD_STEPS = 100, 40  # of the conservation test
REFLECTED_WAVE_COUNTS = (6, 8)  # waves on the tile, for each a reflection
LARGE_TILE_RATIO, FREE_SHARE = 8, 0.35  # side over that of the small tile; share of the side from pressure to rim
SEA_KEYS = {"significant_wave_height": 1.5, "peak_period": 6.0, "heading_deg": 30.0, "spreading": 10.0, "seed": 3}
CUT_OFF_RATIO = 2.2  # over the peak frequency: the highest on a tile of twelve waves in 256 cells at order 3
SAMPLE_SIDE, SAMPLE_POINTS, SAMPLE_TIMES = 2.0e4, 16000, 10  # [m] of the square of sampled points
RISE_INTERVAL = 1.0e-3  # [s] of the difference in time


def problems(coarse: bool) -> list[Problem]:
    return [conservation_problem(), reflection_problem(), *(random_sea_problem(order) for order in (1, 3))]


def conservation_problem() -> Problem:
    energy = Promise("energy after 100 periods, change", "1", "none is lost", {"spectral_sea": 1e-6})
    phase = Promise("phase after 100 periods, error [rad]", "rad", "omega^2 = g k", {"spectral_sea": 1e-9})

    def measure(simulation: Simulation) -> Finding:
        tile = sea_of(simulation).tile
        layer, still = Layer(tile, rim=False), np.zeros(tile.k.shape)
        mode, random_ = (6, 5), np.random.default_rng(1).normal(size=tile.shape)
        e = tile.to_modes(random_) * np.exp(-((tile.k * tile.cell * 4.0) ** 2))
        e[0, 0] = 0.0
        travel_ahead(layer, tile.to_values(e))
        first, omega = tile.energy(layer.eta, layer.phi), tile.omega[mode]
        before, dt = tile.to_modes(layer.eta)[mode], 2.0 * np.pi / omega / PERIOD_STEPS
        for _ in range(PERIOD_COUNT * PERIOD_STEPS):
            layer.advance(dt, still, np.zeros(2))
        turn = float(abs(np.angle(tile.to_modes(layer.eta)[mode] / before)))
        change = tile.energy(layer.eta, layer.phi) / first - 1.0
        return Finding([absolute_error(change), absolute_error(turn)])

    return Problem(tile_scene(100.0, 64), (energy, phase), measure, "kept", schemes=SPECTRAL_SCHEMES)


def reflection_problem() -> Problem:
    promises = tuple(
        Promise(f"returned by the rim, {n} waves on the tile", "%", "none on a wide sea", {"spectral_sea": 2.0})
        for n in REFLECTED_WAVE_COUNTS
    )

    def measure(simulation: Simulation) -> Finding:
        small = sea_of(simulation).tile
        large = Tile(LARGE_TILE_RATIO * small.side, LARGE_TILE_RATIO * small.cells, 1, small.depth, small.gravity)
        numbers = []
        for n in REFLECTED_WAVE_COUNTS:
            k = 2.0 * np.pi * n / small.side
            near, far = radiated_amplitude(small, k, True), radiated_amplitude(large, k, False)
            sent = np.abs(far[: len(far) // 4]).mean()
            numbers.append(absolute_error(100.0 * float(np.sqrt(np.mean(np.abs(near - far) ** 2)) / sent)))
        return Finding(numbers)

    return Problem(tile_scene(100.0, 256, slice_=True), promises, measure, "returned", schemes=SPECTRAL_SCHEMES)


def radiated_amplitude(tile: Tile, k: float, rim: bool) -> np.ndarray:
    """Complex amplitudes (n,) [m], along x, of waves of wavenumber `k` [1/m] that an oscillating pressure sends out on
    a tile, with an absorbing rim or without."""
    layer, omega = Layer(tile, rim), np.sqrt(GRAVITY * k)
    dt, source = 2.0 * np.pi / omega / PERIOD_STEPS, tile.to_modes(np.exp(-((tile.nodes()[0] * k / 1.5) ** 2))[:, None])
    found = []
    for n in range(1, 30 * PERIOD_STEPS + 1):
        layer.advance(dt, smooth_ramp(n / (4.0 * PERIOD_STEPS)) * np.cos(omega * n * dt) * source, np.zeros(2))
        if n > 28 * PERIOD_STEPS:
            found.append(layer.eta[:, 0] * np.exp(1j * omega * n * dt))
    middle, half = tile.cells // 2, round(FREE_SHARE * tile.cells / (1 if rim else LARGE_TILE_RATIO))
    return 2.0 * np.mean(found, axis=0)[middle - half : middle + half]


def random_sea_problem(order: int) -> Problem:
    """Set-up of a random sea, linear (`order` 1) or nonlinear (3)."""
    name = f"a random sea, order {order}"
    height = Promise(f"{name}: 4 sqrt(m0) [m]", "%", "asked for", {"spectral_sea": 1.0})
    period = Promise(f"{name}: T_m02 [s]", "%", "of the spectrum asked for", {"spectral_sea": 1.0})
    towards = Promise(f"{name}: direction [deg]", "deg", "asked for", {"spectral_sea": 1.0})
    spectrum: dict[str, float] = SEA_KEYS | {"cut_off": CUT_OFF_RATIO}
    asked = waves.SpreadSpectrum.model_validate(spectrum)
    side = 12.0 * GRAVITY * asked.peak_period**2 / (2.0 * np.pi)

    def measure(simulation: Simulation) -> Finding:
        eta, rise, slope = surface_samples(simulation, order)
        h = 4.0 * float(np.sqrt(np.mean(eta**2)))
        t = 2.0 * np.pi * float(np.sqrt(np.mean(eta**2) / np.mean(rise**2)))
        flux = -(rise[:, None] * slope).mean(axis=0)
        ahead = float(np.degrees(np.arctan2(*flux)))
        f = np.linspace(waves.LOWEST_FREQUENCY, asked.cut_off, waves.SPECTRUM_POINTS) / asked.peak_period
        s = asked.density(f)
        mean = float(np.sqrt(np.trapezoid(s, f) / np.trapezoid(s * f**2, f)))
        off = (ahead - SEA_KEYS["heading_deg"] + 180.0) % 360.0 - 180.0
        numbers = (percent_error(h, SEA_KEYS["significant_wave_height"]), percent_error(t, mean))
        return Finding([*numbers, (ahead, SEA_KEYS["heading_deg"], off)])

    scene = tile_scene(side, 256, order=order, spectrum=spectrum)
    return Problem(scene, (height, period, towards), measure, name, schemes=SPECTRAL_SCHEMES)


def surface_samples(simulation: Simulation, order: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Elevations (m,) [m], vertical speeds (m,) [m/s], slopes (m, 2) along x, z of a sea of this order at m points."""
    fluid = sea_of(simulation)
    if fluid.steep is not None:
        from ocean_sim.fluid.spectral_sea import SPECTRUM_COMPONENTS, snapped

        sea = fluid.nonlinear(snapped(fluid.config.sea_of(simulation.basin, SPECTRUM_COMPONENTS), fluid.tile))
        tile = sea.tile
        e, p = tile.to_modes(sea.eta), tile.to_modes(sea.phi)
        modes = np.array([e, tile.k * np.tanh(tile.k * tile.depth) * p, *tile.slopes(e)])
        eta, rise, along, across = tile.to_values(modes).reshape(4, -1)
        return eta, rise, np.stack([along, across], axis=1)
    found = []
    draw = np.random.default_rng(5)
    for _ in range(SAMPLE_TIMES):
        fluid.advance(float(draw.uniform(5.0, 50.0)))
        points = draw.uniform(-0.5 * SAMPLE_SIDE, 0.5 * SAMPLE_SIDE, (SAMPLE_POINTS, 2))
        here, time = fluid.elevations(points), fluid.time
        ahead = [(fluid.elevations(points + step) - here) / 0.01 for step in ([0.01, 0.0], [0.0, 0.01])]
        rise = (waves.elevation(fluid.plane_waves, points, time + RISE_INTERVAL) - here) / RISE_INTERVAL
        found.append((here, rise, np.stack(ahead, axis=1)))
    return tuple(np.concatenate(part) for part in zip(*found))  # type: ignore[return-value]
