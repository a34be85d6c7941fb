"""Two-way contact: momentum, no particle inside, draught, walls and bed, extremes."""

from dataclasses import replace

import numpy as np
import pytest

from ocean_sim import runtime
from ocean_sim.basin.solids.voxels import distance_lattice
from ocean_sim.conventions import Diverged
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.reading.scene import load, observer_names
from ocean_sim.ship.body.rigid_body import RigidBody, advance_body, euler_quaternion, with_spin
from ocean_sim.ship.hull.shapes import Box, Sphere
from ocean_sim.ship.water import wave_contact
from ocean_sim.ship.water.wall_contact import Sides
from ocean_sim.simulation import Simulation
from tests.conftest import Start
from tests.water_energy import total_energy

QUIET = {name: None for name in observer_names() if name != "manifest"} | {"runtime.threads": 1}
SHAPE = {"kind": "box", "length": 0.6, "breadth": 0.6, "height": 0.5}


def floating(relative: float = 0.6, **ship) -> dict:
    """A box in a small tank of coarse water."""
    hull = {"shape": SHAPE, "mass": 180.0 * relative, "centre_of_mass": [0.0, 0.15, 0.0]}
    return {
        "duration": 2.0,
        "basin": {"length": 1.6, "width": 1.6, "depth": 0.6},
        "fluid": {"kind": "mueller", "spacing": 0.1, "kinematic_viscosity": 0.01, "compression": 0.008},
        "surface": "cloth",
        "ship": {"kind": "hydrostatic", "hull": hull, **ship},
    }


def shot(fluid: dict, response: float = 1.0, mass: float = 100.0) -> dict:
    """A block of water without gravity (a ship wants a little), and a spinning box that is shot into it."""
    hull = {
        "shape": {"kind": "box", "length": 0.4, "breadth": 0.4, "height": 0.3},
        "mass": mass,
        "centre_of_mass": [0.0, 0.15, 0.0],
        "inertia": [2.0, 2.0, 2.0],
    }
    ship = {
        "kind": "thesis",
        "hull": hull,
        "linear_damping": 0.0,
        "angular_damping": 0.0,
        "contact": {"restitution": 0.3, "friction": 0.4, "response": response},
        "position": [0.05, -0.25, 0.03],
        "velocity": [0.3, -2.0, 0.1],
        "rates": [0.5, 0.0, 1.0],
    }
    water = {"spacing": 0.1, "fill": [{"min": [-0.4, -0.9, -0.4], "max": [0.4, -0.5, 0.4]}]}
    basin = {"length": 2.0, "width": 2.0, "depth": 1.2, "gravity": [0.0, -1e-15, 0.0], "walls": "none", "floor": "none"}
    return {
        "duration": 0.2,
        "basin": basin,
        "fluid": water | fluid,
        "surface": "cloth",
        "ship": ship,
        "time_step": {"kind": "fixed", "dt": 0.001},
    }


PRESSING = {"kind": "delta_sph", "compression": 0.01, "reference_speed": 3.0}


def momenta(simulation: Simulation) -> np.ndarray:
    """(2, 3) of water and ship [kg m/s]."""
    water, body = simulation.fluid.particles, simulation.ships["ship"].body
    return np.stack(
        [water.mass * water.velocity.to_numpy().astype(float).sum(axis=0), body.mass * np.array(body.velocity)]
    )


def inside(simulation: Simulation, shape: dict, centre: np.ndarray, tolerance: float) -> int:
    """Particles inside a box by more than a tolerance [m]."""
    body = simulation.ships["ship"].body
    half = 0.5 * np.array([shape["breadth"], shape["height"], shape["length"]]) - tolerance
    own = (simulation.fluid.positions() - body.position) @ body.matrix + centre - [0.0, 0.5 * shape["height"], 0.0]
    return int((abs(own) < half).all(axis=1).sum())


def test_the_distance_to_a_ball_and_to_a_box():
    random = np.random.default_rng(3)
    from scipy.interpolate import RegularGridInterpolator

    for shape, exact in (
        (Sphere(kind="sphere", radius=0.4), lambda p: np.linalg.norm(p - [0.0, 0.4, 0.0], axis=1) - 0.4),
        (Box(kind="box", length=0.8, breadth=0.6, height=0.5), from_a_box),
    ):
        values, first, step = distance_lattice(shape, 0.04, 0.2, 0.2)
        axes = [first[k] + step[k] * np.arange(values["distance"].shape[k]) for k in range(3)]
        lower, upper = shape.bounds()
        points = random.uniform(lower - 0.15, upper + 0.15, (4000, 3))
        near = abs(exact(points)) < 0.15
        found = RegularGridInterpolator(axes, values["distance"])(points)
        assert abs(found - exact(points))[near].max() < 0.75 * 0.04
        assert abs((found - exact(points))[near].mean()) < 0.1 * 0.04
        share = RegularGridInterpolator(axes, values["share"])(points)
        on_it = abs(exact(points)) < 0.005
        assert share[on_it].mean() == pytest.approx(0.45, abs=0.07)  # a half on a flat face, less at edges
        assert share.sum() * 0.0 == 0.0 and share.max() < 1.0 + 1e-9


