"""A box that floats in a patch of open sea, carried by the pressure of particles: its motion against linear theory.

A section 1.0 m wide and 0.2 m deep, on eight spacings in its draught, across waves of 1.8 s and 60 mm, free in heave
and pitch (its roll: waves go across it); at rest, and towed against the waves. The sea grows over two periods, since
waves that were there at once would run through the box. Rims of a wavelength on either side leave two wavelengths
free, and three in a larger patch. The reference is the same box in `linear_waves`, with added mass, damping and
the force of scattered waves from a table of linear potential flow. Tolerances are 8 % of it, and 3 % between both
patches; they were set before any run. The table's terms of speed are those of a slender hull, unlike a box that goes
end on: of the towed box the closed form is only reported, and both patches are compared.
"""

from collections.abc import Sequence
from math import pi
from typing import Any

import numpy as np

from ocean_sim import waves
from ocean_sim.conventions import GRAVITY, WATER_DENSITY
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared import case
from ocean_sim.validation.shared import ship as ships
from ocean_sim.validation.shared.state import State, particle_state
from ocean_sim.validation.shared.tables import table_path

BREADTH, DRAUGHT, HEIGHT, BILGE, LENGTH = 1.0, 0.2, 0.32, 0.0512, 1.0  # [m]
KG, ROLL_RADIUS = 0.15, 0.2  # [m]
MASS = WATER_DENSITY * LENGTH * (BREADTH * DRAUGHT - 2.0 * BILGE**2 * (1.0 - pi / 4.0))  # [kg]
PERIOD, AMPLITUDE, DEPTH = 1.8, 0.03, 1.0  # [s], [m], [m]
WAVENUMBER = float(waves.wavenumber(2.0 * pi / PERIOD, DEPTH, GRAVITY))
WAVELENGTH = 2.0 * pi / WAVENUMBER  # [m]
DRAUGHT_SPACINGS, RIM_WIDTH, FREE_LENGTHS = 8, 1.0, (2.0, 3.0)  # [wavelengths], of two patches
RUN_PERIODS, JUDGED_PERIODS, PERIOD_STEPS = 11.0, 4.0, 240  # the last ones; steps in each of `linear_waves`
TOWING_SPEED, RAMP_TIME = -0.5, 2.0 * PERIOD  # [m/s] along x, [s]
HEAVE_STROKE, PERIOD_SAMPLES, FIT_RANGE = 0.02, 16, (0.5, 0.95)  # [m]; in a period; [wavelengths] from the box
MOTIONS = ("heave", "pitch")
SHIP_MOTIONS = ("heave", "roll")  # in the axes of the ship
THEORY_TOLERANCE, PATCH_TOLERANCE = 8.0, 3.0  # [%]


def problems(coarse: bool) -> list[case.Problem]:
    """Set-ups to run: the box moored, towed, and in forced heave; none if coarse."""
    moored, towed = floating_problem("moored", 0.0), floating_problem("towed", TOWING_SPEED)
    return [] if coarse else [moored, towed, heaving_problem()]


def floating_problem(name: str, speed: float) -> case.Problem:
    """Set-up `name`: box in waves, towed along x at a speed [m/s] (0: held in sway), in a patch of sea and a larger."""
    moves = SHIP_MOTIONS if speed == 0.0 else ("sway", *SHIP_MOTIONS)
    source, within = "linear_waves, with its table", THEORY_TOLERANCE if speed == 0.0 else None
    small_patch, larger_patch = f"{FREE_LENGTHS[0]:g} of them free", f", {FREE_LENGTHS[1]:g} wavelengths free"
    promises = [motion_promise(f"{name}: {motion}", within, source) for motion in MOTIONS]
    promises += [motion_promise(f"{name}: {motion}{larger_patch}", PATCH_TOLERANCE, small_patch) for motion in MOTIONS]

    def measure(simulation: Simulation) -> case.Finding:
        exact, small = closed_form_motions(simulation, speed), follow_motions(simulation, speed)
        with case.other_simulation(simulation, patch_scene(FREE_LENGTHS[1], moves)) as larger:
            large = follow_motions(larger, speed)
        theory, here, there = (motion_amplitudes(rows, speed) for rows in (exact, small, large))
        numbers = [*map(case.percent_error, here, theory), *map(case.percent_error, there, here)]
        curves = [*motion_curves(small), *motion_curves(large, larger_patch)]
        return case.Finding(numbers, curves, motion_curves(exact, ", linear"), ("t / T", "heave / a, pitch / k a"))

    scene = patch_scene(FREE_LENGTHS[0], moves)
    return case.Problem(scene, tuple(promises), measure, name, True, "ship", ("pressure",))


