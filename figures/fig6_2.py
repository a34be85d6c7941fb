"""Figure 6-2: the cloth next to marching cubes on the same water: milliseconds, triangles, and distance from each other
and from the particles: CSV and PNG.

python figures/fig6_2.py [--fast] [--out DIR]

The table counts open edges, too: boundaries and holes. `flying_edges` cuts the field of our marching cubes by VTK's
code; its time is that of the cut alone. Colours are shaded so little that they stay near those of the bar.
"""

from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from _options import options
from _paper import INK, light_colours, paper, save_figure, save_table, set_plan

from ocean_sim.fluid import with_particles
from ocean_sim.observers.accuracy import highest_particles, surface_fit
from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation
from ocean_sim.surface import Mesh, Surface
from ocean_sim.surface.cloth import Cloth
from ocean_sim.surface.marching_cubes import MarchingCubes

SCENE, MOMENT, ROUNDS = "thesis/fig6_3c_wide", 6.0, 9  # [s]; medians of so many
HIGH, TALLER = 2.0, 2.5  # [m] to which colours reach; how much larger heights are drawn
SOON = 3.0  # [s] in haste: the gust has come in


def median_time(make: Callable[[], object]) -> float:
    """Median time [ms] of calls of `make`, after one that compiles."""
    make()
    times = []
    for _ in range(ROUNDS):
        begin = perf_counter()
        make()
        times.append(perf_counter() - begin)
    return 1e3 * float(np.median(times))


def open_edges(triangles: np.ndarray) -> int:
    """Number of edges that belong to one triangle only: boundaries and holes."""
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    return int((np.unique(edges, axis=0, return_counts=True)[1] == 1).sum())


def flying_edges(cubes: MarchingCubes) -> Callable[[], Any]:
    """Function that cuts the field of `cubes` by VTK's flying edges."""
    import pyvista

    nodes = cubes.nodes
    origin = tuple(np.array(nodes.lower) - 0.5 * np.array(nodes.width))
    image = pyvista.ImageData(dimensions=nodes.shape, spacing=nodes.width, origin=origin)
    values = cubes.isosurface.rows.spread_values(cubes.isosurface.value.to_numpy()).ravel()
    return lambda: image.contour([0.0], values, method="flying_edges")


def draw_figure(meshes: dict[str, Mesh], captions: dict[str, str], off: np.ndarray, found: str, path: Path) -> None:
    """Draw both surfaces from the same viewpoint, and a map of their distance; `off`: x, z [m] and distance [spacings];
    `found`: end of the caption."""
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    figure, solid = paper(17.0, 5.2), []
    heights = ScalarMappable(Normalize(-HIGH, HIGH), colormaps["GnBu_r"])
    chart = figure.add_subplot(1, 3, 3)
    most = float(np.percentile(np.abs(off[:, 2]), 98))
    shown = chart.scatter(*off[:, :2].T, c=off[:, 2], s=22.0, marker="s", cmap="PuOr", vmin=-most, vmax=most)
    set_plan(chart, aspect="equal", title="cloth minus marching cubes")
    figure.colorbar(shown, ax=chart, label="[spacings]", shrink=0.7, extend="both")
    for k, (name, mesh) in enumerate(meshes.items()):
        axes = figure.add_subplot(1, 3, k + 1, projection="3d")
        x, y, z = mesh.vertices.T
        solid.append(axes)
        skin = axes.plot_trisurf(x, z, y, triangles=mesh.triangles, shade=False, linewidth=0.1, edgecolor=(INK, 0.25))
        colours = heights.to_rgba(y[mesh.triangles].mean(axis=1))[:, :3]
        skin.set_facecolor(0.6 * colours + 0.4 * light_colours(mesh.vertices, mesh.triangles, colours))
        axes.set_box_aspect((np.ptp(x), np.ptp(z), 8.0 * TALLER), zoom=1.15)
        axes.set_title(f"{name.replace('_', ' ')}: {captions[name]}", y=0.97)
        set_plan(axes, zlabel="y [m]", zlim=(-4.0, 4.0), zticks=(-4, -2, 0, 2, 4))
        axes.set(xticks=(-20, -10, 0, 10, 20), yticks=(-20, -10, 0, 10, 20))
        axes.view_init(elev=24.0, azim=-60.0)
    bar = {"shrink": 0.4, "aspect": 30.0, "pad": 0.06, "orientation": "horizontal", "extend": "both"}
    figure.colorbar(heights, ax=solid, label="y [m]", **bar)
    save_figure(figure, path, found)


