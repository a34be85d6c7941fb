"""A computed sea in place of a simulated one: the inputs of observers, without physics."""

from contextlib import nullcontext
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from ocean_sim import basin
from ocean_sim.fluid import Fluid, Totals
from ocean_sim.fluid.sph.particles import Snapshot
from ocean_sim.parts import LedgerRow
from ocean_sim.time_step.courant import Config as Courant
from ocean_sim.wind import NO_DRAWING

SPACING = 0.5


@dataclass
class Field:
    values: np.ndarray

    def to_numpy(self):
        return self.values.copy()


@dataclass
class Limits:
    acoustic: float = 0.01
    viscous: float = float("inf")
    force: float = 0.1


class Sea(Fluid):
    """Particles on a lattice under eta = slope * x + rise * t + waves; elevation and velocity are linear in time."""

    impulse = work = None  # its own, not computed by anybody
    rest_density, spacing = 1000.0, SPACING

    @property
    def of_particles(self):
        return self

    def __init__(self, place):
        self.place, self.rise, self.time = place, 0.25, 0.0
        counts = [
            max(1, round((u - l) / SPACING)) for l, u in zip(place.lower, (*place.upper[:1], 0.0, place.upper[2]))
        ]
        axes = [l + (np.arange(n) + 0.5) * SPACING for l, n in zip(place.lower, counts)]
        if place.dimension == 2:
            axes[2] = np.zeros(1)
        x = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        x = x if place.ground is None else x[place.ground.distances(x) > 0.0]
        n = len(x)
        self.particles = SimpleNamespace(
            n=n,
            count=SimpleNamespace(now=n),
            mass=1000.0 * SPACING**3,
            rest_density=1000.0,
            spacing=SPACING,
            position=Field(x),
            velocity=Field(np.zeros((n, 3))),
            density=Field(np.full(n, 1000.0)),
            pressure=Field(np.zeros(n)),
            id=Field(np.arange(n)[::-1].copy()),
        )
        kept = [getattr(self.particles, name) for name in Snapshot._fields]
        self.particles.snapshot = lambda: Snapshot(*(field.to_numpy() for field in kept))
        self.status = SimpleNamespace(
            max_speed=0.0,
            max_acceleration=0.0,
            min_density=1000.0,
            max_density=1000.0,
            clipped=0,
            finite=True,
            swelling=0.0,
            inner=0,
        )
        self.impulse = {term: np.zeros(3) for term in ("gravity", "walls", "pressure", "viscosity", "wind")}
        self.work = {"gravity": 0.0, "walls": 0.0, "pressure": 0.0, "viscosity": 0.0, "wind": 0.0}
        self.sound_speed, self.reference_speed = 50.0, 5.0

    def elevations(self, points):
        x, z = np.asarray(points).T
        waves = 0.35 * np.sin(0.9 * x + 0.5 * z - 2.9 * self.time) + 0.12 * np.sin(1.7 * z - 1.1 * x - 4.0 * self.time)
        return self.rise * self.time + 0.0 * x if self.rise else waves

    def pressures(self, points):
        return -1000.0 * 9.81 * np.asarray(points)[:, 1] + 100.0 * self.time

    def advance(self, dt):
        self.time += dt
        self.particles.velocity.values += dt * np.array([1.0, 0.0, 0.0])
        self.impulse["wind"] += dt * np.array([self.particles.mass * self.particles.n, 0.0, 0.0])
        self.status.max_speed = float(np.abs(self.particles.velocity.values).max())

    def internal_energy(self):
        return 3.0 * self.time

    def totals(self):
        particles, v = self.particles, self.particles.velocity.values
        x, excess = particles.position.values, particles.density.values / self.rest_density - 1.0
        with np.errstate(invalid="ignore"):
            turning = np.cross(x, v).sum(axis=0)
        return Totals(
            density=particles.density.values.sum(),
            compression=np.maximum(excess, 0.0).sum(),
            most_compressed=max(excess.max(), 0.0),
            deficit=np.maximum(-excess, 0.0).sum(),
            squared_speed=(v * v).sum(),
            position=x.sum(axis=0),
            velocity=v.sum(axis=0),
            turning=turning,
            lower=x.min(axis=0),
            upper=x.max(axis=0),
        )

    def limits(self):
        return Limits()


class Watched:
    """The loop around a step, as observers see it; `steps_of` are the time steps it takes, over and over."""

    def __init__(self, sea, place, steps_of):
        self.fluid, self.basin, self.steps_of = sea, place, steps_of
        self.scene = SimpleNamespace(
            title="A computed sea",
            seed=7,
            wind=SimpleNamespace(still=True, strongest=0.0),
            fluid=SimpleNamespace(kind="computed", steady_force=(0.0, 0.0, 0.0), driven=False),
            surface=None,
            ships={},
            time_step=Courant(),
            warnings=list,
            ledger=lambda: [LedgerRow("fluid", "particles", 1024, "a computed sea")],
            inputs=dict,
            files=list,
            resolved=lambda: {"title": "A computed sea", "basin": {"length": place.config.length}},
        )
        self.backend = SimpleNamespace(arch="cpu", threads=2, precision="f32")
        self.time_step = SimpleNamespace(limited_by="acoustic")
        self.surface, self.ships = None, {}
        self.wind = SimpleNamespace(drawing=lambda: NO_DRAWING)
        self.observers = []
        self.time, self.steps, self.outcome, self.reason = 0.0, 0, "running", ""

    def stage(self, name):
        return nullcontext()

    @property
    def next_dt(self):
        return self.steps_of[self.steps % len(self.steps_of)]

    def step(self):
        dt = self.next_dt
        with self.stage("fluid"):
            self.fluid.advance(dt)
        self.time += dt
        self.steps += 1

    def run(self, until):
        before = -1.0e-30
        while True:
            for observer in self.observers:
                every = observer.every
                if every == 0.0 or np.floor((self.time + self.next_dt) / every) > np.floor(before / every):
                    with self.stage("observers"):
                        observer.observe(self)
            if self.time >= until - 1.0e-9:
                break
            before = self.time
            self.step()
        self.outcome = "done"
        for observer in self.observers:
            observer.close()


@pytest.fixture
def watched():
    """A computed simulation: `watched([0.01, 0.004])`, or a slice with `width=None`."""

    def build(steps_of=(0.01,), width=4.0, **sides):
        place = basin.Config(length=6.0, width=width, depth=2.0, **sides).build()
        return Watched(Sea(place), place, steps_of)

    return build