def heaving_problem() -> case.Problem:
    """Set-up of the box in forced heave in calm water: ratio [%] of waves that the rim reflects to those sent out."""
    back = case.Promise("heaving: wave that comes back, over that which leaves", "%", "none; 5 %", {"pressure": 5.0})
    scene = patch_scene(FREE_LENGTHS[0], ["heave"])
    scene["sea"] = {"kind": "linear_waves", "rim": scene["sea"]["rim"]}

    def measure(simulation: Simulation) -> case.Finding:
        omega, rows, values, nexts = 2.0 * pi / PERIOD, [], [], (RUN_PERIODS - JUDGED_PERIODS) * PERIOD
        began = float(ships.ship_of(simulation).body.position[1])
        while simulation.time < RUN_PERIODS * PERIOD:
            simulation.step()
            moved = ships.ramped_swing(simulation.time, HEAVE_STROKE, omega, RAMP_TIME)
            ships.impose_motion(simulation, 1, moved._replace(place=began + moved.place))
            if simulation.time >= nexts:
                nexts += PERIOD / PERIOD_SAMPLES
                columns, speeds = fit_columns(particle_state(simulation))
                rows.append(columns)
                values.append(speeds)
        fit = np.linalg.lstsq(np.concatenate(rows), np.concatenate(values), rcond=None)[0]
        leaving, coming = np.hypot(fit[0], fit[1]), np.hypot(fit[2], fit[3])
        return case.Finding([case.absolute_error(100.0 * float(coming / leaving))])

    return case.Problem(scene, (back,), measure, "heaving", True, "ship", ("pressure",))


def fit_columns(water: State) -> tuple[np.ndarray, np.ndarray]:
    """Equations A c = b to fit the heights c of waves that leave the box and return, from particles beside it. A (n, 4)
    [m/s]: velocities in waves of 1 m (cos and sin leaving, then returning); b (n,) [m/s]: velocities of the water."""
    (x, y), (u, v) = water.position[:, :2].T, water.velocity[:, :2].T
    far = np.abs(x)
    first, last = (share * WAVELENGTH for share in FIT_RANGE)
    near = (far > first) & (far < last) & (y < -HEAVE_STROKE) & (y > -0.9 * DEPTH)
    x, y, u, v = far[near], y[near], np.sign(x[near]) * u[near], v[near]
    omega = 2.0 * pi / PERIOD
    c, s = (GRAVITY * WAVENUMBER / omega * share for share in waves.profiles(WAVENUMBER, y, DEPTH))
    columns = []
    for sign in (1.0, -1.0):
        angle = sign * WAVENUMBER * x - omega * water.time
        columns.append(np.concatenate([sign * c * np.cos(angle), s * np.sin(angle)]))
        columns.append(np.concatenate([-sign * c * np.sin(angle), s * np.cos(angle)]))
    return np.stack(columns, axis=1), np.concatenate([u, v])


def motion_promise(quantity: str, within: float | None, source: str) -> case.Promise:
    """Promised result: motion `quantity` over wave amplitude (pitch: over wave slope). `within`: tolerance [%], None:
    only reported; `source`: text on the reference."""
    over = "k a" if "pitch" in quantity else "a"
    if within is None:
        return case.Promise(f"{quantity} [{over}]", "%", f"{source}; reported")
    return case.Promise(f"{quantity} [{over}]", "%", f"{source}; {within:g} %", {"pressure": within})


