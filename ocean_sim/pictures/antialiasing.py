"""Edges of a finished picture made smooth, after Lottes' FXAA (2009, NVIDIA): an edge is followed both ways to its
ends, and a pixel takes of its neighbour across it what the edge would cover. Only pixels at edges cost time."""

import numpy as np

LEAST, RELATIVE = 26, 0.2  # contrast of brightness of 255, and over the brightest around, from which there is an edge
STEPS = (1.0, 1.0, 1.0, 1.5, 2.0, 4.0, 8.0)  # pixels by which an edge is followed
ROWS = 60  # that are looked at together: what is worked with stays in the processor's cache
SINGLE = 0.6  # of the blur of what is a single pixel wide


def mean(image: np.ndarray, samples: int) -> np.ndarray:
    """A picture with so many samples along each side of a pixel as one of their means, 8-bit RGB."""
    from PIL import Image

    return np.array(Image.fromarray(np.ascontiguousarray(image)).reduce(samples))


def smooth(image: np.ndarray) -> np.ndarray:
    """(height, width, 3) 8-bit RGB of the same size."""
    from PIL import Image

    bright = np.pad(np.asarray(Image.fromarray(np.ascontiguousarray(image)).convert("L")), 1, mode="edge")
    padded = np.pad(image, ((1, 1), (1, 1), (0, 0)), mode="edge").reshape(-1, 3)
    flat, result = bright.ravel().astype(np.float32), image.copy()
    for first in range(0, len(image), ROWS):
        at, across, share = edges(bright, flat, first)
        blended = (1.0 - share) * padded[at] + share * padded[at + across]
        row, column = np.divmod(at, bright.shape[1])
        result[row - 1, column - 1] = (blended + 0.5).astype(np.uint8)
    return result


def edges(bright: np.ndarray, flat: np.ndarray, first: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of ROWS rows of a picture from a first one on, the numbers (n,) of the pixels at edges in its brightness, padded
    by a pixel; by how much the number across the edge differs, and the share (n, 1) that a pixel takes from there.

    `flat`: the same brightness, pixel after pixel.
    """
    rows, last = bright.shape[1], min(first + ROWS, len(bright) - 2)
    north, south = bright[first:last, 1:-1], bright[first + 2 : last + 2, 1:-1]
    middle, west, east = (bright[first + 1 : last + 1, k : rows - 2 + k] for k in (1, 0, 2))
    high = np.maximum(np.maximum(np.maximum(north, south), np.maximum(west, east)), middle)
    low = np.minimum(np.minimum(np.minimum(north, south), np.minimum(west, east)), middle)
    contrast = (high - low).ravel()
    found = np.flatnonzero(contrast > LEAST).astype(np.int32)
    found = found[contrast[found] > np.float32(RELATIVE) * high.ravel()[found]]
    contrast = contrast[found].astype(np.float32)
    at = found + 2 * (found // (rows - 2)) + (rows * (first + 1) + 1)
    m, n, s, w, e = (flat.take(at + step) for step in (0, -rows, rows, -1, 1))
    nw, ne, sw, se = (flat.take(at + step) for step in (-rows - 1, -rows + 1, rows - 1, rows + 1))
    around = (2.0 * (n + s + w + e) + nw + ne + sw + se) / 12.0
    single = np.clip(np.abs(around - m) / contrast, 0.0, 1.0)
    single = SINGLE * (single * single * (3.0 - 2.0 * single)) ** 2
    across_rows = np.abs(nw + sw - 2.0 * w) + 2.0 * np.abs(n + s - 2.0 * m) + np.abs(ne + se - 2.0 * e)
    across_columns = np.abs(nw + ne - 2.0 * n) + 2.0 * np.abs(w + e - 2.0 * m) + np.abs(sw + se - 2.0 * s)
    level = across_rows >= across_columns  # whether the edge runs along a row
    before, after = np.where(level, n, w), np.where(level, s, e)
    nearer_before = np.abs(before - m) >= np.abs(after - m)
    across = np.where(level, np.int32(rows), np.int32(1)) * np.where(nearer_before, np.int32(-1), np.int32(1))
    along = np.where(level, np.int32(1), np.int32(rows))
    steepness = np.where(nearer_before, np.abs(before - m), np.abs(after - m))
    edge = 0.5 * (m + np.where(nearer_before, before, after))
    ends = [followed(flat, at, across, way * along, edge, 0.25 * steepness) for way in (-1, 1)]
    nearer = ends[0][0] <= ends[1][0]
    distance = np.where(nearer, ends[0][0], ends[1][0])
    beyond = np.where(nearer, ends[0][1], ends[1][1])
    covered = 0.5 - distance / (ends[0][0] + ends[1][0])
    return at, across, np.maximum(np.where((m < edge) != (beyond < 0.0), covered, 0.0), single)[:, None]


def followed(
    flat: np.ndarray, at: np.ndarray, across: np.ndarray, along: np.ndarray, edge: np.ndarray, most: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """How far along an edge its end lies (n,) [pixels], and by how much the brightness there is off the edge's."""
    distance, off = np.zeros(len(at), np.float32), np.zeros(len(at), np.float32)
    going, reach = np.arange(len(at), dtype=np.int32), 0.0
    for step in STEPS:
        reach += step
        here = at + np.int32(reach) * along
        found = 0.5 * (flat.take(here, mode="clip") + flat.take(here + across, mode="clip")) - edge
        distance[going], off[going] = reach, found
        more = np.flatnonzero(np.abs(found) < most)
        going, at, across, along, edge, most = (each[more] for each in (going, at, across, along, edge, most))
    return distance, off
