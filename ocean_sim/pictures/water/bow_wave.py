"""The wave at the bow of a ship under way, and the white water that it breaks into: drawn where the water of the run is
too coarse for it, without effect on the run.

Height and place of the crest are those of a wedge (Noblesse, Delhommeau, Guilbaud, Hendrix & Yang 2008, J. Fluid Mech.
600); how it goes on aside, and the white, are ours. The height is that by which waves at a bow stand at V^2 / 2 g where
V / sqrt(g D) = 4.4 tan / cos - 1 (Delhommeau, Guilbaud, David, Yang & Noblesse 2009, J. Fluid Mech. 620, abstract); the
number of the place was not checked against the paper.
"""

from typing import NamedTuple

import numpy as np

from ocean_sim.conventions import GRAVITY

ENTRANCE = 0.35  # lengths of a ship abaft her stem in which she reaches her breadth
DRAUGHT = 0.25  # of her breadth
RISE, BACK = 2.2, 1.1  # of V^2 / g: height and place of the crest
HIGHEST = 0.2  # of the breadth: a higher one is spray
OUTWARD = 0.33  # slope of the crest's line against the hull, as it leaves it
LASTS = 0.5, 2.0  # lengths of a ship, and V^2 / g, along that line in which the crest falls to a third
NARROW, WIDER = 0.10, 0.10  # [breadths] of the crest at the stem, and what it gains for each it goes aft
BEGINS, WHOLE = 0.03, 0.22  # [m] height from which the crest breaks, and is wholly white
TRAILS = 0.9  # [breadths] behind the crest in which its white falls to a third


class Bow(NamedTuple):
    """Of a ship that goes at a speed."""

    length: float  # [m]
    breadth: float  # [m]
    speed: float  # [m/s]

    @property
    def wedge(self) -> float:
        """Tangent of half the angle of her entrance."""
        return 0.5 * self.breadth / (ENTRANCE * self.length)

    @property
    def crest(self) -> tuple[float, float]:
        """Height over the water around, and distance abaft the stem [m]."""
        head = self.speed**2 / GRAVITY
        slowed = 1.0 + self.speed / np.sqrt(GRAVITY * DRAUGHT * self.breadth)
        rise = RISE / slowed * self.wedge * np.hypot(1.0, self.wedge) * head
        return float(min(rise, HIGHEST * self.breadth)), float(BACK / slowed * head)

    @property
    def breaks(self) -> float:
        """0 to 1, how white its crest is."""
        return float(np.clip((self.crest[0] - BEGINS) / (WHOLE - BEGINS), 0.0, 1.0))

    def across(self, abaft: np.ndarray, gap: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """How far places lie outside the line of the crest [its own widths], and the share of its height that it has
        left there: places `abaft` the stem and a `gap` off the hull [m]."""
        back = self.crest[1]
        aft = np.maximum(abaft - back, 0.0)
        width = self.breadth * NARROW + WIDER * aft + 0.25 * back
        left = np.exp(-aft / (LASTS[0] * self.length + LASTS[1] * self.speed**2 / GRAVITY))
        ahead = np.exp(-np.square(np.minimum(abaft - back, 0.0) / (back + self.breadth * NARROW)))
        return (gap - OUTWARD * aft) / width, left * ahead

    def height(self, abaft: np.ndarray, gap: np.ndarray) -> np.ndarray:
        """[m] of the wave at places abaft the stem and off the hull [m]: a steep face outside, and inside it the water
        falls to what it was."""
        off, left = self.across(abaft, gap)
        return self.crest[0] * left * np.exp(-np.square(np.where(off > 0.0, off, 0.6 * off)))

    def white(self, abaft: np.ndarray, gap: np.ndarray) -> np.ndarray:
        """Share of foam there: on the face of the crest, and thinner behind it."""
        off, left = self.across(abaft, gap)
        behind = np.exp(np.minimum(off, 0.0) * self.breadth * NARROW / (TRAILS * self.breadth) * 3.0)
        face = np.exp(-np.square(np.maximum(off, 0.0) / 0.8))
        return self.breaks * np.square(left) * np.where(off > 0.0, face, behind) * (gap > -1.0)

    def half_breadth(self, abaft: np.ndarray) -> np.ndarray:
        """[m] of a wedge that goes on as a wall."""
        return np.clip(self.wedge * abaft, 0.0, 0.5 * self.breadth)
