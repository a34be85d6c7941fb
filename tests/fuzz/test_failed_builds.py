"""Builds that fail at any allocation, by any failure: what is built next is as in a fresh process."""

import json
import subprocess
import sys

import pytest

BARE = {"render": None, "runtime": {"threads": 1}, "duration": 0.2}
WAVES = BARE | {
    "basin": {"length": 40.0, "width": 40.0, "depth": 7.5, "walls": "none"},
    "fluid": {"kind": "linear_waves", "height": 0.2, "period": 4.0},
}
WATER = BARE | {"basin": {"length": 2.0, "depth": 1.0}, "fluid": {"kind": "mueller", "spacing": 0.25}}
WHOLE = BARE | {
    "basin": {"length": 24.0, "width": 24.0, "depth": 4.0},
    "fluid": {"kind": "delta_sph", "spacing": 1.0},
    "surface": "cloth",
    "ship": {"kind": "hydrostatic", "hull": "yacht"},
    "wind": "wide",
}


def answer_of(tmp_path, stride, **scenes):
    (tmp_path / "scenes.json").write_text(json.dumps(scenes))
    command = [sys.executable, "-m", "tests.fuzz._failed_builds", str(tmp_path / "scenes.json"), str(stride)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.strip().splitlines()[-1])


def test_a_failed_build_changes_nothing_that_follows(tmp_path):
    """Waves, wind and a ship, which compile nothing while they are built."""
    answer = answer_of(tmp_path, 61, small=WAVES, large=WAVES | {"wind": "wide", "ship": "barge20"})
    assert answer["wrong"] == [] and answer["failures"] >= 8


@pytest.mark.slow
@pytest.mark.parametrize(
    ("small", "large", "stride"),
    [(WAVES, WAVES | {"wind": "wide", "ship": "barge20"}, 1), (WATER, WHOLE, 31)],
    ids=["waves", "water"],
)
def test_a_failed_build_changes_nothing_that_follows_wherever_it_fails(tmp_path, small, large, stride):
    """At every allocation; of water with a surface, a ship and wind, which compile, at every 31st."""
    answer = answer_of(tmp_path, stride, small=small, large=large)
    assert answer["wrong"] == [] and answer["failures"] >= 40
