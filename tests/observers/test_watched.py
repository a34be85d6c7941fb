"""Whoever watches changes nothing: the bytes of water and ship are the same with an observer as without."""

import pytest

from ocean_sim import load
from ocean_sim.parts import kinds
from ocean_sim.reading.scene import observer_names
from ocean_sim.simulation import Simulation
from tests.conftest import quickly

OFF = {name: None for name in observer_names() if name != "manifest"}
TANK = {"length": 0.8, "depth": 0.3}
WIDE = TANK | {"length": 0.6, "width": 0.3}
GATE = {"obstacles": [{"min": [0.15, -0.3], "max": [0.25, 0.1], "velocity": [0.0, 1.0, 0.0], "until": 0.3}]}
ROUGH = {"floor": {"friction_factor": 0.02}, "walls": "no_slip"}
SCHEMES = [kind for kind in kinds("fluid") if kind in ("mueller", "delta_sph", "dfsph", "ballistic")]
KEYS = {
    "accuracy": {"every": 0.01},
    "checkpoint": {"every": 0.02},
    "frames": {"every": 0.02},
    "gauges": {"elevation": {"a": [0.1]}, "pressure": {"b": [-0.3, -0.2]}, "every": 0.01},
    "health": {},
    "motion": {"every": 0.01},
    "report": {},
    "timings": {},
    "tracers": {"boxes": [{"min": [-0.3, -0.3], "max": [-0.1, -0.1]}], "every": 0.01},
}


def scene(kind: str, basin: dict, **keys) -> dict:
    """A column of water that breaks."""
    wide = "width" in basin
    low, up = ([-0.3, -0.3, -0.15], [0.0, 0.0, 0.15]) if wide else ([-0.4, -0.3], [0.1, 0.0])
    viscous = {} if kind == "ballistic" else {"kinematic_viscosity": 1e-3}
    fluid = {"kind": kind, "spacing": 0.075 if wide else 0.04, "fill": [{"min": low, "max": up}]} | viscous
    return {"duration": 0.05, "basin": basin, "fluid": fluid, "time_step": {"kind": "fixed", "dt": 1e-3}} | keys


def bytes_after(data: dict, folder, **on: dict) -> list[bytes]:
    """Particles and ships at the end of a run with these observers alone."""
    folder.mkdir()
    with Simulation(load(data | OFF | on), folder) as simulation:
        simulation.run(data["duration"])
        particles, ships = simulation.fluid.particles, simulation.ships.values()
        fields = (*particles.position, *particles.velocity, particles.density, particles.pressure)
        bodies = [part.tobytes() for ship in ships for part in (ship.body.position, ship.body.velocity)]
        return [field.to_numpy().tobytes() for field in fields] + bodies


@pytest.mark.parametrize("kind", quickly("mueller", *[kind for kind in SCHEMES if kind != "mueller"]))
def test_accounts_of_impulses_change_no_byte(kind, tmp_path):
    data = scene(kind, TANK)
    assert bytes_after(data, tmp_path / "on", accuracy=KEYS["accuracy"]) == bytes_after(data, tmp_path / "off")


@pytest.mark.slow
@pytest.mark.parametrize("basin", [TANK | GATE, TANK | ROUGH, WIDE], ids=["gate", "rough", "wide"])
@pytest.mark.parametrize("kind", [kind for kind in SCHEMES if kind != "ballistic"])
def test_accounts_change_no_byte_of_water_among_bodies_beds_and_in_3d(kind, basin, tmp_path):
    data = scene(kind, basin)
    assert bytes_after(data, tmp_path / "on", accuracy=KEYS["accuracy"]) == bytes_after(data, tmp_path / "off")


@pytest.mark.slow
@pytest.mark.parametrize("kind", SCHEMES)
def test_no_observer_changes_a_byte(kind, tmp_path):
    """Each by itself, with a ship afloat."""
    shape = {"kind": "box", "length": 0.2, "breadth": 0.2, "height": 0.2}
    ship = {"kind": "hydrostatic", "hull": {"shape": shape, "mass": 4.0}, "position": [-0.1, 0.0]}
    data = scene(kind, TANK | {"width": 0.4}, ship=ship, surface="cloth")
    data["fluid"] |= {"spacing": 0.1, "fill": None}
    three = {
        "tracers": KEYS["tracers"] | {"boxes": [{"min": [-0.3, -0.3, -0.1], "max": [-0.1, -0.1, 0.1]}]},
        "gauges": {"elevation": {"a": [0.1, 0.0]}, "pressure": {"b": [-0.3, -0.2, 0.0]}, "every": 0.01},
    }
    without = bytes_after(data, tmp_path / "off")
    for name, keys in (KEYS | three).items():
        needed = {"frames": KEYS["frames"]} if name == "report" else {}
        assert bytes_after(data, tmp_path / name, **(needed | {name: keys})) == without, name
