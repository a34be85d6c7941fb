"""Cylinders forced to roll in a slice of particles: damping against that measured by Ikeda, Himeno & Tanaka (1978).

A rectangle (A), and one with slightly round bilges (B), 0.28 m broad and 0.112 m deep, turn by phi sin(omega t) about
the middle of the still waterline. A linear torque -B44 dphi/dt [N m a metre] would take pi omega phi^2 B44 [J a metre]
in a cycle. So B44 [N m s a metre] is the work against the torque of the particles over whole cycles, divided by
pi omega phi^2 and their number. It is given over rho S B^2 sqrt(2 g / B), [kg/m] [m2] [1/s], with S [m2] the area of
the section under water. Eddies at the bilges are 86 to 95 % of the measured damping. No row has a tolerance.
"""

from functools import partial
from math import pi, sqrt
from typing import NamedTuple

import numpy as np

from ocean_sim.conventions import GRAVITY, WATER_DENSITY
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, percent_error
from ocean_sim.validation.shared.ship import impose_motion, ramped_swing, ship_of, ship_of_section

SECTION_BREADTH, SECTION_DRAUGHT, SECTION_HEIGHT = 0.28, 0.112, 0.224  # [m]
RATE_SCALE = sqrt(2.0 * GRAVITY / SECTION_BREADTH)  # [rad/s]
BOX_MASS = WATER_DENSITY * SECTION_BREADTH * SECTION_DRAUGHT  # [kg] of water that a metre of A displaces
TANK_LENGTH, TANK_DEPTH, ABSORBING_ZONE = 2.4, 0.36, {"kind": "absorbing", "length": 0.7}  # [m]
BREADTH_SPACINGS = 40
START_CYCLES, JUDGED_CYCLES = 2, 2  # the swing grows over the first
SOURCE_TEXT = "Ikeda, Himeno & Tanaka (1978), measured"


class Swing(NamedTuple):
    """A forced roll of one of the sections (cylinders), and its measured damping."""

    model: str
    area_coefficient: float  # S / (B d)
    amplitude: float  # phi [rad]
    rate: float  # omega sqrt(B / 2 g)
    damping: float  # total, over rho S B^2 sqrt(2 g / B)

    @property
    def omega(self) -> float:
        return self.rate * RATE_SCALE


MEASURED_SWINGS = (
    Swing("A", 1.0, 0.23, 0.751, 0.0411694),
    Swing("A", 1.0, 0.24, 0.507, 0.0298034),
    Swing("B", 0.997, 0.30, 0.751, 0.0239657),
)


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: the forced rolls of MEASURED_SWINGS; none if coarse."""
    return [] if coarse else [roll_problem(swing) for swing in MEASURED_SWINGS]


def roll_problem(swing: Swing) -> Problem:
    """Set-up of a section forced to roll between absorbing zones; its centre of mass is in the waterline. The bilge
    radius r follows from the area that the two bilges lack, 2 (1 - pi / 4) r^2."""
    name = f"{swing.model}, omega {swing.rate:g}"
    missing = (1.0 - swing.area_coefficient) * SECTION_BREADTH * SECTION_DRAUGHT
    promise = Promise(f"{name}: roll damping [rho S B^2 sqrt(2 g / B)]", "%", SOURCE_TEXT)
    bilge, mass = sqrt(missing / (2.0 - 0.5 * pi)), swing.area_coefficient * BOX_MASS
    section = ship_of_section(
        SECTION_BREADTH, SECTION_HEIGHT, bilge, 1.0, mass, SECTION_DRAUGHT, 0.35 * SECTION_BREADTH, cells=10
    )
    scene = {
        "duration": (START_CYCLES + JUDGED_CYCLES) * 2.0 * pi / swing.omega,
        "basin": {"length": TANK_LENGTH, "depth": TANK_DEPTH, "walls": {"x": ABSORBING_ZONE}},
        "fluid": {"kind": "delta_sph", "spacing": SECTION_BREADTH / BREADTH_SPACINGS, "compression": 0.02},
        "ship": section | {"free": ["roll"]},
    }
    return Problem(scene, (promise,), partial(measure_damping, swing=swing), name, True, "ship", ("pressure",))


def measure_damping(simulation: Simulation, swing: Swing) -> Finding:
    """Force the cylinder to roll by `swing`; compare its linear-equivalent damping in the last cycles with Ikeda's."""
    ship, rows, end, period = ship_of(simulation), [], simulation.scene.duration, 2.0 * pi / swing.omega
    while simulation.time < end:
        simulation.step()
        moved = ramped_swing(simulation.time, swing.amplitude, swing.omega, period)
        rows.append((simulation.time, moved.place, ship.last.torque[2]))
        impose_motion(simulation, 5, moved)
    t, roll, torque = np.array(rows).T
    unit = swing.area_coefficient * BOX_MASS * SECTION_BREADTH**2 * RATE_SCALE  # [N m s] of B44
    spent = -np.cumsum(torque * np.diff(roll, prepend=0.0)) / (pi * swing.omega * swing.amplitude**2 * unit)
    begun, ended = np.interp([START_CYCLES * period, end], t, spent)
    cycles = t / period
    late = cycles > START_CYCLES
    measured = Curve("particles", cycles, spent)
    expected = Curve("measured", cycles[late], begun + swing.damping * (cycles[late] - START_CYCLES))
    found = percent_error(float(ended - begun) / JUDGED_CYCLES, swing.damping)
    return Finding([found], [measured], [expected], ("t / T", "work [pi omega phi^2 rho S B^2 sqrt(2 g / B)]"))
