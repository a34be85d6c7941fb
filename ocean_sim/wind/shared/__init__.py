"""Modules that the kinds of `wind` share; none of them is a kind that a scene may name."""
