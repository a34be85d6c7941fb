"""The preview without a window: keys and cameras; and, where Vulkan is there, its pictures."""

import ast
import gc
import json
import os
import socket
import subprocess
import sys
from math import radians
from pathlib import Path

import numpy as np
import pytest

from ocean_sim.__main__ import run_command_line
from ocean_sim.observers import preview
from ocean_sim.parts import PACKAGE
from ocean_sim.pictures.live import panel as panel_module
from ocean_sim.pictures.live import preview_scene, vulkan
from ocean_sim.pictures.live.panel import Panel
from ocean_sim.pictures.live.preview_scene import SPEED_COLOURS, PreviewScene
from ocean_sim.pictures.live.scene_lines import scene_lines, surface_heights
from ocean_sim.pictures.stage import opengl
from ocean_sim.pictures.water.water_shading import colour_scale
from ocean_sim.platform.shared.packets import unpack
from ocean_sim.reading.scene import load
from ocean_sim.verbs import preview as verb

with_vulkan = pytest.mark.usefixtures("vulkan_there")
CONFIG = preview.Config(size=(1280, 720))
HERE = os.environ | {"PYTHONPATH": str(PACKAGE.parent)}


class Wheel:
    """A person at the helm, as a ship gives it."""

    throttle = rudder = 0.0

    def give(self, throttle, rudder):
        self.throttle, self.rudder = min(max(throttle, -1.0), 1.0), min(max(rudder, -0.6), 0.6)


def test_keys_of_the_panel():
    panel = Panel()
    panel.press(" ")
    assert panel.paused
    panel.press(" ")
    panel.press("n")
    assert panel.paused and panel.take("step") and not panel.take("step")
    for wanted in ("helm", "top", "side", "third_person"):
        panel.press("c")
        assert panel.camera == wanted
    for wanted in ("particles", "both", "surface"):
        panel.press("v")
        assert panel.content == wanted
    panel.press("r")
    assert panel.take("reset")
    panel.orbit(0.2, 9.0)
    panel.zoom(0.5)
    assert (panel.height, panel.distance) == (panel_module.MIN_EYE_HEIGHT, 0.5)
    before = repr(panel)
    panel.press("?")
    assert repr(panel) == before
    panel.press("Escape")
    assert panel.closed


def test_throttle_and_brake_pedal_and_wheel():
    panel = Panel()
    panel.hold({"Up"}, 0.1)
    assert panel.take("helm") and panel.person is None  # the first touch takes the helm
    panel.person = Wheel()
    for _ in range(10):
        panel.hold({"Up", "Left"}, 0.1)
    assert panel.person.throttle == pytest.approx(panel_module.PEDAL_RATE)
    assert panel.person.rudder == pytest.approx(radians(20.0))  # positive turns to port
    panel.hold({"Down"}, 100.0)
    assert panel.person.throttle == -1.0
    panel.hold({"Left", "Right"}, 1.0)
    assert panel.person.rudder == pytest.approx(radians(20.0))
    panel.press("x")
    assert panel.person.rudder == 0.0 and panel.person.throttle == -1.0


def test_the_panel_says_how_things_stand_in_lines_that_fit(coarse):
    panel = Panel(ships=("ship",), ship="ship", message="long " * 40)
    panel.press(" ")
    lines = panel.text(coarse, 2.0, 0.5).splitlines()
    assert any("paused" in line for line in lines) and "camera: third_person" in lines
    assert any("throttle" in line and "rudder" in line for line in lines)
    assert max(len(line) for line in lines) <= 38  # fits the panel


@pytest.mark.parametrize("camera", ["third_person", "top", "side"])
@pytest.mark.parametrize("aspect", [16 / 9, 4 / 3])
def test_the_whole_basin_is_in_the_part_of_the_picture_that_no_panel_covers(coarse, camera, aspect):
    scene = PreviewScene(coarse)
    lower, upper = scene.box
    shown = scene.camera(Panel(camera, azimuth=0.7, height=0.4), aspect, 0.25)
    right = np.cross(shown.forward, shown.up)
    corners = np.array(list(np.ndindex(2, 2, 2))) * (upper - lower) + lower - shown.eye
    depth, half = corners @ shown.forward, np.tan(radians(shown.angle / 2))
    x = 0.5 + 0.5 * (corners @ right) / depth / half / aspect
    y = 0.5 + 0.5 * (corners @ shown.up) / depth / half
    assert (depth > shown.near).all() and (depth < preview.FAR_OVER_NEAR * shown.near).all()
    edge = 0.5 * (1.0 - preview_scene.FILLED_SHARE)  # left free above and below, and aside
    assert x.min() >= 0.25 + 0.75 * edge - 1e-9 and x.max() <= 1.0 - 0.75 * edge + 1e-9
    assert y.min() >= edge - 1e-9 and y.max() <= 1.0 - edge + 1e-9
    # ... and fills it along one side
    assert np.ptp(x) / 0.75 == pytest.approx(1.0 - 2.0 * edge) or np.ptp(y) == pytest.approx(1.0 - 2.0 * edge)


