import hashlib
import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ocean_sim import waves
from ocean_sim.basin import shifts
from ocean_sim.basin.points import grid_points
from ocean_sim.observers import frames, manifest, render
from ocean_sim.parts import SceneFacts
from ocean_sim.pictures.stage import opengl
from ocean_sim.pictures.water import foam
from ocean_sim.pictures.water.waterline import ship_coordinates
from ocean_sim.reading.scene import load
from ocean_sim.result import run
from ocean_sim.waves.orbits import surface_fall

with_opengl = pytest.mark.skipif(opengl.probe() is not None, reason="no OpenGL on this machine")


def test_a_frame_is_the_first_state_at_or_after_its_time(tmp_path, watched):
    simulation = watched((0.013, 0.004))
    simulation.fluid.rise = 0.0
    simulation.observers = [frames.Config(every=0.05).build(tmp_path, simulation)]
    simulation.run(until=0.3)
    files = sorted((tmp_path / "frames").iterdir())
    assert [f.name for f in files] == [f"frame_{k:05d}.npz" for k in range(7)] + ["grid.npz"]
    grid, frame = np.load(files[-1]), np.load(files[3])
    assert 0.15 <= frame["time"] < 0.15 + 0.013
    assert frame["elevation"].shape == (len(grid["x"]), len(grid["z"])) == (12, 8)
    simulation.fluid.time = float(frame["time"])
    exact = simulation.fluid.elevations([(grid["x"][2], grid["z"][5])])
    np.testing.assert_allclose(frame["elevation"][2, 5], exact, rtol=1e-6)
    assert frame["position"].dtype == frame["velocity"].dtype == np.float32
    assert frame["position"].shape == (simulation.fluid.particles.n, 3) and frame["id"].dtype.kind == "i"
    assert bool(grid["has_surface"])


def with_a_ship(simulation, x: float, z: float):
    """The run with a ship in it, at a place [m]."""
    at = np.array([x, 0.0, z])
    body = SimpleNamespace(position=at, matrix=np.eye(3), velocity=np.zeros(3))
    body.point, body.point_velocity = (lambda arm: at + arm), (lambda arm: np.zeros(3))
    triangle = np.eye(3), np.arange(3)[None]
    simulation.ships = {"ship": SimpleNamespace(name="ship", body=body, points={}, drawn=lambda: triangle)}
    simulation.scene.ships = {"ship": SimpleNamespace(look=lambda preflight: None)}
    simulation.scene.preflight = None
    return simulation


def test_a_ship_off_the_middle_of_a_tank_moves_no_frame(tmp_path, watched):
    simulation = with_a_ship(watched(), 1.5, -2.0)
    frames.Config().build(tmp_path, simulation).observe(simulation)
    grid, frame = np.load(tmp_path / "frames/grid.npz"), np.load(tmp_path / "frames/frame_00000.npz")
    exact = simulation.fluid.elevations(grid_points(grid["x"], grid["z"]))
    np.testing.assert_allclose(frame["elevation"].ravel(), exact, rtol=1e-5, atol=1e-6)
    assert "origin" not in frame


def test_frames_of_a_sea_that_answers_lie_around_the_ship(tmp_path, watched, monkeypatch):
    """Within half a cell of her, and the heights are those of there."""
    simulation = with_a_ship(watched(), 300.0, -2.0)
    sea = waves.regular_wave(0.5, 4.0, np.array([0.0, 1.0]), 5.0)
    monkeypatch.setattr(type(simulation.fluid), "plane_waves", sea, raising=False)
    monkeypatch.setattr(type(simulation.fluid), "can_be_disturbed", True, raising=False)
    frames.Config().build(tmp_path, simulation).observe(simulation)
    grid, frame = np.load(tmp_path / "frames/grid.npz"), np.load(tmp_path / "frames/frame_00000.npz")
    cell = [grid["x"][1] - grid["x"][0], grid["z"][1] - grid["z"][0]]
    assert (np.abs(frame["origin"] - [300.0, -2.0]) <= np.multiply(0.5, cell)).all()
    assert np.allclose(frame["origin"] / cell, np.round(frame["origin"] / cell), atol=1e-4)
    there = grid_points(grid["x"], grid["z"]) + frame["origin"]
    np.testing.assert_allclose(frame["elevation"].ravel(), simulation.fluid.elevations(there), atol=1e-4)
    known = frame["elevation"] - frame["answer"]
    np.testing.assert_allclose(known.ravel(), waves.elevation(sea, there, simulation.time), atol=1e-4)


