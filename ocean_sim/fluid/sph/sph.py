"""Base class of schemes of smoothed particle hydrodynamics, and of their configs: keys, memory, limits and fields."""

from collections.abc import Iterator
from itertools import product
from math import inf, pi, sqrt
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ocean_sim import waves
from ocean_sim.basin import Basin
from ocean_sim.fluid import Limits
from ocean_sim.fluid.bodies.emitter import MOST_PARTICLES
from ocean_sim.fluid.bodies.walls import warnings as of_zones
from ocean_sim.fluid.bodies.walls import zones
from ocean_sim.fluid.budget.field import Field
from ocean_sim.fluid.neighbours.grid_size import GridSize
from ocean_sim.fluid.neighbours.particle_walk import PLANS, Walk, account_ledger, mesh_ledger
from ocean_sim.fluid.open_sea.plane_waves import PlaneWaves
from ocean_sim.fluid.patch.attenuation import Attenuation, Delay, Train, wave_trains
from ocean_sim.fluid.patch.relaxation_zone import relaxation_band, tile_cells
from ocean_sim.fluid.sph.initial_state import MIN_WAVE_SPACINGS, NOTABLE_LOST_VARIANCE
from ocean_sim.fluid.sph.particle_water import ParticleWater
from ocean_sim.fluid.sph.smoothing import NEUTRAL_KERNEL, NEUTRAL_RATIO, Kernel, Smoothing, rigidity_notes
from ocean_sim.fluid.sph.water_keys import Lattice, WaterConfig, free_fall_speed
from ocean_sim.kernel_library import ti, tm
from ocean_sim.model import Fault, quantity
from ocean_sim.parts import LedgerRow, SceneFacts, called, key_of
from ocean_sim.runtime import in_kernels
from ocean_sim.wind import Wind

if TYPE_CHECKING:  # it is imported only where there are bodies
    from ocean_sim.fluid.bodies.boundary import Boundary

NOTABLE_VISCOSITY = 0.1  # of the viscosity asked for: from there on the addition of a scheme is stated
MAX_COUNT = 2**31 - 1  # highest number that kernels count up to
NOTABLE_STIFFNESS = 10.0  # times the stiffness of 1 % compression: from there on it costs more than it gives
NOTABLE_COMPRESSION = 0.05  # compression at the bed from which a warning is due
MOTION_SAMPLES = 400  # times at which the motion of the tank is sampled
CROWDED_SHARE = 0.8  # share of a kernel filled by solid bodies, from which a particle's remembered push is damped
MIN_WAVE_PARTICLES = 19.5  # spacings to a wavelength: measurements of waves begin at 20
MAX_STEEPNESS, MAX_SEA_STEEPNESS = 0.25, 0.15  # k a of regular waves, and of half the significant height: more breaks


