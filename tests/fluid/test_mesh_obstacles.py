"""Meshes in the water: they displace, bear and move as boxes do, and are refused as the meshes of hulls are."""

import subprocess
import sys

import numpy as np
import pytest
import trimesh

from ocean_sim import load
from ocean_sim.conventions import GRAVITY
from ocean_sim.observers.shared.checks import distance_outside
from ocean_sim.reading.scene import SceneError
from ocean_sim.simulation import Simulation
from tests.fluid.test_boundary import FREE, step_to

SIZE, SPACING = 0.4, 0.04
BASIN = {"length": 0.8, "width": 0.8, "depth": 0.8}
BOX = {"min": [-0.2, -0.6, -0.2], "max": [0.2, -0.2, 0.2]}
QUIET = dict.fromkeys(("render", "report", "timings", "preview"))


@pytest.fixture(autouse=True, scope="module")
def cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """A function that writes bodies into one file and returns its name."""
    folder = tmp_path_factory.mktemp("meshes")

    def written(*bodies, name: str = "body.stl") -> str:
        trimesh.util.concatenate(bodies).export(folder / name)
        return str(folder / name)

    return written


@pytest.fixture(scope="module")
def cube(file):
    """A cube in millimetres whose file has x, -z and y of the basin along its own x, y and z."""
    return {"mesh": file(trimesh.creation.box([1e3 * SIZE] * 3), name="cube.stl"), "unit": "mm"}


def starting(obstacle: dict, spacing: float = SPACING, kind: str = "delta_sph"):
    """Basin with one obstacle, and the lattice of its water."""
    config = load({"basin": BASIN | {"obstacles": [obstacle]}, "fluid": {"kind": kind, "spacing": spacing}})
    return config.preflight.tank, config.fluid.lattice(config.preflight.tank)


def test_a_cube_displaces_as_many_particles_as_a_box_and_the_same(cube):
    """On the lattice the particles rest already: none moves, and samples, volumes and normals are the box's."""
    (_, box), (_, mesh) = starting(BOX), starting(cube | {"at": [0.0, -0.4, 0.0]})
    assert box.start_count == mesh.start_count == 20**3 - 10**3
    np.testing.assert_allclose(mesh.positions(), box.positions(), atol=1e-3 * SPACING)
    np.testing.assert_allclose(mesh.column_ends(), box.column_ends(), atol=1e-9)


@pytest.mark.parametrize("up, file_axes", [("z", (0, 2, 1)), ("y", (0, 1, 2)), ("-z", (0, 2, 1)), ("x", (1, 0, 2))])
def test_a_mesh_stands_by_its_files_origin_turned_upright_and_to_its_heading(file, up, file_axes):
    """A slab from the file's origin on: its lengths along x, y and z of the basin, and where its middle lies."""
    lengths = np.array([0.3, 0.2, 0.1])
    body = trimesh.creation.box(lengths, trimesh.transformations.translation_matrix(0.5 * lengths))
    obstacle = {"mesh": file(body, name=f"slab{up}.ply"), "up": up, "at": [0.05, -0.4, 0.0]}
    low, high = starting(obstacle, 0.1, "mueller")[0].meshes[0].extent
    np.testing.assert_allclose(high - low, lengths[list(file_axes)], atol=1e-6)
    assert low[1] == pytest.approx(-0.4 - (0.1 if up == "-z" else 0.0), abs=1e-6)
    turned = starting(obstacle | {"heading_deg": 90.0}, 0.1, "mueller")[0].meshes[0].extent
    np.testing.assert_allclose(turned[:, 0] - 0.05, [low[2], high[2]], atol=1e-6)  # z goes where x was
    np.testing.assert_allclose(turned[:, 2], [0.05 - high[0], 0.05 - low[0]], atol=1e-6)


def bears(water, obstacle: dict, begin: float, end: float):
    """Fluid around an obstacle at `end` [s], and its mean force (3,) [N] on it since `begin` [s]."""
    fluid = water("delta_sph", basin=BASIN | {"obstacles": [obstacle]}, spacing=SPACING, accounts=True)
    step_to(fluid, begin)
    before = fluid.boundary.impulses()[0]
    step_to(fluid, end)
    return fluid, (fluid.boundary.impulses()[0] - before) / (end - begin)


