"""The cloth: it lies on flat water, follows waves, meets what the water's particles say, and is stable whatever."""

import numpy as np
import pytest

from ocean_sim.kernel_library import ti, tm
from ocean_sim.surface.cloth import Contact
from tests.fluid.conftest import put

H = 0.1  # [m] spacing of the particles
FLUME = {"length": 12.0, "width": 0.4, "depth": 0.8, "walls": {"x": "periodic"}}


@pytest.fixture(scope="module")
def pond(water):
    return water(basin={"length": 2.0, "width": 1.4, "depth": 0.8}, spacing=H)


@pytest.fixture(scope="module")
def lattice(pond):
    return pond.particles.position.to_numpy()


@pytest.fixture(scope="module")
def sheet(pond, cloth):
    return cloth(pond)


@pytest.fixture(scope="module")
def flume(water):
    return water(basin=FLUME, spacing=H)


@pytest.fixture(scope="module")
def still(flume):
    """Places of the flume's particles by id: all of them, before the first test moves any."""
    x = np.empty((flume.particles.n, 3))
    x[flume.particles.id.to_numpy()] = flume.particles.position.to_numpy()
    return x


@pytest.fixture(scope="module")
def streamer(flume, still, cloth):
    return cloth(flume)


def heights(sheet) -> np.ndarray:
    return sheet.height.to_numpy().reshape(sheet.nodes)


def grid(length: float, width: float, n: int = 41) -> np.ndarray:
    x, z = np.meshgrid(np.linspace(-length / 2, length / 2, n), np.linspace(-width / 2, width / 2, n))
    return np.stack([x.ravel(), z.ravel()], axis=1)


@pytest.mark.parametrize("thickness, each, mean", [(2.0, 0.01, 0.002), (1.2, 0.05, 0.006)])  # 1.2: 1.5 m of 1.25 m
def test_flat_water_lies_at_zero_up_to_the_walls(pond, lattice, cloth, thickness, each, mean):
    """Nodes at all places between the particles: 0.37 spacings apart."""
    put(pond, lattice)
    fine = cloth(pond, thickness=thickness * H, spacing=0.37 * H)
    assert np.abs(heights(fine)).max() < each * H
    assert abs(heights(fine).mean()) < mean * H
    assert np.abs(fine.elevations(grid(2.0, 1.4))).max() < each * H


def test_the_share_at_the_surface_is_what_calibrates_it():
    """Negative control: with one half instead, a thin sheet lies elsewhere."""
    thin = Contact(3, 1.2 * H, H)
    assert abs(thin.surface_height(thin.at_surface)) < 1e-6 * H
    assert abs(thin.surface_height(0.5)) > 0.008 * H


def waved(still: np.ndarray, wavelength: float, amplitude: float, shift: float = 0.0) -> np.ndarray:
    """Columns of the lattice moved up and down to a cos k(x - shift): a shear, so the water keeps its density."""
    x = still.copy()
    x[:, 1] += amplitude * np.cos(2.0 * np.pi * (x[:, 0] - shift) / wavelength)
    return x


def transfer(sheet, wavelength: float, amplitude: float) -> tuple[float, float, float]:
    """Height of the wave in the sheet over its own, mean offset and RMS distance from it [spacings]."""
    x = np.linspace(-6.0, 6.0, 2401)[:-1]
    wave = np.cos(2.0 * np.pi * x / wavelength)
    eta = sheet.elevations(np.stack([x, np.full_like(x, 0.03)], axis=1))
    miss = np.sqrt(np.mean((eta - amplitude * wave) ** 2))
    return 2.0 * float(np.mean(eta * wave)) / amplitude, float(eta.mean()) / H, float(miss) / H


