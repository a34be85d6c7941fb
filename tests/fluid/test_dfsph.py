"""Incompressible water: what the two solvers promise, momentum, still water, and what becomes of it without them."""

from itertools import product

import numpy as np
import pytest

from ocean_sim.conventions import GRAVITY, Diverged
from ocean_sim.fluid.bodies.emitter import MOST_PARTICLES
from ocean_sim.fluid.dfsph import MIN_DIAGONAL_SHARE
from ocean_sim.fluid.neighbours.grid_size import GridSize
from ocean_sim.fluid.sph.smoothing import NEUTRAL_KERNEL, Smoothing, Stencil
from ocean_sim.reading.scene import load
from ocean_sim.result import run
from ocean_sim.simulation import Simulation
from ocean_sim.verbs.run import run_facts, run_summary
from ocean_sim.verbs.shared.progress import Progress
from tests.conftest import quickly
from tests.fluid.conftest import box, by_id, kept, put

OPEN = {"length": 1.0, "width": 1.0, "depth": 0.5, "walls": "none", "floor": "none"}
TANK = {"length": 0.8, "width": 0.4, "depth": 0.4}
COLUMN = [{"min": [-0.4, -0.4, -0.2], "max": [0.0, 0.0, 0.2]}]


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_lattice_has_the_rest_density_inside_and_at_walls(water, dimension):
    fluid = water("dfsph", basin={"length": 1.0, "depth": 1.0, "width": 1.0 if dimension == 3 else None})
    x, rho = fluid.particles.position.to_numpy(), fluid.particles.density.to_numpy()
    np.testing.assert_allclose(rho[x[:, 1] < -0.25], 1000.0, rtol=1e-9)
    assert rho[x[:, 1] > -0.1].max() < 900.0, "a surface lacks neighbours, and says so"


def column(again):
    """Water in one half of a tank."""
    return again("dfsph", basin=TANK, spacing=0.05, fill=COLUMN, kinematic_viscosity=0.005)


def test_kept_pairs_are_all_neighbours_and_all_images(again):
    fluid = column(again)
    x = fluid.particles.position.to_numpy()
    x += 0.01 * np.random.default_rng(5).uniform(-1.0, 1.0, x.shape)
    put(fluid, x, np.zeros_like(x))
    x, h, pairs = fluid.particles.position.to_numpy(), fluid.smoothing.support, kept(fluid)
    assert len(pairs) == len(x)
    planes = [(-0.4, 0.4), (-0.4, None), (-0.2, 0.2)]  # of the sides on each axis
    images = {0: x}
    for axis, sides in enumerate(planes):
        for flips, seen_so_far in list(images.items()):
            mirrored = [seen_so_far * np.where(np.arange(3) == axis, -1.0, 1.0) for _ in range(2)]
            for image, side in zip(mirrored, sides):
                if side is not None:
                    image[:, axis] += 2.0 * side
                    both = images.get(flips | 1 << axis, np.empty((0, 3)))
                    images[flips | 1 << axis] = np.concatenate([both, image])
    for i in range(0, len(x), 7):
        expected = []
        for flips, places in images.items():
            away = x[i] - places
            r = np.linalg.norm(away, axis=1)
            for k in np.nonzero((r < h) & (r > 0.0))[0]:
                slope = fluid.smoothing.kernel.gradient(1.0 - r[k] / h)
                expected.append((flips * MOST_PARTICLES + k % len(x), *(slope * away[k])))
        found = [(name, *gradient) for name, gradient in zip(*pairs[i])]
        np.testing.assert_allclose(sorted(found), sorted(expected), atol=1e-12)


def moved(fluid, x: np.ndarray, steps: int = 3) -> np.ndarray:
    """Positions, in the order of their ids, after some steps from x."""
    put(fluid, x, np.zeros_like(x))
    for _ in range(steps):
        fluid.advance(2e-3)
    return by_id(fluid, fluid.particles.position.to_numpy())


