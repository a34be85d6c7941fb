"""The case table of marching cubes: which edges of a cube its surface cuts, and how the cuts make triangles.

A case has a bit for each corner, set where it is in the water; corner c lies at (c & 1, c >> 1 & 1, c >> 2 & 1), edge e
runs along axis e // 4. The table is made, not copied. On every face each run of wet corners is cut off by a line of its
own, so two wet corners across a diagonal stay apart (the ambiguous face): the line depends on the four corners of that
face alone, so both cubes that share it draw the same one. The lines of the six faces join to loops, seen from outside
the cube with the water on one side, and every loop is cut into triangles without a diagonal on a face, which the
neighbour might draw as well. So any field that is dry all round gives a closed surface, two triangles an edge.
"""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

CORNERS = np.array([(c & 1, c >> 1 & 1, c >> 2 & 1) for c in range(8)])
EDGES = tuple((c, c | 1 << axis) for axis in range(3) for c in range(8) if not c >> axis & 1)
NUMBER = {frozenset(edge): e for e, edge in enumerate(EDGES)}
MIDDLES = np.array([CORNERS[list(edge)].mean(axis=0) for edge in EDGES])
MOST = 5  # triangles of a case, at most

Loop = list[int]  # edges that are cut, in order
Cut = tuple[tuple[int, int, int], ...]  # triangles by indices in a loop


def ring(axis: int, side: int) -> list[int]:
    """The corners of a face, counter-clockwise seen from outside the cube."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    corners = [side << axis | a << u | b << v for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
    return corners if side else corners[::-1]


FACES = tuple(ring(axis, side) for axis in range(3) for side in (0, 1))


def edge_between(p: int, q: int) -> int:
    return NUMBER[frozenset((p, q))]


def lines(case: int, corners: list[int]) -> list[tuple[int, int]]:
    """(from edge, to edge) of each run of wet corners on a face, the way round that leaves the water inside."""
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
    """Whether some face has two wet corners across a diagonal and two dry ones."""
    return any(len(lines(case, corners)) == 2 for corners in FACES)


def loops(case: int) -> list[Loop]:
    """The closed lines in which the surface meets the faces of the cube."""
    after = {enters: leaves for corners in FACES for enters, leaves in lines(case, corners)}
    found = []
    while after:
        first = min(after)
        loop, edge = [first], after.pop(first)
        while edge != first:
            loop.append(edge)
            edge = after.pop(edge)
        found.append(loop)
    return found


def cuts(first: int, last: int) -> Iterator[Cut]:
    """Every way to cut the polygon first, first + 1, ... last into triangles."""
    if last - first < 2:
        yield ()
    for k in range(first + 1, last):
        for left in cuts(first, k):
            for right in cuts(k, last):
                yield (*left, *right, (first, k, last))


def diagonal_lengths() -> np.ndarray:
    """(12, 12) squared lengths between the middles of edges; infinite where both lie on one face of the cube."""
    squared = ((MIDDLES[:, None] - MIDDLES[None]) ** 2).sum(axis=-1)
    for corners in FACES:
        on_it = [e for e, edge in enumerate(EDGES) if set(edge) <= set(corners)]
        squared[np.ix_(on_it, on_it)] = np.inf
    return squared


def triangles(loop: Loop, lengths: np.ndarray) -> list[tuple[int, int, int]]:
    """A loop cut into triangles: no diagonal on a face of the cube, and the diagonals as short as can be."""
    n = len(loop)

    def length(cut: Cut) -> float:
        pairs = {pair for corners in cut for pair in combinations(corners, 2) if pair[1] - pair[0] not in (1, n - 1)}
        return sum(lengths[loop[a], loop[b]] for a, b in sorted(pairs))

    best = min(cuts(0, n - 1), key=length)
    return [(loop[a], loop[b], loop[c]) for a, b, c in best]


def table() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(256,) triangles of each case, (256, 3 * MOST) their edges, and (256,) whether the case is ambiguous."""
    lengths = diagonal_lengths()
    counts, edges = np.zeros(256, dtype=np.int32), np.zeros((256, 3 * MOST), dtype=np.int32)
    for case in range(256):
        found = [corner for loop in loops(case) for triangle in triangles(loop, lengths) for corner in triangle]
        counts[case] = len(found) // 3
        edges[case, : len(found)] = found
    return counts, edges, np.array([is_ambiguous(case) for case in range(256)], dtype=np.int32)
