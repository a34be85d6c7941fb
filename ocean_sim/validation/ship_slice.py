"""A ship of kind `pressure` in 2-D: the draught of a box that the particles alone carry, and a half-immersed
cylinder released, against linear theory.

A cylinder of 0.1524 m is released 0.0254 m too high (Ito 1977; Yeung 1982): extrema by the multipoles of Ursell (1949),
over the level that the water has under its own weight. Its swings are 8 % too small, 11 % too large and 24 % too small,
and late by 1.2, 0.6 and 0.7 %, on ten spacings to the radius; 5 % of the rise are an eighth of a spacing.
"""

from functools import partial

import numpy as np

from ocean_sim.simulation import Simulation
from ocean_sim.validation.shared.case import Curve, Finding, Problem, Promise, relative
from ocean_sim.validation.shared.ship import G, track

LENGTH, DEPTH, SIDE, DRAUGHT, TOP = 3.2, 1.2, 0.8, 0.4, 0.3  # [m] of the tank, the box, and its centre of mass
SETTLED = 1.0  # [s]
DENSITIES = (0.1, 0.3, 0.5, 0.7, 0.9, 0.95)
RADIUS, RISE = 0.0762, 0.0254  # [m]
LONG, DEEP = 3.2, 0.45  # [m]; half as long, it would rise by a tenth of RISE
SQUEEZE = 0.02  # compression at the bed: the water settles by half of it of its depth
EXTREMA = ((0.326, -0.6408), (0.635, 0.3045), (0.934, -0.2136))  # [s], of the rise
LIMIT, PERIOD, FIRST = 3.0, 5.0, 10.0  # [%]
PRESSURE = ("pressure",)


def problems(coarse: bool) -> list[Problem]:
    found = [box(density, coarse) for density in ((0.5,) if coarse else DENSITIES)]
    return [*found, cylinder(coarse)]


def box(density: float, coarse: bool) -> Problem:
    """A box that draws ten spacings (coarse: five); it settles, and is then observed for a period of its heave, with
    the added mass of half a plate."""
    draught = SIDE * density
    period = 2.0 * np.pi * np.sqrt((density * SIDE**2 + np.pi / 8.0 * SIDE**2) / (G * SIDE))
    shape = {"kind": "box", "length": 1.0, "breadth": SIDE, "height": SIDE}
    hull = {"shape": shape, "mass": 1000.0 * density * SIDE**2, "centre_of_mass": [0.0, TOP, 0.0]}
    scene = {
        "duration": SETTLED + period,
        "basin": {"length": LENGTH, "depth": DEPTH},
        "fluid": {
            "kind": "delta_sph",
            "spacing": draught / (5.0 if coarse else 10.0),
            "compression": 0.02,
            "artificial_viscosity": 0.1,
        },
        "ship": {"hull": hull},
    }
    limit = {} if coarse else {"pressure": LIMIT}
    promise = Promise(f"box of relative density {density:g}: draught [m]", "%", "Archimedes, closed form", limit)
    name = f"box {density:g}"
    return Problem(
        scene, (promise,), partial(floating, promise=promise, exact=draught), name, not coarse, "ship", PRESSURE
    )


def floating(simulation: Simulation, promise: Promise, exact: float) -> Finding:
    """Keel under the water's own level, from half a breadth next to the hull on. A level by the volume of the water at
    rest density would be about 15 mm too high: 1.2 m of water that is compressed by 2 % at the bed is 12 mm lower."""
    apart = np.linspace(SIDE, 0.5 * LENGTH - 0.1, 8)
    gauges = np.array([(x, 0.0) for x in (*-apart, *apart)])
    until = simulation.scene.duration
    path = [
        (t, simulation.fluid.elevations(gauges).mean() - (b.position[1] - TOP)) for t, b in track(simulation, until)
    ]
    t, draught = np.array(path).T
    found = relative(float(draught[t > SETTLED].mean()), exact)
    axes = ("t [s]", "draught [m]")
    return Finding({promise.quantity: found}, [Curve("draught", t, draught)], [Curve("rest", t, 0 * t + exact)], axes)


def cylinder(coarse: bool) -> Problem:
    """Heave decay; ten spacings in its radius (coarse: five)."""
    hull = {
        "shape": {"kind": "cylinder", "length": 1.0, "radius": RADIUS},
        "mass": 500.0 * np.pi * RADIUS**2,
        "centre_of_mass": [0.0, RADIUS, 0.0],
    }
    scene = {
        "duration": 1.0,
        "basin": {"length": LONG, "depth": DEEP, "walls": {"x": "absorbing"}},
        "fluid": {
            "kind": "delta_sph",
            "spacing": RADIUS / (5.0 if coarse else 10.0),
            "compression": SQUEEZE,
            "artificial_viscosity": 0.03,
        },
        "ship": {"hull": hull, "position": [0.0, RISE - 0.5 * SQUEEZE * DEEP, 0.0], "free": ["heave"]},
    }
    source = "linear theory (Ursell 1949, Yeung 1982)"
    promises = []
    for k, (_, height) in enumerate(EXTREMA):
        promises.append(Promise(f"time of extremum {k + 1} [s]", "%", source, {} if coarse else {"pressure": PERIOD}))
        limit = {"pressure": FIRST} if k == 0 and not coarse else {}
        promises.append(Promise(f"extremum {k + 1} over the rise, {height:g}", "%", source, limit))
    look = partial(bobbing, promises=tuple(promises))
    return Problem(scene, tuple(promises), look, "cylinder", not coarse, "ship", PRESSURE)


def bobbing(simulation: Simulation, promises: tuple[Promise, ...]) -> Finding:
    """Extrema one after the other, over the water's own level."""
    surface_drop = simulation.fluid.surface_drop
    t, y = np.array([(0.0, 1.0), *((t, (b.position[1] + surface_drop) / RISE) for t, b in track(simulation, 1.0))]).T
    numbers, begin = {}, 0
    for k, (when, height) in enumerate(EXTREMA):
        until = np.searchsorted(t, when + 0.15)
        span = y[begin:until] * np.sign(height)
        at = begin + int(np.argmax(span))
        numbers[promises[2 * k].quantity] = relative(float(t[at]), when)
        numbers[promises[2 * k + 1].quantity] = relative(float(y[at]), height)
        begin = at
    exact = np.array(EXTREMA).T
    return Finding(
        numbers,
        [Curve("heave", t, y)],
        [Curve("linear theory", exact[0], exact[1], points=True)],
        ("t [s]", "heave over the rise"),
    )
