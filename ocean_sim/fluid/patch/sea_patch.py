"""Forcing of a patch of open sea: a band opposite the ship that relaxes particles towards the sea, and a feed.

A table over the patch and some depths holds the sea's velocity and its feed (acceleration that makes up for the
scheme's losses). It is written forty times in a period of the highest waves and is linear in time between; it is cubic
across the patch and in the square root of the depth. Above the still level velocities go on along their slope there
(Rodenbusch & Forristall 1986, OTC 5098).
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import ClassVar, NamedTuple

import numpy as np

from ocean_sim import waves
from ocean_sim.basin import whole_sides
from ocean_sim.columns import vec3
from ocean_sim.fluid import Displacing
from ocean_sim.fluid.open_sea.wave_sheet import cubic_weights
from ocean_sim.fluid.open_sea.wave_tile import Tile
from ocean_sim.fluid.patch.relaxation_zone import RelaxationBand, rim_depth, tile_cells
from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.runtime import Template, in_kernels
from ocean_sim.waves import Components
from ocean_sim.waves.absorption import DAMPING_POWER

WRITES_PER_PERIOD = 40  # writes in a period of the highest waves
NODES_PER_WAVE, MIN_NODES, MAX_NODES = 8, 16, 512  # nodes to the shortest wave, and along an axis of the patch
CELLS_PER_WAVE = 4  # cells to the shortest wave of a nonlinear sea
TABLE_LEVELS = 10  # levels at and below the still level; one more lies above it
NODE_VALUES = 6  # values of a node: velocity [m/s] and its feed [m/s2]


def wave_counts(band: RelaxationBand, sea: Components) -> np.ndarray:
    """Number (n, 2) of wavelengths of each wave of a `sea` along the sides x and z of the patch of `band`."""
    return np.round(sea.wavevector * np.array(band.lattice.basin.periods)[::2] / (2.0 * np.pi)).astype(int)


class Depths(NamedTuple):
    """Levels of a SeaTable [m]: down to `deepest`, ever further apart, and one level `above` still water."""

    deepest: float
    above: float
    bed: float  # the depth of the water

    def profiles(self, k: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Yield for each level the horizontal and vertical velocity (n,) of waves with wavenumbers k (n,) [rad/m],
        divided by their velocity amplitude at the still level (wave amplitude times g k / omega)."""
        for level in range(TABLE_LEVELS):
            yield waves.profiles(k, -self.deepest * (level / (TABLE_LEVELS - 1)) ** 2, self.bed)
        (c, s), slope = waves.profiles(k, 0.0, self.bed), np.tanh(k * self.bed)
        yield c + k * self.above * slope, s + k * self.above


class PlaneWaveSource:
    """Linear sea (sum of plane waves, not yet grown by the ramp) for a SeaTable, a grid over a patch of particles."""

    left_out: ClassVar[tuple[str, ...]] = ("shapes", "places")

    def __init__(self, band: RelaxationBand, sea: Components, depths: Depths, count: tuple[int, ...]) -> None:
        self.sea, self.count = sea, count
        self.places = tuple(wave_counts(band, sea)[:, axis] % count[axis] for axis in range(2))
        k, (kx, kz) = sea.wavenumber, sea.wavevector.T
        speed, lower = sea.amplitude * sea.gravity * k / sea.omega, band.lattice.basin.lower
        shape = np.array([np.stack([kx / k * c, -1j * s, kz / k * c]) for c, s in depths.profiles(k)])
        velocity = speed * shape * np.exp(1j * (kx * lower[0] + kz * lower[2]))
        self.shapes = np.concatenate([velocity, band.feed * velocity], axis=1)
        """(levels, values, n) contribution of each wave at the lower corner of the patch and phase 0."""

    def modes(self, time: float) -> np.ndarray:
        """Fourier modes (depths, 6, nodes x, nodes z) at a time [s]: velocity (3), feed (3: against losses [m/s2])."""
        found = np.zeros((TABLE_LEVELS + 1, NODE_VALUES, *self.count), dtype=np.complex128)
        origin_phase = np.exp(1j * np.mod(self.sea.phase - self.sea.omega * time, 2.0 * np.pi))
        found[:, :, self.places[0], self.places[1]] = self.shapes * origin_phase
        return found