def main() -> None:
    asked = options(__doc__, "coarse and short")
    coarse = {"resolution": 2.0} if asked.fast else {}
    config = load(SCENE, {"render": None, "frames": None, "accuracy": None, "surface": "cloth", **coarse})
    other = load(SCENE, {"surface": "marching_cubes", **coarse}).preflight.surface
    with Simulation(config) as simulation:
        simulation.run(until=SOON if asked.fast else MOMENT)
        cloth, fluid = simulation.surface, with_particles(simulation.fluid)
        assert isinstance(cloth, Cloth) and other is not None
        cubes, spacing = other.build(simulation.basin, fluid), fluid.spacing
        assert isinstance(cubes, MarchingCubes)
        top = highest_particles(simulation.basin, fluid)

        def moved() -> None:
            fluid.advance(simulation.next_dt)
            fluid.elevations(np.zeros((1, 2)))

        def laid() -> None:
            cloth.update(cloth.config.every)
            cloth.mesh()

        def frame() -> None:
            cubes.follow(fluid.particles, 0.0)
            cubes.mesh()

        step = median_time(moved)
        times = {"cloth": median_time(laid), "marching_cubes": median_time(frame)}
        meshes = {"cloth": cloth.mesh(), "marching_cubes": cubes.free_surface()}
        whole = {"cloth": meshes["cloth"], "marching_cubes": cubes.mesh()}
        rows = []
        surfaces: dict[str, Surface] = {"cloth": cloth, "marching_cubes": cubes}
        for name, surface in surfaces.items():
            mean, rms = (value / spacing for value in surface_fit(surface, top))
            rows.append((name, times[name], len(whole[name].triangles), mean, rms, open_edges(whole[name].triangles)))
        between = (cloth.elevations(top[:, [0, 2]]) - cubes.elevations(top[:, [0, 2]])) / spacing
        cut = flying_edges(cubes)
        triangles = cut().regular_faces
        rows.append(("flying_edges", median_time(cut), len(triangles), rows[1][3], rows[1][4], open_edges(triangles)))
    head = [f"{SCENE} at {simulation.time:.3f} s, {fluid.particles.n} particles {spacing:g} m apart"]
    head += ["distance over the highest particle of every column, in spacings; an open edge has one triangle"]
    columns = ["surface", "triangles", "mean_spacings", "rms_spacings", "open_edges"]
    rows = [
        (name, round(ms, 2), count, round(mean, 3), round(rms, 3), open) for name, ms, count, mean, rms, open in rows
    ]
    counted = [(name, *others) for name, _, *others in rows]
    save_table(asked.out / "fig6_2.csv", head, columns, counted)
    timed = [(name, ms) for name, ms, *_ in rows] + [("step of the water", round(step, 2))]
    save_table(asked.out / "fig6_2_timings.csv", [f"medians of {ROUNDS} [ms]"], ["surface", "ms"], timed)
    captions = {name: f"{ms:g} ms, {count} triangles, {rms:g} spacings (RMS)" for name, ms, count, _, rms, _ in rows}
    means = {name: mean for name, _, _, mean, *_ in rows}
    found = (
        f"From the particles: cloth {means['cloth']:+g}, marching cubes {means['marching_cubes']:+g} spacings (mean)."
    )
    draw_figure(meshes, captions, np.column_stack([top[:, [0, 2]], between]), found, asked.out / "fig6_2.png")


if __name__ == "__main__":
    main()
