"""report.html: one page that says what was run and how it went, with its curves; nothing in it needs a network."""

import html
import os
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ocean_sim.observers._counted import described
from ocean_sim.observers._csv import columns
from ocean_sim.observers._plot import curves
from ocean_sim.parts import ObserverConfig

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #16242c; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
h1 { margin-bottom: 0; } h2 { margin-top: 2rem; } img, svg { width: 100%; height: auto; }
.stopped { color: #9c2b12; } table { border-collapse: collapse; }
td { padding: .15rem 1rem .15rem 0; vertical-align: top; } td:first-child { color: #5a6d78; }
"""


class Config(ObserverConfig):
    """Nothing to choose: the page is written when the run is over."""

    def build(self, folder: Path, simulation: "Simulation") -> "Report":
        return Report(folder, simulation)


class Report:
    """Reads what the other observers wrote; holds no clock value, only a link to timings.csv."""

    every = 0.0

    def __init__(self, folder: Path, simulation: "Simulation") -> None:
        self.folder, self.simulation = folder, simulation

    def observe(self, simulation: "Simulation") -> None:
        pass

    def close(self) -> None:
        beside = self.folder / ".report.html.tmp"
        beside.write_text(self.page(), encoding="utf-8")
        os.replace(beside, self.folder / "report.html")

    def page(self) -> str:
        simulation, scene = self.simulation, self.simulation.scene
        title = html.escape(scene.title or "Untitled scene")
        ended = f"{simulation.outcome} at t = {simulation.time:.3f} s after {simulation.steps} steps"
        reason = f": {simulation.reason}" if simulation.reason else ""
        return "\n".join(
            [
                f'<!doctype html>\n<html lang="en">\n<meta charset="utf-8">\n<title>{title}</title>',
                f"<style>{STYLE}</style>",
                f'<h1>{title}</h1>\n<p class="{simulation.outcome}">{html.escape(ended + reason)}</p>',
                # Pictures come last and only where there is OpenGL: a missing one takes itself off the page.
                '<a href="film.mp4"><img src="preview.png" alt="The water" onerror="this.parentNode.remove()"></a>',
                table(self.facts()),
                *self.gauges(),
                *self.accuracy(),
                "<h2>Files</h2>",
                f"<p>{' · '.join(self.files())}</p>",
                "</html>\n",
            ]
        )

    def facts(self) -> Iterable[tuple[str, str]]:
        """What was run, in a dozen rows."""
        simulation, scene = self.simulation, self.simulation.scene
        basin, fluid, backend = simulation.basin, simulation.fluid, simulation.backend
        width = f" x {basin.config.width:g}" if basin.config.width else ""
        yield "basin", f"{basin.config.length:g}{width} m, {basin.depth:g} m deep"
        yield "fluid", f"{scene.fluid.kind}, {described(fluid)}"
        if fluid.sound_speed > 0.0:
            yield "sound speed", f"{fluid.sound_speed:.4g} m/s"
        for slot in ("wind", "surface", "ship", "platform", "time_step"):
            part = getattr(scene, slot)
            if part is not None:
                yield slot.replace("_", " "), part.kind
        threads = f", {backend.threads} threads" if backend.threads else ""
        yield "machine", f"{backend.arch}, {backend.precision}{threads}"
        yield "seed", str(scene.seed)

    def gauges(self) -> Iterable[str]:
        table = self.read("gauges.csv")
        heights = {name[:-2]: values for name, values in table.items() if name.endswith("_m")}
        if heights:
            yield "<h2>Wave gauges</h2>"
            yield curves(table["time_s"], heights, "elevation [m]")

    def accuracy(self) -> Iterable[str]:
        table = self.read("accuracy.csv")
        if "compression_mean" not in table:  # water without particles keeps no balances
            return
        time = table["time_s"]
        density = {
            "compression, mean": table["compression_mean"],
            "compression, largest": table["compression_max"],
            "surface deficit, mean": table["surface_deficit_mean"],
        }
        energy = {name: table[f"{name}_energy_J"] / 1000.0 for name in ("kinetic", "potential", "internal")}
        momentum = {f"along {axis}": table[f"momentum_{axis}_kg_m_s"] / 1000.0 for axis in "xyz"}
        terms = [name.split("_")[1] for name in table if name.startswith("impulse_") and name.endswith("_x_Ns")]
        horizontal = {
            term: np.hypot(table[f"impulse_{term}_x_Ns"], table[f"impulse_{term}_z_Ns"]) / 1000.0 for term in terms
        }
        yield "<h2>Accuracy</h2>"
        yield curves(time, {name: 100.0 * values for name, values in density.items()}, "density error [%]")
        yield curves(time, energy, "energy [kJ]")
        yield curves(time, momentum, "momentum [kN s]")
        if horizontal:
            yield curves(time, horizontal, "horizontal impulse by force [kN s]")

    def files(self) -> Iterable[str]:
        names = ("manifest.json", "timings.csv", "accuracy.csv", "gauges.csv", "events.jsonl")
        return [f'<a href="{name}">{name}</a>' for name in names if (self.folder / name).exists()]

    def read(self, name: str) -> dict[str, np.ndarray]:
        """The columns of a CSV of this run; empty where it was not written or holds no row."""
        path = self.folder / name
        table = columns(path) if path.exists() else {}
        return table if table and len(table["time_s"]) else {}


def table(rows: Iterable[tuple[str, str]]) -> str:
    cells = "\n".join(f"<tr><td>{html.escape(name)}</td><td>{html.escape(value)}</td></tr>" for name, value in rows)
    return f"<table>\n{cells}\n</table>"
