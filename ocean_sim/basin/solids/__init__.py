"""Solid bodies of any shape among particles: shapes and meshes, their cubes and distances, and room for them."""
