import numpy as np
import pytest
from pydantic import ValidationError

from ocean_sim.parts import preset
from ocean_sim.platform.shared.kinematics import Geometry, Hexapod, rotation_matrices
from tests.platform.conftest import DATA

INCH = 0.0254
HEX_A = preset("geometry", "hexapod_a")


def hexapod(name):
    return Hexapod(Geometry.model_validate(preset("geometry", name)))


@pytest.fixture(scope="module")
def hex_a():
    return hexapod("hexapod_a")


def inside(machine, count, seed=3, part=1.0):
    """Random poses within the stroke, or within a part of it."""
    ends = part * machine.excursions()
    pose = np.random.default_rng(seed).uniform(ends[:, 0], ends[:, 1], (60 * count, 6))
    return pose[machine.is_allowed(pose)][:count]


def test_inverse_kinematics_and_condition_numbers_of_a_known_hexapod(hex_a):
    table = np.genfromtxt(DATA / "hexapod_a_ik.csv", delimiter=",", skip_header=3)
    pose = np.hstack([table[:, :3], np.radians(table[:, 3:6])])
    np.testing.assert_allclose(hex_a.legs(pose), table[:, 6:12], rtol=0.0, atol=1e-6)
    np.testing.assert_allclose(hex_a.condition(pose), table[:, 12], rtol=0.0, atol=1e-3)
    assert hex_a.is_allowed(pose)[:8].all()  # the last uses the buffer
    assert hex_a.neutral_height == pytest.approx(2.389904, abs=1e-6)


def test_inverse_kinematics_of_linuxcnc():
    """The lengths that genhexkins gives for its own default joints, in inches."""
    machine = hexapod("linuxcnc")
    pose = np.array([[0.0, 0.0, 20.0, 0.0, 0.0, 0.0], [1.0, -2.0, 21.0, 5.0, -4.0, 10.0]])
    pose = np.hstack([pose[:, :3] * INCH, np.radians(pose[:, 3:])]) - [0, 0, machine.neutral_height, 0, 0, 0]
    expected = [
        [29.746680, 29.746680, 29.746715, 29.746363, 29.746363, 29.746715],
        [30.583984, 32.120805, 30.044885, 31.025596, 26.634849, 32.907007],
    ]
    np.testing.assert_allclose(machine.legs(pose) / INCH, expected, rtol=0.0, atol=1e-6)


@pytest.mark.parametrize("name, part", [("hexapod_a", 1.0), ("linuxcnc", 0.5)])
def test_forward_after_inverse_is_the_same_pose(name, part):
    """From neutral. LinuxCNC's turns so far that beyond half of that another pose with the same legs is nearer."""
    machine = hexapod(name)
    pose = inside(machine, 1000, part=part)
    assert len(pose) == 1000
    np.testing.assert_allclose(machine.pose(machine.legs(pose)), pose, rtol=0.0, atol=1e-10)


def test_legs_that_reach_no_pose_have_none(hex_a):
    assert np.isnan(hex_a.pose(np.array([[2.1, 9.0, 2.1, 2.1, 2.1, 2.1]]))).all()


def test_the_jacobian_is_the_slope_of_the_leg_lengths(hex_a):
    """And the one with the arm turned twice is not: a mistake that another program made."""
    pose = inside(hex_a, 20)
    jacobian, step = hex_a.jacobian(pose), 1e-6
    for k in range(3):
        moved = pose.copy()
        moved[:, k] += step
        np.testing.assert_allclose((hex_a.legs(moved) - hex_a.legs(pose)) / step, jacobian[:, :, k], atol=1e-5)
    from scipy.spatial.transform import Rotation

    spin = np.array([0.3, -0.2, 0.5])
    turned = Rotation.from_rotvec(step * spin) * Rotation.from_matrix(rotation_matrices(pose[:, 3:]))
    moved = np.hstack([pose[:, :3], turned.as_euler("ZYX")[:, ::-1]])
    slope = (hex_a.legs(moved) - hex_a.legs(pose)) / step
    np.testing.assert_allclose(slope, jacobian[:, :, 3:] @ spin, atol=1e-5)
    leg, arm = hex_a.leg_vectors(pose)
    along = leg / np.linalg.norm(leg, axis=2, keepdims=True)
    twice = np.cross(arm @ np.swapaxes(rotation_matrices(pose[:, 3:]), 1, 2), along)
    assert np.abs(slope - twice @ spin).max() > 1e-2


def test_the_workspace_of_a_known_hexapod(hex_a):
    ends = hex_a.excursions()
    metres = [[-1.260, 0.981], [-1.031, 1.031], [-0.678, 0.636]]
    degrees = [[-25.93, 25.93], [-23.72, 24.29], [-41.58, 41.58]]
    np.testing.assert_allclose(ends[:3], metres, rtol=0.0, atol=1e-3)
    np.testing.assert_allclose(np.degrees(ends[3:]), degrees, rtol=0.0, atol=0.05)


def test_a_quarter_turn_is_singular_and_refused(hex_a):
    pose = np.zeros((4, 6))
    pose[:, 5] = np.radians([40.0, 60.0, 80.0, 90.0])
    condition = hex_a.condition(pose)
    np.testing.assert_allclose(condition[:3], [3.20, 4.80, 14.9], rtol=5e-3)
    assert condition[3] > 1e9 and not hex_a.is_allowed(pose)[2:].any()


@pytest.mark.parametrize(
    "wrong, sentence",
    [
        ({"shortest": 0.2, "longest": 0.4}, "legs of 0.3 m, half way out, do not reach the platform"),
        ({"shortest": 3.4}, "leaves no travel"),
        ({"shortest": 2.70, "longest": 2.71, "buffer": 0.02}, "leaves no travel"),
        ({"base": [[3.6, 0.3, 0.0], *HEX_A["base"][1:]]}, "in neutral leg 1 is 3.* m long, outside 2.131 to 3.281 m"),
    ],
)
def test_a_geometry_that_cannot_be_assembled_is_refused(wrong, sentence):
    with pytest.raises(ValidationError, match=sentence):
        Geometry.model_validate(preset("geometry", "hexapod_a") | wrong)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "wrong, sentence",
    [
        ({"platform": [[0.0, 0.0, 0.0]] * 6}, "all joints of its platform are at the point whose pose is given"),
        ({"platform": [[0.5, 0.0, 0.0]] * 6}, "its neutral pose is singular"),
        ({"platform": [[1e160, 0.0, 0.0], *HEX_A["platform"][1:]]}, "it cannot be assembled"),
    ],
)
def test_a_geometry_of_one_point_or_beyond_all_size_is_refused_without_a_warning(wrong, sentence):
    with pytest.raises(ValidationError, match=sentence):
        Geometry.model_validate(preset("geometry", "hexapod_a") | wrong)


def test_a_geometry_that_is_singular_in_neutral_is_refused():
    """Legs between two like hexagons all stand upright: nothing holds the platform from moving sideways."""
    corners = [[np.cos(a), np.sin(a), 0.0] for a in np.arange(6) * np.pi / 3.0]
    with pytest.raises(ValidationError, match="neutral pose is singular"):
        Geometry.model_validate(preset("geometry", "hexapod_a") | {"base": corners, "platform": corners})
