"""Smooth edges in a finished picture, after Lottes' FXAA (2009, NVIDIA): each edge is followed both ways to its ends,
and a pixel is mixed with its neighbour across the edge by the share that the edge would cover."""

import numpy as np

# Contrast of brightness of 255, and over the brightest around, from which there is an edge
MIN_CONTRAST, MIN_RELATIVE_CONTRAST = 32, 0.25
EDGE_REACHES = (1.0, 2.0, 3.0, 4.5, 6.5, 10.5, 18.5)  # pixels along an edge at which it is looked for its end
BATCH_ROWS = 60  # that are looked at together: what is worked with stays in the processor's cache
SINGLE_PIXEL_BLUR = 0.6  # of the blur of what is a single pixel wide


def sample_means(image: np.ndarray, samples: int) -> np.ndarray:
    """Picture (height, width, 3), 8-bit RGB, reduced by the mean over samples x samples pixels."""
    from PIL import Image

    return np.array(Image.fromarray(np.ascontiguousarray(image)).reduce(samples))


def smooth_edges(image: np.ndarray) -> np.ndarray:
    """Copy of a picture (height, width, 3), 8-bit RGB, with jagged edges smoothed."""
    from PIL import Image

    bright = np.pad(np.asarray(Image.fromarray(np.ascontiguousarray(image)).convert("L")), 1, mode="edge")
    padded = np.pad(image, ((1, 1), (1, 1), (0, 0)), mode="edge")
    flat, result = bright.ravel().astype(np.float32), padded.copy()
    for first in range(0, len(image), BATCH_ROWS):
        at, across, share = find_edges(bright, flat, first)
        at, beyond, rest = 3 * at, 3 * (at + across), 1.0 - share
        for channel in range(3):
            old, new = padded.ravel()[channel:], result.ravel()[channel:]
            new[at] = (rest * old.take(at) + share * old.take(beyond) + 0.5).astype(np.uint8)
    return np.ascontiguousarray(result[1:-1, 1:-1])


def find_edges(bright: np.ndarray, flat: np.ndarray, first: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Indices (n,) in `flat` of pixels at edges, in BATCH_ROWS rows from `first` on, of a brightness with a one-pixel
    margin; index step (n,) across the edge to the neighbour; share (n,) of its colour that each pixel takes."""
    rows, last = bright.shape[1], min(first + BATCH_ROWS, len(bright) - 2)
    north, south = bright[first:last, 1:-1], bright[first + 2 : last + 2, 1:-1]
    middle, west, east = (bright[first + 1 : last + 1, k : rows - 2 + k] for k in (1, 0, 2))
    high = np.maximum(np.maximum(np.maximum(north, south), np.maximum(west, east)), middle)
    low = np.minimum(np.minimum(np.minimum(north, south), np.minimum(west, east)), middle)
    contrast = (high - low).ravel()
    found = np.flatnonzero(contrast > np.maximum(np.float32(MIN_RELATIVE_CONTRAST) * high.ravel(), MIN_CONTRAST))
    contrast = contrast.take(found).astype(np.float32)
    at = found + 2 * (found // (rows - 2)) + (rows * (first + 1) + 1)
    m, n, s, w, e = (flat.take(at + step) for step in (0, -rows, rows, -1, 1))
    nw, ne, sw, se = (flat.take(at + step) for step in (-rows - 1, -rows + 1, rows - 1, rows + 1))
    around = (2.0 * (n + s + w + e) + nw + ne + sw + se) / 12.0
    single = np.minimum(np.abs(around - m) / contrast, 1.0)
    single = SINGLE_PIXEL_BLUR * (single * single * (3.0 - 2.0 * single)) ** 2
    across_rows = np.abs(nw + sw - 2.0 * w) + 2.0 * np.abs(n + s - 2.0 * m) + np.abs(ne + se - 2.0 * e)
    across_columns = np.abs(nw + ne - 2.0 * n) + 2.0 * np.abs(w + e - 2.0 * m) + np.abs(sw + se - 2.0 * s)
    along = np.where(across_rows >= across_columns, 1, rows)  # an edge runs along a row, or along a column
    across = rows + 1 - along
    before, after = np.abs(flat.take(at - across) - m), np.abs(flat.take(at + across) - m)
    steepness = np.maximum(before, after)
    across *= 1 - 2 * (before >= after)
    edge = 0.5 * (m + flat.take(at + across))
    back, off_back = follow_edge(flat, at, across, -along, edge, 0.25 * steepness)
    on, off_on = follow_edge(flat, at, across, along, edge, 0.25 * steepness)
    covered = 0.5 - np.minimum(back, on) / (back + on)
    beyond = np.where(back <= on, off_back, off_on)
    return at, across, np.maximum(covered * ((m < edge) != (beyond < 0.0)), single)


def follow_edge(
    flat: np.ndarray, at: np.ndarray, across: np.ndarray, along: np.ndarray, edge: np.ndarray, most: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Distance (n,) [pixels] from pixels `at` to their edges' ends, and brightness (n,) there less the edge's."""

    def found(of: slice | np.ndarray, reach: float) -> np.ndarray:
        here = at[of] + int(reach) * along[of]
        there = here + across[of]
        return 0.5 * (flat.take(here, mode="clip") + flat.take(there, mode="clip")) - edge[of]

    off = found(slice(None), EDGE_REACHES[0])
    distance, going = np.full_like(off, EDGE_REACHES[0]), np.flatnonzero(np.abs(off) < most)
    for reach in EDGE_REACHES[1:]:
        distance[going], off[going] = reach, found(going, reach)
        going = going[np.abs(off[going]) < most[going]]
    return distance, off
