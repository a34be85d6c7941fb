"""Mean and slow drift of a hull in waves: horizontal forces of the second order in their height.

A regular wave of amplitude a pushes with D a^2. D comes from a table, or by rule from the waterline: where waves along
the unit vector d meet its outward normal n, each metre is pushed by rho g a^2 / 2 R^2 (n . d)^2 along -n. With R = 1
that is the limit of short waves (Faltinsen, Minsaas, Liapis & Skjordal 1980, 13th Symposium on Naval Hydrodynamics),
and R^2 abeam of a wall-sided hull is Maruo's (1960, J. Ship Res. 4). R is the share that a thin wall as deep as the
section reflects, R^2 = 1 / (1 + (K1(k T) / (pi I1(k T)))^2) (Ursell 1947, Proc. Camb. Phil. Soc. 43).

In a sum of waves with phases phi the force is that of Newman (1974, Symposium on the Dynamics of Marine Vehicles),
sum over i, j of a_i a_j (D_i + D_j) / 2 cos(phi_i - phi_j): the mean, and all difference frequencies.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ocean_sim.conventions import Motions
from ocean_sim.files import csv_file
from ocean_sim.files.input_file import Checked, Rule
from ocean_sim.fluid import ClosedForm
from ocean_sim.ship.body.rigid_body import RigidBody
from ocean_sim.ship.forces.radiation import HEADING_STEP, MIRROR_SIGNS, at_headings, heading_gap
from ocean_sim.ship.naval.hydrostatics import Hydrostatics

TABLE_COLUMNS = ("omega_rad_s", "heading_deg", "surge_N_m2", "sway_N_m2", "yaw_Nm_m2")
SIGNS = MIRROR_SIGNS[[Motions._fields.index(motion) for motion in ("surge", "sway", "yaw")]]
GRID_RULE = Rule("a table of drift has one row for each frequency, above 0, with each heading, 0 to 180 or 360 degrees")
CHECKS = (Checked("Drift forces, `ship.drift.table`", (GRID_RULE,)),)
SLOW_SHARE = 0.15  # of the waves' mean frequency, up to which a motion is a slow one
Law = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
"""(3, n) surge and sway force [N/m2], yaw moment [N m/m2] per amplitude squared of waves with frequencies (n,) [rad/s],
wavenumbers (n,) [rad/m], and headings (n,) [rad] to which they go, from that of the ship."""


class DriftTable(NamedTuple):
    """Tabulated drift force per squared wave amplitude: linear in between, constant beyond the table, 0 at 0 rad/s."""

    omega: np.ndarray  # (n,) [rad/s], rising
    headings: np.ndarray  # (h,) to which waves go, from that of the ship [deg], rising
    force: np.ndarray  # (3, h, n) surge, sway [N/m2], yaw [N m/m2]

    def coefficients(self, omega: np.ndarray, wavenumber: np.ndarray, heading: np.ndarray) -> np.ndarray:
        """`Law`: (3, n) surge, sway [N/m2], yaw [N m/m2] per squared amplitude at `omega` (n,) [rad/s] and `heading`
        (n,) [rad], whatever the wavenumber; a table of 0 to 180 degrees is mirrored for the other side."""
        angle, signs = np.degrees(heading) % 360.0, np.ones((3, len(omega)))
        if self.headings[-1] <= 180.0:
            signs = np.where(angle > 180.0, SIGNS[:, None], 1.0)
            angle = np.minimum(angle, 360.0 - angle)
        at = np.append(0.0, self.omega)
        known = [[np.interp(omega, at, np.append(0.0, row)) for row in rows] for rows in self.force]
        return signs * [at_headings(angle, self.headings, np.array(rows)) for rows in known]


def read_table(file: str) -> DriftTable:
    """Read a table with TABLE_COLUMNS from a CSV file; raises Unreadable if it breaks a rule of CHECKS."""
    omega, heading, *force = csv_file.Table(file).finite(*TABLE_COLUMNS)
    bad = np.flatnonzero((omega <= 0.0) | (heading < 0.0) | (heading > 360.0))
    if len(bad):
        k = bad[0]
        raise GRID_RULE.broken(file, f"row {k + 1} has {omega[k]:g} rad/s and {heading[k]:g} degrees")
    (omegas, i), (headings, j) = (np.unique(each, return_inverse=True) for each in (omega, heading))
    count = np.zeros((len(headings), len(omegas)), dtype=int)
    np.add.at(count, (j, i), 1)
    if (count != 1).any():
        h, n = np.argwhere(count != 1)[0]
        raise GRID_RULE.broken(file, f"{omegas[n]:g} rad/s and {headings[h]:g} degrees stand in {count[h, n]} rows")
    if only := heading_gap(headings):
        raise GRID_RULE.broken(file, f"its headings are {only}{'' if '?' in only else ' alone'}")
    whole = np.zeros((3, *count.shape))
    whole[:, j, i] = force
    return DriftTable(omegas, headings, whole)


def waterline_law(hull: Hydrostatics) -> Law:
    """Drift force by a floating hull's waterline, as a function of the waves' frequencies, wavenumbers and headings
    (`Law`): the limit of short waves times Ursell's reflection."""
    from scipy.special import ive, kve

    z, breadth, draught = (values[hull.stations[1] > 0.0] for values in hull.stations)
    ends = hull.waterline_ends
    slopes = np.append(np.diff(breadth) / np.diff(z), 0.0)[[0, max(len(z) - 2, 0)]]
    blunt = np.maximum(breadth[[0, -1]] + slopes * (ends - z[[0, -1]]), 0.0)
    half = 0.5 * np.concatenate([[0.0], blunt[:1], breadth, blunt[1:], [0.0]])
    z = np.concatenate([ends[:1] * 2, z, ends[1:] * 2]) - hull.matter.centre[2]
    depth = np.pad(draught, 2, mode="edge")
    pieces = [np.diff(z), -np.diff(half), *(0.5 * (values[1:] + values[:-1]) for values in (half, z, depth))]
    # Of each piece of the waterline, port and starboard: outward normal times length, x and z of its middle, draught.
    nx, nz, x, z, deep = (np.append(values, sign * values) for values, sign in zip(pieces, (-1, 1, -1, 1, 1)))
    size = np.maximum(np.hypot(nx, nz), 1e-9)
    sides = np.stack([nz, nx, z * nx - x * nz])

    def coefficients(omega: np.ndarray, wavenumber: np.ndarray, heading: np.ndarray) -> np.ndarray:
        """(3, n) surge, sway [N/m2], yaw [N m/m2] by the waterline of `hull`; arguments as in `Law`, `omega` unused."""
        met = np.minimum((np.outer(nx, np.sin(heading)) + np.outer(nz, np.cos(heading))) / size[:, None], 0.0)
        under = np.outer(deep, wavenumber)
        passed = kve(1, under) / ive(1, under) * np.exp(-2.0 * under) / np.pi
        return -0.5 * hull.density * hull.gravity * sides @ (met**2 / (1.0 + passed**2))

    return coefficients


