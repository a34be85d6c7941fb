"""The case table: every cube closes with its neighbours, whatever their corners are."""

from collections import Counter
from itertools import product

import numpy as np
import pytest

from ocean_sim.surface.shared.isosurface import CORNERS, EDGE_MIDDLES, EDGES, MAX_TRIANGLES, case_table
from tests.surface.cube_cases import FACES, computed_table

COUNTS, CUTS, AMBIGUOUS = case_table()


def triangles(case: int) -> list[tuple[int, int, int]]:
    return [tuple(CUTS[case, 3 * t : 3 * t + 3].tolist()) for t in range(COUNTS[case])]


def sides(case: int) -> Counter:
    """How often each directed side of a triangle occurs."""
    return Counter((t[k], t[(k + 1) % 3]) for t in triangles(case) for k in range(3))


def rim(case: int) -> set[tuple[int, int]]:
    """Directed sides without a partner in the same cube: where the surface leaves it."""
    found = sides(case)
    return {(a, b) for a, b in found if (b, a) not in found}


def on_face(e: int, corners: list[int]) -> bool:
    return set(EDGES[e]) <= set(corners)


def test_the_file_follows_the_rules_of_faces_loops_and_shortest_diagonals():
    for kept, computed in zip(case_table(), computed_table(), strict=True):
        np.testing.assert_array_equal(kept, computed)


def test_a_case_uses_exactly_the_edges_whose_ends_differ():
    for case in range(256):
        cut = {e for e, (p, q) in enumerate(EDGES) if case >> p & 1 != case >> q & 1}
        assert {e for t in triangles(case) for e in t} == cut, case
        assert COUNTS[case] <= MAX_TRIANGLES and all(len(set(t)) == 3 for t in triangles(case)), case


def test_within_a_cube_every_side_is_met_once_and_leaves_the_cube_on_a_face():
    for case in range(256):
        assert all(n == 1 for n in sides(case).values()), case
        leaving = rim(case)
        assert all(any(on_face(a, f) and on_face(b, f) for f in FACES) for a, b in leaving), case
        # a side between two triangles of one cube never lies on a face, where the neighbour might have it too
        inside = set(sides(case)) - leaving
        assert not [(a, b) for a, b in inside if any(on_face(a, f) and on_face(b, f) for f in FACES)], case


def test_all_cases_agree_with_all_neighbours_on_all_six_faces():
    """The rim on a face is that of any neighbour with the same corners there, the other way round."""
    pairings = 0
    for axis in range(3):
        here = [c for c in range(8) if c >> axis & 1]
        for case in range(256):
            neighbours = [n for n in range(256) if all(case >> c & 1 == n >> (c ^ 1 << axis) & 1 for c in here)]
            assert len(neighbours) == 16
            own = {pair for pair in rim(case) if all(on_face(e, here) for e in pair)}
            for other in neighbours:
                there = [c ^ 1 << axis for c in here]
                across = {pair for pair in rim(other) if all(on_face(e, there) for e in pair)}
                moved = {(shifted(b, axis), shifted(a, axis)) for a, b in across}
                assert own == moved, (axis, case, other)
                pairings += 2  # as the upper face of one and the lower face of the other
    assert pairings == 256 * 6 * 16


def shifted(e: int, axis: int) -> int:
    """The edge at the upper side of a cube that is edge e at the lower side of its neighbour."""
    return EDGES.index(tuple(c | 1 << axis for c in EDGES[e]))


@pytest.mark.parametrize("corner", range(8))
def test_triangles_face_away_from_the_water(corner):
    (a, b, c) = (EDGE_MIDDLES[e] for e in triangles(1 << corner)[0])
    assert np.cross(b - a, c - a) @ (a - CORNERS[corner]) > 0.0


def test_the_cases_are_the_fifteen_of_the_thesis_under_turns_and_complements():
    """Figure 3-2: the empty one and 14 more."""
    patterns = {min(turned(c, turn) for turn in TURNS for c in (case, 255 - case)) for case in range(256)}
    assert len(patterns) == 15
    assert AMBIGUOUS.sum() == 120


def test_a_turned_cube_has_turned_lines_on_its_faces():
    for turn, case in product(TURNS, range(0, 256, 5)):
        moved = {tuple(EDGES.index(tuple(sorted(turn[c] for c in EDGES[e]))) for e in pair) for pair in rim(case)}
        assert moved == rim(turned(case, turn))


def turned(case: int, turn: list[int]) -> int:
    return sum((case >> c & 1) << turn[c] for c in range(8))


def turns() -> list[list[int]]:
    """Where each corner goes under the 24 rotations of the cube."""
    found = []
    for axes in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)):
        for flips in product((0, 1), repeat=3):
            matrix = np.zeros((3, 3), dtype=int)
            for k in range(3):
                matrix[k, axes[k]] = -1 if flips[k] else 1
            if round(np.linalg.det(matrix)) == 1:
                at = (matrix @ (2 * CORNERS.T - 1) + 1) // 2
                found.append((at[0] + 2 * at[1] + 4 * at[2]).tolist())
    return found


TURNS = turns()
