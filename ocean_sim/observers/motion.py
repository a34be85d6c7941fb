"""The motion of each ship at a fixed rate: pose, rates, specific force at a point, and every part of (4.27)."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np

from ocean_sim.conventions import Frame, Motions, to_frame
from ocean_sim.model import quantity
from ocean_sim.observers.shared.csv_rows import CsvFile, heading
from ocean_sim.observers.shared.handed_on import TakesMotion, takers
from ocean_sim.observers.shared.sampled import Multiples, Passing, Sample, between, path
from ocean_sim.parts import ALONE, LedgerRow, Preflight, Problems, called
from ocean_sim.ship import Load, Ship
from ocean_sim.simulation import Observer, PeriodicConfig

if TYPE_CHECKING:
    from ocean_sim.ship.shared.rigid_body import RigidBody
    from ocean_sim.simulation import Simulation

LINES, TURNS = Motions._fields[:3], Motions._fields[3:]
AXES = {
    "ship": "right-handed, x to port, y up, z to the bow; world x and z horizontal, y up",
    "ned": "SNAME: x to the bow, y to starboard, z down; world x along our z, y along our -x, z down",
    "flu": "ISO 8855: x to the bow, y to port, z up; world x along our z, y along our x, z up",
}
UNKNOWN = np.full(7, np.nan)  # of a place


def file_of(ship: str) -> str:
    """The name of a ship's motion log."""
    return "motion.csv" if ship == ALONE else f"motion_{ship}.csv"


def columns(parts: tuple[str, ...]) -> tuple[str, ...]:
    """Of a motion log, for a ship whose load has these parts."""
    return (
        "time_s",
        "seq",
        *(f"{name}_m" for name in LINES),
        *(f"{name}_rad" for name in TURNS),
        *("qw", "qx", "qy", "qz"),
        *(f"{name}_velocity_m_s" for name in LINES),
        *(f"{name}_rate_rad_s" for name in TURNS),
        *(f"{name}_acceleration_m_s2" for name in LINES),
        *(f"specific_force_{axis}_m_s2" for axis in "xyz"),
        *(
            f"{what}_{part}_{axis}_{unit}"
            for part in (*parts, "total")
            for what, unit in (("force", "N"), ("torque", "Nm"))
            for axis in "xyz"
        ),
        "throttle",
        "rudder_rad",
    )


class Config(PeriodicConfig):
    leaves: ClassVar[str] = "motion.csv"
    takes: ClassVar[tuple[float, float]] = (5.0e-4, 0.0)
    every: float = quantity("s", 0.01, gt=0.0)
    """Simulated time between rows."""
    point: str | None = None
    """The name in `points` of every ship where the specific force is felt; null: the centre of mass."""
    frame: Frame = "ship"
    """Axes that are written; `ship`: ours, `ned` (SNAME) or `flu` (ISO 8855)."""

    def mismatches(self, preflight: Preflight) -> Problems:
        if not preflight.ships:
            return [((), "there is no ship whose motion could be logged")]
        found: Problems = []
        for name, ship in preflight.ships.items():
            if self.point is not None and self.point not in ship.points:
                there = f"there are {', '.join(ship.points)}" if ship.points else "it names none"
                found.append((("point",), f"{called(name)} has no point {self.point!r}; {there}"))
        return found

    def ledger(self, preflight: Preflight) -> list[LedgerRow]:
        logs, rows = [file_of(name) for name in preflight.ships], super().ledger(preflight)
        return [row._replace(what=", ".join(logs) or row.what, seconds=max(len(logs), 1) * row.seconds) for row in rows]

    def build(self, folder: Path, simulation: "Simulation") -> "Motion":
        return Motion(self, folder, simulation)


class Motion(Observer):
    """A log for each ship."""

    every = 0.0  # what acts on a ship at one time is known a step later

    def __init__(self, config: Config, folder: Path, simulation: "Simulation") -> None:
        self.simulation = simulation
        self.logs = [Log(config, folder, simulation, ship) for ship in simulation.ships.values()]

    def observe(self, simulation: "Simulation") -> None:
        for log in self.logs:
            log.observe(simulation)

    def close(self) -> None:
        for log in self.logs:
            log.close(self.simulation)


class Moment(NamedTuple):
    """A ship at one time [s], and what acted on it then."""

    time: float
    body: "RigidBody"
    orders: tuple[float, float]
    acceleration: np.ndarray
    turning: np.ndarray
    load: Load
    place: np.ndarray  # (7,) position [m] and quaternion
    bend: np.ndarray  # (7,) their second derivatives
    velocity: np.ndarray = UNKNOWN  # (7,) their first derivatives at this time

    @property
    def passing(self) -> Passing:
        """With the velocity of this time."""
        return Passing(self.time, self.place, self.velocity)

    def setting_out(self, dt: float) -> Passing:
        """At the first time: with the mean of the velocity that it has and that of the next step, of dt [s]."""
        gained = 0.5 * dt * self.acceleration, 0.5 * dt * self.turning
        change = self.body.change(self.body.velocity + gained[0], self.body.angular_velocity + gained[1])
        return Passing(self.time, self.place, change)


def moment(time: float, body: "RigidBody", orders: tuple[float, float], ship: Ship) -> Moment:
    """A ship whose body and orders were these at a time [s], with what has acted on it since."""
    place = np.concatenate([body.position, body.orientation])
    bend = body.bend(ship.acceleration, ship.turning)
    return Moment(time, body, orders, ship.acceleration, ship.turning, ship.last, place, bend)


