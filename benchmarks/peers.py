"""`bench --peers`: time of other programs, where they are installed, for tasks that this one has, too."""

from collections.abc import Callable, Iterator
from importlib.metadata import PackageNotFoundError, version
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any, NamedTuple, Self, TypeAlias, cast

import numpy as np

from benchmarks import another_python, pysph_dam, splishsplash
from benchmarks.another_python import Peer
from ocean_sim.conventions import Failed, Refused
from ocean_sim.machine import available_cores
from ocean_sim.verbs.shared import console

SURFACE_REPEATS, DAM_TURNS = 5, 3
MAX_PEER_SECONDS = 300.0  # of wall time [s]
WAVE_PERIOD, WAVE_COUNT, STEPS_PER_WAVE = 6.0, 20, 60  # of the response of a barge: [s], waves that pass, steps in each


class Spent(NamedTuple):
    """Time spent on a task [s]: by the clock, and of all processors."""

    wall: float
    cpu: float

    @classmethod
    def now(cls) -> Self:
        return cls(perf_counter(), process_time())

    def since(self, begin: "Spent") -> "Spent":
        return Spent(self.wall - begin.wall, self.cpu - begin.cpu)


Pairs: TypeAlias = list[tuple[Spent, Spent]]  # theirs and ours, measured by turns


class Dam(NamedTuple):
    """A dam break, one of the scenes of `bench`, with the method of the peer and our kind of fluid that compute it."""

    name: str
    lattice: tuple[int, int, int]
    method: str
    kind: str
    support: float | None  # of ours [spacings], by default its own; of theirs where it has a choice
    seconds: float = 0.0  # of wall time that a measurement takes [s], at least
    end: float = 0.0  # simulated time to which it goes [s], at least

    @property
    def task(self) -> str:
        """Name of the timed task; its unit is a step, or a simulated second if each program chooses its steps."""
        ours = self.kind if self.support is None else f"{self.kind} at {self.support:g} spacings"
        return f"{self.name}, its {self.method.upper()}, our {ours}, a {'simulated second' if self.end else 'step'}"

    def each(self, found: dict[str, Any]) -> Spent:
        """Time of one unit of the task, a step or a simulated second, from a measurement `found`."""
        count = found["simulated" if self.end else "steps"]
        return Spent(found["wall"] / count, found["cpu"] / count)


class Others(NamedTuple):
    """Another program, and the dam breaks for which it is compared with this one."""

    peer: Peer
    dams: tuple[Dam, ...]


PARTICLE_SPACING, WARM_UP_SECONDS = 0.05, 0.01  # [m]; simulated time that is not measured [s]
KINEMATIC_VISCOSITY = 0.01  # [m2/s] of theirs, and of ours where it bounds the steps that each makes
OTHERS = (
    Others(
        splishsplash,
        (
            Dam("dam_break_6k", (20, 15, 20), "wcsph", "mueller", 2.0, seconds=1.0),
            Dam("dam_break_50k", (37, 37, 37), "wcsph", "mueller", 2.0, seconds=2.0),
            Dam("dam_break_50k", (37, 37, 37), "wcsph", "delta_sph", 2.82, seconds=2.0),
            Dam("dam_break_50k", (37, 37, 37), "wcsph", "delta_sph", None, seconds=2.0),
            Dam("dam_break_250k", (63, 63, 63), "wcsph", "mueller", 2.0, seconds=4.0),
            Dam("dam_break_6k", (20, 15, 20), "dfsph", "dfsph", 2.0, end=0.5),
            Dam("dam_break_6k", (20, 15, 20), "dfsph", "dfsph", None, end=0.5),
        ),
    ),
    Others(
        pysph_dam,
        (
            Dam("dam_break_6k", (20, 15, 20), "wcsph", "mueller", 2.0, seconds=1.0),
            Dam("dam_break_50k", (37, 37, 37), "wcsph", "mueller", 2.0, seconds=2.0),
            Dam("dam_break_50k", (37, 37, 37), "delta-sph", "delta_sph", 2.6, seconds=4.0),
            Dam("dam_break_250k", (63, 63, 63), "wcsph", "mueller", 2.0, seconds=4.0),
            Dam("dam_break_6k", (20, 15, 20), "delta-sph", "delta_sph", 2.6, end=0.3),
        ),
    ),
)


