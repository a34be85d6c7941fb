"""A patch of open sea: waves of the surrounding sea at a ship that sails at any speed, with them or against them.

A slice of three wavelengths, half a wavelength deep, 40 particles to the wave; no ship, but a rim opposite a point that
rests or moves at a share of the group speed. Fitted to the velocities half a wavelength around that point: complex
height of the linear wave over that of the sea, and the current. At rest 20 periods, under way 25, of which the last
five count.

A nonlinear sea (`spectral_sea`) is compared with itself: with the wave of the same length in the sea around the patch.

A packet in a calm sea goes once round the patch; the returned share of its height passed the rim or was reflected. The
velocities give a complex height of each wavelength. Over a period, waves ahead turn one way in the complex plane,
reflected ones the other, and slow eddies of the water not at all. The method has a floor of 0.4 % of the height sent.

The random sea: JONSWAP, four wavelengths of the peak, of which a rim takes one on either side; heights in the free part
against linear theory for the same phases.
"""

from functools import partial
from math import pi

import numpy as np

from ocean_sim import waves
from ocean_sim.fluid import with_particles
from ocean_sim.fluid.patch.relaxation_zone import relaxation_band
from ocean_sim.fluid.patch.sea_patch import Depths, SteepSource, table_nodes
from ocean_sim.fluid.sph.initial_state import displaced_state, patch_waves
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, absolute_error, percent_error
from ocean_sim.validation.shared.flume import gauge_records
from ocean_sim.validation.shared.state import State, particle_state, record_run, set_state

LENGTH, DEPTH, G = 1.0, 0.5, 9.81  # [m], [m], [m/s2]
K = 2.0 * pi / LENGTH
OMEGA = (G * K * float(np.tanh(K * DEPTH))) ** 0.5
PERIOD, GROUP_SPEED = 2.0 * pi / OMEGA, float(waves.group_speed(K, DEPTH, G))
PATCH_LENGTH, FINE_PARTICLES, COARSE_PARTICLES = 3.0, 40, 20  # [wavelengths], particles to the wave
JUDGED_PERIODS, PERIOD_SAMPLES, FIT_DISTANCE = 5.0, 8, 0.25  # at the end; in a period; [wavelengths] around the point
LOWEST_FIT = -0.9  # [depths] particles below it are left out
HEIGHT, SEED, RANDOM_PATCH, RANDOM_RIM = 0.03, 3, 4.0, 1.0  # [m], seed, [wavelengths] twice
SOURCE_TEXT = "the sea asked for, linear theory"
PACKET_WAY, PACKET_SPREAD, PACKET_SLOPE = 5.5, 0.21, 0.15  # [wavelengths]; of wavenumbers over K; the highest
PACKET_WAVES = slice(2, 10)  # the judged ones, by their number on the patch


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: regular waves, packets, a nonlinear and a random sea; coarse: one regular wave at rest."""
    if coarse:
        return [regular_problem(0.15, 0.0, 10.0, COARSE_PARTICLES, 7.0, 15.0)]
    found = [regular_problem(ka, 0.0, 20.0, FINE_PARTICLES, 5.0, 10.0) for ka in (0.05, 0.15)]
    found += [
        regular_problem(ka, speed, 25.0, FINE_PARTICLES, 7.0, 15.0, slow=True)
        for ka in (0.05, 0.15)
        for speed in (0.5, 1.0, 1.5, -0.5, -1.0, -1.5)
    ]
    found += [packet_problem(0.75, 4.0), packet_problem(1.0, 2.5)]
    nonlinear = regular_problem(0.15, 0.0, 15.0, FINE_PARTICLES, 5.0, 10.0, slow=True, kind="spectral_sea")
    return [*found, nonlinear, random_problem()]


def patch_scene(length: float, particles: int, sea: dict, periods: float) -> dict:
    """Scene of a patch of open sea: `length` [wavelengths], `particles` to the wavelength, duration [wave periods];
    `sea`: keys of the surrounding sea."""
    return {
        "duration": periods * PERIOD,
        "basin": {"length": length * LENGTH, "depth": DEPTH, "walls": "periodic"},
        "fluid": {"spacing": LENGTH / particles},
        "sea": {"kind": "linear_waves"} | sea,
    }


def regular_problem(
    ka: float,
    speed: float,
    periods: float,
    particles: int,
    within: float,
    degrees: float,
    slow: bool = False,
    kind: str = "linear_waves",
) -> Problem:
    """Set-up of regular waves of steepness `ka`, `particles` to the wavelength, on a patch at `speed` [group speeds],
    for so many `periods`. `within` [%], `degrees`: tolerances of height, phase; `kind`: of sea; `slow`: for --slow."""
    where = "at rest" if speed == 0.0 else f"at {speed:+g} group speeds"
    name = f"ka {ka:g}, {where}" + ("" if kind == "linear_waves" else ", nonlinear")
    height = Promise(f"{name}: height over that of the sea", "%", f"{SOURCE_TEXT}; {within:g} %", {"delta_sph": within})
    phase = Promise(f"{name}: phase [deg]", "deg", f"{SOURCE_TEXT}; {degrees:g} deg", {"delta_sph": degrees})
    current = Promise(f"{name}: current over the phase speed", "%", "none; 0.05 %", {"delta_sph": 0.05})
    sea = {"kind": kind, "height": 2.0 * ka / K, "period": PERIOD, "rim": {"velocity": [speed * GROUP_SPEED, 0.0]}}
    look = partial(measure_regular, amplitude=ka / K, speed=speed * GROUP_SPEED)
    return Problem(patch_scene(PATCH_LENGTH, particles, sea, periods), (height, phase, current), look, name, slow)


def fit_wave(water: State, amplitude: float, at: float) -> tuple[complex, float]:
    """Fit a linear wave and a current to velocities near x = `at` [m]. Return the complex wave height over the sea's
    `amplitude` [m], and the current [m/s]."""
    x, y = water.position[:, 0], water.position[:, 1]
    far = (x - at + 0.5 * PATCH_LENGTH * LENGTH) % (PATCH_LENGTH * LENGTH) - 0.5 * PATCH_LENGTH * LENGTH
    near = (np.abs(far) < FIT_DISTANCE * LENGTH) & (y < -amplitude) & (y > LOWEST_FIT * DEPTH)
    angle = K * x[near] - OMEGA * water.time
    c, s = waves.profiles(K, y[near], DEPTH)
    one, none = np.ones_like(c), np.zeros_like(c)
    along = np.stack([c * np.cos(angle), -c * np.sin(angle), one], axis=1)
    up = np.stack([s * np.sin(angle), s * np.cos(angle), none], axis=1)
    speeds = np.concatenate([water.velocity[near, 0], water.velocity[near, 1]])
    real, imaginary, current = np.linalg.lstsq(np.concatenate([along, up]), speeds, rcond=None)[0]
    return complex(real, imaginary) / (amplitude * G * K / OMEGA), float(current)


def measure_regular(simulation: Simulation, amplitude: float, speed: float) -> Finding:
    """Run; fit the wave at a point moving at `speed` [m/s]: height over the sea's `amplitude` [m], phase, current."""
    fit = lambda water: fit_wave(water, amplitude, speed * water.time)
    time, fits = record_run(simulation, PERIOD / PERIOD_SAMPLES, fit)
    height = fits[:, 0] / linear_wave_share(simulation, time)
    last = time > simulation.scene.duration - JUDGED_PERIODS * PERIOD
    a, u = complex(height[last].mean()), float(fits[last, 1].real.mean()) * K / OMEGA
    degrees = float(np.degrees(np.angle(a)))
    numbers = ((abs(a), 1.0, 100.0 * (abs(a) - 1.0)), absolute_error(degrees), (u, 0.0, 100.0 * u))
    measured = [Curve("height", time / PERIOD, np.abs(height))]
    expected = [Curve("the sea", time / PERIOD, np.ones_like(time))]
    return Finding(numbers, measured, expected, ("t / T", "height over that of the sea"))


