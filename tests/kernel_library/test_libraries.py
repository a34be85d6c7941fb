"""What compiles the kernels: Taichi, or its fork Quadrants, which is the way on when Taichi no longer installs."""

import json
import os
import subprocess
import sys

import pytest

from ocean_sim import kernel_library, runtime
from ocean_sim.pictures.live import vulkan

TANK = {"basin": {"length": 2.0, "width": 1.2, "depth": 0.5}, "duration": 1.0}
TANK |= {"time_step": {"kind": "fixed", "dt": 0.002}}
COLUMN = [{"min": [-1.0, -0.5, -0.6], "max": [-0.2, -0.1, 0.6]}]
BARGE = {"shape": {"kind": "box", "length": 0.6, "breadth": 0.4, "height": 0.3}, "mass": 12.0}
BLOWN = {
    "include": [{"kind": "box", "centre": [0.0, 0.0, 0.0], "half_size": [0.5, 0.5, 0.5]}],
    "noise": [2.0, 2.0, 2.0],
}
SCENES = {
    "a barge under a gust": {
        "fluid": {"kind": "mueller", "spacing": 0.1},
        "wind": {"kind": "gusts", "volumes": [BLOWN | {"acceleration": [3.0, 1.0, 0.0], "drift": [1.0, 0.0, 0.0]}]},
        "surface": "cloth",
        "ship": {"kind": "hydrostatic", "hull": BARGE},
        "runtime": {"threads": 1, "precision": "f32"},
    },
    "a column in cubes": {
        "fluid": {"kind": "delta_sph", "spacing": 0.1, "fill": COLUMN},
        "surface": "marching_cubes",
        "runtime": {"threads": 1, "precision": "f64"},
    },
    "a column that keeps its volume": {
        "fluid": {"kind": "dfsph", "spacing": 0.1, "fill": COLUMN},
        "runtime": {"threads": 1, "precision": "f64"},
    },
}
ROUNDING = {"f32": 2e-4, "f64": 1e-11}  # in single precision, forces that nearly cancel leave 5e-5 m/s
MOVED = """
import json, numpy, ocean_sim
found = {}
for name, scene in SCENES.items():
    with ocean_sim.Simulation(ocean_sim.load(scene, {"runtime.library": LIBRARY})) as simulation:
        for _ in range(20):
            simulation.step()
        particles, surface = simulation.fluid.particles, simulation.surface
        order = numpy.argsort(particles.id.to_numpy())
        seen = [simulation.fluid.positions()[order], particles.velocity.to_numpy()[order]]
        if surface is not None:
            seen += [surface.elevations(numpy.linspace([-0.9, -0.5], [0.9, 0.5], 9)), surface.mesh().area]
        for ship in simulation.ships.values():
            seen += [ship.body.position, ship.body.velocity]
        found[name] = numpy.concatenate([numpy.ravel(one).astype(float) for one in seen]).tolist()
print(json.dumps(found))
"""


def process(script: str, library: str) -> subprocess.CompletedProcess[str]:
    """A process that computes with a library."""
    environment = {**os.environ, kernel_library.LIBRARY_VARIABLE: library}
    return subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=False)


def moved(library: str) -> dict[str, list[float]]:
    """Water, surface and ship of each scene after 0.04 s: places, speeds, heights and an area [m, s]."""
    scenes = {name: TANK | scene for name, scene in SCENES.items()}
    done = process(MOVED.replace("SCENES", repr(scenes)).replace("LIBRARY", repr(library)), library)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def test_another_library_than_the_process_computes_with_is_refused(monkeypatch):
    other = runtime.RuntimeConfig(library="quadrants" if kernel_library.LIBRARY_NAME == "taichi" else "taichi")
    said = r"runtime.library: .* was chosen, but this process already computes"
    with pytest.raises(runtime.BackendMissing, match=said):
        runtime.start(other)


def test_a_library_that_nobody_knows_is_named():
    done = process("import ocean_sim.kernel_library", "numba")
    assert "OCEAN_SIM_LIBRARY: 'numba' is not a library that compiles kernels here" in done.stderr


def test_an_error_in_a_kernel_still_tells_the_place_and_the_line():
    runtime.start(runtime.RuntimeConfig(threads=1))

    @kernel_library.ti.kernel
    def wrong() -> float:
        return 1.0 + nowhere  # noqa: F821

    with pytest.raises(kernel_library.ti.TaichiCompilationError) as error:
        wrong()
    line = wrong.__wrapped__.__code__.co_firstlineno + 2
    assert f'test_libraries.py", line {line}, in wrong:\n' in str(error.value)
    assert "return 1.0 + nowhere" in str(error.value)


def test_a_fork_has_no_window_to_preview_in(monkeypatch):
    monkeypatch.setattr(kernel_library, "LIBRARY_NAME", kernel_library.QUADRANTS)
    with pytest.raises(vulkan.Lacking, match="drawn in a window of Taichi's, and quadrants has none"):
        vulkan.require(show=False)


def test_quadrants_moves_water_and_what_is_on_it_as_taichi_does():
    """To rounding: another compiler, the same laws."""
    expected, found = moved("taichi"), moved("quadrants")
    for name, scene in SCENES.items():
        rounding = ROUNDING[scene["runtime"]["precision"]]
        assert found[name] == pytest.approx(expected[name], rel=0.0, abs=rounding), name
        assert len(found[name]) > 1000