def peers(pythons: list[Path], threads: int | None) -> Iterator[dict[str, Any]]:
    """Yield a row of each task as soon as it is measured: `peer`, `version`, `task`, `peer_s`, `ours_s`, `ratio` (ours
    over theirs), `peer_cpu_s`, `ours_cpu_s`, `cpu_ratio` for processor time, `peer_walls` (wall particles, not counted
    as water) and `failed` (reason, or None). Numbers are None if not measured. `pythons`: of environments that have
    SPlisHSPlasH and PySPH; all programs then use `threads`, by default all cores. Standard error names the next
    task."""
    yield measure_installed("pysplashsurf", "surface of 6144 particles", surface)
    yield measure_installed("capytaine", "response of a barge", response)
    for others in OTHERS:
        yield from dam_breaks(others, pythons, threads or available_cores())


def must_have_one(pythons: list[Path]) -> None:
    """Raise Refused if a Python runs but has none of the programs that are looked for there."""
    for python in pythons:
        try:
            found = [another_python.version_in(others.peer, python) for others in OTHERS]
        except (OSError, ValueError):
            continue
        if not any(found):
            names = " nor ".join(others.peer.PACKAGE for others in OTHERS)
            raise Refused(f"--peer-python {python}: this Python has neither {names}; install one of them there")


def dam_breaks(others: Others, pythons: list[Path], threads: int) -> Iterator[dict[str, Any]]:
    """Yield a row for each dam break of a peer, run by the first Python that has it, up to the first that fails."""
    peer = others.peer
    try:
        place = find_peer(peer, pythons)
    except (OSError, ValueError) as error:
        yield table_row(peer.PEER, None, "dam breaks", [], str(error))
        return
    if place is None:
        yield table_row(peer.PEER, None, "dam breaks", [])
        return
    with TemporaryDirectory(ignore_cleanup_errors=True) as folder:  # where a compiler may outlive its program
        for dam in others.dams:
            found = dam_break(peer, dam, *place, threads, folder)
            yield found
            if found["failed"] is not None:
                return


def find_peer(peer: Peer, pythons: list[Path]) -> tuple[Path, str] | None:
    """First Python that has a peer, and its version there; if there is none, None, or ValueError if a Python does not
    run."""
    failed = ""
    for python in pythons:
        try:
            found = another_python.version_in(peer, python)
        except (OSError, ValueError) as error:
            failed = failed or f"it does not run under {python}: {error}"
            continue
        if found is not None:
            return python, found
    if failed:
        raise ValueError(failed)
    return None


def measure_installed(peer: str, task: str, measured: Callable[[], Pairs]) -> dict[str, Any]:
    """Measure another program that is installed in this environment: a row of the table, without numbers if absent."""
    try:
        found = version(peer)
    except PackageNotFoundError:
        return table_row(peer, None, task, [])
    announce(peer, task)
    try:
        return table_row(peer, found, task, measure_apart(measured))
    except Failed as error:
        return table_row(peer, found, task, [], str(error))


def announce(peer: str, task: str) -> None:
    console.complain(f"measuring {peer}: {task} ...")


def measure_apart(measured: Callable[[], Pairs]) -> Pairs:
    """Measure in a child process, as a peer may crash or hang; raises Failed."""
    context = get_context("spawn")
    here, there = context.Pipe(duplex=False)
    child = context.Process(target=send_times, args=(measured, there))
    child.start()
    there.close()
    try:
        if not here.poll(MAX_PEER_SECONDS):
            raise Failed(f"it was not done after {MAX_PEER_SECONDS:g} s")
        found = here.recv()
    except EOFError:
        child.join()
        raise Failed(f"its process died ({child.exitcode})") from None
    finally:
        child.kill()
        child.join()
    if isinstance(found, str):
        raise Failed(found)
    return found


