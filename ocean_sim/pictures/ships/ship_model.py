"""Looks of ships: a yacht, a tug and a barge on hulls of any size, and test bodies in two colours.

A model stands on the deck of the physical hull and is scaled by its dimensions.
"""

from typing import NamedTuple

import numpy as np

from ocean_sim.pictures.ships.ship_hull import Hull, Sheer
from ocean_sim.pictures.ships.ship_parts import Block, Mesh, level_outline, merge_meshes, mirrored_pair, tube_mesh

PAINTS = {  # linear RGB
    "white": (0.80, 0.80, 0.77),
    "cream": (0.74, 0.64, 0.42),
    "grey": (0.30, 0.32, 0.34),
    "steel": (0.55, 0.57, 0.58),
    "black": (0.018, 0.019, 0.021),
    "rubber": (0.030, 0.029, 0.028),
    "glass": (0.010, 0.014, 0.018),
    "navy": (0.014, 0.030, 0.105),
    "green": (0.012, 0.075, 0.055),
    "oxide": (0.26, 0.050, 0.028),
    "teak": (0.46, 0.27, 0.12),
    "wood": (0.28, 0.115, 0.038),
    "orange": (0.78, 0.24, 0.020),
    "yellow": (0.80, 0.52, 0.030),
    "blue": (0.0, 0.165, 0.445),
    "emerald": (0.0, 0.342, 0.171),
}


class Cabin(NamedTuple):
    """A symmetric body between two level outlines of a style's table."""

    bottom: tuple[tuple[float, float], ...]  # half breadth and station, from aft
    low: float  # height
    top: tuple[tuple[float, float], ...]
    high: float
    walls: str  # paints
    lid: str
    windows: tuple[tuple[int, int, float, float, float], ...] = ()  # as Block.panes: walls from aft on port
    aside: float = 0.0  # of its middle to port; there is one to starboard, too


class Pole(NamedTuple):
    """A round bar of a style's table."""

    start: tuple[float, float, float]
    end: tuple[float, float, float]
    radii: tuple[float, float]  # units
    paint: str


class Style(NamedTuple):
    """The look of a kind of ship.

    Its tables are in half breadths of the house (x), heights of the house (y) and units of length (z), from the deck at
    the front of the house.
    """

    units: float  # in the length of the hull
    house: float  # half breadth of the house over that of the deck
    eye: tuple[float, float]  # helm over the deck and before amidships, where none is given [units]
    front: float | None  # of the house, abaft the eye [units]; None: the tables begin amidships
    min_height: float  # of the house [units]
    headroom: float  # of the house over the eye [units]
    bulwark: tuple[float, float, float]  # height amidships and at the bow, rake [units]
    paints: tuple[str, str, str, str]  # topsides and bulwark, deck, inside of the bulwark, its cap
    cabins: tuple[Cabin, ...]
    poles: tuple[Pole, ...]
    strake: tuple[float, float, float, str] | None = None  # share of the bulwark's height, out, radius [units], paint


