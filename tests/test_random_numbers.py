"""Counter-based random numbers: Taichi and NumPy agree bit for bit, and the numbers look random along every key."""

import subprocess
import sys

import numpy as np
import pytest

from ocean_sim.kernel_library import ti
from ocean_sim.random_numbers import numpy_uniform, numpy_uniform3, uniform, uniform3

N = 1 << 14
KEYS = (0, 1, 7, 2**31 - 1)

SINGLE_PRECISION = """
import numpy as np
import taichi as ti

from ocean_sim.random_numbers import numpy_uniform, numpy_uniform3, uniform, uniform3

ti.init(arch=ti.cpu, default_fp=ti.f32, cpu_max_num_threads=1, log_level=ti.ERROR)
one, three = ti.field(float, shape=1000), ti.Vector.field(3, float, shape=1000)


@ti.kernel
def draw():
    for i in range(1000):
        one[i] = uniform(7, 3, i, 11)
        three[i] = uniform3(7, 3, i, 11)


draw()
assert one.to_numpy().dtype == np.float32
assert np.array_equal(one.to_numpy(), numpy_uniform(7, 3, np.arange(1000), 11))
assert np.array_equal(three.to_numpy(), numpy_uniform3(7, 3, np.arange(1000), 11))
"""


@pytest.fixture(scope="module")
def draw(taichi_cpu):
    """Taichi's numbers of one seed, stream and step for N particles: (N,) and (N, 3)."""
    one, three = ti.field(float, shape=N), ti.Vector.field(3, float, shape=N)

    @ti.kernel
    def fill(seed: int, stream: int, step: int):
        for i in range(N):
            one[i] = uniform(seed, stream, i, step)
            three[i] = uniform3(seed, stream, i, step)

    def numbers(seed, stream, step):
        fill(seed, stream, step)
        return one.to_numpy(), three.to_numpy()

    return numbers


@pytest.mark.parametrize("seed", KEYS)
@pytest.mark.parametrize("stream, step", [(0, 0), (3, 12345), (2**31 - 1, 2**31 - 1)])
def test_taichi_and_numpy_agree_bit_for_bit(draw, seed, stream, step):
    scalars, vectors = draw(seed, stream, step)
    assert np.array_equal(scalars, numpy_uniform(seed, stream, np.arange(N), step))
    assert np.array_equal(vectors, numpy_uniform3(seed, stream, np.arange(N), step))


def test_single_precision_gives_the_same_numbers(tmp_path):
    """In a process of its own: a second ti.init would drop the fields of this one."""
    script = tmp_path / "single_precision.py"
    script.write_text(SINGLE_PRECISION)
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_known_numbers():
    """What the mixer gives today: a change would change every seeded run."""
    assert (numpy_uniform(7, 2, np.arange(4), 3) * 2**24).astype(int).tolist() == [580389, 5897293, 3913528, 2104718]


@pytest.mark.parametrize("along", range(4), ids=["seeds", "streams", "particles", "steps"])
def test_numbers_look_random_along_every_key(along):
    """Limits at about four standard deviations of a fair sample."""
    keys = [7, 2, 5, 3]
    keys[along] = np.arange(N)
    u = numpy_uniform(*keys)
    assert u.min() >= 0.0 and u.max() < 1.0
    assert abs(u.mean() - 0.5) < 4.0 / np.sqrt(12 * N)
    assert abs(u.var() - 1 / 12) < 4.0 * np.sqrt((1 / 80 - 1 / 144) / N)
    counts = np.histogram(u, bins=64, range=(0.0, 1.0))[0]
    assert ((counts - N / 64) ** 2 / (N / 64)).sum() < 63 + 4 * np.sqrt(2 * 63)
    for lag in (1, 2, 32, 1024):
        assert abs(np.corrcoef(u[lag:], u[:-lag])[0, 1]) < 4.0 / np.sqrt(N - lag)


@pytest.mark.parametrize("along", range(4), ids=["seeds", "streams", "particles", "steps"])
def test_neighbouring_keys_are_independent(along):
    """The same particles under the next seed, the next stream, the next step; and each particle beside its next."""
    keys, beside = [7, 2, np.arange(N), 3], [7, 2, np.arange(N), 3]
    beside[along] = beside[along] + 1
    assert abs(np.corrcoef(numpy_uniform(*keys), numpy_uniform(*beside))[0, 1]) < 4.0 / np.sqrt(N)


def test_the_three_axes_of_a_vector_are_independent_and_centred():
    v = numpy_uniform3(7, 2, np.arange(N), 3)
    assert np.abs(v).max() < 1.0
    assert np.all(np.abs(v.mean(axis=0)) < 4.0 / np.sqrt(3 * N))
    assert np.all(np.abs(v.var(axis=0) - 1 / 3) < 4.0 * np.sqrt((1 / 5 - 1 / 9) / N))
    assert np.all(np.abs(np.corrcoef(v.T) - np.eye(3)) < 4.0 / np.sqrt(N) + 1e-12)
