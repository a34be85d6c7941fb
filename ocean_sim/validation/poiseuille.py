"""Water driven through a gap by a body force, from rest to the parabola (Morris, Fox & Zhu 1997).

Numbers are those of Morris, Fox & Zhu (1997, J. Comput. Phys. 136, 214-226), Re = 0.0125, made dimensionless by L and
L^2 / nu, so that f32 holds them: L = 1 m, nu = 1 m2/s. `couette` shares the set-up.
"""

from collections.abc import Callable

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, free_space
from ocean_sim.validation.shared.state import sampled_states

FINAL_SPEED = 0.0125  # [m/s] the largest in the steady flow
JUDGED_TIMES = (0.0225, 0.045, 0.1125, 0.225, 1.0)  # [L^2 / nu]; the last is steady to 1e-4
SERIES_TERMS = np.arange(1, 200)
SOURCE_TEXT = "series solution; Morris, Fox & Zhu 1997"
TOLERANCE = {"delta_sph": 1.0, "dfsph": 2.0}  # [%]

Profile = Callable[[np.ndarray, float], np.ndarray]
"""Speed over the final speed at heights (n,) [L] and a time [L^2 / nu]."""


def problems(coarse: bool) -> list[Problem]:
    force = 8.0 * FINAL_SPEED  # u_max = F L^2 / (8 nu)
    return [gap_problem(poiseuille_profile, [0.0, 0.0, 0.0], force, coarse)]


def poiseuille_profile(y: np.ndarray, time: float) -> np.ndarray:
    """Exact speed (n,), by body force, over its final maximum, at heights `y` (n,) [gap widths], time [L^2 / nu]."""
    odd = 2.0 * SERIES_TERMS - 1.0
    waves = np.sin(np.pi * np.outer(y, odd)) * np.exp(-((odd * np.pi) ** 2) * time) / odd**3
    return 4.0 * y * (1.0 - y) - 32.0 / np.pi**3 * waves.sum(axis=1)


def gap_problem(exact: Profile, lid: list[float], force: float, coarse: bool) -> Problem:
    """Set-up of water in the gap between plates, the upper at velocity `lid` (3,) [m/s], under a body `force` [m/s2].
    `exact`: profile to compare with.

    Compression follows the largest of V^2, nu V / L and F L, as Morris, Fox & Zhu (1997) advise."""
    duration = JUDGED_TIMES[2] if coarse else JUDGED_TIMES[-1]
    plates = {"walls": {"x": "periodic"}, "floor": "no_slip", "lid": {"slip": "no_slip", "velocity": lid}}
    scene = {
        "duration": duration,
        "basin": free_space(1.0, 1.0) | plates,
        "fluid": {
            "spacing": 0.1 if coarse else 0.05,
            "kinematic_viscosity": 1.0,
            "reference_speed": max(FINAL_SPEED, FINAL_SPEED**0.5, force**0.5),
            "body_force": [force, 0.0, 0.0],
        },
    }
    times = [time for time in JUDGED_TIMES if time <= duration]
    promises = tuple(
        Promise(f"speed at t nu / L^2 = {time:g}, worst [u_max]", "%", SOURCE_TEXT, TOLERANCE) for time in times
    )
    return Problem(scene, promises, lambda simulation: measure_profiles(simulation, exact, times))


def measure_profiles(simulation: Simulation, exact: Profile, times: list[float]) -> Finding:
    """Run; measure the largest error of speed at each of `times` [L^2 / nu], against the profile `exact`."""
    numbers, measured, heights = [], [], np.linspace(0.0, 1.0, 101)
    for time in times:
        *_, water = sampled_states(simulation, time, time)
        y, speed = water.position[:, 1] + 1.0, water.velocity[:, 0] / FINAL_SPEED
        wanted = exact(y, water.time)
        worst = int(np.argmax(np.abs(speed - wanted)))
        numbers.append((speed[worst], wanted[worst], 100.0 * float(speed[worst] - wanted[worst])))
        order = np.argsort(y)
        measured.append(Curve(f"t = {time:g}", speed[order], y[order], points=True))
    expected = [Curve(f"series, t = {time:g}", exact(heights, time), heights) for time in times]
    return Finding(numbers, measured, expected, ("u / u_max", "y / L"))