def send_times(measured: Callable[[], Pairs], there: Connection) -> None:
    """Send the measured times to the parent process, or the error as text."""
    try:
        there.send(measured())
    except Exception as error:  # whatever a program of others raises
        there.send(f"{type(error).__name__}: {error}")


def table_row(
    peer: str, found: str | None, task: str, times: Pairs, failed: str | None = None, walls: int = 0
) -> dict[str, Any]:
    """Row of the table with medians of `times`; `failed`: reason if there are none; `walls`: particles of its walls."""
    row = {"peer": peer, "version": found, "task": task, "peer_walls": walls, "failed": failed}
    for head, what in (("", "wall"), ("cpu_", "cpu")):
        pairs = [(getattr(theirs, what), getattr(ours, what)) for theirs, ours in times]
        medians = [median(column) for column in zip(*((a, b, b / a) for a, b in pairs))] or [None] * 3
        row |= dict(zip((f"peer_{head}s", f"ours_{head}s", f"{head}ratio"), medians))
    return row


def dam_break(peer: Peer, dam: Dam, python: Path, version: str, threads: int, folder: str) -> dict[str, Any]:
    """Measure the peer and this program alternately, each run from the start; `folder`: for the peer's files."""
    order = {"method": dam.method, "lattice": dam.lattice, "spacing": PARTICLE_SPACING, "support": dam.support}
    order |= {"begin": WARM_UP_SECONDS, "seconds": dam.seconds, "end": dam.end, "viscosity": KINEMATIC_VISCOSITY}
    order |= {"threads": threads, "folder": folder}
    times: Pairs = []
    announce(peer.PEER, dam.task)
    try:
        measure_here(dam, threads)  # which compiles
        for _ in range(DAM_TURNS):
            theirs, ours = another_python.measure_peer(peer, python, order), measure_here(dam, threads)
            if theirs["particles"] != ours["particles"]:
                raise ValueError(f"{theirs['particles']} particles there, {ours['particles']} here")
            times.append((dam.each(theirs), dam.each(ours)))
    except (OSError, ValueError) as error:
        return table_row(peer.PEER, version, dam.task, [], f"it does not run under {python}: {error}")
    return table_row(peer.PEER, version, dam.task, times, walls=theirs["walls"])


def unobserved() -> dict[str, Any]:
    """Settings that switch off all observers of a scene but the manifest."""
    from ocean_sim.reading.scene import observer_names

    return {name: None for name in observer_names() if name != "manifest"}


def measure_here(dam: Dam, threads: int) -> dict[str, Any]:
    """Measure a dam break with this program; keys are those of `another_python.measure_peer`, except `walls`."""
    from ocean_sim.fluid import with_particles
    from ocean_sim.reading.scene import load
    from ocean_sim.simulation import Simulation

    laid = unobserved() | {
        "runtime.threads": threads,
        "fluid.kind": dam.kind,
        "fluid.support_ratio": dam.support,
    }
    if dam.end:
        laid |= {"time_step": "courant", "fluid.kinematic_viscosity": KINEMATIC_VISCOSITY}
    with Simulation(load(f"bench/{dam.name}", laid)) as simulation:
        simulation.run(WARM_UP_SECONDS)
        time, steps, began = simulation.time, simulation.steps, Spent.now()
        spent = Spent(0.0, 0.0)
        while spent.wall < dam.seconds or simulation.time < dam.end or simulation.steps == steps:
            simulation.step()
            spent = Spent.now().since(began)
        return {
            "particles": with_particles(simulation.fluid).particles.n,
            "steps": simulation.steps - steps,
            **spent._asdict(),
            "simulated": simulation.time - time,
        }


