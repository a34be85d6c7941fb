"""An emitter: a mouth from which water flows at a given rate and velocity until there are as many particles as its cap.

Particles leave in layers across the mouth, whose area is rate over speed: the first at time 0, then one in the time in
which the rate fills it. Particles that left between two steps are on their parabola at the end of the step, so neither
their number nor, until they meet others, their place depends on the time step.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ocean_sim.basin import Basin, axes_beyond
from ocean_sim.basin.points import in_space
from ocean_sim.model import Faults, Model, Point, quantity

MOST_PARTICLES = 2**26  # their neighbours are counted in 32 bits
LAYER_ROUNDING = 1e-9  # [layers] rounding of the time
PLACE_ROUNDING = 1e-6  # [spacings] rounding of a place


class Emitter(Model):
    """An inflow: a mouth from which water flows, in a basin that is empty but for `fill`."""

    position: Point = quantity("m")
    """Middle of the mouth; in 2-D [x, y]."""
    velocity: Point = quantity("m/s")
    """Velocity of the water that leaves, at right angles to the mouth; in 2-D [u, v]."""
    rate: float = quantity("m3/s", gt=0.0)
    """Volume of water that leaves per second; in 2-D area, m2/s."""
    cap: int = quantity("particles", ge=1, le=MOST_PARTICLES)
    """Largest number of particles in all, those of `fill` included; then the inflow stops."""

    def problems(self, basin: Basin) -> Faults:
        """Yield faults (key, sentence) of these keys that show before the lattice is made."""
        for key in ("position", "velocity"):
            numbers = getattr(self, key)
            if len(numbers) != basin.dimension and (basin.dimension == 3 or numbers[2] != 0.0):
                yield (key,), f"a point of this basin has {basin.dimension} numbers, got {len(numbers)}"
        if not any(self.velocity):
            yield ("velocity",), "must not be zero: the water leaves the emitter with it"


@dataclass(frozen=True)
class Jet:
    """Geometry and schedule of the layers of particles that leave an emitter."""

    config: Emitter
    dimension: int
    spacing: float  # [m]
    volume: float  # of a particle [m3]; in 2-D [m2]
    first: int  # number of the first particle that leaves it

    @property
    def velocity(self) -> np.ndarray:
        """Velocity (3,) of the water that leaves [m/s]."""
        return in_space(self.config.velocity)

    @property
    def area(self) -> float:
        """Area of the mouth [m2]; in 2-D its width [m]."""
        return self.config.rate / float(np.linalg.norm(self.velocity))

    @cached_property
    def sites(self) -> np.ndarray:
        """Positions (k, 3) [m] of the particles in one layer: a square lattice around the middle of the mouth."""
        ahead = self.velocity / np.linalg.norm(self.velocity)
        apart = self.spacing ** (self.dimension - 1)
        k = max(1, round(self.area / apart))
        middle = in_space(self.config.position)
        if self.dimension == 2:
            across = np.array([-ahead[1], ahead[0], 0.0])
            return middle + self.area / k * (np.arange(k) - 0.5 * (k - 1))[:, None] * across
        across = np.cross(ahead, np.eye(3)[np.argmin(np.abs(ahead))])
        across /= np.linalg.norm(across)
        reach = np.arange(-int(k**0.5) - 2, int(k**0.5) + 3, dtype=float)
        layers = []
        for shift in ((0.0, 0.0), (0.5, 0.5), (0.5, 0.0)):
            a, b = (part.ravel() for part in np.meshgrid(reach + shift[0], reach + shift[1], indexing="ij"))
            nearest = np.argsort((a * a + b * b).round(9), kind="stable")[:k]
            flat = np.stack([a[nearest], b[nearest]], axis=1)
            layers.append(flat - flat.mean(axis=0))
        flat = min(layers, key=lambda layer: float((layer**2).sum().round(9))) * (self.area / k) ** 0.5
        return middle + flat[:, :1] * across + flat[:, 1:] * np.cross(ahead, across)

    @property
    def interval(self) -> float:
        """Time between two layers [s]."""
        return len(self.sites) * self.volume / self.config.rate

    def particle_count(self, time: float) -> int:
        """Number of particles in the basin at a time [s], those of `fill` included, and at most the cap."""
        layers = int(time / self.interval + LAYER_ROUNDING) + 1
        return min(self.config.cap, self.first + layers * len(self.sites))

    def emitted_state(self, first: int, last: int, time: float, pull: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Positions (n, 3) [m], velocities of particles `first` to `last` - 1 at a time, falling by `pull` [m/s2]."""
        layer, site = np.divmod(np.arange(first, last) - self.first, len(self.sites))
        age = np.maximum(time - layer * self.interval, 0.0)[:, None]
        return self.sites[site] + age * self.velocity + 0.5 * age**2 * pull, self.velocity + age * pull


def problems(basin: Basin, jet: Jet) -> Faults:
    """Yield faults (path below `fluid.emitter`, sentence) of an emitter that its `jet` shows: of cap and mouth."""
    config = jet.config
    if config.cap <= jet.first:
        yield ("cap",), f"{config.cap} particles in all, but `fill` makes {jet.first}: nothing would be left to emit"
    if basin.closed and config.cap * jet.volume > basin.volume * (1.0 + 1e-9):
        most = int(basin.volume / jet.volume + 1e-9)
        yield ("cap",), f"{config.cap} particles are more water than this closed basin holds: at most {most}"
    if out := axes_beyond(jet.sites.min(axis=0).tolist(), jet.sites.max(axis=0).tolist(), basin):
        area = f"{jet.area:.3g} {'m2' if jet.dimension == 3 else 'm'}"
        yield ("position",), f"the mouth, {area}, reaches out of the basin along {' and '.join(out)}"
        return
    behind = jet.sites - jet.spacing * jet.velocity / np.linalg.norm(jet.velocity)
    for side in basin.sides:
        beyond = float(((behind[:, side.axis] - side.position) * (1.0 if side.upper else -1.0)).max())
        if beyond > PLACE_ROUNDING * jet.spacing:
            near = f"the mouth is too near {side.name}, the wall behind it, whose mirror image pushes what leaves"
            free = f"a spacing, {jet.spacing:g} m, must be free; move it {beyond:.3g} m further in"
            yield ("position",), f"{near}: {free}"
