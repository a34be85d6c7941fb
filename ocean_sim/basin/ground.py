"""A bed of any shape: heights over the plan of a basin, as a fixed solid body that is represented by sample points.

Heights are bilinear between grid nodes. Sample points stand in columns, at equal distances along the bed and into it,
down to the flat bottom of the basin, which mirrors the water.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np

from ocean_sim.basin.solids.packing import FIT_REACH, Lattice, cached_room, deepest_first, fit_particles
from ocean_sim.files.bathymetry import Heights

Boxes = Sequence[tuple[np.ndarray, np.ndarray]]  # lower and upper corner of each [m]
LAYERS_A_SPACING = 2  # of samples: a single one drives still water up a slope of 1:20 at 0.01 sqrt(g h)
DRY_WARNED = 0.5  # share of a bed's plan that is dry, of which `check` warns
WAVE_ROWS = 8.0  # [spacings] of depth that waves need
SLICE_HALF = 1.0  # [m] half the width of the bed in a slice
FIT_ITERATIONS = 40  # at which still water is as calm as at 100
COLUMNS_A_SPACING = 4  # columns to a spacing by which the volume of the bed is summed
BASE_SHARE = 0.012  # thickness of what is drawn under the flat bed, over the height of the bed above it
WET_DEPTH_SHARE = 1e-5  # of the height of the bed: least depth of water on it
TOUCH_DISTANCE = 1.25  # [spacings] from the bed within which a particle touches it
RUNUP_GAP = 3.0  # [spacings] from the bed and between particles there, at which the water that runs up ends
DEEP_LAYERS = 2.5  # [spacings] of water, from which on its height is right within a tenth of one
FILM_REACH = 1.5  # [spacings] in plan from a particle that touches the bed to where the bed looks dry
FILM_TAPER = 0.2  # slope at which a film of water ends there
SUNK_LAYERS = 0.5  # [spacings] below a dry bed, at which a sheet of water goes on unseen


@dataclass(frozen=True, eq=False)
class Ground:
    """Bed with heights `y` (n, m) [m] at grid nodes `x` (n,) and `z` (m,) [m] that reach from side to side."""

    x: np.ndarray
    z: np.ndarray
    y: np.ndarray
    lowest: float  # height [m] of the flat bed under it
    dimension: int
    periodic: tuple[bool, bool]  # along x and z
    no_slip: bool
    is_sampled: bool = True

    @classmethod
    def within(
        cls, sides: Sequence[tuple[float, float]], given: Heights, lowest: float, dimension: int, *traits: Any
    ) -> "Ground":
        """Bed with the heights `given`, cut at the `sides` (lowest and highest coordinate [m] along x, and along z) and
        at the height `lowest` [m] of the flat bottom, in 2-D or 3-D (`dimension`); `traits`: `periodic`, `no_slip`."""
        spans = [sides[0], sides[1] if dimension == 3 else (-SLICE_HALF, SLICE_HALF)]
        x, z = (np.unique(np.clip([low, *nodes, up], low, up)) for (low, up), nodes in zip(spans, (given.x, given.z)))
        whole = cls(given.x, given.z, given.y, lowest, 3, (False, False), False)
        places = np.stack(np.meshgrid(x, z, indexing="ij"), axis=-1).reshape(-1, 2)
        heights = np.maximum(whole.heights(places), lowest).reshape(len(x), len(z))
        return cls(x, z, heights, lowest, dimension, *traits)

    @property
    def origin(self) -> np.ndarray:
        return np.zeros(3)

    @property
    def extent(self) -> np.ndarray:
        return np.array([[self.x[0], self.lowest, self.z[0]], [self.x[-1], self.y.max(), self.z[-1]]])

    @property
    def foot(self) -> float:
        """Height [m] of the bottom of the bed in pictures, a little below the flat bottom."""
        return float(self.lowest - BASE_SHARE * (self.y.max() - self.lowest))

    def shape_at(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Heights (n,) [m] and slopes (n, 2) along x and z of the bed at places x, z (n, 2) [m], also beyond sides."""
        (i, a, run, x_way), (j, b, rise, z_way) = (
            cells_and_shares(places[:, axis], nodes, periodic)
            for axis, (nodes, periodic) in enumerate(zip((self.x, self.z), self.periodic))
        )
        low, high = self.y[i, j] * (1 - b) + self.y[i, j + 1] * b, self.y[i + 1, j] * (1 - b) + self.y[i + 1, j + 1] * b
        left, right = (self.y[i, k] * (1 - a) + self.y[i + 1, k] * a for k in (j, j + 1))
        slopes = np.stack([x_way * (high - low) / run, z_way * (right - left) / rise], axis=1)
        return low * (1 - a) + high * a, slopes

    def heights(self, places: np.ndarray) -> np.ndarray:
        """Heights (n,) [m] of the bed at places x, z (n, 2) [m]."""
        return self.shape_at(places)[0]

    def wet_heights(self, places: np.ndarray, water: np.ndarray) -> np.ndarray:
        """Heights `water` (n,) [m] at places x, z (n, 2) [m], with NaN in place of those where the bed is dry."""
        over = water - self.heights(places) > WET_DEPTH_SHARE * (self.y.max() - self.lowest)
        return np.where(over, water, np.nan)

    def touching(self, position: np.ndarray, spacing: float) -> np.ndarray:
        """Positions (m, 3) [m] of those particles at `position` (n, 3), `spacing` [m] apart, that touch the bed."""
        return position[self.distances(position) <= TOUCH_DISTANCE * spacing]

    def runup(self, position: np.ndarray, spacing: float, axis: int = 0) -> float:
        """Run-up [m]: height of the water's edge, half a `spacing` [m] of water beyond the highest bed point that
        particles at `position` (n, 3) [m] touch, if water near the bed joins it along `axis` (0: x, 2: z) without a gap
        to the lowest; NaN if none touches. Still water has 0 within a quarter of a spacing."""
        position = position[np.argsort(position[:, axis])]
        away = self.distances(position)
        over = away <= RUNUP_GAP * spacing
        near, touch = position[over], away[over] <= TOUCH_DISTANCE * spacing
        if not touch.any():
            return float("nan")
        bed, slopes = self.shape_at(near[:, [0, 2]])
        steepness = np.linalg.norm(slopes, axis=1)
        edge = bed + 0.5 * spacing * (1.0 + steepness + steepness**2) / np.sqrt(1.0 + steepness**2)
        stretch = np.cumsum(np.diff(near[:, axis], prepend=near[0, axis]) > RUNUP_GAP * spacing)
        return float(edge[touch & (stretch == stretch[np.where(touch, bed, np.inf).argmin()])].max())

    def sheet_heights(self, places: np.ndarray, water: np.ndarray, position: np.ndarray, spacing: float) -> np.ndarray:
        """Heights (n,) [m] of the drawn surface of `water` (n,) [m] at places x, z (n, 2) [m]: in shallows near that of
        deep water, but hidden in the bed far from particles (at `position`, `spacing` [m] apart) that touch it."""
        from scipy.spatial import cKDTree

        bed = self.heights(places)
        deep = water - bed > DEEP_LAYERS * spacing
        if deep.all():
            return water
        thin, sheet, bed = ~deep, water.copy(), bed[~deep]
        level = np.append(water[deep], -np.inf)[cKDTree(places[deep]).query(places[thin])[1]]  # the last without any
        away = cKDTree(self.touching(position, spacing)[:, [0, 2]]).query(places[thin])[0]
        edge = bed + np.maximum(FILM_TAPER * (FILM_REACH * spacing - away), -SUNK_LAYERS * spacing)
        film = np.clip(level, np.maximum(water[thin], edge), np.maximum(water[thin], bed + DEEP_LAYERS * spacing))
        sheet[thin] = np.where(away < FILM_REACH * spacing, film, np.minimum(level, edge))
        return np.maximum(sheet, 0.5 * (self.lowest + self.foot))

    def normals(self, places: np.ndarray) -> np.ndarray:
        """Upward unit normals (n, 3) of the bed at places x, z (n, 2) [m]."""
        slopes = self.shape_at(places)[1]
        across = np.stack([-slopes[:, 0], np.ones(len(places)), -slopes[:, 1]], axis=1)
        return across / np.linalg.norm(across, axis=1, keepdims=True)

    def body_mesh(self, breadth: float) -> tuple[np.ndarray, np.ndarray]:
        """Corners (m, 3, 3) [m], outward normals (m, 3) of triangles around the bed; `breadth`: along z in 2-D [m]."""
        nodes = self.x, self.z if self.dimension == 3 else 0.5 * breadth * self.z
        x, z = np.meshgrid(*(np.pad(places, 1, "edge") for places in nodes), indexing="ij")
        shell = np.stack([x, np.pad(self.y, 1, constant_values=self.foot), z], axis=-1)  # surface and sides
        parts = []
        for sheet in (shell, shell[[-1, 0]][:, [0, -1]]):
            a, b, c, d = sheet[:-1, :-1], sheet[:-1, 1:], sheet[1:, 1:], sheet[1:, :-1]
            parts += [np.stack(three, axis=-2).reshape(-1, 3, 3) for three in ((a, b, c), (a, c, d))]
        corners = np.concatenate(parts)
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        doubled_areas = np.linalg.norm(across, axis=1)
        some = doubled_areas > 0.0
        return corners[some], across[some] / doubled_areas[some, None]

    def distances(self, points: np.ndarray) -> np.ndarray:
        """Distances (n,) [m] of `points` (n, 3) [m] from the bed's tangent plane under them; negative in the bed."""
        heights, slopes = self.shape_at(points[:, [0, 2]])
        return (points[:, 1] - heights) / np.sqrt(1.0 + np.square(slopes).sum(axis=1))

    def column_edges(self, axis: int, spacing: float, margin: float) -> np.ndarray:
        """Edges (k + 1,) [m] along `axis` (0: x, 1: z) of columns of sample points, about a `spacing` [m] apart along
        the bed, which go on for `margin` [m] beyond the first and last grid node."""
        nodes = (self.x, self.z)[axis]
        steepest = np.abs(np.diff(self.y, axis=axis)).max(axis=1 - axis)
        way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(nodes), steepest))])
        edges = np.interp(np.linspace(0.0, way[-1], max(1, round(way[-1] / spacing)) + 1), way, nodes)
        before = edges[(edges > edges[0]) & (edges < edges[0] + margin)]
        after = edges[(edges < edges[-1]) & (edges > edges[-1] - margin)]
        if self.periodic[axis]:
            size = edges[-1] - edges[0]
            return np.concatenate([after - size, edges, before + size])
        return np.concatenate([2.0 * edges[0] - before[::-1], edges, 2.0 * edges[-1] - after[::-1]])

    def columns(self, spacing: float, margin: float) -> tuple[np.ndarray, np.ndarray]:
        """Upright columns that divide the bed and a `margin` [m] beyond its sides, about a `spacing` [m] apart along
        the bed: middles x, z (k, 2) [m], and cross-sections (k,) [m2], in 2-D widths [m]."""
        edges = [self.column_edges(axis, spacing, margin) for axis in range(self.dimension - 1)]
        middles = [0.5 * (edge[1:] + edge[:-1]) for edge in edges] + [np.zeros(1)]
        widths = [np.diff(edge) for edge in edges] + [np.ones(1)]
        places = np.stack(np.meshgrid(*middles[:2], indexing="ij"), axis=-1).reshape(-1, 2)
        return places, np.multiply.outer(*widths[:2]).ravel()

    def samples(self, spacing: float, support: float, margin: float = 0.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Boundary particles within `support` [m] of the bed, in columns a `spacing` [m] apart: positions (n, 3) [m],
        volumes (n,) [m3], in 2-D [m2], normals (n, 3); with a `margin` [m] also in mirror images beyond its sides."""
        places, areas = self.columns(spacing, margin)
        heights, slopes = self.shape_at(places)
        steep = np.sqrt(1.0 + np.square(slopes).sum(axis=1))
        thickness = spacing / LAYERS_A_SPACING * steep[:, None]
        top = heights[:, None] - np.arange(ceil(LAYERS_A_SPACING * (support / spacing + 0.5))) * thickness
        foot = top - thickness
        if margin == 0.0:
            foot = np.maximum(foot, self.lowest)
        tall = top - foot
        column, layer = np.nonzero(tall > 1e-6 * spacing)
        position = np.stack([places[column, 0], (0.5 * (top + foot))[column, layer], places[column, 1]], axis=1)
        return position, (areas[:, None] * tall)[column, layer], self.normals(places)[column]

    def volume_inside(self, boxes: Boxes, spacing: float) -> float:
        """Volume of the bed inside `boxes` [m3], in 2-D area [m2], by columns finer than the particle `spacing` [m]."""
        places, areas = self.columns(spacing / COLUMNS_A_SPACING, 0.0)
        heights, total = self.heights(places), 0.0
        for low, up in boxes:
            within = ((places >= low[[0, 2]]) & (places <= up[[0, 2]]))[:, : self.dimension - 1].all(axis=1)
            total += float((areas * within * (np.clip(heights, low[1], up[1]) - low[1])).sum())
        return total

    def statement(self, spacing: float) -> str:
        """Sentence for the user on volume and depth of the water over the bed, for particles a `spacing` [m] apart."""
        places, areas = self.columns(spacing, 0.0)
        depth = -self.heights(places)
        wet, unit = depth > 0.0, "m3" if self.dimension == 3 else "m2"
        volume, dry = float((depth * areas)[wet].sum()), 1.0 - float(areas[wet].sum() / areas.sum())
        shallow = depth[wet].min() / spacing
        shore = f"; {dry:.0%} of its plan is dry" if dry > 0.0 else ""
        begin = f"the bed has a shape: {volume:.4g} {unit} of still water over it, {shallow:.2g} to"
        return f"{begin} {depth.max() / spacing:.3g} spacings deep{shore}"

    def warnings(self, spacing: float, waves: bool) -> Iterator[str]:
        """Warn of a bed that is mostly dry, and of water too shallow for `waves` at this particle `spacing` [m]."""
        places, _ = self.columns(spacing, 0.0)
        depth = -self.heights(places)
        shallow = places[(depth > 0.0) & (depth < WAVE_ROWS * spacing), 0]
        if (depth <= 0.0).mean() > DRY_WARNED:
            yield "most of the bed is dry; heights count upwards from still water: are these depths, downwards?"
        if waves and len(shallow):
            begin = f"between x = {shallow.min():.3g} and {shallow.max():.3g} m the water over the bed is less than"
            yield f"{begin} {WAVE_ROWS:g} spacings deep in places: waves are coarse there; take a smaller spacing"

    def displaced(self, positions: np.ndarray, boxes: Boxes, lattice: Lattice) -> np.ndarray:
        """(n,) True for particles that the bed displaces, of those at `positions` (n, 3) [m], which fill `boxes`."""
        gone = np.zeros(len(positions), dtype=bool)
        count = round(self.volume_inside(boxes, lattice.spacing) / lattice.volume)
        gone[deepest_first(self.distances(positions), lattice.spacing)[:count]] = True
        return gone

    def make_room(
        self, positions: np.ndarray, beyond: np.ndarray, boxes: Boxes, lattice: Lattice
    ) -> tuple[np.ndarray, np.ndarray]:
        """Make room for the bed among particles at `positions` (n, 3) [m] that fill `boxes`; points `beyond` (m, 3) [m]
        continue their lattice outside. Returns (n,) True for particles to remove, new positions (n, 3) [m]."""
        numbers = repr([lattice, self.lowest, self.periodic, *(x.tolist() for box in boxes for x in box)])
        content = b"".join(array.tobytes() for array in (self.x, self.z, self.y, positions, beyond)) + numbers.encode()

        def made() -> dict[str, np.ndarray]:
            points = np.concatenate([positions, beyond])
            water = np.arange(len(points)) < len(positions)
            gone = np.concatenate([self.displaced(positions, boxes, lattice), self.distances(beyond) < 0.0])
            support = lattice.support * lattice.spacing
            at, volumes, _ = self.samples(lattice.spacing, support, (FIT_REACH + 1.0) * lattice.spacing + support)
            sides = np.array([self.x[0], -np.inf, self.z[0]]), np.array([self.x[-1], np.inf, self.z[-1]])
            return fit_particles(points, water, gone, (at, volumes), lattice, self.dimension, sides, FIT_ITERATIONS)

        return cached_room(positions, content, made)


def cells_and_shares(
    places: np.ndarray, nodes: np.ndarray, periodic: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Cell between `nodes` of an axis for each of `places` (n,) [m]: index, share of the way across it, size [m], and
    -1 for places in the mirror image beyond a side, else 1. If `periodic`, the nodes repeat without mirroring."""
    first, size = nodes[0], nodes[-1] - nodes[0]
    turned = np.mod(places - first, size if periodic else 2.0 * size)
    way = np.where(turned > size, -1.0, 1.0)
    at = first + np.where(turned > size, 2.0 * size - turned, turned)
    cell = np.clip(np.searchsorted(nodes, at, "right") - 1, 0, len(nodes) - 2)
    run = np.diff(nodes)[cell]
    return cell, (at - nodes[cell]) / run, run, way
