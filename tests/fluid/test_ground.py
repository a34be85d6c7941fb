"""Beds of any shape: what they displace, how still water lies over them, and which are refused."""

import re

import numpy as np
import pytest
from scipy.io import netcdf_file

from ocean_sim import Simulation, load
from ocean_sim.files.bathymetry import read_heights
from ocean_sim.files.input_file import Unreadable
from ocean_sim.files.yaml_file import SceneError
from tests.conftest import quickly

DEPTH = 0.4
SLOPE = [[-1.0, -DEPTH], [-0.6, -DEPTH], [1.0, -0.08]]
SAWTOOTH = [
    [-1.0, -DEPTH],
    *([-0.8 + 0.2 * k + 0.1 * j, -DEPTH + 0.1 * j] for k in range(8) for j in (0, 1)),
    [1.0, -DEPTH],
]


def scene(floor, fluid=None, **basin):
    """Slice, 2 m long and 0.4 m deep, with a bed."""
    return {
        "duration": 1.0,
        "basin": {"length": 2.0, "depth": DEPTH, "floor": floor} | basin,
        "fluid": {"kind": "delta_sph", "spacing": 0.04} | (fluid or {}),
    }


def write_mound(path, turned=False, **traits):
    """Heights of a mound on a grid of 0.1 m, in the format that the file's ending names; east of a map is -x. `turned`:
    east is the first dimension of a netCDF file; `traits`: of its heights."""
    x, z = np.linspace(-1.0, 1.0, 21), np.linspace(-0.5, 0.5, 11)
    y = -DEPTH + 0.3 * np.exp(-((x[:, None] - 0.3) ** 2 + (z - 0.1) ** 2) / 0.1)
    if path.suffix == ".csv":
        rows = [f"{a},{b},{c!r}" for a, row in zip(x, y.tolist()) for b, c in zip(z, row)]
        path.write_text("\n".join(["x_m,z_m,y_m", *rows[::-1]]))
    elif path.suffix == ".asc":
        head = "ncols 21\nnrows 11\nxllcorner -1.05\nyllcorner -0.55\ncellsize 0.1\nNODATA_value -9999\n"
        path.write_text(head + "\n".join(" ".join(map(repr, row)) for row in y[::-1].T[::-1].tolist()))
    else:
        with netcdf_file(path, "w") as file:
            for name, nodes in (("x", x), ("y", z)):
                file.createDimension(name, len(nodes))
                file.createVariable(name, "d", (name,))[:] = nodes
            heights = file.createVariable("elevation", "d", ("x", "y") if turned else ("y", "x"))
            heights[:] = (y[::-1] if turned else y[::-1].T) * (-1.0 if "positive" in traits else 1.0)
            for name, value in traits.items():
                setattr(heights, name, value)
    return y


@pytest.mark.parametrize("profile", [SLOPE, SAWTOOTH, [[-1.0, -0.4], [0.4, -0.4], [1.0, 0.2]]])
def test_a_bed_takes_as_many_particles_as_it_displaces(profile):
    preflight = load(scene({"profile": profile})).preflight
    x, y = np.array(profile).T
    water = np.trapezoid(np.maximum(-np.interp(np.linspace(-1, 1, 20001), x, y), 0.0), dx=1e-4)
    assert preflight.lattice.n == pytest.approx(water / 0.04**2, abs=2)
    positions, ground = preflight.lattice.positions(), preflight.tank.ground
    assert (ground.distances(positions) > 0.0).all()
    apart = np.linalg.norm(positions[:, None] - positions, axis=2) + np.eye(len(positions))
    assert apart.min() > 0.6 * 0.04


def test_samples_fill_the_ground_down_to_the_flat_bed():
    ground = load(scene({"profile": SLOPE})).preflight.tank.ground
    position, volume, normal = ground.samples(0.04, 1.0)
    assert volume.sum() == pytest.approx(0.5 * 1.6 * 0.32, rel=2e-3)
    assert position[:, 1].min() > -DEPTH
    assert normal[position[:, 0] > -0.5] == pytest.approx(
        np.array([[-0.2, 1.0, 0.0]] * (position[:, 0] > -0.5).sum()) / 1.04**0.5
    )


@pytest.mark.parametrize("ending", ["csv", "asc", "nc"])
def test_heights_on_a_grid_read_alike_in_three_formats(ending, tmp_path):
    file = tmp_path / f"mound.{ending}"
    y = write_mound(file)
    tank = load(scene({"grid": str(file)}, width=1.0, fluid={"spacing": 0.1})).preflight.tank
    assert tank.ground.y == pytest.approx(np.maximum(y, -DEPTH), abs=1e-12)
    with pytest.raises(SceneError, match="the bed reaches from x = "):
        load(scene({"grid": str(file), "grid_centre": [0.2, 0.0]}, {"spacing": 0.1}, width=1.0))


