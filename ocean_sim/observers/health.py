"""Stops a run that has left the physical world, with what, where, when and what to try; keeps a log of events."""

import json
from collections.abc import Iterable, Iterator
from dataclasses import asdict
from itertools import combinations
from math import isnan
from pathlib import Path
from typing import ClassVar

import numpy as np

from ocean_sim.conventions import Diverged
from ocean_sim.files.atomic_file import file_named_in_errors
from ocean_sim.fluid import Totals, with_particles
from ocean_sim.model import quantity
from ocean_sim.observers.shared.checks import Momentum, Symmetry, beyond, kept, level_ratio
from ocean_sim.observers.shared.energy import (
    Balance,
    at_stake,
    driven,
    mechanical,
    potential,
    stored_by_weight,
    told_apart,
)
from ocean_sim.parts import ALONE
from ocean_sim.ship import Ship
from ocean_sim.simulation import NO_FOLDER, OutcomeObserver, PeriodicConfig, Simulation

POSITIONS_EVERY = 50  # steps between two checks of all positions
ENERGY_EVERY = 0.1  # [depth over reference speed] at most between two checks of the energy, however long the steps
GAIN_REPORTED = 0.01  # of the same scale as `max_energy_gain`: less is not reported
MOMENTUM_REPORTED = 1e-4  # over all impulses: more from nowhere is reported
WORK_REPORTED = 0.05  # over all work and the energy at stake: gains beyond, that no work has given, are reported
PARTED = 0.02  # spacings: images that are farther apart after so few steps as lie before the first look are reported
QUIET = 0.5  # [s] at least between two events of one kind
FIRM = 100.0  # stiffness over the square of the reference speed that holds the water within 1 %
STIFF = 10.0  # times the stiffness that holds the water within 1 %: from there on it is the likeliest cause


class Config(PeriodicConfig):
    turn: ClassVar[int] = -3
    leaves: ClassVar[str] = "events.jsonl; checks every particle"
    writes: ClassVar[bool] = False
    every: float = quantity("s", 0.0, ge=0.0)
    """Simulated time between checks; 0 checks after every step."""
    max_speed: float | None = quantity("m/s", None, gt=0.0)
    """Speed that no particle may exceed; by default ten times the fluid's reference speed."""
    max_density_ratio: float = quantity("1", 1.5, gt=1.0)
    """Density that no particle may exceed, as a multiple of the rest density."""
    max_level_ratio: float = quantity("1", 1.25, gt=1.0)
    """How high the centre of mass of the water may come to lie over the bed, as a multiple of where that of the same
    water in the same columns would lie at rest, or of where it began: water that swells lies higher. Not judged where
    water enters or a lid holds it down."""
    max_distance: float | None = quantity("m", None, gt=0.0)
    """How far from the basin a particle may get where no wall stops it; by default one diagonal of the basin."""

    max_energy_gain: float = quantity("1", 0.1, gt=0.0)
    """Energy that water driven by nothing but gravity may gain, over its mass times the square of the fluid's
    reference speed: of motion, height and compression together, and of motion and height alone."""

    def build(self, folder: Path, simulation: Simulation) -> "Health":
        return Health(self, None if folder is NO_FOLDER else folder, simulation)


