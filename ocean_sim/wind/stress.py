"""A physical wind: the stress rho C_d U10^2 (2.20), or one that was measured, on the plan area of the free surface, and
pressure on its waves.

The stress acts along the wind on the plan area of the surface; so momentum grows by stress times plan area,
whatever the resolution. Pressure on waves is Jeffreys's (1925, Proc. R. Soc. A 107): s rho_air (U10 - c)^2 times the
slope along the wind, higher on the windward side, which makes waves grow. In linear theory the energy of a wave of
frequency w grows at the rate P w / (rho c^2), P = s rho_air (U10 - c)^2.
"""

from collections.abc import Iterator
from functools import cached_property
from math import cos, hypot, pi, radians, sin
from typing import Literal

import numpy as np

from ocean_sim import waves
from ocean_sim.basin import Basin
from ocean_sim.columns import Columns
from ocean_sim.conventions import AIR_DENSITY, GRAVITY, WATER_DENSITY
from ocean_sim.kernel_library import ti, tm
from ocean_sim.model import Faults, quantity
from ocean_sim.parts import LedgerRow, SceneFacts, WindConfig
from ocean_sim.runtime import in_kernels
from ocean_sim.wind import DeviceRow, Drawing, Target, Wind
from ocean_sim.wind.shared.air_load import DRAG_LAWS, LAW, RANGES, DragLaw, drag, stated_speed, stress
from ocean_sim.wind.shared.schedule import Scheduled
from ocean_sim.wind.shared.warnings import ship_drag_warnings

ROW = Columns(
    stress_x=1,  # [Pa]
    stress_z=1,  # [Pa]
    pressure=1,  # [Pa] on the waves over their slope along the wind
    ahead_x=1,  # unit vector where the wind goes to
    ahead_z=1,
    speed=1,  # [m/s] U10
)
FLOW_SHEAR_RATIO = 6.0  # times the shear that particles bear: under less stress drift is over 15 % too slow at 20 s
MIN_WAVE_SPACINGS = 10.0  # spacings that a wave must be long to travel well
MAX_SLOPE = 1.0  # slope beyond which the pressure does not rise: the air has long parted from the surface


