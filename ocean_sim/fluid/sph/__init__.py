"""Smoothed particle hydrodynamics: interface of pair laws, smoothing kernels, pressure solver, initial states."""