def linear_wave_share(simulation: Simulation, time: np.ndarray) -> np.ndarray:
    """Complex ratio (n,) of the surrounding sea's wave to a linear wave, at increasing times (n,) [s]."""
    around_it = relaxation_band(with_particles(simulation.fluid).config.lattice(simulation.basin))
    if around_it is None or around_it.sea is None or around_it.nonlinear is None:
        return np.ones(len(time), dtype=complex)
    depths = Depths(DEPTH, around_it.sea.significant_height, DEPTH)
    source = SteepSource(around_it, around_it.sea, depths, table_nodes(around_it, around_it.sea))
    crests = round(PATCH_LENGTH)
    began = source.modes(0.0)[1, 0, crests, 0]
    return np.array([source.modes(t)[1, 0, crests, 0] / began * np.exp(1j * OMEGA * t) for t in time])


def packet_problem(width: float, within: float) -> Problem:
    """Set-up of a wave packet in a calm sea that meets a rim (relaxation zone) `width` [wavelengths] wide; `within`:
    tolerance [%] of the height that comes through or back."""
    quantity = f"rim of {width:g} wavelengths: height of a packet that returns once round"
    promise = Promise(quantity, "%", f"none; {within:g} %", {"delta_sph": within})
    periods = PACKET_WAY * LENGTH / GROUP_SPEED / PERIOD + 1.0
    scene = patch_scene(PACKET_WAY, FINE_PARTICLES, {"rim": {"width": width * LENGTH}}, periods)
    return Problem(scene, (promise,), measure_packet, f"packet, {width:g}", slow=True)


