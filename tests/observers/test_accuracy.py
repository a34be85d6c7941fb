import numpy as np

from ocean_sim.observers import accuracy
from ocean_sim.observers._csv import columns


def test_sums_are_those_of_the_particles(tmp_path, watched):
    simulation = watched((0.013, 0.002))
    particles, fluid = simulation.fluid.particles, simulation.fluid
    particles.density.values[:] = 1000.0
    particles.density.values[0], particles.density.values[1] = 1020.0, 900.0
    simulation.observers = [accuracy.Config().build(tmp_path, simulation)]
    simulation.run(until=0.2)
    table = columns(tmp_path / "accuracy.csv")
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
    names = [name for name in columns(tmp_path / "accuracy.csv") if name.startswith("impulse") and "_x_" in name]
    assert names == [f"impulse_{term}_x_Ns" for term in ("pressure", "viscosity", "wind", "gravity", "walls")]


def test_rising_water_gains_potential_energy(tmp_path, watched):
    simulation = watched()
    observer = accuracy.Config().build(tmp_path, simulation)
    particles = simulation.fluid.particles
    particles.position.values[:, 1] += 0.1
    observer.observe(simulation)
    observer.close()
    gained = columns(tmp_path / "accuracy.csv")["potential_energy_J"]
    np.testing.assert_allclose(gained, particles.n * particles.mass * 9.81 * 0.1, rtol=1e-8)