def from_a_box(p: np.ndarray, length: float = 0.4) -> np.ndarray:
    away = abs(p - [0.0, 0.25, 0.0]) - [0.3, 0.25, length]
    return np.linalg.norm(np.maximum(away, 0.0), axis=1) + np.minimum(away.max(axis=1), 0.0)


@pytest.fixture(scope="module")
def pressing():
    """A box in f64 that is about to hit water that presses, between periodic sides, and its start."""
    scene = shot(PRESSING)
    scene["basin"]["walls"] = "periodic"
    with Simulation(load(scene, QUIET | {"runtime.precision": "f64"})) as simulation:
        yield simulation, Start(simulation)


def test_momentum_is_kept_and_at_a_response_of_one_half_the_ledger_shows_exactly_half_missing(pressing):
    """Water that presses, in f64; the exchange at one half is the negative control of the first."""
    simulation, start = pressing
    start.put_back()
    contact, before = simulation.ships["ship"].contact, momenta(simulation)
    simulation.run(0.1)
    middle = momenta(simulation)
    whole = middle - before
    assert abs(whole[1]).max() > 10.0  # they did meet
    assert abs(whole.sum(axis=0)).max() < 1e-12 * 200.0
    np.testing.assert_allclose(contact.impulse[0], whole[1], atol=1e-10)
    assert not contact.lost.any()
    given = contact.config
    contact.config = given.model_copy(update={"response": 0.5})
    simulation.run(0.2)
    contact.config = given
    half = momenta(simulation) - middle
    np.testing.assert_allclose(half[1], -0.5 * half[0], atol=1e-10)
    np.testing.assert_allclose(half.sum(axis=0), -contact.lost[0], atol=1e-10)
    np.testing.assert_allclose(contact.impulse[0] - whole[1], contact.lost[0], atol=1e-10)
    assert abs(contact.lost[0]).max() > 1.0
    shape = {"length": 0.4, "breadth": 0.4, "height": 0.3}
    assert inside(simulation, shape, np.array([0.0, 0.15, 0.0]), 0.02) == 0


def test_a_hull_across_periodic_sides_meets_what_one_in_the_middle_meets(pressing):
    simulation, start = pressing
    impulses = []
    for shift in (0.0, 1.0):
        start.put_back()
        position, ship = simulation.fluid.particles.position, simulation.ships["ship"]
        x = position.to_numpy()
        x[:, [0, 2]] = (x[:, [0, 2]] + shift + 1.0) % 2.0 - 1.0
        position.from_numpy(x)
        simulation.fluid.begin()
        ship.body = replace(ship.body, position=ship.body.position + shift * np.array([1.0, 0.0, 1.0]))
        simulation.run(0.1)
        impulses.append(ship.contact.impulse.copy())
    assert abs(impulses[0][0]).max() > 10.0
    np.testing.assert_allclose(*impulses, rtol=1e-6, atol=1e-6)


def test_a_hull_above_the_cells_meets_what_one_among_them_meets(pressing):
    """At heights that lie in other cells than those under which they are filed."""
    simulation, start = pressing
    impulses = []
    for rise in (0.0, 2.5, 3.25):
        start.put_back()
        position, ship = simulation.fluid.particles.position, simulation.ships["ship"]
        position.from_numpy(position.to_numpy() + [0.0, rise, 0.0])
        simulation.fluid.begin()
        ship.body = replace(ship.body, position=ship.body.position + rise * np.array([0.0, 1.0, 0.0]))
        simulation.run(0.1)
        impulses.append(ship.contact.impulse.copy())
    assert abs(impulses[0][0]).max() > 10.0
    for impulse in impulses[1:]:
        np.testing.assert_allclose(impulse, impulses[0], rtol=1e-6, atol=1e-6)


