"""A ship that turns, drifts and rolls as one: lift and Munk's moment, heel in a turn, waves from abeam, added mass."""

from itertools import pairwise
from math import pi

import numpy as np
import pytest

from ocean_sim.reading.scene import load, observer_names
from ocean_sim.ship.forces.added_mass import by_rule
from ocean_sim.ship.forces.damping import Damping, Resistance
from ocean_sim.ship.forces.propulsion import SLIPSTREAM_SHARE, Propeller, Rudder
from ocean_sim.ship.hull.hull import Hull, hull_of
from ocean_sim.simulation import Simulation
from tests.conftest import quickly

QUIET = {name: None for name in observer_names() if name != "manifest"} | {"runtime.threads": 1}
KINDS = ("hydrostatic", "dynamic")


def at_sea(ship: dict, **fluid) -> dict:
    return {
        "duration": 100.0,
        "basin": {"length": 900.0, "width": 900.0, "depth": 200.0, "walls": "none"},
        "fluid": {"kind": "linear_waves", "height": 0.0, "period": 5.0} | fluid,
        "time_step": {"kind": "fixed", "dt": 0.05},
        "ship": {"kind": "yacht", "cells_per_draught": 3.0} | ship,
    }


def test_roll_moves_as_much_water_as_a_panel_method_says_of_a_barge_and_none_of_a_round_one():
    barge = by_rule(hull_of("barge20").in_still_water(8.0, 1000.0, 9.81))
    assert barge[5] == pytest.approx(1167.8e3, rel=0.03)  # [kg m2] Capytaine at the natural frequency
    shape = {"kind": "cylinder", "length": 6.0, "radius": 1.0}
    log = Hull.model_validate({"shape": shape, "mass": 3000.0 * pi}).in_still_water(8.0, 1000.0, 9.81)
    plate = 6.0 * 1000.0 * pi / 16.0
    assert by_rule(log)[5] < 0.02 * plate


@pytest.mark.parametrize("kind", KINDS)
def test_a_hull_that_drifts_under_way_is_turned_further_and_lifted_back(kind):
    """Munk's moment less that of the lift at the stern: at small drift the hull turns into it, in both kinds alike."""
    still = hull_of("yacht").in_still_water(4.0, 1000.0, 9.81)
    sway, _, surge = by_rule(still)[:3]
    ahead, aside = 6.0, 0.01
    munk = -(sway - surge) * ahead * aside
    bare = Resistance(Damping(cross_flow=0.0), still, np.zeros(6))
    lifted = Resistance(Damping(cross_flow=0.0), still, np.zeros(6), munk=sway - surge)
    motion = np.array([aside, 0.0, ahead, 0.0, 0.0, 0.0])
    assert lifted.load(motion)[1, 1] - bare.load(motion)[1, 1] == pytest.approx(munk)
    assert munk < lifted.load(motion)[1, 1] < 0.0
    ship = {"kind": kind, "hull": "yacht", "velocity": [aside, 0.0, ahead], "damping": {"cross_flow": 0.0}}
    with Simulation(load(at_sea(ship), QUIET | {"runtime.precision": "f64"})) as simulation:
        simulation.step()
        parts = dict(zip(simulation.ships["ship"].parts, simulation.ships["ship"].last.parts, strict=True))
        whole = 1.0 + simulation.ships["ship"].added[4] / simulation.ships["ship"].body.inertia_body[1, 1]
        assert parts["damping"][1, 1] * whole == pytest.approx(lifted.load(motion)[1, 1], rel=0.05)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_it_heels_outwards_in_a_turn(way):
    """To starboard in a turn to port, and the other way round: the water pushes below, the weight pulls above."""
    controls = [{"time": 0.0, "throttle": 1.0, "rudder": 0.6 * way}]
    ship = {"velocity": [0.0, 0.0, 5.5], "controls": controls}
    with Simulation(load(at_sea(ship), QUIET)) as simulation:
        rolls = []
        while simulation.time < 25.0:
            simulation.step()
            if simulation.time > 15.0:
                rolls.append(np.degrees(simulation.ships["ship"].body.angles[2]))
        assert way * simulation.ships["ship"].body.rates[1] > 0.05
        assert 1.0 < way * np.mean(rolls) < 8.0


@pytest.mark.parametrize("kind", quickly(*KINDS))
def test_waves_from_abeam_do_not_turn_it_about(kind):
    """What damps it acts on its motion through the water: dragged over the ground it yaws by more than 30 degrees."""
    ship = {"kind": kind, "hull": "yacht", "damping": {"heave": 0.15, "pitch": 0.15, "roll": 0.08, "surge": 400.0}}
    with Simulation(load(at_sea(ship, height=1.0, period=5.0, heading_deg=90.0), QUIET)) as simulation:
        yaws = []
        while simulation.time < 100.0:
            simulation.step()
            yaws.append(np.degrees(simulation.ships["ship"].body.angles[1]))
        assert np.abs(yaws).max() < 20.0


def test_a_slipstream_has_the_momentum_of_its_thrust_and_only_a_propeller_with_a_diameter_has_one():
    screw = Propeller(thrust=14400.0, diameter=0.8)
    far = (screw.slipstream_speed(14400.0, 6.0, 1000.0) - 6.0) / SLIPSTREAM_SHARE + 6.0
    through = 0.5 * (far + 6.0) * 1000.0 * pi / 4.0 * 0.8**2  # [kg/s]
    assert through * (far - 6.0) == pytest.approx(14400.0)
    assert screw.slipstream_speed(-7200.0, 6.0, 1000.0) == 6.0
    assert Propeller(thrust=14400.0).slipstream_speed(14400.0, 6.0, 1000.0) == 6.0
    blade = Rudder(area=1.0, aspect_ratio=1.0, position=(0.0, 0.5, -6.8))
    mean = blade.mean_inflow(screw, 9.0, 6.0)
    assert mean**2 == pytest.approx(0.8 * 81.0 + 0.2 * 36.0)


def test_the_otter_takes_steps_of_second_order_from_any_start():
    """From rest and under way, with orders that rise: half the step is a quarter of the error; it was half."""
    rows = [{"time": 0.0, "throttle": 0.6}, {"time": 3.0, "throttle": 0.6, "rudder": 0.3}]
    for start in ({}, {"velocity": [0.3, 0.0, 1.5], "rates": [0.0, 0.2, 0.0]}):
        scene = at_sea({"controls": rows} | start)
        scene["ship"] = {"kind": "otter", "controls": rows} | start
        ends = []
        for dt in (0.04, 0.02, 0.01):
            with Simulation(load(scene | {"time_step": {"kind": "fixed", "dt": dt}}, QUIET)) as simulation:
                for _ in range(round(8.0 / dt)):
                    simulation.step()
                ends.append(simulation.ships["ship"].body.position)
        first, second = (float(np.linalg.norm(a - b)) for a, b in pairwise(ends))
        assert 3.0 < first / second < 5.0 and second < 3e-3
