"""The thesis's scheme against closed forms: density, third law, momentum, free fall, and its terms one by one."""

import numpy as np
import pytest

from ocean_sim.columns import vec3
from ocean_sim.conventions import GRAVITY
from ocean_sim.fluid.mueller import Momentum
from ocean_sim.kernel_library import ti
from ocean_sim.reading.scene import load
from ocean_sim.wind.gusts import Config as Gusts
from tests.fluid.conftest import box, by_id, put

OPEN = {"length": 1.0, "width": 1.0, "depth": 0.5, "walls": "none", "floor": "none"}


def test_density_equals_the_sum_over_all_particles(water):
    fluid = water(basin=OPEN, particles=400)
    rng = np.random.default_rng(1)
    x = rng.uniform(-0.4, 0.4, (fluid.particles.n, 3)) * [1.0, 0.5, 1.0]
    put(fluid, x)
    h, m = fluid.smoothing.support, fluid.particles.mass
    r2 = ((x[:, None] - x[None]) ** 2).sum(axis=2)
    W = 315.0 / (64.0 * np.pi * h**9) * np.maximum(h * h - r2, 0.0) ** 3
    rho = m * W.sum(axis=1)
    np.testing.assert_allclose(by_id(fluid, fluid.particles.density.to_numpy()), rho, rtol=1e-10)
    p = np.maximum(fluid.stiffness * (rho - 1000.0), 0.0)
    np.testing.assert_allclose(by_id(fluid, fluid.particles.pressure.to_numpy()), p, rtol=1e-8, atol=1e-6)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_lattice_has_the_rest_density_inside(water, dimension):
    spacing = 0.1
    fluid = water(basin={"length": 1.0, "depth": 1.0, "width": 1.0 if dimension == 3 else None}, spacing=spacing)
    x, rho = fluid.particles.position.to_numpy(), fluid.particles.density.to_numpy()
    inside = (np.abs(x[:, 0]) < 0.2) & (np.abs(x[:, 1] + 0.5) < 0.2) & (np.abs(x[:, 2]) < 0.2)
    assert inside.any()
    assert rho[inside] == pytest.approx(1000.0, rel=0.015)
    top = x[:, 1] > -spacing
    assert rho[top].max() < 850.0, "a surface lacks neighbours, and says so"
    deep = x[:, 1] < -2.0 * spacing
    np.testing.assert_allclose(rho[deep], rho[inside][0], rtol=1e-9, err_msg="walls are mirrors")


def test_mass_is_rest_density_times_volume_over_the_number(water):
    fluid = water(particles=777)
    assert fluid.particles.mass * fluid.particles.n == pytest.approx(1000.0 * 0.5, rel=1e-12)


@ti.data_oriented
class Unsymmetric(Momentum):
    """(2.14): the pressure of the neighbour alone."""

    @ti.func
    def pair(self, own, other):
        x_ij = vec3(own, self.row.position) - vec3(other, self.row.position)
        r = ti.sqrt(x_ij.dot(x_ij) + 1e-12)
        q = ti.max(self.fluid.smoothing.support - r, 0.0)
        along = 2.0 * other[self.row.pressure] * other[self.row.volume] * q * q / r * x_ij
        return ti.Vector([along[0], along[1], along[2], 0.0, 0.0, 0.0])


def internal_impulses(fluid) -> None:
    """Pressure and viscosity give and take: their impulses over all particles are zero, up to rounding."""
    rng = np.random.default_rng(2)
    n = fluid.particles.n
    put(fluid, rng.uniform(-0.25, 0.25, (n, 3)), rng.normal(0.0, 1.0, (n, 3)))
    before = fluid.impulse
    speed = fluid.particles.velocity.to_numpy()
    fluid.advance(1e-4)
    scale = fluid.particles.mass * np.abs(fluid.particles.velocity.to_numpy() - speed).sum()
    for term in ("pressure", "viscosity"):
        assert np.abs(fluid.impulse[term] - before[term]).max() < 1e-12 * scale, term


@pytest.fixture(scope="module")
def free(water):
    """Water without walls, floor or gravity."""
    basin = OPEN | {"gravity": [0.0, 0.0, 0.0]}
    return water(basin=basin, particles=300, reference_speed=2.0, kinematic_viscosity=0.1, accounts=True)


def test_the_energy_of_compression_is_the_work_of_the_pressure(free):
    """A block of rows that is compressed and goes on being so: equal but for the two kernels, which differ by 6 %."""
    side = np.arange(7) - 3.0
    rows = 0.95 * free.particles.spacing * np.array(np.meshgrid(side, side, side)).reshape(3, -1).T[: free.particles.n]
    put(free, rows, -rows)
    worked, stored = free.work["pressure"], free.internal_energy()
    free.advance(1e-4)
    assert worked - free.work["pressure"] == pytest.approx(free.internal_energy() - stored, rel=0.1)


