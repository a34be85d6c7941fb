"""Fixtures of tests of observers."""

from tests.computed_sea import watched

__all__ = ["watched"]
