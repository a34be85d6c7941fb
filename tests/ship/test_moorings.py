"""Lines and fenders: what pulls and what pushes, the period and energy of a moored barge, its column in motion.csv."""

from math import pi, sqrt

import numpy as np
import pytest

from ocean_sim.files.yaml_file import SceneError
from ocean_sim.observers import motion as motion_observer
from ocean_sim.reading.scene import load, observer_names
from ocean_sim.ship import PARTS
from ocean_sim.ship.body.rigid_body import RigidBody, euler_quaternion
from ocean_sim.ship.forces.moorings import Mooring, Moorings
from ocean_sim.simulation import Simulation

QUIET = {name: None for name in observer_names() if name != "manifest"} | {"runtime.threads": 1}
STIFF = 4.0e4  # [N/m]


def moored(moorings: list, **ship) -> dict:
    """A barge in calm deep water, whose surge nothing but the moorings holds."""
    keys = {"hull": "barge20", "cells_per_draught": 4.0, "free": ["surge"], "damping": {"surge": 0.0}}
    return {
        "duration": 60.0,
        "basin": {"length": 200.0, "width": 200.0, "depth": 50.0, "walls": "none"},
        "fluid": {"kind": "linear_waves", "height": 0.0, "period": 5.0},
        "time_step": {"kind": "fixed", "dt": 0.02},
        "runtime": {"threads": 1, "precision": "f64"},
        "ship": {"kind": "dynamic", **keys, "moorings": moorings, **ship},
    }


def spring(z: float, to: float, **keys) -> dict:
    """From the barge's ends along its length, at the height of its centre of mass."""
    return {"from": [0.0, 2.5, z], "to": [0.0, 0.5, to], "stiffness": STIFF, **keys}


def body(z: float = 0.0, speed: float = 0.0) -> RigidBody:
    still = np.zeros(3)
    turn = euler_quaternion(0.0, 0.0, 0.0)
    return RigidBody(1.0, np.eye(3), np.array([0.0, 0.0, z]), turn, np.array([0.0, 0.0, speed]), still)


def stored_energy(moorings, body) -> float:
    """Elastic energy [J] of all lines and fenders."""
    stretched = moorings.pulls * (np.linalg.norm(moorings.line_spans(body), axis=1) - moorings.slack)
    return 0.5 * float((moorings.stiffness * np.maximum(stretched, 0.0) ** 2).sum())


def test_a_line_only_pulls_and_a_fender_only_pushes():
    keys = {"from": (0.0, 0.0, 0.0), "to": (0.0, 0.0, 10.0), "stiffness": 100.0, "slack_length": 8.0}
    for kind, held, free, way in (("line", 0.0, 5.0, 1.0), ("fender", 5.0, 0.0, -1.0)):
        one = Moorings([Mooring(kind=kind, **keys)], {}, np.zeros(3), body())
        assert one.load(body(held))[0, 2] == pytest.approx(way * 100.0 * abs(10.0 - held - 8.0))
        assert np.abs(one.load(body(free))).max() == 0.0
        h = 1e-5  # a force is the slope of what is stored
        slope = (stored_energy(one, body(held + h)) - stored_energy(one, body(held - h))) / (2.0 * h)
        assert one.load(body(held))[0, 2] == pytest.approx(-slope)
    damped = Moorings([Mooring(damping=50.0, **keys)], {}, np.zeros(3), body())
    assert damped.load(body(0.0, -1.0))[0, 2] == pytest.approx(250.0)  # it lengthens
    assert damped.load(body(0.0, 9.0))[0, 2] == 0.0  # and never pushes


def test_a_barge_between_two_lines_surges_with_the_period_of_its_springs():
    """T = 2 pi sqrt((m + A) / 2k), both lines taut throughout; potential and kinetic energy add up to a constant."""
    lines = [spring(10.0, 40.0, slack_length=25.0), spring(-10.0, -40.0, slack_length=25.0)]
    with Simulation(load(moored(lines, velocity=[0.0, 0.0, 0.5]), QUIET)) as simulation:
        ship, rows = simulation.ships["ship"], []
        whole = ship.body.mass + ship.added[2]
        while simulation.time < 40.0:
            simulation.step()
            v = ship.body.velocity[2]
            rows.append(
                (simulation.time, ship.body.position[2], 0.5 * whole * v * v + stored_energy(ship.moorings, ship.body))
            )
    t, z, energy = np.array(rows).T
    k = np.flatnonzero(z[1:] * z[:-1] < 0.0)
    crossings = t[k] - z[k] * (t[k + 1] - t[k]) / (z[k + 1] - z[k])
    assert 2.0 * np.diff(crossings).mean() == pytest.approx(2.0 * pi * sqrt(whole / (2.0 * STIFF)), rel=2e-3)
    assert np.ptp(energy) < 0.03 * 0.5 * whole * 0.25
    assert abs(energy[-1] - energy[0]) < 0.02 * 0.5 * whole * 0.25


def test_a_fender_sends_a_barge_back_as_fast_as_it_came():
    fender = spring(10.0, 16.0, kind="fender", slack_length=4.0)
    with Simulation(load(moored([fender], velocity=[0.0, 0.0, 0.5]), QUIET)) as simulation:
        furthest = 0.0
        while simulation.time < 20.0:
            simulation.step()
            furthest = max(furthest, simulation.ships["ship"].body.position[2])
        whole = simulation.ships["ship"].body.mass + simulation.ships["ship"].added[2]
        assert simulation.ships["ship"].body.velocity[2] == pytest.approx(-0.5, rel=5e-3)
        assert furthest == pytest.approx(2.0 + 0.5 * sqrt(whole / STIFF), rel=5e-3)
        assert simulation.ships["ship"].parts == (*PARTS, "mooring")
        assert "force_mooring_z_N" in motion_observer.log_columns(simulation.ships["ship"].parts)


def test_a_scene_with_moorings_is_what_its_dump_says_and_a_wrong_point_is_named():
    lines = [{"from": "bow", "to": [0.0, 2.0, 60.0], "stiffness": STIFF}]
    config = load(moored(lines, points={"bow": [0.0, 3.0, 10.0]}), QUIET)
    dumped = config.resolved()["ship"]["moorings"][0]
    assert dumped["from"] == "bow" and dumped["slack_length"] is None
    assert load(config.resolved()).ships == config.ships
    with pytest.raises(SceneError, match="the ship has no point 'bow'"):
        load(moored(lines, points={"stem": [0.0, 3.0, 10.0]}))
    with pytest.raises(SceneError, match="from"):
        load(moored([{"frm": "bow", "to": [0.0, 2.0, 60.0], "stiffness": STIFF}]))
