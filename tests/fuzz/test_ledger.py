"""Model only what a scene requires: the ledger lists it, and a part that is left out leaves no trace in the numbers."""

import json
import subprocess
import sys
from pathlib import Path
from statistics import median

import pytest

from ocean_sim import machine
from ocean_sim.machine import available_cores
from ocean_sim.observers.render import PICTURE_SECONDS, SERIAL_SHARE, START_SECONDS
from ocean_sim.parts import config_of
from ocean_sim.reading.scene import load
from ocean_sim.result import Result
from ocean_sim.runtime import allocated_bytes, start
from ocean_sim.simulation import Simulation
from ocean_sim.verbs.check import ledger_rows, preflight

SHIP = {"kind": "hydrostatic", "hull": {"shape": {"kind": "sphere", "radius": 0.3}, "mass": 40.0}}
APART = {"contact": None} if "contact" in config_of("ship", "hydrostatic").model_fields else {}  # pushes no water
EVERYWHERE = {"kind": "sphere", "centre": [0.0, 0.0, 0.0], "radius": 5.0}
GUST = {"kind": "gusts", "volumes": [{"include": [EVERYWHERE], "acceleration": [2.0, 0.0, 0.0]}]}
WHOLE = {
    "basin": {"length": 2.0, "width": 2.0, "depth": 1.0},
    "fluid": {"kind": "mueller", "spacing": 0.25},
    "wind": GUST,
    "surface": "cloth",
    "ship": SHIP | APART,
    "platform": "hexapod_a",
    "gauges": {"elevation": {"a": [0.0, 0.0]}, "every": 0.02},
    "accuracy": {"every": 0.02},
    "time_step": {"kind": "fixed", "dt": 0.004},
    "duration": 0.04,
    "runtime": {"threads": 1},
    **dict.fromkeys(("render", "report")),
}

WATCHERS = {"ship": ("motion", "platform_log"), "platform": ("platform_log",)}  # who has nothing to watch without
SLAB = {
    "basin": {"length": 4.0, "depth": 1.2},
    "fluid": {"kind": "delta_sph", "spacing": 0.1},
    "runtime": {"threads": 1},
    **dict.fromkeys(("render", "report")),
}
FLOATING = {"kind": "pressure", "hull": {"shape": {"kind": "sphere", "radius": 0.4}, "mass": 134.0}}


def test_each_part_lists_its_own_kernels():
    config = load(WHOLE)
    rows = ledger_rows(preflight(config), config)
    kernels = {row["part"]: row["kernels"] for row in rows if row["kernels"] is not None}
    assert "PairSph.move" in kernels["fluid"] and "Cloth.update" in kernels["surface"]
    assert not any(name.startswith("Mueller") for part in ("wind", "surface", "ship") for name in kernels[part])


def test_pictures_take_time_as_many_as_there_are(tmp_path, monkeypatch):
    """No more pictures than frames, one each 0.033 s, on a machine that knows no film."""
    monkeypatch.setattr(machine, "cache_directory", lambda: tmp_path)
    drawn = preflight(load(WHOLE, {"render": {"every": 0.01, "size": [1280, 720]}}))
    seconds = START_SECONDS[3] + 2 * PICTURE_SECONDS[3]["draft"]
    assert drawn["estimated_by_part"]["pictures_s"] == pytest.approx(
        seconds * (SERIAL_SHARE + (1.0 - SERIAL_SHARE) / available_cores())
    )
    assert preflight(load(WHOLE))["estimated_by_part"]["pictures_s"] == 0.0


def test_what_a_part_takes_does_not_depend_on_what_else_there_is():
    config = load(WHOLE)
    for left_out in (["platform"], ["ship", "platform"], ["surface", "ship", "platform"], ["wind"], ["gauges"]):
        rest = load(WHOLE, dict.fromkeys(left_out))
        gone = {*left_out, *(watcher for slot in left_out for watcher in WATCHERS.get(slot, ()))}
        kept = [row for row in config.ledger() if row.part not in gone]
        assert rest.ledger() == kept and len(kept) < len(config.ledger())


