"""What ships look like: a yacht, a tug and a barge on hulls of any size, and test bodies in two colours.

A model stands on the deck of the physical hull and is scaled by its dimensions. Colours are linear RGB.
"""

from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from ocean_sim.pictures.ship_hull import Hull, Sheer
from ocean_sim.pictures.ship_parts import Block, Mesh, banded, both, box, merged, outline, path, tube

WHITE, CREAM, GREY, STEEL = (0.80, 0.80, 0.77), (0.74, 0.64, 0.42), (0.30, 0.32, 0.34), (0.55, 0.57, 0.58)
BLACK, RUBBER, GLASS = (0.018, 0.019, 0.021), (0.030, 0.029, 0.028), (0.010, 0.014, 0.018)
NAVY, GREEN, OXIDE, RED = (0.014, 0.030, 0.105), (0.012, 0.075, 0.055), (0.26, 0.050, 0.028), (0.42, 0.030, 0.022)
TEAK, WOOD, ORANGE, YELLOW = (0.46, 0.27, 0.12), (0.28, 0.115, 0.038), (0.78, 0.24, 0.020), (0.80, 0.52, 0.030)
PITCH = (0.11, 0.055, 0.024)  # between planks
CARGO = ((0.0, 0.165, 0.445), (0.665, 0.115, 0.0), (0.0, 0.342, 0.171), (0.55, 0.53, 0.48), (0.42, 0.17, 0.03))


class Model(NamedTuple):
    """A ship to be drawn, body axes from its centre of mass."""

    mesh: Mesh
    helm: np.ndarray  # (3,) where the eye of a helmsman is [m]
    length: float  # of the hull [m]


def modelled(vertices: np.ndarray, triangles: np.ndarray, submerged: float, look: str, helm: np.ndarray) -> Model:
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
    u, deck = hull.length / 15.0, float(sheer.deck(0.5 * (sheer.stern + sheer.bow)))
    middle = 0.5 * (sheer.stern + sheer.bow)
    eye = helm if helm is not None else np.array([0.0, deck + 1.0 * u, middle + 0.6 * u])
    front, back = float(eye[2]) - 0.30 * u, sheer.stern + 2.4 * u  # of the deckhouse, at the height of the eye
    half = 0.72 * float(sheer.half(0.5 * (front + back)))
    roof = deck + max(1.75 * u, float(eye[1]) - deck + 0.60 * u)
    walls = Block(
        outline([half, half, 0.62 * half], [back, front - 0.464 * u, front + 0.35 * u], deck),
        outline([0.90 * half, 0.90 * half, 0.55 * half], [back + 0.1 * u, front - 1.2 * u, front - 0.45 * u], roof),
    )
    over = outline([0.98 * half, 1.0 * half, 0.62 * half], [back - 1.1 * u, front - 1.0 * u, front - 0.15 * u], roof)
    bridge = Block(
        outline(
            [0.74 * half, 0.74 * half, 0.45 * half],
            [back + 0.5 * u, front - 1.503 * u, front - 1.1 * u],
            roof + 0.10 * u,
        ),
        outline(
            [0.76 * half, 0.76 * half, 0.40 * half], [back + 0.4 * u, front - 2.2 * u, front - 1.7 * u], roof + 0.62 * u
        ),
    )
    nose, end = sheer.bow - 2.6 * u, front + 0.30 * u
    coach = Block(
        outline([0.60 * half, 0.60 * half, 0.30 * half], [end, nose - 1.3 * u, nose], deck),
        outline([0.54 * half, 0.54 * half, 0.24 * half], [end, nose - 1.6 * u, nose - 0.5 * u], deck + 0.36 * u),
    )
    rear, masthead = back + 1.6 * u, roof + 3.6 * u
    parts = [
        hull.painted(OXIDE, WHITE, NAVY, TEAK),
        sheer.bulwark(NAVY, WHITE, WOOD, 0.07 * u),
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
        seams(coach.top, 0.16 * u, PITCH),
        hatch(0.0, deck + 0.36 * u, 0.5 * (end + nose), 0.36 * u),
        tube([0.0, deck, nose + 0.6 * u], [0.0, deck + 0.28 * u, nose + 0.6 * u], 0.13 * u, STEEL),  # windlass
        both(bitts(0.0, deck, nose - 0.4 * u, 0.26 * u, 0.55 * float(sheer.half(nose - 0.4 * u)))),
        tube([0.0, roof, rear], [0.0, masthead, rear - 0.12 * u], (0.085 * u, 0.045 * u), WHITE),
        tube(
            [-0.55 * u, masthead - 0.8 * u, rear - 0.1 * u],
            [0.55 * u, masthead - 0.8 * u, rear - 0.1 * u],
            0.028 * u,
            WHITE,
        ),
        tube([0.0, roof + 1.0 * u, rear], [0.0, roof + 1.75 * u, sheer.stern + 0.9 * u], (0.05 * u, 0.035 * u), WOOD),
        tube(
            [0.0, masthead - 0.1 * u, rear - 0.1 * u],
            [0.0, roof + 1.75 * u, sheer.stern + 0.9 * u],
            0.010 * u,
            STEEL,
            5,
        ),
        tube([0.0, masthead - 0.15 * u, rear - 0.1 * u], [0.0, roof + 0.1 * u, front - 0.6 * u], 0.010 * u, STEEL, 5),
        radar(masthead - 1.35 * u, rear + 0.22 * u, u),
        *ensign(float(sheer.top(np.array([sheer.stern]))[0, 1]), sheer.stern, u),
        box(
            (-0.5 * half, deck, sheer.stern + 0.25 * u),
            (0.5 * half, deck + 0.42 * u, sheer.stern + 0.75 * u),
            WHITE,
            TEAK,
        ),
        rubbing(sheer, 0.045 * u, WOOD),
        portholes(hull, deck - 0.85 * u, np.linspace(front - 3.6 * u, front + 3.6 * u, 6), 0.17 * u),
    ]
    return Model(merged(parts), eye, hull.length)


