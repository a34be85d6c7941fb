"""The zones before absorbing sides: how long, how strong and towards what motion, from the waves that a scene has."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import inf, pi

from ocean_sim import waves
from ocean_sim.basin import Basin, Side
from ocean_sim.fluid.sph.initial_state import Initial, borne, fitted
from ocean_sim.fluid.sph.lattice import Lattice
from ocean_sim.fluid.sph.water_keys import free_fall_speed
from ocean_sim.waves.absorption import damping_rate, reflected

REGULAR, RANDOM = 1.0, 2.0  # [wavelengths] of a zone
MOST = 0.5  # of the basin that the zones along an axis take
SHORT = 0.5  # [wavelengths] a zone that is shorter sends most back
FEWEST = 4.0  # spacings that a wave of a target must be long to be there
UNKNOWN_PART, UNKNOWN_RATE = 0.25, 2.5  # of the basin, [sqrt(|g| / depth)]: zones for waves that nobody named


@dataclass(frozen=True)
class Zone:
    """Water that is relaxed towards a motion, the faster the nearer to its side."""

    side: str
    axis: int
    begin: float  # [m] along the axis
    end: float  # [m] where the side is
    rate: float  # [1/s]
    size: float  # [m] of the basin
    coming: waves.Components | None  # the waves that it is for
    current: tuple[float, float, float]  # [m/s] of the target
    given: waves.Components | None  # the waves of the target

    @property
    def length(self) -> float:
        """[m]"""
        return abs(self.end - self.begin)

    @property
    def wavelength(self) -> float:
        """Of the highest of the waves [m]."""
        return inf if self.coming is None else self.coming.wavelength

    @cached_property
    def sent_back(self) -> tuple[float, float]:
        """Height over that of the waves of what comes back, by linear theory: of the highest, and of all of them."""
        assert self.coming is not None
        return reflected(self.coming, self.length, self.rate)

    @property
    def statement(self) -> str:
        """What it is, in numbers."""
        what = f"absorbing side {self.side}: a zone of {self.length:.3g} m, "
        rate = f"rate {self.rate:.3g} 1/s at the side"
        aim = "" if not any(self.current) else f"; towards a current of {list(self.current)} m/s"
        if self.given is not None:
            aim += f"{';' if not aim else ' and'} towards waves of {self.given.wavelength:.4g} m"
        if self.coming is None:
            return f"{what}{rate}; the scene names no waves to choose them for{aim}"
        peak, whole = self.sent_back
        back = f"by linear theory it sends back {peak:.2%} of the height of waves of {self.coming.period:.3g} s"
        band = f", {whole:.2%} of the whole sea" if self.coming.random else ""
        many = f"{self.length / self.wavelength:.3g} times the wavelength of {self.wavelength:.3g} m"
        return f"{what}{many}, {rate}; {back}{band}{aim}"

    @property
    def warning(self) -> str | None:
        """Why it absorbs badly."""
        if self.coming is None or self.length >= SHORT * self.wavelength:
            return None
        peak, _ = self.sent_back
        return (
            f"the zone before absorbing side {self.side} is {self.length:.3g} m long, less than half the wavelength of "
            f"{self.wavelength:.3g} m: it sends back {peak:.0%} of the height of waves, one wavelength about 1 %"
        )


def coming(basin: Basin, initial: Initial | None) -> waves.Components | None:
    """The waves of a scene: of its wavemaker, of its initial state, or of the period at which its tank moves."""
    if any(waves.unsuited(basin)):
        return None
    if basin.piston is not None:
        return basin.piston.sea
    began = None if initial is None else initial.sea(basin)
    return began or basin.swung


def zones(lattice: Lattice) -> tuple[Zone, ...]:
    """Of each absorbing side of the water on a lattice, in the order of the sides."""
    basin = lattice.basin
    absorbing = [side for side in basin.sides if side.absorbing is not None]
    of_scene = coming(basin, lattice.config.initial) if absorbing else None
    return tuple(zone(side, basin, of_scene, absorbing, lattice.spacing) for side in absorbing)


def zone(side: Side, basin: Basin, of_scene: waves.Components | None, absorbing: list[Side], spacing: float) -> Zone:
    """The zone before a side; a sea that it is to let pass comes before those of the scene."""
    asked, axis = side.absorbing, side.axis
    assert asked is not None
    target, given = asked.target, None
    if target is not None and target.waves is not None:
        given = target.waves.sea(basin)
        if target.waves.spectrum is not None:
            given = borne(given, target.waves.spectrum.significant_wave_height, FEWEST * spacing)
        given = fitted(given, basin)
    sea, size = given or of_scene, basin.upper[axis] - basin.lower[axis]
    length, rate = UNKNOWN_PART * size, UNKNOWN_RATE * free_fall_speed(basin) / basin.depth
    if sea is not None:
        k = float(sea.wavenumber[sea.highest])
        wanted = (RANDOM if sea.random else REGULAR) * 2.0 * pi / k
        length = asked.length or min(wanted, MOST * size / sum(other.axis == axis for other in absorbing))
        rate = damping_rate(k, sea.depth, sea.gravity, length)
    length, rate = asked.length or length, asked.rate or rate
    begin = side.position - length if side.upper else side.position + length
    current = (0.0, 0.0, 0.0) if target is None else target.current
    return Zone(side.name, axis, begin, side.position, rate, size, sea, current, given)


def warnings(found: tuple[Zone, ...]) -> Iterator[str]:
    """What is wrong with zones but possible."""
    for one in found:
        if one.warning is not None:
            yield one.warning
    for axis in sorted({one.axis for one in found}):
        along = [one for one in found if one.axis == axis]
        part = sum(one.length for one in along) / along[0].size
        if part > MOST + 1e-9:
            names = " and ".join(one.side for one in along)
            yield f"the zones before absorbing sides ({names}) take {part:.0%} of the basin along {'xyz'[axis]}"
