"""The only module that starts Taichi: backend, precision, threads, and where compiled kernels are kept."""

import os
import re
import shutil
import sys
import tempfile
import threading
import time
import weakref
from collections.abc import Callable
from contextlib import chdir, redirect_stdout, suppress
from dataclasses import dataclass
from functools import wraps
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias, TypeVar

import numpy as np

from ocean_sim import kernel_library
from ocean_sim.conventions import Lacking
from ocean_sim.kernel_library import FieldsBuilder, SNodeTree, impl, ti, to_numpy_type
from ocean_sim.machine import available_cores, kernel_cache
from ocean_sim.model import Model, quantity

TAICHI_BACKENDS = {name: getattr(ti, name) for name in ("cpu", "cuda", "vulkan", "metal", "gpu")} | {"auto": ti.gpu}
BASE_MEMORY, COPY_BYTES_PER_PARTICLE = 160_000_000, 100  # [bytes], [bytes a particle]
MAX_FIELD_SETS = 512  # sets of fields that Taichi 1.7 holds; it crashes beyond
FIELD_SET_MARGIN = 128  # sets of fields of one simulation, at most
OPTIMISE_VARIABLE = "OCEAN_SIM_OPTIMISE"  # where it is "0", kernels compile sooner and run slower: for tests
CACHE_SIZE = 1 << 30  # [bytes] of compiled kernels kept, the least recently used given up
# Without the last, Taichi 1.7.4 reads a field once before a serial loop that writes it, and not again in each turn.
UNOPTIMISED_OPTIONS = {"opt_level": 0, "cfg_optimization": False, "cache_loop_invariant_global_vars": False}
UNUSED_CACHE_AGE = 30 * 86_400.0  # [s] after which the kernels of another copy of the program are removed
STALE_LOCK_AGE = 30.0  # [s] that a process may keep the kernel cache locked; it takes well under a second
FREEING_BACKENDS = ("cpu", "cuda", "vulkan")  # backends on which Taichi 1.7 can give the memory of fields back
GRAPHICS_CARD_CHOICES = ("cuda", "vulkan", "metal", "gpu")  # what one asks for to have a graphics card
OPTIONAL_DOUBLES = ("vulkan", "metal")  # backends on which Taichi 1.7 has f64 only where the driver has
GRAPHICS_BACKENDS = ("cuda", "vulkan", "metal", "opengl", "gles")


if TYPE_CHECKING:  # what a kernel is handed, as callers see it
    Array: TypeAlias = np.ndarray
    Array2: TypeAlias = np.ndarray
    Integers: TypeAlias = np.ndarray
    Doubles2: TypeAlias = np.ndarray
    Doubles3: TypeAlias = np.ndarray
    Template: TypeAlias = Any
else:  # and as Taichi reads it
    Array, Array2 = ti.types.ndarray(ndim=1), ti.types.ndarray(ndim=2)
    Integers = ti.types.ndarray(dtype=ti.i32, ndim=1)
    Doubles2, Doubles3 = ti.types.ndarray(dtype=ti.f64, ndim=2), ti.types.ndarray(dtype=ti.f64, ndim=3)
    Template = ti.template()


Kind = TypeVar("Kind", bound=type)


def in_kernels(kind: Kind) -> Kind:
    """Decorate a class `kind` with Taichi kernels or functions, in place of `ti.data_oriented`, which slows all access
    to attributes; kernels skip Taichi's look-ups from their second launch on."""
    if kernel_library.LIBRARY_NAME == kernel_library.QUADRANTS:
        if "__dataclass_fields__" in vars(kind):  # by which it would take `self` for a struct, handed over by value
            del kind.__dataclass_fields__  # type: ignore[attr-defined]
        return ti.data_oriented(kind)  # which has no such cost
    kind._data_oriented = True  # type: ignore[attr-defined]
    for name, kernel in list(vars(kind).items()):
        if hasattr(kernel, "_is_wrapped_kernel"):
            setattr(kind, name, _direct_launch(kernel))
    return kind