def test_a_map_may_lack_heights_and_lie_deeper_outside_the_basin_only(tmp_path):
    file = tmp_path / "mound.csv"
    write_mound(file)
    z = np.linspace(-0.5, 0.5, 11)
    outside = "\n".join(f"{x},{b},{'9999' if b > 0.0 else '-7'}" for x in (-1.1, 1.1) for b in z)
    file.write_text(file.read_text() + "\n" + outside)
    ground = load(scene({"grid": str(file)}, width=1.0, fluid={"spacing": 0.1})).preflight.tank.ground
    assert ground.y.min() == pytest.approx(-DEPTH, abs=1e-6)
    file.write_text(re.sub(r"(?m)^0.0,0.0,.*$", "0.0,0.0,9999", file.read_text()))
    with pytest.raises(
        SceneError, match=r"1 of \d+ heights in the basin are missing, or of 9000 m and more, the first at x = "
    ):
        load(scene({"grid": str(file)}, width=1.0, fluid={"spacing": 0.1}))


def test_a_map_says_its_dimensions_its_direction_and_its_unit(tmp_path):
    file = tmp_path / "mound.nc"
    for traits in ({"turned": True}, {"positive": "down"}, {"turned": True, "units": "m"}):
        y = write_mound(file, **traits)
        assert read_heights(file, (0.0, 0.0)).y == pytest.approx(y, abs=1e-12)
    write_mound(file, units="feet")
    with pytest.raises(Unreadable, match="its places and heights are in m, m, feet"):
        read_heights(file, (0.0, 0.0))


@pytest.mark.parametrize(
    "row, sentence",
    [("0,0.5,-0.4\n1,0.5,-0.4\n0,0,-0.1", "x = 0, z = 0 m has two heights"), ("", "it has 2 x 1 heights")],
)
def test_a_table_that_cannot_be_is_refused(row, sentence, tmp_path):
    (tmp_path / "bed.csv").write_text(f"x_m,z_m,y_m\n0,0,-0.4\n1,0,-0.4\n{row}")
    with pytest.raises(Unreadable, match=sentence):
        read_heights(tmp_path / "bed.csv", (0.0, 0.0))


@pytest.mark.parametrize(
    "head, rows, sentence",
    [
        ("ncols 2 nrows 2 xllcorner 0 yllcorner 0 cellsize 1", "0 0\n0 a", "line 3: 'a' is not a number"),
        ("ncols 2 nrows 2 yllcorner 0", "0 0\n0 0", "its head lacks cellsize, xllcorner"),
        ("ncols 2 nrows 2 xllcenter 0 yllcenter 0 cellsize 1", "0 0\n0", "it has 3 heights, by its head 2 rows of 2"),
        ("ncols 2 nrows nan xllcenter 0 yllcenter 0 cellsize 1", "0 0\n0 0", "by its head nan rows of 2"),
    ],
)
def test_a_map_that_cannot_be_is_refused(head, rows, sentence, tmp_path):
    (tmp_path / "bed.asc").write_text(f"{head}\n{rows}\n")
    with pytest.raises(Unreadable, match=sentence):
        read_heights(tmp_path / "bed.asc", (0.0, 0.0))


def test_a_bed_mostly_dry_is_warned_of():
    for profile, told in (([[-1.0, 0.35], [-0.7, 0.4], [1.0, -0.1]], True), (SLOPE, False)):
        config = load(scene({"profile": profile}))
        warnings = config.fluid.warnings(config.preflight)
        assert any("are these depths, downwards?" in warning for warning in warnings) == told


@pytest.mark.parametrize("profile", quickly(SLOPE, SAWTOOTH))
def test_still_water_stays_still_over_a_shaped_bed(profile):
    """Within 0.8 % of sqrt(g h), at the pressure of its depth on the bed within 1 %."""
    with Simulation(load(scene({"profile": profile}, {"spacing": 0.02}))) as simulation:
        simulation.run(until=1.0)
        water, ground = simulation.fluid, simulation.basin.ground
        speed = np.linalg.norm(water.particles.snapshot().velocity, axis=1)
        x = np.linspace(-0.9, 0.5, 15)
        points = np.stack([x, ground.heights(np.stack([x, 0 * x], axis=1)), 0 * x], axis=1)
        apart = water.pressures(points) + 9810.0 * points[:, 1]
    assert np.sqrt((speed**2).mean()) < 8e-3 * (9.81 * DEPTH) ** 0.5
    assert np.abs(apart).mean() < 0.01 * 9810.0 * DEPTH


