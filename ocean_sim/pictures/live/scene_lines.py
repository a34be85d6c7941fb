"""Surface heights of a live scene, and its lines: edges of the still water, the wind, and the surface of a slice."""

from typing import TYPE_CHECKING

import numpy as np

from ocean_sim.basin.points import grid, grid_points

if TYPE_CHECKING:
    from ocean_sim.simulation import Simulation

BASIN_COLOUR, SURFACE_COLOUR = np.array([0.20, 0.28, 0.34]), np.array([0.93, 0.89, 0.80])  # display RGB
VOLUME_COLOUR, ARROW_COLOUR = np.array([0.98, 0.78, 0.22]), np.array([0.86, 0.16, 0.10])  # of the wind, display RGB
ARROW_LENGTH, MIN_ARROW_LENGTH = 0.1, 1e-3  # of the basin's length: an arrow of length 1, and the shortest drawn
BARB_LENGTH, BARB_SPREAD = 0.28, 0.4  # over the length of an arrow, and sideways over the barb's length along it


def box_top(simulation: "Simulation", ship_length: float) -> float:
    """Height [m] to which a preview shows wind and ships over still water; `ship_length`: of the longest ship [m]."""
    ground = simulation.basin.ground
    return max(0.25 * simulation.basin.depth, 0.3 * ship_length, 0.0 if ground is None else float(ground.y.max()))


def surface_heights(simulation: "Simulation", points: np.ndarray) -> np.ndarray:
    """Heights (n,) [m] of the drawn water surface at points x, z (n, 2) [m]; under a dry bed it continues, hidden."""
    fluid, ground = simulation.fluid, simulation.basin.ground
    heights = (simulation.surface or fluid).elevations(points)
    if ground is None:
        return heights
    position = np.zeros((0, 3)) if fluid.particles is None else fluid.particles.position.to_numpy()
    return ground.sheet_heights(points, heights, position, fluid.spacing)


def scene_lines(simulation: "Simulation", top: float) -> tuple[np.ndarray, np.ndarray]:
    """End points (n, 2, 3) [m] and display RGB (n, 3) of all lines in a preview; `top`: height [m] of drawn wind."""
    basin, fluid, wind = simulation.basin, simulation.fluid, simulation.wind.drawing()
    lower, upper = np.array(basin.lower, dtype=float), np.array(basin.upper, dtype=float)
    flat = basin.dimension == 2
    corners = np.array([[(lower, upper * [1.0, 0.0, 1.0])[b][a] for a, b in enumerate(k)] for k in np.ndindex(2, 2, 2)])
    edges = corners[[(i, i ^ bit) for i in range(8) for bit in (1, 2, 4) if i < i ^ bit]]
    volumes = wind.lines.copy()
    volumes[..., 1] = np.clip(volumes[..., 1], 0.0, top)  # a volume may reach far beyond the picture
    if flat:
        volumes[..., 2] = 0.0
    volumes = volumes[np.linalg.norm(volumes[:, 1] - volumes[:, 0], axis=1) > 1e-6]
    arrows = arrow_lines(wind.tails, wind.arrows, lower, upper, 0.6 * top)
    parts = [(edges, BASIN_COLOUR), (volumes, VOLUME_COLOUR), (arrows, ARROW_COLOUR)]
    if flat and not basin.closed and (fluid.particles is None or fluid.sound_speed > 0.0):
        x, z = grid(basin, fluid.spacing)
        heights = surface_heights(simulation, grid_points(x, z))
        line = np.stack([x, heights, 0.0 * x], axis=1)
        parts.append((np.stack([line[:-1], line[1:]], axis=1), SURFACE_COLOUR))
    colours = np.concatenate([np.tile(colour, (len(ends), 1)) for ends, colour in parts])
    return np.concatenate([ends for ends, _ in parts]), colours


def arrow_lines(
    feet: np.ndarray, pushes: np.ndarray, lower: np.ndarray, upper: np.ndarray, height: float
) -> np.ndarray:
    """End points (n, 2, 3) [m] of the lines of wind arrows, a shaft and four barbs each, within a basin from `lower` to
    `upper`, at a `height` [m]. Arrows begin at `feet` (m, 3) [m]; `pushes` (m, 3): their vectors, 1 the longest."""
    size = upper - lower
    inside = ((feet > lower) & (feet < upper) | (size <= 0.0))[:, [0, 2]].all(axis=1)
    feet, pushes = feet[inside], ARROW_LENGTH * size.max() * pushes[inside]
    if size[2] <= 0.0:
        pushes = pushes * [1.0, 1.0, 0.0]
    lengths = np.linalg.norm(pushes, axis=1)
    feet, pushes, lengths = (a[lengths > MIN_ARROW_LENGTH * size.max()] for a in (feet, pushes, lengths))
    begin = feet * [1.0, 0.0, 1.0] + [0.0, height, 0.0]
    tip, along = begin + pushes, pushes / lengths[:, None]
    across = np.cross(along, [0.0, 1.0, 0.0])
    across[np.linalg.norm(across, axis=1) < 1e-6] = [1.0, 0.0, 0.0]  # of an arrow that points up or down
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    barb = BARB_LENGTH * lengths[:, None]
    sides = [side * BARB_SPREAD * out for out in (across, np.cross(along, across)) for side in (-1.0, 1.0)]
    return np.concatenate([np.stack([a, tip], axis=1) for a in (begin, *(tip + barb * (s - along) for s in sides))])
