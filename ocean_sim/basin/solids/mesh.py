"""Solid bodies from mesh files: read, checked, turned into the axes of a hull, and filled by columns.

A point is inside if the skins of the mesh wind around it at least once: the signs of the faces that a ray from it
crosses add up to more than 0. So bodies that overlap count once. Every closed skin is taken to face outwards.
"""

import logging
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from io import BytesIO
from typing import Any

import numpy as np

from ocean_sim.files.input_file import BYTE_ORDER_MARK, Checked, Rule, Unreadable, marked_codec

MAX_METRES = 1.0e3  # units: a hull longer than a kilometre is taken to be drawn in millimetres
MAX_UNITS = 1.0e30  # of a coordinate, whose powers stay finite
ROUNDING_SHARE = 1.0e-9  # of a mesh's size, volume or area
MIN_PANELS, GAUSS_POINTS = 64, 2  # across and along a hull, where its volume is summed over columns
ROOM_LEVELS = 32  # at which the room that is open at the top is looked for
OPEN_SHARE = 0.1  # of the volume: room that is open at the top, from which on it is told
SHIP_LENGTH = 0.2, 460.0  # [m] of models and ships
SHIP_LENGTH_OVER_BREADTH, SHIP_BREADTH_OVER_DRAUGHT, SHIP_DRAUGHT_OVER_HEIGHT = (1.2, 30.0), (0.7, 30.0), (0.04, 0.96)
UPRIGHT_BUOYANCY = 0.49  # of the draught: least height of the centre of buoyancy of sections that do not narrow upwards
MAX_PROBES = 64  # corners of a skin of which is asked whether others enclose them

TRIANGLE_RULE = Rule(f"a mesh is an STL, OBJ or PLY file of triangles, with finite corners within {MAX_UNITS:g} units")
CLOSED_RULE = Rule("faces close around a volume: at every edge as many turn one way as the other way")
AXES_RULE = Rule("`up` and `bow` are two axes of the file")
CHECKS = (
    Checked("A hull's mesh, `hull.shape.file` and `ocean-sim hull FILE`", (TRIANGLE_RULE, CLOSED_RULE, AXES_RULE)),
    Checked("An obstacle's mesh, `basin.obstacles[].mesh`", (TRIANGLE_RULE, CLOSED_RULE)),
)


class BadMesh(ValueError):
    """Error of a mesh that is no closed body; `problems`: sentences on each fault and its position."""

    def __init__(self, *problems: Unreadable) -> None:
        self.problems = [str(problem) for problem in problems]
        super().__init__("; ".join(self.problems))


