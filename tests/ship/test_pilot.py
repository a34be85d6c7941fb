"""A pilot at the helm: waypoints by line of sight, a heading held against a drift, a speed, and what is refused."""

import numpy as np
import pytest

from ocean_sim.files.yaml_file import SceneError
from ocean_sim.reading.scene import load, observer_names
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.tables import table_path

SOUTH = {"route": [[0.0, 100.0]], "speed": 3.0}
QUIET = {name: None for name in observer_names() if name != "manifest"} | {"runtime.threads": 1}


def at_sea(ship: dict, **keys) -> dict:
    return {
        "duration": 200.0,
        "basin": {"length": 900.0, "width": 900.0, "depth": 50.0, "walls": "none"},
        "fluid": {"kind": "linear_waves", "height": 0.0, "period": 5.0},
        "time_step": {"kind": "fixed", "dt": 0.05},
        "ship": {"kind": "yacht", "cells_per_draught": 3.0} | ship,
    } | keys


def sailed(scene: dict, until: float) -> np.ndarray:
    """(5, n) time, x, z, yaw [deg], speed."""
    rows = []
    with Simulation(load(scene, QUIET)) as simulation:
        while simulation.time < until:
            simulation.step()
            body = simulation.ships["ship"].body
            speed = np.hypot(body.velocity[0], body.velocity[2])
            rows.append((simulation.time, body.position[0], body.position[2], np.degrees(body.angles[1]), speed))
    return np.array(rows).T


def test_it_sails_round_its_waypoints_and_on_along_the_last_leg():
    route = [[0.0, 150.0], [150.0, 150.0], [150.0, 0.0]]
    _, x, z, yaw, speed = sailed(at_sea({"helm": {"route": route, "speed": 4.0}, "velocity": [0.0, 0.0, 4.0]}), 180.0)
    passed = [np.hypot(x - px, z - pz) for px, pz in route]
    assert all(distance.min() < 15.0 for distance in passed)
    assert (np.diff([distance.argmin() for distance in passed]) > 0).all()
    np.testing.assert_allclose(x[-100:], 150.0, atol=1.5)  # a tenth of its length, five seconds long
    np.testing.assert_allclose(np.abs(yaw[-100:]), 180.0, atol=4.0)
    assert z[-1] < 0.0 and speed[-100:].mean() == pytest.approx(4.0, rel=0.02)


def test_a_waypoint_given_twice_is_one():
    """After the last one the ship goes on as on the last leg; a leg without a length turned her to +z."""
    once, twice = (
        sailed(at_sea({"helm": {"route": route, "speed": 4.0}, "velocity": [0.0, 0.0, 4.0]}), 30.0)
        for route in ([[0.0, 20.0], [40.0, 20.0]], [[0.0, 20.0], [0.0, 20.0], [40.0, 20.0], [40.0, 20.0]])
    )
    np.testing.assert_array_equal(once, twice)


def test_where_the_only_waypoint_is_where_she_begins_she_goes_on_as_she_heads():
    """A leg without a length turned her to +z."""
    ship = {"helm": {"route": [[3.0, -2.0]], "speed": 4.0}, "position": [3.0, -2.0], "heading_deg": 90.0}
    _, x, z, yaw, _ = sailed(at_sea(ship), 20.0)
    np.testing.assert_allclose(yaw, 90.0, atol=0.1)
    assert x[-1] > 30.0 and z[-1] == pytest.approx(-2.0, abs=0.01)


def test_it_holds_a_heading_and_a_leg_against_a_wind_from_the_side():
    wind = {"kind": "stress", "u10": 15.0, "heading_deg": 90.0, "targets": ["ship"]}
    away = {"position": [20.0, 0.0], "velocity": [0.0, 0.0, 4.0]}
    held = {"helm": {"heading_deg": 30.0, "speed": 4.0}} | away
    _, _, _, yaw, speed = sailed(at_sea(held, wind=wind), 60.0)
    assert yaw[-200:].mean() == pytest.approx(30.0, abs=0.5) and speed[-1] == pytest.approx(4.0, rel=0.03)
    leg = {"helm": {"route": [[20.0, 2000.0]], "speed": 4.0}} | away
    _, x, _, _, _ = sailed(at_sea(leg, wind=wind), 150.0)
    assert np.abs(x[-400:] - 20.0).max() < 0.5


