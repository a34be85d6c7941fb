"""Resolved scene, versions, backend and seed at the start of a run; outcome and hashes at its end."""

import hashlib
import json
import platform
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from ocean_sim import kernel_library
from ocean_sim.files import input_file, run_files
from ocean_sim.files.atomic_file import write_facts
from ocean_sim.machine import installed_version, program_hash
from ocean_sim.parts import ObserverConfig
from ocean_sim.simulation import OutcomeObserver, Simulation

LIBRARIES = ("numpy", "scipy", "pydantic", "pyyaml", "h5py", "pyvista", "vtk")
PACKAGE_NAMES = ("ocean-sim", kernel_library.LIBRARY_NAME, *LIBRARIES)


class Config(ObserverConfig):
    """No keys: the manifest is written at the start and at the end."""

    turn: ClassVar[int] = 2
    leaves: ClassVar[str] = "manifest.json"


class Manifest(OutcomeObserver, of=Config):
    """Writes manifest.json, the facts of a run, without clock values, so that equal runs leave equal files."""

    left_out = ("facts",)  # the program that goes on has its own

    def __init__(self, config: Config, folder: Path, simulation: Simulation) -> None:
        self.path, self.simulation = folder / "manifest.json", simulation
        scene, fluid, backend = simulation.scene.resolved(), simulation.fluid, simulation.backend
        self.facts: dict[str, Any] = {
            "outcome": "running",
            "scene": scene,
            "scene_sha256": hashlib.sha256(json.dumps(scene, sort_keys=True).encode()).hexdigest(),
            "inputs": simulation.scene.inputs(),
            "seed": simulation.scene.seed,
            "versions": {"python": platform.python_version()}
            | {name: installed_version(name) for name in PACKAGE_NAMES},
            "sources_sha256": program_hash(),
            "machine": {"system": platform.system(), "processor": platform.machine()},
            "backend": {"arch": backend.arch, "threads": backend.threads, "precision": backend.precision},
            "particles": {
                "count": fluid.count,
                "spacing_m": fluid.spacing if fluid.count else None,
                "mass_kg": float(fluid.particles.mass) if fluid.particles is not None else None,
            },
            "warnings": simulation.scene.warnings(),
            "ledger": [row._asdict() for row in simulation.scene.ledger()],
            "files": simulation.scene.files(),
        }
        self.write()

    def resumed(self, changed: str) -> None:
        """Add to the manifest the time at which the run was resumed, and `changed`, how the program differs since."""
        before, now = input_file.read_json(self.path), round(self.simulation.time, 9)
        self.facts["resumed_s"] = [*before.get("resumed_s", []), now]
        changes = [each for each in before.get("changed", []) if each["from_s"] < now]
        changes += [{"from_s": now, "what": changed}] if changed else []
        if changes:
            self.facts["changed"] = changes
            said = [f"from t = {each['from_s']:g} s on by another program: {each['what']}" for each in changes]
            self.facts["warnings"] = [*self.facts["warnings"], *said]
        self.write()

    def close(self) -> None:
        simulation = self.simulation
        self.facts |= {
            "outcome": simulation.outcome,
            "reason": simulation.reason,
            "steps": simulation.steps,
            "simulated_s": round(simulation.time, 9),
            "particles": self.facts["particles"] | {"count": simulation.fluid.count},
            "state_sha256": state_sha256(simulation) if simulation.outcome != "failed" else None,
        }
        self.write()

    def amend(self) -> None:
        self.close()

    def write(self) -> None:
        """Write the manifest; files that other programs have added to the list on disk since stay in it."""
        if before := run_files.read_manifest(self.path.parent):
            self.facts["files"] = sorted({*self.facts["files"], *run_files.listed_files(before)})
        write_facts(self.path, self.facts)


def state_sha256(simulation: Simulation) -> str:
    """SHA-256 of the final particles, sorted by id, and ships; without particles, of heights along a basin diagonal."""
    particles = simulation.fluid.particles
    if particles is None:
        points = np.linspace(simulation.basin.lower, simulation.basin.upper, 101)[:, [0, 2]]
        state = [simulation.fluid.elevations(points)]
    else:
        snapshot = particles.snapshot()
        order = np.argsort(snapshot.id, kind="stable")
        state = [snapshot.position[order], snapshot.velocity[order]]
    for ship in simulation.ships.values():
        state += [ship.body.position, ship.body.orientation, ship.body.velocity, ship.body.angular_momentum]
    return hashlib.sha256(b"".join(np.ascontiguousarray(array).tobytes() for array in state)).hexdigest()
