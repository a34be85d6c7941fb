"""Pictures are checked where OpenGL is there; everywhere, that its absence is a sentence and never a crash."""

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

import ocean_sim
from ocean_sim.basin import points as points_module
from ocean_sim.observers import frames, render
from ocean_sim.pictures import frame_files
from ocean_sim.pictures.stage import camera as camera_module
from ocean_sim.pictures.stage import opengl
from ocean_sim.pictures.stage import sky as sky_module
from ocean_sim.pictures.stage.picture import fitting_size
from ocean_sim.pictures.water import water_mesh, water_shading
from ocean_sim.reading.scene import load
from tests.processes import alive, children, wait_for, wait_for_end

with_opengl = pytest.mark.skipif(opengl.probe() is not None, reason="no OpenGL on this machine")


@pytest.fixture
def kept(tmp_path, watched):
    def build(width=4.0, **config):
        simulation = watched((0.02,), width=width)
        simulation.fluid.rise = 0.0
        simulation.observers = [frames.Config(every=0.1, **config).build(tmp_path, simulation)]
        simulation.run(until=0.4)
        return tmp_path

    return build


def test_fresnel_against_published_values():
    angles = np.radians([0.0, 30.0, 45.0, 60.0, 75.0, 85.0, 89.0])
    exact = [0.02037, 0.02144, 0.02790, 0.05969, 0.21238, 0.58352, 0.89628]
    np.testing.assert_allclose(water_shading.fresnel(np.cos(angles)), exact, atol=6e-6)
    assert water_shading.fresnel(np.array([0.0]))[0] == pytest.approx(1.0)


def test_flat_water_mirrors_the_sky_at_grazing_angles_and_shows_itself_from_above():
    origin, up = np.zeros((1, 3)), np.array([[0.0, 1.0, 0.0]])
    above = water_shading.surface_light(origin, up, np.zeros(1), np.array([0.0, 50.0, 0.1]))
    grazing = water_shading.surface_light(origin, up, np.zeros(1), np.array([50.0, 1.0, 0.0]))
    assert above.sum() < 0.5 * grazing.sum()
    assert np.isfinite(above).all() and np.isfinite(grazing).all()


def test_the_sky_is_finite_and_not_negative_in_every_direction():
    directions = sky_module.unit_vector(np.random.default_rng(0).normal(size=(1000, 3)))
    for colour in (sky_module.clear_sky(directions), sky_module.sky_and_ground(directions)):
        assert np.isfinite(colour).all() and (colour >= 0.0).all()


def test_the_smooth_surface_keeps_a_level_goes_through_its_points_and_stands_level_at_walls():
    x, z = points_module.middles(-3.0, 3.0, 0.5), points_module.middles(-2.0, 2.0, 0.5)
    mesh = water_mesh.WaterMesh(x, z, np.array([-3.0, -2.0, -2.0]), np.array([3.0, 2.0, 2.0]), nodes=2000)
    np.testing.assert_allclose(mesh.surface(np.full((12, 8), 0.3))[0][:, 1], 0.3, atol=1e-12)
    wave = np.cos(np.pi * (x + 3.0) / 6.0)[:, None] * np.ones(8)
    points, normals = mesh.surface(wave)
    assert abs(points[:, 1] - np.cos(np.pi * (points[:, 0] + 3.0) / 6.0)).max() < 2e-3
    steepness = -normals[:, 0] / normals[:, 1]
    exact = -np.pi / 6.0 * np.sin(np.pi * (points[:, 0] + 3.0) / 6.0)
    assert abs(steepness - exact).max() < 0.03
    sides = mesh.sides(points)
    assert sides[:, 1].min() == -2.0 and len(sides) == len(mesh.side_normals) == len(mesh.side_depth)
    corners = sides[mesh.side_triangles]
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.isfinite(facing).all() and len(facing) > 0