def test_a_pilot_who_is_told_a_route_on_the_way_keeps_the_speed_and_arrives_a_length_before():
    with Simulation(load(at_sea({"velocity": [0.0, 0.0, 3.0]}), QUIET)) as simulation:
        simulation.run(1.0)
        ship = simulation.ships["ship"]
        pilot = ship.sail([(0.0, 60.0), (40.0, 100.0)], 3.0)
        passed = []
        while not pilot.has_arrived(ship.body) and simulation.time < 90.0:
            simulation.step()
            if len(passed) < pilot.leg:
                passed.append(ship.body.position[[0, 2]])
        length = np.ptp(ship.drawn()[0][:, 2])
        assert pilot.near == length and passed[0][1] == pytest.approx(60.0 - length, abs=0.5)
        assert np.hypot(*(ship.body.position[[0, 2]] - [40.0, 100.0])) == pytest.approx(length, rel=0.1)
        assert np.hypot(*ship.body.velocity[[0, 2]]) == pytest.approx(3.0, rel=0.1)
        assert pilot.ahead == [(40.0, 100.0)]


def test_orders_that_come_when_the_run_is_over_are_told(tmp_path):
    """A log with the times of a calendar: its first row holds from the beginning to the end."""
    path = tmp_path / "orders.csv"
    path.write_text("time_s,throttle,rudder_rad\n1700000000,0.5,0.1\n1700000100,0.8,0.0\n")
    said = "controls begins at 1700000000 s, when the run of 200 s is over: only its first row holds"
    assert any(said in warning for warning in load(at_sea({"controls": {"file": str(path)}})).warnings())
    bounded = {"thrust": 1.0e4, "zero_thrust_speed": 6.0, "wake": 0.25}  # at 8 m/s
    ships = [{"propeller": bounded, "helm": {"heading_deg": 0.0, "speed": speed}} for speed in (7.9, 8.1)]
    fast = [load(at_sea(ship)).warnings() for ship in ships]
    assert [any("at which her propeller gives no thrust" in told for told in found) for found in fast] == [False, True]
    rows = [{"time": 199.0, "throttle": 0.5}]
    assert not any("controls" in warning for warning in load(at_sea({"controls": rows})).warnings())


@pytest.mark.parametrize(
    "ship, sentence",
    [
        ({"helm": {"speed": 4.0}}, "give either a route or a heading_deg"),
        ({"helm": {"route": [[0.0, 9.0]], "heading_deg": 3.0, "speed": 4.0}}, "give either a route or a heading_deg"),
        ({"helm": {"route": [], "speed": 4.0}}, "route"),
        ({"helm": {"heading_deg": 3.0, "speed": 4.0}, "controls": [{"time": 0.0}]}, "leave one of them out"),
        ({"helm": SOUTH, "propeller": None}, "ship.helm: asks for 3 m/s, but she has no propeller"),
        ({"helm": SOUTH, "rudder": None}, "ship.helm: asks for a heading or a route, but she has no rudder"),
        ({"helm": SOUTH, "free": ["yaw", "sway"]}, "ship.helm: asks for 3 m/s, but her surge is held; add surge"),
        ({"controls": {"autopilot": {"heading_deg": 3.0}}, "rudder": None}, "ship.controls: asks for a heading, but"),
    ],
)
def test_what_cannot_be_steered_is_refused(ship, sentence):
    with pytest.raises(SceneError) as refused:
        load(at_sea(ship))
    assert any(sentence in str(problem) for problem in refused.value.problems), refused.value


@pytest.mark.parametrize(
    "ship",
    [
        {"helm": SOUTH},
        {
            "helm": {"heading_deg": 0.0, "speed": 3.0},
            "rudder": None,
            "free": ["surge", "heave", "pitch"],
        },  # a straight line
        {"kind": "otter", "helm": SOUTH},  # steers by two propellers of its own
        {"controls": [{"time": 0.0, "throttle": 0.5, "rudder": 0.1}], "propeller": None},  # said, see test_idle
    ],
)
def test_what_can_be_steered_is_taken(ship):
    whole = at_sea(ship)
    if ship.get("kind") == "otter":
        del whole["ship"]["cells_per_draught"]
    assert load(whole).ships["ship"]


def test_radiation_on_particles_is_refused_as_they_radiate_already():
    ship = {"kind": "dynamic", "hull": "barge20", "radiation": str(table_path("barge20_radiation"))}
    water = {"kind": "mueller", "spacing": 4.0}
    basin = {"length": 60.0, "width": 60.0, "depth": 12.0}
    with pytest.raises(SceneError, match="would count them twice"):
        load({"basin": basin, "fluid": water, "surface": "cloth", "ship": ship})
