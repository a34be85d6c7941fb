"""Errata of the thesis: printed and corrected number, reason, and measurement by this program: CSV and PNG.

The table goes to standard output, too.

python figures/errata.py [--fast] [--out DIR]
"""

import re
from math import asin, degrees, radians, sin, sqrt
from pathlib import Path
from sys import stdout
from typing import NamedTuple

import numpy as np
from _options import options
from _paper import BLUE, GREY, INK, PALE, SOFT, paper, save_figure, save_table

from ocean_sim.conventions import AIR_DENSITY, GRAVITY, WATER_DENSITY
from ocean_sim.fluid import with_particles
from ocean_sim.fluid.sph.smoothing import Smoothing
from ocean_sim.kernel_library import ti, tm
from ocean_sim.parts import PACKAGE
from ocean_sim.pictures.water.water_shading import REFRACTIVE_INDEX, fresnel
from ocean_sim.random_numbers import numpy_uniform3
from ocean_sim.reading.scene import load
from ocean_sim.ship import PARTS
from ocean_sim.ship.body.rigid_body import RigidBody, advance_body, euler_angles, euler_quaternion
from ocean_sim.ship.hull.hull import hull_of
from ocean_sim.ship.naval.hydrostatics import UPRIGHT
from ocean_sim.simulation import Simulation
from ocean_sim.surface import sheet
from ocean_sim.wind.shared.air_load import drag, drag_coefficient, lift, stress

BLOWS = 10.0  # wind [m/s]
LIFTS = 1.0e-3  # lift coefficient
STEP = 1.0 / 60.0  # [s]
PARTICLES, SPACING, THICKNESS = (32, 6, 32), 1.25, 1.5  # of the thesis's water [m], and of its cloth [m]
NODES = 33  # of the cloth along a side
QUIET = dict.fromkeys(("accuracy", "timings", "health", "frames", "render", "report"))


class Erratum(NamedTuple):
    """A misprint of the thesis: its place, and a number that shows it, as printed, corrected, and by this program."""

    where: str
    quantity: str
    unit: str
    as_printed: float
    corrected: float
    difference: float
    measured: float
    why: str


def erratum(
    where: str, quantity: str, unit: str, as_printed: float, corrected: float, measured: float, why: str
) -> Erratum:
    numbers = float(as_printed), float(corrected), float(as_printed - corrected), float(measured)
    return Erratum(where, quantity, unit, *numbers, why)


def cited_number(module: str, pattern: str) -> float:
    """Number of an equation or section that a module of the program cites: the group of a pattern in its source."""
    found = re.search(pattern, (PACKAGE / module).read_text(encoding="utf-8"))
    return float(found[1]) if found is not None else float("nan")


@ti.kernel
def blown(wind: tm.vec3, coefficient: float) -> tm.vec3:
    return lift(wind, 1.0, coefficient)


@ti.kernel
def dragged(wind: tm.vec3) -> tm.vec3:
    return drag(wind, 1.0)


class Program(NamedTuple):
    """Measured results of the program, to compare with the thesis."""

    momentum: float  # made by pressure in free water, over the sum of all particles' momenta
    stress: float  # on water at rest [Pa]
    along: float  # on water that moves along at half the wind's speed [Pa]
    lift: float  # upwards on 1 m2 [N]


def run_program() -> Program:
    """Run an uneven lump of water, free of gravity and walls, for a few steps, and evaluate the wind's kernels."""
    box = {"length": 8.0, "width": 8.0, "depth": 8.0, "walls": "none", "floor": "none", "gravity": [0.0, 0.0, 0.0]}
    lump = [
        {"min": [-2.0, -6.0, -2.0], "max": [2.0, -4.0, 2.0]},
        {"min": [-2.0, -4.0, -2.0], "max": [0.0, -2.0, 1.0]},
    ]
    water = {"kind": "mueller", "spacing": 1.0, "fill": lump, "reference_speed": 5.0, "minimum_pressure": None}
    scene = {"title": "errata", "duration": 1.0, "basin": box, "fluid": water, "runtime": {"precision": "f64"}, **QUIET}
    with Simulation(load(scene)) as simulation:
        for _ in range(5):
            simulation.step()
        moving = with_particles(simulation.fluid).particles.velocity.to_numpy().astype(float)
        wind = tm.vec3(BLOWS, 0.0, 0.0)
        raised = float(blown(wind, LIFTS).y)
        still, along = (float(dragged(tm.vec3(u, 0.0, 0.0)).x) for u in (BLOWS, BLOWS - 5.0))
    made = float(np.linalg.norm(moving.sum(axis=0)) / np.linalg.norm(moving, axis=1).sum())
    return Program(made, still, along, raised)