@pytest.mark.parametrize("name", ["third_person", "top", "side"])
@pytest.mark.parametrize("size", [(40.0, 7.5, 40.0), (8.0, 1.0, 0.5), (2.0, 9.0, 30.0)])
def test_every_camera_sees_the_whole_basin(name, size):
    upper = 0.5 * np.array(size)
    camera = camera_module.camera_on_box(name, -upper, upper, 16.0 / 9.0)
    right = np.cross(camera.forward, camera.up)
    corners = np.array(list(np.ndindex(2, 2, 2))) * 2.0 * upper - upper - camera.eye
    away = corners @ camera.forward
    half = camera.parallel_height or away * np.tan(np.radians(camera_module.VIEW_ANGLE / 2))
    assert (away > 0.0).all()
    assert (np.abs(corners @ camera.up) <= half).all() and (np.abs(corners @ right) <= half * 16.0 / 9.0).all()


def test_the_film_takes_the_nearest_frame_in_real_time():
    times = np.array([0.0, 0.034, 0.066, 0.101, 0.133])
    assert frame_files.film_frames(times, 0.033) == [0, 1, 2, 3, 4]
    assert frame_files.film_frames(times, 0.066) == [0, 2, 4]
    assert frame_files.film_frames(times[:1], 0.033) == [0]


def test_pictures_are_chosen_as_soon_as_no_later_frame_can_change_them():
    times = np.cumsum(np.random.default_rng(4).uniform(0.01, 0.08, 60))
    for every in (0.02, 0.033, 0.1):
        chosen = frame_files.film_frames(times, every)
        for n in range(1, len(times) + 1):
            already = frame_files.film_frames(times[:n], every, ended=False)
            assert already == chosen[: len(already)] and times[n - 1] - times[0] - every < every * len(already)


def test_of_a_run_that_is_over_the_frames_are_drawn_that_are_left(tmp_path):
    """Of one that goes on, those are that came without a gap."""
    (tmp_path / "frames").mkdir()
    for k in (0, 1, 3, 4):
        np.savez(frame_files.frame_path(tmp_path, k), time=0.1 * k)
    over = threading.Event()
    coming = render.ComingFrames(tmp_path, over)
    assert coming.log.times == pytest.approx([0.0, 0.1])
    over.set()
    coming.wait()
    assert coming.log.times == pytest.approx([0.0, 0.1, 0.3, 0.4])
    frame_files.frame_path(tmp_path, 0).unlink()
    assert render.ComingFrames(tmp_path, over).log.times == pytest.approx([0.1, 0.3, 0.4])


@pytest.mark.parametrize("size", [(961, 540), (960, 541), (0, 0), (960,), (20000, 540)])
def test_a_size_that_no_film_can_have_is_refused_at_once(size):
    with pytest.raises(ValidationError):
        render.Config(size=size)


def test_pictures_of_a_long_slice_are_as_high_as_it_needs():
    """Its ends are in the picture as before; tall slices and tanks have the size of all pictures."""
    lower, upper = np.array([-5.0, -0.4, 0.0]), np.array([5.0, 0.25, 0.0])
    width, height = fitting_size(lower, upper, True)
    assert width == 1280 and height % 2 == 0 and 0.25 < (1280 / 11.0 * 0.65) / height < 0.5
    camera = camera_module.camera_on_box("side", lower, upper, width / height)
    assert camera.parallel_height * width / height == pytest.approx(5.5)
    assert fitting_size(lower, upper, False) == fitting_size(lower, lower + [2.0, 2.0, 0.0], True) == (1280, 720)


def test_missing_opengl_is_a_sentence(kept, watched, monkeypatch, capsys):
    folder = kept()
    monkeypatch.setattr(opengl, "window", lambda: None)
    with pytest.raises(render.OpenGLMissing, match="apt-get install --no-install-recommends libegl1 libgl1-mesa-dri"):
        render.render_run(folder)
    render.Render(render.Config(), folder, watched()).close()
    assert "no pictures: this machine has no OpenGL" in capsys.readouterr().err
    assert "libegl1" in render.probe()


@pytest.mark.anchor
def test_a_drawing_process_that_dies_is_a_sentence(kept, monkeypatch, tmp_path):
    folder, forgotten = kept(), []
    monkeypatch.setattr(opengl, "window", lambda: "vtkEGLRenderWindow")
    monkeypatch.setattr(opengl, "forget", lambda: forgotten.append(True))
    monkeypatch.setattr(sys, "executable", script(tmp_path, "kill -SEGV $$"))
    with pytest.raises(render.RenderFailed, match="died"):
        render.render_run(folder)
    assert forgotten


