"""Model only what a scene requires: the ledger tells it, and a part that is left out leaves no trace in the numbers."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from ocean_sim.parts import config_of
from ocean_sim.scene import load
from ocean_sim.verbs.check import ledger, preflight

SHIP = {"kind": "hydrostatic", "hull": {"shape": {"kind": "sphere", "radius": 0.3}, "mass": 40.0}}
APART = {"contact": None} if "contact" in config_of("ship", "hydrostatic").model_fields else {}  # pushes no water
WHOLE = {
    "basin": {"length": 2.0, "width": 2.0, "depth": 1.0},
    "fluid": {"kind": "mueller", "spacing": 0.25},
    "wind": "wide",
    "surface": "cloth",
    "ship": SHIP | APART,
    "platform": "hexapod_a",
    "gauges": {"elevation": {"a": [0.0, 0.0]}, "every": 0.02},
    "time_step": {"kind": "fixed", "dt": 0.004},
    "duration": 0.04,
    "runtime": {"threads": 1},
    **dict.fromkeys(("render", "report")),
}


def test_the_shares_of_a_step_are_whole_and_each_part_says_its_own():
    config = load(WHOLE)
    found = preflight(config)
    rows = ledger(found, config)
    shares = {row["part"]: row["share"] for row in rows if row["share"] is not None}
    assert set(shares) == {"wind", "fluid", "surface", "ship"}
    assert sum(shares.values()) == pytest.approx(1.0)
    assert found["estimated_wall_s"] == pytest.approx(10 * sum(row.a_step(0.004) for row in found["ledger"]))
    kernels = {row["part"]: row["kernels"] for row in rows if row["kernels"] is not None}
    assert "Mueller.move" in kernels["fluid"] and "Cloth.update" in kernels["surface"]
    assert not any(name.startswith("Mueller") for part in ("wind", "surface", "ship") for name in kernels[part])


def test_what_a_part_takes_does_not_depend_on_what_else_there_is():
    config = load(WHOLE)
    for left_out in (["platform"], ["ship", "platform"], ["surface", "ship", "platform"], ["wind"]):
        rest = load(WHOLE, dict.fromkeys(left_out))
        kept = [row for row in config.ledger() if row.part not in left_out]
        assert rest.ledger() == kept
    longer = load(WHOLE, {"ship": None, "platform": None})
    assert preflight(longer)["estimated_wall_s"] < preflight(config)["estimated_wall_s"]


def test_the_estimate_grows_with_what_there_is_to_do():
    def wall(**changes) -> float:
        return preflight(load(WHOLE, changes))["estimated_wall_s"]

    assert wall(**{"fluid.spacing": 0.125}) > 1.5 * wall()
    assert wall(**{"surface.every": 0.004}) > wall(**{"surface.every": 0.02})
    assert wall(**{"ship.cells_per_draught": 16.0}) > wall()
    assert wall(duration=0.08) == pytest.approx(2.0 * wall())


@pytest.mark.parametrize("part", ["platform", "ship", "surface", "gauges"])
def test_a_scene_without_a_part_says_nothing_of_it(part):
    gone = {"surface": ["surface", "ship", "platform"], "ship": ["ship", "platform"]}.get(part, [part])
    rest = load(WHOLE, dict.fromkeys(gone))
    assert not [row for row in rest.ledger() if row.part in gone]
    assert all(name not in rest.parts() for name in gone)


PROBE = """
import hashlib, json, sys
from pathlib import Path
from ocean_sim import runtime
from ocean_sim.scene import load, run
config = load(json.loads(sys.argv[1]))
folder = Path(sys.argv[2])
run(config, folder)
modules = sorted(name for name in sys.modules if name.startswith("ocean_sim."))
facts = {"modules": modules, "kernels": runtime.compiled_kernels(), "allocated": runtime.allocated_bytes()}
(folder / "facts.json").write_text(json.dumps(facts))
"""


def runs(scene: dict, folder: Path) -> dict:
    """A run in a process of its own: what it imported, compiled and allocated, and its files by name."""
    command = [sys.executable, "-c", PROBE, json.dumps(scene), str(folder)]
    child = subprocess.run(command, capture_output=True, text=True)
    assert child.returncode == 0, child.stderr
    files = {p.name: p.read_bytes() for p in folder.glob("*.csv") if p.name != "timings.csv"}
    return json.loads((folder / "facts.json").read_text()) | {"files": files}


@pytest.fixture(scope="module")
def whole_and_without(tmp_path_factory) -> dict[str, dict]:
    """The scene with all slots, and without one after the other from the end of the chain."""
    folder = tmp_path_factory.mktemp("ledger")
    scenes = {"whole": WHOLE, "platform": {**WHOLE, "platform": None}}
    scenes["ship"] = {**scenes["platform"], "ship": None}
    scenes["surface"] = {**scenes["ship"], "surface": None}
    return {name: runs(scene, folder / name) for name, scene in scenes.items()}


def test_a_slot_that_is_left_out_is_not_imported_or_compiled(whole_and_without):
    compiled = set(whole_and_without["whole"]["kernels"])
    for slot, found in list(whole_and_without.items())[1:]:
        kinds = [m for m in found["modules"] if m.startswith(f"ocean_sim.{slot}.")]
        assert not kinds, f"without a {slot}, {kinds} are imported"
        assert set(found["kernels"]) <= compiled
        if slot in ("ship", "surface"):
            assert found["allocated"] < whole_and_without["whole"]["allocated"]


def test_a_slot_that_is_left_out_changes_no_number_of_those_before_it(whole_and_without):
    """Downstream reads upstream: the water does not know of a surface, nor a ship without contact of its platform."""
    files = {name: found["files"] for name, found in whole_and_without.items()}
    assert files["whole"]["motion.csv"] == files["platform"]["motion.csv"]
    for name in ("platform", "ship", "surface"):
        assert files[name]["gauges.csv"] == files["whole"]["gauges.csv"]
    assert "motion.csv" not in files["ship"] and "platform.csv" not in files["platform"]


def test_what_is_compiled_is_in_the_ledger(whole_and_without):
    config = load(WHOLE)
    listed = {name for row in ledger(preflight(config), config) for name in row["kernels"] or ()}
    ours = {name for name in whole_and_without["whole"]["kernels"] if "." in name}  # the rest are Taichi's copies
    assert ours and ours <= listed, ours - listed
