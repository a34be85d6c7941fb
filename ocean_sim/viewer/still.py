"""The viewer's page, and the static part of a simulation, which is sent once: basin, ships, surrounding sea, shaders.

The page is one HTML document with its style and programs in it; it may also contain a replay."""

import base64
import html
import json
import re
import zlib
from collections.abc import Mapping, Sequence
from functools import cache
from math import pi
from pathlib import Path
from typing import Any

import numpy as np

from ocean_sim.basin.points import middles_of
from ocean_sim.conventions import GRAVITY
from ocean_sim.pictures.frame_files import kept_ground, ship_keys
from ocean_sim.pictures.live.preview_scene import SPEED_COLOURS
from ocean_sim.pictures.ships.ship_model import ShipModel, kept_models
from ocean_sim.pictures.stage import sky
from ocean_sim.pictures.stage.obstacles import NO_BOXES
from ocean_sim.pictures.water import sea_state, tank_walls, water_glsl, water_shading, waterline
from ocean_sim.viewer.protocol import PROTOCOL_VERSION, box_positions, packet
from ocean_sim.waves import Components

SCRIPT_NAMES = ("math", "packets", "draw", "world", "cameras", "plots", "editor", "xr", "app")
# Side of the map of distances to a hull at rest [cells]; margin around it [m], and at most so many of her lengths
GAP_CELLS, GAP_REACH, GAP_LENGTHS = 64, 3.0, 0.5
MAX_FAR_WAVES = 40  # plane waves of the sea around the basin
SYNTHETIC_WAVES = 28  # of them, if only the water of the basin is known
SKY_SIDE = 512  # [pixels]
RIPPLE_LENGTHS = 0.02, 3.0  # [m] least and greatest length of the longest ripple


