"""A sea in closed form, without particles: the linear waves of `ocean_sim.waves`, for ships and platforms alone."""

from typing import Any, ClassVar, Literal

import numpy as np
import taichi as ti
import taichi.math as tm
from pydantic import model_validator

from ocean_sim import waves
from ocean_sim.basin import Basin
from ocean_sim.conventions import WATER_DENSITY
from ocean_sim.fluid import Fluid, Limits, Status
from ocean_sim.model import quantity
from ocean_sim.parts import FluidConfig, LedgerRow, Preflight, Problems
from ocean_sim.wind import Wind

ADVANCE = 7.0e-4  # [s] of processor time a step
POINTS_PER_WAVE = 16  # at which a wave is drawn
SMOOTH = 0.04  # [periods] times a quarter (the force number of `courant`): a hundred steps a wave


class Config(waves.WaveTrain, FluidConfig):
    """Regular waves (`height`, `period`, `heading_deg`) or a `spectrum`; sides of the basin do not reflect them."""

    example: ClassVar[dict[str, Any]] = {"height": 0.5, "period": 4.0}
    kind: Literal["linear_waves"] = "linear_waves"
    height: float | None = quantity("m", None, ge=0.0)
    """From trough to crest; 0 is calm water."""
    heading_deg: float | None = quantity("deg", None)
    """Where regular waves go to: 0 along +z, 90 along +x; by default 0, in a slice 90."""
    rest_density: float = quantity("kg/m3", WATER_DENSITY, gt=0.0)
    """Density of the water."""

    @model_validator(mode="after")
    def _one_heading(self) -> "Config":
        if self.spectrum is not None and self.heading_deg is not None:
            raise ValueError("the heading of random waves is spectrum.heading_deg")
        return self

    @property
    def heading(self) -> float | None:
        """Where the waves go to [deg]."""
        return self.heading_deg if self.spectrum is None else self.spectrum.heading_deg

    def sea(self, basin: Basin) -> waves.Components:
        """The waves of this basin."""
        return self.train(waves.direction(self.heading, basin.dimension), basin.depth, waves.pull(basin))

    def problems(self, preflight: Preflight) -> Problems:
        basin = preflight.tank
        random = self.spectrum is not None
        key: tuple[str, ...] = ("spectrum", "significant_wave_height") if random else ("height",)
        path: tuple[str, ...] = ("spectrum", "heading_deg") if random else ("heading_deg",)
        found: Problems = [(("kind",), sentence) for sentence in waves.unsuited(basin)]
        found = found or [(key, sentence) for sentence in waves.unsuited(basin, *self.scale)]
        if basin.obstacles:
            found.append((("kind",), "a sea in closed form goes through obstacles; leave basin.obstacles out"))
        if basin.rough_bed is not None:
            found.append((("kind",), "a sea in closed form knows no friction; leave basin.floor out"))
        return found + [(path, sentence) for sentence in waves.misdirected(self.heading, basin)]

    def warnings(self, preflight: Preflight) -> list[str]:
        deaf = "closed-form waves do not feel the wind; it reaches the ship alone"
        return [] if preflight.wind.still else [deaf]

    def still_limits(self, preflight: Preflight) -> Limits:
        return self.smooth

    @property
    def smooth(self) -> Limits:
        """A closed form is right at any step; this one keeps the straight lines between steps, by which files are
        sampled, within 0.05 % of the waves."""
        return Limits(force=SMOOTH * self.scale[1])

    def ledger(self, preflight: Preflight) -> list[LedgerRow]:
        n, word = len(self.sea(preflight.tank).amplitude), preflight.word
        return [
            LedgerRow("fluid", f"{n} plane waves", 6 * word * n, "fluid.kind is linear_waves: no particles", ADVANCE)
        ]

    def build(self, basin: Basin, seed: int, *, accounts: bool, wind: Wind) -> "LinearWaves":
        return LinearWaves(self, basin)


