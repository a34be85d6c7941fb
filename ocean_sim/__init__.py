"""Particle-based ocean waves and ship motion: load a scene, run it, or step it yourself.

>>> scene = ocean_sim.load("scenes/showcase.yaml", {"duration": 2.0})
>>> with ocean_sim.Simulation(scene) as simulation:
...     simulation.run(until=1.0)
"""

import os
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ocean_sim.reading.scene import load
    from ocean_sim.result import run, wave_field
    from ocean_sim.simulation import Simulation
    from ocean_sim.viewer.notebook import view

__all__ = ["Simulation", "load", "run", "view", "wave_field"]

PUBLIC_MODULES = {  # modules of the public names
    "Simulation": "simulation",
    "load": "reading.scene",
    "run": "result",
    "view": "viewer.notebook",
    "wave_field": "result",
}

os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "False")  # before Taichi is imported, or its fork
os.environ.setdefault("ENABLE_QUADRANTS_HEADER_PRINT", "False")
os.environ.setdefault("TI_SKIP_VERSION_CHECK", "ON")  # it would ask a server once a day, with a number of this machine


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used (`list` needs no Taichi); raises AttributeError for others."""
    if name in PUBLIC_MODULES:
        return getattr(import_module(f"ocean_sim.{PUBLIC_MODULES[name]}"), name)
    raise AttributeError(f"module 'ocean_sim' has no attribute {name!r}")