def joined(before: Moment, now: Moment) -> tuple[Moment, Moment]:
    """Two moments that follow each other, with the velocities of their own times. Those of the bodies have led from one
    pose to the next, so they are the mean of a step; from there on accelerations change evenly."""
    step = now.time - before.time
    if now.place[3:] @ before.place[3:] < 0.0:  # the short way around
        body, other = replace(now.body, orientation=-now.body.orientation), np.repeat([1.0, -1.0], [3, 4])
        now = now._replace(body=body, place=other * now.place, bend=other * now.bend)
    mean = (now.place - before.place) / step
    if np.isnan(before.velocity).any():
        before = before._replace(velocity=mean - step * (2.0 * before.bend + now.bend) / 6.0)
    return before, now._replace(velocity=mean + step * (before.bend + 2.0 * now.bend) / 6.0)


class Log:
    """motion.csv, of one ship. A step begins with what acts on the hull, so that this is known of a time when the step
    is over; of the last time it is that of the step before."""

    left_out = ("known",)  # of `before`, and made again from it

    last: "tuple[float, RigidBody, tuple[float, float]] | None"  # the newest time, body and orders
    before: Moment | None
    known: tuple[Moment, Sample] | None  # the newest moment, and what the log shows then, if that was asked for

    def __init__(self, config: Config, folder: Path, simulation: "Simulation", ship: Ship) -> None:
        self.ship, self.frame = ship, config.frame
        self.signs = to_frame(self.frame, np.eye(3)).sum(axis=1)  # each of our axes is plus or minus one of the frame's
        self.arm = ship.points[config.point] if config.point else np.zeros(3)
        self.multiples, self.gravity = Multiples(config.every), np.array(simulation.basin.gravity)
        self.number = 0
        self.last, self.before, self.known = None, None, None
        head = heading(
            simulation,
            f"every {config.every:g} s, between steps poses on cubics, velocities and rates theirs, all else linear",
            rates_and_specific_force=f"body axes, gravity included, felt at {config.point or 'the centre of mass'}",
            angles="intrinsic yaw, pitch, roll; the quaternion turns body to world",
            forces="world axes, torques about the centre of mass",
            velocities="of the time of their row: how fast positions and attitudes change then",
            damping="the reaction of added mass is part of damping",
        )
        head |= {"frame": config.frame, "axes": AXES[config.frame]}
        self.columns = columns(ship.parts)
        self.handed_on = next(k for k, name in enumerate(self.columns) if name.startswith("force_"))  # so many of them
        self.csv = CsvFile(folder / file_of(ship.name), head, self.columns)

    def observe(self, simulation: "Simulation") -> None:
        self.complete(simulation)
        self.last = simulation.time, self.ship.body, self.ship.orders

    def complete(self, simulation: "Simulation") -> None:
        """Write the rows up to the newest time, with what has acted on the ship since."""
        if self.last is None:
            return
        ship = self.ship
        now = moment(*self.last, ship)
        if self.before is not None and self.before.time < now.time:
            before, now = joined(self.before, now)
            start, end = before.passing, now.passing
        else:
            before, start = now, now.setting_out(simulation.time - now.time)
            end = start
        passed = self.multiples.reached(now.time)
        if passed:
            first, last = self.sample(before, start), self.sample(now, end)
            self.known, lines = (now, last), []
            for k in passed:
                time, values, _ = between(first, last, k * self.multiples.every)
                there = path(start, end, time)
                motions = self.motions(now.body.passing(there.place, there.velocity))
                lines.append(self.csv.row([time, self.number, *motions.tolist(), *values.tolist()]))
                self.number += 1
            self.hand_on(lines, simulation)
        self.before = now

    def hand_on(self, rows: list[str], simulation: "Simulation") -> None:
        """Give rows, as the log shows them, to the observers that take them: what they make of them then is what they
        would make of the file."""
        for observer in takers(simulation, TakesMotion):
            cells = [row.split(",", self.handed_on)[: self.handed_on] for row in rows]
            table = np.array([[float(number) for number in row] for row in cells]).T
            observer.take_motion(self.ship.name, dict(zip(self.columns, table)), self.frame)

    def sample(self, at: Moment, there: Passing) -> Sample:
        """What the log shows at a moment, whose body passes there."""
        if self.known is not None and self.known[0] is at:
            return self.known[1]
        return Sample(at.time, self.row(at._replace(body=at.body.passing(there.place, there.velocity))), ())

    def row(self, now: Moment) -> np.ndarray:
        """All columns after velocities and rates."""
        body, load, turn = now.body, now.load, now.body.matrix
        felt = body.point_acceleration(self.arm, now.acceleration, now.turning)
        parts = np.concatenate([load.parts, load.parts.sum(axis=0, keepdims=True)])
        vectors = np.concatenate([[turn.T @ (felt - self.gravity)], parts.reshape(-1, 3)])
        specific, *loads = to_frame(self.frame, vectors)
        acceleration = self.signs * now.acceleration  # positive as the frame's axes are
        return np.concatenate([acceleration, specific, *loads, now.orders])

    def motions(self, body: "RigidBody") -> np.ndarray:
        """(16,) columns of position, angles, unit quaternion, velocity and rates in the frame's axes. Angles are of the
        quaternion: by themselves they leap where a bow points straight up."""
        pose, speed = self.signs * [body.position, body.angles], self.signs * [body.velocity, body.rates]
        q = body.orientation
        return np.concatenate([*pose, q[:1], to_frame(self.frame, q[1:]), *speed])

    def close(self, simulation: "Simulation") -> None:
        self.complete(simulation)
        self.csv.close()