def interleaved(theirs: Callable[[], object], ours: Callable[[], object], prepare: Callable[[], object]) -> Pairs:
    """Time both functions alternately, so that other load of the machine affects both; the first round, which compiles,
    is not counted. `prepare`: runs before ours, not timed."""
    times = []
    for _ in range(SURFACE_REPEATS + 1):
        begin = Spent.now()
        theirs()
        between = Spent.now()
        prepare()
        began = Spent.now()
        ours()
        times.append((between.since(begin), Spent.now().since(began)))
    return times[1:]


def surface() -> Pairs:
    """Time to triangulate the surface of the same particles; cubes of half a spacing, kernels of twice a spacing."""
    import pysplashsurf

    from ocean_sim.fluid import with_particles
    from ocean_sim.reading.scene import load
    from ocean_sim.simulation import Simulation
    from ocean_sim.surface.marching_cubes import MarchingCubes

    with Simulation(load("bench/dam_break_6k", {**unobserved(), "surface": "marching_cubes"})) as simulation:
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
    """Time for heave and pitch of barge20 in a head sea of one period: a panel method, and this program's run in
    time."""
    import capytaine

    from ocean_sim.reading.scene import load
    from ocean_sim.simulation import Simulation

    mesh = capytaine.mesh_parallelepiped(size=(20.0, 8.0, 4.0), resolution=(20, 8, 4)).immersed_part()
    body = capytaine.FloatingBody(mesh=mesh, dofs=capytaine.rigid_body_dofs(rotation_center=(0.0, 0.0, 0.5)))
    solver = capytaine.BEMSolver()
    omega = 2.0 * np.pi / WAVE_PERIOD
    problems = [capytaine.RadiationProblem(body=body, radiating_dof=dof, omega=omega) for dof in ("Heave", "Pitch")]
    problems.append(capytaine.DiffractionProblem(body=body, wave_direction=np.pi, omega=omega))
    scene = {
        "basin": {"length": 800.0, "width": 800.0, "depth": 400.0, "walls": "none"},
        "fluid": {"kind": "linear_waves", "height": 0.08, "period": WAVE_PERIOD, "heading_deg": 180.0},
        "ship": {"kind": "dynamic", "hull": "barge20", "free": ["heave", "pitch"], "cells_per_draught": 4},
        "time_step": {"kind": "fixed", "dt": WAVE_PERIOD / STEPS_PER_WAVE},
    }
    with Simulation(load(scene | unobserved())) as simulation:
        return interleaved(
            lambda: solver.solve_all(problems, progress_bar=False),
            lambda: simulation.run(simulation.time + WAVE_COUNT * WAVE_PERIOD),
            lambda: None,
        )


def sentence(row: dict[str, Any]) -> str:
    """Row of the table as a sentence to print."""
    if row["failed"] is not None:
        return f"{row['peer']}, {row['task']}: not measured: {row['failed']}"
    if row["version"] is None:
        return f"{row['peer']}: not installed; {remedy(row['peer'])}"
    theirs, ours = (
        f"{row[key]:.3g} s" if row[key] > 1.0 else f"{1e3 * row[key]:.3g} ms" for key in ("peer_s", "ours_s")
    )
    times = f"by turns {row['ratio']:.3g} times, of processor time {row['cpu_ratio']:.3g} (medians)"
    walls = f"; its walls are {row['peer_walls']} particles more" if row["peer_walls"] else ""
    return f"{row['peer']} {row['version']}, {row['task']}: {theirs}, here {ours}: {times}{walls}"


def remedy(peer: str) -> str:
    """Command that installs a peer."""
    for other, _ in OTHERS:
        if peer == other.PEER:
            return f"pip install {other.INSTALLED} into an environment of its own, and name that by --peer-python"
    return "pip install 'ocean-sim[peers]' brings it"
