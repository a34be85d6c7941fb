"""Load of moving air on a piece of surface: the thesis's (2.20) to (2.23).

(2.20) is a stress, rho C_d U^2 with C_d of the sea surface (Wu 1982, J. Geophys. Res. 87), without the half of (2.22).
The coefficient was measured in that form, so drag has no half here; lift, whose coefficient is ours, keeps it.
Wind is taken relative to the surface, where section 2.3 takes wind speed alone.
"""

from typing import Literal

from ocean_sim.conventions import AIR_DENSITY
from ocean_sim.kernel_library import ti, tm

DragLaw = Literal["wu", "garratt", "zijlema"]

LAW: DragLaw = "wu"  # where a scene leaves it open
U10 = 10.0  # [m/s] of a wind whose speed is left open, and of the real wind that force fields are compared with


def drag_coefficient(u10):
    """Wu's drag coefficient of the sea at a 10 m wind speed u10 [m/s] (thesis 2.21); its branches meet at 7.5 m/s."""
    return max(1.2875e-3, (0.8 + 0.065 * u10) * 1e-3)


def garratt(u10: float) -> float:
    """Drag coefficient of Garratt (1977, Mon. Weather Rev. 105) at 10 m wind speed u10 [m/s]."""
    return (0.75 + 0.067 * u10) * 1e-3


def zijlema(u10: float) -> float:
    """Drag coefficient of Zijlema, van Vledder & Holthuijsen (2012, Coastal Engineering 65) at 10 m wind speed u10
    [m/s]: it falls again in a hurricane, and is constant beyond 50 m/s, before it would become negative."""
    u = min(u10, 50.0) / 31.5
    return (0.55 + 2.97 * u - 1.49 * u * u) * 1e-3


DRAG_LAWS = {"wu": drag_coefficient, "garratt": garratt, "zijlema": zijlema}
RANGES = {"wu": (0.0, 20.0), "garratt": (4.0, 21.0), "zijlema": (0.0, 50.0)}
"""Winds [m/s] that each law is good for: Wu's overestimates above 20 m/s (SWAN technical manual)."""


def stress(u10: float, law: DragLaw = LAW) -> float:
    """Stress [Pa] of a wind on the sea surface at a 10 m wind speed u10 [m/s], by a drag law (thesis 2.20)."""
    return AIR_DENSITY * DRAG_LAWS[law](u10) * u10**2


def speed_under(tau: float) -> float:
    """10 m wind speed [m/s] at which Wu's law gives the stress tau [Pa]: the inverse of `stress`, by root search."""
    from scipy.optimize import brentq

    strongest = (tau / (AIR_DENSITY * drag_coefficient(0.0))) ** 0.5
    return float(brentq(lambda u10: stress(u10) - tau, 0.0, 1.001 * strongest)) if tau > 0.0 else 0.0


def stated_speed(u10: float | None, tau: float | None) -> float:
    """10 m wind speed [m/s] of a wind given by u10 [m/s], by its stress tau [Pa], or by neither (then 10)."""
    if tau is not None:
        return speed_under(tau)
    return U10 if u10 is None else u10


C_d = ti.func(drag_coefficient)


@ti.func
def drag(wind, area):
    """Drag (3,) [N] on an `area` [m2]; `wind`: air velocity relative to it [m/s]: (2.22), (2.20) of the thesis."""
    u = wind.norm()
    return AIR_DENSITY * C_d(u) * u * area * wind


@ti.func
def lift(wind, area, coefficient):
    """Lift vector [N] on an `area` [m2], whichever way it faces, upwards across the wind: (2.23) of the thesis with a
    plus sign. `wind`: air velocity relative to the area [m/s]; `coefficient`: C_L."""
    across = tm.vec3(wind.z, 0.0, -wind.x)
    horizontal = ti.max(across.norm(), 1e-12)  # in a vertical wind there is no lift
    return 0.5 * AIR_DENSITY * coefficient * area * wind.norm() * wind.cross(across) / horizontal
