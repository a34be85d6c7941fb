"""Kernels are read as Taichi reads them, and nothing is left of that."""

import ast
import inspect
import textwrap

import pytest

from ocean_sim.fluid.sph import pair_sph, smoothing
from ocean_sim.kernel_library import reading, ti, tm
from ocean_sim.ship.water import wave_contact


@pytest.fixture(autouse=True)
def started(taichi_cpu):
    """Taichi, started."""


@ti.func
def power(x, n: ti.template()):
    result = 1.0
    if ti.static(n > 0):
        result = x * power(x, n - 1)
    return result


@ti.func
def oddly(
    x,
    y,
):
    """Lies
    as nothing else does."""
    # and this does, too
    z = x + y
    return z - 1.0


@ti.func
def lost(x):
    y = 2.0 * x
    return y + nowhere  # noqa: F821


@ti.func
def length(v: ti.template()):
    return v.norm()


@ti.data_oriented
class Stick:
    @ti.func
    def norm(self):
        return 7.0


def test_a_function_may_call_itself():
    @ti.kernel
    def cubed(x: float) -> float:
        return power(x, 3) + power(power(x, 2), 1)

    assert cubed(3.0) == 36.0
    assert cubed(2.0) == 12.0


def test_a_function_ends_where_its_statement_does():
    @ti.kernel
    def asked(x: float) -> float:
        return oddly(x, 2.0)

    assert asked(3.0) == 4.0


def functions(module) -> list:
    """All that Taichi compiles in a module, as Python knows it."""
    owners = [module, *(owner for owner in vars(module).values() if inspect.isclass(owner))]
    found = [value for owner in owners for value in vars(owner).values()]
    return [inspect.unwrap(one) for one in found if hasattr(one, "_is_taichi_function") or hasattr(one, "_primal")]


@pytest.mark.parametrize("module", [pair_sph, smoothing, wave_contact])
def test_what_is_read_is_what_python_says_the_source_is(module):
    assert functions(module)
    for function in functions(module):
        expected = ast.parse(textwrap.dedent(inspect.getsource(function)))
        expected.body[0].decorator_list = []
        assert ast.dump(reading.Source(function).parse()) == ast.dump(expected)


def test_a_mistake_in_a_called_function_has_its_place():
    @ti.kernel
    def wrong() -> float:
        return lost(1.0)

    with pytest.raises(ti.TaichiCompilationError) as error:
        wrong()
    line = lost.__wrapped__.__code__.co_firstlineno + 3
    assert f'test_reading.py", line {line}, in lost:\n' in str(error.value)
    assert "in wrong:\n        return lost(1.0)" in str(error.value)


def test_a_method_is_that_of_what_is_handed_over_now():
    """A vector finds its methods among Taichi's functions, an object has its own."""
    stick = Stick()

    @ti.kernel
    def three(x: float) -> float:
        return length(tm.vec2(3.0 * x, 4.0)) + length(stick) + length(tm.vec2(0.0, x))

    assert three(1.0) == 13.0


def test_reading_leaves_nothing_of_what_a_kernel_belongs_to():
    stick = Stick()

    @ti.kernel
    def seven() -> float:
        return length(stick)

    assert seven() == 7.0
    trees = [tree for source in reading.known_sources.values() for tree in source.trees]
    assert trees
    assert [node for tree in trees for node in tree.nodes if getattr(node, "ptr", None) is not None] == []


@ti.func
def counted(count: ti.template()):
    count[0] += 1.0
    return tm.vec2(7.0, 8.0)


def test_products_and_sums_are_those_of_what_is_worked_out_once():
    found = ti.field(float, shape=8)

    @ti.kernel
    def fill():
        tall, square = ti.Matrix([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]), ti.Matrix([[1.0, 2.0], [3.0, 4.0]])
        turned, both, back = tall @ counted(found), square @ square, tm.vec2(7.0, 8.0) @ square
        for k in ti.static(range(3)):
            found[1 + k] = turned[k]
        found[4], found[5] = both[0, 1], back[1]
        found[6] = tm.vec2(1.0, 2.0).dot(counted(found))
        found[7] = float((tall > 5.5).any()) + 2.0 * float((tall > 0.5).all()) + 4.0 * float((tall > 1.5).all())

    fill()
    assert found.to_numpy().tolist() == [2.0, 23.0, 53.0, 83.0, 10.0, 46.0, 23.0, 3.0]


def test_a_product_of_what_does_not_fit_is_told():
    @ti.kernel
    def wrong() -> float:
        return (ti.Matrix([[1.0, 2.0], [3.0, 4.0]]) @ tm.vec3(0.0))[0]

    with pytest.raises(ti.TaichiCompilationError, match=r"dimension mismatch between \(2, 2\) and \(3,\)"):
        wrong()


def test_the_switch_leaves_taichi_as_it_is(monkeypatch):
    monkeypatch.setenv(reading.SWITCH_VARIABLE, "0")
    reading.install()
    assert all(getattr(owner, name) is value for owner, name, value in reading.TAICHI_ORIGINALS)
    monkeypatch.delenv(reading.SWITCH_VARIABLE)
    reading.install()
    assert all(getattr(owner, name) is value for owner, name, value in reading.REPLACEMENTS)
