"""The walk over neighbours equals brute force, wherever the particles are."""

from itertools import product

import numpy as np
import pytest

from ocean_sim.columns import Columns
from ocean_sim.conventions import Diverged
from ocean_sim.fluid.bodies.emitter import MOST_PARTICLES
from ocean_sim.fluid.neighbours.grid import STATE_COLUMNS
from ocean_sim.fluid.sph.law import Law, WalkOptions
from ocean_sim.fluid.sph.particles import PAGE_BYTES
from ocean_sim.kernel_library import ti
from tests.fluid.conftest import by_id, kept, put


@ti.data_oriented
class Count(Law):
    """How many particles lie within the support, and the sum of their squared distances."""

    terms = Columns(count=1, squares=1)

    def __init__(self, fluid, padded: bool = False) -> None:
        self.reads, self.options = tuple(fluid.particles.position), WalkOptions(apart=True, padded=padded)
        self.support = fluid.smoothing.support
        self.count, self.squares = (ti.field(float, shape=fluid.particles.n) for _ in range(2))
        self.images, self.image_squares = (ti.field(float, shape=fluid.particles.n) for _ in range(2))

    @ti.func
    def pair(self, own, other):
        r2 = (own - other).dot(own - other)
        near = ti.select(r2 < self.support * self.support, 1.0, 0.0)
        return ti.Vector([near, near * r2])

    @ti.func
    def finish(self, i, own, total, beyond, group):
        self.count[i], self.squares[i] = total[0], total[1]
        self.images[i], self.image_squares[i] = beyond[0], beyond[1]


@ti.kernel
def walk(neighbours: ti.template(), law: ti.template(), find: ti.template()):
    neighbours.walk(law, find)


def brute_force(x: np.ndarray, support: float) -> tuple[np.ndarray, np.ndarray]:
    r2 = ((x[:, None] - x[None]) ** 2).sum(axis=2)
    near = r2 < support**2
    return near.sum(axis=1), np.where(near, r2, 0.0).sum(axis=1)


