"""The same seed leaves the same bytes in every file but the clock's: with one thread and with two, and once more.

Each scheme meets each surface and each ship, and each surface each ship; all with contact, wind, platform and every
watcher that writes numbers. The water has 1800 particles: Taichi shares loops of less than 512 between no threads.
"""

from pathlib import Path

import pytest

from ocean_sim import runtime
from ocean_sim.kernel_library import ti
from ocean_sim.reading.scene import load
from ocean_sim.simulation import Simulation

pytestmark = pytest.mark.optimised  # these bytes are those of users' runs

TANK = {"length": 4.0, "width": 3.0, "depth": 1.2}
SEA = {"length": 40.0, "width": 40.0, "depth": 7.5, "walls": "none"}
PLAIN = {
    "seed": 3,
    "frames": {"every": 0.03},
    "accuracy": {"every": 0.01},
    "gauges": {"elevation": {"here": [0.1, 0.2]}, "pressure": {"bed": [0.1, -0.4, 0.2]}, "every": 0.01},
    **dict.fromkeys(("timings", "render", "report", "checkpoint")),
}
BOX = {"shape": {"kind": "box", "length": 1.4, "breadth": 0.8, "height": 0.5}, "mass": 250.0}
CALM_SHIP = {"hull": BOX | {"centre_of_mass": [0.0, 0.2, 0.0]}, "velocity": [0.2, 0.0, 0.5], "cells_per_draught": 4.0}
STEERED = {
    "hull": "yacht",
    "rudder": {"area": 0.6, "position": [0.0, -0.5, -4.0]},
    "controls": {"autopilot": {"heading_deg": 30.0, "throttle": 0.5}},
}
RIDE = {"platform": {"kind": "hexapod", "washout": "ship"}, "motion": {"every": 0.01}}
SCHEMES, SURFACES = ("mueller", "delta_sph", "dfsph", "ballistic"), ("cloth", "marching_cubes")
KINDS = ("thesis", "hydrostatic", "dynamic", "pressure", "manoeuvring")


def water(scheme: str, surface: str, kind: str | None) -> dict:
    """Particles in a tank under a wide gust, with what is on them."""
    scene = PLAIN | {"basin": TANK, "fluid": {"kind": scheme, "spacing": 0.2}, "wind": "wide", "surface": surface}
    scene |= {"tracers": {"ids": [0, 700], "every": 0.01}, "duration": 0.06}
    if kind == "manoeuvring":
        return scene | RIDE | {"ship": {"kind": kind}}
    return scene if kind is None else scene | RIDE | {"ship": {"kind": kind} | CALM_SHIP}


def swell(kind: str, water: str = "linear_waves", **keys) -> dict:
    """A sea without particles with a ship under way."""
    ship = {"kind": kind} | ({} if kind == "manoeuvring" else STEERED)
    wind = None if kind == "manoeuvring" else "wide"
    fluid = {"kind": water, "height": 0.5, "period": 3.0} | keys
    return PLAIN | RIDE | {"basin": SEA, "fluid": fluid, "wind": wind, "ship": ship, "duration": 0.3}


SCENES = {
    f"{scheme}, {SURFACES[(i + k) % 2]}, {kind or 'no ship'}": water(scheme, SURFACES[(i + k) % 2], kind)
    for i, scheme in enumerate(SCHEMES)
    for k, kind in enumerate((None, *KINDS))
    if kind != "pressure" or scheme in ("mueller", "delta_sph")  # others carry none
} | {f"linear_waves, {kind}": swell(kind) for kind in KINDS if kind != "pressure"}
SCENES["spectral_sea, dynamic"] = swell("dynamic", "spectral_sea", order=3, cells=32)
NONLINEAR = {"kind": "spectral_sea", "height": 0.1, "period": 1.3, "onset": 0.0, "rim": {"velocity": [2.0, 0.0]}}
RANDOM = {"spectrum": {"significant_wave_height": 0.1, "peak_period": 1.3, "spreading": 10.0, "seed": 2}}
for scheme, sea, what in (
    ("delta_sph", NONLINEAR, "nonlinear"),
    *((scheme, {"kind": "linear_waves"} | RANDOM, "random") for scheme in ("mueller", "delta_sph", "dfsph")),
):
    SCENES[f"{scheme}, patch of a {what} sea, no ship"] = water(scheme, "cloth", None) | {
        "basin": TANK | {"walls": "periodic"},
        "sea": sea,
    }
MESH = str(Path(__file__).parents[2] / "ocean_sim/validation/data/ball.obj")
BED = {
    "floor": {"profile": [[-2.0, -1.2], [-0.4, -1.2], [2.0, 0.2]]},
    "obstacles": [{"mesh": MESH, "at": [-1.2, -0.6, 0.0]}],
}
SCENES |= {
    f"{scheme}, {name}, no ship": {key: value for key, value in water(scheme, "cloth", None).items() if key != "wind"}
    | {"basin": TANK | BED | {"wavemaker": {"height": 0.2, "period": 1.5}}}
    | {"gauges": {"elevation": {"here": [0.1, 0.2]}, "runup": {"shore": {}}, "every": 0.01}}
    for scheme, name in (("delta_sph", "a beach and a mesh"), ("dfsph", "a beach and a mesh"))
}
FEW = ("mueller, cloth, hydrostatic", "spectral_sea, dynamic")


def contents(keys: dict, threads: int, folder: Path) -> dict[str, bytes]:
    """What a run with so many threads leaves, by name; manifest.json tells clock and threads."""
    folder.mkdir()
    scene = load({key: value for key, value in keys.items() if value is not None or key in PLAIN})
    scene = load(scene.resolved(), {"runtime.threads": threads})
    with Simulation(scene, folder) as simulation:
        simulation.run(scene.duration)
    files = [path for path in folder.rglob("*") if path.is_file() and path.name != "manifest.json"]
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def differing(one: dict[str, bytes], other: dict[str, bytes]) -> list[str]:
    """Names of the files that are not the same."""
    return [name for name in sorted({*one, *other}) if one.get(name) != other.get(name)]


@pytest.mark.anchor
@pytest.mark.parametrize("name", [pytest.param(n, marks=() if n in FEW else pytest.mark.slow) for n in SCENES])
def test_the_threads_change_no_byte(name, tmp_path):
    one, two = (contents(SCENES[name], n, tmp_path / str(n)) for n in (1, 2))
    assert {"accuracy.csv", "gauges.csv", "events.jsonl"} <= set(one)
    assert ("motion.csv" in one and "platform.csv" in one) or "no ship" in name
    assert differing(one, two) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_and_neither_does_a_repetition(name, tmp_path):
    once, again = (contents(SCENES[name], 2, tmp_path / str(k)) for k in range(2))
    assert differing(once, again) == []


def test_a_sum_in_the_order_of_threads_would_be_seen():
    """Negative control: with so many particles two threads do share the work, and a plain sum shows it."""

    def added(threads: int) -> float:
        runtime.start(runtime.RuntimeConfig(threads=threads))
        total = ti.field(ti.f32, ())

        @ti.kernel
        def add(n: int):
            for i in range(n):
                total[None] += 1e3 * ti.sin(float(i))

        add(1800)
        return total[None]

    assert added(1) != added(2)
