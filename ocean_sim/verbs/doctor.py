"""`ocean-sim doctor`: capabilities of this machine, each that may crash tested in a child process."""

import json
import os
import platform
import re
import subprocess
import sys
from typing import Any

from ocean_sim import machine
from ocean_sim.verbs.shared import console

PACKAGE_NAMES = ("ocean-sim", "taichi", "quadrants", "numpy", "pydantic", "pyvista", "vtk", "h5py", "imageio-ffmpeg")
BACKEND_NAMES = ("cpu", "cuda", "vulkan", "metal")
BACKEND_PROBE = """
from ocean_sim.machine import kernel_cache
from ocean_sim.runtime import RuntimeConfig, start
start(RuntimeConfig(arch={arch!r}))
print(kernel_cache())
"""
FILM_PROBE = """
import subprocess
from imageio_ffmpeg import get_ffmpeg_exe
print(subprocess.run([get_ffmpeg_exe(), "-version"], check=True, capture_output=True, text=True).stdout.split("\\n")[0])
"""
VECTOR_PROBE = """
from ocean_sim.kernel_library import LIBRARY_NAME
from ocean_sim.runtime import vector_width
print(LIBRARY_NAME, vector_width())
"""
USUAL_VECTOR_WIDTH = 8  # numbers at once that suffice: many processors are no faster with more
PROBE_SECONDS = 90.0  # [s] for one probe


def doctor() -> None:
    """Report the abilities of the machine; a missing one is not an error."""
    found = examine_machine()
    console.answer(found)
    backends = [[f"backend {name}", *_row(fact)] for name, fact in found["backends"].items()]
    names = {"vectors": "vectors", "preview": "ggui", "pictures": "opengl", "film": "video"}
    others = [[name, *_row(found[key])] for name, key in names.items()]
    machine = [
        ["machine", "", f"{found['machine']}, {found['cores']} cores, {found['memory_gb']:.1f} GB of memory"],
        ["python", "", f"{found['python']} ({found['executable']})"],
        ["packages", "", " ".join(f"{name} {number}" for name, number in found["versions"].items())],
        ["cache", "", found["cache"] or "unknown"],
    ]
    console.table("", ["", "", ""], [*backends, *others, *machine])


def _row(fact: dict[str, Any]) -> list[str]:
    return ["yes" if fact["ok"] else "no", fact["detail"]]


def examine_machine() -> dict[str, Any]:
    """Facts that `doctor` reports, by topic: backends, graphics, memory, versions."""
    backends = {arch: run_probe(BACKEND_PROBE.format(arch=arch)) for arch in BACKEND_NAMES}
    cache = backends["cpu"]["detail"] if backends["cpu"]["ok"] else None
    for fact in backends.values():
        fact["detail"] = "" if fact["ok"] else fact["detail"].split(";")[0]
    return {
        "backends": backends,
        "vectors": vector_row(),
        "ggui": run_probe("from ocean_sim.pictures.live.vulkan import require; require(show=False)"),
        "opengl": opengl_row(),
        "video": run_probe(FILM_PROBE),
        "machine": f"{platform.system()} {platform.machine()}",
        "cores": machine.available_cores(),
        "memory_gb": machine.memory_limit() / 1e9,
        "python": platform.python_version(),
        "executable": sys.executable,
        "versions": {name: number for name in PACKAGE_NAMES if (number := machine.installed_version(name)) is not None},
        "cache": cache,
    }


def run_probe(script: str) -> dict[str, Any]:
    """Run a Python script in a child process, as it may crash: `ok` if it succeeds, `detail` is its last line."""
    try:
        quiet = os.environ | {"ENABLE_TAICHI_HEADER_PRINT": "False"}
        options: dict[str, Any] = {"capture_output": True, "text": True, "timeout": PROBE_SECONDS, "env": quiet}
        child = subprocess.run([sys.executable, "-c", script], check=False, **options)
    except subprocess.TimeoutExpired:
        return {"ok": False, "detail": f"no answer within {PROBE_SECONDS:.0f} s"}
    if child.returncode < 0:
        return {"ok": False, "detail": f"the process that tried it died (signal {-child.returncode})"}
    lines = (child.stdout if child.returncode == 0 else child.stderr).strip().splitlines()
    last = lines[-1] if lines else ""
    if "libX11" in last:
        last = "Taichi needs the system library libX11: as root, apt-get install libx11-6"
    return {"ok": child.returncode == 0, "detail": re.sub(r"^[\w.]+Missing: ", "", last)}


def opengl_row() -> dict[str, Any]:
    """Test of OpenGL, for drawing without a screen: `ok` if available, `detail` the kind of window or the problem."""
    script = "from ocean_sim.pictures.stage.opengl import probe, window; print(json.dumps([probe(), window()]))"
    fact = run_probe(f"import json; {script}")
    if not fact["ok"]:
        return fact
    problem, window = json.loads(fact["detail"])
    return {"ok": problem is None, "detail": problem or window}


def vector_row() -> dict[str, Any]:
    """Test of the kernels' vector instructions: `ok` if as wide as the processor allows, `detail` in words."""
    fact, room = run_probe(VECTOR_PROBE), machine.max_vector_width()
    if not fact["ok"]:
        return fact
    library, width = fact["detail"].split()
    if room is None or int(width) >= min(room, USUAL_VECTOR_WIDTH):
        return {"ok": True, "detail": f"{library} works on {width} numbers at once"}
    after = "" if machine.installed_version("quadrants") else ", after `pip install quadrants`"
    cure = f"; particles are quicker with runtime.library=quadrants{after}"
    does = f"{library} does not know this processor, and works on {width} numbers at once, not {room}"
    return {"ok": False, "detail": does + (cure if library == "taichi" else "")}