def test_shapes_that_find_no_room_are_found_anew(water, monkeypatch):
    """Half of a tank of shaken water next to three sides and a floor; negative control: a kernel's other shapes."""
    keys = {"basin": TANK, "spacing": 0.05, "fill": COLUMN, "kinematic_viscosity": 0.005}
    fluid = water("dfsph", **keys)
    x = fluid.particles.position.to_numpy()
    x += 0.01 * np.random.default_rng(5).uniform(-1.0, 1.0, x.shape)
    kept = moved(fluid, x)
    monkeypatch.setattr(GridSize, "shapes_per_particle", 0)
    without = water("dfsph", **keys)
    assert without.pairs.shape.shape[0] < 0.5 * fluid.pairs.shape.shape[0]
    found = moved(without, x)
    begun, last = without.pairs.begun.to_numpy(), without.pairs.shape.shape[0] - without.pairs.width
    assert (np.bincount(begun) > 1).any() and begun.max() <= last, "parts without room share a row"
    np.testing.assert_allclose(found, kept, atol=1e-13)
    assert np.abs(kept - by_id(fluid, x)).max() > 1e-5


@pytest.mark.parametrize(("dimension", "support"), [(2, 4.0), (3, 4.0), (3, 6.0)])
def test_spray_and_jets_beyond_the_grid_find_room(water, dimension, support):
    """A pool, of which one in ten particles is alone in a cell, and one in ten in a jet high over the grid."""
    wide = dimension == 3
    basin = {"length": 3.0, "width": 1.0 if wide else None, "depth": 1.0}
    low = [-1.5, -1.0, *([-0.5] if wide else [])]
    fill = [{"min": low, "max": [1.5, -0.7, *([0.5] if wide else [])]}]
    fluid = water("dfsph", basin=basin, spacing=0.08 if wide else 0.02, fill=fill, support_ratio=support)
    rng, x = np.random.default_rng(4), fluid.particles.position.to_numpy()
    tenth = len(x) // 10
    x[:tenth] = rng.uniform([-1.5, -0.6, -0.5], [1.5, 1.0, 0.5], (tenth, 3))
    x[tenth : 2 * tenth] = rng.uniform([0.0, 1.5, 0.0], [0.1, 9.0, 0.1], (tenth, 3))
    put(fluid, x * [1.0, 1.0, float(wide)], np.zeros_like(x))
    fluid.advance(1e-3)
    assert np.isfinite(fluid.particles.position.to_numpy()).all()


def test_more_neighbours_than_lists_hold_stop_the_run(water):
    fluid = water("dfsph", basin=OPEN | {"width": None}, spacing=0.025)
    x = fluid.particles.position.to_numpy()
    assert len(x) == 800
    put(fluid, x.mean(axis=0) + 0.4 * (x - x.mean(axis=0)), np.zeros_like(x))
    fluid = water("dfsph", basin=OPEN | {"width": None}, spacing=0.0125)
    x = fluid.particles.position.to_numpy()
    with pytest.raises(Diverged, match="more neighbours than their lists hold"):
        put(fluid, x.mean(axis=0) + 0.02 * (x - x.mean(axis=0)), np.zeros_like(x))


BOUND = 4.0 / 3.0  # of the relaxation times A / A_ii: up to there steps that Nesterov's momentum carries on are stable


def stiffness(x: np.ndarray, stencil: Stencil, crowded: bool) -> float:
    """Largest eigenvalue of A / A_ii of particles at x [spacings], with mirrors in the planes x, y and z = 0, over that
    of a lattice. `crowded`: whether A_ii counts for more where there are more of them than at rest."""
    smoothing, n = stencil.smoothing, len(x)
    rates, sums, squares, density = np.zeros((n, n, 3)), np.zeros((n, 3)), np.zeros(n), np.zeros(n)
    for axes in product(*[(1.0, -1.0)] * smoothing.dimension, *[(1.0,)] * (3 - smoothing.dimension)):
        away = x[:, None] - axes * x[None]
        t = np.maximum(1.0 - np.linalg.norm(away, axis=2) / smoothing.support, 0.0)
        gradient = smoothing.kernel.gradient(t)[..., None] * away
        rates -= axes * gradient
        sums += gradient.sum(axis=1)
        squares += (gradient**2).sum(axis=(1, 2))
        density += smoothing.kernel.value(t).sum(axis=1)
    rates[np.arange(n), np.arange(n)] += sums
    diagonal = np.maximum(
        (sums**2).sum(axis=1) + squares, MIN_DIAGONAL_SHARE * stencil.gradient_squares / stencil.slope**2
    )
    diagonal *= np.maximum(density / stencil.value.sum(), 1.0) if crowded else 1.0
    return float(np.linalg.norm(rates.reshape(n, -1) / np.sqrt(diagonal)[:, None], 2) ** 2 / stencil.stiffest_mode)


