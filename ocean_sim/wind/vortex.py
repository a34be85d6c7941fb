"""A rotating column of air (thesis figure 6-3 d, which gives no numbers: all are ours).

A stylised force field, as in `gusts`: the acceleration turns about a vertical axis with the profile of a Rankine
vortex, growing like r in the core and falling like 1/r outside, and fades from the still surface downwards in a layer.
"""

from collections.abc import Iterator
from math import hypot, inf, pi
from typing import ClassVar, Literal

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.columns import Columns
from ocean_sim.kernel_library import ti, tm
from ocean_sim.model import Faults, NotNegative3, Vector2, quantity
from ocean_sim.parts import LedgerRow, SceneFacts, WindConfig
from ocean_sim.runtime import in_kernels
from ocean_sim.wind import DeviceRow, Drawing, Target, Wind
from ocean_sim.wind.shared.noise import DRAW_INTERVAL, DRAWS, Noise
from ocean_sim.wind.shared.place import Passages, Patch, Placed
from ocean_sim.wind.shared.schedule import Timed
from ocean_sim.wind.shared.warnings import stylised, velocity_change

NOISE_STREAM = 0x3_0000  # stream of random numbers
ROW = Columns(
    draws=DRAWS.size,
    axis_x=1,  # [m] when the clock was restarted
    axis_z=1,  # [m]
    part=1,  # of its strength
    since=1,  # [s]
)


class Config(Timed, Placed, WindConfig):
    """A column of air that turns about the vertical."""

    needs_area: ClassVar[bool] = False
    kind: Literal["vortex"] = "vortex"
    centre: Vector2 = quantity("m", (0.0, 0.0))
    """x and z of the axis at the beginning."""
    core_radius: float = quantity("m", 6.0, gt=0.0)
    """Radius at which the acceleration is highest."""
    acceleration: float = quantity("m/s2", 1.0)
    """Highest acceleration around the axis; positive turns from +z to +x, by the right hand about +y."""
    inward: float = quantity("m/s2", 0.0)
    """Highest acceleration towards the axis, with the same profile."""
    upward: float = quantity("m/s2", 0.0)
    """Highest acceleration upwards, with the same profile."""
    noise: NotNegative3 = quantity("m/s2", (0.0, 0.0, 0.0))
    """Highest random acceleration along each axis, uniform between minus and plus this (2.24), with the same
    profile: the air is as rough as it is strong."""
    noise_every: float = quantity("s", DRAW_INTERVAL, ge=0.0)
    """Duration of a draw of the noise, as in gusts."""
    layer: float = quantity("m", 2.5, gt=0.0)
    """Depth at which the water no longer feels it."""
    drift: Vector2 = quantity("m/s", (0.0, 0.0))
    """Velocity of the axis along x and z; where it leaves the basin it comes in again upwind."""
    targets: list[Target] = ["fluid", "ship"]
    """Targets of the wind."""

    @property
    def acts_on(self) -> list[Target]:
        return self.targets

    @property
    def is_random(self) -> bool:
        return any(self.noise)

    def circulation(self, radius: float) -> float:
        """Line integral [m2/s2] of the acceleration around a circle of a radius [m] about the vortex axis."""
        return 2.0 * pi * self.acceleration * min(radius**2 / self.core_radius, self.core_radius)

    def build(self, basin: Basin, seed: int) -> Wind:
        return Vortex(self, basin, seed)

    def problems(self, preflight: SceneFacts) -> Faults:
        if preflight.tank.dimension == 2:
            yield ("kind",), "a vortex turns about the vertical: give the basin a width"
        yield from self.misframed(preflight)

    def ledger(self, preflight: SceneFacts) -> list[LedgerRow]:
        size = ROW.size * preflight.word
        return [LedgerRow("wind", "axis, strength and noise of the vortex", size, "wind.kind is vortex")]

    def warnings(self, preflight: SceneFacts) -> Iterator[str]:
        speed = hypot(*self.drift)
        acceleration = (self.acceleration, self.upward, self.inward)
        passing = 2.0 * self.core_radius / speed if speed else inf
        yield stylised("wind", hypot(*acceleration, *self.noise), preflight)
        yield from velocity_change("wind", acceleration, passing, preflight)


