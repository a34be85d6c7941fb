"""Solid bodies in the water: what they bear is what the water loses, and still water around them is hydrostatic."""

import subprocess
import sys

import numpy as np
import pytest

from ocean_sim import load
from ocean_sim.conventions import GRAVITY
from ocean_sim.fluid.bodies.boundary import Boundary
from ocean_sim.observers.shared.checks import distance_outside
from ocean_sim.reading.scene import SceneError
from tests.conftest import quickly
from tests.fluid.conftest import by_id, put, undone

BOX = {"min": [-0.2, -0.35], "max": [0.2, -0.15]}  # submerged, m
VOLUME, WEIGHT = 0.4 * 0.2, 1000.0 * GRAVITY  # [m2], [N/m3]
FREE = {"width": None, "walls": "none", "floor": "none", "gravity": [0.0, 0.0, 0.0]}


def step_to(fluid, until: float, number: float = 0.4) -> int:
    """Advance to `until` [s] by steps of the limits; how many."""
    steps = 0
    while fluid.time < until:
        limits = fluid.limits()
        dt = min(number * limits.acoustic, 0.125 * limits.viscous, 0.25 * limits.force)
        fluid.advance(min(dt, until - fluid.time + 1e-12))
        steps += 1
    return steps


@pytest.fixture(scope="module")
def still(water):
    """Water around a box for 0.6 s, and the impulses on the box from 0.2 s on [N s]."""
    basin = {"width": None, "obstacles": [BOX]}
    fluid = water("delta_sph", basin=basin, spacing=0.05, kinematic_viscosity=1e-3, accounts=True)
    step_to(fluid, 0.2)
    before = fluid.boundary.impulses()[0]
    step_to(fluid, 0.6)
    return fluid, (fluid.boundary.impulses()[0] - before) / 0.4


def test_a_submerged_box_bears_the_weight_of_the_water_it_displaces(still):
    _, force = still
    assert force[1] == pytest.approx(WEIGHT * VOLUME, rel=0.02)
    assert abs(force[0]) < 1e-6 * WEIGHT * VOLUME


def test_and_the_water_around_it_rests_with_the_pressure_of_its_depth(still):
    fluid, _ = still
    assert fluid.status.max_speed < 0.02 * np.sqrt(GRAVITY * 0.5)
    points = np.array([[0.0, -0.35, 0.0], [0.0, -0.15, 0.0], [0.2, -0.25, 0.0], [-0.2, -0.25, 0.0]])
    np.testing.assert_allclose(fluid.pressures(points), -WEIGHT * points[:, 1], atol=0.03 * WEIGHT * 0.5)


def test_momentum_of_water_and_box_is_accounted_for(still):
    fluid, _ = still
    momentum = fluid.particles.mass * fluid.particles.velocity.to_numpy().sum(axis=0)
    impulse = fluid.impulse
    np.testing.assert_allclose(sum(impulse.values()), momentum, atol=1e-9)
    np.testing.assert_array_equal(impulse["obstacles"], -fluid.boundary.impulses().sum(axis=0))


def test_samples_of_a_box_face_the_side_that_is_nearest(still):
    fluid, _ = still
    body = fluid.boundary.bodies[0]
    np.testing.assert_array_equal(abs(body.normal).sum(axis=1), 1.0)
    deep = np.array([0.2, 0.1]) - abs(body.position[:, :2])
    for k in range(len(deep)):
        across = int(np.argmax(abs(body.normal[k])))
        assert deep[k, across] == pytest.approx(deep[k].min())
        assert body.normal[k, across] * body.position[k, across] > 0.0


def test_nobody_is_inside(still):
    fluid, _ = still
    x = fluid.particles.position.to_numpy()
    assert len(x) == 20 * 10 - 8 * 4
    assert not distance_outside(x, fluid.grid.basin, fluid.time, 0.05).any()


def test_a_box_without_samples_bears_nothing(still):
    """Negative control: from then on, and the water bounces all the same."""
    with undone(still[0]) as fluid:
        before = fluid.boundary.impulses()
        fluid.boundary.share.fill(0.0)
        step_to(fluid, 0.7)
        np.testing.assert_array_equal(fluid.boundary.impulses(), before)
        x = fluid.particles.position.to_numpy()
        assert not distance_outside(x, fluid.grid.basin, fluid.time, 0.05).any()
        assert fluid.status.max_speed > 0.2 * np.sqrt(GRAVITY * 0.5)  # nothing else bears it


