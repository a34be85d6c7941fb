"""Modules shared by the kinds of `platform`; none is a kind that a scene may name."""