def test_a_slice_and_loose_particles_have_no_surface_to_draw(tmp_path, watched):
    simulation = watched(width=None)
    frames.Config(particles=False).build(tmp_path, simulation).observe(simulation)
    grid, frame = np.load(tmp_path / "frames/grid.npz"), np.load(tmp_path / "frames/frame_00000.npz")
    assert not grid["has_surface"] and frame["elevation"].shape == (12, 1) and "position" not in frame


def test_the_manifest_says_what_was_run_and_how_it_ended(tmp_path, watched):
    simulation = watched()
    simulation.observers = [manifest.Config().build(tmp_path, simulation)]
    assert json.loads((tmp_path / "manifest.json").read_text())["outcome"] == "running"
    simulation.run(until=0.1)
    facts = json.loads((tmp_path / "manifest.json").read_text())
    assert (facts["outcome"], facts["steps"], facts["simulated_s"], facts["seed"]) == ("done", 10, 0.1, 7)
    assert facts["backend"] == {"arch": "cpu", "threads": 2, "precision": "f32"}
    assert facts["scene_sha256"] == hashlib.sha256(json.dumps(facts["scene"], sort_keys=True).encode()).hexdigest()
    assert facts["versions"]["numpy"] == np.__version__
    before = facts["state_sha256"]
    particles = simulation.fluid.particles
    for field in (particles.position, particles.velocity, particles.id):
        field.values = field.values[::-1].copy()
    assert manifest.state_sha256(simulation) == before  # storage order does not matter
    particles.position.values[0, 0] += 1e-3
    assert manifest.state_sha256(simulation) != before


def test_frames_that_would_fill_a_disk_are_announced(watched):
    water = SimpleNamespace(lattice=lambda basin: SimpleNamespace(n=2_000_000), point_spacing=lambda known: 0.5)
    scene = SceneFacts({"fluid": water}, watched().basin, 4, 20.0)
    [sentence] = frames.Config().warnings(scene)
    assert sentence.startswith("frames: about 38.9 GB") and "frames.particles: false" in sentence
    assert frames.Config(particles=False).warnings(scene) == []


def test_the_velocity_of_a_large_sea_is_that_of_its_waves_at_every_point_up_to_the_rim():
    """Waves of which 60 fit side by side are not told from each other at a few hundred points."""
    spectrum = waves.Spectrum(significant_wave_height=0.5, peak_period=2.0, heading_deg=30.0, seed=3)
    sea = spectrum.components(waves.heading_vector(30.0, 3), 20.0)
    x, z = np.arange(101) * 2.0 - 100.0, np.arange(91) * 2.0 - 90.0
    found = waves.surface_velocity(sea, grid_points(x, z), 3.0).reshape(101, 91, 3)
    for i, k in [(0, 0), (100, 90), (37, 44), (98, 3)]:
        angle = sea.wavevector @ [x[i], z[k]] - sea.omega * 3.0 + sea.phase
        rising = (sea.amplitude * sea.omega * np.sin(angle)).sum()
        towards = sea.wavevector[0] / sea.wavenumber[0]
        along = (sea.amplitude * sea.omega / np.tanh(sea.wavenumber * 20.0) * np.cos(angle)).sum() * towards
        np.testing.assert_allclose(found[i, k], [along[0], rising, along[1]], atol=1e-9)


def test_particles_of_a_patch_are_kept_around_the_ship_and_triangles_stay_whole():
    from ocean_sim.surface import Mesh

    origin, period = np.array([0.0, 37.0]), (20.0, 0.0, 20.0)
    x = np.random.default_rng(0).uniform(-10.0, 10.0, (200, 3))
    moved = x + shifts(x, origin, period)
    assert np.abs(moved[:, 2] - 37.0).max() <= 10.0 and np.abs(moved[:, 0]).max() <= 10.0
    np.testing.assert_array_equal(moved[:, 1], x[:, 1])
    corners = np.array([[0.0, 0.0, -9.0], [1.0, 0.0, -9.0], [0.0, 0.0, -8.0], [1.0, 0.0, 9.0], [0.0, 0.0, 9.5]])
    faces = np.array([[0, 2, 1], [3, 4, 1]])
    there = frames.move_triangles(Mesh(corners, faces[:1], 0.0 * corners), origin, period)
    sides = there.vertices[there.triangles[0]] - there.vertices[there.triangles[0, 0]]
    np.testing.assert_allclose(sides, corners[faces[0]] - corners[faces[0, 0]], atol=1e-12)
    assert np.abs(there.vertices[:, 2] - 37.0).max() <= 11.0


