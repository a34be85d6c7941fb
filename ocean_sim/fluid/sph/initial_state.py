"""The states that water may start from: still, waves in mid-flight, a Taylor-Green vortex, or a file of particles.

Waves are those of linear theory. The lattice is carried to where it is by the flow of the theory's displacement, which
is free of divergence, so it keeps its density to all orders; its crests then are those of Stokes to second order. The
velocity is the theory's there: free of divergence and rotation. A particle's pressure follows it: hydrostatic
where it rests, and rho g (pressure head - rise) of linear theory there, which is zero on the surface.
"""

from collections.abc import Iterator
from dataclasses import replace
from math import pi
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from ocean_sim import waves
from ocean_sim.basin import Basin
from ocean_sim.files import csv_file
from ocean_sim.files.input_file import Checked, FileName, Rule, Unreadable, display_path, read_npz
from ocean_sim.model import Faults, Model, quantity
from ocean_sim.random_numbers import numpy_uniform3

State = tuple[np.ndarray, np.ndarray, np.ndarray]  # positions (n, 3) [m], velocities (n, 3) [m/s], pressures (n,) [Pa]
ONE_COLUMN = Rule("a column is known by its name before the first _, and there is one of each")
UNIQUE_ROWS = Rule("each particle is there once: no two rows have the same place and velocity")
CHECKED_FILE = "Particles, `fluid.initial.file.path`: a table, or an npz file of arrays"
CHECKS = (Checked(CHECKED_FILE, (ONE_COLUMN, UNIQUE_ROWS)),)

DISORDER_STREAM = 0x4_0000  # stream of random numbers
FLOW_STEPS = 4  # Runge-Kutta steps along a displacement
MAX_FIT_CHANGE = 0.01  # part of its wavenumber by which a wave may be changed to fit a periodic basin
MIN_WAVE_SPACINGS = 10.0  # [spacings] shortest wave of a random sea: shorter ones, fed, become up to 3 times too high
NOTABLE_LOST_VARIANCE = 0.02  # share of the variance in waves that are shorter: worth a warning
MAX_STANDING_STEEPNESS = 0.218  # height over wavelength, over tanh(kh), of a standing wave that breaks (Wiegel 1964)


class Start(Model):
    """Keys common to all initial states."""

    def sea(self, basin: Basin) -> waves.Components | None:
        """Waves of this state; None for a state without waves."""
        return None


class StandingWave(Start):
    """A standing wave along x; its crest or trough stands at both ends of the basin."""

    kind: Literal["standing_wave"] = "standing_wave"
    height: float | None = quantity("m", None, gt=0.0)
    """Height from trough to crest."""
    amplitude: float | None = quantity("m", None, gt=0.0)
    """Half of `height`, given in its place."""
    mode: int = quantity("1", 1, ge=1)
    """Half wavelengths in the length of the basin."""
    phase: Literal["crest", "flat"] = "crest"
    """`crest`: highest and at rest, with a crest at x_min; `flat`: as flat as still water and in fastest motion."""

    def contradictions(self) -> Iterator[str]:
        if (self.height is None) == (self.amplitude is None):
            yield "give either height [m] or amplitude [m], half of it"

    def sea(self, basin: Basin) -> waves.Components:
        """Two equal waves in opposite directions: together A cos k(x - x_min) cos omega t, or sin omega t."""
        half = (self.amplitude or (self.height or 0.0) / 2.0) / 2.0
        k = self.mode * pi / basin.config.length
        shift, late = -k * basin.lower[0], 0.5 * pi if self.phase == "flat" else 0.0
        amplitude, wavevector = np.array([half, half]), np.array([[k, 0.0], [-k, 0.0]])
        phase, g = np.array([shift + late, -shift + late]), waves.downward_gravity(basin)
        return waves.Components(amplitude, wavevector, phase, basin.depth, g)

    def problems(self, basin: Basin) -> Faults:
        """Yield faults (key, sentence) of a wave that would break, or that fits no periodic basin."""
        for sentence in waves.basin_faults(basin):
            yield ("kind",), sentence
            return
        length = 2.0 * basin.config.length / self.mode
        most = MAX_STANDING_STEEPNESS * length * float(np.tanh(2.0 * pi * basin.depth / length))
        if 4.0 * self.sea(basin).amplitude[0] > most:
            key = "height" if self.amplitude is None else "amplitude"
            yield (key,), f"a standing wave of {length:.3g} m would break: at most it is {most:.3g} m high"
        if basin.periods[0] and self.mode % 2:
            yield ("mode",), f"x is periodic: the mode must be even, got {self.mode}"

    def state(self, positions: np.ndarray, basin: Basin, density: float) -> State:
        """State at time 0 of water of rest `density` [kg/m3] that at rest lies at `positions` (n, 3) [m]."""
        return displaced_state(self.sea(basin), positions, basin, density)


