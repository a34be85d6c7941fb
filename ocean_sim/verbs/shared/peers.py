"""`bench --peers`: what other programs take for a task that this one has, too, where they are installed."""

from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from statistics import median
from time import perf_counter
from typing import Any, TypeAlias, cast

import numpy as np

REPEATS = 5
Pairs: TypeAlias = list[tuple[float, float]]  # theirs and ours [s], measured by turns
PERIOD, WAVES, STEPS = 6.0, 20, 60  # of the response of a barge: [s], waves that pass, steps in each


def peers() -> list[dict[str, Any]]:
    """One row of each: `peer`, `version`, `task`, `peer_s`, `ours_s`, `ratio` (ours over theirs); no numbers where it
    is not installed."""
    return [
        row("pysplashsurf", "surface of 6144 particles", surface),
        row("capytaine", "response of a barge", response),
    ]


def row(peer: str, task: str, measured: Callable[[], Pairs]) -> dict[str, Any]:
    try:
        found = version(peer)
    except PackageNotFoundError:
        return {"peer": peer, "version": None, "task": task, "peer_s": None, "ours_s": None, "ratio": None}
    times = measured()
    theirs, ours = (median(both[k] for both in times) for k in range(2))
    ratio = median(our / their for their, our in times)
    return {"peer": peer, "version": found, "task": task, "peer_s": theirs, "ours_s": ours, "ratio": ratio}


def interleaved(theirs: Callable[[], object], ours: Callable[[], object], prepare: Callable[[], object]) -> Pairs:
    """Wall times of both, by turns, so that what else the machine does strikes both alike; the first turn, which
    compiles, is left out. `prepare`: what comes before ours and is not measured."""
    times = []
    for _ in range(REPEATS + 1):
        begin = perf_counter()
        theirs()
        between = perf_counter()
        prepare()
        began = perf_counter()
        ours()
        times.append((between - begin, perf_counter() - began))
    return times[1:]


def surface() -> Pairs:
    """Triangles around the same particles, cubes of half a spacing, kernels of twice a spacing."""
    import pysplashsurf

    from ocean_sim.fluid import with_particles
    from ocean_sim.reading.scene import load, observer_names
    from ocean_sim.simulation import Simulation
    from ocean_sim.surface.marching_cubes import MarchingCubes

    quiet = {name: None for name in observer_names() if name != "manifest"}
    with Simulation(load("bench/dam_break_6k", {**quiet, "surface": "marching_cubes"})) as simulation:
        for _ in range(20):
            simulation.step()
        water, own = with_particles(simulation.fluid), cast(MarchingCubes, simulation.surface)
        spacing = water.spacing
        at = water.positions().astype(np.float32)
        keys = {"particle_radius": 0.5 * spacing, "smoothing_length": spacing, "cube_size": 0.5 * spacing}
        return interleaved(
            lambda: pysplashsurf.reconstruct_surface(at, **keys),
            own.mesh,
            simulation.step,  # or it would be the surface that it has already made
        )


def response() -> Pairs:
    """Heave and pitch of barge20 in a head sea of one period: a panel method in frequency, and a run in time."""
    import capytaine

    from ocean_sim.reading.scene import load, observer_names
    from ocean_sim.simulation import Simulation

    mesh = capytaine.mesh_parallelepiped(size=(20.0, 8.0, 4.0), resolution=(20, 8, 4)).immersed_part()
    body = capytaine.FloatingBody(mesh=mesh, dofs=capytaine.rigid_body_dofs(rotation_center=(0.0, 0.0, 0.5)))
    solver = capytaine.BEMSolver()
    omega = 2.0 * np.pi / PERIOD
    problems = [capytaine.RadiationProblem(body=body, radiating_dof=dof, omega=omega) for dof in ("Heave", "Pitch")]
    problems.append(capytaine.DiffractionProblem(body=body, wave_direction=np.pi, omega=omega))
    quiet = {name: None for name in observer_names() if name != "manifest"}
    scene = {
        "basin": {"length": 800.0, "width": 800.0, "depth": 400.0, "walls": "none"},
        "fluid": {"kind": "linear_waves", "height": 0.08, "period": PERIOD, "heading_deg": 180.0},
        "ship": {"kind": "dynamic", "hull": "barge20", "free": ["heave", "pitch"], "cells_per_draught": 4},
        "time_step": {"kind": "fixed", "dt": PERIOD / STEPS},
    }
    with Simulation(load(scene | quiet)) as simulation:
        return interleaved(
            lambda: solver.solve_all(problems, progress_bar=False),
            lambda: simulation.run(simulation.time + WAVES * PERIOD),
            lambda: None,
        )


def sentence(row: dict[str, Any]) -> str:
    """A row for people."""
    if row["version"] is None:
        return f"{row['peer']}: not installed; pip install 'ocean-sim[peers]' brings it"
    theirs, ours = (f"{1e3 * row[key]:.3g} ms" for key in ("peer_s", "ours_s"))
    return f"{row['peer']} {row['version']}, {row['task']}: {theirs}, here {ours}: {row['ratio']:.3g} times"
