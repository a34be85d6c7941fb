"""Where hulls meet the water of pictures and of files: the waves at their bows, and the white along them."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ocean_sim.pictures.water import foam
from ocean_sim.pictures.water.bow_wave import Bow

REACH, FADES = 4.0, 1.5  # [m] around a hull in which it is white, and before the end of that in which her bow's ends
RESTING, CONTACT_WIDTH = 0.30, 0.55  # share of foam along a hull that lies still, and [m] in which it falls to a third


class Met(NamedTuple):
    """A hull in the water at a time."""

    line: np.ndarray  # (m, 2, 2) segments x, z [m] at which it meets the water
    position: np.ndarray  # (3,) [m]
    turn: np.ndarray  # (3, 3) from body to world
    bow: Bow

    @property
    def wet(self) -> bool:
        """Whether it meets the water at all."""
        return len(self.line) > 2

    def around(self) -> tuple[np.ndarray, np.ndarray]:
        """(2,) the least and the greatest x, z [m] at which it is white."""
        return self.line.min(axis=(0, 1)) - REACH, self.line.max(axis=(0, 1)) + REACH

    def places(self, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(n,) how far places x, z (n, 2) lie abaft the stem and to a side of the middle [m]."""
        ends = self.line.reshape(-1, 2)
        stem = foam.from_ship(ends[:, 0], ends[:, 1], self.position, self.turn)[0].max()
        along, aside = foam.from_ship(at[:, 0], at[:, 1], self.position, self.turn)
        return stem - along, aside

    def raised(self, at: np.ndarray) -> np.ndarray:
        """(n,) height [m] of the wave at her bow at places x, z (n, 2)."""
        abaft, aside = self.places(at)
        return self.bow.height(abaft, np.abs(aside) - self.bow.half_breadth(abaft))

    def gap(self, at: np.ndarray) -> np.ndarray:
        """(n,) [m] from places x, z (n, 2) to the hull, negative inside it."""
        return foam.distance(at, self.line)

    def breaking(self, at: np.ndarray, gap: np.ndarray) -> np.ndarray:
        """(n,) share of foam of the wave at her bow, at places x, z (n, 2) that lie a gap off the hull [m]."""
        return self.bow.white(self.places(at)[0], gap) * np.clip((REACH - gap) / FADES, 0.0, 1.0)

    def white(self, at: np.ndarray) -> np.ndarray:
        """(n,) share of foam at places x, z (n, 2): of that wave, and of all the hull."""
        gap = self.gap(at)
        return np.maximum(self.breaking(at, gap), RESTING * np.exp(-np.maximum(gap, 0.0) / CONTACT_WIDTH))


class Hull:
    """Of a ship that meets the water."""

    def __init__(self, grid: Any, key: str) -> None:
        """Of the ship that frames keep under a key."""
        self.vertices, self.triangles = grid[f"{key}_vertices"].astype(float), grid[f"{key}_triangles"].astype(int)
        self.beam, _, self.length = (float(size) for size in np.ptp(self.vertices, axis=0))  # [m]

    def met(
        self, position: np.ndarray, turn: np.ndarray, speed: float, heights_at: Callable[[np.ndarray], np.ndarray]
    ) -> Met:
        """Where she is, at a speed [m/s]; `heights_at`: of the water [m] at places x, z (n, 2)."""
        vertices = self.vertices @ turn.T + position
        above = vertices[:, 1] - heights_at(vertices[:, [0, 2]])
        line = foam.waterline(vertices, self.triangles, above)
        return Met(line, position, turn, Bow(self.length, self.beam, speed))
