"""The arrows of the architecture, read from the source: who may know whom, and who alone may do what."""

import ast
import json
import subprocess
import sys
from functools import cache

import pytest

from ocean_sim.parts import PACKAGE, SLOTS

ROOMS = (*SLOTS, "observers")
FOUNDATION = (
    "conventions",
    "model",
    "parts",
    "columns",
    "kernel_library",
    "runtime",
    "machine",
    "random_numbers",
    "palette",
    "files",
    "waves",
    "basin",
)
OPEN = ("motion_log", "datagrams", "packets", "track")  # of platform.shared and ship.body: what those who write and
# read motion logs use, too


@cache
def sources() -> dict[str, ast.Module]:
    """The source of every module, by name; read when a test asks, not in every process that collects tests."""
    paths = sorted(PACKAGE.rglob("*.py"))
    names = [
        ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__") for path in paths
    ]
    return {name: ast.parse(path.read_text(encoding="utf-8")) for name, path in zip(names, paths)}


def is_only_for_types(node: ast.If) -> bool:
    return isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"


def walked(node: ast.AST):
    """Every node but what is imported for type checkers alone."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.If) and is_only_for_types(child):
            continue
        yield child
        yield from walked(child)


@cache
def every(module: str) -> tuple[ast.AST, ...]:
    """Every node of a module: walking takes long, and many tests ask."""
    return tuple(ast.walk(sources()[module]))


@cache
def nodes(module: str) -> tuple[ast.AST, ...]:
    """The same but what is imported for type checkers alone."""
    return tuple(walked(sources()[module]))


@cache
def imports(module: str) -> set[str]:
    """What a module imports, here and inside its functions; `from a import b` counts as a.b where that is a module."""
    found = set()
    for node in nodes(module):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            inner = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= {name for name in inner if name in sources()} or {str(node.module)}
    return found


def ours(module: str) -> set[str]:
    return {name for name in imports(module) if name.split(".")[0] == "ocean_sim"}


def room(module: str) -> str:
    """The slot, or `observers`, or another part of the package that a module is in."""
    return module.removeprefix("ocean_sim").removeprefix(".").split(".")[0]


def is_kind(module: str) -> bool:
    """Whether a module is in a room, and not its protocol."""
    return room(module) in ROOMS and module.count(".") > 1 and module.split(".")[-1] not in OPEN


@cache
def calls(module: str) -> set[str]:
    """What a module calls, as it is written: `ti.init`, `open`, `.write_text` where the owner is an expression."""
    return {ast.unparse(node.func) for node in nodes(module) if isinstance(node, ast.Call)}


def modules(*rooms: str) -> list[str]:
    return [name for name in sources() if room(name) in rooms]


def test_there_is_something_to_look_at():
    assert {"ocean_sim.reading.scene", "ocean_sim.simulation", "ocean_sim.wind", "ocean_sim.wind.gusts"} <= set(
        sources()
    )
    assert "ocean_sim.wind" in imports("ocean_sim.fluid.mueller") and "ocean_sim.kernel_library" in imports(
        "ocean_sim.wind.gusts"
    )


@pytest.mark.parametrize("slot", SLOTS)
def test_slots_know_each_other_by_protocol_only_and_read_upstream_only(slot):
    upstream = {"wind": (), "fluid": ("wind",), "surface": ("wind", "fluid"), "ship": ("wind", "fluid", "surface")}
    upstream |= {"platform": ("wind", "fluid", "surface", "ship"), "time_step": ("fluid",)}
    for module in modules(slot):
        for other in ours(module):
            if room(other) in SLOTS and room(other) != slot:
                assert not is_kind(other), f"{module} knows a kind of another slot: {other}"
                assert room(other) in upstream[slot], f"{module} reads downstream: {other}"
            else:
                assert room(other) in (*FOUNDATION, slot), f"{module} imports {other}"


def test_kinds_do_not_know_each_other():
    """But for the still wind, which is handed to a body that a wind does not reach."""
    for module in modules(*SLOTS, "observers"):
        siblings = {name for name in ours(module) if is_kind(name) and room(name) == room(module)}
        kinds = {name for name in siblings if name.count(".") == 2}
        assert kinds <= {"ocean_sim.wind.still"}, f"{module} imports the kinds {kinds}"


def test_the_foundation_knows_no_room():
    for module in modules(*FOUNDATION):
        for other in ours(module):
            assert room(other) in FOUNDATION, f"{module} imports {other}"


def test_simulation_imports_no_kind_and_no_scene():
    assert not [name for name in ours("ocean_sim.simulation") if is_kind(name)]
    assert "ocean_sim.reading.scene" not in ours("ocean_sim.simulation")


def test_scene_and_what_composes_it_import_no_kind():
    for module in modules("reading"):
        assert not [name for name in ours(module) if is_kind(name)], module


def test_only_the_command_line_imports_observers():
    """But for the page, which shares what they share."""
    for module in sources():
        if room(module) == "viewer":
            kinds = [name for name in ours(module) if is_kind(name) and room(name) == "observers"]
            assert all(name.startswith("ocean_sim.observers.shared.") for name in kinds), module
        elif room(module) not in ("observers", "verbs", "__main__"):
            assert not [name for name in ours(module) if is_kind(name) and room(name) == "observers"], module


def test_validation_reads_scene_and_simulation_and_only_what_stands_above_reads_it():
    """scene <- validation <- studies <- figures <- __main__."""
    above = ("validation", "studies", "figures", "verbs", "__main__")
    for module in sources():
        if room(module) == "validation":
            for other in ours(module):
                assert room(other) in (*FOUNDATION, "reading", "simulation", "fluid", "validation"), (
                    f"{module} imports {other}"
                )
        elif room(module) not in above:
            assert not [name for name in ours(module) if room(name) == "validation"], module


def test_studies_read_validation_and_what_stands_below_it():
    below = (*FOUNDATION, "reading", "simulation", "result", "fluid", "time_step", "validation", "studies")
    for module in modules("studies"):
        for other in ours(module):
            assert room(other) in below and not is_kind(other), f"{module} imports {other}"


def test_nothing_below_it_knows_the_command_line():
    for module in sources():
        if room(module) not in ("verbs", "__main__"):
            assert not [name for name in ours(module) if room(name) in ("verbs", "__main__")], module
            assert not imports(module) & {"typer", "rich"}, module


def test_observers_read_the_simulation_and_import_no_kind_of_a_slot():
    for module in modules("observers"):
        for other in ours(module):
            assert not (is_kind(other) and room(other) in SLOTS), f"{module} imports {other}"


def test_the_page_reads_the_simulation_and_imports_no_kind_of_a_slot():
    for module in modules("viewer"):
        assert not [name for name in ours(module) if is_kind(name) and room(name) in SLOTS], module
        assert "ocean_sim.kernel_library" not in imports(module), module


@pytest.mark.parametrize(
    "call, allowed",
    [
        ("ti.init", {"ocean_sim.runtime"}),
        ("ti.reset", {"ocean_sim.runtime"}),
        ("ti.random", set()),
        ("ti.randn", set()),
        ("np.random.rand", set()),
        ("np.random.seed", set()),
    ],
)
def test_who_alone_may_call(call, allowed):
    assert {module for module in sources() if call in calls(module)} <= allowed


def test_classes_of_kernels_are_marked_by_our_own_decorator():
    for module in sources():
        classes = [node for node in nodes(module) if isinstance(node, ast.ClassDef)]
        assert "ti.data_oriented" not in {ast.unparse(mark) for one in classes for mark in one.decorator_list}, module


@pytest.mark.parametrize(
    "package, allowed",
    [
        ("yaml", {"ocean_sim.files.yaml_file"}),
        ("random", set()),
        ("aiohttp", {"ocean_sim.viewer.server"}),
        ("pyvista", {"ocean_sim.pictures.stage.plotter", "ocean_sim.pictures.export.paraview"}),
        ("vtkmodules", {"ocean_sim.pictures.water.water_glsl", "ocean_sim.pictures.ships.ship"}),
        ("vtk", set()),
        ("imageio", {"ocean_sim.observers.render"}),
        ("imageio_ffmpeg", {"ocean_sim.observers.render"}),
    ],
)
def test_who_alone_may_import(package, allowed):
    found = {module for module in sources() if any(name.split(".")[0] == package for name in imports(module))}
    assert found <= allowed


@pytest.mark.parametrize("package", ["pyvista", "imageio", "matplotlib", "h5py", "scipy", "vtk", "trimesh"])
def test_what_is_slow_to_import_is_imported_where_it_is_used(package):
    for module, tree in sources().items():
        names = [
            alias.name if isinstance(node, ast.Import) else node.module
            for node in tree.body
            if isinstance(node, ast.Import | ast.ImportFrom)
            for alias in node.names
        ]
        assert not [name for name in names if str(name).split(".")[0] == package], module


def test_timings_is_the_only_one_with_a_clock():
    """But for checkpoints, which may be due by the clock, though what they hold is not, and datagrams, sent by it."""
    for module in modules(*SLOTS, "observers", "simulation", "basin", "reading"):
        if module.split(".")[-1] not in ("timings", "checkpoint", "datagrams"):
            assert not imports(module) & {"time", "datetime"}, module


def test_during_a_run_only_observers_write():
    writing = ("write_text", "write_bytes", "mkdir", "unlink", "savez", "savez_compressed", "savetxt", "to_csv", "dump")
    for module in modules(*SLOTS, "simulation", "basin", "random_numbers", "parts", "reading"):
        written = [call for call in calls(module) if call.split(".")[-1] in (*writing, "open")]
        assert not written, f"{module} calls {written}"


def test_one_module_alone_imports_what_compiles_kernels():
    """So that a scene may be computed with another library than Taichi."""
    for module in sources():
        libraries = {name for name in imports(module) if name.split(".")[0] in ("taichi", "quadrants")}
        assert not libraries or module == "ocean_sim.kernel_library", f"{module} imports {libraries}"


def test_modules_with_taichi_kernels_keep_their_annotations():
    for module in sources():
        if "ocean_sim.kernel_library" in imports(module):
            assert "__future__" not in imports(module), module


PROBE = """
import json, linecache, sys
from ocean_sim import runtime
from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation
basin = {"length": 40.0, "width": 40.0, "depth": 7.5}
scene = {"basin": basin, "fluid": {"kind": "mueller", "spacing": 1.25}, "wind": "wide"}
config = load(scene, {"runtime.threads": 1})
with Simulation(config) as simulation:
    simulation.run(0.5 * simulation.next_dt)
    facts = {
        "modules": sorted(name for name in sys.modules if name.startswith("ocean_sim.")),
        "slow": sorted({"pyvista", "matplotlib", "scipy", "h5py", "imageio", "rich", "typer"} & set(sys.modules)),
        "servers": sorted({"ssl", "urllib.request", "http.client"} & set(sys.modules)),
        "read": sorted(name.rpartition("ocean_sim/")[2] for name in linecache.cache if "ocean_sim/" in name),
        "allocated": runtime.allocated_bytes(),
        "ledger": sum(row.bytes for row in config.ledger() if row.part != "render"),
        "kernels": runtime.compiled_kernels(),
    }
