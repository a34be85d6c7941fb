"""Axes and signs, one at a time: ours (X port, Y up, Z bow), SNAME/NED and ISO 8855/FLU."""

import numpy as np
import pytest

from ocean_sim.conventions import FRAMES, from_frame, to_frame

PORT, UP, BOW = np.eye(3)
AXES = {
    "ned": {"bow": (BOW, [1, 0, 0]), "starboard": (-PORT, [0, 1, 0]), "down": (-UP, [0, 0, 1])},
    "flu": {"bow": (BOW, [1, 0, 0]), "port": (PORT, [0, 1, 0]), "up": (UP, [0, 0, 1])},
}
ROTATIONS = {  # about our axes: pitch lowers the bow, yaw turns it to port, roll lifts the port side
    "ned": {"bow down": (PORT, [0, -1, 0]), "to port": (UP, [0, 0, -1]), "starboard down": (BOW, [1, 0, 0])},
    "flu": {"bow down": (PORT, [0, 1, 0]), "to port": (UP, [0, 0, 1]), "starboard down": (BOW, [1, 0, 0])},
}


@pytest.mark.parametrize("table", [AXES, ROTATIONS])
@pytest.mark.parametrize("frame", ["ned", "flu"])
def test_every_axis_by_itself(frame, table):
    for ours, theirs in table[frame].values():
        np.testing.assert_array_equal(to_frame(frame, ours), theirs)
        np.testing.assert_array_equal(from_frame(frame, np.array(theirs, dtype=float)), ours)


@pytest.mark.parametrize("frame", FRAMES)
def test_frames_are_right_handed(frame):
    assert np.linalg.det(FRAMES[frame]) == pytest.approx(1.0)
    v = np.random.default_rng(1).normal(size=(5, 3))
    np.testing.assert_allclose(from_frame(frame, to_frame(frame, v)), v)


def test_a_worked_specific_force():
    """The same vector in NED, FLU and our axes."""
    ned = np.array([-0.187498, -0.991343, -8.237563])
    ours = from_frame("ned", ned)
    np.testing.assert_allclose(ours, [0.991343, 8.237563, -0.187498])
    np.testing.assert_allclose(to_frame("flu", ours), [-0.187498, 0.991343, 8.237563])
