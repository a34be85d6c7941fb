"""Ships on particles: what floats by a law over a surface, and what floats by pressure alone."""

import inspect

import numpy as np
import pytest
from scipy.spatial import cKDTree

from ocean_sim.basin.solids.packing import Lattice
from ocean_sim.conventions import Diverged
from ocean_sim.files.yaml_file import SceneError
from ocean_sim.fluid.sph.smoothing import WENDLAND
from ocean_sim.reading.scene import load, observer_names
from ocean_sim.ship import pressure
from ocean_sim.ship.body.rigid_body import RigidBody
from ocean_sim.ship.hull.hull import hull_of
from ocean_sim.ship.water.solid import Solid
from ocean_sim.simulation import Simulation

QUIET = {name: None for name in observer_names() if name != "manifest"} | {"runtime.threads": 1}
REST = ("thesis", "dynamic")
BOX = {"kind": "box", "length": 2.0, "breadth": 1.0, "height": 0.6}


def tank(ship: dict, **keys) -> dict:
    """A coarse tank at rest."""
    fluid = {"kind": "mueller", "spacing": 0.2, "kinematic_viscosity": 0.01, "compression": 0.008}
    basin = {"length": 4.0, "width": 4.0, "depth": 1.2}
    return {"duration": 1.0, "basin": basin, "fluid": fluid, "surface": "cloth", "ship": ship, **keys}


@pytest.mark.parametrize("walls", [{}, {"walls": "periodic"}])
def test_a_hull_that_is_longer_than_its_water_is_refused(walls):
    """Along the axis that it lies along; in a patch that repeats itself it would meet itself on the other side."""
    hull = {"shape": BOX | {"length": 5.0}, "mass": 1000.0, "centre_of_mass": [0.0, 0.2, 0.0]}
    basin = {"length": 4.0, "width": 8.0, "depth": 1.2} | walls
    load(tank({"kind": "hydrostatic", "hull": hull, "heading_deg": 0.0}, basin=basin))
    with pytest.raises(SceneError, match="the hull takes 5 m along x, the basin 4 m"):
        load(tank({"kind": "hydrostatic", "hull": hull, "heading_deg": 90.0}, basin=basin))


@pytest.mark.parametrize("kind", ["hydrostatic", *(pytest.param(kind, marks=pytest.mark.slow) for kind in REST)])
def test_a_barge_floats_at_its_draught_on_the_surface_of_particles(kind):
    """A third of 0.6 m under the surface that the water shows, to 5 %, where they pass through each other."""
    hull = {"shape": BOX, "mass": 400.0, "centre_of_mass": [0.0, 0.2, 0.0]}
    with Simulation(load(tank({"kind": kind, "hull": hull, "contact": None}), QUIET)) as simulation:
        body, draughts = simulation.ships["ship"].body, []
        while simulation.time < 3.0:
            simulation.step()
            body = simulation.ships["ship"].body
            x, z = np.meshgrid(np.linspace(-0.5, 0.5, 5), np.linspace(-1.0, 1.0, 9))
            level = simulation.surface.elevations(np.stack([x.ravel(), z.ravel()], axis=1)).mean()
            if simulation.time > 1.5:
                draughts.append(level - (body.position[1] - 0.2))
        assert np.mean(draughts) == pytest.approx(0.2, rel=0.05)
        assert abs(np.degrees(body.angles[[0, 2]])).max() < 2.0


def slice_of_water(mass: float = 400.0, start: float | None = None, spacing: float = 0.08, **ship) -> dict:
    """A box 0.8 m broad and high in a slice, a metre of it."""
    box = {"kind": "box", "length": 1.0, "breadth": 0.8, "height": 0.8}
    place = {} if start is None else {"position": [0.0, start, 0.0]}
    hull = {"shape": box, "mass": 0.64 * mass, "centre_of_mass": [0.0, 0.3, 0.0]}
    return {
        "duration": 2.0,
        "basin": {"length": 3.2, "depth": 1.2},
        "fluid": {"kind": "delta_sph", "spacing": spacing, "compression": 0.02, "artificial_viscosity": 0.1},
        "ship": {"kind": "pressure", "hull": hull, **place, **ship},
    }


def at_rest(draught: float, place: float = 0.0, scheme: str = "delta_sph", side: float = 0.5, **basin) -> dict:
    """A cube that draws so many spacings of 0.1 m, with its middle `place` spacings off that of the lattice."""
    hull = {
        "shape": {"kind": "box", "length": side, "breadth": side, "height": side},
        "mass": 100.0 * side**2 * draught,
        "centre_of_mass": [0.0, 0.5 * side, 0.0],
    }
    fluid = {"kind": scheme, "spacing": 0.1} | ({"kinematic_viscosity": 0.02} if scheme == "mueller" else {})
    ship = {"kind": "pressure", "hull": hull, "free": ["heave"], "position": [0.1 * place, 0.1 * place]}
    return {"duration": 5.0, "basin": {"length": 6.0, "depth": 1.0} | basin, "fluid": fluid, "ship": ship}


