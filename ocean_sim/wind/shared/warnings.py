"""Warnings about a wind: how much stronger than a real one it is, and what it will do to the water."""

from math import hypot, isinf, pi
from typing import Protocol

from ocean_sim import waves
from ocean_sim.conventions import AIR_DENSITY, GRAVITY, WATER_DENSITY, figures
from ocean_sim.model import Vector3
from ocean_sim.parts import Preflight, called
from ocean_sim.wind.shared.air_load import DRAG_LAWS, RANGES, U10, DragLaw, stress

FLOWING = 5.0  # times the shear that particles bear: under less of a stress the drift is more than a tenth too slow
TIMES = "15 to 70"  # between the two, of the yacht, the tug and the barge in a wind of 15 m/s from ahead and abeam
FEWEST = 10.0  # spacings that a wave must be long to travel well


class PhysicalWind(Protocol):
    """A wind that is a stress, as its effect on waves needs it."""

    gain: float
    pressure_gain: float | None
    sheltering: float

    def on_water(self, u10: float) -> float:
        """Stress on the water [Pa], its gain included."""
        ...

    @property
    def gain_of_pressure(self) -> float:
        """The factor on the pressure on waves that is at work."""
        ...

    def sheltered(self, u10: float) -> float:
        """Pressure on the waves over their slope along the wind [Pa], its gain included."""
        ...


def layer(preflight: Preflight) -> float:
    """Thickness of one layer of particles [m]; 1 where the water has none."""
    return preflight.spacing or 1.0


def stylised(name: str, acceleration: float, preflight: Preflight) -> str:
    """How a force field of this size [m/s2] compares with the stress of a wind on one layer of particles."""
    thick = layer(preflight)
    real = stress(U10) / (preflight.fluid.rest_density * thick)
    return (
        f"{name}: a stylised force field, not a physical stress: {acceleration:.3g} m/s2 is "
        f"{figures(acceleration / real, 2)} times what a wind of {U10:g} m/s does to a layer of {thick:g} m"
    )


def velocity_change(name: str, acceleration: Vector3, passing_time: float, preflight: Preflight) -> list[str]:
    """What one passage does to a particle, and whether that throws the water out of the basin."""
    if isinf(passing_time):
        return [f"{name}: does not drift: it keeps accelerating what it holds by {hypot(*acceleration):.3g} m/s2"]
    along, up = hypot(acceleration[0], acceleration[2]) * passing_time, acceleration[1] * passing_time
    speed, g, depth = hypot(along, up), hypot(*preflight.tank.gravity), preflight.tank.depth
    sentences = [f"{name}: one passage changes the velocity by {speed:.2g} m/s ({along:.2g} along, {up:.2g} up)"]
    if speed**2 > 2.0 * g * depth:
        height = f"{speed**2 / (2.0 * g):.1f} m high, above the depth of {depth:g} m" if g else "away, without gravity"
        sentences.append(f"{name}: throws the water {height}: not a sea; make it weaker, thinner or faster")
    return sentences


def out_of_range(u10: float, law: DragLaw) -> list[str]:
    """Whether a drag law is asked for a wind that it was not made for, and what the others say."""
    low, high = RANGES[law]
    if u10 == 0.0 or low <= u10 <= high:
        return []
    others = ", ".join(f"{name} {1e3 * coefficient(u10):.2f}" for name, coefficient in DRAG_LAWS.items())
    return [
        f"wind: U10 = {u10:g} m/s is outside the range of {law} ({low:g} to {high:g} m/s); 1000 C_d there is {others}"
    ]


def on_ships(preflight: Preflight) -> list[str]:
    """How far the drag (2.22) on a hull lies from that of a real ship."""
    afloat = [called(name) for name, ship in preflight.ships.items() if ship.look(preflight) is not None]
    if not afloat:
        return []
    law = f"wind: its drag on {' and '.join(afloat)} is that of the sea's surface, on all of the hull that is dry"
    real = "a real ship has a coefficient of about 0.9 on the area that she turns to the wind (Blendermann 1994)"
    return [f"{law}; {real}, {TIMES} times as much: she drifts and heels too little"]


def fetch_limited(u10: float, fetch: float, gravity: float = GRAVITY) -> tuple[float, float]:
    """Significant wave height [m] and peak period [s] that a wind makes over a fetch [m] of deep water: Kahma &
    Calkoen (1992, J. Phys. Oceanogr. 22), composite, no higher than Pierson & Moskowitz (1964)."""
    x = gravity * fetch / u10**2
    energy = min(5.2e-7 * x**0.9, 3.64e-3)
    omega = max(13.7 * x**-0.27, 2.0 * pi * 0.133)
    return 4.0 * energy**0.5 * u10**2 / gravity, 2.0 * pi * u10 / (gravity * omega)


