"""Figure 6-1: the particles of a sea, the cloth fitted to them, and how far it is from them: CSV and PNG.

python figures/fig6_1.py [--fast] [--out DIR]
"""

from pathlib import Path

import numpy as np
from _options import options
from _paper import INK, light_colours, paper, save_figure, save_table, set_plan

from ocean_sim.fluid import with_particles
from ocean_sim.observers.accuracy import highest_particles, surface_fit
from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation
from ocean_sim.surface import Mesh

SCENE, MOMENT = "thesis/fig6_3c_wide", 6.0  # [s]
SOON = 3.0  # [s] in haste: the gust has come in
CLOTH = 0.66, 0.83, 0.91  # colour


def draw(position: np.ndarray, mesh: Mesh, rows: np.ndarray, spacing: float, rms: str, found: str, path: Path) -> None:
    """Draw the particles, the cloth over them, and a map of their difference; `rows`: x, z and both heights [m]."""
    figure, solid = paper(16.0, 5.2), []
    size = np.ptp(position, axis=0)
    for k, title in enumerate(("particles", f"and the cloth on them: {rms}")):
        axes = figure.add_subplot(1, 3, k + 1, projection="3d", computed_zorder=False)
        solid.append(axes)
        x, y, z = position.T
        dots = axes.scatter(x, z, y, s=5.0, c=y, cmap="cividis", depthshade=False)
        if k:
            vx, vy, vz = mesh.vertices.T
            skin = axes.plot_trisurf(vx, vz, vy, triangles=mesh.triangles, shade=False, edgecolor=INK, lw=0.1)
            high = mesh.vertices * [1.0, 2.0, 1.0]  # as it is drawn
            skin.set_facecolor(np.insert(light_colours(high, mesh.triangles, np.array(CLOTH)), 3, 0.85, axis=1))
        axes.set_box_aspect((size[0], size[2], 2.0 * size[1]), zoom=1.1)  # heights twice as large
        axes.set_title(title, y=0.97)
        set_plan(axes, zlabel="y [m]", zticks=(-6, -3, 0, 3))
        axes.set(xticks=(-20, -10, 0, 10, 20), yticks=(-20, -10, 0, 10, 20))
        axes.view_init(elev=18.0, azim=-60.0)
    figure.colorbar(dots, ax=solid, label="y [m]", shrink=0.4, aspect=30.0, pad=0.06, orientation="horizontal")
    chart = figure.add_subplot(1, 3, 3)
    off = (rows[:, 2] - rows[:, 3]) / spacing
    most = float(np.percentile(np.abs(off), 98))
    shown = chart.scatter(rows[:, 0], rows[:, 1], c=off, s=22.0, marker="s", cmap="PuOr", vmin=-most, vmax=most)
    set_plan(chart, aspect="equal", title="cloth minus particles")
    figure.colorbar(shown, ax=chart, label="[spacings]", shrink=0.7, extend="both")
    save_figure(figure, path, found)


def main() -> None:
    asked = options(__doc__, "coarse and short")
    coarse = {"resolution": 2.0} if asked.fast else {}
    with Simulation(load(SCENE, {"render": None, "frames": None, "accuracy": None, **coarse})) as simulation:
        simulation.run(until=SOON if asked.fast else MOMENT)
        fluid, surface, moment = with_particles(simulation.fluid), simulation.surface, simulation.time
        assert surface is not None
        mesh, position, spacing = surface.mesh(), fluid.particles.position.to_numpy(), fluid.spacing
        top = highest_particles(simulation.basin, fluid)
        cloth = surface.elevations(top[:, [0, 2]])
        mean, rms = surface_fit(surface, top)
    head = [f"{SCENE} at {moment:.3f} s, {len(position)} particles {spacing:g} m apart"]
    head += ["particles: the highest in every column two spacings wide, half a spacing above its centre"]
    off = f"{rms / spacing:.3f} spacings (RMS)"
    found = f"Cloth minus particles: {mean / spacing:+.3f} spacings in the mean, {off}."
    head += [found]
    rows = np.column_stack([top[:, [0, 2]], cloth, top[:, 1]]).round(6)
    save_table(asked.out / "fig6_1.csv", head, ["x_m", "z_m", "cloth_m", "particles_m"], rows.tolist())
    draw(position, mesh, rows, spacing, off, found, asked.out / "fig6_1.png")


if __name__ == "__main__":
    main()
