"""The basin: its size, walls, floor and lid; 3-D, or 2-D, a vertical slice in x-y, where no width is given."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from math import log
from typing import TYPE_CHECKING, Annotated, Any, Literal, Protocol

import numpy as np
from pydantic import BeforeValidator, Discriminator, Field, Tag

from ocean_sim import waves
from ocean_sim.basin.motion import NOT_MOVED, AnyWavemaker, Gate, Motion, Piston
from ocean_sim.basin.open_sea import Absorbing, OpenSea
from ocean_sim.conventions import GRAVITY, AxisName
from ocean_sim.files.bathymetry import HIGHEST_GROUND, Heights, is_map, read_heights
from ocean_sim.files.input_file import FileName, Unreadable
from ocean_sim.model import Fault, Faults, Model, Point, Vector2, Vector3, below, quantity

if TYPE_CHECKING:  # they are imported only where the bed has a shape, or bodies are in the water
    from ocean_sim.basin.ground import Ground
    from ocean_sim.basin.solids import packing
    from ocean_sim.basin.solids.room import MeshSolid
    from ocean_sim.basin.solids.shape import Boxes, PlacedMesh

OPEN = 1.0e30  # [m] where a side that is open would stand

Wall = Literal["none", "reflecting", "no_slip", "periodic", "absorbing"]
Slip = Literal["free_slip", "no_slip"]
KARMAN_CONSTANT = 0.41  # constant of the logarithmic law
GRAINS_PER_Z0 = 30.0  # sand roughness over z0, where that law comes to rest (Nikuradse 1933, VDI-Forschungsheft 361)
MIN_ROW_SHARE = 0.25  # [rows] least height above the bed in the logarithmic law
Corners = tuple[tuple[float, ...], tuple[float, ...]]
SAME_DIGITS = 0.005  # of the decimal logarithm: a per cent, by which gravity differs over the Earth and in tables
LEVEL_ROUNDING = 1e-6  # of the depth by which a bed may be deeper, as numbers of single precision are
HIGHEST_BED = 50.0  # [depth of the basin] of a bed over still water: no water reaches so high
BOX_ROUNDING = 1e-9  # [m] by which a box may reach over a side or into another one
MESH_ROUNDING = 1e-6  # of its size by which a mesh may, as files have numbers of single precision


# A side written as the word `absorbing` becomes a mapping of its keys, so that dumped configs show the defaults.
OneSide = Annotated[
    Annotated[Wall, Tag("Wall")] | Annotated[Absorbing, Tag("Absorbing")],
    Discriminator(lambda written: "Absorbing" if isinstance(written, dict | Absorbing) else "Wall"),
    BeforeValidator(lambda written: {"kind": "absorbing"} if written == "absorbing" else written),
]
# Walls written as that word become a mapping with such an entry each for x and z.
AllSides = BeforeValidator(lambda written: {"x": written, "z": written} if written == "absorbing" else written)


class Walls(Model):
    """The wall on each side; `reflecting`: water slides along it, `no_slip`: it sticks to it, `periodic`: what leaves
    comes in at the other side, `absorbing`: waves end there, `none`: water flows out."""

    x: OneSide = "reflecting"
    """Both sides across x."""
    z: OneSide = "reflecting"
    """Both sides across z."""
    x_min: OneSide | None = None
    """The side at the lowest x; null: as `x`."""
    x_max: OneSide | None = None
    """The side at the highest x; null: as `x`."""
    z_min: OneSide | None = None
    """The side at the lowest z; null: as `z`."""
    z_max: OneSide | None = None
    """The side at the highest z; null: as `z`."""
    y: Literal["periodic"] | None = None
    """`periodic`: what leaves through the bed comes in at the still surface, and there is neither bed nor surface."""

    def key(self, side: str) -> str:
        """Config key that sets the wall at `side` (as `x_min`): this name, or `x` or `z`, which set both sides."""
        return side if getattr(self, side) is not None else side[0]

    def at(self, side: str) -> Wall:
        """Kind of wall at a side (`x_min`, `x_max`, `z_min` or `z_max`)."""
        wall: OneSide = getattr(self, self.key(side))
        return wall.kind if isinstance(wall, Absorbing) else wall

    def absorbing(self, side: str) -> Absorbing | None:
        """Absorption settings of a side (`x_min`, `x_max`, `z_min` or `z_max`); None if it does not absorb waves."""
        wall: OneSide = getattr(self, self.key(side))
        return wall if isinstance(wall, Absorbing) else None


class Lid(Model):
    """A flat lid at the height of the still water."""

    slip: Slip = "no_slip"
    """`no_slip`: water sticks to it; `free_slip`: it slides along."""
    velocity: Vector3 = quantity("m/s", (0.0, 0.0, 0.0))
    """Velocity of the lid, in its own plane."""


class Floor(Model):
    """A bed of any shape, or one with friction: free slip, and a shear stress tau on the water next to it, opposite to
    the water's velocity u along the bed. In a tank that moves, u is relative to the tank."""

    profile: Annotated[tuple[Annotated[tuple[float, float], Field(strict=False)], ...], Field(strict=False)] | None = (
        quantity("m", None)
    )
    """Points [x, y] of the bed, from one side to the other, straight in between; it is alike along z."""
    grid: FileName | None = None
    """Heights of the bed on a regular grid, in place of a profile: a table of x_m, z_m and y_m; or a map, an ESRI ASCII
    grid (.asc) or netCDF 3 (.nc), whose north is +z and whose east -x; linear in between."""
    grid_centre: Vector2 | None = quantity("m", None)
    """Place in the file at which the basin's middle lies: x, z, of a map east, north; null: [0, 0]."""
    slip: Slip = "free_slip"
    """`no_slip`: water sticks to the bed; `free_slip`: it slides along."""

    roughness: float | None = quantity("m", None, gt=0.0)
    """Nikuradse's sand roughness k_s: tau = rho (kappa u / ln(z / z0))^2 with u at the height z, z0 = k_s / 30 (Fredsoe
    & Deigaard 1992, Mechanics of coastal sediment transport; Nielsen 1992, Coastal bottom boundary layers)."""
    friction_factor: float | None = quantity("1", None, gt=0.0)
    """f of tau = rho f |u| u / 2, as for waves (Jonsson 1966): a quarter of that of Darcy and Weisbach."""

    def contradictions(self) -> Iterator[str]:
        if self.profile is not None and self.grid is not None:
            yield "give either a profile or a grid"
        if self.roughness is not None and self.friction_factor is not None:
            yield "give either roughness [m] or friction_factor"
        if not (self.rubs or self.shaped):
            yield "give a profile [m], a grid, a roughness [m] or a friction_factor"
        if self.rubs and self.slip == "no_slip":
            yield "a bed with friction is one that water slides along: leave slip out"
        x = [point[0] for point in self.profile or ((0.0, 0.0), (1.0, 0.0))]
        fall = next((f": {b:g} comes after {a:g}" for a, b in pairwise(x) if b <= a), None)
        if len(x) < 2 or fall:
            yield f"a profile has two points [x, y] or more, and their x rise{fall or ''}"

    @property
    def shaped(self) -> bool:
        """True if the bed has a shape of its own, and is not flat."""
        return self.profile is not None or self.grid is not None

    @cached_property
    def bed_heights(self) -> Heights:
        """Grid nodes and heights of the bed, as given in the scene, in the axes of the basin; raises Unreadable."""
        if self.profile is not None:
            x, y = np.array(self.profile).T
            return Heights(x, np.array([-OPEN, OPEN]), np.repeat(y[:, None], 2, axis=1))
        assert self.grid is not None
        return read_heights(self.grid, self.grid_centre or (0.0, 0.0))

    @property
    def middle(self) -> list[float]:
        """Middle x, z [m] of the bed's grid, to be compared with the key `grid_centre`."""
        (x, z, _), centre = self.bed_heights, self.grid_centre or (0.0, 0.0)
        way = -0.5 if self.grid is not None and is_map(self.grid) else 0.5
        return [centre[0] + way * float(x[0] + x[-1]), centre[1] + 0.5 * float(z[0] + z[-1])]

    def shape_problems(self, basin: "Basin") -> Faults:
        """Yield faults of the bed's shape in this basin: key path below `floor`, and sentence."""
        key = "profile" if self.profile is not None else "grid"
        try:
            x, z, y = self.bed_heights
        except Unreadable as error:
            yield (key,), f"{error}"
            return
        for axis, nodes in (("x", x), ("z", z)):
            low, up = basin.lower["xyz".index(axis)], basin.upper["xyz".index(axis)]
            if nodes[0] > low + BOX_ROUNDING or nodes[-1] < up - BOX_ROUNDING:
                middle = "" if self.grid is None else f"; its middle lies at grid_centre: {self.middle}"
                reach = f"reaches from {axis} = {nodes[0]:g} to {nodes[-1]:g} m, the basin from {low:g} to {up:g} m"
                yield (key,), f"the bed {reach}{middle}"
                return
        x, z, y = self.bed_heights.around(basin.plan_sides)
        if len(missing := np.argwhere(~np.isfinite(y))):
            first = f"the first at x = {x[missing[0, 0]]:g}, z = {z[missing[0, 1]]:g} m"
            told = f"{len(missing)} of {y.size} heights in the basin are missing, or of {HIGHEST_GROUND:g} m and more"
            yield (key,), f"{told}, {first}"
            return
        if y.min() < (1.0 + LEVEL_ROUNDING) * basin.lower[1]:
            deep = f"reaches down to y = {y.min():g} m, and the basin is {basin.depth:g} m deep"
            yield (key,), f"the bed {deep}; y counts upwards from the still water"
            return
        if y.max() > HIGHEST_BED * basin.depth:
            high = f"rises to y = {y.max():g} m over water {basin.depth:g} m deep"
            yield (key,), f"the bed {high}, where no water comes: are its heights in metres? else cut it off"
            return
        ground = basin.shaped_bed
        if ground.y.min() >= 0.0:
            yield (key,), "the bed lies above the water everywhere; y counts upwards from the still water"
        if ground.y.max() <= ground.lowest:
            yield (key,), f"the bed is flat, at y = {ground.lowest:g} m, as it is without a {key}: leave {key} out"
        for axis, ends in (("x", ground.y[[0, -1]]), ("z", ground.y[:, [0, -1]].T)):
            if basin.periods["xyz".index(axis)] and np.ptp(ends, axis=0).max() > -LEVEL_ROUNDING * basin.lower[1]:
                yield (key,), f"{axis} is periodic, and the bed is not as high at one side as at the other"
        if basin.config.wavemaker is not None:
            wall = {"x_min": ground.y[0], "x_max": ground.y[-1], "z_min": ground.y[:, 0], "z_max": ground.y[:, -1]}
            if wall[basin.config.wavemaker.wall].max() > (1.0 - LEVEL_ROUNDING) * basin.lower[1]:
                made = f"its waves are those of water {basin.depth:g} m deep"
                yield (key,), f"before the wavemaker the bed must lie at y = {basin.lower[1]:g} m: {made}"
        if basin.closed:
            yield (key,), "a bed with a shape lies under a free surface: leave lid and a periodic y out"

    @property
    def rubs(self) -> bool:
        """True if the bed has friction."""
        return self.roughness is not None or self.friction_factor is not None

    @property
    def z0(self) -> float:
        """Height z0 [m] at which the logarithmic law has no speed; 0 if a friction factor is given instead."""
        return (self.roughness or 0.0) / GRAINS_PER_Z0

    def problems(self, row: float) -> Iterator[str]:
        """Yield faults of the bed's roughness; `row`: height [m] of the lowest horizontal row of particles."""
        if self.z0 >= MIN_ROW_SHARE * row:
            begin = f"the bed's z0 of {self.z0:.3g} m, a thirtieth of its roughness, is not below a quarter of the"
            yield f"{begin} lowest row of particles, {row:g} m high; take coarser particles or a friction_factor"

    def warnings(self, row: float) -> Iterator[str]:
        """Warn of a doubtful roughness; `row`: height [m] of the lowest horizontal row of particles."""
        if (self.roughness or 0.0) > 0.5 * row:
            opening = f"the bed's grains of {self.roughness:g} m reach above the middle of the lowest row of particles,"
            told = f"{0.5 * row:g} m, where the logarithmic law takes u;"
            yield f"{opening} {told} take coarser particles or a friction_factor"

    def statement(self, row: float) -> str:
        """Sentence for the user on the bed's friction; `row`: height [m] of the lowest horizontal row of particles."""
        height = 0.5 * row
        factor = f"friction factor of {2.0 * self.drag(height):.4g} (tau = rho f |u| u / 2)"
        if self.roughness is None:
            return f"the bed has a {factor}, u that of the lowest row of particles"
        opening = f"the bed is rough: roughness {self.roughness:g} m, z0 {self.z0:.3g} m;"
        told = f"u is that of the lowest row of particles, {height:g} m or {height / self.z0:.3g} z0 above it,"
        return f"{opening} {told} where the logarithmic law is a {factor}"

    def drag(self, height: float) -> float:
        """Drag coefficient tau / (rho |u| u) of the bed, u being the water's speed at a height [m] above the bed."""
        if self.friction_factor is not None:
            return 0.5 * self.friction_factor
        return (KARMAN_CONSTANT / log(height / self.z0)) ** 2