YACHT = Style(
    15.0,
    0.72,
    (1.0, 0.6),
    0.30,
    1.75,
    0.60,
    (0.15, 0.51, 0.24),
    ("navy", "teak", "white", "wood"),
    (
        Cabin(  # deckhouse
            ((1.0, -5.4), (1.0, -0.464), (0.62, 0.35)),
            0.0,
            ((0.90, -5.3), (0.90, -1.2), (0.55, -0.45)),
            1.0,
            "white",
            "white",
            (
                *((k, 5, 0.46, 0.84, 0.22) for k in (0, 4)),
                *((k, 1, 0.46, 0.84, 0.10) for k in (1, 3)),
                (2, 2, 0.44, 0.86, 0.10),
                (5, 2, 0.08, 0.84, 0.20),
            ),
        ),
        Cabin(  # roof
            ((0.98, -6.5), (1.0, -1.0), (0.62, -0.15)),
            1.0,
            ((0.98, -6.5), (1.0, -1.0), (0.62, -0.15)),
            1.057,
            "white",
            "cream",
        ),
        Cabin(  # bridge
            ((0.74, -4.9), (0.74, -1.503), (0.45, -1.1)),
            1.057,
            ((0.76, -5.0), (0.76, -2.2), (0.40, -1.7)),
            1.354,
            "white",
            "teak",
            tuple((k, 1, 0.62, 0.98, 0.06) for k in (1, 2, 3)),
        ),
        Cabin(  # coachroof
            ((0.60, 0.3), (0.60, 3.3), (0.30, 4.6)),
            0.0,
            ((0.54, 0.3), (0.54, 3.0), (0.24, 4.1)),
            0.206,
            "white",
            "teak",
            tuple((k, 4, 0.30, 0.72, 0.5) for k in (0, 4)),
        ),
    ),
    (
        Pole((0.0, 1.0, -3.8), (0.0, 3.06, -3.92), (0.085, 0.045), "white"),  # mast
        Pole((0.0, 1.57, -3.8), (0.0, 2.0, -6.9), (0.050, 0.035), "wood"),  # boom
        Pole((0.0, 3.0, -3.9), (0.0, 2.0, -6.9), (0.010, 0.010), "steel"),  # backstay
        Pole((0.0, 3.0, -3.9), (0.0, 1.057, -0.6), (0.010, 0.010), "steel"),  # forestay
    ),
    (0.0, 0.0, 0.045, "wood"),
)
TUG = Style(
    22.0,
    0.62,
    (3.5, 2.0),
    0.25,
    4.0,
    0.75,
    (0.79, 1.58, 0.40),
    ("green", "oxide", "cream", "black"),
    (
        Cabin(  # deckhouse
            ((1.0, -6.7), (1.0, -0.2), (0.70, 1.5)),
            0.0,
            ((1.0, -6.7), (1.0, -0.3), (0.70, 1.3)),
            0.47,
            "cream",
            "oxide",
            (*((k, 6, 0.48, 0.74, 0.55) for k in (0, 4)), (2, 2, 0.45, 0.75, 0.5)),
        ),
        Cabin(  # wheelhouse
            ((0.64, -3.4), (0.80, -2.8), (0.80, -1.1), (0.50, -0.25)),
            0.47,
            ((0.64, -3.4), (0.80, -2.8), (0.80, -0.716), (0.544, 0.0)),
            1.0,
            "white",
            "white",
            tuple((k, n, 0.46, 0.90, 0.14) for k, n in enumerate((1, 3, 1, 3, 1, 3, 1, 2))),
        ),
        Cabin(  # its roof
            ((0.72, -3.6), (0.90, -3.0), (0.90, -0.8), (0.64, 0.25)),
            1.0,
            ((0.72, -3.6), (0.90, -3.0), (0.90, -0.8), (0.64, 0.25)),
            1.04,
            "orange",
            "white",
        ),
        Cabin(((0.16, -5.5), (0.16, -4.3)), 0.47, ((0.13, -5.7), (0.13, -4.7)), 1.06, "orange", "orange", (), 0.62),
        Cabin(((0.13, -5.7), (0.13, -4.7)), 1.06, ((0.13, -5.75), (0.13, -4.75)), 1.16, "black", "black", (), 0.62),
    ),
    (
        Pole((0.0, 1.0, -2.2), (0.0, 1.99, -2.2), (0.13, 0.06), "white"),  # mast
        Pole((-0.35, 1.71, -2.2), (0.35, 1.71, -2.2), (0.045, 0.045), "white"),  # yard
        Pole((-0.35, 0.18, -7.6), (0.35, 0.18, -7.6), (0.55, 0.55), "steel"),  # towing winch
    ),
    (0.55, 0.15, 0.20, "rubber"),
)
BARGE = Style(
    20.0,
    0.72,
    (1.9, 6.35),
    None,
    1.0,
    -0.9,
    (0.28, 0.44, 0.0),
    ("black", "grey", "grey", "yellow"),
    (
        Cabin(((1.0, -7.2), (1.0, 6.0)), 0.0, ((1.0, -7.2), (1.0, 6.0)), 0.55, "oxide", "grey"),  # coaming
        *(  # containers: four rows of three, two high amidships
            Cabin(
                ((0.29, 3.1 * row - 6.8), (0.29, 3.1 * row - 3.8)),
                0.57 + 1.28 * level,
                ((0.29, 3.1 * row - 6.8), (0.29, 3.1 * row - 3.8)),
                1.82 + 1.28 * level,
                *2 * [("blue", "orange", "emerald", "white", "wood")[(2 * row + column + 3 * level) % 5]],
                (),
                0.62 * column,
            )
            for row in range(4)
            for column in range(2)
            for level in range(2 if row in (1, 2) else 1)
        ),
    ),
    (
        Pole((0.0, 0.0, 9.2), (0.0, 3.0, 9.2), (0.08, 0.05), "white"),  # mast
        Pole((0.0, 3.0, 9.2), (0.0, 3.3, 9.2), (0.14, 0.14), "yellow"),  # light
    ),
)
STYLES = {"yacht": YACHT, "tug": TUG, "barge": BARGE, "box": BARGE, "outline": YACHT}  # by a word of a look
FILE_PAINTS = "oxide", "white", "navy", "teak"  # of a hull from a file, which may bring its own house
BODY_PAINTS = "grey", "white", "yellow", "orange"  # of a body without a style: test bodies