class StaticScene:
    """Static part of a simulation or replay, sent to a page once: water, basin and ships."""

    def __init__(
        self,
        grid: Mapping[str, Any],
        scene: dict[str, Any],
        title: str,
        waves: Components | None,
        surface: bool,
        particles: int,
    ) -> None:
        """`grid`: arrays of frames/grid.npz; `scene`: resolved scene; `title`: of the page; `waves`: plane waves of
        water in closed form, or None; `surface`: True if there are heights to show; `particles`: number to show."""
        self.scene, self.title, self.waves, self.surface, self.particles = scene, title, waves, surface, particles
        names = "lower", "upper", "x", "z"  # corners of the basin; of the heights, from their origin [m]
        self.lower, self.upper, self.x, self.z = (np.asarray(grid[name], dtype=float) for name in names)
        self.spacing = float(grid["spacing"])  # [m]
        self.plates, self.zones = grid.get("plates", NO_BOXES), grid.get("zones", NO_BOXES)  # (n, 2, 3) [m]
        self.obstacles = np.concatenate([self.plates, grid["obstacles"]])
        self.ground = kept_ground(grid)
        # A tank is drawn without ripples and foam
        self.tank = bool(self.flat or self.ground or sea_state.is_tank(scene.get("basin") or {}))
        self.ship_keys = ship_keys(grid, "_look")
        self.models = kept_models(grid)
        named = (scene.get("gauges") or {}).get("elevation") or {}
        places = {name: (float(at[0]), float(at[1]) if len(at) > 1 else 0.0) for name, at in named.items()}
        self.gauges = places or {"middle": (0.0, 0.0)}  # x, z [m] by name
        self.scalars: Sequence[Mapping[str, str]] = ()  # name, label, unit and group of each plotted number

    @property
    def flat(self) -> bool:
        """True if the water is 2-D: heights vary along x only."""
        return len(self.z) == 1

    @property
    def box(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner (3,) [m] of the box in which particles are shown: the basin with a margin."""
        size = self.upper - self.lower
        room = np.array([0.02 * size[0], 0.0, 0.02 * size[2]])
        above = max(size[1], 0.2 * size[0])  # the still surface: room for spray
        low, high = self.lower - room, self.upper + room
        low[1], high[1] = low[1] - 0.02 * size[1], above
        return low, high

    def packet(self) -> bytes:
        """Packet of kind `still` that holds this static part, compressed."""
        arrays: dict[str, np.ndarray] = {}
        boxes: dict[str, Any] = {}
        ships = [self.ship_header(k, *ship, arrays, boxes) for k, ship in enumerate(self.models.items())]
        if self.ground is not None:
            corners, normals = self.ground.body_mesh(self.spacing)
            arrays["ground"] = corners.reshape(-1, 3).astype(np.float32)
            arrays["ground_normals"] = np.repeat(normals, 3, axis=0).astype(np.float32)
        floor, apart = tank_walls.ground_sheet(self.lower, self.upper)
        arrays["floor"] = floor.vertices[floor.triangles].reshape(-1, 3).astype(np.float32)
        steps = [spacing_of(self.x), spacing_of(self.z)]
        sea, uniforms = self.sea_header()
        platform, wind, basin = (self.scene.get(name) or {} for name in ("platform", "wind", "basin"))
        train = self.scene.get("sea") or basin.get("wavemaker") or self.scene.get("fluid") or {}
        header = {
            "protocol": PROTOCOL_VERSION,
            "title": self.title,
            "basin": {"lower": json_numbers(self.lower), "upper": json_numbers(self.upper), "flat": self.flat},
            "tile": {"nx": len(self.x), "nz": len(self.z), "step": steps, "first": [self.x[0], self.z[0]]},
            "spacing": float(self.spacing),
            "surface": self.surface,
            "particles": self.particles,
            "obstacles": json_numbers(self.obstacles),
            "plates": len(self.plates),  # the first of the obstacles are wavemakers
            "zones": json_numbers(self.zones),
            "ships": ships,
            "gauges": {name: [float(v) for v in place] for name, place in self.gauges.items()},
            "scalars": list(self.scalars),
            "sea": sea,
            "tank": self.tank,
            "floorLines": apart,
            "platform": platform.get("geometry") if isinstance(platform.get("geometry"), dict) else None,
            "waves": {key: (train | (train.get("spectrum") or {})).get(key) for key in WAVE_KEYS},
            "windAngle": sea_state.scene_wind_heading(wind),
            "windSpeed": sea_state.stated_wind_speed(self.scene) or sea_state.gust_speed(self.scene),
            "windStylised": any(np.any(each.get("acceleration", 0.0)) for each in wind.get("volumes") or [wind]),
            "fluid": (self.scene.get("fluid") or {}).get("kind", ""),
            "speeds": json_numbers(SPEED_COLOURS),
            "light": {name: json_numbers(getattr(sky, name)) for name in LIGHT_NAMES},
            "shaders": {  # in GLSL; a page adds the declarations of its version
                "common": water_glsl.COMMON_FUNCTIONS,
                "functions": water_glsl.WATER_FUNCTIONS,
                "water": water_glsl.water_program(len(ships)),
                "sky": water_glsl.SKY_PROGRAM,
                "floor": water_glsl.shader("tank_ground", tank_walls, sky),
            },
            "uniforms": uniforms,
        }
        return zlib.compress(packet("still", arrays, boxes, **header), 6)

    def ship_header(
        self, k: int, name: str, model: ShipModel, arrays: dict[str, Any], boxes: dict[str, Any]
    ) -> dict[str, Any]:
        """Entry on ship k in the header of the packet. Her triangles and map of distances to the waterline go to
        `arrays`, by name as `corners0`; to `boxes`, by that name, go the corners [m] of the box that an array spans."""
        hull, corners = model.hull, model.mesh.corners.reshape(-1, 3)
        low, high = corners.min(axis=0), corners.max(axis=0)
        arrays[f"corners{k}"] = box_positions(corners, low, high)
        boxes[f"corners{k}"] = {"low": json_numbers(low), "high": json_numbers(high)}
        arrays[f"normals{k}"] = np.rint(127.0 * model.mesh.normals.reshape(-1, 3)).astype(np.int8)
        paint = np.concatenate([model.mesh.colour ** (1.0 / 2.2), model.mesh.gloss[:, None]], axis=1)
        arrays[f"paint{k}"] = np.repeat(np.rint(255.0 * np.clip(paint, 0.0, 1.0)).astype(np.uint8), 3, axis=0)
        line = waterline.waterline_segments(hull.vertices, hull.triangles, hull.over_water(hull.vertices))
        config = (self.scene.get("ships") or {}).get(name) or self.scene.get("ship") or {}
        if len(line) > 2:
            reach = min(GAP_REACH, GAP_LENGTHS * float(hull.length))
            near, far = line.min(axis=(0, 1)) - reach, line.max(axis=(0, 1)) + reach
            x, z = (middles_of(low, high, GAP_CELLS) for low, high in zip(near, far))
            gap = waterline.distance_to_line(np.stack(np.meshgrid(x, z), axis=-1).reshape(-1, 2), line)
            arrays[f"gap{k}"] = gap.astype(np.float32).reshape(GAP_CELLS, GAP_CELLS)
            boxes[f"gap{k}"] = {"near": json_numbers(near), "far": json_numbers(far)}
        return {
            "name": name,
            "length": float(hull.length),
            "beam": float(hull.breadth),
            "helm": json_numbers(model.helm),
            "steered": config.get("propeller", True) is not None,  # kinds without the key have their own
        }

    def sea_header(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Two header entries: plane waves of the sea around the basin, and uniforms of the water shader."""
        height = self.waves.significant_height if self.waves is not None else 0.5
        angle, wind = sea_state.wind_heading(self.scene, self.waves), sea_state.ripple_wind_speed(self.scene, height)
        if self.waves is not None:
            most = np.argsort(self.waves.amplitude)[::-1][:MAX_FAR_WAVES]
            energy, kept = self.waves.amplitude**2, self.waves.amplitude[most]
            kept = kept * np.sqrt(energy.sum() / max(energy[most].sum(), 1e-30))
            rows = np.column_stack([kept, self.waves.wavevector[most], self.waves.omega[most], self.waves.phase[most]])
            resolved = pi / float(self.waves.wavenumber.max())
        else:
            rows = synthetic_waves(angle, float(min(np.ptp([self.lower[0], self.upper[0]]), 200.0)), self.spacing)
            resolved = self.spacing
        uniforms = water_glsl.neutral_uniforms(len(self.models)) | {
            "hullFoam": np.array([0.0, 0.0, 0.0] if self.tank else [0.75, 0.55, 0.0]),
            "windAngle": angle,
            "rippleVariance": 0.0 if self.tank else water_shading.slope_variance(wind),
            "rippleLongest": float(np.clip(2.0 * resolved, *RIPPLE_LENGTHS)),
        }
        ramp = self.waves.ramp if self.waves else 0.0
        known = {"waves": json_numbers(rows), "exact": self.waves is not None, "ramp": ramp}
        return known, {name: json_numbers(np.asarray(value, dtype=float).T) for name, value in uniforms.items()}


LIGHT_NAMES = ("SUNSHINE", "FROM_ABOVE", "FROM_BELOW", "MIRRORED")
WAVE_KEYS = ("kind", "height", "period", "significant_wave_height", "peak_period")  # of a train or a spectrum


def synthetic_waves(angle: float, length: float, spacing: float) -> np.ndarray:
    """Invented plane waves about the `angle` [rad, from +x to +z] to which the wind blows, where none are known around
    a basin of `length` [m] with heights `spacing` [m] apart. Rows (SYNTHETIC_WAVES, 5): amplitude [m] (together 1 m
    significant height), wavevector x, z [1/m], frequency [rad/s], phase [rad]."""
    share = (np.arange(SYNTHETIC_WAVES) + 0.5) / SYNTHETIC_WAVES
    wavelength = max(4.0 * spacing, 0.08 * length) ** (1.0 - share) * (0.7 * length) ** share
    turn = 0.9 * np.sin(2.399963 * (np.arange(SYNTHETIC_WAVES) + 1.0) * 7.0)
    amplitude = wavelength * np.cos(turn) ** 2
    amplitude *= 0.25 * np.sqrt(2.0 / (amplitude**2).sum())
    k = 2.0 * pi / wavelength
    phase = 2.0 * pi * np.mod(0.754877666 * np.arange(SYNTHETIC_WAVES), 1.0)
    return np.column_stack([amplitude, k * np.cos(angle + turn), k * np.sin(angle + turn), np.sqrt(GRAVITY * k), phase])


@cache
def sky_packet() -> bytes:
    """Packet of kind `sky`, compressed: the sky with its mipmaps, and its haze, as shared-exponent colours."""
    seen = sky.cloudy_sky(SKY_SIDE)
    images = {"haze": seen.haze} | {f"level{k}": image for k, image in enumerate(seen.levels)}
    lit = {name: json_numbers(value) for name, value in water_glsl.sky_uniforms(seen).items()}
    return zlib.compress(packet("sky", {name: shared_exponent(image) for name, image in images.items()}, lit=lit), 6)


def shared_exponent(image: np.ndarray) -> np.ndarray:
    """RGB image (rows, columns, 3) as uint32 pixels in OpenGL's RGB9_E5: three 9-bit mantissas, a 5-bit exponent."""
    colours = np.clip(image, 0.0, 65000.0)
    exponent = np.clip(np.ceil(np.log2(np.maximum(colours.max(axis=-1), 2.0**-16))), -15, 16)
    unit = 2.0 ** (exponent - 9)
    parts = np.minimum(np.rint(colours / unit[..., None]), 511).astype(np.uint32)
    stored = (exponent + 15).astype(np.uint32)
    return parts[..., 0] | parts[..., 1] << 9 | parts[..., 2] << 18 | stored << 27


def spacing_of(places: np.ndarray) -> float:
    """Spacing [m] of evenly spaced coordinates [m]; 0 if there is only one."""
    return float(places[1] - places[0]) if len(places) > 1 else 0.0


def json_numbers(value: Any) -> Any:
    """Number as a float, or array as nested lists, for JSON, with seven significant digits."""
    array = np.asarray(value, dtype=float)
    return [json_numbers(part) for part in array] if array.ndim else float(f"{float(array):.7g}")


@cache
def page_file(name: str) -> str:
    """Text of one of the page's files in the folder `static`, such as index.html."""
    return (Path(__file__).parent / "static" / name).read_text(encoding="utf-8")


def page_document(title: str, start: dict[str, Any], data: dict[str, bytes] | None = None) -> bytes:
    """HTML page with a `title`, in UTF-8; `start`: constants for its programs; `data`: packets to contain, by name."""
    held = "".join(
        f'<script type="application/octet-stream" id="{name}">{base64.b64encode(content).decode()}</script>\n'
        for name, content in (data or {}).items()
    )
    given = json.dumps(start, allow_nan=False).replace("<", "\\u003c")
    contents = {
        "<!--title-->": html.escape(title),
        "/*style*/": page_file("style.css"),
        "<!--data-->": held,
        "/*start*/": f"const START = {given};",
        "/*program*/": "".join(page_file(f"{name}.js") for name in SCRIPT_NAMES),
    }
    places = "|".join(map(re.escape, contents))
    return re.sub(places, lambda place: contents[place[0]], page_file("index.html")).encode(errors="replace")
