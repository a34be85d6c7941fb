"""Marching cubes on particles: the surface lies where the water ends, wherever that is, and costs nothing unread."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

import ocean_sim
from ocean_sim import runtime
from ocean_sim.basin import Basin
from ocean_sim.basin import Config as BasinConfig
from ocean_sim.conventions import Diverged
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.fluid.sph.particles import Components, Count
from ocean_sim.kernel_library import ti
from ocean_sim.parts import SceneFacts
from ocean_sim.pictures.water.tank import smooth_mesh
from ocean_sim.surface.marching_cubes import Config, MarchingCubes, flat_share
from tests.surface.spray import spray
from tests.surface.test_isosurface import topology

SPACING = 0.1  # [m] of the particles


def basin(length: float, width: float, depth: float, **keys: Any) -> Basin:
    return BasinConfig(length=length, width=width, depth=depth, **keys).build()


SPACE = {"walls": "none", "floor": "none"}


def water(places: np.ndarray, spacing: float = SPACING) -> Any:
    """Particles at these places, as a surface sees them and their fluid."""
    position = Components(len(places))
    position.from_numpy(places)
    volume = {"mass": 1000.0 * spacing**3, "rest_density": 1000.0, "spacing": spacing}
    n = len(places)
    lattice = SimpleNamespace(spacing=spacing, n=n)
    particles = SimpleNamespace(n=n, count=Count(n, n), position=position, **volume)
    fluid = SimpleNamespace(particles=particles, lattice=lambda _: lattice, ratio=lambda _: 2.0)
    fluid.of_particles = fluid
    return fluid


def built(places: np.ndarray, place: Basin, apart: float = SPACING, **keys: Any) -> MarchingCubes:
    fluid = water(np.asarray(places, dtype=float), apart)
    preflight = SceneFacts({"fluid": fluid}, place, 8, 1.0)
    config = Config(**keys).completed(preflight)
    assert not [*config.problems(preflight), *config.mismatches(preflight)]
    return config.build(place, fluid)


def lattice(*extents: tuple[float, float], spacing: float = SPACING) -> np.ndarray:
    axes = [low + spacing * (np.arange(round((high - low) / spacing)) + 0.5) for low, high in extents]
    return np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=1)


def ball(spacing: float) -> np.ndarray:
    places = lattice((-1.2, 1.2), (-1.2, 1.2), (-1.2, 1.2), spacing=spacing)
    return places[np.linalg.norm(places, axis=1) <= 1.0]


def put(surface: MarchingCubes, places: Any) -> MarchingCubes:
    """The surface of other water: particles left over are nowhere."""
    everywhere = np.full((surface.map.n, 3), np.nan)
    everywhere[: len(places)] = places
    surface.map.particles.position.from_numpy(everywhere)
    surface.follow(surface.map.particles, 0.01)
    return surface


def line(x: np.ndarray, z: float = 0.03) -> np.ndarray:
    return np.stack([x, np.full_like(x, z)], axis=1)


STILL = lattice((-1.0, 1.0), (-0.6, 0.0), (-0.6, 0.6))


@pytest.fixture(scope="module")
def tank(taichi_cpu) -> MarchingCubes:
    """For tests that put their own water into it, of one particle more than it holds at rest."""
    return built(np.concatenate([STILL, STILL[:1]]), basin(2.0, 1.2, 0.6))


@pytest.fixture
def sea(tank) -> MarchingCubes:
    return put(tank, STILL)


@pytest.fixture(scope="module")
def round_water(taichi_cpu) -> dict[float, MarchingCubes]:
    place = basin(2.8, 2.8, 1.4, **SPACE)
    return {spacing: built(ball(spacing), place, spacing) for spacing in (0.1, 0.05)}


@pytest.mark.parametrize("spacing, particles", [(0.1, 4224), (0.05, 33552)])
def test_a_ball_of_particles_has_its_volume_and_radius(round_water, spacing, particles):
    """The particle sets of the published reference; pysplashsurf 0.14.1, raw: volume +1.67 and +0.69 %, mean radius
    +0.07 and +0.06 spacings; smoothed 25 times: -1.49 and -0.02 %, -0.04 and 0.00 spacings."""
    surface = round_water[spacing]
    assert surface.map.n == particles
    mesh = put(surface, ball(spacing)).mesh()
    radius = np.linalg.norm(mesh.vertices, axis=1)
    assert topology(mesh) == (True, 2)
    assert mesh.volume() == pytest.approx(4.0 / 3.0 * np.pi, rel=0.01)
    assert abs(radius.mean() - 1.0) < 0.02 * spacing
    assert radius.std() < 0.12 * spacing
    assert mesh.area == pytest.approx(4.0 * np.pi, rel=0.02)


def test_a_jittered_ball_keeps_both_and_smoothing_leaves_the_volume_alone(round_water):
    places = ball(SPACING)
    surface = put(round_water[0.1], places + np.random.default_rng(2).normal(0.0, 0.1 * SPACING, places.shape))
    raw = surface.mesh()
    picture = smooth_mesh(raw, surface.nodes.lower, surface.nodes.upper, 0.4 * SPACING)
    assert topology(raw) == (True, 2)
    assert raw.volume() == pytest.approx(4.0 / 3.0 * np.pi, rel=0.01)
    assert picture.volume() == pytest.approx(raw.volume(), rel=2e-3)
    assert picture.area < raw.area - 0.004 * 4.0 * np.pi
    assert picture.triangles is raw.triangles
    outward = picture.vertices / np.linalg.norm(picture.vertices, axis=1, keepdims=True)
    assert (outward * picture.normals).sum(axis=1).min() > 0.8


def test_a_slope_meets_a_wall_in_a_clean_line_when_smoothed(tank):
    """A slope of 1 : 4: along the wall the grid leaves steps of its nodes, half a spacing high; smoothed, what lies
    flat on the wall ends where the water inside does, in a line."""
    places = STILL[STILL[:, 1] < -0.3 - 0.25 * STILL[:, 0]]
    raw = put(tank, places).mesh()
    picture = smooth_mesh(raw, tank.nodes.lower, tank.nodes.upper, 0.4 * SPACING)
    rims = {}
    for name, mesh in (("raw", raw), ("smoothed", picture)):
        on_wall = np.flatnonzero(np.isclose(mesh.vertices[:, 2], 0.6) & (np.abs(mesh.vertices[:, 0]) < 0.6))
        across = mesh.triangles[~np.isclose(mesh.vertices[mesh.triangles, 2], 0.6).all(axis=1)]
        x, y, _ = mesh.vertices[np.intersect1d(on_wall, across)].T
        rims[name] = (y + 0.25 * x)[y > -0.55]
    inside = picture.vertices[(picture.normals[:, 1] > 0.9) & (np.abs(picture.vertices) < [0.6, 9.0, 0.4]).all(axis=1)]
    assert rims["raw"].std() > 0.15 * SPACING
    assert rims["smoothed"].std() < 0.05 * SPACING
    assert rims["smoothed"].mean() == pytest.approx((inside[:, 1] + 0.25 * inside[:, 0]).mean(), abs=0.1 * SPACING)
    flat = np.isclose(picture.vertices[picture.triangles, 2], 0.6).all(axis=1)
    np.testing.assert_array_equal(picture.normals[picture.triangles[flat]].reshape(-1, 3)[:, 2], 1.0)
    assert abs(picture.volume(bed=-0.6) - raw.volume(bed=-0.6)) < 0.02 * SPACING * raw.area


def test_flat_water_lies_at_zero_up_to_the_walls_and_fills_the_basin(sea):
    x, z = np.meshgrid(np.linspace(-1.0, 1.0, 61), np.linspace(-0.6, 0.6, 41))
    heights = sea.elevations(np.stack([x.ravel(), z.ravel()], axis=1))
    assert abs(heights.mean()) < 0.005 * SPACING and np.abs(heights).max() < 0.05 * SPACING
    mesh, free = sea.mesh(), sea.free_surface()
    assert topology(mesh) == (True, 2)
    assert mesh.volume() == pytest.approx(2.0 * 1.2 * 0.6, rel=0.01)
    np.testing.assert_allclose(mesh.vertices.min(axis=0), [-1.0, -0.6, -0.6], atol=1e-12)
    np.testing.assert_allclose(mesh.vertices.max(axis=0)[[0, 2]], [1.0, 0.6], atol=1e-12)
    on_wall = np.isclose(mesh.vertices[:, 0], -1.0)
    np.testing.assert_array_equal(mesh.normals[on_wall], np.broadcast_to([-1.0, 0.0, 0.0], (on_wall.sum(), 3)))
    assert free.area == pytest.approx(2.0 * 1.2, rel=0.005)
    assert free.volume(bed=-0.6) == pytest.approx(2.0 * 1.2 * 0.6, rel=0.002)
    assert free.normals[:, 1].min() > 0.99


@pytest.fixture(scope="module")
def canal(taichi_cpu) -> MarchingCubes:
    return built(lattice((-6.0, 6.0), (-0.8, 0.0), (-0.2, 0.2)), basin(12.0, 0.4, 1.0, walls={"x": "periodic"}))


@pytest.mark.parametrize("wavelength, ratio", [(6, 0.75), (10, 0.90), (20, 0.97), (40, 0.99)])
def test_waves_keep_their_mean_and_their_height(canal, wavelength, ratio):
    """Amplitudes of a twentieth of the wave; smoothing by poly6 of variance radius^2 / 11 takes exp(-variance k^2 / 2)
    of it: 0.82, 0.93, 0.98 and 1.00 at these lengths; the bound is ours, the offset the reference's."""
    k, a = 2.0 * np.pi / (wavelength * SPACING), wavelength * SPACING / 20.0
    places = lattice((-6.0, 6.0), (-0.8, 0.0), (-0.2, 0.2))
    places[:, 1] += a * np.cos(k * places[:, 0])
    x = np.linspace(-6.0, 6.0, 1200, endpoint=False)
    heights, wave = put(canal, places).elevations(line(x)), np.cos(k * x)
    assert abs(heights.mean()) < 0.01 * SPACING
    assert ratio < 2.0 * (heights * wave).mean() / a < 1.01


