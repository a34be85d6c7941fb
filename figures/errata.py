"""What the thesis prints, what this program uses instead, and the difference, measured: CSV on standard output.

python figures/errata.py
"""

import csv
import sys
from math import sqrt
from typing import NamedTuple

import numpy as np

from ocean_sim.conventions import AIR_DENSITY
from ocean_sim.fluid._smoothing import Smoothing
from ocean_sim.random_numbers import numpy_uniform3
from ocean_sim.wind._air_load import drag_coefficient, stress


class Erratum(NamedTuple):
    """One place of the thesis, by a number that shows it."""

    where: str
    quantity: str
    unit: str
    as_printed: float
    corrected: float
    difference: float
    why: str


def erratum(where: str, quantity: str, unit: str, as_printed: float, corrected: float, why: str) -> Erratum:
    return Erratum(where, quantity, unit, as_printed, corrected, as_printed - corrected, why)


def pressure_forces(symmetric: bool) -> np.ndarray:
    """Forces [N] on two particles of 1953 kg, 1 m apart, of unlike pressure: (2.14), or (2.16) where symmetric."""
    smoothing, apart, mass = Smoothing(3, support=2.5), 1.0, 1953.125
    density, pressure = np.array([1000.0, 1010.0]), np.array([10e3, 60e3])
    slope = -3.0 * smoothing.spiky_constant * (smoothing.support - apart) ** 2  # dW/dr of the spiky kernel
    other = pressure[::-1]
    p = (pressure + other) / 2.0 if symmetric else other
    per_volume = -mass * p / density[::-1] * slope * np.array([-1.0, 1.0])
    return per_volume * mass / density


def momentum_error(forces: np.ndarray) -> float:
    """Sum of the forces over their sum without signs: zero where action equals reaction."""
    return float(abs(forces.sum()) / np.abs(forces).sum())


def stirred(dt: float, lasts: float, particles: int = 5000) -> float:
    """Variance of the velocity after 1 s of the listing's noise of 30 m/s2 [m2/s2]: steps of dt, draws that last."""
    time = np.arange(round(1.0 / dt)) * dt
    velocity = np.zeros((particles, 3))
    for draw in (time / lasts + 1e-6).astype(int):
        velocity += dt * 30.0 * numpy_uniform3(7, 0, np.arange(particles), draw)
    return float(velocity.var())


def errata() -> list[Erratum]:
    wind, lift_coefficient = 10.0, 1.0e-3
    lift = 0.5 * AIR_DENSITY * wind**2 * lift_coefficient
    step = 1.0 / 60.0
    return [
        erratum(
            "(2.14), (2.27)",
            "momentum made by the pressure of two particles, over the sum of its forces",
            "1",
            momentum_error(pressure_forces(symmetric=False)),
            momentum_error(pressure_forces(symmetric=True)),
            "(2.27) goes back to the pressure of one side; the symmetric (2.16) obeys Newton's third law",
        ),
        erratum(
            "(2.20), (2.22)",
            "stress of a wind of 10 m/s",
            "Pa",
            0.5 * AIR_DENSITY * drag_coefficient(wind) * wind**2,
            stress(wind),
            "(2.22) halves the stress (2.20) that it is set equal to; C_d (2.21) was measured without the half",
        ),
        erratum(
            "(2.22), v",
            "stress of a wind of 10 m/s on water that moves along at 5 m/s",
            "Pa",
            stress(wind),
            stress(wind - 5.0),
            "section 2.3 takes the wind's speed for the relative one",
        ),
        erratum(
            "(2.23)",
            "lift on 1 m2 in a wind of 10 m/s, C_L 0.001, along wind x across",
            "N",
            -lift,
            lift,
            "the minus sign makes the direction that section 2.3 constructs point into the water",
        ),
        erratum(
            "(2.24)",
            "spread of the velocity after 1 s of noise of 30 m/s2, at steps of 1/120 s over that at 1/60 s",
            "1",
            sqrt(stirred(step / 2, step / 2) / stirred(step, step)),
            sqrt(stirred(step / 2, step) / stirred(step, step)),
            "a new draw each step stirs less the shorter the step, its variance falls by half; our draws last 1/60 s",
        ),
    ]


def main() -> None:
    table = csv.writer(sys.stdout, lineterminator="\n")
    table.writerow(Erratum._fields)
    for row in errata():
        table.writerow(f"{value:.6g}" if isinstance(value, float) else value for value in row)


if __name__ == "__main__":
    main()