@pytest.mark.parametrize(("dimension", "support"), [(2, 2.0), (2, 4.0), (3, 2.0), (3, 2.82), (3, 4.0)])
def test_iterations_are_stable_for_particles_in_disorder_and_piled_up(dimension, support):
    stencil, rng = Stencil(Smoothing(dimension, support, NEUTRAL_KERNEL), 1.0), np.random.default_rng(3)
    flat = np.array([1.0, 1.0, float(dimension == 3)])
    side = [5 if dimension == 3 else 11] * dimension
    lattice = flat * (np.stack(np.indices([*side, *[1] * (3 - dimension)]), axis=-1).reshape(-1, 3) + 0.5)
    for shaken in (0.1, 0.3, 0.5):
        x = np.abs(lattice + flat * rng.uniform(-shaken, shaken, lattice.shape))
        assert stiffness(x, stencil, True) < BOUND
    for place in ([2.2, 2.3, 2.1], [0.05, 2.0, 2.0], [0.05, 0.05, 0.05]):
        pile = flat * (np.array(place) + 1.0e-3 * rng.uniform(-1.0, 1.0, (20, 3)))
        assert stiffness(np.concatenate([lattice, pile]), stencil, True) < BOUND
    assert stiffness(np.concatenate([lattice, flat * np.full((20, 3), 2.2)]), stencil, False) > 2.0, "A_ii alone"


MOST = {"max_density_iterations": 90, "max_divergence_iterations": 80}


def rushing_together(again, tolerance: float = 1e-5, most: tuple[int, int] = (90, 80)):
    """A shaken viscous block without gravity whose halves run into each other, after one step in which its solvers
    iterate so often at the most."""
    basin, keys = OPEN | {"gravity": [0.0, 0.0, 0.0]}, {"reference_speed": 2.0, "kinematic_viscosity": 0.01}
    keys |= MOST | dict.fromkeys(("density_tolerance", "divergence_tolerance"), 1e-5)
    fluid = again("dfsph", basin=basin, accounts=True, **keys, **box(10, 10, 10, spacing=0.05))
    assert {f"max_{name}_iterations": solver.most for name, solver in fluid.solvers.items()} == MOST
    for solver, limit in zip((fluid.solvers["density"], fluid.solvers["divergence"]), most):
        assert solver.tolerance == 1e-5
        solver.tolerance, solver.most = tolerance, limit
    x = fluid.particles.position.to_numpy()
    x += 0.05 * fluid.particles.spacing * np.random.default_rng(3).uniform(-1.0, 1.0, x.shape)
    v = np.zeros_like(x)
    v[:, 0] = x[:, 0].mean() - x[:, 0]
    put(fluid, x, v)
    fluid.before = fluid.particles.velocity.to_numpy().sum(axis=0)
    fluid.advance(5e-3)
    return fluid


def test_the_solvers_end_within_their_tolerances_and_say_so(again):
    fluid = rushing_together(again)
    for solver in fluid.solvers.values():
        assert solver.last_error <= 1e-5 and solver.error == solver.last_error
        assert solver.unsolved == 0 and solver.iterations == solver.last_iterations
    assert fluid.solvers["divergence"].iterations > 0
    excess = np.maximum(fluid.particles.density.to_numpy() / 1000.0 - 1.0, 0.0)
    assert excess.mean() < 2e-4, "the density found is the density wanted, up to the square of the step"


def test_a_limit_of_iterations_that_is_met_is_counted(again):
    fluid = rushing_together(again, tolerance=1e-7, most=(2, 1))
    density, divergence = fluid.solvers["density"], fluid.solvers["divergence"]
    assert (density.iterations, divergence.iterations) == (2, 1)
    assert (density.unsolved, divergence.unsolved) == (1, 1)
    assert density.error > 1e-7 and divergence.error > 1e-7


@pytest.mark.anchor
def test_momentum_is_kept_to_rounding(again):
    fluid = rushing_together(again)
    gained = np.abs(fluid.particles.velocity.to_numpy()).sum()
    np.testing.assert_allclose(fluid.particles.velocity.to_numpy().sum(axis=0), fluid.before, atol=1e-13 * gained)
    assert np.abs(fluid.impulse["pressure"]).max() < 1e-13 * gained * fluid.particles.mass