@pytest.mark.parametrize("spacings, least", [(6, 0.7), (10, 0.88), (20, 0.96), (40, 0.99)])
def test_waves_keep_their_height(flume, still, streamer, spacings, least):
    """By theory 1 - (k R)^2 / 20 for poly6 of radius R, times bilinear interpolation, 1 - (k d)^2 / 12 for nodes d
    apart; amplitude a twentieth of the wavelength."""
    wavelength, amplitude = spacings * H, min(spacings / 20.0, 2.0) * H
    put(flume, waved(still, wavelength, amplitude))
    streamer.lay_down(flume.particles)
    ratio, offset, _ = transfer(streamer, wavelength, amplitude)
    k = 2.0 * np.pi / wavelength
    assert ratio > least
    assert ratio == pytest.approx(1.0 - (k * 2.0 * H) ** 2 / 20.0 - (k * H) ** 2 / 12.0, abs=0.05)
    assert abs(offset) < 0.05


def test_a_cut_lattice_has_the_same_wave(flume, still, streamer):
    """Particles only below eta, in steps of a spacing; what is above lies on the bed."""
    wavelength, amplitude = 20 * H, H
    x = still.copy()
    x[:, 1] += H
    above = x[:, 1] > amplitude * np.cos(2.0 * np.pi * x[:, 0] / wavelength)
    x[above, 1] = -0.79
    put(flume, x)
    streamer.lay_down(flume.particles)
    ratio, offset, _ = transfer(streamer, wavelength, amplitude)
    assert 0.9 < ratio < 1.1
    assert abs(offset) < 0.1


def test_a_moving_wave_is_followed_up_and_down(flume, still, streamer):
    """A wave that travels: the sheet after a second is the sheet laid anew, to a thousandth of its height."""
    wavelength, amplitude, speed, dt = 20 * H, H, 1.8, 1.0 / 60.0
    for step in range(60):
        put(flume, waved(still, wavelength, amplitude, speed * step * dt))
        streamer.follow(flume.particles, dt)
    followed = heights(streamer).copy()
    streamer.lay_down(flume.particles)
    assert np.abs(followed - heights(streamer)).max() < 0.01 * H
    assert np.ptp(followed) > 1.9 * amplitude


def test_both_ends_of_a_periodic_basin_are_one(streamer):
    assert np.array_equal(heights(streamer)[0], heights(streamer)[-1])
    z = np.linspace(-0.2, 0.2, 9)
    here, there = (streamer.elevations(np.stack([np.full(9, x), z], axis=1)) for x in (0.3, 12.3))
    np.testing.assert_allclose(here, there, atol=1e-12)


@ti.kernel
def shares(around: ti.template(), law: ti.template(), x: ti.types.ndarray(ndim=2), found: ti.types.ndarray(ndim=2)):
    for n in range(x.shape[0]):
        total = around.total(tm.vec3(x[n, 0], x[n, 1], x[n, 2]), law, 0.0)
        found[n, 0], found[n, 1] = total[0], total[1]


def brute_force(x: np.ndarray, particles: np.ndarray, thickness: float, size: float, walls: list) -> np.ndarray:
    """Algorithm 5, every node with every particle and its mirror images: share of water and its slope upwards."""
    images = particles
    for axis, place in walls:
        mirrored = images.copy()
        mirrored[:, axis] = 2.0 * place - mirrored[:, axis]
        images = np.concatenate([images, mirrored])
    away = x[:, None, :] - images[None, :, :]
    w = np.maximum(thickness**2 - np.sum(away**2, axis=2), 0.0)
    constant = 315.0 / (64.0 * np.pi * thickness**9) * size**3
    return constant * np.stack([np.sum(w**3, axis=1), np.sum(-6.0 * w**2 * away[:, :, 1], axis=1)], axis=1)


def test_contact_through_the_grid_equals_brute_force(pond, lattice, sheet):
    random = np.random.default_rng(3)
    particles = lattice + random.uniform(-0.4, 0.4, lattice.shape) * H
    put(pond, particles)
    x = random.uniform([-1.0, -0.8, -0.7], [1.0, 0.2, 0.7], (60, 3))
    found = np.empty((60, 2))
    shares(sheet.around, sheet.contact, x, found)
    walls = [(0, -1.0), (0, 1.0), (2, -0.7), (2, 0.7), (1, -0.8)]
    expected = brute_force(x, particles, sheet.thickness, H, walls)
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-9)
    without = brute_force(x, particles, sheet.thickness, H, walls[1:])
    assert np.abs(found - without).max() > 0.1  # negative control: the images at one wall matter


