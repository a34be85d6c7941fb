"""Checkpoints: the whole state of a run as plain data and arrays."""