class Health(OutcomeObserver):
    """Looks at the fluid after every step; events.jsonl has start, limits of the time step, clipping and the end."""

    first_energy: tuple[float, float] | None  # of motion and height, and of compression [J]

    def __init__(self, config: Config, folder: Path | None, simulation: Simulation) -> None:
        self.config, self.every, self.folder, self.simulation = config, config.every, folder, simulation
        basin, fluid = simulation.basin, simulation.fluid
        self.lower, self.upper = np.array(basin.lower), np.array(basin.upper)
        self.n = 0 if fluid.particles is None else fluid.particles.n
        self.max_speed = config.max_speed or 10.0 * fluid.reference_speed
        self.max_distance = config.max_distance or float(np.linalg.norm(self.upper - self.lower))
        self.judged = self.n > 0 and fluid.sound_speed > 0.0 and not driven(simulation)
        self.first_energy = None
        self.stored = stored_by_weight(simulation) if self.judged else 0.0  # [J]
        self.levelled = (
            self.n > 0 and fluid.sound_speed > 0.0 and not basin.closed and not simulation.scene.fluid.driven
        )
        self.first_level = float("nan")
        self.energy_every = ENERGY_EVERY * basin.depth / fluid.reference_speed if self.judged else 0.0  # [s]
        self.energy_seen, self.gain_reported = 0.0, False
        self.momentum: Momentum | None = None
        self.balance: Balance | None = None
        self.symmetry: Symmetry | None = None
        self.working: list[str] = []  # the forces that it counts
        self.stiffness = 0.0  # speed of sound [m/s] since which the balance counts
        self.reported: list[str] = []  # events of which one is enough
        self.events = None if folder is None else (folder / "events.jsonl").open("w", encoding="utf-8")
        of_ships = [f"{kind} of {name}" for kind in ("grounding", "flight") for name in simulation.ships]
        self.last = dict.fromkeys(["limit", "clipped", *of_ships], -QUIET)  # [s] last events that may come again
        self.limit, self.clipped = "", 0
        self.groundings = dict.fromkeys(simulation.ships, 0)
        self.airborne = dict.fromkeys(simulation.ships, False)
        self.flown = dict.fromkeys(simulation.ships, 0.0)  # [m/s] upwards when it was last in the air
        self.event(
            "start",
            particles=self.n,
            sound_speed_m_s=fluid.sound_speed,
            max_speed_m_s=self.max_speed,
            max_density_ratio=config.max_density_ratio if fluid.sound_speed > 0.0 else None,
            max_distance_m=self.max_distance,
        )

    def event(self, name: str, **facts: object) -> None:
        """One line of events.jsonl."""
        if self.events is not None:
            simulation = self.simulation
            line = {"time_s": round(simulation.time, 9), "step": simulation.steps, "event": name, **facts}
            with file_named_in_errors(self.events.name):
                self.events.write(json.dumps(line) + "\n")
                self.events.flush()

    def resumed(self, changed: str) -> None:
        if changed:
            self.event("the program has changed", what=changed)

    def observe(self, simulation: Simulation) -> None:
        if self.judged and self.first_energy is None:
            self.first_energy = self.energies(with_particles(simulation.fluid).totals())
        if self.n > 0 and simulation.steps == 0:
            self.symmetry = Symmetry(simulation)
        if self.momentum is None and self.n > 0 and simulation.fluid.impulse:
            self.momentum = Momentum(simulation)
            alone = self.judged and simulation.basin.sea is None
            self.working = [] if alone else told_apart(simulation)
            if self.working:
                self.balance = Balance(simulation, self.working)
                self.stiffness = simulation.fluid.sound_speed
                self.unaccounted(self.balance, with_particles(simulation.fluid).totals())
        if self.levelled and isnan(self.first_level):
            particles = with_particles(simulation.fluid).particles
            self.first_level = level_ratio(particles.snapshot().position, particles.spacing, simulation.basin)
        if self.n > 0 and simulation.steps > 0:
            if self.suspicious() or simulation.steps % POSITIONS_EVERY == 0:
                sentence = next(self.violations(), None)
            elif self.judged and simulation.time >= self.energy_seen + self.energy_every:
                sentence = next(self.energy_violations(with_particles(simulation.fluid).totals()), None)
            else:
                sentence = None
            if sentence is not None:
                raise Diverged(sentence)
        self.judge_hulls(simulation)
        self.note_limit(simulation)
        self.note_rim(simulation)
        self.note_grounding(simulation)
        self.note_flight(simulation)
        if self.n > 0:
            self.note_clipping(simulation)

    def suspicious(self) -> bool:
        """Whether the fluid's own summary of the last step is out of bounds; NaN counts as out of bounds."""
        status = self.simulation.fluid.status
        dense = self.too_dense(status.max_density) or self.without_density(status.min_density)
        return not status.finite or not status.max_speed <= self.max_speed or dense

    def too_dense(self, density: float) -> bool:
        """A fluid without sound speed has no pressure, so its density is not kept and not judged."""
        fluid = self.simulation.fluid
        return fluid.sound_speed > 0.0 and not density <= self.config.max_density_ratio * fluid.rest_density

    def without_density(self, density: float) -> bool:
        """Whether water has no density left, which a scheme that carries it on from step to step can come to."""
        return self.simulation.fluid.sound_speed > 0.0 and not density > 0.0

    def violations(self) -> Iterator[str]:
        """Sentences about what is out of bounds, worst kind first."""
        fluid, basin = with_particles(self.simulation.fluid), self.simulation.basin
        particles, totals = fluid.particles, fluid.totals()
        within = bool((totals.lower >= self.lower).all() and (totals.upper <= self.upper).all())
        if self.suspicious() or not (totals.finite and within and kept(totals, basin)):
            yield from self.violations_of_particles()
        if not totals.finite:
            return
        snapshot = particles.snapshot()
        self.note_particles(snapshot.id)
        self.note_symmetry()
        self.note_momentum(totals)
        self.note_work(totals)
        if self.levelled:
            level = level_ratio(snapshot.position, particles.spacing, basin)
            bound = self.config.max_level_ratio * max(self.first_level, 1.0)
            if not level <= bound:
                high = f"its centre of mass lies {level:.3g} x as high over the bed as that of as much water at rest"
                yield (
                    f"the water has swollen: {high} (bound {bound:.3g}), {self.moment()}; {self.advice()}"
                    f"{self.last_frame()}"
                )
        yield from self.energy_violations(totals)

    def violations_of_particles(self) -> Iterator[str]:
        """The same of single particles, each of which is looked at."""
        fluid = with_particles(self.simulation.fluid)
        particles, status = fluid.particles, fluid.status
        position = particles.position.to_numpy().astype(np.float64)
        velocity = particles.velocity.to_numpy().astype(np.float64)
        density = particles.density.to_numpy().astype(np.float64)
        finite = np.isfinite(position).all(axis=1) & np.isfinite(velocity).all(axis=1) & np.isfinite(density)
        if not (status.finite and finite.all()):
            lost = np.flatnonzero(~finite)
            what = "position, velocity or density stopped being a number"
            yield self.sentence(f"{what} for {len(lost)} of {len(finite)} particles", position, lost[:1])
            return
        if self.too_dense(status.max_density):
            ratio = status.max_density / particles.rest_density
            what = f"density reached {status.max_density:.4g} kg/m^3, {ratio:.3g} x the rest density"
            yield self.sentence(f"{what} (bound {self.config.max_density_ratio:g})", position, [density.argmax()])
        if self.without_density(status.min_density):
            what = f"density fell to {status.min_density:.4g} kg/m^3; it must stay above 0"
            yield self.sentence(what, position, [int(density.argmin())])
        if not status.max_speed <= self.max_speed:
            what = f"a particle reached {status.max_speed:.4g} m/s (bound {self.max_speed:.4g} m/s)"
            yield self.sentence(what, position, [int(np.square(velocity).sum(axis=1).argmax())])
        through = beyond(position, self.simulation.basin, self.simulation.time)
        if through.any():
            what = f"{np.count_nonzero(through)} of {len(through)} particles are outside the walls"
            far = f"the farthest by {through.max():.4g} m (none may be)"
            yield self.sentence(f"{what}, {far}", position, [int(through.argmax())])
        distance = np.linalg.norm(position - np.clip(position, self.lower, self.upper), axis=1)
        if not distance.max() <= self.max_distance:
            what = f"{np.count_nonzero(distance > self.max_distance)} particles left the basin"
            far = f"the farthest by {distance.max():.4g} m (bound {self.max_distance:.4g} m)"
            yield self.sentence(f"{what}, {far}", position, [distance.argmax()])

    def once(self, name: str, **facts: object) -> None:
        """An event of which one is enough."""
        if name not in self.reported:
            self.event(name, **facts)
            self.reported.append(name)

    def seldom(self, kind: str, name: str, **facts: object) -> bool:
        """An event that comes at least QUIET after the last of its kind; True if it does."""
        if self.simulation.time < self.last[kind] + QUIET:
            return False
        self.event(name, **facts)
        self.last[kind] = self.simulation.time
        return True

    def note_particles(self, ids: np.ndarray) -> None:
        """Where the water's mass is not that of all particles that there are, each once; `ids`: theirs."""
        count = len(ids)
        there = np.bincount(ids[(ids >= 0) & (ids < count)], minlength=count)
        if (there != 1).any():
            self.once("particles from nowhere", lost=int((there == 0).sum()), twice=int((there > 1).sum()))

    def note_symmetry(self) -> None:
        """Where water that was its own mirror image is not any more, before rounding can have grown; looked at once."""
        if self.symmetry is not None:
            apart, self.symmetry = self.symmetry.lost(self.simulation), None
            if not apart <= PARTED:
                self.once("symmetry lost", spacings=float(f"{apart:.3g}"), bound=PARTED)

    def note_momentum(self, totals: Totals) -> None:
        """Where the water's momentum is not what all forces have given it."""
        if self.momentum is not None:
            share = self.momentum.from_nowhere(self.simulation, totals)
            if not share <= MOMENTUM_REPORTED:
                said = float(f"{share:.3g}")
                self.once("momentum from nowhere", over_all_impulses=said, bound=MOMENTUM_REPORTED)

    def note_work(self, totals: Totals) -> None:
        """Where driven water, or that of a patch, has gained energy that no force has given; other water is judged by
        its energy alone."""
        if self.balance is not None and not self.simulation.fluid.status.clipped:
            fluid = with_particles(self.simulation.fluid)
            work = fluid.work
            scale = at_stake(self.simulation) + sum(abs(work[term]) for term in self.working)
            share = self.unaccounted(self.balance, totals) / scale
            if not share <= WORK_REPORTED:
                self.once("energy that no work has given", over_all_work=float(f"{share:.3g}"), bound=WORK_REPORTED)

    def unaccounted(self, balance: Balance, totals: Totals) -> float:
        """Energy [J] that no force has given since the first look."""
        fluid, gravity = with_particles(self.simulation.fluid), self.simulation.basin.gravity
        if fluid.sound_speed != self.stiffness:  # a person has made the water stiffer, or softer
            balance.at_first, self.stiffness = None, fluid.sound_speed
        return balance.residual(
            sum(self.energies(totals)), potential(fluid.particles.mass, totals, gravity), fluid.work
        )

    def energies(self, totals: Totals) -> tuple[float, float]:
        """Of motion and height, and of compression [J]."""
        return mechanical(self.simulation, totals), self.simulation.fluid.internal_energy()

    def energy_violations(self, totals: Totals) -> Iterator[str]:
        """Energy that no force has given: an unstable scheme creates it long before one particle is out of bounds, and
        a stiff one has it in its first lattice, which motion and height get when it gives way."""
        if self.judged and self.first_energy is not None:
            fluid, bound = self.simulation.fluid, self.config.max_energy_gain
            scale = with_particles(fluid).particles.mass * self.n * fluid.reference_speed**2
            moved, squeezed = (now - then for now, then in zip(self.energies(totals), self.first_energy))
            gain, given = (moved + squeezed) / scale, (moved - self.stored) / scale
            self.energy_seen = self.simulation.time
            if not (gain <= GAIN_REPORTED or self.gain_reported):
                self.event("energy from nowhere", over_m_v2=round(gain, 6), bound=bound)
                self.gain_reported = True
            of = f"of its mass times the square of {fluid.reference_speed:.4g} m/s (bound {100.0 * bound:g} %)"
            if not gain <= bound:
                yield (
                    f"the water gained energy from nowhere, {100.0 * gain:.3g} % {of}, {self.moment()}; try a larger "
                    f"fluid.kinematic_viscosity, or a shorter time step{self.last_frame()}"
                )
            if not given <= bound:
                yield (
                    f"the water rises or moves with nothing to drive it: it gained {100.0 * given:.3g} % {of}, "
                    f"{self.moment()}; {self.advice()}{self.last_frame()}"
                )

    def moment(self) -> str:
        """Time and step of the simulation."""
        return f"t = {self.simulation.time:.4f} s, step {self.simulation.steps}"

    def sentence(self, what: str, position: np.ndarray, worst: Iterable[int]) -> str:
        """What, where, when, what to try, and the file of the last good state."""
        where = "".join(f" at ({', '.join(f'{x:.4g}' for x in position[i])}) m" for i in worst)
        return f"{what}{where}, {self.moment()}; {self.advice()}{self.last_frame()}"

    def advice(self) -> str:
        """What to try, by the likeliest cause."""
        fluid, basin, scene = self.simulation.fluid, self.simulation.basin, self.simulation.scene
        pull = float(np.linalg.norm(basin.gravity))
        if fluid.sound_speed == 0.0:
            return "particles of this fluid ignore each other: try a weaker wind, walls around the basin, or a floor"
        held = 0.01 * fluid.sound_speed**2 / pull if pull > 0.0 else float("inf")  # depth at 1 % compression [m]
        if held < 0.1 * basin.depth:
            stiffness, wanted = fluid.sound_speed**2, FIRM * pull * basin.depth  # [m^2/s^2]
            return (
                f"stiffness {stiffness:.4g} m^2/s^2 holds only {held:.2g} m of water within 1 % and the basin is"
                f" {basin.depth:g} m deep: try fluid.compression: 0.01, or a stiffness of {wanted:.4g}"
            )
        needed = FIRM * fluid.reference_speed**2  # [m2/s2] for 1 %
        if fluid.sound_speed**2 >= STIFF * needed:
            times = f"{fluid.sound_speed**2 / needed:.3g} times that of 1 % compression"
            return f"stiffness {fluid.sound_speed**2:.4g} m^2/s^2 is {times}: try fluid.compression: 0.01"
        limits = fluid.limits()
        limit, shortest = min(asdict(limits).items(), key=lambda item: item[1])
        return scene.time_step.advice(limit, shortest)

    def last_frame(self) -> str:
        """Names the newest frame, which is the last state worth looking at."""
        frames = [] if self.folder is None else sorted((self.folder / "frames").glob("frame_*.npz"))
        return f"; the last picture before is frames/{frames[-1].name}" if frames else ""

    def judge_hulls(self, simulation: Simulation) -> None:
        """Raises Diverged where two hulls have come into one another: what pushes them apart is not modelled."""
        if len(simulation.ships) < 2:
            return
        outlines = [(name, ship.outline()) for name, ship in simulation.ships.items()]
        there = [(name, outline) for name, outline in outlines if outline is not None]
        repeats = simulation.scene.preflight.repeats
        for (name, one), (other_name, other) in combinations(there, 2):
            image = max(other.images(one, repeats), key=one.overlap)
            depth = one.overlap(image)
            if depth > 0.0:
                x, z = one.middle(image)
                raise Diverged(
                    f"the hulls of {name} and {other_name} reach {depth:.3g} m into each other at ({x:.4g}, {z:.4g}) "
                    f"m, {self.moment()}; contact between hulls is not modelled: keep them apart{self.last_frame()}"
                )

    def note_rim(self, simulation: Simulation) -> None:
        """A ship, or one of several that have parted, lies in the rim of the patch: the sea around her is not hers."""
        if len(simulation.ships) < 2:
            return
        at = np.array([ship.body.position[[0, 2]] for ship in simulation.ships.values()])
        for (name, ship), inside in zip(simulation.ships.items(), simulation.fluid.in_rim(at), strict=True):
            if inside:
                self.once("the ships are too far apart for their patch: one is in its rim", **where(name, ship))

    def note_grounding(self, simulation: Simulation) -> None:
        """The keel met the bed, again and again it may be."""
        for name, ship in simulation.ships.items():
            if ship.groundings > self.groundings[name]:
                self.seldom(f"grounding of {name}", "the hull meets the bed", **where(name, ship))
                self.groundings[name] = ship.groundings

    def note_flight(self, simulation: Simulation) -> None:
        """The whole hull has left the water, or some of it is in the water again."""
        for name, ship in simulation.ships.items():
            if ship.airborne:
                self.flown[name] = float(ship.body.velocity[1])
            if ship.airborne != self.airborne[name]:
                event = f"the hull {'leaves' if ship.airborne else 'meets'} the water"
                facts = where(name, ship) | {"speed_m_s": round(self.flown[name], 3)}
                if self.seldom(f"flight of {name}", event, **facts):
                    self.airborne[name] = ship.airborne

    def note_limit(self, simulation: Simulation) -> None:
        limit, step = simulation.time_step.limited_by, float(simulation.next_dt)
        if limit != self.limit and self.seldom("limit", "limit", limited_by=limit, time_step_s=step):
            self.limit = limit

    def note_clipping(self, simulation: Simulation) -> None:
        clipped = simulation.fluid.status.clipped
        if simulation.outcome != "running":
            self.last["clipped"] = -QUIET
        if clipped > self.clipped:
            facts = {"particles": int(clipped - self.clipped), "since_start": int(clipped)}
            if self.seldom("clipped", "clipped", **facts):
                self.clipped = clipped

    def close(self) -> None:
        outcome = self.simulation.outcome
        if self.n > 0 and outcome != "failed":
            self.note_clipping(self.simulation)
        self.event(outcome, **({"reason": self.simulation.reason} if self.simulation.reason else {}))
        if self.events is not None:
            self.events.close()

    def amend(self) -> None:
        if self.events is not None:
            self.events = Path(self.events.name).open("a", encoding="utf-8")
            self.close()


def where(name: str, ship: Ship) -> dict[str, object]:
    """Which ship of several, and where she is, for an event."""
    x, _, z = ship.body.position
    which = {} if name == ALONE else {"ship": name}
    return which | {"x_m": round(float(x), 3), "z_m": round(float(z), 3)}
