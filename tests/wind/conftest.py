"""What a wind does at points, asked from Python."""

import numpy as np
import pytest

from ocean_sim import basin
from ocean_sim.files.yaml_file import read_mapping
from ocean_sim.kernel_library import ti, tm
from ocean_sim.parts import config_of, library
from tests.fluid.conftest import water

__all__ = ["water"]


@ti.kernel
def push(
    wind: ti.template(),
    position: ti.types.ndarray(dtype=ti.f64, ndim=2),
    force: ti.types.ndarray(dtype=ti.f64, ndim=2),
    velocity: tm.vec3,
    area: tm.vec3,
    bend: tm.vec3,
    mass: float,
    since: float,
    step: float,
):
    wind.set_clock(since, step)
    for i in range(position.shape[0]):
        f = wind.force(i, tm.vec3(position[i, 0], position[i, 1], position[i, 2]), velocity, area, bend, mass)
        for k in ti.static(range(3)):
            force[i, k] = f[k]


@pytest.fixture(scope="module")
def force(taichi_cpu):
    """The force of a wind [N], (n, 3), on particles at points (n, 3); by default at rest, of 1 kg and without area."""

    def felt(wind, points, velocity=(0.0, 0.0, 0.0), area=(0.0, 0.0, 0.0), bend=(0.0, 0.0, 0.0), mass=1.0):
        points = np.ascontiguousarray(np.atleast_2d(points), dtype=float)
        result = np.zeros_like(points)
        vectors, clock = (tm.vec3(velocity), tm.vec3(area), tm.vec3(bend)), wind.clock
        push(wind, points, result, *vectors, mass, clock.since, clock.step)
        return result

    return felt


@pytest.fixture(scope="session")
def thesis_basin():
    return basin.Config(length=40.0, width=40.0, depth=7.5).build()


@pytest.fixture(scope="module")
def build(taichi_cpu, thesis_basin):
    """A wind of this kind and these keys, in the thesis's basin unless given another."""

    def built(kind, seed=7, place=thesis_basin, **keys):
        return config_of("wind", kind).model_validate({"kind": kind, **keys}).build(place, seed)

    return built


@pytest.fixture(scope="session")
def preset_data():
    """The content of a file in configs/."""

    def content(folder, name):
        return read_mapping(library("configs") / folder / f"{name}.yaml").plain()

    return content