@pytest.mark.slow
@pytest.mark.parametrize("body", ["cube", "sphere"])
def test_a_submerged_mesh_bears_the_weight_of_the_water_it_displaces(water, file, cube, body):
    """Archimedes within 1 %, ten spacings across, and nobody is inside."""
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.5 * SIZE)
    own = cube if body == "cube" else {"mesh": file(ball, name="ball.obj")}
    fluid, force = bears(water, own | {"at": [0.0, -0.4, 0.0]}, 0.1, 0.6)
    weight = 1000.0 * GRAVITY * (SIZE**3 if body == "cube" else ball.volume)
    assert force[1] == pytest.approx(weight, rel=0.01) and np.abs(force[[0, 2]]).max() < 2e-3 * weight
    assert fluid.status.max_speed < 0.05 * np.sqrt(GRAVITY * 0.8)
    x = fluid.particles.position.to_numpy()
    assert not distance_outside(x, fluid.grid.basin, fluid.time, SPACING).any()


SPEED = np.array([-1.0, 0.3, 0.0])
PLATE = trimesh.creation.box([0.2, 0.3, 0.3])  # x, y, z of the basin, by `up: y`


def swept(water, obstacle: dict, kind: str = "delta_sph"):
    """A block of water at rest in a slice into which a plate has run for 0.1 s, away from sides, without gravity."""
    basin = FREE | {"obstacles": [obstacle | {"velocity": SPEED.tolist()}]}
    keys = {"spacing": 0.05, "reference_speed": 4.0, "kinematic_viscosity": 0.005, "collision_distance": 0.001}
    fluid = water(kind, basin=basin, accounts=True, fill=[{"min": [-0.35, -0.4], "max": [0.0, -0.1]}], **keys)
    fluid.particles.pressure.fill(0.0)
    for _ in range(100):
        fluid.advance(0.001)
    return fluid


def test_a_moving_mesh_gives_the_water_what_a_moving_box_gives(water, file):
    """In a slice, by its section: all of the water's momentum comes from its samples and its faces, work is velocity
    times impulse, and both are those of the box."""
    mesh = {"mesh": file(PLATE, name="plate.stl"), "up": "y", "at": [0.15, -0.25]}
    by_mesh, by_box = swept(water, mesh), swept(water, {"min": [0.05, -0.4], "max": [0.25, -0.1]})
    momentum = by_mesh.particles.mass * by_mesh.particles.velocity.to_numpy().sum(axis=0)
    impulse, scale = by_mesh.impulse, np.abs(momentum).max()
    np.testing.assert_allclose(impulse["obstacles"] + impulse["walls"], momentum, atol=1e-12 * scale)
    assert by_mesh.work["obstacles"] == pytest.approx(impulse["obstacles"] @ SPEED, rel=1e-12)
    np.testing.assert_allclose(impulse["obstacles"], by_box.impulse["obstacles"], atol=0.02 * scale)


def thrown(water, obstacle: dict, kind: str):
    """A block of water in a slice that hits an obstacle at 2 m/s."""
    fill = [{"min": [-0.45, -0.4], "max": [-0.2, -0.1]}]
    fluid = water(kind, basin=FREE | {"obstacles": [obstacle]}, fill=fill, spacing=0.025, **thrown_keys(kind))
    fluid.particles.velocity.from_numpy(np.tile([2.0, 0.0, 0.0], (fluid.particles.n, 1)))
    fluid.begin()
    return fluid


def thrown_keys(kind: str) -> dict:
    return {} if kind == "ballistic" else {"reference_speed": 4.0}


def inside(fluid, steps: int) -> int:
    """Number of particles that were in an obstacle after any of so many steps, each counted once a step."""
    found = 0
    for _ in range(steps):
        fluid.advance(0.0015)
        x = fluid.particles.position.to_numpy()
        found += int(np.count_nonzero(distance_outside(x, fluid.grid.basin, fluid.time, 0.025)))
    assert x[:, 0].max() > 0.0
    return found


