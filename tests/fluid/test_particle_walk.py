"""The walk of a thread a particle, as graphics cards take it, equals the walk of groups of cells to rounding."""

import numpy as np
import pytest

import ocean_sim
from ocean_sim.fluid.shared.particle_walk import BLOCK, levels
from ocean_sim.fluid.shared.walk_plan import PARTICLES, PLANS
from ocean_sim.kernel_library import ti
from ocean_sim.runtime import allocated_bytes
from tests.fluid.conftest import by_id, put
from tests.fluid.test_neighbours import Count, walk

STEPS, DT = 12, 0.002  # of a step [s]
BOX = {"obstacles": [{"min": [-0.1, -0.5, -0.2], "max": [0.2, -0.2, 0.1]}]}
DAM = {"fill": [{"min": [-0.5, -0.5, -0.3], "max": [-0.1, -0.1, 0.3]}]}
PLACES = {
    "box before walls": {"width": 0.6, **BOX},
    "rough walls": {"width": 0.6, "walls": "no_slip"},
    "across a period": {"width": 0.6, "walls": {"z": "periodic"}},
}


@pytest.fixture
def by_particles(monkeypatch):
    """From now on what is built on the processor walks as on a card."""
    return lambda: monkeypatch.setitem(PLANS, "cpu", PARTICLES)


def moved(fluid, seed: int = 1) -> dict[str, np.ndarray]:
    """What becomes of water that starts next to its lattice: where it touches a wall nothing hangs on rounding."""
    rng, n = np.random.default_rng(seed), fluid.particles.n
    x = by_id(fluid, fluid.particles.position.to_numpy())
    put(fluid, x + rng.uniform(-2e-3, 2e-3, (n, 3)) * [1.0, 1.0, 1.0], rng.uniform(-0.1, 0.1, (n, 3)))
    for _ in range(STEPS):
        fluid.advance(DT)
    found = {"position": by_id(fluid, fluid.positions())}
    found |= {"velocity": by_id(fluid, fluid.particles.velocity.to_numpy())}
    found |= {f"impulse of {name}": value for name, value in fluid.impulse.items()}
    return found | {"density": np.array([fluid.status.min_density, fluid.status.max_density])}


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("kind", ["mueller", "delta_sph", "dfsph"])
def test_equals_the_walk_of_cells(water, by_particles, kind, place):
    """Apart from rounding in f32: 1 mm of a way of 24 steps is 1e-4 of it. A walk that forgets the images in a wall is
    off by more than a hundred times as much."""
    keys = {"basin": PLACES[place], "accounts": True, "spacing": 0.1, "kinematic_viscosity": 1e-3, **DAM}
    expected = moved(water(kind, **keys))
    by_particles()
    found = moved(water(kind, **keys))
    assert np.abs(expected["velocity"]).max() > 0.1
    for name, value in found.items():
        scale = np.abs(expected[name]).max() + (1.0 if "impulse" in name else 0.0)
        assert value == pytest.approx(expected[name], rel=0.0, abs=2e-5 * scale), name


