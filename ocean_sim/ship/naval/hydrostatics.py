"""A hull in still water: its draught, stability, natural periods without added mass, and its squat under way.

By its cubes: a cube is wet by the height of the water over its lower side. A turned cube has the same variance of
heights, so a linear ramp serves it too (variance side^2 / 12 in any direction).

By its faces, without cubes, metacentric heights are KB + I / V - KG, by integrals over its wet faces. Over a closed
surface the integral of f(x, z) n_y is 0, so over the waterplane, where n_y = 1, it is that over the wet faces with the
other sign; with heights from the waterplane, volume and its moment are the integrals of y n_y and y^2 n_y / 2 (Gauss).
"""

from dataclasses import dataclass
from functools import cached_property, partial
from math import inf, pi, radians, sin, sqrt
from typing import NamedTuple

import numpy as np

from ocean_sim.basin.solids.mesh import ClosedMesh, gauss_points, inside_stretches, lone_corner_first
from ocean_sim.basin.solids.shape import SolidShape
from ocean_sim.basin.solids.voxels import Voxels
from ocean_sim.conventions import GRAVITY, Motions
from ocean_sim.ship.body.rigid_body import axis_rotation
from ocean_sim.ship.hull.shapes import drawn_mesh

UPRIGHT = np.array([0.0, 1.0, 0.0])
SMALL_TURN = 0.5  # [deg] heel and trim at which metacentric heights are taken
LEVER_HEELS = (5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0)  # [deg]
VOLUME_ROUNDING = 1.0e-11  # of a hull's volume: many times what the order of a sum over its cubes changes
LEVEL_ROUNDING = 1e-13  # of a hull's height
BLUNT_AREA = 0.1  # of the greatest area, of a slice at an end
BOW_SINKAGE = 2.4  # for merchant ships in open shallow water (ICORELS 1980)


@dataclass(frozen=True)
class Matter:
    """Mass, centre of mass and inertia of the floating body."""

    mass: float  # [kg]
    centre: np.ndarray  # (3,) from the hull's origin [m]
    inertia: np.ndarray  # (3, 3) about the centre, hull axes [kg m2]


