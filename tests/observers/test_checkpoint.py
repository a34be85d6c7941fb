"""A run that was stopped and went on leaves the bytes of the run that was not, whatever its scene is made of."""

import shutil
from pathlib import Path

import pytest

from ocean_sim.fluid.linear_waves import LinearWaves
from ocean_sim.kernel_library import impl
from ocean_sim.observers.checkpoint import KEPT_FILES
from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation
from ocean_sim.state import checkpoint_file
from ocean_sim.validation.shared.tables import table_path
from ocean_sim.verbs.resume import continue_run
from ocean_sim.verbs.shared.progress import Progress

QUIET = {"seed": 3, "runtime": {"threads": 1}, "timings": None, "render": None, "report": None}
OFTEN = {"frames": {"every": 0.05}, "accuracy": {"every": 0.02}, "checkpoint": {"every": 100.0}}
SQUARE = {"length": 2.0, "width": 2.0, "depth": 0.5}
TANK = {"length": 4.0, "width": 4.0, "depth": 1.2}
OPEN = {"length": 40.0, "width": 40.0, "depth": 7.5, "walls": "none"}
SLICE = {"length": 2.0, "depth": 0.5}
AROUND = {
    "length": 1.0,
    "depth": 1.0,
    "floor": "none",
    "walls": {"x": "periodic", "y": "periodic"},
    "gravity": [0.0, 0.0, 0.0],
}
WAVEMAKER = {
    "wavemaker": {"wall": "x_min", "height": 0.05, "period": 1.0, "ramp": 0.5},
    "walls": {"x_max": "absorbing"},
}
DRIFTING = {
    "walls": {
        "x_min": {
            "kind": "absorbing",
            "target": {"current": [0.1, 0.0, 0.0], "waves": {"height": 0.05, "period": 1.0}},
        }
    }
}
ROLLS = {"motion": {"kind": "harmonic", "axis": "roll_z", "amplitude": 0.1, "period": 1.0}}
LEFT = {"fill": [{"min": [-1.0, -0.5], "max": [0.0, -0.2]}]}
MOUTH = {"emitter": {"position": [0.0, 0.0], "velocity": [1.0, 1.0], "rate": 0.4, "cap": 300}}
BOX = {"shape": {"kind": "box", "length": 2.0, "breadth": 1.0, "height": 0.6}, "mass": 400.0}
HULL = {"hull": BOX | {"centre_of_mass": [0.0, 0.2, 0.0]}, "velocity": [0.0, 0.0, 0.5]}
RADIATION = str(table_path("barge20_radiation"))
ENGINE = {"propeller": {"thrust": 9000.0}, "rudder": {"area": 0.8, "position": [0.0, 0.9, -6.5]}}
AUTOPILOT = {"hull": "yacht", "controls": {"autopilot": {"heading_deg": 30.0, "throttle": 0.5}}} | ENGINE
LINE = {"from": [0.0, 2.0, 5.0], "to": [0.0, 0.0, 9.0], "stiffness": 1.0e4}
PILOT = {"hull": "yacht", "helm": {"route": [[1.0, 2.0], [3.0, 2.0]], "speed": 2.0}, "moorings": [LINE]} | ENGINE
GAUGES = {"gauges": {"elevation": {"here": [0.1, 0.2]}, "pressure": {"bed": [0.1, -0.4, 0.2]}, "every": 0.02}}
IN_SLICE = {"gauges": {"elevation": {"here": [0.1]}, "pressure": {"bed": [0.1, -0.4]}, "every": 0.02}}
TRACED = {"tracers": {"ids": [0, 5], "every": 0.02}}
RIDE = {"platform": {"kind": "hexapod", "washout": "ship"}}
SWELL = {"kind": "linear_waves", "height": 0.5, "period": 3.0}
STEEP = {"kind": "spectral_sea", "height": 0.5, "period": 3.0, "order": 3, "cells": 32}
WIND_SEA = {"kind": "jonswap", "significant_wave_height": 0.5, "peak_period": 4.0}
VORTICES = {"initial": {"kind": "taylor_green", "speed": 1.0}, "reference_speed": 1.0}


def water(kind: str, spacing: float = 0.2, **keys) -> dict:
    return {"fluid": {"kind": kind, "spacing": spacing, **keys}}


def sea(kind: str, ship: dict, **keys) -> dict:
    return {
        "basin": OPEN,
        "fluid": SWELL,
        "wind": "wide",
        "duration": 1.5,
        "ship": {"kind": kind, **ship},
        **RIDE,
        **keys,
    }


def afloat(scheme: str, kind: str, **keys) -> dict:
    return {"basin": TANK, **water(scheme, 0.25), "ship": {"kind": kind, **HULL}, **RIDE, **keys}