def test_elevation_is_continuous_and_has_the_height_of_its_side_beyond_the_basin(tank):
    surface = put(tank, STILL[STILL[:, 0] < 0.0])  # the other half is dry
    x = np.linspace(-1.3, 1.3, 20001)
    heights = surface.elevations(line(x))
    steepest = 0.6 / surface.nodes.width[0]
    assert np.abs(np.diff(heights)).max() < 1.2 * steepest * (x[1] - x[0])
    assert heights[x < -1.0] == pytest.approx(heights[np.argmin(np.abs(x + 1.0))])
    assert (heights[x > 0.1] == -0.6).all()


def test_both_ends_of_a_period_are_one_place(canal):
    places = lattice((-6.0, 6.0), (-0.8, 0.0), (-0.2, 0.2))
    places[:, 1] += 0.1 * np.sin(np.pi * places[:, 0] + 1.0)
    surface = put(canal, places)
    ends = surface.elevations(line(np.array([-6.0, 6.0, 18.0])))
    np.testing.assert_allclose(ends, ends[0], atol=1e-12)
    assert ends[0] == pytest.approx(0.1 * np.sin(1.0), abs=0.01)
    skin = surface.free_surface()
    sides = [skin.vertices[np.abs(skin.vertices[:, 0] - at) < 1e-9] for at in (-6.0, 6.0)]
    np.testing.assert_allclose(*(side[np.argsort(side[:, 2])][:, 1:] for side in sides), atol=1e-9)


