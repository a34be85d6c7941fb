"""Frames drawn from a finished run or from a running simulation; nothing here imports a simulation."""

LOOK_VERSION = 19
"""Raised where pictures come to look otherwise: those of the gallery are then old."""
