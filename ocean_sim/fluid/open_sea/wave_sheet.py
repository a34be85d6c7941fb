"""Waves on a tile as kernels read them: their elevation, and their velocity and acceleration on a few levels below.

Two times are kept, and straight lines between them. The levels lie ever farther apart, from the still surface down to
the length of a wave of which PER_TILE fit on the tile; between them runs the cubic through the nearest four, and below
the last of them the waves fade as that wave does.
"""

from typing import ClassVar

import numpy as np

from ocean_sim.fluid.open_sea.wave_tile import PER_TILE, Tile
from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.runtime import Template, in_kernels
from ocean_sim.waves import profiles

SHEET_LEVELS = 6  # levels below the still surface, with it
WORDS_PER_CELL = 2 * (1 + 6 * SHEET_LEVELS)  # numbers a cell
CLOCK_COLUMNS = ("late", "first_x", "first_z", "centre_x", "centre_z")  # the last four [m]


@ti.func
def cubic_weights(s):
    """Cubic weights (4,) of adjacent values at a share s from second to third (Keys 1981, IEEE Trans. ASSP 29)."""
    return tm.vec4(
        0.5 * s * (-1.0 + s * (2.0 - s)),
        0.5 * (2.0 + s * s * (3.0 * s - 5.0)),
        0.5 * s * (1.0 + s * (4.0 - 3.0 * s)),
        0.5 * s * s * (s - 1.0),
    )