class SteepSource:
    """Nonlinear sea on a grid (tile) over the patch, one cell a particle spacing, which writes a SeaTable. A wave's
    feed, the acceleration that makes up for the scheme's losses, is a complex f times its velocity. Modes P of
    potential, E of elevation are waves along the wavevector, P / 2 - i g E / (2 omega), fed by f, and waves against it,
    the rest of P, fed by its conjugate: added up, the feed has the potential Re f P + Im f g E / omega."""

    left_out: ClassVar[tuple[str, ...]] = ("shapes", "feed_factors", "origin_phase", "places")

    def __init__(self, band: RelaxationBand, sea: Components, depths: Depths, count: tuple[int, ...]) -> None:
        from ocean_sim.fluid.open_sea.high_order import nonlinear_sea, tile_step  # a linear sea does without it

        assert band.nonlinear is not None
        basin, (cells, rows) = band.lattice.basin, tile_cells(band)
        tile = Tile(basin.periods[0], cells, rows, basin.depth, sea.gravity)
        self.sea = nonlinear_sea(replace(sea, ramp=0.0), tile, *band.nonlinear, sea.period)
        self.step, self.count = tile_step(tile), count
        self.feed_factors = feed_factors(band, sea, self.sea.tile)
        tile = self.sea.tile
        kx, kz, k = 1j * tile.kx + 0.0 * tile.kz, 1j * tile.kz + 0.0 * tile.kx, tile.k
        self.shapes = [np.stack([kx * c, k * s, kz * c]) for c, s in depths.profiles(k)]
        first = [axis[0] for axis in tile.nodes()]
        lower = (basin.lower[0], basin.lower[2] if rows > 1 else first[1])
        self.origin_phase = np.exp(kx * (lower[0] - first[0]) + kz * (lower[1] - first[1])) / (cells * rows)
        along = np.round(np.fft.fftfreq(cells) * cells).astype(int)
        self.places = (along % count[0])[:, None], (np.arange(tile.columns) % count[1])[None, :]

    def modes(self, time: float) -> np.ndarray:
        """Advance the sea to a time [s]; return its modes of velocity (3), feed (3), as PlaneWaveSource.modes does."""
        left = time - self.sea.time
        for _ in range(steps := int(np.ceil(left / self.step - 1e-9))):
            self.sea.advance(left / steps)
        e, below, _ = self.sea.potentials()
        # Until it has set in, the potential at the still level is that of a linear sea.
        part = self.sea.nonlinear_share(time)
        potential = part * below + (1.0 - part) * self.sea.tile.to_modes(self.sea.phi)
        real, crossed = self.feed_factors
        both = self.sea.resolved_modes * self.origin_phase * np.array([potential, real * potential + crossed * e])
        found = np.zeros((len(self.shapes), NODE_VALUES, *self.count), dtype=np.complex128)
        for level, shape in enumerate(self.shapes):
            for n, of in enumerate(both):
                three = found[level, 3 * n : 3 * n + 3]
                three[:, self.places[0], self.places[1]] = shape * of
        found[..., 1 : self.sea.tile.columns] *= 2.0  # so that the real part of their complex Fourier sum is the field
        return found


def feed_factors(band: RelaxationBand, sea: Components, tile: Tile) -> tuple[np.ndarray, np.ndarray]:
    """Factors Re f, Im f g / omega (cells, columns) for a tile's modes of potential and of elevation: both products add
    up to the potential of the feed, f [1/s] times velocity, against the scheme's losses (see SteepSource)."""
    order = np.argsort(sea.wavenumber)
    k, f = sea.wavenumber[order], band.feed[order]
    real, imaginary = (np.interp(tile.k, k, of) for of in (f.real, f.imag))
    return real, np.divide(imaginary * tile.gravity, tile.omega, out=np.zeros(tile.k.shape), where=tile.omega > 0.0)


def table_nodes(band: RelaxationBand, sea: Components) -> tuple[int, ...]:
    """Numbers of nodes along x, z of the SeaTable (velocities of `sea` on a patch of `band`), by the shortest wave."""
    periods = band.lattice.basin.periods[::2]
    crests = np.abs(wave_counts(band, sea)).max(axis=0)
    if band.nonlinear is not None:
        crests = np.array(tile_cells(band)) // CELLS_PER_WAVE
    counts = np.clip(NODES_PER_WAVE * crests, MIN_NODES, MAX_NODES)
    return tuple(int(n) if period else 1 for n, period in zip(counts, periods))


def table_bytes(band: RelaxationBand, sea: Components, word: int) -> int:
    """Memory [bytes] of the SeaTable (velocities, accelerations) of a sea on a patch; `word`: bytes of a `float`."""
    x, z = table_nodes(band, sea)
    return 3 * x * z * (TABLE_LEVELS + 1) * NODE_VALUES * word