@pytest.mark.parametrize("dimension", [2, 3])
def test_sees_the_same_particles_and_images(water, by_particles, dimension):
    """Particles anywhere, outside the grid and on borders of cells, near two sides and in corners."""
    rng = np.random.default_rng(3)
    basin = {"length": 1.0, "depth": 0.5, "width": 0.8 if dimension == 3 else None}
    counted = []
    for _ in range(2):
        fluid = water(basin=basin, particles=300)
        law, n = Count(fluid), fluid.particles.n
        x = rng.uniform(-0.48, 0.48, (n, 3)) * [1.0, 0.5, 0.8] - [0.0, 0.25, 0.0]
        x[: n // 10] *= 3.0
        put(fluid, (x * [1.0, 1.0, float(dimension == 3)]).astype(np.float32))
        walk(fluid.neighbours, law, True)
        sums = (law.count, law.squares, law.images, law.image_squares)
        counted.append([by_id(fluid, one.to_numpy()) for one in sums])
        rng = np.random.default_rng(3)
        by_particles()
    inside = slice(n // 10, None)  # what is outside has no images that are of use to anyone
    for expected, found in zip(*counted):
        assert found[inside] == pytest.approx(expected[inside], rel=1e-4, abs=1e-4)
    assert counted[0][2].max() > 0.0


@ti.kernel
def sort(grid: ti.template()):
    grid.sort()


def test_sorts_in_the_order_of_storage(water, by_particles):
    """Stable: as NumPy sorts, whatever the order in which threads put particles down, in three levels of sums."""
    by_particles()
    fluid = water(basin={"length": 26.0, "width": 26.0, "depth": 0.5}, spacing=0.1, **DAM)
    assert len(levels(fluid.grid.cell_count)) == 4 and fluid.grid.cell_count > BLOCK**2
    rng, n = np.random.default_rng(2), fluid.particles.n
    cell, name = rng.integers(0, fluid.grid.cell_count, n) // 500 * 500, rng.permutation(n).astype(np.int32)
    fluid.grid.cell.from_numpy(cell.astype(np.int32))
    fluid.grid.moved[6].from_numpy(name)
    sort(fluid.grid)
    assert (fluid.particles.id.to_numpy() == name[np.argsort(cell, kind="stable")]).all()
    start = fluid.grid.start.to_numpy()
    assert (np.diff(start) == np.bincount(cell, minlength=fluid.grid.cell_count)).all()


@pytest.mark.parametrize("kind", ["mueller", "delta_sph", "dfsph", "ballistic"])
def test_ledger_tells_what_it_takes(by_particles, kind):
    """Bytes a particle, accounts included."""
    by_particles()
    config = ocean_sim.load({**TANK, "fluid": {"kind": kind, "spacing": 0.08}})
    before = allocated_bytes()
    with ocean_sim.Simulation(config):
        taken = allocated_bytes() - before
    told = sum(row.bytes for row in config.ledger())
    assert taken == pytest.approx(told, rel=0.05, abs=2e5)


TANK = {"basin": {"length": 2.0, "width": 1.0, "depth": 0.5}, "duration": 0.1}
SAILING = {
    "basin": {"length": 24.0, "width": 12.0, "depth": 4.0},
    "fluid": {"spacing": 1.2},
    "wind": "wide",
    "surface": "cloth",
    "ship": {"kind": "hydrostatic", "hull": "yacht", "heading_deg": 90.0, "controls": [{"time": 0.0, "throttle": 0.5}]},
    "duration": 1.0,
    "time_step": {"kind": "fixed", "dt": 0.01},
}


def sailed(kind: str, **runtime: object) -> dict[str, np.ndarray]:
    """What becomes of a ship, and of the water and the wind around it, in 30 steps."""
    config = ocean_sim.load({**SAILING, "fluid": {**SAILING["fluid"], "kind": kind}, "runtime": runtime})
    with ocean_sim.Simulation(config) as simulation:
        for _ in range(30):
            simulation.step()
        assert simulation.ship is not None and simulation.surface is not None
        body, grid = simulation.ship.body, np.linspace(-4.0, 4.0, 5)
        level = simulation.surface.elevations(np.stack(np.meshgrid(grid, grid), axis=-1).reshape(-1, 2))
        position, velocity = body.position.copy(), body.velocity.copy()
        return {"water": by_id(simulation.fluid, simulation.fluid.positions()), "ship": position, "level": level} | {
            "speed": velocity
        }


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["mueller", "delta_sph", "dfsph"])
def test_a_ship_sails_the_same(by_particles, kind):
    """Wind, cloth, hull and walls on the walk of a thread a particle."""
    expected = sailed(kind)
    by_particles()
    found = sailed(kind)
    for name, value in found.items():
        assert value == pytest.approx(expected[name], rel=0.0, abs=1e-3), name


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["mueller", "delta_sph", "dfsph"])
def test_vulkan_in_software_sails_the_same(kind):
    """The whole step on Vulkan, which Mesa runs on the processor (lavapipe)."""
    expected = sailed(kind)
    try:
        found = sailed(kind, arch="vulkan")
    except ocean_sim.conventions.Lacking as lacking:
        pytest.skip(f"no Vulkan here: {lacking}")
    for name, value in found.items():
        assert value == pytest.approx(expected[name], rel=0.0, abs=1e-3), name


@pytest.mark.slow
def test_same_bytes_on_any_number_of_threads(by_particles):
    """Every sum has one order."""
    by_particles()
    one, two = (sailed("delta_sph", threads=n) for n in (1, 2))
    for name, value in one.items():
        assert (value == two[name]).all(), name
