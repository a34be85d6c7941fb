"""SPlisHSPlasH beside this program: a dam break, timed by a Python that has pysplishsplash.

Its wheel cannot share a process with VTK or Taichi, so this file is also a program: `measured` runs it with the Python
of another environment, where nothing of ours is installed.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

PEER = "SPlisHSPlasH"
DISPATCH = "libGLdispatch.so.0"  # without which the wheel for Linux dies as it is imported
PATIENCE, IMPORTING = 300.0, 60.0  # with a dam break, and with an import [s]
WCSPH, DFSPH = 0, 4  # numbers of its methods
VISCOSITY = 0.01  # of the water [m2/s]
CUBE = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
FACES = [(1, 2, 4), (1, 4, 3), (5, 7, 8), (5, 8, 6), (1, 5, 6), (1, 6, 2), (3, 4, 8), (3, 8, 7), (1, 3, 7), (1, 7, 5)]
FACES += [(2, 6, 8), (2, 8, 4)]  # outwards


def measured(python: Path, order: dict[str, Any], threads: int) -> dict[str, Any]:
    """`particles`, `steps`, `wall`, `cpu` of all threads and `simulated` [s] of a dam break.

    `order`: `method`, "wcsph" or "dfsph"; `lattice`, particles along x, y and z; `spacing` [m]; `begin`, simulated time
    from which it counts [s]; `seconds` of wall time and simulated time `end`, to which it goes at least [s]. Raises
    OSError or ValueError where that Python cannot.
    """
    with tempfile.TemporaryDirectory() as folder:
        return json.loads(said(python, [__file__, json.dumps(order | {"folder": folder})], threads, PATIENCE))


def version_in(python: Path) -> str:
    """The version that a Python has and can import; raises OSError or ValueError."""
    look = "import pysplishsplash; from importlib.metadata import version; print(version('pysplishsplash'))"
    return said(python, ["-c", look], 1, IMPORTING)


def said(python: Path, arguments: list[str], threads: int, patience: float) -> str:
    """The last line of what a program under another Python prints."""
    environment = os.environ | {
        "OMP_NUM_THREADS": str(threads),
        "OMP_WAIT_POLICY": "passive",
        "LD_PRELOAD": DISPATCH,
    }
    command = [str(python), "-I", *arguments]
    try:
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=patience, check=False)
    except subprocess.TimeoutExpired:
        raise ValueError(f"it was not done after {patience:g} s") from None
    if done.returncode or not done.stdout.strip():
        raise ValueError((done.stderr.strip().splitlines() or [f"it ended with {done.returncode}"])[-1])
    return done.stdout.splitlines()[-1]


def scene(order: dict[str, Any], box: str) -> dict[str, Any]:
    """The dam break as the peer's scene: a tank 2.5 times as long as the water, walls from a map of volumes.

    WCSPH as in the peer's own examples, with steps of 0.5 ms; DFSPH with a density error of 0.05 % and a divergence
    error of 0.1 %, and steps by its CFL condition.
    """
    spacing = order["spacing"]
    water = [n * spacing for n in order["lattice"]]
    tank = [2.5 * water[0], 1.5 * water[1], water[2] + spacing]
    dfsph = order["method"] == "dfsph"
    return {
        "Configuration": {
            "particleRadius": 0.5 * spacing,
            "numberOfStepsPerRenderUpdate": 1,
            "gravitation": [0.0, -9.81, 0.0],
            "simulationMethod": DFSPH if dfsph else WCSPH,
            "timeStepSize": 0.002 if dfsph else 0.0005,
            "cflMethod": int(dfsph),
            "cflFactor": 1,
            "cflMaxTimeStepSize": 0.005,
            "boundaryHandlingMethod": 2,
            "WCSPH": {"stiffness": 25000, "exponent": 1},
            "DFSPH": {
                "minIterations": 2,
                "maxIterations": 100,
                "maxError": 0.05,
                "maxIterationsV": 100,
                "maxErrorV": 0.1,
                "enableDivergenceSolver": True,
            },
        },
        "Materials": [
            {"id": "Fluid", "density0": 1000, "viscosityMethod": 1, "Standard viscosity": {"viscosity": VISCOSITY}}
        ],
        "RigidBodies": [
            {
                "geometryFile": box,
                "translation": [0.5 * length for length in tank],
                "rotationAxis": [1, 0, 0],
                "rotationAngle": 0,
                "scale": tank,
                "isDynamic": False,
                "isWall": True,
                "mapInvert": True,
                "mapThickness": 0.0,
                "mapResolution": [30, 30, 30],
            }
        ],
        "FluidBlocks": [
            {
                "denseMode": 0,
                "start": [0.0, 0.0, 0.0],
                "end": [length + 0.9 * spacing for length in water],  # the last of a row that it makes
                "translation": [0.5 * spacing] * 3,
                "scale": [1, 1, 1],
            }
        ],
    }


def main(order: dict[str, Any]) -> None:
    """Run it in this process, with its files in the `folder` of the order, and leave as soon as it has been measured:
    it offers no other end."""
    import pysplishsplash  # type: ignore[import-not-found]  # in another environment

    folder = Path(order["folder"])
    lines = [f"v {x} {y} {z}" for x, y, z in CUBE] + [f"f {a} {b} {c}" for a, b, c in FACES]
    (folder / "box.obj").write_text("\n".join(lines))
    (folder / "scene.json").write_text(json.dumps(scene(order, str(folder / "box.obj"))))
    answer = os.dup(1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # for it prints as it goes
    run = pysplishsplash.Exec.SimulatorBase()
    run.init(
        sceneFile=str(folder / "scene.json"),
        useGui=False,
        initialPause=False,
        useCache=False,
        outputDir=str(folder),
        stopAt=1e9,
    )
    run.initSimulation()
    water = pysplishsplash.Simulation.getCurrent().getFluidModel(0)
    clock = pysplishsplash.TimeManager.getCurrent()
    since: dict[str, float] = {}

    def look() -> None:
        now, time = perf_counter(), clock.getTime()
        if not since:
            if time >= order["begin"]:
                since.update(wall=now, cpu=process_time(), time=time, steps=0)
            return
        since["steps"] += 1
        if now - since["wall"] >= order["seconds"] and time >= order["end"]:
            found = {
                "particles": water.numActiveParticles(),
                "steps": since["steps"],
                "wall": now - since["wall"],
                "cpu": process_time() - since["cpu"],
                "simulated": time - since["time"],
            }
            os.write(answer, json.dumps(found).encode())
            os._exit(0)

    run.setTimeStepCB(look)
    run.runSimulation()


if __name__ == "__main__":
    main(json.loads(sys.argv[1]))
