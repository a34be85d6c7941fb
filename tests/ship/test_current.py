"""A ship, waves and a current: only her velocity through the water counts."""

from pathlib import Path

import numpy as np
import pytest

from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation
from tests.conftest import quickly

THROUGH = 2.0  # velocity through the water [m/s]
SCATTERED = str(Path(__file__).parent / "data" / "barge20_capytaine.nc")
OFF = dict.fromkeys(("accuracy", "timings", "frames", "render", "report", "motion"))


def ride(heading: float, current: tuple[float, float], height: float = 1.0, order: int = 1, until: float = 6.0, **ship):
    """(7,) height and velocity [m, m/s] less that of the current, and the rates of turn [rad/s], after a time [s]."""
    scene = afloat(heading, current, height, order, ship or {"kind": "barge20", "velocity": [0.0, 0.0, THROUGH]})
    with Simulation(load(scene, OFF)) as simulation:
        simulation.run(until=until)
        body = simulation.ship.body
        x, _, z = body.velocity
        return np.array([body.position[1], x - current[0], body.velocity[1], z - current[1], *body.rates])


def afloat(heading: float, current: tuple[float, float], height: float, order: int, ship: dict) -> dict:
    return {
        "duration": 6.0,
        "basin": {"length": 200.0, "width": 200.0, "depth": 20.0, "walls": "none"},
        "fluid": {
            "kind": "spectral_sea",
            "order": order,
            "ramp": 0.0,
            "current": list(current),
            "height": height,
            "period": 7.0,
            "heading_deg": heading,
        },
        "ship": ship,
        "time_step": {"kind": "fixed", "dt": 0.05},
    }


@pytest.mark.parametrize("heading", quickly(60.0, 180.0))
def test_what_counts_is_the_velocity_through_the_water(heading):
    """In water that flows as in still water: the lattice that she reads is carried by the current, and her added mass
    is accelerated by what she does relative to the water, in axes that turn with her."""
    still = ride(heading, (0.0, 0.0))
    assert np.abs(still).max() > 0.1
    np.testing.assert_allclose(ride(heading, (0.0, -THROUGH)), still, atol=1e-3)
    np.testing.assert_allclose(ride(heading, (1.0, 0.7)), still, atol=1e-3)


def test_a_table_of_scattered_waves_knows_the_current():
    """A hull with one takes its own motion for that through the water; it took that over the ground, and turned."""
    ship = {"kind": "dynamic", "hull": "barge20", "radiation": SCATTERED, "velocity": [0.0, 0.0, THROUGH]}
    still = ride(60.0, (0.0, 0.0), until=3.0, **ship)
    np.testing.assert_allclose(ride(60.0, (1.0, 0.7), until=3.0, **ship), still, atol=1e-5)


def test_waves_on_a_tile_are_read_where_the_current_had_carried_them():
    """Galileo: a body takes its step after the water, and reads the water as it was before; a nonlinear sea was read
    where the current carries it a step later, and heave was wrong by 1 % of its amplitude."""
    still = ride(180.0, (0.0, 0.0), order=3, until=1.0)
    np.testing.assert_allclose(ride(180.0, (1.5, -2.0), order=3, until=1.0), still, atol=1e-6)


def test_what_ships_make_of_the_waves_goes_with_the_current():
    """Galileo: two ships that feel each other's waves do in water that flows what they do in water that rests. How deep
    their cubes lay was read a step's current away from where they were, and the yacht rolled by 0.4 % otherwise."""

    def pair(current):
        yacht, barge = {"kind": "yacht"}, {"kind": "barge20", "position": [9.0, 0.0, 3.0]}
        scene = afloat(60.0, current, 1.0, 1, yacht)
        scene["ships"] = {"yacht": scene.pop("ship"), "barge": barge}
        scene["fluid"]["cells"] = 32
        with Simulation(load(scene, OFF | {"runtime.precision": "f64"})) as simulation:
            simulation.run(until=1.0)
            return np.concatenate([ship.body.rates for ship in simulation.ships.values()])

    np.testing.assert_allclose(pair((1.5, -2.0)), pair((0.0, 0.0)), atol=1e-12)


def test_waves_that_meet_a_hull_are_told_where_the_current_had_carried_them():
    def met(current):
        with Simulation(load(afloat(60.0, current, 1.0, 1, {"kind": "barge20"}), OFF)) as simulation:
            simulation.run(until=1.0)
            water = simulation.fluid
            x, z = np.array([3.0, -2.0]) + water.before * np.array(current)
            return water.arriving(x, z)

    still, flowing = met((0.0, 0.0)), met((1.5, -2.0))
    np.testing.assert_allclose(flowing.angle, still.angle, atol=1e-9)


def test_a_ship_in_calm_water_goes_with_the_current_and_does_not_turn():
    """A hull whose bow and stern differ, too: water that flows alike everywhere does not turn."""
    adrift = ride(0.0, (0.7, -0.4), height=0.0, kind="yacht")
    np.testing.assert_allclose(adrift[1:], 0.0, atol=1e-6)


def test_a_manoeuvring_ship_is_carried_by_the_current():
    """Galileo: at rest in water that flows she does what she does in still water, and goes with it."""
    still = ride(0.0, (0.0, 0.0), height=0.0, kind="otter")
    carried = ride(0.0, (0.7, -0.4), height=0.0, kind="otter", velocity=[0.7, 0.0, -0.4])
    np.testing.assert_allclose(carried, still, atol=1e-9)
    caught = ride(0.0, (0.7, -0.4), height=0.0, kind="otter")  # she begins at rest in the world
    assert abs(caught[1]) < 0.01


def test_a_velocity_that_is_held_is_told():
    scene = at_sea_of("barge20", velocity=[0.0, 0.0, 4.0], rates=[0.0, 0.2, 0.0], free=["heave", "pitch", "roll"])
    told = [sentence for sentence in load(scene).warnings() if "held" in sentence]
    assert told == [
        "velocity: surge held, so the ship does not begin with it; add surge to `free`, or leave it out",
        "rates: yaw held, so the ship does not begin with it; add yaw to `free`, or leave it out",
    ]
    across = at_sea_of("barge20", velocity=[0.0, 0.0, 4.0], heading_deg=90.0, free=["surge"])
    assert [s for s in load(across).warnings() if s.startswith("velocity: sway held")]
    along = at_sea_of("barge20", velocity=[4.0, 0.0, 0.0], heading_deg=90.0, free=["surge"])
    assert not [s for s in load(along).warnings() if "held" in s]


def at_sea_of(kind: str, **keys) -> dict:
    return {
        "basin": {"length": 300.0, "width": 300.0, "depth": 50.0, "walls": "none"},
        "fluid": {"kind": "linear_waves", "height": 0.5, "period": 7.0},
        "ship": {"kind": kind} | keys,
    }