def test_the_eye_at_the_helm_moves_with_the_ship_and_looks_over_the_bow(coarse):
    ship = coarse.ships["ship"]
    shown = PreviewScene(coarse).camera(Panel("helm", ship="ship"), 1.5, 0.0)
    np.testing.assert_allclose(shown.eye, ship.body.position + ship.body.matrix @ ship.points["helm"])
    assert shown.forward @ ship.body.matrix[:, 2] > 0.99


def test_what_is_seen_lies_where_the_simulation_has_it(coarse):
    scene = PreviewScene(coarse)
    heights = surface_heights(coarse, scene.points)
    water = scene.water_patch(np.array([40.0, 20.0, 40.0]), solid=True)
    assert np.isfinite(water.colours).all() and water.colours.min() >= 0.0 and water.colours.max() <= 1.0
    assert water.triangles.max() < len(water.vertices)
    # the drawn surface goes through the surface of the simulation
    net = scene.water_patch(np.array([40.0, 20.0, 40.0]), solid=False)
    assert net.vertices[:, 1].mean() == pytest.approx(heights.mean(), abs=0.02)
    positions, tints = scene.particle_balls()
    assert len(positions) == coarse.fluid.particles.n == len(tints)
    hull = scene.ship_patch()
    low, high = hull.vertices.min(axis=0), hull.vertices.max(axis=0)
    assert len(hull.triangles) > 2000 and len(np.unique(hull.colours, axis=0)) > 100  # a model, painted and lit
    assert (low < coarse.ships["ship"].body.position).all() and (coarse.ships["ship"].body.position < high).all()
    ends, colours = scene_lines(coarse, scene.box[1][1])
    assert len(ends) == len(colours) and np.isfinite(ends).all()
    assert ends[..., 1].min() >= scene.lower[1] - 1e-9  # no volume is drawn below the bed
    assert scene.contents == ("surface", "particles", "both") and "helm" in scene.cameras


def test_colours_of_speed_brighten_evenly():
    """Told apart in grey, too."""
    grey = colour_scale(np.linspace(0.0, 1.0, 50), SPEED_COLOURS) @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(grey) > 0.0).all()


def test_a_person_steers_through_the_same_rate_limits_as_any_crew(coarse):
    ship, machine = coarse.ships["ship"], coarse.ships["ship"].actuators
    crew, before = machine.crew, ship.orders
    person = ship.hand_over()
    assert person.order(0.0, ship.body) == before  # nothing jumps when the helm changes hands
    person.give(0.8, 3.0)
    assert person.rudder == pytest.approx(machine.rudder_blade.limit)
    machine.steer(ship.body, 0.1)
    assert ship.orders[1] - before[1] == pytest.approx(0.1 * machine.rudder_blade.rate)
    for _ in range(200):
        machine.steer(ship.body, 0.1)
    assert ship.orders == (0.8, pytest.approx(machine.rudder_blade.limit))
    person.give(*before)
    for _ in range(200):
        machine.steer(ship.body, 0.1)
    machine.crew = crew


def test_only_the_preview_uses_the_window_library():
    for path in PACKAGE.rglob("*.py"):
        used = [n for n in ast.walk(ast.parse(path.read_text())) if isinstance(n, ast.Attribute) and n.attr == "ui"]
        assert not used or (path.name == "preview.py" and path.parent.name == "observers"), path


