"""Figure 3-3: the springs of the cloth, stretch, shear and bend, as the program has them: CSV and PNG.

python figures/fig3_3.py [--fast] [--out DIR]
"""

import csv
from pathlib import Path

import numpy as np
from _options import options
from _paper import keep, paper

from ocean_sim.surface.shared.springs import springs

NX, NZ = 5, 4
COLOURS = {"stretch": "#0b4f6c", "shear": "#c8553d", "bend": "#588157"}


def drawn(found: dict[str, np.ndarray], path: Path) -> None:
    """One panel a kind; bend springs are bowed, for they lie on stretch springs."""

    figure = paper(10.0, 3.2)
    for axes, (kind, ends) in zip(figure.subplots(1, 3), found.items(), strict=True):
        for pair in ends:
            (x0, z0), (x1, z1) = (divmod(int(node), NZ) for node in pair)
            bow = 0.12 if kind == "bend" else 0.0
            s = np.linspace(0.0, 1.0, 21)
            lift = bow * np.sin(np.pi * s)
            axes.plot(x0 + (x1 - x0) * s + lift * (z1 > z0), z0 + (z1 - z0) * s + lift * (x1 > x0), color=COLOURS[kind])
        x, z = np.divmod(np.arange(NX * NZ), NZ)
        axes.plot(x, z, "o", color="#222", ms=5)
        axes.set(title=f"{kind}: {len(ends)}", aspect="equal")
        axes.axis("off")
    keep(figure, path)


def main() -> None:
    out = options(__doc__, "nothing here takes long").out
    found = springs(NX, NZ)
    with (out / "fig3_3.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        file.write(f"# springs of a sheet of {NX} x {NZ} nodes; node (i, k) has the number i {NZ} + k\n")
        writer.writerow(["kind", "from", "to"])
        writer.writerows([kind, *map(int, pair)] for kind, ends in found.items() for pair in ends)
    drawn(found, out / "fig3_3.png")


if __name__ == "__main__":
    main()
