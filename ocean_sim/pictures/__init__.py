"""Frames drawn from a finished run or from a simulation that goes on; nothing here imports a simulation."""