print(json.dumps(facts))
"""


@pytest.fixture(scope="module")
def without_a_ship(tmp_path_factory) -> dict:
    """A scene without a ship, stepped in a process of its own: what it imported, allocated and compiled."""
    child = subprocess.run(
        [sys.executable, "-c", PROBE], capture_output=True, text=True, check=False, cwd=tmp_path_factory.mktemp("empty")
    )
    assert child.returncode == 0, child.stderr
    return json.loads(child.stdout.splitlines()[-1])


def test_a_scene_without_a_ship_imports_no_ship(without_a_ship):
    absent = [name for name in without_a_ship["modules"] if room(name) in ("ship", "surface", "platform")]
    assert not [name for name in absent if is_kind(name)]
    assert "ocean_sim.fluid.ballistic" not in without_a_ship["modules"]
    assert "ocean_sim.wind.vortex" not in without_a_ship["modules"]
    assert without_a_ship["slow"] == []
    assert without_a_ship["servers"] == []  # Taichi alone imports all of these


def test_no_source_is_read_but_that_of_kernels(without_a_ship):
    """What a key means is read where that is asked for, not for every model that is made."""
    assert "fluid/mueller.py" in without_a_ship["read"]
    assert not {"observers/accuracy.py", "basin/motion.py"} & set(without_a_ship["read"])


def test_it_allocates_what_the_ledger_says_and_nothing_else(without_a_ship):
    assert without_a_ship["allocated"] == pytest.approx(without_a_ship["ledger"], rel=0.05, abs=200_000)


def test_it_compiles_no_kernel_of_a_ship(without_a_ship):
    names = without_a_ship["kernels"]
    assert "PairSph.move" in names
    words = ("ship", "hull", "cloth", "voxel", "body", "surface")
    assert not [name for name in names if any(word in name.lower() for word in words)]
    assert "Components.copy_to" not in names  # one kernel copies all that particles hold
