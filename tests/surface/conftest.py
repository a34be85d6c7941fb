"""Water with a sheet on it."""

from collections.abc import Callable
from typing import Any

import pytest

from ocean_sim.parts import SceneFacts, config_of
from tests.fluid.conftest import water

__all__ = ["water"]


@pytest.fixture(scope="module")
def cloth(taichi_cpu) -> Callable[..., Any]:
    """Lays a cloth on a fluid: `cloth(fluid, **keys of the cloth)`."""

    def build(fluid: Any, **keys: Any):
        basin = fluid.grid.basin
        preflight = SceneFacts({"fluid": fluid.config}, basin, 8, 1.0)
        return config_of("surface", "cloth")(**keys).completed(preflight).build(basin, fluid)

    return build
