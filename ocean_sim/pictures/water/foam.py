"""White water, or foam, in pictures: where crests converge, up to a target cover; along hulls; and how it drifts and
fades."""

from itertools import product

import numpy as np

from ocean_sim.pictures.stage.sky import value_noise

# Convergence of a linear wave, its downward acceleration over gravity, at which crests turn white: ours; Snyder and
# Kennedy (1983, J. Phys. Oceanogr. 13) take 0.4 for the points where breaking begins.
BREAKING_CONVERGENCE = 0.30
MAX_COVER = 0.10  # share of the sea that may be white where none is asked for
# [s] in which foam falls to a third (Monahan & Zietlow 1969, J. Geophys. Res. 74: 3.85 s in salt water)
FADE_SECONDS = 3.5
EDGE_SHARE = 0.3  # of the area that turns white: its edge, less than wholly white
FRESH_THICKNESS = 1.25  # of foam just born, over wholly white: ours, so that the white share lasts for 3.5 s
PATCH_CELLS = 4.0  # cells of white water along a side of the least patch that a crest makes
GATHERING_PATCHES = 3.0  # patches apart at which a crest breaks more readily, or less
GATHERING_SPEED = (1.0, 0.6)  # [cells of white water/s] by which these places go along x and z, for another crest
MAX_FLECK_SPREAD = 3.0  # cells that a fleck covers before it thins out: a steep trough over the crest before
FIRST_SPREAD_SHARE = 0.3  # of the cover born where there is none: what the first patches gain as they begin to move
RIM_POWER = 0.6  # power of the share of a mean within the sides, by which it is divided: ours, so that all vary alike
SPENT_CONVERGENCE = 0.3  # share of convergence that white water lacks: crests break sooner where none has before
RISE_SECONDS = 0.4  # [s] in which a patch turns white while the crest that breaks runs over it
BREAKING_INTERVAL = 0.2  # [s] after which crests are looked for that break
FLECKS_PER_CELL = 2  # cells of white water along a cell of the waves
GRAIN_SECONDS = 9.0  # [s] in which the grain of foam forgets how far the water has carried it
PATCH_MEAN, PATCH_VARIANCE = 0.550, 0.0090  # mean of the grain; variance of its largest scale
RIDGE_MEAN, RIDGE_VARIANCE = 0.447, 0.0845  # mean and variance of each of its finer octaves, over their share
GRAIN_SCALE = 1.6  # of the grain of foam [1/m]
OCTAVE_TURN = (0.8253, 0.5646)  # cosine and sine by which each octave of the grain is turned against the one before
GRAIN_BEND = 0.9  # by which the grain is bent, so that it follows no axis
EDGE_SOFTNESS = 0.40  # of a covered share: how far the edges of foam fade at most
MIN_WHITENESS, WHOLE_SHARE = 0.40, 0.50  # of the thinnest foam, and the share from which foam is wholly white
MIN_SHARE = 0.005  # share of white water below which none is drawn
MAX_FOOTPRINT = 0.45  # [m] footprint of a pixel beyond which the grain is not drawn
HEAP_SCALES, HEAP_SLOPE = (1.9, 5.3, 14.0), 0.34  # [1/m] of heaps of thick foam; slope of each, of noise's own
HOLLOW_SHADES = (0.34, 0.24, 0.18)  # share of its light that a hollow between heaps loses against their tops
STREAK_STRETCH, THREAD_STRETCH = 3.0, 1.5  # along the wind over across it: of bent edges, and of the grain
EDGE_BENDS = (2.3, 1.3), (1.1, 0.8), (0.6, 0.35)  # cells of a wave that bends the edges of foam, and by how much


def crest_cover(convergence: np.ndarray) -> float:
    """Share of the sea where convergence exceeds BREAKING_CONVERGENCE, so that crests break; at most MAX_COVER.
    Convergence: downward acceleration of the surface over gravity."""
    return float(min((convergence > BREAKING_CONVERGENCE).mean(), MAX_COVER))