CLOTH = {"surface": "cloth", "wind": "wide"}
RANDOM = {
    "kind": "linear_waves",
    "spectrum": {"significant_wave_height": 0.05, "peak_period": 1.0, "spreading": 10.0, "seed": 2},
}
BLOB = {"kind": "sphere", "radius": 0.5, "centre": [0.0, 0.0, 0.0]}
SCENES = {
    "delta_sph, patch of a sea": {
        "basin": SLICE | {"walls": "periodic"},
        **water("delta_sph", 0.1),
        "sea": {"kind": "linear_waves", "height": 0.05, "period": 1.0, "rim": {"velocity": [2.0, 0.0]}},
        **IN_SLICE,
    },
    "ballistic, emitter, noise": {"basin": SLICE, **water("ballistic", 0.1, **LEFT, **MOUTH), "wind": "noise_only"},
    "spectral sea of third order, dynamic ship, gusts": sea("dynamic", AUTOPILOT, fluid=STEEP),
}  # fmt: skip
MORE = {
    "mueller, cloth, hydrostatic ship, gusts, platform": afloat("mueller", "hydrostatic", **CLOTH, **TRACED),
    "linear waves, dynamic ship, autopilot": sea("dynamic", AUTOPILOT | {"radiation": RADIATION}),
    "dfsph, stress": {"basin": SQUARE, **water("dfsph"), "wind": {"kind": "stress"}, **GAUGES},
    "delta_sph, wavemaker": {"basin": SLICE | WAVEMAKER, **water("delta_sph", 0.1), **IN_SLICE},
    "delta_sph, absorbed towards a sea": {"basin": SLICE | DRIFTING, **water("delta_sph", 0.1), **IN_SLICE},
    "delta_sph, marching cubes, pressure ship, vortex": afloat(
        "delta_sph", "pressure", wind="vortex", surface="marching_cubes"
    ),
    "mueller, closed": {"basin": AROUND, **water("mueller", 0.1, **VORTICES)},
    "mueller, slice": {"basin": SLICE, **water("mueller", 0.1), "wind": "noise_only", **IN_SLICE},
    "delta_sph, closed": {"basin": AROUND, **water("delta_sph", 0.1, **VORTICES), **TRACED},
    "delta_sph, emitter": {"basin": SLICE, **water("delta_sph", 0.1, **LEFT, **MOUTH)},
    "delta_sph, cloth": {"basin": SQUARE, **water("delta_sph"), **CLOTH, **GAUGES},
    "delta_sph, patch of a nonlinear sea, gusts that travel": {
        "basin": SLICE | {"walls": "periodic"},
        **water("delta_sph", 0.1),
        "sea": {"kind": "spectral_sea", "height": 0.05, "period": 1.0, "onset": 0.0, "rim": {"velocity": [2.0, 0.0]}},
        "wind": {"kind": "gusts", "volumes": [{"include": [BLOB], "acceleration": [1.0, 0.0, 0.0]}]},
        "gauges": {"elevation": {"there": {"at": [0.1], "rides": True}}, "every": 0.02},
    },
    "delta_sph, wide patch of a random sea": {
        "basin": TANK | {"walls": "periodic"},
        **water("delta_sph"),
        "sea": RANDOM,
    },
    **{
        f"{scheme}, patch of a sea": {
            "basin": SLICE | {"walls": "periodic"},
            **water(scheme, 0.1),
            "sea": {"kind": "linear_waves", "height": 0.05, "period": 1.0},
            **IN_SLICE,
        }
        for scheme in ("mueller", "dfsph")
    },
    "dfsph, patch of a sea, hydrostatic ship": afloat(
        "dfsph", "hydrostatic", basin=TANK | {"walls": "periodic"}, surface="cloth", sea="calm"
    ),
    "delta_sph, pressure ship": afloat("delta_sph", "pressure", wind="wide"),
    "dfsph, closed": {"basin": AROUND, **water("dfsph", 0.1, **VORTICES)},
    "dfsph, rolling tank": {"basin": SLICE | ROLLS, **water("dfsph", 0.1), **IN_SLICE},
    "dfsph, cloth, stress": {"basin": SQUARE, **water("dfsph"), "surface": "cloth", "wind": {"kind": "stress"}},
    "mueller, pressure ship": afloat("mueller", "pressure"),
    "mueller, cloth, thesis ship": afloat("mueller", "thesis", **CLOTH),
    "mueller, marching cubes, dynamic ship": afloat("mueller", "dynamic", surface="marching_cubes"),
    "linear waves, hydrostatic ship": sea("hydrostatic", AUTOPILOT),
    "linear waves, moored ship with a pilot": sea("dynamic", PILOT),
    "linear waves, thesis ship": sea("thesis", AUTOPILOT),
    "linear waves, manoeuvring": sea("manoeuvring", {}, wind=None),
    "irregular waves": {"basin": OPEN, "fluid": {"kind": "linear_waves", "spectrum": WIND_SEA}},
    "f64": {"basin": SQUARE, **water("dfsph"), "wind": "wide", "runtime": {"threads": 1, "precision": "f64"}},
}


