"""A scene that is played with from pages: stepped in the thread that built it, told by the commands that come in."""

import json
from collections.abc import Callable, Mapping
from contextlib import ExitStack, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from ocean_sim import machine
from ocean_sim.conventions import Diverged, Failed, Refused, in_words
from ocean_sim.files import input_file, run_files
from ocean_sim.files.atomic_file import atomic_write
from ocean_sim.files.run_files import Claim
from ocean_sim.files.yaml_file import MAX_TEXT_BYTES, Node, SceneError, parse_mapping, parse_setting
from ocean_sim.parts import library, named
from ocean_sim.pictures.live.panel import Panel
from ocean_sim.reading.scene import SceneConfig, load_text, packaged_scenes, scene_path
from ocean_sim.runtime import base_memory
from ocean_sim.simulation import Simulation
from ocean_sim.viewer import protocol as p
from ocean_sim.viewer.answers import answer, keys
from ocean_sim.viewer.server import Order
from ocean_sim.viewer.sliders import Slider, bound, sliders_of
from ocean_sim.viewer.watch import Audience, Watch

if TYPE_CHECKING:
    from ocean_sim.ship import Ship
    from ocean_sim.ship.forces.propulsion import Helmsman, Person

BUDGET = 0.04  # [s] of steps between two looks at what has come in
NAP = 0.05  # [s] to wait for commands where there is nothing to do
ALWAYS = ("gauges", "motion", "health")  # observers that play along; files of theirs go to a folder that is thrown away
RIG = ("platform_log", "stream")  # and these where a scene names `stream`: who sits on the platform has the helm
SCENE = "of the scene"  # a wind that is not a preset
LEAST_BEHIND = 0.1  # [s] of wall time that a simulation which is too slow for its speed may lag behind


class Desk(Audience, Protocol):
    """Where commands come from and answers go to."""

    arrived: Any
    fresh: bool

    def orders(self) -> list[Order]: ...
    def tell(self, watcher: int | None, **message: Any) -> None: ...


class Source(NamedTuple):
    """What is played: a text, its name and folder, and what is laid over it."""

    text: str
    name: str
    folder: Path
    profile: str | None = None
    overrides: Mapping[str, Any] = {}

    @classmethod
    def of(cls, scene: str | Path, profile: str | None = None, overrides: Mapping[str, Any] | None = None) -> "Source":
        path = scene_path(scene)
        return cls(input_file.read_text(path, MAX_TEXT_BYTES), path.stem, path.parent, profile, dict(overrides or {}))

    def load(self) -> SceneConfig:
        """The scene; raises SceneError with every problem, located in the text."""
        return load_text(self.text, self.name, self.folder, dict(self.overrides), self.profile)


