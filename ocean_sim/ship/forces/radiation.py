"""Tables of a panel method (added mass and damping over frequency, force of scattered waves), and the radiation and
scattering forces on one hull by them.

A table is a CSV file, or the NetCDF file that Capytaine writes; that is HDF5 and read without Capytaine. Capytaine's
axes (x to the bow, y to port, z up) are ours in another order; its rotations must be about the centre of mass. It gives
six by six entries; the coupling of two motions is the mean of the two that reciprocity makes equal. Tables are of a
hull without forward speed. Under way they count at the frequency of encounter, with strip theory's terms of speed
(Salvesen, Tuck & Faltinsen 1970, Trans. SNAME 78).

A motion's force is -A(infinity) times its acceleration, less the integral of K(t - tau) times its velocity (Cummins
1962, Schiffstechnik 9), with Ogilvie's relations (1964, 5th Symposium on Naval Hydrodynamics)
K(t) = 2/pi int B(omega) cos(omega t) d omega and A(infinity) = A(omega) + 1/omega int K(t) sin(omega t) dt.
Where a table says so, motions act on each other: A, B and K are then symmetric matrices.

The momentum left in the waves is the integral of L(t - tau) times the velocity with L(t) = -int K from t
on, and the force is less its rate. A hull that moves on through the water at v is turned by it, by -v x momentum, as
Kirchhoff's equations have it of A(infinity). In heave and pitch at a speed U these are strip theory's terms of speed,
U A33, U B33 / omega^2 and U^2 / omega^2 times both (table 1 there, without those of a transom), omega being the
frequency of encounter.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from io import BytesIO
from itertools import combinations_with_replacement, product
from math import pi
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ocean_sim.conventions import Motions
from ocean_sim.files import csv_file, input_file
from ocean_sim.files.input_file import DATA_SET_RULE, WORD_KINDS, Checked, Rule, display_path, read_data_set
from ocean_sim.fluid import Arriving
from ocean_sim.ship.body.rigid_body import cross

FREQUENCY_COLUMN = "omega_rad_s"
ADDED_UNITS = dict(zip(Motions._fields, ("kg", "kg", "kg", "kg_m2", "kg_m2", "kg_m2"), strict=True))
RECIPROCITY_TOLERANCE = 0.1  # share of both own entries by which the two couplings may differ (median of all rows)
MIRROR_SIGNS = np.array([-1.0, 1.0, 1.0, 1.0, -1.0, -1.0])  # of each motion in waves from the other side
DOF_NAMES = ("influenced_dof", "radiating_dof")  # of forces, and of motions, as Capytaine calls them
PANEL_RULE = Rule("a NetCDF file is Capytaine's, of a hull without forward speed, in finite numbers")
MAX_END_DAMPING = 0.25  # of the largest damping, at the highest frequency
MIN_FREQUENCIES, MAX_FREQUENCIES = 4, 300  # frequencies
NEGATIVE_TOLERANCE = 0.25  # of the largest damping: negative values by irregular frequencies
FREQUENCY_RULE = Rule(f"there are {MIN_FREQUENCIES} to {MAX_FREQUENCIES} frequencies above 0, which rise, each once")
DAMPING_RULE = Rule(
    "damping is above 0, or there are no waves to remember; of the other sign it is of another convention"
)
END_RULE = Rule(
    f"damping has fallen below {MAX_END_DAMPING:.0%} of its most at the highest frequency; let the table go on"
)
CHECKS = (
    Checked("Added mass and damping, `ship.radiation`: a NetCDF file", (DATA_SET_RULE, PANEL_RULE)),
    Checked("Added mass and damping, `ship.radiation`: a table", (FREQUENCY_RULE, DAMPING_RULE, END_RULE)),
)
POINTS_A_PERIOD = 20  # points of K in a period of the highest frequency, and of B between two frequencies
TAIL_FREQUENCIES = 3.0  # [highest frequencies] to which damping is carried on
ERROR_TOLERANCE = 0.05  # share of the largest damping, or of added mass, that a matrix may lie below zero by error
FORGOTTEN_SHARE = 0.003  # of the largest K, below which it is forgotten
HEADING_TOLERANCE = 0.5  # [deg] of a table's first and last heading
HEADING_STEP = 0.02  # [rad] of a turn, after which forces are looked up anew


class Scattered(NamedTuple):
    """Diffraction force Re(X exp(-i omega t)) by waves of unit amplitude, crest at the centre of mass at t = 0."""

    headings: np.ndarray  # (h,) to which waves go, from that of the ship [deg], rising
    force: np.ndarray  # (6, h, n) [N/m], [N m/m], of the `Motions`


class Response(NamedTuple):
    """Impulse response of m motions to radiation: convolved with their velocities, kernels K give the force and L the
    momentum left in the waves; A(infinity) is the added mass of quick motions."""

    times: np.ndarray  # (n,) since a push [s]
    kernels: np.ndarray  # (m, m, n) K [kg/s2], [kg m/s2], [kg m2/s2]
    left: np.ndarray  # (m, m, n) L [kg/s], [kg m/s], [kg m2/s]
    added: np.ndarray  # (m, m) A(infinity) [kg], [kg m], [kg m2]


@dataclass(frozen=True, eq=False)
class BemTable:
    """Added mass, damping and wave force of m motions over n frequencies; couplings that the table lacks are 0."""

    omega: np.ndarray  # (n,) [rad/s]
    motions: list[str]
    added: np.ndarray  # (m, m, n) [kg], [kg m], [kg m2]
    damping: np.ndarray  # (m, m, n) [kg/s], [kg m/s], [kg m2/s]
    scattered: Scattered | None
    depth: float | None = None  # of the water [m]; infinite where it is deep, None where the table does not say
    axis: float | None = None  # height over the still water about which it turns [m]; None where it does not say

    @cached_property
    def numbers(self) -> list[int]:
        """Index in `Motions` (sway, heave, ...) of each motion of the table."""
        return [Motions._fields.index(motion) for motion in self.motions]

    def has_coupling(self, one: str, other: str) -> bool:
        """True if the table has added mass or damping that couples motions `one` and `other` (names of `Motions`)."""
        pair = tuple(self.numbers.index(Motions._fields.index(motion)) for motion in (one, other))
        return bool(self.added[pair].any() or self.damping[pair].any())

    @property
    def unphysical_entries(self) -> Iterator[str]:
        """Yield sentences on entries that no hull can have: damping that would give energy, negative added mass."""
        own = np.diag_indices(len(self.numbers))
        most = np.sqrt(np.abs(self.damping[own]).max(axis=1))
        lowest = np.linalg.eigvalsh(np.moveaxis(self.damping, 2, 0) / np.outer(most, most))[:, 0]
        if lowest.min() < -ERROR_TOLERANCE:
            at = self.omega[lowest.argmin()]
            yield f"the damping of the table would give energy at {at:g} rad/s, which no hull's waves do"
        added = self.impulse_response.added
        most = np.sqrt(np.maximum(np.abs(added[own]), 1e-300))
        if np.linalg.eigvalsh(added / np.outer(most, most))[0] < -ERROR_TOLERANCE or (added[own] <= 0.0).any():
            values = ", ".join(f"{Motions._fields[k]} {x:.3g}" for k, x in zip(self.numbers, added[own]))
            yield f"the added mass of quick motions ({values}) is no water's: below zero, or tied to too much"

    @cached_property
    def impulse_response(self) -> Response:
        """Impulse response of the table's motions, until all kernels stay below FORGOTTEN_SHARE of their largest."""
        from scipy.integrate import cumulative_trapezoid

        omega, apart = self.omega, np.diff(self.omega, prepend=0.0).max()
        times = np.arange(0.0, 2.0 * pi / apart, 2.0 * pi / omega[-1] / POINTS_A_PERIOD)
        m = len(self.numbers)
        kernels, added = np.zeros((m, m, len(times))), np.zeros((m, m))
        for i, j in combinations_with_replacement(range(m), 2):
            if self.damping[i, j].any():
                kernels[i, j] = kernels[j, i] = self.retardation_kernel(times, self.damping[i, j])
            sines = np.trapezoid(kernels[i, j] * np.sin(omega[:, None] * times), times, axis=1)
            added[i, j] = added[j, i] = np.median(self.added[i, j] + sines / omega)
        most = np.sqrt(np.abs(kernels[np.diag_indices(m)]).max(axis=1))
        noise = np.abs(kernels).max(axis=2) <= FORGOTTEN_SHARE * np.outer(most, most)  # of a symmetric hull
        kernels[noise] = 0.0
        kept = (np.abs(kernels) / np.outer(most, most)[:, :, None]).max(axis=(0, 1)) > FORGOTTEN_SHARE
        last = int(np.flatnonzero(kept)[-1]) + 1
        times, kernels = times[:last], kernels[:, :, :last]
        whole = cumulative_trapezoid(kernels, times, initial=0.0)
        return Response(times, kernels, whole - whole[:, :, -1:], added)

    def retardation_kernel(self, times: np.ndarray, damping: np.ndarray) -> np.ndarray:
        """Kernel K (n,) [kg/s2] at times (n,) [s] after a push, from `damping`, beyond the table by a power law."""
        from scipy.interpolate import PchipInterpolator

        omega = self.omega
        count = POINTS_A_PERIOD * len(omega)
        within = np.linspace(0.0, omega[-1], count)
        beyond = np.linspace(omega[-1], TAIL_FREQUENCIES * omega[-1], int((TAIL_FREQUENCIES - 1.0) * count))[1:]
        ends = np.maximum(np.abs(damping[-2:]), 1e-12 * np.abs(damping).max())
        power = max(2.0, -float(np.diff(np.log(ends))[0] / np.diff(np.log(omega[-2:]))[0]))
        known = PchipInterpolator(np.append(0.0, omega), np.append(0.0, damping))(within)
        every, falling = np.append(within, beyond), np.copysign(ends[-1], damping[-1]) * (omega[-1] / beyond) ** power
        whole = np.append(known, falling)
        return np.array([2.0 / pi * np.trapezoid(whole * np.cos(every * t), every) for t in times])


