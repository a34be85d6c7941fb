"""Drawn models of ships: a yacht, a tug and a barge on hulls of any size, and plain bodies.

A model stands on the deck of the physical hull and is scaled by its dimensions.
"""

from collections.abc import Mapping
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ocean_sim.files.yaml_file import read_mapping
from ocean_sim.parts import SEVERAL, library
from ocean_sim.pictures.frame_files import ship_keys
from ocean_sim.pictures.ships import ship_parts
from ocean_sim.pictures.ships.ship_parts import Hull
from ocean_sim.pictures.stage.render_order import RenderFailed
from ocean_sim.pictures.stage.sky import painted_light
from ocean_sim.pictures.water import water_shading

STYLE_WORDS = {"yacht": "yacht", "tug": "tug", "barge": "barge", "outline": "yacht"}  # in a look
FILE_PAINTS = "oxide", "white", "navy", "teak"  # of a hull from a file, which may bring its own house
BODY_PAINTS = 4 * ("yellow",)  # of a body without a style, a box or a cylinder: plain


class ShipModel(NamedTuple):
    """Drawn model of a ship in body axes from her centre of mass: painted mesh, helmsman's eye and physical hull."""

    mesh: ship_parts.Mesh
    helm: np.ndarray  # (3,) eye of a helmsman [m]
    hull: Hull

    @property
    def length(self) -> float:
        return float(self.hull.length)

    def placed(self, position: np.ndarray, turn: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Corners (n, 3) [m] of the mesh, three per triangle, with the centre of mass at `position`, and their 8-bit
        display RGB in the light of sun and sky; `turn`: (3, 3) from body to world."""
        mesh, normals = self.mesh, self.mesh.normals.reshape(-1, 3) @ turn.T
        paint, gloss = np.repeat(mesh.colour, 3, axis=0), np.repeat(mesh.gloss, 3)[:, None]
        points = mesh.corners.reshape(-1, 3) @ turn.T + position
        return points, water_shading.display_colours(painted_light(normals, paint, gloss))


def kept_models(grid: Mapping[str, Any]) -> dict[str, ShipModel]:
    """Models to draw of all ships of a run, by ship name, from the arrays in its grid.npz (`grid`)."""
    return {key.removeprefix(f"{SEVERAL}."): kept_model(grid, key) for key in ship_keys(grid, "_look")}


def kept_model(grid: Mapping[str, Any], key: str) -> ShipModel:
    """Ship model to draw, by ship key, from the arrays in grid.npz (`grid`); raises RenderFailed without them."""
    if f"{key}_still_water" not in grid:
        raise RenderFailed("these frames are of an older version, which kept no ship to draw; run the scene again")
    names = "vertices", "triangles", "still_water", "look", "helm"
    vertices, triangles, still_water, look, helm = (grid[f"{key}_{name}"] for name in names)
    return build_model(vertices, triangles, still_water, str(look), helm)


def build_model(
    vertices: np.ndarray, triangles: np.ndarray, still_water: np.ndarray, look: str, helm: np.ndarray
) -> ShipModel:
    """Drawn model of a ship on a hull: vertices (n, 3) [m], triangles (m, 3). `still_water` (4,): as in `ship.Look`;
    `look`: names of hull and shape, by which a style is chosen; `helm`: eye of the helmsman [m], or empty."""
    hull = Hull(np.asarray(vertices, dtype=float), np.asarray(triangles, dtype=int), still_water)
    given = np.asarray(helm, dtype=float) if np.isfinite(helm).all() and np.size(helm) else None
    from_file = "mesh" in look.lower()
    style = next((style for word, style in STYLE_WORDS.items() if word in look.lower()), None)
    if style is not None and not from_file and hull.has_deck:
        return styled_model(hull, style_of(style), given)
    eye = given if given is not None else np.array([0.0, hull.upper[1] + 0.15 * hull.depth, 0.1 * hull.length])
    paints = (PAINTS[name] for name in (FILE_PAINTS if from_file else BODY_PAINTS))
    return ShipModel(hull.painted(*paints), eye, hull)


@cache
def style_of(name: str) -> dict[str, Any]:
    """Style of a kind of ship (cabins, colours), or the common paints: the contents of configs/look/`name`.yaml."""
    return dict(read_mapping(library("configs") / "look" / f"{name}.yaml").plain())


PAINTS = style_of("paints")  # linear RGB


def styled_model(hull: Hull, style: dict[str, Any], helm: np.ndarray | None) -> ShipModel:
    """Drawn model of a hull with the bulwark, cabins and poles of a style; `helm`: eye of the helmsman [m], or None."""
    unit = hull.length / style["units"]
    amidships, bow, rake = (unit * length for length in style["bulwark"])
    sheer = ship_parts.Sheer(hull, (amidships, bow), rake)
    middle = 0.5 * (sheer.stern + sheer.bow)
    deck, half = float(sheer.deck_height(middle)), style["house"] * float(sheer.half_breadth(middle))
    over_deck, ahead = style["eye"]
    eye = helm if helm is not None else np.array([0.0, deck + over_deck * unit, middle + ahead * unit])
    height = max(style["min_height"] * unit, float(eye[1]) - deck + style["headroom"] * unit)
    front = middle if style["front"] is None else float(eye[2]) - style["front"] * unit
    scale, origin = np.array([half, height, unit]), np.array([0.0, deck, front])
    topsides, deck_paint, inside, cap = (PAINTS[name] for name in style["paints"])
    parts = [
        hull.painted(PAINTS["oxide"], PAINTS["white"], topsides, deck_paint),
        sheer.bulwark(topsides, inside, cap, 0.1 * unit),
    ]
    if "strake" in style:
        bar = style["strake"]
        parts.append(sheer.strake(bar["share"], bar["out"] * unit, bar["radius"] * unit, PAINTS[bar["paint"]]))
    for cabin in style["cabins"]:
        aside = cabin.get("aside", 0.0)  # distance of its middle to port; there is one to starboard, too
        ends = ("bottom", "low"), ("top", "high")
        outlines = (ship_parts.level_outline(cabin[outline], cabin[height]) for outline, height in ends)
        block = ship_parts.Block(*(origin + scale * (outline + [aside, 0.0, 0.0]) for outline in outlines))
        mesh = block.mesh(PAINTS[cabin["walls"]], PAINTS[cabin["lid"]])
        parts.append(ship_parts.mirrored_pair(mesh) if aside else mesh)
        for wall, count, low, high, post in cabin.get("windows", []):
            parts.append(block.panes(wall, count, low, high, post, PAINTS["glass"]))
    for pole in style["poles"]:
        start, end = (origin + scale * np.array(pole[name]) for name in ("start", "end"))
        thick, thin = (unit * radius for radius in pole["radii"])
        parts.append(ship_parts.tube_mesh(start, end, (thick, thin), PAINTS[pole["paint"]], 12))
    return ShipModel(ship_parts.merge_meshes(parts), eye, hull)