def thrown(again, kind: str, **keys):
    """A block of water that runs into a box, away from all sides."""
    basin = FREE | {"obstacles": [{"min": [0.0, -0.45], "max": [0.2, -0.2]}]}
    fill = [{"min": [-0.35, -0.4], "max": [-0.05, -0.2]}]
    keys = {"spacing": 0.05, "reference_speed": 2.0, "kinematic_viscosity": 0.01, "collision_distance": 0.001} | keys
    fluid = again(kind, basin=basin, fill=fill, accounts=True, **keys)
    x = fluid.particles.position.to_numpy()
    put(fluid, by_id(fluid, x), np.tile([0.5, 0.1, 0.0], (len(x), 1)))
    return fluid


@pytest.mark.parametrize("kind", quickly("mueller", "delta_sph", "dfsph"))
def test_a_box_is_pushed_as_strongly_as_it_pushes(again, kind):
    fluid = thrown(again, kind)
    for _ in range(70):
        fluid.advance(0.0015)
    given, taken = fluid.boundary.impulses()[0], fluid.accounts.totals()["walls"][:3]
    assert given[0] > 0.02 * fluid.particles.mass * fluid.particles.n
    np.testing.assert_allclose(taken, -given, atol=1e-12 * np.abs(given).max())


def test_the_force_acts_where_the_water_pushes(again):
    """On a body in a pressure p = constant: none; its torque is the sum of arms and forces."""
    fluid = thrown(again, "mueller")
    for _ in range(60):
        fluid.advance(0.0015)
    force, torque = fluid.boundary.forces()
    assert force.shape == torque.shape == (1, 3)
    arm = fluid.boundary.bodies[0].position
    np.testing.assert_allclose(torque[0], np.cross(arm, fluid.boundary.force.to_numpy()).sum(axis=0), rtol=1e-12)


def test_a_body_is_placed_turned_and_moves_as_it_is_told(again):
    fluid = thrown(again, "mueller")
    body: Boundary = fluid.boundary
    local, turn = body.bodies[0].position, np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    body.place(0, np.array([0.1, -0.2, 0.0]), turn, (1.0, 0.0, 0.0), (0.0, 0.0, 3.0), (0.0, -2.0, 0.0), (0.0, 0.0, 5.0))
    body.sort()
    name = body.name.to_numpy()
    arm = local @ turn.T
    across = np.stack([-arm[:, 1], arm[:, 0], 0.0 * arm[:, 0]], axis=1)
    np.testing.assert_allclose(body.position.to_numpy(), (np.array([0.1, -0.2, 0.0]) + arm)[name], atol=1e-14)
    np.testing.assert_allclose(body.velocity.to_numpy(), (np.array([1.0, 0.0, 0.0]) + 3.0 * across)[name], atol=1e-14)
    expected = np.array([0.0, -2.0, 0.0]) + 5.0 * across - 9.0 * arm
    np.testing.assert_allclose(body.acceleration.to_numpy(), expected[name], atol=1e-13)


@pytest.mark.parametrize("kind", quickly("mueller", "delta_sph"))
def test_what_a_moving_body_gives_the_water_gets(again, kind):
    fluid = thrown(again, kind)
    x = fluid.particles.position.to_numpy()
    put(fluid, by_id(fluid, x))
    before = fluid.boundary.impulses()[0]
    for step in range(110):
        way = 0.0015 * step
        fluid.boundary.place(0, np.array([0.1 - way, -0.325 + 0.5 * way, 0.0]), velocity=(-1.0, 0.5, 0.0))
        fluid.advance(0.0015)
    gained = fluid.particles.mass * fluid.particles.velocity.to_numpy().sum(axis=0)
    given = fluid.boundary.impulses()[0] - before
    assert gained[0] < -0.05 * fluid.particles.mass * fluid.particles.n
    bounced = fluid.accounts.totals()["walls"][:3] + given
    np.testing.assert_allclose(gained, -given, atol=1e-11 * np.abs(given).max())
    np.testing.assert_allclose(bounced, 0.0, atol=1e-11 * np.abs(given).max())


