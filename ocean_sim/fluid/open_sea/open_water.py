"""Open water as a sum: plane waves in closed form, waves on tiles, and a current that carries both."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ocean_sim import waves
from ocean_sim.fluid import Arriving, Fluid, Limits, Status
from ocean_sim.fluid.open_sea.plane_waves import PlaneWaves, Window
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import in_kernels

if TYPE_CHECKING:  # they are imported only where there are tiles
    from ocean_sim.fluid.open_sea.wave_sheet import Sheet
    from ocean_sim.fluid.open_sea.wave_tile import OnTile

POINTS_PER_WAVE = 16  # at which a wave is drawn
SMOOTH_STEP_PERIODS = 0.04  # [periods] times a quarter (the force number of `courant`): a hundred steps a wave


def status_of(sea: waves.Components, density: float) -> Status:
    """Status of a sea of this density [kg/m3]: surface speed and acceleration, as root sums of squares over waves."""
    speed = sea.amplitude * sea.gravity * sea.wavenumber / sea.omega  # [m/s]
    fastest, hardest = np.linalg.norm(speed), np.linalg.norm(speed * sea.omega)
    return Status(float(fastest), float(hardest), density, density, 0, True)


class OpenWater(Fluid):
    """Base class of water: plane waves plus waves on `tiles` (grids), which kernels read from fields (`sheets`)."""

    config: Any
    waves: PlaneWaves  # in closed form
    sheets: "tuple[Sheet, ...]" = ()
    tiles: "Sequence[OnTile]" = ()
    drift: np.ndarray = np.zeros(2)  # x, z by which the current has carried the water [m]
    current: tuple[float, float] = (0.0, 0.0)  # along x and z [m/s]
    time: float  # [s]
    before: float  # when the last step began: where bodies are that take theirs after the water has [s]
    still: Limits  # of the time step

    def limits(self) -> Limits:
        return self.still

    @ti.func
    def elevation(self, x, z):
        """Elevation [m] at x, z [m], at present, by plane waves and waves on grids (in kernels' fields, `sheets`)."""
        eta = self.waves.elevation(x, z)
        for sheet in ti.static(self.sheets):
            eta += sheet.elevation(x, z, sheet.now)
        return eta

    @ti.func
    def rise(self, x, z):
        eta = 0.0
        for sheet in ti.static(self.sheets):
            eta += sheet.elevation(x, z, sheet.before)
        return eta

    @ti.func
    def moving(self, x, z, depth):
        v, a = tm.vec3(self.current[0], 0.0, self.current[1]), tm.vec3(0.0)
        for sheet in ti.static(self.sheets):
            v += sheet.velocity(x, z, depth, sheet.before)
            a += sheet.acceleration(x, z, depth, sheet.before)
        return v, a

    @property
    def in_closed_form(self) -> "OpenWater":
        return self

    def window(self, size: tuple[int, int], step: tuple[float, float], depths: tuple[float, ...]) -> Window:
        return Window(self, size, step, depths)

    def arriving(self, x: float, z: float, afar: bool = False) -> Arriving:
        sea = (self.plane_waves if afar else None) or self.waves.sea
        dx, dz = np.array([x, z]) - self.before * np.array(self.current)
        angle = sea.wavevector[:, 0] * dx + sea.wavevector[:, 1] * dz + sea.phase - sea.omega * self.before
        heading = np.arctan2(sea.wavevector[:, 0], sea.wavevector[:, 1])
        return Arriving(sea.ramp_share(self.before) * sea.amplitude, angle, sea.omega, heading, sea.wavenumber)

    def elevations(self, points: np.ndarray) -> np.ndarray:
        return self.sum_elevations(np.asarray(points, dtype=float) - self.drift, self.tiles)

    def undisturbed_elevations(self, points: np.ndarray, elevation: np.ndarray) -> np.ndarray:
        """Heights (m,) [m] at `points` (m, 2) without ships' waves: here `elevation`, (m,) [m] with all waves."""
        return elevation

    def sum_elevations(self, points: np.ndarray, tiles: "Sequence[OnTile]") -> np.ndarray:
        """Heights (m,) [m] at `points` x, z (m, 2), in axes moving with the current, of plane waves and `tiles`."""
        eta = waves.elevation(self.waves.sea, points, self.time)
        for one in tiles:
            there = one.covers(points)
            if there.any():
                eta[there] += one.elevation(points[there], self.time)
        return eta

    def velocities(self, points: np.ndarray) -> np.ndarray:
        """Velocities (m, 3) [m/s] at points (m, 3) [m]; above the surface, the velocity of the surface."""
        at, (_, y) = self.locate_points(points)
        return self.flow_velocities(at, y)

    def surface_velocities(self, points: np.ndarray) -> np.ndarray:
        at = np.asarray(points, dtype=float) - self.drift
        return self.flow_velocities(at, np.zeros(len(at)))

    def flow_velocities(self, at: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Velocities (m, 3) [m/s] at x, z (m, 2) [m], axes moving with the current, Wheeler-stretched y (m,) [m]."""
        stretched = np.stack([at[:, 0], y, at[:, 1]], axis=1)
        v = waves.linear_velocity(self.waves.sea, stretched, self.time)
        v += [self.current[0], 0.0, self.current[1]]
        for one in self.tiles:
            there = one.covers(at)
            v[there] += one.velocities(at[there], y[there], self.time)
        return v

    def pressures(self, points: np.ndarray) -> np.ndarray:
        at, (eta, y) = self.locate_points(points)
        stretched = np.stack([at[:, 0], y, at[:, 1]], axis=1)
        head = waves.pressure_head(self.waves.sea, stretched, self.time) - points[:, 1]
        for one in self.tiles:
            there = one.covers(at)
            head[there] += one.heads(at[there], y[there], self.time)
        return np.where(points[:, 1] < eta, self.rest_density * self.waves.sea.gravity * head, 0.0)

    def locate_points(self, points: np.ndarray) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray]]:
        """Coordinates of points (m, 3) [m]: x, z (m, 2) in axes moving with the current; elevation (m,) of the surface
        there, and Wheeler-stretched height (m,) of the point."""
        points = np.asarray(points, dtype=float)
        at = points[:, [0, 2]] - self.drift
        eta = self.sum_elevations(at, self.tiles)
        return at, (eta, waves.stretched_height(self.waves.sea, points, eta))


@in_kernels
class WaterForShip(OpenWater):
    """Open water around one of several ships: all waves but those that she makes herself."""

    def __init__(self, whole: OpenWater, tiles: "Sequence[OnTile]", sheets: "tuple[Sheet, ...]") -> None:
        """View of `whole` that sums only the given tiles and sheets, which leave out the ship's own waves."""
        self.whole, self.tiles, self.sheets = whole, tiles, sheets
        self.config, self.waves, self.current = whole.config, whole.waves, whole.current
        self.rest_density, self.spacing, self.reference_speed = whole.rest_density, whole.spacing, whole.reference_speed
        self.still = whole.still

    @property
    def time(self) -> float:  # type: ignore[override]
        return self.whole.time

    @property
    def before(self) -> float:  # type: ignore[override]
        """Time [s] at which the last step began."""
        return self.whole.before

    @property
    def drift(self) -> np.ndarray:  # type: ignore[override]
        """Displacement of the water along x, z (2,) [m] by the current since the start."""
        return self.whole.drift

    @property
    def status(self) -> Status:  # type: ignore[override]
        return self.whole.status

    def advance(self, dt: float) -> None:
        """Do nothing; the whole water, of which this is a view, is advanced by itself."""
