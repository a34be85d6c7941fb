"""An open sea without particles: waves from afar, and waves of ships and winds.

The sea from afar is a sum of plane waves, in closed form (`order: 1`), or a nonlinear sea on a tile that repeats itself
(`order: 3`, `open_sea/high_order.py`). Each ship pushes a tile of her own, which travels with her and fades at its rim
(`open_sea/wave_tile.py`); the winds push another one. She feels the sea, the winds' waves and those of other ships,
never her own: her law of motion holds their force already (added mass and damping, or `radiation`).

A ship makes waves as the volume that she displaces, by layers. A volume D per area at a depth d that changes in time is
a source; with eta' = eta - D f, f = cosh k (h - d) / cosh kh, the conditions at the surface become those of waves eta'
under a pressure rho g D f (Wehausen & Laitone 1960, Surface Waves, 13). At rest eta is 0 around her; where she floats
it is shown as low as her hull, smoothed over a cell.

A wind presses on the surface by the vertical part of its force. It is taken in the middle of each cell of a tile: on
the sloping surface of the cell where the wind acts on surfaces, and in a few slabs below it where it acts on mass. By
linear theory a force f on every kilogram of a slab of thickness dy moves a wave as the pressure -rho f dy sinh k(y+h) /
sinh kh on the surface would: a wave shorter than the slab is deep hardly feels it. Horizontal forces are left out: a
stress drags water along and makes no waves here.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import ceil, pi
from typing import Any, ClassVar, Literal

import numpy as np

from ocean_sim import waves
from ocean_sim.basin import Basin
from ocean_sim.conventions import LEAST_DENSITY, LEAST_STEP, WATER_DENSITY, Diverged
from ocean_sim.fluid import Displacing, Fluid, Limits
from ocean_sim.fluid.open_sea.high_order import STEPS_PER_WAVE, Breaking, HighOrder, nonlinear_sea, tile_step
from ocean_sim.fluid.open_sea.open_water import POINTS_PER_WAVE, SMOOTH_STEP_PERIODS, OpenWater, WaterForShip, status_of
from ocean_sim.fluid.open_sea.plane_waves import PlaneWaves, Window
from ocean_sim.fluid.open_sea.wave_sheet import WORDS_PER_CELL, Sheet
from ocean_sim.fluid.open_sea.wave_tile import PER_TILE, RIM_SHARE, Layer, OnTile, Tile, TileModes
from ocean_sim.kernel_library import ti, tm, to_numpy_type
from ocean_sim.model import Faults, Vector2, quantity
from ocean_sim.parts import FluidConfig, LedgerRow, SceneFacts, beyond_drift_tables, called, forces_in_waves
from ocean_sim.runtime import in_kernels
from ocean_sim.waves.seas import Seas, Steepening
from ocean_sim.wind import Wind

DEFAULT_CELLS = 128  # along a tile
MIN_BEAM_CELLS = 4.0  # cells over a ship's breadth
MAX_FIT_CHANGE = 0.01  # part of its wavenumber by which a regular wave may be changed to fit a tile
MIN_HELD_ENERGY = 0.5  # part of a sea's energy that a tile which repeats itself must hold
WIND_SLABS = 4  # slabs of water in which a wind acts on mass
SPECTRUM_COMPONENTS = 4000  # plane waves that stand for a spectrum before they are fitted to a tile


class Config(Seas, waves.GrowingTrain, Steepening, FluidConfig):
    """Calm water, regular waves (`height`, `period`, `heading_deg`) or a `spectrum`, and more `spectra` on top of them;
    the sea has no sides."""

    kind: Literal["spectral_sea"] = "spectral_sea"
    current: Vector2 = quantity("m/s", (0.0, 0.0))
    """Velocity of the water along x and z, the same at every depth; waves are carried by it."""
    order: Literal[1, 3] = 1
    """`1`: linear waves; `3`: the sea that comes from afar is nonlinear up to the third order in its slope, and repeats
    itself on the tile. What ships and winds make stays linear."""
    tile: float | None = quantity("m", None, gt=0.0)
    """Side length of the tiles; null: six wavelengths of the highest waves, in calm water the longer side of the
    basin."""
    cells: int = quantity("1", DEFAULT_CELLS, ge=16, le=1024, multiple_of=2)
    """Cells along a tile."""
    step: float | None = quantity("s", None, ge=LEAST_STEP)
    """Time step of the tiles; null: in one step waves of four cells turn by 0.8 rad, and in a nonlinear sea the
    highest waves by at most a fortieth of their period."""
    rest_density: float = quantity("kg/m3", WATER_DENSITY, ge=LEAST_DENSITY)
    """Density of the water."""

    def tiled(self, basin: waves.Tank, length: float, width: float) -> Tile:
        """Make the tile (periodic grid of sea, by default six waves long) for a basin of this length, width [m]."""
        side, g = self.tile, waves.downward_gravity(basin)
        if side is None and self.highest is not None:
            side = PER_TILE * 2.0 * pi / float(waves.wavenumber(2.0 * pi / self.highest[1], basin.depth, g))
        side = max(length, width) if side is None else side
        return Tile(side, self.cells, self.cells if basin.dimension == 3 else 1, basin.depth, g)

    def tile_of(self, basin: Basin) -> Tile:
        return self.tiled(basin, basin.config.length, basin.config.width or 0.0)

    def tile_step(self, tile: Tile) -> float:
        """Time step [s] of waves on tiles: the key `step`, else by the shortest and, if nonlinear, highest waves."""
        if self.step is not None:
            return self.step
        step = tile_step(tile)
        return min(step, self.highest[1] / STEPS_PER_WAVE) if self.order == 3 and self.highest is not None else step

    def problems(self, preflight: SceneFacts) -> Faults:
        basin = preflight.tank
        found = [*self.sea_faults(basin), *self.misplaced(basin)]
        return found or (self.unfitted(basin) if self.order == 3 else ())

    def misplaced(self, basin: Basin) -> Faults:
        """Yield faults (key, sentence) of a basin that holds more than open water."""
        if basin.ground is not None:
            yield ("kind",), "a sea computed by its surface lies over a flat bed; leave the shape of basin.floor out"
        if basin.config.obstacles:
            yield ("kind",), "a sea without sides goes through obstacles; leave basin.obstacles out"
        if basin.rough_bed is not None:
            yield ("kind",), "a sea computed by its surface has no friction; leave basin.floor out"
        if basin.dimension == 2 and self.current[1]:
            yield ("current",), "in 2-D water flows only along x; give [speed, 0.0]"

    def unfitted(self, basin: Basin) -> Faults:
        """Faults (key, sentence) of a tile (periodic grid) that does not fit waves or holds under half their energy."""
        tile, fits = self.tile_of(basin), True
        for _, train in self.trains:
            if train.spectrum is not None or not train.scale[0]:
                continue
            sea = train.sea(basin)
            wanted = snapped(sea, tile).wavevector[0]
            if np.linalg.norm(wanted - sea.wavevector[0]) > MAX_FIT_CHANGE * sea.wavenumber[0]:
                length = 2.0 * pi / sea.wavenumber[0]
                sentence = f"a tile of {tile.side:.4g} m that repeats itself does not hold waves of {length:.4g} m"
                cure = "take a multiple of their length, order 1, or a heading of 0 or 90 degrees"
                yield ("tile",), f"{sentence} in this direction; {cure}"
                fits = False
        if fits and self.energy_share(basin) < MIN_HELD_ENERGY:
            held = f"from {4.0 * tile.cell:.3g} m, four cells, to {tile.side:.4g} m"
            sentence = f"a tile of {tile.side:.4g} m in {tile.cells} cells holds waves {held}"
            share = f"{100.0 * self.energy_share(basin):.2g} % of the energy of this sea"
            yield ("tile",), f"{sentence}: {share}; take one of several of its waves"

    def energy_share(self, basin: Basin) -> float:
        """Share of the sea's energy in waves that are periodic on the tile and resolved by it; 1 in calm water."""
        whole = self.sea_of(basin, SPECTRUM_COMPONENTS)
        energy = float((whole.amplitude**2).sum())
        return float((snapped(whole, self.tile_of(basin)).amplitude ** 2).sum()) / energy if energy else 1.0

    def warnings(self, preflight: SceneFacts) -> Iterator[str]:
        tile = self.tile_of(preflight.tank)
        yield from self.like_radians()
        if self.highest is not None:
            yield from waves.cut_short(preflight.duration, self.with_ramp(self.sea_of(preflight.tank)).ramp)
            yield from beyond_drift_tables(preflight, self.sea_of(preflight.tank))
        if self.order == 3:
            kept = 4.0 * tile.cell
            if self.highest is None:
                yield "order 3 changes nothing in calm water: what ships and winds make is linear"
            else:
                lost = 100.0 * (1.0 - self.energy_share(preflight.tank))
                begin = f"order 3: waves shorter than {kept:.3g} m, four cells,"
                yield f"{begin} or far longer than the tile are left out of the sea: {lost:.2g} % of its energy"
        for name, ship in preflight.ships.items():
            look = ship.look(preflight)
            if look is not None and look.breadth < MIN_BEAM_CELLS * tile.cell:
                beam = (
                    f"the breadth of {called(name)}, {look.breadth:.3g} m, is {look.breadth / tile.cell:.2g} cells of"
                )
                low = f"{tile.cell:.3g} m; below {MIN_BEAM_CELLS:g} the waves that she makes are too long and too low"
                yield f"{beam} {low}: take more fluid.cells or a smaller fluid.tile"
            if look is None:
                yield f"a ship of kind {ship.kind} has no hull that could push the water: she makes no waves"
        if not preflight.wind.still:
            yield "only the vertical part of the wind presses on the water; its drag moves no water here"

    def notes(self, preflight: SceneFacts) -> Iterator[str]:
        side = self.tile_of(preflight.tank).side
        if self.order == 3 and self.highest is not None:
            afar = f"order 3: the sea from afar is nonlinear and repeats itself after {side:.4g} m"
            yield f"{afar}; the waves of ships and winds stay linear"
        for name, ship in preflight.ships.items():
            if ship.look(preflight) is not None:
                unfelt = f"the waves that {called(name)} makes are seen and act on other ships, but not on herself"
                yield f"{unfelt}: her damping stands for their force"

    def statements(self, preflight: SceneFacts) -> Iterator[str]:
        tile = self.tile_of(preflight.tank)
        if self.highest is not None:
            yield from forces_in_waves(preflight, len(self.sea_of(preflight.tank).amplitude) == 1, any(self.current))
        begin = f"tiles of {tile.side:.4g} m in cells of {tile.cell:.3g} m that step every {self.tile_step(tile):.3g}"
        yield f"{begin} s; what ships and winds make fades in their outer {100.0 * RIM_SHARE:g} %"

    def still_limits(self, preflight: SceneFacts) -> Limits:
        return self.interpolation_limits(self.tile_of(preflight.tank))

    def interpolation_limits(self, tile: Tile) -> Limits:
        """Time step limits: waves interpolated between steps err by at most 0.05 %, and no tile step is skipped."""
        period = self.highest[1] if self.highest is not None else np.inf
        return Limits(force=min(SMOOTH_STEP_PERIODS * period, 4.0 * self.tile_step(tile)))

    def point_spacing(self, preflight: SceneFacts) -> float:
        return spacing(self.sea_of(preflight.tank), self.tile_of(preflight.tank))

    def ledger(self, preflight: SceneFacts) -> Iterator[LedgerRow]:
        word, tile = preflight.word, self.tile_of(preflight.tank)
        cells = tile.cells * tile.rows
        why = f"fluid.cells {self.cells}"
        n = self.summed_waves(preflight)
        yield LedgerRow("fluid", f"{n} plane waves", PlaneWaves.bytes(n, word), "fluid.order 1")
        if self.order == 3:
            size = cells * (6 * 8 + WORDS_PER_CELL * word)
            yield LedgerRow("fluid", f"a nonlinear sea of {cells} cells", size, why)
        making = [name for name, ship in preflight.ships.items() if ship.look(preflight) is not None]
        several = len(preflight.ships) > 1  # each feels the others
        for name in making:
            size = cells * (5 * 8 + several * WORDS_PER_CELL * word)
            yield LedgerRow("fluid", f"{called(name)}'s waves on {cells} cells", size, why)
        if not preflight.wind.still:
            size = cells * (5 * 8 + WORDS_PER_CELL * word) + AirPressure.bytes(cells, word)
            yield LedgerRow("fluid", f"the wind's waves on {cells} cells", size, why)

    def summed_waves(self, preflight: SceneFacts) -> int:
        """Number of plane waves that kernels sum, by facts of the scene: all, or 1, of height 0, if a grid has them."""
        return len(self.sea_of(preflight.tank).amplitude) if self.order == 1 else 1

    def window_bytes(self, preflight: SceneFacts, size: tuple[int, int], levels: int) -> int:
        return Window.bytes(size, levels, self.summed_waves(preflight), preflight.word)

    def build(self, basin: Basin, seed: int, *, accounts: bool, wind: Wind) -> "SpectralSea":
        return SpectralSea(self, basin, wind, accounts)


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
        self.weights = [waves.profiles(tile.k, -d, tile.depth)[1] / scale for d in self.middle]
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


