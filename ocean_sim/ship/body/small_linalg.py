"""Vectors, (3, 3) matrices and quaternions of one body as plain numbers.

Python computes with so few numbers several times as quickly as NumPy, and with the same bytes on every processor,
unlike the library behind NumPy's matrix products. A component may also be an array; each column is then one vector.
"""

from collections.abc import Sequence
from math import cos, sin, sqrt

Three = tuple[float, float, float]
Four = tuple[float, float, float, float]  # w, x, y, z
Vector = Sequence[float]
Rows = Sequence[Vector]  # of a matrix


def plus(a: Vector, b: Vector) -> Three:
    (ax, ay, az), (bx, by, bz) = a, b
    return ax + bx, ay + by, az + bz


def minus(a: Vector, b: Vector) -> Three:
    (ax, ay, az), (bx, by, bz) = a, b
    return ax - bx, ay - by, az - bz


def times(factor: float, a: Vector) -> Three:
    x, y, z = a
    return factor * x, factor * y, factor * z


def times_each(factors: Vector, a: Vector) -> Three:
    """Product of each component of a vector with its own factor."""
    (fx, fy, fz), (x, y, z) = factors, a
    return fx * x, fy * y, fz * z


def dot(a: Vector, b: Vector) -> float:
    (ax, ay, az), (bx, by, bz) = a, b
    return ax * bx + ay * by + az * bz


def cross(a: Vector, b: Vector) -> Three:
    (ax, ay, az), (bx, by, bz) = a, b
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


def matrix_times(m: Rows, a: Vector) -> Three:
    (p, q, r), (s, t, u), (v, w, o) = m
    x, y, z = a
    return p * x + q * y + r * z, s * x + t * y + u * z, v * x + w * y + o * z


def transpose_times(m: Rows, a: Vector) -> Three:
    """Product of the transpose of a (3, 3) matrix m and a vector a."""
    (p, q, r), (s, t, u), (v, w, o) = m
    x, y, z = a
    return p * x + s * y + v * z, q * x + t * y + w * z, r * x + u * y + o * z


def solve_3x3(m: Rows, b: Vector) -> Three:
    """The solution x of m x = b, by Cramer's rule."""
    (p, q, r), (s, t, u), (v, w, x) = m
    d, e, f = b
    one, two, three = t * x - u * w, u * v - s * x, s * w - t * v
    other = 1.0 / (p * one + q * two + r * three)
    return (
        other * (d * one + e * (r * w - q * x) + f * (q * u - r * t)),
        other * (d * two + e * (p * x - r * v) + f * (r * s - p * u)),
        other * (d * three + e * (q * v - p * w) + f * (p * t - q * s)),
    )


def quaternion_product(p: Vector, q: Vector) -> Four:
    """Product p q of quaternions (w, x, y, z): the rotation q followed by p (thesis 4.7)."""
    a, b, c, d = p
    e, f, g, h = q
    return (
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g + c * e + d * f - b * h,
        a * h + d * e + b * g - c * f,
    )


def rotation_matrix(q: Vector) -> tuple[Three, Three, Three]:
    """Rows of the rotation matrix of a quaternion (w, x, y, z) of any length (thesis 4.10)."""
    w, x, y, z = q
    s = 2.0 / (w * w + x * x + y * y + z * z)
    return (
        (1.0 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)),
        (s * (x * y + w * z), 1.0 - s * (x * x + z * z), s * (y * z - w * x)),
        (s * (x * z - w * y), s * (y * z + w * x), 1.0 - s * (x * x + y * y)),
    )


def unit_quaternion(q: Vector) -> Four:
    w, x, y, z = q
    size = sqrt(w * w + x * x + y * y + z * z)
    return w / size, x / size, y / size, z / size


def turn_quaternion(turn: Vector) -> Four:
    """Quaternion (w, x, y, z) of a rotation about the vector `turn`, whose length is the angle [rad]."""
    x, y, z = turn
    angle = sqrt(x * x + y * y + z * z)
    half = sin(0.5 * angle) / angle if angle > 1e-150 else 0.5
    return cos(0.5 * angle), half * x, half * y, half * z


def spin_of(turn: Rows, momentum: Vector, inertia_body: Rows) -> Three:
    """Angular velocity [rad/s] from angular momentum [kg m2/s], world axes (thesis 4.19); `turn`: body to world."""
    return matrix_times(turn, solve_3x3(inertia_body, transpose_times(turn, momentum)))