def pressure_forces(symmetric: bool) -> np.ndarray:
    """Forces [N] on two particles of 1953 kg, 1 m apart, of unlike pressure, by (2.14), or if symmetric by (2.16)."""
    smoothing, apart, mass = Smoothing(3, support=2.5), 1.0, 1953.125
    density, pressure = np.array([1000.0, 1010.0]), np.array([10e3, 60e3])
    slope = -3.0 * smoothing.spiky_constant * (smoothing.support - apart) ** 2  # dW/dr of the spiky kernel
    other = pressure[::-1]
    p = (pressure + other) / 2.0 if symmetric else other
    per_volume = -mass * p / density[::-1] * slope * np.array([-1.0, 1.0])
    return per_volume * mass / density


def momentum_error(forces: np.ndarray) -> float:
    """Magnitude of the summed forces over the sum of their magnitudes: zero if action equals reaction."""
    return float(abs(forces.sum()) / np.abs(forces).sum())


def noise_variance(dt: float, lasts: float, particles: int = 5000) -> float:
    """Velocity variance [m2/s2] after 1 s of random acceleration of 30 m/s2, as in the listing, by steps `dt` [s]; each
    random number lasts for `lasts` [s]."""
    time = np.arange(round(1.0 / dt)) * dt
    velocity = np.zeros((particles, 3))
    for draw in (time / lasts + 1e-6).astype(int):
        velocity += dt * 30.0 * numpy_uniform3(7, 0, np.arange(particles), draw)
    return float(velocity.var())


def listing_reflectance(cosine: float) -> float:
    """Reflectance by the shader of section 5.2.3, for the cosine of the angle between its eye vector and the normal."""
    incident = np.arccos(cosine)
    below = np.arcsin(np.sin(incident) / REFRACTIVE_INDEX)
    less, more = incident - below, incident + below
    return float(max(0.0, min(1.0, 0.02 + 0.5 * ((sin(less) / sin(more)) ** 2 + (np.tan(less) / np.tan(more)) ** 2))))


def listing_height(heights: np.ndarray, x: float, z: float, side: float) -> float:
    """Height [m] at x, z by the listing's `getWaveHeight` (5.3), from heights (n, n) [m] of a cloth of this side
    [m]."""
    count = len(heights)
    i, j = (int(count * (side / 2.0 - value) / side) for value in (x, z))
    return float(heights.ravel()[j * count + i - 1])


def interpolated_height(heights: np.ndarray, x: float, z: float, side: float) -> float:
    """Height [m] at x, z by bilinear interpolation on the same cloth as `listing_height` has."""
    at = [(side / 2.0 - value) * (len(heights) - 1) / side for value in (z, x)]
    (j, i), (g, f) = (int(value) for value in at), (value % 1.0 for value in at)
    square = heights[j : j + 2, i : i + 2]
    return float(np.array([1.0 - g, g]) @ square @ np.array([1.0 - f, f]))


def count_contacts() -> tuple[int, int, int]:
    """Numbers of (node, particle) pairs: all, as Algorithm 5 checks them; those that touch; and those left to check
    with cells as wide as the sheet is thick."""
    from scipy.spatial import cKDTree

    x, y, z = (np.arange(count) * SPACING for count in PARTICLES)
    water = np.stack(
        [grid.ravel() for grid in np.meshgrid(x + 0.5 * SPACING, y - y[-1] - 0.5 * SPACING, z + 0.5 * SPACING)], axis=1
    )
    side = np.linspace(0.0, PARTICLES[0] * SPACING, NODES)
    nodes = np.stack([grid.ravel() for grid in np.meshgrid(side, [0.0], side)], axis=1)
    every = len(nodes) * len(water)
    near = cKDTree(nodes).count_neighbors(cKDTree(water), THICKNESS)
    cells = [np.floor(points / THICKNESS + 1e-9).astype(int) for points in (nodes, water)]
    seen = sum(int((np.abs(cells[1] - cell).max(axis=1) <= 1).sum()) for cell in cells[0])
    return every, int(near), seen