def tug(hull: Hull, helm: np.ndarray | None) -> Model:
    """A harbour tug: fenders all round, deckhouse, wheelhouse all of glass, funnels, towing bitt and winch aft."""
    sheer = Sheer(hull, (0.036 * hull.length, 0.072 * hull.length), 0.018 * hull.length)
    u, middle = hull.length / 22.0, 0.5 * (sheer.stern + sheer.bow)
    deck = float(sheer.deck(middle))
    eye = helm if helm is not None else np.array([0.0, deck + 3.5 * u, middle + 2.0 * u])
    half = 0.62 * float(sheer.half(middle))
    floor = max(deck + 2.0 * u, float(eye[1]) - 1.5 * u)  # of the wheelhouse
    front = float(eye[2]) - 0.25 * u
    roof, back = float(eye[1]) + 0.75 * u, front - 3.4 * u
    house = Block(
        outline([half, half, 0.7 * half], [back - 3.3 * u, front - 0.2 * u, front + 1.5 * u], deck),
        outline([half, half, 0.7 * half], [back - 3.3 * u, front - 0.3 * u, front + 1.3 * u], floor),
    )
    wide = 0.80 * half
    wheelhouse = Block(
        outline(
            [0.8 * wide, wide, wide, 0.62 * wide], [back, back + 0.6 * u, front - 1.1 * u, front - 0.25 * u], floor
        ),
        outline([0.8 * wide, wide, wide, 0.68 * wide], [back, back + 0.6 * u, front - 0.716 * u, front], roof),
    )
    lid = outline(
        [0.9 * wide, 1.12 * wide, 1.12 * wide, 0.8 * wide],
        [back - 0.2 * u, back + 0.4 * u, front - 0.8 * u, front + 0.25 * u],
        roof,
    )
    fender_z = np.unique(np.concatenate([np.linspace(sheer.stern, sheer.bow, 33), sheer.z]))
    fender = sheer.top(fender_z, 0.0, -0.45 * sheer.rise(fender_z)) + [0.15 * u, 0.0, 0.0]
    fender[-1] = fender[-1] * [0.0, 1.0, 1.0] + [0.0, 0.0, 0.14 * u]
    across = fender[[0]] * np.array([[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]])
    posts = np.linspace(sheer.stern + 1.0 * u, sheer.bow - 6.0 * u, 6)
    top = sheer.top(posts)
    tow, winch, mast = back - 5.2 * u, back - 4.0 * u, roof + 4.2 * u
    funnel = Block(
        outline([0.42 * u, 0.42 * u], [-0.62 * u, 0.62 * u], floor) + [0.62 * half, 0.0, back - 1.5 * u],
        outline([0.34 * u, 0.34 * u], [-0.50 * u, 0.50 * u], floor + 2.5 * u) + [0.62 * half, 0.0, back - 1.8 * u],
    )
    crown = Block(funnel.top, funnel.top + [0.0, 0.45 * u, -0.05 * u])
    parts = [
        hull.painted(OXIDE, WHITE, GREEN, OXIDE),
        sheer.bulwark(GREEN, CREAM, BLACK, 0.12 * u),
        both(path(fender, 0.20 * u, RUBBER, 8)),
        path(across, 0.20 * u, RUBBER, 8),
        both(merged(tyre(point + [0.14 * u, -0.75 * u, 0.0], 0.46 * u, 0.17 * u) for point in top)),
        house.mesh(CREAM, OXIDE),
        *(house.panes(k, 6, 0.48, 0.74, GLASS, 0.55) for k in (0, 4)),
        house.panes(2, 2, 0.45, 0.75, GLASS, 0.5),
        wheelhouse.mesh(WHITE),
        *(
            wheelhouse.panes(k, n, 0.46, 0.90, GLASS, 0.14)
            for k, n in ((0, 1), (1, 3), (2, 1), (3, 3), (4, 1), (5, 3), (6, 1))
        ),
        wheelhouse.panes(7, 2, 0.46, 0.90, GLASS, 0.14),
        Block(lid, lid + [0.0, 0.16 * u, 0.0]).mesh(ORANGE, WHITE),
        both(merged([funnel.mesh(ORANGE), crown.mesh(BLACK)])),
        tube([0.0, roof, back + 1.2 * u], [0.0, mast, back + 1.2 * u], (0.13 * u, 0.06 * u), WHITE),
        tube([-1.0 * u, mast - 1.2 * u, back + 1.2 * u], [1.0 * u, mast - 1.2 * u, back + 1.2 * u], 0.045 * u, WHITE),
        tube([0.0, roof, back - 0.1 * u], [0.0, mast - 1.2 * u, back + 1.2 * u], 0.04 * u, WHITE),
        radar(mast - 2.2 * u, back + 1.6 * u, 1.4 * u),
        both(
            tube(
                [0.55 * wide, roof + 0.15 * u, front - 0.6 * u],
                [0.55 * wide, roof + 0.5 * u, front - 0.5 * u],
                0.22 * u,
                STEEL,
            )
        ),
        bitts(0.55 * u, deck, tow, 1.5 * u),
        bitts(0.45 * u, deck, sheer.bow - 2.4 * u, 1.1 * u),
        tube([-0.9 * u, deck + 0.75 * u, winch], [0.9 * u, deck + 0.75 * u, winch], 0.55 * u, STEEL, 14),
        both(box((0.9 * u, deck, winch - 0.7 * u), (1.1 * u, deck + 1.35 * u, winch + 0.7 * u), GREY)),
        *house_rail(house.top, 0.75 * u, 0.026 * u),
        *ensign(floor, back - 3.2 * u, 1.4 * u),
    ]
    return Model(merged(parts), eye, hull.length)


