"""The highest particle of every column, against a search column by column."""

import numpy as np

from ocean_sim.observers.accuracy import highest_particles, surface_fit
from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation

SEA = {
    "basin": {"length": 7.0, "width": 5.0, "depth": 2.0},
    "fluid": {"kind": "mueller", "spacing": 0.5, "kinematic_viscosity": 0.5},
    "surface": {"kind": "cloth", "spacing": 1.0},
    "runtime": {"threads": 1},
    **dict.fromkeys(("render", "report", "frames", "accuracy", "timings")),
}


def test_the_surface_is_compared_with_the_highest_of_each_column():
    with Simulation(load(SEA)) as simulation:
        particles, surface = simulation.fluid.particles, simulation.surface
        x = particles.position.to_numpy() + np.random.default_rng(4).uniform(-0.3, 0.3, (particles.n, 3))
        x[:40, [0, 2]] += 20.0  # far outside: they belong to the nearest column
        particles.position.from_numpy(x)
        x = particles.position.to_numpy().astype(float)
        count = np.array([7, 5])  # columns of two spacings
        column = np.clip(((x[:, [0, 2]] + [3.5, 2.5]) / [7.0, 5.0] * count).astype(int), 0, count - 1) @ [5, 1]
        top = [max(np.flatnonzero(column == c), key=lambda i: x[i, 1]) for c in sorted(set(column.tolist()))]
        away = surface.elevations(x[top][:, [0, 2]]) - (x[top, 1] + 0.25)
        offset, fit = surface_fit(surface, highest_particles(simulation.basin, simulation.fluid))
        np.testing.assert_allclose([offset, fit], [away.mean(), np.sqrt((away**2).mean())], rtol=1e-6)