def move_body(force: np.ndarray, torque: np.ndarray, steps: int) -> RigidBody:
    """A body of 1 kg and moments of inertia 1, 2, 3 kg m2, after so many steps under a force [N] and torque [N m]."""
    none = np.zeros(3)
    body = RigidBody(1.0, np.diag([1.0, 2.0, 3.0]), none, np.array([1.0, 0.0, 0.0, 0.0]), none, none)
    for _ in range(steps):
        body = advance_body(body, force, torque, STEP)
    return body


def errata() -> list[Erratum]:
    own = run_program()
    return [*water_errata(own), *surface_errata(), *ship_errata()]


def water_errata(own: Program) -> list[Erratum]:
    """Errata of chapter 2."""
    upwards = 0.5 * AIR_DENSITY * BLOWS**2 * LIFTS
    shorter = sqrt(noise_variance(STEP / 2, STEP) / noise_variance(STEP, STEP))
    air = "wind/shared/air_load.py"
    return [
        erratum(
            "2.2.3",
            "number of the symmetric viscous force",
            "equation",
            2.16,
            2.18,
            cited_number("fluid/mueller.py", r"Viscous force of a pair \(thesis eq\. (2\.\d+)\)"),
            "two equations are numbered (2.16); the second follows (2.17)",
        ),
        erratum(
            "2.3, 4.3, 5.1.2: drag",
            "number of the drag that the text cites",
            "equation",
            2.21,
            2.22,
            cited_number(air, r"relative to it \[m/s\]: \((2\.\d+)\)"),
            "(2.21) is the drag coefficient",
        ),
        erratum(
            "4.3, 5.1.2: lift",
            "number of the lift that the text cites",
            "equation",
            2.22,
            2.23,
            cited_number(air, r"upwards across the wind: \((2\.\d+)\)"),
            "(2.22) is the drag",
        ),
        erratum(
            "5.1.2: superposition",
            "number of the sum of wind forces that the text cites",
            "equation",
            2.18,
            2.26,
            cited_number("wind/gusts.py", r"\((2\.\d+)\) of the thesis, summed over the volumes"),
            "no equation is numbered (2.18); (2.19) sums the forces on the air, (2.26) those on the water",
        ),
        erratum(
            "5.1.2: section",
            "section that models the wind, as the text cites it",
            "section",
            2.4,
            2.3,
            cited_number(air, r"where section (\d\.\d)"),
            "chapter 2 ends with section 2.3",
        ),
        erratum(
            "(2.14), (2.27)",
            "momentum made by the pressure of two particles, over the sum of its forces",
            "1",
            momentum_error(pressure_forces(symmetric=False)),
            momentum_error(pressure_forces(symmetric=True)),
            own.momentum,
            "(2.27) goes back to the pressure of one side; the symmetric (2.16) obeys Newton's third law",
        ),
        erratum(
            "(2.20), (2.22)",
            "stress of a wind of 10 m/s",
            "Pa",
            0.5 * AIR_DENSITY * drag_coefficient(BLOWS) * BLOWS**2,
            stress(BLOWS),
            own.stress,
            "(2.22) halves the stress (2.20) that it is set equal to; C_d (2.21) was measured without the half",
        ),
        erratum(
            "(2.22), (2.25): rho",
            "stress of a wind of 10 m/s with the density that (2.25) calls rho",
            "Pa",
            WATER_DENSITY * drag_coefficient(BLOWS) * BLOWS**2,
            stress(BLOWS),
            own.stress,
            "rho is the density of air in (2.22) and that of water in (2.25)",
        ),
        erratum(
            "(2.22), v",
            "stress of a wind of 10 m/s on water that moves along at 5 m/s",
            "Pa",
            stress(BLOWS),
            stress(BLOWS - 5.0),
            own.along,
            "section 2.3 takes the wind's speed for the relative one",
        ),
        erratum(
            "(2.23)",
            "lift on 1 m2 in a wind of 10 m/s, C_L 0.001, along wind x across",
            "N",
            -upwards,
            upwards,
            own.lift,
            "the minus sign makes the direction that section 2.3 constructs point into the water",
        ),
        erratum(
            "(2.24)",
            "spread of the velocity after 1 s of noise of 30 m/s2, at steps of 1/120 s over that at 1/60 s",
            "1",
            sqrt(noise_variance(STEP / 2, STEP / 2) / noise_variance(STEP, STEP)),
            1.0,
            shorter,
            "a new draw each step stirs less the shorter the step, its variance falls by half; our draws last 1/60 s",
        ),
    ]