@pytest.mark.parametrize(
    ("draught", "place", "basin"),
    [
        *((draught, place, {}) for draught in (2.0, 2.5, 4.0) for place in (0.0, 0.25)),
        (3.3, 0.25, {"width": 1.5, "length": 1.5, "walls": "periodic"}),
        *(pytest.param(2.5, place, {"width": 2.0}, marks=pytest.mark.slow) for place in (0.0, 0.25, 0.5)),
    ],
)
def test_a_hull_leaves_the_water_that_it_does_not_displace(draught, place, basin):
    """To a particle, or 1 %, and none nearer to another than 0.7 spacings, wherever she lies on the lattice."""
    lattice = load(at_rest(draught, place, **basin), QUIET).preflight.lattice
    x, displaced = lattice.positions(), draught * (25.0 if basin else 5.0)
    assert len(lattice.full_positions) - len(x) == pytest.approx(displaced, rel=0.01, abs=1.0)
    assert cKDTree(x).query(x, k=2)[0][:, 1].min() > 0.07


def heave(scene: dict, until: float) -> np.ndarray:
    """Heave from the beginning in every step, in spacings."""
    with Simulation(load(scene, QUIET)) as simulation:
        ship, found = simulation.ships["ship"], []
        start = ship.body.position[1]
        while simulation.time < until:
            simulation.step()
            found.append(ship.body.position[1] - start)
    return np.array(found) / scene["fluid"]["spacing"]


@pytest.mark.anchor
def test_a_box_afloat_is_not_thrown():
    """2.5 spacings of draught do not fit the lattice: with the points inside left out she rises by 0.6 spacings."""
    assert abs(heave(at_rest(2.5), 0.6)).max() < 0.06


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["delta_sph", "mueller"])
@pytest.mark.parametrize(("draught", "place", "side"), [(2.0, 0.3, 0.5), (2.5, 0.0, 0.5), (4.0, 0.3, 0.7)])
def test_a_box_at_rest_stays_near_its_draught(scheme, draught, place, side):
    """For 5 s, as far as `check` says."""
    assert abs(heave(at_rest(draught, place, scheme, side), 5.0)).max() < pressure.REST_SWING[0]


def draught(simulation: Simulation) -> float:
    """Keel under the water's own level, from half a breadth next to the hull on [m]. A level by its volume at rest
    density would be 15 mm too high: 1.2 m of water that yields by 2 % at the bed."""
    apart = np.linspace(0.8, 1.5, 8)
    gauges = np.array([(x, 0.0) for x in (*-apart, *apart)])
    return simulation.fluid.elevations(gauges).mean() - (simulation.ships["ship"].body.position[1] - 0.3)


def settled(simulation: Simulation, first: float, last: float) -> float:
    """Mean draught between two times [m]."""
    draughts = []
    while simulation.time < last:
        simulation.step()
        if simulation.time > first:
            draughts.append(draught(simulation))
    return float(np.mean(draughts))


def test_the_waters_pressure_alone_carries_a_box():
    config = load(slice_of_water(500.0, spacing=0.1), QUIET)
    with Simulation(config) as simulation:
        first = simulation.ships["ship"].body.velocity * simulation.ships["ship"].body.mass
        pushed = np.zeros(3)
        before = simulation.fluid.boundary.impulses()[0]
        while simulation.time < 0.6:
            dt = simulation.next_dt
            simulation.step()
            pushed += dt * simulation.ships["ship"].last.force
        body = simulation.ships["ship"].body
        assert draught(simulation) == pytest.approx(0.4, rel=0.05)
        np.testing.assert_allclose(body.mass * body.velocity - first, pushed * [1.0, 1.0, 0.0], atol=1e-6 * body.mass)
        weight = body.mass * 9.81 * simulation.time
        water = simulation.fluid.boundary.impulses()[0] - before
        assert pushed[1] + weight == pytest.approx(water[1], rel=1e-5)
        x = simulation.fluid.particles.position.to_numpy()
        own = (x - body.position) @ body.matrix + [0.0, 0.3, 0.0]
        inside = (abs(own[:, 0]) < 0.38) & (own[:, 1] > 0.02) & (own[:, 1] < 0.78)
        assert not inside.any()
        # Negative control: without what the water presses, nothing else carries it.
        assert "elevation" not in inspect.getsource(pressure) and "wetted" not in inspect.getsource(pressure)
        simulation.fluid.boundary.shares.fill(0.0)
        start, height, speed = simulation.time, body.position[1], body.velocity[1]
        with pytest.raises(Diverged, match="sunk to the bed"):
            simulation.run(3.0)
        fallen, t = height - simulation.ships["ship"].body.position[1], simulation.time - start
        assert fallen == pytest.approx(0.5 * 9.81 * t * t - speed * t, abs=0.05)


@pytest.mark.slow
def test_its_draught_at_ten_spacings():
    with Simulation(load(slice_of_water(500.0, spacing=0.04), QUIET)) as simulation:
        assert settled(simulation, 1.0, 1.5) == pytest.approx(0.4, rel=0.03)


