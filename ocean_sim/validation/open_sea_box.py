"""A box that floats in a patch of open sea, carried by the pressure of the particles: does it move as in the sea?

A section 1.0 m wide and 0.2 m deep, on eight spacings in its draught, across waves of 1.8 s and 60 mm, free in heave
and pitch (its roll: waves go across it); at rest, and towed against the waves. The sea grows over two periods, since
waves that were there at once would run through the box. Rims of a wavelength on either side leave two wavelengths
free, and three in a larger patch. The answer is that of the same box in `linear_waves`, with added mass, damping and
the force of scattered waves from a table of linear potential flow. Wanted, before anything was run: 8 % of it, and 3 %
between both patches. The table's terms of speed are those of a slender hull, which a box that goes end on is not: of
the towed box the closed form is reported and both patches are compared.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import cos, pi, sin
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from ocean_sim import waves
from ocean_sim.reading.scene import load, observer_names
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative
from ocean_sim.validation.shared.ship import DENSITY, G, at_sea, first_harmonics, section, ship_of, track
from ocean_sim.validation.shared.state import State, state
from ocean_sim.validation.shared.tables import table_path

if TYPE_CHECKING:
    from ocean_sim.ship.pressure import Pressure

BREADTH, DRAUGHT, HEIGHT, BILGE, LENGTH = 1.0, 0.2, 0.32, 0.0512, 1.0  # [m]
KG, ROLL_RADIUS = 0.15, 0.2  # [m]
MASS = DENSITY * LENGTH * (BREADTH * DRAUGHT - 2.0 * BILGE**2 * (1.0 - pi / 4.0))  # [kg]
PERIOD, AMPLITUDE, DEPTH = 1.8, 0.03, 1.0  # [s], [m], [m]
K = float(waves.wavenumber(2.0 * pi / PERIOD, DEPTH, G))
WAVE = 2.0 * pi / K  # [m]
FINE, RIM, FREE = 8, 1.0, (2.0, 3.0)  # spacings in the draught, [wavelengths], of two patches
RUN, JUDGED, STEPS = 11.0, 4.0, 240  # periods, those that are looked at, steps in each of `linear_waves`
SPEED, SETTING_OUT = -0.5, 2.0 * PERIOD  # [m/s] along x, in which it is reached [s]
STROKE, LOOKS, WHERE = 0.02, 16, (0.5, 0.95)  # of heave [m], looks at the waves a period, [wavelengths] from it
MOTIONS = ("heave", "pitch")
MOVES = ("heave", "roll")  # in the axes of the ship
WITHIN, ALIKE = 8.0, 3.0  # [%]


def problems(coarse: bool) -> list[Problem]:
    return [] if coarse else [afloat("moored", 0.0), afloat("towed", SPEED), heaving()]


def afloat(name: str, speed: float) -> Problem:
    """Held in sway, or towed at a speed [m/s] along the waves, in two patches."""
    moves = MOVES if speed == 0.0 else ("sway", *MOVES)
    source, within = "linear_waves, with its table", WITHIN if speed == 0.0 else None
    wanted = {motion: promise(f"{name}: {motion}", within, source) for motion in MOTIONS}
    of_larger = f", {FREE[1]:g} wavelengths free"
    alike = {motion: promise(f"{name}: {motion}{of_larger}", ALIKE, f"{FREE[0]:g} of them free") for motion in MOTIONS}

    def measure(simulation: Simulation) -> Finding:
        right, small = in_closed_form(simulation, speed), motions(simulation, speed)
        with beside(simulation, patch(FREE[1], moves)) as larger:
            large = motions(larger, speed)
        numbers = {wanted[motion].quantity: relative(small.of[motion], right.of[motion]) for motion in MOTIONS}
        numbers |= {alike[motion].quantity: relative(large.of[motion], small.of[motion]) for motion in MOTIONS}
        curves = [*small.curves(), *large.curves(of_larger)]
        return Finding(numbers, curves, right.curves(", linear"), ("t / T", "heave / a, pitch / k a"))

    promises = (*wanted.values(), *alike.values())
    return Problem(patch(FREE[0], moves), promises, measure, name, True, "ship", ("pressure",), True)


def heaving() -> Problem:
    """Moved up and down in calm water: what of the waves that it makes comes back to it through the rim."""
    back = Promise("heaving: wave that comes back, over that which leaves", "%", "none; 5 %", {"pressure": 5.0})
    scene = patch(FREE[0], ["heave"])
    scene["sea"] = {"kind": "linear_waves", "rim": scene["sea"]["rim"]}

    def measure(simulation: Simulation) -> Finding:
        omega, rows, values, nexts = 2.0 * pi / PERIOD, [], [], (RUN - JUDGED) * PERIOD
        began = float(ship_of(simulation).body.position[1])
        while simulation.time < RUN * PERIOD:
            simulation.step()
            phase, share = omega * simulation.time, waves.ramp_share(simulation.time, SETTING_OUT)
            rate = waves.ramp_rate(simulation.time, SETTING_OUT)
            moved = Moved(
                began + STROKE * share * sin(phase),
                STROKE * (omega * share * cos(phase) + rate * sin(phase)),
                STROKE * omega * (2.0 * rate * cos(phase) - omega * share * sin(phase)),
            )
            impose(simulation, 1, moved)
            if simulation.time >= nexts:
                nexts += PERIOD / LOOKS
                of, right = both_ways(state(simulation))
                rows.append(of)
                values.append(right)
        fit = np.linalg.lstsq(np.concatenate(rows), np.concatenate(values), rcond=None)[0]
        leaving, coming = np.hypot(fit[0], fit[1]), np.hypot(fit[2], fit[3])
        share = 100.0 * float(coming / leaving)
        return Finding({back.quantity: (share, 0.0, share)})

    return Problem(scene, (back,), measure, "heaving", True, "ship", ("pressure",), True)


def both_ways(water: State) -> tuple[np.ndarray, np.ndarray]:
    """(n, 4) velocities of waves of 1 m, cosine and sine, that leave and that come back, where they are looked at, and
    (n,) those of the water; the patch is its own image left to right."""
    (x, y), (u, v) = water.position[:, :2].T, water.velocity[:, :2].T
    far = np.abs(x)
    near = (far > WHERE[0] * WAVE) & (far < WHERE[1] * WAVE) & (y < -STROKE) & (y > -0.9 * DEPTH)
    x, y, u, v = far[near], y[near], np.sign(x[near]) * u[near], v[near]
    omega = 2.0 * pi / PERIOD
    c, s = (G * K / omega * of for of in waves.profiles(K, y, DEPTH))
    columns = []
    for sign in (1.0, -1.0):
        angle = sign * K * x - omega * water.time
        columns.append(np.concatenate([sign * c * np.cos(angle), s * np.sin(angle)]))
        columns.append(np.concatenate([-sign * c * np.sin(angle), s * np.cos(angle)]))
    return np.stack(columns, axis=1), np.concatenate([u, v])


def promise(quantity: str, within: float | None, source: str) -> Promise:
    """Of an amplitude of heave over that of the waves, or of pitch over their slope, within so much of it [%]."""
    over = "k a" if "pitch" in quantity else "a"
    if within is None:
        return Promise(f"{quantity} [{over}]", "%", f"{source}; reported")
    return Promise(f"{quantity} [{over}]", "%", f"{source}; {within:g} %", {"pressure": within})


def patch(free: float, moves: Sequence[str]) -> dict[str, Any]:
    """The scene of a patch with so many wavelengths between its rims, and a box with these motions."""
    return {
        "duration": RUN * PERIOD,
        "basin": {
            "length": (free + 2.0 * RIM) * WAVE,
            "depth": DEPTH,
            "walls": "periodic",
            "gravity": [0.0, -G, 0.0],
        },
        "fluid": {"kind": "delta_sph", "spacing": WAVE / round(WAVE / DRAUGHT * FINE)},
        "sea": {"kind": "linear_waves", "height": 2.0 * AMPLITUDE, "period": PERIOD, "rim": {"width": RIM * WAVE}},
        "ship": box(moves) | {"kind": "pressure"},
    }


def box(moves: Sequence[str]) -> dict[str, Any]:
    """The ship of a scene."""
    whole = section(BREADTH, HEIGHT, BILGE, LENGTH, MASS, KG, ROLL_RADIUS, cells=12)
    return whole | {"free": list(moves)}


def beside(simulation: Simulation, scene: dict[str, Any]) -> Simulation:
    """Another scene without observers, on the same processor."""
    quiet = {name: None for name in observer_names() if name != "manifest"}
    return Simulation(load(scene | quiet | {"runtime": simulation.scene.resolved()["runtime"]}))


class Moved(NamedTuple):
    """Along one axis of the world."""

    place: float  # [m]
    speed: float  # [m/s]
    acceleration: float  # [m/s2]


def impose(simulation: Simulation, axis: int, moved: Moved) -> None:
    """Have the box move along an axis as given, whatever the water does, and the water know of it."""
    ship = ship_of(simulation)
    position, velocity = ship.body.position.copy(), ship.body.velocity.copy()
    position[axis], velocity[axis] = moved.place, moved.speed
    ship.body = replace(ship.body, position=position, velocity=velocity)
    if any(solid.felt for solid in simulation.basin.afloat.values()):
        pressed = cast("Pressure", ship)
        pressed.known[0, axis] = moved.acceleration
        pressed.place()


@dataclass(frozen=True)
class Motions:
    """How a box moved, at a speed [m/s] along the waves."""

    rows: np.ndarray  # (n, 3) time [s], heave over the amplitude of the waves, pitch over their slope
    speed: float

    @cached_property
    def of(self) -> dict[str, float]:
        """Amplitudes of both in the last periods, beside a trend."""
        t = self.rows[:, 0]
        last = t > t[-1] - JUDGED * PERIOD
        met = 2.0 * pi / PERIOD - K * self.speed  # [rad/s] of the waves that are met
        found = first_harmonics(t[last], self.rows[last, 1:], met)
        return dict(zip(MOTIONS, map(float, found), strict=True))

    def curves(self, what: str = "") -> list[Curve]:
        t = self.rows[:, 0] / PERIOD
        return [Curve(f"{motion}{what}", t, self.rows[:, k + 1]) for k, motion in enumerate(MOTIONS)]


def motions(simulation: Simulation, speed: float) -> Motions:
    """How the box moves that is held in sway, or towed at a speed [m/s] along the waves."""
    rows, x, before, last = [], 0.0, 0.0, 0.0
    for time, body in track(simulation, RUN * PERIOD):
        if speed != 0.0:
            now = speed * waves.ramp_share(time, SETTING_OUT)
            x, before = x + 0.5 * (before + now) * (time - last), now
            impose(simulation, 0, Moved(x, now, speed * waves.ramp_rate(time, SETTING_OUT)))
            last = time
        rows.append((time, body.position[1] / AMPLITUDE, body.angles[2] / (K * AMPLITUDE)))
    found = np.array(rows)
    found[:, 1] -= found[0, 1]
    return Motions(found, speed)


def in_closed_form(simulation: Simulation, speed: float) -> Motions:
    """Motions in `linear_waves`; sway is imposed, so no acceleration of its own turns the box."""
    extra = {"kind": "dynamic", "radiation": str(table_path("box_radiation")), "damping": {"cross_flow": 0.0}}
    of_waves = {"height": 2.0 * AMPLITUDE, "period": PERIOD, "heading_deg": 90.0}
    scene = at_sea(box(MOVES) | extra, BREADTH, PERIOD / STEPS, RUN * PERIOD, **of_waves)
    scene["basin"]["depth"] = DEPTH
    with beside(simulation, scene) as plain:
        return motions(plain, speed)
