"""The page report.html of a run folder: scene, outcome, pictures, curves and events."""

import html
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ocean_sim.files import csv_file, input_file
from ocean_sim.files.atomic_file import write_file
from ocean_sim.observers.shared.page import draw_curves, embedded_picture, html_page, html_table, scene_text

MAX_STILLS = 6  # in a page
MAX_EDGE_EVENTS = 60  # that are shown from the beginning, and as many from the end
DEGREES = float(np.degrees(1.0))  # a radian
FILES = (
    *("manifest.json", "motion.csv", "platform.csv", "gauges.csv", "accuracy.csv", "timings.csv", "events.jsonl"),
    *("film.mp4", "preview.png", "moments.png", "strip.png"),
)
Table = Mapping[str, np.ndarray]


def write_report(folder: Path) -> Path:
    """Write report.html of a run folder, however the run ended; returns its path."""
    run, path = Run(folder), folder / "report.html"
    write_file(path, html_page(run.title, run.parts()))
    return path


class Run:
    """Run folder, and the HTML parts that report.html shows of it; a missing or incomplete file is left out."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.manifest: dict[str, Any] = input_file.read_json_object(folder / "manifest.json")
        self.scene: dict[str, Any] = self.manifest.get("scene") or {}
        self.title = self.scene.get("title") or "Untitled scene"
        self.events = whole_lines(folder / "events.jsonl")

    def parts(self) -> Iterator[str]:
        """Yield the HTML parts of the page from top to bottom."""
        yield f"<h1>{html.escape(self.title)}</h1>"
        yield self.outcome()
        if (self.folder / "replay.html").exists():
            yield '<p><a href="replay.html">Replay of the run</a>: look around, and scrub in time.</p>'
        yield from self.pictures()
        yield html_table(self.summary_rows())
        yield from self.warnings()
        for part in (self.motions, self.platform, self.gauges, self.accuracy, self.timings):
            yield from part()
        yield from self.event_table()
        if self.scene:
            yield f"<h2>Scene</h2>\n<p>With all defaults.</p>\n<pre>{html.escape(scene_text(self.scene))}</pre>"
        yield from self.versions()
        yield from self.file_links()

    def outcome(self) -> str:
        manifest, outcome = self.manifest, self.manifest.get("outcome", "unknown")
        if outcome == "running":
            sentence = "This run has not ended: it is still running, or was killed."
        elif not manifest:
            sentence = "This run left no manifest that can be read."
        else:
            sentence = f"{outcome} at t = {manifest['simulated_s']:.3f} s after {manifest['steps']} steps"
            sentence += f": {manifest['reason']}" if manifest.get("reason") else ""
        return f'<p class="outcome{"" if outcome == "done" else " bad"}">{html.escape(sentence)}</p>'

    def pictures(self) -> Iterator[str]:
        folder, film = self.folder, "film.mp4" if (self.folder / "film.mp4").exists() else None
        more = "; click for film.mp4, next to this page" if film else ""
        yield embedded_picture(folder / "preview.png", f"The run at its liveliest{more}.", film)
        yield embedded_picture(folder / "moments.png", "The film, from the beginning to the end.", film)
        yield embedded_picture(folder / "strip.png", "From the beginning to the end.")
        for path in sorted(folder.glob("still_*.png"))[:MAX_STILLS]:
            yield embedded_picture(path, f"t = {path.stem.removeprefix('still_').lstrip('0') or '0'} s")

    def summary_rows(self) -> Iterator[tuple[str, str]]:
        """Yield about a dozen rows (name, text) on the scene and the machine."""
        scene, manifest = self.scene, self.manifest
        basin = scene.get("basin", {})
        if "depth" in basin:
            width = f" x {basin['width']:g}" if basin.get("width") else ""
            yield "basin", f"{basin['length']:g}{width} m, {basin['depth']:g} m deep"
        count = manifest.get("particles", {})
        if count:
            apart = f"{count['count']} particles, {count['spacing_m']:.4g} m apart" if count.get("count") else ""
            yield "fluid", f"{scene.get('fluid', {}).get('kind', 'unknown')}, {apart or 'in closed form'}"
        for part in (scene.get("sea"), scene.get("fluid")):
            yield from (("waves", sentence) for sentence in wave_trains(part or {}))
        sound = next((event["sound_speed_m_s"] for event in self.events if event.get("sound_speed_m_s")), None)
        if sound:
            yield "sound speed", f"{sound:.4g} m/s"
        parts = {slot: scene.get(slot) for slot in ("wind", "surface", "ship", "platform", "time_step")}
        parts |= {f"ship {name}": ship for name, ship in scene.get("ships", {}).items()}
        for slot, part in parts.items():
            if part:
                hull = f", {part['hull']}" if isinstance(part.get("hull"), str) else ""
                gain = f", {part['gain']:g} times a real wind (gain)" if slot == "wind" and "gain" in part else ""
                yield slot.replace("_", " "), f"{part.get('kind', 'unknown')}{hull}{gain}"
        backend = manifest.get("backend")
        if backend:
            threads = f", threads: {backend['threads']}" if backend.get("threads") else ""
            yield "machine", f"{backend['arch']}, {backend['precision']}{threads}"
        if "seed" in manifest:
            yield "seed", str(manifest["seed"])

    def warnings(self) -> Iterator[str]:
        warnings = self.manifest.get("warnings", [])
        if warnings:
            rows = "".join(f"<li>{html.escape(sentence)}</li>" for sentence in warnings)
            yield f"<h2>Warnings</h2>\n<ul>{rows}</ul>"

    def table(self, name: str) -> Table:
        """Columns, by name, of a CSV file in the run folder; empty if there is no such file."""
        return csv_file.read_columns_if_any(self.folder / name)

    def motions(self) -> Iterator[str]:
        yield from motion_plots("Motions of the ship", self.table("motion.csv"))
        for name in self.scene.get("ships", {}):
            yield from motion_plots(f"Motions of {name}", self.table(f"motion_{name}.csv"))

    def platform(self) -> Iterator[str]:
        log = self.table("platform.csv")
        if "leg1_m" not in log:
            return
        machine = (self.scene.get("platform") or {}).get("geometry")
        ends = machine if isinstance(machine, dict) else {}
        reach = {name: ends[name] for name in ("shortest", "longest") if name in ends}  # [m]
        fastest = ends.get("leg_speed")  # [m/s]
        both = {} if fastest is None else {"fastest": fastest, "fastest, shortening": -fastest}
        legs, axes = range(1, 7), "xyz"
        yield "<h2>Motion platform</h2>"
        yield draw(log, "length of the legs [m]", {f"leg {k}": f"leg{k}_m" for k in legs}, limits=reach)
        yield draw(log, "velocity of the legs [m/s]", {f"leg {k}": f"leg{k}_velocity_m_s" for k in legs}, limits=both)
        angles = {name: f"{name}_rad" for name in ("roll", "pitch", "yaw")}
        yield draw(log, "attitude of the platform [deg]", angles, DEGREES)
        yield draw(log, "position of the platform [m]", {axis: f"{axis}_m" for axis in axes})
        felt = {axis: f"felt_force_{axis}_m_s2" for axis in axes}
        yield draw(log, "specific force on the platform [m/s2]", felt)
        share = float(np.mean(log["limited"] > 0.0))
        yield f"<p>A limit was reached in {100.0 * share:.3g} % of the rows.</p>"

    def gauges(self) -> Iterator[str]:
        log = self.table("gauges.csv")
        heights = columns_between(log, "", "_m")
        pressures = columns_between(log, "", "_Pa")
        if heights or pressures:
            yield "<h2>Gauges</h2>"
        if heights:
            yield draw(log, "elevation [m]", heights)
            rows = [
                (name, f"{4.0 * np.nanstd(v):.3g}", f"{np.nanmin(v):.3g}", f"{np.nanmax(v):.3g}")
                for name, v in ((name, log[column]) for name, column in heights.items())
                if not np.isnan(v).all()
            ]
            yield html_table(rows, ("gauge", "4 standard deviations [m]", "least [m]", "greatest [m]"))
        if pressures:
            yield draw(log, "pressure [kPa]", pressures, 0.001)

    def accuracy(self) -> Iterator[str]:
        log = self.table("accuracy.csv")
        if "compression_mean" not in log:  # water without particles keeps no balances
            return
        density = {
            "compression, mean": "compression_mean",
            "compression, largest": "compression_max",
            "surface deficit, mean": "surface_deficit_mean",
        }
        energy = {name: f"{name}_energy_J" for name in ("kinetic", "potential", "internal")}
        yield "<h2>Accuracy</h2>"
        yield draw(log, "density error [%]", density, 100.0)
        yield draw(log, "energy [kJ]", energy, 0.001)
        yield draw(log, "momentum [kN s]", {f"along {axis}": f"momentum_{axis}_kg_m_s" for axis in "xyz"}, 0.001)
        impulses = columns_between(log, "impulse_", "_x_Ns")
        horizontal = {name: np.hypot(log[x], log[x.replace("_x_Ns", "_z_Ns")]) for name, x in impulses.items()}
        acting = {name: name for name, values in horizontal.items() if values.max() > 0.0}
        yield draw({"time_s": log["time_s"]} | horizontal, "horizontal impulse by force [kN s]", acting, 0.001)
        if "time_step_s" in log:
            yield draw(log, "time step [ms]", {"time step": "time_step_s"}, 1000.0)

    def timings(self) -> Iterator[str]:
        log = self.table("timings.csv")
        stages = columns_between(log, "", "_ms_per_step")
        if not stages:
            return
        steps = np.maximum(np.diff(np.concatenate([[0.0], log["steps"]])), 1.0)
        means = {name: float(np.average(log[column], weights=steps)) for name, column in stages.items()}
        total = sum(means.values())
        rows = [(name, f"{value:.3g}", f"{100.0 * value / total:.3g}") for name, value in means.items() if total]
        yield "<h2>Timings</h2>"
        yield html_table(rows, ("stage", "milliseconds a step", "share [%]"))
        yield draw(log, "milliseconds a step", stages)
        yield draw(log, "simulated time over wall time", {"real-time factor": "real_time_factor"})

    def event_table(self) -> Iterator[str]:
        if not self.events:
            return
        yield "<h2>Events</h2>"
        n = MAX_EDGE_EVENTS
        shown = self.events if len(self.events) <= 2 * n else [*self.events[:n], *self.events[-n:]]
        if shown is not self.events:
            yield f"<p>The first and the last {n} of {len(self.events)}.</p>"
        rows = [(f"{event.get('time_s', 0.0):.3f}", event.get("event", ""), event_details(event)) for event in shown]
        yield html_table(rows, ("time [s]", "event", ""), row_names=False)

    def versions(self) -> Iterator[str]:
        manifest = self.manifest
        rows = [(name, str(value)) for name, value in manifest.get("versions", {}).items() if value]
        rows += [(name, str(value)) for name, value in manifest.get("machine", {}).items() if value]
        hashes = ("sources_sha256", "scene_sha256", "state_sha256")
        rows += [(name.replace("_", " "), manifest[name]) for name in hashes if manifest.get(name)]
        if rows:
            yield f"<h2>Versions</h2>\n{html_table(rows)}"

    def file_links(self) -> Iterator[str]:
        names = [*FILES, *(f"motion_{name}.csv" for name in self.scene.get("ships", {}))]
        links = [f'<a href="{name}">{name}</a>' for name in names if (self.folder / name).exists()]
        if links:
            yield f"<h2>Files</h2>\n<p>{' · '.join(links)}</p>"


def whole_lines(path: Path) -> list[dict[str, Any]]:
    """Objects in the lines of a JSON-lines file, up to its first incomplete line; empty if there is no file."""
    objects = []
    for line in input_file.read_text(path).splitlines() if path.is_file() else ():
        try:
            objects.append(json.loads(line))
        except ValueError:
            break
    return objects


def draw(
    log: Table, label: str, columns: Mapping[str, str], factor: float = 1.0, limits: Mapping[str, float] | None = None
) -> str:
    """HTML plot over time of `columns` of a table (column by name of its curve), times a factor; empty without any."""
    series = {name: factor * log[column] for name, column in columns.items()}
    return draw_curves(log["time_s"], series, label, limits) if series else ""


def columns_between(log: Table, prefix: str, suffix: str) -> dict[str, str]:
    """Names of columns that begin with `prefix` and end with `suffix`, by the part of the name between these."""
    named = [column for column in log if column.startswith(prefix) and column.endswith(suffix)]
    return {column.removeprefix(prefix).removesuffix(suffix): column for column in named}


def motion_plots(title: str, log: Table) -> Iterator[str]:
    """Yield HTML plots of the motions of one ship, from her motion log, under a title."""
    if "heave_m" not in log:
        return
    yield f"<h2>{html.escape(title)}</h2>"
    yield draw(log, "heave of the centre of mass [m]", {"heave": "heave_m"})
    yield draw(log, "roll and pitch [deg]", {name: f"{name}_rad" for name in ("roll", "pitch")}, DEGREES)
    yield draw({**log, "yaw_rad": np.unwrap(log["yaw_rad"])}, "yaw [deg]", {"yaw": "yaw_rad"}, DEGREES)
    yield draw(log, "velocity [m/s]", {name: f"{name}_velocity_m_s" for name in ("surge", "sway", "heave")})
    yield draw(log, "specific force, body axes [m/s2]", {axis: f"specific_force_{axis}_m_s2" for axis in "xyz"})
    upward = columns_between(log, "force_", "_y_N")
    acting = {part: column for part, column in upward.items() if np.abs(log[column]).max() > 0.0}
    yield draw(log, "vertical force [kN]", acting, 0.001)
    if "throttle" in log:
        tens = {**log, "rudder_rad": 0.1 * DEGREES * log["rudder_rad"]}
        yield draw(tens, "throttle and rudder", {"throttle [1]": "throttle", "rudder [10 deg]": "rudder_rad"})


def wave_trains(part: dict[str, Any]) -> Iterator[str]:
    """Yield a sentence about each wave train of a sea or a fluid, from its keys in the scene as data (`part`)."""
    spectrum, components = part.get("spectrum"), part.get("components")
    sources = [each for each in (spectrum, components) if isinstance(each, dict)]
    yield from (f"spectrum of {each['file']}" for each in sources if "file" in each)
    if spectrum and "kind" in spectrum:
        kind, height = spectrum["kind"].replace("_", " "), spectrum["significant_wave_height"]
        period = f"peak period {spectrum['peak_period']:g} s"
        yield f"{kind}, significant height {height:g} m, {period}{heading_text(spectrum)}"
    if part.get("height") and part.get("period"):
        yield f"regular, {part['height']:g} m high, period {part['period']:g} s{heading_text(part)}"
    for more in part.get("spectra", ()):
        yield from wave_trains(more)
    if isinstance(components, str):
        yield f"plane waves of {components}"


def heading_text(waves: dict[str, Any]) -> str:
    """Clause on the direction in which waves travel; empty if the scene gives none."""
    towards = waves.get("heading_deg")
    return "" if towards is None else f", heading {towards:g} deg"


def event_details(event: dict[str, Any]) -> str:
    """Text of the facts of an event, apart from its time, step and name."""
    facts = {key: value for key, value in event.items() if key not in ("time_s", "step", "event") and value is not None}
    return ", ".join(f"{k} {v:.5g}" if isinstance(v, float) else f"{k} {v}" for k, v in facts.items())
