"""Figure 3-3: the springs of the cloth, stretch, shear and bend, as the program has them: CSV and PNG.

python figures/fig3_3.py [--fast] [--out DIR]
"""

from pathlib import Path

import numpy as np
from _options import options
from _paper import BLUE, GREEN, INK, RED, paper, save_figure, save_table

from ocean_sim.surface.cloth import BEND_STEPS, SHEAR_STEPS, STRETCH_STEPS

NX, NZ = 5, 4
KINDS = {"stretch": STRETCH_STEPS, "shear": SHEAR_STEPS, "bend": BEND_STEPS}
COLOURS = {"stretch": BLUE, "shear": RED, "bend": GREEN}


def springs(nx: int, nz: int) -> dict[str, np.ndarray]:
    """End nodes (m, 2) of all springs of a sheet of nx by nz nodes, by kind; node (i, k) has the number i nz + k.

    There are nx (nz - 1) + nz (nx - 1) stretch, 2 (nx - 1)(nz - 1) shear and nx (nz - 2) + nz (nx - 2) bend springs.
    """
    number = np.arange(nx * nz).reshape(nx, nz)
    found = {}
    for kind, steps in KINDS.items():
        ends = []
        for i, k in steps:
            here = number[: max(nx - i, 0), max(-k, 0) : nz - max(k, 0) if nz > k else 0]
            there = number[i:, max(k, 0) : nz + min(k, 0)]
            ends.append(np.stack([here.ravel(), there.ravel()], axis=1))
        found[kind] = np.concatenate(ends)
    return found


def draw_figure(found: dict[str, np.ndarray], path: Path) -> None:
    """Draw a panel for each kind of spring; bend springs are curved, as they lie on stretch springs."""
    figure = paper(10.0, 3.2)
    for axes, (kind, ends) in zip(figure.subplots(1, 3), found.items(), strict=True):
        for pair in ends:
            (x0, z0), (x1, z1) = (divmod(int(node), NZ) for node in pair)
            bow = 0.12 if kind == "bend" else 0.0
            s = np.linspace(0.0, 1.0, 21)
            lift = bow * np.sin(np.pi * s)
            axes.plot(x0 + (x1 - x0) * s + lift * (z1 > z0), z0 + (z1 - z0) * s + lift * (x1 > x0), color=COLOURS[kind])
        x, z = np.divmod(np.arange(NX * NZ), NZ)
        axes.plot(x, z, "o", color=INK, ms=5)
        axes.set(title=f"{kind}: {len(ends)} springs", aspect="equal", xlim=(-0.2, NX - 0.8), ylim=(-0.2, NZ - 0.7))
        axes.axis("off")
    save_figure(figure, path)


def main() -> None:
    out = options(__doc__).out
    found = springs(NX, NZ)
    rows = [(kind, *map(int, pair)) for kind, ends in found.items() for pair in ends]
    head = [f"springs of a sheet of {NX} x {NZ} nodes; node (i, k) has the number i {NZ} + k"]
    save_table(out / "fig3_3.csv", head, ["kind", "from", "to"], rows)
    draw_figure(found, out / "fig3_3.png")


if __name__ == "__main__":
    main()
