"""Base class of all water made of particles: grid, walls, surface, emitter, budget, and the frame of a step."""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.fluid import Contact, Displacing, Fluid, ParticleFluid, Totals
from ocean_sim.fluid.bodies.walls import Walls
from ocean_sim.fluid.budget import momentum_budget as budget
from ocean_sim.fluid.budget.field import Field, FreeSurface
from ocean_sim.fluid.neighbours.grid import Grid
from ocean_sim.fluid.neighbours.grid_size import GridSize
from ocean_sim.fluid.neighbours.point_sum import PointSum
from ocean_sim.fluid.neighbours.thread_tasks import Tasks
from ocean_sim.fluid.patch.relaxation_zone import relaxation_band
from ocean_sim.fluid.sph.body_force import Bed, Pull
from ocean_sim.fluid.sph.particles import Particles, seeded, staggered_field
from ocean_sim.fluid.sph.smoothing import Smoothing
from ocean_sim.fluid.sph.water_keys import WaterConfig
from ocean_sim.kernel_library import ti, tm
from ocean_sim.runtime import Array2, in_kernels, runs_alone
from ocean_sim.waves import Components
from ocean_sim.wind import Wind

if TYPE_CHECKING:  # it is imported only where a sea is around
    from ocean_sim.fluid.patch.sea_patch import SeaRim


