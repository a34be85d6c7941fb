"""The white wake of a ship: drawn along the track of its stern, without effect on the water of the run."""

import numpy as np

from ocean_sim.pictures.camera import Vessel

LASTS = 7.0  # [s] in which it falls to a third
AGE = 22.0  # [s] after which it is not drawn
STEPS = 48  # positions of the stern that are kept
FAST = 4.0  # [m/s] from which a wake is as white as it gets
WHITEST = 0.8
STERN = 0.46  # lengths of a ship from its middle to its stern
SPREADING = 0.22  # [half breadths at s^-1/2] by which it widens


class Wake:
    """Shares of foam at the nodes of a grid, by how long ago and how far away the stern passed. The laws are ours."""

    def __init__(self, vessel: Vessel, breadth: float, x: np.ndarray, z: np.ndarray) -> None:
        """`breadth` of the ship [m]; `x`, `z`: nodes along the sides [m]."""
        track = vessel.track
        self.time, self.half, self.x, self.z = track.time, 0.5 * breadth, x, z
        stern = track.position - STERN * vessel.length * track.turn[:, :, 2]
        self.position = stern[:, [0, 2]]

    def share(self, time: float, origin: np.ndarray) -> np.ndarray:
        """(nx, nz) at a time [s], on nodes around an origin x, z [m]."""
        share = np.zeros((len(self.x), len(self.z)))
        moments = np.linspace(max(self.time[0], time - AGE), time, STEPS)
        position = np.stack([np.interp(moments, self.time, self.position[:, k]) for k in range(2)], axis=1) - origin
        along = np.diff(position, axis=0)
        length2 = np.maximum((along**2).sum(axis=1), 1e-9)
        seconds = max(float(moments[-1] - moments[0]), 1e-9) / (STEPS - 1)
        speed = np.sqrt(length2) / seconds
        reach = 4.0 * self.half
        near = [
            np.flatnonzero((nodes > position[:, k].min() - reach) & (nodes < position[:, k].max() + reach))
            for k, nodes in enumerate((self.x, self.z))
        ]
        if not (len(near[0]) and len(near[1])):
            return share
        at = np.stack(np.meshgrid(self.x[near[0]], self.z[near[1]], indexing="ij"), axis=-1)
        best = np.zeros(at.shape[:2])
        for k in range(STEPS - 1):
            offset = at - position[k]
            part = np.clip((offset @ along[k]) / length2[k], 0.0, 1.0)
            age = np.maximum(time - moments[k] - part * seconds, 0.0)
            width = self.half * (0.75 + SPREADING * np.sqrt(age))
            away = np.linalg.norm(offset - part[..., None] * along[k], axis=-1) / width
            white = WHITEST * min(speed[k] / FAST, 1.0) * np.exp(-age / LASTS - away**4)
            best = np.maximum(best, white)
        share[np.ix_(*near)] = np.where(best > 0.02, best, 0.0)
        return share