class Config(Scheduled, WindConfig):
    """The stress of a real wind on the surface, times `gain`."""

    kind: Literal["stress"] = "stress"
    u10: float | None = quantity("m/s", None, ge=0.0, le=200.0)
    """Wind speed 10 m above the water; by default 10, or the speed at which Wu's law gives the stress `tau`."""
    tau: float | None = quantity("Pa", None, ge=0.0)
    """The stress itself, as measured, in place of `u10`, `drag_law` and `schedule`. Drag on a ship and sheltering,
    which need a wind speed, then take the U10 at which Wu's law gives this stress."""
    heading_deg: float | None = quantity("deg", None)
    """Direction that the wind blows to: 0 along +z, 90 along +x; by default 0, in 2-D 90."""
    drag_law: DragLaw | None = None
    """Drag coefficient by wind speed: `wu` (1982, (2.21)), the default, `garratt` (1977) or `zijlema` (2012)."""
    gain: float = quantity("1", 1.0, ge=0.0)
    """Factor on stress and pressure: 1 is a real wind."""
    pressure_gain: float | None = quantity("1", None, ge=0.0)
    """Factor on the pressure on waves alone; by default that of `gain`. Where it is given, `gain` acts on the stress
    alone."""
    sheltering: float = quantity("1", 0.0, ge=0.0, le=1.0)
    """s of Jeffreys, who found 0.27: pressure on waves is s rho_air (U10 - c)^2 times their slope; 0: none."""
    wave_speed: float = quantity("m/s", 0.0)
    """c: speed of the crests that the sheltered wind is relative to, along the wind."""
    targets: list[Target] = ["fluid", "ship"]
    """Targets of the wind; on a ship it is the drag (2.22) of the wind relative to the hull, without the gain."""

    @property
    def needs_bend(self) -> bool:
        """True if the wind presses on the fluid's waves: `force` then reads `bend`, the slope's change with depth."""
        return self.needs_area and self.sheltering > 0.0

    @property
    def acts_on(self) -> list[Target]:
        return self.targets

    def blows(self, time: float, dimension: int) -> tuple[float, float]:
        """U10 [m/s], heading [deg] at a time [s] in a basin of this `dimension`; without the ramp of the stress."""
        if self.course is not None:
            return self.course.at(time)
        return self.speed, (90.0 if dimension == 2 else 0.0) if self.heading_deg is None else self.heading_deg

    @cached_property
    def speed(self) -> float:
        """U10 [m/s] of a wind without a schedule, as given by u10 or tau."""
        return stated_speed(self.u10, self.tau)

    @property
    def law(self) -> DragLaw:
        return self.drag_law or LAW

    @property
    def strongest(self) -> float:
        return self.speed if self.course is None else float(self.course.speed.max())

    def on_water(self, u10: float) -> float:
        """Stress on the water [Pa] by a wind speed u10 [m/s], with the factor `gain`."""
        return self.gain * stress(u10, self.law)

    @property
    def gain_of_pressure(self) -> float:
        """Factor on the pressure on waves: `pressure_gain`, or `gain` if that is not given."""
        return self.gain if self.pressure_gain is None else self.pressure_gain

    def sheltered(self, u10: float) -> float:
        """Pressure on waves [Pa] over their slope along a wind u10 [m/s] (Jeffreys 1925), times `gain_of_pressure`."""
        relative = u10 - self.wave_speed
        return self.gain_of_pressure * self.sheltering * AIR_DENSITY * relative * abs(relative)

    def problems(self, preflight: SceneFacts) -> Faults:
        basin = preflight.tank
        yield from self.schedule_faults()
        stated = {"u10": self.u10, "drag_law": self.drag_law, "schedule": self.schedule}
        others = [key for key, value in stated.items() if value is not None]
        if self.tau is not None and others:
            yield ("tau",), f"tau gives the stress that {' and '.join(others)} would; leave out one or the other (null)"
        if basin.closed:
            yield ("kind",), "a stress acts on a free surface; this basin has none"
        if self.schedule is None and basin.dimension == 2 and self.heading_deg is not None:
            if abs(cos(radians(self.heading_deg))) > 1e-9:
                flat = f"in 2-D the wind goes along +x (heading 90 degrees) or -x (270), got {self.heading_deg:g}"
                yield ("heading_deg",), flat

    def build(self, basin: Basin, seed: int) -> Wind:
        return Stress(self, basin)

    def ledger(self, preflight: SceneFacts) -> list[LedgerRow]:
        return [LedgerRow("wind", "stress, pressure and direction", 6 * preflight.word, "wind.kind is stress")]

    def warnings(self, preflight: SceneFacts) -> Iterator[str]:
        u10 = self.strongest
        sheltered = f", pressure on waves {self.sheltered(u10):.3g} Pa times their slope" if self.sheltering else ""
        gain = "a real wind (gain 1)" if self.gain == 1.0 else f"{self.gain:g} times a real wind (gain)"
        if self.sheltering and self.pressure_gain is not None:
            gain += f", its pressure {self.pressure_gain:g} times (pressure_gain)"
        at = f"at U10 = {u10:g} m/s by {self.law}" if self.tau is None else f"by tau, U10 = {u10:.3g} m/s by {self.law}"
        yield f"wind: a physical stress of {self.on_water(u10):.3g} Pa {at}{sheltered}: {gain}"
        yield from (f"wind: {sentence}" for sentence in self.end_warnings(preflight.duration))
        if self.course is not None and preflight.tank.dimension == 2:
            for row in np.flatnonzero(np.abs(np.cos(np.radians(self.course.heading))) > 1e-9)[:1]:
                blows = f"row {row + 1} of the schedule blows to {self.course.heading[row] % 360.0:g} degrees"
                yield f"wind: {blows}: in 2-D only its part along x acts"
        if "ship" in self.targets and u10 > 0.0:
            yield from ship_drag_warnings(preflight)
        yield from out_of_range(u10, self.law)
        yield from unresolved(self, u10, preflight)


def out_of_range(u10: float, law: DragLaw) -> Iterator[str]:
    """Warn of a wind u10 [m/s] outside the range of a drag law, with the coefficients of the other laws."""
    low, high = RANGES[law]
    if u10 != 0.0 and not low <= u10 <= high:
        others = ", ".join(f"{name} {1e3 * coefficient(u10):.2f}" for name, coefficient in DRAG_LAWS.items())
        outside = f"outside the range of {law} ({low:g} to {high:g} m/s)"
        yield f"wind: U10 = {u10:g} m/s is {outside}; 1000 C_d there is {others}"


def fetch_limited(u10: float, fetch: float, gravity: float = GRAVITY) -> tuple[float, float]:
    """Significant wave height [m] and peak period [s] that a wind u10 [m/s] raises over a fetch [m] of deep water, by
    Kahma & Calkoen (1992, J. Phys. Oceanogr. 22), composite, limited to those of Pierson & Moskowitz (1964)."""
    x = gravity * fetch / u10**2
    energy = min(5.2e-7 * x**0.9, 3.64e-3)
    omega = max(13.7 * x**-0.27, 2.0 * pi * 0.133)
    return 4.0 * energy**0.5 * u10**2 / gravity, 2.0 * pi * u10 / (gravity * omega)


