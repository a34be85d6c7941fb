"""Keels that meet the bed under waves in closed form."""

import json

import numpy as np
import pytest

from ocean_sim.files.yaml_file import SceneError
from ocean_sim.reading.scene import load, observer_names
from ocean_sim.result import Result, run

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