class Drift:
    """Drift force of the waves of a closed-form sea on one hull, and her slow position: her path without wave motion.

    First-order forces are those on the hull at rest there, so no mean of them counts twice. The slow position e follows
    the ship x: e''' = r^3 (x - e) + 2 r^2 (x' - e') - 2 r e'', r = SLOW_SHARE of the waves' mean frequency."""

    def __init__(self, law: Law, sea: ClosedForm, body: RigidBody) -> None:
        self.law, self.sea, self.rate = law, sea, 0.0
        self.slow = np.array([body.position, body.velocity, np.zeros(3)])  # and its rates of change, world axes
        self.known: tuple[float, np.ndarray, np.ndarray] | None = None  # a heading, frequencies, coefficients (3, n)

    def follow(self, body: RigidBody, dt: float) -> None:
        """Advance the slow position, that of the ship's `body` with her wave motion filtered out, by a step dt [s]."""
        r, (place, speed, change) = self.rate, self.slow
        jerk = r**3 * (body.position - place) + 2.0 * r**2 * (body.velocity - speed) - 2.0 * r * change
        change = change + dt * jerk
        speed = speed + dt * change
        self.slow = np.array([place + dt * speed, speed, change])

    def load(self, body: RigidBody) -> np.ndarray:
        """(2, 3) drift force [N], torque about the centre of mass [N m], world axes, for the pose of `body`."""
        (x, _, z), (_, yaw, _) = body.position, body.angles
        waves, known = self.sea.arriving(float(x), float(z), afar=True), self.known
        if known is None or abs(yaw - known[0]) > HEADING_STEP or not np.array_equal(waves.omega, known[1]):
            known = yaw, waves.omega, self.law(waves.omega, waves.wavenumber, waves.heading - yaw)
            self.known, weights = known, waves.amplitude**2 + 1e-12
            self.rate = SLOW_SHARE * float(np.average(waves.omega, weights=weights))
        elevation = waves.amplitude * np.exp(1j * waves.angle)
        surge, sway, turn = (known[2] * (elevation * elevation.sum().conj()).real).sum(axis=1)
        c, s = np.cos(yaw), np.sin(yaw)
        return np.array([[c * sway + s * surge, 0.0, c * surge - s * sway], [0.0, turn, 0.0]])
