"""The rigid body: its algebra against scipy's Rotation, its step against the torque-free top of Jacobi and Euler."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from scipy.special import ellipj, ellipk

from ocean_sim.ship.body import rigid_body as rigid
from ocean_sim.ship.body import small_linalg, track

NUMBER = st.floats(-3.0, 3.0, allow_nan=False)
TURN = st.tuples(NUMBER, NUMBER, NUMBER).map(np.array)
UNIT = st.tuples(*[st.floats(-1.0, 1.0)] * 4).map(np.array).filter(lambda q: q @ q > 1e-2).map(rigid.unit_quaternion)


def scipys(q: np.ndarray) -> Rotation:
    return Rotation.from_quat(q, scalar_first=True)


@settings(max_examples=50, deadline=None)
@given(UNIT, UNIT, UNIT, TURN)
def test_the_algebra_agrees_with_scipy(p, q, s, v):
    """(4.1) to (4.10)."""
    np.testing.assert_allclose(rigid.rotation_matrix(p), scipys(p).as_matrix(), atol=1e-12)
    np.testing.assert_allclose(rigid.rotate_vector(p, v), scipys(p).apply(v), atol=1e-12)
    np.testing.assert_allclose(
        rigid.rotation_matrix(rigid.quaternion_product(p, q)), (scipys(p) * scipys(q)).as_matrix(), atol=1e-12
    )
    np.testing.assert_allclose(
        rigid.quaternion_product(rigid.quaternion_product(p, q), s),
        rigid.quaternion_product(p, rigid.quaternion_product(q, s)),
        atol=1e-12,
    )
    np.testing.assert_allclose(rigid.quaternion_product(p, rigid.quaternion_inverse(p)), [1, 0, 0, 0], atol=1e-12)
    np.testing.assert_allclose(
        rigid.rotation_matrix(rigid.turn_quaternion(v)), Rotation.from_rotvec(v).as_matrix(), atol=1e-12
    )
    np.testing.assert_allclose(rigid.rotation_matrix(2.5 * p), rigid.rotation_matrix(p), atol=1e-12)
    assert np.linalg.det(rigid.rotation_matrix(p)) == pytest.approx(1.0)


@settings(max_examples=20, deadline=None)
@given(UNIT, TURN, TURN)
def test_a_body_that_passes_a_place_turns_as_its_momentum_says(q, velocity, omega):
    """And many at once as each alone."""
    body = rigid.with_spin(rigid.RigidBody(3.0, np.diag([2.0, 3.0, 4.0]), np.zeros(3), q, velocity, np.zeros(3)), omega)
    spins = np.column_stack([omega, -2.0 * omega])
    orientations = np.column_stack([q, body.orientation])
    changes = track.first_derivative(np.column_stack([velocity, velocity]), spins, orientations)
    places = np.concatenate([np.zeros((3, 2)), 1.7 * orientations])  # of any length
    found = track.attitude_of(track.Track(np.zeros(2), places, changes * np.repeat([1.0, 1.7], [3, 4])[:, None]))
    np.testing.assert_allclose(found.spin, spins, atol=1e-12)
    np.testing.assert_allclose(found.orientation[:, 0], q, atol=1e-12)
    np.testing.assert_allclose(found.matrix[..., 1], body.matrix, atol=1e-12)
    np.testing.assert_allclose(found.to_body(found.spin)[:, 0], body.rates, atol=1e-12)
    np.testing.assert_array_equal(rigid.euler_angles(orientations)[:, 0], rigid.euler_angles(q))
    np.testing.assert_array_equal(
        rigid.quaternion_product(places[3:], orientations)[:, 1], rigid.quaternion_product(places[3:, 1], q)
    )


@settings(max_examples=50, deadline=None)
@given(st.floats(-1.5, 1.5), st.floats(-3.1, 3.1), st.floats(-3.1, 3.1))
def test_angles_are_yaw_then_pitch_then_roll_about_the_turned_axes(pitch, yaw, roll):
    q = rigid.euler_quaternion(pitch, yaw, roll)
    expected = Rotation.from_euler("YXZ", [yaw, pitch, roll]).as_matrix()
    np.testing.assert_allclose(rigid.rotation_matrix(q), expected, atol=1e-12)
    np.testing.assert_allclose(rigid.euler_angles(q), [pitch, yaw, roll], atol=1e-9)


def test_a_small_turn_has_its_rate():
    """(4.13), (4.14): the quaternion's rate against a finite difference."""
    omega, q, h = np.array([0.3, -0.2, 0.5]), rigid.euler_quaternion(0.2, 0.4, -0.1), 1e-6
    rate = (rigid.quaternion_product(rigid.turn_quaternion(omega * h), q) - q) / h
    np.testing.assert_allclose(rate, 0.5 * rigid.quaternion_product(np.append(0.0, omega), q), atol=1e-6)
    np.testing.assert_allclose(2.0 * rigid.quaternion_product(rate, rigid.quaternion_inverse(q))[1:], omega, atol=1e-6)


