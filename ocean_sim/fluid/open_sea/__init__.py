"""Seas without particles: plane waves in closed form, wave tiles, and nonlinear waves."""