@in_kernels
class SeaTable:
    """Table over x, z of a patch and depth: the sea's velocity and feed (acceleration against the scheme's losses)."""

    def __init__(self, band: RelaxationBand, sea: Components) -> None:
        basin, self.sea = band.lattice.basin, sea
        self.every = sea.period / WRITES_PER_PERIOD
        self.depth = min(basin.depth, sea.wavelength)  # [m] below which velocities are those there
        self.above = max(sea.significant_height, 1e-3 * self.depth)  # [m]
        self.count = table_nodes(band, sea)
        self.lower = (basin.lower[0], basin.lower[2])
        self.per_cell = tuple(n / (period or 1.0) for n, period in zip(self.count, basin.periods[::2]))
        depths = Depths(self.depth, self.above, sea.depth)
        kind: type[PlaneWaveSource | SteepSource] = PlaneWaveSource if band.nonlinear is None else SteepSource
        self.source = kind(band, sea, depths, self.count)
        shape = (*self.count, TABLE_LEVELS + 1, NODE_VALUES)
        self.slots, self.now = ti.field(float, shape=(2, *shape)), ti.field(float, shape=shape)
        self.begun = 0  # number of the time that the first slot holds
        self.write_slot(0, 0.0)
        self.write_slot(1, self.every)

    def write_slot(self, slot: int, time: float) -> None:
        """Write the sea at a time [s] to slot 0 or 1; the table is interpolated between the times of both slots."""
        from scipy.fft import ifft2

        modes, sea = self.source.modes(time), self.sea
        velocity, fed = modes[:, :3], modes[:, 3:]
        fed[:] = sea.ramp_share(time) * fed + 2.0 * sea.ramp_rate(time) * velocity
        velocity *= sea.ramp_share(time)
        values = ifft2(modes, norm="forward", workers=1).real
        self.store_slot(slot, np.ascontiguousarray(values.transpose(2, 3, 0, 1), dtype=to_numpy_type(self.now.dtype)))

    def advance(self, time: float) -> None:
        """Interpolate the table to a time [s] between its two stored ones (slots); before, write the later if due."""
        share = time / self.every - self.begun
        while share > 1.0 + 1e-9:
            self.begun, share = self.begun + 1, share - 1.0
            self.shift_slots()
            self.write_slot(1, (self.begun + 1) * self.every)
        self.interpolate_slots(share)

    @ti.kernel
    def store_slot(self, slot: int, values: ti.types.ndarray(ndim=4)):  # type: ignore[valid-type]
        for i in ti.grouped(self.now):
            self.slots[slot, i] = values[i]

    @ti.kernel
    def shift_slots(self):
        for i, k in ti.ndrange(*self.count):
            for l, c in ti.ndrange(TABLE_LEVELS + 1, NODE_VALUES):  # a node's numbers lie in a row
                self.slots[0, i, k, l, c] = self.slots[1, i, k, l, c]

    @ti.kernel
    def interpolate_slots(self, share: float):
        """Interpolate the table between its two stored times, at a `share` of the way from slot 0 to slot 1."""
        for i, k in ti.ndrange(*self.count):
            for l, c in ti.ndrange(TABLE_LEVELS + 1, NODE_VALUES):
                self.now[i, k, l, c] = tm.mix(self.slots[0, i, k, l, c], self.slots[1, i, k, l, c], share)

    @ti.func
    def level_weights(self, y):
        """Indices (4,) of the table's levels around a height y [m], and their interpolation weights (4,)."""
        last = TABLE_LEVELS - 1
        at = tm.min(ti.sqrt(tm.max(-y, 0.0) / self.depth), 1.0) * last
        first = tm.clamp(int(at) - 1, 0, last - 3)
        s = at - first
        level = ti.Vector([first, first + 1, first + 2, first + 3])
        weight = tm.vec4(
            -(s - 1.0) * (s - 2.0) * (s - 3.0) / 6.0,
            0.5 * s * (s - 2.0) * (s - 3.0),
            -0.5 * s * (s - 1.0) * (s - 3.0),
            s * (s - 1.0) * (s - 2.0) / 6.0,
        )
        if y > 0.0:
            rise = tm.min(y / self.above, 2.0)
            level, weight = ti.Vector([0, TABLE_LEVELS, 0, 0]), tm.vec4(1.0 - rise, rise, 0.0, 0.0)
        return level, weight

    @ti.func
    def node_weights(self, x, axis: Template):
        """Index of the first of four nodes around x [m] along an axis, and their interpolation weights (4,)."""
        at = (x - self.lower[axis]) * self.per_cell[axis]
        i = int(ti.floor(at))
        return i - 1, cubic_weights(at - i)

    @ti.func
    def sample(self, x):
        """Velocity [m/s] of the sea and feed (acceleration [m/s2] against the scheme's losses) at x [m]: 6 numbers."""
        n, m = ti.static(self.count)
        level, share = self.level_weights(x.y)
        i, along = self.node_weights(x.x, 0)
        total = ti.Vector.zero(float, NODE_VALUES)
        for p in range(4):
            cell = (i + p + n) % n
            if ti.static(m == 1):
                total += along[p] * self.sample_column(cell, 0, level, share)
            else:
                k, across = self.node_weights(x.z, 1)
                for q in range(4):
                    total += along[p] * across[q] * self.sample_column(cell, (k + q + m) % m, level, share)
        return total

    @ti.func
    def sample_column(self, i, k, level, share):
        """Velocity and feed (as in `sample`) at node i, k by four depths: indices `level`, weights `share` (4,)."""
        total = ti.Vector.zero(float, NODE_VALUES)
        for l in ti.static(range(4)):
            for c in ti.static(range(NODE_VALUES)):
                total[c] += share[l] * self.now[i, k, level[l], c]
        return total