@pytest.mark.parametrize("kind", ["delta_sph", "ballistic"])
def test_no_particle_gets_into_a_mesh(water, file, kind):
    """A block of water thrown against a ball, seen through its middle; what ignores other particles and samples is
    stopped by its distances alone. Negative control: without them it runs through the ball."""
    ball = {"mesh": file(trimesh.creation.icosphere(subdivisions=4, radius=0.15), name="small.stl"), "at": [0.1, -0.25]}
    assert inside(thrown(water, ball, kind), 150) == 0
    if kind == "ballistic":
        fluid = thrown(water, ball, kind)
        fluid.walls.nets[0][1].nodes.fill(9.0)
        assert inside(fluid, 150) > 0


def test_a_mesh_that_has_left_is_nowhere(water, file):
    gate = {"mesh": file(PLATE, name="gate.stl"), "up": "y", "at": [0.15, -0.25], "until": 0.05}
    fluid = water("delta_sph", basin=FREE | {"obstacles": [gate]}, fill=[{"min": [-0.4, -0.4], "max": [0.0, -0.1]}],
                  spacing=0.05, reference_speed=1.0)  # fmt: skip
    basin = fluid.grid.basin
    assert len(basin.meshes_at(0.0)) == 1 and fluid.boundary.start.to_numpy()[-1] == fluid.boundary.n
    step_to(fluid, 0.06)
    assert basin.meshes_at(fluid.time) == [] and fluid.boundary.start.to_numpy()[-1] == 0
    assert len(basin.mesh_triangles(fluid.time, moving=True)) == 0 and not fluid.boundary.forces()[0].any()


def open_box():
    mesh = trimesh.creation.box([0.1, 0.1, 0.1])
    return trimesh.Trimesh(mesh.vertices, mesh.faces[:-1], process=False)


@pytest.mark.parametrize(
    ("body", "keys", "sentence"),
    [
        (open_box(), {}, r"obstacles.0.mesh: .*not watertight: 3 edges bound a hole"),
        (trimesh.creation.box([0.1] * 3), {"mesh": "none.stl"}, "there is no such file"),
        (trimesh.creation.box([0.1] * 3), {"at": [0.48, -0.25]}, "the box around the mesh, 0.1 x 0.1 m, reaches out"),
        (trimesh.creation.box([100.0] * 3), {}, "reaches out of the basin along x and y; is its .unit. right"),
        (trimesh.creation.box([0.1] * 3), {"at": [0.0, -0.25, 0.0]}, "has 2 numbers, got 3"),
        (trimesh.creation.box([1.0, 1.0, 0.5]), {}, "leave no room for water"),
        (trimesh.creation.box([0.1, 0.1, 0.01]), {}, "the mesh is 0.*spacings thick.*unit"),
        (trimesh.creation.box([0.1] * 3, trimesh.transformations.translation_matrix([0, 0.2, 0])), {},
         r"the slice, z = 0, misses this mesh from z = -0.25 to -0.15 m"),
        (trimesh.creation.box([0.1] * 3), {"unit": "km"}, "unit: 'km' is not"),
        (trimesh.creation.box([0.1] * 3), {"min": [0.0, 0.0]}, "obstacles.0.min: unknown key"),
        (trimesh.creation.box([0.1] * 3), {"velocity": [9.0, 0.0, 0.0]}, "reaches out of the basin along x at 0.0"),
    ],
)  # fmt: skip
def test_meshes_that_cannot_be_are_said(file, body, keys, sentence):
    obstacle = {"mesh": file(body, name="bad.stl"), "at": [0.0, -0.25]} | keys
    with pytest.raises(SceneError, match=sentence):
        load({"basin": {"length": 1.0, "depth": 0.5, "obstacles": [obstacle]},
              "fluid": {"kind": "mueller", "spacing": 0.1}, "duration": 1.0})  # fmt: skip


