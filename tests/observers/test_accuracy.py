import numpy as np
import pytest

import ocean_sim
from ocean_sim.conventions import GRAVITY
from ocean_sim.files.csv_file import read_columns
from ocean_sim.observers import accuracy
from tests.conftest import quickly


def test_sums_are_those_of_the_particles(tmp_path, watched):
    simulation = watched((0.013, 0.002))
    particles, fluid = simulation.fluid.particles, simulation.fluid
    particles.density.values[:] = 1000.0
    particles.density.values[0], particles.density.values[1] = 1020.0, 900.0
    simulation.observers = [accuracy.Config().build(tmp_path, simulation)]
    simulation.run(until=0.2)
    table = read_columns(tmp_path / "accuracy.csv")
    n, mass, t = particles.n, particles.mass, table["time_s"]
    np.testing.assert_allclose(table["compression_mean"], 0.02 / n)
    np.testing.assert_allclose(table["compression_max"], 0.02)
    np.testing.assert_allclose(table["surface_deficit_mean"], 0.1 / n)
    np.testing.assert_allclose(table["momentum_x_kg_m_s"], n * mass * t, atol=1e-6)
    np.testing.assert_allclose(table["impulse_wind_x_Ns"], table["momentum_x_kg_m_s"], rtol=1e-8, atol=1e-6)
    np.testing.assert_allclose(table["internal_energy_J"], 3.0 * t, atol=1e-8)
    assert (table["potential_energy_J"] == 0.0).all()
    exact = 0.5 * n * mass * t**2
    assert (
        abs(table["kinetic_energy_J"] - exact).max() <= 0.5 * n * mass * 0.013**2 / 4 * 1.001
    )  # a chord of a parabola
    assert set(table["limited_by"]) == {"acoustic"} and set(table["time_step_s"]) <= {0.013, 0.002}
    assert fluid.impulse.keys() >= {"wind"}


def test_impulses_come_in_one_order_and_only_those_the_fluid_keeps(tmp_path, watched):
    simulation = watched()
    accuracy.Config().build(tmp_path, simulation).close()
    names = [name for name in read_columns(tmp_path / "accuracy.csv") if name.startswith("impulse") and "_x_" in name]
    assert names == [f"impulse_{term}_x_Ns" for term in ("pressure", "viscosity", "wind", "gravity", "walls")]


def test_rising_water_gains_potential_energy(tmp_path, watched):
    simulation = watched()
    observer = accuracy.Config().build(tmp_path, simulation)
    particles = simulation.fluid.particles
    particles.position.values[:, 1] += 0.1
    observer.observe(simulation)
    observer.close()
    gained = read_columns(tmp_path / "accuracy.csv")["potential_energy_J"]
    np.testing.assert_allclose(gained, particles.n * particles.mass * 9.81 * 0.1, rtol=1e-8)


def test_a_body_that_turns_has_the_angular_momentum_of_its_inertia(tmp_path, watched):
    simulation = watched()
    particles, spin = simulation.fluid.particles, np.array([0.3, -0.7, 1.1])
    x = particles.position.values
    particles.velocity.values[:] = np.cross(spin, x)
    observer = accuracy.Config().build(tmp_path, simulation)
    observer.observe(simulation)
    observer.close()
    table = read_columns(tmp_path / "accuracy.csv")
    inertia = particles.mass * (np.square(x).sum() * np.eye(3) - x.T @ x)
    got = [table[f"angular_momentum_{axis}_kg_m2_s"][0] for axis in "xyz"]
    np.testing.assert_allclose(got, inertia @ spin, rtol=1e-8)
    assert table["kinetic_energy_J"][0] == pytest.approx(0.5 * spin @ inertia @ spin, rel=1e-8)


def test_work_comes_in_one_order_and_the_residual_is_what_nobody_gave(tmp_path, watched):
    simulation = watched()
    fluid, observer = simulation.fluid, accuracy.Config(every=0.1).build(tmp_path, simulation)
    observer.observe(simulation)
    simulation.time = fluid.time = 0.1
    fluid.particles.velocity.values[:, 0] = 2.0
    kinetic = 2.0 * fluid.particles.n * fluid.particles.mass
    fluid.work |= {"wind": kinetic, "walls": -7.0, "viscosity": -5.0, "pressure": -900.0, "gravity": 400.0}
    observer.observe(simulation)
    observer.close()
    table = read_columns(tmp_path / "accuracy.csv")
    assert [name for name in table if name.startswith("work")] == [
        f"work_{term}_J" for term in ("pressure", "viscosity", "wind", "gravity", "walls")
    ]
    assert table["energy_residual_J"][0] == 0.0
    assert table["energy_residual_J"][1] == pytest.approx(3.0 * 0.1 + 12.0, rel=1e-6)


def test_particles_outside_are_counted(tmp_path, watched):
    simulation = watched(walls={"x_min": "none"})
    observer = accuracy.Config().build(tmp_path, simulation)
    position = simulation.fluid.particles.position.values
    position[:3] = [[-9.0, -1.0, 0.0], [3.01, -1.0, 0.0], [0.0, -2.5, 0.0]]
    observer.observe(simulation)
    observer.close()
    assert read_columns(tmp_path / "accuracy.csv")["outside"] == [2.0]


