"""Checkpoints: the whole state of a run saved as plain data and arrays, and restored."""
