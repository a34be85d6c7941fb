"""A ship of kind `pressure` in 2-D: the draught of a box that the particles alone carry, and a half-immersed
cylinder released, against linear theory.

A cylinder of 0.1524 m is released 0.0254 m too high (Ito 1977; Yeung 1982): extrema by the multipoles of Ursell (1949),
over the level of the water under its own weight. On ten spacings to the radius, 5 % of the rise are an eighth of a
spacing.
"""

from functools import partial

import numpy as np

from ocean_sim.conventions import GRAVITY
from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, percent_error
from ocean_sim.validation.shared.ship import follow_body

TANK_LENGTH, TANK_DEPTH, BOX_SIDE = 3.2, 1.2, 0.8  # [m]
CENTRE_HEIGHT = 0.3  # [m] of the box's centre of mass over its keel
SETTLING_TIME = 1.0  # [s]
BOX_DENSITIES = (0.1, 0.3, 0.5, 0.7, 0.9, 0.95)
RADIUS, RISE = 0.0762, 0.0254  # [m] of the cylinder, and of its release over the rest position
CYLINDER_LENGTH, CYLINDER_DEPTH = 3.2, 0.45  # [m] of its tank; half as long, it would rise by a tenth of RISE
BED_COMPRESSION = 0.02  # the water settles by half of this share of its depth
EXTREMA = ((0.326, -0.6408), (0.635, 0.3045), (0.934, -0.2136))  # [s], over RISE
DRAUGHT_TOLERANCE, TIME_TOLERANCE, SWING_TOLERANCE = 3.0, 5.0, 10.0  # [%] of the first swing
PRESSURE_SCHEMES = ("pressure",)


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run: boxes of six relative densities (coarse: one), and a cylinder released."""
    found = [box_problem(density, coarse) for density in ((0.5,) if coarse else BOX_DENSITIES)]
    return [*found, cylinder_problem(coarse)]


def box_problem(density: float, coarse: bool) -> Problem:
    """Set-up of a floating box of a density relative to water, ten (coarse: five) spacings deep, that settles before
    its draught is measured."""
    draught = BOX_SIDE * density
    spacing = draught / (5.0 if coarse else 10.0)
    period = 2.0 * np.pi * np.sqrt((density * BOX_SIDE**2 + np.pi / 8.0 * BOX_SIDE**2) / (GRAVITY * BOX_SIDE))
    shape = {"kind": "box", "length": 1.0, "breadth": BOX_SIDE, "height": BOX_SIDE}
    hull = {"shape": shape, "mass": 1000.0 * density * BOX_SIDE**2, "centre_of_mass": [0.0, CENTRE_HEIGHT, 0.0]}
    scene = {
        "duration": SETTLING_TIME + period,
        "basin": {"length": TANK_LENGTH, "depth": TANK_DEPTH},
        "fluid": {"kind": "delta_sph", "spacing": spacing, "compression": 0.02, "artificial_viscosity": 0.1},
        "ship": {"hull": hull},
    }
    limit = {} if coarse else {"pressure": DRAUGHT_TOLERANCE}
    promise = Promise(f"box of relative density {density:g}: draught [m]", "%", "Archimedes, closed form", limit)
    look = partial(measure_draught, exact=draught)
    return Problem(scene, (promise,), look, f"box {density:g}", not coarse, "ship", PRESSURE_SCHEMES)


def measure_draught(simulation: Simulation, exact: float) -> Finding:
    """Run; compare the depth of the keel below the water level beside the hull with the `exact` draught [m].

    A level by volume at rest density would be about 15 mm too high: 1.2 m of water compressed by 2 % is 12 mm lower."""
    apart = np.linspace(BOX_SIDE, 0.5 * TANK_LENGTH - 0.1, 8)
    gauges = np.array([(x, 0.0) for x in (*-apart, *apart)])
    path = [
        (t, simulation.fluid.elevations(gauges).mean() - (b.position[1] - CENTRE_HEIGHT))
        for t, b in follow_body(simulation, simulation.scene.duration)
    ]
    t, draught = np.array(path).T
    found = percent_error(float(draught[t > SETTLING_TIME].mean()), exact)
    axes = ("t [s]", "draught [m]")
    return Finding([found], [Curve("draught", t, draught)], [Curve("rest", t, 0 * t + exact)], axes)


def cylinder_problem(coarse: bool) -> Problem:
    """Set-up of the cylinder released in heave, with ten (coarse: five) spacings to its radius."""
    shape = {"kind": "cylinder", "length": 1.0, "radius": RADIUS}
    hull = {"shape": shape, "mass": 500.0 * np.pi * RADIUS**2, "centre_of_mass": [0.0, RADIUS, 0.0]}
    height = RISE - 0.5 * BED_COMPRESSION * CYLINDER_DEPTH
    water = {"kind": "delta_sph", "compression": BED_COMPRESSION, "artificial_viscosity": 0.03}
    scene = {
        "duration": 1.0,
        "basin": {"length": CYLINDER_LENGTH, "depth": CYLINDER_DEPTH, "walls": {"x": "absorbing"}},
        "fluid": water | {"spacing": RADIUS / (5.0 if coarse else 10.0)},
        "ship": {"hull": hull, "position": [0.0, height, 0.0], "free": ["heave"]},
    }
    timed = {} if coarse else {"pressure": TIME_TOLERANCE}
    source = "linear theory (Ursell 1949, Yeung 1982)"
    promises = []
    for k, (_, extremum) in enumerate(EXTREMA):
        promises.append(Promise(f"time of extremum {k + 1} [s]", "%", source, timed))
        limit = {"pressure": SWING_TOLERANCE} if k == 0 and not coarse else {}
        promises.append(Promise(f"extremum {k + 1} over the rise, {extremum:g}", "%", source, limit))
    return Problem(scene, tuple(promises), measure_extrema, "cylinder", not coarse, "ship", PRESSURE_SCHEMES)


def measure_extrema(simulation: Simulation) -> Finding:
    """Run, and compare times and heights of successive extrema of heave, over the water level, with linear theory."""
    drop = simulation.fluid.surface_drop
    path = [(t, (b.position[1] + drop) / RISE) for t, b in follow_body(simulation, 1.0)]
    t, y = np.array([(0.0, 1.0), *path]).T
    numbers, begin = [], 0
    for when, height in EXTREMA:
        until = np.searchsorted(t, when + 0.15)
        at = begin + int(np.argmax(y[begin:until] * np.sign(height)))
        numbers += [percent_error(float(t[at]), when), percent_error(float(y[at]), height)]
        begin = at
    exact = np.array(EXTREMA).T
    expected = [Curve("linear theory", exact[0], exact[1], points=True)]
    return Finding(numbers, [Curve("heave", t, y)], expected, ("t [s]", "heave over the rise"))