def _direct_launch(kernel: Any) -> Any:
    """Wrap a Taichi kernel in a method that from its second launch on skips Taichi's look-ups (0.2 to 1 ms a step)."""

    @wraps(kernel)
    def launch(self: Any, *given: Any) -> Any:
        launches = _launches.get(self)
        if launches is None:
            launches = _launches[self] = {}
        for known in launches.get(kernel, ()):
            if known.suits(given):
                return known(given)
        try:
            result = kernel._primal(self, *given)
        except ti.TaichiCompilationError as error:  # which quotes what Freed says among lines of the kernel
            why = next((why for why in (CLOSED_MESSAGE, RESTARTED_MESSAGE) if why in str(error)), None)
            if why is None:
                raise
            raise RuntimeError(why) from None
        made = _launch_of(kernel._primal, self, given)
        if made is not None:
            launches.setdefault(kernel, []).append(made)
        return result

    return launch


@dataclass(frozen=True)
class Launch:
    """Compiled kernel, launched directly, without the look-ups of Taichi. Entries of `templates`, `numbers` and
    `arrays` begin with an argument's index in the call; in numbers and arrays (k,) follows, its index among both."""

    program: Any  # of Taichi
    compiled: Any  # Taichi's compiled kernel data
    kernel: Any
    templates: list[tuple[int, Any]]  # a weak reference to each
    numbers: list[tuple[int, tuple[int], bool]]  # True for a whole number
    arrays: list[tuple[int, tuple[int], np.dtype, int]]  # type and number of axes

    def suits(self, given: tuple) -> bool:
        """True if the kernel was compiled for arguments like these: equal templates, types and numbers of axes."""
        for k, same in self.templates:
            if given[k] is not same():
                return False
        for k, _, dtype, ndim in self.arrays:
            array = given[k]
            if array.dtype != dtype or array.ndim != ndim or not array.flags.c_contiguous:
                return False
        return True

    def __call__(self, given: tuple) -> None:
        """Launch the compiled kernel with the arguments `given` in a call, for which `suits` must be true."""
        context = self.kernel.make_launch_context()
        for k, slot, whole in self.numbers:
            if whole:
                context.set_arg_int(slot, int(given[k]))
            else:
                context.set_arg_float(slot, float(given[k]))
        for k, slot, _, _ in self.arrays:
            array = given[k]
            context.set_arg_external_array_with_shape(slot, array.ctypes.data, array.nbytes, array.shape, 0)
        self.program.launch_kernel(self.compiled, context)


def _launch_of(primal: Any, owner: Any, given: tuple) -> Launch | None:
    """`Launch`, without look-ups, of Taichi's kernel `primal`, just run by `owner` with `given`; None if impossible."""
    if primal.return_type is not None or primal.has_print:
        return None
    templates, numbers, arrays = list[Any](), list[Any](), list[Any]()
    for k, (argument, value) in enumerate(zip(primal.arguments[1:], given, strict=True)):
        needed, slot = argument.annotation, (len(numbers) + len(arrays),)
        if isinstance(needed, ti.template):
            try:
                templates.append((k, weakref.ref(value)))
            except TypeError:  # a number or a name
                return None
        elif isinstance(needed, ti.types.ndarray):
            if not isinstance(value, np.ndarray) or not value.flags.c_contiguous:
                return None
            arrays.append((k, slot, value.dtype, value.ndim))
        elif needed in (float, int, ti.f32, ti.f64):
            numbers.append((k, slot, needed is int))
        else:
            return None
    program = impl.get_runtime().prog
    kernel = primal.compiled_kernels[primal.ensure_compiled(owner, *given)]
    compiled = program.compile_kernel(program.config(), program.get_device_caps(), kernel)
    return Launch(program, compiled, kernel, templates, numbers, arrays)


