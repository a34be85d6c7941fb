"""The sea around the basin of a run, as its frames have shown it until now: its waves, its wind and its level.

A picture asks nothing of later frames, so it is the same while the run goes on and afterwards.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ocean_sim.files import run_files
from ocean_sim.pictures.frame_files import Frame, FrameLog, read_elevation
from ocean_sim.pictures.water import far_sea
from ocean_sim.waves import Components

SWELL_SECONDS = 4.0  # [s] by which the far sea lags behind the basin's
# [s] between the frames that it is taken from; and in lags, how far it looks back
FRAME_INTERVAL, MEMORY_LAGS = 0.25, 6.0
MIN_LIT_HEIGHT = 0.25  # [m] over the resolved length: crests of a sea lower than that are not lit as crests
MIN_RIPPLE_WIND, MAX_RIPPLE_WIND = 2.0, 14.0  # [m/s] wind that ripples follow
TANK_FITTINGS = ("motion", "wavemaker", "lid", "obstacles")  # of a basin that is a tank
LABORATORY_LENGTH = 12.0  # [m] of the longest basin that is a tank without fittings: an ocean's foam is no shorter
DRY_DEPTH_SHARE = 0.5  # share of the depth below which the water of a sea does not lie when a run begins


class SeaNow(NamedTuple):
    """Sea around a basin at one time: level, wave height, plane waves and winds."""

    level: float  # [m] mean height of the water
    height: float  # [m] four times the standard deviation of the elevation, lately
    waves: Components  # that are drawn far away, as high as they are now
    wind: float  # [m/s] that drives the ripples
    raising: float = 0.0  # [m/s] wind that calls for white water: the scene's, else that which raises its random waves


class SeaState:
    """Estimate of the sea around the basin of a run at the time of each frame, from that frame and earlier ones."""

    def __init__(self, scene: dict[str, Any], grid: Any, log: FrameLog) -> None:
        """`scene`: resolved scene of the run; `grid`: arrays in the run's grid.npz; `log`: times of its frames."""
        self.scene, self.log = scene, log
        self.exact = exact_waves(grid)  # the waves themselves, where water is a closed form
        self.resolved = float(grid["spacing"])  # [m] between particles, or half the shortest wave
        self.stated = stated_wind_speed(scene)  # [m/s] wind, 0 where the scene has none with a speed
        self.angle = wind_heading(scene, self.exact)  # [rad] where the wind goes to, from +x to +z
        towards = np.array([np.cos(self.angle), np.sin(self.angle)])
        first = Frame(log.files[0])
        if self.exact is not None:
            self.resolved = np.pi / float(self.exact.wavenumber.max())
            self.beyond = far_sea.strongest_waves(self.exact)
        else:
            size = tuple(float(grid["upper"][k] - grid["lower"][k]) for k in (0, 2))
            self.modes = far_sea.Modes(first.elevation.shape, (size[0], size[1]), float(grid["depth"]), towards)
            self.beyond = self.modes.sea
        self.seen: dict[int, tuple[float, np.ndarray]] = {}  # level and variances of frames, by their numbers

    def at(self, time: float) -> SeaNow:
        """Sea at the time [s] of a frame, from that frame and earlier ones."""
        if self.exact is not None:
            level, height = 0.0, self.exact.significant_height
            raising = self.stated or far_sea.wind_speed_from_sea(self.exact, time)
            waves = far_sea.grown_waves(self.beyond, time)
        else:
            numbers, weights = recent_frames(self.log.times, time)
            self.seen = {n: self.seen[n] if n in self.seen else self.measure_frame(n) for n in numbers}
            level = float(sum(w * self.seen[n][0] for n, w in zip(numbers, weights, strict=True)))
            variances = np.sum([w * self.seen[n][1] for n, w in zip(numbers, weights, strict=True)], axis=0)
            height, raising = 4.0 * float(np.sqrt(variances.sum())), self.stated
            waves = replace(self.beyond, amplitude=np.sqrt(2.0 * variances))
        least = 0.0 if self.exact is not None else MIN_LIT_HEIGHT * self.resolved
        return SeaNow(level, max(height, least), waves, ripple_wind_speed(self.scene, height), raising)

    def measure_frame(self, number: int) -> tuple[float, np.ndarray]:
        """Mean level [m] in frame `number`, and variances (n,) [m2] of the plane waves that continue its heights."""
        elevation = read_elevation(self.log.files[number])
        return float(elevation.mean()), self.modes.variances(elevation)


