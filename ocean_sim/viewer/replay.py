"""Replay of a finished run in a browser: all its frames as one packet, and a page that contains it."""

import csv
import re
import zlib
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from ocean_sim.conventions import Refused
from ocean_sim.files import csv_file
from ocean_sim.files.atomic_file import write_file
from ocean_sim.files.input_file import read_json
from ocean_sim.pictures.frame_files import Frame, frame_files, open_frame
from ocean_sim.pictures.water.foam import cell_means
from ocean_sim.pictures.water.sea_state import exact_waves
from ocean_sim.viewer.protocol import FULL_SCALE, box_positions, moment_differences, packet
from ocean_sim.viewer.still import StaticScene, page_document, sky_packet
from ocean_sim.viewer.watch import MAX_CELLS

MAX_MOMENT_RATE = 20.0  # [1/s] of simulated time
MAX_MOMENTS = 1600
RESOLUTIONS = 0.001, 0.006  # [m] of heights, and of positions of particles
MAX_STREAM_BYTES = 2_150_000  # of a larger stream, every second, third, ... particle is kept
MAX_DROP_BYTES = 400_000  # bytes of all drops, of which every second, third, ... is kept likewise
PARTICLE_INTERVAL = 2  # moments between two with particles
PLOTTED_FILE = Path(__file__).with_name("plotted_columns.csv")  # columns of logs by their patterns, in this order


