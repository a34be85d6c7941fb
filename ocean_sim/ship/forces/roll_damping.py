"""Roll damping besides waves of a table: friction, eddies, bilge keels, the hull's own waves, and lift under way.

Ikeda's prediction by components (Himeno 1981, Univ. of Michigan report 239; ITTC 7.5-02-07-04.5) in its simple form of
Kawahara, Maekawa & Ikeda (2009, 10th STAB; 2012, in Contemporary Ideas on Ship Stability, Springer), whose regressions
of form, axis and amplitude are of their published program (2009). Lift under way is that of Ikeda, Himeno & Tanaka
(1978), as in ITTC 7.5-02-07-04.5, 2.2.2. A component at an amplitude phi and a frequency omega is a moment over the
rate. The part of their sum that grows with the amplitude becomes a moment over the square of the rate, 8 / (3 pi) omega
phi of which does the same work in a period.

Regressions hold within the limits of roll_damping.yaml; beyond them a hull is taken as one at the limit, and
`ratios_beyond` says so.
"""

from collections.abc import Sequence
from functools import cache
from math import exp, log, pi, radians, sqrt
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ocean_sim.files.yaml_file import read_mapping
from ocean_sim.model import Model, quantity
from ocean_sim.ship.naval.hydrostatics import Hydrostatics

WATER_VISCOSITY = 1.14e-6  # of sea water of 15 degrees C [m2/s]
FIT_AMPLITUDES = tuple(float(a) for a in range(1, 21))  # [deg] over which a linear and a quadratic part are fitted
WETTED_DRAUGHTS = 1.75  # draughts of a hull's sides in the wetted surface


@cache
def regressions() -> dict[str, Any]:
    """Coefficients of the regressions in roll_damping.yaml, and the `limits` of their arguments by name."""
    return read_mapping(Path(__file__).with_suffix(".yaml")).plain()


def polynomial_at(coefficients: Sequence[Any], x: float, *others: float) -> float:
    """Value of a polynomial at x: `coefficients` by falling powers, each a number or a polynomial in `others`."""
    return float(np.polyval([polynomial_at(row, *others) for row in coefficients] if others else coefficients, x))


class BilgeKeels(Model):
    """A pair of plates along the bilges."""

    length: float = quantity("m", ..., gt=0.0)
    """Length of each keel."""
    breadth: float = quantity("m", ..., gt=0.0)
    """Breadth of each keel, out from the hull."""


class Ikeda(Model):
    """Roll damping by components, from the form of the hull (Kawahara, Maekawa & Ikeda 2012)."""

    bilge_keels: BilgeKeels | None = None
    """The bilge keels; null: the hull is bare."""
    kinematic_viscosity: float = quantity("m2/s", WATER_VISCOSITY, gt=0.0)
    """Kinematic viscosity of the water."""


class Form(NamedTuple):
    """Dimensions and ratios of a rolling hull, arguments of the regressions of roll damping."""

    length: float  # of the waterline [m]
    breadth: float  # [m]
    draught: float  # [m]
    block: float  # C_B
    midship: float  # C_M
    axis: float  # depth of the centre of mass under the still water over the draught
    frequency: float  # omega sqrt(B / 2g)
    keels: tuple[float, float] | None  # length over that of the hull, breadth over that of the hull

    @property
    def limited_ratios(self) -> dict[str, float]:
        """Ratios of this form, by name, that have limits in roll_damping.yaml; not yet clipped to these."""
        keels = () if self.keels is None else self.keels[::-1]
        ratios = self.block, self.midship, self.breadth / self.draught, self.axis, self.frequency
        return dict(zip(regressions()["limits"], (*ratios, *keels)))


class Components(NamedTuple):
    """Dimensionless components of roll damping, B44 / (rho V B^2) sqrt(B / 2g), at one amplitude and frequency."""

    friction: float
    wave: float
    eddies: float
    bilge_keels: float


def form_of(hull: Hydrostatics, omega: float, keels: BilgeKeels | None) -> Form:
    """Dimensions and ratios, for the regressions, of a hull that rolls at `omega` [rad/s]; `keels`: her bilge keels."""
    _, breadth, draught = hull.stations
    length, broad = hull.length, float(breadth.max())
    deep = float(draught.max())
    volume = min(hull.needed_volume, hull.voxels.volume)
    return Form(
        length,
        broad,
        deep,
        volume / (length * broad * deep),
        float(hull.section_areas.max()) / (broad * deep),
        (hull.keel + deep - float(hull.matter.centre[1])) / deep,
        omega * sqrt(broad / (2.0 * hull.gravity)),
        None if keels is None else (keels.length / length, keels.breadth / broad),
    )


