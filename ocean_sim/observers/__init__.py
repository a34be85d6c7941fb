"""Observers: every module of this folder may be named at a scene's top level. Their base is in simulation.py."""
