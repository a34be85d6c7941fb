"""Stops a run that has left the physical world, with a sentence on place, time and cure; keeps a log of events."""

import json
from collections.abc import Iterable, Iterator
from dataclasses import asdict
from itertools import combinations
from math import sqrt
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from ocean_sim.conventions import Diverged
from ocean_sim.files.atomic_file import file_named_in_errors
from ocean_sim.fluid import Totals, with_particles
from ocean_sim.model import quantity
from ocean_sim.observers.shared import checks
from ocean_sim.parts import ALONE, PeriodicConfig
from ocean_sim.ship import Ship
from ocean_sim.simulation import NO_FOLDER, OutcomeObserver, Simulation

STEPS_BETWEEN_CHECKS = 50  # of all positions
ENERGY_CHECK_INTERVAL = 0.1  # [depth over reference speed] at most, between two checks of the energy
GAIN_REPORTED = 0.01  # in units of `max_energy_gain`: a larger one is reported
MOMENTUM_REPORTED = 1e-4  # over all impulses: a larger unexplained share is reported
WORK_REPORTED = 0.05  # over all work and the energy scale: a larger unexplained share is reported
SWELLING_REPORTED = 0.03  # mean share by which particles stand thinner or denser than their density says
INNER_SHARE = 0.2  # of all particles: of fewer so far inside the water that mean is chance
MAX_IMAGE_DRIFT = 0.02  # [spacings] of an image from its place, before the first check
EVENT_INTERVAL = 0.5  # [s] at least, between two events of one kind
FIRM_STIFFNESS_RATIO = 100.0  # stiffness over the square of the reference speed, for compression of 1 %
EXCESS_STIFFNESS_RATIO = 10.0  # times the stiffness for compression of 1 %: a larger one is the likeliest cause


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
    """Height over the bed that the centre of mass of the water may reach, as a multiple of its height at rest in the
    same columns, and of its height at the start, unless it stays longer than its highest particle takes to rise and
    fall: water that swells lies higher. Not judged where water enters, a lid holds it down or gravity does not."""
    max_distance: float | None = quantity("m", None, gt=0.0)
    """Distance from the basin that a particle may reach where no wall stops it; by default the basin's diagonal."""
    max_energy_gain: float = quantity("1", 0.1, gt=0.0)
    """Energy that water driven by nothing but gravity may gain, over its mass times the square of the fluid's
    reference speed: of motion, height and compression together, and of motion and height alone."""


