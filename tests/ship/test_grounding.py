"""Keels that meet the bed under waves in closed form, and squat."""

import json
from math import inf, sqrt
from types import SimpleNamespace

import numpy as np
import pytest

from ocean_sim.__main__ import run_command_line
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.reading.scene import load, observer_names
from ocean_sim.result import Result, run
from ocean_sim.ship import Load
from ocean_sim.ship.body.rigid_body import RigidBody, quaternion, rotation_matrix
from ocean_sim.ship.hull.shapes import Box
from ocean_sim.ship.naval.hydrostatics import bow_squat, slender_squat
from ocean_sim.ship.water.wall_contact import Sides

QUIET = {name: None for name in observer_names() if name not in ("manifest", "health", "motion")}
DEPTH = 2.3


def shallow(**ship) -> dict:
    """A barge that draws 2 m in waves of 0.8 m."""
    return {
        "duration": 12.0,
        "basin": {"length": 100.0, "width": 100.0, "depth": DEPTH, "walls": "none"},
        "fluid": {"kind": "linear_waves", "height": 0.8, "period": 6.0},
        "time_step": {"kind": "fixed", "dt": 0.02},
        "runtime": {"threads": 1},
        "motion": {"every": 0.02},
        "ship": {"kind": "dynamic", "hull": "barge20", "cells_per_draught": 4.0, **ship},
    }


def test_a_keel_rests_on_the_bed_and_the_run_says_so(tmp_path):
    run(load(shallow(), QUIET), tmp_path)
    events = [json.loads(line) for line in (tmp_path / "events.jsonl").read_text().splitlines()]
    assert any(event["event"] == "the hull meets the bed" for event in events)
    table = Result(tmp_path).motion
    keel = table["heave_m"] - 2.5 * np.cos(table["pitch_rad"]) - 10.0 * np.abs(np.sin(table["pitch_rad"]))
    assert -DEPTH - 0.01 < keel.min() < -DEPTH + 0.05
    assert table["force_wave_y_N"].max() > 3.0e5  # the bed's push


def test_a_ship_that_begins_in_the_bed_is_refused():
    with pytest.raises(SceneError, match=r"the hull reaches 0\.2 m through the bed"):
        load(shallow(position=[0.0, 0.0, 0.0]))
    with pytest.raises(SceneError, match="the ship draws 2 m"):
        load(shallow() | {"basin": {"length": 100.0, "width": 100.0, "depth": 1.9, "walls": "none"}})


def test_squat_under_way_over_a_bed_is_said():
    """The barge of 20 x 8 x 2 m at 2 m/s in 2.3 m: 2.4 320 / 20^2 0.1773 / sqrt(1 - 0.1773) = 0.375 m, over the bed at
    0.3 m."""
    assert bow_squat(320.0, 20.0, 2.0, DEPTH) == pytest.approx(0.3753, abs=1e-4)
    said = [line for line in load(shallow(velocity=[0.0, 0.0, 2.0])).warnings() if "draughts deep" in line]
    assert said[0].endswith("at 2 m/s her bow would lie 0.38 m deeper, and touch the bed (ICORELS 1980)"), said
    fast = [line for line in load(shallow(velocity=[0.0, 0.0, 5.0])).warnings() if "draughts deep" in line]
    assert "faster than the fastest wave there" in fast[0]
    assert not any("m/s" in line for line in load(shallow()).warnings() if "draughts deep" in line)


def slice_of(fuller):
    """Slices of a hull of 30 x 3 x 1 m: a parabola, fuller forward by this part of its breadth; of unit stiffness."""
    d = 0.05
    z = np.arange(-15.0 + d / 2.0, 15.0, d)
    breadth = 3.0 * (1.0 - (z / 15.0) ** 2) * (1.0 + fuller * z / 15.0)
    voxels = SimpleNamespace(size=(d, d, d))
    stiffness = {"heave": 9810.0 * float(breadth.sum()) * d, "pitch": 9810.0 * float((breadth * z**2).sum()) * d}
    water = {"density": 1000.0, "gravity": 9.81}
    return SimpleNamespace(
        stations=(z, breadth, 0.0 * z + 1.0), section_areas=breadth, voxels=voxels, stiffness=stiffness, **water
    )