def test_a_drawing_process_is_ended_with_what_it_has_started(kept, monkeypatch, tmp_path):
    """Its encoder, and the film that is not finished."""
    folder, noted = kept(), tmp_path / "encoder"
    monkeypatch.setattr(opengl, "window", lambda: "vtkEGLRenderWindow")
    words = f"sleep 60 &\ntouch {folder}/.film.$$.tmp.mp4\necho $! > {noted}\nwait"
    monkeypatch.setattr(sys, "executable", script(tmp_path, words))
    drawer = render.Drawer([render.order_of(folder)], goes_on=True)
    wait_for("the number of the encoder", lambda: noted.exists() and noted.read_text().strip())
    child, encoder = drawer.child.pid, int(noted.read_text())
    drawer.stop()
    assert not alive(encoder) and not alive(child)
    assert not list(folder.glob(".film*"))


def script(folder, words):
    """A program of the shell, in place of Python."""
    file = folder / "python"
    file.write_text(f"#!/bin/sh\n{words}\n")
    file.chmod(0o755)
    return str(file)


def led_by(process):
    """The processes that its threads have started, and their commands."""
    led = {}
    for n in children(process):
        with suppress(FileNotFoundError, ProcessLookupError):
            led[n] = Path(f"/proc/{n}/cmdline").read_text()
    return led


def drawing_and_encoding(process):
    """The process that draws by turns with it and the encoder of its film, as soon as both are there."""
    found = []

    def both_are_there():
        led = led_by(process)
        second = [n for n, command in led.items() if "ocean_sim.observers.render" in command]
        encoder = [n for n, command in led.items() if "ffmpeg" in command and "film" in command]
        found[:] = [*second[:1], *encoder[:1]]
        return second and encoder

    wait_for("a drawing process and the encoder of its film", both_are_there)
    return tuple(found)


def test_after_an_interruption_the_drawing_process_is_ended(kept, watched, monkeypatch):
    ended, simulation = [], watched()
    observer = render.Render(render.Config(), kept(), simulation)
    observer.drawer = type("Drawer", (), {"stop": lambda self: ended.append(True)})()
    simulation.reason = "interrupted"
    observer.close()
    assert ended


def test_the_probe_believes_only_what_was_drawn(monkeypatch):
    def child(command, **how):
        return subprocess.CompletedProcess(command, -11, stdout="drawn by vtkEGLRenderWindow", stderr="")

    monkeypatch.setattr(opengl.subprocess, "run", child)
    assert not opengl.draws("vtkEGLRenderWindow")


def test_after_an_interruption_nobody_waits_for_a_film(kept, watched, capsys):
    folder, simulation = kept(), watched()
    simulation.reason = "interrupted"
    render.Render(render.Config(), folder, simulation).close()
    assert "ocean-sim render" in capsys.readouterr().err and not (folder / "film.mp4").exists()


def test_a_still_at_the_end_of_a_run_is_of_the_last_frame(kept, watched, monkeypatch, capsys):
    folder, drawn = kept(), []  # frames from 0 to 0.4 s, 0.1 s apart
    monkeypatch.setattr(render, "render_run", lambda folder, **options: drawn.append(options["stills"]))
    assert render.obstacle_to_pictures(folder, "third_person", [0.0, 0.45, 0.49]) is None
    assert "no picture at 0.6 s; the frames of this run reach from 0 to 0.4 s" in render.obstacle_to_pictures(
        folder, "top", [0.6]
    )
    render.Render(render.Config(stills=[0.2, 0.49, 3.0]), folder, watched()).close()
    assert drawn == [(0.2, 0.49)]
    assert capsys.readouterr().err.startswith(
        "there is no picture at 3 s; the frames of this run reach from 0 to 0.4 s"
    )