SIZES = [(2, 2.0), (3, 2.0), (2, 6.0), (3, 4.0)]  # dimension, and support [spacings]; of the wide ones cells have parts
CLOUDS = {
    "random": lambda rng, n: rng.uniform(-0.45, 0.45, (n, 3)) * [1.0, 0.5, 1.0],
    "sparse, most cells empty": lambda rng, n: rng.uniform(-0.5, 0.5, (n, 3)) ** 3,
    "all in one place": lambda rng, n: np.full((n, 3), 0.123),
    "two in one place": lambda rng, n: np.repeat(rng.uniform(-0.45, 0.45, ((n + 1) // 2, 3)), 2, axis=0)[:n],
    "on the borders of cells": lambda rng, n: rng.integers(-2, 3, (n, 3)) * 0.2,
    "far outside the grid": lambda rng, n: rng.uniform(-0.45, 0.45, (n, 3)) + rng.integers(-1, 2, (n, 3)) * 3.0,
}
CROWDED = "all in one place", "sparse, most cells empty"  # of more particles more than a list holds
CASES = [(*size, cloud) for size in SIZES for cloud in CLOUDS if size[1] == 2.0 or cloud not in CROWDED]


@pytest.fixture(scope="module")
def clouds(water):
    """One fluid a dimension and support, with its laws, not padded and padded, for all clouds: a new one would be
    compiled anew."""
    made = {}
    for dimension, ratio in SIZES:
        basin = {"length": 1.0, "depth": 0.5, "width": 1.0 if dimension == 3 else None}
        fluid = water(basin=basin, particles=300 if ratio == 2.0 else 2000, support_ratio=ratio)
        assert fluid.grid.parts == (1 if ratio == 2.0 else 2**dimension)
        made[dimension, ratio] = fluid, (Count(fluid), Count(fluid, padded=True))
    return made


@pytest.mark.parametrize(("dimension", "ratio", "cloud"), CASES)
@pytest.mark.parametrize("padded", [False, True])
def test_the_walk_equals_brute_force(clouds, dimension, ratio, cloud, padded):
    fluid, laws = clouds[dimension, ratio]
    law = laws[padded]
    x = CLOUDS[cloud](np.random.default_rng(3), fluid.particles.n)
    x[:, 2] *= dimension - 2
    put(fluid, x)
    for find in (True, False):
        walk(fluid.neighbours, law, find)
        count, squares = brute_force(x, fluid.smoothing.support)
        np.testing.assert_array_equal(by_id(fluid, law.count.to_numpy()), count)
        np.testing.assert_allclose(by_id(fluid, law.squares.to_numpy()), squares, atol=1e-12)


def mirrored(x: np.ndarray, fluid) -> np.ndarray:
    """All images of the cloud in the sides of its basin, made one by one: images of images too."""
    low, up = fluid.grid.basin.stops()
    sides = [[None] + [w for w in (low[k], up[k]) if abs(w) < 1e29] for k in range(3)]
    copies = []
    for walls in product(*sides):
        image = x.copy()
        for k, wall in enumerate(walls):
            if wall is not None:
                image[:, k] = 2.0 * wall - x[:, k]
        if any(wall is not None for wall in walls):
            copies.append(image)
    return np.concatenate(copies)


def assert_images_are_mirrored_copies(fluid, law, x: np.ndarray) -> None:
    """Of particles at x, those near each as many as brute force finds, found anew and from the lists."""
    put(fluid, x)
    for find in (True, False):
        walk(fluid.neighbours, law, find)
        r2 = ((x[:, None] - mirrored(x, fluid)[None]) ** 2).sum(axis=2)
        near = r2 < fluid.smoothing.support**2
        np.testing.assert_array_equal(by_id(fluid, law.images.to_numpy()), near.sum(axis=1))
        squares = np.where(near, r2, 0.0).sum(axis=1)
        np.testing.assert_allclose(by_id(fluid, law.image_squares.to_numpy()), squares, atol=1e-12)
    assert near.any()


@pytest.mark.parametrize(("dimension", "ratio"), SIZES)
@pytest.mark.parametrize("padded", [False, True])
def test_images_equal_mirrored_copies_of_all_particles(clouds, dimension, ratio, padded):
    fluid, laws = clouds[dimension, ratio]
    rng = np.random.default_rng(8)
    x = rng.uniform(-0.5, 0.5, (fluid.particles.n, 3)) * [1.0, 0.5, 1.0] + [0.0, -0.25, 0.0]
    x[:, 2] *= dimension - 2
    assert_images_are_mirrored_copies(fluid, laws[padded], x)


@pytest.mark.parametrize("height", [2.0, 20.0])
def test_a_jet_along_a_wall_that_rises_above_the_grid_finds_room(clouds, height):
    """All of the water, from the bed on, in a fifth of a support: no list has room for as much in one cell and for its
    images."""
    fluid, laws = clouds[2, 2.0]
    x = np.random.default_rng(6).uniform([0.485, -0.5, 0.0], [0.5, height, 0.0], (fluid.particles.n, 3))
    assert 2 * fluid.particles.n > fluid.neighbours.capacity
    assert_images_are_mirrored_copies(fluid, laws[True], x)
    count, _ = brute_force(x, fluid.smoothing.support)
    np.testing.assert_array_equal(by_id(fluid, laws[True].count.to_numpy()), count)
    assert not fluid.accounts.overflow.to_numpy()[:, 0].any()


def test_room_is_asked_for_images_that_are_there_not_for_all_that_could_be(clouds):
    """A crowd in the cells along a wall, too far from it to be seen there."""
    fluid, laws = clouds[2, 2.0]
    n = fluid.particles.n
    x = np.random.default_rng(7).uniform([0.4168, -0.2, 0.0], [0.4182, -0.199, 0.0], (n, 3))
    put(fluid, x)
    walk(fluid.neighbours, laws[True], True)
    assert 2 * n > fluid.neighbours.capacity and len(np.unique(fluid.grid.part.to_numpy())) == 1
    assert (laws[True].count.to_numpy() == n).all() and not laws[True].images.to_numpy().any()
    assert not fluid.accounts.overflow.to_numpy()[:, 0].any()


@ti.kernel
def address(field: ti.template()) -> ti.u64:
    return ti.get_addr(field, [0])


@pytest.mark.parametrize(("along", "n"), [(32, 1024), (31, 961)])
def test_what_fields_have_of_a_particle_lies_in_lines_of_the_cache_that_do_not_compete(water, along, n):
    """1024 numbers are whole pages: fields one behind the other would all begin on the same line of their pages."""
    basin = {"length": 0.1 * along, "depth": 3.2, "width": None}
    fluid = water(
        basin=basin, spacing=0.1, fill=[{"min": [-0.05 * along, -0.1 * n / along], "max": [0.05 * along, 0.0]}]
    )
    assert fluid.particles.n == n
    for together in (
        fluid.grid.state[: STATE_COLUMNS.id],
        fluid.grid.moved[: STATE_COLUMNS.id],
        fluid.neighbours.scratch,
    ):
        lines = {address(field) % PAGE_BYTES // 64 for field in together}
        assert len(lines) == len(together)


def test_one_particle_is_its_only_neighbour(water):
    fluid = water(particles=1)
    law = Count(fluid)
    walk(fluid.neighbours, law, True)
    assert law.count.to_numpy() == [1.0]


def test_the_sort_is_stable_and_loses_nobody(clouds):
    fluid, _ = clouds[3, 2.0]
    n = fluid.particles.n
    put(fluid, np.full((n, 3), 0.05))
    np.testing.assert_array_equal(fluid.particles.id.to_numpy(), np.arange(n))
    x = np.random.default_rng(4).uniform(-0.4, 0.4, (n, 3))
    put(fluid, x)
    np.testing.assert_array_equal(fluid.particles.position.to_numpy(), x[fluid.particles.id.to_numpy()])
    assert sorted(fluid.particles.id.to_numpy()) == list(range(n))


def test_a_crowd_that_overflows_the_lists_is_told(water):
    fluid = water(spacing=0.05)
    with pytest.raises(Diverged, match="neighbours than their lists hold"):
        put(fluid, np.zeros((fluid.particles.n, 3)))
        fluid.advance(1e-4)


@pytest.mark.parametrize(("ratio", "halves"), [(2.0, 1), (4.0, 2)])
def test_sorting_in_chunks_gives_the_same_order(water, ratio, halves):
    """More particles than one thread sorts: compared with NumPy's stable sort by cell and, in large cells, by part."""
    fluid = water(basin={"length": 3.0, "width": 3.0, "depth": 1.0}, spacing=0.07, support_ratio=ratio)
    assert fluid.grid.chunks > 1 and fluid.grid.parts_per_axis == halves
    x = np.random.default_rng(5).uniform(-1.4, 1.4, (fluid.particles.n, 3)) * [1.0, 0.6, 1.0]
    put(fluid, x)
    along = (x - np.array(fluid.grid.lower)) / np.array([w for _, w in fluid.grid.size.inner_cells])
    place = np.floor(along).astype(int) + 1
    cell = (place[:, 2] * fluid.grid.cells[1] + place[:, 1]) * fluid.grid.cells[0] + place[:, 0]
    half = (halves * (along % 1.0)).astype(int)
    part = ((cell * halves + half[:, 0]) * halves + half[:, 1]) * halves + half[:, 2]
    np.testing.assert_array_equal(fluid.particles.id.to_numpy(), np.argsort(part, kind="stable"))


@pytest.mark.parametrize(("dimension", "ratio"), SIZES)
def test_periodic_sides_equal_shifted_copies_of_all_particles(water, dimension, ratio):
    walls = {"x": "periodic", "y": "periodic"} | ({"z": "periodic"} if dimension == 3 else {})
    basin = {"length": 1.0, "depth": 0.7, "width": 0.8 if dimension == 3 else None, "walls": walls, "floor": "none"}
    fluid = water(basin=basin, particles=300 if ratio == 2.0 else 3000, support_ratio=ratio)
    law, low, period = Count(fluid), np.array(fluid.grid.basin.lower), np.array(fluid.grid.basin.periods)
    x = low + np.random.default_rng(9).uniform(0.0, 1.0, (fluid.particles.n, 3)) * period
    put(fluid, x)
    for find in (True, False):
        walk(fluid.neighbours, law, find)
        d = x[:, None] - x[None]
        d -= np.where(period > 0.0, period, 1.0) * np.round(d / np.where(period > 0.0, period, 1.0)) * (period > 0.0)
        r2 = (d**2).sum(axis=2)
        near = r2 < fluid.smoothing.support**2
        np.testing.assert_array_equal(by_id(fluid, law.count.to_numpy()), near.sum(axis=1))
        squares = np.where(near, r2, 0.0).sum(axis=1)
        np.testing.assert_allclose(by_id(fluid, law.squares.to_numpy()), squares, atol=1e-12)


def test_the_pairs_that_are_kept_are_those_of_the_walk(water):
    """Images lie behind a gap where sums go through whole vectors."""
    fluid = water("dfsph", basin={"length": 1.0, "width": None, "depth": 0.5}, spacing=0.05)
    x = np.random.default_rng(5).uniform(-0.49, 0.49, (fluid.particles.n, 3)) * [1.0, 0.5, 0.0] - [0.0, 0.25, 0.0]
    put(fluid, x)
    law = Count(fluid, padded=True)
    walk(fluid.neighbours, law, True)
    images = np.array([(names >= MOST_PARTICLES).sum() for names, _ in kept(fluid)])
    near = np.array([len(names) for names, _ in kept(fluid)]) - images
    np.testing.assert_array_equal(near, law.count.to_numpy() - 1.0)
    np.testing.assert_array_equal(images, law.images.to_numpy())
    assert images.max() > 0
