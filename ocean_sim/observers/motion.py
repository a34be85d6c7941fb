"""The motion of each ship at a fixed rate: pose, rates, specific force at a point, and every load in equation
(4.27)."""

from functools import reduce
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ocean_sim.columns import Columns
from ocean_sim.conventions import Frame, Motions, to_frame
from ocean_sim.model import Faults, quantity
from ocean_sim.observers.shared.csv_rows import CsvFile, Multiples, TakesCommands, TakesMotion, heading, legend
from ocean_sim.parts import ALONE, LedgerRow, PeriodicConfig, SceneFacts, called
from ocean_sim.ship import Ship
from ocean_sim.ship.body.track import (
    UNKNOWN_VELOCITY,
    Attitude,
    Between,
    Track,
    attitude_of,
    continuous_signs,
    first_derivative,
    join_moments,
    second_derivative,
)
from ocean_sim.simulation import Observer, Simulation

if TYPE_CHECKING:
    from ocean_sim.ship.body.rigid_body import RigidBody

LINEAR_MOTIONS, ROTATIONS = Motions._fields[:3], Motions._fields[3:]
FRAME_AXES = {
    "ship": "right-handed, x to port, y up, z to the bow; world x and z horizontal, y up",
    "ned": "SNAME: x to the bow, y to starboard, z down; world x along our z, y along our -x, z down",
    "flu": "ISO 8855: x to the bow, y to port, z up; world x along our z, y along our x, z up",
}
MOMENTS_PER_BATCH = 100  # whose rows are computed together
MOMENT = Columns(time=1, position=3, orientation=4, acceleration=3, turning=3, spin=3, orders=2)  # then the load
PLACE, QUATERNION = slice(MOMENT.position, MOMENT.acceleration), slice(MOMENT.orientation, MOMENT.acceleration)
ACCELERATION, TURNING = slice(MOMENT.acceleration, MOMENT.turning), slice(MOMENT.turning, MOMENT.spin)
SPIN = slice(MOMENT.spin, MOMENT.orders)


def log_name(ship: str) -> str:
    return "motion.csv" if ship == ALONE else f"motion_{ship}.csv"