def ratios_beyond(form: Form) -> list[str]:
    """Texts (name, value, limits) on ratios of a hull that lie outside the limits of the regressions."""
    found = []
    for name, value in form.limited_ratios.items():
        low, high = regressions()["limits"][name]
        if not low - 1e-6 <= value <= high + 1e-6:
            found.append(f"{name} {value:.3g} ({low:g} to {high:g})")
    return found


def damping_components(form: Form, amplitude: float, viscosity: float, gravity: float) -> Components:
    """Roll damping at an amplitude [deg], `viscosity` [m2/s], `gravity` [m/s2]; ratios are clipped to the `limits`."""
    held = (float(np.clip(value, *regressions()["limits"][name])) for name, value in form.limited_ratios.items())
    cb, cm, bd, og, frequency, *keels = held
    return Components(
        skin_friction(form, amplitude, viscosity, gravity),
        wave_damping(cb, cm, bd, og, frequency),
        eddy_damping(cb, cm, bd, og, amplitude) * frequency,
        keel_damping(cb, cm, bd, og, amplitude, keels[1], keels[0]) * frequency if keels else 0.0,
    )


def skin_friction(form: Form, amplitude: float, viscosity: float, gravity: float) -> float:
    """Roll damping by skin friction at an amplitude [deg] (Kato 1958): Blasius's boundary layer on a mean cylinder."""
    _, broad, deep, cb, _, og, frequency, _ = form
    phi, omega = radians(amplitude), frequency * sqrt(2.0 * gravity / broad)
    radius = deep * ((0.887 + 0.145 * cb) * (1.7 + cb * broad / deep) - 2.0 * og) / pi
    reynolds = 3.22 * (radius * phi) ** 2 * omega / (2.0 * pi * viscosity)
    wetted = WETTED_DRAUGHTS * deep + cb * broad  # a metre of length
    moment = 4.0 / (3.0 * pi) * wetted * radius**3 * phi * omega * 1.328 / sqrt(reynolds)
    return moment / (cb * deep * broad**3) * sqrt(broad / (2.0 * gravity))


def wave_damping(cb: float, cm: float, bd: float, og: float, frequency: float) -> float:
    """Roll damping by waves of a hull without forward speed, as in `Components`. `cb`, `cm`: block and midship
    coefficient; `bd`, `og`: breadth, and depth of the centre of mass, over draught; `frequency`: omega sqrt(B / 2g)."""
    if frequency == 0.0:
        return 0.0
    over, of = 1.0 - og, regressions()
    a1 = polynomial_at(of["wave_a1"], over, cb, bd)
    a1 *= polynomial_at(of["wave_a1_shape"], cm, cb, bd) * (1.0 - over) + 1.0
    bent = polynomial_at(of["wave_a3_breadth"], bd) * polynomial_at(of["wave_a3_shape"], over, cb)
    bent *= polynomial_at(of["wave_a3_axis"], over - polynomial_at(of["wave_a3_shift"], bd), bd)
    a3 = polynomial_at(of["wave_a3"], over, cb) + bent
    return a1 / frequency * exp(-polynomial_at(of["wave_a2"], over) * (log(frequency) - a3) ** 2 / 1.44)


def eddy_damping(cb: float, cm: float, bd: float, og: float, amplitude: float) -> float:
    """Dimensionless roll damping by eddies over omega sqrt(B / 2g), at an amplitude [deg]; 0 from cb 0.84 on. `cb`,
    `cm`: block and midship coefficient; `bd`, `og`: breadth, and depth of the centre of mass, over draught."""
    form = max((-0.0182 * cb + 0.0155) * (bd - 1.8) ** 3 + polynomial_at(regressions()["eddies_form"], cb), 0.0)
    axis = (3.98 * cb - 5.1525) * (-0.2 * bd + 1.6) * og
    axis *= (0.9717 * cb**2 - 1.55 * cb + 0.723) * og + 0.04567 * cb + 0.9408
    section = (0.25 * og + 0.95) * og + polynomial_at(regressions()["eddies_section"], cb)
    power = -15.0 * cb * bd + 46.5 * cb + 11.2 * bd - 28.6
    drag = form * exp(axis + section * cm**power)
    return 4.0 * radians(amplitude) / (3.0 * pi * cb * bd**3) * drag


