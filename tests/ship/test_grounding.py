"""Keels that meet the bed under waves in closed form."""

import json

import numpy as np
import pytest

from ocean_sim.files.yaml_file import SceneError
from ocean_sim.reading.scene import load, observer_names
from ocean_sim.result import Result, run
from ocean_sim.ship.shared.squat import squat

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
    assert squat(320.0, 20.0, 2.0, DEPTH) == pytest.approx(0.3753, abs=1e-4)
    said = [line for line in load(shallow(velocity=[0.0, 0.0, 2.0])).warnings() if "draughts deep" in line]
    assert said[0].endswith("at 2 m/s her bow would lie 0.38 m deeper, and touch the bed (ICORELS 1980)"), said
    fast = [line for line in load(shallow(velocity=[0.0, 0.0, 5.0])).warnings() if "draughts deep" in line]
    assert "faster than the fastest wave there" in fast[0]
    assert not any("m/s" in line for line in load(shallow()).warnings() if "draughts deep" in line)
