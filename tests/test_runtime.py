"""Taichi is started once, and afresh before its room for fields runs out; its threads have cores of their own."""

import json
import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from ocean_sim import Simulation, load, runtime
from ocean_sim.kernel_library import ti
from ocean_sim.machine import available_cores, kernel_cache
from ocean_sim.simulation import require_doubles
from ocean_sim.verbs.shared.progress import kernel_notice

SEA = {
    "basin": {"length": 20.0, "width": 20.0, "depth": 5.0, "walls": "none"},
    "fluid": {"kind": "linear_waves", "height": 0.5, "period": 3.0},
    "duration": 1.0,
    "runtime": {"threads": 1},
}
WATER = {
    "basin": {"length": 2.0, "width": 2.0, "depth": 0.5},
    "fluid": {"kind": "mueller", "spacing": 0.1},
    "duration": 1.0,
    "runtime": {"threads": 1},
    **dict.fromkeys(("render", "report", "frames", "timings")),
}
MANY = """
from ocean_sim.kernel_library import ti
from ocean_sim import runtime
begun = set()
for k in range(540):
    begun.add(id(runtime.start(runtime.RuntimeConfig(threads=1))))
    ti.field(float, shape=4).fill(0.0)
print(len(begun))
"""


def test_the_same_config_gives_what_runs(taichi_cpu):
    assert runtime.start(runtime.RuntimeConfig(precision="f64", threads=1)) is taichi_cpu


KERNEL = """
from ocean_sim import runtime
from ocean_sim.kernel_library import ti
runtime.start(runtime.RuntimeConfig(threads=1))
@ti.kernel
def double(x: ti.f32) -> ti.f32:
    return 2.0 * x
double(1.0)
"""


@pytest.mark.parametrize(("age", "kept"), [(0.0, False), (60.0, True)])
def test_the_lock_of_a_killed_process_does_not_cost_the_kernel_cache(tmp_path, monkeypatch, age, kept):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    cache, script = kernel_cache(), tmp_path / "kernel.py"
    cache.mkdir(parents=True)
    lock = cache / "ticache.lock"
    lock.touch()
    os.utime(lock, (time.time() - age,) * 2)
    script.write_text(KERNEL)
    subprocess.run([sys.executable, str(script)], check=True)
    assert bool(list(cache.glob("*.tic"))) is kept and lock.exists() is not kept