class OwnWaves(OnTile):
    """Linear waves made by one ship or by the wind, on a periodic grid (tile) of their own."""

    def __init__(self, tile: Tile, ship: Displacing | None = None) -> None:
        """Start with calm water; `ship`: the ship that makes the waves, None for the wind."""
        self.tile, self.ship, self.layer, self.time, self.begun = tile, ship, Layer(tile), 0.0, False
        self.hollow = self.felt = np.zeros(1)
        """Fourier modes of the ship's displaced volume per area [m]: as it is, and as it acts on the surface."""
        self.velocity = np.zeros(2)  # of the ship through the water [m/s]

    def covers(self, points: np.ndarray) -> np.ndarray:
        return self.layer.covers(points)

    def modes_at(self, time: float) -> TileModes:
        """Fourier modes of the ship's or wind's waves at a time [s], by linear theory from their grid's last step."""
        dt, tile = time - self.time, self.tile
        e, p = self.layer.propagate(dt)
        u, w = self.velocity
        onward = np.exp(-1j * dt * (tile.kx * u + tile.kz * w)) if self.velocity.any() else 1.0
        around = e + onward * self.felt
        return TileModes(around - onward * self.hollow, p, -tile.gravity * around)


class NonlinearSea(OnTile):
    """Nonlinear sea on a periodic grid (tile), stored at two times, one time step of it apart, interpolated between."""

    def __init__(self, sea: HighOrder, step: float, ramp: float) -> None:
        """Compute the first two states of `sea`, `step` [s] apart; `ramp`: time [s] over which its height grows."""
        self.sea, self.tile, self.step, self.ramp, self.number = sea, sea.tile, step, ramp, 0
        self.slots = [np.array(sea.potentials()), np.array(sea.potentials())]
        """Modes of the elevation, of the potential and of its growth, (3, cells, rows // 2 + 1) each."""
        self.advance_step()

    def advance_step(self) -> None:
        """Advance the nonlinear sea by its step; store its modes as the later of the two states for interpolation."""
        self.sea.advance(self.step)
        self.number += 1
        self.slots = [self.slots[1], np.array(self.sea.potentials())]

    def share(self, time: float) -> float:
        """Position of a time [s] between the two stored states: 0 at the earlier, 1 at the later one."""
        return time / self.step - (self.number - 1)

    def modes_at(self, time: float) -> TileModes:
        """Fourier modes of the sea at a time [s] between the two stored states, times the ramp."""
        late, grown = self.share(time), waves.ramp_share(time, self.ramp)
        return TileModes(*(grown * ((1.0 - late) * a + late * b) for a, b in zip(*self.slots)))

    def ramped_modes(self, slot: int) -> np.ndarray:
        """Modes (3, cells, columns; TileModes) of the earlier (`slot` 0) or later (1) state, times the ramp in time."""
        return waves.ramp_share(self.step * (self.number - 1 + slot), self.ramp) * self.slots[slot]


