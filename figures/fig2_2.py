"""Figure 2-2: one moment of a standing wave, known on a grid (Euler) and on the particles that carry it (Lagrange): CSV
and PNG.

The grid's numbers are sums over the particles around each of its places, as (2.5); next to each the closed form.

python figures/fig2_2.py [--fast] [--out DIR]
"""

from pathlib import Path
from typing import Any

import numpy as np
from _options import options
from _paper import BLUE, GREY, paper, save_figure, save_table

from ocean_sim.fluid import with_particles
from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation

LENGTH, DEPTH, HEIGHT = 4.0, 1.0, 0.2  # [m]
SPACING, CELL = 0.1, 0.2  # [m]
QUARTER = 0.25  # of a period: the water is level and moves fastest
OBSERVERS = ("accuracy", "timings", "health", "frames", "render", "report")


def scene(spacing: float) -> dict[str, Any]:
    """Scene of a standing wave as long as the basin, for a particle spacing [m]."""
    wave = {"kind": "standing_wave", "height": HEIGHT, "mode": 2}
    return {
        "title": "figure 2-2",
        "duration": 2.0,
        "basin": {"length": LENGTH, "depth": DEPTH},
        "fluid": {"kind": "delta_sph", "spacing": spacing, "initial": wave},
        **dict.fromkeys(OBSERVERS),
    }


def draw_figure(grid: np.ndarray, water: np.ndarray, moment: float, fit: float, path: Path) -> None:
    """Draw velocities as arrows, once in the cells of the grid and once on the particles."""
    figure = paper(11.0, 6.4)
    panels = figure.subplots(2, 1, sharex=True, sharey=True)
    titles = ("Euler: numbers at fixed places of a grid", "Lagrange: numbers on particles that move with the water")
    for axes, rows, what in zip(panels, (grid, water), titles):
        x, y, u, v = rows.T
        speed = np.hypot(u, v)
        arrows = axes.quiver(x, y, u, v, speed, cmap="viridis_r", scale=9.0, width=0.0022, clim=(0.0, water_top(water)))
        axes.set(title=what, ylabel="y [m]", aspect="equal", xlim=(-2.05, 2.05), ylim=(-1.05, 0.18))
    panels[1].plot(*water[:, :2].T, "o", color=BLUE, ms=2.5, zorder=0)
    for edge in np.arange(-LENGTH / 2, LENGTH / 2 + 1e-9, CELL):
        panels[0].plot([edge, edge], [-DEPTH, 0.0], color=GREY, lw=0.4, zorder=0)
    for edge in np.arange(-DEPTH, 1e-9, CELL):
        panels[0].plot([-LENGTH / 2, LENGTH / 2], [edge, edge], color=GREY, lw=0.4, zorder=0)
    panels[1].set_xlabel("x [m]")
    figure.colorbar(arrows, ax=panels.tolist(), label="speed [m/s]", shrink=0.75)
    found = (
        f"{len(grid)} cells next to {len(water)} particles at {moment:.3f} s; the grid differs from linear theory by "
    )
    save_figure(figure, path, f"{found}{100.0 * fit:.1f} % (RMS)")


def water_top(water: np.ndarray) -> float:
    """Greatest speed of the water [m/s]; `water`: rows x, y, u, v."""
    return float(np.hypot(*water[:, 2:].T).max())


def main() -> None:
    asked = options(__doc__, "particles twice as far apart")
    spacing = 2.0 * SPACING if asked.fast else SPACING
    wavenumber = 2.0 * np.pi / LENGTH
    omega = float(np.sqrt(9.81 * wavenumber * np.tanh(wavenumber * DEPTH)))
    with Simulation(load(scene(spacing))) as simulation:
        simulation.run(until=QUARTER * 2.0 * np.pi / omega)
        moment, particles = simulation.time, with_particles(simulation.fluid).particles
        water = np.hstack([particles.position.to_numpy()[:, :2], particles.velocity.to_numpy()[:, :2]]).astype(float)
        water = water[np.argsort(particles.id.to_numpy())]
        across, up = np.arange(-LENGTH / 2 + CELL / 2, LENGTH / 2, CELL), np.arange(-DEPTH + CELL / 2, 0.0, CELL)
        places = np.stack(
            [grid.ravel() for grid in np.meshgrid(across, up)] + [np.zeros(across.size * up.size)], axis=1
        )
        found = simulation.fluid.velocities(places)[:, :2].astype(float)
    k_x, above = wavenumber * (places[:, 0] + LENGTH / 2), wavenumber * (places[:, 1] + DEPTH)
    size = 0.5 * HEIGHT * omega / np.sinh(wavenumber * DEPTH) * np.sin(omega * moment)
    theory = size * np.stack([np.sin(k_x) * np.cosh(above), -np.cos(k_x) * np.sinh(above)], axis=1)
    fit = float(np.sqrt(((found - theory) ** 2).sum() / (theory**2).sum()))
    rows = [("grid", *row) for row in np.hstack([places[:, :2], found, theory]).tolist()]
    rows += [("particle", *row, "", "") for row in water.tolist()]
    head = [f"a standing wave of {LENGTH:g} m and {HEIGHT:g} m on {DEPTH:g} m of water, at {moment:.6f} s (delta_sph)"]
    head += [f"grid minus linear theory: {fit:.5f} of it (root mean square)"]
    columns = ["kind", "x_m", "y_m", "u_m_s", "v_m_s", "theory_u_m_s", "theory_v_m_s"]
    save_table(asked.out / "fig2_2.csv", head, columns, rows)
    draw_figure(np.hstack([places[:, :2], found]), water, moment, fit, asked.out / "fig2_2.png")


if __name__ == "__main__":
    main()