@in_kernels
class Sheet:
    """Waves on a tile (grid of sea) as Taichi fields. Beyond it water is calm, or periodic if the sheet `repeats`."""

    left_out: ClassVar[tuple[str, ...]] = ("profiles",)
    now: ClassVar[int] = 0  # row of the clock: at the end of the water's last step,
    before: ClassVar[int] = 1  # and at its beginning

    def __init__(self, tile: Tile, repeats: bool) -> None:
        self.tile, self.repeats = tile, repeats
        self.cell, self.cells, self.rows = tile.cell, tile.cells, tile.rows
        deepest = min(tile.depth, tile.side / PER_TILE)
        self.depths = tuple(float(d) for d in deepest * (np.arange(SHEET_LEVELS) / (SHEET_LEVELS - 1)) ** 2)  # [m]
        self.fading = 2.0 * np.pi * PER_TILE / tile.side if deepest < tile.depth else 0.0  # [1/m]
        self.level = ti.field(float, shape=(2, *tile.shape))  # [m]
        self.speed = ti.Vector.field(3, float, shape=(2, SHEET_LEVELS, *tile.shape))  # [m/s]
        self.pull = ti.Vector.field(3, float, shape=(2, SHEET_LEVELS, *tile.shape))  # [m/s2]
        self.clock = ti.field(ti.f64, shape=(2, len(CLOCK_COLUMNS)))
        self.real = to_numpy_type(self.level.dtype)
        self.profiles = [profiles(tile.k, -d, tile.depth) for d in self.depths]

    def write_modes(self, slot: int, e: np.ndarray, potential: np.ndarray, growth: np.ndarray) -> None:
        """Store waves in `slot` 0 or 1 (two times) from Fourier modes: elevation e, potential and its rate `growth`."""
        tile, modes = self.tile, [e]
        for c, s in self.profiles:
            for of in (potential, growth):
                x, z = tile.slopes(c * of)
                modes += [x, tile.k * s * of, z]
        single = np.complex64 if self.real == np.float32 else np.complex128
        values = tile.to_values(np.array(modes, dtype=single)).astype(self.real)
        self.store_values(slot, values)

    def set_clock(self, shares: tuple[float, float], drifts: np.ndarray, centre: np.ndarray) -> None:
        """Set for two times, now and the last step's start, `shares` (2,) of the way from stored time (slot) 0 to 1,
        `drifts` (2, 2) [m] by the current; set the tile's `centre` (2,) [m] in axes that move with the current."""
        tile = self.tile
        size = np.array([tile.side, tile.width])
        first = np.array([axis[0] for axis in tile.nodes()]) + size * np.round(centre / size)
        rows = [[late, *(first + drift), *(centre + drift)] for late, drift in zip(shares, drifts, strict=True)]
        self.clock.from_numpy(np.array(rows))

    @ti.kernel
    def store_values(self, slot: int, values: ti.types.ndarray(ndim=3)):  # type: ignore[valid-type]
        """Copy `values` (1 + 6 SHEET_LEVELS, cells, rows) to `slot` 0 or 1, one of the two stored times: elevation,
        then at each level (depth) three velocities and three accelerations."""
        for i, k in ti.ndrange(self.cells, self.rows):
            self.level[slot, i, k] = values[0, i, k]
            for l in range(SHEET_LEVELS):
                for c in ti.static(range(3)):
                    self.speed[slot, l, i, k][c] = values[1 + 6 * l + c, i, k]
                    self.pull[slot, l, i, k][c] = values[4 + 6 * l + c, i, k]

    @ti.func
    def locate_cell(self, x, z, when: Template):
        """Cell indices at x, z [m], shares of the way to the next, True if on the tile; `when`: `now` or `before`."""
        a, b = (x - self.clock[when, 1]) / self.cell, (z - self.clock[when, 2]) / self.cell
        i, k = int(ti.floor(a)), int(ti.floor(b))
        there = True
        if ti.static(not self.repeats):
            there = ti.abs(x - self.clock[when, 3]) < 0.5 * self.cell * self.cells
            if ti.static(self.rows > 1):
                there = there and ti.abs(z - self.clock[when, 4]) < 0.5 * self.cell * self.rows
        return i, k, ti.cast(a - i, float), ti.cast(b - k, float), there

    @ti.func
    def wrap_x(self, i):
        return i - self.cells * int(ti.floor(i / self.cells))

    @ti.func
    def wrap_z(self, k):
        return k - self.rows * int(ti.floor(k / self.rows))

    @ti.func
    def elevation(self, x, z, when: Template):
        """Elevation [m] at x, z [m]; `when`: `now`, or `before` for the beginning of the water's last step."""
        i, k, a, b, there = self.locate_cell(x, z, when)
        eta, late = 0.0, ti.cast(self.clock[when, 0], float)
        if there:
            u, v = cubic_weights(a), cubic_weights(b)
            for p in range(4):
                line, cell = 0.0, self.wrap_x(i + p - 1)
                for q in range(4):
                    other = self.wrap_z(k + q - 1)
                    line += v[q] * ((1.0 - late) * self.level[0, cell, other] + late * self.level[1, cell, other])
                eta += u[p] * line
        return eta

    @ti.func
    def velocity(self, x, z, depth, when: Template):
        """Velocity [m/s] at x, z and a Wheeler-stretched depth [m]; `when`: `now` or `before` the last step."""
        return self.interpolate(self.speed, x, z, depth, when)

    @ti.func
    def acceleration(self, x, z, depth, when: Template):
        """Acceleration [m/s2] at x, z and a Wheeler-stretched depth [m]; `when`: `now` or `before` the last step."""
        return self.interpolate(self.pull, x, z, depth, when)

    @ti.func
    def interpolate(self, field: Template, x, z, depth, when: Template):
        """Vector of `field`, `speed` [m/s] or `pull` (acceleration [m/s2]), at x, z, depth [m]; `when`: `now`, or
        `before` for the start of the last step: bilinear in the cell, cubic over levels, linear in time."""
        i, k, a, b, there = self.locate_cell(x, z, when)
        total, late = tm.vec3(0.0), ti.cast(self.clock[when, 0], float)
        if there:
            # Lagrange's cubic over the four levels around the depth, bilinear in the cell, linear in time.
            depths = ti.Vector(self.depths)
            d = ti.min(depth, depths[SHEET_LEVELS - 1])
            first = 0
            for l in ti.static(range(1, SHEET_LEVELS - 3)):
                if d > depths[l + 1]:
                    first = l
            i0, i1, k0, k1 = self.wrap_x(i), self.wrap_x(i + 1), self.wrap_z(k), self.wrap_z(k + 1)
            for l in range(first, first + 4):
                weight = 1.0
                for m in range(first, first + 4):
                    if m != l:
                        weight *= (d - depths[m]) / (depths[l] - depths[m])
                for slot in range(2):
                    time = (1.0 - late) if slot == 0 else late
                    near = (1.0 - b) * field[slot, l, i0, k0] + b * field[slot, l, i0, k1]
                    far = (1.0 - b) * field[slot, l, i1, k0] + b * field[slot, l, i1, k1]
                    total += weight * time * ((1.0 - a) * near + a * far)
            total *= ti.exp(-self.fading * (depth - d))
        return total