def white_shares(convergence: np.ndarray, wanted: float, among: np.ndarray | None = None) -> np.ndarray:
    """Whiteness (n,), 0 to 1, of points with `convergence` (n,) (downward acceleration over gravity): highest where
    that is, `wanted` on average. `among`: sorted convergence of the points to rank these among; default: themselves."""
    known = np.sort(convergence, axis=None) if among is None else among
    if wanted * len(known) < 1.0 or known[0] == known[-1]:  # not one of them would be white
        return np.zeros(np.shape(convergence))
    part = 2.0 * min(wanted, 0.5)  # of the points that are not wholly dark
    white = np.zeros(np.shape(convergence))
    some = convergence >= known[max(int((1.0 - part) * len(known)) - 1, 0)]
    upper = 1.0 - np.searchsorted(known, convergence[some], side="right") / len(known)
    white[some] = np.clip(1.0 - upper / part, 0.0, 1.0)
    return white


def monahan_cover(speed: float) -> float:
    """White-cap cover at a wind speed [m/s] at 10 m (Monahan & O'Muircheartaigh 1980, J. Phys. Oceanogr. 10, eq. 5)."""
    return 3.84e-6 * max(speed, 0.0) ** 3.41


def smoothed_convergence(convergence: np.ndarray) -> np.ndarray:
    """Convergence (n, m) (downward acceleration over gravity) averaged over a foam patch, to choose crests that break.
    It is lowered at the grid's sides, where a mean over fewer cells varies more and would start too much foam."""
    from scipy.ndimage import gaussian_filter

    whole = np.ones_like(convergence)
    held, within = (gaussian_filter(of, PATCH_CELLS, mode="constant") for of in (convergence, whole))
    return np.asarray(held / within**RIM_POWER)


def wanted_cover(convergence: np.ndarray, wind: float) -> float:
    """Target share of white water: from the wind speed [m/s], or if 0, from convergence (downward acceleration / g)."""
    return min(monahan_cover(wind), MAX_COVER) if wind > 0.0 else crest_cover(convergence)