def columns_of(motion: str, other: str) -> tuple[str, str]:
    """Names of the columns for added mass and damping, of one motion (`other` is the same) or of a coupling of two."""
    whole = motion if motion == other else f"{motion}_{other}"
    unit = ADDED_UNITS[motion] if ADDED_UNITS[motion] == ADDED_UNITS[other] else "kg_m"
    return f"{whole}_added_{unit}", f"{whole}_damping_{unit}_s"


def read_bem_table(file: str) -> BemTable:
    """Read a panel method's table from a CSV or Capytaine's NetCDF file; raises ValueError if something is missing."""
    return read_capytaine(file) if Path(file).suffix == ".nc" else read_csv_table(file)


def read_csv_table(file: str) -> BemTable:
    """Read a panel method's table from a CSV file; raises ValueError for a column that is missing or unknown."""
    table = csv_file.Table(file)
    names = [motion for motion in Motions._fields if columns_of(motion, motion)[0] in table]
    given = [(a, b) for a, b in product(names, names) if a == b or any(column in table for column in columns_of(a, b))]
    scattering = dict(scattering_columns(table))
    wanted = [FREQUENCY_COLUMN, *(column for a, b in given for column in columns_of(a, b))]
    parts = sorted({f"{column[:-2]}{part}" for column in scattering for part in ("re", "im")})
    missing = [name for name in wanted + parts if name not in table]
    unread = [name for name in table if name.split("_")[0] in Motions._fields and name not in wanted + parts]
    if not names:
        lacks = "has no column of added mass, such as heave_added_kg or pitch_added_kg_m2"
        raise ValueError(f"{display_path(file)} {lacks}")
    if missing:
        raise ValueError(f"{display_path(file)} has no column {', '.join(missing)}")
    if unread:
        right = "a motion has heave_added_kg and the like, two of them heave_pitch_added_kg_m"
        raise ValueError(f"{display_path(file)}: nothing reads the column {', '.join(unread)}; {right}")
    table.finite(*wanted, *scattering)
    added, damping = np.zeros((2, len(names), len(names), len(table[FREQUENCY_COLUMN])))
    for (i, a), (j, b) in product(enumerate(names), repeat=2):
        pair = (a, b) if (a, b) in given else (b, a)
        if pair in given:
            added[i, j], damping[i, j] = (table[column] for column in columns_of(*pair))
    found = None
    if scattering:
        headings = np.unique([heading for _, heading, _ in scattering.values()])
        force = np.zeros((6, len(headings), len(table[FREQUENCY_COLUMN])), dtype=complex)
        for column, (number, heading, part) in scattering.items():
            force[number, np.searchsorted(headings, heading)] += part * table[column]
        found = Scattered(headings, force)
    added, damping = (symmetric_part(file, names, whole) for whole in (added, damping))
    return BemTable(table[FREQUENCY_COLUMN], names, added, damping, found)