class Box(Model):
    """A box of water, or one that it flows around; in 2-D the points are [x, y]."""

    min: Point = quantity("m")
    """Lowest corner."""
    max: Point = quantity("m")
    """Highest corner."""

    def contradictions(self) -> Iterator[str]:
        if len(self.min) != len(self.max) or any(a >= b for a, b in zip(self.min, self.max, strict=True)):
            yield f"every number of max must be greater than that of min, got {self.min} and {self.max}"


class Obstacle(Model):
    """A body in the water, fixed unless it has a `motion`. One that is thinner than the support of the smoothing kernel
    lets the water on both sides feel each other through it."""

    slip: Slip = "free_slip"
    """`no_slip`: water that touches it moves with it; `free_slip`: it slides along."""
    motion: Gate | None = None
    """Motion of a gate, and when it has left; null: as `velocity` and `until` say."""
    velocity: Vector3 | None = quantity("m/s", None)
    """Its velocity from the beginning on; null: it is fixed, or moves as `motion` says."""
    until: float | None = quantity("s", None, gt=0.0)
    """Time at which it has left; null: it stays, or leaves as `motion` says."""

    def contradictions(self) -> Iterator[str]:
        yield from super().contradictions()
        if self.motion is not None and (self.velocity is not None or self.until is not None):
            yield "give either motion, or velocity [m/s] and until [s]"

    @cached_property
    def gate(self) -> Gate | None:
        """Motion of the obstacle until it leaves the basin; None if it is fixed."""
        if self.velocity is None and self.until is None:
            return self.motion
        return Gate(velocity=self.velocity or (0.0, 0.0, 0.0), end=self.until)