def test_of_water_without_particles_there_is_only_the_time_step(tmp_path):
    basin = {"length": 20.0, "width": 20.0, "depth": 10.0}
    scene = ocean_sim.load(
        {"duration": 0.2, "basin": basin, "fluid": {"kind": "linear_waves", "height": 0.5, "period": 4.0}}
    )
    with ocean_sim.Simulation(scene) as simulation:
        simulation.observers = [accuracy.Config().build(tmp_path, simulation)]
        simulation.run(until=0.2)
    table = read_columns(tmp_path / "accuracy.csv")
    assert list(table) == ["time_s", "time_step_s", "limited_by"] and len(table["time_s"]) >= 2


def energies(tmp_path, fluid, **scene):
    """accuracy.csv of half a second in a small basin."""
    data = {
        "duration": 0.5,
        "basin": {"length": 1.0, "width": 0.6, "depth": 0.5},
        "fluid": {"spacing": 0.1} | fluid,
        "runtime": {"precision": "f64", "threads": 1},
        "time_step": {"kind": "fixed", "dt": 0.002},
        **dict.fromkeys(("frames", "render", "report")),
    }
    return ocean_sim.run(ocean_sim.load(data | scene), tmp_path).accuracy


def test_falling_bouncing_and_driven_particles_close_their_energy(tmp_path):
    basin = {"length": 1.0, "width": 0.6, "depth": 0.5, "restitution": 0.5, "friction": 0.3}
    fluid = {"kind": "ballistic", "body_force": [3.0, 0.0, 0.0]}
    fluid |= {"fill": [{"min": [-0.3, -0.3, -0.3], "max": [0.3, 0.0, 0.3]}]}
    table = energies(tmp_path, fluid, basin=basin)
    assert table["kinetic_energy_J"].max() > 50.0 and table["work_walls_J"][-1] < -10.0
    np.testing.assert_allclose(table["energy_residual_J"], 0.0, atol=1e-6)
    assert not table["outside"].any()


def test_what_a_piston_gives_is_the_work_of_walls(tmp_path):
    """Over 20 layers within 4 % (half of the 6 % of 10 layers)."""
    basin = {"length": 1.0, "depth": 0.2, "wavemaker": {"kind": "solitary", "height": 0.04}}
    fluid = {"kind": "delta_sph", "spacing": 0.01, "kinematic_viscosity": 1e-6}
    table = energies(tmp_path, fluid, basin=basin, duration=0.8, time_step={"kind": "fixed", "dt": 0.0005})
    assert table["work_walls_J"][-1] > 2.0
    assert np.abs(table["energy_residual_J"][-1]) < 0.04 * table["work_walls_J"][-1]


def test_a_collapsing_column_loses_little_energy_that_nothing_took(tmp_path):
    fluid = {"kind": "delta_sph", "compression": 0.02, "kinematic_viscosity": 0.01}
    fluid |= {"fill": [{"min": [-0.5, -0.5, -0.3], "max": [0.0, 0.0, 0.3]}]}
    table = energies(tmp_path, fluid, duration=0.3, time_step={"kind": "fixed", "dt": 0.0005})
    fallen = -table["potential_energy_J"][-1]
    assert fallen > 100.0
    assert np.abs(table["energy_residual_J"]).max() < 0.15 * fallen
    given = table["work_walls_J"] + table["work_viscosity_J"] + table["work_diffusion_J"]
    assert np.abs(table["energy_residual_J"] + given).max() > 0.15 * fallen  # without the work it does not close


SLICE = {"length": 2.0, "width": None, "depth": 0.5}
STILL = {"basin": SLICE}
PATCH = {"basin": SLICE | {"walls": "periodic"}, "sea": {"kind": "linear_waves", "height": 0.1, "period": 1.14}}
COLUMN = {"basin": SLICE, "fluid": {"fill": [{"min": [-1.0, -0.5], "max": [-0.2, 0.0]}]}}


@pytest.mark.parametrize("scene", quickly(STILL, PATCH, COLUMN))
def test_incompressible_water_closes_its_energy(tmp_path, scene):
    """Weight times the way g dt / 2 that water falls in a step before its pressure holds it is nobody's work: work is
    counted at the mean velocity of the whole step."""
    dt = 0.005
    fluid = {"kind": "dfsph"} | scene.get("fluid", {})
    table = energies(tmp_path, **scene | {"fluid": fluid}, time_step={"kind": "fixed", "dt": dt})
    mass = 1000.0 * (0.4 if scene is COLUMN else 1.0)
    falls = 0.5 * mass * GRAVITY**2 * dt * table["time_s"][-1]
    assert np.abs(table["energy_residual_J"]).max() < 0.1 * falls  # half a step of the momentum times g stays
    if scene is STILL:
        for term in ("gravity", "pressure", "walls"):
            assert np.abs(table[f"work_{term}_J"]).max() < 0.05 * falls


def test_a_scheme_that_iterates_tells_how_its_solvers_fared(tmp_path):
    scene = {
        "duration": 0.06,
        "basin": {"length": 0.4, "depth": 0.2},
        "fluid": {"kind": "dfsph", "spacing": 0.05, "max_divergence_iterations": 1},
        "accuracy": {"every": 0.02},
        "frames": None,
        "render": None,
        "report": None,
        "runtime": {"threads": 1},
    }
    ocean_sim.run(ocean_sim.load(scene), out=tmp_path)
    table = read_columns(tmp_path / "accuracy.csv")
    for solver in ("density", "divergence"):
        total, last = table[f"{solver}_iterations"], table[f"{solver}_iterations_last"]
        assert (np.diff(total) >= 0).all() and (total >= last).all()
        assert (table[f"{solver}_error_max"] >= table[f"{solver}_error_last"]).all()
    assert table["divergence_unsolved"][-1] > 0 and table["divergence_iterations_last"].max() == 1
    assert table["density_unsolved"][-1] == 0
