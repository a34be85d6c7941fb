import hashlib
import json
from types import SimpleNamespace

import numpy as np

from ocean_sim.observers import frames, manifest
from ocean_sim.parts import Preflight


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
    water = SimpleNamespace(lattice=lambda basin: SimpleNamespace(n=2_000_000, spacing=0.5))
    scene = Preflight({"fluid": water}, watched().basin, 4, 20.0)
    [sentence] = frames.Config().warnings(scene)
    assert sentence.startswith("frames: about 34.0 GB") and "frames.particles: false" in sentence
    assert frames.Config(particles=False).warnings(scene) == []
