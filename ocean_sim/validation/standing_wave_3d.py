"""Standing waves in a tank with a width: their period and decay, at intermediate depth and in deep water.

What a slice does not show: at some supports the lattice that water starts from bears shear under pressure, as a crystal
does, and waves are borne by it as well; they run fast, by the same share in finer water. With the shear modulus of a
lattice under the pressure p written as kappa p, the period falls by the share kappa: such a modulus takes up
kappa rho g |y| (2 k a exp(k y))^2 / 2 of energy a volume at the depth |y|, twice kappa times what gravity takes up.
"""

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Finding, Problem, Promise, relative
from ocean_sim.validation.shared.standing import DEEP, STEEP, StandingWave

SHALLOW = StandingWave(length=1.0, depth=0.32, mode=1, amplitude=0.015, gravity=9.81)  # k h = 1.005
LAYERS_ACROSS = 6  # of the tank
DISPERSION, LAMB = "w^2 = g k tanh(k h)", "2 nu k^2, Lamb, Hydrodynamics, art. 348"


def problems(coarse: bool) -> list[Problem]:
    shallow = [
        problem(SHALLOW, "kh 1", layers, 1000.0, 4.0, {"delta_sph": 1.0, "dfsph": 2.0}, {"delta_sph": 25.0})
        for layers in (8, 16)
    ]
    if coarse:
        return shallow[:1]
    within = {12: 2.0, 16: 1.3, 20: 0.8}  # [%] it falls with the square of the spacing
    deep = [problem(DEEP, "kh pi", layers, 250.0, 2.5, {"delta_sph": within[layers]}, {}) for layers in within]
    return [shallow[0], deep[0], shallow[1], *deep[1:]]


def problem(
    wave: StandingWave,
    what: str,
    layers: int,
    reynolds: float,
    periods: float,
    period: dict[str, float],
    decay: dict[str, float],
) -> Problem:
    """A wave at a Reynolds number sqrt(g h) h / nu on so many layers of particles, for so many periods."""
    spacing, viscosity = wave.depth / layers, wave.viscosity(reynolds)
    width = LAYERS_ACROSS * spacing
    scene = {
        "duration": periods * wave.period,
        "basin": {"length": wave.length, "depth": wave.depth, "width": width, "gravity": [0.0, -wave.gravity, 0.0]},
        "fluid": {"spacing": spacing, "kinematic_viscosity": viscosity},
    }
    name = f"{what}, {layers} layers"
    promises = (
        Promise(f"{name}: period [s]", "%", STEEP if wave is DEEP else DISPERSION, period),
        Promise(f"{name}: decay rate over its leading order [1/s]", "%", LAMB, decay),
    )
    return Problem(scene, promises, lambda run: measure(run, wave, promises, viscosity), name, slow=layers > 12)


def measure(simulation: Simulation, wave: StandingWave, promises: tuple[Promise, ...], viscosity: float) -> Finding:
    """Period and decay rate of the part of the velocity that is the wave's."""
    times, share = wave.run(simulation)
    period, rate = wave.damped_cosine(times, share)
    expected = wave.leading_rate(viscosity)
    right = wave.finite_period(wave.viscous_root(viscosity), times) if wave is DEEP else wave.period
    numbers = (relative(period, right), relative(rate, expected))
    return wave.finding(promises, numbers, times, share, expected)
