"""Water over beds of any shape and around meshes: at rest, falling, and as waves that climb, come back or pass a bar.

Solitary waves climb a beach of 1:19.85 (Synolakis 1987, J. Fluid Mech. 185) and one with a wall at its end (Briggs et
al. 1996). Regular waves come back from a wall and from slopes, and release harmonics on a bar (Dingemans 1994).
"""

from collections.abc import Callable, Sequence
from math import pi, sqrt
from typing import Any, cast

import numpy as np

from ocean_sim.basin.ground import RUNUP_GAP, Ground
from ocean_sim.conventions import GRAVITY
from ocean_sim.simulation import Simulation
from ocean_sim.validation.piston_flume import DEPTH, GROUP_SPEED, HEIGHT, PERIOD, WAVELENGTH
from ocean_sim.validation.shared.case import Curve, Finding, Number, Problem, Promise, absolute_error, percent_error
from ocean_sim.validation.shared.flume import reflection_ratio, resample_evenly
from ocean_sim.validation.shared.state import State, record_run
from ocean_sim.validation.shared.tables import table, table_path

Compare = Callable[[np.ndarray, np.ndarray], list[Number]]
"""Numbers from times (n,) [s] and records (n, 2 + m) [m]: how high water climbs bed and last wall, m elevations."""

SPECIFIC_WEIGHT = 1000.0 * GRAVITY  # [N/m3]
STILL_BEDS = {  # points x, y [m]
    "1:20": [[-1.0, -0.4], [-0.6, -0.4], [1.0, -0.32]],
    "1:5": [[-1.0, -0.4], [-0.6, -0.4], [1.0, -0.08]],
    "1:1": [[-1.0, -0.4], [0.4, -0.4], [1.0, 0.2]],
    "sawtooth": [[-1.0, -0.4], *([0.1 * k - 0.8, -0.3 - 0.1 * ((k + 1) % 2)] for k in range(17)), [1.0, -0.4]],
}
LEAST_ROWS = 3.0  # of water over a place of the bed where pressure is read
STILL_SAMPLES, SETTLING_SAMPLES = 10, 2  # of still water at its end; of the force on a mesh that are left out
BEACH_DEPTH, BEACH_COTANGENT, BEACH_FOOT = 0.4, 19.85, 4.0  # [m], 1, [m] from the piston
BEACH_TIMES, COMPOSITE_TIMES = {0.28: 13.0, 0.04: 18.0}, {0.039: 16.0, 0.264: 12.0, 0.696: 12.0}  # [s] by H/d
LIKE_WAVES, BREAKING_RATIO = 0.05, 0.045  # of H/d, by which measured waves differ at most; H/d from which they break
COMPOSITE_BED = [[10.0, -0.218], [15.04, -0.218], [19.4, -0.136], [22.33, -0.116], [23.23, -0.047]]
FRICTION = {"friction_factor": 0.01}  # of the beaches
RETURNS = {  # cotangent, share that comes back, its source and tolerance
    "vertical wall": (0.0, 0.95, "0.9 to 1", {"delta_sph": 5.0}),
    "slope 1:1": (1.0, 0.95, "0.9 to 1", {"delta_sph": 5.0}),
    "slope 1:3": (3.0, 0.587, "Iribarren number of 2.79, Seelig & Ahrens 1981", {}),
}
SHORE_X = 4.0 * WAVELENGTH  # [m] from the piston to where the bed leaves the water
SAMPLE_INTERVAL = 0.02  # [s] in a flume
BAR_BED = [[0.0, -0.8], [11.01, -0.8], [23.04, -0.2], [27.04, -0.2], [33.07, -0.8], [45.0, -0.8]]
BAR_WAVE_HEIGHT, BAR_PERIOD, BAR_TIME, BAR_RECORD = 0.04, 2.858, 35.0, 4.0  # [m], [s], [s], [periods]


def problems(coarse: bool) -> list[Problem]:
    """Set-ups to run; coarse: at twice the spacing (beach: four times, bar: 2.9), and still water for 5 s, not 60 s."""
    return [
        *(mesh_problem(name, coarse) for name in ("block", "ball")),
        momentum_problem(coarse),
        *(still_problem(name, coarse) for name in STILL_BEDS),
        *(beach_problem(ratio, coarse) for ratio in BEACH_TIMES),
        *(slope_problem(name, coarse) for name in RETURNS),
        bar_problem(coarse),
        *(composite_problem(ratio, coarse) for ratio in COMPOSITE_TIMES),
    ]