def test_kernels_of_other_copies_are_kept_apart_and_removed_when_long_unused(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    used, unused = kernel_cache().parent / "used", kernel_cache().parent / "unused"
    for folder, days in ((used, 29.0), (unused, 31.0)):
        folder.mkdir(parents=True)
        (folder / "kernel.tic").touch()
        os.utime(folder, (time.time() - 86_400.0 * days,) * 2)
    script = tmp_path / "kernel.py"
    script.write_text(KERNEL)
    subprocess.run([sys.executable, str(script)], check=True)
    assert list(kernel_cache().glob("*.tic")) and used.exists() and not unused.exists()


def test_a_run_says_how_many_kernels_the_cache_has_dropped(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert kernel_notice().startswith("compiling kernels")
    kernel_cache().mkdir(parents=True)
    kernels = [kernel_cache() / f"{k}.tic" for k in range(5)]
    for kernel in kernels:
        kernel.touch()
    assert kernel_notice() == kernel_notice() == "loading kernels"
    for kernel in kernels[:3]:
        kernel.unlink()
    assert "; 3 unused for longest were dropped" in kernel_notice()
    assert kernel_notice() == "loading kernels"


TWICE = """
import sys
from ocean_sim import runtime
from ocean_sim.kernel_library import ti
@ti.kernel
def double(x: ti.template()):
    for i in x:
        x[i] *= 2.0
for k in range(int(sys.argv[1])):
    runtime.start(runtime.RuntimeConfig(threads=1))
    with runtime.Fields() as fields:
        x = ti.field(float, shape=4)
    double(x)
    fields.free()
    runtime._open = runtime._open if sys.argv[2] == "as it is" else {None}
"""


@pytest.mark.parametrize(("told", "more"), [("as it is", False), ("as if one were open", True)])
def test_the_same_fields_once_more_are_not_compiled_once_more(tmp_path, told, more):
    """While nothing is open Taichi starts afresh, and numbers fields as before; else, the negative control, it goes on
    counting, and knows the kernel no more."""
    kept = []
    for times in ("1", "3"):
        home = tmp_path / times
        environment = {**os.environ, "XDG_CACHE_HOME": str(home)}
        (tmp_path / "twice.py").write_text(TWICE)
        subprocess.run([sys.executable, str(tmp_path / "twice.py"), times, told], check=True, env=environment)
        kept.append(len(list((home / "ocean-sim" / "kernels").rglob("*.tic"))))
    assert kept[0] > 0 and (kept[1] > kept[0]) is more


def test_a_simulation_without_fields_of_its_own_keeps_running_beside_another():
    runtime.start(runtime.RuntimeConfig(threads=1))
    with runtime.Fields(), Simulation(load(SEA)) as second:
        backend = second.backend
        second.step()
        assert runtime.start(runtime.RuntimeConfig(threads=1)) is backend


def test_a_simulation_whose_fields_are_gone_says_so(monkeypatch):
    with Simulation(load(SEA)) as first, Simulation(load(SEA)) as second:
        first.step()
        second.step()
        monkeypatch.setattr(runtime, "MAX_FIELD_SETS", 0)  # no room is left
        with Simulation(load(SEA)) as third:
            third.step()
            with pytest.raises(RuntimeError, match="the fields of this simulation are gone"):
                first.step()
            third.step()


def test_fields_that_a_restart_has_taken_say_so_whoever_asks():
    """By a kernel that ran before, by one that did not, and by reading a field; Taichi itself may crash there."""
    runtime.start(runtime.RuntimeConfig(threads=1))
    with Simulation(load(WATER | {"basin": {"length": 2.0, "depth": 0.5}})) as first:
        fluid, points = first.fluid, np.zeros((1, 2))
        fluid.elevations(points)
        runtime.start(runtime.RuntimeConfig(threads=1, precision="f64"))
        for use in (
            lambda: fluid.elevations(points),
            lambda: fluid.pressures(np.zeros((1, 3))),
            lambda: fluid.advance(1e-3),
            lambda: fluid.totals(),
            lambda: fluid.particles.position.to_numpy(),
        ):
            with pytest.raises(RuntimeError) as told:
                use()
            assert str(told.value) == runtime.RESTARTED_MESSAGE


def test_closing_a_simulation_frees_the_memory_of_its_fields_alone():
    with Simulation(load(WATER)) as outer:
        outer.step()
        before, kernels = runtime.allocated_bytes(), runtime.impl.get_runtime().get_num_compiled_functions()
        with Simulation(load(WATER)) as inner:
            inner.step()
            particles, first = inner.fluid.particles, inner.fluid.particles.position.x
            read = particles.position.to_numpy()
            assert runtime.allocated_bytes() > before + read.nbytes
        assert runtime.allocated_bytes() == before
        assert runtime.impl.get_runtime().get_num_compiled_functions() >= kernels
        for use in (particles.position.to_numpy, first.to_numpy, lambda: first[0], particles.velocity.to_numpy):
            with pytest.raises(RuntimeError, match="belongs to a simulation that is closed"):
                use()
        with pytest.raises(RuntimeError, match="this simulation is closed"):
            inner.step()
        outer.step()
        again = Simulation(load(WATER))
        again.step()
        np.testing.assert_array_equal(again.fluid.particles.position.to_numpy(), read)
        again.close()
        again.close()  # a second time changes nothing
        outer.step()
    assert runtime.allocated_bytes() < before


def test_a_simulation_that_cannot_be_built_keeps_no_memory(monkeypatch, tmp_path):
    before = runtime.allocated_bytes()
    (tmp_path / "frames").write_text("a file where a folder is to be")
    with pytest.raises(OSError):
        Simulation(load(WATER | {"frames": {}}), tmp_path)
    assert runtime.allocated_bytes() == before


class Fault(Exception):
    """Raised on purpose."""


def test_fields_of_a_build_that_failed_are_forgotten(taichi_cpu):
    """Declared, placed or neither, inside of what is open or by itself; what is built next has its own memory alone."""
    with Simulation(load(SEA)) as kept:
        before = runtime.allocated_bytes()
        with pytest.raises(Fault), runtime.Fields():
            placed, bare = ti.field(float, shape=1_000_000), ti.Vector.field(3, float)
            raise Fault
        with Simulation(load(SEA)) as following:
            assert runtime.allocated_bytes() < before + 1_000_000
            following.step()
        for field in (placed, bare.get_scalar_field(0)):
            with pytest.raises(RuntimeError, match="is closed"):
                field.to_numpy()
        kept.step()
        assert runtime.allocated_bytes() == before


TOO_LARGE = """
import resource, sys
from ocean_sim import runtime
from ocean_sim.kernel_library import ti

def fields(size):
    runtime.start(runtime.RuntimeConfig(threads=1))
    with runtime.Fields() as them:
        field = ti.field(float, shape=size)
    return them, field

first, ones = fields(4)
ones.fill(1.0)
resource.setrlimit(resource.RLIMIT_AS, (5 << 30, -1))
if sys.argv[1] == "closed":
    first.free()
for _ in range(3):
    for size in (1 << 30, 4000):
        try:
            them, field = fields(size)
        except (MemoryError, RuntimeError) as error:
            print(error)
        else:
            field.fill(1.0)
            print(field.to_numpy().sum())
            them.free()
    if sys.argv[1] == "open" and not first.freed:
        assert ones.to_numpy().sum() == 4.0
        first.free()
"""


@pytest.mark.skipif(sys.platform != "linux", reason="memory is bounded as Linux does it")
@pytest.mark.parametrize("before", ["closed", "open"])
def test_fields_that_no_memory_holds_are_told_in_a_sentence_and_leave_the_process_whole(before):
    """What is open goes on; others can be built once it is closed: Taichi would take the old sizes for theirs."""
    done = subprocess.run([sys.executable, "-c", TOO_LARGE, before], capture_output=True, text=True)
    lines = [line for line in done.stdout.splitlines() if line]
    assert done.returncode == 0 and done.stderr == "", done.stderr
    assert "there is no memory" in lines[0] and ("4000.0" if before == "closed" else "close those that") in lines[1]
    assert lines[2:] == [lines[0], "4000.0"] * 2


def in_another_thread(task):
    """What a task returns there, or raises."""
    with ThreadPoolExecutor(1) as other:
        return other.submit(task).result()


def stepped(simulation):
    for _ in range(2):
        simulation.step()
    return simulation.fluid.elevations(np.array([[1.0, 2.0]])).tobytes()


def built_and_stepped():
    with Simulation(load(SEA)) as simulation:
        return stepped(simulation)


def test_another_thread_builds_where_nothing_is_open_and_else_says_why_not():
    here = built_and_stepped()
    assert in_another_thread(built_and_stepped) == here
    with Simulation(load(SEA)) as kept:
        with pytest.raises(RuntimeError, match="in another thread of this process"):
            in_another_thread(built_and_stepped)
        with pytest.raises(RuntimeError, match="in another thread"):  # of which a part would be enough
            in_another_thread(runtime.Fields().__enter__)
        assert built_and_stepped() == here and stepped(kept) == here
    assert in_another_thread(built_and_stepped) == here == built_and_stepped()


def test_what_another_thread_has_stepped_is_closed_without_a_word(capfd):
    """Kernels that it compiles leave Taichi unable to give that memory back, which the next start does."""
    for _ in range(2):
        with Simulation(load(WATER)) as simulation:
            in_another_thread(simulation.step)
        assert not simulation.fluid.particles.n == 0 and "Assertion" not in capfd.readouterr().err
    runtime.start(runtime.RuntimeConfig(threads=1))
    assert runtime.allocated_bytes() == 0


@pytest.mark.slow
def test_more_fields_than_taichi_holds_are_no_end():
    """Without a fresh start, the 513th set of fields ends the process."""
    done = subprocess.run([sys.executable, "-c", MANY], capture_output=True, text=True)
    assert done.returncode == 0 and int(done.stdout) == 2, done.stderr
    never = MANY.replace("begun = set()", "begun = set()\nruntime.MAX_FIELD_SETS = 10_000")
    assert subprocess.run([sys.executable, "-c", never], capture_output=True).returncode < 0  # the negative control


def test_a_card_without_double_precision_says_what_it_cannot_do():
    """Taichi has f64 on Vulkan and Metal only where the driver has it."""
    scene = load({"basin": {"length": 1.0, "width": 1.0, "depth": 0.5}, "fluid": {"kind": "mueller", "spacing": 0.1}})
    single = runtime.Backend("metal", 0, "f32", doubles=False)
    with pytest.raises(
        runtime.BackendMissing, match="no double precision, in which accuracy, health of this scene would count"
    ):
        require_doubles(scene, single)
    bare = load({**scene.resolved(), "accuracy": None, "health": None})
    require_doubles(bare, single)
    with pytest.raises(runtime.BackendMissing, match=r"in which fluid\.kind of this scene"):
        require_doubles(load({**bare.resolved(), "fluid": {"kind": "dfsph", "spacing": 0.1}}), single)
    require_doubles(scene, runtime.Backend("cpu", 1, "f32"))


@runtime.in_kernels
class Adding:
    """Kernels that are launched again and again."""

    def __init__(self, start: float) -> None:
        self.start = start

    @ti.kernel
    def add(self, to: runtime.Array, number: float, times: int):
        for k in range(to.shape[0]):
            to[k] += times * number + self.start

    @ti.kernel
    def add_exactly(self, to: runtime.Array, number: ti.f64):
        to[0] += number

    @ti.kernel
    def add_another(self, to: runtime.Array, other: runtime.Template):
        to[0] += other.start

    @ti.kernel
    def answered(self, number: float) -> float:
        return number + self.start


def test_a_kernel_launched_again_takes_what_it_is_given_now(taichi_cpu):
    """Owners, numbers, arrays of any length, type and layout, and templates: nothing of an earlier launch is left."""
    one, ten = Adding(1.0), Adding(10.0)
    for _ in range(3):
        for kind in (np.float32, np.float64):
            for length in (2, 5):
                to = np.zeros(length, dtype=kind)
                one.add(to, 0.5, 4)
                ten.add(to, 0.25, np.int32(2))
                assert (to == 3.0 + 10.5).all()
        spread = np.zeros((4, 2))[:, 0]
        with pytest.raises(ValueError, match="contiguous"):
            one.add(spread, 0.5, 4)
        to = np.zeros(1)
        one.add_another(to, ten)
        one.add_another(to, one)
        assert to[0] == 11.0
        one.add_exactly(to, 1.0e-12)
        one.add_exactly(to, 1.0e-12)
        assert to[0] - 11.0 == pytest.approx(2.0e-12, rel=1e-3)
        assert one.answered(2.0) == 3.0 and ten.answered(2.0) == 12.0


def test_the_number_of_kept_launches_does_not_grow_with_launches(taichi_cpu):
    adding = Adding(1.0)
    for length in range(1, 30):
        adding.add(np.zeros(length), 1.0, 1)
    assert [len(kept) for kept in runtime._launches[adding].values()] == [1]


AFFINITIES = """
import os, sys
from ocean_sim import runtime

pins = {"null": None, "true": True, "false": False}
runtime.start(runtime.RuntimeConfig(threads=2, pin=pins[sys.argv[1]]))
threads = sorted(int(thread) for thread in os.listdir("/proc/self/task"))
print([sorted(os.sched_getaffinity(thread)) for thread in threads[-2:]])
"""


@pytest.mark.skipif(
    sys.platform != "linux" or available_cores() < 2, reason="workers are bound on Linux, to several cores"
)
@pytest.mark.parametrize("pin", ["null", "true", "false"])
def test_two_workers_have_no_core_in_common_unless_they_may_go_anywhere(pin):
    """Woken for a short time on a core that both may use, they take turns on it while another is idle."""
    done = subprocess.run([sys.executable, "-c", AFFINITIES, pin], capture_output=True, text=True, check=True)
    one, other = (set(there) for there in json.loads(done.stdout))
    usable = os.sched_getaffinity(0)
    if pin == "false":
        assert one == other == usable
    else:
        assert not one & other
        assert one | other == usable if pin == "null" else len(one) == len(other) == 1