class Window:
    """Stands for the screen: plays keys, one list a picture, then closes."""

    def __init__(self, script):
        self.script, self.drawn, self.times, self.places = list(script), 0, [], []

    def watch(self, simulation, panel):
        self.simulation = simulation
        panel.ships, panel.ship, panel.person = tuple(simulation.ships), next(iter(simulation.ships), ""), None

    def listen(self, panel, seconds):
        held = self.script.pop(0) if self.script else ["Escape"]
        for key in held:
            panel.press(key)
        panel.hold(set(held), 0.1)

    def draw(self, panel, pace=None):
        self.drawn += 1
        self.times.append(self.simulation.time)
        self.places.append([ship.body.position.copy() for ship in self.simulation.ships.values()])

    def image(self):
        return np.zeros((4, 4, 3), np.uint8)

    def show(self):
        pass

    def close(self):
        pass


def test_a_window_is_played_with(tmp_path, monkeypatch):
    """Keys through the whole loop, on a sea in closed form."""
    scene, sets = "ship_linear_sea", {"runtime.threads": 1, "runtime.precision": "f64", "time_step.kind": "fixed"}
    sets["time_step.dt"] = 0.02
    window = Window([[" "], [], ["n"], [" "], ["Up", "p"], ["Up"], [], ["r"]])
    monkeypatch.setattr(
        verb.Session,
        "open",
        lambda self, show: self.__dict__.update(screen=window) or window.watch(self.simulation, self.panel),
    )
    session = verb.Session(load(scene, sets), tmp_path, True)
    session.play()
    times = window.times
    assert times[0] == times[1] == 0.0 and times[2] == pytest.approx(0.02)  # paused, then one step
    assert times[3] == pytest.approx(0.04) or times[3] > times[2]  # it goes on
    assert session.simulation.time < max(times)  # built anew
    assert [path.name for path in tmp_path.iterdir()] == ["snapshot_000.png"]
    session.close()