class BoxObstacle(Obstacle, Box):
    """A box in the water."""


class MeshObstacle(Obstacle):
    """A closed mesh of triangles in the water; in 2-D its section at z = 0."""

    mesh: FileName
    """File of the mesh: STL, OBJ or PLY."""
    unit: Literal["m", "cm", "mm", "ft", "in"] = "m"
    """Unit of the file: `m`, `cm`, `mm`, `ft` (0.3048 m) or `in` (0.0254 m)."""
    up: AxisName = "z"
    """The file's axis that points up; its x stays x where it can."""
    at: Point = quantity("m")
    """Place of the file's origin."""
    heading_deg: float = quantity("deg", 0.0)
    """Turn about the vertical through the file's origin, from z towards x."""

    @cached_property
    def shape(self) -> "PlacedMesh":
        """The mesh where it stands at time 0."""
        from ocean_sim.basin.solids.shape import PlacedMesh

        (x, y, *z), keys = self.at, self.model_dump(include={"unit", "up", "heading_deg"})
        return PlacedMesh(file=self.mesh, at=(x, y, sum(z)), is_section=not z, **keys)

    @cached_property
    def corners(self) -> np.ndarray:
        """(2, n) lowest and highest corner of the mesh [m], drawn in by MESH_ROUNDING of its size; n: 2 or 3 numbers,
        as the point `at` has, or 0 for a faulty mesh."""
        if self.shape.faults:
            return np.zeros((2, 0))
        ends = np.array(self.shape.bounds())[:, : len(self.at)]
        return ends + MESH_ROUNDING * np.ptp(ends, axis=0) * np.array([[1.0], [-1.0]])

    @property
    def min(self) -> tuple[float, ...]:
        return tuple(self.corners[0].tolist())

    @property
    def max(self) -> tuple[float, ...]:
        return tuple(self.corners[1].tolist())


