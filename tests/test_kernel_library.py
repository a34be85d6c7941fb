"""What compiles the kernels: Taichi, or its fork Quadrants, which is the way on when Taichi no longer installs."""

import json
import os
import subprocess
import sys
from importlib.util import find_spec

import pytest

from ocean_sim import kernel_library, runtime
from ocean_sim.pictures import vulkan

FALL = """
import json, numpy, ocean_sim
found = {}
for kind in ("mueller", "delta_sph"):
    scene = {
        "basin": {"length": 1.0, "width": 0.6, "depth": 0.5},
        "fluid": {"kind": kind, "spacing": 0.1, "fill": [{"min": [-0.5, -0.5, -0.3], "max": [-0.1, -0.1, 0.3]}]},
        "runtime": {"threads": 1, "library": LIBRARY},
        "time_step": {"kind": "fixed", "dt": 0.002},
        "duration": 1.0,
    }
    with ocean_sim.Simulation(ocean_sim.load(scene)) as simulation:
        for _ in range(20):
            simulation.step()
        order = numpy.argsort(simulation.fluid.particles.id.to_numpy())
        found[kind] = simulation.fluid.positions()[order].tolist()
print(json.dumps(found))
"""


def process(script: str, library: str) -> subprocess.CompletedProcess[str]:
    """A process that computes with a library."""
    environment = {**os.environ, kernel_library.VARIABLE: library}
    return subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=False)


def fallen(library: str) -> dict[str, list[list[float]]]:
    """Where particles are, by scheme, after a fall of 0.04 s."""
    done = process(FALL.replace("LIBRARY", repr(library)), library)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def test_another_library_than_the_process_computes_with_is_refused(monkeypatch):
    other = runtime.RuntimeConfig(library="quadrants" if kernel_library.NAME == "taichi" else "taichi")
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
    assert f'test_kernel_library.py", line {line}, in wrong:\n' in str(error.value)
    assert "return 1.0 + nowhere" in str(error.value)


def test_a_fork_has_no_window_to_preview_in(monkeypatch):
    monkeypatch.setattr(kernel_library, "NAME", kernel_library.QUADRANTS)
    with pytest.raises(vulkan.Lacking, match="drawn in a window of Taichi's, and quadrants has none"):
        vulkan.require(show=False)


@pytest.mark.slow
def test_quadrants_moves_water_as_taichi_does():
    """To rounding: another compiler, the same laws."""
    if find_spec("quadrants") is None:
        pytest.skip("quadrants is not installed here: `pip install quadrants` beside Taichi, and this test runs both")
    expected, found = fallen("taichi"), fallen("quadrants")
    for kind, positions in found.items():
        assert [x for row in positions for x in row] == pytest.approx(
            [x for row in expected[kind] for x in row], abs=1e-5
        ), kind