def patch_scene(free: float, moves: Sequence[str]) -> dict[str, Any]:
    """Scene of the box in a patch of sea, `free` wavelengths between rims (relaxation zones); `moves`: free motions."""
    rim = {"width": RIM_WIDTH * WAVELENGTH}
    return {
        "duration": RUN_PERIODS * PERIOD,
        "basin": {"length": (free + 2.0 * RIM_WIDTH) * WAVELENGTH, "depth": DEPTH, "walls": "periodic"},
        "fluid": {"kind": "delta_sph", "spacing": WAVELENGTH / round(WAVELENGTH / DRAUGHT * DRAUGHT_SPACINGS)},
        "sea": {"kind": "linear_waves", "height": 2.0 * AMPLITUDE, "period": PERIOD, "rim": rim},
        "ship": box_keys(moves) | {"kind": "pressure"},
    }


def box_keys(moves: Sequence[str]) -> dict[str, Any]:
    """Scene keys of the ship that is the box; `moves`: names of its free motions."""
    whole = ships.ship_of_section(BREADTH, HEIGHT, BILGE, LENGTH, MASS, KG, ROLL_RADIUS, cells=12)
    return whole | {"free": list(moves)}


def motion_amplitudes(rows: np.ndarray, speed: float) -> list[float]:
    """Amplitudes of heave and pitch in the last wave periods, over those of wave and wave slope, from rows (n, 3) of
    time and both motions (`follow_motions`); `speed` [m/s]: of towing along x."""
    t = rows[:, 0]
    last = t > t[-1] - JUDGED_PERIODS * PERIOD
    encounter = 2.0 * pi / PERIOD - WAVENUMBER * speed  # [rad/s]
    return ships.first_harmonics(t[last], rows[last, 1:], encounter).tolist()


def motion_curves(rows: np.ndarray, suffix: str = "") -> list[case.Curve]:
    """Curves of heave and pitch over time from rows (n, 3) of time, heave, pitch; `suffix`: end of their labels."""
    return [case.Curve(f"{motion}{suffix}", rows[:, 0] / PERIOD, rows[:, k + 1]) for k, motion in enumerate(MOTIONS)]


def follow_motions(simulation: Simulation, speed: float) -> np.ndarray:
    """Run the box at a speed [m/s] along x: rows (n, 3) of time [s], heave / wave amplitude, pitch / wave slope."""
    rows, x, before, last = [], 0.0, 0.0, 0.0
    for time, body in ships.follow_body(simulation, RUN_PERIODS * PERIOD):
        if speed != 0.0:
            now = speed * waves.ramp_share(time, RAMP_TIME)
            x, before = x + 0.5 * (before + now) * (time - last), now
            ships.impose_motion(simulation, 0, ships.ImposedMotion(x, now, speed * waves.ramp_rate(time, RAMP_TIME)))
            last = time
        rows.append((time, body.position[1] / AMPLITUDE, body.angles[2] / (WAVENUMBER * AMPLITUDE)))
    found = np.array(rows)
    found[:, 1] -= found[0, 1]
    return found


def closed_form_motions(simulation: Simulation, speed: float) -> np.ndarray:
    """Motions of the same box towed in `linear_waves` at a speed [m/s] along x: rows (n, 3) of time [s], heave over
    wave amplitude, pitch over wave slope."""
    ship = box_keys(SHIP_MOTIONS) | {"kind": "dynamic", "radiation": str(table_path("box_radiation"))}
    ship["damping"] = {"cross_flow": 0.0}
    of_waves = {"height": 2.0 * AMPLITUDE, "period": PERIOD, "heading_deg": 90.0}
    scene = ships.at_sea(ship, BREADTH, PERIOD / PERIOD_STEPS, RUN_PERIODS * PERIOD, **of_waves)
    scene["basin"]["depth"] = DEPTH
    with case.other_simulation(simulation, scene) as plain:
        return follow_motions(plain, speed)