def test_a_lone_drop_is_spray_and_no_surface(tank):
    surface = put(tank, [*STILL, [0.3, 0.4, 0.1]])
    assert np.flatnonzero(spray(surface)).tolist() == [len(STILL)]
    assert topology(surface.mesh()) == (True, 2)
    assert abs(surface.elevations(np.array([[0.3, 0.1]]))[0]) < 0.05 * SPACING


EXTREMES = {  # water, particles outside, particles that are spray
    "a single particle": ([[0.0, -0.3, 0.0]], 0, 1),
    "none in the basin": ([[0.0, 5.0, 0.0], [0.0, -5.0, 0.0]], 2, 2),
    "no number": ([[np.nan] * 3, [0.0, -0.3, 0.0]], 1, 2),
    "all in one place": ([[0.0, -0.3, 0.0]] * 40, 0, 0),
    "a thread one particle thick": (lattice((0.0, 0.1), (-0.6, 0.6), (0.0, 0.1)), 0, 12),
    "two particles thick": (lattice((-0.1, 0.1), (-0.6, 0.6), (-0.1, 0.1)), 0, 0),
    "a jet": (lattice((-0.2, 0.2), (-0.6, 0.6), (-0.2, 0.2)), 0, 0),
    "a film on the bed": (lattice((-1.0, 1.0), (-0.6, -0.5), (-0.6, 0.6)), 0, 0),
    "everywhere": (np.random.default_rng(1).uniform(-0.6, 0.6, (1000, 3)), 0, None),
}