@in_kernels
class FieldCopy:
    """Reader of a scalar Taichi field into a NumPy array by a kernel, many times as fast as Taichi's own method."""

    def __init__(self, field: Any) -> None:
        self.field = field

    def values(self) -> np.ndarray:
        """Present values (n,) of the field, in its precision."""
        found: np.ndarray = np.empty(self.field.shape, dtype=to_numpy_type(self.field.dtype))
        self.fill(found)
        return found

    @ti.kernel
    def fill(self, values: Array):  # type: ignore[no-untyped-def]
        ti.loop_config(serialize=ti.static(runs_alone()))
        for i in self.field:
            values[i] = self.field[i]


class BackendMissing(Lacking):
    """Error: this machine lacks the backend, or a property of it such as double precision, that was asked for."""


class RuntimeConfig(Model):
    """Settings of a run's use of the machine: backend, precision, threads."""

    arch: Literal["cpu", "cuda", "vulkan", "metal", "gpu", "auto"] = "cpu"
    """Taichi backend; `cpu`: the processor, `cuda`: NVIDIA, `metal`: Apple, `vulkan`: most graphics processors, `gpu`:
    any of them, `auto`: one if there is one, else the processor."""
    precision: Literal["f32", "f64"] = "f32"
    """Floating-point precision of particles and kernels; `f32`: 7 digits, `f64`: 16, slower."""
    threads: int | None = quantity("threads", None, ge=1, le=1024)
    """Worker threads on the processor; null: all cores this process may use."""
    library: Literal["taichi", "quadrants"] | None = None
    """Compiler of the kernels: `taichi`, or its fork `quadrants` where it is installed, for which from Python
    OCEAN_SIM_LIBRARY=quadrants has to be set; null: the library of the process, by default Taichi."""
    pin: bool | None = None
    """Cores of each worker thread (Linux); null: on cores of its own, shared out among the threads, `true`: on one
    core, for steadier timings, `false`: on any core, so that two threads often share one for a while."""


@dataclass(frozen=True)
class Backend:
    """Taichi backend that was obtained: its name, threads (0 on a GPU), precision, and support of doubles."""

    arch: str
    threads: int
    precision: str
    doubles: bool = True  # whether it has double precision


_launches: "weakref.WeakKeyDictionary[Any, dict[Any, list[Launch]]]" = weakref.WeakKeyDictionary()  # by owner
_started: tuple[RuntimeConfig, Backend] | None = None
_allocations: list["Allocation"] = []  # the sets of fields that take memory now, in the order they were made
_open: "weakref.WeakSet[Fields]" = weakref.WeakSet()  # those that are not freed
_numbered = False  # whether Taichi has given numbers to fields since it was started
_short = False  # whether memory ran out: Taichi takes the sizes of those fields for those of the next ones
_thread = 0  # the thread that started Taichi, and which alone can give memory to fields
_starting = threading.RLock()  # held while Taichi changes its thread


class Allocation(NamedTuple):
    """A set of fields to which Taichi has given memory in one call."""

    tree: SNodeTree
    variables: list[Any]  # the expressions by which its fields are known

    def forget(self, why: str) -> None:
        """Replace the fields of this set by stubs that raise RuntimeError with the reason `why`."""
        for variable in self.variables:
            variable.ptr = FreedField(why)


def _record_allocation(finalize: Any) -> Any:
    """Wrap `finalize`, Taichi's method that allocates declared fields, so that the handle which frees them is kept."""

    def noted(builder: FieldsBuilder, raise_warning: bool = True) -> SNodeTree:
        global _numbered, _short
        variables = [*impl.get_runtime().global_vars]
        _numbered = True
        try:
            tree = finalize(builder, raise_warning)
        except RuntimeError as error:
            if not re.search("alloc|out of memory", str(error), re.IGNORECASE):
                raise
            _short = True
            raise MemoryError(NO_MEMORY_MESSAGE) from None
        _allocations.append(Allocation(tree, variables))
        return tree

    return noted


FieldsBuilder.finalize = _record_allocation(FieldsBuilder.finalize)