def box_or_mesh(written: Any) -> str:
    """Pydantic tag of an obstacle, `MeshObstacle` or `BoxObstacle`; `written`: mapping of its keys, or the object."""
    is_mesh = "mesh" in written if isinstance(written, dict) else isinstance(written, MeshObstacle)
    return "MeshObstacle" if is_mesh else "BoxObstacle"


AnyObstacle = BoxObstacle | MeshObstacle
TaggedObstacle = Annotated[
    Annotated[BoxObstacle, Tag("BoxObstacle")] | Annotated[MeshObstacle, Tag("MeshObstacle")],
    Discriminator(box_or_mesh),
]


class Config(Model):
    """Size and sides of the basin; the origin is the centre of the still surface, y points up."""

    length: float = quantity("m", gt=0.0)
    """Length along x."""
    width: float | None = quantity("m", None, gt=0.0)
    """Width along z; null: 2-D, a vertical slice in x-y."""
    depth: float = quantity("m", gt=0.0)
    """Depth of the still water."""
    gravity: Vector3 = quantity("m/s2", (0.0, -GRAVITY, 0.0))
    """Acceleration of gravity."""
    walls: Annotated[Wall | Walls, AllSides] = "reflecting"
    """`reflecting` (free slip), `no_slip`, `periodic`, `absorbing` or `none`, for all sides or per side; walls rise
    without limit. Per side also {kind: absorbing, length: 2.0, rate: 3.0}."""
    floor: Literal["free_slip", "no_slip", "none"] | Floor = "free_slip"
    """The bed; `free_slip`: water slides along it, `no_slip`: it sticks to it, `none`: there is no bed; a mapping gives
    it a `profile` or a `grid` of heights, or friction between the first two by a `roughness` or a `friction_factor`."""
    lid: Lid | None = None
    """A lid on the still water; none: a free surface."""
    restitution: float = quantity("1", 0.0, ge=0.0, le=1.0)
    """Share of the normal speed that a particle keeps when it meets a wall or the floor."""
    friction: float = quantity("1", 0.0, ge=0.0)
    """Coulomb friction at walls and floor: tangential over normal impulse, at most."""

    obstacles: Annotated[tuple[TaggedObstacle, ...], Field(strict=False)] = ()
    """Boxes and meshes that the water flows around, fixed or moving as gates do."""
    motion: Motion | None = None
    """Motion of the whole tank: `harmonic`, or recorded in a `file`; measurements are made in the axes of the tank."""
    wavemaker: AnyWavemaker | None = None
    """A wall that makes waves."""

    def build(self, sea: OpenSea | None = None) -> "Basin":
        """Basin of these settings; `sea`: the open sea that the basin is a patch of, or None."""
        return Basin(self, sea=sea)

    def problems(self, basin: "Basin", duration: float) -> Faults:
        """Yield contradictions in these keys for a run of `duration` [s]: key path below `basin`, and sentence."""
        walls = basin.walls
        for axis in "xz" if basin.dimension == 3 else "x":
            if [walls.at(f"{axis}_min"), walls.at(f"{axis}_max")].count("periodic") == 1:
                yield ("walls",), f"{axis} is periodic on one side only; periodic sides come in pairs"
        if walls.y == "periodic":
            if self.lid is not None:
                yield ("lid",), "a basin that is periodic along y has no lid"
            if self.floor != "none":
                yield ("floor",), "a basin that is periodic along y has no floor; set floor: none"
        if self.lid is not None and self.lid.velocity[1] != 0.0:
            yield ("lid", "velocity"), "a lid slides in its own plane: its velocity along y must be 0"
        if basin.dimension == 2 and self.gravity[2] != 0.0:
            yield ("gravity",), "a slice, in x-y, has no gravity along z; y is up here: gravity: [0, -9.81, 0]"
        meshes = [(k, body) for k, body in enumerate(self.obstacles) if isinstance(body, MeshObstacle)]
        bad: list[Fault] = [(("obstacles", k, "mesh"), each) for k, body in meshes for each in body.shape.faults]
        misplaced = bad or list(box_faults("obstacles", self.obstacles, basin, "overlaps an earlier one"))
        yield from misplaced or path_faults(self.obstacles, basin, duration)
        if isinstance(self.floor, Floor) and self.floor.shaped:
            yield from below("floor", faults=self.floor.shape_problems(basin))
        for side in basin.sides:
            if side.absorbing is not None:
                size = basin.upper[side.axis] - basin.lower[side.axis]
                yield from below("walls", walls.key(side.name), faults=side.absorbing.problems(basin, size))
        if self.motion is not None:
            yield from below("motion", faults=self.motion.problems(basin))
        if (maker := self.wavemaker) is not None:
            pushed = list(maker.problems(basin, walls.at(maker.wall)))
            yield from below("wavemaker", faults=pushed)
            size = np.subtract(basin.upper, basin.lower)["xyz".index(maker.wall[0])]
            if not pushed and basin.piston is not None and (advance := basin.piston.path.advance) >= size:
                moves = f"the wall moves {advance:.4g} m into a basin that is {size:g} m long; paths are in metres"
                yield ("wavemaker",), moves


