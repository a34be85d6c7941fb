"""What pictures add to the water of a run: wakes, a wanted cover of foam, boxes of concrete; and sets of pictures."""

import shutil
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

from ocean_sim.observers import frames, render
from ocean_sim.pictures.stage import opengl, wind_marks
from ocean_sim.pictures.stage.camera import camera_looking
from ocean_sim.pictures.stage.plotter import Stage
from ocean_sim.pictures.water import water_shading
from ocean_sim.wind import Drawing
from ocean_sim.wind.gusts import joined
from ocean_sim.wind.shared import place

with_opengl = pytest.mark.skipif(opengl.probe() is not None, reason="no OpenGL on this machine")


@with_opengl
def test_the_volumes_of_a_wind_are_told_apart_by_their_lines():
    box = place.Core(half=(1.0, 2.0, 3.0), radius=0.0, yaw=0.3, centre=np.zeros(3)).edges()
    lines = np.concatenate([box, box + [20.0, 0.0, 0.0]])[np.random.default_rng(1).permutation(24)]
    stage = Stage((64, 64), camera_looking(np.array([0.0, 9.0, 60.0]), np.zeros(3)), 1)
    marks = wind_marks.WindMarks(stage, np.full(3, -20.0), np.full(3, 20.0))
    marks.show_volumes(lines, 0.0)
    edges, walls = (stage.plotter.actors[name].mapper.dataset for name in ("edges of volumes", "volumes"))
    rings = edges.points[edges.lines.reshape(2, 6)[:, 1:]]  # each ends where it begins
    for ring in rings:
        sides = np.linalg.norm(np.diff(ring, axis=0), axis=1)
        np.testing.assert_allclose(np.sort(sides), [2.0, 2.0, 6.0, 6.0], atol=1e-5)
    assert np.ptp(rings.mean(axis=1)[:, 0]) == pytest.approx(20.0, abs=4.0)
    assert walls.bounds[2:4] == pytest.approx((-0.2 * 40.0, 0.10 * 40.0))
    marks.show_volumes(lines[:0], 0.0)
    assert "volumes" not in stage.plotter.actors
    stage.close()


@pytest.mark.parametrize("centre", [(0.0, 0.0, 0.0), (0.0, 2.0, 5.0), (10.0, 0.0, 0.0)])
def test_a_round_wind_volume_is_drawn_once(centre):
    """The ends of its rings differ by rounding where a coordinate is 0."""
    lines = place.Core(half=(0.0, 0.0, 0.0), radius=3.0, yaw=0.0, centre=np.array(centre)).edges().astype(np.float32)
    stage = Stage((64, 64), camera_looking(np.array([0.0, 9.0, 60.0]), np.zeros(3)), 1)
    marks = wind_marks.WindMarks(stage, np.full(3, -20.0), np.full(3, 20.0))
    marks.show_volumes(lines, 0.0)
    edges = stage.plotter.actors["edges of volumes"].mapper.dataset
    assert edges.n_cells == 1
    assert np.hypot(*(edges.points[:, [0, 2]] - np.array(centre)[[0, 2]]).T) == pytest.approx(3.0, rel=1e-4)
    stage.close()


def blown(arrows: list[float], strongest: float, unit: str):
    along = np.outer(arrows, [1.0, 0.0, 0.0])
    return SimpleNamespace(wind_arrows=along, wind_tails=0.0 * along, wind_strongest=strongest, wind_unit=unit)


def test_what_an_arrow_of_the_wind_stands_for_is_written_at_one_as_long_as_it_is_drawn():
    """Length 1 is the strongest, drawn 0.13 of the basin long: 2 m/s2 of 2.5 are 0.104 of it."""
    assert wind_marks.arrow_legend(blown([0.7, 1.0], 2.5, "m/s²"), 40.0) == (
        pytest.approx(0.104 * 40.0),
        "acceleration by wind, 2 m/s²",
    )
    assert wind_marks.arrow_legend(blown([0.5], 10.0, "m/s"), 40.0) == (pytest.approx(0.13 * 40.0), "wind, 10 m/s")
    assert wind_marks.arrow_legend(blown([0.0], 0.0, "m/s²"), 40.0) == (0.0, "wind: noise alone")
    assert wind_marks.arrow_legend(blown([], 0.0, ""), 40.0) == (0.0, "no wind")
    push, speed = (Drawing(np.zeros((0, 2, 3)), np.zeros((1, 3)), np.ones((1, 3)), 3.0, u) for u in ("m/s²", "m/s"))
    assert (joined([push, push]).strongest, joined([push, push]).unit) == (3.0, "m/s²")
    assert (joined([push, speed]).strongest, joined([push, speed]).unit) == (0.0, "")


def test_no_slope_of_a_map_is_so_steep_that_it_is_black():
    """A steep pit among gentle waves, at the height of the pale crests around it."""
    slope = np.append(np.random.default_rng(1).normal(0.0, 0.05, 400), [0.9, -0.9])
    normals = np.stack([-slope, np.ones_like(slope), -slope], axis=1) / np.hypot(1.0, np.sqrt(2.0) * slope)[:, None]
    bright = water_shading.relief_light(normals, np.full(len(slope), 0.8)).mean(axis=1)
    flat = water_shading.relief_light(np.array([[0.0, 1.0, 0.0]]), np.array([0.8])).mean()
    assert bright.min() > 0.5 * flat and bright.max() < 1.5 * flat