def scattering_columns(table: dict[str, np.ndarray]) -> Iterator[tuple[str, tuple[int, float, complex]]]:
    """Yield columns like `heave_scattered_90_re`: name, (index in `Motions`, heading [deg], 1 for `re`, i for `im`)."""
    for column in table:
        motion, _, rest = column.partition("_scattered_")
        heading, _, part = rest.rpartition("_")
        if motion in Motions._fields and part in ("re", "im"):
            yield column, (Motions._fields.index(motion), float(heading), 1.0 if part == "re" else 1.0j)


def read_capytaine(file: str) -> BemTable:
    """Read a table from Capytaine's NetCDF file; raises Unreadable if it is damaged or of a hull under way."""
    import h5py

    content = BytesIO(input_file.read_bytes(file))
    try:
        with h5py.File(content) as data:
            names_of = (read_data_set(data, name, WORD_KINDS) for name in DOF_NAMES)
            words, push = ([word.decode().lower() for word in each] for each in names_of)
            omega = read_data_set(data, "omega")
            names = [motion for motion in Motions._fields if motion in words and motion in push]
            rows, columns = [words.index(motion) for motion in names], [push.index(motion) for motion in names]
            order = np.argsort(omega, kind="stable")
            axes = ("omega", *DOF_NAMES)
            mass, loss = (in_axis_order(data, name, axes)[order] for name in ("added_mass", "radiation_damping"))
            added, damping = (np.moveaxis(whole[:, rows][:, :, columns], 0, 2) for whole in (mass, loss))
            found = None
            if "diffraction_force" in data:
                parts = in_axis_order(data, "diffraction_force", ("complex", DOF_NAMES[0], "wave_direction", "omega"))
                headings, inwards = np.unique(np.degrees(read_data_set(data, "wave_direction")) % 360.0, True)
                force = np.zeros((6, len(headings), len(omega)), dtype=complex)
                numbers = [Motions._fields.index(motion) for motion in names]
                force[numbers] = (parts[0] + 1j * parts[1])[rows][:, inwards][:, :, order]
                found = Scattered(headings, force)
            speed = float(np.abs(read_data_set(data, "forward_speed")).max()) if "forward_speed" in data else 0.0
            depth = float(read_data_set(data, "water_depth").item()) if "water_depth" in data else None
            axis = float(read_data_set(data, "rotation_center")[2]) if "rotation_center" in data else None
    except Exception as error:  # HDF5 has errors of its own
        why = f"{error}" if type(error) is ValueError else "a part of it is missing or damaged"
        raise PANEL_RULE.broken(file, why) from None
    if not names or not all(np.isfinite(part).all() for part in (omega, added, damping, *(found or ()))):
        what = "a value that is not a finite number" if names else f"no motion among {', '.join(Motions._fields)}"
        raise PANEL_RULE.broken(file, f"it has {what}")
    added, damping = (symmetric_part(file, names, whole) for whole in (added, damping))
    if speed != 0.0:
        raise PANEL_RULE.broken(file, f"it is of a hull under way at {speed:g} m/s")
    return BemTable(omega[order], names, added, damping, found, depth, axis)


