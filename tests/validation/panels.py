"""Linear potential flow around a ship's section across a flume, by panels: how data/section_radiation.csv and
data/box_radiation.csv were made.

`python tests/validation/panels.py section` prints the one, `box` the other, `drift` data/section_drift.csv. The
potential is that of constant sources and dipoles (Green's third identity with ln r and its image in the bed) on hull,
free surface and two ends; at the ends it is a sum of the eigenfunctions of the depth, which lets every wave out. Slots
between the hull and the walls of the flume are thin sheets of water with a free surface of their own: they take the
pressure of the hull's contour and give it their flux, less what laminar friction between two plates holds back
(Womersley 1955, J. Physiol. 127, in a plane).
"""

from itertools import pairwise
from math import pi, sqrt
from sys import argv
from typing import Any

import numpy as np

from ocean_sim import waves

G, DENSITY, VISCOSITY = 9.81, 1000.0, 1e-6
SECTION = (0.400, 0.200, 0.0512)  # breadth, draught, radius of the bilges [m]
LENGTH, FLUME, DEPTH, AXIS = 0.586, 0.600, 1.00, -0.093  # [m]
BOX = {"section": (1.0, 0.2, 0.0512), "length": 1.0, "flume": 1.0, "axis": -0.05}  # of open_sea_box
MASS = 46.8  # [kg]
DRIFT_FREQUENCIES = np.arange(3.0, 11.01, 0.1)  # [rad/s]
SPRINGS = (60.0, 8.70, 0.303)  # in sway [N/m], [N s/m], [kg]
MODES = 12  # of those that do not travel
MOTIONS = ("sway", "heave", "roll")
FREQUENCIES = [0.02, 0.1, *np.arange(0.25, 26.01, 0.25)]  # [rad/s]


def graded(start: float, end: float, n: int) -> np.ndarray:
    """(n + 1,) places, denser towards both ends."""
    return start + (end - start) * (0.5 - 0.5 * np.cos(pi * np.linspace(0.0, 1.0, n + 1)))


def contour(breadth: float, draught: float, bilge: float, n: int) -> np.ndarray:
    """(m, 2) from the waterline on port (x > 0) around the keel to the other [m]."""
    half, turns = breadth / 2.0, np.linspace(0.0, pi / 2.0, n + 1)[1:]
    inner, upper = half - bilge, bilge - draught
    side = [(half, y) for y in graded(0.0, upper, n)]
    round_ = [(inner + bilge * np.cos(t), upper - bilge * np.sin(t)) for t in turns]
    flat = [(x, -draught) for x in graded(inner, 0.0, n)[1:]]
    port = np.array(side + round_ + flat)
    return np.vstack([port, port[::-1][1:] * [-1.0, 1.0]])


