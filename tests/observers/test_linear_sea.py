"""A run of water without particles leaves the same files as any other, and its gauges read the closed form."""

import json

import numpy as np
import pytest

from ocean_sim import waves
from ocean_sim.conventions import Failed
from ocean_sim.files.csv_file import read_columns
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.parts import SurfaceConfig
from ocean_sim.pictures.export.paraview import export_run
from ocean_sim.reading import composition, scene
from ocean_sim.reading.scene import load
from ocean_sim.result import run as run_scene
from ocean_sim.verbs.check import preflight, preflight_lines
from tests.waves.closed_forms import pressure

OVER = {"runtime.threads": 1, "duration": 1.0, "frames.spacing": 4.0, "frames.every": 0.5, "render": None}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The scene and the folder of one run of the packaged sea."""
    config = load("linear_sea", OVER)
    folder = tmp_path_factory.mktemp("sea")
    run_scene(config, folder)
    return config, folder


def test_gauges_read_the_closed_form(run):
    config, folder = run
    sea = config.fluid.sea(config.basin.build())
    table = read_columns(folder / "gauges.csv")
    time, scale = table["time_s"], config.fluid.scale[0]
    assert len(time) == 21
    for name, (x, z) in config.observers["gauges"].elevation.items():
        exact = np.array([waves.elevation(sea, np.array([[x, z]]), t)[0] for t in time])
        np.testing.assert_allclose(table[f"{name}_m"], exact, atol=2e-3 * scale)  # straight lines between steps
        late = np.array([waves.elevation(sea, np.array([[x, z]]), t + 0.2)[0] for t in time])
        assert np.abs(table[f"{name}_m"] - late).max() > 0.02 * scale  # the sea moves: a later one is another
    bed = config.observers["gauges"].pressure["bed"]
    exact = np.array([pressure(sea, np.array([bed]), t, config.fluid.rest_density)[0] for t in time])
    np.testing.assert_allclose(table["bed_Pa"], exact, atol=2e-3 * 9.81e3 * scale)


def test_every_other_file_is_there_and_says_that_there_are_no_particles(run):
    _, folder = run
    facts = json.loads((folder / "manifest.json").read_text())
    assert facts["outcome"] == "done" and facts["particles"] == {"count": 0, "spacing_m": None, "mass_kg": None}
    assert "closed form" in (folder / "report.html").read_text()
    grid, frame = np.load(folder / "frames/grid.npz"), np.load(folder / "frames/frame_00001.npz")
    assert grid["has_surface"] and "position" not in frame and np.abs(frame["elevation"]).max() > 0.05
    assert len(read_columns(folder / "accuracy.csv")["time_step_s"]) == 11


def test_the_final_state_is_told_apart_by_its_hash(run, tmp_path):
    _, folder = run
    of = {}
    for name, over in {"same": {}, "later": {"duration": 1.1}, "other": {"fluid.spectrum.seed": 8}}.items():
        run_scene(load("linear_sea", {**OVER, **over}), tmp_path / name)
        of[name] = json.loads((tmp_path / name / "manifest.json").read_text())["state_sha256"]
    first = json.loads((folder / "manifest.json").read_text())["state_sha256"]
    assert of["same"] == first and len({first, of["later"], of["other"]}) == 3


def test_its_surface_can_be_exported_and_its_particles_cannot(run, tmp_path):
    _, folder = run
    assert len(export_run(folder, None, "ply", tmp_path)) == 3
    with pytest.raises(Failed, match="no particles"):
        export_run(folder, "vtkhdf", None, tmp_path)


def test_a_check_counts_no_particles_and_sees_frames_that_fill_a_disk():
    config = load("linear_sea", OVER)
    found = preflight(config)
    assert found["ok"] and found["particles"] == 0 and "0 particles" in preflight_lines(found, config)
    wide = load("linear_sea", {**OVER, "frames.spacing": 0.01, "frames.every": 0.01})
    assert "frames: about" in " ".join(wide.observers["frames"].warnings(wide.preflight))


def test_a_surface_that_would_follow_particles_is_refused(monkeypatch):
    class Drape(SurfaceConfig):
        kind: str = "drape"

        def ledger(self, preflight):
            return []

        def build(self, basin, fluid):
            raise NotImplementedError

    config_of, kinds = scene.config_of, composition.kinds
    of = lambda slot, kind: Drape if slot == "surface" else config_of(slot, kind)
    monkeypatch.setattr(scene, "config_of", of)
    monkeypatch.setattr(composition, "config_of", of)
    monkeypatch.setattr(composition, "kinds", lambda slot: ("drape",) if slot == "surface" else kinds(slot))
    basin = {"length": 40.0, "width": 40.0, "depth": 7.5}
    water = {"kind": "linear_waves", "height": 0.5, "period": 4.0}
    with pytest.raises(SceneError) as refused:
        load({"basin": basin, "fluid": water, "surface": "drape"})
    [problem] = refused.value.problems
    assert problem.key == "surface" and "linear_waves has none" in problem.message
    assert load({"basin": basin, "fluid": {"kind": "mueller", "spacing": 2.5}, "surface": "drape"}).surface is not None