def test_every_part_and_every_observer_has_a_row_and_a_reason():
    config = load(WHOLE, {"tracers": {"ids": [1]}, "checkpoint": {}})
    rows = {row.part: row for row in reversed(config.ledger())}
    assert set(rows) == set(config.parts()) - {"basin", "time_step"}
    assert "washout" in rows["platform"].what and "checkpoint_*.h5" in rows["checkpoint"].what
    assert rows["motion"].why == "every 0.01 s" and rows["gauges"].why == "every 0.02 s"
    otter = load(
        {"basin": WHOLE["basin"], "fluid": {"kind": "linear_waves", "height": 0.01, "period": 1.0}},
        {"ship": {"kind": "manoeuvring"}},
    )
    assert [row.bytes for row in otter.ledger() if row.part == "ship"] == [0]


@pytest.mark.parametrize("slot, name", [("basin", "basin.obstacles"), ("ship", "ship.kind is pressure")])
def test_samples_of_solid_bodies_are_rows_of_what_they_belong_to(slot, name):
    """What is allocated grows by what the ledger says; where there is no body, nothing is said."""
    box = {"min": [0.5, -1.0], "max": [1.0, -0.5]}
    body = {"ship": FLOATING} if slot == "ship" else {"basin": SLAB["basin"] | {"obstacles": [box]}}
    scenes = {"with": load(SLAB | body), "without": load(SLAB)}
    of_samples, rest, samples = {}, {}, 0
    for key, scene in scenes.items():
        of_samples[key] = {row.what: row for row in scene.ledger() if "samples" in row.what}
        start(scene.runtime)
        before = allocated_bytes()
        with Simulation(scene) as simulation:
            own = sum(row.bytes for row in scene.ledger() if row not in of_samples[key].values())
            rest[key] = allocated_bytes() - before - own
            samples = samples or simulation.fluid.boundary.n
    assert not of_samples["without"]
    (row,) = of_samples["with"].values()
    assert (row.part, row.what) == (slot, f"{samples} samples of solid bodies") and row.why.startswith(name)
    assert row.bytes == pytest.approx(rest["with"] - rest["without"], rel=0.1)


@pytest.mark.parametrize("part", ["platform", "ship", "surface", "gauges"])
def test_a_scene_without_a_part_says_nothing_of_it(part):
    gone = {"surface": ["surface", "ship", "platform"], "ship": ["ship", "platform"]}.get(part, [part])
    rest = load(WHOLE, dict.fromkeys(gone))
    assert not [row for row in rest.ledger() if row.part in gone]
    assert all(name not in rest.parts() for name in gone)


PROBE = """
import json, sys, time
from collections import Counter
from pathlib import Path
from taichi.lang.kernel_impl import Kernel
from ocean_sim import runtime
from ocean_sim import load, run
from ocean_sim.simulation import Simulation

launches, costs, allocated = Counter(), [], []
launch, step = Kernel.launch_kernel, Simulation.step

def counted(self, *rest):
    launches[f"{self.func.__module__}:{self.func.__qualname__}"] += bool(costs) and costs[-1] is None
    return launch(self, *rest)

def stepped(self):
    began = time.process_time()
    costs.append(None)  # within a step
    step(self)
    costs[-1] = time.process_time() - began
    allocated[:] = [runtime.allocated_bytes()]  # before it is closed, which frees its fields

Kernel.launch_kernel, Simulation.step = counted, stepped
runtime._launch_of = lambda *_: None  # every launch goes where it is counted
config = load(json.loads(sys.argv[1]))
folder = Path(sys.argv[2])
run(config, folder)
modules = sorted(name for name in sys.modules if name.startswith("ocean_sim."))
facts = {"modules": modules, "kernels": runtime.compiled_kernels(), "allocated": allocated[0]}
facts |= {"launches": {name: n for name, n in launches.items() if n}, "costs": costs}
(folder / "facts.json").write_text(json.dumps(facts))
"""


def runs(scene: dict, folder: Path) -> dict:
    """A run in a process of its own: what it imported, compiled and allocated, and its files by name."""
    command = [sys.executable, "-c", PROBE, json.dumps(scene), str(folder)]
    child = subprocess.run(command, capture_output=True, text=True)
    assert child.returncode == 0, child.stderr
    files = {p.name: p.read_bytes() for p in folder.glob("*.csv") if p.name != "timings.csv"}
    return json.loads((folder / "facts.json").read_text()) | {"files": files, "folder": folder}


