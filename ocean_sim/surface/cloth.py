"""A sheet of masses and springs on the water (thesis 3.2 and 5.2.2, Algorithm 5); the water never feels it.

Its nodes slide on upright rails: the thesis looks a height up by x and z as if they did. Each update carries a node on
with its speed, moves it to the height at which the share of water around it is that of a flat surface, and lets the
springs pull. Springs are an implicit step with the diagonal of their Hessian, gathered node by node (Jacobi): any
stiffness and any time step are stable, and the result does not depend on threads.

A node has water around it if the share of water within the sheet's thickness, smoothed with the poly6 kernel, is above
that of a flat surface. A lone drop does not reach that share, so spray does not lift the sheet.
"""

from functools import cached_property
from math import ceil, pi
from typing import TYPE_CHECKING, ClassVar, Literal, Self

import numpy as np

from ocean_sim.basin import Basin
from ocean_sim.fluid import Fluid, with_particles
from ocean_sim.kernel_library import ti, tm
from ocean_sim.model import Faults, quantity
from ocean_sim.parts import LedgerRow, SceneFacts, SurfaceConfig
from ocean_sim.runtime import in_kernels
from ocean_sim.surface import AREA_AND_VOLUME, Mesh, Surface
from ocean_sim.surface.shared.heights import Heights, column_counts

if TYPE_CHECKING:
    from ocean_sim.fluid import Particles

MAX_MOVES = 8  # the most moves of a node towards the surface in one update
LAST_MOVE = 0.01  # [thicknesses] a smaller move is the last
MAX_NODES = 2**24
MAX_CARRY = 0.5  # [thicknesses] that its speed carries a node in one update
LATTICE_OFFSETS = 12  # positions of a node between the particles of a lattice, along an axis
LATTICE_HEIGHTS = 241
# Springs as steps along x and z from a node to the other end (thesis figure 3-3).
STRETCH_STEPS, SHEAR_STEPS, BEND_STEPS = ((1, 0), (0, 1)), ((1, 1), (1, -1)), ((2, 0), (0, 2))


class Config(SurfaceConfig):
    """A sheet over the whole basin; in 2-D a rope. Where it is dry it lies on the bed."""

    compared: ClassVar[bool] = True
    kind: Literal["cloth"] = "cloth"
    spacing: float | None = quantity("m", None, gt=0.0)
    """Distance between nodes, changed a little to fit the basin; null: the spacing of the particles."""
    thickness: float | None = quantity("m", None, gt=0.0)
    """Distance from a node within which water counts; at least a spacing and at most a support of the particles. null:
    two spacings, or the support if that is less."""
    stretching_stiffness: float = quantity("1/s2", 18.0, ge=0.0)
    """Stiffness of stretch and shear springs: spring constant over mass of a node."""
    bending_stiffness: float = quantity("1/s2", 18.0, ge=0.0)
    """Stiffness of bend springs: spring constant over mass of a node."""
    damping: float = quantity("1/s", 0.06, ge=0.0)
    """Rate at which the speed of a node decays."""
    response: float = quantity("1", 1.0, ge=0.0, le=1.0)
    """Share of the way to the water's surface that a node goes in one update; 0: the water does not move it."""
    edges: float | None = quantity("m", None)
    """Height above the still water at which all edges are held, as in the thesis (-0.5), and `elevation` next to them
    with them; null, which is right up to the walls: they slide along them with the water."""
    every: float = quantity("s", 1.0 / 60.0, gt=0.0)
    """Simulated time between updates, to the nearest step."""

    def completed(self, preflight: SceneFacts) -> Self:
        assert preflight.spacing is not None
        widest = min(2.0 * preflight.spacing, preflight.support)
        found = {"spacing": self.spacing or preflight.spacing, "thickness": self.thickness or widest}
        return self.model_copy(update=found)

    def problems(self, preflight: SceneFacts) -> Faults:
        if preflight.tank.closed:
            yield ("kind",), "a basin without a free surface has nothing for a cloth to lie on; leave it out"

    def mismatches(self, preflight: SceneFacts) -> Faults:
        least, most = preflight.spacing, preflight.support
        assert least is not None
        nx, nz = self.completed(preflight).nodes(preflight.tank)
        if nx * nz > MAX_NODES:
            yield ("spacing",), f"would make {nx} x {nz} nodes, more than {MAX_NODES}"
        elif self.thickness is not None and not 0.999 * least < self.thickness < 1.001 * most:
            thin = self.thickness < least
            why = "less, and the sheet falls between them" if thin else "water is looked for no further"
            span = f"a spacing of the particles, {least:.4g} m, and their support, {most:.4g} m"
            yield ("thickness",), f"{self.thickness:g} m must lie between {span}: {why}"

    def nodes(self, basin: Basin) -> tuple[int, int]:
        """Numbers of nodes along x and z, of a completed config; 1 along z in 2-D."""
        assert self.spacing is not None, "completed() says how far apart nodes are"
        return column_counts(basin, self.spacing)

    def ledger(self, preflight: SceneFacts) -> list[LedgerRow]:
        nx, nz = self.completed(preflight).nodes(preflight.tank)
        size, why = 3 * preflight.word * nx * nz, "surface.kind is cloth"
        return [LedgerRow("surface", f"{nx} x {nz} nodes", size, why)]

    def build(self, basin: Basin, fluid: Fluid) -> Surface:
        return Cloth(self, basin, fluid)