def test_internal_forces_obey_newtons_third_law(free):
    internal_impulses(free)


def test_an_unsymmetric_pressure_is_noticed(free):
    """Negative control: (2.14) in place of (2.16)."""
    law = free.momentum
    free.momentum = Unsymmetric(free)
    Mueller = type(free)

    @ti.data_oriented
    class Other(Mueller):
        def __init__(self) -> None:
            self.__dict__.update(free.__dict__)

    with pytest.raises(AssertionError, match="pressure"):
        internal_impulses(Other())
    free.momentum = law


def third_law(fluid, law) -> None:
    """Forces of two particles of different density and pressure on each other are equal and opposite."""
    pair = np.array(
        [
            [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 300.0, 1.0 / 1030.0],  # position, velocity, pressure, volume of 1 kg
            [0.7, 0.2, -0.1, 0.0, -2.0, 0.5, 900.0, 1.0 / 990.0],
        ]
    )
    pair[1, :3] *= 0.5 * fluid.smoothing.support
    forces = np.empty((2, law.terms.size))

    @ti.kernel
    def both(pair: ti.types.ndarray(), forces: ti.types.ndarray()):
        own = ti.Vector([pair[0, k] for k in ti.static(range(law.row.size))])
        near = ti.Vector([pair[1, k] for k in ti.static(range(law.row.size))])
        on_one, on_other = own[law.row.volume] * law.pair(own, near), near[law.row.volume] * law.pair(near, own)
        for k in ti.static(range(law.terms.size)):
            forces[0, k], forces[1, k] = on_one[k], on_other[k]

    both(pair, forces)
    np.testing.assert_allclose(forces[0], -forces[1], rtol=1e-12)
    assert np.abs(forces[0]).max() > 0.0


def test_two_particles_push_each_other_equally_by_2_16_and_not_by_2_14(free):
    third_law(free, free.momentum)
    with pytest.raises(AssertionError):
        third_law(free, Unsymmetric(free))


def test_free_fall_to_the_order_of_the_integrator(water):
    """Symplectic Euler: the speed is exact, the way too long by g t dt / 2."""
    fluid = water(basin=OPEN, **box(1, 1, 1))
    way = []
    for steps in (50, 100):
        put(fluid, np.zeros((1, 3)))
        for _ in range(steps):
            fluid.advance(0.2 / steps)
        assert fluid.particles.velocity.to_numpy()[0, 1] == pytest.approx(-GRAVITY * 0.2, rel=1e-12)
        way.append(-fluid.particles.position.to_numpy()[0, 1] - 0.5 * GRAVITY * 0.2**2)
    assert way[0] == pytest.approx(0.5 * GRAVITY * 0.2 * 0.2 / 50, rel=1e-9)
    assert way[0] / way[1] == pytest.approx(2.0, rel=1e-9)


@pytest.mark.anchor
def test_the_momentum_of_a_block_in_still_air_is_g_t(water):
    fluid = water(basin=OPEN, particles=200, kinematic_viscosity=0.05, accounts=True)
    for _ in range(40):
        fluid.advance(5e-4)
    momentum = fluid.particles.mass * fluid.particles.velocity.to_numpy().sum(axis=0)
    weight = fluid.particles.mass * fluid.particles.n * GRAVITY
    np.testing.assert_allclose(momentum, [0.0, -weight * 0.02, 0.0], atol=1e-9 * weight)
    np.testing.assert_allclose(fluid.impulse["gravity"], [0.0, -weight * 0.02, 0.0], atol=1e-9 * weight)
    assert not fluid.impulse["walls"].any()


def test_a_uniform_stream_has_no_viscous_force(water):
    fluid = water(particles=200, kinematic_viscosity=10.0, accounts=True)
    x = fluid.particles.position.to_numpy()
    put(fluid, x, np.full_like(x, 1.7))
    fluid.advance(1e-4)
    np.testing.assert_allclose(fluid.impulse["viscosity"], 0.0, atol=1e-12)


EVERYWHERE = {"kind": "sphere", "centre": [0.0, 0.0, 0.0], "radius": 10.0}
CHANGES = {
    "pressure": {"compression": 0.04},
    "viscosity": {"kinematic_viscosity": 0.0},
    "gravity": {"body_force": [0.0, GRAVITY, 0.0]},
    "wind": {"wind": Gusts(volumes=[{"include": [EVERYWHERE], "acceleration": [3.0, 1.0, 0.0]}])},
}


