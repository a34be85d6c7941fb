"""A scene that is dumped and read again is the same scene, and runs to the same bytes."""

import json

import numpy as np
import pytest

from ocean_sim.parts import SLOTS, ShipConfig, config_of, kinds
from ocean_sim.reading.scene import SceneConfig, load, packaged_scenes
from ocean_sim.simulation import Simulation

BASIN = {"length": 40.0, "width": 40.0, "depth": 7.5}
SEA = {"basin": BASIN, "fluid": {"kind": "linear_waves", "height": 0.5, "period": 4.0}}
PARTICLES = {"basin": BASIN, "fluid": {"kind": "mueller", "spacing": 2.5}}
PATCH = PARTICLES | {"basin": BASIN | {"walls": "periodic"}}
KINDS = [(slot, kind) for slot in SLOTS for kind in kinds(slot)]
QUIET = {"runtime.threads": 1, "resolution": 1.3}


def again(config: SceneConfig) -> SceneConfig:
    """What its dump, as text, is read as."""
    return load(json.loads(json.dumps(config.resolved())))


@pytest.mark.parametrize("name", packaged_scenes())
@pytest.mark.parametrize("profile", [None, "ci", "reference"])
def test_every_scene_is_read_again_as_it_was(name, profile):
    config = load(name, {"resolution": 1.3}, profile)
    assert again(config).parts() == config.parts() and again(config).resolved() == config.resolved()


def run(config: SceneConfig) -> list[bytes]:
    """The state of every part after two steps."""
    with Simulation(config) as simulation:
        simulation.step()
        simulation.step()
        particles, surface = simulation.fluid.particles, simulation.surface
        found = [] if particles is None else [particles.position.to_numpy(), particles.velocity.to_numpy()]
        if particles is None or surface is not None:
            found.append((surface or simulation.fluid).elevations(np.linspace([-15.0, 0.0], [15.0, 3.0], 7)))
        for ship in simulation.ships.values():
            found += [ship.body.position, ship.body.orientation, ship.body.velocity, ship.last.parts]
        return [np.asarray(array).tobytes() for array in found]


def of_kind(slot: str, kind: str) -> SceneConfig:
    """A small scene with this kind in it."""
    model = config_of(slot, kind)
    base = {"platform": SEA, "sea": PATCH}.get(slot, PARTICLES)
    if issubclass(model, ShipConfig):
        base = PARTICLES | {"fluid": {"kind": "delta_sph", "spacing": 2.5}} if model.carried_as_body else SEA
    example = dict(model.example)
    if "hull" in example:
        example["hull"] = "yacht"
    return load(base | {slot: {"kind": kind} | example}, QUIET)


@pytest.mark.parametrize("slot, kind", KINDS)
def test_every_kind_is_read_again_as_it_was(slot, kind):
    config = of_kind(slot, kind)
    assert again(config).parts() == config.parts() and again(config).resolved() == config.resolved()


def is_brief(slot: str, kind: str) -> bool:
    """Whether nothing of it is compiled for particles."""
    model = config_of(slot, kind)
    return slot == "platform" or (issubclass(model, ShipConfig) and not model.carried_as_body)


@pytest.mark.parametrize(
    "slot, kind", [pytest.param(*pair, marks=() if is_brief(*pair) else pytest.mark.slow) for pair in KINDS]
)
def test_every_kind_runs_to_the_same_bytes_from_its_dump(slot, kind):
    config = of_kind(slot, kind)
    assert run(again(config)) == run(config)


def test_the_dump_shows_what_was_left_open():
    resolved = load(PARTICLES | {"surface": "cloth"}).resolved()
    assert resolved["surface"]["spacing"] is None and resolved["surface"]["thickness"] is None
