"""The page report.html of a run folder: scene, outcome, pictures, curves and events."""

import html
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ocean_sim.files import csv_file, input_file
from ocean_sim.files.atomic_file import write_file
from ocean_sim.files.yaml_file import read_mapping
from ocean_sim.observers.shared.page import draw_curves, embedded_picture, html_page, html_table, scene_text

MAX_STILLS = 6  # in a page
MAX_EDGE_EVENTS = 60  # that are shown from the beginning, and as many from the end
DEGREES = float(np.degrees(1.0))  # a radian
FILES = (
    *("manifest.json", "motion.csv", "platform.csv", "gauges.csv", "accuracy.csv", "timings.csv", "events.jsonl"),
    *("film.mp4", "preview.png", "moments.png", "strip.png"),
)
PLAN_FILE = Path(__file__).with_suffix(".yaml")  # of the sections with plots
Table = Mapping[str, np.ndarray]


def write_report(folder: Path) -> Path:
    """Write report.html of a run folder, whether the run succeeded or failed; returns its path."""
    run, path = Run(folder), folder / "report.html"
    write_file(path, html_page(run.title, run.outcome(), run.parts()))
    return path


class Run:
    """A run folder, and the pieces of HTML that report.html shows of it; missing or incomplete files are skipped."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.manifest: dict[str, Any] = input_file.read_json_object(folder / "manifest.json")
        self.scene: dict[str, Any] = self.manifest.get("scene") or {}
        self.title = self.scene.get("title") or "Untitled scene"
        self.events = whole_lines(folder / "events.jsonl")

    def parts(self) -> Iterator[str]:
        """Yield the HTML sections of the page below the outcome, from top to bottom."""
        if (self.folder / "replay.html").exists():
            yield '<p><a href="replay.html">Replay of the run</a>: look around, and scrub in time.</p>'
        yield from self.pictures()
        yield html_table(self.summary_rows())
        yield from self.warnings()
        yield from self.plots()
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

    def plots(self) -> Iterator[str]:
        """Yield the HTML of each section of plots in PLAN_FILE whose table the run has written."""
        motion, *others = read_mapping(PLAN_FILE).plain().items()
        ships = self.scene.get("ships", {})
        several = [(f"motion_{name}", motion[1] | {"title": f"Motions of {name}"}) for name in ships]
        for table, section in (motion, *several, *others):
            log = with_derived_columns(csv_file.read_columns_if_any(self.folder / f"{table}.csv"))
            if section["needs"] in log:
                yield f"<h2>{html.escape(section['title'])}</h2>"
                for item in section["shows"]:
                    yield EXTRAS[item](log) if isinstance(item, str) else draw(log, item, self.platform_limits())

    def platform_limits(self) -> dict[str, float]:
        """Limits of the platform's legs by name, lengths [m] and velocities [m/s]; empty if the scene has none."""
        geometry = (self.scene.get("platform") or {}).get("geometry")
        known = geometry if isinstance(geometry, dict) else {}
        found = {name: known[name] for name in ("shortest", "longest") if name in known}
        speed = known.get("leg_speed")
        return found | ({} if speed is None else {"fastest": speed, "fastest, shortening": -speed})

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
    """Objects in the lines of a JSON-lines file, up to the first incomplete line; empty if there is no file."""
    objects = []
    for line in input_file.read_text(path).splitlines() if path.is_file() else ():
        try:
            objects.append(json.loads(line))
        except ValueError:
            break
    return objects


def draw(log: Table, plot: Mapping[str, Any], limits: Mapping[str, float]) -> str:
    """HTML of one plot over time; empty if there is no curve. `plot`: its keys (`label`, `curves` and so on; see
    PLAN_FILE); `log`: table of the run that has its columns; `limits`: values by name for its horizontal lines."""
    columns, shown = plot["curves"], {name: limits[name] for name in plot.get("limits", ()) if name in limits}
    columns = columns_like(log, columns) if isinstance(columns, str) else columns
    series = {name: plot.get("times", 1.0) * log[column] for name, column in columns.items() if column in log}
    if plot.get("acting"):
        series = {name: values for name, values in series.items() if values.any()}
    return draw_curves(log["time_s"], series, plot["label"], shown, plot.get("needles", "")) if series else ""


def columns_like(log: Table, pattern: str) -> dict[str, str]:
    """Columns of a table whose names match a pattern with one *, such as `*_m`; keys: the text for which * stands."""
    begin, end = pattern.split("*")
    named = [column for column in log if column.startswith(begin) and column.endswith(end)]
    return {column.removeprefix(begin).removesuffix(end): column for column in named}


def with_derived_columns(log: Table) -> Table:
    """Table with yaw unwrapped and two more kinds of column: rudder in tens of degrees, horizontal impulses."""
    more = {"yaw_rad": np.unwrap(log["yaw_rad"])} if "yaw_rad" in log else {}
    more |= {"rudder_10_deg": 0.1 * DEGREES * log["rudder_rad"]} if "rudder_rad" in log else {}
    for name, column in columns_like(log, "impulse_*_x_Ns").items():
        more[f"impulse_{name}_horizontal_Ns"] = np.hypot(log[column], log[f"impulse_{name}_z_Ns"])
    return {**log, **more}


def elevation_table(log: Table) -> str:
    heights = {name: log[column] for name, column in columns_like(log, "*_m").items()}
    rows = [
        (name, f"{4.0 * np.nanstd(v):.3g}", f"{np.nanmin(v):.3g}", f"{np.nanmax(v):.3g}")
        for name, v in heights.items()
        if not np.isnan(v).all()
    ]
    return html_table(rows, ("gauge", "4 standard deviations [m]", "least [m]", "greatest [m]")) if heights else ""


def stage_table(log: Table) -> str:
    """HTML table of the mean time that each stage of a time step (pressure, ships, ...) takes."""
    steps = np.maximum(np.diff(np.concatenate([[0.0], log["steps"]])), 1.0)
    stages = columns_like(log, "*_ms_per_step")
    means = {name: float(np.average(log[column], weights=steps)) for name, column in stages.items()}
    total = sum(means.values())
    rows = [(name, f"{value:.3g}", f"{100.0 * value / total:.3g}") for name, value in means.items() if total]
    return html_table(rows, ("stage", "milliseconds a step", "share [%]"))


def limited_share(log: Table) -> str:
    share = float(np.mean(log["limited"] > 0.0))
    return f"<p>A limit was reached in {100.0 * share:.3g} % of the rows.</p>"


EXTRAS = {"elevations": elevation_table, "stages": stage_table, "share at a limit": limited_share}


def wave_trains(part: dict[str, Any]) -> Iterator[str]:
    """Yield a sentence about each wave train of a sea or of water; `part`: its section of the scene, as plain data."""
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
    """Clause on the direction in which `waves` (their section of the scene) travel; empty if the scene gives none."""
    towards = waves.get("heading_deg")
    return "" if towards is None else f", heading {towards:g} deg"


def event_details(event: dict[str, Any]) -> str:
    """Text of an event's facts; its time, step and name, which are in columns of their own, are left out."""
    facts = {key: value for key, value in event.items() if key not in ("time_s", "step", "event") and value is not None}
    return ", ".join(f"{k} {v:.5g}" if isinstance(v, float) else f"{k} {v}" for k, v in facts.items())