def log_columns(parts: tuple[str, ...]) -> tuple[str, ...]:
    """Column names of a ship's motion log. `parts`: components of her load, such as buoyancy, six columns each."""
    return (
        "time_s",
        "seq",
        *(f"{name}_m" for name in LINEAR_MOTIONS),
        *(f"{name}_rad" for name in ROTATIONS),
        *("qw", "qx", "qy", "qz"),
        *(f"{name}_velocity_m_s" for name in LINEAR_MOTIONS),
        *(f"{name}_rate_rad_s" for name in ROTATIONS),
        *(f"{name}_acceleration_m_s2" for name in LINEAR_MOTIONS),
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
    every: float = quantity("s", 0.01, gt=0.0)
    """Simulated time between rows. Rows within the last step of a run use the load of the step before; a run that goes
    on replaces them."""
    point: str | None = None
    """Name of a point, in `points` of every ship, of the specific force; null: the centre of mass."""
    frame: Frame = "ship"
    """Axes of the columns; `ship`: ours, `ned` (SNAME) or `flu` (ISO 8855)."""

    def mismatches(self, preflight: SceneFacts) -> Faults:
        if not preflight.ships:
            yield (), "there is no ship whose motion could be logged"
        for name, ship in preflight.ships.items():
            if self.point is not None and self.point not in ship.points:
                there = f"there are {', '.join(ship.points)}" if ship.points else "it names none"
                yield ("point",), f"{called(name)} has no point {self.point!r}; {there}"

    def files_of(self, preflight: SceneFacts) -> tuple[str, ...]:
        return tuple(log_name(name) for name in preflight.ships)

    def ledger(self, preflight: SceneFacts) -> list[LedgerRow]:
        logs, [row] = self.files_of(preflight), super().ledger(preflight)
        return [row._replace(what=", ".join(logs) or row.what)]


class Motion(Observer, of=Config):
    """Writes the motion log of each ship, by one `Log` each."""

    every = 0.0  # the load at one time is known a step later

    def __init__(self, config: Config, folder: Path, simulation: Simulation) -> None:
        self.simulation = simulation
        self.logs = [Log(config, folder, simulation, ship) for ship in simulation.ships.values()]

    def observe(self, simulation: Simulation) -> None:
        for log in self.logs:
            log.observe(simulation)

    def close(self) -> None:
        for log in self.logs:
            log.close(self.simulation)


class Log:
    """Motion log of one ship. It stores her state after each step (a "moment") and interpolates rows between moments,
    in batches unless another observer waits for them. The load at a moment is known only after the next step."""

    last: "tuple[float, RigidBody, tuple[float, float]] | None"  # the newest time, body and orders

    def __init__(self, config: Config, folder: Path, simulation: Simulation, ship: Ship) -> None:
        self.ship, self.frame = ship, config.frame
        self.signs = to_frame(self.frame, np.eye(3)).sum(axis=1)  # each of our axes is plus or minus one of the frame's
        self.arm = ship.points[config.point] if config.point else np.zeros(3)
        self.multiples, self.gravity = Multiples(config.every), np.array(simulation.basin.gravity)
        self.last = None
        # Moments since the last row, and the one before it.
        self.moments = np.zeros((MOMENTS_PER_BATCH, MOMENT.size + 6 * len(ship.parts)))
        self.seen, self.velocity = 0, UNKNOWN_VELOCITY  # number of moments, and velocity at the first
        self.due: list[tuple[float, int]] = []  # times of rows [s], and the moment that completes each
        self.number = 0
        rate = f"every {config.every:g} s, between steps poses on cubics, velocities and rates theirs, all else linear"
        head = heading(simulation, rate, **legend("motion", point=config.point or "the centre of mass"))
        head |= {"frame": config.frame, "axes": FRAME_AXES[config.frame]}
        self.columns = log_columns(ship.parts)
        self.motion_columns = next(k for k, name in enumerate(self.columns) if name.startswith("force_"))
        self.csv = CsvFile(folder / log_name(ship.name), head, self.columns)

    def observe(self, simulation: Simulation) -> None:
        self.complete(simulation)
        self.last = simulation.time, self.ship.body, self.ship.orders

    def complete(self, simulation: Simulation) -> None:
        """Store time, pose and load at this step's start, whose load is known only now; write the rows that are due."""
        if self.last is None:
            return
        (time, body, orders), ship = self.last, self.ship
        moment, pose = self.moments[self.seen], (*body.position.tolist(), *body.orientation.tolist())
        moment[: MOMENT.size] = time, *pose, *ship.acceleration.tolist(), *ship.turning.tolist(), *body.spin, *orders
        moment[MOMENT.size :] = ship.last.parts.ravel()
        self.due += [(k * self.multiples.every, self.seen) for k in self.multiples.reached(time)]
        self.seen += 1
        if self.seen == 1:
            dt = 0.5 * (simulation.time - time)
            speeds = body.velocity + dt * ship.acceleration, body.angular_velocity + dt * ship.turning
            self.velocity = first_derivative(*speeds, body.orientation)  # mean of this moment's and the next one's
            self.write(simulation)
            self.velocity = UNKNOWN_VELOCITY
        elif self.seen == MOMENTS_PER_BATCH or (
            self.due and any(o.at_once for o in simulation.observers if isinstance(o, TakesMotion | TakesCommands))
        ):
            self.write(simulation)

    def write(self, simulation: Simulation) -> None:
        """Write all due rows, interpolated between the stored states; the last state begins the next batch."""
        moments = self.moments[: self.seen]
        moments[:, QUATERNION] = continuous_signs(moments[:, QUATERNION].T).T
        columns = moments[:, : MOMENT.size].T
        acceleration, turning = columns[ACCELERATION], columns[TURNING]
        bends = second_derivative(acceleration, turning, columns[SPIN], columns[QUATERNION])
        track = join_moments(columns[MOMENT.time], columns[PLACE], bends, self.velocity)
        rows = []
        if self.due:
            times, numbers = zip(*self.due)
            between = Between(track, np.array(times), np.array(numbers))
            values = self.load_table(attitude_of(track), acceleration, turning, moments[:, MOMENT.orders :])
            motions = self.motion_table(between.interpolated_track()).T.tolist()
            for t, pose, rest in zip(times, motions, between.interpolated_values(values).tolist(), strict=True):
                rows.append(self.csv.row([t, self.number, *pose, *rest]))
                self.number += 1
        self.moments[0], self.velocity, self.seen, self.due = moments[-1], track.velocity[:, -1], 1, []
        if rows:
            self.hand_rows_on(rows, simulation)

    def hand_rows_on(self, rows: list[str], simulation: Simulation) -> None:
        """Give new rows to the observers that take the motion log, as numbers rounded like those in the file."""
        for observer in (each for each in simulation.observers if isinstance(each, TakesMotion)):
            cells = [row.split(",", self.motion_columns)[: self.motion_columns] for row in rows]
            table = np.array([[float(number) for number in row] for row in cells]).T
            observer.take_motion(self.ship.name, dict(zip(self.columns, table)), self.frame)

    def load_table(self, body: Attitude, acceleration: np.ndarray, turning: np.ndarray, rest: np.ndarray) -> np.ndarray:
        """Columns (n, m) of the log at n times: accelerations, specific forces, loads, throttle, rudder.
        `acceleration`, `turning` (3, n): linear [m/s2], angular [rad/s2]; `rest` (n, k): throttle, rudder, loads."""
        felt = body.point_acceleration(self.arm, acceleration, turning)
        specific = to_frame(self.frame, body.to_body(felt - self.gravity[:, None]).T)
        orders, parts = rest[:, :2], rest[:, 2:].reshape(len(rest), -1, 6)
        total = reduce(np.add, parts.transpose(1, 0, 2))
        loads = to_frame(self.frame, np.concatenate([rest[:, 2:], total], axis=1).reshape(len(rest), -1, 3))
        along = self.signs * acceleration.T  # positive as the frame's axes are
        return np.concatenate([along, specific, loads.reshape(len(rest), -1), orders], axis=1)

    def motion_table(self, track: Track) -> np.ndarray:
        """Columns (16, n), log's axes: positions [m], angles [rad], quaternions, velocities [m/s], rates [rad/s]."""
        body, signs = attitude_of(track), self.signs[:, None]
        q = body.orientation
        pose, speed = (track.place[:3], body.angles), (track.velocity[:3], body.to_body(body.spin))
        turn = q[:1], to_frame(self.frame, q[1:].T).T
        return np.concatenate([*(signs * x for x in pose), *turn, *(signs * x for x in speed)])

    def close(self, simulation: Simulation) -> None:
        """Write the last rows, with the load of the step before, as their own is not known yet, and close the file."""
        self.complete(simulation)
        if self.due:
            self.write(simulation)
        self.csv.close()
