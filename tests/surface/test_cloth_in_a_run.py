"""A cloth in a run: the water does not feel it, threads do not change it, a storm does not tear it, files have it."""

import hashlib

import numpy as np
import pytest

from ocean_sim.files.csv_file import read_columns
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.pictures.export.paraview import export_run
from ocean_sim.reading.scene import load, packaged_scenes
from ocean_sim.result import run
from ocean_sim.simulation import Simulation

SEA = {
    "basin": {"length": 24.0, "width": 20.0, "depth": 5.0},
    "fluid": {"kind": "mueller", "spacing": 1.25, "kinematic_viscosity": 1.0, "compression": 0.008},
    "wind": "noise_only",
    "surface": "cloth",
}
BOX = {"include": [{"kind": "box", "half_size": [6.0, 6.0, 6.0], "centre": [0.0, 0.0, 0.0]}]}
QUIET = dict.fromkeys(("render", "report", "frames", "accuracy", "timings"))


def state(steps: int = 40, **sets) -> tuple[str, np.ndarray | None]:
    """SHA-256 of positions and velocities, and the heights of the sheet, after so many steps."""
    with Simulation(load(SEA | QUIET, {"runtime.threads": 1, **sets})) as simulation:
        for _ in range(steps):
            simulation.step()
        particles, surface = simulation.fluid.particles, simulation.surface
        bytes_ = b"".join(field.to_numpy().tobytes() for field in (particles.position, particles.velocity))
        return hashlib.sha256(bytes_).hexdigest(), surface.height.to_numpy() if surface is not None else None


@pytest.fixture(scope="module")
def with_cloth():
    return state()


@pytest.mark.anchor
def test_the_water_moves_bit_for_bit_as_without_a_cloth(with_cloth):
    assert state(surface=None)[0] == with_cloth[0]


def test_two_threads_give_the_same_sheet(with_cloth):
    again = state(**{"runtime.threads": 2})
    assert again[0] == with_cloth[0] and np.array_equal(again[1], with_cloth[1])
    assert np.ptp(with_cloth[1]) > 0.05  # there are waves on it


def test_it_fits_the_water_of_a_moving_sea(tmp_path):
    """accuracy.csv: mean and RMS distance from the highest particles, area and volume."""
    out = tmp_path / "run"
    watched = QUIET | {"accuracy": {"every": 0.2}, "frames": {"every": 0.2}, "duration": 1.0, "wind": "still"}
    run(load(SEA | watched, {"fluid.initial": {"kind": "standing_wave", "amplitude": 0.6, "mode": 2}}), out)
    table = read_columns(out / "accuracy.csv")
    assert np.abs(table["surface_offset_m"]).max() < 0.05 * 1.25
    assert table["surface_fit_m"].max() < 0.15 * 1.25
    assert (table["surface_area_m2"] > 0.999 * 24.0 * 20.0).all()
    assert table["surface_volume_m3"] == pytest.approx(24.0 * 20.0 * 5.0, rel=0.03)
    last = sorted((out / "frames").glob("frame_*.npz"))[-1]
    grid, frame = np.load(out / "frames" / "grid.npz"), np.load(last)
    vertices = frame["vertices"].reshape(20, 17, 3)
    middle = 0.25 * (vertices[:-1, :-1] + vertices[1:, :-1] + vertices[:-1, 1:] + vertices[1:, 1:])
    assert frame["elevation"].shape == (len(grid["x"]), len(grid["z"]))
    assert frame["elevation"].mean() == pytest.approx(middle[:, :, 1].mean(), abs=0.02)
    import pyvista

    ply = export_run(out, None, "ply", tmp_path / "export")[-1]
    mesh = pyvista.read(ply)
    np.testing.assert_allclose(mesh.points, frame["vertices"], atol=1e-6)
    assert mesh.n_cells == len(frame["triangles"]) and mesh.area == pytest.approx(
        table["surface_area_m2"][-1], rel=0.01
    )


@pytest.mark.parametrize(
    "sets",
    [
        {"surface.every": 1.0 / 6.0, "surface.stretching_stiffness": 1.8e4, "surface.bending_stiffness": 1.8e4},
        pytest.param({"surface.spacing": 0.3, "surface.thickness": 1.3}, marks=pytest.mark.slow),
    ],
)
def test_a_storm_leaves_it_finite_and_above_the_bed(sets):
    storm = {"kind": "gusts", "volumes": [{**BOX, "acceleration": [-20.0, 30.0, 5.0], "noise": [30.0, 30.0, 30.0]}]}
    _, heights = state(150, wind=storm, **sets)
    assert np.isfinite(heights).all()
    assert heights.min() >= -5.0 and heights.max() < 40.0


def test_the_thesis_scenes_have_a_cloth_and_a_part_has_the_numbers_of_the_listing():
    names = [name for name in packaged_scenes() if name.startswith("thesis/")]
    assert len(names) >= 4 and all(load(name).surface.kind == "cloth" for name in [*names, "showcase"])
    listing = load("thesis/fig6_3c_wide", {"surface": "thesis_listing"}).surface
    dt = 1.0 / 60.0  # of PhysX
    assert listing.thickness == 1.5 and listing.edges == -0.5 and listing.response == 1.0
    for stiffness in (listing.stretching_stiffness, listing.bending_stiffness):
        assert 2.0 * stiffness * dt**2 == pytest.approx(0.01)
    assert listing.damping * dt == pytest.approx(0.001)


def test_a_scene_that_leaves_numbers_to_the_water_is_built_with_them_and_dumped_without():
    config = load(SEA | QUIET, {"resolution": 2.0})
    built = config.preflight.surface
    assert built.spacing == config.fluid.spacing == 2.5
    assert built.thickness == 5.0
    assert config.surface.spacing is None and config.surface.thickness is None
    again = load(config.resolved())
    assert again.surface == config.surface and again.preflight.surface == built


@pytest.mark.parametrize(
    "sets, sentence",
    [
        ({"surface.thickness": 0.5}, "less, and the sheet falls between them"),
        ({"surface.thickness": 4.0}, "water is looked for no further"),
        ({"basin.lid": {}}, "nothing for a cloth to lie on"),
        ({"surface.response": 1.5}, "surface.response: 1.5 is not at most 1"),
        ({"surface.every": 0.0}, "surface.every: 0.0 is not greater than 0"),
        ({"surface.spacing": 1e-5}, "nodes, more than"),
    ],
)
def test_what_cannot_be_is_refused_with_a_sentence(sets, sentence):
    with pytest.raises(SceneError) as refusal:
        load(SEA, sets)
    assert sentence in str(refusal.value)
