"""Smoothed particle hydrodynamics: the interface of a law, sums over pairs, smoothing kernels, pressure solver, and the
state that particles start from."""