def sph_promise(quantity: str, unit: str, source: str, limit: float) -> Promise:
    """Promised result of a quantity. `unit`: of its error; `source`: of its reference; `limit`: tolerance of scheme
    `delta_sph`, the only one that is judged."""
    return Promise(quantity, unit, source, {"delta_sph": limit})


def slice_over(bed: Sequence[Sequence[float]], rows: int, duration: float, **basin: Any) -> dict[str, Any]:
    """Scene of a 2-D slice over a `bed` of points x, y [m], with so many rows of particles where it is deepest, for a
    `duration` [s]; `basin`: further keys of the basin."""
    x, y = np.array(bed).T
    depth, profile = float(-y.min()), np.stack([x - 0.5 * (x[0] + x[-1]), y], axis=1).tolist()
    floor = basin.get("floor", {}) | {"profile": profile} if np.ptp(y) else "free_slip"
    basin |= {"length": float(x[-1] - x[0]), "depth": depth, "floor": floor}
    return {"duration": duration, "basin": basin, "fluid": {"spacing": depth / rows, "kinematic_viscosity": 1e-6}}


def mesh_problem(name: str, coarse: bool) -> Problem:
    """Set-up of the mesh `name` (block or ball) fixed in still water, 0.4 m or ten (coarse: five) spacings across."""
    obstacle = {"mesh": str(table_path(name).with_suffix(".obj")), "at": [0.0, -0.4, 0.0]}
    basin = {"length": 0.8, "width": 0.8, "depth": 0.8, "obstacles": [obstacle]}
    fluid = {"spacing": 0.08 if coarse else 0.04, "kinematic_viscosity": 1e-6}
    promise = sph_promise(f"{name}: force of still water [N]", "%", "Archimedes; 1 %", 1.0)
    return Problem({"duration": 0.6, "basin": basin, "fluid": fluid}, (promise,), measure_buoyancy, name)


def measure_buoyancy(simulation: Simulation) -> Finding:
    """Run; measure the mean force on the mesh after its first 0.1 s."""
    weight = SPECIFIC_WEIGHT * simulation.basin.meshes[0].mesh.volume
    times, up = record_run(simulation, 0.05, lambda _: -simulation.fluid.impulse["obstacles"][1])
    force = (up[-1] - up[SETTLING_SAMPLES]) / (times[-1] - times[SETTLING_SAMPLES])
    curve = Curve("mesh", times[1:], np.diff(up) / np.diff(times) / weight)
    return Finding([percent_error(force, weight)], [curve], [], ("time [s]", "F / (rho g V)"))


def momentum_problem(coarse: bool) -> Problem:
    """Set-up of a column of water that falls over a block and up a slope of 1:5, in double precision."""
    block = {"min": [-0.3, -0.4], "max": [-0.1, -0.3]}
    scene = slice_over([[-1.0, -0.4], [0.0, -0.4], [1.0, -0.2]], 10 if coarse else 20, 0.5, obstacles=[block])
    scene["fluid"]["fill"] = [{"min": [-1.0, -0.4], "max": [-0.5, 0.0]}]
    promise = sph_promise("momentum of falling water, worst", "impulse of walls, bed, block", "sum of impulses", 1e-6)
    return Problem(scene | {"runtime": {"precision": "f64"}}, (promise,), measure_momentum, "momentum")


def measure_momentum(simulation: Simulation) -> Finding:
    """Run; compare the momentum of the water with the sum of all impulses on it."""

    def momenta(water: State) -> np.ndarray:
        given = simulation.fluid.impulse
        return np.stack([water.momentum, sum(given.values()), given["walls"] + given["obstacles"]])

    times, values = record_run(simulation, 0.025, momenta)
    gained, given, borne = np.moveaxis(values[1:], 1, 0)
    lost = np.linalg.norm(gained - given, axis=1) / np.linalg.norm(borne, axis=1)
    return Finding([absolute_error(lost.max())], [Curve("water", times[1:], lost)], [], ("time [s]", "lost"))


def still_problem(name: str, coarse: bool) -> Problem:
    """Set-up of still water over the bed of this name in STILL_BEDS."""
    promises = (
        sph_promise(f"{name}: rms speed [sqrt(g h)]", "1", "still water has none", 3e-3),
        sph_promise(f"{name}: level [spacings]", "1", "0 less g h^2 / (2 c^2)", 0.05),
        sph_promise(f"{name}: pressure on the bed, mean error [rho g h]", "%", "rho g depth; 1 %", 1.0),
        sph_promise(f"{name}: mean pressure on the bed [Pa]", "%", "rho g depth; 1 %", 1.0),
    )
    scene = slice_over(STILL_BEDS[name], *((10, 5.0) if coarse else (20, 60.0)))
    return Problem(scene, promises, measure_still, f"still, {name}", slow=True)