@dataclass(frozen=True, eq=False)
class Hydrostatics:
    """Draught, stability and periods of a hull of given mass and centre of mass in still water."""

    voxels: Voxels
    matter: Matter
    density: float  # of the water [kg/m3]
    gravity: float  # [m/s2]
    free_surface_loss: tuple[float, float] = (0.0, 0.0)  # of metacentric heights across and along, by liquids [m]
    shape: SolidShape | None = None  # that the cubes fill

    @property
    def needed_volume(self) -> float:
        """Volume of water that weighs as much as the ship [m3]."""
        return self.matter.mass / self.density

    def wet_volumes(self, up: np.ndarray, level: float) -> np.ndarray:
        """(n,) volume [m3] of each cube below a water level [m] along `up`, a unit vector in the hull's axes."""
        return self.cube_volumes * np.clip(self.wet_shares(up, level), 0.0, 1.0)

    def wet_shares(self, up: np.ndarray, level: float) -> np.ndarray:
        """(n,) share of each cube's height below a level [m] along `up`; below 0 or above 1 for cubes not cut."""
        return (level - self.voxels.centre_heights(up)) / self.voxels.height_spread(up) + 0.5

    @cached_property
    def cube_volumes(self) -> np.ndarray:
        """(n,) volume of each cube inside the hull [m3]."""
        return self.voxels.size.prod() * self.voxels.share

    def water_level(self, up: np.ndarray) -> float:
        """Water level [m] over the origin along unit vector `up`, at which the hull floats; infinite if it sinks."""
        if self.needed_volume >= self.voxels.volume:
            return inf
        height, spread = self.voxels.centre_heights(up), self.voxels.height_spread(up)
        low, high = float(height.min()) - spread, float(height.max()) + spread
        # Bisect over the cubes that the surface may cut; `sunk` is the volume of those under it.
        near, whole, sunk = height, self.cube_volumes, 0.0
        for _ in range(40):
            middle = 0.5 * (low + high)
            volume = sunk + volume_under(middle, near, spread, whole)
            if abs(volume - self.needed_volume) < VOLUME_ROUNDING * self.voxels.volume:  # the order of a sum may decide
                volume = volume_under(middle, height, spread, self.cube_volumes)
            low, high = (middle, high) if volume < self.needed_volume else (low, middle)
            if high - low > 0.25 * spread:
                under = near <= low - 0.5 * spread
                cut = (near < high + 0.5 * spread) & ~under
                near, whole, sunk = near[cut], whole[cut], sunk + float(whole[under].sum())
        return 0.5 * (low + high)

    @cached_property
    def draught(self) -> float:
        """Draught of the upright hull [m]; infinite if it sinks."""
        return self.water_level(UPRIGHT) - self.keel

    @cached_property
    def keel(self) -> float:
        """Height [m] over the hull's origin of the underside of the cubes; 0 where the origin is at the keel."""
        return float(self.voxels.lower[1])

    def centre_of_buoyancy(self, turn: np.ndarray | None = None) -> np.ndarray:
        """(3,) centre of buoyancy from the origin [m], world axes; `turn`: rotation of the hull, by default upright."""
        turn = np.eye(3) if turn is None else turn
        share = self.wet_shares(turn[1], self.water_level(turn[1]))
        volume = self.cube_volumes * np.clip(share, 0.0, 1.0)
        dx, dz = self.voxels.cut_offset(turn.tolist(), float(self.cube_volumes[(share > 0.0) & (share < 1.0)].sum()))
        return (turn @ (volume[:, None] * self.voxels.centre).sum(axis=0) + [dx, 0.0, dz]) / volume.sum()

    def buoyancy_offset(self, turn: np.ndarray) -> np.ndarray:
        """(2,) offset [m], to port and ahead, of the centre of buoyancy from that of mass at a rotation `turn` (3, 3),
        hull to world; free surfaces of liquids on board shift the centre of mass."""
        between = self.centre_of_buoyancy(turn) - turn @ self.matter.centre
        return between[[0, 2]] + self.free_surface_loss * turn[1, [0, 2]]

    def righting_lever(self, axis: int, degrees: float) -> float:
        """Righting lever [m] of a floating hull turned by `degrees` about z (`axis` 2: GZ) or x (0: in trim)."""
        to_port, ahead = self.buoyancy_offset(axis_rotation(axis, radians(degrees))).tolist()
        return -to_port if axis == 2 else ahead

    def gz(self, degrees: float) -> float:
        """Righting lever GZ [m] at a heel of `degrees`, starboard down where positive."""
        return self.righting_lever(2, degrees)

    @cached_property
    def kb(self) -> float:
        """Height of the centre of buoyancy over the keel [m]."""
        return float(self.centre_of_buoyancy()[1]) - self.keel

    def metacentric_height(self, axis: int = 2) -> float:
        """Metacentric height GM [m] in heel (`axis` 2) or trim (0), from righting levers at a small angle both ways."""
        rise = self.righting_lever(axis, SMALL_TURN) - self.righting_lever(axis, -SMALL_TURN)
        return rise / (2.0 * sin(radians(SMALL_TURN)))

    @cached_property
    def gm_of_faces(self) -> float | None:
        """GM [m] in heel from faces of the shape, which cubes only approach; None without these, or if she sinks."""
        heights = None if self.shape is None else metacentric_heights(self.shape, self)
        return None if heights is None else heights[0]

    @cached_property
    def waterplane(self) -> float:
        """Area of the waterplane of the upright hull [m2]."""
        level, step = self.draught + self.keel, 0.25 * self.voxels.size[1]
        above, below = (self.wet_volumes(UPRIGHT, level + away).sum() for away in (step, -step))
        return float(above - below) / (2.0 * step)

    @cached_property
    def stiffness(self) -> dict[str, float]:
        """Stiffness by name: heave [N/m], roll and pitch [N m/rad]."""
        weight = self.matter.mass * self.gravity
        gm, trim = self.metacentric_height(2), self.metacentric_height(0)
        return {"heave": self.density * self.gravity * self.waterplane, "roll": weight * gm, "pitch": weight * trim}

    @property
    def inertia(self) -> dict[str, float]:
        """Inertia of the hull alone, without added mass, by name: heave [kg], roll and pitch [kg m2]."""
        m = self.matter
        return {"heave": m.mass, "roll": float(m.inertia[2, 2]), "pitch": float(m.inertia[0, 0])}

    def periods(self, added: np.ndarray) -> dict[str, float | None]:
        """Natural periods of heave, roll and pitch [s] with (6,) added mass; None without restoring force."""
        found, water = {}, Motions(*added.tolist())._asdict()
        for motion, k in self.stiffness.items():
            inertia = self.inertia[motion] + water[motion]
            found[motion] = 2.0 * pi * sqrt(inertia / k) if k > 0.0 else None
        return found

    @cached_property
    def waterline_volumes(self) -> np.ndarray:
        """(n,) part [m3] of each cube's volume that lies within a quarter of a cube's height of the still water."""
        step = 0.25 * self.voxels.size[1]
        return self.wet_volumes(UPRIGHT, self.waterline + step) - self.wet_volumes(UPRIGHT, self.waterline - step)

    @cached_property
    def stations(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position along z, breadth at the still water, draught (m,) [m] of m slices of the hull, each a cube long."""
        v, level = self.voxels, self.waterline
        _, tall, long = v.size
        number, n = self.cube_slices
        lowest = np.full(n, level)
        np.minimum.at(lowest, number, self.keel + tall * v.cells[:, 1])
        along = v.lower[2] + long * (np.arange(n) + 0.5)
        return along, np.bincount(number, self.waterline_volumes, n) / (0.5 * tall * long), level - lowest

    @cached_property
    def waterline_ends(self) -> tuple[float, float]:
        """Positions along z [m] of stern and bow at the still water. Each lies in the outermost slice, beyond its inner
        side by twice the distance of the centroid of the wet part for a transom, by three times for a wedge."""
        along, breadth, _ = self.stations
        number, _ = self.cube_slices
        long = float(self.voxels.size[2])

        def waterline_end(k: int, way: int) -> float:
            """Position along z [m] of the waterline's end in slice k; `way`: 1 bow, -1 stern."""
            inner, there = float(along[k]) - 0.5 * way * long, number == k
            middle = np.average(self.voxels.centre[there, 2], weights=self.waterline_volumes[there])
            reach = 2.0 * abs(float(middle) - inner)
            bluntness = float(breadth[k] * long / (reach * max(breadth[k - way], breadth[k])))  # a wedge's is 3/4
            return inner + way * reach * min(max(3.0 - 2.0 * bluntness, 1.0), 1.5)

        wet = np.flatnonzero(breadth > 0.0)
        return waterline_end(wet[0], -1), waterline_end(wet[-1], 1)

    @property
    def length(self) -> float:
        """Length of the waterline [m]."""
        stern, bow = self.waterline_ends
        return bow - stern

    @cached_property
    def section_areas(self) -> np.ndarray:
        """(m,) cross-section under the still water [m2] of each of m slices of the hull, each a cube long."""
        number, n = self.cube_slices
        return np.bincount(number, self.wet_volumes(UPRIGHT, self.waterline), n) / self.voxels.size[2]

    @property
    def waterline(self) -> float:
        """Height of the still water above the hull's origin [m]; for a ship that sinks, height of her deck."""
        return min(self.draught + self.keel, float(self.voxels.centre[:, 1].max()))

    @cached_property
    def cube_slices(self) -> tuple[np.ndarray, int]:
        """(n,) number of the slice, counted along z, to which each cube belongs, and the number of slices."""
        number = self.voxels.cells[:, 2]
        return number, int(number.max()) + 1


def volume_under(level: float, height: np.ndarray, spread: float, whole: np.ndarray) -> float:
    """Volume [m3] below a level [m] of cubes: n centres at `height` [m], `spread` [m] high, volumes `whole` [m3]."""
    return float((whole * np.clip((level - height) / spread + 0.5, 0.0, 1.0)).sum())


class Wet(NamedTuple):
    """Volume, centre and waterplane of the part of a hull below a water level, from integrals over its faces."""

    volume: float  # [m3]
    below: float  # moment of the volume about the level, negative [m4]
    area: float  # of the waterplane [m2]
    first: np.ndarray  # (2,) its moments along x and z [m3]
    second: np.ndarray  # (2,) the same, second [m4]


def metacentric_heights(shape: SolidShape, still: Hydrostatics) -> tuple[float, float] | None:
    """GM across and along [m] of a hull upright in still water; None if its faces only approximate it, or it sinks."""
    from scipy.optimize import brentq

    if shape.rounded:
        return None
    vertices, triangles = drawn_mesh(shape)
    faces, mesh = vertices[triangles], shape.closed_mesh()
    wet_under = partial(wet_part, faces) if mesh is None or not mesh.has_overlaps else partial(columns_under, mesh)
    low, high = float(faces[..., 1].min()), float(faces[..., 1].max())
    if still.needed_volume >= wet_under(high).volume:
        return None
    rounding = LEVEL_ROUNDING * (high - low)
    level = float(brentq(lambda y: wet_under(y).volume - still.needed_volume, low, high, xtol=rounding))
    wet = wet_under(level)
    about_middle = wet.second - wet.first**2 / wet.area
    km = level + (wet.below + about_middle) / wet.volume
    across, along = km - still.matter.centre[1] - np.array(still.free_surface_loss)
    return float(across), float(along)


def wet_part(faces: np.ndarray, level: float) -> Wet:
    """Wet part of a closed surface of outward faces (n, 3, 3) [m], under a level [m]."""
    cut = faces_below(faces - [0.0, level, 0.0])
    upwards = 0.5 * np.cross(cut[:, 1] - cut[:, 0], cut[:, 2] - cut[:, 0])[:, 1]  # area times n_y [m2]
    x, y, z = np.moveaxis(0.5 * (cut + np.roll(cut, -1, axis=1)), 2, 0)  # middles of the edges: exact to second order

    def face_integral(values: np.ndarray) -> float:
        """Integral over the wet faces, weighted by n_y, of `values` (m, 3) at the middles of their edges."""
        return float(upwards @ values.mean(axis=1))

    plane = [np.ones_like(x), x, z, x * x, z * z]
    area, *moments = (-face_integral(values) for values in plane)
    return Wet(face_integral(y), 0.5 * face_integral(y * y), area, np.array(moments[:2]), np.array(moments[2:]))


def columns_under(mesh: ClosedMesh, level: float) -> Wet:
    """Wet part, under a level [m], of a mesh whose faces intersect: volume by columns, waterplane by lines across."""
    volume, below = (mesh.column_integral(lambda y: np.minimum(y - level, 0.0) ** n / n) for n in (1, 2))
    positions, along = gauss_points(mesh.vertices[:, 2])
    line, port, starboard = inside_stretches(mesh.triangles[..., [2, 0, 1]], positions, np.array([level]))
    z, dz = positions[line], along[line]
    area, first, second = (dz * (starboard**n - port**n) / n for n in (1, 2, 3))
    moments = np.array([first.sum(), z @ area]), np.array([second.sum(), z**2 @ area])
    return Wet(volume, below, float(area.sum()), *moments)


def faces_below(faces: np.ndarray) -> np.ndarray:
    """Triangles (m, 3, 3) over which an integral equals that over the part of `faces` (n, 3, 3) below y = 0; reversed
    triangles subtract the tips above."""
    over = faces[..., 1] > 0.0
    number = np.count_nonzero(over, axis=1)
    cut = number % 3 > 0
    a, b, c, above = lone_corner_first(faces[cut], over[cut])
    ab, ac = (a + (a[:, 1] / (a[:, 1] - end[:, 1]))[:, None] * (end - a) for end in (b, c))
    tips = np.where(above[:, None, None], np.stack([a, ac, ab], axis=1), np.stack([a, ab, ac], axis=1))
    return np.concatenate([faces[number <= 1], tips])


def bow_squat(volume: float, length: float, speed: float, depth: float) -> float:
    """Bow sinkage [m] of a ship of a volume under water [m3] and length [m] at a speed [m/s] and depth [m]: 2.4 V / L^2
    F^2 / sqrt(1 - F^2), F^2 = U^2 / (g h) (Tuck 1966, J. Fluid Mech. 26; ICORELS 1980); infinite from F = 1 on."""
    return BOW_SINKAGE * volume / length**2 * squat_factor(speed, depth)


def squat_factor(speed: float, depth: float) -> float:
    """Squat factor F^2 / sqrt(1 - F^2) at a speed [m/s] and a depth [m], F^2 = U^2 / (g h); infinite from F = 1 on."""
    froude_2 = speed**2 / (GRAVITY * depth)
    return froude_2 / sqrt(1.0 - froude_2) if froude_2 < 1.0 else inf


class Slender(NamedTuple):
    """Squat of a slender hull (Tuck 1966): sinkage and trim divided by `squat_factor`, or, from `at_speed`, whole."""

    sinkage: float  # of the centre of her waterplane [m]
    trim: float  # bow down [rad]
    levers: tuple[float, float]  # from there to the stern and to the bow [m]
    blunt: bool = False  # whether she ends in more than a tenth of her greatest area, which the theory does not allow

    @property
    def end_sinkage(self) -> float:
        """Sinkage of the lower end of the ship, bow or stern [m]."""
        return self.sinkage + self.trim * (self.levers[1] if self.trim > 0.0 else -self.levers[0])

    def at_speed(self, speed: float, depth: float) -> "Slender":
        """Squat at a speed U [m/s] over a bed at a depth h [m]; infinite from U = sqrt(g h) on."""
        factor = squat_factor(speed, depth)
        return self._replace(sinkage=factor * self.sinkage, trim=factor * self.trim)


def slender_squat(hull: Hydrostatics) -> Slender:
    """Squat of a hull by its breadth B and wet section area S along its length (Tuck 1966, J. Fluid Mech. 26, 81). The
    flow past S pulls the waterplane down by rho g F^2 / (2 pi sqrt(1 - F^2)) times the double integral of B'(x) S'(y)
    log|x - y|; for the trimming moment B is multiplied by its lever."""
    along, breadth, _ = hull.stations
    half = 0.5 * hull.voxels.size[2]
    wet = np.flatnonzero(breadth > 0.0)
    inside = slice(wet[0], wet[-1] + 1)
    x = np.concatenate([[along[inside][0] - half], along[inside], [along[inside][-1] + half]])
    b, s = (np.pad(values[inside], 1) for values in (breadth, hull.section_areas))
    centre = float((along * breadth).sum() / breadth.sum())
    apart = np.abs(x[:, None] - x)
    kernel = 0.5 * apart**2 * np.log(np.where(apart > 0.0, apart, 1.0)) - 0.75 * apart**2  # log, integrated twice

    def slope_changes(values: np.ndarray) -> np.ndarray:
        """Change of slope (m,) at each station x of the polyline through `values` (m,), level beyond the ends."""
        return np.diff(np.diff(values) / np.diff(x), prepend=0.0, append=0.0)

    def pull_integral(values: np.ndarray) -> float:
        """Upward force [N] of the flow past the hull (`slender_squat`), over F^2 / sqrt(1 - F^2), on a waterplane with
        breadths `values` (m,) [m] at her stations x; its moment [N m] if these are multiplied by levers."""
        return -float(slope_changes(values) @ kernel @ slope_changes(s)) * hull.density * hull.gravity / (2.0 * pi)

    stiff = hull.stiffness
    blunt = bool(max(s[1], s[-2]) > BLUNT_AREA * s.max())
    levers = (centre - float(x[0]), float(x[-1]) - centre)
    return Slender(-pull_integral(b) / stiff["heave"], -pull_integral((x - centre) * b) / stiff["pitch"], levers, blunt)