def keel_damping(cb: float, cm: float, bd: float, og: float, amplitude: float, long: float, broad: float) -> float:
    """Dimensionless roll damping by bilge keels over omega sqrt(B / 2g), at an amplitude [deg]. `cb`, `cm`: block,
    midship coefficient; `bd`, `og`: breadth, depth of centre of mass over draught; `long`, `broad`: keel over hull."""
    form = (-0.3651 * cb + 0.3907) * (bd - 2.83) ** 2 - 2.21 * cb + 2.632
    swing = 0.00255 * amplitude**2 + 0.122 * amplitude + 0.4794
    size = (-0.8913 * broad**2 - 0.0733 * broad) * long**2
    size += (5.2857 * broad**2 - 0.01185 * broad + 0.00189) * long
    axis = (5.0 * broad + 0.3 * bd - 0.2 * long + 0.00125 * amplitude**2 - 0.0425 * amplitude - 1.86) * og
    section = -15.0 * broad + 1.2 * cb - 0.1 * bd - 0.0657 * og**2 + 0.0586 * og + 1.6164
    return form * swing * size * exp(axis + section * cm ** (2.5 * og + 15.75))


def lift_damping(form: Form, density: float) -> float:
    """Roll damping by lift of the hull in water of a density [kg/m3]: moment per roll rate and speed [N s2 rad-1]."""
    length, broad, deep, _, cm, _, _, _ = form
    held = min(max(cm, 0.91), 0.99)
    slope = 2.0 * pi * deep / length
    slope += (106.0 * (held - 0.91) ** 2 - 700.0 * (held - 0.91) ** 3) * (4.1 * broad / length - 0.045)
    push, arm, og = 0.3 * deep, 0.5 * deep, form.axis * deep
    return 0.5 * density * length * deep * slope * push * arm * (1.0 - 1.4 * og / arm + 0.7 * og**2 / (push * arm))


class RollDamping:
    """Roll damping of one hull: coefficients of the roll rate, of its square, and of the rate times the speed ahead."""

    def __init__(self, config: Ikeda, hull: Hydrostatics, added: float, waves: bool) -> None:
        """`added`: added inertia in roll [kg m2]; `waves`: True to include damping by the hull's own waves, False if a
        radiation table gives it. A hull without righting moment has lift damping alone."""
        stiffness = hull.stiffness["roll"]
        omega = sqrt(max(stiffness, 0.0) / (hull.inertia["roll"] + added))
        self.keels = config.bilge_keels
        self.form = form = form_of(hull, omega, config.bilge_keels)
        volume = min(hull.needed_volume, hull.voxels.volume)
        self.scale = hull.density * volume * form.breadth**2 / sqrt(form.breadth / (2.0 * hull.gravity))  # [N m s]
        self.omega, self.critical = omega, 2.0 * sqrt(max(stiffness, 0.0) * (hull.inertia["roll"] + added))
        self.parts: dict[float, Components] = {}
        self.linear, self.quadratic, self.ahead = 0.0, 0.0, lift_damping(form, hull.density)
        if omega > 0.0:
            found = [damping_components(form, a, config.kinematic_viscosity, hull.gravity) for a in FIT_AMPLITUDES]
            self.parts = {a: each if waves else each._replace(wave=0.0) for a, each in zip(FIT_AMPLITUDES, found)}
            whole = self.scale * np.array([sum(each) for each in self.parts.values()])
            rate = 8.0 / (3.0 * pi) * omega * np.radians(FIT_AMPLITUDES)
            rows = np.stack([np.ones_like(rate), rate], axis=1)
            self.linear, self.quadratic = (max(float(x), 0.0) for x in np.linalg.lstsq(rows, whole, rcond=None)[0])

    @property
    def warnings(self) -> list[str]:
        """Warnings of a form beyond the regressions, and of eddy damping counted as 0."""
        beyond = ratios_beyond(self.form)
        limits = f"roll damping: {', '.join(beyond)}: beyond Ikeda's regressions, taken at their limit"
        said = [limits] if beyond else []
        if any(each.eddies == 0.0 for each in self.parts.values()):
            said.append("roll damping: for so full a hull Ikeda's regression gives negative eddy damping, counted as 0")
        return said

    def critical_share(self, amplitude: float) -> float:
        """Roll damping at `amplitude`, one of FIT_AMPLITUDES [deg], over critical; 0 for no righting moment."""
        return self.scale * sum(self.parts[amplitude]) / self.critical if self.parts else 0.0

    def roll_moment(self, rate: float, ahead: float) -> float:
        """Damping moment [N m], opposite to a rate of roll [rad/s], at a speed ahead [m/s]."""
        return -(self.linear + self.quadratic * abs(rate) + self.ahead * max(ahead, 0.0)) * rate