class Health(OutcomeObserver, of=Config):
    """Checks the water after each step and raises Diverged if it left the physical world; writes events.jsonl."""

    def __init__(self, config: Config, folder: Path, simulation: Simulation) -> None:
        self.config, self.every, self.simulation = config, config.every, simulation
        self.folder = None if folder is NO_FOLDER else folder
        basin, fluid = simulation.basin, simulation.fluid
        self.lower, self.upper = np.array(basin.lower), np.array(basin.upper)
        self.n = 0 if fluid.particles is None else fluid.particles.n
        self.max_speed = config.max_speed or 10.0 * fluid.reference_speed
        self.max_distance = config.max_distance or float(np.linalg.norm(self.upper - self.lower))
        self.judges_energy = self.n > 0 and fluid.sound_speed > 0.0 and not checks.gains_energy(simulation)
        self.stored = checks.stored_by_weight(simulation) if self.judges_energy else 0.0  # [J]
        held = basin.gravity[1] < 0.0 and not basin.closed  # by its weight alone
        self.judges_level = self.n > 0 and fluid.sound_speed > 0.0 and held and not simulation.scene.fluid.driven
        interval = ENERGY_CHECK_INTERVAL * basin.depth / fluid.reference_speed if self.judges_energy else 0.0
        self.energy_interval = interval  # [s]
        self.energy_time = 0.0
        self.begun = False  # True once the first state is known
        self.first_energy = 0.0, 0.0  # of motion and height, and of compression [J]
        self.first_level = float("nan")
        self.first_height = 0.0  # [m] of the centre of mass over the bed
        self.level_time = 0.0  # [s] when the level was last within its bound
        self.momentum: checks.Momentum | None = None
        self.balance: checks.Balance | None = None
        self.symmetry: checks.Symmetry | None = None
        self.work_terms: list[str] = []  # of `balance`
        self.scale = self.highest_motion = 0.0  # [J] of `balance`: fixed, and of motion so far
        self.stiffness = 0.0  # speed of sound [m/s] of the balance
        self.reported: list[str] = []  # events that are recorded once
        self.events = None if self.folder is None else (folder / "events.jsonl").open("w", encoding="utf-8")
        self.recorded: dict[str, Any] = {"limit": "", "clipped": 0}  # value of a kind at its last event
        self.recorded |= {f"grounding of {name}": 0 for name in simulation.ships}
        self.recorded |= {f"flight of {name}": False for name in simulation.ships}
        self.event_times = dict.fromkeys(self.recorded, -EVENT_INTERVAL)  # [s] of the last event of a kind
        self.flown = dict.fromkeys(simulation.ships, 0.0)  # [m/s] upwards, when last in the air
        self.record_event(
            "start",
            particles=self.n,
            sound_speed_m_s=fluid.sound_speed,
            max_speed_m_s=self.max_speed,
            max_density_ratio=config.max_density_ratio if fluid.sound_speed > 0.0 else None,
            max_distance_m=self.max_distance,
        )

    def record_event(self, name: str, **facts: object) -> None:
        """Write an event of this name, with time, step and its facts, as one line of events.jsonl."""
        if self.events is not None:
            simulation = self.simulation
            line = {"time_s": round(simulation.time, 9), "step": simulation.steps, "event": name, **facts}
            with file_named_in_errors(self.events.name):
                self.events.write(json.dumps(line) + "\n")
                self.events.flush()

    def resumed(self, changed: str) -> None:
        """Record as an event how the program has `changed` since the checkpoint, if it has."""
        if changed:
            self.record_event("the program has changed", what=changed)

    def observe(self, simulation: Simulation) -> None:
        """Check water and ships, and record events; raises Diverged with the first violated bound."""
        if self.n > 0 and not self.begun:
            self.begin(simulation)
        if self.n > 0 and simulation.steps > 0:
            sentence = None
            if self.is_suspicious() or simulation.steps % STEPS_BETWEEN_CHECKS == 0:
                sentence = next(self.violations(), None)
            elif self.judges_energy and simulation.time >= self.energy_time + self.energy_interval:
                sentence = next(self.energy_violations(with_particles(simulation.fluid).totals()), None)
            if sentence is not None:
                raise Diverged(sentence)
        self.judge_hulls(simulation)
        limit, step = simulation.time_step.limited_by, float(simulation.next_dt)
        self.record_change("limit", limit, "limit", limited_by=limit, time_step_s=step)
        self.note_rim(simulation)
        self.note_ships(simulation)
        if self.n > 0:
            self.note_clipping(simulation)

    def begin(self, simulation: Simulation) -> None:
        """Store energies, momentum, water level and symmetry of the first state, to compare later ones with."""
        self.begun = True
        water = with_particles(simulation.fluid)
        totals, particles = water.totals(), water.particles
        if self.judges_energy:
            self.first_energy = self.energy_parts(totals)
        if self.judges_level:
            position = particles.snapshot().position
            self.first_level = checks.level_ratio(position, particles.spacing, simulation.basin, simulation.time)
            self.first_height = float(position[:, 1].mean()) - simulation.basin.lower[1]
            self.level_time = simulation.time
        if simulation.steps == 0:
            self.symmetry = checks.Symmetry(simulation)
        if water.impulse:
            self.momentum = checks.Momentum(simulation)
            self.work_terms = checks.separable_work_terms(simulation)
            self.scale = checks.energy_scale(simulation)
            if self.work_terms:
                self.balance = checks.Balance(simulation, self.work_terms)
                self.stiffness = water.sound_speed
                self.unexplained_energy(self.balance, totals)

    def is_suspicious(self) -> bool:
        """True if the greatest speed or density of the last step, which the fluid reports, is out of bounds or NaN."""
        status = self.simulation.fluid.status
        dense = self.is_too_dense(status.max_density) or self.has_no_density(status.min_density)
        return not status.finite or not status.max_speed <= self.max_speed or dense

    def is_too_dense(self, density: float) -> bool:
        """True if a density [kg/m3] exceeds its bound; a fluid without sound speed has no bound."""
        fluid = self.simulation.fluid
        return fluid.sound_speed > 0.0 and not density <= self.config.max_density_ratio * fluid.rest_density

    def has_no_density(self, density: float) -> bool:
        """True if a density [kg/m3] is zero or negative, which can happen where a scheme integrates density in time."""
        return self.simulation.fluid.sound_speed > 0.0 and not density > 0.0

    def violations(self) -> Iterator[str]:
        """Yield a sentence for each violated bound, worst kind first; faults too small to end the run become events."""
        fluid, basin = with_particles(self.simulation.fluid), self.simulation.basin
        particles, totals = fluid.particles, fluid.totals()
        within = bool((totals.lower >= self.lower).all() and (totals.upper <= self.upper).all())
        if self.is_suspicious() or not (totals.finite and within and checks.surely_inside(totals, basin)):
            yield from self.violations_of_particles()
        if not totals.finite:
            return
        snapshot = particles.snapshot()
        count, ids = len(snapshot.id), snapshot.id
        there = np.bincount(ids[(ids >= 0) & (ids < count)], minlength=count)
        if (there != 1).any():
            lost, twice = int((there == 0).sum()), int((there > 1).sum())
            self.record_once("particles from nowhere", lost=lost, twice=twice)
        if self.symmetry is not None:  # judged once, before rounding can have grown
            apart, self.symmetry = self.symmetry.largest_distance(self.simulation), None
            self.report_excess("symmetry lost", "spacings", apart, MAX_IMAGE_DRIFT)
        if self.momentum is not None:
            share = self.momentum.unexplained_share(self.simulation, totals)
            self.report_excess("momentum from nowhere", "over_all_impulses", share, MOMENTUM_REPORTED)
        self.note_work(totals)
        if fluid.status.inner > INNER_SHARE * count:
            self.report_excess("volume from nowhere", "over_volume", fluid.status.swelling, SWELLING_REPORTED)
        if self.judges_level:
            now, top, centre = self.simulation.time, float(totals.upper[1]), float(totals.position[1]) / count
            level = checks.level_ratio(snapshot.position, particles.spacing, basin, now)
            bound = self.config.max_level_ratio * max(self.first_level, 1.0)
            self.level_time = now if level <= bound else self.level_time
            flight = 2.0 * sqrt(2.0 * max(top - basin.lower[1], 0.0) / -basin.gravity[1])  # up and down [s]
            risen = centre - basin.lower[1] > self.config.max_level_ratio * self.first_height
            if level > bound and (risen or now > self.level_time + flight):
                high = f"its centre of mass lies {level:.3g} x as high over the bed as that of as much water at rest"
                yield self.failure_sentence(f"the water has swollen: {high} (bound {bound:.3g})", self.suggest_cure())
        yield from self.energy_violations(totals)

    def violations_of_particles(self) -> Iterator[str]:
        """Yield a sentence for each bound that some particle violates; reads all particles, so it is slow."""
        fluid = with_particles(self.simulation.fluid)
        particles, status = fluid.particles, fluid.status
        position = particles.position.to_numpy().astype(np.float64)
        velocity = particles.velocity.to_numpy().astype(np.float64)
        density = particles.density.to_numpy().astype(np.float64)
        finite = np.isfinite(position).all(axis=1) & np.isfinite(velocity).all(axis=1) & np.isfinite(density)
        if not (status.finite and finite.all()):
            lost = np.flatnonzero(~finite)
            what = "position, velocity or density stopped being a number"
            yield self.describe_failure(f"{what} for {len(lost)} of {len(finite)} particles", position, lost[:1])
            return
        if self.is_too_dense(status.max_density):
            ratio, bound = status.max_density / particles.rest_density, self.config.max_density_ratio
            what = f"density reached {status.max_density:.4g} kg/m^3, {ratio:.3g} x the rest density (bound {bound:g})"
            yield self.describe_failure(what, position, [density.argmax()])
        if self.has_no_density(status.min_density):
            what = f"density fell to {status.min_density:.4g} kg/m^3; it must stay above 0"
            yield self.describe_failure(what, position, [int(density.argmin())])
        if not status.max_speed <= self.max_speed:
            what = f"a particle reached {status.max_speed:.4g} m/s (bound {self.max_speed:.4g} m/s)"
            yield self.describe_failure(what, position, [int(np.square(velocity).sum(axis=1).argmax())])
        through = checks.distance_outside(position, self.simulation.basin, self.simulation.time, fluid.spacing)
        if through.any():
            what = f"{np.count_nonzero(through)} of {len(through)} particles are outside the walls"
            far = f"the farthest by {through.max():.4g} m (none may be)"
            yield self.describe_failure(f"{what}, {far}", position, [int(through.argmax())])
        distance = np.linalg.norm(position - np.clip(position, self.lower, self.upper), axis=1)
        if not distance.max() <= self.max_distance:
            what = f"{np.count_nonzero(distance > self.max_distance)} particles left the basin"
            far = f"the farthest by {distance.max():.4g} m (bound {self.max_distance:.4g} m)"
            yield self.describe_failure(f"{what}, {far}", position, [distance.argmax()])

    def record_once(self, name: str, **facts: object) -> None:
        """Record an event of this name, the first time only."""
        if name not in self.reported:
            self.record_event(name, **facts)
            self.reported.append(name)

    def report_excess(self, name: str, measure: str, value: float, bound: float) -> None:
        """Record the event `name`, the first time only, if abs(value) exceeds `bound`; `measure`: the value's name."""
        if not abs(value) <= bound:
            self.record_once(name, **{measure: float(f"{value:.3g}")}, bound=bound)

    def record_change(self, kind: str, value: object, name: str, **facts: object) -> None:
        """Record the event `name` if `value` differs from the one at the last event of this `kind` (a key of
        `recorded`), and that event is at least EVENT_INTERVAL [s] ago."""
        if self.simulation.time >= self.event_times[kind] + EVENT_INTERVAL and value != self.recorded[kind]:
            self.record_event(name, **facts)
            self.event_times[kind], self.recorded[kind] = self.simulation.time, value

    def note_work(self, totals: Totals) -> None:
        """Record an event if energy that no force explains, gained or lost, exceeds the share WORK_REPORTED of this
        sum: `energy_scale`, the highest kinetic energy so far, and the work of the driving forces, gravity included."""
        if self.balance is not None and not self.simulation.fluid.status.clipped:
            work, moving = self.simulation.fluid.work, checks.kinetic_and_potential(self.simulation, totals)[0]
            self.highest_motion = max(self.highest_motion, moving)
            driving = sum(abs(work[term]) for term in self.work_terms if term in checks.DRIVING_TERMS)
            share = self.unexplained_energy(self.balance, totals) / (self.scale + self.highest_motion + driving)
            self.report_excess("energy that no work has given", "over_all_work", share, WORK_REPORTED)

    def unexplained_energy(self, balance: checks.Balance, totals: Totals) -> float:
        """Energy [J] gained without work of a force since the first check, or a change of the speed of sound."""
        fluid = self.simulation.fluid
        if fluid.sound_speed != self.stiffness:  # a person has changed the stiffness
            balance.at_first, self.stiffness = None, fluid.sound_speed
        lifted = checks.kinetic_and_potential(self.simulation, totals)[1]
        return balance.residual(sum(self.energy_parts(totals)), lifted, fluid.work)

    def energy_parts(self, totals: Totals) -> tuple[float, float]:
        """Kinetic plus potential energy of the water, and its energy of compression [J]."""
        return sum(checks.kinetic_and_potential(self.simulation, totals)), self.simulation.fluid.internal_energy()

    def energy_violations(self, totals: Totals) -> Iterator[str]:
        """Yield a sentence for each excess of energy. An unstable scheme gains energy long before a particle leaves its
        bounds. Stiff water may also turn compression in its initial lattice into motion."""
        if self.judges_energy:
            fluid, bound = self.simulation.fluid, self.config.max_energy_gain
            scale = with_particles(fluid).particles.mass * self.n * fluid.reference_speed**2
            moved, squeezed = (now - then for now, then in zip(self.energy_parts(totals), self.first_energy))
            gain, given = (moved + squeezed) / scale, (moved - self.stored) / scale
            self.energy_time = self.simulation.time
            if not gain <= GAIN_REPORTED:
                self.record_once("energy from nowhere", over_m_v2=round(gain, 6), bound=bound)
            of = f"of its mass times the square of {fluid.reference_speed:.4g} m/s (bound {100.0 * bound:g} %)"
            if not gain <= bound:
                cure = "try a larger fluid.kinematic_viscosity, or a shorter time step"
                yield self.failure_sentence(f"the water gained energy from nowhere, {100.0 * gain:.3g} % {of}", cure)
            if not given <= bound:
                what = f"the water rises or moves with nothing to drive it: it gained {100.0 * given:.3g} % {of}"
                yield self.failure_sentence(what, self.suggest_cure())

    def failure_sentence(self, what: str, cure: str) -> str:
        """Sentence for the user: the failure `what`, its time, how to avoid it (`cure`), the last good frame file."""
        simulation = self.simulation
        return f"{what}, t = {simulation.time:.4f} s, step {simulation.steps}; {cure}{self.name_last_frame()}"

    def describe_failure(self, what: str, position: np.ndarray, worst: Iterable[int]) -> str:
        """Sentence for the user: the failure `what`, and `position` [m] of the particles with indices `worst`."""
        where = "".join(f" at ({', '.join(f'{x:.4g}' for x in position[i])}) m" for i in worst)
        return self.failure_sentence(f"{what}{where}", self.suggest_cure())

    def suggest_cure(self) -> str:
        """Advice to the user on avoiding the likeliest cause of a failure, such as a stiffness or a shorter step."""
        fluid, basin, scene = self.simulation.fluid, self.simulation.basin, self.simulation.scene
        pull = float(np.linalg.norm(basin.gravity))
        if fluid.sound_speed == 0.0:
            return "particles of this fluid ignore each other: try a weaker wind, walls around the basin, or a floor"
        held = 0.01 * fluid.sound_speed**2 / pull if pull > 0.0 else float("inf")  # depth at 1 % compression [m]
        if held < 0.1 * basin.depth:
            stiffness, wanted = fluid.sound_speed**2, FIRM_STIFFNESS_RATIO * pull * basin.depth  # [m^2/s^2]
            begin = f"stiffness {stiffness:.4g} m^2/s^2 holds only {held:.2g} m of water within 1 % and the basin is"
            return f"{begin} {basin.depth:g} m deep: try fluid.compression: 0.01, or a stiffness of {wanted:.4g}"
        needed = FIRM_STIFFNESS_RATIO * fluid.reference_speed**2  # [m2/s2] for 1 %
        if fluid.sound_speed**2 >= EXCESS_STIFFNESS_RATIO * needed:
            times = f"{fluid.sound_speed**2 / needed:.3g} times that of 1 % compression"
            return f"stiffness {fluid.sound_speed**2:.4g} m^2/s^2 is {times}: try fluid.compression: 0.01"
        limit, shortest = min(asdict(fluid.limits()).items(), key=lambda item: item[1])
        return scene.time_step.advice(limit, shortest)

    def name_last_frame(self) -> str:
        """Clause that names the newest frame file, the last good state; empty without frames."""
        frames = [] if self.folder is None else sorted((self.folder / "frames").glob("frame_*.npz"))
        return f"; the last picture before is frames/{frames[-1].name}" if frames else ""

    def judge_hulls(self, simulation: Simulation) -> None:
        """Raise Diverged if the hulls of two ships overlap: contact between hulls is not modelled."""
        if len(simulation.ships) < 2:
            return
        there = [(name, found) for name, ship in simulation.ships.items() if (found := ship.outline()) is not None]
        repeats = simulation.scene.preflight.repeats
        for (name, one), (other_name, other) in combinations(there, 2):
            image = max(other.images(one, repeats), key=one.overlap)
            depth = one.overlap(image)
            if depth > 0.0:
                x, z = one.middle(image)
                what = f"the hulls of {name} and {other_name} reach {depth:.3g} m into each other at"
                cure = "contact between hulls is not modelled: keep them apart"
                raise Diverged(self.failure_sentence(f"{what} ({x:.4g}, {z:.4g}) m", cure))

    def note_rim(self, simulation: Simulation) -> None:
        """Record an event if one of several ships is in the rim, relaxed to the open sea, of a patch of that sea."""
        if len(simulation.ships) < 2:
            return
        at = np.array([ship.body.position[[0, 2]] for ship in simulation.ships.values()])
        for (name, ship), inside in zip(simulation.ships.items(), simulation.fluid.in_rim(at), strict=True):
            if inside:
                event = "the ships are too far apart for their patch: one is in its rim"
                self.record_once(event, **ship_facts(name, ship))

    def note_ships(self, simulation: Simulation) -> None:
        """Record an event for each ship whose keel touches the bed, or which leaves the water or meets it again."""
        for name, ship in simulation.ships.items():
            grounding, flight = f"grounding of {name}", f"flight of {name}"
            if ship.airborne:
                self.flown[name] = float(ship.body.velocity[1])
            if (ship.groundings, ship.airborne) == (self.recorded[grounding], self.recorded[flight]):
                continue
            facts = ship_facts(name, ship)
            self.record_change(grounding, ship.groundings, "the hull meets the bed", **facts)
            self.recorded[grounding] = ship.groundings
            event, speed = f"the hull {'leaves' if ship.airborne else 'meets'} the water", round(self.flown[name], 3)
            self.record_change(flight, ship.airborne, event, **facts, speed_m_s=speed)

    def note_clipping(self, simulation: Simulation) -> None:
        """Record an event if more particles have had their motion in one step cut to the limit `motion_limit`."""
        clipped = simulation.fluid.status.clipped
        if simulation.outcome != "running":
            self.event_times["clipped"] = -EVENT_INTERVAL
        since_last = int(clipped - self.recorded["clipped"])
        self.record_change("clipped", clipped, "clipped", particles=since_last, since_start=int(clipped))

    def close(self) -> None:
        outcome = self.simulation.outcome
        if self.n > 0 and outcome != "failed":
            self.note_clipping(self.simulation)
        self.record_event(outcome, **({"reason": self.simulation.reason} if self.simulation.reason else {}))
        if self.events is not None:
            self.events.close()

    def amend(self) -> None:
        """Rewrite the event at the run's end: files made after the run (pictures, say) may have changed the outcome."""
        if self.events is not None:
            self.events = Path(self.events.name).open("a", encoding="utf-8")
            self.close()


def ship_facts(name: str, ship: Ship) -> dict[str, object]:
    """Facts about a ship for an event: her name, unless she is the only one, and x, z [m]."""
    x, _, z = ship.body.position
    which = {} if name == ALONE else {"ship": name}
    return which | {"x_m": round(float(x), 3), "z_m": round(float(z), 3)}