@in_kernels
class Vortex(Wind):
    """Wind of a vortex about a vertical axis that drifts across the basin."""

    config: Config

    def __init__(self, config: Config, basin: Basin, seed: int) -> None:
        super().__init__(config)
        self.patch, self.part = Patch(config, basin), config.blowing(0.0)
        x, z = config.centre
        self.passage = Passages((x, 0.0, z), (config.drift[0], 0.0, config.drift[1]), config.core_radius, basin)
        self.row = DeviceRow(ROW.size)
        self.noisy = any(config.noise)
        self.noise = Noise(seed, config.noise_every, self.row)
        self._restart()

    def follow(self, middle: np.ndarray) -> None:
        self.patch.follow(middle)

    def advance(self, dt: float) -> None:
        """Move the axis by a step of dt [s] (thesis, Algorithm 1), and set strength and noise (random acceleration)."""
        before, part, begun = self.passage.number, self.part, self.clock.time
        self.passage.advance(dt)
        self.clock.advance(dt)
        if not self.config.always:
            self.part = self.config.blowing(begun, dt)
        if self.passage.number != before or self.part != part or self.clock.is_due():
            self._restart()
        if self.noisy:
            self.noise.advance()

    def strengthen(self, factor: float) -> None:
        super().strengthen(factor)
        self._restart()

    def drawing(self) -> Drawing:
        """Two rings around the core, at the surface and the lower end of its layer, lines between them, and arrows."""
        config, angle = self.config, np.linspace(0.0, 2.0 * pi, 33)
        around = np.stack([np.cos(angle), np.zeros(33), np.sin(angle)], axis=1)
        top = self.passage.centre + self.patch.origin + config.core_radius * around
        rings = [np.stack([ring[:-1], ring[1:]], axis=1) for ring in (top, top - [0.0, config.layer, 0.0])]
        upright = np.stack([top[:-1:4], top[:-1:4] - [0.0, config.layer, 0.0]], axis=1)
        out = around[:-1:4]
        pushes = config.acceleration * np.cross([0.0, 1.0, 0.0], out) - config.inward * out + [0.0, config.upward, 0.0]
        greatest = hypot(config.acceleration, config.inward, config.upward)
        arrows = self.gain * self.part / (greatest or 1.0) * pushes
        return Drawing(np.concatenate([*rings, upright]), top[:-1:4], arrows, greatest, "m/s²")

    def _restart(self) -> None:
        """Write the present axis and strength to the device row; restart the clocks of wind and random acceleration."""
        x, _, z = self.passage.centre.tolist()
        for column, number in ((ROW.axis_x, x), (ROW.axis_z, z), (ROW.part, self.gain * self.part)):
            self.row.set(column, number)
        if self.noisy:
            self.noise.restart(self.clock.time)
        self.clock.restart()

    @ti.func
    def set_clock(self, since, step):
        self.row.field[ROW.since] = since
        if ti.static(self.noisy):
            self.noise.set_clock(since, step)

    @ti.func
    def force(self, key, position, velocity, area, bend, mass):
        """Force [N]: mass times acceleration around, towards and along the axis, and noise (random acceleration, drawn
        by the number `key` of a particle or voxel), fading with depth. `velocity`, `area` and `bend` are not used."""
        row = ti.static(self.row.field)
        drift = ti.static(self.config.drift)
        x, z = row[ROW.axis_x] + row[ROW.since] * drift[0], row[ROW.axis_z] + row[ROW.since] * drift[1]
        seen = self.patch.seen(position)
        arm = tm.vec3(seen.x - x, 0.0, seen.z - z)
        r2, core = arm.dot(arm), ti.static(self.config.core_radius)
        around, towards = tm.vec3(arm.z, 0.0, -arm.x), -arm
        profile = core / ti.max(r2, core * core)  # times r: r / core inside, core / r outside
        depth = row[ROW.part] * tm.clamp(1.0 + position.y / self.config.layer, 0.0, 1.0)
        level = self.config.acceleration * around + self.config.inward * towards
        total = level + tm.vec3(0.0, self.config.upward * ti.sqrt(r2), 0.0)
        if ti.static(self.noisy):
            if depth > 0.0:  # below its layer nothing is drawn
                total += ti.sqrt(r2) * tm.vec3(self.config.noise) * self.noise.of(NOISE_STREAM, key)
        return mass * depth * profile * total
