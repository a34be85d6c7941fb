"""Figure 6-1: the particles of a sea, the cloth fitted to them, and how far it is from them: CSV and PNG.

python figures/fig6_1.py [--fast] [--out DIR]
"""

from pathlib import Path

import numpy as np
from _options import options
from _paper import INK, keep, paper, table

from ocean_sim.observers.shared.surface_fit import fit, highest
from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation

SCENE, MOMENT = "thesis/fig6_3c_wide", 6.0  # [s]


def drawn(position: np.ndarray, mesh, caption: str, path: Path) -> None:
    """Particles alone, and with the cloth over them."""
    figure = paper(13.0, 4.8)
    size = np.ptp(position, axis=0)
    for k, title in enumerate(("particles", f"and the cloth on them: {caption}")):
        axes = figure.add_subplot(1, 2, k + 1, projection="3d", computed_zorder=False)
        x, y, z = position.T
        axes.scatter(x, z, y, s=5.0, c=y, cmap="cividis", depthshade=False)
        if k:
            vx, vy, vz = mesh.vertices.T
            axes.plot_trisurf(vx, vz, vy, triangles=mesh.triangles, color="#7fb7d6", alpha=0.85, edgecolor=INK, lw=0.1)
        axes.set_box_aspect((size[0], size[2], 2.0 * size[1]), zoom=1.08)  # heights twice as large
        axes.set_title(title, y=0.97)
        axes.set(xlabel="x [m]", ylabel="z [m]", zlabel="y [m]", zticks=(-6, -3, 0, 3))
        axes.set(xticks=(-20, -10, 0, 10, 20), yticks=(-20, -10, 0, 10, 20))
        axes.view_init(elev=18.0, azim=-60.0)
    keep(figure, path)


def main() -> None:
    asked = options(__doc__, "coarse and short")
    coarse = {"resolution": 2.0} if asked.fast else {}
    with Simulation(load(SCENE, {"render": None, "frames": None, "accuracy": None, **coarse})) as simulation:
        simulation.run(until=0.2 if asked.fast else MOMENT)
        mesh, position = simulation.surface.mesh(), simulation.fluid.particles.position.to_numpy()
        spacing, moment = simulation.fluid.particles.spacing, simulation.time
        top = highest(position.astype(float), simulation.basin, spacing)
        cloth = simulation.surface.elevations(top[:, [0, 2]])
        mean, rms = fit(simulation.surface, top)
    head = [f"{SCENE} at {moment:.3f} s, {len(position)} particles {spacing:g} m apart"]
    head += ["particles: the highest in every column two spacings wide, half a spacing above its centre"]
    head += [f"cloth minus particles: mean {mean:.5f} m, root mean square {rms:.5f} m"]
    rows = np.column_stack([top[:, [0, 2]], cloth, top[:, 1]]).round(6)
    table(asked.out / "fig6_1.csv", head, ["x_m", "z_m", "cloth_m", "particles_m"], rows.tolist())
    drawn(position, mesh, f"{rms / spacing:.3f} spacings (RMS)", asked.out / "fig6_1.png")


if __name__ == "__main__":
    main()