def scene_of(keys: dict, **over):
    keys = {"duration": 0.2} | QUIET | OFTEN | keys | over
    return load({key: value for key, value in keys.items() if value is not None or key in QUIET})


def undisturbed(scene, folder: Path, stop: float, copy: Path) -> None:
    """A run with a checkpoint at a time [s], and a copy of what its folder was like then."""
    folder.mkdir()
    with Simulation(scene, folder) as simulation:
        watching = dict(zip(scene.observers, simulation.observers))
        simulation.run(stop)
        watching["checkpoint"].write_state()
        shutil.copytree(folder, copy)
        simulation.run(scene.duration)


def differing(one: Path, other: Path) -> list[str]:
    """Names of the files that are not the same in two run folders, but for those that say when a run was stopped."""
    names = {path.relative_to(folder) for folder in (one, other) for path in folder.rglob("*") if path.is_file()}
    names = {name for name in names if name.suffix != ".h5" and name.name not in ("manifest.json", "timings.csv")}
    same = {name for name in names if all((folder / name).is_file() for folder in (one, other))}
    return sorted(
        str(name) for name in names if name not in same or (one / name).read_bytes() != (other / name).read_bytes()
    )


def resumed(scene, folder: Path) -> list[str]:
    """Runs a scene without and with a stop in its midst; the files that differ."""
    folder.mkdir(exist_ok=True)
    undisturbed(scene, folder / "a", 0.4 * scene.duration, folder / "b")
    continue_run(
        scene,
        checkpoint_file.read_checkpoint(next(checkpoint_file.checkpoint_files(folder / "b"))),
        folder / "b",
        Progress(scene.duration, quiet=True),
    )
    return differing(folder / "a", folder / "b")


@pytest.mark.parametrize("name", [*SCENES, *(pytest.param(name, marks=pytest.mark.slow) for name in MORE)])
def test_a_run_goes_on_as_if_nothing_had_happened(name, tmp_path):
    assert resumed(scene_of((SCENES | MORE)[name]), tmp_path) == []
    written = {path.name for path in (tmp_path / "b").iterdir()}
    assert {"accuracy.csv", "events.jsonl", "frames"} <= written and not [n for n in written if n.endswith("tmp")]


@pytest.mark.slow
@pytest.mark.usefixtures("vulkan_there")
def test_a_preview_goes_on_with_the_same_pictures(tmp_path):
    scene = scene_of({"basin": SLICE, **water("mueller", 0.1), "preview": {"every": 0.1, "size": [960, 640]}})
    assert resumed(scene, tmp_path) == []
    assert len([*(tmp_path / "b" / "preview").iterdir()]) == 3


def test_a_part_that_forgot_something_would_be_seen(tmp_path, monkeypatch):
    """Negative control of the test above: waves that begin anew."""
    scene = scene_of({"basin": OPEN, "fluid": SWELL, "duration": 0.5, "gauges": {"elevation": {"here": [0.1, 0.2]}}})
    monkeypatch.setattr(LinearWaves, "left_out", ("time",), raising=False)
    assert {"gauges.csv", "frames/frame_00005.npz"} <= set(resumed(scene, tmp_path))


WATER = {"basin": SLICE, **water("mueller", 0.1), "wind": "noise_only", "duration": 0.05, **IN_SLICE}
WAVES = {"basin": OPEN, "fluid": SWELL, "duration": 0.5, "gauges": {"elevation": {"here": [0.0, 0.0]}}}


def test_each_checkpoint_after_the_first_compiles_nothing(tmp_path):
    """Kernels stay in memory for ever: in an hour they would fill it."""
    with Simulation(scene_of(WATER), tmp_path) as simulation:
        watcher = dict(zip(simulation.scene.observers, simulation.observers))["checkpoint"]
        counts = []
        for _ in range(3):
            simulation.step()
            watcher.write_state()
            counts.append(sum(len(kernel.compiled_kernels) for kernel in impl.get_runtime().kernels))
    assert counts[0] == counts[1] == counts[2]


@pytest.mark.parametrize("keys", [pytest.param(WATER, marks=pytest.mark.slow), WAVES])
def test_checkpoints_change_nothing_and_only_the_newest_are_kept(keys, tmp_path):
    """Here one is due after every step."""
    for name, every in (("without", None), ("with", {"every": 0.1, "wall_every": 1e-6})):
        (tmp_path / name).mkdir()
        with Simulation(scene_of(keys, checkpoint=every), tmp_path / name) as simulation:
            simulation.run(simulation.scene.duration)
    assert differing(tmp_path / "without", tmp_path / "with") == []
    kept = [*checkpoint_file.checkpoint_files(tmp_path / "with")]
    assert len(kept) == KEPT_FILES
    newest, before = (checkpoint_file.read_checkpoint(path) for path in kept)
    assert newest.time == simulation.time >= keys["duration"] and before.steps == newest.steps - 1
    assert kept[0].name == f"checkpoint_{simulation.time:013.6f}.h5"
