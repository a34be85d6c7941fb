"""The lattice on which particles start: their first positions, counted before any field is made."""

from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from ocean_sim.basin import Basin, Solid, shifts
from ocean_sim.basin.points import middles_of
from ocean_sim.fluid.bodies.emitter import Jet
from ocean_sim.fluid.sph import initial_state as initial_module

if TYPE_CHECKING:
    from ocean_sim.basin.solids import packing
    from ocean_sim.basin.solids.shape import Boxes

BUDGET_ROWS = 32  # in the depth, by which the volume of a bed is summed before the spacing is known
MARGIN_SPACINGS = 8.0  # [spacings] around a solid, as far as the water that makes room for it is pressed from


@dataclass(frozen=True)
class Lattice:
    """Cubic lattice of the first particles. It fills the boxes of water, half a spacing away from their faces."""

    config: Any  # a WaterConfig, which makes the lattice
    basin: Basin

    @cached_property
    def boxes(self) -> "Boxes":
        """Lowest and highest corner (3,) [m] of each box of water."""
        if self.config.fill is None and self.config.emitter is not None and self.given is None:
            return []
        if self.config.fill is None:
            surface = np.array([self.basin.upper[0], 0.0, self.basin.upper[2]])
            return [(np.array(self.basin.lower), surface)]
        flat = (0.0,) * (3 - self.basin.dimension)
        return [(np.array(box.min + flat), np.array(box.max + flat)) for box in self.config.fill]

    @property
    def volume(self) -> float:
        """Volume of the water [m3]; in 2-D its area [m2]."""
        return sum(float(np.prod((up - low)[: self.basin.dimension])) for low, up in self.boxes)

    @cached_property
    def spacing(self) -> float:
        """Distance between particles [m]: the key `spacing`, or the least found that makes at most `particles`."""
        if self.config.spacing is not None:
            return self.config.spacing
        assert self.config.particles is not None
        asked, ground = self.config.particles, self.basin.ground
        if ground is not None:  # the bed takes the room of some
            solid = ground.volume_inside(self.boxes, self.basin.depth / BUDGET_ROWS)
            asked = int(asked * self.volume / (self.volume - solid))
        spacing = (self.volume / asked) ** (1.0 / self.basin.dimension)
        while total_count(self.box_counts(spacing)) > max(asked, len(self.boxes)):
            spacing *= 1.001
        return spacing

    def box_counts(self, spacing: float) -> list[np.ndarray]:
        """Numbers (3,) of particles along x, y, z in each box of water, about `spacing` [m] apart."""
        counts = [np.maximum(1, np.round((up - low) / spacing)).astype(int) for low, up in self.boxes]
        return [np.append(count[:2], 1) if self.basin.dimension == 2 else count for count in counts]

    @cached_property
    def counts(self) -> list[np.ndarray]:
        """Numbers (3,) of particles along x, y, z in each box of water."""
        return self.box_counts(self.spacing)

    @cached_property
    def n(self) -> int:
        """Number of particles; with an emitter, the largest number there can be."""
        return self.config.emitter.cap if self.config.emitter is not None else self.start_count

    @cached_property
    def start_count(self) -> int:
        """Number of particles at the start, before an emitter adds any."""
        if self.given is None and not (self.basin.config.obstacles or self.basin.solids):
            return total_count(self.counts)
        return int(self.wet_mask.sum()) if self.given is None else len(self.given)

    @cached_property
    def jet(self) -> Jet | None:
        """Jet of the emitter; None without an emitter."""
        if self.config.emitter is None:
            return None
        volume = self.mass / self.config.rest_density
        return Jet(self.config.emitter, self.basin.dimension, self.spacing, volume, self.start_count)

    @cached_property
    def given(self) -> np.ndarray | None:
        """Positions (n, 3) [m] of particles given by a file, which replace the lattice; None without a file."""
        return initial_module.given_positions(self.config.initial, self.basin)

    @property
    def mass(self) -> float:
        """Mass of a particle [kg], in 2-D [kg/m]: rest density times water volume over the number of particles."""
        if not self.boxes and self.given is None:
            return self.config.rest_density * self.spacing**self.basin.dimension
        count = total_count(self.counts) if self.given is None else len(self.given)
        return self.config.rest_density * self.volume / count

    @property
    def row(self) -> float:
        """Thickness [m] of the lowest layer (row) of particles."""
        rows = [(low[1], (up[1] - low[1]) / count[1]) for (low, up), count in zip(self.boxes, self.counts, strict=True)]
        return float(min(rows)[1]) if rows else self.spacing

    @property
    def plan_area(self) -> float | None:
        """Area of the still surface [m2], in 2-D its length [m]; None if the water does not fill an open basin."""
        dry = self.basin.ground is not None and self.basin.ground.y.max() > 0.0
        filled = self.config.fill is None and self.given is None and not self.basin.closed and not dry
        return self.basin.volume / self.basin.depth if filled else None

    @property
    def height(self) -> float:
        """Height of the tallest box of water [m]."""
        return max((float((up - low)[1]) for low, up in self.boxes), default=self.basin.depth)

    @cached_property
    def deepest(self) -> float:
        """Depth of the deepest column of water [m], whose boxes may be stacked; 0 without water."""
        bed, surface = self.column_ends()
        return float(np.max(surface - bed, initial=0.0))

    def column_ends(self) -> np.ndarray:
        """Heights (2, n) [m] of bottom and surface of the water column at each particle; stacked boxes count as one."""
        if self.given is not None:
            return np.repeat([[self.basin.lower[1]], [0.0]], len(self.given), axis=1)
        heights = np.array([(low[1], up[1]) for low, up in self.boxes]).reshape(-1, 2)
        numbers = np.array([np.prod(count) for count in self.counts], dtype=int)
        ends = np.repeat(heights, numbers, axis=0)[self.wet_mask].T
        x, y, z = self.full_positions[self.wet_mask].T
        feet, heads = heights.round(9).T
        touching = np.flatnonzero(np.isin(feet, heads) | np.isin(heads, feet))  # one box begins where another ends
        stacked = [
            (low[1], up[1], (x >= low[0]) & (x <= up[0]) & (z >= low[2]) & (z <= up[2]))
            for low, up in (self.boxes[k] for k in touching[feet[touching].argsort(kind="stable")])
        ]
        for foot, head, along in stacked:
            ends[1, along & np.isclose(ends[1], foot)] = head
        for foot, head, along in reversed(stacked):
            ends[0, along & np.isclose(ends[0], head)] = foot
        for mesh in self.basin.meshes.values():
            ends[0] = np.maximum(ends[0], np.minimum(mesh.tops_below(self.full_positions[self.wet_mask]), y))
        for low, up in self.basin.obstacles:
            over = (x > low[0]) & (x < up[0]) & (z > low[2]) & (z < up[2]) & (y > up[1])
            ends[0, over] = np.maximum(ends[0, over], up[1])
        if self.basin.ground is not None:
            ends[0] = np.maximum(ends[0], self.basin.ground.heights(np.stack([x, z], axis=1)))
        return ends

    @cached_property
    def full_positions(self) -> np.ndarray:
        """Positions (m, 3) [m] of the lattice as if there were no bodies; x runs fastest."""
        parts = [np.empty((0, 3))]
        for (low, up), count in zip(self.boxes, self.counts, strict=True):
            x, y, z = (middles_of(low[k], up[k], count[k]) for k in range(3))
            grid = np.meshgrid(z, y, x, indexing="ij")
            parts.append(np.stack([grid[2].ravel(), grid[1].ravel(), grid[0].ravel()], axis=1))
        return np.concatenate(parts)

    @cached_property
    def room_for_bodies(self) -> tuple[np.ndarray, np.ndarray]:
        """Mask (m,) of `full_positions` in no body or obstacle, and all (m, 3) [m] as Solid.make_room moves them."""
        wet, positions = ~in_boxes(self.full_positions, self.basin), self.full_positions
        for solid in self.basin.solids:
            nearest = shifts(positions, solid.origin[[0, 2]], self.basin.periods)
            beyond = self.points_beyond(solid) if solid.is_sampled else np.empty((0, 3))
            gone, moved = solid.make_room(positions + nearest, beyond, self.repeated_boxes, self.packed)
            wet &= ~gone
            positions = initial_module.wrap_positions(moved - nearest, self.basin)
        return wet, positions

    @property
    def packed(self) -> "packing.Lattice":
        """Spacing, particle volume and kernel, by which Solid.make_room moves particles out of a solid body."""
        from ocean_sim.basin.solids import packing

        volume = self.mass / self.config.rest_density
        return packing.Lattice(self.spacing, volume, self.config.kernel, self.config.ratio(self.basin))

    @property
    def repeated_boxes(self) -> "Boxes":
        """Lowest and highest corner [m] of each box of water, and of its repeats beyond periodic sides."""
        ways = product(*((-period, 0.0, period) if period else (0.0,) for period in self.basin.periods[::2]))
        return [(low + [x, 0.0, z], up + [x, 0.0, z]) for x, z in ways for low, up in self.boxes]

    def points_beyond(self, solid: Solid) -> np.ndarray:
        """Points (m, 3) [m] in no box, up to MARGIN_SPACINGS from a solid, to continue the first near box's lattice."""
        d, found = self.basin.dimension, np.empty((0, 3))
        low_end, high_end = solid.extent + np.array([[-1.0], [1.0]]) * MARGIN_SPACINGS * self.spacing
        counts = self.counts * (len(self.repeated_boxes) // len(self.counts))
        for (low, up), count in zip(self.repeated_boxes, counts, strict=True):
            if len(found) or (low[:d] > high_end[:d]).any() or (up[:d] < low_end[:d]).any():
                continue
            step = (up - low)[:d] / count[:d]
            first, last = np.floor((low_end - low)[:d] / step), np.ceil((high_end - low)[:d] / step)
            index = np.stack(np.meshgrid(*map(np.arange, first, last), indexing="ij"), axis=-1).reshape(-1, d)
            found = np.zeros((len(index), 3))
            found[:, :d] = low[:d] + (index + 0.5) * step
        for low, up in self.repeated_boxes:
            found = found[~((found >= low)[:, :d] & (found <= up)[:, :d]).all(axis=1)]
        return found

    @cached_property
    def wet_mask(self) -> np.ndarray:
        """Mask (m,) of the `full_positions` that hold water: those outside obstacles and bodies."""
        ground = self.basin.ground
        if ground is None or len(self.basin.solids) > 1:
            return self.room_for_bodies[0]
        gone = ground.displaced(self.full_positions, self.repeated_boxes, self.packed)
        return ~(gone | in_boxes(self.full_positions, self.basin))

    def positions(self) -> np.ndarray:
        """Positions (n, 3) [m] at which the particles start; x runs fastest."""
        return self.room_for_bodies[1][self.wet_mask] if self.given is None else self.given


def in_obstacles(positions: np.ndarray, basin: Basin, spacing: float) -> np.ndarray:
    """Mask (n,) of the positions (n, 3) [m] of particles a `spacing` [m] apart that lie in an obstacle of the basin."""
    meshes = [mesh.distances(positions.copy(), spacing) < 0.0 for mesh in basin.meshes.values()]
    return np.any([in_boxes(positions, basin), *meshes], axis=0)


def in_boxes(positions: np.ndarray, basin: Basin) -> np.ndarray:
    """Mask (n,) of the positions (n, 3) [m] that lie in a box in the water of the basin."""
    found = np.zeros(len(positions), dtype=bool)
    if basin.obstacles:
        order = positions[:, 0].argsort(kind="stable")
        x = positions[order, 0]
        for low, up in basin.obstacles:
            near = order[np.searchsorted(x, low[0], "right") : np.searchsorted(x, up[0], "left")]
            found[near] |= ((positions[near] > low) & (positions[near] < up)).all(axis=1)
    return found


def total_count(counts: list[np.ndarray]) -> int:
    """Number of particles in all boxes; `counts`: numbers (2,) or (3,) of particles along the axes of each box."""
    return sum(int(np.prod(count)) for count in counts)
