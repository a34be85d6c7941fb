"""Scenes of a ship in closed-form waves, and access to the state of the ship."""

from collections.abc import Iterator
from dataclasses import replace
from math import cos, degrees, pi, sin
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.parts import compared
from ocean_sim.simulation import Simulation
from ocean_sim.waves import heading_vector, ramp_rate, ramp_share, regular_wave

if TYPE_CHECKING:
    from ocean_sim.ship import Load, Ship
    from ocean_sim.ship.body.floating import FloatingShip
    from ocean_sim.ship.body.rigid_body import RigidBody
    from ocean_sim.ship.pressure import Pressure

BILGE_CORNERS = 8
UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])  # quaternion
WAVE_COUNT, JUDGED_WAVES, WAVE_STEPS = 20, 4, 60  # of `record_in_waves`: waves, the last that count, steps in each
COMPARED_SHIPS = compared("ship")  # the kinds that studies compare


def at_sea(ship: dict[str, Any], size: float, dt: float, duration: float = 1.0, **waves: float) -> dict[str, Any]:
    """Scene of a ship in closed-form waves on a wide, deep sea. `ship`: its keys; `size`: its length or breadth [m];
    `dt`: time step, `duration` [s]; `waves`: keys of the sea, calm without them."""
    return {
        "duration": duration,
        "basin": {"length": 40.0 * size, "width": 40.0 * size, "depth": 20.0 * size, "walls": "none"},
        "fluid": {"kind": "linear_waves", "period": 5.0, "height": 0.0} | waves,
        "ship": ship,
        "time_step": {"kind": "fixed", "dt": dt},
        "runtime": {"precision": "f64"},
    }


def ship_of_section(
    breadth: float, height: float, bilge: float, length: float, mass: float, kg: float, roll_radius: float, cells: int
) -> dict[str, Any]:
    """Scene keys of a ship with a prismatic hull: breadth, height, bilge radius, length [m], mass [kg]; `kg`: height of
    the centre of mass over the keel [m]; `roll_radius`: of gyration [m]; `cells`: sampling cubes over the draught."""
    angles, inner = np.linspace(0.0, pi / 2.0, BILGE_CORNERS + 1), breadth / 2.0 - bilge
    side = [(breadth / 2.0, height)] + [(inner + bilge * cos(a), bilge - bilge * sin(a)) for a in angles]
    points = [[float(x), float(y), end * length / 2.0] for x, y in side for end in (1.0, -1.0)]
    long = mass * (length**2 + height**2) / 12.0
    return {
        "hull": {
            "shape": {"kind": "outline", "points": points},
            "mass": mass,
            "centre_of_mass": [0.0, kg, 0.0],
            "inertia": [long, long, mass * roll_radius**2],
        },
        "cells_per_draught": cells,
    }


def first_harmonics(t: np.ndarray, values: np.ndarray, omega: float) -> np.ndarray:
    """Amplitudes (k,) at frequency `omega` [rad/s] of signals (n, k) at times (n,) [s], fitted with mean and trend."""
    base = np.stack([np.cos(omega * t), np.sin(omega * t), np.ones_like(t), t], axis=1)
    fit = np.linalg.lstsq(base, values, rcond=None)[0]
    return np.hypot(fit[0], fit[1])


def ship_of(simulation: Simulation) -> "Ship":
    """Ship of the simulation whose name is `ship`."""
    return simulation.ships["ship"]


def floating_ship(simulation: Simulation) -> "FloatingShip":
    return cast("FloatingShip", simulation.ships["ship"])


def set_pose(simulation: Simulation, **changes: Any) -> None:
    """Replace fields of the ship's body by `changes`; velocity and angular momentum become 0 unless given."""
    ship = ship_of(simulation)
    ship.body = replace(ship.body, **({"velocity": np.zeros(3), "angular_momentum": np.zeros(3)} | changes))


class ImposedMotion(NamedTuple):
    """Displacement, speed and acceleration of a ship in one of her six motions at one time."""

    place: float  # [m] or [rad]
    speed: float  # [m/s] or [rad/s]
    acceleration: float  # [m/s2] or [rad/s2]