@pytest.mark.parametrize("kind", quickly("delta_sph", "mueller"))
def test_bodies_are_told_how_the_water_accelerates(again, kind):
    """By what each particle's velocity has changed in the last step, but of those that bounced: without viscosity all
    of it presses."""
    fluid = thrown(again, kind, kinematic_viscosity=0.0)
    for _ in range(110):
        fluid.advance(0.0015)
    before = by_id(fluid, fluid.particles.velocity.to_numpy())
    fluid.advance(0.0015)
    gained = (by_id(fluid, fluid.particles.velocity.to_numpy()) - before) / 0.0015
    told = by_id(fluid, np.stack([component.to_numpy() for component in fluid.last_acceleration], axis=1))
    pushed = np.linalg.norm(gained, axis=1) > 0.1
    same = np.isclose(told, gained, rtol=1e-6, atol=1e-6).all(axis=1)
    assert pushed.sum() > 5 and same[pushed].mean() > 0.8


def falling(water, told: float) -> float:
    """Largest force over weight on a box that falls with the water around it, that both accelerate told or not. Without
    the diffusion of density, which takes water for still: falling, it would be pressed by up to 9 % of the weight.
    Bodies are told the water's acceleration of the step before, hence of the first one that it falls already."""
    basin = FREE | {"gravity": [0.0, -GRAVITY, 0.0], "obstacles": [BOX]}
    fill = [{"min": [-0.5, -0.5], "max": [0.5, 0.0]}]
    fluid = water("delta_sph", basin=basin, spacing=0.05, fill=fill, density_diffusion=0.0)
    fluid.particles.pressure.fill(0.0)
    x = fluid.particles.position.to_numpy()
    put(fluid, by_id(fluid, x))
    fluid.last_acceleration[1].fill(-told)
    worst, dt = 0.0, 1e-3
    for step in range(20):
        if not told:
            fluid.last_acceleration[1].fill(0.0)
        t = dt * (step + 1)  # bodies are placed where they are at the end of the step
        place = np.array([0.0, -0.25 - 0.5 * GRAVITY * t**2, 0.0])
        fluid.boundary.place(0, place, velocity=(0.0, -GRAVITY * t, 0.0), acceleration=(0.0, -told, 0.0))
        fluid.advance(dt)
        worst = max(worst, float(np.abs(fluid.boundary.forces()[0]).max()))
    return worst / (WEIGHT * VOLUME)


@pytest.mark.slow
def test_a_box_that_falls_with_its_water_feels_nothing_if_accelerations_are_told(water):
    assert falling(water, GRAVITY) < 1e-12
    assert falling(water, 0.0) > 0.1


def dragged(water, slip: str, until: float):
    """Water between a slab that fills the bed and a lid that moves at 1 m/s, 0.2 m apart; nu is 0.05 m2/s."""
    slab = {"min": [-0.3, -0.4], "max": [0.3, -0.2], "slip": slip}
    basin = {"length": 0.6, "depth": 0.4, "width": None, "gravity": [0.0, 0.0, 0.0], "walls": "periodic"}
    basin |= {"lid": {"velocity": [1.0, 0.0, 0.0]}, "obstacles": [slab]}
    fluid = water("delta_sph", basin=basin, spacing=0.025, kinematic_viscosity=0.05, reference_speed=1.0)
    step_to(fluid, until)
    return fluid


@pytest.mark.slow
def test_water_that_runs_against_a_body_presses_on_it_as_on_a_wall(water):
    """The mean pressure on the lowest 0.1 m over half a second of a dam break: samples that move against the water show
    2.2 times as much (at 0.02 m, over 0.3 to 1.2 s)."""

    def pressed(behind: float) -> np.ndarray:
        low = -0.5 * (1.2 + behind)
        solid = {"min": [low + 1.2, -0.4], "max": [low + 1.2 + behind, 0.0]}
        basin = {"length": 1.2 + behind, "width": None, "depth": 0.4, "obstacles": [solid] if behind else []}
        fluid = water("delta_sph", basin=basin, spacing=0.025, fill=[{"min": [low, -0.4], "max": [low + 0.4, 0.0]}])
        heights = np.arange(0.02, 0.11, 0.02)
        face = np.stack([np.full(5, low + 1.2), heights - 0.4, np.zeros(5)], axis=1)
        seen = []
        for until in np.arange(0.4, 0.9, 0.02):
            step_to(fluid, until)
            seen.append(fluid.pressures(face))
        return np.mean(seen, axis=0)

    assert pressed(0.4).mean() == pytest.approx(pressed(0.0).mean(), rel=0.4)  # a splash differs by a quarter