class Model(NamedTuple):
    """A ship to be drawn, body axes from its centre of mass."""

    mesh: Mesh
    helm: np.ndarray  # (3,) eye of a helmsman [m]
    length: float  # of the hull [m]


def build_model(vertices: np.ndarray, triangles: np.ndarray, submerged: float, look: str, helm: np.ndarray) -> Model:
    """Model on a hull, the share `submerged` of whose volume is under water at rest.

    `look`: name of the hull, then its kind of shape; `helm`: a named point, or nothing.
    """
    hull = Hull(np.asarray(vertices, dtype=float), np.asarray(triangles, dtype=int), submerged)
    given = np.asarray(helm, dtype=float) if np.isfinite(helm).all() and np.size(helm) else None
    from_file = "mesh" in look.lower()
    style = next((style for word, style in STYLES.items() if word in look.lower()), None)
    if style is not None and not from_file and hull.has_deck:
        return styled_model(hull, style, given)
    eye = given if given is not None else np.array([0.0, hull.upper[1] + 0.15 * hull.depth, 0.1 * hull.length])
    paints = (PAINTS[name] for name in (FILE_PAINTS if from_file else BODY_PAINTS))
    return Model(hull.painted(*paints), eye, hull.length)


def styled_model(hull: Hull, style: Style, helm: np.ndarray | None) -> Model:
    """Hull with bulwark, and the cabins and poles of a style."""
    unit = hull.length / style.units
    amidships, bow, rake = (unit * length for length in style.bulwark)
    sheer = Sheer(hull, (amidships, bow), rake)
    middle = 0.5 * (sheer.stern + sheer.bow)
    deck, half = float(sheer.deck_height(middle)), style.house * float(sheer.half_breadth(middle))
    eye = helm if helm is not None else np.array([0.0, deck + style.eye[0] * unit, middle + style.eye[1] * unit])
    height = max(style.min_height * unit, float(eye[1]) - deck + style.headroom * unit)
    front = middle if style.front is None else float(eye[2]) - style.front * unit
    scale, origin = np.array([half, height, unit]), np.array([0.0, deck, front])
    topsides, deck_paint, inside, cap = (PAINTS[name] for name in style.paints)
    parts = [
        hull.painted(PAINTS["oxide"], PAINTS["white"], topsides, deck_paint),
        sheer.bulwark(topsides, inside, cap, 0.1 * unit),
    ]
    if style.strake is not None:
        share, out, radius, paint = style.strake
        parts.append(sheer.strake(share, out * unit, radius * unit, PAINTS[paint]))
    for cabin in style.cabins:
        outlines = [(*zip(*cabin.bottom), cabin.low), (*zip(*cabin.top), cabin.high)]
        low, high = (origin + scale * (level_outline(*each) + [cabin.aside, 0.0, 0.0]) for each in outlines)
        block = Block(low, high)
        mesh = block.mesh(PAINTS[cabin.walls], PAINTS[cabin.lid])
        parts.append(mirrored_pair(mesh) if cabin.aside else mesh)
        parts += [block.panes(*window, PAINTS["glass"]) for window in cabin.windows]
    for pole in style.poles:
        start, end = (origin + scale * np.array(point) for point in (pole.start, pole.end))
        parts.append(tube_mesh(start, end, (pole.radii[0] * unit, pole.radii[1] * unit), PAINTS[pole.paint], 12))
    return Model(merge_meshes(parts), eye, hull.length)