@with_opengl
def test_a_wind_is_drawn_where_it_blows(tmp_path, watched):
    simulation = watched((0.02,))
    simulation.fluid.rise = 0.0
    corners = place.Core(half=(1.0, 1.5, 1.0), radius=0.0, yaw=0.0, centre=np.zeros(3)).edges()
    tails = np.array([[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]])
    blowing = Drawing(corners, tails, np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]))  # an arrow and a cross
    simulation.wind.drawing = lambda: blowing
    simulation.observers = [frames.Config(every=0.1).build(tmp_path, simulation)]
    simulation.run(until=0.1)
    looks = [{"wind": on, "camera": camera} for camera in ("third_person", "top") for on in (False, True)]
    pictures = render.variants(tmp_path, 0.0, looks, size=(320, 180), caption=False).astype(int)
    without, with_wind, plain, marked = pictures
    changed = np.abs(with_wind - without).max(axis=2) > 8
    painted = (with_wind[..., 0] > with_wind[..., 2] + 60) & changed
    assert 0.01 < changed.mean() < 0.5 and painted.sum() > 30
    assert not (without[..., 0] > without[..., 2] + 60).any()
    rows, columns = np.nonzero(np.abs(marked - plain).max(axis=2) > 4)
    filled = len(rows) / (np.ptp(rows) + 1) / (np.ptp(columns) + 1)
    assert 0.1 < filled < 0.6  # on a map a volume is its outline, and the colours of heights stay as they are


@pytest.fixture(scope="module")
def tank(tmp_path_factory):
    """One frame of still water with, in `grid.npz`, a box that stands out of it."""
    folder = tmp_path_factory.mktemp("tank")
    (folder / "frames").mkdir()
    axis = np.arange(-3.75, 4.0, 0.5)
    box = np.array([[[-1.0, -2.0, -1.0], [1.0, 1.0, 1.0]]])
    ground = {"x": axis, "z": axis, "lower": [-4.0, -2.0, -4.0], "upper": [4.0, 0.0, 4.0], "depth": 2.0}
    ground |= {"spacing": 0.5, "every": 1.0, "has_surface": True, "obstacles": box}
    np.savez(folder / "frames" / "grid.npz", **{key: np.array(value) for key, value in ground.items()})
    np.savez(folder / "frames" / "frame_00000.npz", time=0.0, elevation=np.zeros((16, 16)))
    (folder / "manifest.json").write_text('{"scene": {"basin": {"obstacles": [1]}}}')
    return folder


@with_opengl
@pytest.mark.parametrize("body", ["box", "mesh", "moving mesh"])
def test_an_obstacle_is_drawn_as_grey_concrete_in_blue_water(tank, body, tmp_path):
    if body != "box":
        mesh = trimesh.creation.box([2.0, 3.0, 2.0], trimesh.transformations.translation_matrix([0.0, -0.5, 0.0]))
        shutil.copytree(tank, tmp_path, dirs_exist_ok=True)
        name, key = ("grid", "meshes") if body == "mesh" else ("frame_00000", "moving_meshes")
        for file, more in (("grid", {"obstacles": np.zeros((0, 2, 3))}), (name, {key: np.array(mesh.triangles)})):
            path = tmp_path / "frames" / f"{file}.npz"
            np.savez(path, **dict(np.load(path)) | more)
        tank = tmp_path
    pictures = render.variants(tank, 0.0, [{"camera": "top"}, {"camera": "third_person"}], size=(160, 120))
    assert pictures.shape == (2, 120, 160, 3)
    top = pictures[0].astype(float)
    red, _, blue = top[55:65, 75:85].mean(axis=(0, 1))
    assert red > 0.9 * blue  # concrete in the middle
    red, _, blue = top[55:65, 110:115].mean(axis=(0, 1))
    assert red < 0.8 * blue  # water beside it


@with_opengl
def test_a_wavemaker_and_an_absorbing_zone_are_seen_at_their_ends_of_a_tank(tank, tmp_path):
    """Of a plate at -x that has gone 0.2 m into the basin, and a zone of 2 m before +x."""
    zone, plate = [[[2.0, -2.0, -4.0], [4.0, 0.24, 4.0]]], [[[-4.1, -2.0, -4.0], [-4.0, 0.24, 4.0]]]
    folders = {"none": {}, "zone": {"zones": np.array(zone)}, "plate": {"plates": np.array(plate)}}
    for name, more in folders.items():
        shutil.copytree(tank, tmp_path / name)
        for file, kept in (("grid", {"obstacles": np.zeros((0, 2, 3))} | more), ("frame_00000", {})):
            path = tmp_path / name / "frames" / f"{file}.npz"
            np.savez(path, **dict(np.load(path)) | kept | {"plate_way": np.array([0.2, 0.0, 0.0])})
    shots = [{"folder": str(tmp_path / name)} for name in folders]
    bare, *fitted = render.variants(tmp_path / "none", 0.0, shots, size=(320, 180), caption=False).astype(int)
    columns = [np.nonzero((np.abs(one - bare).max(axis=2) > 8).any(axis=0))[0] for one in fitted]
    assert columns[0].min() > 150 and len(columns[0]) > 20  # the zone: right
    assert columns[1].max() < 170 and len(columns[1]) > 10


def test_a_set_of_pictures_at_a_time_without_frames_is_refused(tank):
    with pytest.raises(render.RenderFailed, match="reach from 0 to 0 s"):
        render.variants(tank, 3.0, [{}], size=(160, 120))