@pytest.mark.parametrize("term", CHANGES)
def test_changing_one_term_changes_only_its_impulse(again, term):
    """From the same state, one step; what the walls give is what is left of all terms."""
    impulses = []
    for change in ({}, CHANGES[term]):
        keys = {"particles": 300, "kinematic_viscosity": 0.1, "accounts": True} | change
        fluid = again(basin=OPEN, **keys)
        rng = np.random.default_rng(6)
        n = fluid.particles.n
        x = rng.uniform(-0.2, 0.2, (n, 3))
        put(fluid, x, rng.normal(0.0, 1.0, (n, 3)))
        kinetic = fluid.particles.velocity.to_numpy().copy()
        fluid.advance(1e-4)
        gained = by_id(fluid, fluid.particles.velocity.to_numpy())
        impulses.append((fluid.impulse, gained, kinetic))
    (one, v_one, _), (other, v_other, _) = impulses
    for name in one:
        if name != term:
            np.testing.assert_allclose(one[name], other[name], rtol=0, atol=1e-9)
    assert np.abs(v_one - v_other).max() > 1e-6
    if term == "gravity":
        assert np.abs(other["gravity"]).max() < 1e-9 < np.abs(one["gravity"]).max()
    if term == "wind":
        mass = fluid.particles.mass * fluid.particles.n
        assert not one["wind"].any()
        np.testing.assert_allclose(other["wind"], [3e-4 * mass, 1e-4 * mass, 0.0], rtol=1e-9)


@pytest.mark.anchor
def test_walls_hold_still_water_and_carry_its_weight(water):
    fluid = water(
        basin={"length": 0.6, "width": 0.6, "depth": 0.4}, spacing=0.1, kinematic_viscosity=0.02, accounts=True
    )
    for _ in range(1500):
        fluid.advance(1e-3)
    x = fluid.particles.position.to_numpy()
    assert np.abs(x[:, [0, 2]]).max() <= 0.25 + 1e-9
    assert x[:, 1].min() >= -0.35 - 1e-9
    weight = fluid.particles.mass * fluid.particles.n * GRAVITY
    assert fluid.impulse["walls"][1] == pytest.approx(weight * 1.5, rel=0.02)
    assert np.abs(fluid.impulse["pressure"]).max() < 1e-9 * weight


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_exposed_area_of_flat_water_is_its_plan_area(water, dimension):
    """Walls and floor are mirrors, so only the free surface is exposed; a wind of no strength asks for it."""
    wind = Gusts(volumes=[{"include": [EVERYWHERE], "wind_speed": 1e-6}])
    basin = {"length": 1.0, "depth": 0.6, "width": 0.8 if dimension == 3 else None}
    fluid = water(basin=basin, spacing=0.05, wind=wind)
    fluid.exposure.find_areas()
    x, area = fluid.particles.position.to_numpy(), fluid.exposure.area.to_numpy()[fluid.particles.id.to_numpy()]
    plan = 0.8 if dimension == 3 else 1.0
    np.testing.assert_allclose(area.sum(axis=0), [0.0, plan, 0.0], atol=0.1 * plan)
    deep = x[:, 1] < -0.3
    assert np.abs(area[deep]).max() < 1e-3 * area[:, 1].max()


def test_a_bed_that_water_lies_on_does_no_work(water):
    """Each step gives a particle on the bed back some of the speed at which it would fall through, and it stays where
    it is: what images push times that speed, a work that nothing does, is over sixty times what is counted."""
    basin = {"restitution": 0.5}
    fluid = water(basin=basin, kinematic_viscosity=0.05, compression=0.01, collision_distance=0.5, accounts=True)
    fluid.advance(dt := 0.2 * fluid.limits().acoustic)
    while fluid.time < 2.0:
        fluid.advance(dt)
    before, unreal = fluid.work["walls"], 0.0
    while fluid.time < 3.0:
        impulse, y = fluid.impulse["walls"][1], fluid.particles.position.to_numpy()[:, 1]
        returned = fluid.particles.velocity.to_numpy()[y < y.min() + 1e-6, 1].mean()
        fluid.advance(dt)
        unreal += returned * (fluid.impulse["walls"][1] - impulse)
    assert unreal > 0.0
    assert abs(fluid.work["walls"] - before) < unreal / 60.0


def still(viscosity, duration):
    """What `check` warns of in a slice of still water."""
    basin = {"length": 3.0, "depth": 0.5, "walls": "periodic"}
    fluid = {"kind": "mueller", "spacing": 0.05, "kinematic_viscosity": viscosity}
    scene = load({"duration": duration, "basin": basin, "fluid": fluid})
    return [sentence for sentence in scene.fluid.warnings(scene.preflight) if "boils" in sentence]


def test_check_warns_of_a_viscosity_with_which_still_water_boils():
    """Under the rim of a calm patch it moved at 1.6 m/s rms after 5 s with half of what keeps it from it, at 0.09 m/s
    with all of it."""
    (told,) = still(0.002, 5.0)
    assert "below a viscosity of about 0.004 m2/s" in told
    assert still(0.004, 5.0) == still(0.0, 1.0) == []