class Recorded:
    """Frames and logs of a run folder, read for a replay; raises Refused if it is no run folder or has no frames."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        try:
            self.scene: dict[str, Any] = read_json(folder / "manifest.json")["scene"]
        except (ValueError, KeyError, TypeError):
            raise Refused(f"{folder}: this is not a run folder (there is no manifest.json that can be read)") from None
        files = frame_files(folder)
        if not files or not (folder / "frames" / "grid.npz").is_file():
            raise Refused(f"{folder}: this run kept no frames to replay; run it without frames=null")
        with open_frame(folder / "frames" / "grid.npz") as file:
            self.grid = {name: file[name] for name in file.files}
        every = max(float(self.grid.get("every", 0.033)), 1e-9)
        self.files = files[:: max(1, round(1.0 / (MAX_MOMENT_RATE * every)), -(-len(files) // MAX_MOMENTS))]
        self.title = self.scene.get("title") or folder.name

    @property
    def strides(self) -> tuple[int, int]:
        """Steps along x and z by which the grid of heights is thinned to at most MAX_CELLS along each axis."""
        return tuple(-(-len(self.grid[axis]) // MAX_CELLS) for axis in "xz")  # type: ignore[return-value]

    def still(self) -> bytes:
        return self.setting.packet()

    @cached_property
    def setting(self) -> StaticScene:
        """Static part of the replay: water, basin and ships, and a list of the numbers to plot over time."""
        (i, j), first = self.strides, Frame(self.files[0])
        grid = self.grid | {"x": self.grid["x"][::i], "z": self.grid["z"][::j]}
        surface = bool(grid["has_surface"]) or len(grid["z"]) == 1
        particles = 0 if first.position is None else len(first.position)
        setting = StaticScene(grid, self.scene, self.title, exact_waves(grid), surface, particles)
        setting.scalars = self.plotted_numbers(np.zeros(1))[0]
        return setting

    def stream(self) -> bytes:
        """Packet of kind `replay`: all frames, compressed, with particles thinned to fit MAX_STREAM_BYTES."""
        setting, (i, j) = self.setting, self.strides
        low, high = setting.box
        times, heights, foams, poses, origins, particles, speeds, drops = [], [], [], [], [], [], [], []
        every = 1
        for k, path in enumerate(self.files):
            frame = Frame(path)
            times.append(frame.time)
            origins.append(frame.origin)
            drops.append(frame.drops[:, :6] - [*frame.place, 0.0, 0.0, 0.0])
            heights.append(frame.elevation[::i, ::j].ravel())
            if frame.foam is not None:
                foams.append(cell_means(frame.foam, frame.elevation.shape)[::i, ::j].ravel())
            poses.append([self.ship_pose(*frame.ships[key]) for key in setting.ship_keys])
            if frame.position is not None and k % PARTICLE_INTERVAL == 0:
                assert frame.velocity is not None and frame.id is not None
                order = frame.id.astype(int)
                particles.append(self.sorted_by_id(frame.position, order))
                speeds.append(self.sorted_by_id(np.linalg.norm(frame.velocity, axis=1)[:, None], order))
        tall = np.nan_to_num(np.array(heights))
        top = max(FULL_SCALE * RESOLUTIONS[0], float(np.abs(tall).max()))
        _, scalars = self.plotted_numbers(np.array(times))
        arrays = {
            "height": moment_differences(np.rint(tall * (FULL_SCALE / top)).astype(np.int16)),
            "poses": np.array(poses, np.float32).reshape(len(times), -1),
            "origins": np.array(origins, np.float32),
            "scalars": np.nan_to_num(scalars, nan=np.nan).astype(np.float32),
        }
        boxes: dict[str, Any] = {"height": {"delta": True, "low": -top, "high": top}}
        if (platform := self.platform_commands(np.array(times))) is not None:
            arrays["platform"] = platform
        if foams:
            arrays["foam"] = moment_differences(np.rint(255.0 * np.clip(foams, 0.0, 1.0)).astype(np.int16))
            boxes["foam"] = {"delta": True}
        if any(map(len, drops)):
            most = MAX_DROP_BYTES // (12 * len(drops))
            arrays["drops"] = np.full((len(drops), most, 6), np.nan, np.float16)
            for kept, moment in zip(arrays["drops"], drops, strict=True):
                some = moment[:: -(-len(moment) // most) or 1]
                kept[: len(some)] = some
        header = {"times": [round(t, 6) for t in times], "fastest": 1.0}
        if particles:
            most = max(len(each) for each in particles)
            whole_run = np.full((len(particles), most, 3), np.nan, np.float32)
            pace = np.zeros((len(particles), most), np.float32)
            for k, each in enumerate(particles):
                whole_run[k, : len(each)], pace[k, : len(each)] = each, np.nan_to_num(speeds[k][:, 0])
            header["fastest"] = fastest = max(0.5, float(np.quantile(pace, 0.999)))
            wide = np.maximum(0.5 * (high - low), FULL_SCALE * RESOLUTIONS[1])
            middle = 0.5 * (high + low)
            low, high = middle - wide, middle + wide
            boxes["speed"] = {"delta": True, "every": PARTICLE_INTERVAL}
            boxes["particles"] = boxes["speed"] | {"low": low.tolist(), "high": high.tolist()}
            places = box_positions(whole_run, low.astype(np.float32), high.astype(np.float32))
            tints = (np.minimum(pace / fastest, 1.0) * 31.0).astype(np.int16) * 8
            while True:
                kept = slice(None, None, every)
                arrays["particles"] = moment_differences(places[:, kept].reshape(len(places), -1))
                arrays["speed"] = moment_differences(tints[:, kept])
                data = zlib.compress(packet("replay", arrays, boxes, **header), 6)
                if len(data) <= MAX_STREAM_BYTES or arrays["particles"].size < 20_000:
                    return data
                every += max(1, round(every * (len(data) / MAX_STREAM_BYTES - 1.0)))
        return zlib.compress(packet("replay", arrays, boxes, **header), 6)

    @staticmethod
    def sorted_by_id(values: np.ndarray, order: np.ndarray) -> np.ndarray:
        """Rows (ids, k), one per id, from rows `values` (n, k) of particles in any order; NaN for ids that are missing.
        `order` (n,): index in the result for each row."""
        found = np.full((int(order.max()) + 1 if len(order) else 0, values.shape[1]), np.nan, np.float32)
        found[order] = values
        return found

    @staticmethod
    def ship_pose(position: np.ndarray, turn: np.ndarray) -> list[float]:
        """Position x, y, z [m] and quaternion w, x, y, z of a ship; `turn`: matrix (3, 3) from body to world axes."""
        from scipy.spatial.transform import Rotation

        return [*position.tolist(), *Rotation.from_matrix(turn).as_quat(canonical=True)[[3, 0, 1, 2]].tolist()]

    def plotted_numbers(self, times: np.ndarray) -> tuple[list[dict[str, str]], np.ndarray]:
        """Time series to plot: name, label, unit and group of each, and their values (moments, k) at times [s]."""
        rows, columns = [], []
        with PLOTTED_FILE.open(encoding="utf-8") as file:
            known = list(csv.DictReader(file))
        logs = [("gauges", ""), *(("motion", name) for name in self.scene.get("ships") or [""])]
        for kind, ship in [*logs, ("platform", ""), ("accuracy", ""), ("timings", "")]:
            log = csv_file.read_columns_if_any(self.folder / (f"{kind}_{ship}.csv" if ship else f"{kind}.csv"))
            for plotted, column in product((row for row in known if row["log"] == kind), log):
                if (found := re.fullmatch(plotted["column"], column)) is None:
                    continue
                label, group = f"{found.expand(plotted['label'])} {ship}".strip(), plotted["group"]
                name = f"{group}_{label}".replace(" ", "_")
                rows.append({"name": name, "label": label, "unit": plotted["unit"], "group": group})
                values = np.asarray(log[column], float)
                values = np.unwrap(values) if column == "yaw_rad" else values
                columns.append(float(plotted["factor"]) * np.interp(times, log["time_s"], values))
        return rows, np.array(columns).T.reshape(len(times), -1)

    def platform_commands(self, times: np.ndarray) -> np.ndarray | None:
        """Poses [m, rad] and leg lengths [m] (moments, 12) of a motion platform at times [s]; None without one."""
        log = csv_file.read_columns_if_any(self.folder / "platform.csv")
        names = ("x_m", "y_m", "z_m", "roll_rad", "pitch_rad", "yaw_rad", *(f"leg{k}_m" for k in range(1, 7)))
        if not all(name in log for name in names):
            return None
        return np.array([np.interp(times, log["time_s"], log[name]) for name in names], np.float32).T


def replay_file(folders: list[Path], path: Path) -> Path:
    """Write a replay of one run folder, or of two side by side, as one self-contained HTML file; returns its path."""
    runs = [Recorded(folder) for folder in folders]
    data = {"sky": sky_packet()}
    for k, run in enumerate(runs):
        data |= {f"still{k}": run.still(), f"replay{k}": run.stream()}
    title = " and ".join(run.title for run in runs)
    start = {"mode": "replay", "held": True, "runs": [{"title": run.title, "name": run.folder.name} for run in runs]}
    write_file(path, page_document(title, start, data))
    return path
