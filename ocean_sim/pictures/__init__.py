"""Pictures and files drawn from the frames of a run; nothing here imports a simulation."""

LOOK_VERSION = 23
"""Raised where pictures come to look otherwise: those of the gallery are then old."""
