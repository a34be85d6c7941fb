"""The walk of a thread a particle, as graphics cards take it, equals the walk of groups of cells to rounding."""

import numpy as np
import pytest

import ocean_sim
from ocean_sim.conventions import Lacking
from ocean_sim.fluid.neighbours.particle_walk import PARTICLE_PLAN, PLANS, SUM_BLOCK_CELLS, level_sizes
from ocean_sim.kernel_library import ti
from ocean_sim.runtime import allocated_bytes
from tests.fluid.conftest import by_id, put
from tests.fluid.test_neighbours import Count, walk

STEPS, DT = 12, 0.002  # of a step [s]
BOX = {"obstacles": [{"min": [-0.1, -0.5, -0.2], "max": [0.2, -0.2, 0.1]}]}
DAM = {"fill": [{"min": [-0.5, -0.5, -0.3], "max": [-0.1, -0.1, 0.3]}]}
POOL = {"basin": {"length": 2.0, "width": 1.0, "depth": 0.5}, "duration": 0.1}
SLOWER = [pytest.param(kind, marks=pytest.mark.slow) for kind in ("delta_sph", "dfsph")]
SLICE = {"width": None, "walls": {"x_min": "no_slip", "x_max": "reflecting"}}
TANK = {"width": 0.6, "walls": {"x_min": "no_slip", "x_max": "reflecting", "z": "periodic"}, **BOX}
FLUME = {"width": None, "wavemaker": {"wall": "x_min", "height": 0.1, "period": 0.8}}
CASES = [
    pytest.param("mueller", SLICE),
    pytest.param("dfsph", SLICE),
    pytest.param("dfsph", FLUME),
    pytest.param("delta_sph", SLICE, marks=pytest.mark.slow),
    *(pytest.param(kind, TANK, marks=pytest.mark.slow) for kind in ("mueller", "delta_sph", "dfsph")),
]


@pytest.fixture
def by_particles(monkeypatch):
    """From now on what is built on the processor walks as on a card."""
    return lambda: monkeypatch.setitem(PLANS, "cpu", PARTICLE_PLAN)


def moved(fluid, seed: int = 1) -> dict[str, np.ndarray]:
    """What becomes of water that starts next to its lattice: where it touches a wall nothing hangs on rounding."""
    rng, n = np.random.default_rng(seed), fluid.particles.n
    x = by_id(fluid, fluid.particles.position.to_numpy())
    fluid.particles.pressure.from_numpy(by_id(fluid, fluid.particles.pressure.to_numpy()))  # in the order of `put`
    axes = np.arange(3) < fluid.smoothing.dimension
    put(fluid, x + axes * rng.uniform(-2e-3, 2e-3, (n, 3)), axes * rng.uniform(-0.1, 0.1, (n, 3)))
    for _ in range(STEPS):
        fluid.advance(DT)
    found = {"position": by_id(fluid, fluid.positions())}
    found |= {"velocity": by_id(fluid, fluid.particles.velocity.to_numpy())}
    found |= {f"impulse of {name}": value for name, value in fluid.impulse.items()}
    return found | {"density": np.array([fluid.status.min_density, fluid.status.max_density])}


@pytest.mark.parametrize(("kind", "place"), CASES)
def test_equals_the_walk_of_cells(water, by_particles, kind, place):
    """To rounding in f64, before a rough wall, a slippery floor and a wavemaker; in space with a box, across a period,
    and with accounts."""
    low, high = ([-0.5, -0.5, -0.3], [-0.1, -0.1, 0.3]) if place is TANK else ([-0.5, -0.5], [-0.1, -0.1])
    keys = {
        "basin": place,
        "accounts": place is TANK,
        "fill": [{"min": low, "max": high}],
        "spacing": 0.1,
        "kinematic_viscosity": 1e-3,
    }
    expected = moved(water(kind, **keys))
    by_particles()
    found = moved(water(kind, **keys))
    assert np.abs(expected["velocity"]).max() > 0.1
    for name, value in found.items():
        scale = np.abs(expected[name]).max() + (1.0 if "impulse" in name else 0.0)
        assert value == pytest.approx(expected[name], rel=0.0, abs=1e-9 * scale), name


@pytest.mark.parametrize("dimension", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_sees_the_same_particles_and_images(water, by_particles, dimension):
    """Particles near sides, in corners, and above the grid."""
    rng = np.random.default_rng(3)
    basin = {"length": 1.0, "depth": 0.5, "width": 0.8 if dimension == 3 else None}
    counted = []
    for _ in range(2):
        fluid = water(basin=basin, particles=300)
        law, n = Count(fluid), fluid.particles.n
        x = rng.uniform(-0.48, 0.48, (n, 3)) * [1.0, 0.5, 0.8] - [0.0, 0.25, 0.0]
        x[: n // 10, 1] += 3.0
        put(fluid, x * [1.0, 1.0, float(dimension == 3)])
        walk(fluid.neighbours, law, True)
        sums = (law.count, law.squares, law.images, law.image_squares)
        counted.append([by_id(fluid, one.to_numpy()) for one in sums])
        rng = np.random.default_rng(3)
        by_particles()
    for expected, found in zip(*counted):
        assert found == pytest.approx(expected, rel=1e-9, abs=1e-9)
    assert counted[0][2].max() > 0.0


@ti.kernel
def sort(grid: ti.template()):
    grid.sort()


def test_sorts_in_the_order_of_storage(water, by_particles):
    """Stable: as NumPy sorts, whatever the order in which threads put particles down, in three levels of sums."""
    by_particles()
    fluid = water(basin={"length": 26.0, "width": 26.0, "depth": 0.5}, spacing=0.1, **DAM)
    assert len(level_sizes(fluid.grid.cell_count)) == 4 and fluid.grid.cell_count > SUM_BLOCK_CELLS**2
    rng, n = np.random.default_rng(2), fluid.particles.n
    cell, name = rng.integers(0, fluid.grid.cell_count, n) // 500 * 500, rng.permutation(n).astype(np.int32)
    fluid.grid.part.from_numpy(cell.astype(np.int32))
    fluid.grid.moved[6].from_numpy(name)
    sort(fluid.grid)
    assert (fluid.particles.id.to_numpy() == name[np.argsort(cell, kind="stable")]).all()
    start = fluid.grid.start.to_numpy()
    assert (np.diff(start) == np.bincount(cell, minlength=fluid.grid.cell_count)).all()


@pytest.mark.parametrize("kind", ["mueller", "ballistic", *SLOWER])
def test_ledger_tells_what_it_takes(taichi_cpu, by_particles, kind):
    """Bytes a particle, accounts included."""
    by_particles()
    runtime = {"precision": "f64", "threads": 1}  # as what runs, which is not started anew
    config = ocean_sim.load({**POOL, "runtime": runtime, "fluid": {"kind": kind, "spacing": 0.08}})
    before = allocated_bytes()
    with ocean_sim.Simulation(config):
        taken = allocated_bytes() - before
    told = sum(row.bytes for row in config.ledger() if row.part != "render")
    assert taken == pytest.approx(told, rel=0.05, abs=2e5)


SAILING = {
    "basin": {"length": 24.0, "width": 12.0, "depth": 4.0},
    "fluid": {"kind": "mueller", "spacing": 1.2},
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
        water = by_id(simulation.fluid, simulation.fluid.positions())
        return {"water": water, "ship": body.position.copy(), "speed": body.velocity.copy(), "level": level}


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
    except Lacking as lacking:
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
