"""Particle-based ocean waves and ship motion: load a scene, run it, or step it yourself."""

import os

os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "False")