class RegularWave(Start):
    """A regular wave that travels through periodic sides."""

    kind: Literal["regular_wave"] = "regular_wave"
    height: float = quantity("m", gt=0.0)
    """Height from trough to crest."""
    period: float = quantity("s", gt=0.0)
    """Period of the wave; its wavelength must fit the basin."""
    heading_deg: float | None = quantity("deg", None)
    """Direction of travel: 0 along +z, 90 along +x; by default 0, in 2-D 90."""

    def sea(self, basin: Basin) -> waves.Components:
        """Wave as the keys state it, before it is fitted to the basin."""
        towards = waves.heading_vector(self.heading_deg, basin.dimension)
        return waves.regular_wave(self.height, self.period, towards, basin.depth, waves.downward_gravity(basin))

    def problems(self, basin: Basin) -> Faults:
        """Yield faults (key, sentence) of a wave too steep, not periodic in the basin, or running into walls."""
        found = [(("height",), sentence) for sentence in waves.basin_faults(basin, self.height, self.period)]
        found += [(("heading_deg",), sentence) for sentence in waves.heading_faults(self.heading_deg, basin)]
        yield from found
        if found:
            return
        sea = self.sea(basin)
        yield from ((("heading_deg",), sentence) for sentence in wall_problems(sea.wavevector[0], basin))
        wanted = fitted_waves(sea, basin)
        off = float(np.linalg.norm(wanted.wavevector[0] - sea.wavevector[0]) / sea.wavenumber[0])
        if off > MAX_FIT_CHANGE:
            (length, fits), period = 2.0 * pi / np.append(sea.wavenumber, wanted.wavenumber), 2.0 * pi / wanted.omega[0]
            wave = f"a wave of {self.period:g} s is {length:.4g} m long and does not repeat itself in the periodic"
            yield ("period",), f"{wave} basin; the nearest that does is {fits:.4g} m long: period {period:.5g}"

    def state(self, positions: np.ndarray, basin: Basin, density: float) -> State:
        return displaced_state(fitted_waves(self.sea(basin), basin), positions, basin, density)


class RandomWaves(Start):
    """Random waves that travel through periodic sides; each of their components is made to fit the basin."""

    kind: Literal["spectrum"] = "spectrum"
    spectrum: waves.Spectrum
    """Spectrum of the waves."""

    def sea(self, basin: Basin) -> waves.Components:
        """Waves as the spectrum states them, before they are fitted to the basin."""
        towards = waves.heading_vector(self.spectrum.heading_deg, basin.dimension)
        return self.spectrum.components(towards, basin.depth, waves.downward_gravity(basin))

    def problems(self, basin: Basin) -> Faults:
        """Yield faults (key, sentence) of waves too steep for the basin, or running into walls."""
        size = self.spectrum.significant_wave_height, self.spectrum.peak_period
        found = [(("spectrum", "significant_wave_height"), sentence) for sentence in waves.basin_faults(basin, *size)]
        heading = ("spectrum", "heading_deg")
        found += [(heading, sentence) for sentence in waves.heading_faults(self.spectrum.heading_deg, basin)]
        yield from found
        if not found:
            yield from ((heading, sentence) for sentence in wall_problems(self.sea(basin).wavevector[0], basin))

    def state(self, positions: np.ndarray, basin: Basin, density: float) -> State:
        kept = bearable_waves(self.sea(basin), self.spectrum.significant_wave_height, mean_spacing(positions, basin))
        return displaced_state(fitted_waves(kept, basin), positions, basin, density)


