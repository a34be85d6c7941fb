"""Open water as a sum: plane waves in closed form, waves on tiles, and a current that carries both."""

from abc import abstractmethod
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import taichi as ti
import taichi.math as tm

from ocean_sim import waves
from ocean_sim.fluid import Fluid, Limits, Status
from ocean_sim.fluid.shared.plane_waves import PlaneWaves
from ocean_sim.fluid.shared.sheet import Sheet
from ocean_sim.fluid.shared.tile import Tile, below


class Shown(NamedTuple):
    """What a tile shows now: modes of the elevation, of the potential at the still surface, and of its growth."""

    e: np.ndarray
    potential: np.ndarray
    growth: np.ndarray


class OnTile:
    """Waves on a tile that can be asked for."""

    tile: Tile

    @abstractmethod
    def shown(self, time: float) -> Shown:
        """At a time [s]."""

    def seen(self, points: np.ndarray) -> np.ndarray:
        """(m,) whether there is anything at points x, z (m, 2) in the axes of the water [m]: everywhere."""
        return np.ones(len(points), dtype=bool)


@ti.data_oriented
class OpenWater(Fluid):
    """The sum, for kernels and for Python: kernels read the plane waves and the `sheets`, Python the plane waves and
    all `tiles`."""

    sound_speed = 0.0  # [m/s] nothing is compressed

    config: Any
    waves: PlaneWaves  # in closed form
    sheets: tuple[Sheet, ...]
    tiles: Sequence[OnTile]
    drift: np.ndarray  # x, z by which the current has carried the water [m]
    current: tuple[float, float]  # along x and z [m/s]
    time: float

    def internal_energy(self) -> float:
        """0: nothing is compressed [J]."""
        return 0.0

    @ti.func
    def elevation(self, x, z):
        eta = self.waves.elevation(x, z)
        for sheet in ti.static(self.sheets):
            eta += sheet.elevation(x, z)
        return eta

    @ti.func
    def velocity(self, position):
        """[m/s]; above the water that of its surface."""
        y = self.waves.stretched(position, self.elevation(position.x, position.z))
        v = tm.vec3(self.current[0], 0.0, self.current[1]) + self.waves.velocity_at(position, y)
        for sheet in ti.static(self.sheets):
            v += sheet.velocity(position.x, position.z, -y)
        return v

    @ti.func
    def acceleration(self, position):
        """[m/s2] by linear theory, -grad p / rho less gravity: what a body that is small against the waves feels."""
        y = self.waves.stretched(position, self.elevation(position.x, position.z))
        a = self.waves.acceleration_at(position, y)
        for sheet in ti.static(self.sheets):
            a += sheet.acceleration(position.x, position.z, -y)
        return a

    @ti.func
    def moving(self, position, eta):
        """Velocity [m/s] and acceleration [m/s2] under an elevation [m]."""
        y = self.waves.stretched(position, eta)
        v, a = self.waves.moving_at(position, y)
        v += tm.vec3(self.current[0], 0.0, self.current[1])
        for sheet in ti.static(self.sheets):
            v += sheet.velocity(position.x, position.z, -y)
            a += sheet.acceleration(position.x, position.z, -y)
        return v, a

    def elevations(self, points: np.ndarray) -> np.ndarray:
        """(m, 2) points x, z [m] -> (m,) heights [m]."""
        return self.heights(np.asarray(points, dtype=float) - self.drift)

    def heights(self, points: np.ndarray) -> np.ndarray:
        """The same of points in the axes of the water."""
        eta = waves.elevation(self.waves.sea, points, self.time)
        for one in self.tiles:
            there = one.seen(points)
            if there.any():
                eta[there] += one.tile.at(one.tile.values(one.shown(self.time).e), points[there])
        return eta

    def velocities(self, points: np.ndarray) -> np.ndarray:
        """(m, 3) points [m] -> (m, 3) velocities [m/s]; above the water that of its surface."""
        at, (_, y) = self.in_water(points)
        stretched = np.stack([at[:, 0], y, at[:, 1]], axis=1)
        v = waves.linear_velocity(self.waves.sea, stretched, self.time)
        v += [self.current[0], 0.0, self.current[1]]
        for one in self.tiles:
            there, now = one.seen(at), one.shown(self.time)
            v[there] += below(one.tile, now.potential, now.growth, at[there], y[there]).velocity
        return v

    def pressures(self, points: np.ndarray) -> np.ndarray:
        """(m, 3) points [m] -> (m,) pressures [Pa]; 0 above the water."""
        at, (eta, y) = self.in_water(points)
        stretched = np.stack([at[:, 0], y, at[:, 1]], axis=1)
        head = waves.pressure_head(self.waves.sea, stretched, self.time) - points[:, 1]
        for one in self.tiles:
            there, now = one.seen(at), one.shown(self.time)
            head[there] += below(one.tile, now.potential, now.growth, at[there], y[there]).head
        return np.where(points[:, 1] < eta, self.rest_density * self.waves.sea.gravity * head, 0.0)

    def in_water(self, points: np.ndarray) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray]]:
        """Of points (m, 3): x and z in the axes of the water (m, 2), and over them the elevation (m,) and the height in
        the unstretched column (m,) [m]."""
        at = np.asarray(points, dtype=float)[:, [0, 2]] - self.drift
        eta, h = self.heights(at), self.waves.sea.depth
        y = np.minimum(h * (points[:, 1] - eta) / np.maximum(h + eta, 1e-9 * h), 0.0)
        return at, (eta, y)


@ti.data_oriented
class Felt(OpenWater):
    """Open water as one of several ships feels it: without the waves that she makes herself."""

    def __init__(self, whole: OpenWater, tiles: Sequence[OnTile], sheets: tuple[Sheet, ...]) -> None:
        self.whole, self.tiles, self.sheets = whole, tiles, sheets
        self.config, self.waves, self.current = whole.config, whole.waves, whole.current
        self.rest_density, self.spacing, self.reference_speed = whole.rest_density, whole.spacing, whole.reference_speed

    @property
    def time(self) -> float:  # type: ignore[override]
        return self.whole.time

    @property
    def drift(self) -> np.ndarray:  # type: ignore[override]
        return self.whole.drift

    @property
    def status(self) -> Status:  # type: ignore[override]
        return self.whole.status

    def advance(self, dt: float) -> None:
        """The whole goes on by itself."""

    def limits(self) -> Limits:
        return self.whole.limits()