@in_kernels
class SpectralSea(OpenWater):
    """Open sea without particles, with waves of ships and wind. Kernels read all waves but those of ships; each of
    several ships reads a view of the water that includes the waves of the others."""

    def __init__(self, config: Config, basin: Basin, wind: Wind, accounts: bool = False) -> None:
        self.config, self.tile, self.accounts = config, config.tile_of(basin), accounts
        tile = self.tile
        self.still, self.step = config.interpolation_limits(tile), config.tile_step(tile)
        self.rest_density = density = config.rest_density
        whole = config.with_ramp(config.sea_of(basin))
        self.spacing = spacing(whole, tile)
        self.reference_speed = (tile.gravity * basin.depth) ** 0.5
        self.status = status_of(whole, density)
        self.current, self.drift = config.current, np.zeros(2)
        self.time = self.before = self.then = 0.0
        self.waves = PlaneWaves(whole if config.order == 1 else waves.combine([], tile.depth, tile.gravity))
        self.afar = whole
        self.steep, self.air, self.raised = None, None, None
        self.made: list[OwnWaves] = []
        self.sheets = ()
        if config.order == 3:
            fitted = snapped(config.sea_of(basin, SPECTRUM_COMPONENTS), tile)
            self.afar = replace(fitted, ramp=whole.ramp)
            self.steep = NonlinearSea(self.nonlinear(fitted), self.step, whole.ramp)
            self.sheets += (Sheet(self.steep.tile, repeats=True),)
            self.sheets[0].write_modes(0, *self.steep.ramped_modes(0))
            self.write_steep(self.steep)
        if wind.blows:
            self.raised, self.air = OwnWaves(tile), AirPressure(wind, tile, density)
            self.made.append(self.raised)
            self.sheets += (Sheet(tile, repeats=False),)
        self.felt: list[tuple[OwnWaves, Sheet]] = []  # of ships that others feel
        self.tiles = [*([self.steep] if self.steep is not None else []), *self.made]
        self.set_clocks()

    def nonlinear(self, sea: waves.Components) -> HighOrder:
        period = self.config.highest[1] if self.config.highest is not None else 0.0
        return nonlinear_sea(sea, self.tile, self.config.onset_in(period), self.config.breaking, period)

    @property
    def plane_waves(self) -> waves.Components:
        """Plane waves of the sea without ships and wind, by linear theory, in axes that move with the current."""
        return self.afar

    @property
    def breaking(self) -> Breaking | None:
        """Breaking crests of the nonlinear sea; None if the scene does not ask for them."""
        return self.steep.sea.breaking if self.steep is not None else None

    @property
    def work(self) -> dict[str, float]:
        """Work [J] on the sea by breaking since the start (negative); empty if not summed or nothing may break."""
        broken = self.breaking
        return {"breaking": -self.rest_density * broken.lost} if self.accounts and broken is not None else {}

    def undisturbed_elevations(self, points: np.ndarray, elevation: np.ndarray) -> np.ndarray:
        """Heights (m,) [m] of sea and wind waves at `points` (m, 2): `elevation` (m,), of all, if no ship makes any."""
        if not any(made.ship is not None for made in self.made):
            return elevation
        at = np.asarray(points, dtype=float) - self.drift
        return self.sum_elevations(at, [one for one in (self.steep, self.raised) if one is not None])

    def foam(self, points: np.ndarray) -> np.ndarray | None:
        broken = self.breaking
        if broken is None:
            return None
        white = self.tile.interpolate(broken.white, np.asarray(points, dtype=float) - self.drift)
        return self.afar.ramp_share(self.time) * np.clip(white, 0.0, 1.0)

    @property
    def can_be_disturbed(self) -> bool:
        """True if the water has tiles (a nonlinear sea, wind or ships) or a current."""
        return bool(self.tiles) or any(self.current)

    def begin(self, sea: waves.Components) -> None:
        """Restart at time 0 with another `sea` of the same number of plane waves and the same depth."""
        self.time = self.before = self.then = 0.0
        for made in self.made:
            made.time, made.begun = 0.0, False
        self.afar = self.config.with_ramp(sea)
        self.waves.begin(self.afar)

    def add_ships(self, ships: Sequence[Displacing]) -> tuple[Fluid, ...]:
        """Give each ship that displaces water a grid (tile) for her waves; return the water of each without her own."""
        wakes = [OwnWaves(self.tile, ship) for ship in ships if len(ship.displaced()[1])]
        self.made += wakes
        self.tiles = [*self.tiles, *wakes]
        if len(ships) < 2:
            return (self,) * len(ships)
        self.felt = [(wake, Sheet(self.tile, repeats=False)) for wake in wakes]
        return tuple(
            WaterForShip(
                self,
                [tile for tile in self.tiles if not (isinstance(tile, OwnWaves) and tile.ship is ship)],
                (*self.sheets, *(sheet for wake, sheet in self.felt if wake.ship is not ship)),
            )
            for ship in ships
        )

    def advance(self, dt: float) -> None:
        """Advance by a step of dt [s]; tiles take their own, longer steps when these are due."""
        if self.made and (self.time == 0.0 or self.time - self.then > self.step - 0.5 * dt):
            self.advance_tiles()
        if self.air is not None and self.raised is not None:
            self.air.collect_impulse(dt, self.drift, self.raised.layer.centre)
        self.before, self.time = self.time, self.time + dt
        self.drift = np.array(self.current) * self.time
        self.waves.set_time(self.time, (float(self.drift[0]), float(self.drift[1])))
        if self.steep is not None:
            while self.steep.share(self.time) > 1.0 + 1e-9:
                self.steep.advance_step()
                self.write_steep(self.steep)
        self.set_clocks()

    def advance_tiles(self) -> None:
        """Advance the waves of ships and wind to the present, under their pressures; update the fields for kernels."""
        dt = self.time - self.then
        for made in self.made:
            made.time = self.time
            if made.ship is not None:
                self.displace(made, made.ship, dt)
        if self.raised is not None and self.air is not None and dt > 0.0:
            layer = self.raised.layer
            layer.set_pressure(self.air.take_pressure())  # as it was in the mean, before and after
            layer.advance(dt, layer.pressure, self.wind_centre())
        self.then = self.time
        if self.raised is not None and self.air is not None:
            if self.air.slope is not None:
                self.air.set_slopes(*self.slopes(self.raised, self.time + 0.5 * self.step))
            self.write_waves(self.raised, self.sheets[-1])
        for made, sheet in self.felt:
            self.write_waves(made, sheet)

    def slopes(self, raised: OwnWaves, time: float) -> tuple[np.ndarray, np.ndarray]:
        """Slopes along x and z (cells, rows) of the sea plus the wind waves `raised`, on their tile, at a time [s]."""
        along, across = (self.tile.to_values(slope) for slope in self.tile.slopes(raised.modes_at(time).e))
        if self.steep is not None:
            afar = [self.steep.tile.to_values(of) for of in self.steep.tile.slopes(self.steep.modes_at(self.time).e)]
            return along + afar[0], across + afar[1]
        sea = self.waves.sea
        if sea.amplitude.any():
            axes = zip(self.tile.nodes(), (self.tile.side, self.tile.width), raised.layer.centre, strict=True)
            x, z = (axis - size * np.round((axis - middle) / size) for axis, size, middle in axes)
            turn = 1j * sea.ramp_share(time) * sea.amplitude * np.exp(1j * (sea.phase - sea.omega * time))
            kx, kz = sea.wavevector.T
            rows, columns = turn * np.exp(1j * x[:, None] * kx), np.exp(1j * z[:, None] * kz)
            along = along + np.einsum("in,kn->ik", rows * kx, columns).real  # without BLAS: the same on any threads
            across = across + np.einsum("in,kn->ik", rows * kz, columns).real
        return along, across

    def displace(self, made: OwnWaves, ship: Displacing, dt: float) -> None:
        """Advance the waves `made` by a ship by dt [s] under her displaced volume; raise Diverged if not finite."""
        points, volumes = ship.displaced()
        centre = np.array([ship.body.position[0], ship.body.position[2]]) - self.drift
        made.hollow, made.felt = self.tile.displaced_modes(points - [*self.drift, 0.0], volumes)
        pressure = self.tile.gravity * made.felt
        if made.begun:
            made.velocity = (centre - made.layer.centre) / dt
            made.layer.advance(dt, pressure, centre)
            if not np.isfinite(made.layer.eta).all():
                raise Diverged("the waves that a ship makes stopped being numbers; try a shorter fluid.step")
        else:
            made.layer.begin(pressure, centre, self.step)
            made.begun = True

    def wind_centre(self) -> np.ndarray:
        """Centre x, z (2,) [m], in axes moving with the current, of the wind's grid: first ship, or basin's middle."""
        first = next((made.ship for made in self.made if made.ship is not None), None)
        at = np.zeros(2) if first is None else np.array([first.body.position[0], first.body.position[2]])
        return at - self.drift

    def write_waves(self, made: OwnWaves, sheet: Sheet) -> None:
        """Write waves of a ship or wind, now and one step of their tile (grid) later, to kernels' fields (`sheet`)."""
        for slot, time in enumerate((self.time, self.time + self.step)):
            sheet.write_modes(slot, *made.modes_at(time))

    def write_steep(self, steep: NonlinearSea) -> None:
        """Write the later state of the nonlinear sea to the fields for kernels, in place of the older one there."""
        self.sheets[0].write_modes(steep.number % 2, *steep.ramped_modes(1))

    def set_clocks(self) -> None:
        """Set position and time of each sheet (fields for kernels), at present and when the last step began."""
        drifts = np.outer((self.time, self.before), self.current)
        if self.steep is not None:
            first, last = self.steep.share(self.time), self.steep.share(self.before)
            late = (first, last) if self.steep.number % 2 else (1.0 - first, 1.0 - last)
            self.sheets[0].set_clock(late, drifts, self.wind_centre())
        late = (self.time - self.then) / self.step, (self.before - self.then) / self.step
        if self.raised is not None:
            self.sheets[-1].set_clock(late, drifts, self.raised.layer.centre)
        for made, sheet in self.felt:
            sheet.set_clock(late, drifts, made.layer.centre)


def spacing(sea: waves.Components, tile: Tile) -> float:
    """Distance [m] between points that resolve the highest waves of a sea; in calm water two cells of the tile."""
    return sea.wavelength / POINTS_PER_WAVE if sea.amplitude.any() else 2.0 * tile.cell


def snapped(sea: waves.Components, tile: Tile) -> waves.Components:
    """Waves moved to the nearest wavevectors periodic on a tile, equal ones merged, unresolved ones dropped."""
    unit = 2.0 * pi / np.array([tile.side, tile.width if tile.rows > 1 else np.inf])
    steps = np.round(np.divide(sea.wavevector, unit, out=np.zeros(sea.wavevector.shape), where=unit > 0.0)).astype(int)
    most = ceil(tile.cells / 4) - 1
    kept = (np.abs(steps) <= most).all(axis=1) & steps.any(axis=1) & (sea.amplitude > 0.0)
    if not kept.any():
        return waves.combine([], tile.depth, tile.gravity)
    there = replace(sea, amplitude=sea.amplitude[kept], wavevector=sea.wavevector[kept], phase=sea.phase[kept])
    return waves.merge_waves(there, steps[kept] * np.where(np.isfinite(unit), unit, 0.0))