@pytest.fixture(scope="module")
def still(water):
    """A slice of inviscid water, left alone for 4 s, and the largest speed that it had [sqrt(g H)]."""
    fluid = water("dfsph", basin={"length": 1.0, "width": None, "depth": 0.5}, spacing=0.05, accounts=True)
    fluid.fastest = 0.0
    while fluid.time < 4.0:
        fluid.advance(0.01)
        fluid.fastest = max(fluid.fastest, fluid.status.max_speed / np.sqrt(GRAVITY * 0.5))
    return fluid


@pytest.mark.anchor
def test_still_water_stays_still_and_holds_its_pressure(still):
    """Without viscosity of its own; the lattice would give way, and simmer at 0.2 to 0.3 sqrt(g H), after 1 s."""
    assert still.fastest < 0.02
    y = still.particles.position.to_numpy()[:, 1]
    error = (still.particles.pressure.to_numpy() + 1000.0 * GRAVITY * y) / (1000.0 * GRAVITY * 0.5)
    assert np.sqrt((error**2).mean()) < 0.02
    assert abs(error[y < -0.45].mean()) < 0.02
    assert abs(y.mean() + 0.25) < 0.005 * 0.5
    weight = still.particles.mass * still.particles.n * GRAVITY
    assert still.impulse["walls"][1] == pytest.approx(weight * 4.0, rel=0.01)


def test_calm_water_needs_few_iterations(still):
    steps = 400
    assert sum(solver.iterations for solver in still.solvers.values()) < 2 * steps
    assert all(solver.unsolved == 0 for solver in still.solvers.values())


def test_water_that_is_carried_along_does_what_it_does_at_rest(again):
    """Galileo: a wave in a slice without sides, and the same in water that streams by at 1 m/s."""
    moved = []
    for stream in (0.0, 1.0):
        fluid = again("dfsph", basin={"length": 1.0, "width": None, "depth": 0.4, "walls": "periodic"}, spacing=0.05)
        x = fluid.particles.position.to_numpy()
        k = 2.0 * np.pi
        u, up = np.sin(k * x[:, 0]) * np.cosh(k * (x[:, 1] + 0.4)), -np.cos(k * x[:, 0]) * np.sinh(k * (x[:, 1] + 0.4))
        put(fluid, x, np.stack([0.05 * u + stream, 0.05 * up, 0.0 * up], axis=1))
        for _ in range(30):
            fluid.step(0.002)
        way = by_id(fluid, fluid.particles.position.to_numpy()) - x - [0.06 * stream, 0.0, 0.0]
        moved.append(way - np.round(way))  # times round
    assert np.abs(moved[0]).max() > 0.005
    np.testing.assert_allclose(moved[1], moved[0], atol=1e-10)


def test_angular_momentum_is_kept_to_rounding(again):
    fluid = rushing_together(again)
    x, v = fluid.particles.position.to_numpy(), fluid.particles.velocity.to_numpy()
    for _ in range(3):
        fluid.advance(5e-3)
    x_after, v_after = fluid.particles.position.to_numpy(), fluid.particles.velocity.to_numpy()
    turned = np.cross(x_after, v_after).sum(axis=0) - np.cross(x, v).sum(axis=0)
    assert np.abs(turned).max() < 1e-13 * np.abs(np.cross(x, v)).sum()


def collapsed(fluid) -> float:
    """A column of water that falls into a tank, after 0.2 s: mean of what is denser than at rest."""
    for _ in range(80):
        fluid.advance(2.5e-3)
    assert fluid.status.finite
    return float(np.maximum(fluid.particles.density.to_numpy() / 1000.0 - 1.0, 0.0).mean())


def test_a_falling_column_is_not_compressed(again):
    assert collapsed(column(again)) < 2e-3


def test_without_its_solvers_water_is_compressed(again):
    """Negative control."""
    fluid = column(again)
    for solver in fluid.solvers.values():
        solver.most = 0
    assert collapsed(fluid) > 0.2


def gained(again, brief: bool) -> float:
    """Energy that a column of syrup gains in steps as short as its viscosity asks for, over m g H."""
    fluid = again(
        "dfsph",
        basin={"length": 1.0, "width": None, "depth": 0.5},
        spacing=0.05,
        fill=[{"min": [-0.5, -0.5], "max": [0.0, 0.0]}],
        kinematic_viscosity=10.0,
    )
    if not brief:
        fluid.divergence.brief = 0.0

    def energy() -> float:
        x, v = fluid.particles.position.to_numpy(), fluid.particles.velocity.to_numpy()
        return 0.5 * float((v**2).sum(axis=1).mean()) + GRAVITY * float(x[:, 1].mean())

    start, most = energy(), 0.0
    for k in range(2000):
        fluid.advance(2.5e-5)
        if k % 50 == 49:
            most = max(most, energy() - start)
    return most / (GRAVITY * 0.5)