def symmetric_part(file: str, names: list[str], matrix: np.ndarray) -> np.ndarray:
    """(m, m, n) mean of `matrix` and its transpose, motions `names`; Unreadable if beyond RECIPROCITY_TOLERANCE."""
    most = np.sqrt(np.abs(matrix[np.diag_indices(len(names))]).max(axis=1))
    mirrored = matrix.transpose(1, 0, 2)
    apart = np.median(np.abs(matrix - mirrored), axis=2) / np.maximum(np.outer(most, most), 1e-300)
    i, j = np.unravel_index(apart.argmax(), apart.shape)
    if apart[i, j] > RECIPROCITY_TOLERANCE:
        both = f"what {names[i]} does to {names[j]} and {names[j]} to {names[i]} is equal by reciprocity"
        raise input_file.Unreadable(file, f"{both}, and differs by {apart[i, j]:.0%} of their own entries")
    return 0.5 * (matrix + mirrored)


def in_axis_order(data: Any, name: str, axes: tuple[str, ...]) -> np.ndarray:
    """Array `name` of an open HDF5 file `data`, transposed so that its axes are in the order of the names `axes`."""
    numbers = read_data_set(data, name)
    names = [dimension[0].name.strip("/") for dimension in data[name].dims]
    return np.transpose(numbers, [names.index(axis) for axis in axes])