@pytest.mark.parametrize("fine", [0.5, 0.19, 2.0])
def test_whatever_the_water_does_the_surface_is_finite_and_closed(tank, fine):
    surface = tank if fine == 0.5 else built(STILL, basin(2.0, 1.2, 0.6), spacing=fine * SPACING)
    for what, (places, outside, lonely) in EXTREMES.items():
        mesh = put(surface, places).mesh()
        assert topology(mesh)[0], what
        assert np.isfinite(mesh.vertices).all() and np.isfinite(mesh.normals).all(), what
        left_over = surface.map.n - len(places)
        assert surface.outside == outside + left_over, what
        assert lonely is None or spray(surface).sum() == lonely + left_over, what
        heights = surface.elevations(line(np.linspace(-1.0, 1.0, 50)))
        assert ((heights >= -0.6) & (heights <= 0.6)).all(), what


def test_a_jet_and_a_film_have_their_size(tank):
    jet = put(tank, lattice((-0.2, 0.2), (-0.6, 0.3), (-0.2, 0.2)))
    assert jet.elevations(np.array([[0.0, 0.0], [0.7, 0.0]])) == pytest.approx([0.3, -0.6], abs=0.2 * SPACING)
    film = put(tank, lattice((-1.0, 1.0), (-0.6, -0.5), (-0.6, 0.6)))
    assert film.free_surface().volume(bed=-0.6) == pytest.approx(2.0 * 1.2 * 0.1, rel=0.03)


def test_only_rows_near_water_are_kept_and_the_rest_is_dry(tank):
    jet = put(tank, np.concatenate([lattice((-0.2, 0.2), (-0.6, 0.3), (-0.2, 0.2)), [[0.8, 0.4, 0.5]]]))
    rows, banded = tank.isosurface.rows, jet.mesh()
    assert rows.count[None] < 0.8 * rows.all
    rows.near.fill(1)
    rows.keep_rows()
    tank.map.fill_rows(rows, tank.isosurface.value, tank.isovalue)
    whole = tank.cut_surface(0)[0]
    assert rows.count[None] == rows.all
    for array in ("vertices", "triangles", "normals"):
        np.testing.assert_array_equal(getattr(banded, array), getattr(whole, array))
    rows.near.fill(0)  # a control: without rows there is nothing
    rows.keep_rows()
    assert len(tank.cut_surface(0)[0].triangles) == 0


def test_rows_without_room_stop_with_a_sentence(taichi_cpu):
    surface = built(STILL, basin(2.0, 1.2, 0.6), most_nodes=24_000)
    surface.mesh()
    apart = np.linspace(-0.55, 0.55, len(STILL))
    with pytest.raises(Diverged, match=r"\d+ nodes .* near water, more than surface\.most_nodes 24000; try a larger"):
        put(surface, np.stack([0.0 * apart, apart, np.roll(apart, 600)], axis=1)).mesh()


def test_a_surface_of_too_many_triangles_stops_with_a_sentence(sea, monkeypatch):
    monkeypatch.setattr(sea, "config", sea.config.model_copy(update={"most_triangles": 1000}))
    with pytest.raises(Diverged, match=r"has \d+ triangles, more than surface\.most_triangles 1000; try a larger"):
        sea.mesh()


def test_nothing_is_built_until_it_is_read(sea, monkeypatch):
    done = []
    for owner, name in (
        (sea.map, "sort_particles"),
        (sea.map, "fill_rows"),
        (sea.isosurface, "count_surface"),
        (sea, "find_heights"),
    ):
        before = getattr(owner, name)
        monkeypatch.setattr(owner, name, lambda *a, f=before, n=name: done.append(n) or f(*a))
    sea.follow(sea.map.particles, 0.01)
    assert done == []
    sea.mesh(), sea.free_surface()
    assert done == ["sort_particles", "fill_rows", "count_surface", "count_surface"]
    sea.elevations(line(np.zeros(1))), sea.elevations(line(np.ones(1)))
    assert done[4:] == ["find_heights"]