def test_a_light_ship_is_not_thrown_back_and_the_threads_change_nothing(monkeypatch):
    """A tenth as heavy as the water that it hits: impulses one by one would return its speed several times. In f32,
    layer after layer, and side by side on one thread and on two."""
    scene, states = shot({"kind": "ballistic"}, mass=10.0), []
    for threads, serial in ((1, 20_000), (1, 0), (2, 0)):
        monkeypatch.setattr(wave_contact, "SERIAL_PARTICLES", serial)
        with Simulation(load(scene, QUIET | {"runtime.threads": threads})) as simulation:
            before = momenta(simulation)
            simulation.run(0.2)
            gained, body = momenta(simulation) - before, simulation.ships["ship"].body
            assert abs(gained.sum(axis=0)).max() < 1e-5 * 20.0
            assert 5.0 < gained[1][1] < 1.3 * 20.0
            states.append(np.concatenate([body.position, body.velocity, simulation.fluid.positions().ravel()]))
    np.testing.assert_array_equal(*states[1:])
    np.testing.assert_allclose(*states[:2], rtol=1e-8, atol=1e-10)  # the same sums, compiled in two ways


def test_the_first_collision_of_a_run_compiles_nothing():
    with Simulation(load(shot({"kind": "ballistic"}), QUIET)) as simulation:
        simulation.step()
        contact, before = simulation.ships["ship"].contact, compiled()
        assert not contact.given.any()
        simulation.run(0.2)
        assert contact.given.any() and compiled() == before


def compiled() -> int:
    return sum(len(kernel.compiled_kernels) for kernel in runtime.impl.get_runtime().kernels)


CENTRE = np.array([0.0, 0.15, 0.0])


@pytest.fixture(scope="module")
def afloat():
    """A simulation that tests begin anew, and what it takes to do so."""
    with Simulation(load(floating(), QUIET | {"health": {}, "accuracy": {}})) as simulation:
        particles, ship = simulation.fluid.particles, simulation.ships["ship"]
        start = [field.to_numpy().copy() for field in (particles.position, particles.velocity, particles.pressure)]
        yield simulation, start, ship.body, ship.weight.copy()


def begun(afloat, weight: float = 1.0, **changes) -> Simulation:
    """The simulation at its start, with the ship changed."""
    simulation, start, body, own = afloat
    particles, ship = simulation.fluid.particles, simulation.ships["ship"]
    for field, values in zip((particles.position, particles.velocity, particles.pressure), start):
        field.from_numpy(values)
    simulation.fluid.begin()
    simulation.surface.lay_down(particles)
    ship.body = replace(body, mass=weight * body.mass, inertia_body=weight * body.inertia_body, **changes)
    ship.weight = weight * own
    return simulation


def test_as_much_water_makes_room_as_the_hull_displaces(afloat):
    """To half a particle, none nearer than half a spacing; and `check` counts what is left, and the distances."""
    simulation, start, body, _ = afloat
    scene, water, hull = simulation.scene, simulation.fluid.particles, simulation.ships["ship"].contact.hull.distance
    gone = 16 * 16 * 6 - water.n
    assert gone * 0.1**3 == pytest.approx(body.mass / 1000.0, abs=0.5 * 0.1**3)
    assert from_a_box(start[0][: water.n, [0, 1, 2]] - body.position + CENTRE, 0.3).min() > 0.04
    assert scene.preflight.lattice.n == water.n < scene.preflight.untouched.n
    row = next(row for row in scene.ledger() if "distances" in row.what)
    assert row.bytes == 2 * 4 * np.prod(hull.nodes.shape)