class TaylorGreen(Start):
    """The vortices of Taylor & Green (1937), one period in x and y, uniform along z."""

    kind: Literal["taylor_green"] = "taylor_green"
    speed: float = quantity("m/s", gt=0.0)
    """Highest speed along x."""
    disorder: float = quantity("spacings", 0.0, ge=0.0, lt=0.5)
    """Largest displacement of a particle from the lattice, along x and along y."""
    seed: int = quantity("1", 0, ge=0, lt=2**31)
    """Seed of the disorder."""

    def problems(self, basin: Basin) -> Faults:
        """Yield a fault (key, sentence) for each of x and y that is not periodic."""
        for axis in (0, 1):
            if not basin.periods[axis]:
                sentence = f"these vortices repeat themselves: {'xy'[axis]} must be periodic"
                yield ("kind",), f"{sentence} (basin.walls: {{{'xy'[axis]}: periodic}})"

    def state(self, positions: np.ndarray, basin: Basin, density: float) -> State:
        """State at time 0 of particles at `positions` (n, 3) [m], randomly disturbed; `density` at rest [kg/m3]."""
        a, b = 2.0 * pi / basin.config.length, 2.0 * pi / basin.depth
        kick = numpy_uniform3(self.seed, DISORDER_STREAM, np.arange(len(positions)), 0) * (1.0, 1.0, 0.0)
        placed = wrap_positions(positions + self.disorder * mean_spacing(positions, basin) * kick, basin)
        x, y = a * (placed[:, 0] - basin.lower[0]), b * (placed[:, 1] - basin.lower[1])
        u, v = -np.cos(x) * np.sin(y), a / b * np.sin(x) * np.cos(y)
        pressure = -0.25 * density * self.speed**2 * (np.cos(2.0 * x) + (a / b) ** 2 * np.cos(2.0 * y))
        return placed, self.speed * np.stack([u, v, np.zeros_like(u)], axis=1), pressure


