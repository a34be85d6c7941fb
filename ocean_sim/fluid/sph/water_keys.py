"""Config keys of water made of particles, common to every scheme."""

from collections.abc import Iterator
from dataclasses import replace
from math import sqrt
from typing import Annotated, Any, ClassVar, cast

import numpy as np
from pydantic import Field, field_validator

from ocean_sim import machine
from ocean_sim.basin import BOX_ROUNDING, Basin, Box, box_faults, odd_gravity
from ocean_sim.conventions import LEAST_DENSITY, WATER_DENSITY, figures
from ocean_sim.fluid.bodies.emitter import MOST_PARTICLES, Emitter
from ocean_sim.fluid.bodies.emitter import problems as mouth_problems
from ocean_sim.fluid.sph import initial_state as initial_module
from ocean_sim.fluid.sph.initial_state import Initial
from ocean_sim.fluid.sph.lattice import Lattice, in_obstacles
from ocean_sim.fluid.sph.smoothing import WENDLAND, Kernel
from ocean_sim.model import Fault, Faults, Vector3, below, quantity
from ocean_sim.parts import FluidConfig, SceneFacts, forces_in_waves
from ocean_sim.runtime import BASE_MEMORY, COPY_BYTES_PER_PARTICLE
from ocean_sim.waves import Components

MAX_ROUNDING_SPACINGS = 1e-3  # [spacings] between two numbers: about a hundredth of the way of a particle in a step
COARSE_PARTICLES = 50_000  # of the lattice by which the memory of a particle is measured
MIN_GATE_SPACINGS = 2.0  # [spacings] thickness of a gate that holds still water back as a wall does