@in_kernels
class SeaRim:
    """Forcing of particles towards the sea: relaxation in a zone opposite the ships (or a moving point), and a feed,
    which returns the height that waves lose by the scheme."""

    left_out: ClassVar[tuple[str, ...]] = ("ships",)

    def __init__(self, band: RelaxationBand) -> None:
        basin = band.lattice.basin
        assert basin.sea is not None
        self.width, self.rate, self.velocity = band.width, band.rate, np.array(basin.sea.rim.velocity)
        self.periods = np.array(basin.periods)[[0, 2]]
        self.axes = tuple((axis, 2 * axis, float(p)) for axis, p in enumerate(self.periods) if p)
        self.waving = band.sea is not None
        self.fed = bool(band.feed.any()) or (band.sea is not None and band.sea.ramp > 0.0)
        if band.sea is not None:
            self.table = SeaTable(band, band.sea)
        self.ships: tuple[Displacing, ...] = ()
        self.middle = ti.field(float, shape=2)  # x, z opposite which it lies, on the patch [m]
        self.advance(0.0)

    def follow(self, ships: Sequence[Displacing]) -> None:
        """Keep the relaxation zone half a side of the patch, along each axis, from the mean position of these ships."""
        self.ships = tuple(ships)
        self.place_band(0.0)

    def centre_at(self, time: float) -> np.ndarray:
        """Centre x, z (2,) in the world [m] of the patch at a time [s]: the ships' middle, or a moving point."""
        if self.ships:
            return np.mean([ship.body.position[[0, 2]] for ship in self.ships], axis=0)
        return self.velocity * time

    def on_patch(self, points: np.ndarray) -> np.ndarray:
        """Points x, z (..., 2) [m] moved by whole periods onto the patch at the origin; 0 on an axis without period."""
        return np.where(self.periods > 0.0, points - whole_sides(points, self.periods), 0.0)

    def place_band(self, time: float) -> None:
        """Move the relaxation zone to its position at a time [s]."""
        at = self.on_patch(self.centre_at(time))
        self.middle.from_numpy(at.astype(to_numpy_type(self.middle.dtype)))

    def contains(self, points: np.ndarray, time: float) -> np.ndarray:
        """Mask (m,) of the points x, z (m, 2) in the world [m] that lie in the relaxation zone at a time [s]."""
        return rim_depth(points - self.centre_at(time), self.periods, self.width) > 0.0

    def advance(self, time: float) -> None:
        """Move the relaxation zone and interpolate the table of the sea to a time [s]."""
        self.place_band(time)
        if self.waving:
            self.table.advance(time)

    @ti.func
    def rim_share(self, x):
        """Depth of x [m] in the relaxation zone over its width: 0 outside, 1 half a period away from the ships."""
        far = 0.0
        for axis, k, period in ti.static(self.axes):
            xi = x[k] - self.middle[axis]
            xi -= period * ti.round(xi / period)
            far = tm.max(far, (ti.abs(xi) - (0.5 * period - self.width)) / self.width)
        return tm.min(far, 1.0)

    @ti.func
    def acceleration(self, x, v, dt):
        """Acceleration [m/s2] by the sea over dt [s], at x [m]; v: velocity [m/s] at the step's end without it."""
        s, a = self.rim_share(x), tm.vec3(0.0)
        # The relaxation is implicit in time: no step overshoots the sea, however strong the rate.
        if s > 0.0 or ti.static(self.fed):
            rate = self.rate * tm.max(s, 0.0) ** DAMPING_POWER
            if ti.static(self.waving):
                sea = self.table.sample(x)
                a = rate / (1.0 + rate * dt) * (vec3(sea, 0) - v) + vec3(sea, 3)
            else:
                a = -rate / (1.0 + rate * dt) * v
        return a
