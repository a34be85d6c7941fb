"""Every scene, part, profile and kind validates; every scene steps under the profile of tests."""

from pathlib import Path

import numpy as np
import pytest

from ocean_sim.parts import SLOTS, KindConfig, ShipConfig, config_of, kinds, library, named
from ocean_sim.reading.scene import load, packaged_scenes
from ocean_sim.simulation import Simulation

BASIN = {"length": 40.0, "width": 40.0, "depth": 7.5}
SEA = {"basin": BASIN | {"depth": 40.0}, "fluid": {"kind": "linear_waves", "height": 0.5, "period": 4.0}}
PARTICLES = {"basin": BASIN, "fluid": {"kind": "mueller", "spacing": 2.5}}
PATCH = PARTICLES | {"basin": BASIN | {"walls": "periodic"}}
PARTS = [(slot, name) for slot in SLOTS for name in named(slot)]
KINDS = [(slot, kind) for slot in SLOTS for kind in kinds(slot)]
MANY = 20_000  # particles: scenes with more are stepped with a coarser lattice


@pytest.mark.parametrize("name", packaged_scenes())
@pytest.mark.parametrize("profile", [None, *named("run")])
def test_every_scene_validates_under_every_profile(name, profile):
    config = load(name, profile=profile)
    assert config.title and load(config.resolved()).resolved() == config.resolved()


@pytest.mark.parametrize("slot, name", PARTS)
def test_every_part_validates(slot, name):
    scene = {"ship": SEA, "surface": PARTICLES | {"fluid": "thesis_6000"}, "sea": PATCH}.get(slot, PARTICLES)
    assert slot in load(scene | {slot: name}).parts()


@pytest.mark.anchor
@pytest.mark.parametrize("slot, kind", KINDS)
def test_every_kind_validates_and_says_its_own_name(slot, kind):
    model = config_of(slot, kind)
    assert issubclass(model, KindConfig)
    afloat = issubclass(model, ShipConfig) and not model.carried_as_body
    scene = SEA if afloat else PATCH if slot == "sea" else PARTICLES
    config = load(scene | {slot: {"kind": kind} | model.example}).parts()[slot]
    assert config.kind == kind and isinstance(config, model)


@pytest.mark.parametrize("folder", ["scenes", "configs"])
def test_every_file_begins_by_saying_what_it_is(folder):
    for path in library(folder).rglob("*.yaml"):
        text = path.read_text(encoding="utf-8")
        assert text.startswith("# ") or "\ntitle: " in text, path


def test_scenes_point_editors_to_the_schema():
    for path in library("scenes").rglob("*.yaml"):
        first = path.read_text(encoding="utf-8").splitlines()[0]
        target = Path(path.parent, first.partition("$schema=")[2])
        assert target.resolve() == library("scenes").parent / "ocean_sim" / "scene.schema.json", path


DEAR = ("gallery/dam_break_on_a_box", "thesis/fig6_3a_noise_only", "thesis/fig6_3b_narrow", "thesis/long_hour")


@pytest.mark.anchor
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name in DEAR else name for name in packaged_scenes()]
)
def test_every_scene_steps(name):
    config = load(name, {"runtime.threads": 1}, "ci")
    many = config.preflight.particles / MANY
    if many > 1.0:
        config = load(name, {"runtime.threads": 1, "resolution": 1.6 * 1.1 * many ** (1 / 3)}, "ci")
    with Simulation(config) as simulation:
        before = state(simulation)
        for _ in range(3):
            simulation.step()
        after = state(simulation)
    assert np.isfinite(after).all() and len(after) == len(before) and not np.array_equal(after, before)
    assert simulation.time > 0.0


def state(simulation: Simulation) -> np.ndarray:
    """Where the particles are [m]; of water without any, its height along x [m]."""
    if simulation.fluid.particles is not None:
        return simulation.fluid.particles.position.to_numpy()
    return simulation.fluid.elevations(np.linspace([-20.0, 0.0], [20.0, 0.0], 9))


@pytest.mark.parametrize("size, counts", [("6k", 6000), ("50k", 37**3), ("250k", 63**3), ("1m", 10**6)])
def test_the_dam_breaks_are_of_the_size_that_they_say(size, counts):
    config = load(f"bench/dam_break_{size}")
    place = config.basin.build()
    lattice = config.fluid.lattice(place)
    column = lattice.boxes[0][1] - lattice.boxes[0][0]
    assert lattice.n == counts
    assert lattice.mass == pytest.approx(1000.0 * 0.05**3, rel=1e-9)
    assert place.config.length == pytest.approx(2.5 * column[0])
    sound_speed = config.fluid.sound_speed(place)
    assert sound_speed == pytest.approx(10.0 * np.sqrt(9.81 * column[1]), rel=1e-6)
    assert config.time_step.dt == pytest.approx(0.2 * 0.1 / sound_speed, rel=2e-3)
    assert config.fluid.kinematic_viscosity == pytest.approx(0.02 * 0.1 * sound_speed, rel=1e-3)
