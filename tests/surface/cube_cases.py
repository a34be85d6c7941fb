"""The rules by which cube_cases.csv was computed: lines on faces, loops around the cube, shortest diagonals."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from ocean_sim.surface.shared.isosurface import EDGE_MIDDLES, EDGES, MAX_TRIANGLES

EDGE_NUMBERS = {frozenset(edge): e for e, edge in enumerate(EDGES)}
Loop = list[int]  # edges that are cut, in order
Cut = tuple[tuple[int, int, int], ...]  # triangles by indices in a loop


def face_corners(axis: int, side: int) -> list[int]:
    """Corners of the lower (side 0) or upper face of a cube across an axis, counter-clockwise from outside."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    corners = [side << axis | a << u | b << v for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
    return corners if side else corners[::-1]


FACES = tuple(face_corners(axis, side) for axis in range(3) for side in (0, 1))


def edge_between(p: int, q: int) -> int:
    """Number of the cube's edge between corners p and q."""
    return EDGE_NUMBERS[frozenset((p, q))]


def face_lines(case: int, corners: list[int]) -> list[tuple[int, int]]:
    """Lines (from edge, to edge) that cut off each run of wet `corners` of a face, water always on the same side."""
    wet = [bool(case >> c & 1) for c in corners]
    found = []
    for k in range(4):
        if not wet[k] and wet[(k + 1) % 4]:
            last = k + 1
            while wet[(last + 1) % 4]:
                last += 1
            enters = edge_between(corners[k], corners[(k + 1) % 4])
            leaves = edge_between(corners[last % 4], corners[(last + 1) % 4])
            found.append((enters, leaves))
    return found


def is_ambiguous(case: int) -> bool:
    """True if some face of a case has two wet corners across a diagonal and two dry ones."""
    return any(len(face_lines(case, corners)) == 2 for corners in FACES)


def case_loops(case: int) -> list[Loop]:
    """Closed loops of cut edges, along which the surface of a case crosses the faces of the cube."""
    after = {enters: leaves for corners in FACES for enters, leaves in face_lines(case, corners)}
    found = []
    while after:
        first = min(after)
        loop, edge = [first], after.pop(first)
        while edge != first:
            loop.append(edge)
            edge = after.pop(edge)
        found.append(loop)
    return found


def polygon_cuts(first: int, last: int) -> Iterator[Cut]:
    """Yield each way to cut the polygon of corners first, first + 1, ..., last into triangles."""
    if last - first < 2:
        yield ()
    for k in range(first + 1, last):
        for left in polygon_cuts(first, k):
            for right in polygon_cuts(k, last):
                yield (*left, *right, (first, k, last))


def diagonal_lengths() -> np.ndarray:
    """(12, 12) squared lengths between the middles of a cube's edges; infinite for two edges of the same face."""
    squared = ((EDGE_MIDDLES[:, None] - EDGE_MIDDLES[None]) ** 2).sum(axis=-1)
    for corners in FACES:
        on_it = [e for e, edge in enumerate(EDGES) if set(edge) <= set(corners)]
        squared[np.ix_(on_it, on_it)] = np.inf
    return squared


def triangles(loop: Loop, lengths: np.ndarray) -> list[tuple[int, int, int]]:
    """Triangles of a loop of edges, by the shortest diagonals (squared `lengths`) of which none lies on a face."""
    n = len(loop)

    def length(cut: Cut) -> float:
        """Sum of squared lengths of the diagonals of a cut."""
        pairs = {pair for corners in cut for pair in combinations(corners, 2) if pair[1] - pair[0] not in (1, n - 1)}
        return sum(lengths[loop[a], loop[b]] for a, b in sorted(pairs))

    best = min(polygon_cuts(0, n - 1), key=length)
    return [(loop[a], loop[b], loop[c]) for a, b, c in best]


def computed_table() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(256,) number of triangles of each case, (256, 3 * MAX_TRIANGLES) their edges, (256,) 1 if it is ambiguous."""
    lengths = diagonal_lengths()
    counts, edges = np.zeros(256, dtype=np.int32), np.full((256, 3 * MAX_TRIANGLES), -1, dtype=np.int32)
    for case in range(256):
        found = [corner for loop in case_loops(case) for triangle in triangles(loop, lengths) for corner in triangle]
        counts[case] = len(found) // 3
        edges[case, : len(found)] = found
    return counts, edges, np.array([is_ambiguous(case) for case in range(256)], dtype=np.int32)
