"""Pressure and velocity at points: exact in still water up to walls, bed and corners, exact for what is linear, bounded
at the surface, zero where it is dry, and the same in every repeat of a periodic basin."""

import numpy as np
import pytest

from ocean_sim.conventions import GRAVITY
from ocean_sim.fluid.budget.field import Field
from tests.fluid.conftest import put

GRAVITIES = np.array([0.0, -GRAVITY, 0.0])


def field_of(fluid, gravity=GRAVITIES):
    return Field(fluid.particles, fluid.grid, fluid.surface.smoothing, gravity)


def press(fluid, law):
    """Give every particle the pressure that a law has for its place."""
    x = fluid.particles.position.to_numpy()
    fluid.particles.pressure.from_numpy(np.ascontiguousarray(law(x), dtype=float))


def move(fluid, law):
    fluid.particles.velocity.from_numpy(np.ascontiguousarray(law(fluid.particles.position.to_numpy()), dtype=float))


def jittered(fluid, part=0.2):
    """The lattice, each particle moved by up to so many spacings, walls kept clear."""
    x = fluid.grid.size.lattice.positions()
    noise = np.random.default_rng(3).uniform(-part, part, x.shape) * fluid.particles.spacing
    if fluid.grid.basin.dimension == 2:
        noise[:, 2] = 0.0
    put(fluid, x + noise)


def still(x):
    return -1000.0 * GRAVITY * x[:, 1]


@pytest.fixture(scope="module")
def tank(water):
    return water(basin={"length": 1.0, "width": 0.8, "depth": 0.6}, spacing=0.1)


@pytest.fixture(scope="module")
def slice_(water):
    return water(basin={"length": 1.0, "width": None, "depth": 0.6}, spacing=0.05)


def test_still_water_is_exact_inside_on_the_bed_on_walls_and_in_corners(tank):
    jittered(tank)
    press(tank, still)
    points = np.array(
        [
            [0.0, -0.3, 0.0],
            [0.2, -0.6, 0.1],
            [-0.5, -0.37, 0.0],
            [0.5, -0.6, 0.4],
            [-0.5, -0.6, -0.4],
            [0.1, -0.13, 0.4],
        ]
    )
    np.testing.assert_allclose(field_of(tank).pressures(points), still(points), rtol=1e-10)


def test_and_in_a_slice(slice_):
    jittered(slice_)
    press(slice_, still)
    points = np.array([[0.0, -0.3, 0.0], [-0.5, -0.6, 0.0], [0.5, -0.6, 0.0], [0.5, -0.2, 0.0], [0.03, -0.6, 0.0]])
    np.testing.assert_allclose(field_of(slice_).pressures(points), still(points), rtol=1e-10)


def test_without_the_weight_of_the_water_the_bed_reads_too_little(slice_):
    put(slice_, slice_.grid.size.lattice.positions())
    press(slice_, still)
    bed = np.array([[0.0, -0.6, 0.0]])
    read = field_of(slice_, np.zeros(3)).pressures(bed)
    assert read[0] < still(bed)[0] - 0.3 * 1000.0 * GRAVITY * slice_.particles.spacing


def test_what_is_linear_comes_back_inside(tank):
    jittered(tank)
    press(tank, lambda x: 70.0 + x @ [300.0, -200.0, 500.0])
    move(tank, lambda x: np.stack([x[:, 1], 2.0 - x[:, 2], x[:, 0] + x[:, 1]], axis=1))
    points = np.random.default_rng(1).uniform([-0.29, -0.39, -0.19], [0.29, -0.21, 0.19], (30, 3))
    wanted = np.stack([points[:, 1], 2.0 - points[:, 2], points[:, 0] + points[:, 1]], axis=1)
    np.testing.assert_allclose(field_of(tank).pressures(points), 70.0 + points @ [300.0, -200.0, 500.0], atol=2e-2)
    np.testing.assert_allclose(field_of(tank).velocities(points), wanted, atol=1e-4)


def test_a_wall_without_slip_is_at_rest_and_one_with_slip_is_only_shut(water):
    for kind, along in (("no_slip", 0.0), ("reflecting", 3.0)):
        fluid = water(basin={"width": None, "length": 1.0, "depth": 0.6, "walls": kind}, spacing=0.05)
        move(fluid, lambda x: np.array([2.0, 3.0, 0.0]) + 0.0 * x)
        at_wall = field_of(fluid).velocities(np.array([[0.5, -0.3, 0.0], [-0.5, -0.2, 0.0]]))
        np.testing.assert_allclose(at_wall, [[0.0, along, 0.0]] * 2, atol=1e-12)