def plant(u10: float, k: float, gravity: float = GRAVITY) -> float:
    """Growth rate of energy [1/s] of deep-water waves of wavenumber k [1/m] in a real wind u10 [m/s], by Plant (1982,
    J. Geophys. Res. 87): 0.04 (u*/c)^2 w, accurate to 50 %."""
    omega = (gravity * k) ** 0.5
    return 0.04 * stress(u10) / AIR_DENSITY * (k / omega) ** 2 * omega


def growth_rate(wind: Config, u10: float, k: float, depth: float, pull: float) -> float:
    """Growth rate of energy [1/s] of waves of wavenumber k [1/m] at a `depth` [m] in the scene's wind of `u10` [m/s]
    under gravity `pull` [m/s2]: by its pressure on waves if it has one, else by Plant's law (`plant`) times gain."""
    if wind.sheltering:
        return wind.sheltered(u10) * k * float(waves.angular_frequency(k, depth, pull)) / (WATER_DENSITY * pull)
    return wind.gain * plant(u10, k, pull)


def overdamped(wind: Config, u10: float, k: float, preflight: SceneFacts) -> Iterator[str]:
    """Warn if viscosity damps waves of wavenumber k [1/m] faster than the scene's wind, u10 [m/s], makes them grow."""
    fluid, pull, length = preflight.fluid, hypot(*preflight.tank.gravity), 2.0 * pi / k
    beta = growth_rate(wind, u10, k, preflight.tank.depth, pull)
    own, added = fluid.viscosity_asked, fluid.viscosity_added(preflight, length)
    lost = 4.0 * (own + added) * k**2
    if lost <= beta:
        return
    key, gain = "gain", wind.gain
    if wind.sheltering and wind.pressure_gain is not None:
        key, gain = "pressure_gain", wind.gain_of_pressure
    needed = f"; a {key} of {gain * lost / beta:.2g} would balance it" if beta > 0.0 else ""
    begin = f"wind: damping exceeds growth: waves of {length:.3g} m grow at {beta:.2g} /s, and 4 nu k^2 is {lost:.2g}"
    yield f"{begin} /s, of a viscosity of {own:g} m2/s and {added:.2g} that {fluid.kind} adds, as measured{needed}"


def unresolved(wind: Config, u10: float, preflight: SceneFacts) -> Iterator[str]:
    """Warn if the water cannot show waves of a wind u10 [m/s]: too coarse, too viscous, or in too short a basin."""
    basin, pull, spacing = preflight.tank, hypot(*preflight.tank.gravity), preflight.spacing
    if u10 <= 0.0 or pull <= 0.0 or spacing is None:
        return
    fetch = max(basin.config.length, basin.config.width or 0.0)
    height, period = fetch_limited(u10, fetch, pull)
    k = float(waves.wavenumber(2.0 * pi / period, basin.depth, pull))
    length = 2.0 * pi / k
    real = f"over {fetch:g} m a real wind of {u10:g} m/s makes waves {length:.2g} m long and {height:.2g} m high"
    if length < MIN_WAVE_SPACINGS * spacing:
        short = f"shorter than {MIN_WAVE_SPACINGS:g} spacings of {spacing:g} m, unresolved"
        yield f"wind: {real} (Kahma & Calkoen 1992): {short}"
    if fetch < 2.0 * length:
        yield f"wind: {real}: the basin is shorter than two of them"
    seen = 2.0 * pi / max(length, MIN_WAVE_SPACINGS * spacing)
    most, nu = plant(u10, seen, pull) / (4.0 * seen**2), preflight.fluid.viscosity_asked
    if nu > most:
        opening = f"wind: the viscosity of {nu:g} m2/s is more than the {most:.2g} m2/s under which"
        told = f"a real wind of {u10:g} m/s makes waves of {2.0 * pi / seen:.3g} m grow (Plant 1982);"
        yield f"{opening} {told} the scheme adds viscosity of its own (ocean-sim validate wind_growth)"
    yield from overdamped(wind, u10, seen, preflight)
    yield from rigid_layer_warnings(wind.on_water(u10), preflight)


def rigid_layer_warnings(stress: float, preflight: SceneFacts) -> Iterator[str]:
    """Warn if particles whose rows (lattice) are broken up would bear a stress [Pa] like a solid instead of flowing."""
    fluid, tank = preflight.fluid, preflight.tank
    pressure, share = fluid.rest_density * hypot(*tank.gravity) * tank.depth, fluid.bears_shear
    if 0.0 < stress < FLOW_SHEAR_RATIO * share * pressure:
        opening = f"wind: the stress of {stress:.2g} Pa is {stress / pressure:.1e} of the pressure at the bed,"
        told = f"and particles of {fluid.kind} that have lost their rows bear about {share:.0e} of it:"
        yield f"{opening} {told} after some seconds the drift is too slow, or stops (ocean-sim validate wind_setup)"


