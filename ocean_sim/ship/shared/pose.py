"""A rigid body as a row of numbers: how kernels are handed where it is and how it moves."""

import numpy as np

from ocean_sim.columns import Columns
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import Template
from ocean_sim.ship.shared.rigid_body import RigidBody

POSE = {"position": 3, "turn": 9, "velocity": 3, "spin": 3}  # [m], body to world, [m/s], [rad/s], world axes
pose = Columns(**POSE)


def write_pose(row: np.ndarray, body: RigidBody) -> None:
    """Write a body into the first numbers of a row."""
    across, up, ahead = body.rows
    row[: pose.size] = *body.position.tolist(), *across, *up, *ahead, *body.velocity.tolist(), *body.spin


@ti.func
def vector(table: Template, first: Template):
    """Three numbers of the first row of a table."""
    return ti.cast(tm.vec3(table[0, first], table[0, first + 1], table[0, first + 2]), float)


@ti.func
def turned(table: Template):
    """The matrix in the first row of a table, from body to world axes."""
    return ti.Matrix.rows([vector(table, pose.turn), vector(table, pose.turn + 3), vector(table, pose.turn + 6)])