class FoamField:
    """Share of white water on a grid over time: foam begins on converging crests, drifts with the water and fades.

    New patches, each as wide as a white cap, replace faded foam, so that the mean cover stays at a target. Foam
    consists of flecks that move freely, since shares on a grid would blur. A fleck begins on one of the foam's cells,
    of which there are FLECKS_PER_CELL along each side of a cell of the waves' grid."""

    def __init__(self, shape: tuple[int, int], cell: np.ndarray, life: float = FADE_SECONDS, fine: bool = True) -> None:
        """`shape`, `cell`: number and sides [m] of the heights' cells on x, z; `life`: time [s] of fading to 1/e;
        `fine`: True to move the foam's fine pattern, too."""
        self.cell, self.life, self.fine, self.time = cell, life, fine, 0.0
        self.origin = np.zeros(2)  # of the grid along x and z [cells of the waves]
        self.flecks = np.zeros((4, 0))  # places along x and z [cells of the waves], thickness, and what that rises to
        self.white = np.zeros((FLECKS_PER_CELL * shape[0], FLECKS_PER_CELL * shape[1]))  # share of each of its cells
        self.whitened = np.zeros_like(self.white)  # share of each of its cells that has turned white in the last step
        self.ticked = 0.0  # time of the last tick [s]
        self.carried = np.zeros((*shape, 2))  # by which the grain has been moved along x and z [m]
        self.cover = 0.0  # that is called for, in the mean over the time that foam lasts, or since any was
        self.called = 0.0  # weight of that mean: near 1 once foam has been called for as long as it lasts
        self.owed = 0.0  # cover that is lacking in the mean over the time that foam lasts
        self.started = False

    def due(self, time: float) -> bool:
        """True if crests should be searched for new foam at a time [s]: at first, and then every BREAKING_INTERVAL."""
        now, before = (np.floor(moment / BREAKING_INTERVAL + 1e-6) for moment in (time, self.ticked))
        return not self.started or bool(now > before)

    def advance(
        self, time: float, velocity: np.ndarray, source: np.ndarray | None, wanted: float | None = None
    ) -> None:
        """Advance the foam to a time [s], carried by the surface velocity along x, z (nx, nz, 2) [m/s]. `source` (nx,
        nz): convergence (downward acceleration over gravity), where new foam keeps the mean cover at `wanted`; or,
        without `wanted`, the share of new white water; None: no new foam."""
        if self.started and time > self.time:
            self.carry(velocity * (time - self.time))
            self.carried *= np.exp(-(time - self.time) / GRAIN_SECONDS)
            self.fade(time - self.time)
            self.white = self.cell_shares(self.flecks[2])
        if source is not None and wanted is None:
            made = refined_cells(source)
            fresh = np.where(made > self.white + MIN_SHARE, made, 0.0)
            self.whitened = np.maximum(fresh - self.white, 0.0)
            self.add(fresh, fresh)
        elif source is not None and wanted is not None and self.due(time):
            since = time - self.ticked if self.started else 0.0
            self.update_target_cover(wanted, np.exp(-since / FADE_SECONDS) if self.started else 0.0)
            born = self.breaking_foam(source, time, since)
            if born.any():
                self.add(born, self.white if self.started else born)
            self.ticked = time
        self.time, self.started = time, True

    def update_target_cover(self, wanted: float, fades: float) -> None:
        """Update the running mean of the target cover by `wanted`; `fades`: weight that the old mean keeps, 0 to 1."""
        before = self.called * fades
        self.called = before + 1.0 - fades if before > 0.0 or wanted > 0.0 else 0.0
        if self.called > 0.0:
            self.cover += (wanted - self.cover) * (1.0 - before / self.called)

    def breaking_foam(self, convergence: np.ndarray, time: float, step: float) -> np.ndarray:
        """Thickness (1: white) of new foam in each foam cell, to bring the mean cover to its target. `convergence` (nx,
        nz): downward acceleration over gravity at a `time` [s]; `step`: time since the last call [s]. White cells count
        as less convergent; else foam on standing waves would never end."""
        white, least = self.cell_shares(self.flecks[2:].max(axis=0)), PATCH_CELLS**2 / self.white.size
        lacks = self.cover - white.mean()
        self.owed = float(np.clip(self.owed + lacks * step / FADE_SECONDS, -least, least))
        if max(lacks, self.owed) < 0.5 * least:
            return np.zeros_like(white)
        # A crest breaks in places, not all along in a line too thin to last.
        cells = FLECKS_PER_CELL * (np.indices(convergence.shape) + self.origin[:, None, None])
        places = cells + np.multiply(GATHERING_SPEED, time)[:, None, None]
        gathering = gathering_noise(places / (GATHERING_PATCHES * PATCH_CELLS))
        gathered = refined_cells(convergence * gathering)
        fresh = smoothed_convergence(gathered) * (1.0 - SPENT_CONVERGENCE * white)
        spreads = FIRST_SPREAD_SHARE * float(np.clip(lacks / max(self.cover, 1e-9), 0.0, 1.0))
        born = new_foam(white, fresh, white.mean() + (1.0 - spreads) * max(lacks, least))
        return np.where(born > white, born, 0.0)

    def add(self, rises_to: np.ndarray, thick: np.ndarray) -> None:
        """Add flecks (pieces of foam that drift freely), one on each foam cell where `rises_to` is not 0, in place of
        older ones there. In each cell their thickness (1: white) is `thick` now, and will grow to `rises_to`."""
        covered = rises_to[tuple(self.fleck_cells())] > 0.0
        i, k = np.nonzero(rises_to)
        x, z = ((cell + 0.5) / FLECKS_PER_CELL - 0.5 for cell in (i, k))
        fresh = np.stack([x, z, thick[i, k], rises_to[i, k]])
        self.flecks = np.concatenate([self.flecks[:, ~covered], fresh], axis=1)
        self.white = self.cell_shares(self.flecks[2])

    def fleck_cells(self) -> np.ndarray:
        """Indices (2, n) of the foam cells that hold the n flecks (pieces of foam that drift freely)."""
        return np.floor(FLECKS_PER_CELL * (self.flecks[:2] + 0.5)).astype(int)

    def receive(self, places: np.ndarray, area: np.ndarray) -> None:
        """Add foam of `area` (n,) [m2] where spray falls: at x, z `places` (n, 2), in cells of the grid of heights."""
        cells = np.floor(FLECKS_PER_CELL * (places + 0.5)).astype(int)
        inside = ((cells >= 0) & (cells < self.white.shape)).all(axis=1)
        share, thick = np.zeros((2, *self.white.shape))
        np.add.at(share, tuple(cells[inside].T), area[inside] * FLECKS_PER_CELL**2 / self.cell.prod())
        np.maximum.at(thick, tuple(self.fleck_cells()), self.flecks[2])
        whiter = np.where(share > MIN_SHARE, np.minimum(thick + share, FRESH_THICKNESS), 0.0)
        self.add(whiter, whiter)

    def fade(self, step: float) -> None:
        """Let each fleck thicken or fade over a time `step` [s], and remove those too thin to see."""
        x, z, thick, rises_to = self.flecks
        rising = rises_to > thick
        risen = np.minimum(rises_to, thick + step / RISE_SECONDS)
        thick = np.where(rising, risen, thick * np.exp(-step / self.life))
        self.whitened = self.cell_shares(np.where(rising, thick - self.flecks[2], 0.0))
        rises_to = np.where(rising & (rises_to > thick), rises_to, 0.0)
        self.flecks = np.stack([x, z, thick, rises_to])[:, np.maximum(thick, rises_to) > MIN_SHARE]

    def cell_shares(self, thick: np.ndarray) -> np.ndarray:
        """Share of white water in each foam cell, from flecks (drifting pieces of foam) of thickness `thick` (n,), 1
        being a white cell; less where the water has spread them apart."""
        rows, columns = self.white.shape
        x, z = (FLECKS_PER_CELL * (along + 0.5) - 0.5 for along in self.flecks[:2])
        i, k = np.floor(x).astype(int), np.floor(z).astype(int)
        covered, held = np.zeros(self.white.size), np.zeros(self.white.size)
        for m, n in product((0, 1), repeat=2):
            near = (1.0 - np.abs(x - i - m)) * (1.0 - np.abs(z - k - n))
            at = np.clip(i + m, 0, rows - 1) * columns + np.clip(k + n, 0, columns - 1)
            covered += np.bincount(at, near, covered.size)
            held += np.bincount(at, near * thick, held.size)
        share = held * np.minimum(MAX_FLECK_SPREAD, 1.0 / np.maximum(covered, 1e-9))
        return np.minimum(share, 1.0).reshape(rows, columns)

    def carry(self, way: np.ndarray) -> None:
        """Move flecks and the foam's fine pattern by the water's displacements `way` along x, z (nx, nz, 2) [m]."""
        cells = np.moveaxis(way / self.cell, -1, 0)
        # Ways are read in their middle, not at their end, since water may go around.
        if self.fine:
            here = np.indices(cells.shape[1:]) - read_ways(cells, np.indices(cells.shape[1:]) - 0.5 * cells)
            self.carried = np.moveaxis(read_ways(np.moveaxis(self.carried, -1, 0), here, order=3), 0, -1) + way
        self.flecks[:2] += read_ways(cells, self.flecks[:2] + 0.5 * read_ways(cells, self.flecks[:2]))
        self.drop_outside()

    def shift(self, cells: np.ndarray) -> None:
        """Move the grid by whole cells along x and z under the foam, which stays in place; new cells have no foam."""
        from scipy.ndimage import shift

        self.origin += cells
        self.flecks[:2] -= cells[:, None]
        self.drop_outside()
        if cells.any():
            self.white = shift(self.white, -FLECKS_PER_CELL * cells, order=0)
            self.carried = shift(self.carried, (*-cells, 0), order=0)

    def drop_outside(self) -> None:
        """Remove the flecks outside the grid."""
        x, z = self.flecks[:2]
        nx, nz = self.carried.shape[:2]
        self.flecks = self.flecks[:, (x >= -0.5) & (x < nx - 0.5) & (z >= -0.5) & (z < nz - 0.5)]


