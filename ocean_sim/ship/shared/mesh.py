"""Hulls from mesh files: read, judged, turned into the hull's axes, and filled by columns.

A point is inside where the skins of the mesh wind around it at least once: the signs of the faces that a ray from it
crosses add up to more than 0. So bodies that overlap count once. Every closed skin is taken to face outwards.
"""

import logging
import warnings
from dataclasses import dataclass
from functools import cached_property, lru_cache
from io import BytesIO
from typing import Any, NamedTuple

import numpy as np

from ocean_sim.files.input_file import Unreadable, content, shown

MILLIMETRES = 1.0e3  # units: a hull longer than a kilometre is taken to be drawn in millimetres
MAX_UNITS = 1.0e30  # of a coordinate, whose powers stay finite
ROUNDING = 1.0e-9  # of a mesh's size, volume or area
MAX_PAIRS = 1_000_000  # of a face and a line that are looked at together
PANELS, GAUSS_POINTS = 64, 2  # across and along a hull, where its volume is summed over columns
LEVELS = 32  # at which the room that is open at the top is looked for
OPEN_SHARE = 0.1  # of the volume: room that is open at the top, from which on it is told
SHIP_LENGTH_OVER_BREADTH, SHIP_BREADTH_OVER_DRAUGHT, SHIP_DRAUGHT_OVER_HEIGHT = (1.2, 30.0), (0.7, 30.0), (0.04, 0.96)
UPRIGHT_BUOYANCY = (
    0.49  # of the draught, at least: height of the centre of buoyancy where sections do not narrow upwards
)
MAX_PROBES = 64  # corners of a skin of which is asked whether others enclose them


class BadMesh(ValueError):
    """A mesh that is no hull; `problems` are sentences: what is wrong and where."""

    def __init__(self, problems: list[str]) -> None:
        self.problems = problems
        super().__init__("; ".join(problems))


class Axis(NamedTuple):
    """A signed axis of a file."""

    number: int
    sense: float

    @classmethod
    def named(cls, name: str) -> "Axis":
        return cls("xyz".index(name[-1]), -1.0 if name[0] == "-" else 1.0)

    @property
    def vector(self) -> np.ndarray:
        """(3,) along it."""
        return self.sense * np.eye(3)[self.number]

    def __str__(self) -> str:
        return f"{'-' if self.sense < 0.0 else ''}{'xyz'[self.number]}"


class Guess(NamedTuple):
    """Reading of a mesh: metres per unit, and the file's axes that point up and to the bow."""

    scale: float
    up: Axis
    bow: Axis


class Columns(NamedTuple):
    """Stretches of vertical lines inside a mesh, with the part of the plan that each line stands for."""

    low: np.ndarray  # (n,) [m]
    high: np.ndarray  # (n,) [m]
    area: np.ndarray  # (n,) [m2]


