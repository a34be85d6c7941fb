"""Heights of a basin and of the far sea around it as one surface: a blend within the basin, never its mirror image."""

from typing import Any

import numpy as np

from ocean_sim.basin.points import grid_points
from ocean_sim.pictures.frame_files import Frame
from ocean_sim.pictures.water import far_sea, foam
from ocean_sim.pictures.water.sea_state import SeaNow, SeaState
from ocean_sim.pictures.water.water_mesh import grid_triangles, spline_matrix
from ocean_sim.waves.orbits import surface_fall

WHITE_REACH = 6  # cells from white water, of the grid that it is kept on, from which a spline through it shows none
GATHERING_LENGTH = 7.0  # [m] apart at which white water gathers along a crest


class SeaSurface:
    """Surface of the sea around an eye: an even grid of nodes over the basin, and a fan of nodes beyond. Near the sides
    of the basin its waves are blended into those of the far sea. Only heights and the origin change."""

    def __init__(self, grid: Any, state: SeaState, nodes: int) -> None:
        """`grid`: arrays in the run's grid.npz; `state`: sea over time; `nodes`: approximate number in the basin."""
        self.state = state
        self.lower, self.upper = grid["lower"][[0, 2]], grid["upper"][[0, 2]]
        self.margin = far_sea.BLEND_MARGIN * float((self.upper - self.lower).min())
        cells = len(grid["x"]), len(grid["z"])
        factor = int(np.clip(np.sqrt(nodes / (cells[0] * cells[1])), 1, 24))
        factor += factor % 2  # the points whose heights are known are nodes
        self.x, self.z = (np.linspace(self.lower[k], self.upper[k], n * factor + 1) for k, n in enumerate(cells))
        self.own = [spline_matrix(n, factor) for n in cells]
        self.share = np.outer(self.blend_weight(0), self.blend_weight(1))
        self.far, self.fan = far_sea.PlaneWaves(state.beyond, self.x, self.z), far_sea.Fan(state.beyond)
        self.exact = None if state.exact is None else far_sea.PlaneWaves(state.exact, self.x, self.z)
        self.nodes = grid_points(self.x, self.z)
        self.triangles = grid_triangles(len(self.x), len(self.z))
        self.grain = self.grain_at(np.zeros(2))
        self.wanted = 0.0  # share of white water

    def grain_at(self, origin: np.ndarray) -> np.ndarray:
        """Factor (nx, nz), 1 on average, that makes foam patchy, at the nodes of a basin around x, z `origin` [m]."""
        return foam.gathering_noise((self.nodes + origin).T / GATHERING_LENGTH).reshape(len(self.x), len(self.z))

    def blend_weight(self, k: int) -> np.ndarray:
        """Weight, 0 to 1, of the basin's own waves in the surface, at the nodes along x (k = 0) or z (k = 1)."""
        return far_sea.blend_weight((self.x, self.z)[k], self.lower[k], self.upper[k], self.margin)

    def at(self, frame: Frame, now: SeaNow, answer: np.ndarray | None = None) -> far_sea.SeaSample:
        """Heights [m] and convergence (downward acceleration over gravity) at the basin's nodes (nx, nz) in a frame;
        `now`: sea around. `answer`: heights [m] on its grid beyond exact plane waves, by ships, wind, nonlinearity."""
        far = self.far.at(far_sea.complex_amplitudes(now.waves, frame.time, frame.origin))
        (x, z), mine = self.own, self.share
        if self.exact is not None and self.state.exact is not None:
            sea = far_sea.grown_waves(self.state.exact, frame.time)
            near = self.exact.at(far_sea.complex_amplitudes(sea, frame.time, frame.origin))
            if answer is not None:
                near = near._replace(height=near.height + x @ answer @ z.T)
            return far_sea.SeaSample(far.height + mine * (near.height - far.height), near.convergence)
        step = (self.upper - self.lower) / frame.elevation.shape
        convergence = surface_fall(frame.elevation, step[0], step[1])
        # Seas that know nothing of each other: weights whose squares add up to one keep the height of the waves.
        rest = (1.0 - mine) / np.hypot(mine, 1.0 - mine)
        mine = mine / np.hypot(mine, 1.0 - mine)
        level = now.level
        return far_sea.SeaSample(
            level + mine * (x @ (frame.elevation - level) @ z.T) + rest * far.height,
            mine * (x @ convergence @ z.T) + rest * far.convergence,
        )

    def far_samples(self, frame: Frame, eye: np.ndarray, now: SeaNow) -> np.ndarray:
        """Height [m], slopes along x and z, and convergence (downward acceleration over gravity) of the far sea `now`,
        at nodes on rings around an eye (3,) [m] and rays from it (rings, rays, 4)."""
        found = self.fan.at(far_sea.complex_amplitudes(now.waves, frame.time, eye[[0, 2]]))
        found[..., 0] += now.level
        return found

    def normals(self, height: np.ndarray) -> np.ndarray:
        """Unit normals (nx, nz, 3) at the basin's nodes, for heights (nx, nz) [m] there."""
        slope_x, slope_z = np.gradient(height, self.x, axis=0), np.gradient(height, self.z, axis=1)
        normal = np.stack([-slope_x, np.ones_like(height), -slope_z], axis=-1)
        return normal / np.linalg.norm(normal, axis=-1, keepdims=True)

    def foam(self, convergence: np.ndarray, cover: float | None = None) -> np.ndarray:
        """Share (nx, nz) of white water, highest where `convergence` (downward acceleration over gravity) is; `cover`
        on average, by default the share of crests that break."""
        self.wanted = foam.crest_cover(convergence) if cover is None else cover
        return foam.white_shares(convergence * self.grain, self.wanted)

    def far_foam(
        self, found: np.ndarray, rings: np.ndarray, nodes: np.ndarray, eye: np.ndarray, amplitude: np.ndarray
    ) -> np.ndarray:
        """Share (bands, rays) of white water at `nodes` x, z (bands * rays, 2) [m] of the far sea: on each ray from the
        `eye`, in each row of pixels (band), on ring `rings` (bands, rays). `found`: as `far_samples`; `amplitude` (m,):
        of waves [m]. Each ring has the basin's mean share, and varies less the more waves are too short to draw."""
        if self.wanted <= 0.0:
            return np.zeros(rings.shape)
        fan = self.fan
        whole, drawn = fan.convergence_deviation(amplitude)
        told = np.clip(drawn / whole, 1e-3, 1.0)
        gathered = found[..., 3] / (told * whole)[:, None]
        near = fan.nodes[fan.evenly] + eye[[0, 2]]
        known = np.sort(gathered.flat[fan.evenly] * foam.gathering_noise(near.T / GATHERING_LENGTH))
        gathering = foam.gathering_noise(nodes.T / GATHERING_LENGTH).reshape(rings.shape)
        here = np.take_along_axis(gathered, rings, axis=0) * gathering
        white = foam.white_shares(here, self.wanted, known)
        return self.wanted + told[rings] * (white - self.wanted)

    def blended_foam(self, fresh: np.ndarray, kept: np.ndarray, grain: np.ndarray) -> np.ndarray:
        """Share (nx, nz) of white water at the basin's nodes: inside, that `kept` in a frame, on its grid; at the
        sides, `fresh` (nx, nz) on converging crests. `grain` (n, 2): positions [m] in the noise that bends edges."""
        return self.laced_foam(kept, grain) + (1.0 - self.share) * fresh

    def on_nodes(self, kept: np.ndarray) -> np.ndarray:
        """Values `kept` in a frame, on its grid, interpolated to nodes (nx, nz) and faded to 0 at the basin's sides."""
        x, z = self.own
        return self.share * (x @ kept @ z.T)

    def laced_foam(self, kept: np.ndarray, grain: np.ndarray) -> np.ndarray:
        """Share (nx, nz) of white water at the nodes, from that `kept` in a frame, on its grid; noise bends edges by
        about a cell. `grain` (n, 2): position [m] at which each node reads the noise, which drifts with the water."""
        from scipy.ndimage import map_coordinates, maximum_filter

        cell, white = (self.upper - self.lower) / kept.shape, np.zeros(self.share.shape)
        near = maximum_filter(kept, 2 * WHITE_REACH + 1) > foam.MIN_SHARE
        rows, columns = (
            np.clip((nodes - self.lower[k]) / cell[k], 0, kept.shape[k] - 1).astype(int)
            for k, nodes in enumerate((self.x, self.z))
        )
        some = near[np.ix_(rows, columns)]
        at = ((self.nodes[some.ravel()] - self.lower) / cell).T - 0.5
        of_x, of_z = (grain[some.ravel()] / cell).T
        at += foam.edge_bends(of_x, of_z, self.state.angle)
        white[some] = map_coordinates(kept, at, order=3, mode="nearest")
        return self.share * np.clip(white, 0.0, 1.0)
