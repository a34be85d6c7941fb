"""Fixtures of tests of pictures."""

from tests.computed_sea import watched

__all__ = ["watched"]