def barge(hull: Hull, helm: np.ndarray | None) -> Model:
    """A cargo barge: coaming with a stack of containers, bollards, a low bulwark, a mast with a light."""
    sheer = Sheer(hull, (0.014 * hull.length, 0.022 * hull.length), 0.0)
    u, deck = hull.length / 20.0, float(sheer.deck(0.0))
    half = 0.72 * float(sheer.half(0.5 * (sheer.stern + sheer.bow)))
    start, end = sheer.stern + 0.14 * hull.length, sheer.bow - 0.20 * hull.length
    coaming = box((-half, deck, start), (half, deck + 0.55 * u, end), OXIDE, GREY)
    parts = [
        hull.painted(OXIDE, WHITE, BLACK, GREY),
        sheer.bulwark(BLACK, GREY, YELLOW, 0.10 * u),
        coaming,
        both(
            merged(
                box((half, deck, z), (half + 0.12 * u, deck + 0.5 * u, z + 0.1 * u), OXIDE)
                for z in np.linspace(start, end - 0.1 * u, 9)
            )
        ),
        *containers(half - 0.15 * u, deck + 0.57 * u, start + 0.2 * u, end - 0.2 * u, u),
    ]
    at = 0.5 * (half + float(sheer.half(0.0)))
    for z in (sheer.stern + 1.0 * u, sheer.bow - 1.1 * u, sheer.bow - 3.0 * u):
        parts.append(both(bitts(0.0, deck, z, 0.7 * u, at)))
    anchor = sheer.bow - 2.1 * u
    parts += [
        tube([-0.7 * u, deck + 0.4 * u, anchor], [0.7 * u, deck + 0.4 * u, anchor], 0.32 * u, STEEL, 12),
        both(box((0.7 * u, deck, anchor - 0.4 * u), (0.85 * u, deck + 0.8 * u, anchor + 0.4 * u), YELLOW)),
        tube([0.0, deck, sheer.bow - 0.8 * u], [0.0, deck + 3.0 * u, sheer.bow - 0.8 * u], (0.08 * u, 0.05 * u), WHITE),
        box(
            (-0.12 * u, deck + 3.0 * u, sheer.bow - 0.92 * u), (0.12 * u, deck + 3.3 * u, sheer.bow - 0.68 * u), YELLOW
        ),
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
    corners, normals = sides[:, :, :3], sides[:, :, 3:]
    height = hull.over_water(corners)
    thick, draught = 0.012 * hull.depth, max(hull.depth - hull.freeboard, 0.1 * hull.depth)
    marks = [-0.5 * draught, 0.5 * hull.freeboard]
    bands: list[tuple[float, Any]] = [
        (marks[0] - thick, GREY),
        (marks[0] + thick, WHITE),
        (-thick, GREY),
        (thick, WHITE),
    ]
    bands += [(marks[1] - thick, YELLOW), (marks[1] + thick, BLACK), (np.inf, YELLOW)]
    mesh = banded(corners, normals, height, bands)
    if level:
        mesh = merged(
            [mesh, banded(deck[:, :, :3], deck[:, :, 3:], hull.over_water(deck[:, :, :3]), [(np.inf, ORANGE)])]
        )
    eye = helm if helm is not None else np.array([0.0, hull.upper[1] + 0.15 * hull.depth, 0.1 * hull.length])
    return Model(mesh, eye, hull.length)


def rubbing(sheer: Sheer, radius: float, colour: Any) -> Mesh:
    """A strake along the edge of the deck."""
    foot = sheer.foot(np.linspace(sheer.stern, sheer.bow, 41))
    return merged(
        [
            both(path(foot, radius, colour, 8)),
            path(foot[[0]] * np.array([[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]]), radius, colour, 8),
        ]
    )


def portholes(hull: Hull, y: float, stations: np.ndarray, radius: float) -> Mesh:
    """Round windows with rims in the sides."""
    parts = []
    for z in stations:
        point, out = hull.side(y, float(z))
        parts.append(tube(point - 0.1 * radius * out, point + 0.12 * radius * out, 1.25 * radius, STEEL, 16))
        parts.append(tube(point - 0.1 * radius * out, point + 0.20 * radius * out, radius, GLASS, 16))
    return both(merged(parts))


def hatch(x: float, y: float, z: float, half: float) -> Mesh:
    """A square hatch with a dark pane."""
    frame = box((x - half, y, z - half), (x + half, y + 0.25 * half, z + half), STEEL)
    pane = box(
        (x - 0.8 * half, y + 0.25 * half, z - 0.8 * half), (x + 0.8 * half, y + 0.31 * half, z + 0.8 * half), GLASS
    )
    return merged([frame, pane])


def bitts(apart: float, y: float, z: float, height: float, x: float = 0.0) -> Mesh:
    """Two posts with a bar across, or with `apart` 0 along, to which lines are made fast."""
    side = np.array([apart, 0.0, 0.0]) if apart else np.array([0.0, 0.0, 0.35 * height])
    foot, r = np.array([x, y, z]), 0.16 * height
    parts = [tube(foot + s * side, foot + s * side + [0.0, height, 0.0], r, GREY, 10) for s in (-1.0, 1.0)]
    bar = foot + [0.0, 0.65 * height, 0.0]
    return merged([*parts, tube(bar - 1.5 * side, bar + 1.5 * side, 0.7 * r, GREY, 8)])


def radar(y: float, z: float, u: float) -> Mesh:
    """A scanner on a bracket."""
    bar = box((-0.55 * u, y + 0.12 * u, z - 0.06 * u), (0.55 * u, y + 0.24 * u, z + 0.06 * u), WHITE)
    return merged(
        [
            bar,
            tube([0.0, y - 0.08 * u, z], [0.0, y + 0.12 * u, z], 0.10 * u, GREY),
            box((-0.05 * u, y - 0.14 * u, z - 0.4 * u), (0.05 * u, y - 0.06 * u, z + 0.1 * u), WHITE),
        ]
    )


def ensign(y: float, z: float, u: float) -> list[Mesh]:
    """A staff with a flag at the stern."""
    head = np.array([0.0, y + 1.5 * u, z - 0.35 * u])
    cloth = box((-0.008 * u, y + 0.95 * u, z - 1.10 * u), (0.008 * u, y + 1.42 * u, z - 0.34 * u), RED)
    return [tube([0.0, y, z], head, 0.022 * u, WOOD), cloth]


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


def tyre(middle: np.ndarray, radius: float, thick: float) -> Mesh:
    """An old tyre that hangs at the side."""
    angle = np.linspace(0.0, 2.0 * np.pi, 13)
    ring = np.stack([np.zeros(13), np.cos(angle), np.sin(angle)], axis=1)
    return path(middle + (radius - thick) * ring, thick, RUBBER, 6)


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