def measure_packet(simulation: Simulation) -> Finding:
    """Run until the packet has gone once round the patch; measure its height over that in theory without a rim."""
    basin, water = simulation.basin, with_particles(simulation.fluid)
    side = basin.periods[0]
    k = 2.0 * pi * np.arange(1, 4 * round(side / LENGTH) + 1) / side
    share = np.exp(-0.5 * ((k / K - 1.0) / PACKET_SPREAD) ** 2)
    sea = waves.Components(PACKET_SLOPE / K * share / share.sum(), np.stack([k, 0.0 * k], axis=1), 0.0 * k, DEPTH, G)
    began = particle_state(simulation)
    position, velocity, pressure = displaced_state(sea, began.position, basin, water.rest_density)
    set_state(simulation, position, velocity, pressure)
    losses = water.config.losses(water.config.lattice(basin), sea)
    assert losses is not None
    time = side / GROUP_SPEED + PERIOD * (np.arange(PERIOD_SAMPLES) + 0.5) / PERIOD_SAMPLES - 0.5 * PERIOD
    left = sea.amplitude * np.exp(-losses.real * side / GROUP_SPEED)
    found = []
    for until in time:
        simulation.run(float(until))
        found.append(fit_heights(particle_state(simulation), sea))
    ways = [way[PACKET_WAVES] for way in split_directions(np.array(found), sea.omega, time)]
    returned = float(np.linalg.norm(ways)) / float(np.linalg.norm(left[PACKET_WAVES]))
    number = (returned, 0.0, 100.0 * returned)
    ratio = LENGTH * k[PACKET_WAVES] / (2.0 * pi)
    rows = [Curve(name, ratio, np.abs(way)) for name, way in zip(("through", "back"), ways)]
    asked = [Curve("without a rim", ratio, left[PACKET_WAVES])]
    return Finding([number], rows, asked, ("wavelength / length of a wave", "height [m]"))


def fit_heights(water: State, sea: waves.Components) -> np.ndarray:
    """Complex heights (k,) [m] at the wavelengths of `sea`, both ways in one, fitted to `water` below the troughs."""
    x, y = water.position[:, 0], water.position[:, 1]
    deep = (y < -PACKET_SLOPE / K * 2.0) & (y > LOWEST_FIT * DEPTH)
    angle = x[deep, None] * sea.wavenumber
    speed = G * sea.wavenumber / sea.omega  # [1/s] at the still level, over the height
    c, s = (speed * profile for profile in waves.profiles(sea.wavenumber, y[deep, None], DEPTH))
    along = np.concatenate([c * np.cos(angle), c * np.sin(angle), np.ones_like(c[:, :1])], axis=1)
    up = np.concatenate([s * np.sin(angle), -s * np.cos(angle), np.zeros_like(c[:, :1])], axis=1)
    speeds = np.concatenate([water.velocity[deep, 0], water.velocity[deep, 1]])
    real, imaginary = np.linalg.lstsq(np.concatenate([along, up]), speeds, rcond=None)[0][:-1].reshape(2, -1)
    return real + 1j * imaginary


def split_directions(found: np.ndarray, omega: np.ndarray, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Split complex heights `found` (n, m) of m waves, at n times [s] over a period, into heights (m,) of waves that
    travel ahead and (m,) back, which rotate oppositely in the complex plane; `omega` (m,): frequencies [rad/s]."""
    turned = np.exp(1j * omega * time[:, None])
    return (found * turned.conj()).mean(axis=0), (found * turned).mean(axis=0)


def random_problem() -> Problem:
    spectrum = {"significant_wave_height": HEIGHT, "peak_period": PERIOD, "cut_off": 2.0, "seed": SEED}
    promises = (
        Promise("JONSWAP: 4 sqrt m0 in the free part [m]", "%", f"{SOURCE_TEXT}; 6 %", {"delta_sph": 6.0}),
        Promise("JONSWAP: correlation with the sea", "1", "1; 0.05", {"delta_sph": 0.05}),
    )
    sea = {"spectrum": spectrum, "rim": {"width": RANDOM_RIM * LENGTH}}
    scene = patch_scene(RANDOM_PATCH, FINE_PARTICLES, sea, 20.0)
    return Problem(scene, promises, measure_random, "JONSWAP", slow=True)


def measure_random(simulation: Simulation) -> Finding:
    """Run; compare height and phase of waves between the rims (relaxation zones at the ends of the patch), in the
    second half of the run, with linear theory."""
    sea = patch_waves(simulation.basin, simulation.fluid.spacing)
    assert sea is not None
    half = (0.5 * RANDOM_PATCH - RANDOM_RIM) * LENGTH
    x = np.linspace(-half, half, 81)
    points = np.stack([x, 0.0 * x], axis=1)
    time, found = gauge_records(simulation, points, PERIOD / PERIOD_SAMPLES)
    second_half = time > 0.5 * simulation.scene.duration
    time, found = time[second_half], found[second_half]
    wanted = np.array([waves.elevation(sea, points, t) for t in time])
    eta, theory = found - found.mean(), wanted - wanted.mean()
    alike = float((eta * theory).mean() / (eta.std() * theory.std()))
    height, right = 4.0 * float(eta.std()), 4.0 * float(theory.std())
    numbers = (percent_error(height, right), absolute_error(alike, 1.0))
    middle = len(x) // 2
    measured = [Curve("in the middle", time / PERIOD, eta[:, middle])]
    expected = [Curve("the sea", time / PERIOD, theory[:, middle])]
    return Finding(numbers, measured, expected, ("t / T", "elevation [m]"))
