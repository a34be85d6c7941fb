"""Heights of a basin and of the far sea around it as one surface: the basin's own inside it, a blend in a margin."""

from dataclasses import replace
from typing import Any

import numpy as np

from ocean_sim.pictures import far_sea, foam
from ocean_sim.pictures.frame_files import Frame
from ocean_sim.pictures.ripples import noise
from ocean_sim.pictures.sea_state import SeaState
from ocean_sim.pictures.water_mesh import spline, triangles

GRAIN = 7.0  # [m] apart at which white water gathers along a crest


class SeaSurface:
    """Nodes of a grid that is even within the basin and widens to the horizon; only heights change, and the origin
    where ships sail away."""

    def __init__(self, grid: Any, state: SeaState, nodes: int) -> None:
        """`nodes`: about how many lie within the basin."""
        self.state = state
        self.lower, self.upper = grid["lower"][[0, 2]], grid["upper"][[0, 2]]
        self.margin = far_sea.MARGIN * float((self.upper - self.lower).min())
        cells = len(grid["x"]), len(grid["z"])
        factor = int(np.clip(np.sqrt(nodes / (cells[0] * cells[1])), 1, 24))
        whole = state.exact is not None and "sea_answers" not in grid
        if not whole:
            factor += factor % 2  # the points whose heights are known are nodes
        inner = [np.linspace(self.lower[k], self.upper[k], n * factor + 1) for k, n in enumerate(cells)]
        self.x, self.z = (far_sea.axis(nodes, self.margin) for nodes in inner)
        if not whole:
            self.own = [self.stretched(spline(n, factor), k) for k, n in enumerate(cells)]
            self.share = np.outer(self.blend_weight(0), self.blend_weight(1))
        if state.exact is None:
            self.far = far_sea.FarSea(state.estimated, self.x, self.z, self.lower, self.lower)
        else:
            self.far = far_sea.FarSea(state.exact, self.x, self.z, self.lower, self.upper)
        self.nodes = np.stack(np.meshgrid(self.x, self.z, indexing="ij"), axis=-1).reshape(-1, 2)
        self.triangles = triangles(len(self.x), len(self.z))
        self.near = np.ix_(self.blend_weight(0) > 0.0, self.blend_weight(1) > 0.0)
        self.grain = self.grain_at(np.zeros(2))

    def grain_at(self, origin: np.ndarray) -> np.ndarray:
        """(nx, nz) how readily white water gathers at the nodes around an origin x, z [m]."""
        x, z = (self.nodes + origin).T / GRAIN
        return 0.5 + noise(x, z)[0].reshape(len(self.x), len(self.z))

    def blend_weight(self, k: int) -> np.ndarray:
        """Share of the basin's own waves at the nodes along one side."""
        return far_sea.blend_weight((self.x, self.z)[k], self.lower[k], self.upper[k], self.margin)

    def stretched(self, inner: np.ndarray, k: int) -> np.ndarray:
        """(nodes, cells): from the heights of cells to all nodes along one side, mirrored in the walls and zero beyond
        the margin."""
        nodes, low, high = (self.x, self.z)[k], self.lower[k], self.upper[k]
        index = (far_sea.mirrored(nodes, low, high) - low) / (high - low) * (len(inner) - 1)
        left = np.clip(np.floor(index + 1e-9).astype(int), 0, len(inner) - 2)
        share = np.clip(index - left, 0.0, 1.0)[:, None]
        return ((1.0 - share) * inner[left] + share * inner[left + 1]) * (self.blend_weight(k) > 0.0)[:, None]

    def at(self, frame: Frame) -> far_sea.SeaSample:
        """Heights, convergence and lost slopes at all nodes (nx, nz)."""
        far = self.far.at(frame.time, frame.origin)
        if self.state.exact is not None and frame.answer is None:
            return far
        x, z = self.own
        if frame.answer is not None:  # what ships, winds and steepness add to the exact waves ends in the margin
            return replace(far, height=far.height + self.share * (x @ frame.answer @ z.T))
        step = (self.upper - self.lower) / frame.elevation.shape
        drawn_together = foam.convergence(frame.elevation, step[0], step[1])
        # Seas that know nothing of each other: weights whose squares add up to one keep the height of the waves.
        mine = self.share / np.hypot(self.share, 1.0 - self.share)
        rest = (1.0 - self.share) / np.hypot(self.share, 1.0 - self.share)
        level = self.state.level
        return far_sea.SeaSample(
            level + mine * (x @ (frame.elevation - level) @ z.T) + rest * far.height,
            mine * (x @ drawn_together @ z.T) + rest * far.convergence,
            rest**2 * far.variance,
        )

    def normals(self, height: np.ndarray) -> np.ndarray:
        """(nx, nz, 3) unit normals."""
        slope_x, slope_z = np.gradient(height, self.x, axis=0), np.gradient(height, self.z, axis=1)
        normal = np.stack([-slope_x, np.ones_like(height), -slope_z], axis=-1)
        return normal / np.linalg.norm(normal, axis=-1, keepdims=True)

    def foam(self, drawn_together: np.ndarray, cover: float | None = None) -> np.ndarray:
        """(nx, nz) share of white water: its mean over the basin and its margin is the cover; None: what crests call
        for."""
        gathered = drawn_together * self.grain
        wanted = foam.cover(drawn_together[self.near]) if cover is None else cover
        return foam.shares(gathered, wanted, gathered[self.near])

    def broken(self, frame: Frame) -> np.ndarray | float:
        """(nx, nz) share of white water that crests which broke in the run have left behind; 0 where it knows none."""
        if frame.foam is None:
            return 0.0
        x, z = self.own
        return np.clip(self.share * (x @ frame.foam @ z.T), 0.0, 1.0)