class Scattering:
    """Force on one hull by the waves that she scatters. In each motion, a table's force at rest is B - i omega A
    (damping B, added mass A) times a velocity w of the water. Under way it is w times B - i omega A at the frequency of
    encounter, and a moment more, her velocity x momentum given by waves (Salvesen, Tuck & Faltinsen 1970, table 2)."""

    def __init__(self, table: BemTable) -> None:
        assert table.scattered is not None
        self.omega, self.scattered = table.omega, table.scattered
        self.numbers = table.numbers
        own = np.diag_indices(len(table.motions))
        self.added, self.lost = table.added[own], table.damping[own] / table.omega
        self.known: tuple[float, np.ndarray, np.ndarray] | None = None  # a heading, frequencies, what is given (6, n)

    def load(self, waves: Arriving, yaw: float, velocity: np.ndarray) -> np.ndarray:
        """(2, 3) scattering force [N] and torque [N m] by `waves`, world axes, on a hull with heading `yaw` [rad] and a
        velocity (3,) through the water [m/s]."""
        known, still = self.known, waves.omega
        if known is None or abs(yaw - known[0]) > HEADING_STEP or not np.array_equal(still, known[1]):
            # Momentum that waves of unit amplitude give a hull at rest, divided by its `complex_inertia`.
            forces = self.unit_wave_forces(still, np.degrees(waves.heading - yaw))
            known = self.known = yaw, still, forces / (-1j * still * self.complex_inertia(still))
        omega = waves.encounter_frequencies(velocity)
        given = known[2] * self.complex_inertia(omega) * (waves.amplitude * np.exp(1j * waves.angle))
        c, s = np.cos(yaw), np.sin(yaw)
        level = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
        momentum, rate = ((part.real.sum(axis=1).reshape(2, 3)) @ level.T for part in (given, -1j * omega * given))
        rate[1] += cross(velocity, momentum[0])
        return rate

    def complex_inertia(self, omega: np.ndarray) -> np.ndarray:
        """(6, n) A + i B / omega [kg], [kg m2] at frequencies (n,) [rad/s]; 1 for motions that the table lacks."""
        found, met = np.ones((6, len(omega)), dtype=complex), np.abs(omega)
        for number, added, lost in zip(self.numbers, self.added, self.lost, strict=True):
            found[number] = np.interp(met, self.omega, added) + 1j * np.sign(omega) * np.interp(met, self.omega, lost)
        return found

    def unit_wave_forces(self, omega: np.ndarray, heading: np.ndarray) -> np.ndarray:
        """(6, n) complex forces [N/m], [N m/m] of waves `omega` (n,) [rad/s], `heading` (n,) from the ship's [deg]."""
        headings, force = self.scattered
        angle, turned = heading % 360.0, np.ones((6, len(heading)))
        if headings.max() <= 180.0:
            beyond = angle > 180.0
            angle = np.where(beyond, 360.0 - angle, angle)
            turned = np.where(beyond, MIRROR_SIGNS[:, None], 1.0)
        found = np.zeros((6, len(omega)), dtype=complex)
        for number in self.numbers:
            by_heading = [np.interp(omega, self.omega, row) for row in force[number]]
            found[number] = at_headings(angle, headings, np.array(by_heading))
        return found * turned


def heading_gap(headings: np.ndarray) -> str:
    """Text on headings (h,) [deg] of a table that reach neither from 0 to 180 nor all round; empty if they do."""
    steps = np.diff(headings, append=headings[0] + 360.0)
    half = max(abs(headings[0]), abs(headings[-1] - 180.0)) < HEADING_TOLERANCE
    if half or (headings[-1] > 180.0 and steps[-1] <= steps[:-1].max() + HEADING_TOLERANCE):
        return ""
    radians = ": are they radians?" if 1.0 < headings[-1] < 2.0 * pi + 0.1 else ""
    return f"{f'{headings[0]:g} to ' if len(headings) > 1 else ''}{headings[-1]:g} degrees{radians}"