def surface_errata() -> list[Erratum]:
    """Errata of chapters 3 and 5.2."""
    slope, angle = 2.0, radians(45.0)
    x = np.arange(5.0)
    normal = sheet(x, x, np.tile(slope * x[:, None], (1, 5))).normals[12]
    limit, exact = degrees(asin(1.0 / REFRACTIVE_INDEX)), float(fresnel(np.cos(angle)))
    least = ((REFRACTIVE_INDEX - 1.0) / (REFRACTIVE_INDEX + 1.0)) ** 2
    known = 0.0278984  # at 45 degrees, by (3.8), which holds there
    every, near, seen = count_contacts()
    return [
        erratum(
            "(3.2) to (3.4)",
            "slope of a field that rises by 2 a metre",
            "1/m",
            (slope * 3.0 - slope * 1.0) / 1.0,
            slope,
            -normal[0] / normal[1],
            "central differences span two cells; normals do not show it, for they are of length one",
        ),
        erratum(
            "3.3.2, Figure 3-7",
            "largest angle of light in the water",
            "deg",
            48.59,
            limit,
            limit,
            "48.59 belongs to a refractive index of 4/3; section 3.3.1 says 1.333",
        ),
        erratum(
            "(3.8)",
            "reflectance at normal incidence",
            "1",
            float("nan"),
            least,
            float(fresnel(np.array(1.0))),
            "sines and tangents of angles of zero divide nothing by nothing; in cosines there is a number",
        ),
        erratum(
            "5.2.3: 0.02",
            "reflectance at 45 degrees",
            "1",
            listing_reflectance(float(np.cos(angle))),
            known,
            exact,
            "the listing adds 0.02, which (3.8) does not have",
        ),
        erratum(
            "5.2.3: Eye",
            "reflectance at 45 degrees with the eye vector as the listing makes it",
            "1",
            listing_reflectance(-float(np.cos(angle))),
            known,
            exact,
            "its eye vector points from the eye to the water, so the cosine is negative and the sea a mirror",
        ),
        erratum(
            "Algorithm 5",
            "pairs of 33 x 33 nodes and 6144 particles that are looked at",
            "1",
            every,
            near,
            seen,
            "all pairs, where only those within the thickness of 1.5 m can touch; measured: those in adjoining cells",
        ),
    ]