@pytest.mark.slow
@pytest.mark.parametrize("density", [100.0, 900.0])
def test_light_and_heavy_bodies_are_stable(density):
    """At a tenth of the water's density the water next to a body outweighs it six times; it draws two spacings. Both
    begin on the level that the water has under its own weight, 12 mm below the one that was asked for."""
    with Simulation(load(slice_of_water(density, spacing=0.04), QUIET)) as simulation:
        while simulation.time < 0.6:
            simulation.step()
        body = simulation.ships["ship"].body
        assert np.linalg.norm(body.velocity) < 0.1
        assert simulation.fluid.surface_drop == pytest.approx(0.012, rel=0.05)
        assert draught(simulation) == pytest.approx(0.8 * density / 1000.0, rel=0.02)


@pytest.mark.slow
def test_a_half_immersed_cylinder_bobs_as_potential_flow_says():
    """Ito's cylinder of 0.1524 m, let go 0.0254 m too high: extrema of linear theory (Ursell 1949; Yeung 1982)."""
    radius, rise, depth, squeeze = 0.0762, 0.0254, 0.45, 0.02  # at the bed: the water settles by half of it
    shape = {"kind": "cylinder", "length": 1.0, "radius": radius}
    hull = {"shape": shape, "mass": 500.0 * np.pi * radius**2, "centre_of_mass": [0.0, radius, 0.0]}
    water = {"kind": "delta_sph", "spacing": radius / 10, "compression": squeeze, "artificial_viscosity": 0.03}
    scene = {
        "duration": 1.0,
        "basin": {"length": 3.2, "depth": depth, "walls": {"x": "absorbing"}},  # half as long, it rises by rise / 10
        "fluid": water,
        "ship": {"kind": "pressure", "hull": hull, "free": ["heave"]},
    }
    scene["ship"] |= {"position": [0.0, rise - 0.5 * squeeze * depth, 0.0]}
    with Simulation(load(scene, QUIET)) as simulation:
        rows = []
        while simulation.time < 0.7:
            simulation.step()
            y = simulation.ships["ship"].body.position[1] + simulation.fluid.surface_drop  # over the water's own level
            rows.append((simulation.time, y / rise))
    t, y = np.array(rows).T
    low = int(np.argmin(y))
    high = low + int(np.argmax(y[low:]))
    assert y[low] == pytest.approx(-0.6408, rel=0.10) and t[low] == pytest.approx(0.326, rel=0.05)
    assert t[high] == pytest.approx(0.635, rel=0.05)


def test_a_hull_at_a_given_height_lies_in_water_that_has_settled_around_it():
    """Given the height at which another floats, it has the same water around it, and no gap below."""
    places = []
    start = None
    for _ in range(2):
        with Simulation(load(slice_of_water(start=start), QUIET)) as simulation:
            start = float(simulation.ships["ship"].body.position[1])
            places.append((start, simulation.fluid.particles.position.to_numpy()))
    (afloat, water), (given, same) = places
    assert simulation.fluid.surface_drop > 0.01 and given == pytest.approx(afloat, abs=1e-9)
    np.testing.assert_allclose(same, water, atol=1e-6)


@pytest.mark.slow
def test_water_next_to_a_hull_is_not_pulled_along_its_sides():
    """A box that draws all but a spacing of the water, moved up and down: the water at its sides stays behind, and what
    force it takes beyond its weight is that of what is under it."""
    scene = slice_of_water(mass=400.0, free=["heave"])
    with Simulation(load(scene, QUIET)) as simulation:
        ship, fluid = simulation.ships["ship"], simulation.fluid
        boundary, still, push = fluid.boundary, ship.body.position.copy(), 2.0
        for _ in range(40):
            dt = simulation.next_dt
            boundary.place(ship.number, still, acceleration=[0.0, push, 0.0])
            fluid.advance(dt)
        x, v = fluid.particles.position.to_numpy(), fluid.particles.velocity.to_numpy()
        beside = (abs(abs(x[:, 0]) - 0.4) < 0.08) & (x[:, 1] < -0.08) & (x[:, 1] > still[1] - 0.1)
        assert abs(v[beside, 1]).mean() < 0.2 * push * fluid.time


def test_water_that_cannot_carry_it_is_refused():
    scene = slice_of_water() | {"fluid": {"kind": "dfsph", "spacing": 0.1}}
    with pytest.raises(SceneError, match="does not carry a ship of kind pressure"):
        load(scene)


def test_a_ship_may_float_before_the_first_water_comes():
    """An emitter alone, or a hull that takes the place of all the water there is."""
    unit = np.array([1.0, 0.0, 0.0, 0.0])
    body = RigidBody(400.0, np.eye(3), np.zeros(3), unit, np.zeros(3), np.zeros(3))
    hull = Solid(hull_of("wigley").shape, np.zeros(3), body.position, body.matrix, False, False, body=body)
    packed = Lattice(0.2, 0.2**3, WENDLAND, 2.0)
    for places, taken in ((np.zeros((0, 3)), 0), (np.zeros((1, 3)), 1)):
        gone, others = hull.make_room(places, places[:0], [(np.full(3, -2.0), np.full(3, 2.0))], packed)
        assert gone.sum() == taken and np.array_equal(others, places)
