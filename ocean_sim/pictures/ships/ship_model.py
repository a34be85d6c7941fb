"""Looks of ships: a yacht, a tug and a barge on hulls of any size, and test bodies in two colours.

A model stands on the deck of the physical hull and is scaled by its dimensions. Colours are linear RGB.
"""

from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from ocean_sim.pictures.ships.ship_hull import Hull, Sheer, strake
from ocean_sim.pictures.ships.ship_parts import Block, Mesh, both, box, merged, outline, path, tube

WHITE, CREAM, GREY, STEEL = (0.80, 0.80, 0.77), (0.74, 0.64, 0.42), (0.30, 0.32, 0.34), (0.55, 0.57, 0.58)
BLACK, RUBBER, GLASS = (0.018, 0.019, 0.021), (0.030, 0.029, 0.028), (0.010, 0.014, 0.018)
NAVY, GREEN, OXIDE, RED = (0.014, 0.030, 0.105), (0.012, 0.075, 0.055), (0.26, 0.050, 0.028), (0.42, 0.030, 0.022)
SEAM = (0.11, 0.055, 0.024)  # pitch between planks
TEAK, WOOD, ORANGE, YELLOW = (0.46, 0.27, 0.12), (0.28, 0.115, 0.038), (0.78, 0.24, 0.020), (0.80, 0.52, 0.030)
CARGO = ((0.0, 0.165, 0.445), (0.665, 0.115, 0.0), (0.0, 0.342, 0.171), (0.55, 0.53, 0.48), (0.42, 0.17, 0.03))


class Model(NamedTuple):
    """A ship to be drawn, body axes from its centre of mass."""

    mesh: Mesh
    helm: np.ndarray  # (3,) eye of a helmsman [m]
    length: float  # of the hull [m]


def build_model(vertices: np.ndarray, triangles: np.ndarray, submerged: float, look: str, helm: np.ndarray) -> Model:
    """The ship on a hull, the share `submerged` of whose volume is under water at rest.

    `look`: name of the hull, then its kind of shape; `helm`: a named point, or nothing.
    """
    hull = Hull(np.asarray(vertices, dtype=float), np.asarray(triangles, dtype=int), submerged)
    build = next((made for word, made in MODELS.items() if word in look.lower()), test_body)
    if build is not plain and not hull.has_deck:
        build = test_body
    given = np.asarray(helm, dtype=float) if np.isfinite(helm).all() and np.size(helm) else None
    return build(hull, given)