NO_MEMORY_MESSAGE = "there is no memory for the fields of this simulation; try a larger resolution, or fewer particles"
CLOSED_MESSAGE = "this field belongs to a simulation that is closed; read it before, inside its `with` block"
RESTARTED_CAUSE = "a later one restarted Taichi, because its runtime differs or about a hundred were open"
RESTARTED_MESSAGE = f"the fields of this simulation are gone: {RESTARTED_CAUSE}; close each before starting others"
MEMORY_SHORT_MESSAGE = "memory ran out for a simulation, and Taichi builds no other now; close those that are open"
OTHER_THREAD_MESSAGE = (
    "Taichi runs in another thread of this process, where a simulation is open, and builds others only there; close "
    "that one first, build all in one thread, or run each in a process of its own"
)


class FreedField:
    """Stub for a field whose memory is freed: any use raises RuntimeError with the reason."""

    def __init__(self, why: str) -> None:
        self.why = why

    def __getattr__(self, name: str) -> Any:
        raise RuntimeError(self.why)


class Fields:
    """Owner of the Taichi fields that are declared inside its `with` block; an error in the block frees them."""

    def __init__(self) -> None:
        self.allocations: list[Allocation] = []
        self.freed = False

    def __enter__(self) -> "Fields":
        """Begin the block: fields declared from here on belong to this owner, which frees them. Raises RuntimeError in
        a thread other than the one that started Taichi."""
        with _starting:
            if threading.get_ident() != _thread:
                raise RuntimeError(OTHER_THREAD_MESSAGE)
            self.allocate()
            self.first = len(_allocations)
            _open.add(self)
        return self

    def __exit__(self, kind: type[BaseException] | None, *rest: object) -> None:
        """Give memory to the fields declared in the block, or drop and free them after an error."""
        built = False
        try:
            if kind is None:
                self.allocate()
                built = True
        finally:
            self.allocations = _allocations[self.first :]
            if not built:
                self.free()
                _forget_declared()

    def allocate(self) -> None:
        """Give memory to the fields declared so far."""
        if not ti.root.empty:
            impl.get_runtime().materialize()

    def free(self) -> None:
        """Free the memory of these fields. Taichi's `SNodeTree.destroy` is not used: it would also forget the compiled
        kernels of all other simulations. Kernels can be called only through the objects that own the fields."""
        self.freed = True
        _open.discard(self)
        program = impl.get_runtime().prog
        there = [one for one in self.allocations if one in _allocations]  # none where Taichi has been restarted since
        if there and _started is not None and _started[1].arch in FREEING_BACKENDS:
            program.synchronize()  # a GPU may still be at work
            for one in there:
                _allocations.remove(one)
                with suppress(RuntimeError):  # after kernels of another thread; the next start frees it
                    one.tree.ptr.destroy_snode_tree(program)
        for one in self.allocations:
            one.forget(CLOSED_MESSAGE)
        self.allocations = []


def _forget_declared() -> None:
    """Drop declared fields that have no memory yet; else Taichi would allocate them together with the next ones."""
    taichi = impl.get_runtime()
    for variable in taichi.global_vars:
        variable.ptr = FreedField(CLOSED_MESSAGE)
    for waiting in (taichi.global_vars, taichi.grad_vars, taichi.dual_vars, taichi.matrix_fields):
        waiting.clear()
    taichi.unfinalized_fields_builder.clear()
    impl._root_fb = FieldsBuilder()


def start(config: RuntimeConfig) -> Backend:
    """Start Taichi and return its backend; if one is running that suits the config, keep it. A restart loses all
    fields. Raises BackendMissing if the backend obtained is not the one asked for, and RuntimeError if a simulation of
    another thread is open, or any at all after memory ran out."""
    with _starting:
        if _open and (_short or threading.get_ident() != _thread):
            raise RuntimeError(MEMORY_SHORT_MESSAGE if _short else OTHER_THREAD_MESSAGE)
        if _started is not None and not must_restart(config):
            return _started[1]
        return _start(config)