def test_it_floats_as_deep_as_without_contact_and_nothing_is_inside(afloat):
    """To 2 % under the water around it; collisions carry nothing in the mean."""
    simulation = begun(afloat)
    ship, given, rows = simulation.ships["ship"], simulation.fluid.impulse["ship"], []
    x = np.linspace(-0.75, 0.75, 16)
    around_it = np.stack(np.meshgrid(x, x), axis=-1).reshape(-1, 2)
    around_it = around_it[(abs(around_it) > 0.5).any(axis=1)]
    end = simulation.time + 2.0
    while simulation.time < end:
        simulation.step()
        if simulation.steps % 20 == 0:
            assert inside(simulation, SHAPE, CENTRE, 0.005) == 0
            level = simulation.surface.elevations(around_it).mean()
            rows.append((level - ship.body.position[1] + CENTRE[1], ship.last.parts[1, 0, 1], ship.last.parts[4, 0, 1]))
    draught, buoyancy, collisions = np.array(rows)[len(rows) // 3 :].T
    weight = 9.81 * ship.body.mass
    assert draught.mean() == pytest.approx(0.3, rel=0.02)
    assert buoyancy.mean() == pytest.approx(weight, rel=0.02)
    assert abs(collisions.mean()) < 0.02 * weight
    under = ship.water
    middle = under.level.to_numpy()[12, 6]
    assert simulation.surface.elevations(np.zeros((1, 2)))[0] < -0.15  # the sheet lies under the hull,
    assert abs(middle - level) < 0.05  # the ship fills it
    # The water bears the ship, as well as three particles under it tell.
    assert (simulation.fluid.impulse["ship"] - given)[1] == pytest.approx(-2.0 * weight, rel=0.25)


def test_without_giving_the_push_back_buoyancy_would_count_twice(afloat):
    """A negative control: collisions then hold the water up, and lift the ship out of it by as much."""
    simulation = begun(afloat)
    ship, shares = simulation.ships["ship"], simulation.ships["ship"].contact.hull.distance.nodes.to_numpy()
    ship.contact.hull.distance.nodes.from_numpy(shares * np.array([1.0, 0.0], dtype=shares.dtype))
    carried, end = [], simulation.time + 0.8
    while simulation.time < end:
        simulation.step()
        carried.append(ship.last.parts[4, 0, 1])
    ship.contact.hull.distance.nodes.from_numpy(shares)
    assert np.mean(carried[len(carried) // 2 :]) > 0.15 * 9.81 * ship.body.mass


@pytest.mark.slow
def test_the_energy_of_water_next_to_a_hull_at_rest_is_accounted_for():
    """To a twentieth of what its forces exchange at half the usual step (4.6 %; at the usual 5.2 %), and the water
    stands as high as before; were the work of the hull left out, a fifth would be missing."""
    fluid = {"kind": "delta_sph", "spacing": 0.1, "compression": 0.008}
    scene = floating() | {"fluid": fluid, "time_step": {"kind": "courant", "courant_number": 0.5}}
    with Simulation(load(scene, QUIET | {"accuracy": {}})) as simulation:
        start, height = residual(simulation), simulation.fluid.positions()[:, 1].mean()
        simulation.run(1.5)
        work = simulation.fluid.work
        exchanged = sum(abs(energy) for energy in work.values())
        assert exchanged > 10.0
        assert abs(residual(simulation) - start) < 0.05 * exchanged
        assert abs(residual(simulation) + work["ship"] - start) > 0.2 * exchanged
        assert abs(simulation.fluid.positions()[:, 1].mean() - height) < 0.02 * 0.1


def residual(simulation: Simulation) -> float:
    """Energy of water that stores it when compressed, less what all other forces have given [J]."""
    work = simulation.fluid.work
    given = sum(energy for term, energy in work.items() if term not in ("gravity", "pressure"))
    return total_energy(simulation) - given


EXTREMES = {
    "a tenth of the water's density": (1.0 / 6.0, {}),
    "ten times the water's density, it lies on the bed": (100.0 / 6.0, {}),
    "capsized": (1.0, {"orientation": euler_quaternion(0.0, 0.0, np.pi), "position": np.array([0.0, 0.05, 0.0])}),
    "wholly under water": (1.0, {"position": np.array([0.0, -0.3, 0.0])}),
    "dropped from 5 m": (1.0, {"position": np.array([0.0, 5.0, 0.0])}),
    "wholly out": (1.0, {"position": np.array([0.0, 1.0, 0.0])}),
    "a spin of 30 degrees a second": (1.0, {"spin": np.radians([30.0, 30.0, 30.0])}),
    "steps four times as long": (1.0, {"steps": 4.0}),
    "a thrust of a hundred times": (1.0, {"thrust": 100.0}),
}


@pytest.mark.parametrize("extreme", EXTREMES)
def test_extremes_end_physically_or_with_a_sentence(afloat, extreme):
    weight, changes = EXTREMES[extreme]
    own = {key: value for key, value in changes.items() if key not in ("spin", "steps", "thrust")}
    simulation = begun(afloat, weight, **own)
    ship = simulation.ships["ship"]
    if "spin" in changes:
        ship.body = with_spin(ship.body, changes["spin"])
    if "thrust" in changes:  # of a tenth of its weight
        ship.weight[0, 0] = 0.1 * changes["thrust"] * 9.81 * ship.body.mass
    longer, next_step = changes.get("steps", 1.0), simulation.time_step.next
    simulation.time_step.next = lambda limits: longer * next_step(limits)
    try:
        simulation.run(simulation.time + (1.3 if "5 m" in extreme else 0.5))
    except Diverged as stopped:
        assert "t = " in str(stopped) and "try" in str(stopped)
        return
    finally:
        simulation.time_step.next = next_step
    body = ship.body
    assert np.isfinite(body.position).all() and np.linalg.norm(body.velocity) < 15.0
    assert (abs(body.position[[0, 2]]) < 0.8).all() and body.position[1] > -0.6
    assert inside(simulation, SHAPE, CENTRE, 0.02) == 0
    if weight > 10.0:
        assert body.position[1] < -0.35


@pytest.mark.slow
def test_a_hull_thinner_than_a_spacing_floats():
    plate = {"shape": {"kind": "box", "length": 0.6, "breadth": 0.6, "height": 0.06}, "mass": 10.8}
    with Simulation(load(floating(hull=plate), QUIET | {"health": {}})) as simulation:
        simulation.run(0.5)
        body = simulation.ships["ship"].body
        assert np.linalg.norm(body.velocity) < 1.0 and abs(body.position[1]) < 0.15


def test_a_hull_that_is_lost_between_particles_is_refused():
    """Its lattice of distances would have 1e10 nodes; a tenth of a spacing is enough."""
    cube = {"shape": dict.fromkeys(("length", "breadth", "height"), 1e-4) | {"kind": "box"}, "mass": 5e-10}
    with pytest.raises(SceneError, match=r"ship.hull: a hull of 0.0001 x .* m is too small for particles .* m apart"):
        load(floating(hull=cube), QUIET)
    small = {"shape": dict.fromkeys(("length", "breadth", "height"), 0.01) | {"kind": "box"}, "mass": 5e-4}
    load(floating(hull=small), QUIET)


def test_contact_can_be_switched_off_and_a_hull_across_a_wall_is_refused():
    scene = floating()
    on = load(scene, QUIET)
    off = load(scene, QUIET | {"ship.contact": None})
    assert len(on.preflight.solids) == 1 and off.preflight.solids == {}
    with pytest.raises(SceneError, match=r"reaches 0\.1 m through a wall across x"):
        load(scene, QUIET | {"ship.position": [0.6, 0.0]})
    load(scene, QUIET | {"ship.position": [0.6, 0.0], "ship.contact": None})


def struck(restitution: float, friction: float, **changes) -> tuple[Sides, RigidBody]:
    """Walls and bed, and a box of 1 kg on the bed."""
    basin = load(
        {
            "basin": {"length": 2.0, "width": 2.0, "depth": 1.0, "restitution": restitution, "friction": friction},
            "fluid": {"kind": "ballistic", "spacing": 0.5},
        },
        QUIET,
    ).basin.build()
    sides = Sides(Box(kind="box", length=0.4, breadth=0.4, height=0.4), np.array([0.0, 0.2, 0.0]), basin)
    still = {"velocity": np.zeros(3), "angular_momentum": np.zeros(3), "orientation": euler_quaternion(0.0, 0.0, 0.0)}
    body = RigidBody(1.0, 0.16 / 6.0 * np.eye(3), **(still | {"position": np.array([0.0, -0.8, 0.0])} | changes))
    return sides, body


def bounced(sides: Sides, body: RigidBody, dt: float = 1e-3) -> RigidBody:
    from ocean_sim.ship import Load

    def after(load):
        return advance_body(body, load.force, load.torque, dt)

    return sides.moved_inside(after(sides.with_impulses(Load.of({}), after, dt)))


def test_a_box_bounces_from_the_bed_and_from_a_corner():
    sides, body = struck(0.4, 0.0, velocity=np.array([1.0, -2.0, 0.0]))
    after = bounced(sides, body)
    np.testing.assert_allclose(after.velocity, [1.0, 0.8, 0.0], atol=1e-6)
    np.testing.assert_allclose(after.angular_momentum, np.zeros(3), atol=1e-6)
    rubbed = bounced(*struck(0.4, 0.1, velocity=np.array([1.0, -2.0, 0.0])))
    assert rubbed.velocity[0] == pytest.approx(1.0 - 0.1 * 2.8, rel=0.2)
    elastic, body = struck(1.0, 0.0, velocity=np.array([-3.0, 0.0, 0.5]), position=np.array([-0.76, 0.0, 0.1]))
    body = replace(body, orientation=euler_quaternion(0.3, 0.4, 0.2))
    after = bounced(elastic, body)
    assert after.velocity[0] > -3.0 and after.kinetic_energy() == pytest.approx(body.kinetic_energy(), rel=1e-3)
    corners = elastic.points @ after.matrix.T + after.position
    assert corners[:, 0].min() > -1.0 - 1e-9


def test_a_ship_is_put_into_water_that_leaves_it_in_peace():
    """The particles around the hull do not begin crowded, which would throw some of them at it: 26 m/s2 at 0.1 s."""
    with Simulation(load("showcase", QUIET)) as simulation:
        while simulation.time < 0.25:
            simulation.step()
            assert np.linalg.norm(simulation.ships["ship"].acceleration) < 0.5
