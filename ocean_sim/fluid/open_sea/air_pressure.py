"""Wind on a surface without particles: the vertical part of its force, as a pressure on the surface.

The force is taken in the middle of each cell of a tile: on the sloping surface of the cell where the wind acts on
surfaces, and in a few slabs below it where it acts on mass. By linear theory a force f on every kilogram of a slab of
thickness dy moves a wave as the pressure -rho f dy sinh k(y+h) / sinh kh on the surface would: a wave shorter than the
slab is deep hardly feels it. Horizontal forces are left out: a stress drags water along and makes no waves here.
"""

from typing import Any, ClassVar

import numpy as np

from ocean_sim.fluid.open_sea.wave_tile import PER_TILE, Tile
from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.runtime import in_kernels
from ocean_sim.waves import profiles
from ocean_sim.wind import Wind

WIND_SLABS = 4  # slabs of water in which a wind acts on mass


@in_kernels
class AirPressure:
    """Vertical impulse of the wind on the water in each cell of a tile (periodic grid), summed over a step of it."""

    left_out: ClassVar[tuple[str, ...]] = ("weights",)

    def __init__(self, wind: Wind, tile: Tile, density: float) -> None:
        self.wind, self.tile, self.density = wind, tile, density
        self.cell, self.cells, self.rows = tile.cell, tile.cells, tile.rows
        deepest = min(tile.depth, tile.side / PER_TILE)
        edges = deepest * (np.arange(WIND_SLABS + 1) / WIND_SLABS) ** 2
        on_top = [0.0] if wind.needs_area else []
        self.middle = (*on_top, *(float(d) for d in 0.5 * (edges[1:] + edges[:-1])))  # depth of each [m]
        self.thick = (*on_top, *(float(d) for d in np.diff(edges)))  # [m]
        scale = np.maximum(np.tanh(tile.k * tile.depth), 1e-30)
        self.weights = [profiles(tile.k, -d, tile.depth)[1] / scale for d in self.middle]
        self.impulse = ti.field(ti.f64, shape=(len(self.middle), *tile.shape))  # upwards over area and density [m2/s]
        self.slope: Any = ti.Vector.field(2, float, shape=tile.shape) if wind.needs_area else None
        self.gathered = 0.0  # [s]

    @staticmethod
    def bytes(cells: int, word: int) -> int:
        """Memory [bytes] of the fields for a tile of `cells` cells in all; `word`: bytes of a `float`."""
        return cells * (8 * (WIND_SLABS + 1) + 2 * word)

    def set_slopes(self, along: np.ndarray, across: np.ndarray) -> None:
        """Set the surface slopes on which wind presses, `along` x and `across`, along z: (cells, rows) of the tile."""
        self.slope.from_numpy(np.stack([along, across], axis=-1).astype(to_numpy_type(self.slope.dtype)))

    def collect_impulse(self, dt: float, drift: np.ndarray, centre: np.ndarray) -> None:
        """Add the wind's impulse over dt [s] to each cell of the tile around `centre`, x, z (2,) [m] in axes that move
        with the current; `drift` (2,) [m]: way of these axes since the start."""
        first, clock = [axis[0] for axis in self.tile.nodes()], self.wind.clock
        self.add_impulses(clock.since, clock.step, dt, *(tm.vec2(*at) for at in (first, drift, centre)))
        self.gathered += dt

    def take_pressure(self) -> np.ndarray:
        """Fourier modes of the wind's mean pressure / density [m2/s2] by impulses since the last call; reset these."""
        tile, pushed = self.tile, self.impulse.to_numpy()
        modes = sum(weight * tile.to_modes(slab) for weight, slab in zip(self.weights, pushed))
        span, self.gathered = self.gathered, 0.0
        self.impulse.fill(0.0)
        return -modes / span if span else np.zeros(tile.k.shape)

    @ti.kernel
    def add_impulses(self, since: float, step: float, dt: float, first: tm.vec2, drift: tm.vec2, centre: tm.vec2):
        """Add the wind's upward impulse over dt [s] by cell and slab (layer of depth). `since`, `step` [s]: time since
        the wind clock's restart, its step; x, z [m]: middle of the `first` cell, `centre` of the tile, both in axes
        that the current has carried by `drift`."""
        self.wind.set_clock(since, step)
        for i, k in ti.ndrange(self.cells, self.rows):
            at, sides = first + self.cell * tm.vec2(i, k), self.cell * tm.vec2(self.cells, self.rows)
            at = at - sides * ti.round((at - centre) / sides) + drift  # of the periodic repeat nearest to the centre
            for slab in ti.static(range(len(self.middle))):
                area = tm.vec3(0.0)
                if ti.static(slab == 0 and self.wind.needs_area):
                    lean = self.slope[i, k]
                    area = self.cell * self.cell * tm.vec3(-lean.x, 1.0, -lean.y)
                mass = ti.static(self.density * self.thick[slab] * self.cell**2)
                key = (slab * self.cells + i) * self.rows + k
                position = tm.vec3(at.x, -ti.static(self.middle[slab]), at.y)
                push = self.wind.force(key, position, tm.vec3(0.0), area, tm.vec3(0.0), mass)
                lift = ti.cast(push.y * dt / (self.density * self.cell * self.cell), ti.f64)
                self.impulse[slab, i, k] = self.impulse[slab, i, k] + lift