def test_an_interrupt_while_pictures_are_drawn_is_told_once_by_the_verb(kept, watched, monkeypatch, capsys):
    """In the sentence that `tests/test_progress.py` has, which names what draws them."""

    def interrupted(folder, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(render, "render_run", interrupted)
    with pytest.raises(KeyboardInterrupt):
        render.Render(render.Config(), kept(), watched()).close()
    assert capsys.readouterr().err == ""


def test_a_report_is_written_before_the_pictures_and_again_after_them(tmp_path, monkeypatch):
    seen = []
    scene = {"basin": {"length": 20.0, "width": 20.0, "depth": 5.0, "walls": "none"}, "duration": 0.05}
    scene |= {"fluid": {"kind": "linear_waves", "height": 0.5, "period": 3.0}, "runtime": {"threads": 1}}

    class Drawer:
        def __init__(self, orders, progress, goes_on):
            self.folder = Path(orders[0].folder)
            assert goes_on and not (self.folder / "report.html").exists()  # it begins while the run goes on

        def finish(self):
            seen.append((self.folder / "report.html").read_text())
            (self.folder / "strip.png").write_bytes(b"")
            if len(seen) == 1:
                raise KeyboardInterrupt

    monkeypatch.setattr(render, "Drawer", Drawer)
    with pytest.raises(KeyboardInterrupt):
        ocean_sim.run(scene, tmp_path / "a")
    assert "done at t = " in seen[0] and (tmp_path / "a" / "report.html").read_text() == seen[0]
    ocean_sim.run(scene, tmp_path / "b")
    assert '<a href="strip.png">' in (tmp_path / "b" / "report.html").read_text()


def test_a_run_without_frames_has_nothing_to_draw(tmp_path, watched):
    render.Render(render.Config(), tmp_path, watched()).close()
    with pytest.raises(render.RenderFailed, match="has no frames to draw"):
        render.render_run(tmp_path)


@with_opengl
def test_water_is_drawn_and_filmed(kept):
    import imageio.v2 as imageio

    folder, drawn = kept(), []
    files = render.render_run(folder, size=(320, 180), every=0.1, progress=lambda done, of: drawn.append((done, of)))
    picture = np.asarray(imageio.imread(files[0]))
    assert picture.shape == (180, 320, 3) and picture.std() > 20.0
    sky, water = picture[5, 300].astype(float), picture[90, 160].astype(float)
    assert sky.sum() > water.sum() and water[2] > water[0]  # light above, blue below
    film = imageio.get_reader(files[1])
    assert film.get_meta_data()["size"] == (320, 180) and film.get_meta_data()["fps"] == pytest.approx(10.0)
    assert film.count_frames() == 5 and drawn[-1] == (5, 5)


@with_opengl
@pytest.mark.parametrize("painters", [1, 2])
def test_pictures_drawn_while_a_run_goes_on_are_those_drawn_afterwards_to_the_byte(painters, kept, tmp_path):
    folder, going = kept(), tmp_path / "going"
    asked = {"size": (160, 90), "every": 0.1, "stills": (0.2,)}
    after = render.render_run(folder, out=tmp_path / "after", **asked)
    (going / "frames").mkdir(parents=True)
    files = frame_files.frame_files(folder)
    for path in (folder / "frames" / "grid.npz", *files[:2]):
        shutil.copy(path, going / "frames")
    drawn = []
    order = render.order_of(going, painters=painters, **asked)
    drawer = render.Drawer([order], lambda done, of: drawn.append((done, of)), goes_on=True)
    wait_for("the first picture", lambda: drawn)
    for path in files[2:]:
        shutil.copy(path, going / "frames" / "coming")
        os.replace(going / "frames" / "coming", going / "frames" / path.name)
    drawer.finish()
    assert drawn[0] == (1, 0) and drawn[-1] in [(5, 0), (5, 5)]  # the last is told of before the run is over, or after
    for path in after:
        assert path.read_bytes() == (going / path.name).read_bytes(), path.name


def test_processes_take_the_pictures_of_a_film_by_turns_and_none_is_drawn_twice(tmp_path):
    (tmp_path / "frames").mkdir()
    for k in range(4):
        np.savez(frame_files.frame_path(tmp_path, k), time=0.1 * k)
    over = threading.Event()
    over.set()

    def taken(every, of):
        return [
            (int(file.stem[-5:]), whose)
            for file, _, whose in render.film_turns(render.ComingFrames(tmp_path, over), every, of)
        ]

    assert taken(0.1, 1) == [(0, 0), (1, 0), (2, 0), (3, 0)]
    assert taken(0.1, 3) == [(0, 0), (1, 1), (2, 2), (3, 0)]
    assert taken(0.06, 2) == [(0, 0), (1, 1), (1, None), (2, 0), (2, None), (3, 1)]


@with_opengl
@pytest.mark.parametrize("painters, asked", [(2, {}), (3, {"camera": "orbit", "stills": (0.2,)})])
def test_a_film_is_the_same_to_the_byte_however_many_processes_draw_it(painters, asked, kept, tmp_path):
    """Of five frames, some of them shown twice."""
    folder, made = kept(), []
    for n in (1, painters):
        files = render.render_run(folder, out=tmp_path / str(n), size=(160, 90), every=0.06, painters=n, **asked)
        made.append([path.read_bytes() for path in files])
    assert made[0] == made[1]


@pytest.mark.parametrize("words, told", [("kill -SEGV $$", r"died \(signal 11\)"), ("echo no >&2; exit 1", "^no$")])
def test_a_second_drawing_process_that_ends_is_a_sentence(words, told, tmp_path, monkeypatch):
    monkeypatch.setattr(opengl, "forget", lambda: None)
    monkeypatch.setattr(sys, "executable", script(tmp_path, words))
    with render.Painter(render.order_of(tmp_path), threading.Event(), 1) as painter:
        with pytest.raises(render.RenderFailed, match=told):
            painter.picture((64, 64))


@with_opengl
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
@pytest.mark.parametrize("killed", ["second", "first", "asking"])
def test_no_drawing_process_outlives_another(killed, kept, tmp_path):
    """Of two that draw a film, the one that is killed takes the other and the encoder with it, and leaves no film; so
    does the end of the process that has asked for it."""
    drawer = render.Drawer([render.order_of(kept(), every=0.1, painters=2)], goes_on=True)
    first = drawer.child.pid
    second, encoder = drawing_and_encoding(first)
    assert alive(second) and alive(encoder)
    if killed == "asking":
        drawer.child.stdin.close()  # as the system does for a process that has died
    else:
        os.kill({"first": first, "second": second}[killed], signal.SIGKILL)
    wait_for_end(second)
    if killed == "asking":
        drawer.stop()
    else:
        with pytest.raises(render.RenderFailed, match=r"died \(signal 9\)"):
            drawer.finish()
    wait_for_end(first, encoder)  # the encoder is nobody's child here: it may take a moment
    assert not list(tmp_path.glob("*film*"))


@with_opengl
@pytest.mark.parametrize("width, asked", [(None, {}), (4.0, {"particles": True})])
def test_particles_are_drawn_where_there_is_no_surface_or_on_request(kept, width, asked):
    import imageio.v2 as imageio

    [file] = render.render_run(kept(width), size=(320, 180), film=False, **asked)
    assert np.asarray(imageio.imread(file)).std() > 20.0


@with_opengl
def test_particles_that_were_not_kept_are_a_sentence(kept):
    with pytest.raises(render.RenderFailed, match=r"frames\.particles: true"):
        render.render_run(kept(particles=False), particles=True)


@with_opengl
def test_a_surface_that_folds_is_drawn_as_its_triangles_are(kept):
    """A ball of water in the frames of a sea: its outline is in the picture, the block of water is not."""
    import imageio.v2 as imageio

    folder = holding_a_ball(kept())
    picture = np.asarray(imageio.imread(render.render_run(folder, size=(320, 180), film=False)[0])).astype(float)
    middle, beside = picture[90, 160], picture[90, 40]
    assert middle[2] > middle[0] + 20.0 and middle.sum() < beside.sum()  # blue and dark before the sky
    assert np.ptp(beside) < 60.0


@with_opengl
def test_water_is_seen_through_water(kept):
    """A second ball behind the first makes its rim darker, one beside it does not."""
    import imageio.v2 as imageio

    asked = {"size": (320, 180), "film": False, "camera": "fixed", "eye": (0.0, -1.0, 9.0), "target": (0.0, -1.0, 0.0)}
    shown = []
    for further in ([], [(0.0, -1.0, -0.9)], [(2.0, -1.0, 0.9)]):
        folder = holding_balls(kept(), [(0.0, -1.0, 0.9), *further])
        picture = np.asarray(imageio.imread(render.render_run(folder, **asked)[0])).astype(float)
        shown.append(picture[60:120, 130:160].mean(axis=2))  # a half of the ball, thin at its rim
    assert (shown[0] - shown[1] > 8.0).sum() > 60
    assert not (np.abs(shown[0] - shown[2]) > 8.0).any()


@with_opengl
def test_from_above_a_tank_has_a_light_bed_before_which_water_tells_how_thick_it_is(kept):
    import imageio.v2 as imageio

    folder = holding_a_ball(kept())
    [file] = render.render_run(folder, size=(320, 180), film=False, camera="top")
    picture = np.asarray(imageio.imread(file)).astype(float)
    light = (picture.min(axis=2) > 150.0).sum(axis=0) > 45  # columns of the bed, which is wider than the ball
    assert light.sum() > 60 and not light[:8].any()
    assert picture[90, 160].sum() < picture[90, np.flatnonzero(light)[4]].sum() - 60.0
    towards, off = (picture[90 + k - 2 : 90 + k + 3, 160 + k - 2 : 160 + k + 3].mean() for k in (-14, 14))
    assert towards > 1.3 * off  # slopes are lit from the upper left


def holding_a_ball(folder: Path) -> Path:
    """Frames whose water is a ball, 1 m across from its middle, in place of a surface."""
    return holding_balls(folder, [(0.0, -1.0, 0.0)])


def holding_balls(folder: Path, middles: list[tuple[float, float, float]]) -> Path:
    """Frames whose water is balls around these middles [m]."""
    import pyvista

    balls = [pyvista.Sphere(radius=1.0, center=middle) for middle in middles]
    vertices = np.concatenate([ball.points for ball in balls])
    starts = np.cumsum([0] + [ball.n_points for ball in balls])
    for path in frame_files.frame_files(folder):
        frame = dict(np.load(path)) | {
            "vertices": vertices,
            "triangles": np.concatenate([ball.regular_faces + n for ball, n in zip(balls, starts)]),
            "normals": np.concatenate([ball.points - np.float32(at) for ball, at in zip(balls, middles)]),
        }
        np.savez(path, **frame)
    return folder


@pytest.mark.parametrize("of, pictures, painters", [(1, 1000, 1), (2, 1000, 2), (16, 1000, 2), (2, 10, 1)])
def test_short_films_and_films_on_one_core_are_drawn_by_one_process(of, pictures, painters, tmp_path, monkeypatch):
    """As is a film of a run of unknown length."""
    monkeypatch.setattr(render, "available_cores", lambda: of)
    assert render.order_of(tmp_path).painters == 1
    (tmp_path / "manifest.json").write_text(json.dumps({"scene": {"duration": 0.1 * pictures}}))
    assert render.order_of(tmp_path, every=0.1).painters == painters


def test_of_a_film_that_processes_draw_by_turns_no_core_idles_but_while_they_start(monkeypatch):
    sea = {"basin": {"length": 9.0, "width": 9.0, "depth": 2.0}, "fluid": {"kind": "mueller", "spacing": 0.5}}
    scene = load(sea | {"duration": 100.0, "frames": {"every": 0.1}, "render": {"every": 0.1, "size": [1280, 720]}})
    film, first = 1001 * render.PICTURE_SECONDS[3]["draft"], render.START_SECONDS[3]
    for of, wall in ((1, first + film), (2, 0.5 * film)):
        monkeypatch.setattr(render, "available_cores", lambda: of)
        assert wall <= scene.observers["render"].picture_time(scene.preflight) <= wall + first


def test_check_warns_of_stills_after_the_end_and_of_pictures_without_frames():
    sea = {"basin": {"length": 9.0, "width": 9.0, "depth": 2.0}, "fluid": {"kind": "mueller", "spacing": 0.5}}
    sea |= {"duration": 2.0}
    late = "stills at 2.1, 5 s are never drawn: the run ends at 2 s"
    assert late in " ".join(load(sea | {"render": {"stills": [1.0, 2.0, 2.1, 5.0]}}).warnings())
    assert "never drawn" not in " ".join(load(sea | {"render": {"stills": [1.0, 2.0]}}).warnings())
    assert "nothing to draw" in " ".join(load(sea | {"frames": None, "render": {}}).warnings())
    plain = load(sea | {"frames": None})
    assert "render" not in plain.observers and not any("render" in sentence for sentence in plain.warnings())
