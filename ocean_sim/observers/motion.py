"""The motion of each ship at a fixed rate: pose, rates, specific force at a point, and every part of (4.27)."""

from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ocean_sim.conventions import Frame, Motions, to_frame
from ocean_sim.model import quantity
from ocean_sim.observers.shared.csv_rows import CsvFile, heading
from ocean_sim.observers.shared.handed_on import TakesMotion, takers
from ocean_sim.observers.shared.sampled import Sampled
from ocean_sim.parts import ALONE, LedgerRow, Preflight, Problems, called
from ocean_sim.ship import Ship
from ocean_sim.simulation import Observer, PeriodicConfig

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation

LINES, TURNS = Motions._fields[:3], Motions._fields[3:]
AXES = {
    "ship": "right-handed, x to port, y up, z to the bow; world x and z horizontal, y up",
    "ned": "SNAME: x to the bow, y to starboard, z down; world x along our z, y along our -x, z down",
    "flu": "ISO 8855: x to the bow, y to port, z up; world x along our z, y along our x, z up",
}
BEFORE = ("time_s", "seq")
ANGLES, QUATERNION = slice(3, 6), slice(6, 10)  # in a row without these two


def file_of(ship: str) -> str:
    """The name of a ship's motion log."""
    return "motion.csv" if ship == ALONE else f"motion_{ship}.csv"


def columns(parts: tuple[str, ...]) -> tuple[str, ...]:
    """Of a motion log, for a ship whose load has these parts."""
    return (
        *BEFORE,
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
    """Axes that are written: ours, `ned` (SNAME) or `flu` (ISO 8855)."""

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

    def __init__(self, config: Config, folder: Path, simulation: "Simulation") -> None:
        self.every = config.every
        self.logs = [Log(config, folder, simulation, ship) for ship in simulation.ships.values()]

    def observe(self, simulation: "Simulation") -> None:
        for log in self.logs:
            log.observe(simulation)

    def close(self) -> None:
        for log in self.logs:
            log.close()


class Log:
    """motion.csv, of one ship."""

    before: np.ndarray | None

    def __init__(self, config: Config, folder: Path, simulation: "Simulation", ship: Ship) -> None:
        self.ship, self.frame = ship, config.frame
        self.signs = to_frame(self.frame, np.eye(3)).sum(axis=1)  # each of our axes is plus or minus one of the frame's
        self.arm = ship.points[config.point] if config.point else np.zeros(3)
        self.sampled, self.gravity = Sampled(config.every), np.array(simulation.basin.gravity)
        self.number = 0
        self.before = None
        head = heading(
            simulation,
            f"every {config.every:g} s, linear between steps",
            rates_and_specific_force=f"body axes, gravity included, felt at {config.point or 'the centre of mass'}",
            angles="intrinsic yaw, pitch, roll; the quaternion turns body to world",
            forces="world axes, torques about the centre of mass, of the step that ended",
            damping="what the water that moves along does back is part of damping",
        )
        head |= {"frame": config.frame, "axes": AXES[config.frame]}
        self.columns = columns(ship.parts)
        self.handed_on = next(k for k, name in enumerate(self.columns) if name.startswith("force_"))  # so many of them
        self.csv = CsvFile(folder / file_of(ship.name), head, self.columns)

    def observe(self, simulation: "Simulation") -> None:
        rows: list[str] = []
        for time, values, _ in self.sampled.rows(simulation.time, self.continuous(self.row(self.ship))):
            angles, q = values[ANGLES], values[QUATERNION]
            values[ANGLES] = np.remainder(angles + np.pi, 2.0 * np.pi) - np.pi
            values[QUATERNION] = q / np.linalg.norm(q)
            rows.append(self.csv.row([time, self.number, *values.tolist()]))
            self.number += 1
        if rows:
            self.hand_on(rows, simulation)

    def hand_on(self, rows: list[str], simulation: "Simulation") -> None:
        """Give rows, as the log shows them, to the observers that take them: what they make of them then is what they
        would make of the file."""
        for observer in takers(simulation, TakesMotion):
            cells = [row.split(",", self.handed_on)[: self.handed_on] for row in rows]
            table = np.array([[float(number) for number in row] for row in cells]).T
            observer.take_motion(self.ship.name, dict(zip(self.columns, table)), self.frame)

    def row(self, ship: Ship) -> np.ndarray:
        """All columns but time and number."""
        body, load, turn = ship.body, ship.last, ship.body.matrix
        felt = body.point_acceleration(self.arm, ship.acceleration, ship.turning)
        n = len(load.parts)
        vectors = np.empty((4 + 2 * n, 3))  # of the quaternion, the specific force, and the loads
        vectors[0], vectors[1] = body.orientation[1:], turn.T @ (felt - self.gravity)
        vectors[2 : 2 + 2 * n], vectors[2 + 2 * n :] = load.parts.reshape(-1, 3), load.parts.sum(axis=0)
        vectors = to_frame(self.frame, vectors)
        motions = np.empty((5, 3))
        motions[0], motions[1], motions[2] = body.position, body.angles, body.velocity
        motions[3], motions[4] = body.rates, ship.acceleration
        motions *= self.signs  # positive as the frame's axes are
        row = np.empty(len(self.columns) - len(BEFORE))
        row[:6], row[6], row[QUATERNION.start + 1 : QUATERNION.stop] = (
            motions[:2].ravel(),
            body.orientation[0],
            vectors[0],
        )
        row[QUATERNION.stop : QUATERNION.stop + 9] = motions[2:].ravel()
        row[QUATERNION.stop + 9 : -2], row[-2:] = vectors[1:].ravel(), ship.orders
        return row

    def continuous(self, row: np.ndarray) -> np.ndarray:
        """The row with angles and quaternion near those of the row before, so that lines between them are short."""
        if self.before is not None:
            turns = np.round((row[ANGLES] - self.before[ANGLES]) / (2.0 * np.pi))
            row[ANGLES] -= 2.0 * np.pi * turns
            row[QUATERNION] *= 1.0 if row[QUATERNION] @ self.before[QUATERNION] >= 0.0 else -1.0
        self.before = row.copy()
        return row

    def close(self) -> None:
        self.csv.close()
