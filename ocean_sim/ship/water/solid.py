"""A hull as a solid body among particles: the space that it keeps free of water."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ocean_sim.basin.solids.packing import Lattice, Wendland
from ocean_sim.basin.solids.room import Boxes, ShapedSolid, face_normals, lattice_values
from ocean_sim.ship.body.rigid_body import RigidBody

FIT_SUPPORT = 2.0  # [spacings] of the kernel by which particles are fitted to a hull that the water's laws meet
START_GAP = 0.5  # [spacings] from the hull to the nearest particle of the start
PACKING_SWEEPS = 100  # over crowded particles that are pushed apart
PACKING_PUSH = 0.5  # share of their overlap in each sweep


@dataclass(frozen=True, eq=False, kw_only=True)
class Solid(ShapedSolid):
    """A hull at its pose at the beginning of a run, as a solid body; in 2-D the section amidships."""

    body: RigidBody
    reach: float = 0.0  # of what it does else to the water [m]

    def room_arrays(
        self, positions: np.ndarray, beyond: np.ndarray, boxes: Boxes, lattice: Lattice
    ) -> dict[str, np.ndarray]:
        if self.is_sampled:
            packed = replace(lattice, kernel=Wendland(), support=FIT_SUPPORT)
            return super().room_arrays(positions, beyond, boxes, packed)
        return self.carve_room(positions, boxes, lattice.spacing)

    def carve_room(self, positions: np.ndarray, boxes: Boxes, spacing: float) -> dict[str, np.ndarray]:
        """Make room for a hull without boundary particles. Returns indices of particles inside her, to be removed
        (`gone`), and of those close to her (`near`), and positions [m] to which the latter are moved (`moved`)."""
        values, first, step = self.lattice(spacing)
        distance, order = self.deepest_first((positions - self.origin) @ self.turn + self.centre, spacing)
        gone = np.zeros(len(positions), dtype=bool)
        gone[order[: round(self.displaced_volume(spacing, boxes) / spacing**3)]] = True
        slopes = np.gradient(values["distance"], *step)

        def off(points: np.ndarray) -> np.ndarray:
            """Copy of points (m, 3) [m]; those within half a spacing of the hull are moved out to that distance."""
            at = ((points - self.origin) @ self.turn + self.centre - first) / step
            away = lattice_values(values["distance"], at, 2.0 * spacing)
            return points + np.maximum(START_GAP * spacing - away, 0.0)[:, None] * face_normals(slopes, at, self.turn.T)

        free = np.flatnonzero(~gone & (distance < 2.0 * spacing))
        moved = pack_particles(positions[free], positions[~gone & (distance >= 2.0 * spacing)], spacing, off)
        return {"gone": np.flatnonzero(gone), "near": free, "moved": moved}


def pack_particles(
    free: np.ndarray, others: np.ndarray, spacing: float, off: Callable[[np.ndarray], np.ndarray]
) -> np.ndarray:
    """(m, 3) positions of the `free` particles near a hull, moved so that they neither touch it nor crowd each other or
    the `others` (k, 3), which stay; crowded ones would burst into the hull at once. `off` moves points off the hull. In
    sweeps, particles nearer than `spacing` push each other apart (particle packing, Colagrossi et al. 2012, Comput.
    Phys. Commun. 183), but not beyond the heights of the water around."""
    from scipy.spatial import cKDTree

    if len(free) == 0:
        return free
    lowest, highest = (bound(np.concatenate([free, others]), axis=0) for bound in (np.min, np.max))
    near = others[cKDTree(free).query(others)[0] < 3.0 * spacing] if len(others) else others
    whole, m = np.concatenate([off(free), near]), len(free)
    for _ in range(PACKING_SWEEPS):
        pairs = cKDTree(whole).query_pairs(spacing * (1.0 - 1e-9), output_type="ndarray")
        pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
        i, j = pairs[pairs.min(axis=1) < m].T
        apart = whole[i] - whole[j]
        way = np.linalg.norm(apart, axis=1, keepdims=True)
        push = 0.5 * PACKING_PUSH * (spacing - way) * apart / np.maximum(way, 1e-9 * spacing)
        moved = np.zeros_like(whole)
        np.add.at(moved, i, push)
        np.add.at(moved, j, -push)
        whole[:m] = np.clip(off(whole[:m] + moved[:m]), lowest, highest)
    return whole[:m]