@in_kernels
class Cloth:
    """Sheet of nodes that move up and down only, joined by springs; node (i, k) along x, z has the number i nz + k."""

    def __init__(self, config: Config, basin: Basin, fluid: Fluid) -> None:
        water = with_particles(fluid)
        self.config, self.around, particles = config, water.around, water.particles
        self.nodes, self.flat, self.bed = config.nodes(basin), basin.dimension == 2, basin.lower[1]
        self.heights = Heights.over_basin(basin, self.nodes)
        size = (particles.mass / particles.rest_density) ** (1.0 / basin.dimension)
        assert config.thickness is not None
        self.thickness = config.thickness
        self.contact = Contact(basin.dimension, self.thickness, size)
        self.at_surface, self.steepness = self.contact.at_surface, self.contact.steepness
        stretching, bending = config.stretching_stiffness, config.bending_stiffness
        steps = [(*step, stretching) for step in STRETCH_STEPS + SHEAR_STEPS]
        steps += [(*step, bending) for step in BEND_STEPS]
        self.springs = [*steps, *((-di, -dk, stiffness) for di, dk, stiffness in steps)]  # both ways from a node
        count = self.nodes[0] * self.nodes[1]
        self.height = self.heights.height  # [m]
        self.speed, self.on_water = ti.field(float, shape=count), ti.field(float, shape=count)  # [m/s], [m]
        self.held = config.edges is not None
        self.edges = max(config.edges or 0.0, self.bed)
        self.age = 0.0  # [s] since the last update
        self.measured = {} if self.flat else AREA_AND_VOLUME
        self.lay_down(particles)

    def lay_down(self, particles: "Particles") -> None:
        """Lower the sheet from above all particles until it lies at rest on the water."""
        top = float(particles.snapshot().position[:, 1].max()) + self.thickness
        self.height.fill(top)
        moves = 4.0 * (top - self.bed) / self.thickness + MAX_MOVES
        for _ in range(int(moves / MAX_MOVES) + 1):
            self.update(0.0)

    def follow(self, particles: "Particles", dt: float) -> None:
        self.age += dt
        if self.age + 0.5 * dt > self.config.every:
            self.update(self.age)
            self.age = 0.0

    @ti.kernel
    def update(self, dt: float):
        """Advance the sheet by dt [s]: carry nodes on, move them to water, pull by springs; 0: only to water."""
        for n in self.height:
            way = dt * self.speed[n] * tm.exp(-ti.static(self.config.damping) * dt)
            most = ti.static(MAX_CARRY * self.thickness)
            self.on_water[n] = self.moved_to_water(n, self.height[n] + tm.clamp(way, -most, most))
        for n in self.height:
            height = self.on_water[n] + dt * dt * self.spring_pull(n, dt)
            if ti.static(self.held):
                if self.on_edge(n):
                    height = self.edges
            height = tm.max(height, self.bed)
            self.speed[n] = (height - self.height[n]) / dt if dt > 0.0 else 0.0
            self.height[n] = height

    @ti.func
    def on_edge(self, n):
        """True if node n lies at an edge of the sheet."""
        i, k = n // self.nodes[1], n % self.nodes[1]
        side = i == 0 or i == self.nodes[0] - 1
        if ti.static(not self.flat):
            side = side or k == 0 or k == self.nodes[1] - 1
        return side

    @ti.func
    def moved_to_water(self, n, y):
        """Height [m] of node n after Newton steps, which never overshoot, from the height y [m] to the water."""
        p, start, moves = self.heights.column_place(n), y, 0
        while moves < MAX_MOVES:
            share = self.around.total(tm.vec3(p.x, y, p.y), self.contact, 0.0)  # of the water within a thickness
            move = (share[0] - ti.static(self.at_surface)) / tm.max(-share[1], ti.static(self.steepness))
            y, moves = y + move, ti.select(ti.abs(move) < LAST_MOVE * self.thickness, MAX_MOVES, moves + 1)
            if y < self.bed:
                y, moves = self.bed, MAX_MOVES
        return start + ti.static(self.config.response) * (y - start)

    @ti.func
    def spring_pull(self, n, dt):
        """Upward acceleration [m/s2] of node n by its springs, implicit over a step of dt: -sum k C C' / (1 + 2 dt^2
        sum k (C'^2 + C C'')); k: stiffness, C: stretch of a spring, C', C'': its derivatives by the node's height."""
        i, k = n // self.nodes[1], n % self.nodes[1]
        force, hessian = 0.0, 0.0
        for di, dk, stiffness in ti.static(self.springs):
            there = self.neighbour_node(i + di, k + dk)
            if there >= 0:
                rest = tm.length(self.heights.width * tm.vec2(di, dk))
                rise = self.on_water[n] - self.on_water[there]
                length = ti.sqrt(rest * rest + rise * rise)
                stretch, slope = length - rest, rise / length
                force -= stiffness * stretch * slope
                hessian += stiffness * (slope * slope + stretch / length * (1.0 - slope * slope))
        return force / (1.0 + 2.0 * dt * dt * hessian)

    @ti.func
    def neighbour_node(self, i, k):
        """Number of node (i, k), wrapped at periodic sides; -1 beyond other sides."""
        nx, nz = ti.static(self.heights.cells)
        if ti.static(self.heights.periodic[0]):
            i = (i + 2 * nx) % nx
        if ti.static(self.heights.periodic[1]):
            k = (k + 2 * nz) % nz
        inside = 0 <= i < self.nodes[0] and 0 <= k < self.nodes[1]
        return ti.select(inside, i * self.nodes[1] + k, -1)

    @ti.func
    def elevation(self, x, z):
        return self.heights.height_at(x, z)

    def elevations(self, points: np.ndarray) -> np.ndarray:
        return self.heights.elevations(points)

    def mesh(self) -> Mesh:
        return self.heights.mesh()

    def measures(self) -> list[float]:
        """Area of the sheet [m2] and volume of water under it [m3]; none in 2-D."""
        if self.flat:
            return []
        mesh = self.mesh()
        return [mesh.area, mesh.volume(self.bed)]


