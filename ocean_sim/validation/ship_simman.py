"""Ships that were measured: circles and zig-zags of KCS and KVLCC2 by their MMG coefficients, and KVLCC2's roll decay.

Circles and zig-zags begin at the measured approach speed, with the revolutions that keep it, in the wake of a model
(KVLCC2: 0.40, Yasukawa & Yoshimura 2015). The MMG model does not heel; KCS, with a GM of 0.6 m, heels by up to 18
degrees in these tests. The decay, with Ikeda's damping and added inertia by rule, is that of SSPA's model of 1:68
(Alexandersson, Mao & Ringsberg 2021, Ocean Eng.), on a hull of her length, breadth, draught, bilge and displacement,
and of her GM within 0.4 %: a prismatic middle body whose bottom rises towards narrower ends. No number is fitted.
"""

from functools import partial
from math import degrees, log, radians
from typing import Any, cast

import numpy as np

from ocean_sim.files import csv_file
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared import ship as ships
from ocean_sim.validation.shared.case import Curve, Finding, Number, Problem, Promise, absolute_error, percent_error
from ocean_sim.validation.shared.tables import table_path
from ocean_sim.validation.ship_turn import RUDDER_ANGLE, circle_values, preset_keys, sail_rows, zigzag_record

COARSE_TEST = "kvlcc2 zig-zag 20 port"
MODEL_WAKE = {"hull": [0.220, 0.40], "revolutions": 2.0}
TURN_TIME, ZIGZAG_TIME, SETTLED_TIME, DECAY_TIME = 1500.0, 600.0, 100.0, 170.0  # [s]
CIRCLE_TOLERANCES = {"advance": 8.0, "tactical diameter": 8.0, "speed left": 10.0}  # [%]
OVERSHOOT_TOLERANCE, OVERSHOOT_SHARE = 2.5, 0.2  # [deg], and the share of the overshoot where that is more
ROLL_TOLERANCES = {"period": 2.0, "decrement": 20.0}  # [%]
SAILED, ROLLED = "MARIN's free-running models (SIMMAN 2008, 2020)", "SSPA's model (Alexandersson et al. 2021)"
DECAYS = {  # speed [m/s], heel [deg] at first and 15 half swings later, period [s]
    "run 21337, at rest": (0.0, 9.573, 6.762, 20.92),
    "run 21338, at rest": (0.0, 10.417, 7.196, 20.91),
    "run 21340, 15.5 kn": (7.974, 9.840, 5.059, 20.95),
}
LENGTH, DRAUGHT, HEIGHT, END_BREADTH = 320.0, 20.8, 30.0, 20.0  # [m], the breadth of the ends at the water
MIDDLE_BODY = (58.0, HEIGHT, 3.60, 221.8, 312653.0e3, 18.6, 23.2)  # as `ship_of_section` takes it


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: one for each measured test; coarse: only COARSE_TEST."""
    rows = csv_file.read_records(table_path("simman_free_running").read_text(encoding="utf-8"))
    tests = [sailed_problem(row) for row in rows]
    return [test for test in tests if test.name == COARSE_TEST] if coarse else [*tests, decay_problem()]


def sailed_problem(row: dict[str, str]) -> Problem:
    """Set-up of one measured turning circle or zig-zag; `row`: its row in the table of measurements."""
    name, test, speed, *_ = row.values()
    ship = preset_keys(name)
    ship["mmg"]["propeller"] |= MODEL_WAKE if name == "kvlcc2" else {}
    ship |= {"velocity": [0.0, 0.0, float(speed)], "windage": None}
    measured = {key: float(value) for key, value in list(row.items())[3:] if value}
    promises = []
    for key, value in measured.items():
        limit = CIRCLE_TOLERANCES.get(key, max(OVERSHOOT_TOLERANCE, OVERSHOOT_SHARE * value))
        unit = "%" if key in CIRCLE_TOLERANCES else "deg"
        promises.append(Promise(f"{name}, {test}: {key}", unit, SAILED, {"manoeuvring": limit}))
    look = partial(measure_sailed, test=test, speed=float(speed), measured=list(measured.values()))
    scene = ships.at_sea(ship, LENGTH, 0.25)
    return Problem(scene, tuple(promises), look, f"{name} {test}", slot="ship", schemes=("manoeuvring",))


def measure_sailed(simulation: Simulation, test: str, speed: float, measured: list[float]) -> Finding:
    """Run a test, as `circle 35 port`, from a speed [m/s]; compare indices such as advance with `measured` ones."""
    (kind, angle, side), ship = test.split(), cast(Any, ships.ship_of(simulation))
    way, sailing = 1.0 if side == "port" else -1.0, (set_steady_throttle(ship, speed), 0.0)
    if kind == "circle":
        turn = lambda time, yaw: way * radians(RUDDER_ANGLE)
        rows = np.array(list(sail_rows(simulation, turn, TURN_TIME, *sailing)))
        found: list[Any] = circle_values(rows, ship.model.box[0], SETTLED_TIME)
        numbers = list(map(percent_error, (found[0], found[2], found[4] / speed), measured))
    else:
        rows, _, found = zigzag_record(simulation, float(angle), way, ZIGZAG_TIME, *sailing)
        numbers = list(map(absolute_error, found, measured))
    axes = ("x, to port [m]", "z, ahead [m]")
    return Finding(numbers, [Curve("track", rows[:, 1], rows[:, 2])], [], axes, equal_axes=kind == "circle")


def set_steady_throttle(ship: Any, speed: float) -> float:
    """Set her propeller to the revolutions that keep a speed [m/s] straight ahead; return that throttle."""
    from scipy.optimize import brentq

    motion, full = np.array([speed, *[0.0] * 5]), ship.model.ordered_revolutions(1.0, 0.0)
    drag = ship.model.drag_load(motion)[0]
    surplus = lambda n: drag + ship.model.driving_loads(motion, n * full, 0.0)["propeller"][0]
    throttle = float(brentq(surplus, 0.1, 2.0))
    ship.revolutions = throttle * full
    return throttle


def decay_problem() -> Problem:
    """Set-up of the roll decay tests DECAYS, one after another."""
    ship = ships.ship_of_section(*MIDDLE_BODY, cells=16)
    ends = [[END_BREADTH / 2.0, y, way * LENGTH / 2.0] for y in (DRAUGHT, HEIGHT) for way in (1.0, -1.0)]
    ship["hull"]["shape"]["points"] += ends
    ship |= {"free": ["roll", "surge"], "damping": {"cross_flow": 0.0, "surge": 0.0, "ikeda": {}}}
    limits = [(f"kvlcc2 {name}: {key}", limit) for name in DECAYS for key, limit in ROLL_TOLERANCES.items()]
    promises = tuple(Promise(words, "%", ROLLED, {"dynamic": limit}) for words, limit in limits)
    scene = ships.at_sea(ship, LENGTH, 0.1)
    return Problem(scene, promises, measure_decays, "roll decay", slot="ship", schemes=("dynamic",))


def measure_decays(simulation: Simulation) -> Finding:
    """Release the heeled ship, under way, for each of DECAYS; compare period and decrement of 15 half swings."""
    numbers, curves, upright = list[Number](), [], ships.ship_of(simulation).body.position
    for name, (speed, first, last, period) in DECAYS.items():
        pose, begin = {"position": upright, "orientation": ships.turn_quaternion(2, first)}, simulation.time
        ships.set_pose(simulation, **pose, velocity=np.array([0.0, 0.0, speed]))
        rows = [(t - begin, degrees(b.angles[2])) for t, b in ships.follow_body(simulation, begin + DECAY_TIME)]
        t, roll = np.array(rows).T
        turns = np.flatnonzero(np.diff(np.sign(np.diff(roll)))) + 1  # the first extreme is the heel at the start
        numbers.append(percent_error(ships.zero_crossing_period(t, roll), period))
        numbers.append(percent_error(log(first / abs(roll[turns[14]])), log(first / last)))
        curves.append(Curve(name, t, roll))
    return Finding(numbers, curves, [], ("t [s]", "roll [deg]"))