class FromFile(Start):
    """The particles of a file, in place of the lattice."""

    kind: Literal["file"] = "file"
    path: FileName
    """A CSV file with column names, or an npz file: x, y, z [m], u, v, w [m/s], and p [Pa] where it is known. In 2-D
    without z and w."""

    def columns(self) -> dict[str, np.ndarray]:
        """Columns (n,) of the file by name without unit; raise Unreadable if not numbers, or a name is ambiguous."""
        found = read_npz(self.path) if self.path.endswith(".npz") else csv_file.Table(self.path)
        unnumbered = [name for name, column in found.items() if column.dtype.kind not in "iuf" or column.ndim > 1]
        if unnumbered:
            raise Unreadable(self.path, f"{unnumbered[0]} is not a column of numbers")
        short = {name: name.split("_")[0] for name in found}
        if (name := csv_file.first_duplicate([*short.values()])) is not None:
            alike = " and ".join(long for long in short if short[long] == name)
            raise ONE_COLUMN.broken(self.path, f"it has {alike}")
        return {short[name]: np.atleast_1d(column).astype(float) for name, column in found.items()}

    def problems(self, basin: Basin) -> Faults:
        """Yield faults (key, sentence) of a file that is unreadable, lacks columns, or leaves the basin."""
        try:
            columns = self.columns()
        except Unreadable as error:
            yield ("path",), f"{error}"
            return
        missing = [name for name in ("xyuv" if basin.dimension == 2 else "xyzuvw") if name not in columns]
        sizes = {column.shape for column in columns.values()}
        if missing:
            yield ("path",), f"{display_path(self.path)} has no column {' and no column '.join(missing)}"
        elif len(sizes) != 1 or sizes == {(0,)}:
            yield ("path",), f"the columns of {display_path(self.path)} must be of one length, and not empty"
        elif len(wrong := np.argwhere(~np.isfinite([*columns.values()]).T)):
            (row, k), names = wrong[0], [*columns]
            found = f"{names[k]} is {columns[names[k]][row]} in row {row + 1}"
            yield ("path",), f"{csv_file.FINITE_NUMBERS_RULE.broken(self.path, found)}"
        else:
            positions = self.positions(basin)
            rows = np.hstack([positions, column_vectors(columns, "uvw", basin)])
            _, first, count = np.unique(rows, axis=0, return_index=True, return_counts=True)
            if len(first) < len(rows):
                row = int(first[count > 1].min())
                found = f"{len(rows) - len(first)} rows repeat others, the first row {row + 1}"
                yield ("path",), f"{UNIQUE_ROWS.broken(self.path, found)}"
            low, up = np.array(basin.lower), np.array(basin.upper)
            outside = np.flatnonzero(((positions < low - 1e-9) | (positions > up + 1e-9)).any(axis=1))
            if len(outside):
                x, y, z = positions[outside[0]]
                yield ("path",), f"{len(outside)} particles are outside the basin, the first at ({x:g}, {y:g}, {z:g}) m"

    def positions(self, basin: Basin) -> np.ndarray:
        """Positions (n, 3) [m] of the file's particles; z is 0 in 2-D."""
        return column_vectors(self.columns(), "xyz", basin)

    def state(self, positions: np.ndarray, basin: Basin, density: float) -> State:
        """State in the file; if without pressures, hydrostatic by `density` [kg/m3]; `positions` is not used."""
        columns = self.columns()
        placed, velocity = (column_vectors(columns, names, basin) for names in ("xyz", "uvw"))
        return placed, velocity, columns.get("p", still_pressure(placed, basin, density, 0.0))


Initial = Annotated[StandingWave | RegularWave | RandomWaves | TaylorGreen | FromFile, Field(discriminator="kind")]


def start_state(
    initial: Initial | None, positions: np.ndarray, basin: Basin, density: float, surface: float | np.ndarray = 0.0
) -> State:
    """State at time 0 of water that at rest lies at `positions` (n, 3) [m]; `surface`: still level [m], one or (n,)."""
    if initial is not None:
        return initial.state(positions, basin, density)
    sea = patch_waves(basin, mean_spacing(positions, basin)) if basin.sea is not None else None
    if sea is not None and not sea.ramp:
        return displaced_state(sea, positions, basin, density)
    return positions, np.zeros_like(positions), still_pressure(positions, basin, density, surface)


def problems(initial: Initial | None, basin: Basin) -> Faults:
    """Yield faults (path below `fluid.initial`, sentence) of an initial state in this basin; none without one."""
    found = [] if initial is None else list(initial.problems(basin))
    yield from found
    if initial is not None and basin.ground is not None and not found and initial.sea(basin) is not None:
        yield ("kind",), "these are waves over a flat bed; let basin.wavemaker make waves over this one"


def given_positions(initial: Initial | None, basin: Basin) -> np.ndarray | None:
    """Positions (n, 3) [m] of particles from a file, which replace a lattice; None without a file."""
    return initial.positions(basin) if isinstance(initial, FromFile) else None


def still_pressure(positions: np.ndarray, basin: Basin, density: float, surface: float | np.ndarray) -> np.ndarray:
    """Hydrostatic pressure (n,) [Pa] at `positions` (n, 3) [m] below a `surface` at this height [m], one or (n,); 0 if
    y is periodic or gravity not downward."""
    pull = 0.0 if basin.periods[1] else max(0.0, -basin.gravity[1])
    return density * pull * np.maximum(surface - positions[:, 1], 0.0)