def measure_still(simulation: Simulation) -> Finding:
    """Run; measure rms speed [sqrt(g h)], water level [spacings], bed pressures: means over the run's last tenth."""
    fluid, ground, depth = simulation.fluid, cast(Ground, simulation.basin.ground), simulation.basin.depth
    x = np.linspace(-0.95, 0.95, 39)
    points = np.stack([x, ground.heights(np.stack([x, 0.0 * x], axis=1)), 0.0 * x], axis=1)
    points = points[points[:, 1] < -LEAST_ROWS * fluid.spacing]

    def motion(water: State) -> list[float]:
        speed = sqrt(np.square(water.velocity).sum(axis=1).mean() / (GRAVITY * depth))
        level = float(fluid.elevations(points[:3, [0, 2]]).mean()) + fluid.surface_drop
        return [speed, level / fluid.spacing, *fluid.pressures(points)]

    times, values = record_run(simulation, simulation.scene.duration / 100.0, motion)
    means = values[-STILL_SAMPLES:].mean(axis=0)
    pressure, exact = means[2:], -SPECIFIC_WEIGHT * points[:, 1]
    off = 100.0 * float(np.abs(pressure - exact).mean()) / (SPECIFIC_WEIGHT * depth)
    numbers = [*map(absolute_error, (means[0], means[1], off)), percent_error(pressure.mean(), exact.mean())]
    return Finding(numbers, [Curve("water", times[1:], values[1:, 0])], [], ("time [s]", "rms speed / sqrt(g h)"))


def flume_problem(
    name: str, scene: dict[str, Any], gauges: np.ndarray, promises: Sequence[Promise], compare: Compare
) -> Problem:
    """Set-up `name` of a flume with `gauges` at x (m,) [m] from the piston. `promises`: quantities and tolerances;
    `compare`: from times and records to value, reference and error of each."""

    def measure(simulation: Simulation) -> Finding:
        basin, ground = simulation.basin, simulation.basin.ground
        points = np.stack([basin.lower[0] + gauges, 0.0 * gauges], axis=1)

        def heights(water: State) -> np.ndarray:
            climbing = np.sort(water.position[water.position[:, 0] > basin.upper[0] - 1.5 * water.spacing, 1])
            ends = np.flatnonzero(np.diff(climbing, append=np.inf) > RUNUP_GAP * water.spacing)
            wall = climbing[ends[0]] + 0.5 * water.spacing if len(climbing) else np.nan
            climbed = ground.runup(water.position, water.spacing) if ground else np.nan
            return np.array([climbed, wall, *simulation.fluid.elevations(points)])

        times, records = record_run(simulation, SAMPLE_INTERVAL, heights)
        shown = zip(("on the bed", "on the wall", *(f"gauge {k + 1}" for k in range(len(gauges)))), records.T)
        curves = [Curve(label, times, column) for label, column in shown if np.isfinite(column).any()]
        return Finding(compare(times, records), curves, [], ("time [s]", "height [m]"))

    return Problem(scene, tuple(promises), measure, name, slow=True)


def beach_problem(ratio: float, coarse: bool) -> Problem:
    """Set-up of a solitary wave, whose height over depth is `ratio`, on the smooth beach."""
    depth, top, known = BEACH_DEPTH, BEACH_DEPTH * (2.0 * ratio + 0.2), table("synolakis1987_runup")
    bed = [[0.0, -depth], [BEACH_FOOT, -depth], [BEACH_FOOT + BEACH_COTANGENT * (depth + top), top]]
    name, like = f"solitary, H/d {ratio:g}", np.abs(known["height_over_depth"] / ratio - 1.0) <= LIKE_WAVES
    measured, theory = known["runup_over_depth"][like].mean(), 2.831 * sqrt(BEACH_COTANGENT) * ratio**1.25
    limit, source = 8.0 if ratio > BREAKING_RATIO else 5.0, "Synolakis 1987, mean of measured waves within 5 % of H/d"
    promises = (
        sph_promise(f"{name}: R/d", "%", f"{source}; {limit:g} %", limit),
        Promise(f"{name}: crest at the foot [d]", "%", "H/d"),
        Promise(f"{name}: R/d without friction", "%", "2.831 sqrt(cot b) (H/d)^1.25, Synolakis 1987"),
    )
    count = 2 if ratio > BREAKING_RATIO else 3

    def compare(times: np.ndarray, records: np.ndarray) -> list[Number]:
        runup, _, crest = np.fmax.reduce(records) / depth
        return [*map(percent_error, (runup, crest, runup), (measured, ratio, theory))][:count]

    maker = {"kind": "solitary", "height": ratio * depth}
    scene = slice_over(bed, 10 if coarse else 40, BEACH_TIMES[ratio], wavemaker=maker, floor=FRICTION)
    return flume_problem(name, scene, np.array([BEACH_FOOT]), promises[:count], compare)