@dataclass(frozen=True, eq=False)
class ClosedMesh:
    """A mesh in the hull's axes, keel at y = 0, amidships at x = z = 0."""

    vertices: np.ndarray  # (n, 3) [m]
    faces: np.ndarray  # (m, 3) corners, anticlockwise seen from outside
    guess: Guess
    skins: list[str]  # sentences about its closed skins

    @cached_property
    def triangles(self) -> np.ndarray:
        """(m, 3, 3) [m]."""
        return np.asarray(self.vertices[self.faces])

    @cached_property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Corners of the box around it [m]."""
        return self.vertices.min(axis=0), self.vertices.max(axis=0)

    @property
    def size(self) -> np.ndarray:
        """(3,) breadth, height and length [m]."""
        return self.bounds[1] - self.bounds[0]

    @cached_property
    def _plan(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Positions of columns along x and z [m], and (len(x), len(z)) the area of each [m2]."""
        (x, across), (z, along) = (gauss_points(self.vertices[:, axis]) for axis in (0, 2))
        return x, z, across[:, None] * along

    @cached_property
    def overlaps(self) -> bool:
        """True where faces pass through each other, so that skins wind around a point more than once or less than
        never."""
        x, z, _ = self._plan
        line, height, winding = crossings(self.triangles, x, z)
        thick = (np.diff(height) > ROUNDING * self.size[1]) & (np.diff(line) == 0)
        return bool((thick & ((winding[:-1] > 1) | (winding[:-1] < 0))).any())

    @cached_property
    def columns(self) -> Columns:
        """The inside, by columns."""
        x, z, area = self._plan
        line, low, high = stretches(self.triangles, x, z)
        return Columns(low, high, area.ravel()[line])

    @cached_property
    def volume(self) -> float:
        """Volume of the inside [m3]: by its faces, by columns where they pass through each other."""
        if not self.overlaps:
            return float(signed_volumes(self.triangles).sum())
        return float(self.columns.area @ (self.columns.high - self.columns.low))

    @cached_property
    def thickness(self) -> float:
        """Mean thickness of a shell of this volume and of these faces [m]."""
        a, b, c = np.moveaxis(self.triangles, 1, 0)
        return 4.0 * self.volume / float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())

    def sentence(self) -> str:
        """Size and axes."""
        broad, tall, long = self.size
        size = f"{long:.4g} m long, {broad:.4g} m broad and {tall:.4g} m high"
        axes = f"{self.guess.scale:g} m per unit, {self.guess.up} up and the bow along {self.guess.bow}"
        return f"{size}, read with {axes}; watertight, {len(self.faces)} faces"

    def unlike_a_ship(self, draught: float, kb: float) -> list[str]:
        """Sentences on proportions of a hull afloat that ships do not have: `draught`, and height of the centre of
        buoyancy over the keel [m]."""
        broad, tall, long = self.size.tolist()
        odd = [
            f"{what} is {ratio:.2g} ({low:g} to {high:g} for ships)"
            for what, ratio, (low, high) in (
                ("length over breadth", long / broad, SHIP_LENGTH_OVER_BREADTH),
                ("breadth over draught", broad / draught, SHIP_BREADTH_OVER_DRAUGHT),
                ("draught over height", draught / tall, SHIP_DRAUGHT_OVER_HEIGHT),
            )
            if not low <= ratio <= high
        ]
        if kb < UPRIGHT_BUOYANCY * draught and len(self.remarks) == len(self.skins):  # and no open shell
            odd.append(
                f"she becomes narrower from the keel to the waterline (KB is {kb / draught:.3f} of the draught): is "
                f"she upside down? --up {Axis(self.guess.up.number, -self.guess.up.sense)} turns her over"
            )
        return [f"unlike a ship: {'; '.join(odd)}; --up, --bow and --scale say how the file is meant"] if odd else []

    @cached_property
    def remarks(self) -> list[str]:
        """Sentences about what a hull may not be meant to be."""
        return [*self.skins, *self._open_at_the_top()]

    def _open_at_the_top(self) -> list[str]:
        """A sentence where rain would fill as much room as counts beside the volume of the hull."""
        from scipy.ndimage import label

        x, z, area = self._plan
        line, _, high = stretches(self.triangles, x, z)
        top = np.full(area.size, -np.inf)
        np.maximum.at(top, line, high)
        top = np.pad(top.reshape(area.shape), 1, constant_values=-np.inf)
        room, tall = np.zeros(LEVELS), self.size[1] / LEVELS
        for k in range(LEVELS):
            open_above, _ = label(top < (k + 0.5) * tall)
            held = (open_above > 0) & ~np.isin(open_above, open_above[np.isinf(top)])
            room[k] = tall * area[held[1:-1, 1:-1]].sum()
        if room.sum() <= OPEN_SHARE * self.volume:
            return []
        share = self.volume / float(np.prod(self.size))
        return [
            f"an open shell: {self.volume:.3g} m3 fill {share:.0%} of their box, and {room.sum():.3g} m3 inside are "
            "open at the top: nobody can know whether they stay dry; water counts there as high as outside; close the "
            "hull by a deck if they do"
        ]


@lru_cache(maxsize=4)
def closed_mesh(file: str, data: bytes, scale: float | None, up: str | None, bow: str | None) -> ClosedMesh:
    """The hull in the content of a mesh file, with metres per unit and the file's axes up and to the bow, guessed where
    they are None; raises BadMesh."""
    vertices, faces = read(file, data)
    problems = flaws(vertices, faces)
    if problems:
        raise BadMesh([f"{shown(file)}: {problem}" for problem in problems])
    faces, skins = turned_outwards(vertices, faces)
    guess = guessed(vertices, faces, scale, up, bow)
    if guess.up.number == guess.bow.number:
        raise BadMesh([f"{shown(file)}: up and bow are the same axis, {'xyz'[guess.up.number]}"])
    upwards, ahead = guess.up.vector, guess.bow.vector
    turn = np.stack([np.cross(upwards, ahead), upwards, ahead])  # rows: port, up, bow in the file's axes
    vertices = guess.scale * vertices @ turn.T
    lower, upper = vertices.min(axis=0), vertices.max(axis=0)
    vertices = vertices - [(lower[0] + upper[0]) / 2, lower[1], (lower[2] + upper[2]) / 2]
    return ClosedMesh(vertices, faces, guess, skins)