def test_a_drop_a_hole_and_a_dry_place(pond, lattice, sheet):
    x = lattice.copy()
    x[np.argmax(x[:, 1])] = [0.5, 0.5, 0.0]  # one drop in the air
    hole = np.linalg.norm(x[:, [0, 2]] + [0.4, 0.0], axis=1) < 0.35
    x[hole, 1] = -0.79
    put(pond, x)
    sheet.lay_down(pond.particles)
    drop, middle, next_to_it = sheet.elevations(np.array([[0.5, 0.0], [-0.4, 0.0], [0.8, 0.5]]))
    assert abs(drop) < 0.2 * H and abs(next_to_it) < 0.02 * H
    assert middle < -0.5
    x[:, 0] = -1.0 + (x[:, 0] + 1.0) / 2.0  # all of it in the lower half of x
    put(pond, x)
    for _ in range(100):
        sheet.update(0.01)
    assert sheet.elevations(np.array([[0.7, 0.0]]))[0] == pytest.approx(-0.8, abs=1e-6)


def test_a_jet_is_followed_and_left_again(pond, lattice, sheet):
    x = lattice.copy()
    jet = np.linalg.norm(x[:, [0, 2]], axis=1) < 0.3
    x[jet, 1] = -0.8 + (x[jet, 1] + 0.8) * 1.8
    put(pond, x)
    for _ in range(30):
        sheet.update(1.0 / 60.0)
    assert heights(sheet).max() > 0.4
    put(pond, lattice)
    for _ in range(30):
        sheet.update(1.0 / 60.0)
    assert np.abs(heights(sheet)).max() < 0.02 * H


def test_water_that_leaves_leaves_the_sheet_on_the_bed(pond, lattice, sheet):
    put(pond, lattice + [0.0, 0.0, 100.0])
    for _ in range(200):
        sheet.update(1.0 / 60.0)
    assert np.allclose(heights(sheet)[:, :-4], -0.8)
    put(pond, lattice)
    for _ in range(200):
        sheet.update(1.0 / 60.0)
    assert np.abs(heights(sheet)).max() < 0.02 * H  # and it comes back


@pytest.fixture(scope="module")
def free(pond, cloth):
    """Sheets that the water does not move, a thousand times softer and stiffer than usual."""
    return {
        factor: cloth(pond, response=0.0, stretching_stiffness=18.0 * factor, bending_stiffness=18.0 * factor)
        for factor in (1e-3, 1e3)
    }


@pytest.mark.parametrize("factor", [1e-3, 1e3])
@pytest.mark.parametrize("dt", [1.0 / 60.0, 1.0 / 6.0, 10.0])
def test_whatever_stiffness_and_time_step_a_free_sheet_stays_bounded(free, factor, dt):
    """Springs alone: no node goes beyond where the first was pulled to; stiff ones swing."""
    sheet = free[factor]
    x, z = np.linspace(-1.0, 1.0, sheet.nodes[0]), np.linspace(-0.7, 0.7, sheet.nodes[1])
    sheet.height.from_numpy((0.5 * np.exp(-20.0 * (x[:, None] ** 2 + z[None, :] ** 2))).ravel())
    sheet.speed.fill(0.0)
    highest = []
    for _ in range(150):
        sheet.update(dt)
        highest.append(np.abs(heights(sheet)).max())
    assert np.isfinite(highest).all() and max(highest) < 0.55
    assert min(highest) < (0.2 if factor > 1.0 else 0.5)


def test_stiff_springs_flatten_a_wave(flume, still, streamer, cloth):
    """The springs are there: taut ones take a part of a short wave's height."""
    wavelength, amplitude = 10 * H, 0.5 * H
    put(flume, waved(still, wavelength, amplitude))
    streamer.lay_down(flume.particles)
    stiff = cloth(flume, stretching_stiffness=18.0e5, bending_stiffness=18.0e5)
    for _ in range(20):
        stiff.update(1.0 / 60.0)
    assert transfer(stiff, wavelength, amplitude)[0] < transfer(streamer, wavelength, amplitude)[0] - 0.02