def odd_gravity(gravity: Vector3) -> Iterator[str]:
    """Warn of gravity [m/s2] that seems to follow another convention: z upwards, or another unit."""
    size, (x, y, z) = float(np.linalg.norm(gravity)), gravity
    if abs(y) < max(abs(x), abs(z)):
        yield f"gravity of {list(gravity)} m/s2 points more to a side than down; y is up here"
    power = log(size / GRAVITY, 10) if size > 0.0 else 0.0
    if round(power) != 0 and abs(power - round(power)) < SAME_DIGITS:
        yield f"gravity of {size:g} m/s2 has the digits of the Earth's, {GRAVITY:g} m/s2, in another unit"


def box_faults(key: str, boxes: Sequence[Box | MeshObstacle], basin: "Basin", overlap: str) -> Faults:
    """Yield faults of boxes, listed under the config key `key`, that leave the basin or overlap each other; `overlap`:
    words for an overlap in the sentence."""
    fitting = [k for k, box in enumerate(boxes) if len(box.min) == basin.dimension]
    low = np.array([boxes[k].min for k in fitting]).reshape(-1, basin.dimension)
    up = np.array([boxes[k].max for k in fitting]).reshape(-1, basin.dimension)
    room = np.subtract(basin.upper, basin.lower)[: basin.dimension]
    for row, k in enumerate(fitting):
        size = " x ".join(f"{side:.3g}" for side in up[row] - low[row])
        noun = "the box" if isinstance(boxes[k], Box) else f"the box around the mesh, {size} m,"
        if out := axes_beyond(boxes[k].min, boxes[k].max, basin):
            huge = "" if isinstance(boxes[k], Box) or (up[row] - low[row] <= room).all() else "; is its `unit` right?"
            yield (key, k), f"{noun} reaches out of the basin along {' and '.join(out)}{huge}"
        common = np.minimum(up[:row], up[row]) - np.maximum(low[:row], low[row])
        if (common.min(axis=1) > BOX_ROUNDING).any():
            yield (key, k), f"{noun} {overlap}"
    for k in set(range(len(boxes))) - set(fitting):
        yield (key, k), f"a point of this basin has {basin.dimension} numbers, got {len(boxes[k].min)}"


def axes_beyond(low: Sequence[float], up: Sequence[float], basin: "Basin") -> list[str]:
    """Names of axes along which a box from `low` to `up` [m] reaches out of the basin; an open one has no top."""
    return [
        axis
        for axis, a, b, least, most in zip("xyz", low, up, basin.lower, basin.upper)
        if a < least - BOX_ROUNDING or (b > most + BOX_ROUNDING and (axis != "y" or basin.closed))
    ]