def from_file(file: str, scale: float | None, up: str | None, bow: str | None) -> ClosedMesh:
    """The hull in a mesh file; raises BadMesh."""
    try:
        return closed_mesh(file, content(file), scale, up, bow)
    except Unreadable as error:
        raise BadMesh([str(error)]) from None


def read(file: str, data: bytes) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) corners [units of the file] and (m, 3) faces that have three of them; raises BadMesh."""
    import trimesh

    kind = file.lower().rpartition(".")[2]
    if kind not in ("stl", "obj", "ply"):
        raise BadMesh([f"{shown(file)}: a hull is an STL, OBJ or PLY file"])
    logging.getLogger("trimesh").addHandler(logging.NullHandler())  # what is wrong is told here
    try:  # from its bytes: materials that an OBJ names are not looked for
        with warnings.catch_warnings(action="ignore"), np.errstate(all="ignore"):
            mesh: Any = trimesh.load(BytesIO(data), file_type=kind, force="mesh")
            if len(getattr(mesh, "faces", ())) and np.shape(mesh.vertices)[1:] == (3,):
                mesh.merge_vertices(merge_tex=True, merge_norm=True)
    except Exception as error:
        raise BadMesh([f"{shown(file)}: cannot be read as a mesh ({first_line(error)})"]) from None
    if len(getattr(mesh, "faces", ())) == 0:
        raise BadMesh([f"{shown(file)}: holds no triangles"])
    if np.shape(mesh.vertices)[1:] != (3,):
        raise BadMesh([f"{shown(file)}: cannot be read as a mesh (its vertices do not have three coordinates)"])
    faces = np.array(mesh.faces)
    return np.array(mesh.vertices, dtype=float), faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]


def first_line(error: Exception) -> str:
    """The first line of an error's message, cut short."""
    line = next(iter(str(error).strip().splitlines()), "") or type(error).__name__
    return line if len(line) <= 100 else f"{line[:97]}..."


def flaws(vertices: np.ndarray, faces: np.ndarray) -> list[str]:
    """Sentences on why a mesh bounds no volume, with positions in the file's own units."""
    used = vertices[np.unique(faces)]
    if not np.isfinite(used).all():
        return ["some vertices are not numbers"]
    if np.abs(used).max(initial=0.0) > MAX_UNITS:
        return [f"some vertices lie {np.abs(used).max():.2g} units away; at most {MAX_UNITS:g} are read"]
    found = []
    edges, count, balance = edge_uses(faces)
    wrong = balance != 0  # an edge that faces use as often one way as the other bounds nothing
    for which, what in ((count == 1, "a hole"), (count > 2, "a seam of more than two faces")):
        if (wrong & which).any():
            position = vertices[edges[wrong & which]].reshape(-1, 3).mean(axis=0)
            found.append(
                f"not watertight: {np.count_nonzero(wrong & which)} edges bound {what}, around {spot(position)}"
            )
    if not found and wrong.any():
        found.append("its faces do not all turn the same way, so inside and outside cannot be distinguished")
    holds = np.abs(np.bincount(closed_skins(faces), signed_volumes(vertices[faces]))).max() if not found else 0.0
    if not found and holds <= ROUNDING * float(np.prod(np.ptp(used, axis=0))):
        found.append("it holds no volume")
    return found