def test_it_is_dry_above_the_surface_and_beside_a_drop(slice_):
    x = slice_.grid.size.lattice.positions()
    drop = np.argmax(x[:, 1])
    x[:, 0] = -0.5 + (x[:, 0] + 0.5) / 2.0
    x[drop] = [0.3, -0.1, 0.0]
    put(slice_, x)
    press(slice_, lambda x: 1000.0 + 0.0 * x[:, 0])
    move(slice_, lambda x: 1.0 + 0.0 * x)
    points = np.array([[-0.25, 0.1, 0.0], [0.3, -0.11, 0.0], [0.4, -0.6, 0.0], [5.0, 5.0, 0.0]])
    assert (field_of(slice_).pressures(points) == 0.0).all()
    assert (field_of(slice_).velocities(points) == 0.0).all()


def test_at_the_surface_noise_is_not_blown_up(slice_):
    jittered(slice_)
    noise = np.random.default_rng(5).normal(0.0, 1.0, slice_.particles.n)
    slice_.particles.pressure.from_numpy(still(slice_.particles.position.to_numpy()) + noise)
    points = np.stack([np.linspace(-0.5, 0.5, 201), np.full(201, -0.005), np.zeros(201)], axis=1)
    wet = field_of(slice_).pressures(points)
    assert (wet != 0.0).mean() > 0.7
    assert np.abs(wet[wet != 0.0] - still(points)[wet != 0.0]).max() < 3.0


def test_repeats_of_a_periodic_basin_are_the_same_water(water):
    walls = {"x": "periodic", "z": "reflecting"}
    fluid = water(basin={"length": 1.0, "width": 0.8, "depth": 0.6, "walls": walls}, spacing=0.1)
    wave = lambda x: 100.0 * np.cos(2.0 * np.pi * x[:, 0])
    press(fluid, lambda x: still(x) + wave(x))
    move(fluid, lambda x: np.stack([np.sin(2.0 * np.pi * x[:, 0]), 0.0 * x[:, 0], 0.0 * x[:, 0]], axis=1))
    points = np.array([[-0.5, -0.3, 0.0], [0.5, -0.3, 0.0], [0.5, -0.6, 0.4], [-0.5, -0.6, 0.4], [1.5, -0.3, 0.0]])
    field = field_of(fluid, GRAVITIES + [1.0, 0.0, 0.0])  # a force along x that no pressure holds
    pressures = field.pressures(points)
    np.testing.assert_allclose(pressures[[0, 2]], pressures[[1, 3]], rtol=1e-6)
    assert pressures[4] == pytest.approx(pressures[0])
    assert np.abs(field.velocities(points)[:, 0]).max() < 1e-6
    crest = pressures[:3] - still(points[:3])
    np.testing.assert_allclose(crest, -100.0, rtol=0.1)  # smoothing takes a few per cent of the top


def test_a_fully_periodic_slice_has_no_sides(water):
    basin = {"length": 1.0, "width": None, "depth": 1.0, "walls": {"x": "periodic", "y": "periodic"}, "floor": "none"}
    fluid = water(basin=basin | {"gravity": [0.0, 0.0, 0.0]}, spacing=0.05, stiffness=100.0)
    k = 2.0 * np.pi
    move(fluid, lambda x: np.stack([np.sin(k * x[:, 0]) * np.cos(k * x[:, 1]), 0.0 * x[:, 0], 0.0 * x[:, 0]], axis=1))
    grid = np.random.default_rng(2).uniform([-0.5, -1.0, 0.0], [0.5, 0.0, 0.0], (200, 3))
    error = field_of(fluid, np.zeros(3)).velocities(grid)[:, 0] - np.sin(k * grid[:, 0]) * np.cos(k * grid[:, 1])
    assert np.abs(error).max() < 0.04


def test_a_particle_that_went_through_a_periodic_side_after_the_sort_is_still_seen(water):
    fluid = water(basin={"length": 1.0, "width": None, "depth": 0.6, "walls": {"x": "periodic"}}, spacing=0.05)
    jittered(fluid)
    press(fluid, lambda x: 500.0 * x[:, 1] ** 2 + still(x))
    x = fluid.particles.position.to_numpy()
    points = np.stack([np.full(30, 0.47), np.linspace(-0.55, -0.1, 30), np.zeros(30)], axis=1)
    before = field_of(fluid).pressures(points)
    x[:, 0] = (x[:, 0] + 0.02 + 0.5) % 1.0 - 0.5
    fluid.particles.position.from_numpy(x)  # and no sort
    np.testing.assert_allclose(field_of(fluid).pressures(points + [0.02, 0.0, 0.0]), before, atol=1e-3)