@ti.data_oriented
class LinearWaves(Fluid):
    """The waves at one time; what they do follows from it."""

    sound_speed = 0.0  # [m/s] nothing is compressed

    def __init__(self, config: Config, basin: Basin) -> None:
        self.config, self.sea = config, config.sea(basin)
        k = float(waves.wavenumber(2.0 * np.pi / config.scale[1], basin.depth, self.sea.gravity))
        self.spacing = 2.0 * np.pi / k / POINTS_PER_WAVE  # [m] between points that show the waves
        self.still = config.smooth
        self.reference_speed = (self.sea.gravity * basin.depth) ** 0.5
        speed = self.sea.amplitude * self.sea.gravity * self.sea.wavenumber / self.sea.omega  # [m/s] at the surface
        self.rest_density = density = config.rest_density
        fastest, hardest = np.linalg.norm(speed), np.linalg.norm(speed * self.sea.omega)  # sqrt 2 deviations if random
        self.status = Status(float(fastest), float(hardest), density, density, 0, True)
        n = len(speed)
        self.amplitude, self.phase, self.k, self.kx, self.kz, self.speed = (ti.field(float, shape=n) for _ in range(6))
        self.begin(self.sea)

    @property
    def plane_waves(self) -> waves.Components:
        return self.sea

    def begin(self, sea: waves.Components) -> None:
        """These waves from time 0 on; as many as there were, of the same depth."""
        self.sea, self.time = sea, 0.0
        self.take(self.amplitude, sea.amplitude)
        self.take(self.k, sea.wavenumber)
        self.take(self.kx, sea.wavevector[:, 0])
        self.take(self.kz, sea.wavevector[:, 1])
        self.take(self.speed, sea.amplitude * sea.gravity * sea.wavenumber / sea.omega)
        self.advance(0.0)

    def take(self, field: ti.Field, values: np.ndarray) -> None:
        """Numbers into a field of its own precision."""
        field.from_numpy(np.ascontiguousarray(values, dtype=field.to_numpy().dtype))

    def advance(self, dt: float) -> None:
        """One step of dt [s]; phases are kept in f64 and small, whatever the precision of the run and its length."""
        self.time += dt
        self.take(self.phase, np.mod(self.sea.phase - self.sea.omega * self.time, 2.0 * np.pi))

    def limits(self) -> Limits:
        return self.still

    def internal_energy(self) -> float:
        """0: nothing is compressed [J]."""
        return 0.0

    @ti.func
    def elevation(self, x, z):
        eta = 0.0
        for i in range(self.amplitude.shape[0]):
            eta += self.amplitude[i] * ti.cos(self.kx[i] * x + self.kz[i] * z + self.phase[i])
        return eta

    @ti.func
    def stretched(self, position, eta):
        """Wheeler's y' [m] of a position under an elevation."""
        h = ti.static(self.sea.depth)
        return ti.min(h * (position.y - eta) / ti.max(h + eta, 1e-6 * h), 0.0)

    @ti.func
    def velocity(self, position):
        y = self.stretched(position, self.elevation(position.x, position.z))
        h = ti.static(self.sea.depth)
        v = tm.vec3(0.0)
        for i in range(self.amplitude.shape[0]):
            k, angle = self.k[i], self.kx[i] * position.x + self.kz[i] * position.z + self.phase[i]
            scale = self.speed[i] * ti.exp(k * y) / (1.0 + ti.exp(-2.0 * k * h))
            mirrored = ti.exp(-2.0 * k * (y + h))
            along = scale * (1.0 + mirrored) * ti.cos(angle) / k
            v += tm.vec3(self.kx[i] * along, scale * (1.0 - mirrored) * ti.sin(angle), self.kz[i] * along)
        return v

    @ti.func
    def acceleration(self, position):
        """[m/s2] by linear theory, -grad p / rho less gravity: what a body that is small against the waves feels."""
        y = self.stretched(position, self.elevation(position.x, position.z))
        h, g = ti.static(self.sea.depth), ti.static(self.sea.gravity)
        a = tm.vec3(0.0)
        for i in range(self.amplitude.shape[0]):
            k, angle = self.k[i], self.kx[i] * position.x + self.kz[i] * position.z + self.phase[i]
            scale = g * self.amplitude[i] * ti.exp(k * y) / (1.0 + ti.exp(-2.0 * k * h))
            mirrored = ti.exp(-2.0 * k * (y + h))
            along = scale * (1.0 + mirrored) * ti.sin(angle)
            a += tm.vec3(self.kx[i] * along, -k * scale * (1.0 - mirrored) * ti.cos(angle), self.kz[i] * along)
        return a

    @ti.func
    def pressure(self, position):
        eta = self.elevation(position.x, position.z)
        y = self.stretched(position, eta)
        h = ti.static(self.sea.depth)
        head = -position.y
        for i in range(self.amplitude.shape[0]):
            k, angle = self.k[i], self.kx[i] * position.x + self.kz[i] * position.z + self.phase[i]
            profile = ti.exp(k * y) * (1.0 + ti.exp(-2.0 * k * (y + h))) / (1.0 + ti.exp(-2.0 * k * h))
            head += self.amplitude[i] * profile * ti.cos(angle)
        return ti.select(position.y < eta, self.config.rest_density * self.sea.gravity * head, 0.0)

    def elevations(self, points: np.ndarray) -> np.ndarray:
        """(m, 2) points x, z [m] -> (m,) heights [m]."""
        return waves.elevation(self.sea, np.asarray(points, dtype=float), self.time)

    def velocities(self, points: np.ndarray) -> np.ndarray:
        """(m, 3) points [m] -> (m, 3) velocities [m/s]; above the water that of its surface."""
        return waves.velocity(self.sea, np.asarray(points, dtype=float), self.time)

    def pressures(self, points: np.ndarray) -> np.ndarray:
        """(m, 3) points [m] -> (m,) pressures [Pa]; 0 above the water."""
        return waves.pressure(self.sea, np.asarray(points, dtype=float), self.time, self.config.rest_density)