@pytest.fixture(scope="module")
def whole_and_without(tmp_path_factory) -> dict[str, dict]:
    """The scene with all slots, and without one after the other from the end of the chain."""
    folder = tmp_path_factory.mktemp("ledger")
    scenes = {"whole": WHOLE, "platform": {**WHOLE, "platform": None}}
    scenes["ship"] = {**scenes["platform"], "ship": None}
    scenes["surface"] = {**scenes["ship"], "surface": None}
    scenes["wind"] = {**scenes["surface"], "wind": None}
    return {name: runs(scene, folder / name) for name, scene in scenes.items()}


STILL = {
    "ocean_sim.wind.still",
}  # an absent wind is one that blows nowhere


@pytest.mark.anchor
def test_a_slot_that_is_left_out_is_not_imported_or_compiled(whole_and_without):
    compiled = set(whole_and_without["whole"]["kernels"])
    for slot, found in list(whole_and_without.items())[1:]:
        kinds = {m for m in found["modules"] if m.startswith(f"ocean_sim.{slot}.")} - STILL
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


def test_a_step_without_a_slot_is_as_if_it_did_not_exist(whole_and_without):
    """Each step of what remains launches the very same kernels as often as before; none of the slot's own."""
    launched = {name: found["launches"] for name, found in whole_and_without.items()}
    assert sum(launched["whole"].values()) > sum(launched["ship"].values()) > sum(launched["surface"].values()) > 0
    for slot, rooms in {
        "platform": ("ship", "surface", "fluid"),
        "ship": ("surface", "fluid"),
        "surface": ("fluid",),
    }.items():
        before = of_rooms(launched["whole"], rooms)
        assert before and launched[slot] == before
    assert not of_rooms(launched["wind"], ("wind",))
    assert of_rooms(launched["wind"], ("fluid",)).keys() == of_rooms(launched["surface"], ("fluid",)).keys()


def of_rooms(launches: dict[str, int], rooms: tuple[str, ...]) -> dict[str, int]:
    """Launches of kernels of these slots."""
    return {name: n for name, n in launches.items() if name.split(":")[0].split(".")[1] in rooms}


def test_no_wind_gives_the_numbers_of_still_air(whole_and_without, tmp_path):
    without = whole_and_without["wind"]
    assert load({**WHOLE, "wind": None}).resolved() == load({**WHOLE, "wind": "still"}).resolved()
    windy = whole_and_without["surface"]["files"]
    assert without["files"].keys() == windy.keys() and without["files"]["accuracy.csv"] != windy["accuracy.csv"]
    impulse = Result(without["folder"]).accuracy
    assert all((impulse[f"impulse_wind_{axis}_Ns"] == 0.0).all() for axis in "xyz")


@pytest.mark.slow
def test_a_step_without_a_slot_costs_what_its_other_slots_cost(tmp_path):
    """In seconds of the processor, the median of 60 steps: a wide bound, for caches and clocks are shared."""
    long = {**WHOLE, "duration": 0.24, "fluid": {"kind": "mueller", "spacing": 0.125}, "gauges": None, "accuracy": None}
    alone = {**long, **dict.fromkeys(("platform", "ship", "surface"))}
    never = {key: value for key, value in alone.items() if key not in ("platform", "ship", "surface")}
    cost = {
        name: median(runs({**scene, "frames": None}, tmp_path / name)["costs"][2:])
        for name, scene in {"whole": long, "left out": alone, "never named": never}.items()
    }
    print(f"\nseconds of a step: {cost}")
    assert 0.6 < cost["left out"] / cost["never named"] < 1.6
    assert cost["left out"] < cost["whole"]


def test_what_is_compiled_is_in_the_ledger(whole_and_without):
    config = load(WHOLE)
    listed = {name for row in ledger_rows(preflight(config), config) for name in row["kernels"] or ()}
    ours = {name for name in whole_and_without["whole"]["kernels"] if "." in name}  # the rest are Taichi's copies
    assert ours and ours <= listed, ours - listed
