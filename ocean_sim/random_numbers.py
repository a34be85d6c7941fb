"""Counter-based random numbers: (seed, stream, particle, step) -> number, the same in any order and on any backend.

The mixing function is `pcg4d` of Jarzynski & Olano (2020), Hash Functions for GPU Rendering, J. Computer Graphics
Techniques 9(3): four 32-bit words in, four well mixed words out. It is written once and serves Taichi and NumPy. The
upper 24 bits of a word make a number, so it is the same in f32 and f64. Keys are 0 to 2^31 - 1.
"""

import numpy as np
from numpy.typing import ArrayLike

from ocean_sim.kernel_library import ti, tm

UNIT_STEP = 2.0**-24  # step of the numbers in [0, 1)


def pcg4d(a, b, c, d):
    """Mix four unsigned 32-bit words, or arrays of them, into four random ones; unannotated, for Taichi's sake."""
    a = a * 1664525 + 1013904223
    b = b * 1664525 + 1013904223
    c = c * 1664525 + 1013904223
    d = d * 1664525 + 1013904223
    a += b * d
    b += c * a
    c += a * b
    d += b * c
    a = a ^ (a >> 16)
    b = b ^ (b >> 16)
    c = c ^ (c >> 16)
    d = d ^ (d >> 16)
    a += b * d
    b += c * a
    c += a * b
    d += b * c
    return a, b, c, d


taichi_pcg4d = ti.func(pcg4d)


@ti.func
def to_unit_interval(word):
    """Number in [0, 1) from a random 32-bit word."""
    return ti.cast(ti.cast(word >> 8, ti.i32), float) * UNIT_STEP


@ti.func
def to_symmetric_interval(word):
    """Number in (-1, 1) from a random 32-bit word, as often above zero as below."""
    return ti.cast(ti.cast((word >> 8) | 1, ti.i32), float) * (2.0 * UNIT_STEP) - 1.0


@ti.func
def uniform(seed, stream, particle, step):
    """Random number in [0, 1) for four integer keys (`stream`: one for each use); equal keys give the equal number."""
    a, _b, _c, _d = taichi_pcg4d(ti.u32(seed), ti.u32(stream), ti.u32(particle), ti.u32(step))
    return to_unit_interval(a)


@ti.func
def uniform3(seed, stream, particle, step):
    """Vector of three independent random numbers in (-1, 1) for four integer keys; equal keys give the equal vector."""
    a, b, c, _d = taichi_pcg4d(ti.u32(seed), ti.u32(stream), ti.u32(particle), ti.u32(step))
    return tm.vec3(to_symmetric_interval(a), to_symmetric_interval(b), to_symmetric_interval(c))


def numpy_words(seed: ArrayLike, stream: ArrayLike, particle: ArrayLike, step: ArrayLike) -> tuple[np.ndarray, ...]:
    """Four arrays of random unsigned 32-bit words for keys (arrays or numbers), broadcast to at least one axis."""
    keys = np.broadcast_arrays(*(np.atleast_1d(np.asarray(k, dtype=np.uint32)) for k in (seed, stream, particle, step)))
    return pcg4d(*keys)


def numpy_uniform(seed: ArrayLike, stream: ArrayLike, particle: ArrayLike, step: ArrayLike) -> np.ndarray:
    """Random numbers in [0, 1) in the broadcast shape of the keys, equal to those of `uniform` bit for bit."""
    return (numpy_words(seed, stream, particle, step)[0] >> 8) * UNIT_STEP


def numpy_uniform3(seed: ArrayLike, stream: ArrayLike, particle: ArrayLike, step: ArrayLike) -> np.ndarray:
    """Random numbers (..., 3) in (-1, 1) for keys broadcast to (...), equal to those of `uniform3` bit for bit."""
    words = numpy_words(seed, stream, particle, step)[:3]
    return np.stack([((w >> 8) | 1) * (2.0 * UNIT_STEP) - 1.0 for w in words], axis=-1)
