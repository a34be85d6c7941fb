"""A sea in closed form, without particles: the linear waves of `ocean_sim.waves`, for ships and platforms alone."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, ClassVar, Literal

import numpy as np

from ocean_sim import waves
from ocean_sim.basin import Basin
from ocean_sim.conventions import LEAST_DENSITY, WATER_DENSITY, Setting
from ocean_sim.fluid import Limits
from ocean_sim.fluid.open_sea.open_water import POINTS_PER_WAVE, SMOOTH_STEP_PERIODS, OpenWater, status_of
from ocean_sim.fluid.open_sea.plane_waves import PlaneWaves, Window
from ocean_sim.model import Fault, Faults, quantity
from ocean_sim.parts import FluidConfig, LedgerRow, SceneFacts, beyond_drift_tables, forces_in_waves
from ocean_sim.runtime import in_kernels
from ocean_sim.wind import Wind


class Config(waves.GrowingTrain, FluidConfig):
    """Regular waves (`height`, `period`, `heading_deg`) or a `spectrum`; sides of the basin do not reflect them.
    They grow over the `ramp`, so that floating hulls do not begin with the velocity of one phase."""

    example: ClassVar[dict[str, Any]] = {"height": 0.5, "period": 4.0}
    kind: Literal["linear_waves"] = "linear_waves"
    height: float | None = quantity("m", None, ge=0.0)
    """Height from trough to crest; 0 is calm water."""
    rest_density: float = quantity("kg/m3", WATER_DENSITY, ge=LEAST_DENSITY)
    """Density of the water."""

    def problems(self, preflight: SceneFacts) -> Faults:
        basin = preflight.tank
        unfit: list[Fault] = [(("kind",), sentence) for sentence in waves.basin_faults(basin)]
        yield from unfit or [(self.height_key, sentence) for sentence in waves.basin_faults(basin, *self.scale)]
        if basin.ground is not None:
            yield ("kind",), "a sea in closed form lies over a flat bed; leave the shape of basin.floor out"
        if basin.config.obstacles:
            yield ("kind",), "a sea in closed form goes through obstacles; leave basin.obstacles out"
        if basin.rough_bed is not None:
            yield ("kind",), "a sea in closed form has no friction; leave basin.floor out"
        yield from self.direction_faults(basin)

    def statements(self, preflight: SceneFacts) -> list[str]:
        return forces_in_waves(preflight, self.spectrum is None, False) if self.scale[0] > 0.0 else []

    def warnings(self, preflight: SceneFacts) -> Iterator[str]:
        if self.scale[0] > 0.0:
            yield from waves.cut_short(preflight.duration, self.with_ramp(self.sea(preflight.tank)).ramp)
            yield from beyond_drift_tables(preflight, self.sea(preflight.tank))
        if not preflight.wind.still:
            yield "closed-form waves do not feel the wind; it reaches only the ship"

    def still_limits(self, preflight: SceneFacts) -> Limits:
        return self.interpolation_limits

    @property
    def interpolation_limits(self) -> Limits:
        """Limits of the time step by which waves, interpolated between the steps of a file, err by at most 0.05 %."""
        return Limits(force=SMOOTH_STEP_PERIODS * self.scale[1])

    def point_spacing(self, preflight: SceneFacts) -> float:
        return self.wave_spacing(preflight.tank)

    def wave_spacing(self, tank: waves.Tank) -> float:
        """Distance [m] between points that resolve the waves: POINTS_PER_WAVE of them to a wavelength."""
        k = waves.wavenumber(2.0 * np.pi / self.scale[1], tank.depth, waves.downward_gravity(tank))
        return 2.0 * np.pi / float(k) / POINTS_PER_WAVE

    def ledger(self, preflight: SceneFacts) -> list[LedgerRow]:
        n, word = len(self.sea(preflight.tank).amplitude), preflight.word
        why = "fluid.kind is linear_waves: no particles"
        return [LedgerRow("fluid", f"{n} plane waves", PlaneWaves.bytes(n, word), why)]

    def window_bytes(self, preflight: SceneFacts, size: tuple[int, int], levels: int) -> int:
        return Window.bytes(size, levels, len(self.sea(preflight.tank).amplitude), preflight.word)

    def build(self, basin: Basin, seed: int, *, accounts: bool, wind: Wind) -> "LinearWaves":
        return LinearWaves(self, basin)


@in_kernels
class LinearWaves(OpenWater):
    """Water without particles: the sum of linear plane waves, evaluated at the present time."""

    def __init__(self, config: Config, basin: Basin) -> None:
        self.config, sea = config, config.with_ramp(config.sea(basin))
        self.given = sea  # waves of the scene
        self.heading = float(np.degrees(np.arctan2(*(sea.amplitude**2 @ sea.wavevector)))) % 360.0  # [deg] their mean
        names = ("wave_height", "wave_period", "wave_heading")[: basin.dimension]
        self.train = dict(zip(names, (*config.scale, self.heading)))  # as sliders set it
        self.spacing = config.wave_spacing(basin)  # [m]
        self.still = config.interpolation_limits
        self.reference_speed = (sea.gravity * basin.depth) ** 0.5
        self.rest_density = config.rest_density
        self.status = status_of(sea, config.rest_density)
        self.waves = PlaneWaves(sea)
        self.time = self.before = 0.0

    @property
    def plane_waves(self) -> waves.Components:
        return self.waves.sea

    def begin(self, sea: waves.Components) -> None:
        """Restart at time 0 with other waves, as many and in the same depth; they grow over the ramp of the config."""
        self.time = self.before = 0.0
        self.waves.begin(self.config.with_ramp(sea))

    @property
    def adjustable(self) -> dict[str, Setting]:
        """Settings for the waves' height [m], period [s], in 3-D heading [deg]; of random ones Hs, Tp, mean heading."""
        (height, period), sea = self.config.scale, self.given
        highest = min(4.0 * height, waves.breaking_height(period, sea.depth, sea.gravity))
        rows = zip(self.train.items(), "m s deg".split(), ((0.0, highest), (0.5 * period, 2.0 * period), (0.0, 360.0)))
        return {name: Setting(now, unit, ends) for (name, now), unit, ends in rows if height > 0.0}

    def adjust(self, **values: float) -> None:
        """Set `wave_height` [m] (up to breaking), `wave_period` [s], `wave_heading` [deg]; the origin keeps phase."""
        past, sea, self.train = self.waves.sea, self.given, self.train | values
        height, period, *heading = self.train.values()
        turn = np.radians(heading[0] - self.heading) if heading else 0.0
        share = min(height, waves.breaking_height(period, sea.depth, sea.gravity)) / self.config.scale[0]
        k = waves.wavenumber(sea.omega * (self.config.scale[1] / period), sea.depth, sea.gravity) / sea.wavenumber
        vectors = k[:, None] * sea.wavevector @ [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
        sea = replace(sea, amplitude=share * sea.amplitude, wavevector=vectors)
        self.waves.begin(replace(sea, phase=past.phase + (sea.omega - past.omega) * self.time))
        self.waves.set_time(self.time)
        self.still = Limits(force=SMOOTH_STEP_PERIODS * period)

    def advance(self, dt: float) -> None:
        self.before, self.time = self.time, self.time + dt
        self.waves.set_time(self.time)
