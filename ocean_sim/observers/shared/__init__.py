"""Shared by the modules of `observers`; none of it is a kind that a scene may name."""
