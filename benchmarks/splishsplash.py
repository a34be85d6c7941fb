"""SPlisHSPlasH beside this program: a dam break. Its wheel cannot share a process with VTK or Taichi."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from benchmarks.another_python import Watch

PEER, PACKAGE = "SPlisHSPlasH", "pysplishsplash"
INSTALLED = PACKAGE
ENVIRONMENT = {"LD_PRELOAD": "libGLdispatch.so.0"}  # without which the wheel for Linux dies as it is imported
WCSPH, DFSPH = 0, 4  # numbers of its methods
CUBE = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
FACES = [(1, 2, 4), (1, 4, 3), (5, 7, 8), (5, 8, 6), (1, 5, 6), (1, 6, 2), (3, 4, 8), (3, 8, 7), (1, 3, 7), (1, 7, 5)]
FACES += [(2, 6, 8), (2, 8, 4)]  # outwards


def scene(order: dict[str, Any], box: str) -> dict[str, Any]:
    """SPlisHSPlasH's scene of the dam break, in a tank 2.5 times as long as the water; `box`: mesh file of its walls.

    WCSPH as in the peer's own examples, with steps of 0.5 ms; DFSPH with a density error of 0.05 % and a divergence
    error of 0.1 %, and steps by its CFL condition. The walls act as a map of volumes.
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
            {
                "id": "Fluid",
                "density0": 1000,
                "viscosityMethod": 1,
                "Standard viscosity": {"viscosity": order["viscosity"]},
            }
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


def main(order: dict[str, Any], watch: "Watch") -> None:
    """Run the dam break of `scene`; its support is two spacings."""
    import pysplishsplash  # type: ignore[import-not-found]  # in another environment

    folder = Path(order["folder"])
    lines = [f"v {x} {y} {z}" for x, y, z in CUBE] + [f"f {a} {b} {c}" for a, b, c in FACES]
    (folder / "box.obj").write_text("\n".join(lines))
    (folder / "scene.json").write_text(json.dumps(scene(order, str(folder / "box.obj"))))
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
    run.setTimeStepCB(lambda: watch.look(clock.getTime(), water.numActiveParticles(), 0))
    run.runSimulation()