def plant(u10: float, k: float, gravity: float = GRAVITY) -> float:
    """Rate [1/s] at which a real wind feeds energy into deep-water waves of wavenumber k [1/m]: 0.04 (u*/c)^2 w, right
    to a half (Plant 1982, J. Geophys. Res. 87)."""
    omega = (gravity * k) ** 0.5
    return 0.04 * stress(u10) / AIR_DENSITY * (k / omega) ** 2 * omega


def growth_rate(wind: PhysicalWind, u10: float, k: float, depth: float, pull: float) -> float:
    """Rate [1/s] at which the wind of a scene feeds energy into waves of wavenumber k [1/m]: by its pressure on them
    where it has one, or else what Plant found, times its gain."""
    if wind.sheltering:
        return wind.sheltered(u10) * k * float(waves.angular_frequency(k, depth, pull)) / (WATER_DENSITY * pull)
    return wind.gain * plant(u10, k, pull)


def overdamped(wind: PhysicalWind, u10: float, k: float, preflight: Preflight) -> list[str]:
    """Whether viscosity damps waves of wavenumber k [1/m] faster than the wind of the scene makes them grow."""
    fluid, pull, length = preflight.fluid, hypot(*preflight.tank.gravity), 2.0 * pi / k
    beta = growth_rate(wind, u10, k, preflight.tank.depth, pull)
    own, added = fluid.viscosity_asked, fluid.viscosity_added(preflight, length)
    lost = 4.0 * (own + added) * k**2
    if lost <= beta:
        return []
    key, gain = "gain", wind.gain
    if wind.sheltering and wind.pressure_gain is not None:
        key, gain = "pressure_gain", wind.gain_of_pressure
    needed = f"; a {key} of {gain * lost / beta:.2g} would balance it" if beta > 0.0 else ""
    return [
        f"wind: damping exceeds growth: waves of {length:.3g} m grow at {beta:.2g} /s, and 4 nu k^2 is {lost:.2g} /s, "
        f"of a viscosity of {own:g} m2/s and {added:.2g} that {fluid.kind} adds, as measured{needed}"
    ]


def unresolved(wind: PhysicalWind, u10: float, preflight: Preflight) -> list[str]:
    """What keeps this water from showing the waves of a real wind: particles too coarse, water too viscous, a basin too
    short."""
    basin, pull, spacing = preflight.tank, hypot(*preflight.tank.gravity), preflight.spacing
    if u10 <= 0.0 or pull <= 0.0 or spacing is None:
        return []
    fetch = max(basin.config.length, basin.config.width or 0.0)
    height, period = fetch_limited(u10, fetch, pull)
    k = float(waves.wavenumber(2.0 * pi / period, basin.depth, pull))
    length, sentences = 2.0 * pi / k, []
    real = f"over {fetch:g} m a real wind of {u10:g} m/s makes waves {length:.2g} m long and {height:.2g} m high"
    if length < FEWEST * spacing:
        sentences.append(
            f"wind: {real} (Kahma & Calkoen 1992): shorter than {FEWEST:g} spacings of {spacing:g} m, unresolved"
        )
    if fetch < 2.0 * length:
        sentences.append(f"wind: {real}: the basin is shorter than two of them")
    seen = 2.0 * pi / max(length, FEWEST * spacing)
    most, nu = plant(u10, seen, pull) / (4.0 * seen**2), preflight.fluid.viscosity_asked
    if nu > most:
        sentences.append(
            f"wind: the viscosity of {nu:g} m2/s is more than the {most:.2g} m2/s under which a real wind of {u10:g} "
            f"m/s makes waves of {2.0 * pi / seen:.3g} m grow (Plant 1982); the scheme adds viscosity of its own "
            "(ocean-sim validate wind_growth)"
        )
    return sentences + overdamped(wind, u10, seen, preflight) + borne(wind.on_water(u10), preflight)


def borne(stress: float, preflight: Preflight) -> list[str]:
    """Whether particles that have lost their rows would bear a stress [Pa] rather than flow."""
    fluid, tank = preflight.fluid, preflight.tank
    pressure, share = fluid.rest_density * hypot(*tank.gravity) * tank.depth, fluid.bears_shear
    if not 0.0 < stress < FLOWING * share * pressure:
        return []
    return [
        f"wind: the stress of {stress:.2g} Pa is {stress / pressure:.1e} of the pressure at the bed, and particles of "
        f"{fluid.kind} that have lost their rows bear about {share:.0e} of it: after some seconds the drift is too "
        "slow, or stops (ocean-sim validate wind_setup)"
    ]