def _start(config: RuntimeConfig) -> Backend:
    """Start Taichi with this config, and forget all fields; raises BackendMissing as `start` does."""
    global _started, _numbered, _short, _thread
    if config.library not in (None, kernel_library.LIBRARY_NAME):
        raise BackendMissing(
            f"runtime.library: {config.library} was chosen, but this process already computes with "
            f"{kernel_library.LIBRARY_NAME}; set {kernel_library.LIBRARY_VARIABLE}={config.library} before it starts, "
            "or leave the key out"
        )
    if kernel_library.LIBRARY_NAME == kernel_library.TAICHI:
        from ocean_sim.kernel_library import reading

        reading.install()
    _started, _numbered, _short, _thread = None, False, False, threading.get_ident()
    threads = config.threads or available_cores()
    before = _thread_ids()
    for one in _allocations:
        one.forget(RESTARTED_MESSAGE)
    _allocations.clear()
    _open.clear()
    _launches.clear()
    with redirect_stdout(StringIO()):  # Taichi announces itself
        ti.init(
            arch=TAICHI_BACKENDS[config.arch],
            default_fp=ti.f64 if config.precision == "f64" else ti.f32,
            cpu_max_num_threads=threads,
            offline_cache=True,
            offline_cache_file_path=str(_kernel_cache()),
            offline_cache_max_size_of_files=CACHE_SIZE,
            log_level=ti.CRITICAL,  # an error is raised, and not printed as well
            **(UNOPTIMISED_OPTIONS if os.environ.get(OPTIMISE_VARIABLE) == "0" else {}),
        )
    obtained = impl.current_cfg().arch.name
    arch = obtained if obtained in GRAPHICS_BACKENDS else "cpu"
    if config.arch not in (arch, "auto") and not (config.arch == "gpu" and arch != "cpu"):
        ti.reset()
        begin = f"runtime.arch: {config.arch} was asked for, but this machine gave {arch}; set runtime.arch=cpu,"
        raise BackendMissing(f"{begin} or auto to take what there is (`ocean-sim doctor` lists it)")
    if config.pin is not False and arch == "cpu":
        _pin_threads(before, threads, one=bool(config.pin))
    _started = (config, Backend(arch, threads if arch == "cpu" else 0, config.precision, _has_doubles(arch)))
    return _started[1]


def _has_doubles(arch: str) -> bool:
    """True if the started backend has double precision, tried by a kernel: for Vulkan and Metal the driver decides."""
    if arch not in OPTIONAL_DOUBLES:
        return True

    @ti.kernel
    def halved(x: float) -> float:
        return ti.cast(0.5 * ti.cast(x, ti.f64), float)

    try:
        return bool(halved(1.0) == 0.5)
    except RuntimeError:
        return False


def vector_width() -> int:
    """Number of f32 lanes that kernels use on this processor, from the LLVM code of a sum; restarts Taichi."""
    with tempfile.TemporaryDirectory() as folder, chdir(folder):  # where the library puts what it prints
        with redirect_stdout(StringIO()):
            ti.init(arch=ti.cpu, offline_cache=False, print_kernel_llvm_ir_optimized=True, log_level=ti.ERROR)
        summed = ti.field(ti.f32, 1024)

        @ti.kernel
        def total() -> float:
            found = 0.0
            ti.loop_config(serialize=True)
            for k in range(1024):
                found += summed[k] * summed[k]
            return found

        total()
        made = "".join(path.read_text() for path in Path().glob("*.ll"))
    return max((int(n) for n in re.findall(r"<(\d+) x float>", made)), default=1)


def values_at(points: np.ndarray, real: type, fill: Callable[..., Any], *size: int) -> np.ndarray:
    """Values (m, *size) at points (m, ...), computed by the kernel `fill(points, values)` in the precision `real`."""
    values: np.ndarray = np.empty((len(points), *size), dtype=real)
    fill(np.ascontiguousarray(points, dtype=real), values)
    return values.astype(float)


def running_arch() -> str:
    """Name of the running backend: `cpu`, `cuda`, `vulkan` or `metal`; `cpu` before any runs."""
    return _started[1].arch if _started is not None else "cpu"


def runs_alone() -> bool:
    """True if kernels should run short loops in the launching thread: on a processor waking others takes 7 us."""
    return running_arch() == "cpu"