def displaced_state(sea: waves.Components, positions: np.ndarray, basin: Basin, density: float) -> State:
    """State at time 0, in these waves, of water of rest `density` [kg/m3] that rests at `positions` (n, 3) [m]."""
    placed, leap = positions.astype(float), 1.0 / FLOW_STEPS
    for _ in range(FLOW_STEPS):
        a = waves.displacement(sea, placed)
        b = waves.displacement(sea, placed + 0.5 * leap * a)
        c = waves.displacement(sea, placed + 0.5 * leap * b)
        d = waves.displacement(sea, placed + leap * c)
        placed = placed + leap / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    rise = waves.displacement(sea, positions)[:, 1]
    head = waves.pressure_head(sea, positions) - rise - positions[:, 1]
    return wrap_positions(placed, basin), waves.linear_velocity(sea, placed), density * sea.gravity * head


def bearable_waves(sea: waves.Components, height: float, shortest: float = 0.0) -> waves.Components:
    """Waves of a random `sea` with k < 2 / height (Stansberg et al. 2008), `height` being the significant height [m],
    and no shorter than `shortest` [m]; enlarged so that they have the variance of all."""
    k = sea.wavenumber
    found = sea.select((k < 2.0 / height) & (shortest * k < 2.0 * pi))
    share = np.linalg.norm(sea.amplitude) / np.linalg.norm(found.amplitude)
    return replace(found, amplitude=share * found.amplitude)


def fitted_waves(sea: waves.Components, basin: Basin) -> waves.Components:
    """Waves of a sea, each moved to the nearest wavevector that is periodic in the basin."""
    return waves.fit_periods(sea, basin.periods[::2])


def patch_waves(basin: Basin, spacing: float) -> waves.Components | None:
    """Waves of the sea around a patch (the part of it filled with particles), each of the nearest wavevector that is
    periodic in the basin; without random ones too short for a `spacing` [m]. None without sea."""
    sea = basin.sea.plane_waves(basin) if basin.sea is not None else None
    if sea is None or basin.sea is None:
        return None
    there = fitted_waves(bearable_waves(sea, basin.sea.significant_height) if sea.random else sea, basin)
    if sea.random:
        there = there.select((1.0 - 1e-9) * MIN_WAVE_SPACINGS * spacing * there.wavenumber <= 2.0 * pi)
    ramp = basin.sea.ramp
    if ramp is None:
        ramp = waves.RAMP_PERIODS * there.period if basin.afloat else 0.0
    return replace(there, ramp=ramp)


def wall_problems(wavevector: np.ndarray, basin: Basin) -> Iterator[str]:
    """Yield the reasons why a wave of this wavevector cannot travel in the basin: walls across its way."""
    for axis, k in zip((0, 2), wavevector):
        walls = [basin.walls.at(f"{'xyz'[axis]}_{end}") for end in ("min", "max")]
        if abs(k) > 1e-9 * np.linalg.norm(wavevector) and set(walls) - {"periodic", "none"}:
            name = "xyz"[axis]
            yield f"waves that travel along {name} need periodic sides there (basin.walls: {{{name}: periodic}})"


def wrap_positions(positions: np.ndarray, basin: Basin) -> np.ndarray:
    """Positions (n, 3) [m] moved by whole periods into the basin along periodic axes."""
    placed = positions.copy()
    for axis, period in enumerate(basin.periods):
        if period:
            low = basin.lower[axis]
            placed[:, axis] = low + np.mod(placed[:, axis] - low, period)
    return placed


def mean_spacing(positions: np.ndarray, basin: Basin) -> float:
    """Distance between neighbours [m] if the n particles of `positions` filled the basin evenly."""
    return (basin.volume / len(positions)) ** (1.0 / basin.dimension)


def column_vectors(columns: dict[str, np.ndarray], names: str, basin: Basin) -> np.ndarray:
    """Vectors (n, 3) from the columns whose names are the letters of `names`; in 2-D the third component is 0."""
    flat = np.zeros_like(columns[names[0]])
    return np.stack([columns[names[0]], columns[names[1]], flat if basin.dimension == 2 else columns[names[2]]], axis=1)
