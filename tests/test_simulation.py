"""The step in the order of Algorithm 8, the loop around it, and the same bytes with any number of threads."""

from contextlib import contextmanager
from hashlib import sha256
from types import SimpleNamespace

import numpy as np
import pytest

import ocean_sim
from ocean_sim import conventions
from ocean_sim.fluid import Limits

SMALL = {
    "duration": 0.2,
    "seed": 3,
    "basin": {"length": 2.0, "width": 2.0, "depth": 0.5},
    "fluid": {"kind": "mueller", "spacing": 0.1, "kinematic_viscosity": 0.02},
    "wind": {
        "kind": "gusts",
        "volumes": [
            {
                "include": [{"kind": "box", "centre": [0.0, 0.0, 0.0], "half_size": [0.5, 0.5, 0.5]}],
                "acceleration": [3.0, 1.0, 0.0],
                "noise": [2.0, 2.0, 2.0],
                "drift": [1.0, 0.0, 0.0],
            }
        ],
    },
    "runtime": {"threads": 2},
    "frames": None,
    "render": None,
    "report": None,
    "timings": None,
}


@pytest.fixture(scope="module")
def small():
    with ocean_sim.Simulation(ocean_sim.load(SMALL)) as simulation:
        yield simulation


def test_the_stages_of_a_step_are_those_of_algorithm_8_in_order(small, monkeypatch):
    order = []

    @contextmanager
    def stage(name):
        order.append(name)
        yield

    surface = SimpleNamespace(follow=lambda particles, dt: order.append("follow"))
    ship = SimpleNamespace(
        load=lambda *who: order.append("load"),
        advance=lambda load, dt: order.append("advance ship"),
        limits=Limits,
    )
    for name, part in {
        "stage": stage,
        "surface": surface,
        "ships": {"ship": ship},
        "water_at_ships": (small.fluid,),
    }.items():
        monkeypatch.setattr(small, name, part)
    small.step()
    assert order == ["wind", "fluid", "surface", "follow", "ship", "load", "advance ship"]


class Watcher:
    """Remembers when it was called."""

    def __init__(self, every: float) -> None:
        self.every, self.times, self.closed = every, [], 0

    def observe(self, simulation) -> None:
        self.times.append(simulation.time)

    def close(self) -> None:
        self.closed += 1


def test_an_observer_sees_the_states_around_every_multiple_of_its_period(small):
    each, sometimes = Watcher(0.0), Watcher(0.03)
    small.run(until=small.time)  # shows those who watch already how it begins
    small.observers += [each, sometimes]
    start, steps = small.time, small.steps
    small.run(until=start + 0.2)
    small.observers = small.observers[:-2]
    assert len(each.times) == small.steps - steps
    for k in range(int(start / 0.03) + 2, int(small.time / 0.03)):
        before = max(t for t in each.times if t <= 0.03 * k)
        after = min(t for t in each.times if t > 0.03 * k)
        assert before in sometimes.times and after in sometimes.times


def test_observers_are_closed_and_the_reason_is_kept_when_a_run_leaves_the_physical_world():
    scene = ocean_sim.load(SMALL)
    watcher = Watcher(0.0)
    with pytest.raises(conventions.Diverged, match="too fast"), ocean_sim.Simulation(scene) as simulation:
        simulation.observers.append(watcher)

        def fail(dt):
            raise conventions.Diverged("too fast at (1, 2, 3)")

        simulation.fluid.advance = fail
        simulation.run(until=1.0)
    assert (simulation.outcome, simulation.reason) == ("stopped", "too fast at (1, 2, 3); t = 0.0000 s, step 0")
    assert watcher.closed == 1


def state(kind: str, threads: int, steps: int, spacing: float) -> str:
    changed = {"runtime.threads": threads, "fluid.spacing": spacing, "fluid.kind": kind}
    with ocean_sim.Simulation(ocean_sim.load(SMALL, changed)) as simulation:
        for _ in range(steps):
            simulation.step()
        particles = simulation.fluid.particles
        x, v = particles.position.to_numpy(), particles.velocity.to_numpy()
        assert np.isfinite(x).all() and np.abs(v).max() > 0.0
        return sha256(x.tobytes() + v.tobytes() + particles.id.to_numpy().tobytes()).hexdigest()


@pytest.mark.parametrize(
    ("kind", "steps", "spacing"),
    [
        pytest.param("mueller", 500, 0.1, id="mueller, serial sort", marks=pytest.mark.slow),
        pytest.param("mueller", 30, 0.043, id="mueller, sort in chunks", marks=pytest.mark.slow),
        pytest.param("delta_sph", 300, 0.15, id="delta_sph, serial sort"),
        pytest.param("delta_sph", 5, 0.043, id="delta_sph, sort in chunks", marks=pytest.mark.slow),
        pytest.param("dfsph", 300, 0.15, id="dfsph, serial sort", marks=pytest.mark.slow),
    ],
)
def test_the_same_bytes_with_one_and_two_threads_and_run_after_run(kind, steps, spacing):
    two = state(kind, 2, steps, spacing)
    assert two == state(kind, 1, steps, spacing)
    assert two == state(kind, 2, steps, spacing)


def test_another_seed_gives_another_sea():
    def sea(seed: int) -> np.ndarray:
        with ocean_sim.Simulation(ocean_sim.load(SMALL, {"seed": seed})) as simulation:
            for _ in range(5):
                simulation.step()
            return simulation.fluid.particles.velocity.to_numpy()

    assert np.abs(sea(1) - sea(2)).max() > 1e-3