def at_headings(angle: np.ndarray, headings: np.ndarray, values: np.ndarray) -> np.ndarray:
    """(n,) values at `angle` (n,) [deg], each interpolated linearly in its column of `values` (h, n), whose rows are at
    `headings` (h,), all round if one is above 180; else constant beyond."""
    each = np.arange(len(angle))
    if headings[-1] > 180.0:
        headings, values = np.append(headings, headings[0] + 360.0), np.append(values, values[:1], axis=0)
        angle = np.where(angle < headings[0], angle + 360.0, angle)
    if len(headings) == 1:
        return values[0, each]
    at = np.clip(angle, headings[0], headings[-1])
    above = np.clip(np.searchsorted(headings, at), 1, len(headings) - 1)
    part = (at - headings[above - 1]) / (headings[above] - headings[above - 1])
    return (1.0 - part) * values[above - 1, each] + part * values[above, each]


def checked_table(file: str) -> BemTable:
    """Read a table and check that it suffices for radiated waves; raises ValueError if not, or as `read_bem_table`."""
    table = read_bem_table(file)
    omega, back = table.omega, np.flatnonzero(np.diff(table.omega, prepend=0.0) <= 0.0)
    if not MIN_FREQUENCIES <= len(omega) <= MAX_FREQUENCIES:
        raise FREQUENCY_RULE.broken(file, f"it has {len(omega)}")
    if len(back):
        raise FREQUENCY_RULE.broken(file, f"{omega[back[0]]:g} rad/s is the one in row {back[0] + 1}")
    own = table.damping[np.diag_indices(len(table.motions))]
    for name, least, most, last in zip(table.motions, own.min(axis=1), own.max(axis=1), own[:, -1]):
        if not most > 0.0 or least < -NEGATIVE_TOLERANCE * most:
            raise DAMPING_RULE.broken(file, f"that of {name} lies between {least:.3g} and {most:.3g}")
        if not last <= MAX_END_DAMPING * most:
            still = f"that of {name} still is {last / most:.0%} of its most"
            raise END_RULE.broken(file, f"at {omega[-1]:g} rad/s {still}")
    return table


class Memory:
    """Radiation force on one hull, from the stored history of her motion (Cummins 1962)."""

    def __init__(self, table: BemTable) -> None:
        self.impulse_response, self.numbers = table.impulse_response, np.array(table.numbers)
        self.pairs = np.argwhere(self.impulse_response.kernels.any(axis=2)).tolist()  # which motions act on which
        self.often = float(self.impulse_response.times[1])  # [s] at least between what is kept
        self.when, self.moved = np.zeros(0), np.zeros((0, len(table.numbers)))  # [s], [m/s] or [rad/s]

    def load(self, time: float, motion: np.ndarray) -> np.ndarray:
        """(2, 3) radiation force [N], torque [N m], body axes, at a time [s] and velocity `motion` (6,) through the
        water [m/s], [rad/s], in the order of `Motions`."""
        times = np.append(self.when, time)
        moved = np.concatenate([self.moved, motion[None, self.numbers]])
        known, ago, rate, momentum = self.impulse_response, time - times, np.zeros(6), np.zeros(6)
        for i, j in self.pairs:
            kernel = np.interp(ago, known.times, known.kernels[i, j], right=0.0)
            left = np.interp(ago, known.times, known.left[i, j], right=0.0)
            rate[self.numbers[i]] += np.trapezoid(kernel * moved[:, j], times)
            momentum[self.numbers[i]] += np.trapezoid(left * moved[:, j], times)
        v, omega, line, turn = motion[:3], motion[3:], momentum[:3], momentum[3:]
        return -rate.reshape(2, 3) - [cross(omega, line), cross(omega, turn) + cross(v, line)]

    def remember(self, time: float, motion: np.ndarray) -> None:
        """Store `motion`, as in `load`, at a time [s], if a step of the kernel has passed since the last."""
        if len(self.when) == 0 or time - self.when[-1] >= self.often * (1.0 - 1e-9):
            near = self.when >= time - self.impulse_response.times[-1] - self.often
            self.when = np.append(self.when[near], time)
            self.moved = np.concatenate([self.moved[near], motion[None, self.numbers]])
