"""Pictures of a ship from frames that were made by hand: cameras, stills, strips, films, memory."""

import json
import re
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

from ocean_sim.__main__ import run_command_line
from ocean_sim.observers import render
from ocean_sim.pictures import frame_files
from ocean_sim.pictures.stage import opengl
from ocean_sim.pictures.stage.picture import picture_row
from ocean_sim.ship.hull.hull import hull_of
from ocean_sim.ship.hull.shapes import drawn_mesh

with_opengl = pytest.mark.skipif(opengl.probe() is not None, reason="no OpenGL on this machine")


def voyage(folder, count, every=0.1, ship=True):
    """Frames of flat water with a yacht under way that heels to starboard."""
    frames = folder / "frames"
    frames.mkdir(parents=True)
    (folder / "manifest.json").write_text("{}")
    x = np.arange(-29.0, 30.0, 2.0)
    grid = {"x": x, "z": x, "lower": [-30.0, -6.0, -30.0], "upper": [30.0, 0.0, 30.0], "depth": 6.0, "spacing": 2.0}
    hull = hull_of("yacht")
    vertices, triangles = drawn_mesh(hull.shape)
    centre = np.array(hull.centre_of_mass)
    kept = {"ship_vertices": vertices - centre, "ship_triangles": triangles, "ship_look": "yacht outline"}
    kept |= {"ship_helm": np.array([0.0, 4.2, 0.5]) - centre, "ship_still_water": [0.0, 1.0, 0.0, 0.1]}
    np.savez(
        frames / "grid.npz",
        **{k: np.asarray(v) for k, v in grid.items()},
        every=every,
        has_surface=True,
        **(kept if ship else {}),
    )
    for k in range(count):
        c, s = np.cos(0.15), np.sin(0.15)
        pose = {
            "ship_position": np.array([0.0, 0.4, 4.0 * every * k - 5.0]),
            "ship_turn": np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]),
        }
        elevation = 0.05 * np.sin(0.3 * x[:, None] + 0.0 * x - 0.1 * k)
        np.savez(frames / f"frame_{k:05d}.npz", time=every * k, elevation=elevation, **(pose if ship else {}))
    return folder


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return voyage(tmp_path_factory.mktemp("voyage"), 11)


def ask(capsys, *words):
    code = run_command_line([str(word) for word in words])
    return code, capsys.readouterr().err


def test_the_still_shows_a_ship_at_her_mean_immersion_on_a_rising_sea(tmp_path):
    """She bobs by 0.6 m with a period of 1.1 s, in water that rises and falls by 0.3 m within 3.9 s."""
    run = voyage(tmp_path / "run", 60)
    for k, path in enumerate(frame_files.frame_files(run)):
        kept = dict(np.load(path))
        kept["ship_position"] = kept["ship_position"] * [1.0, 0.0, 0.0] + [0.0, 0.6 * np.sin(0.57 * k), -5.0]
        kept["elevation"] = kept["elevation"] + 0.3 * np.sin(0.16 * k)
        np.savez(path, **kept)
    files, grid = frame_files.frame_files(run), np.load(run / "frames" / "grid.npz")
    still, _ = frame_files.survey_run(files, grid)
    ends = np.array([frame_files.ends_afloat(frame, grid) for frame in map(frame_files.Frame, files)])
    level, depth = np.moveaxis(ends, -1, 0)
    k = round(still.time / 0.1)
    away = depth - depth[30:].mean(axis=0)
    assert k >= 30 and level[k].mean() > level[k - 1].mean()
    assert np.abs(away[k]).max() < 0.2 < 0.6 < np.abs(away[30:]).max()


@pytest.mark.parametrize(
    "words, said",
    [
        (("--camera", "folow"), "'folow' is not a choice; did you mean 'follow'?"),
        (("--camera", "fixed"), "a fixed camera needs an eye and a target"),
        (("--eye", "1,2,3"), "eye and target belong to the camera fixed"),
        (("--camera", "fixed", "--eye", "1,2", "--target", "0,0,0"), "eye"),
        (("--size", "321x180"), "even width and height"),
        (("--size", "big"), "--size big: a size is width x height"),
        (("--stills", "0.2,soon"), "--stills 0.2,soon: these are not numbers"),
        (("--stills", "0.2,7"), "there is no picture at 7 s; the frames of this run reach from 0 to 1 s"),
        (("--fps", "0"), "--fps 0: choose"),
        (("--strip", "99"), "strip"),
    ],
)
def test_what_makes_no_sense_is_a_sentence(folder, capsys, words, said):
    code, err = ask(capsys, "render", folder, *words)
    assert code == 2 and said in err and not list(folder.glob("*.png"))


def test_a_camera_aboard_wants_a_ship(tmp_path, capsys):
    bare = voyage(tmp_path / "bare", 2, ship=False)
    for camera in ("follow", "first_person"):
        code, err = ask(capsys, "render", bare, "--camera", camera)
        assert code == 2 and f"camera {camera} needs a ship" in err


def test_a_film_shows_no_frame_twice_unless_asked_for_more(folder):
    """Frames lie 0.1 s apart; a film of 30 pictures a second would stand still in two of three."""
    for every, of_film in ((0.033, 0.1), (0.1, 0.1), (0.25, 0.25)):
        assert render.config_options(render.Config(every=every), folder)["every"] == pytest.approx(of_film)
    assert render.Config().film_pictures(1.0, kept=0.1) == 11