class Session:
    """One simulation after another, each with a `Watch`; use it as a context manager."""

    simulation: Simulation

    def __init__(self, source: Source, desk: Desk, out: Path, described: Callable[[], list[dict[str, str]]]) -> None:
        """`out`: where records and saved scenes go; `described`: what a page lists of packaged scenes."""
        self.source, self.desk, self.out, self.described = source, desk, out, described
        self.panel = Panel([*named("wind"), "still"], "")
        self.sliders: list[Slider] = []
        self.speed, self.due = 1.0, 0.0
        self.plays = False  # whether a simulation is open
        self.away: TemporaryDirectory | None = None
        self.claim: Claim | None = None  # of the run folder of a record
        self.touched: list[str] = []  # what was set by hand in a record
        self.moved: dict[str, float] = {}  # sliders, by label
        self.persons: dict[str, Person] = {}  # who steer by hand, by ship
        self.pilots: dict[str, Helmsman] = {}  # who sail a route
        self.sailed: dict[str, int] = {}  # on which leg they were last
        self.done = False
        self.start(fitting(source))

    def start(self, config: SceneConfig, folder: Path | None = None) -> None:
        """Build a simulation, whose files go to a folder that is thrown away unless one is given."""
        self.config = config
        if folder is None:
            self.away = TemporaryDirectory(prefix="ocean-sim-")
            playing = (*ALWAYS, *RIG) if "stream" in config.observers else ALWAYS
            kept = {name: part for name, part in config.observers.items() if name in playing}
            config = config.model_copy(update={"observers": kept})
        self.simulation = Simulation(config, folder or Path(self.away.name))  # type: ignore[union-attr]
        self.plays = True
        self.watch = Watch(self.simulation, self.desk)
        self.simulation.observers.append(self.watch)
        self.panel.wind = wind_name(self.source)
        self.sliders = bound(sliders_of(self.simulation), self.sliders)
        self.panel.message, self.persons, self.pilots, self.due = "", {}, {}, 0.0
        self.report()
        self.watch.show(perf_counter())

    def end(self) -> None:
        """Close what is played, and let go of its folder."""
        if not self.plays:
            return
        simulation, claim, touched, away = self.simulation, self.claim, self.touched, self.away
        self.plays, self.claim, self.touched, self.away = False, None, [], None
        with ExitStack() as last:
            if away is not None:
                last.callback(away.cleanup)
            if claim is not None:
                last.callback(claim.close)
                last.callback(self.say, f"recorded: {claim.folder}")
            last.callback(simulation.close)
            if claim is not None:
                simulation.outcome = "done" if simulation.outcome == "running" else simulation.outcome
                if touched:
                    with atomic_write(claim.folder / "touched.txt") as draft:
                        draft.write_text("\n".join([*touched, ""]), encoding="utf-8")
                    run_files.add_to_manifest(claim.folder, [claim.folder / "touched.txt"])

    def play(self) -> None:
        """Go on until it is ended, by an interrupt or by `done`."""
        last = perf_counter()
        while not self.done:
            now = perf_counter()
            wall, last = now - last, now
            self.desk.arrived.clear()
            self.obey()
            self.go_on(wall)

    def go_on(self, wall: float) -> None:
        """Steps for so much wall time as has gone by [s], as many as there is time for."""
        panel, begin = self.panel, perf_counter()
        if panel.take("step"):
            self.step()
            self.watch.show(perf_counter())
        if panel.paused:
            if self.desk.fresh and self.desk.watchers:
                self.watch.show(perf_counter())
            self.desk.arrived.wait(NAP)
            return
        fast = self.speed == 0.0
        self.due = 0.0 if fast else min(self.due + wall * self.speed, LEAST_BEHIND * self.speed)
        while (fast or self.due > 0.0) and not panel.paused and perf_counter() - begin < BUDGET:
            self.due -= self.simulation.next_dt
            self.step()
        if not fast and self.due <= 0.0 and not panel.paused:
            self.desk.arrived.wait(min(-self.due / self.speed, NAP))

    def step(self) -> None:
        """One step; a simulation that leaves the physical world, or a record that is complete, stops here."""
        simulation = self.simulation
        try:
            simulation.run(simulation.time + 0.5 * simulation.next_dt)
            self.follow()
        except Diverged as failure:
            self.panel.paused, self.panel.message = True, f"diverged: {failure}. Reset starts again."
            self.watch.show(perf_counter())
            self.report()
        except OSError as failure:
            if self.claim is None:
                raise
            self.panel.paused = True
            self.rebuild(self.source)
            self.say(f"the record ends: {in_words(failure)}", bad=True)
        if self.claim is not None and simulation.time >= self.config.duration:
            self.panel.paused = True
            self.rebuild(self.source)

    def follow(self) -> None:
        """Say how far along their routes ships are; at the end of one the rudder goes amidships."""
        simulation = self.simulation
        for name, pilot in list(self.pilots.items()):
            if pilot.has_arrived(simulation.ships[name].body):
                self.amidships(name)
                self.say(f"{name}: the end of the route")
                self.report()
            elif self.sailed.get(name) != pilot.leg:
                self.sailed[name] = pilot.leg
                self.report()

    def obey(self) -> None:
        """What has come in; the newest of those that replace one another."""
        orders = self.desk.orders()
        last = {replaces(order): k for k, order in enumerate(orders)}
        changed = False
        for k, order in enumerate(orders):
            if last[replaces(order)] != k and replaces(order)[0]:
                continue
            try:
                changed = self.take(order) or changed
            except SceneError as error:
                self.problems(order.watcher, error)
                self.say(next(map(str, error.problems), error.sentence), order.watcher, bad=True)
            except Failed as error:
                self.say(error.sentence, order.watcher, bad=True)
            except (OSError, MemoryError, RuntimeError) as error:
                if not self.plays:
                    raise
                self.say(in_words(error), order.watcher, bad=True)
        if changed:
            self.report()

    def take(self, order: Order) -> bool:
        """Do what a command says; whether the panel has changed."""
        command, panel = order.command, self.panel
        match command:
            case p.Act(do="pause" | "play"):
                panel.paused = command.do == "pause"
                self.watch.show(perf_counter())
            case p.Act(do="step"):
                panel.do("step")
            case p.Act(do="reset" | "stop"):
                self.rebuild(self.source)
            case p.Act(do="record"):
                self.record()
            case p.Act(do="scene"):
                self.tell_scene(order.watcher)
            case p.Act(do="scenes"):
                self.desk.tell(order.watcher, type="scenes", rows=self.described())
            case p.Act(do="keys"):
                self.desk.tell(order.watcher, type="keys", rows=keys(self.config))
            case p.Waves():
                self.tell_waves(order.watcher, command)
            case p.Speed(value=value):
                self.speed, self.due = value, 0.0
            case p.Slide(key=label, value=value):
                slider = next((each for each in self.sliders if each.label == label), None)
                if slider is None:
                    raise Failed(f"there is no slider {label!r} here")
                slider.move(value)
                self.moved[label] = slider.value
                self.note(f"{label} = {slider.value:g}")
            case p.Steer(ship=ship, throttle=throttle, rudder=rudder):
                sailed = ship in self.pilots
                self.person(ship).give(throttle, rudder)
                self.note(f"{ship}: throttle {throttle:g}, rudder {rudder:g} rad")
                return sailed
            case p.Route(ship=ship, points=points, speed=speed):
                if points:
                    self.sail(ship, points, speed)
                    self.note(f"{ship}: route {points} at {speed:g} m/s")
                else:
                    self.amidships(ship)
                    self.note(f"{ship}: no route")
            case p.Wind(name=name):
                if name not in panel.winds:
                    raise Failed(f"there is no wind {name!r}")
                rest = {key: value for key, value in self.source.overrides.items() if key.split(".")[0] != "wind"}
                self.rebuild(self.source._replace(overrides=rest | {"wind": name}))
            case p.Change(key=key, value=value):
                path, node = parse_setting(f"{key}={value}")
                self.rebuild(self.source._replace(overrides={**self.source.overrides, path: node}))
            case p.Check(text=text):
                self.check(order.watcher, text)
            case p.Apply(text=text):
                self.rebuild(self.source._replace(text=text, overrides={}))
                self.desk.tell(order.watcher, type="problems", problems=[])
            case p.Open(name=name):
                if name not in packaged_scenes():
                    raise Failed(f"there is no scene {name!r}")
                source = Source.of(library("scenes") / f"{name}.yaml", self.source.profile)
                fitting(source)
                self.moved = {}
                self.sliders = []
                self.rebuild(source)
                self.tell_scene(None)
            case p.Save(name=name):
                self.save(name)
        return command.do not in (*p.LOOKS, "save")

    def person(self, name: str) -> "Person":
        """Who steers a ship by hand from now on; raises Failed."""
        ship = self.ship(name)
        self.pilots.pop(name, None)
        if name not in self.persons:
            self.persons[name] = ship.hand_over()
        return self.persons[name]

    def amidships(self, name: str) -> None:
        """Steer a ship by hand, with the throttle as it is and the rudder amidships; raises Failed."""
        person = self.person(name)
        person.give(person.throttle, 0.0)

    def sail(self, name: str, route: list[tuple[float, float]], speed: float) -> None:
        """A pilot sails a ship along waypoints from now on; raises Failed."""
        ship = self.ship(name)
        self.persons.pop(name, None)
        self.pilots[name], self.sailed[name] = ship.sail(route, speed), 0

    def ship(self, name: str) -> "Ship":
        """A ship by its name; raises Failed."""
        if name not in self.simulation.ships:
            raise Failed(f"there is no ship {name!r} here")
        return self.simulation.ships[name]

    def rebuild(self, source: Source, folder: Path | None = None) -> bool:
        """Play a source from its beginning; the one that is played goes on where it cannot be loaded or is too large,
        and begins again where another cannot be built. True if the source is played."""
        more = {} if folder is None else {"render": None}
        config = fitting(source._replace(overrides={**source.overrides, **more}))
        self.say("building anew ...")
        before, built, said = (self.source, self.config), False, []
        try:
            self.end()
        except Exception as failure:
            said.append(in_words(failure))
        try:
            self.source = source
            self.start(config, folder)
            built = True
        except Exception as failure:
            said.append(in_words(failure))
        if not built:
            with suppress(Exception):
                self.end()
            self.source, config = before
            self.start(config)
        self.say("; ".join(said), bad=bool(said))
        return built

    def record(self) -> None:
        """Begin anew, and keep the whole run folder."""
        folder = next(path for k in range(1, 10_000) if not (path := self.out / f"{self.source.name}-{k}").exists())
        claim = Claim(folder)
        with ExitStack() as failed:
            failed.callback(claim.close)
            if not self.rebuild(self.source, folder):
                return
            failed.pop_all()
        self.claim, self.panel.paused = claim, False
        for label, value in self.moved.items():
            self.note(f"{label} = {value:g}")
        self.say(f"recording {self.config.duration:g} s into {folder}")

    def note(self, what: str) -> None:
        """Keep what was set by hand in a record: its scene does not say it."""
        if self.claim is not None and self.plays:
            self.touched.append(f"t = {self.simulation.time:.6f} s: {what}")

    def check(self, watcher: int, text: str) -> None:
        """Of a text that is being written: its problems stand at their lines, and nowhere else."""
        try:
            self.source._replace(text=text, overrides={}).load()
        except SceneError as error:
            self.problems(watcher, error)
        else:
            self.desk.tell(watcher, type="problems", problems=[])

    def problems(self, watcher: int, error: SceneError) -> None:
        """What is wrong with a scene, at its lines."""
        rows = [each._asdict() for each in error.problems[:100]]
        self.desk.tell(watcher, type="problems", problems=rows)

    def save(self, name: str) -> None:
        """The scene as it is played: its text, or where more was set than it says, all of its keys."""
        path = self.out / f"{name}.yaml"
        if path.exists():
            raise Failed(f"{path}: there is such a file already; choose another name")
        moved = [f"# set by hand: {label} = {value:g}" for label, value in self.moved.items()]
        body = self.source.text
        if self.source.overrides or self.source.profile:
            body = "\n".join(f"{key}: {json.dumps(value)}" for key, value in self.config.resolved().items())
        self.out.mkdir(parents=True, exist_ok=True)
        with atomic_write(path) as draft:
            draft.write_text("\n".join([*moved, body.rstrip(), ""]), encoding="utf-8")
        self.say(f"saved: {path}")

    def tell_waves(self, watcher: int, asked: p.Waves) -> None:
        """What the water does, to who asked."""
        try:
            found = answer(self.simulation.fluid, self.simulation.time, asked)
        except Refused as refusal:
            found = {"error": refusal.sentence}
        self.desk.tell(watcher, type="waves", id=asked.id, verb=asked.verb, **found)

    def tell_scene(self, watcher: int | None) -> None:
        """The text that is played, and what is laid over it."""
        laid = [f"{key}={plain(value)}" for key, value in self.source.overrides.items()]
        self.desk.tell(watcher, type="scene", name=self.source.name, text=self.source.text, sets=laid)

    def say(self, text: str, watcher: int | None = None, bad: bool = False) -> None:
        self.desk.tell(watcher, type="said", text=text, bad=bad)

    def report(self) -> None:
        """Tell everybody what may be set, and how it stands."""
        simulation, panel = self.simulation, self.panel
        sliders = [{"label": s.label, "value": s.value, "low": s.low, "high": s.high} for s in self.sliders]
        ships = [
            {"name": name, "throttle": ship.orders[0], "rudder": ship.orders[1], "route": self.route(name)}
            for name, ship in simulation.ships.items()
        ]
        self.desk.tell(
            None,
            type="panel",
            paused=panel.paused,
            speed=self.speed,
            wind=panel.wind,
            winds=[*([panel.wind] if panel.wind == SCENE else []), *panel.winds],
            sliders=sliders,
            ships=ships,
            message=panel.message,
            recording=str(self.claim.folder) if self.claim is not None else "",
            scene=self.source.name,
            duration=self.config.duration,
        )

    def route(self, name: str) -> list[tuple[float, float]]:
        """The waypoints that a ship has ahead."""
        return self.pilots[name].ahead if name in self.pilots else []

    def __enter__(self) -> "Session":
        return self

    def __exit__(self, *failure: object) -> None:
        with suppress(Failed):
            self.end()


