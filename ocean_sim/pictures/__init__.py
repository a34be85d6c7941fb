"""Frames drawn from a finished run or from a running simulation; nothing here imports a simulation."""