@in_kernels
class Contact:
    """Share of water, smoothed, within `thickness` [m] of a point, and the upward gradient [1/m] of this share."""

    sums = 2

    def __init__(self, dimension: int, thickness: float, spacing: float) -> None:
        """`thickness`: radius of the smoothing kernel [m]; `spacing`: of the particles at rest [m]."""
        self.dimension, self.thickness, self.spacing = dimension, thickness, spacing
        constant = {2: 4.0 / (pi * thickness**8), 3: 315.0 / (64.0 * pi * thickness**9)}[dimension]
        self.constant = constant * spacing**dimension

    @ti.func
    def term(self, own, j, d, mirror):
        """(2,) contribution of particle j, at d [m] from the point, to the smoothed share of water and to its upward
        gradient; `own`, `mirror` are not used."""
        w = self.thickness * self.thickness - d.dot(d)
        w = ti.select(w > 0.0, w, 0.0)
        return ti.static(self.constant) * w * w * ti.Vector([w, 6.0 * d.y])

    @cached_property
    def over_a_lattice(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Smoothed share of water around points near flat water whose particles lie on a lattice: (a) heights (h,) [m]
        of the points over the surface, rising; (b) shares (p, h) at p horizontal positions between particles; (c)
        weights (p,) of the positions, greater where one stands for its mirror image, too."""
        reach = self.thickness / self.spacing
        n = ceil(reach) + 1
        height = np.linspace(-n, n, LATTICE_HEIGHTS)
        offset = (np.arange(LATTICE_OFFSETS // 2) + 0.5) / LATTICE_OFFSETS
        x = np.square(offset[:, None] - np.arange(-n, n + 1))
        across_squared, weight = x, np.ones(len(x))
        if self.dimension == 3:
            i, k = np.triu_indices(len(x))
            across_squared = (x[i][:, :, None] + x[k][:, None, :]).reshape(len(i), -1)
            weight = np.where(i == k, 1.0, 2.0)
        below = np.square(height[:, None] + 0.5 + np.arange(2 * n + 1))

        def summed(across: np.ndarray) -> np.ndarray:  # all together are more than caches hold
            w = np.maximum(reach**2 - across[:, None] - below[:, None, :], 0.0)
            return np.asarray(np.sum(w * w * w, axis=(1, 2)))

        shares = self.constant * self.spacing**6 * np.array([summed(across) for across in across_squared])
        return height * self.spacing, shares, weight / weight.sum()

    def surface_height(self, share: float) -> float:
        """Height [m] over a flat lattice of particles where the smoothed share of water is `share`; mean over x, z."""
        height, shares, weight = self.over_a_lattice
        k = LATTICE_HEIGHTS - 1 - np.argmax(shares[:, ::-1] >= share, axis=1)
        k = np.minimum(k, LATTICE_HEIGHTS - 2)
        inside, outside = (np.take_along_axis(shares, column[:, None], axis=1)[:, 0] for column in (k, k + 1))
        above = height[k] + (height[1] - height[0]) * (inside - share) / np.maximum(inside - outside, 1.0e-12)
        return float(weight @ above)

    @cached_property
    def at_surface(self) -> float:
        """Smoothed share of water at the flat surface of a particle lattice; nodes move to where the share is this."""
        low, high = 0.05, 0.95
        for _ in range(40):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.surface_height(middle) > 0.0 else (low, middle)
        return 0.5 * (low + high)

    @cached_property
    def steepness(self) -> float:
        """Steepest decrease with height [1/m] of the smoothed share of water around a point, through a flat surface."""
        height, shares, weight = self.over_a_lattice
        return float(-np.gradient(weight @ shares, height).min())
