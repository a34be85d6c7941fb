"""Fixtures of tests of pictures."""

import pytest

from ocean_sim.pictures.live import vulkan
from tests.computed_sea import watched

__all__ = ["vulkan_there", "watched"]


@pytest.fixture(scope="session")
def vulkan_there():
    """Skips where there is no Vulkan; a process is started to see, so only where a test asks."""
    if not vulkan.draws(show=False):
        pytest.skip("no Vulkan on this machine")
