"""Water to test: built from numbers, under a wind, without a scene."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest

from ocean_sim.basin import Config as BasinConfig
from ocean_sim.fluid.bodies.emitter import MOST_PARTICLES
from ocean_sim.kernel_library import ti, tm
from ocean_sim.parts import config_of
from ocean_sim.wind.still import Config as Still
from tests.conftest import Start


@pytest.fixture(scope="module")
def water(taichi_cpu) -> Callable[..., Any]:
    """Builds a fluid: `water(kind, basin={...}, wind=..., accounts=..., **keys of the fluid)`."""

    def build(
        kind: str = "mueller", *, basin: dict | None = None, wind: Any = None, accounts: bool = False, **keys: Any
    ):
        place = BasinConfig(**({"length": 1.0, "width": 1.0, "depth": 0.5} | (basin or {}))).build()
        air = (wind or Still()).build(place, 7)
        fluid = config_of("fluid", kind)(**(keys if "particles" in keys else {"spacing": 0.1} | keys)).build(
            place, 7, accounts=accounts, wind=air
        )
        fluid.wind = air
        return fluid

    return build


@pytest.fixture(scope="module")
def again(water) -> Callable[..., Any]:
    """As `water`, but what a module has built from the same numbers before is put back to its start instead: nothing
    is compiled twice. A test holds no two of the same numbers at once."""
    built: dict[str, tuple[Any, Start]] = {}

    def build(*kind: str, **keys: Any) -> Any:
        name = repr((kind, sorted(keys.items())))
        if name not in built:
            fluid = water(*kind, **keys)
            built[name] = fluid, Start(fluid)
            return fluid
        fluid, start = built[name]
        start.put_back()
        return fluid

    return build


@contextmanager
def undone(fluid: Any) -> Iterator[Any]:
    """What is done to a fluid inside is undone at the end."""
    start = Start(fluid)
    try:
        yield fluid
    finally:
        start.put_back()


def box(*count: int, spacing: float = 0.1) -> dict:
    """Keys for exactly so many particles along x, y and z, in a box at the bed's corner of the usual basin."""
    low = np.array([-0.5, -0.5, -0.5])
    return {"spacing": spacing, "fill": [{"min": list(low), "max": list(low + np.array(count) * spacing)}]}


def put(fluid: Any, position: np.ndarray, velocity: np.ndarray | None = None) -> None:
    """Place the particles, in the order of their ids, and sort them."""
    fluid.particles.position.from_numpy(np.asarray(position, dtype=float))
    fluid.particles.velocity.from_numpy(
        np.zeros_like(position) if velocity is None else np.asarray(velocity, dtype=float)
    )
    fluid.particles.id.from_numpy(np.arange(len(position), dtype=np.int32))
    fluid.begin()


def kept(fluid: Any) -> list[tuple[np.ndarray, np.ndarray]]:
    """Of each particle, in storage order, the names of the neighbours and images that a walk over cells keeps, and with
    each x_ij times the shape of grad W; only those that are near, and not in the same place."""
    blocks, x, found = fluid.pairs, fluid.particles.position.to_numpy(), []
    first, begun, near, seen, names, shape, place = (
        getattr(blocks, name).to_numpy() for name in ("first", "begun", "near", "seen", "name", "shape", "place")
    )
    for k in range(fluid.grid.occupied_count[None]):
        listed = slice(first[k], first[k] + seen[k])
        assert (names[listed][: near[k]] < MOST_PARTICLES).all(), "particles come before images"
        for i in range(fluid.grid.first[k], fluid.grid.first[k + 1]):
            own = begun[k] + (i - fluid.grid.first[k]) * seen[k]
            gradient = shape[own : own + seen[k], None] * (x[i] - place[listed])
            there = gradient.any(axis=1)
            found.append((names[listed][there], gradient[there]))
    return found


def by_id(fluid: Any, values: np.ndarray) -> np.ndarray:
    """Values in storage order put into the order of ids."""
    ordered = np.empty_like(values)
    ordered[fluid.particles.id.to_numpy()] = values
    return ordered


def read(fluid: Any, points: np.ndarray, *asked: str) -> np.ndarray:
    """What a kernel sees of open water at points (m, 3): the numbers of all that is asked for, in its order:
    `elevation`, `velocity` and, of the waves on tiles alone, `acceleration`."""
    sizes = {"elevation": 1, "velocity": 3, "acceleration": 3}
    ends = np.cumsum([sizes[name] for name in asked])
    first = {name: int(end) - sizes[name] for name, end in zip(asked, ends)}
    found = np.zeros((len(points), int(ends[-1])))

    @ti.kernel
    def look(points: ti.types.ndarray(ndim=2), found: ti.types.ndarray(ndim=2)):
        for i in range(points.shape[0]):
            position = tm.vec3(points[i, 0], points[i, 1], points[i, 2])
            for name in ti.static(asked):
                if ti.static(name == "elevation"):
                    found[i, first[name]] = fluid.elevation(position.x, position.z)
                else:
                    x, z, v = position.x, position.z, tm.vec3(0.0)
                    y = fluid.waves.stretched(position, fluid.elevation(x, z))
                    if ti.static(name == "velocity"):
                        v = tm.vec3(fluid.current[0], 0.0, fluid.current[1]) + fluid.waves.velocity(position)
                    for sheet in ti.static(fluid.sheets):
                        of = ti.static(sheet.velocity if name == "velocity" else sheet.acceleration)
                        v += of(x, z, -y, sheet.now)
                    for k in ti.static(range(3)):
                        found[i, first[name] + k] = v[k]

    look(np.ascontiguousarray(points), found)
    return found