@pytest.mark.parametrize(
    "data, sentence",
    [
        (
            scene({"profile": [[-1, -0.4], [0, 0.1]]}),
            "basin.floor.profile: the bed reaches from x = -1 to 0 m, the basin",
        ),
        (scene({"profile": [[-1, -0.5], [1, 0.1]]}), "basin.floor.profile: the bed reaches down to y = -0.5 m"),
        (
            scene({"profile": [[-1, -0.4], [1, 300]]}),
            "basin.floor.profile: the bed rises to y = 300 m over water",
        ),
        (scene({"profile": [[-1, 0.4], [1, 0.1]]}), "basin.floor.profile: the bed lies above the water everywhere"),
        (scene({"profile": [[-1, -0.4], [1, -0.4]]}), "basin.floor.profile: the bed is flat, at y = -0.4 m"),
        (
            scene({"profile": [[-1, -0.4], [-1, 0.1]]}),
            "basin.floor: a profile has two points [x, y] or more, and their x",
        ),
        (scene({"profile": [[-1, float("nan")], [1, 0.1]]}), "basin.floor.profile"),
        (scene({"profile": [[-1, -0.4], [0.5, -0.2], [0.2, -0.1], [1, 0.1]]}), "their x rise: 0.2 comes after 0.5"),
        (scene({"grid": "nothing.csv"}), "basin.floor.grid: nothing.csv: there is no such file"),
        (scene({"profile": SLOPE, "grid": "a.csv"}), "basin.floor: give either a profile or a grid"),
        (scene({"profile": SLOPE}, walls="periodic"), "basin.floor.profile: x is periodic, and the bed is not as high"),
        (
            scene({"profile": SLOPE}, wavemaker={"wall": "x_max", "height": 0.05, "period": 1.0}),
            "basin.floor.profile: before the wavemaker the bed must lie at y = -0.4 m",
        ),
        (scene({"profile": SLOPE}, lid={}), "basin.floor.profile: a bed with a shape lies under a free surface"),
        (
            scene({"profile": SLOPE}, {"initial": {"kind": "standing_wave", "height": 0.01, "mode": 1}}),
            "fluid.initial.kind: these are waves over a flat bed",
        ),
        (
            scene({"profile": SLOPE}) | {"fluid": {"kind": "linear_waves", "height": 0.01, "period": 1.0}},
            "fluid.kind: a sea in closed form lies over a flat bed",
        ),
    ],
)
def test_a_bed_that_cannot_be_is_refused_in_a_sentence(data, sentence):
    with pytest.raises(SceneError, match=re.escape(sentence)):
        load(data)


def test_water_runs_down_a_slope_without_going_through_it():
    """A block of water on a slope of 1:2 slides to its foot; nothing is lost, nothing lies in the ground."""
    slope = {"profile": [[-1.0, -0.4], [-0.2, -0.4], [1.0, 0.2]]}
    data = scene(slope, {"fill": [{"min": [0.2, -0.1], "max": [0.6, 0.0]}]}) | {"duration": 0.8}
    with Simulation(load(data)) as simulation:
        before = simulation.fluid.positions()[:, 0].mean()
        simulation.run(until=0.8)
        after = simulation.fluid.positions()
        assert after[:, 0].mean() < before - 0.2
        assert (simulation.basin.ground.distances(after) > 0.0).all()


def test_water_runs_up_as_far_as_no_dry_place_lies_below():
    """Lifted water leaves no gap; a puddle above a dry place does not count, nor does water above one."""
    ground, spacing = load(scene({"profile": SLOPE})).preflight.tank.ground, 0.04
    x = np.arange(-0.98, 0.2, spacing)
    bed = ground.heights(np.stack([x, 0 * x], axis=1))
    edge = 0.5 * spacing * (1.0 + 0.2 + 0.2**2) / np.hypot(1.0, 0.2)  # of water on a slope of 1:5
    water = np.stack([x, bed + 0.75 * spacing, 0 * x], axis=1)
    lifted, puddle = water + np.outer((x > -0.5) & (x < -0.2), [0, spacing, 0]), water[-1:] + [0.3, 0.06, 0]
    for place in (water, lifted, np.concatenate([water, puddle])):
        assert ground.runup(place, spacing) == pytest.approx(bed[-1] + edge)
    parted = np.abs(x + 0.3) > 0.1
    assert ground.runup(water[parted], spacing) == pytest.approx(bed[x < -0.4][-1] + edge)
    assert np.isnan(ground.runup(water + [0, 0.5, 0], spacing))


@pytest.mark.parametrize("slope", [1.0, 0.5, 0.2, 0.1, 0.05])
def test_still_water_runs_up_to_its_level(slope):
    length = 0.2 + (DEPTH + 0.1) / slope
    profile = [[-0.5 * length, -DEPTH], [0.2 - 0.5 * length, -DEPTH], [0.5 * length, 0.1]]
    facts = load(scene({"profile": profile}, length=length)).preflight
    assert facts.tank.ground.runup(facts.untouched.positions(), 0.04) == pytest.approx(0.0, abs=0.25 * 0.04)