def recent_frames(times: np.ndarray, time: float) -> tuple[list[int], np.ndarray]:
    """Indices of frames up to a `time` [s], FRAME_INTERVAL apart, and their weights in a mean over the past. Weights
    decay over SWELL_SECONDS; each frame counts until the next. `times`: of all frames [s]."""
    intervals = np.floor((time - MEMORY_LAGS * SWELL_SECONDS - times[0]) / FRAME_INTERVAL)
    begins = max(times[0], times[0] + FRAME_INTERVAL * intervals)
    moments = np.arange(begins, time + 1e-9, FRAME_INTERVAL)
    last = int(np.searchsorted(times, time + 1e-9)) - 1
    numbers = np.unique(np.minimum(np.searchsorted(times, moments - 1e-9), max(last, 0)))
    left = np.exp((np.minimum(times[numbers], time) - time) / SWELL_SECONDS)
    weights = np.append(left[1:], 1.0) - left
    weights[0] += left[0]  # what was before is as the first
    return [int(n) for n in numbers], weights


def exact_waves(grid: Any) -> Components | None:
    """Plane waves of closed-form water, from the arrays that a run saves once (`grid`); None for other water."""
    if "sea_amplitude" not in grid:
        return None
    ramp = float(grid["sea_ramp"]) if "sea_ramp" in grid else 0.0
    return Components(grid["sea_amplitude"], grid["sea_wavevector"], grid["sea_phase"], float(grid["depth"]), ramp=ramp)


def is_tank(basin: dict[str, Any]) -> bool:
    """True if these keys of a basin describe a tank: with parts of one (as a wavemaker), or short as a laboratory's."""
    return any(basin.get(key) for key in TANK_FITTINGS) or basin.get("length", np.inf) <= LABORATORY_LENGTH


def is_open_sea(scene: dict[str, Any], first: Frame, depth: float) -> bool:
    """True if the basin is a piece of sea: it is no tank, and its bed, at `depth` [m], is under water at first."""
    return bool(first.elevation.min() > -DRY_DEPTH_SHARE * depth) and not is_tank(scene.get("basin") or {})


def run_scene(folder: Path) -> dict[str, Any]:
    """Resolved scene from the manifest in a run's folder; empty if it has none."""
    scene = run_files.read_manifest(folder).get("scene")
    return scene if isinstance(scene, dict) else {}


def ripple_wind_speed(scene: dict[str, Any], height: float) -> float:
    """Wind speed [m/s] that drives ripples: the scene's, or one that raises this significant height [m]."""
    speed = stated_wind_speed(scene) or far_sea.wind_speed_from_height(height)
    return float(np.clip(speed, MIN_RIPPLE_WIND, MAX_RIPPLE_WIND))


def stated_wind_speed(scene: dict[str, Any]) -> float:
    """Wind speed [m/s] at 10 m that a scene states; 0 if it states none."""
    wind = scene.get("wind") or {}
    if "u10" not in wind:
        return 0.0
    from ocean_sim.wind.shared.air_load import stated_speed

    return stated_speed(wind["u10"], wind.get("tau"))


def gust_speed(scene: dict[str, Any]) -> float:
    """Largest speed [m/s] of the air in a scene's volumes of moving air or of their drift; 0 without volumes."""
    volumes = (scene.get("wind") or {}).get("volumes") or []
    return max((max(float(np.linalg.norm(v["drift"])), v["wind_speed"]) for v in volumes), default=0.0)


def wind_heading(scene: dict[str, Any], sea: Components | None) -> float:
    """Angle [rad], from +x to +z, to which the scene's wind blows or, without a heading, its waves travel."""
    angle = scene_wind_heading(scene.get("wind") or {})
    if angle is not None:
        return angle
    going = np.array([1.0, 0.6]) if sea is None else (sea.amplitude[:, None] ** 2 * sea.wavevector).sum(axis=0)
    return float(np.arctan2(going[1], going[0]))


def scene_wind_heading(wind: dict[str, Any]) -> float | None:
    """Angle [rad], +x to +z, to which a wind config blows or its volumes of moving air push the water; None without."""
    if wind.get("heading_deg") is not None:
        turn = np.radians(wind["heading_deg"])
        return float(np.arctan2(np.cos(turn), np.sin(turn)))
    pushes = [v["acceleration"] for v in wind.get("volumes") or [] if v.get("acceleration")]
    push = np.sum(pushes, axis=0) if pushes else np.zeros(3)
    return float(np.arctan2(push[2], push[0])) if np.hypot(push[0], push[2]) > 0.0 else None
