"""The basin: its size, walls and floor; three-dimensional, or a vertical slice in x-y where no width is given."""

from dataclasses import dataclass
from typing import Literal

from ocean_sim.conventions import GRAVITY
from ocean_sim.parts import PartConfig, Vector3, quantity

OPEN = 1.0e30  # [m] where a side that is open would stand

Wall = Literal["none", "reflecting"]


class Walls(PartConfig):
    """One kind of wall a side; `x` stands for both `x_min` and `x_max`, `z` likewise."""

    x: Wall = "reflecting"
    z: Wall = "reflecting"
    x_min: Wall | None = None
    x_max: Wall | None = None
    z_min: Wall | None = None
    z_max: Wall | None = None

    def at(self, side: str) -> Wall:
        """The kind of wall at `x_min`, `x_max`, `z_min` or `z_max`."""
        return getattr(self, side) or getattr(self, side[0])


class Config(PartConfig):
    """Size and sides of the basin; the origin is the centre of the still surface, y points up."""

    length: float = quantity("m", gt=0.0)
    """Length along x."""
    width: float | None = quantity("m", None, gt=0.0)
    """Width along z; none: a vertical slice in x-y."""
    depth: float = quantity("m", gt=0.0)
    """Depth of the still water."""
    gravity: Vector3 = quantity("m/s2", (0.0, -GRAVITY, 0.0))
    """Acceleration of gravity."""
    walls: Wall | Walls = "reflecting"
    """`reflecting` (free slip) or `none`, for all sides or per side; walls rise without limit."""
    floor: Literal["free_slip", "none"] = "free_slip"
    """The bed."""
    restitution: float = quantity("1", 0.0, ge=0.0, le=1.0)
    """Share of the normal speed that a particle keeps when it meets a wall or the floor."""
    friction: float = quantity("1", 0.0, ge=0.0)
    """Coulomb friction at walls and floor: tangential over normal impulse, at most."""

    def build(self) -> "Basin":
        return Basin(self)


@dataclass(frozen=True)
class Basin:
    """The box of water, in plain numbers."""

    config: Config

    @property
    def dimension(self) -> int:
        return 2 if self.config.width is None else 3

    @property
    def depth(self) -> float:
        return self.config.depth

    @property
    def gravity(self) -> tuple[float, float, float]:
        return self.config.gravity

    @property
    def lower(self) -> tuple[float, float, float]:
        """Lowest corner [m]: the bed; z is 0 in a slice."""
        return (-self.config.length / 2, -self.config.depth, -(self.config.width or 0.0) / 2)

    @property
    def upper(self) -> tuple[float, float, float]:
        """Highest corner [m], as far above the still surface as the bed lies below it; nothing ends there."""
        return (self.config.length / 2, self.config.depth, (self.config.width or 0.0) / 2)

    @property
    def volume(self) -> float:
        """Volume of the still water [m3]; in a slice its area [m2]."""
        return self.config.length * self.config.depth * (self.config.width or 1.0)

    def stops(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Where walls and floor stand on each axis [m], lower and upper; OPEN where there is none."""
        walls = (
            self.config.walls
            if isinstance(self.config.walls, Walls)
            else Walls(x=self.config.walls, z=self.config.walls)
        )

        def stand(side: str, place: float, away: float) -> float:
            return away if walls.at(side) == "none" or (side[0] == "z" and self.dimension == 2) else place

        low = (
            stand("x_min", self.lower[0], -OPEN),
            self.lower[1] if self.config.floor != "none" else -OPEN,
            stand("z_min", self.lower[2], -OPEN),
        )
        up = (stand("x_max", self.upper[0], OPEN), OPEN, stand("z_max", self.upper[2], OPEN))
        return low, up
