"""Froude's law: ships of other sizes, under other gravities, in other liquids, do the same at their own times."""

import numpy as np
import pytest
import yaml

from ocean_sim.parts import library
from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation
from tests.conftest import quickly

OFF = dict.fromkeys(("accuracy", "timings", "frames", "render", "report", "motion")) | {"runtime.precision": "f64"}
STEPS = 60


def preset(name: str) -> dict:
    return yaml.safe_load((library("configs") / name).read_text())


def yacht(size: float, time: float, density: float) -> dict:
    """The yacht so many times as long, with times so many times as long, in a liquid so many times as dense."""
    hull, ship = preset("hull/yacht.yaml"), preset("ship/yacht.yaml")
    mass = density * size**3
    force = mass * size / time**2
    hull["shape"]["points"] = (size * np.array(hull["shape"]["points"])).tolist()
    hull["centre_of_mass"] = (size * np.array(hull["centre_of_mass"])).tolist()
    hull |= {"mass": mass * hull["mass"], "inertia": (mass * size**2 * np.array(hull["inertia"])).tolist()}
    for part in (ship["propeller"], ship["rudder"]):
        part["position"] = (size * np.array(part["position"])).tolist()
    ship["propeller"] |= {"thrust": force * 14400.0, "diameter": size * 0.8}
    ship["rudder"] |= {"area": size**2 * 0.8, "rate": 0.14 / time}
    ship["damping"]["surge"] *= mass / size
    ship |= {"hull": hull, "points": {}, "velocity": [0.0, 0.0, 2.0 * size / time]}
    return ship | {"controls": [{"time": 0.0, "throttle": 0.8, "rudder": 0.2}]}


def ridden(kind: str, size: float = 1.0, gravity: float = 9.81, density: float = 1.0) -> np.ndarray:
    """(12,) position, velocity, angles and rates of the yacht under way in oblique waves, as of the one of that size
    here on Earth."""
    time = (size * 9.81 / gravity) ** 0.5
    scene = {
        "duration": 60.0 * time,
        "basin": {
            "length": 200.0 * size,
            "width": 200.0 * size,
            "depth": 20.0 * size,
            "walls": "none",
            "gravity": [0.0, -gravity, 0.0],
        },
        "fluid": {
            "kind": kind,
            "ramp": 0.0,
            "height": size,
            "period": 7.0 * time,
            "heading_deg": 60.0,
            "rest_density": 1000.0 * density,
        },
        "ship": yacht(size, time, density),
        "time_step": {"kind": "fixed", "dt": 0.05 * time},
    }
    with Simulation(load(scene, OFF)) as simulation:
        for _ in range(STEPS):
            simulation.step()
        body = simulation.ship.body
        return np.concatenate([body.position / size, body.velocity * time / size, body.angles, body.rates * time])


@pytest.fixture(scope="module")
def here() -> np.ndarray:
    return ridden("linear_waves")


@pytest.mark.parametrize(
    "scale", [{"density": 13.6}, {"size": 0.04}, *quickly({"gravity": 1.62}, {"gravity": 24.8}, {"size": 20.0})]
)
def test_froude_scales_a_ship_in_waves(scale, here):
    """To rounding, on the Moon and on Jupiter, a model and a giant, and in mercury. Where the lattice around the hull
    was first laid took a second, whatever the waves' period: on the Moon she did otherwise by 1e-5."""
    assert np.abs(here).min() > 1e-4
    np.testing.assert_allclose(ridden("linear_waves", **scale), here, atol=1e-9)