@ti.data_oriented
class Reader:
    """Something that feels the surface in a kernel, as a ship does."""

    def __init__(self, surface: MarchingCubes) -> None:
        self.surface = surface

    @ti.kernel
    def height(self) -> float:
        return self.surface.elevation(0.1, 0.0)


def test_heights_are_kept_current_once_a_kernel_reads_them(taichi_cpu):
    surface = built(STILL, basin(2.0, 1.2, 0.6))
    reader = Reader(surface)
    for rise in (0.0, 0.05, 0.1):
        put(surface, STILL + [0.0, rise, 0.0])
        assert reader.height() == pytest.approx(rise, abs=0.05 * SPACING)


def test_a_kernel_never_reads_old_heights_unsaid(sea):
    with pytest.raises(Exception, match="heights are out of date: call `update_heights`"):
        Reader(sea).height()
    sea.read_by_kernel = False


def test_flat_water_is_half_full_at_its_surface():
    assert flat_share(2.0, 1.0) == pytest.approx(0.5, abs=0.003)
    assert flat_share(6.0, 1.0) == pytest.approx(0.5, abs=1e-5)


SCENE = {
    "basin": {"length": 2.0, "width": 1.0, "depth": 0.5},
    "fluid": {"kind": "mueller", "spacing": 0.1, "kinematic_viscosity": 0.02},
    "surface": "marching_cubes",
    "runtime": {"precision": "f64", "threads": 1},
}


def test_the_ledger_tells_what_is_allocated(taichi_cpu):
    before = runtime.allocated_bytes()
    surface = built(STILL, basin(2.0, 1.2, 0.6))
    put(surface, STILL).mesh()
    allocated = runtime.allocated_bytes() - before - 3 * 8 * len(STILL)  # the particles are the water's
    ledger_rows = surface.config.ledger(SceneFacts({"fluid": water(STILL)}, surface.basin, 8, 1.0))
    assert {row.part for row in ledger_rows} == {"surface"}
    assert allocated == pytest.approx(sum(row.bytes for row in ledger_rows), rel=0.01)


@pytest.mark.parametrize(
    "keys, basin_keys, sentence",
    [
        ({"spacing": 0.001}, {}, r"surface\.spacing: makes .* nodes, more than the 67108864 there can be"),
        ({"radius": 0.05}, {}, r"surface\.radius: 0\.05 m must be 1\.2 to 6 spacings of the particles, 0\.1 m"),
        ({}, {"width": None}, r"surface\.kind: marching cubes need a basin with a width"),
        ({}, {"lid": {}}, r"surface\.kind: a basin without a free surface has none to draw"),
    ],
)
def test_bad_input_is_told_in_a_sentence(keys, basin_keys, sentence):
    scene = SCENE | {"surface": {"kind": "marching_cubes"} | keys, "basin": SCENE["basin"] | basin_keys}
    with pytest.raises(SceneError, match=sentence):
        ocean_sim.load(scene)


def test_a_level_of_zero_is_refused():
    with pytest.raises(ValidationError, match="isovalue"):
        Config(isovalue=0.0)


def test_accuracy_tells_the_free_surface_alone(tmp_path):
    """Still water's surface has the area of the plan, and the water of the basin under it, within the rim."""
    scene = {
        "duration": 0.02,
        "basin": {"length": 4.0, "width": 4.0, "depth": 2.0},
        "fluid": {"kind": "mueller", "spacing": 0.25},
        "surface": "marching_cubes",
        "accuracy": {"every": 0.01},
    }
    import ocean_sim

    off = dict.fromkeys(("render", "frames", "report"))
    rows = ocean_sim.run(ocean_sim.load(scene | off), out=tmp_path).accuracy
    assert abs(rows["surface_area_m2"][0] / 16.0 - 1.0) < 0.01
    assert abs(rows["surface_volume_m3"][0] / 32.0 - 1.0) < 0.01
    assert rows["surface_outside"][-1] == 0.0
    assert 0.0 <= rows["surface_ambiguous"][-1] < 0.01