def yacht(hull: Hull, helm: np.ndarray | None) -> Model:
    """A motor yacht: coachroof before a raked deckhouse with a bridge on its roof, cockpit aft, a mast with a boom."""
    sheer = Sheer(hull, (0.010 * hull.length, 0.034 * hull.length), 0.016 * hull.length)
    u, middle = hull.length / 15.0, 0.5 * (sheer.stern + sheer.bow)
    deck = float(sheer.deck(middle))
    eye = helm if helm is not None else np.array([0.0, deck + 1.0 * u, middle + 0.6 * u])
    front, back = float(eye[2]) - 0.30 * u, sheer.stern + 2.4 * u  # of the deckhouse, at the height of the eye
    half = 0.72 * float(sheer.half(0.5 * (front + back)))
    roof = deck + max(1.75 * u, float(eye[1]) - deck + 0.60 * u)
    nose, end = sheer.bow - 2.6 * u, front + 0.30 * u
    rear, masthead, boom_end = back + 1.6 * u, roof + 3.6 * u, [0.0, roof + 1.75 * u, sheer.stern + 0.9 * u]

    def level(halves: Any, z: Any, y: float) -> np.ndarray:
        return outline(half * np.array(halves), z, y)

    walls = Block(
        level([1.0, 1.0, 0.62], [back, front - 0.464 * u, front + 0.35 * u], deck),
        level([0.90, 0.90, 0.55], [back + 0.1 * u, front - 1.2 * u, front - 0.45 * u], roof),
    )
    over = level([0.98, 1.0, 0.62], [back - 1.1 * u, front - 1.0 * u, front - 0.15 * u], roof)
    bridge = Block(
        level([0.74, 0.74, 0.45], [back + 0.5 * u, front - 1.503 * u, front - 1.1 * u], roof + 0.10 * u),
        level([0.76, 0.76, 0.40], [back + 0.4 * u, front - 2.2 * u, front - 1.7 * u], roof + 0.62 * u),
    )
    coach = Block(
        level([0.60, 0.60, 0.30], [end, nose - 1.3 * u, nose], deck),
        level([0.54, 0.54, 0.24], [end, nose - 1.6 * u, nose - 0.5 * u], deck + 0.36 * u),
    )
    staff = sheer.top(np.array([sheer.stern]))[0] * [0.0, 1.0, 1.0]
    parts = [
        hull.painted(OXIDE, WHITE, NAVY, TEAK),
        portholes(hull, deck - 0.85 * u, np.linspace(front - 3.6 * u, front + 3.6 * u, 6), 0.17 * u),
        tube(staff, staff + [0.0, 1.5 * u, -0.35 * u], 0.022 * u, WOOD),
        box(staff + [-0.008 * u, 0.95 * u, -1.1 * u], staff + [0.008 * u, 1.42 * u, -0.34 * u], RED),
        sheer.bulwark(NAVY, WHITE, WOOD, 0.07 * u),
        strake(sheer.foot(sheer.stations), 0.045 * u, WOOD),
        sheer.rail(front - 0.6 * u, sheer.bow - 0.12 * u, 0.42 * u, 0.85 * u, 0.017 * u, STEEL, 0.035 * u),
        sheer.rail(sheer.stern, back + 0.6 * u, 0.42 * u, 0.9 * u, 0.017 * u, STEEL, 0.035 * u),
        walls.mesh(WHITE),
        *(walls.panes(k, 5, 0.46, 0.84, GLASS) for k in (0, 4)),
        *(walls.panes(k, 1, 0.46, 0.84, GLASS, 0.10) for k in (1, 3)),
        walls.panes(2, 2, 0.44, 0.86, GLASS, 0.10),
        walls.panes(5, 2, 0.08, 0.84, GLASS, 0.2),
        Block(over, over + [0.0, 0.10 * u, 0.0]).mesh(WHITE, CREAM),
        bridge.mesh(WHITE, TEAK),
        *(bridge.panes(k, 1, 0.62, 1.12, GLASS, 0.06) for k in (1, 2, 3)),
        coach.mesh(WHITE, TEAK),
        *(coach.panes(k, 4, 0.30, 0.72, GLASS, 0.5) for k in (0, 4)),
        seams(coach.top, 0.16 * u, SEAM),
        hatch(0.0, deck + 0.36 * u, 0.5 * (end + nose), 0.36 * u),
        tube([0.0, roof, rear], [0.0, masthead, rear - 0.12 * u], (0.085 * u, 0.045 * u), WHITE),
        tube([0.0, roof + 1.0 * u, rear], boom_end, (0.05 * u, 0.035 * u), WOOD),
        tube([0.0, masthead - 0.1 * u, rear - 0.1 * u], boom_end, 0.010 * u, STEEL, 5),
        tube([0.0, masthead - 0.1 * u, rear - 0.1 * u], [0.0, roof + 0.1 * u, front - 0.6 * u], 0.010 * u, STEEL, 5),
    ]
    return Model(merged(parts), eye, hull.length)


