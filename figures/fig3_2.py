"""Figure 3-2: the cases of marching cubes that remain when cubes may be turned and water exchanged for air: CSV and
PNG.

python figures/fig3_2.py [--fast] [--out DIR]
"""

import csv
from itertools import permutations, product
from pathlib import Path

import numpy as np
from _options import options
from _paper import paper, save_figure

from ocean_sim.surface.shared.isosurface import CORNERS, EDGE_MIDDLES, EDGES, case_table

WATER, SKIN = "#0b4f6c", "#7fb7d6"


def turns() -> list[np.ndarray]:
    """Numbers of a cube's corners after each of its 24 rotations."""
    found = []
    for axes, signs in product(permutations(range(3)), product((1, -1), repeat=3)):
        turn = np.diag(signs)[:, axes]
        if np.linalg.det(turn) > 0.0:
            found.append(((2 * CORNERS - 1) @ turn.T + 1) // 2 @ [1, 2, 4])
    return found


def patterns() -> dict[int, int]:
    """Number of cases of each pattern, by its lowest case of 256; rotated and inverted cases are the same pattern."""
    ways = turns()
    counts: dict[int, int] = {}
    for case in range(256):
        alike = (sum((other >> c & 1) << int(way[c]) for c in range(8)) for other in (case, 255 - case) for way in ways)
        least = min(alike)
        counts[least] = counts.get(least, 0) + 1
    return dict(sorted(counts.items(), key=lambda found: (found[0].bit_count(), found[0])))


def draw_figure(found: dict[int, int], counts: np.ndarray, cuts: np.ndarray, path: Path) -> None:
    """Draw one cube for each pattern; balls are corners in the water."""
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    figure = paper(12.5, 8.0)
    for k, (case, alike) in enumerate(found.items()):
        axes = figure.add_subplot(3, 5, k + 1, projection="3d")
        for edge in EDGES:
            axes.plot(*CORNERS[list(edge)].T[[0, 2, 1]], color="#999", lw=0.8)
        wet = CORNERS[[c for c in range(8) if case >> c & 1]]
        axes.scatter(*wet.T[[0, 2, 1]], color=WATER, s=40.0, depthshade=False)
        corners = EDGE_MIDDLES[cuts[case, : 3 * counts[case]]].reshape(-1, 3, 3)[..., [0, 2, 1]]
        axes.add_collection3d(Poly3DCollection(corners, facecolor=SKIN, edgecolor=WATER, alpha=0.8))
        axes.set_title(f"case {case}, {alike} alike", fontsize=9, loc="center")
        axes.set(xlim=(0, 1), ylim=(0, 1), zlim=(0, 1))
        axes.set_box_aspect((1, 1, 1))
        axes.view_init(elev=26.0, azim=-52.0)
        axes.set_axis_off()
    save_figure(figure, path)


def main() -> None:
    out = options(__doc__).out
    found, (counts, cuts, ambiguous) = patterns(), case_table()
    with (out / "fig3_2.csv").open("w", newline="", encoding="utf-8") as file:
        file.write("# corner c lies at (c & 1, c >> 1 & 1, c >> 2 & 1); edges by their corners\n")
        writer = csv.writer(file)
        writer.writerow(["case", "wet_corners", "alike", "ambiguous", "triangles", "edges"])
        for case, alike in found.items():
            edges = ["{}-{}".format(*EDGES[e]) for e in cuts[case, : 3 * counts[case]]]
            row = case, case.bit_count(), alike, bool(ambiguous[case]), int(counts[case]), " ".join(edges)
            writer.writerow(row)
    draw_figure(found, counts, cuts, out / "fig3_2.png")


if __name__ == "__main__":
    main()