def test_held_edges_never_move(pond, lattice, cloth):
    """As in the listing, all four at one height; the middle lies on the water."""
    put(pond, lattice)
    held = cloth(pond, edges=-0.05)
    for _ in range(10):
        held.update(1.0 / 60.0)
    at = heights(held)
    assert (np.concatenate([at[0], at[-1], at[:, 0], at[:, -1]]) == -0.05).all()
    assert np.abs(at[2:-2, 2:-2]).max() < 0.02 * H


def test_elevation_is_bilinear_continuous_and_goes_on_beyond_the_basin(sheet):
    nx, nz = sheet.nodes
    x, z = np.linspace(-1.0, 1.0, nx), np.linspace(-0.7, 0.7, nz)
    sheet.height.from_numpy((0.1 + 0.3 * x[:, None] - 0.2 * z[None, :]).ravel())
    where = grid(2.0, 1.4)
    np.testing.assert_allclose(sheet.elevations(where), 0.1 + 0.3 * where[:, 0] - 0.2 * where[:, 1], atol=1e-12)
    np.testing.assert_allclose(sheet.elevations(np.array([[5.0, 0.2]])), sheet.elevations(np.array([[1.0, 0.2]])))
    sheet.height.from_numpy(np.random.default_rng(1).uniform(-0.1, 0.1, nx * nz))
    line = np.stack([np.linspace(-1.0, 1.0, 20001), np.full(20001, 0.123)], axis=1)
    assert np.abs(np.diff(sheet.elevations(line))).max() < 1.1 * 0.2 * 1e-4 / H  # no jump: steepest slope times step


def test_the_mesh_faces_up_and_has_the_sheets_area_and_volume(sheet):
    nx, nz = sheet.nodes
    x = np.linspace(-1.0, 1.0, nx)
    sheet.height.from_numpy(np.repeat(0.3 * x, nz))
    mesh = sheet.mesh()
    assert mesh.vertices.shape == mesh.normals.shape == (nx * nz, 3)
    assert mesh.triangles.shape == (2 * (nx - 1) * (nz - 1), 3)
    assert (mesh.vector_areas[:, 1] > 0.0).all()
    np.testing.assert_allclose(mesh.normals, np.tile([-0.3, 1.0, 0.0] / np.sqrt(1.09), (nx * nz, 1)), atol=1e-12)
    assert mesh.area == pytest.approx(2.0 * 1.4 * np.sqrt(1.09))
    assert mesh.volume(-0.8) == pytest.approx(2.0 * 1.4 * 0.8)


def test_it_moves_at_its_own_rate(pond, lattice, sheet):
    put(pond, lattice)
    sheet.lay_down(pond.particles)
    sheet.age = 0.0
    moments, time = [], 0.0
    for _ in range(40):
        time += 0.004
        sheet.follow(pond.particles, 0.004)
        if sheet.age == 0.0:
            moments.append(time)
    assert np.diff(moments).tolist() == pytest.approx([0.016] * (len(moments) - 1))


def test_a_slice_has_a_rope(water, cloth):
    slice_ = water(basin={"length": 2.0, "width": None, "depth": 0.8}, spacing=H)
    rope = cloth(slice_, spacing=0.37 * H)
    assert rope.nodes[1] == 1 and np.abs(heights(rope)).max() < 0.01 * H
    mesh = rope.mesh()
    assert mesh.triangles.shape == (0, 3) and mesh.area == 0.0 and np.isfinite(mesh.normals).all()


def test_a_single_particle_is_no_surface(water, cloth):
    lonely = water(
        basin={"length": 1.0, "width": 1.0, "depth": 0.5},
        particles=1,
        fill=[{"min": [0.0, -0.1, 0.0], "max": [0.1, 0.0, 0.1]}],
    )
    assert np.allclose(heights(cloth(lonely)), -0.5)