def top(omega, inertia=(1.0, 2.0, 3.0)) -> rigid.RigidBody:
    """A body about its centre of mass, its axes along the world's, with an angular velocity [rad/s]."""
    zero = np.zeros(3)
    body = rigid.RigidBody(1.0, np.diag(inertia), zero, np.array([1.0, 0.0, 0.0, 0.0]), zero, zero)
    return rigid.with_spin(body, np.array(omega, dtype=float))


def turned(body, seconds, dt=1.0 / 60.0, step=rigid.advance_body):
    for _ in range(round(seconds / dt)):
        body = step(body, np.zeros(3), np.zeros(3), dt)
    return body


def apart(p, q) -> float:
    """Angle between two orientations [degrees]."""
    return 2.0 * np.degrees(np.arccos(min(1.0, abs(float(p @ q)))))


# R1: quaternion and body rates at 10 and 60 s by DOP853 at a tolerance of 1e-13, of I = (1, 2, 3), omega = (1, 0, 1).
R1 = {
    10.0: ((0.86144117, 0.10734076, 0.22094732, -0.44449898), (-0.92107, 0.38939704, 0.97440066)),
    60.0: ((-0.84949542, 0.21516101, -0.09205273, -0.47285259), (-0.54375342, -0.83924503, 0.87477002)),
}


@pytest.mark.parametrize("seconds", R1)
def test_a_torque_free_top_turns_as_by_elliptic_functions(seconds):
    start = top((1.0, 0.0, 1.0))
    end = turned(start, seconds)
    orientation, rates = R1[seconds]
    assert apart(end.orientation, np.array(orientation)) < 0.5
    np.testing.assert_allclose(end.rates, rates, atol=0.01)
    assert end.kinetic_energy() == pytest.approx(start.kinetic_energy(), rel=1e-4)
    np.testing.assert_allclose(end.angular_momentum, start.angular_momentum, rtol=1e-9)


def test_the_thesis_step_loses_a_quarter_of_the_energy_of_the_same_top():
    start = top((1.0, 0.0, 1.0))
    end = turned(start, 60.0, step=rigid.thesis_advance)
    assert end.kinetic_energy() / start.kinetic_energy() - 1.0 == pytest.approx(-0.2412, abs=0.002)
    assert apart(end.orientation, np.array(R1[60.0][0])) == pytest.approx(67.77, abs=0.5)


def test_the_step_is_of_second_order():
    exact = np.array(R1[10.0][0])
    errors = [apart(turned(top((1.0, 0.0, 1.0)), 10.0, dt).orientation, exact) for dt in (0.04, 0.02)]
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.15)