class WaterConfig(FluidConfig):
    """Keys that every kind of particle water shares."""

    made_of_particles: ClassVar[bool] = True
    counts_in_doubles: ClassVar[bool] = False
    leaks: ClassVar[bool] = False
    """True if the pressure of carried density leaks where particles do not stand for it."""
    example: ClassVar[dict[str, Any]] = {"spacing": 2.5}
    kernel: ClassVar[Kernel] = WENDLAND
    """Kernel of the gradient of pressure, and of exposed areas."""

    spacing: float | None = quantity("m", None, gt=0.0)
    """Distance between particles at rest."""
    particles: int | None = quantity("particles", None, ge=1, le=MOST_PARTICLES)
    """A budget of particles, in place of `spacing`."""
    rest_density: float = quantity("kg/m3", WATER_DENSITY, ge=LEAST_DENSITY)
    """Density of the water at rest."""
    body_force: Vector3 = quantity("m/s2", (0.0, 0.0, 0.0))
    """A constant acceleration in addition to gravity."""
    fill: Annotated[tuple[Box, ...], Field(strict=False, min_length=1)] | None = None
    """Boxes of water instead of the whole basin."""
    initial: Initial | None = None
    """State that the water starts from; null: at rest."""
    emitter: Emitter | None = None
    """An inflow: water flows from a mouth into a basin that is empty but for `fill`."""
    motion_limit: float | None = quantity("spacings", None, gt=0.0)
    """Longest way of a particle in one step; particles that it holds back are counted. null: no limit."""
    impulses: bool = True
    """Sum impulse and work of each term, which `accuracy` reads. Without the sums a step takes about 0.85
    of the time, and rounds otherwise."""
    collision_distance: float = quantity("spacings", 0.5, gt=0.0, le=1.0)
    """Least distance of a particle's centre from a wall or the floor."""

    @field_validator("spacing", "particles", mode="before")
    @classmethod
    def _one_size(cls, value: Any) -> Any:
        """Validate that `spacing` and `particles` are single numbers: particles of mixed size are not modelled."""
        if isinstance(value, (list, tuple)):
            raise ValueError(
                "particles of mixed size are not modelled: their forces would not be symmetric; give one number"
            )
        return value

    def contradictions(self) -> Iterator[str]:
        if (self.spacing is None) == (self.particles is None):
            yield "give either spacing [m] or particles, a budget"

    def sums_impulses(self, read: bool) -> bool:
        """True if the key `impulses` asks to sum impulse and work of forces; `read`, an observer's need, is ignored."""
        return self.impulses

    def statements(self, preflight: SceneFacts) -> Iterator[str]:
        if preflight.sea is not None:
            yield from forces_in_waves(preflight, False, False)
        if self.motion_limit is not None:
            limit = f"{self.motion_limit:g}"
            yield f"no particle moves further than {limit} spacings in a step; what is held back is counted"
        if (piston := preflight.tank.piston) is not None and piston.path.sea is None:
            yield f"the wavemaker moves up to {piston.path.advance:.3g} m into the basin"
        for k, mesh in preflight.tank.meshes.items():
            low, up = ((end[: preflight.tank.dimension].round(4) + 0.0).tolist() for end in mesh.extent)
            yield f"obstacles.{k} is a mesh from {low} to {up} m"
        for k, gate in preflight.tank.gates:
            moves = f"moves from {gate.start:g} s on, at up to {gate.fastest(preflight.duration):.3g} m/s, and "
            leaves = "stays" if gate.end is None else f"has left at {gate.end:g} s"
            yield f"obstacles.{k} {moves if gate.moves else ''}{leaves}"

    def warnings(self, preflight: SceneFacts) -> Iterator[str]:
        yield from super().warnings(preflight)
        tank, spacing = preflight.tank, preflight.spacing
        yield from odd_gravity(tank.gravity)
        if tank.gravity[1] > 0.0 and tank.walls.y != "periodic" and not tank.closed:
            yield f"gravity points upwards, {list(tank.gravity)} m/s2: the water falls out of the basin"
        elif tank.gravity[1] < 0.0 and tank.config.floor == "none" and tank.walls.y != "periodic":
            yield "the basin has no floor: the water falls out of it"
        far = float(np.abs([*tank.lower, *tank.upper]).max())
        step = far * float(np.finfo(np.float32).eps)
        if spacing is not None and preflight.word == 4 and step > MAX_ROUNDING_SPACINGS * spacing:
            begin = f"single precision places particles {far:g} m from the origin to {step:.2g} m,"
            yield f"{begin} {step / spacing:.2g} spacings; take runtime.precision: f64, or a basin around its water"
        if tank.config.wavemaker is not None:
            yield from tank.config.wavemaker.warnings(tank, preflight.duration)
        if tank.config.motion is not None:
            yield from tank.config.motion.warnings(preflight.duration)
        for k, box in enumerate(tank.config.obstacles):
            thin = min(up - low for low, up in zip(box.min, box.max))
            if spacing is not None and thin < MIN_GATE_SPACINGS * spacing - BOX_ROUNDING:
                sheet = f"obstacles.{k} is {thin / spacing:.2g} spacings thin: water on either side feels the other"
                yield f"{sheet}; take {MIN_GATE_SPACINGS:g} spacings, or a smaller fluid.spacing"
        yield from (f"obstacles.{k}: {skin}" for k, mesh in tank.meshes.items() for skin in mesh.mesh.skins)
        for k, gate in tank.gates:
            yield from gate.warnings(preflight.duration)
            fastest, speed = gate.fastest(preflight.duration), self.speed(tank)
            if fastest > speed and self.sound_speed(tank) > 0.0:
                opening = f"obstacles.{k} moves at up to {fastest:.3g} m/s,"
                middle = f"faster than the reference speed of {speed:.3g} m/s:"
                yield f"{opening} {middle} water that it runs into is compressed more than fluid.compression says"

    def losses(self, lattice: Lattice, sea: Components) -> np.ndarray | None:
        """Complex decay rate (n,) [1/s] of each wave; imaginary part: minus its loss of frequency; None if unknown."""
        return None

    @property
    def steady_force(self) -> Vector3:
        return self.body_force

    @property
    def driven(self) -> bool:
        return self.emitter is not None

    def start_lattice(self, preflight: SceneFacts) -> Lattice:
        """Lattice on which this water starts in a scene, with room made for floating bodies."""
        lattice = preflight.lattice
        assert isinstance(lattice, Lattice)
        return lattice

    @property
    def sized_by(self) -> str:
        """Name of the key that sets the resolution: `spacing` or `particles`."""
        return "spacing" if self.spacing is not None else "particles"

    def most_particles(self, preflight: SceneFacts) -> int:
        return MOST_PARTICLES

    def fitting_spacing(self, preflight: SceneFacts) -> str:
        """Text that names the least spacing [m] that fits this machine's memory, scaled from a coarse lattice."""
        volume, d = cast(Lattice, preflight.untouched).volume, preflight.tank.dimension
        coarse = self.model_copy(update={"spacing": (volume / COARSE_PARTICLES) ** (1.0 / d), "particles": None})
        there = replace(preflight, parts={**preflight.parts, "fluid": coarse})
        each = sum(row.bytes for row in coarse.ledger(there)) / there.particles + COPY_BYTES_PER_PARTICLE
        most = min((0.9 * machine.memory_limit() - BASE_MEMORY) / each, coarse.most_particles(there))
        return f"fluid.spacing from {1.01 * (volume / most) ** (1.0 / d):.3g} m on fits this machine"

    def lattice(self, basin: Basin) -> Lattice:
        """Lattice on which the particles start in this basin; nothing is allocated yet."""
        return Lattice(self, basin)

    def problems(self, preflight: SceneFacts) -> Faults:
        basin = preflight.tank
        found: list[Fault] = []
        if basin.dimension == 2 and self.body_force[2] != 0.0:
            found.append((("body_force",), "a 2-D basin, in x-y, has no force along z"))
        fill = self.fill or ()
        overlap = "overlaps an earlier one: two particles would share a position"
        misplaced = list(box_faults("fill", fill, basin, overlap))
        if any(len(box.min) != basin.dimension for box in fill):
            return found + misplaced
        if basin.sea is not None:
            for name, value in (("initial", self.initial), ("fill", self.fill), ("emitter", self.emitter)):
                if value is not None:
                    found.append(((name,), f"water that is a patch of the sea starts as the sea; leave {name} out"))
            if found:
                return found
        if self.emitter is not None:
            found += below("emitter", faults=self.emitter.problems(basin))
            if self.fill is None and (self.spacing is None or self.initial is not None):
                needed = "initial" if self.spacing is not None else "particles"
                found.append(((needed,), "with an emitter the basin is empty but for `fill`, which this needs"))
            if found:
                return found
        found += below("initial", faults=initial_module.problems(self.initial, basin))
        lattice = preflight.untouched
        assert isinstance(lattice, Lattice)
        if self.spacing is not None and lattice.volume > MOST_PARTICLES * self.spacing**basin.dimension:
            count = lattice.volume / self.spacing**basin.dimension
            most = f"would make {figures(count, 2)} particles, more than {MOST_PARTICLES}, the most that there can be"
            found.append((("spacing",), f"{most}; {self.fitting_spacing(preflight)}"))
        found += misplaced
        if lattice.jet is not None and not found:
            found += below("emitter", faults=mouth_problems(basin, lattice.jet))
            if in_obstacles(lattice.jet.sites, basin, lattice.spacing).any():
                found.append((("emitter", "position"), "the mouth is inside an obstacle"))
        thin = [sentence for mesh in basin.meshes.values() if (sentence := mesh.problem(lattice.spacing))]
        found += [((self.sized_by,), sentence) for sentence in thin]
        if basin.config.obstacles and not found:
            if lattice.n == 0:
                found.append((("fill",), "the obstacles of the basin leave no room for water"))
            elif lattice.given is not None and in_obstacles(lattice.given, basin, lattice.spacing).any():
                found.append((("initial", "path"), "some of these particles are inside an obstacle"))
        return found


def free_fall_speed(basin: Basin) -> float:
    """Speed scale of water under gravity, sqrt(|g| depth) [m/s], depth of the basin."""
    return sqrt(float(np.linalg.norm(basin.gravity)) * basin.depth)
