"""Particle-based ocean waves and ship motion: load a scene, run it, or step it yourself.

>>> scene = ocean_sim.load("scenes/showcase.yaml", {"duration": 2.0})
>>> with ocean_sim.Simulation(scene) as simulation:
...     simulation.run(until=1.0)
"""

import os

os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "False")  # before Taichi is imported

from ocean_sim.scene import load, run  # noqa: E402
from ocean_sim.simulation import Simulation  # noqa: E402

__all__ = ["Simulation", "load", "run"]