def edge_uses(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(e, 2) edges by their corners, in order, how many faces use each, and how many more do so one way than the other
    way."""
    directed = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    edges, which, count = np.unique(np.sort(directed, axis=1), axis=0, return_inverse=True, return_counts=True)
    way = np.where(directed[:, 0] < directed[:, 1], 1, -1)
    return edges, count, np.bincount(which.ravel(), way, len(edges)).astype(int)


def closed_skins(faces: np.ndarray) -> np.ndarray:
    """(m,) number of the closed skin that each face belongs to: faces that share an edge with no other; all one where
    such skins are not closed by themselves."""
    from trimesh.graph import connected_component_labels, face_adjacency

    labels = np.asarray(connected_component_labels(face_adjacency(faces), node_count=len(faces)))
    closed = all((edge_uses(faces[labels == k])[2] == 0).all() for k in range(labels.max() + 1))
    return labels if closed else np.zeros(len(faces), dtype=int)


def signed_volumes(triangles: np.ndarray) -> np.ndarray:
    """(m,) volume between each face and the middle of the mesh, in the cube of its unit."""
    a, b, c = np.moveaxis(triangles - 0.5 * (triangles.min(axis=(0, 1)) + triangles.max(axis=(0, 1))), 1, 0)
    return np.asarray((a * np.cross(b, c)).sum(axis=1) / 6.0)


def turned_outwards(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Faces of which each closed skin looks outwards, and sentences on several skins and on those that did not look the
    way of the largest."""
    labels = closed_skins(faces)
    volumes = np.bincount(labels, signed_volumes(vertices[faces]))
    inverted = volumes < 0.0
    turned = np.where(inverted[labels][:, None], faces[:, ::-1], faces)
    if len(volumes) == 1:
        return turned, []
    found = [f"{len(volumes)} closed skins, counted once where they overlap"]
    for k in np.flatnonzero(inverted != inverted[np.argmax(np.abs(volumes))]):
        own = vertices[np.unique(faces[labels == k])]
        others = vertices[turned[labels != k]]
        middle = spot(0.5 * (own.min(axis=0) + own.max(axis=0)))
        if all(is_inside(others, point) for point in own[:: -(-len(own) // MAX_PROBES)]):
            share = abs(volumes[k]) / np.abs(volumes).max()
            found.append(
                f"a closed skin around {middle} inside the hull faces inwards: a void, {share:.2g} of the hull, that "
                "stays dry and displaces water as the hull does"
            )
        else:
            found.append(f"a closed skin around {middle} faces inwards beside others; it is turned and counts as hull")
    return turned, found


def is_inside(triangles: np.ndarray, point: np.ndarray) -> bool:
    """True where faces (m, 3, 3) wind around a point (3,)."""
    _, height, winding = crossings(triangles, point[:1], point[2:])
    below = np.count_nonzero(height < point[1])
    return bool(below and winding[below - 1] > 0)


def spot(position: np.ndarray) -> str:
    """A position as a message shows it."""
    return "(" + ", ".join(f"{x:.4g}" for x in position) + ")"


def guessed(vertices: np.ndarray, faces: np.ndarray, scale: float | None, up: str | None, bow: str | None) -> Guess:
    """Unit, up and bow where they are not given: the longest axis is the ship's, and of the other two the one that the
    mesh mirrors itself in is athwart."""
    triangles = vertices[faces]
    lower, upper = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    extents = upper - lower
    scale = scale or (1.0 / MILLIMETRES if extents.max() > MILLIMETRES else 1.0)
    if bow:
        ahead = Axis.named(bow)
    else:
        ahead = Axis(int(next(a for a in np.argsort(-extents) if not up or a != Axis.named(up).number)), 1.0)
    if up:
        return Guess(scale, Axis.named(up), ahead)
    others = [axis for axis in range(3) if axis != ahead.number]
    volumes, middle = signed_volumes(triangles), 0.5 * (lower + upper)
    centre = volumes @ (triangles.sum(axis=1) + middle) / (4.0 * volumes.sum())
    lopsided = [abs(centre[a] - middle[a]) / extents[a] for a in others]
    if abs(lopsided[0] - lopsided[1]) > 1e-3:
        return Guess(scale, Axis(others[int(np.argmax(lopsided))], 1.0), ahead)
    return Guess(scale, Axis(2 if ahead.number != 2 else 1, 1.0), ahead)  # as most files have it


def gauss_points(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions and weights that sum over an axis, between the corners of a mesh (at most PANELS of them) [m]."""
    breaks = np.unique(corners)
    even = np.searchsorted(breaks, np.linspace(breaks[0], breaks[-1], PANELS + 1))
    breaks = breaks if len(breaks) <= PANELS else breaks[np.unique(even)]
    parts = -(-PANELS // (len(breaks) - 1))
    breaks = np.interp(np.arange(parts * (len(breaks) - 1) + 1) / parts, np.arange(len(breaks)), breaks)
    points, weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    half = 0.5 * np.diff(breaks)[:, None]
    return (breaks[:-1, None] + half * (1.0 + points)).ravel(), (half * weights).ravel()


def crossings(triangles: np.ndarray, x: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Faces (m, 3, 3) that lines along y at ascending x and z cross, line by line and upwards: number of the line (that
    of its x times len(z), plus that of its z), height, and winding number above.

    A line crosses a face where the face's edges wind around it, which each edge answers for both its faces by the same
    numbers: what goes into closed skins comes out, rounding or not.
    """
    cx, cz = triangles[..., 0], triangles[..., 2]
    i0, i1 = np.searchsorted(x, cx.min(axis=1)), np.searchsorted(x, cx.max(axis=1))
    k0, k1 = np.searchsorted(z, cz.min(axis=1)), np.searchsorted(z, cz.max(axis=1))
    pairs = (i1 - i0) * (k1 - k0)
    near = np.flatnonzero(pairs)
    lines, heights, signs = [np.zeros(0, dtype=int)], [np.zeros(0)], [np.zeros(0, dtype=int)]
    chunks = np.cumsum(pairs[near]) // MAX_PAIRS
    for faces in np.split(near, np.flatnonzero(np.diff(chunks)) + 1):
        n = pairs[faces]
        number = np.repeat(np.arange(len(faces)), n)
        local = np.arange(n.sum()) - np.repeat(np.cumsum(n) - n, n)
        deep = (k1 - k0)[faces][number]
        i, k = i0[faces][number] + local // deep, k0[faces][number] + local % deep
        at_x, at_z = x[i], z[k]
        turns = np.zeros(len(number), dtype=int)
        for a, b in ((0, 1), (1, 2), (2, 0)):
            rises = cz[faces, a] < cz[faces, b]
            first, last = np.where(rises, a, b), np.where(rises, b, a)
            x0, z0, x1, z1 = cx[faces, first], cz[faces, first], cx[faces, last], cz[faces, last]
            slope = (x1 - x0) / np.where(z1 > z0, z1 - z0, 1.0)
            on_edge = np.clip(x0[number] + (at_z - z0[number]) * slope[number], *np.sort([x0, x1], axis=0)[:, number])
            left = at_x < on_edge
            turns += np.where((z0[number] <= at_z) & (at_z < z1[number]) & left, np.where(rises, 1, -1)[number], 0)
        hit = np.flatnonzero(turns)
        p, q, r = np.moveaxis(triangles[faces][number[hit]], 1, 0)
        u, v = q - p, r - p
        area = u[:, 0] * v[:, 2] - u[:, 2] * v[:, 0]
        area[area == 0.0] = np.inf
        dx, dz = at_x[hit] - p[:, 0], at_z[hit] - p[:, 2]
        s, t = (dx * v[:, 2] - dz * v[:, 0]) / area, (u[:, 0] * dz - u[:, 2] * dx) / area
        between = np.minimum(np.minimum(p, q), r)[:, 1], np.maximum(np.maximum(p, q), r)[:, 1]
        lines.append(i[hit] * len(z) + k[hit])
        heights.append(np.clip(p[:, 1] + s * u[:, 1] + t * v[:, 1], *between))
        signs.append(turns[hit])
    line, height, sign = np.concatenate(lines), np.concatenate(heights), np.concatenate(signs)
    order = np.lexsort((height, line))
    return line[order], height[order], np.cumsum(sign[order])


def stretches(triangles: np.ndarray, x: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Parts inside of lines along y at x and z: number of the line, lower and upper end."""
    line, height, winding = crossings(triangles, x, z)
    inside = winding > 0
    before = np.r_[False, inside[:-1]]
    begins = inside & ~before
    return line[begins], height[begins], height[before & ~inside]


def column_shares(triangles: np.ndarray, x: np.ndarray, z: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """(len(x), len(edges) - 1, len(z)): the share of each interval between `edges` along y that lies inside, on
    columns at x and z [m]."""
    line, low, high = stretches(triangles, x, z)
    parts = np.diff(np.clip(edges, low[:, None], high[:, None])) / np.diff(edges)
    shares = np.zeros((len(x) * len(z), len(edges) - 1))
    _, first, which = np.unique(line, return_index=True, return_inverse=True)
    turn = np.arange(len(line)) - first[which]
    for k in range(turn.max(initial=-1) + 1):
        shares[line[turn == k]] += parts[turn == k]
    return shares.reshape(len(x), len(z), -1).transpose(0, 2, 1)