def test_cells_without_particles_move_as_those_around_them():
    """Particles below the layer, which go the other way, do not count; nor does the noise of single ones."""
    x = np.arange(8.0)
    points, top = grid_points(x, x), np.full((8, 8), -1.0)
    keep = np.ones(64, bool)
    keep[[10, 37]] = False
    at, down = np.insert(points, 1, 0.0, axis=1), np.insert(points, 1, -3.0, axis=1)
    noise = np.where((points.sum(axis=1) % 2 == 0)[:, None], 0.9, -0.9)
    found = SimpleNamespace(
        position=np.concatenate([at[keep], down]),
        velocity=np.concatenate([np.array([1.0, 2.0, 3.0]) + noise[keep], np.full((64, 3), -50.0)]),
    )
    velocity = frames.topmost_velocity(found, points, top, (0.0, 0.0, 0.0))
    assert np.abs(velocity - [1.0, 2.0, 3.0]).max() < 0.35
    found.position = found.position - [0.0, 9.0, 0.0]
    assert not frames.topmost_velocity(found, points, top, (0.0, 0.0, 0.0)).any()


def test_a_sea_that_is_there_from_the_beginning_bears_foam_of_every_age(tmp_path, watched, monkeypatch):
    """One that grows from calm water bears none."""
    simulation = watched()
    spectrum = waves.Spectrum(kind="jonswap", significant_wave_height=1.5, peak_period=5.5, seed=7)
    sea = spectrum.components(waves.heading_vector(30.0, 3), 30.0)
    simulation.fluid.particles = None
    monkeypatch.setattr(type(simulation.fluid), "plane_waves", sea, raising=False)
    monkeypatch.setattr(
        type(simulation.fluid), "velocities", lambda self, places: waves.velocity(sea, places, 0.0), raising=False
    )
    seen = frames.Config().build(tmp_path, simulation)
    points = 12.0 * seen.points
    seen.cell = seen.white.cell = 12.0 * seen.cell
    seen.whiten_past_sea(simulation, points)
    white = seen.white.white
    assert white.mean() > 0.003
    assert np.median(white[white > 0.05]) < 0.7  # of what is born at once nearly all is 1
    monkeypatch.setattr(type(simulation.fluid), "plane_waves", replace(sea, ramp=5.0), raising=False)
    later = frames.Config().build(tmp_path, simulation)
    later.whiten_past_sea(simulation, points)
    assert not later.white.white.any()


COLUMN, LEDGE = [[-1.5, -1.0, -0.5], [-0.5, 0.0, 0.5]], [[-0.5, -1.0, -0.5], [1.5, -0.4, 0.5]]  # [m] corners


def let_go(
    folder: Path, *boxes: list[list[float]], duration: float, surface: str | None = None, scale: float = 1.0
) -> Path:
    """The run of water that begins at rest in these boxes, all lengths times `scale`."""
    basin = {"length": 3.0 * scale, "width": scale, "depth": scale}
    fill = [dict(zip(("min", "max"), (scale * np.array(box)).tolist(), strict=True)) for box in boxes]
    fluid = {"kind": "mueller", "spacing": 0.1 * scale, "fill": fill}
    scene = {"basin": basin, "fluid": fluid, "duration": duration, "frames": {"every": 0.1}, "render": None}
    run(load(scene | ({} if surface is None else {"surface": surface})), folder)
    return folder


def test_water_at_rest_is_not_white_however_steep_its_edge(tmp_path):
    """A column that is let go; a moment later its edge falls, and is."""
    kept = let_go(tmp_path / "run", COLUMN, duration=0.3) / "frames"
    first, later = (np.load(kept / f"frame_{k:05d}.npz") for k in (0, 3))
    assert not first["velocity"].any() and not first["foam"].any() and first["cover"] == 0.0
    assert surface_fall(first["elevation"].astype(float), 0.1, 0.1).max() > foam.BREAKING_CONVERGENCE
    assert later["foam"].any() and later["cover"] > 0.0