def integrals(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(p, n) of ln r over each panel, and of its slope along the normal, which lies right of start to end."""
    span = end - start
    size = np.hypot(*span.T)
    along = span / size[:, None]
    across = np.stack([along[:, 1], -along[:, 0]], axis=1)
    apart = points[:, None] - start
    x, y = (apart * along).sum(axis=2), (apart * across).sum(axis=2)
    seen = np.arctan2(y * size, y * y + x * (x - size))
    ln_1, ln_2 = (0.5 * np.log(np.maximum(z**2 + y**2, 1e-300)) for z in (x, x - size))
    return x * ln_1 - (x - size) * ln_2 - size + y * seen, -seen


def green(start: np.ndarray, end: np.ndarray, depth: float | None) -> tuple[np.ndarray, np.ndarray]:
    """(n, n) source and dipole matrices at the panels' middles; with the image in a bed where there is one."""
    middle = 0.5 * (start + end)
    source, dipole = integrals(middle, start, end)
    np.fill_diagonal(dipole, -pi)
    if depth is not None:
        more = integrals(middle * [1.0, -1.0] - [0.0, 2.0 * depth], start, end)
        source, dipole = source + more[0], dipole + more[1]
    return source, dipole


def outwards(y: np.ndarray, size: np.ndarray, omega: float, k: float) -> np.ndarray:
    """(n, n) from the potential on an end of the water to its slope there, where nothing comes in."""
    deep, shapes, rates = omega**2 / G, [np.cosh(k * (y + DEPTH)) / np.cosh(k * DEPTH)], [-1j * k]
    for number in range(1, MODES + 1):
        low, high = (number - 0.5) * pi / DEPTH + 1e-9, number * pi / DEPTH
        for _ in range(60):
            q = 0.5 * (low + high)
            low, high = (q, high) if -q * np.tan(q * DEPTH) > deep else (low, q)
        shapes.append(np.cos(q * (y + DEPTH)))
        rates.append(q)
    shape = np.array(shapes)
    return -(shape.T * rates) @ np.linalg.solve((shape * size) @ shape.T, shape * size)


def slot(hull: np.ndarray, omega: float, wide: float) -> np.ndarray:
    """(m, m) from the potential on a hull's contour to the mean flow into a slot as `wide` [m] behind it."""
    thin = 0.5 * wide * np.sqrt(-1j * omega / VISCOSITY)
    free = 1.0 - np.tanh(thin) / thin  # of what would flow without friction
    inside, top = hull[::-1], graded(hull[0, 0], hull[-1, 0], 40)
    ring = np.vstack([inside, np.stack([top, np.zeros_like(top)], axis=1)[1:]])
    source, dipole = green(ring[:-1], ring[1:], None)
    m = len(hull) - 1
    surface = dipole[:, m:] - source[:, m:] * (omega**2 / G / free)
    flux = np.linalg.solve(np.hstack([-source[:, :m], surface]), -dipole[:, :m])[:m]
    return -free * flux[::-1, ::-1]


def answers(
    omega: float,
    section: tuple[float, float, float] = SECTION,
    length: float = LENGTH,
    flume: float = FLUME,
    fine: int = 1,
    axis: float = AXIS,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(3, 3) added mass and damping of sway, heave, roll; (3,) scattered and undisturbed force of waves of 1 m."""
    return solve(omega, section, length, flume, fine, axis)[:4]


def solve(
    omega: float, section: tuple[float, float, float], length: float, flume: float, fine: int, axis: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """What `answers` gives, and (2, 4) amplitudes [m] of the waves that leave to the near side, where waves come from,
    and to the far side: of sway, heave and roll at 1 m/s or rad/s, and of the waves of 1 m that are scattered."""
    k, far = float(waves.wavenumber(omega, DEPTH, G)), 1.2 if omega < 12.0 else 0.8
    hull = contour(*section, 24 * fine)
    x = section[0] / 2.0 + (far - section[0] / 2.0) * np.linspace(0.0, 1.0, 200 * fine + 1) ** 1.5
    surface = np.stack([x, np.zeros_like(x)], axis=1)
    y = -DEPTH * np.linspace(0.0, 1.0, 60 * fine + 1) ** 1.5
    end, other = [1.0, 1.0], [-1.0, 1.0]
    wall = np.stack([np.full_like(y, far), y], axis=1)
    lines = [hull, surface[::-1], surface * other, wall[::-1] * end, wall * other]
    start, stop = np.vstack([line[:-1] for line in lines]), np.vstack([line[1:] for line in lines])
    edges = np.cumsum([0, *(len(line) - 1 for line in lines)])
    on = [slice(a, b) for a, b in pairwise(edges)]
    wet, middle = on[0], 0.5 * (start + stop)
    size = np.hypot(*(stop - start).T)
    normal = np.stack([stop[:, 1] - start[:, 1], start[:, 0] - stop[:, 0]], axis=1)[wet] / size[wet, None]

    slope = np.zeros((len(start), len(start)), dtype=complex)  # of the potential, from the potential
    for part in on[1:3]:
        slope[part, part] = omega**2 / G * np.eye(part.stop - part.start)
    for part in on[3:]:
        slope[part, part] = outwards(middle[part, 1], size[part], omega, k)
    share = length / flume
    if share < 1.0:
        slope[wet, wet] = (1.0 - share) * slot(hull, omega, (flume - length) / 2.0)

    at, arm = middle[wet], middle[wet] - [0.0, axis]
    motions = np.column_stack([normal, arm[:, 0] * normal[:, 1] - arm[:, 1] * normal[:, 0]])
    arriving = -1j * G / omega * np.exp(1j * k * at[:, 0]) / np.cosh(k * DEPTH)
    level = k * (at[:, 1] + DEPTH)
    coming = arriving * np.cosh(level)
    passing = k * arriving * (1j * np.cosh(level) * normal[:, 0] + np.sinh(level) * normal[:, 1])
    driven = np.zeros((len(start), 4), dtype=complex)
    driven[wet, :3] = share * motions
    driven[wet, 3] = slope[wet, wet] @ coming - passing
    source, dipole = green(start, stop, DEPTH)
    potential = np.linalg.solve(dipole - source @ slope, source @ driven)
    force = 1j * omega * DENSITY * length * (motions * size[wet, None]).T @ np.column_stack([potential[wet], coming])
    ends = [(part, np.cosh(k * (middle[part, 1] + DEPTH)) / np.cosh(k * DEPTH)) for part in on[:2:-1]]
    left = [1j * omega / G * (f * size[part]) @ potential[part] / (f @ (f * size[part])) for part, f in ends]
    left[1][3] += np.exp(1j * k * far)  # of the waves that pass
    return force[:, :3].imag / omega, -force[:, :3].real, force[:, 3], force[:, 4], np.array(left)


def drift(omega: float, stiffness: float, lost: float, more: float) -> float:
    """Mean force [N/m2] per amplitude squared on the section in the flume, free in sway and heave, on springs of a
    `stiffness` [N/m] that damp by `lost` [N s/m] and weigh `more` [kg]: by the waves that leave, of which the section
    gives rho g a^2 / 2 c_g / c (1 + R^2 - T^2) a metre of the flume (Longuet-Higgins 1977, Proc. R. Soc. A 352)."""
    added, damping, scattered, passing, left = solve(omega, SECTION, LENGTH, FLUME, 1, AXIS)
    two = np.ix_((0, 1), (0, 1))
    heavy = np.diag([MASS + more, MASS]) + added[two]
    stiff = np.diag([stiffness, DENSITY * G * SECTION[0] * LENGTH])
    whole = stiff - omega**2 * heavy - 1j * omega * (damping[two] + np.diag([lost, 0.0]))
    moved = np.linalg.solve(whole, (scattered + passing)[:2])
    near, beyond = np.abs(left[:, 3] + left[:, :2] @ (-1j * omega * moved))
    k = float(waves.wavenumber(omega, DEPTH, G))
    return DENSITY * G / 2.0 * group_speed(omega) * k / omega * (1.0 + near**2 - beyond**2) * FLUME


def main(name: str) -> None:
    if name == "drift":
        print("omega_rad_s,heading_deg,surge_N_m2,sway_N_m2,yaw_Nm_m2")
        for omega in DRIFT_FREQUENCIES:
            print(f"{omega:g},90,0,{drift(float(omega), *SPRINGS):.6g},0")
        return
    body: dict[str, Any] = {"section": {}, "box": BOX}[name]
    units = ("kg", "kg", "kg_m2")
    columns = [f"{m}_added_{u},{m}_damping_{u}_s" for m, u in zip(MOTIONS, units)]
    columns.append("sway_roll_added_kg_m,sway_roll_damping_kg_m_s")
    columns += [f"{m}_scattered_90_re,{m}_scattered_90_im" for m in MOTIONS]
    print(",".join(["omega_rad_s", *columns]))
    for omega in FREQUENCIES:
        added, damping, scattered, _ = answers(float(omega), **body)
        row = [omega, *np.column_stack([np.diag(added), np.diag(damping)]).ravel()]
        row += [(whole[0, 2] + whole[2, 0]) / 2.0 for whole in (added, damping)]
        row += np.column_stack([scattered.real, scattered.imag]).ravel().tolist()
        print(",".join(f"{value:.6g}" for value in row))


def group_speed(omega: float) -> float:
    """Of waves in the flume [m/s]."""
    k = float(waves.wavenumber(omega, DEPTH, G))
    return omega / k * (0.5 + k * DEPTH / np.sinh(2.0 * k * DEPTH))


def by_reciprocity(omega: float, damping: np.ndarray, length: float) -> np.ndarray:
    """(3,) force of waves of 1 m [N/m], from damping (Haskind 1957, Newman 1962)."""
    return np.array([sqrt(2.0 * DENSITY * G * group_speed(omega) * b * length) for b in np.diag(damping)])


if __name__ == "__main__":
    main(argv[1])
