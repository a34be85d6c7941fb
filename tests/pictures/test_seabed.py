"""A bed with a profile in pictures, files and pages: drawn as sand, with no water across it where it is dry."""

import json

import numpy as np
import pytest

from ocean_sim.basin import Config as Tank
from ocean_sim.observers import frames, render
from ocean_sim.pictures.export.paraview import export_run
from ocean_sim.pictures.frame_files import kept_ground
from ocean_sim.pictures.stage import opengl
from ocean_sim.viewer.replay import Recorded
from tests.viewer import page_packets

with_opengl = pytest.mark.skipif(opengl.probe() is not None, reason="no OpenGL on this machine")
BEACH = {"profile": [[-3.0, -2.0], [-2.0, -2.0], [3.0, 1.0]]}  # the still water ends at x = 1.33 m
SECTION = 0.5 * 5.0 * 3.0  # [m2] of the beach above the flat bed


@pytest.fixture
def kept(tmp_path, watched):
    """A run folder of a sea with a beach, still at height 0."""

    def build(width=4.0, **config):
        simulation = watched((0.1,), width=width, floor=BEACH)
        simulation.fluid.rise = 1e-9
        simulation.observers = [frames.Config(every=0.1, **config).build(tmp_path, simulation)]
        simulation.run(until=0.1)
        (tmp_path / "manifest.json").write_text(json.dumps({"scene": {}}))
        return tmp_path

    return build


def test_the_body_of_a_bed_is_closed_and_faces_outwards():
    for width, breadth in ((4.0, 4.0), (None, 0.5)):
        basin = Tank.model_validate({"length": 6.0, "depth": 2.0, "width": width, "floor": BEACH}).build()
        corners, normals = basin.ground.body_mesh(breadth)
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2.0
        np.testing.assert_allclose(across.sum(axis=0), 0.0, atol=1e-12)
        plate = 6.0 * (-2.0 - corners[..., 1].min())
        volume = np.einsum("ij,ij->", corners.mean(axis=1), across) / 3.0
        assert 0.0 < plate < 0.3 and volume == pytest.approx(breadth * (SECTION + plate), rel=1e-12)
        np.testing.assert_allclose(normals * np.linalg.norm(across, axis=1)[:, None], across, atol=1e-12)


def test_the_sheet_of_water_ends_at_the_shore():
    """Where its particles touch the bed it is a film; else it lies below the bed, though a wave in front is higher."""
    ground = Tank.model_validate({"length": 6.0, "depth": 2.0, "width": 4.0, "floor": BEACH}).build().ground
    x = np.arange(-2.9, 3.0, 0.1)
    places, bed = np.stack([x, 0.0 * x], axis=1), np.maximum(-2.0, 0.6 * x - 0.8)
    water = np.where(x < 1.0, 0.5, -2.0)  # a bore before a dry beach
    film = np.array([[1.5, 0.1 + 0.05, 0.0], [2.8, 2.0, 0.0]])  # one on the bed, one in the air
    sheet = ground.sheet_heights(places, water, film, 0.1)
    wet, near = x < 0.95, np.abs(x - 1.5) < 0.12
    np.testing.assert_array_equal(sheet[wet], 0.5)
    assert (sheet[near] > bed[near]).all() and (sheet[near] <= bed[near] + 0.25 + 1e-9).all()
    assert (sheet[~wet & ~near] < bed[~wet & ~near]).all() and (sheet[x > 1.9] <= bed[x > 1.9] - 0.05 + 1e-9).all()
    np.testing.assert_array_equal(ground.sheet_heights(places, bed + 1.0, film, 0.1), bed + 1.0)
    dry = ground.sheet_heights(places, np.full(len(x), -2.0), film[1:], 0.1)
    assert (dry < bed).all() and (dry > ground.foot).all()


def sand(picture: np.ndarray) -> np.ndarray:
    """Mask of the pixels that look like sand: red before green before blue."""
    red, green, blue = np.moveaxis(picture.astype(float), -1, 0)
    return (red > green + 4.0) & (green > blue + 10.0)


@with_opengl
@pytest.mark.parametrize("width", [4.0, None])
def test_a_beach_is_drawn_as_sand_that_rises_out_of_the_water(kept, width):
    import imageio.v2 as imageio

    [file] = render.render_run(kept(width), size=(320, 180), film=False, camera="side")
    shown = sand(np.asarray(imageio.imread(file)))
    columns = shown[:, 20:300].sum(axis=0)
    assert 0.06 < shown.mean() < 0.5
    assert columns[-20:].mean() > 4 * max(columns[:20].mean(), 1.0)  # the beach is on the right


@with_opengl
def test_from_above_no_sheet_of_water_covers_the_dry_sand(kept):
    import imageio.v2 as imageio

    [file] = render.render_run(kept(), size=(320, 180), film=False, camera="top")
    picture = np.asarray(imageio.imread(file))
    shown = sand(picture)[60:120]
    wet = (picture[60:120, :, 2].astype(float) > picture[60:120, :, 0] + 40.0).all(axis=0)
    dry = shown.all(axis=0)
    across = np.flatnonzero(wet | dry)
    shore = (dry.sum()) / len(across)
    assert shore == pytest.approx((3.0 - 4.0 / 3.0) / 6.0, abs=0.09) and not dry[: across[0] + 40].any()


def test_the_bed_is_in_the_files_for_other_programs_and_in_the_page(kept):
    import trimesh

    folder = kept()
    [file] = export_run(folder, None, None, folder / "export", scene="glb")
    volume = trimesh.load(file).geometry["ground"].volume
    assert 4.0 * SECTION < volume < 1.1 * 4.0 * SECTION
    assert (folder / "export" / "ground_00000.ply") in export_run(folder, None, "ply", folder / "export")
    run = Recorded(folder)
    head, arrays = page_packets.unpack(run.still())
    assert head["tank"] and arrays["ground"].shape == arrays["ground_normals"].shape
    low, high = arrays["ground"].min(axis=0), arrays["ground"].max(axis=0)
    np.testing.assert_allclose([low[0], low[2], *high], [-3.0, -2.0, 3.0, 1.0, 2.0])
    assert kept_ground(run.grid).heights(np.array([[0.0, 1.0]])) == pytest.approx([-0.8])