@dataclass(frozen=True, eq=False)
class ClosedMesh:
    """Closed triangle mesh of a hull in the hull's axes, keel at y = 0, amidships at x = z = 0."""

    vertices: np.ndarray  # (n, 3) [m]
    faces: np.ndarray  # (m, 3) corners, anticlockwise seen from outside
    scale: float  # metres per unit of the file
    up: str  # the file's axes
    bow: str
    skins: list[str]  # sentences about its closed skins
    file_origin: np.ndarray  # (3,) where the file's origin lies [m]

    @cached_property
    def triangles(self) -> np.ndarray:
        """(m, 3, 3) corners of the faces [m]."""
        return np.asarray(self.vertices[self.faces])

    @cached_property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner (3,) of the box around the mesh [m]."""
        return self.vertices.min(axis=0), self.vertices.max(axis=0)

    @property
    def size(self) -> np.ndarray:
        """(3,) breadth, height and length [m]."""
        return self.bounds[1] - self.bounds[0]

    @cached_property
    def _column_plan(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Positions along x and z [m] of upright columns for integrals, and (len(x), len(z)) cross-sections [m2]."""
        (x, across), (z, along) = (gauss_points(self.vertices[:, axis]) for axis in (0, 2))
        return x, z, across[:, None] * along

    @cached_property
    def has_overlaps(self) -> bool:
        """True if faces pass through each other: some point has a winding number other than 0 and 1."""
        line, height, winding = line_crossings(self.triangles, *self._column_plan[:2])
        thick = (np.diff(height) > ROUNDING_SHARE * self.size[1]) & (np.diff(line) == 0)
        return bool((thick & ((winding[:-1] > 1) | (winding[:-1] < 0))).any())

    @cached_property
    def inside_columns(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Segments inside the mesh, (k,) each, of upright columns at the quadrature points x, z of `column_integral`:
        index of the column (that of x times the number of z, plus that of z), lower and upper end [m]."""
        return inside_stretches(self.triangles, *self._column_plan[:2])

    def column_integral(self, of_heights: Callable[[np.ndarray], np.ndarray]) -> float:
        """Integral of f(y) over the inside of the mesh, by columns; `of_heights`: antiderivative of f."""
        line, low, high = self.inside_columns
        return float(self._column_plan[2].ravel()[line] @ (of_heights(high) - of_heights(low)))

    @cached_property
    def volume(self) -> float:
        """Volume inside the mesh [m3]: from its faces, or from columns if faces pass through each other."""
        if self.has_overlaps:
            return self.column_integral(np.positive)
        return float(signed_volumes(self.triangles).sum())

    @cached_property
    def mean_thickness(self) -> float:
        """Thickness [m] of a plate with the mesh's volume and, over both of its sides together, the mesh's area."""
        a, b, c = np.moveaxis(self.triangles, 1, 0)
        return 4.0 * self.volume / float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())

    def size_sentence(self) -> str:
        """Sentence on size and axes of the mesh."""
        broad, tall, long = self.size
        size = f"{long:.4g} m long, {broad:.4g} m broad and {tall:.4g} m high"
        axes = f"{self.scale:g} m per unit, {self.up} up and the bow along {self.bow}"
        return f"{size}, read with {axes}; watertight, {len(self.faces)} faces"

    def unlike_a_ship(self, draught: float, kb: float) -> list[str]:
        """Warnings of proportions that no ship has, at a `draught` [m]; `kb`: centre of buoyancy above the keel [m]."""
        broad, tall, long = self.size.tolist()
        odd = [
            f"{what} is {ratio:.3g} ({low:g} to {high:g} for ships)"
            for what, ratio, (low, high) in (
                ("length [m]", long, SHIP_LENGTH),
                ("length over breadth", long / broad, SHIP_LENGTH_OVER_BREADTH),
                ("breadth over draught", broad / draught, SHIP_BREADTH_OVER_DRAUGHT),
                ("draught over height", draught / tall, SHIP_DRAUGHT_OVER_HEIGHT),
            )
            if not low <= ratio <= high
        ]
        if kb < UPRIGHT_BUOYANCY * draught and len(self.remarks) == len(self.skins):  # and no open shell
            begin = f"she becomes narrower from the keel to the waterline (KB is {kb / draught:.3f} of the draught):"
            odd.append(f"{begin} is she upside down? --up {self.up[1:] or f'-{self.up}'} turns her over")
        return [f"unlike a ship: {'; '.join(odd)}; --up, --bow and --scale say how the file is meant"] if odd else []

    @cached_property
    def remarks(self) -> list[str]:
        """Warnings of possible mistakes: several closed skins, or a shell open at the top that would hold water."""
        from scipy.ndimage import binary_propagation

        area, room = self._column_plan[2], 0.0
        line, _, high = self.inside_columns
        top = np.full(area.shape, -np.inf)
        top.ravel()[line] = high  # of the last stretch of each line
        for level in self.size[1] * (np.arange(ROOM_LEVELS) + 0.5) / ROOM_LEVELS:
            drained = binary_propagation(np.isinf(top), mask=top < level, border_value=1)
            room += self.size[1] / ROOM_LEVELS * area[(top < level) & ~drained].sum()
        if room <= OPEN_SHARE * self.volume:
            return self.skins
        share = self.volume / float(np.prod(self.size))
        return [
            *self.skins,
            f"an open shell: {self.volume:.3g} m3 fill {share:.0%} of their box, and {room:.3g} m3 inside are "
            "open at the top: nobody can know whether they stay dry; water counts there as high as outside; close the "
            "hull by a deck if they do",
        ]


def axis_vector(name: str) -> np.ndarray:
    """(3,) unit vector along the axis `name`: `x`, `y` or `z`, or one with a minus sign, as `-z`."""
    return (-1.0 if name[0] == "-" else 1.0) * np.eye(3)["xyz".index(name[-1])]


@lru_cache(maxsize=4)
def closed_mesh(file: str, data: bytes, scale: float | None, up: str | None, bow: str | None) -> ClosedMesh:
    """Closed mesh of a hull from the `data` of a mesh file; raises BadMesh. `scale` [m per unit of the file] and
    axes `up`, `bow` in the file (as `-z`) are guessed where None."""
    vertices, faces = read_mesh(file, data)
    problems = mesh_flaws(vertices, faces)
    if problems:
        raise BadMesh(*(CLOSED_RULE.broken(file, problem) for problem in problems))
    faces, skins = faces_outwards(vertices, faces)
    scale, up, bow = guess_axes(vertices[faces], scale, up, bow)
    if up[-1] == bow[-1]:
        raise BadMesh(AXES_RULE.broken(file, f"up and bow are the same axis, {up[-1]}"))
    upwards, ahead = axis_vector(up), axis_vector(bow)
    turn = np.stack([np.cross(upwards, ahead), upwards, ahead])  # rows: port, up, bow in the file's axes
    vertices = scale * vertices @ turn.T
    lower, upper = vertices.min(axis=0), vertices.max(axis=0)
    keel = np.array([(lower[0] + upper[0]) / 2, lower[1], (lower[2] + upper[2]) / 2])
    return ClosedMesh(vertices - keel, faces, scale, up, bow, skins, -keel)


def section_prism(mesh: ClosedMesh) -> ClosedMesh | None:
    """Closed prism along z whose base is the section of a mesh at z = 0, as thick as that is broad or high; None
    without a section. Its ends are fans of triangles around one point; their parts outside the section cancel out."""
    low, high = mesh.triangles[..., 2].min(axis=1), mesh.triangles[..., 2].max(axis=1)
    cut = mesh.triangles[(low <= 0.0) & (high > 0.0)]
    if len(cut) == 0:
        return None
    a, b, c, ahead = lone_corner_first(cut, cut[..., 2] > 0.0)
    ends = np.stack([on_edge(a, end, np.zeros(len(cut))) for end in (b, c)])
    p, q = np.where(ahead[:, None], ends, ends[::-1])  # anticlockwise around the section
    half = 0.5 * np.array([0.0, 0.0, np.ptp(ends[..., :2], axis=(0, 1)).min()])
    i, (near, far) = np.arange(len(cut)), 4 * len(cut) + np.arange(2)[:, None].repeat(len(cut), axis=1)
    p_near, q_near, p_far, q_far = (i + k * len(cut) for k in range(4))
    corners = (p_near, q_near, q_far), (p_near, q_far, p_far), (far, p_far, q_far), (near, q_near, p_near)
    faces = np.concatenate([np.stack(three, axis=1) for three in corners])
    vertices = np.concatenate([p - half, q - half, p + half, q + half, p[:1] - half, p[:1] + half])
    return replace(mesh, vertices=vertices, faces=faces)


def read_mesh(file: str, data: bytes) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) corners [units of the file] and (m, 3) faces in a mesh file's `data`, none degenerate; raises BadMesh."""
    import trimesh

    kind = file.lower().rpartition(".")[2]
    if kind not in ("stl", "obj", "ply"):
        raise BadMesh(TRIANGLE_RULE.broken(file, "its name has another ending"))
    logging.getLogger("trimesh").addHandler(logging.NullHandler())  # what is wrong is told here
    try:  # from its bytes: materials that an OBJ names are not looked for
        if kind != "stl" and (codec := marked_codec(data)):  # an STL may be binary under any first bytes
            data = data.decode(codec).removeprefix(BYTE_ORDER_MARK).encode()
        with warnings.catch_warnings(action="ignore"), np.errstate(all="ignore"):
            mesh: Any = trimesh.load(BytesIO(data), file_type=kind, force="mesh")
            if len(getattr(mesh, "faces", ())):
                if np.shape(mesh.vertices)[1:] != (3,):
                    raise ValueError("its vertices do not have three coordinates")
                mesh.merge_vertices(merge_tex=True, merge_norm=True)
    except Exception as error:
        missing = "a face names a corner that is not there" if isinstance(error, IndexError) else ""
        line = missing or next(iter(str(error).strip().splitlines()), "") or type(error).__name__
        raise BadMesh(TRIANGLE_RULE.broken(file, f"cannot be read as a mesh ({line:.100})")) from None
    faces = np.array(getattr(mesh, "faces", ()), dtype=int).reshape(-1, 3)
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    if len(faces) == 0:
        whole = 84 + 50 * int.from_bytes(data[80:84], "little")  # bytes of a binary STL, by its head
        short = f"ends after {len(data)} bytes, where a binary STL of its size has {whole}"
        is_cut = kind == "stl" and len(data) < whole and not data.startswith(b"solid")
        raise BadMesh(TRIANGLE_RULE.broken(file, short if is_cut else "holds no triangles"))
    vertices = np.array(mesh.vertices, dtype=float)
    farthest = np.abs(vertices[np.unique(faces)]).max()
    if not farthest <= MAX_UNITS:
        raise BadMesh(TRIANGLE_RULE.broken(file, f"some vertices lie {farthest:.2g} units away"))
    return vertices, faces


def mesh_flaws(vertices: np.ndarray, faces: np.ndarray) -> list[str]:
    """Sentences on why a mesh of `vertices` (n, 3) [units of the file] and `faces` (m, 3) bounds no volume."""
    used, found = vertices[np.unique(faces)], []
    edges, count, balance = edge_uses(faces)
    wrong = balance != 0  # an edge that faces use as often one way as the other bounds nothing
    for which, what in ((count == 1, "a hole"), (count > 2, "a seam of more than two faces")):
        torn = vertices[edges[wrong & which]]
        if len(torn):
            found.append(f"not watertight: {len(torn)} edges bound {what}, around {point_text(torn.mean(axis=(0, 1)))}")
    if wrong.any():
        return found or ["its faces do not all turn the same way, so inside and outside cannot be distinguished"]
    volumes = np.bincount(closed_skins(faces), signed_volumes(vertices[faces]))
    return ["it holds no volume"] if np.abs(volumes).max() <= ROUNDING_SHARE * np.prod(np.ptp(used, axis=0)) else []


def edge_uses(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(e, 2) corner indices of each edge, the lower first; (e,) number of faces at it; (e,) faces that pass it from the
    lower to the higher corner, less those that pass it the other way (0 in a closed mesh)."""
    directed = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    edges, which, count = np.unique(np.sort(directed, axis=1), axis=0, return_inverse=True, return_counts=True)
    way = np.where(directed[:, 0] < directed[:, 1], 1, -1)
    return edges, count, np.bincount(which.ravel(), way, len(edges)).astype(int)


def closed_skins(faces: np.ndarray) -> np.ndarray:
    """(m,) number of each face's skin (faces joined by edges), or all 0 if some skin is not closed by itself."""
    from trimesh.graph import connected_component_labels, face_adjacency

    labels = np.asarray(connected_component_labels(face_adjacency(faces), node_count=len(faces)))
    apart = faces + labels[:, None] * (faces.max() + 1)  # skins that share no corners
    return np.zeros_like(labels) if edge_uses(apart)[2].any() else labels


def signed_volumes(triangles: np.ndarray) -> np.ndarray:
    """(m,) volumes [units3] of tetrahedra from the mesh's middle to `triangles` (m, 3, 3); positive: face outwards."""
    a, b, c = np.moveaxis(triangles - 0.5 * (triangles.min(axis=(0, 1)) + triangles.max(axis=(0, 1))), 1, 0)
    return np.asarray((a * np.cross(b, c)).sum(axis=1) / 6.0)


def faces_outwards(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """`faces` (m, 3) of `vertices`, with skins that face inwards reversed; sentences on multiple or inverted skins."""
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
        skin = f"a closed skin around {point_text(0.5 * (own.min(axis=0) + own.max(axis=0)))}"
        if all(is_inside(others, point) for point in own[:: -(-len(own) // MAX_PROBES)]):
            share = abs(volumes[k]) / np.abs(volumes).max()
            void = f"{skin} inside another faces inwards: a void, {share:.2g} of the body"
            found.append(f"{void}, that stays dry and displaces water as the body does")
        else:
            found.append(f"{skin} faces inwards beside others; it is turned and counts as body")
    return turned, found


def is_inside(triangles: np.ndarray, point: np.ndarray) -> bool:
    """True if closed `triangles` (m, 3, 3) enclose a point (3,), by winding number."""
    _, height, winding = line_crossings(triangles, point[:1], point[2:])
    below = np.count_nonzero(height < point[1])
    return bool(below and winding[below - 1] > 0)


def point_text(position: np.ndarray) -> str:
    """Position (3,) as text for messages, such as (1, 0.25, -3)."""
    return "(" + ", ".join(f"{x:.4g}" for x in position) + ")"


def guess_axes(triangles: np.ndarray, scale: float | None, up: str | None, bow: str | None) -> tuple[float, str, str]:
    """`scale` [m per unit], `up`, `bow` of `triangles` (m, 3, 3), guessed if None: bow lengthwise, up by symmetry."""
    lower, upper = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    extents, middle = upper - lower, 0.5 * (lower + upper)
    scale = scale or (1.0 / MAX_METRES if extents.max() > MAX_METRES else 1.0)
    bow = bow or next("xyz"[a] for a in np.argsort(-extents) if not up or "xyz"[a] != up[-1])
    if up:
        return scale, up, bow
    volumes = signed_volumes(triangles)
    centre = volumes @ (triangles.sum(axis=1) + middle) / (4.0 * volumes.sum())
    lopsided = {axis: off for axis, off in zip("xyz", np.abs(centre - middle) / extents) if axis != bow[-1]}
    most = max(lopsided, key=lambda axis: lopsided[axis])
    usual = "z" if "z" in lopsided else "y"  # as most files have it
    return scale, most if np.ptp(list(lopsided.values())) > 1e-3 else usual, bow


def gauss_points(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Gauss quadrature points and weights [m] on an axis, in MIN_PANELS panels or more between `corners` (n,)."""
    breaks = np.unique(corners)
    even = np.searchsorted(breaks, np.linspace(breaks[0], breaks[-1], MIN_PANELS + 1))
    breaks = breaks if len(breaks) <= MIN_PANELS else breaks[np.unique(even)]
    parts = -(-MIN_PANELS // (len(breaks) - 1))
    breaks = np.interp(np.arange(parts * (len(breaks) - 1) + 1) / parts, np.arange(len(breaks)), breaks)
    points, weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    half = 0.5 * np.diff(breaks)[:, None]
    return (breaks[:-1, None] + half * (1.0 + points)).ravel(), (half * weights).ravel()


def line_crossings(triangles: np.ndarray, x: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Crossings of `triangles` (m, 3, 3) with lines along y at ascending x and z, line by line and upwards: line
    (index of x times len(z), plus that of z), height, and winding number above. Faces with a common edge are cut at the
    same point of it, so a line leaves a closed skin as often as it enters it, despite rounding."""
    face, k = pairs_within(triangles[..., 2].min(axis=1), triangles[..., 2].max(axis=1), z)
    a, b, c, ahead = lone_corner_first(triangles[face], triangles[face, :, 2] > z[k, None])
    p, q = (on_edge(a, end, z[k]) for end in (b, c))
    segment, i = pairs_within(np.minimum(p, q)[:, 0], np.maximum(p, q)[:, 0], x)
    p, q, k, ahead = p[segment], q[segment], k[segment], ahead[segment]
    height = p[:, 1] + (x[i] - p[:, 0]) / (q[:, 0] - p[:, 0]) * (q[:, 1] - p[:, 1])
    line, sign = i * len(z) + k, np.where((p[:, 0] < q[:, 0]) == ahead, 1, -1)
    order = np.lexsort((height, line))
    return line[order], height[order], np.cumsum(sign[order])


def pairs_within(low: np.ndarray, high: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All (i, j) with low[i] <= values[j] < high[i], as two index arrays; `values` ascend."""
    first, last = np.searchsorted(values, low), np.searchsorted(values, high)
    count = last - first
    interval = np.repeat(np.arange(len(count)), count)
    return interval, np.arange(len(interval)) - (np.cumsum(count) - count - first)[interval]


def lone_corner_first(faces: np.ndarray, beyond: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Corners a, b, c (n, 3) of triangles `faces` (n, 3, 3) that a plane cuts, a being alone on its side of it; and
    (n,) True if a lies beyond the plane. `beyond` (n, 3): True for corners beyond it."""
    alone = np.count_nonzero(beyond, axis=1) == 1
    first = np.argmax(beyond == alone[:, None], axis=1)[:, None]
    a, b, c = np.moveaxis(np.take_along_axis(faces, ((first + range(3)) % 3)[..., None], axis=1), 1, 0)
    return a, b, c, alone


def on_edge(a: np.ndarray, b: np.ndarray, z: np.ndarray) -> np.ndarray:
    """(n, 3) points with coordinate z (n,) on edges from a to b (n, 3); bitwise the same if a and b are exchanged."""
    low, high = np.where((a[:, 2] < b[:, 2])[:, None], [a, b], [b, a])
    return np.asarray(low + ((z - low[:, 2]) / (high[:, 2] - low[:, 2]))[:, None] * (high - low))


def inside_stretches(triangles: np.ndarray, x: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Segments inside `triangles` (m, 3, 3) of lines along y at x[i], z[k] [m]: line i len(z) + k, both ends [m]."""
    line, height, winding = line_crossings(triangles, x, z)
    inside = winding > 0
    before = np.r_[False, inside[:-1]]
    begins = inside & ~before
    return line[begins], height[begins], height[before & ~inside]


def column_shares(triangles: np.ndarray, x: np.ndarray, z: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """(len(x), len(edges) - 1, len(z)) share inside `triangles` (m, 3, 3) of intervals of y `edges` [m] at x, z."""
    line, low, high = inside_stretches(triangles, x, z)
    parts = np.diff(np.clip(edges, low[:, None], high[:, None])) / np.diff(edges)
    shares = np.zeros((len(x) * len(z), len(edges) - 1))
    lines, first = np.unique(line, return_index=True)
    shares[lines] = np.add.reduceat(parts, first)
    return shares.reshape(len(x), len(z), -1).transpose(0, 2, 1)