def fitting(source: Source) -> SceneConfig:
    """Load a scene; raises Refused where it takes more memory than this process can have."""
    config = source.load()
    parts = [row.bytes for row in config.ledger() if row.part not in config.observers]
    taken, left = base_memory(config.preflight.particles) + sum(parts), machine.available_memory()
    if taken > left:
        raise Refused(
            f"this scene takes {taken / 1e9:.1f} GB of memory, and {left / 1e9:.1f} GB are left; try a larger "
            "resolution, or fewer particles"
        )
    return config


def wind_name(source: Source) -> str:
    """The preset of wind that a source names, or that it is the scene's own."""
    written = parse_mapping(source.text, source.name).data.get("wind")
    wind = source.overrides.get("wind", written)
    name = plain(wind)
    if any(key.startswith("wind.") for key in source.overrides) or not isinstance(name, str | None):
        return SCENE
    return name or "still"


def plain(value: Any) -> Any:
    """What was laid over a scene, without where it was written."""
    return value.plain() if isinstance(value, Node) else value


def replaces(order: Order) -> tuple[str, ...]:
    """What a command has in common with those that it replaces; empty words where it replaces none."""
    command = order.command
    if isinstance(command, p.Slide):
        return ("slide", command.key)
    if isinstance(command, p.Steer):
        return ("steer", command.ship)
    return ("speed",) if isinstance(command, p.Speed) else ("", str(id(order)))