@pytest.mark.slow
def test_water_sticks_to_a_body_without_slip(water):
    fluid = dragged(water, "no_slip", 0.6)
    x, v = fluid.particles.position.to_numpy(), fluid.particles.velocity.to_numpy()
    couette = (x[:, 1] + 0.2) / 0.2
    np.testing.assert_allclose(v[:, 0], couette, atol=0.06)
    drag = 1000.0 * 0.05 * 1.0 / 0.2 * 0.6  # mu U / H L
    assert fluid.boundary.forces()[0][0, 0] == pytest.approx(drag, rel=0.08)


@pytest.mark.slow
def test_and_not_to_one_with_slip(water):
    """Once the water slides as a whole. Before, particles that approach in rows which gather speed resist, and pass on
    some of the drag that there would be: 6e-6 at 0.1 s, 4.5e-5 at 1.1 s, 1.5e-5 at 1.6 s, 2e-7 at 2.5 s."""
    fluid = dragged(water, "free_slip", 1.6)
    late = 4.0 / np.pi * np.exp(-(np.pi**2) * 0.05 * fluid.time / (4.0 * 0.2**2))  # the slowest part of the series
    assert fluid.particles.velocity.to_numpy()[:, 0].min() == pytest.approx(1.0 - late, abs=0.02)
    assert abs(fluid.boundary.forces()[0][0, 0]) < 1e-4 * 1000.0 * 0.05 / 0.2 * 0.6


def test_particles_without_interaction_bounce_from_a_box(again):
    basin = {"width": None, "restitution": 0.5, "walls": "none", "obstacles": [BOX]}
    fluid = again("ballistic", basin=basin, spacing=0.1, fill=[{"min": [-0.1, -0.1], "max": [0.1, 0.0]}])
    lowest = 0.0
    for _ in range(60):
        fluid.advance(0.01)
        x = fluid.particles.position.to_numpy()
        lowest = min(lowest, x[:, 1].min())
    assert lowest == pytest.approx(-0.15 + 0.05)  # half a spacing above it
    fast = again("ballistic", basin=basin, spacing=0.1, fill=[{"min": [-0.1, -0.1], "max": [0.1, 0.0]}])
    fast.particles.velocity.from_numpy(np.tile([0.0, -3.0, 0.0], (2, 1)))
    fast.advance(0.02)
    at_top = fast.particles.velocity.to_numpy()[:, 1]
    np.testing.assert_allclose(at_top, 0.5 * (3.0 + 0.02 * GRAVITY), rtol=1e-12)


@pytest.mark.parametrize(
    ("obstacle", "sentence"),
    [
        ({"min": [0.3, -0.5], "max": [0.7, 0.0]}, "reaches out of the basin along x"),
        ({"min": [0.1, -0.7], "max": [0.2, 0.0]}, "reaches out of the basin along y"),
        ({"min": [0.1, -0.2, 0.0], "max": [0.2, 0.0, 0.1]}, "has 2 numbers"),
        ({"min": [0.1, -0.2], "max": [0.1, 0.0]}, "must be greater"),
        ({"min": [-0.5, -0.5], "max": [0.5, 0.5]}, "leave no room for water"),
        ({"min": [-0.4, -0.5], "max": [-0.2, -0.3]}, "overlaps an earlier one"),
    ],
)
def test_obstacles_that_cannot_be_are_said(obstacle, sentence):
    first = {"min": [-0.3, -0.4], "max": [-0.1, -0.2]}
    boxes = [first, obstacle] if "earlier" in sentence else [obstacle]
    with pytest.raises(SceneError, match=sentence):
        load({"basin": {"length": 1.0, "depth": 0.5, "obstacles": boxes}, "fluid": {"kind": "mueller", "spacing": 0.1}})


def test_fill_above_the_lid_of_a_closed_basin_is_refused():
    basin, fill = {"length": 1.0, "depth": 0.5, "lid": {}}, [{"min": [-0.5, -0.5], "max": [0.5, 0.2]}]
    with pytest.raises(SceneError, match="the box reaches out of the basin along y"):
        load({"basin": basin, "fluid": {"kind": "mueller", "spacing": 0.1, "fill": fill}})


def test_without_obstacles_nothing_of_this_is_imported():
    code = (
        "import sys, ocean_sim; s = ocean_sim.load({'basin': {'length': 1.0, 'depth': 0.5}, 'duration': 1.0,"
        " 'fluid': {'kind': 'mueller', 'spacing': 0.1}, 'render': None}); ocean_sim.Simulation(s);"
        " print('ocean_sim.fluid.bodies.boundary' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.split()[-1] == "False"