@with_opengl
@pytest.mark.parametrize(
    ("boxes", "surface", "later", "scale"), [((COLUMN,), "marching_cubes", 0.8, 1.0), ((COLUMN, LEDGE), None, 0.9, 5.0)]
)
def test_a_picture_of_water_at_rest_has_no_white_water(tmp_path, boxes, surface, later, scale):
    """In a tank, and in an open sea, whose waves go on beyond the basin; as it meets the far side, or a moment later,
    there is some in both."""
    folder = let_go(tmp_path / "run", *boxes, duration=later, surface=surface, scale=scale)
    looks = [{"foam": on, "stills": (time,)} for time in (0.0, later) for on in (False, True)]
    without, rest, bare, white = render.variants(folder, 0.0, looks, size=(320, 180), caption=False).astype(int)
    assert np.abs(rest - without).max() <= 1
    assert (np.abs(white - bare).max(axis=2) > 30).sum() > 30


@pytest.mark.parametrize("turned", [0.0, 0.6])
def test_the_hollow_in_which_a_hull_lies_is_no_trough_beside_a_crest(tmp_path, watched, turned):
    """Where the water does not tell the ship's part apart: the heights are those of the sea around her, and no others
    change."""
    simulation = with_a_ship(watched(), 0.5, -0.5)
    sailing = simulation.ships["ship"]
    sailing.body.matrix = Rotation.from_euler("y", turned).as_matrix()
    sailing.drawn = lambda: (np.array([[-0.4, 0.0, -1.0], [0.4, 0.0, 1.0], [0.0, -0.5, 0.0]]), np.arange(3)[None])
    seen = frames.Config(spacing=0.25).build(tmp_path, simulation)
    x, z = seen.points.T
    calm = 0.1 * np.sin(0.4 * x - 0.3 * z).reshape(seen.shape)
    ahead, aside = ship_coordinates(x, z, sailing.body.position, sailing.body.matrix)
    hull = ((np.abs(ahead) < 1.0) & (np.abs(aside) < 0.4)).reshape(seen.shape)
    found = seen.breaking_heights(simulation, seen.points, calm - 2.0 * hull, np.zeros(2))
    changed = found != calm - 2.0 * hull
    assert hull.sum() >= 10 and changed[hull].all() and changed.sum() < 4 * hull.sum()
    assert np.abs(found - calm).max() < 0.03


def test_the_waves_of_a_ship_bear_no_whitecaps_however_long_she_goes(tmp_path, watched, monkeypatch):
    """Her hollow is as steep as her hull: the sea around her is as white as without her."""
    spectrum = waves.Spectrum(kind="jonswap", significant_wave_height=1.5, peak_period=5.5, seed=7)
    sea, white = spectrum.components(waves.heading_vector(30.0, 3), 30.0), {}
    for deep in (0.0, 3.0):
        simulation = with_a_ship(watched(), 0.0, 0.0)
        water = type(simulation.fluid)

        def undisturbed_elevations(self, points, elevation=None):
            return waves.elevation(sea, 12.0 * np.asarray(points), self.time)

        def elevations(self, points, deep=deep):
            astern = 3.0 - 2.0 * self.time - np.asarray(points)[:, 1]
            wake = np.where(astern > 0.0, 0.3 * np.cos(3.0 * astern), 0.0) - np.exp(-(astern**2))
            return self.undisturbed_elevations(points) + deep * wake * np.exp(-(np.asarray(points)[:, 0] ** 2))

        for name, value in {"plane_waves": sea, "can_be_disturbed": True, "elevations": elevations}.items():
            monkeypatch.setattr(water, name, value, raising=False)
        monkeypatch.setattr(water, "undisturbed_elevations", undisturbed_elevations, raising=False)
        monkeypatch.setattr(water, "velocities", lambda self, places: 0.0 * places, raising=False)
        monkeypatch.setattr(water, "foam", lambda self, points: None, raising=False)
        simulation.fluid.particles = None
        seen = frames.Config(every=0.1).build(tmp_path, simulation)
        seen.cell = seen.white.cell = 12.0 * seen.cell
        for n in range(30):
            simulation.time = simulation.fluid.time = 0.1 * n
            seen.observe(simulation)
        white[deep] = seen.white.white
    assert white[0.0].mean() > 0.003
    np.testing.assert_array_equal(white[3.0], white[0.0])