def path_faults(obstacles: tuple[AnyObstacle, ...], basin: "Basin", duration: float) -> Faults:
    """Yield faults (key path, sentence) of the paths of moving obstacles in a run of `duration` [s]."""
    unread = set[int]()
    for k, box in enumerate(obstacles):
        gate, key = box.gate, ("obstacles", k, "motion") if box.motion else ("obstacles", k)
        leave = "`end`" if box.motion else "leave (`until`)"
        if gate is None:
            continue
        if gate.file is not None:
            try:
                gate.rows()
            except Unreadable as error:
                yield (*key, "file"), f"{error}"
                unread.add(k)
                continue
        for time in gate.moments(duration).tolist():
            moved = gate.at(time)
            assert moved is not None
            if basin.dimension == 2 and moved.velocity[2] != 0.0:
                yield key, "a 2-D basin, in x-y, has no motion along z"
                break
            low, up = (np.add(end, moved.way[: basin.dimension]) for end in (box.min, box.max))
            if out := axes_beyond(low.tolist(), up.tolist(), basin):
                where = f"it reaches out of the basin along {' and '.join(out)} at {time:.3g} s"
                yield key, f"{where}; let it {leave} before"
                break
        for j, other in enumerate(obstacles):
            if j == k or j in unread or (other.gate is not None and j > k):
                continue
            if (crossing := crossing_time(box, other, duration)) is not None:
                yield key, f"its path crosses obstacles.{j} at {crossing:.3g} s; let it {leave} before"


def crossing_time(box: AnyObstacle, other: AnyObstacle, duration: float) -> float | None:
    """First time [s] up to `duration` at which two obstacles overlap, interpolated between time samples; else None."""
    gates = [(sign, gate) for sign, gate in ((1.0, box.gate), (-1.0, other.gate)) if gate is not None]
    times = min((gate.moments(duration) for _, gate in gates), key=lambda moments: float(moments[-1]))
    ways = [[sign * moved.way for time in times.tolist() if (moved := gate.at(time))] for sign, gate in gates]
    way = np.sum(ways, axis=0)[:, : len(box.min)]
    least = np.subtract(other.min, box.max) + BOX_ROUNDING  # of the way from which on they overlap along each axis
    most = np.subtract(other.max, box.min) - BOX_ROUNDING
    step = np.where((step := np.diff(way, axis=0)) == 0.0, 1e-300, step)
    with np.errstate(over="ignore"):
        at = np.stack([(least - way[:-1]) / step, (most - way[:-1]) / step])
    enter = np.maximum(at.min(axis=0).max(axis=1), 0.0)  # share of a step
    meet = np.flatnonzero(enter < np.minimum(at.max(axis=0).min(axis=1), 1.0))
    return float(times[meet[0]] + enter[meet[0]] * (times[meet[0] + 1] - times[meet[0]])) if len(meet) else None


def box_corners(box: Box) -> Corners:
    """Lowest and highest corner of a box in 3-D [m]; the box of a 2-D scene extends without limit along z."""
    flat = 3 - len(box.min)
    return (*box.min, *flat * (-OPEN,)), (*box.max, *flat * (OPEN,))