def test_a_mesh_is_an_input_of_the_run_and_check_says_where_it_stands(file):
    obstacle = {"mesh": file(trimesh.creation.box([0.2] * 3), name="told.stl"), "at": [0.0, -0.25]}
    scene = load({"basin": {"length": 1.0, "depth": 0.5, "obstacles": [obstacle]},
                  "fluid": {"kind": "mueller", "spacing": 0.1}})  # fmt: skip
    assert list(scene.inputs()) == [obstacle["mesh"]]
    said = scene.fluid.statements(scene.preflight)
    assert "obstacles.0 is a mesh from [-0.1, -0.35] to [0.1, -0.15] m" in said
    assert load(scene.resolved()).resolved() == scene.resolved()
    assert any("spacings thin" in sentence for sentence in scene.warnings())


def test_heights_over_a_dry_mesh_are_those_of_its_top(file):
    """A wedge on the bed: half as high where it is half as wide; water that covers it keeps its height."""
    wedge = trimesh.convex.convex_hull([[-0.3, y, 0.0] for y in (-0.2, 0.2)] + [[0.3, y, 0.0] for y in (-0.2, 0.2)]
                                       + [[0.3, y, 0.6] for y in (-0.2, 0.2)])  # fmt: skip
    tank, _ = starting({"mesh": file(wedge, name="wedge.stl"), "at": [0.0, -0.8, 0.0]}, 0.1, "mueller")
    points = np.array([[0.0, -0.8, 0.0], [0.15, -0.8, 0.1], [0.0, -0.8, 0.25], [0.0, -0.1, -0.1]])
    np.testing.assert_allclose(tank.meshes[0].tops_below(points), [-0.5, -0.35, -np.inf, -0.5], atol=1e-6)


def test_its_fields_are_in_the_ledger_and_its_place_in_the_frames(water, file, tmp_path):
    from ocean_sim.pictures.frame_files import Frame, frame_path

    moving = {"mesh": file(PLATE, name="moving.stl"), "up": "y", "at": [0.0, -0.25], "velocity": [0.1, 0.0, 0.0]}
    scene = {"basin": {"length": 1.0, "depth": 0.5, "obstacles": [moving]}, "duration": 0.02, "frames": {"every": 0.01},
             "fluid": {"kind": "delta_sph", "spacing": 0.05}, "wind": "still", **QUIET}  # fmt: skip
    config = load(scene)
    rows = [row for row in config.ledger() if row.what == "distances from meshes"]
    with Simulation(config, folder=tmp_path) as simulation:
        _, net, _ = simulation.fluid.walls.nets[0]
        assert rows[0].bytes == pytest.approx(4 * (np.prod(net.nodes.shape) * 2 + 6))
        simulation.run(0.02)
    frame = Frame(frame_path(tmp_path, 2))
    ways = frame.moving_meshes - simulation.basin.meshes[0].mesh.triangles
    np.testing.assert_allclose(ways[..., 0], 0.1 * frame.time, atol=1e-6)


def test_without_a_mesh_nothing_of_this_is_imported():
    code = (
        "import sys, ocean_sim; box = {'min': [0.0, -0.4], 'max': [0.2, -0.2]};"
        " s = ocean_sim.load({'basin': {'length': 1.0, 'depth': 0.5, 'obstacles': [box]}, 'duration': 1.0,"
        " 'fluid': {'kind': 'mueller', 'spacing': 0.1}, 'render': None}); ocean_sim.Simulation(s);"
        " print([name for name in sys.modules if name.startswith(('ocean_sim.basin.solids', 'trimesh'))])"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.split()[-1] == "[]"


def test_water_around_a_mesh_from_wall_to_wall_on_the_bed_starts_inside_the_basin(file):
    wedge = trimesh.creation.box([0.4, BASIN["width"], 0.3], trimesh.transformations.translation_matrix([0, 0, 0.15]))
    wedge.vertices[wedge.vertices[:, 2] > 0.1, 0] *= 0.4
    tank, lattice = starting({"mesh": file(wedge, name="dam.stl"), "at": [0.1, -0.8, 0.0]}, 0.08)
    x = lattice.positions()
    assert len(x) == 10**3 - round(wedge.volume / 0.08**3)
    assert not distance_outside(x, tank, 0.0, 0.08).any() and x[:, 1].max() < 0.02