def gathering_noise(places: np.ndarray) -> np.ndarray:
    """Random factor (n,), 1 on average, on convergence, which makes foam patchy; of period 1 in `places` (2, n)."""
    return 0.5 + value_noise(*places)


def refined_cells(values: np.ndarray) -> np.ndarray:
    """Values (nx, nz) at cell centres, interpolated linearly to the centres of the foam's finer cells (FLECKS_PER_CELL
    along each side of a cell); constant outside the outermost centres."""
    fine = np.indices([FLECKS_PER_CELL * cells for cells in values.shape])
    return read_ways(values[None], (fine + 0.5) / FLECKS_PER_CELL - 0.5)[0]


def cell_means(white: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """Means (nx, nz) of the white share on fine cells over the cells of a coarse grid of this shape."""
    nx, nz = shape
    return white.reshape(nx, white.shape[0] // nx, nz, white.shape[1] // nz).mean(axis=(1, 3))


def read_ways(ways: np.ndarray, places: np.ndarray, order: int = 1) -> np.ndarray:
    """Displacements `ways` (k, nx, nz) at cell centres, interpolated by splines of this order to positions `places` (2,
    ...) [cells]; beyond the grid as at its edge."""
    from scipy.ndimage import map_coordinates

    return np.stack([map_coordinates(way, places, order=order, mode="nearest") for way in ways])


def read_cells(values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Values (n, ...) of a grid (nx, nz, ...), interpolated at positions `at` (2, n), 0 to 1 across it."""
    channels = np.moveaxis(values.reshape(*values.shape[:2], -1), -1, 0).astype(float)
    found = read_ways(channels, at * np.array(values.shape[:2])[:, None] - 0.5)
    return found.T.reshape(at.shape[1], *values.shape[2:])


def new_foam(white: np.ndarray, convergence: np.ndarray, wanted: float) -> np.ndarray:
    """Thickness (n, m) (1: white) of new foam, on water of greatest `convergence` (n, m), downward acceleration over
    gravity, that raises the mean of `white` (n, m) to `wanted`."""
    born, (low, high) = np.zeros_like(white), (0.0, 1.0)
    if white.mean() >= wanted or np.ptp(convergence) == 0.0:
        return born
    rank = np.empty_like(white)
    rank.flat[np.argsort(-convergence, axis=None)] = np.arange(white.size) / white.size
    for _ in range(24):
        area = 0.5 * (low + high)
        born = FRESH_THICKNESS * np.clip((area - rank) / (EDGE_SHARE * max(area, 1e-9)), 0.0, 1.0)
        low, high = (area, high) if np.clip(born, white, 1.0).mean() < wanted else (low, area)
    return born


def edge_bends(x: np.ndarray, z: np.ndarray, angle: float) -> np.ndarray:
    """Displacements (2, n) by which noise bends the edges of foam, else round blobs, at positions x, z (n,), all in
    cells of the foam. They are longest along the wind, at an `angle` [rad] from +x to +z."""
    c, s = np.cos(angle), np.sin(angle)
    along, across, way = (c * x + s * z) / STREAK_STRETCH, c * z - s * x, np.zeros((2, len(x)))
    for wave, far in EDGE_BENDS:
        u, v = along / wave, across / wave
        way += far * (np.stack([value_noise(u + 3.0, v + 17.0), value_noise(u + 29.0, v + 5.0)]) - 0.5)
    return np.stack([STREAK_STRETCH * c * way[0] - s * way[1], STREAK_STRETCH * s * way[0] + c * way[1]])


def grain_places(places: np.ndarray, angle: float) -> np.ndarray:
    """Positions (n, 2) [m] at which to read noise for the fine pattern of foam at x, z `places` (n, 2) [m]. They are
    compressed along the wind, at an `angle` [rad] from +x to +z, which draws foam into threads."""
    way = np.array([np.cos(angle), np.sin(angle)])
    return places - (1.0 - 1.0 / THREAD_STRETCH) * (places @ way)[:, None] * way


def levelled_heights(elevation: np.ndarray, inside: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """Heights `elevation` (nx, nz) [m] in which those marked `inside` (nx, nz) are replaced by a mean of unmarked ones
    around them, with Gaussian weights of standard deviation `reach` along x, z [cells]."""
    from scipy.ndimage import gaussian_filter

    outside = (~inside).astype(float)
    around, weight = (gaussian_filter(of, reach, mode="nearest") for of in (elevation * outside, outside))
    return np.where(inside, around / np.maximum(weight, 1e-9), elevation)