@pytest.mark.parametrize("tilt", [0.1, 0.01])
def test_spin_about_the_middle_axis_flips_when_it_should(tilt):
    """R2, Dzhanibekov: omega_2 passes through zero at a quarter of the period 4 K(m) / p."""
    p = np.sqrt((3.0 - 2.0) * ((4.0 + 9.0 * tilt**2) - (2.0 + 3.0 * tilt**2)) / 6.0)
    m = (2.0 - 1.0) * (3.0 * (2.0 + 3.0 * tilt**2) - (4.0 + 9.0 * tilt**2)) / (6.0 * p**2)
    flip = ellipk(m) / p * 2.0
    assert flip == pytest.approx({0.1: 10.821061, 0.01: 18.851036}[tilt], rel=1e-5)
    body, dt, crossings, before = top((0.0, 1.0, tilt)), 1.0 / 60.0, [], 1.0
    for k in range(round(60.0 / dt)):
        body = turned(body, dt)
        now = body.rates[1]
        if before * now < 0.0:
            crossings.append((k + before / (before - now)) * dt)
        before = now
    np.testing.assert_allclose(crossings, flip * (0.5 + np.arange(len(crossings))), rtol=2e-3)
    assert len(crossings) >= 3
    assert body.kinetic_energy() == pytest.approx(top((0.0, 1.0, tilt)).kinetic_energy(), rel=1e-4)
    assert ellipj(0.0, m)[1] == 1.0


def test_a_symmetric_top_precesses_steadily():
    """R3: I = (1, 1, 2), omega = (0.5, 0, 3): body rate 3 rad/s, space rate |L| / A = 6.020797 rad/s."""
    start = top((0.5, 0.0, 3.0), (1.0, 1.0, 2.0))
    assert np.linalg.norm(start.angular_momentum) == pytest.approx(6.020797, rel=1e-6)
    seconds, dt = 1.0, 1.0 / 240.0
    end = turned(start, seconds, dt)
    phase = np.arctan2(end.rates[1], end.rates[0])
    assert np.cos(phase - 3.0 * seconds) == pytest.approx(1.0, abs=1e-4)
    axis = Rotation.from_rotvec(start.angular_momentum * seconds).apply([0.0, 0.0, 1.0])
    assert np.degrees(np.arccos(axis @ end.matrix[:, 2])) < 0.2


def test_the_quaternion_stays_of_length_one_where_4_24_grows():
    """R4: 60 s at 1 rad/s; (4.24) grows by sqrt(1 + (omega dt / 2)^2) a step."""
    end = turned(top((0.0, 0.0, 1.0)), 60.0)
    assert np.linalg.norm(end.orientation) == pytest.approx(1.0, abs=1e-14)
    assert apart(end.orientation, rigid.turn_quaternion(np.array([0.0, 0.0, 60.0]))) < 1e-6
    q, dt = np.array([1.0, 0.0, 0.0, 0.0]), 1.0 / 60.0
    for _ in range(3600):
        q = q + 0.5 * dt * rigid.quaternion_product(np.array([0.0, 0.0, 0.0, 1.0]), q)
    assert np.linalg.norm(q) == pytest.approx(1.13314, abs=1e-4)


def test_a_thrown_body_is_half_g_dt_t_beside_the_parabola():
    """R5: the semi-implicit step is ahead by g dt t / 2, the thesis's behind by as much."""
    dt, g, n = 1.0 / 60.0, 9.81, 60
    for step, side in ((rigid.advance_body, -1.0), (rigid.thesis_advance, 1.0)):
        body = replace(top((0.0, 0.0, 0.0)), velocity=np.array([1.0, 2.0, 3.0]))
        for _ in range(n):
            body = step(body, np.array([0.0, -g, 0.0]), np.zeros(3), dt)
        t = n * dt
        exact = np.array([t, 2.0 * t - 0.5 * g * t**2, 3.0 * t])
        np.testing.assert_allclose(body.position - exact, [0.0, side * 0.5 * g * dt * t, 0.0], atol=1e-12)