def test_a_parabola_sinks_as_slender_theory_says_and_a_full_bow_dips():
    """Of B and S like 1 - (2 z / L)^2 the double integral is in closed form: sinkage is 9 / (2 pi) V / L^2."""
    even, full = slender_squat(slice_of(0.0)), slender_squat(slice_of(0.3))
    volume = 2.0 / 3.0 * 30.0 * 3.0
    assert not even.blunt and even.levers == pytest.approx((15.0, 15.0))
    assert even.end_sinkage == pytest.approx(even.sinkage) and full.end_sinkage > full.sinkage
    assert even.sinkage * 30.0**2 / volume == pytest.approx(9.0 / (2.0 * np.pi), rel=1e-3)
    assert abs(even.trim) < 1e-9 < full.trim
    half, whole = even.at_speed(1.0, 2.0), even.at_speed(sqrt(2.0), 4.0)  # one Froude number
    assert half.sinkage == pytest.approx(whole.sinkage) and even.at_speed(5.0, 2.0).sinkage == inf


def test_hull_tells_squat_over_a_bed(capfd):
    """The Wigley hull of 3 m and 0.075 m3 at F 0.5 in 0.3 m: 1.432 0.075 / 9 0.25 / sqrt(0.75) = 3.45 mm, level."""
    assert run_command_line(["hull", "wigley", "--kg", "0.12", "--depth", "0.3", "--json"]) == 0
    row = next(row for row in json.loads(capfd.readouterr().out)["squat"] if row["froude"] == 0.5)
    assert row["speed_m_s"] == pytest.approx(0.5 * sqrt(9.81 * 0.3)) and abs(row["trim_deg"]) < 1e-3
    assert row["sinkage_m"] == pytest.approx(0.00345, rel=0.01) and row["bow_m"] == pytest.approx(0.00577, rel=0.01)
    assert run_command_line(["hull", "barge20", "--depth", "3", "--json"]) == 0
    assert any("her ends are blunt" in note for note in json.loads(capfd.readouterr().out)["notes"])
    assert run_command_line(["hull", "wigley", "--kg", "0.12", "--depth", "0.1"]) == 2
    assert "--depth: she draws 0.187 m" in capfd.readouterr().err


def test_a_slope_pushes_a_hull_along_its_normal():
    """A cube that falls into a slope of 1:2, without friction: no speed into the slope is left."""
    tank = load(
        {
            "basin": {"length": 4.0, "width": 4.0, "depth": 1.0, "floor": {"profile": [[-2.0, -1.0], [2.0, 1.0]]}},
            "fluid": {"kind": "mueller", "spacing": 0.25, "kinematic_viscosity": 0.01},
        }
    ).preflight.tank
    sides = Sides(Box(kind="box", length=0.5, breadth=0.5, height=0.5), np.array([0.0, 0.25, 0.0]), tank)
    turn = quaternion(np.array([0.0, 0.0, 1.0]), np.arctan(0.5))
    place = rotation_matrix(turn) @ [0.0, 0.15, 0.0]
    body = RigidBody(100.0, np.eye(3), place, turn, np.array([0.0, -1.0, 0.0]), np.zeros(3))
    assert sides.may_touch(body, 0.01)
    impulse = sides.with_impulses(Load.of({}), lambda _: body, 1.0).force
    assert impulse / np.linalg.norm(impulse) == pytest.approx(np.array([-1.0, 2.0, 0.0]) / 5.0**0.5)
    after = body.velocity + impulse / body.mass
    assert after @ [-1.0, 2.0, 0.0] == pytest.approx(0.0, abs=0.02)
