"""Runs, tables and pictures that studies share; none of it is a kind that a scene may name."""