def ship_errata() -> list[Erratum]:
    """Errata of chapters 4 and 5.3."""
    side, place = PARTICLES[0] * SPACING, (10.3, 0.2)
    across = np.linspace(side / 2.0, -side / 2.0, NODES)
    heights = np.tile(0.1 * across, (NODES, 1))
    still = hull_of("barge20").in_still_water(16.0, WATER_DENSITY, GRAVITY)
    weight, area, deep = still.density * GRAVITY, 20.0 * 8.0, 5.0
    turned = degrees(euler_angles(euler_quaternion(0.0, radians(10.0), 0.0))[1])
    none, metre = np.zeros(3), 1.0
    return [
        erratum(
            "(4.20)",
            "torque that turns a body at rest of 1 kg m2 by 1 rad/s2",
            "N m",
            0.0,
            1.0,
            move_body(none, np.array([1.0, 0.0, 0.0]), 1).angular_velocity[0] / STEP * metre,
            "its last line has the dot on the inertia instead of on the angular velocity",
        ),
        erratum(
            "4.3: axes",
            "change of heading by a yaw of 10 degrees",
            "deg",
            0.0,
            10.0,
            turned,
            "roll about y and yaw about z contradict Y up and surge along z: yaw is about y, roll about z",
        ),
        erratum(
            "4.3: -rho V",
            "buoyancy of a barge of 320 t",
            "N",
            -WATER_DENSITY * 320.0,
            320.0e3 * GRAVITY,
            weight * float(still.wet_volumes(UPRIGHT, still.water_level(UPRIGHT)).sum()),
            "the text leaves gravity out, and what floats is pushed up",
        ),
        erratum(
            "5.3: addBuoyancy",
            "buoyancy of a barge of 20 x 8 x 4 m whose keel is 5 m under water",
            "N",
            weight * area * deep,
            weight * area * 4.0,
            weight * float(still.wet_volumes(UPRIGHT, deep).sum()),
            "the columns of water over the bottom are not cut at the deck",
        ),
        erratum(
            "5.3: lever",
            "metacentric height of a barge of 20 x 8 x 2 m, centre of mass 2.5 m over its keel",
            "m",
            8.0**2 / (12.0 * 2.0) - 2.5,
            1.0 + 8.0**2 / (12.0 * 2.0) - 2.5,
            still.metacentric_height(),
            "each push acts on the vertical through the bottom, so the height of the centre of buoyancy is lost",
        ),
        erratum(
            "5.3: getWaveHeight",
            "height of a slope of 0.1 at x = 10.3 m, on 33 x 33 nodes 1.25 m apart",
            "m",
            listing_height(heights, *place, side),
            0.1 * place[0],
            interpolated_height(heights, *place, side),
            "33 nodes have 32 cells between them, the index is cut to a whole number and then lessened by one",
        ),
        erratum(
            "5.3: corner",
            "number of the node at the corner that is listed first",
            "1",
            -1.0,
            0.0,
            (side / 2.0 - across[0]) * (NODES - 1) / side,
            "the same index reaches out of the array",
        ),
        erratum(
            "Algorithm 7",
            "speed of a body that has fallen for 1 s, at steps of 1/60 s",
            "m/s",
            GRAVITY * STEP,
            GRAVITY,
            -move_body(np.array([0.0, -GRAVITY, 0.0]), none, 60).velocity[1],
            "v = a dt and x = v dt forget what was; (4.22) and (4.23) add",
        ),
        erratum(
            "(2.26), (4.27): F_w",
            "forces that F_w stands for",
            "1",
            2.0,
            1.0,
            sum(part.startswith("wave") for part in PARTS),
            "wind in chapter 2, wave in chapter 4; here wind_drag, wind_lift and wave are apart",
        ),
    ]


def draw_figure(rows: list[Erratum], path: Path) -> None:
    """Draw the table as a picture: a line for each erratum, and below it why the printed number is wrong."""
    figure = paper(15.0, 0.46 * len(rows) + 1.0)
    axes = figure.add_subplot()
    axes.set(xlim=(0.0, 1.0), ylim=(len(rows) + 0.6, -1.2))
    axes.axis("off")
    places = {"where": 0.0, "quantity": 0.155, "unit": 0.69, "as_printed": 0.80, "corrected": 0.90, "measured": 1.0}
    for name, x in places.items():
        right = name in ("as_printed", "corrected", "measured")
        axes.text(
            x, -0.6, name.replace("_", " "), fontsize=11, weight="bold", color=INK, ha="right" if right else "left"
        )
    axes.plot([0.0, 1.0], [-0.15, -0.15], color=INK, lw=1.0)
    for k, row in enumerate(rows):
        if k % 2:
            axes.axhspan(k - 0.15, k + 0.85, color=PALE, alpha=0.45, lw=0)
        for name, x in places.items():
            value = getattr(row, name)
            number = isinstance(value, float)
            colour = {"as_printed": GREY, "measured": BLUE}.get(name, INK)
            text = (f"{value:,.0f}" if abs(value) >= 1e4 else f"{value:.5g}") if number else value
            text = "0 / 0" if text == "nan" else text
            axes.text(
                x,
                k + (0.14 if name == "quantity" else 0.35),
                text,
                fontsize=9.5,
                va="center",
                ha="right" if number else "left",
                color=colour,
            )
        axes.text(places["quantity"], k + 0.58, row.why, fontsize=8.0, va="center", color=SOFT)
    save_figure(figure, path)


def main() -> None:
    out = options(__doc__).out
    rows = errata()
    texts = [[f"{value:.9g}" if isinstance(value, float) else value for value in row] for row in rows]
    save_table(out / "errata.csv", [], Erratum._fields, texts)
    draw_figure(rows, out / "errata.png")
    stdout.write((out / "errata.csv").read_text(encoding="utf-8"))


if __name__ == "__main__":
    main()