def test_who_steers_in_a_window_rides_on_the_platform_that_its_scene_streams_to(tmp_path):
    """Numbered pictures, which wait for no clock, send nothing."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listening:
        listening.bind(("127.0.0.1", 0))
        listening.settimeout(5.0)
        scene = {
            "basin": {"length": 60.0, "width": 60.0, "depth": 20.0, "walls": "none"},
            "fluid": {"kind": "linear_waves", "height": 0.5, "period": 4.0},
            "ship": {"kind": "hydrostatic", "hull": "yacht", "cells_per_draught": 3},
            "platform": {"kind": "hexapod", "ramp": 0.05},
            "motion": {"every": 0.02},
            "stream": {"to": f"udp://127.0.0.1:{listening.getsockname()[1]}"},
            "runtime": {"threads": 1, "precision": "f64"},
            "time_step": {"kind": "fixed", "dt": 0.02},
        }
        session = verb.Session(load(scene), tmp_path / "out", True)
        session.panel.ship = "ship"
        for _ in range(4):
            session.panel.hold({"Up", "Left"}, 0.1)
            session.obey()
            session.advance(0.05)
        assert session.panel.person.throttle > 0.0 and session.panel.person.rudder > 0.0
        assert unpack(listening.recv(4096)).seq == 0
        away = session.scratch.name
        session.close()
        assert not (tmp_path / "out").exists() and not Path(away).exists()
        film = verb.Session(load(scene), tmp_path / "out", False)
        assert not {type(each).__name__ for each in film.simulation.observers} & {"Motion", "PlatformLog", "Stream"}
        film.close()


def test_without_vulkan_or_a_screen_a_sentence_says_what_to_do(tmp_path, monkeypatch, capsys):
    command = ["preview", "ship_linear_sea", "--out", str(tmp_path / "out")]
    monkeypatch.setattr(vulkan, "draws", lambda show: False)
    assert run_command_line([*command, "--frames", "1"]) == 3
    assert "apt-get install --no-install-recommends libx11-6 mesa-vulkan-drivers" in capsys.readouterr().err
    monkeypatch.setattr(vulkan, "draws", lambda show: not show)
    assert run_command_line(command) == 3
    assert "--frames" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_without_a_display_no_window_is_tried(monkeypatch):
    for name in vulkan.SCREEN_VARIABLES:
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(opengl.subprocess, "run", lambda *a, **k: pytest.fail("a window was tried"))
    assert not vulkan.draws(show=True)


@pytest.mark.parametrize(
    "words, said",
    [
        (["--frames", "0"], "--frames"),
        (["--camera", "nowhere", "--frames", "1"], "preview.camera"),
        (["--content", "fish", "--frames", "1"], "preview.content"),
        (["--set", "preview.size=[100, 100]", "--frames", "1"], "960 x 640"),
    ],
)
def test_wrong_input_is_a_sentence(words, said, tmp_path, capsys):
    assert run_command_line(["preview", "ship_linear_sea", "--out", str(tmp_path / "out"), *words]) == 2
    captured = capsys.readouterr()
    assert said in captured.err + captured.out and not (tmp_path / "out").exists()


def test_pictures_are_never_written_over_others(tmp_path, capsys):
    (tmp_path / "00000.png").write_bytes(b"")
    assert run_command_line(["preview", "ship_linear_sea", "--frames", "1", "--out", str(tmp_path)]) == 2
    assert "there are pictures here already" in capsys.readouterr().err


@pytest.fixture
def screen():
    """A hidden window, gone for certain before Taichi may start anew."""
    shown = [preview.Screen(CONFIG, show=False)]
    yield shown[0]
    shown.pop().close()
    gc.collect()


@with_vulkan
def test_pictures_without_a_window(coarse, screen):
    """Every camera and content; the first picture has its panel, as the second; a key changes the next picture."""
    panel = CONFIG.first_panel()
    screen.watch(coarse, panel)
    screen.draw(panel)
    first = screen.image()
    screen.draw(panel)
    second = screen.image()
    assert first.shape == (1280, 720, 3)
    left = slice(0, preview.PANEL_WIDTH)
    np.testing.assert_array_equal(first[left], second[left])
    assert (first[left].min(axis=2) > 200).sum() > 2000  # letters
    pictures = {}
    for camera in panel.cameras:
        for content in panel.contents:
            panel.camera, panel.content = camera, content
            screen.draw(panel)
            pictures[camera, content] = screen.image()[preview.PANEL_WIDTH + 20 :]
    seen = list(pictures.values())
    assert all(np.abs(a.astype(int) - b).mean() > 1.0 for k, a in enumerate(seen) for b in seen[:k])
    assert all(picture.std() > 15.0 for picture in seen)
    panel.camera, models = "third_person", screen.scene.models
    screen.scene.models = {}
    for content in panel.contents:
        panel.content = content
        screen.draw(panel)
        without = screen.image()[preview.PANEL_WIDTH + 20 :].astype(int)
        changed = np.abs(pictures["third_person", content] - without).max(axis=2) > 30
        assert changed.sum() > 1000  # the ship
    screen.scene.models, panel.hidden = models, True
    screen.draw(panel)
    bare = screen.image()
    assert np.abs(bare[left].astype(int) - second[left]).mean() > 10.0 and bare[left].std() > 10.0


@with_vulkan
def test_as_an_observer_it_leaves_pictures_in_the_run_folder(coarse, tmp_path, monkeypatch):
    monkeypatch.setattr(preview, "require", lambda show: None)
    observer = CONFIG.model_copy(update={"every": coarse.time}).build(tmp_path, coarse)
    observer.observe(coarse)
    observer.observe(coarse)  # the same moment is drawn once
    observer.close()
    assert [path.name for path in (tmp_path / "preview").iterdir()] == ["00000.png"]


def test_a_run_without_vulkan_goes_on_without_pictures(coarse, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(vulkan, "draws", lambda show: False)
    observer = CONFIG.build(tmp_path, coarse)
    observer.observe(coarse)
    observer.close()
    assert not list(tmp_path.iterdir())
    assert "no preview: this machine has no Vulkan" in capsys.readouterr().err


@with_vulkan
def test_the_command_writes_numbered_pictures(tmp_path):
    """In a process of its own, which must end well."""
    words = ["--frames", "2", "--out", str(tmp_path / "out"), "--set", "runtime.threads=1", "--json"]
    command = [sys.executable, "-m", "ocean_sim", "preview", "ship_linear_sea", *words]
    child = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300, cwd=tmp_path, env=HERE)
    assert child.returncode == 0, child.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["out"]  # nothing but what was asked for
    facts = json.loads(child.stdout)
    assert facts["pictures"] == 2 and facts["simulated_s"] >= 1.0 / 30.0
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["00000.png", "00001.png", "film.mp4"]
    import matplotlib.image

    assert matplotlib.image.imread(tmp_path / "out" / "00001.png").shape == (720, 1280, 3)