class Solid(Protocol):
    """Interface of a solid body, such as a bed, a mesh or a ship, around which the initial water is built."""

    @property
    def is_sampled(self) -> bool:
        """True if boundary particles stand for the body in sums over the neighbours of a water particle."""

    @property
    def origin(self) -> np.ndarray:
        """(3,) position of the centre of mass [m]."""

    @property
    def extent(self) -> np.ndarray:
        """(2, 3) lowest and highest corner of the box around the body [m]."""

    def make_room(
        self, positions: np.ndarray, beyond: np.ndarray, boxes: "Boxes", lattice: "packing.Lattice"
    ) -> tuple[np.ndarray, np.ndarray]:
        """Make room for the body among particles at `positions` (n, 3) [m], which fill `boxes` (lower and upper
        corners). Points `beyond` (m, 3) [m] continue their `lattice` outside and fill the space there, lest particles
        be pushed into it. Returns (n,) True for particles to remove, and (n, 3) new positions [m] of all."""

    def samples(self, spacing: float, support: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Boundary particles inside the body near its surface: (n, 3) positions from the centre of mass, body axes [m],
        (n,) volumes [m3] (2-D: areas [m2]), and (n, 3) outward normals. `spacing`, `support` of the kernel [m]."""


@dataclass(frozen=True)
class Side:
    """A flat side of the basin (wall, bed or lid) at which the water is mirrored."""

    axis: int
    upper: bool
    position: float  # [m] along the axis
    slip: Slip
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)  # [m/s]
    absorbing: Absorbing | None = None  # how the water in front of it is relaxed
    piston: Piston | None = None  # how it moves along its axis

    @property
    def name(self) -> str:
        """Name of a wall, such as `x_min`; of the bed `y_min`, of a lid `y_max`."""
        return f"{'xyz'[self.axis]}_{'max' if self.upper else 'min'}"


def shifts(x: np.ndarray, origin: np.ndarray, period: Sequence[float]) -> np.ndarray:
    """(n, 3) shifts by whole periods [m] that bring points x (n, 3) [m] nearest to `origin`, (2,) x and z [m]."""
    return whole_sides(np.insert(origin, 1, 0.0) - x, np.array([period[0], 0.0, period[2]]))


def whole_sides(away: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """Whole multiples of periods `sides` (n,) [m] nearest to distances `away` (..., n) [m]; 0 for a period of 0."""
    return sides * np.round(away / np.where(sides > 0.0, sides, np.inf))


@dataclass(frozen=True)
class Basin:
    """Geometry of a basin, from its config: corners, sides, obstacles, and wavemaker."""

    config: Config
    afloat: Mapping[str, Solid] = field(default_factory=dict)  # what floats in it, by name
    sea: OpenSea | None = None  # that it is a patch of

    @property
    def dimension(self) -> int:
        """2 for a vertical slice in x-y, else 3."""
        return 2 if self.config.width is None else 3

    @property
    def depth(self) -> float:
        """Depth of the still water [m]."""
        return self.config.depth

    @property
    def gravity(self) -> tuple[float, float, float]:
        """Acceleration of gravity along x, y and z [m/s2]."""
        return self.config.gravity

    @cached_property
    def walls(self) -> Walls:
        """Kind of wall on each side, filled in where the scene gives one kind for all sides."""
        walls = self.config.walls
        return walls if isinstance(walls, Walls) else Walls(x=walls, z=walls)

    @property
    def lower(self) -> tuple[float, float, float]:
        """Lowest corner [m]: the bed; z is 0 in 2-D."""
        return (-self.config.length / 2, -self.config.depth, -(self.config.width or 0.0) / 2)

    @property
    def upper(self) -> tuple[float, float, float]:
        """Highest corner [m]: y is 0 in a closed basin, else the depth, though water may rise higher."""
        top = 0.0 if self.closed else self.config.depth
        return (self.config.length / 2, top, (self.config.width or 0.0) / 2)

    @property
    def closed(self) -> bool:
        """True if the basin has no free surface: it has a lid or is periodic along y."""
        return self.config.lid is not None or self.walls.y == "periodic"

    @property
    def volume(self) -> float:
        """Volume of the still water [m3]; in 2-D its area [m2]."""
        return self.config.length * self.config.depth * (self.config.width or 1.0)

    @cached_property
    def periods(self) -> tuple[float, float, float]:
        """Period of the basin along each axis [m]; 0 along an axis that is not periodic."""
        kinds = self.walls.at("x_min"), self.walls.y, self.walls.at("z_min") if self.dimension == 3 else None
        ends = zip(self.lower, self.upper, kinds)
        return tuple(up - low if kind == "periodic" else 0.0 for low, up, kind in ends)  # type: ignore[return-value]

    def has_potential(self, steady_force: Sequence[float]) -> bool:
        """True if work of gravity is always a change of potential energy: no `steady_force` (3,) [m/s2], no motion of
        the tank, and no component of gravity along a periodic axis."""
        periodic = any(period > 0.0 and g != 0.0 for period, g in zip(self.periods, self.gravity, strict=True))
        return not (periodic or any(steady_force) or self.config.motion is not None)

    @cached_property
    def sides(self) -> tuple[Side, ...]:
        """Walls, bed and lid at which the water is mirrored; open and periodic sides are left out."""
        found = []
        for axis in (0, 2) if self.dimension == 3 else (0,):
            for upper, name in ((False, f"{'xyz'[axis]}_min"), (True, f"{'xyz'[axis]}_max")):
                kind = self.walls.at(name)
                if kind in ("reflecting", "no_slip", "absorbing"):
                    position = (self.upper if upper else self.lower)[axis]
                    slip: Slip = "no_slip" if kind == "no_slip" else "free_slip"
                    piston = self.piston if self.config.wavemaker and self.config.wavemaker.wall == name else None
                    found.append(Side(axis, upper, position, slip, absorbing=self.walls.absorbing(name), piston=piston))
        if self.config.floor != "none":
            floor = self.config.floor
            held = floor == "no_slip" or (isinstance(floor, Floor) and floor.slip == "no_slip")
            found.append(Side(1, False, self.lower[1], "no_slip" if held else "free_slip"))
        if self.config.lid is not None:
            found.append(Side(1, True, 0.0, self.config.lid.slip, self.config.lid.velocity))
        return tuple(found)

    @property
    def rough_bed(self) -> Floor | None:
        """Friction settings of the bed; None if it has no friction."""
        floor = self.config.floor
        return floor if isinstance(floor, Floor) and floor.rubs else None

    @cached_property
    def ground(self) -> "Ground | None":
        """Bed with a shape of its own above the flat bottom; None if the bed is flat or its shape is faulty."""
        floor = self.config.floor
        sound = isinstance(floor, Floor) and floor.shaped and not any(floor.shape_problems(self))
        return self.shaped_bed if sound else None

    @property
    def plan_sides(self) -> list[tuple[float, float]]:
        """Lowest and highest coordinate [m] of the basin along x, and along z."""
        return [(low, up) for low, up in zip(self.lower[::2], self.upper[::2])]

    @cached_property
    def shaped_bed(self) -> "Ground":
        """Bed with the shape that `floor` gives, not checked, cut at the sides of the basin; raises Unreadable."""
        from ocean_sim.basin.ground import Ground

        floor = self.config.floor
        assert isinstance(floor, Floor)
        periodic = self.periods[0] > 0.0, self.periods[2] > 0.0
        sides, traits = self.plan_sides, (periodic, floor.slip == "no_slip")
        return Ground.within(sides, floor.bed_heights.around(sides), self.lower[1], self.dimension, *traits)

    @property
    def solids(self) -> list[Solid]:
        """Bed, meshes and floating bodies around which the initial water is built."""
        return [*([] if self.ground is None else [self.ground]), *self.meshes.values(), *self.afloat.values()]

    @cached_property
    def boxes(self) -> list[BoxObstacle]:
        """Obstacles that are boxes, with as many coordinates as the basin has dimensions."""
        whole = [box for box in self.config.obstacles if isinstance(box, BoxObstacle)]
        return [box for box in whole if len(box.min) == self.dimension]

    @cached_property
    def meshes(self) -> "dict[int, MeshSolid]":
        """Obstacles that are meshes, by their index among all obstacles."""
        found = {}
        for k, body in enumerate(self.config.obstacles):
            if isinstance(body, MeshObstacle) and len(body.min) == self.dimension:
                from ocean_sim.basin.solids.room import MeshSolid

                middle = 0.5 * np.add(*body.shape.bounds())
                found[k] = MeshSolid(body.shape, middle, middle, np.eye(3), self.dimension == 2, gate=body.gate)
        return found

    def meshes_at(self, time: float) -> "list[tuple[MeshSolid, np.ndarray]]":
        """Each mesh in the water at a time [s], and its displacement (3,) from its place at time 0 [m]."""
        moved = [(mesh, NOT_MOVED if mesh.gate is None else mesh.gate.at(time)) for mesh in self.meshes.values()]
        return [(mesh, now.way) for mesh, now in moved if now is not None]

    def mesh_triangles(self, time: float, moving: bool) -> np.ndarray:
        """Triangles (m, 3, 3) [m] of the fixed meshes in the water, or of the moving ones at a time [s]."""
        found = [mesh.mesh.triangles + way for mesh, way in self.meshes_at(time) if (mesh.gate is not None) == moving]
        return np.concatenate([np.zeros((0, 3, 3)), *found])

    @cached_property
    def obstacles(self) -> list[Corners]:
        """Lowest and highest corner of each box in the water at time 0 [m]; in 2-D without limit along z."""
        return [box_corners(box) for box in self.boxes]

    @cached_property
    def fixed(self) -> list[Corners]:
        """Lowest and highest corner [m] of each box in the water that never moves."""
        return [box_corners(box) for box in self.boxes if box.gate is None]

    def obstacles_at(self, time: float) -> list[Corners]:
        """Lowest and highest corner [m] of each box in the water at a time [s]."""
        return self.fixed + self.gates_at(time)

    def gates_at(self, time: float) -> list[Corners]:
        """Lowest and highest corner [m] of each box that moves or is taken out, if it is present at a time [s]."""
        found = []
        for box in self.boxes:
            moved = box.gate.at(time) if box.gate is not None else None
            if moved is not None:
                low, up = np.array(box_corners(box)) + moved.way
                found.append((tuple(low.tolist()), tuple(up.tolist())))
        return found

    @property
    def gates(self) -> list[tuple[int, Gate]]:
        """Index and motion of each obstacle that moves, or is taken out, during the run."""
        return [(k, box.gate) for k, box in enumerate(self.config.obstacles) if box.gate is not None]

    @cached_property
    def piston(self) -> Piston | None:
        """Motion of the wavemaker; None if the basin has none."""
        maker = self.config.wavemaker
        return Piston(maker, self.depth, -self.gravity[1]) if maker is not None else None

    @cached_property
    def tank_wave(self) -> waves.Components | None:
        """Wave 1 m high with the mean frequency of the tank's motion; None if the tank does not move."""
        motion = self.config.motion
        if motion is None or (omega := motion.mean_frequency) == 0.0:
            return None
        along, g = np.array([1.0, 0.0]), waves.downward_gravity(self)
        return waves.regular_wave(1.0, 2.0 * np.pi / omega, along, self.depth, g)

    def stops(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Lowest and highest x, y, z [m] that walls, bed, lid and moving piston allow the water; +-OPEN if no limit."""
        low, up = [-OPEN] * 3, [OPEN] * 3
        for side in self.sides:
            away = side.piston.path.retreat if side.piston is not None else 0.0
            (up if side.upper else low)[side.axis] = side.position + (away if side.upper else -away)
        return tuple(low), tuple(up)  # type: ignore[return-value]