def must_restart(config: RuntimeConfig) -> bool:
    """True if `start` has to restart Taichi: for another config or thread, for too many fields, or if all are freed,
    since kernels are cached by field numbers, which only a restart resets."""
    if _started is None:
        return False
    full = impl.get_runtime().prog.get_snode_tree_size() > MAX_FIELD_SETS - FIELD_SET_MARGIN
    spent = _numbered and not _allocations and not _open and ti.root.empty
    return _started[0] != config or threading.get_ident() != _thread or full or spent


def require_running(backend: Backend) -> None:
    """Raise RuntimeError if Taichi has been restarted since it returned this backend."""
    if _started is None or _started[1] is not backend:
        raise RuntimeError(RESTARTED_MESSAGE)


def base_memory(particles: int) -> int:
    """Bytes that a run takes besides its fields, measured on Linux: interpreter, libraries, compiler, NumPy copies."""
    return BASE_MEMORY + COPY_BYTES_PER_PARTICLE * particles


def compiled_kernels() -> list[str]:
    """Names of the Taichi kernels that this process has compiled or loaded so far."""
    return sorted({kernel.func.__qualname__ for kernel in impl.get_runtime().kernels if kernel.compiled_kernels})


def kernels_in(module: str) -> list[str]:
    """Names of the Taichi kernels in a module, in modules of the same folder that it imports, and in `runtime`."""
    room, found = module.rpartition(".")[0], set()
    waiting, seen = [module], set()
    while waiting:
        name = waiting.pop()
        seen.add(name)
        for thing in vars(sys.modules[name]).values():
            home = str(getattr(thing, "__module__", ""))
            if home.startswith(f"{room}.") and home not in seen and home in sys.modules:
                waiting.append(home)
            if isinstance(thing, type) and home in (name, __name__):
                kernels = [key for key, law in vars(thing).items() if hasattr(law, "_is_wrapped_kernel")]
                found |= {f"{thing.__qualname__}.{key}" for key in kernels}
    return sorted(found)


def allocated_bytes() -> int:
    """Bytes of all Taichi fields that are allocated now."""
    program = impl.get_runtime().prog
    return sum(program.get_snode_root(one.tree.id).cell_size_bytes for one in _allocations)


def _kernel_cache() -> Path:
    """Folder of compiled kernels, created if missing, without a stale lock; raises BackendMissing if not writable."""
    path = kernel_cache()
    try:
        if not path.is_dir():
            path.mkdir(parents=True, exist_ok=True)
            for other in path.parent.iterdir():  # kernels of copies of the program that have not run for long
                with suppress(OSError):
                    if time.time() - other.stat().st_mtime > UNUSED_CACHE_AGE:
                        shutil.rmtree(other) if other.is_dir() else other.unlink()
        os.utime(path)
    except OSError as error:
        raise BackendMissing(f"the kernel cache {path} cannot be written: {error}; set XDG_CACHE_HOME") from error
    # Of a process that was killed Taichi would wait for the lock for ever, compiling everything anew without a word.
    lock = path / "ticache.lock"
    with suppress(OSError):  # there is none, or another process has removed it
        if time.time() - lock.stat().st_mtime > STALE_LOCK_AGE:
            lock.unlink()
    return path


def _thread_ids() -> set[int]:
    """Ids of the threads of this process; empty on systems other than Linux."""
    return {int(t) for t in os.listdir("/proc/self/task")} if sys.platform == "linux" else set()


def _pin_threads(before: set[int], threads: int, one: bool) -> None:
    """Bind each of Taichi's worker threads (ids not in `before`) to cores of its own, or (`one`) to a single one."""
    usable = sorted(os.sched_getaffinity(0)) if sys.platform == "linux" else []
    workers = sorted(_thread_ids() - before)[-threads:] if usable else []
    for k, worker in enumerate(workers):
        own = usable[k::threads] or [usable[k % len(usable)]]
        with suppress(ProcessLookupError):  # it has ended meanwhile
            os.sched_setaffinity(worker, own[:1] if one else own)