def test_an_oscillator_neither_grows_nor_dies_but_under_forward_euler():
    """60 s of a heave at 1.445 rad/s: the thesis's amplitude grows to 2.840."""
    omega2, dt = 1.445**2, 1.0 / 60.0
    amplitude = {}
    for step in (rigid.advance_body, rigid.thesis_advance):
        body = replace(top((0.0, 0.0, 0.0)), position=np.array([0.0, 1.0, 0.0]))
        heights = []
        for _ in range(3600):
            body = step(body, -omega2 * body.position, np.zeros(3), dt)
            heights.append(np.hypot(body.position[1], body.velocity[1] / 1.445))
        amplitude[step.__name__] = heights[-1]
    assert amplitude["advance_body"] == pytest.approx(1.0, abs=0.015)
    assert amplitude["thesis_advance"] == pytest.approx(2.840, abs=0.01)


def test_what_is_not_free_does_not_move():
    body = rigid.with_spin(
        replace(top((0, 0, 0)), velocity=np.ones(3), orientation=rigid.euler_quaternion(0.1, 0.5, 0.2)), np.ones(3)
    )
    only_heave = rigid.hold_motions(body, np.array([False, True, False, False, False, False]))
    np.testing.assert_allclose(only_heave.velocity, [0.0, 1.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(only_heave.angular_velocity, np.zeros(3), atol=1e-12)
    assert rigid.hold_motions(body, np.ones(6, dtype=bool)) is body


def test_motions_that_are_held_do_not_creep_however_long_the_step():
    """Under a torque and a push from all sides only surge and pitch take place, each as if it were alone."""
    body = rigid.RigidBody(
        2.0, np.diag([1.0, 2.0, 3.0]), np.zeros(3), rigid.euler_quaternion(0.1, 0.5, 0.0), np.zeros(3), np.zeros(3)
    )
    free, first = np.array([False, False, True, True, False, False]), body.position
    heading = rigid.axis_rotation(1, 0.5)
    start, own = body.matrix, body
    for _ in range(50):
        free_body = rigid.advance_body(own, heading @ [3.0, 5.0, 2.0], own.matrix @ [0.2, 4.0, -7.0], 0.1)
        own = rigid.guide_step(own, free_body, free, 0.1)
    moved = heading.T @ (own.position - first)
    np.testing.assert_allclose(moved[:2], 0.0, atol=1e-12)
    assert moved[2] > 5.0
    turned = Rotation.from_matrix(start.T @ own.matrix).as_rotvec()
    np.testing.assert_allclose(turned[1:], 0.0, atol=1e-9)
    assert abs(turned[0]) > 0.5


@pytest.mark.parametrize("held", [0, 1, 2])
def test_two_turns_together_leave_the_angle_that_is_held(held):
    """Turns by 0.2 rad about two axes, a quarter of a period apart, turn a body about the third by some degrees."""
    body = rigid.RigidBody(2.0, np.eye(3), np.zeros(3), rigid.euler_quaternion(0.1, 3.1, 0.2), np.zeros(3), np.zeros(3))
    free, first, wildest = np.array([True] * 3 + [k != held for k in range(3)]), body.angles, 0.0
    for t in np.arange(0.0, 60.0, 0.05):
        rates = 0.2 * np.cos(t) * free[3:]
        rates[(held + 1) % 3] = 0.2 * np.sin(t)
        body = rigid.guide_step(body, rigid.with_spin(body, body.matrix @ rates), free, 0.05)
        wildest = max(wildest, np.abs(np.sin(body.angles - first)).max())
    assert body.angles[held] == pytest.approx(first[held], abs=1e-9)
    assert wildest > 0.1


def test_a_small_system_is_solved_as_numpy_does():
    random = np.random.default_rng(5)
    for _ in range(20):
        m = random.normal(size=(3, 3))
        m, b = m @ m.T + 0.1 * np.eye(3), random.normal(size=3)
        np.testing.assert_allclose(
            small_linalg.solve_3x3(m.tolist(), b.tolist()), np.linalg.solve(m, b), rtol=1e-9, atol=1e-12
        )
