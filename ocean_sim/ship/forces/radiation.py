"""The waves that a hull makes and goes on feeling: its radiation force, from added mass and damping over frequency.

A motion's force is -A(infinity) times its acceleration, less the integral of K(t - tau) times its velocity (Cummins
1962, Schiffstechnik 9), with Ogilvie's relations (1964, 5th Symposium on Naval Hydrodynamics)
K(t) = 2/pi int B(omega) cos(omega t) d omega and A(infinity) = A(omega) + 1/omega int K(t) sin(omega t) dt.
Where a table says so, motions act on each other: A, B and K are then symmetric matrices.

What has been left in the waves is a momentum, the integral of L(t - tau) times the velocity with L(t) = -int K from t
on, and the force is less its rate. A hull that moves on through the water at v is turned by it, by -v x momentum, as
Kirchhoff's equations have it of A(infinity). In heave and pitch at a speed U these are strip theory's terms of speed,
U A33, U B33 / omega^2 and U^2 / omega^2 times both (Salvesen, Tuck & Faltinsen 1970, Trans. SNAME 78, table 1, without
those of a transom), omega being the frequency at which she meets the waves.
"""

from functools import cached_property
from itertools import combinations_with_replacement
from math import pi
from typing import NamedTuple

import numpy as np

from ocean_sim.conventions import Motions
from ocean_sim.files.input_file import Checked, Rule
from ocean_sim.ship.body.rigid_body import cross
from ocean_sim.ship.forces.bem_table import Scattering, bem_table

LEFT = 0.25  # of the largest damping: what may be left at the highest frequency
FEWEST, MOST = 4, 300  # frequencies
NEGATIVE = 0.25  # of the largest damping: what the irregular frequencies of a panel method may be below 0
FREQUENCIES = Rule(f"there are {FEWEST} to {MOST} frequencies above 0, which rise, each once")
DAMPED = Rule("damping is above 0, or there are no waves to remember; of the other sign it is of another convention")
FALLEN = Rule(f"damping has fallen below {LEFT:.0%} of its most at the highest frequency; let the table go on")
CHECKS = (Checked("Added mass and damping, `ship.radiation`: a table", (FREQUENCIES, DAMPED, FALLEN)),)
FINE = 20  # points of K in a period of the highest frequency, and of B between two frequencies
TAIL = 3.0  # [highest frequencies] to which damping is carried on
GIVEN = 0.05  # share of the largest damping, or of added mass, that a matrix may lie below zero by error
LOST = 0.003  # of the largest K: what is forgotten


class Response(NamedTuple):
    """What some motions leave behind in the water."""

    times: np.ndarray  # (n,) since a push [s]
    kernels: np.ndarray  # (m, m, n) K [kg/s2], [kg m/s2], [kg m2/s2]
    left: np.ndarray  # (m, m, n) L [kg/s], [kg m/s], [kg m2/s]
    added: np.ndarray  # (m, m) A(infinity) [kg], [kg m], [kg m2]