class SphConfig(WaterConfig):
    """Keys common to all schemes of smoothed particle hydrodynamics."""

    compared: ClassVar[bool] = True
    conserves_momentum: ClassVar[bool] = True

    attenuation: ClassVar[Attenuation | None] = None
    """Viscosity that the scheme adds to waves; None where it has not been measured."""
    delay: ClassVar[Delay] = Delay(0.0)
    """Lengthening of the period of waves by the scheme."""
    joins_a_sea: ClassVar[bool] = True
    told_to_bodies: ClassVar[int] = 3
    """Numbers that are carried along for solid bodies: its acceleration, where a pressure is continued into them."""
    default_ratio: ClassVar[tuple[float, float]] = (NEUTRAL_RATIO, NEUTRAL_RATIO)
    """Default of `support_ratio` in 2-D and in 3-D."""
    kernel: ClassVar[Kernel] = NEUTRAL_KERNEL
    support_ratio: float | None = quantity("spacings", None, ge=1.2, le=6.0)
    """Kernel support radius over the spacing."""
    compression: float | None = quantity("1", None, gt=0.0, le=1.0)
    """Wanted density error: the rise of the density at the bed, (reference_speed / sound speed)^2; 0.01 by default."""
    reference_speed: float | None = quantity("m/s", None, gt=0.0)
    """The speed to which compression refers; by default sqrt(|g| depth)."""
    kinematic_viscosity: float = quantity("m2/s", 0.0, ge=0.0)
    """Kinematic viscosity nu; mu of (2.18) is rest density times nu."""
    minimum_pressure: float | None = quantity("Pa", None)
    """Lowest pressure, to which lower ones are raised; null: none."""

    def speed(self, basin: Basin) -> float:
        """Reference speed [m/s], to which `compression` refers: as given, by default sqrt(|g| depth)."""
        return self.reference_speed or free_fall_speed(basin)

    def sound_speed(self, basin: Basin) -> float:
        """Sound speed c [m/s]: reference speed over the square root of `compression`."""
        return self.speed(basin) / sqrt(self.compression or 0.01)

    def ratio(self, basin: Basin) -> float:
        """Ratio of the kernel's support radius to the particle spacing."""
        return self.support_ratio or self.default_ratio[basin.dimension - 2]

    def smoothing(self, basin: Basin) -> Smoothing:
        """Smoothing kernels of this water in a basin."""
        return Smoothing(basin.dimension, self.ratio(basin) * self.lattice(basin).spacing, self.kernel)

    def is_enclosed(self, basin: Basin) -> bool:
        """True if the water fills a closed basin and so has no free surface."""
        return basin.closed and self.fill is None

    @property
    def compression_asked(self) -> float:
        return self.compression or 0.0

    @property
    def support_asked(self) -> float | None:
        return self.support_ratio

    @property
    def viscosity_asked(self) -> float:
        return self.kinematic_viscosity

    def problems(self, preflight: SceneFacts) -> list[Fault]:
        found, basin = list(super().problems(preflight)), preflight.tank
        if self.sound_speed(basin) == 0.0:
            found.append((("reference_speed",), "is required without gravity: compression needs a speed to refer to"))
        support = preflight.support
        for axis, period in zip("xyz", basin.periods, strict=True):
            if 0.0 < period < 2.0 * support:
                sentence = f"a period of {period:g} m along {axis} is shorter than two support radii of {support:g} m"
                found.append((("spacing",), sentence))
        if not found:
            found += [((self.sized_by,), sentence) for sentence in self.count_problems(preflight)]
        if basin.rough_bed is not None:
            found += [(("spacing",), sentence) for sentence in basin.rough_bed.problems(self.lattice(basin).row)]
        return found

    def most_particles(self, preflight: SceneFacts) -> int:
        """Largest number of particles (roughly) whose neighbours can be counted in 32 bits."""
        sizes = self.untouched_sizes(preflight)
        counted = sizes.plan.highest_index(sizes, self.neighbours_kept(preflight.tank))
        return min(MOST_PARTICLES, sizes.lattice.n * MAX_COUNT // max(counted, 1))

    def untouched_sizes(self, preflight: SceneFacts) -> GridSize:
        """Sizes of grid and lists (GridSize) for the lattice as it would be without floating bodies."""
        lattice = preflight.untouched
        assert isinstance(lattice, Lattice)
        return self.list_size(lattice, preflight.arch, 1)

    def neighbours_kept(self, basin: Basin) -> int:
        """Number of neighbours of a lattice particle if the scheme stores pairs for a step, else 0."""
        return 0

    def count_problems(self, preflight: SceneFacts) -> Iterator[str]:
        """Yield a fault if there are more particles, with their neighbours, or more cells than 32 bits can count."""
        grid, most = self.untouched_sizes(preflight), self.most_particles(preflight)
        depth, spacing = preflight.tank.depth, grid.lattice.spacing
        if not self.fill and 0.0 < depth < spacing:
            few = f"is larger than the water is deep, {depth:g} m"
            yield f"{few}; water that moves takes {depth / self.ratio(preflight.tank):.2g} m or less"
        if grid.lattice.n > most:
            opening = f"makes {grid.lattice.n} particles;"
            middle = f"at a support of {self.ratio(preflight.tank):g} spacings the neighbours of about {most}"
            yield f"{opening} {middle} at most can be counted in 32 bits; {self.fitting_spacing(preflight)}"
        if grid.count_numbers > MAX_COUNT:
            many = f"makes a grid of {grid.cell_count} cells, too many to be counted in 32 bits with their parts"
            yield f"{many}: the basin is too large for so small a spacing"

    def warnings(self, preflight: SceneFacts) -> Iterator[str]:
        yield from super().warnings(preflight)
        basin = preflight.tank
        if basin.rough_bed is not None:
            yield from basin.rough_bed.warnings(self.lattice(basin).row)
        if basin.ground is not None:
            waves = basin.piston is not None or basin.config.motion is not None
            yield from basin.ground.warnings(self.lattice(basin).spacing, waves)
        if "compression" not in self.unheeded:
            yield from self.stiffness_warnings(basin) or self.weight_warnings(basin, preflight.duration)
        lattice = self.start_lattice(preflight)
        outlines = {name: ship.outline(preflight) for name, ship in preflight.ships.items()}
        places = {name: outline.plan.mean(axis=0) for name, outline in outlines.items() if outline is not None}
        around, damping = relaxation_band(lattice), zones(lattice)
        if around is not None:
            yield from around.warnings(preflight.duration)
            yield from around.ships_in_rim(places)
        for name, zone in product(places, damping):
            if zone.axis != 1 and zone.contains(places[name][zone.axis // 2]):
                yield f"{called(name)} starts in the zone before absorbing side {zone.side}, which damps waves"
        yield from of_zones(damping)
        yield from self.scale_warnings(lattice, preflight.support)

    def scale_warnings(self, lattice: Lattice, support: float) -> Iterator[str]:
        """Warn of too few particles (kernel radius: `support` [m]) for the depth or waves, and of too steep waves."""
        spacing, depth = lattice.spacing, lattice.basin.depth
        if support >= depth > 0.0:
            begin = f"the water is {depth / spacing:.3g} particles deep, no more than a support radius of"
            yield f"{begin} {support / spacing:.3g}: too few to move like water; take a smaller spacing"
        for train in wave_trains(lattice):
            length, height = train.sea.wavelength, train.height
            waves_of = f"waves {length:.3g} m long and {height:.3g} m high"
            if length < MIN_WAVE_PARTICLES * spacing:
                few = f"{waves_of} have {length / spacing:.3g} particles to a wavelength"
                yield f"{few}: too few, by which period and height are off; 20 need a spacing of {length / 20.0:.3g} m"
            short = train.variance_below(MIN_WAVE_SPACINGS * spacing)
            if short > NOTABLE_LOST_VARIANCE:
                begin = f"{waves_of}: {short:.2g} of their variance is in waves of fewer than {MIN_WAVE_SPACINGS:g}"
                yield f"{begin} particles, which water hardly carries; take a smaller spacing or a lower cut_off"
            steepness, most = pi * height / length, MAX_SEA_STEEPNESS if train.sea.random else MAX_STEEPNESS
            if steepness > most:
                steep = f"{waves_of} are steep (k a = {steepness:.2g})"
                yield f"{steep}: beyond {most:g} they break on particles and lose height"

    def stiffness_warnings(self, basin: Basin) -> list[str]:
        """Warnings if the sound speed is far above or below the one that keeps compression near 1 %."""
        stiffness, speed = self.sound_speed(basin) ** 2, self.speed(basin)
        times, compression = 0.01 * stiffness / speed**2, speed**2 / stiffness
        if times >= NOTABLE_STIFFNESS * (1.0 - 1e-9):
            more = f"{times:.3g} times that of 1 % compression"
            cost = f"the time step is {sqrt(times):.2g} times shorter, and a lattice that breaks up is less stable"
            return [f"a stiffness of {stiffness:.4g} m2/s2 is {more}: {cost}; 1 % needs {100.0 * speed**2:.4g} m2/s2"]
        if compression > NOTABLE_COMPRESSION:
            squeezed = f"water that falls at {speed:.4g} m/s is compressed by {compression:.2g} of its density"
            return [
                f"{squeezed}, more than {NOTABLE_COMPRESSION:g}: levels and pressures are off by as much; "
                "take compression 0.01"
            ]
        return []

    def weight_warnings(self, basin: Basin, duration: float) -> Iterator[str]:
        """Warn if gravity along the basin, body force or the tank's motion over `duration` [s] compress water much."""
        still = np.add(basin.gravity, self.body_force)
        motion = basin.config.motion.build() if basin.config.motion is not None else None
        times = np.linspace(0.0, duration, MOTION_SAMPLES)
        pulls = np.array([still if motion is None else still - motion.at(float(t)).acceleration for t in times])
        lengths = basin.config.length, basin.depth, basin.config.width or 0.0
        walled = {side.axis for side in basin.sides}
        sizes = [length if axis in walled else 0.0 for axis, length in enumerate(lengths)]
        most = float((np.abs(pulls) @ sizes).max())  # the highest pressure at rest over the density [m2/s2]
        compression = most / self.sound_speed(basin) ** 2
        if compression <= NOTABLE_COMPRESSION:
            return
        pulled = f"gravity, body force and the motion of the tank press with up to {most:.4g} m2/s2 times the density"
        squeezed = f"compress it by {compression:.2g} of it, more than {NOTABLE_COMPRESSION:g}"
        wanted = f"take a reference_speed of {sqrt(most):.3g} m/s"
        yield f"{pulled} of the water and {squeezed}: levels and pressures are off by as much; {wanted}"

    def list_size(self, lattice: Lattice, arch: str, reads: int, carried: int = 0) -> GridSize:
        """Sizes of the grid and of neighbour lists on a backend (`arch`). `reads`: most fields of a particle that a
        pair law reads; `carried`: fields that the sort by cell moves with particles besides position, velocity, id."""
        support = self.ratio(lattice.basin) * lattice.spacing
        carried += self.told_to_bodies if has_bodies(lattice.basin) else 0
        return GridSize(lattice, support, PLANS[arch], carried, reads)

    def still_limits(self, preflight: SceneFacts) -> Limits:
        smoothing = self.smoothing(preflight.tank)
        return step_limits(smoothing, self.sound_speed(preflight.tank), self.kinematic_viscosity, 0.0, 0.0)

    def viscosity_added(
        self, preflight: SceneFacts, length: float, height: float = 0.0, standing: bool = False
    ) -> float:
        tank, spacing = preflight.tank, preflight.spacing
        if self.attenuation is None or spacing is None:
            return 0.0
        share = self.attenuation.share(2.0 * pi / length, tank.depth, height, spacing, standing)
        return share * self.viscosity_scale(tank)

    def viscosity_scale(self, basin: Basin) -> float:
        """Product h c [m2/s] of smoothing length and sound speed: unit of the scheme's numerical viscosity."""
        return self.smoothing(basin).length * self.sound_speed(basin)

    def viscosity(self, basin: Basin) -> float:
        """Kinematic viscosity [m2/s] in effect, an artificial one included."""
        return self.kinematic_viscosity

    def losses(self, lattice: Lattice, sea: waves.Components) -> np.ndarray | None:
        basin, attenuation = lattice.basin, self.attenuation
        if attenuation is None or self.ratio(basin) != self.default_ratio[basin.dimension - 2]:
            return None
        k, height = sea.wavenumber, Train(sea, False).height
        share = np.array([attenuation.share(one, sea.depth, height, lattice.spacing, False) for one in k.tolist()])
        decay = 2.0 * (self.viscosity(basin) + share * self.viscosity_scale(basin)) * k**2
        return decay - 1j * sea.omega * self.delay.share(k, height, lattice.spacing)

    def statements(self, preflight: SceneFacts) -> Iterator[str]:
        basin = preflight.tank
        c, speed = self.sound_speed(basin), self.speed(basin)
        stiff = f"sound speed {c:.4g} m/s, stiffness {c * c:.4g} m2/s2"
        yield f"{stiff}: compression (reference speed {speed:.4g} m/s / sound speed)^2 = {(speed / c) ** 2:.2%}"
        if self.minimum_pressure is not None:
            least = f"{self.minimum_pressure:g}"
            yield f"pressures below {least} Pa are set to {least} (minimum_pressure)"
        if basin.rough_bed is not None:
            yield basin.rough_bed.statement(self.lattice(basin).row)
        if basin.ground is not None:
            yield basin.ground.statement(self.lattice(basin).spacing)
        if (around := relaxation_band(self.start_lattice(preflight))) is not None:
            yield from around.statements()
        yield from (zone.statement for zone in zones(self.start_lattice(preflight)))
        yield from self.wave_statements(preflight)
        yield from super().statements(preflight)
        if self.kernel is NEUTRAL_KERNEL and not self.is_enclosed(basin):
            yield from rigidity_notes(self.smoothing(basin), self.lattice(basin).spacing)

    def wave_statements(self, preflight: SceneFacts) -> Iterator[str]:
        """Yield sentences on the height that the scene's waves lose by the numerical viscosity of the scheme."""
        if self.attenuation is None:
            return
        ratio, usual = self.ratio(preflight.tank), self.default_ratio[preflight.tank.dimension - 2]
        for train in wave_trains(self.start_lattice(preflight)):
            if ratio != usual:
                at = f"was measured at a support of {usual:g} spacings, and is not known at {ratio:g}"
                yield f"what {self.kind} adds to the viscosity of waves {at}"
                return
            own, length = self.viscosity_asked, train.sea.wavelength
            added = self.viscosity_added(preflight, length, train.height, train.standing)
            if added > NOTABLE_VISCOSITY * own:
                a_period, a_wavelength = train.height_loss(own + added)
                way = "" if train.standing else f", {a_wavelength:.2g} over a wavelength travelled"
                begin = f"waves {length:.3g} m long and {train.height:.3g} m high: {self.kind} adds {added:.2g} m2/s"
                middle = f"to the viscosity of {own:g} m2/s, as measured; they lose {a_period:.2g} of their height in a"
                yield f"{begin} {middle} period{way}"


def scheme_ledger(
    preflight: SceneFacts, sizes: GridSize, numbers: int, what: str, told: int = 0
) -> Iterator[LedgerRow]:
    """Yield a scheme's rows of the memory ledger. `numbers`: floats stored per particle besides its id (`what` names
    them); `told`: floats per particle that are sorted along for solid bodies to read."""
    n, lattice, word, wind = sizes.lattice.n, sizes.lattice, preflight.word, preflight.wind
    yield LedgerRow("fluid", f"{n} particles", (numbers * word + 4) * n, what)
    yield LedgerRow("fluid", f"grid of {sizes.cell_count} cells", sizes.bytes(word), f"support {sizes.support:g} m")
    if lists := sizes.plan.list_bytes(sizes, word):
        yield LedgerRow("fluid", "candidate lists", lists, "neighbours of every occupied cell")
    yield from account_ledger(sizes, word, preflight.sums_impulses)
    if wind.needs_area:
        from ocean_sim.fluid.bodies.exposure import memory

        what = "exposed areas, and how the surface bends" if wind.needs_bend else "exposed areas"
        yield LedgerRow("fluid", what, memory(n, word, wind.needs_bend), f"wind.kind is {wind.kind}")
    if passed := sum(len(zone.given.amplitude) for zone in zones(lattice) if zone.given is not None):
        size = PlaneWaves.bytes(passed, word)
        yield LedgerRow("fluid", f"{passed} plane waves", size, "basin.walls: target of a side")
    yield from sea_ledger(lattice, word)
    if has_bodies(lattice.basin):
        yield from body_ledger(sizes, word, preflight.sums_impulses, told)
    yield from mesh_ledger(sizes, word)


def sea_ledger(lattice: Lattice, word: int) -> Iterator[LedgerRow]:
    """Yield rows of the memory ledger for the sea around a patch of particles; `word`: bytes of a `float`."""
    around = relaxation_band(lattice)
    if around is not None and around.sea is not None:
        from ocean_sim.fluid.patch.sea_patch import table_bytes

        what = f"a table of {len(around.sea.amplitude)} plane waves"
        yield LedgerRow("fluid", what, table_bytes(around, around.sea, word), "sea")
        if around.nonlinear is not None:
            cells = int(np.prod(tile_cells(around)))
            yield LedgerRow("fluid", f"a nonlinear sea of {cells} cells", 6 * 8 * cells, "sea.kind is spectral_sea")


def body_ledger(grid: GridSize, word: int, accounts: bool, told: int) -> Iterator[LedgerRow]:
    """Yield memory rows of bodies. `word`: bytes a float; `told`: floats a particle for them; `accounts`: with work."""
    from ocean_sim.fluid.bodies.boundary import any_moves, fixed_bodies, floating_bodies, memory

    lattice, common = grid.lattice, (grid.cell_count, word * told * grid.lattice.n)  # counted with the first bodies
    afloat = {key_of(name): [body] for name, body in floating_bodies(lattice, grid.support).items()}
    of_parts = {"basin": fixed_bodies(lattice, grid.support)} | afloat
    working = accounts and any(any_moves(found) for found in of_parts.values())
    for part, bodies in of_parts.items():
        count, why = sum(len(body.position) for body in bodies), "basin.obstacles, basin.floor"
        if part in afloat:
            why = f"{part}.kind is pressure: the water feels the hull"
        if bodies:
            size = memory(count, len(bodies), common[0], word, working) + common[1]
            yield LedgerRow(part, f"{count} samples of solid bodies", size, why)
            common = 0, 0


def has_bodies(basin: Basin) -> bool:
    """True if solid bodies act on the water by boundary particles: obstacles, a shaped bed, some floating bodies."""
    return bool(basin.config.obstacles or any(solid.is_sampled for solid in basin.solids))


def step_limits(
    smoothing: Smoothing, sound_speed: float, viscosity: float, speed: float, acceleration: float
) -> Limits:
    """Limits of the time step (see `Limits`) from speeds [m/s], kinematic viscosity [m2/s], acceleration [m/s2]."""
    h = smoothing.length
    return Limits(
        acoustic=h / (sound_speed + speed),
        viscous=h * h / viscosity if viscosity > 0.0 else inf,
        force=sqrt(h / acceleration) if acceleration > 0.0 else inf,
    )


@in_kernels
class Sph(ParticleWater):
    """Base class of water of interacting particles, with solid bodies among them; a scheme adds laws and a step."""

    config: SphConfig
    boundary: "Boundary | None" = None

    def __init__(self, config: SphConfig, basin: Basin, sizes: GridSize, accounts: bool, wind: Wind) -> None:
        super().__init__(config, basin, sizes, accounts, wind)
        self.neighbours: Walk = sizes.plan.walk(self.particles, self.grid, self.accounts, sizes)
        self.reference_speed, self.sound_speed = config.speed(basin), config.sound_speed(basin)
        self.kinematic_viscosity = config.kinematic_viscosity
        self.dt = ti.field(float, shape=())  # [s]
        self.bodies = has_bodies(basin)
        if self.bodies:
            from ocean_sim.fluid.bodies.boundary import Boundary, fixed_bodies, floating_bodies

            lattice, support = sizes.lattice, sizes.support
            bodies = [*fixed_bodies(lattice, support), *floating_bodies(lattice, support).values()]
            water = self.particles, self.grid, self.pull, self.smoothing
            self.boundary = Boundary(bodies, *water, accounts, self.walls.relief)
        own = len(self.carried) - (config.told_to_bodies if self.bodies else 0)
        self.last_acceleration = self.carried[own:]  # [m/s2], which solid bodies are told
        pull = self.pull.constant, self.pull
        self.field = Field(self.particles, self.grid, self.smoothing, *pull, self.boundary)
        self.exposed = wind.needs_area
        if self.exposed:
            from ocean_sim.fluid.bodies.exposure import Exposure

            self.exposure = Exposure(self, sizes.lattice.plan_area or 0.0, wind.needs_bend)

    @property
    def listed_positions(self) -> tuple[ti.Field, ...]:
        """Fields x, y, z of the positions [m] at which neighbours were last listed: here the present ones."""
        return tuple(self.particles.position)

    def advance_boundaries(self, dt: float) -> None:
        """Move tank, walls, gates and sea for a step of dt [s]; recompute exposed areas if they are due."""
        if self.exposed:
            self.exposure.renew_if_due(dt, self.status.max_speed + self.reference_speed)
        super().advance_boundaries(dt)
        if self.boundary is not None:
            self.boundary.advance(self.time)
            self.boundary.sort()

    def limits(self) -> Limits:
        """Limits of the next step by sound, viscosity, highest speed and highest acceleration."""
        nu, acceleration = self.kinematic_viscosity, self.status.max_acceleration
        return step_limits(self.smoothing, self.sound_speed, nu, self.max_speed, acceleration)

    @property
    def max_speed(self) -> float:
        """Highest speed [m/s] of the water and of gates in the last step."""
        return self.status.max_speed if self.boundary is None else max(self.status.max_speed, self.boundary.speed)

    @property
    def impulse(self) -> dict[str, np.ndarray]:
        """Impulse (3,) [N s] by force; obstacles and floating bodies are listed besides walls; empty if not summed."""
        total = super().impulse
        if total and self.boundary is not None:
            given, fixed = -self.boundary.impulses(), self.boundary.given
            total["obstacles"] = given[:fixed].sum(axis=0)
            total["ship"] = given[fixed:].sum(axis=0) + total.get("ship", 0.0)
            total["walls"] = total["walls"] - given.sum(axis=0)  # the laws count all as walls
        return total

    @property
    def work(self) -> dict[str, float]:
        """Work [J] by force; moving bodies are listed besides walls; empty if not summed."""
        total = super().work
        if total and self.boundary is not None and self.boundary.working:
            (done, counted), fixed = self.boundary.works().T, self.boundary.given
            total["obstacles"] = float(done[:fixed].sum())
            total["ship"] = float(done[fixed:].sum()) + total.get("ship", 0.0)
            total["walls"] -= float(counted.sum())  # the laws count all as walls
        return total

    @ti.func
    def damp_crowded(self, i, share):
        """Scale down the stored acceleration of particle i where bodies fill a large `share` of its kernel's space."""
        for component in ti.static(self.last_acceleration):
            component[i] *= tm.min(1.0, CROWDED_SHARE / tm.max(share, CROWDED_SHARE))

    @ti.func
    def exposed_area(self, i):
        area = tm.vec3(0.0)
        if ti.static(self.exposed):
            area = self.exposure.of(i)
        return area

    @ti.func
    def surface_bend(self, i):
        bend = tm.vec3(0.0)
        if ti.static(self.exposed):
            bend = self.exposure.bend_of(i)
        return bend