@in_kernels
class Stress(Wind):
    """Wind as a stress on the water, and as drag on ships."""

    config: Config

    def __init__(self, config: Config, basin: Basin, afloat: bool = False) -> None:
        """`afloat`: True for the instance that gives the drag on ships."""
        super().__init__(config)
        self.basin, self.dimension, self.afloat, self.time = basin, basin.dimension, afloat, 0.0
        self.sheltering = config.sheltering > 0.0
        self.row = DeviceRow(ROW.size)
        self.steady = config.always and config.schedule is None
        self.ship = None if afloat or "ship" not in config.targets else Stress(config, basin, afloat=True)
        self._set_strength(0.0)

    def on(self, target: Target) -> Wind:
        return self.ship if target == "ship" and self.ship is not None else super().on(target)

    def advance(self, dt: float) -> None:
        """Set the wind's stress and speed for a step of dt [s], by its schedule in the middle of the step."""
        if not self.steady:
            self._set_strength(dt)
        self.time += dt
        if self.ship is not None:
            self.ship.advance(dt)

    def strengthen(self, factor: float) -> None:
        super().strengthen(factor)
        self._set_strength(0.0)
        if self.ship is not None:
            self.ship.strengthen(factor)

    def _set_strength(self, dt: float) -> None:
        """Write to the device the stress, pressure, direction and speed of the step of dt [s] that begins now."""
        u10, heading = self.config.blows(self.time + 0.5 * dt, self.dimension)
        u10 *= self.gain
        part = self.config.blowing(self.time, dt)
        ahead = sin(radians(heading)), 0.0 if self.dimension == 2 else cos(radians(heading))
        along = part * self.config.on_water(u10)
        numbers = along * ahead[0], along * ahead[1], part * self.config.sheltered(u10), *ahead, part * u10
        for column, number in enumerate(numbers):
            self.row.set(column, number)
        self.real_velocity = part * u10 * ahead[0], part * u10 * ahead[1]

    def drawing(self) -> Drawing:
        """Arrows of the wind on a 4 x 4 grid over the water; length 1 is the greatest U10 of the scene."""
        x, z = (np.linspace(0.7 * self.basin.lower[k], 0.7 * self.basin.upper[k], 4) for k in (0, 2))
        x, z = (a.ravel() for a in np.meshgrid(x, z))
        u10, heading = self.config.blows(self.time, self.dimension)
        push = np.array([sin(radians(heading)), 0.0, cos(radians(heading))])
        strongest = self.config.strongest
        push *= self.gain * self.config.blowing(self.time) * u10 / (strongest or 1.0)
        tails, arrows = np.stack([x, 0.0 * x, z], axis=1), np.tile(push, (len(x), 1))
        return Drawing(np.zeros((0, 2, 3)), tails, arrows, strongest, "m/s")

    @property
    def stress(self) -> float:
        """Present stress on the water [Pa]."""
        return hypot(self.row.values[ROW.stress_x], self.row.values[ROW.stress_z])

    @ti.func
    def force(self, key, position, velocity, area, bend, mass):
        """Force [N]. On a particle: stress on plan area, and pressure on the surface's slope, by exposed `area` (3,)
        [m2] and `bend` (curvature times depth of exposed areas: `Wind.force`). On a voxel of a hull: drag (thesis
        2.22), by `area` and `velocity` [m/s]. `key`, `position` and `mass` are not used."""
        row = ti.static(self.row.field)
        total = tm.vec3(0.0)
        if ti.static(self.afloat):
            wind = row[ROW.speed] * tm.vec3(row[ROW.ahead_x], 0.0, row[ROW.ahead_z])
            total = drag(wind - velocity, area.norm())
        else:
            total = area.y * tm.vec3(row[ROW.stress_x], 0.0, row[ROW.stress_z])
            if ti.static(self.sheltering):
                if area.y > 0.0:
                    slope = -(area.x * row[ROW.ahead_x] + area.z * row[ROW.ahead_z]) / area.y
                    total -= row[ROW.pressure] * tm.clamp(slope, -MAX_SLOPE, MAX_SLOPE) * area
                    steeper_x = bend.x * row[ROW.ahead_x] + bend.y * row[ROW.ahead_z]
                    steeper_z = bend.y * row[ROW.ahead_x] + bend.z * row[ROW.ahead_z]
                    total -= row[ROW.pressure] * area.y * tm.vec3(steeper_x, 0.0, steeper_z)
        return total