def ramped_swing(time: float, amplitude: float, omega: float, ramp: float) -> ImposedMotion:
    """Prescribed sine motion at a time [s], of an amplitude [m] or [rad] at `omega` [rad/s], that grows over a `ramp`
    [s]; its acceleration lacks the curvature of the ramp."""
    share, rate, s, c = ramp_share(time, ramp), ramp_rate(time, ramp), sin(omega * time), cos(omega * time)
    speed, acceleration = omega * share * c + rate * s, omega * (2.0 * rate * c - omega * share * s)
    return ImposedMotion(amplitude * share * s, amplitude * speed, amplitude * acceleration)


def impose_motion(simulation: Simulation, motion: int, moved: ImposedMotion) -> None:
    """Move the ship along the world axis `motion` (0 x, 1 y, 2 z), or turn it from upright about one (3 x, 4 y, 5 z),
    as `moved` prescribes, despite forces; the water gets the new state of the hull."""
    ship = ship_of(simulation)
    position, velocity = ship.body.position.copy(), ship.body.velocity.copy()
    if motion < 3:
        position[motion], velocity[motion] = moved.place, moved.speed
        ship.body = replace(ship.body, position=position, velocity=velocity)
    else:
        turned = replace(ship.body, orientation=turn_quaternion(motion - 3, degrees(moved.place)))
        momentum = moved.speed * turned.matrix @ turned.inertia_body[:, motion - 3]
        ship.body = replace(turned, angular_momentum=momentum)
    if any(solid.is_sampled for solid in simulation.basin.afloat.values()):
        pressed = cast("Pressure", ship)
        pressed.known.flat[motion] = moved.acceleration
        pressed.place_hull()


def current_load(simulation: Simulation) -> "Load":
    """Load (force and torque) on the ship in its present pose."""
    surface = simulation.surface or simulation.fluid
    return ship_of(simulation).load(simulation.wind_on_ship, simulation.fluid, surface)


def balance_heave(simulation: Simulation, orientation: np.ndarray) -> "Load":
    """Turn the ship to a quaternion (4,), real part first, and move it vertically until it floats; returns its load."""
    shape = floating_ship(simulation).shape
    assert shape is not None
    span = float(np.linalg.norm(np.ptp(shape.bounds(), axis=0)))
    low, high = -span, span
    for _ in range(40):
        middle = 0.5 * (low + high)
        set_pose(simulation, position=np.array([0.0, middle, 0.0]), orientation=orientation)
        load = current_load(simulation)
        low, high = (middle, high) if load.force[1] > 0.0 else (low, middle)
    return load


def turn_quaternion(axis: int, degrees: float) -> np.ndarray:
    """Unit quaternion (4,), real part first, of a turn by `degrees` about axis 0 (x), 1 (y) or 2 (z)."""
    half = np.radians(degrees) / 2.0
    return np.concatenate([[np.cos(half)], np.sin(half) * np.eye(3)[axis]])


def follow_body(simulation: Simulation, until: float) -> Iterator[tuple[float, "RigidBody"]]:
    """Run until a time [s]; yield time [s] and rigid body of the ship after every step."""
    while simulation.time < until:
        simulation.step()
        yield simulation.time, ship_of(simulation).body


def record_in_waves(
    simulation: Simulation, rest: float, height: float, period: float, heading: float, count: int = WAVE_COUNT
) -> np.ndarray:
    """Run the ship, upright at height `rest` [m] at first, in `count` waves of height [m], period [s], heading [deg]:
    rows (7, n) of time [s], position x, y, z [m], pitch, yaw, roll [rad] over the last JUDGED_WAVES waves."""
    fluid: Any = simulation.fluid  # of kind linear_waves
    clock: Any = simulation.time_step  # of kind fixed
    set_pose(simulation, position=np.array([0.0, rest, 0.0]), orientation=UPRIGHT)
    fluid.begin(regular_wave(height, period, heading_vector(heading, 3), simulation.basin.depth, GRAVITY))
    simulation.time, simulation.next_dt = 0.0, period / WAVE_STEPS
    clock.adjust(dt=period / WAVE_STEPS)
    rows = [(t, *b.position, *b.angles) for t, b in follow_body(simulation, count * period - 1e-9)]
    return np.array(rows[-JUDGED_WAVES * WAVE_STEPS :]).T


def zero_crossing_period(times: np.ndarray, values: np.ndarray) -> float:
    """Period [s] of a signal (n,) at times (n,) [s]: twice the mean time between its crossings of zero."""
    k = np.flatnonzero(values[1:] * values[:-1] < 0.0)
    crossings = times[k] + (times[k + 1] - times[k]) * values[k] / (values[k] - values[k + 1])
    return 2.0 * float(np.diff(crossings).mean())
