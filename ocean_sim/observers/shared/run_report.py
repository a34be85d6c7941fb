"""The page report.html of a run folder: what was run and how it went, with its pictures and curves."""

import html
import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ocean_sim.files import csv_file, input_file
from ocean_sim.files.atomic_file import atomic_write
from ocean_sim.observers.shared.page import curves, page, picture, plot, table, text

STILLS = 6  # in a page at most
EVENTS = 60  # shown from the beginning, and as many from the end
FILES = (
    *("manifest.json", "motion.csv", "platform.csv", "gauges.csv", "accuracy.csv", "timings.csv", "events.jsonl"),
    *("film.mp4", "preview.png", "moments.png", "strip.png"),
)
Table = dict[str, np.ndarray]


def write(folder: Path) -> Path:
    """Write report.html of a run folder, however the run ended."""
    run = Run(folder)
    path = folder / "report.html"
    with atomic_write(path) as draft:
        draft.write_text(page(run.title, run.parts()), encoding="utf-8")
    return path


class Run:
    """A run folder as its page shows it; a file that is missing or torn is left out."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.manifest: dict[str, Any] = input_file.read_json_object(folder / "manifest.json")
        self.scene: dict[str, Any] = self.manifest.get("scene") or {}
        self.title = self.scene.get("title") or "Untitled scene"
        self.events = self.lines(folder / "events.jsonl")

    def parts(self) -> Iterator[str]:
        """The body of the page from top to bottom."""
        yield f"<h1>{html.escape(self.title)}</h1>"
        yield self.outcome()
        if (self.folder / "replay.html").exists():
            yield '<p><a href="replay.html">Replay of the run</a>: look around, and scrub in time.</p>'
        yield from self.pictures()
        yield table(self.facts())
        yield from self.warnings()
        for part in (self.motion, self.platform, self.gauges, self.accuracy, self.timings):
            yield from part()
        yield from self.happened()
        if self.scene:
            yield f"<h2>Scene</h2>\n<p>With all defaults.</p>\n<pre>{html.escape(text(self.scene))}</pre>"
        yield from self.versions()
        yield from self.files()

    def outcome(self) -> str:
        """How it ended, in a sentence."""
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
        yield picture(folder / "preview.png", f"The run at its liveliest{more}.", film)
        yield picture(folder / "moments.png", "The film, from the beginning to the end.", film)
        yield picture(folder / "strip.png", "From the beginning to the end.")
        for path in sorted(folder.glob("still_*.png"))[:STILLS]:
            yield picture(path, f"t = {path.stem.removeprefix('still_').lstrip('0') or '0'} s")

    def facts(self) -> Iterator[tuple[str, str]]:
        """What was run, in a dozen rows."""
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
            yield from (("waves", sentence) for sentence in trains(part or {}))
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

    def motion(self) -> Iterator[str]:
        yield from self.motion_of("Motions of the ship", csv_file.read_columns_if_any(self.folder / "motion.csv"))
        for name in self.scene.get("ships", {}):
            yield from self.motion_of(
                f"Motions of {name}", csv_file.read_columns_if_any(self.folder / f"motion_{name}.csv")
            )

    def motion_of(self, title: str, log: Table) -> Iterator[str]:
        """The motions of one ship."""
        if "heave_m" not in log:
            return
        time, degrees = log["time_s"], np.degrees
        yield f"<h2>{html.escape(title)}</h2>"
        yield plot(curves(time, {"heave": log["heave_m"]}, "heave of the centre of mass [m]"))
        yield plot(curves(time, {n: degrees(log[f"{n}_rad"]) for n in ("roll", "pitch")}, "roll and pitch [deg]"))
        yield plot(curves(time, {"yaw": degrees(np.unwrap(log["yaw_rad"]))}, "yaw [deg]"))
        speed = {name: log[f"{name}_velocity_m_s"] for name in ("surge", "sway", "heave")}
        yield plot(curves(time, speed, "velocity [m/s]"))
        felt = {axis: log[f"specific_force_{axis}_m_s2"] for axis in "xyz"}
        yield plot(curves(time, felt, "specific force, body axes [m/s2]"))
        parts = [
            n.removeprefix("force_").removesuffix("_y_N") for n in log if n.startswith("force_") and n[-4:] == "_y_N"
        ]
        upward = {p: log[f"force_{p}_y_N"] / 1000.0 for p in parts if np.abs(log[f"force_{p}_y_N"]).max() > 0.0}
        if upward:
            yield plot(curves(time, upward, "vertical force [kN]"))
        if "throttle" in log:
            orders = {"throttle [1]": log["throttle"], "rudder [10 deg]": degrees(log["rudder_rad"]) / 10.0}
            yield plot(curves(time, orders, "throttle and rudder"))

    def platform(self) -> Iterator[str]:
        log = csv_file.read_columns_if_any(self.folder / "platform.csv")
        if "leg1_m" not in log:
            return
        time = log["time_s"]
        machine = (self.scene.get("platform") or {}).get("geometry")
        ends = machine if isinstance(machine, dict) else {}
        reach = {name: ends[name] for name in ("shortest", "longest") if name in ends}  # [m]
        yield "<h2>Motion platform</h2>"
        yield plot(curves(time, {f"leg {k}": log[f"leg{k}_m"] for k in range(1, 7)}, "length of the legs [m]", reach))
        speed = {f"leg {k}": log[f"leg{k}_velocity_m_s"] for k in range(1, 7)}
        fastest = ends.get("leg_speed")  # [m/s]
        both = {} if fastest is None else {"fastest": fastest, "fastest, shortening": -fastest}
        yield plot(curves(time, speed, "velocity of the legs [m/s]", both))
        pose = {name: np.degrees(log[f"{name}_rad"]) for name in ("roll", "pitch", "yaw")}
        yield plot(curves(time, pose, "attitude of the platform [deg]"))
        yield plot(curves(time, {axis: log[f"{axis}_m"] for axis in "xyz"}, "position of the platform [m]"))
        felt = {axis: log[f"felt_force_{axis}_m_s2"] for axis in "xyz"}
        yield plot(curves(time, felt, "specific force on the platform [m/s2]"))
        share = float(np.mean(log["limited"] > 0.0))
        yield f"<p>A limit was reached in {100.0 * share:.3g} % of the rows.</p>"

    def gauges(self) -> Iterator[str]:
        log = csv_file.read_columns_if_any(self.folder / "gauges.csv")
        heights = {name.removesuffix("_m"): values for name, values in log.items() if name.endswith("_m")}
        pressures = {name.removesuffix("_Pa"): v / 1000.0 for name, v in log.items() if name.endswith("_Pa")}
        if heights or pressures:
            yield "<h2>Gauges</h2>"
        if heights:
            yield plot(curves(log["time_s"], heights, "elevation [m]"))
            rows = [
                (n, f"{4.0 * np.nanstd(v):.3g}", f"{np.nanmin(v):.3g}", f"{np.nanmax(v):.3g}")
                for n, v in heights.items()
            ]
            yield table(rows, ("gauge", "4 standard deviations [m]", "least [m]", "greatest [m]"))
        if pressures:
            yield plot(curves(log["time_s"], pressures, "pressure [kPa]"))

    def accuracy(self) -> Iterator[str]:
        log = csv_file.read_columns_if_any(self.folder / "accuracy.csv")
        if "compression_mean" not in log:  # water without particles keeps no balances
            return
        time = log["time_s"]
        density = {
            "compression, mean": log["compression_mean"],
            "compression, largest": log["compression_max"],
            "surface deficit, mean": log["surface_deficit_mean"],
        }
        energy = {name: log[f"{name}_energy_J"] / 1000.0 for name in ("kinetic", "potential", "internal")}
        momentum = {f"along {axis}": log[f"momentum_{axis}_kg_m_s"] / 1000.0 for axis in "xyz"}
        terms = [name.split("_")[1] for name in log if name.startswith("impulse_") and name.endswith("_x_Ns")]
        horizontal = {t: np.hypot(log[f"impulse_{t}_x_Ns"], log[f"impulse_{t}_z_Ns"]) / 1000.0 for t in terms}
        yield "<h2>Accuracy</h2>"
        yield plot(curves(time, {name: 100.0 * values for name, values in density.items()}, "density error [%]"))
        yield plot(curves(time, energy, "energy [kJ]"))
        yield plot(curves(time, momentum, "momentum [kN s]"))
        acting = {term: values for term, values in horizontal.items() if values.max() > 0.0}
        if acting:
            yield plot(curves(time, acting, "horizontal impulse by force [kN s]"))
        if "time_step_s" in log:
            yield plot(curves(time, {"time step": 1000.0 * log["time_step_s"]}, "time step [ms]"))

    def timings(self) -> Iterator[str]:
        log = csv_file.read_columns_if_any(self.folder / "timings.csv")
        stages = [name for name in log if name.endswith("_ms_per_step")]
        if not stages:
            return
        steps = np.maximum(np.diff(np.concatenate([[0.0], log["steps"]])), 1.0)
        means = {name.removesuffix("_ms_per_step"): float(np.average(log[name], weights=steps)) for name in stages}
        whole = sum(means.values())
        yield "<h2>Timings</h2>"
        rows = (
            [(name, f"{value:.3g}", f"{100.0 * value / whole:.3g}") for name, value in means.items()] if whole else []
        )
        yield table(rows, ("stage", "milliseconds a step", "share [%]"))
        yield plot(
            curves(log["time_s"], {n.removesuffix("_ms_per_step"): log[n] for n in stages}, "milliseconds a step")
        )
        yield plot(
            curves(log["time_s"], {"real-time factor": log["real_time_factor"]}, "simulated time over wall time")
        )

    def happened(self) -> Iterator[str]:
        """The events of the run."""
        if not self.events:
            return
        yield "<h2>Events</h2>"
        shown = self.events if len(self.events) <= 2 * EVENTS else [*self.events[:EVENTS], *self.events[-EVENTS:]]
        if shown is not self.events:
            yield f"<p>The first and the last {EVENTS} of {len(self.events)}.</p>"
        rows = [(f"{event.get('time_s', 0.0):.3f}", event.get("event", ""), particulars(event)) for event in shown]
        yield table(rows, ("time [s]", "event", ""), named=False)

    def versions(self) -> Iterator[str]:
        manifest = self.manifest
        rows = [(name, str(value)) for name, value in manifest.get("versions", {}).items() if value]
        rows += [(name, str(value)) for name, value in manifest.get("machine", {}).items() if value]
        hashes = ("sources_sha256", "scene_sha256", "state_sha256")
        rows += [(name.replace("_", " "), manifest[name]) for name in hashes if manifest.get(name)]
        if rows:
            yield f"<h2>Versions</h2>\n{table(rows)}"

    def files(self) -> Iterator[str]:
        names = [*FILES, *(f"motion_{name}.csv" for name in self.scene.get("ships", {}))]
        links = [f'<a href="{name}">{name}</a>' for name in names if (self.folder / name).exists()]
        if links:
            yield f"<h2>Files</h2>\n<p>{' · '.join(links)}</p>"

    @staticmethod
    def lines(path: Path) -> list[dict[str, Any]]:
        """The whole lines of events.jsonl."""
        found = []
        for line in input_file.read_text(path).splitlines() if path.is_file() else ():
            try:
                found.append(json.loads(line))
            except ValueError:
                break
        return found


def trains(part: dict[str, Any]) -> Iterator[str]:
    """The waves of a sea or a fluid of a scene, a sentence for each train."""
    spectrum = part.get("spectrum")
    if spectrum:
        kind, height = spectrum["kind"].replace("_", " "), spectrum["significant_wave_height"]
        yield f"{kind}, significant height {height:g} m, peak period {spectrum['peak_period']:g} s{heading(spectrum)}"
    if part.get("height") and part.get("period"):
        yield f"regular, {part['height']:g} m high, period {part['period']:g} s{heading(part)}"
    for more in part.get("spectra", ()):
        yield from trains(more)
    if part.get("components"):
        yield f"plane waves of {part['components']}"


def heading(waves: dict[str, Any]) -> str:
    """Where waves go to, where a scene says it."""
    towards = waves.get("heading_deg")
    return "" if towards is None else f", heading {towards:g} deg"


def particulars(event: dict[str, Any]) -> str:
    """What is known of an event beyond its time and name."""
    rest: Iterable[tuple[str, Any]] = ((k, v) for k, v in event.items() if k not in ("time_s", "step", "event"))
    words = (
        f"{key} {value:.5g}" if isinstance(value, float) else f"{key} {value}"
        for key, value in rest
        if value is not None
    )
    return ", ".join(words)