def tug(hull: Hull, helm: np.ndarray | None) -> Model:
    """A harbour tug: a fender all round, deckhouse, wheelhouse all of glass, funnels, a mast, a towing winch aft."""
    sheer = Sheer(hull, (0.036 * hull.length, 0.072 * hull.length), 0.018 * hull.length)
    u, middle = hull.length / 22.0, 0.5 * (sheer.stern + sheer.bow)
    deck = float(sheer.deck(middle))
    eye = helm if helm is not None else np.array([0.0, deck + 3.5 * u, middle + 2.0 * u])
    half = 0.62 * float(sheer.half(middle))
    floor = max(deck + 2.0 * u, float(eye[1]) - 1.5 * u)  # of the wheelhouse
    front = float(eye[2]) - 0.25 * u
    roof, back, wide = float(eye[1]) + 0.75 * u, front - 3.4 * u, 0.80 * half
    winch, mast = back - 4.0 * u, roof + 4.2 * u
    house = Block(
        outline([half, half, 0.7 * half], [back - 3.3 * u, front - 0.2 * u, front + 1.5 * u], deck),
        outline([half, half, 0.7 * half], [back - 3.3 * u, front - 0.3 * u, front + 1.3 * u], floor),
    )

    def level(halves: Any, z: Any, y: float) -> np.ndarray:
        return outline(
            wide * np.array(halves), [back + z[0] * u, back + z[1] * u, front + z[2] * u, front + z[3] * u], y
        )

    wheelhouse = Block(
        level([0.8, 1.0, 1.0, 0.62], [0.0, 0.6, -1.1, -0.25], floor),
        level([0.8, 1.0, 1.0, 0.68], [0.0, 0.6, -0.716, 0.0], roof),
    )
    lid = level([0.9, 1.12, 1.12, 0.8], [-0.2, 0.4, -0.8, 0.25], roof)
    side = np.array([0.62 * half, 0.0, back - 1.5 * u])
    funnel = Block(
        outline([0.42 * u, 0.42 * u], [-0.62 * u, 0.62 * u], floor) + side,
        outline([0.34 * u, 0.34 * u], [-0.50 * u, 0.50 * u], floor + 2.5 * u) + side - [0.0, 0.0, 0.3 * u],
    )
    fender = sheer.top(sheer.stations, above=-0.45 * sheer.rise(sheer.stations)) + [0.15 * u, 0.0, 0.0]
    fender[-1] = fender[-1] * [0.0, 1.0, 1.0] + [0.0, 0.0, 0.14 * u]
    crown = Block(funnel.top, funnel.top + [0.0, 0.45 * u, -0.05 * u])
    parts = [
        hull.painted(OXIDE, WHITE, GREEN, OXIDE),
        sheer.bulwark(GREEN, CREAM, BLACK, 0.12 * u),
        strake(fender, 0.20 * u, RUBBER),
        house.mesh(CREAM, OXIDE),
        *(house.panes(k, 6, 0.48, 0.74, GLASS, 0.55) for k in (0, 4)),
        house.panes(2, 2, 0.45, 0.75, GLASS, 0.5),
        wheelhouse.mesh(WHITE),
        *(wheelhouse.panes(k, n, 0.46, 0.90, GLASS, 0.14) for k, n in enumerate((1, 3, 1, 3, 1, 3, 1, 2))),
        Block(lid, lid + [0.0, 0.16 * u, 0.0]).mesh(ORANGE, WHITE),
        both(merged([funnel.mesh(ORANGE), crown.mesh(BLACK)])),
        tube([0.0, roof, back + 1.2 * u], [0.0, mast, back + 1.2 * u], (0.13 * u, 0.06 * u), WHITE),
        tube([-1.0 * u, mast - 1.2 * u, back + 1.2 * u], [1.0 * u, mast - 1.2 * u, back + 1.2 * u], 0.045 * u, WHITE),
        tube([0.0, roof, back - 0.1 * u], [0.0, mast - 1.2 * u, back + 1.2 * u], 0.04 * u, WHITE),
        tube([-0.9 * u, deck + 0.75 * u, winch], [0.9 * u, deck + 0.75 * u, winch], 0.55 * u, STEEL, 14),
        both(box((0.9 * u, deck, winch - 0.7 * u), (1.1 * u, deck + 1.35 * u, winch + 0.7 * u), GREY)),
        *house_rail(house.top, 0.75 * u, 0.026 * u),
    ]
    return Model(merged(parts), eye, hull.length)


def barge(hull: Hull, helm: np.ndarray | None) -> Model:
    """A cargo barge: coaming with a stack of containers, a low bulwark, a mast with a light."""
    sheer = Sheer(hull, (0.014 * hull.length, 0.022 * hull.length), 0.0)
    u, deck = hull.length / 20.0, float(sheer.deck(0.0))
    half = 0.72 * float(sheer.half(0.5 * (sheer.stern + sheer.bow)))
    start, end = sheer.stern + 0.14 * hull.length, sheer.bow - 0.20 * hull.length
    mast, top = sheer.bow - 0.8 * u, deck + 3.0 * u
    parts = [
        hull.painted(OXIDE, WHITE, BLACK, GREY),
        sheer.bulwark(BLACK, GREY, YELLOW, 0.10 * u),
        box((-half, deck, start), (half, deck + 0.55 * u, end), OXIDE, GREY),
        *containers(half - 0.15 * u, deck + 0.57 * u, start + 0.2 * u, end - 0.2 * u, u),
        tube([0.0, deck, mast], [0.0, top, mast], (0.08 * u, 0.05 * u), WHITE),
        box((-0.12 * u, top, mast - 0.12 * u), (0.12 * u, top + 0.3 * u, mast + 0.12 * u), YELLOW),
    ]
    eye = helm if helm is not None else np.array([0.0, deck + 1.9 * u, end + 0.35 * u])
    return Model(merged(parts), eye, hull.length)


def plain(hull: Hull, helm: np.ndarray | None) -> Model:
    """A hull from a file, which may bring its own house: paint and nothing else."""
    eye = helm if helm is not None else np.array([0.0, hull.upper[1] + 0.15 * hull.depth, 0.1 * hull.length])
    return Model(hull.painted(OXIDE, WHITE, NAVY, TEAK), eye, hull.length)


