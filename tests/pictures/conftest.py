"""Fixtures of tests of pictures."""

import pytest

from ocean_sim.pictures.live import vulkan


@pytest.fixture(scope="session")
def vulkan_there():
    """Skips where there is no Vulkan; a process is started to see, so only where a test asks."""
    if not vulkan.draws(show=False):
        pytest.skip("no Vulkan on this machine")