class Radiation:
    """What a file gives for some motions: `omega_rad_s`, and `heave_added_kg`, `heave_damping_kg_s`,
    `pitch_added_kg_m2`, `pitch_damping_kg_m2_s` and the like, of any of the six, and of two that act on each other
    `heave_pitch_added_kg_m`, `heave_pitch_damping_kg_m_s`; or Capytaine's NetCDF.

    Raises ValueError where it gives too little.
    """

    def __init__(self, file: str) -> None:
        table = bem_table(file)
        self.numbers = [Motions._fields.index(motion) for motion in table.motions]
        omega, back = table.omega, np.flatnonzero(np.diff(table.omega, prepend=0.0) <= 0.0)
        if not FEWEST <= len(omega) <= MOST:
            raise FREQUENCIES.broken(file, f"it has {len(omega)}")
        if len(back):
            raise FREQUENCIES.broken(file, f"{omega[back[0]]:g} rad/s is the one in row {back[0] + 1}")
        self.omega, self.mass, self.damping = omega, table.added, table.damping
        self.scattering = None if table.scattered is None else Scattering(table)
        self.depth, self.axis = table.depth, table.axis
        names, own = table.motions, self.damping[np.diag_indices(len(table.motions))]
        for name, least, most, last in zip(names, own.min(axis=1), own.max(axis=1), own[:, -1]):
            if not most > 0.0 or least < -NEGATIVE * most:
                raise DAMPED.broken(file, f"that of {name} lies between {least:.3g} and {most:.3g}")
            if not last <= LEFT * most:
                still = f"that of {name} still is {last / most:.0%} of its most"
                raise FALLEN.broken(file, f"at {omega[-1]:g} rad/s {still}")

    def couples(self, one: str, other: str) -> bool:
        """True if the table has what one motion does to another."""
        pair = tuple(self.numbers.index(Motions._fields.index(motion)) for motion in (one, other))
        return bool(self.mass[pair].any() or self.damping[pair].any())

    @property
    def doubts(self) -> list[str]:
        """Entries that no hull has: waves that would give energy, water of less than no mass."""
        own, found = np.diag_indices(len(self.numbers)), list[str]()
        most = np.sqrt(np.abs(self.damping[own]).max(axis=1))
        lowest = np.linalg.eigvalsh(np.moveaxis(self.damping, 2, 0) / np.outer(most, most))[:, 0]
        if lowest.min() < -GIVEN:
            at = self.omega[lowest.argmin()]
            found.append(f"the damping of the table would give energy at {at:g} rad/s, which no hull's waves do")
        added = self.response.added
        most = np.sqrt(np.maximum(np.abs(added[own]), 1e-300))
        if np.linalg.eigvalsh(added / np.outer(most, most))[0] < -GIVEN or (added[own] <= 0.0).any():
            values = ", ".join(f"{Motions._fields[k]} {x:.3g}" for k, x in zip(self.numbers, added[own]))
            found.append(f"the added mass of quick motions ({values}) is no water's: below zero, or tied to too much")
        return found

    @cached_property
    def response(self) -> "Response":
        """To a push, until less than LOST is left of it."""
        from scipy.integrate import cumulative_trapezoid

        omega, apart = self.omega, np.diff(self.omega, prepend=0.0).max()
        times = np.arange(0.0, 2.0 * pi / apart, 2.0 * pi / omega[-1] / FINE)
        m = len(self.numbers)
        kernels, added = np.zeros((m, m, len(times))), np.zeros((m, m))
        for i, j in combinations_with_replacement(range(m), 2):
            if self.damping[i, j].any():
                kernels[i, j] = kernels[j, i] = self.kernel(times, self.damping[i, j])
            sines = np.trapezoid(kernels[i, j] * np.sin(omega[:, None] * times), times, axis=1)
            added[i, j] = added[j, i] = np.median(self.mass[i, j] + sines / omega)
        most = np.sqrt(np.abs(kernels[np.diag_indices(m)]).max(axis=1))
        kernels[np.abs(kernels).max(axis=2) <= LOST * np.outer(most, most)] = 0.0  # of a symmetric hull: noise
        kept = (np.abs(kernels) / np.outer(most, most)[:, :, None]).max(axis=(0, 1)) > LOST
        last = int(np.flatnonzero(kept)[-1]) + 1
        times, kernels = times[:last], kernels[:, :, :last]
        whole = cumulative_trapezoid(kernels, times, initial=0.0)
        return Response(times, kernels, whole - whole[:, :, -1:], added)

    def kernel(self, times: np.ndarray, damping: np.ndarray) -> np.ndarray:
        """K at some times [s]; beyond the table damping falls on as it did at its end, by a power of the frequency."""
        from scipy.interpolate import PchipInterpolator

        omega = self.omega
        count = FINE * len(omega)
        within = np.linspace(0.0, omega[-1], count)
        beyond = np.linspace(omega[-1], TAIL * omega[-1], int((TAIL - 1.0) * count))[1:]
        ends = np.maximum(np.abs(damping[-2:]), 1e-12 * np.abs(damping).max())
        power = max(2.0, -float(np.diff(np.log(ends))[0] / np.diff(np.log(omega[-2:]))[0]))
        known = PchipInterpolator(np.append(0.0, omega), np.append(0.0, damping))(within)
        every, falling = np.append(within, beyond), np.copysign(ends[-1], damping[-1]) * (omega[-1] / beyond) ** power
        whole = np.append(known, falling)
        return np.array([2.0 / pi * np.trapezoid(whole * np.cos(every * t), every) for t in times])


class Memory:
    """The radiation force on one hull: what it remembers of its motions."""

    def __init__(self, radiation: Radiation) -> None:
        self.response, self.numbers = radiation.response, np.array(radiation.numbers)
        self.pairs = np.argwhere(self.response.kernels.any(axis=2)).tolist()  # which motions act on which
        self.often = float(self.response.times[1])  # [s] at least between what is kept
        self.when, self.moved = np.zeros(0), np.zeros((0, len(radiation.numbers)))  # [s], [m/s] or [rad/s]

    def load(self, time: float, motion: np.ndarray) -> np.ndarray:
        """(2, 3) force [N] and torque [N m] in body axes, at a velocity relative to the water (6,), body axes."""
        times = np.append(self.when, time)
        moved = np.concatenate([self.moved, motion[None, self.numbers]])
        known, ago, rate, momentum = self.response, time - times, np.zeros(6), np.zeros(6)
        for i, j in self.pairs:
            kernel = np.interp(ago, known.times, known.kernels[i, j], right=0.0)
            left = np.interp(ago, known.times, known.left[i, j], right=0.0)
            rate[self.numbers[i]] += np.trapezoid(kernel * moved[:, j], times)
            momentum[self.numbers[i]] += np.trapezoid(left * moved[:, j], times)
        v, omega, line, turn = motion[:3], motion[3:], momentum[:3], momentum[3:]
        return -rate.reshape(2, 3) - [cross(omega, line), cross(omega, turn) + cross(v, line)]

    def keep(self, time: float, motion: np.ndarray) -> None:
        """Remember this velocity (6,), if the last one was long enough ago."""
        if len(self.when) == 0 or time - self.when[-1] >= self.often * (1.0 - 1e-9):
            near = self.when >= time - self.response.times[-1] - self.often
            self.when = np.append(self.when[near], time)
            self.moved = np.concatenate([self.moved[near], motion[None, self.numbers]])
