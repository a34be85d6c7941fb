"""Verbs of the command line; no physics."""
