"""The room that a hull takes: its outline seen from above, as a convex polygon."""

import numpy as np

from ocean_sim.ship import Outline
from ocean_sim.ship.shared.rigid_body import RigidBody


def extreme(vertices: np.ndarray) -> np.ndarray:
    """(m, 3) those of (n, 3) points that are corners of their convex hull."""
    from scipy.spatial import ConvexHull

    return vertices[ConvexHull(vertices).vertices]


def outline(corners: np.ndarray, body: RigidBody) -> Outline:
    """The room of a hull with (m, 3) corners from its centre of mass, body axes [m], where its body is."""
    from scipy.spatial import ConvexHull

    at = np.einsum("ij,kj->ik", corners, body.matrix) + body.position
    plan = at[:, [0, 2]]
    return Outline(plan[ConvexHull(plan).vertices], float(at[:, 1].min()), float(at[:, 1].max()))