@in_kernels
class ParticleWater(ParticleFluid):
    """Base class of particle water, sorted by cell between steps. A scheme adds `step`, which moves the particles, and
    `arrive`, which sorts them and computes their fields at the start and whenever an emitter has added some."""

    particles: Particles
    around: PointSum
    grid: Grid
    accounts: budget.Accounts
    tasks: Tasks
    walls: Walls
    field: Field
    contacts: list[Contact]
    bed: Bed
    rim: "SeaRim"

    def __init__(self, config: WaterConfig, basin: Basin, size: GridSize, accounts: bool, wind: Wind) -> None:
        self.config, self.wind = config, wind
        lattice = size.lattice
        self.particles = seeded(lattice)
        self.rest_density, self.spacing = self.particles.rest_density, self.particles.spacing
        self.smoothing = Smoothing(basin.dimension, size.support, config.kernel)
        self.carried = tuple(staggered_field(float, self.particles.n) for _ in range(size.carried))
        self.grid = size.plan.grid(self.particles, size, self.carried)
        self.rubs, self.joined = basin.rough_bed is not None, basin.sea is not None
        absent = (*budget.absent_terms(basin), *(() if config.leaks else (budget.LEAK,)))
        self.accounts = size.plan.accounts(size.groups, accounts, absent)
        self.accounts.idle += (budget.SHIP,) if wind.blows else (budget.SHIP, budget.WIND)
        self.tasks = Tasks(self.particles.count, size.groups, size.plan.stride)
        self.surface = FreeSurface(self.particles, self.grid, self.smoothing)
        self.around = self.surface.around
        self.walls = Walls(lattice, self.grid.images)
        self.pull = Pull(basin, config.body_force)
        if basin.rough_bed is not None:
            self.bed = Bed(basin.rough_bed, lattice, self.smoothing, self.walls.relief)
        around = relaxation_band(lattice)
        self.sea = around.sea if around is not None else None
        if around is not None:
            from ocean_sim.fluid.patch.sea_patch import SeaRim

            self.rim = SeaRim(around)
        self.summing = budget.Summing(self.particles)
        self.jet, self.lifts = lattice.jet, basin.has_potential(config.steady_force)
        self.time = 0.0  # [s]
        self.emitted_impulse, self.emitted_work = np.zeros(3), 0.0  # [N s], [J]
        self.contacts = []
        self.summary: np.ndarray = np.zeros(budget.SUMMARY_SIZE, dtype=self.particles.position.precision)

    @property
    def of_particles(self) -> ParticleFluid:
        return self

    @property
    def plane_waves(self) -> Components | None:
        return self.sea

    @property
    def can_be_disturbed(self) -> bool:
        """True if the surface may differ from `plane_waves`: for particles that fill a patch of open sea."""
        return self.joined

    @property
    def patch_centre(self) -> np.ndarray:
        return self.rim.centre_at(self.time) if self.joined else np.zeros(2)

    def in_rim(self, points: np.ndarray) -> np.ndarray:
        return self.rim.contains(points, self.time) if self.joined else super().in_rim(points)

    def add_contact(self, contact: Contact) -> None:
        self.contacts.append(contact)
        self.accounts.idle = tuple(term for term in self.accounts.idle if term != budget.SHIP)

    def add_ships(self, ships: Sequence[Displacing]) -> tuple[Fluid, ...]:
        """Let the patch of open sea (filled with particles) follow ships; return this same water for each of them."""
        if self.joined and ships:
            self.rim.follow(ships)
        return super().add_ships(ships)

    @ti.func
    def exposed_area(self, i):
        """Area of particle i exposed to air, times its outward normal [m2]; here zero, some schemes compute it."""
        return tm.vec3(0.0)

    @ti.func
    def surface_bend(self, i):
        """Second derivatives xx, xz, zz of the surface's height at particle i times Stencil.skin_depth; here zero."""
        return tm.vec3(0.0)

    @ti.func
    def wind_acceleration(self, i, x, v):
        """Acceleration [m/s2] of particle i, at x [m] with velocity v [m/s], by the wind."""
        m = ti.static(self.particles.mass)
        return self.wind.force(self.particles.id[i], x, v, self.exposed_area(i), self.surface_bend(i), m) / m

    @ti.func
    def hull_push(self, x, ahead):
        """Acceleration [m/s2] by the hulls of all ships at x [m], `ahead` [s] after the step began."""
        a = tm.vec3(0.0)
        for contact in ti.static(self.contacts):
            a += contact.hull.push(x, ahead)
        return a

    @ti.func
    def stage_particle(self, i, x, v):
        """Store the next position x [m] and velocity v [m/s] of particle i in the staging fields of the sort."""
        self.grid.stage_state(i, x, v)

    def begin(self) -> None:
        self.stage_all()
        self.arrive()
        self.status = self.accounts.status(self.summary, self.grid)

    def advance(self, dt: float) -> None:
        self.advance_boundaries(dt)
        self.step(dt)
        self.status = self.accounts.status(self.summary, self.grid)
        self.emit()

    @abstractmethod
    def arrive(self) -> None:
        """Sort the particles, at the start or after new ones; compute all fields, and extremes of speed, density."""

    @abstractmethod
    def step(self, dt: float) -> None:
        """Move the particles for dt [s] and sort them; update all their fields, and extremes of speed and density."""

    def advance_boundaries(self, dt: float) -> None:
        """Move tank and wavemaker to the middle of a step of dt [s]; gates, zones and sea to its end."""
        self.pull.advance(self.time + 0.5 * dt)
        self.grid.images.advance(self.time + 0.5 * dt)
        self.time += dt
        self.walls.advance(self.time)
        if self.joined:
            self.rim.advance(self.time)

    def emit(self) -> None:
        """Add the particles that left the emitter in the last step; record their momentum and energy."""
        if self.jet is None:
            return
        first, last = self.particles.count.now, self.jet.particle_count(self.time)
        if last == first:
            return
        x, v = self.jet.emitted_state(first, last, self.time, self.pull.at_mouth())
        precision = self.particles.position.precision
        self.append_particles(first, x.astype(precision), v.astype(precision))
        self.particles.count.set(last)
        self.emitted_impulse += self.particles.mass * v.sum(axis=0)
        energy = 0.5 * (v * v).sum()
        if self.lifts:
            energy -= (x @ self.pull.gravity).sum()
        self.emitted_work += self.particles.mass * float(energy)
        before, fastest = self.status, float(np.linalg.norm(v, axis=1).max())
        self.begin()
        fastest = max(before.max_speed, fastest)
        self.status = replace(self.status, max_speed=fastest, max_acceleration=before.max_acceleration)

    @ti.kernel
    def append_particles(self, first: int, x: Array2, v: Array2):
        """Append particles with positions x (m, 3) [m] and velocities v (m, 3) [m/s], from index `first` on."""
        ti.loop_config(serialize=True)
        for k in range(x.shape[0]):
            i, particles = first + k, self.particles
            particles.position.put(i, tm.vec3(x[k, 0], x[k, 1], x[k, 2]))
            particles.velocity.put(i, tm.vec3(v[k, 0], v[k, 1], v[k, 2]))
            particles.id[i], particles.density[i], particles.pressure[i] = i, particles.rest_density, 0.0
            for carried in ti.static(self.carried):
                carried[i] = 0.0

    @ti.kernel
    def stage_all(self):
        """Copy positions and velocities of all particles to the staging fields of the sort."""
        ti.loop_config(serialize=ti.static(runs_alone()))
        for i in range(self.particles.count.there()):
            for left in ti.static(self.grid.left):
                left[i] = 0.0
            self.grid.stage_state(i, self.particles.position.at(i), self.particles.velocity.at(i))

    def budget(self) -> dict[str, np.ndarray]:
        """Impulse x, y, z [N s], work [J], (4,), by name of the force; work of "emitter": all energy of its water."""
        total = self.accounts.totals()
        if total and self.jet is not None:
            total["emitter"] = np.append(self.emitted_impulse, self.emitted_work)
        if total and self.contacts:
            total["ship"] += sum(np.append(contact.given, contact.work) for contact in self.contacts)
        elif total:
            del total["ship"]
        return total

    @property
    def impulse(self) -> dict[str, np.ndarray]:
        without_impulse = [budget.TERM_NAMES[term] for term in budget.ENERGY_TERMS]
        return {term: row[: budget.WORK_COLUMN] for term, row in self.budget().items() if term not in without_impulse}

    @property
    def work(self) -> dict[str, float]:
        return {term: float(row[budget.WORK_COLUMN]) for term, row in self.budget().items()}

    @ti.func
    def elevation(self, x, z):
        return self.surface.elevation(x, z)

    def elevations(self, points: np.ndarray) -> np.ndarray:
        return self.surface.elevations(points)

    def totals(self) -> Totals:
        return self.summing.totals()

    def positions(self) -> np.ndarray:
        x = self.particles.position.to_numpy().astype(float)
        for k, left in zip(self.grid.axes, self.grid.left):
            x[:, k] += left.to_numpy()[: len(x)]
        return x

    def pressures(self, points: np.ndarray) -> np.ndarray:
        return self.field.pressures(points)

    def velocities(self, points: np.ndarray) -> np.ndarray:
        return self.field.velocities(points)