def test_a_film_begins_when_it_is_known_how_fast_ships_go(tmp_path):
    """A ship under way had no foam at her bow in the first picture of a film that was drawn during the run."""
    run, over = voyage(tmp_path / "run", 3), threading.Event()
    files = frame_files.frame_files(run)
    kept = [(path, path.read_bytes()) for path in files[1:]]
    for path in files[1:]:
        path.unlink()
    coming = render.ComingFrames(run, over)
    found: list = []
    drawing = threading.Thread(target=lambda: found.extend(coming.chosen(0.1)))
    drawing.start()
    time.sleep(3.0 * render.LOOK_INTERVAL)
    assert not found
    for path, data in kept:
        path.write_bytes(data)
    over.set()
    drawing.join(60.0)
    assert [path for path, _ in found] == files


def test_a_strip_is_pictures_side_by_side():
    pictures = [np.full((4, 6, 3), shade, np.uint8) for shade in (10, 20, 30)]
    strip = picture_row(pictures, gap=2)
    assert strip.shape == (4, 22, 3)
    assert (strip[:, [0, 8, 16]] == np.array([10, 20, 30])[None, :, None]).all() and (strip[:, 6:8] == 255).all()


@pytest.mark.slow
@with_opengl
def test_images_for_a_figure_are_the_same_whatever_else_is_drawn(folder):
    looks = {"camera": "follow", "size": (160, 90), "caption": False}
    several = render.variants(folder, 0.8, [{"stills": (0.2,)}, {}], **looks)
    alone = render.variants(folder, 0.8, [{}], **looks)
    assert several.shape == (2, 90, 160, 3) and several.dtype == np.uint8
    np.testing.assert_array_equal(several[1], alone[0])
    assert (several[0] != several[1]).any() and several.std() > 10.0
    assert not list(folder.glob("*.png"))


@pytest.mark.slow
@with_opengl
def test_from_the_helm_the_deck_is_below_and_from_the_side_the_sky_is_above(folder):
    [helm] = render.variants(folder, 0.5, [{}], camera="first_person", size=(160, 90), caption=False)
    beside = {"camera": "fixed", "eye": (40.0, 3.0, 0.0), "target": (0.0, 2.0, 0.0)}
    [side] = render.variants(folder, 0.5, [beside], size=(160, 90), caption=False)
    deck, sky, hull = helm[-3, 80].astype(int), side[3, 5].astype(int), side[45:60, 60:100].astype(int)
    assert deck[0] > deck[2] + 20  # planks are yellower than water and sky
    assert sky[2] > sky[0] and (np.ptp(hull, axis=2) > 30).any()


@with_opengl
def test_the_verb_draws_stills_a_strip_and_a_film_of_the_right_length(folder, tmp_path, capsys):
    import imageio.v2 as imageio

    words = (
        "--camera",
        "orbit",
        "--size",
        "128x72",
        "--quality",
        "draft",
        "--fps",
        "20",
        "--strip",
        "3",
        "--stills",
        "0.5",
    )
    code = run_command_line(["render", str(folder), *words, "--out", str(tmp_path), "--json"])
    files = json.loads(capsys.readouterr().out)["files"]
    assert code == 0 and [f.split("/")[-1] for f in files] == [
        "preview.png",
        "still_0000.500.png",
        "strip.png",
        "film.mp4",
        "moments.png",
    ]
    assert imageio.imread(tmp_path / "strip.png").shape == (72, 3 * 128 + 2 * render.STRIP_GAP, 3)
    film = imageio.get_reader(tmp_path / "film.mp4")
    assert film.get_meta_data()["duration"] == pytest.approx(1.05, abs=0.051) and film.count_frames() == 21
    run_command_line(
        ["render", str(folder), "--size", "64x64", "--no-film", "--quality", "draft", "--out", str(tmp_path / "b")]
    )
    assert [f.name for f in (tmp_path / "b").iterdir()] == ["preview.png"]


MEMORY = """
import json, sys, threading
from ocean_sim.observers import render
from ocean_sim.pictures.stage.render_order import Order
def resident():
    return int(open("/proc/self/statm").read().split()[1]) * 4096 / 1e6
over = threading.Event()
over.set()
sizes = [resident() for _ in render.draw_order(Order(**json.loads(sys.argv[1])), over)]
print("resident", max(sizes[20:120]), max(sizes[400:500]))
"""


@with_opengl
@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
def test_the_memory_of_a_film_of_500_pictures_is_flat(tmp_path):
    """The most that 100 pictures hold, early and late.

    A new texture of the sea (33.5 MB) is sent with each picture, and a driver in software frees old ones when it likes:
    none, one or two of them are still held at any single picture.
    """
    run = voyage(tmp_path / "long", 500, every=0.05)
    order = {"folder": str(run), "out": str(tmp_path), "camera": "follow", "size": (64, 64), "particles": False}
    order |= {"quality": "draft", "every": 0.05, "film": True}
    child = subprocess.run(
        [sys.executable, "-c", MEMORY, json.dumps(order)],
        env=opengl.drawing_environment(opengl.window()),
        capture_output=True,
        text=True,
        check=True,
    )
    early, late = (float(word) for word in re.search(r"resident (\S+) (\S+)", child.stdout).groups())
    assert late - early < 10.0  # MB; one more copy of the ship or the water a picture would be hundreds