def test_a_viscous_column_gains_no_energy_in_short_steps(again):
    assert gained(again, True) == 0.0


def test_what_is_calm_in_a_long_step_would_lift_water_in_short_ones(again):
    """Negative control: what gravity compresses in a step is never undone, until it comes as a blow."""
    assert gained(again, False) > 0.01


def test_only_calm_water_goes_on_to_half_of_its_error(again):
    """Still water comes to rest by it; water that breaks stops at the tolerance."""
    solver = column(again).incompressible
    first = 0.8 * solver.tolerance
    assert solver.error_goal(first, 0.01, calm=True) == pytest.approx(0.5 * first)
    assert solver.error_goal(first, 0.01, calm=False) == solver.tolerance
    assert solver.error_goal(1e-9, 0.01, calm=True) == pytest.approx(0.1 * solver.tolerance)


def barge(position: list[float], heading: float) -> dict:
    hull = {"shape": {"kind": "box", "length": 0.5, "breadth": 0.3, "height": 0.3}, "mass": 9.0}
    ship = {"kind": "dynamic", "hull": hull, "position": position, "heading_deg": heading}
    return {"basin": {"length": 1.2, "width": 0.6, "depth": 0.4}, "surface": "cloth", "ship": ship}


OFF_THE_LATTICE = {
    "a ship": barge([0.0, 0.0], 0.0),
    "a ship askew": barge([0.013, 0.011], 20.0),
    "a block": {"basin": {"length": 1.2, "depth": 0.4, "obstacles": [{"min": [-0.15, -0.4], "max": [0.17, -0.13]}]}},
}


@pytest.mark.parametrize("name", ["a block", *quickly("a ship askew", "a ship")])
def test_bodies_off_the_lattice_set_no_water_in_motion(name):
    """Water that begins at rest is no faster after a step than what falls freely, however brief the step is: made room
    for within the first step, a block would throw it aside at 115 m/s here."""
    dt, quiet = 2e-4, dict.fromkeys(["frames", "render", "report"])
    water = {"kind": "dfsph", "spacing": 0.05}
    runtime = {"threads": 1, "precision": "f64"}
    step = {"kind": "fixed", "dt": dt}
    scene = OFF_THE_LATTICE[name] | quiet | {"fluid": water, "time_step": step, "runtime": runtime}
    with Simulation(load(scene)) as simulation:
        simulation.step()
        assert simulation.fluid.status.max_speed < 1.5 * GRAVITY * dt


def test_a_support_too_narrow_for_still_water_is_warned_of():
    for width, still in ((None, 3.0), (0.5, 3.5)):
        scene = {"basin": {"length": 1.0, "depth": 0.5, "width": width}, "duration": 1.0}
        for support, warned in ((still, False), (still - 0.1, True), (1.2, True)):
            fluid = {"kind": "dfsph", "spacing": 0.05, "support_ratio": support}
            assert (
                any("still water of dfsph stirs" in said for said in load(scene | {"fluid": fluid}).warnings())
                == warned
            )


def test_the_closing_lines_count_emitted_particles_and_steps_above_tolerance(tmp_path):
    emitter = {"position": [-0.4, -0.1], "velocity": [1.0, 0.0], "rate": 0.2, "cap": 400}
    fluid = {"kind": "dfsph", "spacing": 0.05, "emitter": emitter, "max_density_iterations": 0}
    fluid |= {"fill": [{"min": [0.0, -0.5], "max": [0.4, 0.0]}]}
    scene = {"basin": {"length": 1.0, "depth": 0.5}, "fluid": fluid, "duration": 0.2, "render": None}
    progress = Progress(0.2, quiet=True)
    result = run(load(scene), tmp_path / "run", (progress,))
    facts = progress.summary()
    assert facts["particles"] == result.manifest["particles"]["count"] > 80
    assert 0 < facts["unsolved"]["density"] <= facts["steps"] and facts["unsolved"]["divergence"] == 0
    told = run_summary(facts | run_facts(result, load(scene)))
    count = facts["unsolved"]["density"]
    assert f"{count} of {facts['steps']} steps ended with a density above fluid.density_tolerance" in told
