"""Standing waves in a tank with a width: their period and decay, at intermediate depth and in deep water.

The case shows an error that a slice does not: at some supports the initial lattice bears shear under pressure, as a
crystal does, and its stiffness speeds waves up, by the same share in finer water. With a shear modulus kappa p of a
lattice under the pressure p, the period falls by the share kappa: such a modulus stores
kappa rho g |y| (2 k a exp(k y))^2 / 2 of energy per volume at the depth |y|, twice kappa times that stored by gravity.
"""

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Finding, Problem, Promise, percent_error
from ocean_sim.validation.standing_wave import DEEP_WAVE, STEEP_SOURCE, StandingWave

SHALLOW_WAVE = StandingWave(length=1.0, depth=0.32, mode=1, amplitude=0.015, gravity=9.81)  # k h = 1.005
LAYERS_ACROSS = 6  # of particles, in the width of the tank
DISPERSION_SOURCE, DECAY_SOURCE = "w^2 = g k tanh(k h)", "2 nu k^2, Lamb, Hydrodynamics, art. 348"


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: shallow and deep waves with several numbers of layers; coarse: one shallow wave with 8 layers."""
    shallow = [
        wave_problem(SHALLOW_WAVE, "kh 1", layers, 1000.0, 4.0, {"delta_sph": 1.0, "dfsph": 2.0}, {"delta_sph": 25.0})
        for layers in (8, 16)
    ]
    if coarse:
        return shallow[:1]
    tolerances = {12: 2.0, 16: 1.3, 20: 0.8}  # [%] by layers; the error falls with the square of the spacing
    deep = [
        wave_problem(DEEP_WAVE, "kh pi", layers, 250.0, 2.5, {"delta_sph": tolerances[layers]}, {})
        for layers in tolerances
    ]
    return [shallow[0], deep[0], shallow[1], *deep[1:]]


def wave_problem(
    wave: StandingWave,
    label: str,
    layers: int,
    reynolds: float,
    periods: float,
    period: dict[str, float],
    decay: dict[str, float],
) -> Problem:
    """Set-up of a wave in `layers` layers of particles at a Reynolds number sqrt(g h) h / nu, for so many wave
    `periods`. `label`: of the wave, in its name; `period`, `decay`: tolerances by scheme."""
    spacing, viscosity = wave.depth / layers, wave.viscosity(reynolds)
    width = LAYERS_ACROSS * spacing
    scene = {
        "duration": periods * wave.period,
        "basin": {"length": wave.length, "depth": wave.depth, "width": width, "gravity": [0.0, -wave.gravity, 0.0]},
        "fluid": {"spacing": spacing, "kinematic_viscosity": viscosity},
    }
    name = f"{label}, {layers} layers"
    promises = (
        Promise(f"{name}: period [s]", "%", STEEP_SOURCE if wave is DEEP_WAVE else DISPERSION_SOURCE, period),
        Promise(f"{name}: decay rate over its leading order [1/s]", "%", DECAY_SOURCE, decay),
    )
    return Problem(scene, promises, lambda run: measure_wave(run, wave, viscosity), name, slow=layers > 12)


def measure_wave(simulation: Simulation, wave: StandingWave, viscosity: float) -> Finding:
    """Run, and compare period and decay rate of a wave with theory for a viscosity [m2/s]."""
    times, share = wave.follow_mode(simulation)
    period, rate = wave.fit_damped_cosine(times, share)
    expected = wave.leading_rate(viscosity)
    right = wave.steep_period(wave.viscous_root(viscosity), times) if wave is DEEP_WAVE else wave.period
    return wave.finding((percent_error(period, right), percent_error(rate, expected)), times, share, expected)