def slope_problem(name: str, coarse: bool) -> Problem:
    """Set-up of regular waves that the wall or slope of this name in RETURNS reflects."""
    cotangent, expected, source, tolerance = RETURNS[name]
    foot, top = SHORE_X - cotangent * DEPTH, [SHORE_X + 0.4 * cotangent * DEPTH, 0.4 * DEPTH]
    gauges = foot - 0.6 * WAVELENGTH + np.array([-0.35, 0.0, 0.25])
    begin, end = (SHORE_X + 0.6 * WAVELENGTH) / GROUP_SPEED + 3.0 * PERIOD, (3.0 * SHORE_X - WAVELENGTH) / GROUP_SPEED
    promises = [Promise(f"{name}: height that comes back, of the incident", "%", source, tolerance)]

    def compare(times: np.ndarray, records: np.ndarray) -> list[Number]:
        _, even = resample_evenly(times, records[:, 2:], begin, SAMPLE_INTERVAL)
        back = reflection_ratio(SAMPLE_INTERVAL, even, gauges, DEPTH, (0.7 / PERIOD, 1.3 / PERIOD))
        return [(back, expected, 100.0 * (back - expected))]

    bed, maker = [[0.0, -DEPTH], [foot, -DEPTH], *([top] if cotangent else [])], {"height": HEIGHT, "period": PERIOD}
    scene = slice_over(bed, 10 if coarse else 20, end, wavemaker=maker)
    return flume_problem(name, scene, gauges, promises, compare)


def bar_problem(coarse: bool) -> Problem:
    """Set-up of regular waves over the bar, whose harmonics are fitted over the last periods."""
    known, order = table("dingemans_harmonics"), np.arange(1, 5)
    unit, source, wanted = "% error, rms", "Dingemans 1994, measured; {:g} %", zip(order, (5.0, 10.0, 15.0, 15.0))
    promises = [sph_promise(f"bar: rms of harmonic {n} [m]", unit, source.format(limit), limit) for n, limit in wanted]

    def compare(times: np.ndarray, records: np.ndarray) -> list[Number]:
        late = times > times[-1] - BAR_RECORD * BAR_PERIOD
        angle = 2.0 * pi / BAR_PERIOD * np.outer(times[late], order)
        parts = np.concatenate([np.cos(angle), np.sin(angle), np.ones((len(angle), 1))], axis=1)
        fitted = np.linalg.lstsq(parts, records[late, 2:], rcond=None)[0]
        found, measured = np.hypot(fitted[:4], fitted[4:8]), np.stack([known[f"a{n}_m"] for n in order])
        rms = [np.sqrt(np.mean(part**2, axis=1)) for part in (found, measured, found - measured)]
        return [(own, theirs, 100.0 * off / theirs) for own, theirs, off in zip(*rms)]

    maker, walls = {"height": BAR_WAVE_HEIGHT, "period": BAR_PERIOD}, {"x_max": "absorbing"}
    scene = slice_over(BAR_BED, 14 if coarse else 40, BAR_TIME, wavemaker=maker, walls=walls)
    return flume_problem("bar", scene, known["x_m"], promises, compare)


def composite_problem(ratio: float, coarse: bool) -> Problem:
    """Set-up of a solitary wave, whose height over depth is `ratio`, on the beach with a wall at its end."""
    known, name, source = table("composite_beach"), f"composite, H/d {ratio:g}", "Briggs et al. 1996, measured; {:g} %"
    own = known["height_over_depth"] == ratio
    (*places, _), (*highest, climbed) = known["x_m"][own], known["highest_m"][own]
    wanted = [("run-up on the wall", 8.0), *((f"highest at {x:g} m", 15.0) for x in places)]
    promises = [sph_promise(f"{name}: {what} [m]", "%", source.format(limit), limit) for what, limit in wanted]

    def compare(times: np.ndarray, records: np.ndarray) -> list[Number]:
        return [percent_error(*pair) for pair in zip(np.fmax.reduce(records)[1:], (climbed, *highest))]

    maker = {"kind": "solitary", "height": -ratio * COMPOSITE_BED[0][1]}
    scene = slice_over(COMPOSITE_BED, 10 if coarse else 20, COMPOSITE_TIMES[ratio], wavemaker=maker, floor=FRICTION)
    return flume_problem(name, scene, np.array(places) - COMPOSITE_BED[0][0], promises, compare)
