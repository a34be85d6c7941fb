"""Neighbour search: the grid of cells, the walk over pairs, kept pairs, and mirror images."""
