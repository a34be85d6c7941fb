"""Marching cubes in a run: the water does not feel them, threads do not change them."""

import numpy as np
import pytest

from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation
from tests.surface.spray import spray

SEA = {
    "basin": {"length": 24.0, "width": 20.0, "depth": 5.0},
    "fluid": {"kind": "mueller", "spacing": 1.25, "kinematic_viscosity": 1.0, "compression": 0.008},
    "wind": "noise_only",
    "surface": "marching_cubes",
}
QUIET = dict.fromkeys(("render", "report", "frames", "accuracy", "timings"))


def state(**sets) -> dict[str, np.ndarray]:
    """The water after some steps, and its surface."""
    with Simulation(load(SEA | QUIET, {"runtime.threads": 1, **sets})) as simulation:
        for _ in range(20):
            simulation.step()
        particles, surface = simulation.fluid.particles, simulation.surface
        found = {"position": particles.position.to_numpy(), "velocity": particles.velocity.to_numpy()}
        if surface is not None:
            mesh = surface.mesh()
            found |= {"vertices": mesh.vertices, "triangles": mesh.triangles, "normals": mesh.normals}
            found |= {"spray": spray(surface), "heights": surface.elevations(mesh.vertices[:, [0, 2]])}
        return found


@pytest.fixture(scope="module")
def watched():
    return state()


def test_the_water_moves_bit_for_bit_as_without_a_surface(watched):
    alone = state(surface=None)
    assert all(alone[name].tobytes() == watched[name].tobytes() for name in alone)


def test_two_threads_make_the_same_mesh_as_one(watched):
    other = state(**{"runtime.threads": 2})
    assert len(watched["triangles"]) > 1000
    assert all(other[name].tobytes() == watched[name].tobytes() for name in watched)