def test_body(hull: Hull, helm: np.ndarray | None) -> Model:
    """A body of a test: yellow above the waterline at rest, dark below, and white at the waterline, a mark at half
    its freeboard and one at half its draught; a deck of another colour."""
    deck = hull.values[hull.is_deck]
    level = len(deck) > 0 and np.ptp(deck[:, :, 1]) < 0.05 * hull.depth
    sides = hull.values[~hull.is_deck] if level else hull.values
    thick, draught = 0.012 * hull.depth, max(hull.depth - hull.freeboard, 0.1 * hull.depth)
    bands: list[tuple[float, Any]] = []
    for mark, below, line in ((-0.5 * draught, GREY, WHITE), (0.0, GREY, WHITE), (0.5 * hull.freeboard, YELLOW, BLACK)):
        bands += [(mark - thick, below), (mark + thick, line)]
    mesh = hull.banded(sides, [*bands, (np.inf, YELLOW)])
    if level:
        mesh = merged([mesh, hull.banded(deck, [(np.inf, ORANGE)])])
    eye = helm if helm is not None else np.array([0.0, hull.upper[1] + 0.15 * hull.depth, 0.1 * hull.length])
    return Model(mesh, eye, hull.length)


def portholes(hull: Hull, y: float, stations: np.ndarray, radius: float) -> Mesh:
    """Round windows with rims in both sides, at a height [m]."""
    places = [hull.side(y, float(z)) for z in stations]
    looks = (1.25, 0.12, STEEL), (1.0, 0.20, GLASS)  # radii, how far they stand out, and colours of rim and pane
    return both(
        merged(
            tube(point - 0.1 * radius * out, point + far * radius * out, wide * radius, colour, 16)
            for point, out in places
            for wide, far, colour in looks
        )
    )


def hatch(x: float, y: float, z: float, half: float) -> Mesh:
    """Square hatch with a dark pane."""
    frame = box((x - half, y, z - half), (x + half, y + 0.25 * half, z + half), STEEL)
    low, high = y + 0.25 * half, y + 0.31 * half
    pane = box((x - 0.8 * half, low, z - 0.8 * half), (x + 0.8 * half, high, z + 0.8 * half), GLASS)
    return merged([frame, pane])


def seams(top: np.ndarray, apart: float, colour: Any) -> Mesh:
    """Thin lines along the planks of a roof (k, 3) that tapers to the bow."""
    half = top[top[:, 0] > 0.0]
    half = half[np.argsort(half[:, 2])]
    start, y, thin = float(half[0, 2]), float(half[0, 1]), 0.03 * apart
    parts = []
    for x in np.arange(0.5 * apart, 0.97 * float(half[:, 0].max()), apart):
        end = float(np.interp(-x, -half[:, 0], half[:, 2])) - thin
        parts.append(box((x - thin, y, start + thin), (x + thin, y + 0.4 * thin, end), colour))
    return both(merged(parts))


def house_rail(roof: np.ndarray, height: float, radius: float) -> list[Mesh]:
    """Posts and bars along the edge of a roof."""
    line = np.concatenate([roof, roof[:1]]) * [0.96, 1.0, 1.0]
    parts = [path(line + [0.0, share * height, 0.0], radius, STEEL) for share in (0.5, 1.0)]
    for a, b in pairwise(line):
        count = max(1, round(float(np.linalg.norm(b - a)) / height))
        for point in a + (b - a) * (np.arange(count) / count)[:, None]:
            parts.append(tube(point, point + [0.0, height, 0.0], radius, STEEL, 6))
    return parts


def containers(half: float, y: float, start: float, end: float, u: float) -> list[Mesh]:
    """Stacks of boxes with ribs, two high amidships; their colours in turns."""
    long, gap, high = 3.0 * u, 0.12 * u, 1.25 * u
    rows, across = max(1, int((end - start + gap) / (long + gap))), max(1, round(half / (0.75 * u)))
    wide, first = (2.0 * half - gap * (across - 1)) / across, 0.5 * (start + end) - 0.5 * (rows * (long + gap) - gap)
    parts = []
    for row in range(rows):
        for column in range(across):
            levels = 2 if 0 < row < rows - 1 or (row + column) % 3 == 0 else 1
            for level in range(levels):
                x, z, low = -half + column * (wide + gap), first + row * (long + gap), y + level * (high + 0.03 * u)
                paint = np.array(CARGO[(2 * row + 3 * column + 4 * level) % len(CARGO)])
                parts.append(box((x, low, z), (x + wide, low + high, z + long), paint))
                out = 0.03 * u
                for rib in np.linspace(z + 0.1 * u, z + long - 0.16 * u, 8):
                    parts.append(
                        box((x - out, low, rib), (x + wide + out, low + high - out, rib + 0.06 * u), 0.8 * paint)
                    )
    return parts


MODELS: dict[str, Callable[[Hull, np.ndarray | None], Model]] = {
    "mesh": plain,
    "yacht": yacht,
    "tug": tug,
    "barge": barge,
    "box": barge,
    "outline": yacht,
}
