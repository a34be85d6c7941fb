"""The sea around the basin of a run: its waves, its wind and its level."""

import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ocean_sim.pictures import far_sea
from ocean_sim.pictures.frame_files import Frame, frame_files
from ocean_sim.pictures.ripples import Wind
from ocean_sim.waves import Components
from ocean_sim.wind.shared.air_load import stated_speed

FRAMES = 48  # of a run, from which its spectrum is taken, and how its waves grow
SWELLS = 3.0  # [s] by which the far sea lags behind the basin's
GENTLEST, STRONGEST = 2.0, 14.0  # [m/s] wind that ripples follow
FITTINGS = ("motion", "wavemaker", "lid", "obstacles")  # of a basin that is a tank
DRY = 0.5  # share of the depth below which the water of a sea never falls


class SeaState(NamedTuple):
    """The sea of one run."""

    exact: Components | None  # the waves themselves, where water is a closed form
    estimated: Components  # plane waves with the spectrum of the basin
    wind: Wind
    level: float  # [m] mean height of the water
    height: float  # [m] four times the standard deviation of the elevation
    resolved: float  # [m] between particles, or half the shortest wave
    open: bool  # whether the basin is a piece of sea: covered by water in every frame, and no tank with fittings
    times: np.ndarray  # (n,) [s]
    shares: np.ndarray  # (n,) of the height of the estimated waves then

    def grown(self, time: float) -> float:
        """Share of their height that the waves around the basin have at a time [s]."""
        return self.exact.grown(time) if self.exact is not None else float(np.interp(time, self.times, self.shares))


def of_run(folder: Path, grid: Any) -> SeaState:
    """From the frames that a run kept, and its scene where a manifest lies next to them."""
    files = frame_files(folder)
    kept = [Frame(path) for path in files[:: max(1, len(files) // FRAMES)]]
    frames, times = [frame.elevation for frame in kept], np.array([frame.time for frame in kept])
    size = tuple(float(grid["upper"][k] - grid["lower"][k]) for k in (0, 2))
    height = 4.0 * float(np.mean([np.std(e) for e in frames]))
    scene = scene_of(folder)
    exact = None
    if "sea_amplitude" in grid:
        exact = Components(
            grid["sea_amplitude"],
            grid["sea_wavevector"],
            grid["sea_phase"],
            float(grid["depth"]),
            ramp=float(grid["sea_ramp"]) if "sea_ramp" in grid else 0.0,
        )
        height = exact.significant_height
    wind = wind_of(scene, exact, height)
    towards = np.array([np.cos(wind.angle), np.sin(wind.angle)])
    depth = float(grid["depth"])
    return SeaState(
        exact,
        far_sea.of_frames(frames, (size[0], size[1]), depth, towards),
        wind,
        float(np.mean(frames)) if exact is None else 0.0,
        height,
        float(grid["spacing"]) if exact is None else np.pi / float(exact.wavenumber.max()),
        all(e.min() > -DRY * depth for e in frames)
        and not any((scene.get("basin") or {}).get(key) for key in FITTINGS),
        times,
        running(times, np.array([np.std(e) for e in frames])),
    )


def running(times: np.ndarray, deviation: np.ndarray) -> np.ndarray:
    """Deviations of the elevation that lag behind those of the frames, over their root mean square; 0 in calm water."""
    variance = deviation**2
    for k in range(1, len(times)):
        near = 1.0 - np.exp(-(times[k] - times[k - 1]) / SWELLS)
        variance[k] = variance[k - 1] + near * (variance[k] - variance[k - 1])
    return np.sqrt(variance / max(float(np.mean(deviation**2)), 1e-12))


def scene_of(folder: Path) -> dict[str, Any]:
    try:
        return json.loads((folder / "manifest.json").read_text(encoding="utf-8"))["scene"]
    except (OSError, ValueError, KeyError):
        return {}


def wind_of(scene: dict[str, Any], sea: Components | None, height: float) -> Wind:
    """The scene's wind where it has one with a speed and a heading; else that which raises such a sea."""
    wind = scene.get("wind") or {}
    stated = stated_speed(wind["u10"], wind.get("tau")) if "u10" in wind else 0.0
    speed = stated or far_sea.wind_speed_of(height)
    angle = heading(wind)
    if angle is None:
        going = np.array([1.0, 0.6]) if sea is None else (sea.amplitude[:, None] ** 2 * sea.wavevector).sum(axis=0)
        angle = float(np.arctan2(going[1], going[0]))
    return Wind(float(np.clip(speed, GENTLEST, STRONGEST)), angle)


def heading(wind: dict[str, Any]) -> float | None:
    """Angle [rad] from +x to +z of the scene's wind: its heading, or the mean push of its volumes."""
    if wind.get("heading_deg") is not None:
        turn = np.radians(wind["heading_deg"])
        return float(np.arctan2(np.cos(turn), np.sin(turn)))
    pushes = [v["acceleration"] for v in wind.get("volumes") or [] if v.get("acceleration")]
    push = np.sum(pushes, axis=0) if pushes else np.zeros(3)
    return float(np.arctan2(push[2], push[0])) if np.hypot(push[0], push[2]) > 0.0 else None
