"""Session of a scene that open pages control. It steps the simulation in the thread that built it, and executes the
pages' commands between steps."""

import json
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, ExitStack, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import TYPE_CHECKING, Any, NamedTuple

from ocean_sim import machine
from ocean_sim.conventions import Diverged, Failed, Refused, in_words
from ocean_sim.files import input_file, run_files
from ocean_sim.files.atomic_file import write_file
from ocean_sim.files.run_files import Claim
from ocean_sim.files.yaml_file import MAX_TEXT_BYTES, Node, SceneError, parse_mapping, parse_setting
from ocean_sim.parts import library, named
from ocean_sim.reading.scene import SceneConfig, load_text, packaged_scenes, scene_path
from ocean_sim.runtime import base_memory
from ocean_sim.simulation import Simulation
from ocean_sim.viewer import protocol as p
from ocean_sim.viewer.answers import answer_waves, key_table
from ocean_sim.viewer.server import Order, Server
from ocean_sim.viewer.sliders import Slider, sliders_of
from ocean_sim.viewer.watch import Watch

if TYPE_CHECKING:
    from ocean_sim.ship import Ship
    from ocean_sim.ship.forces.propulsion import Helmsman, Person

STEP_BUDGET = 0.04  # [s] of wall time, between two looks at the commands
IDLE_WAIT = 0.05  # [s] for commands when nothing is due
PLAYED_OBSERVERS = ("gauges", "motion", "health", "platform_log", "stream")  # their files go to a temporary folder
SCENE_WIND = "of the scene"  # a wind that is not a preset
MAX_LAG = 0.1  # [s] of wall time, of a simulation that is too slow for its speed


class Source(NamedTuple):
    """Scene to play, as text: with its name and folder, profile and overrides."""

    text: str
    name: str
    folder: Path
    profile: str | None = None
    overrides: Mapping[str, Any] = {}

    @classmethod
    def of(cls, scene: str | Path, profile: str | None = None, overrides: Mapping[str, Any] | None = None) -> "Source":
        """Source from a scene file's path or a packaged scene's name; profile and overrides are applied by `load`."""
        path = scene_path(scene)
        return cls(input_file.read_text(path, MAX_TEXT_BYTES), path.stem, path.parent, profile, dict(overrides or {}))

    def load(self) -> SceneConfig:
        """Config of the scene in the text; raises SceneError with all problems and their positions in the text."""
        return load_text(self.text, self.name, self.folder, dict(self.overrides), self.profile)


class Session(AbstractContextManager["Session"]):
    """Player of one scene after another, shown on pages by a `Watch`; executes their commands. A context manager."""

    simulation: Simulation

    def __init__(
        self, source: Source, server: Server, out: Path, described: Callable[[], list[dict[str, str]]]
    ) -> None:
        """Start a scene. `out`: folder of recorded runs and saved scenes; `described`: rows on packaged scenes."""
        self.source, self.server, self.out, self.described = source, server, out, described
        self.paused, self.message = False, ""  # and a sentence about the last failure
        self.winds, self.wind = [*named("wind"), "still"], ""  # names of presets, and of the one that blows
        self.sliders: list[Slider] = []
        self.speed, self.due = 1.0, 0.0
        self.plays = False  # True: a simulation is open
        self.away: TemporaryDirectory | None = None
        self.claim: Claim | None = None  # of the run folder of a record
        self.touched: list[str] = []  # settings by hand in a record
        self.moved: dict[str, float] = {}  # sliders, by label
        self.persons: dict[str, Person] = {}  # hand steering, by ship
        self.pilots: dict[str, Helmsman] = {}  # on a route, by ship
        self.sailed: dict[str, int] = {}  # last leg of each pilot
        self.done = False
        self.start(load_within_memory(source))

    def start(self, config: SceneConfig, folder: Path | None = None) -> None:
        """Build the simulation of a scene; its files go to `folder`, or to a temporary folder."""
        self.config = config
        if folder is None:
            self.away = TemporaryDirectory(prefix="ocean-sim-")
            kept = {name: part for name, part in config.observers.items() if name in PLAYED_OBSERVERS}
            config = config.model_copy(update={"observers": kept})
        self.simulation = Simulation(config, folder or Path(self.away.name))  # type: ignore[union-attr]
        self.plays = True
        self.watch = Watch(self.simulation, self.server)
        self.watch.paced = True
        self.simulation.observers.append(self.watch)
        self.wind = wind_name(self.source)
        self.sliders = sliders_of(self.simulation)
        for slider in self.sliders:
            slider.move(self.moved.get(slider.label, slider.value))
        self.message, self.persons, self.pilots, self.due = "", {}, {}, 0.0
        self.tell_panel()
        self.watch.show(perf_counter())

    def end(self) -> None:
        """Close the simulation: complete its record, if any, and remove or release its folder."""
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
                    write_file(claim.folder / "touched.txt", "\n".join([*touched, ""]))
                    run_files.add_to_manifest(claim.folder, [claim.folder / "touched.txt"])

    def play(self) -> None:
        """Execute the pages' commands and step, until a keyboard interrupt or until `done` is set."""
        last = perf_counter()
        while not self.done:
            now = perf_counter()
            wall, last = now - last, now
            self.server.arrived.clear()
            self.obey()
            self.advance(wall)

    def advance(self, wall: float) -> None:
        """Step, for at most STEP_BUDGET, to keep up with the real time `wall` [s] since the last call, or wait."""
        begin = perf_counter()
        if self.paused or not (self.simulation.steps or self.server.watchers):  # the first step waits for a page
            if self.server.fresh and self.server.watchers:
                self.watch.show(perf_counter())
            self.server.arrived.wait(IDLE_WAIT)
            return
        fast = self.speed == 0.0
        self.due = 0.0 if fast else min(self.due + wall * self.speed, MAX_LAG * self.speed)
        while (fast or self.due > 0.0) and not self.paused and perf_counter() - begin < STEP_BUDGET:
            self.due -= self.simulation.next_dt
            self.step()
        if not fast and self.due <= 0.0 and not self.paused:
            self.server.arrived.wait(min(-self.due / self.speed, IDLE_WAIT))

    def step(self) -> None:
        """Take one time step; pause if it diverges or reaches the scene's end, which completes a record (its run
        folder). A record that cannot be written ends."""
        simulation, ending = self.simulation, self.simulation.time < self.config.duration
        try:
            simulation.run(simulation.time + 0.5 * simulation.next_dt)
            self.follow_routes()
        except Diverged as failure:
            self.paused, self.message = True, f"diverged: {failure}. Reset starts again."
            self.watch.show(perf_counter())
            self.tell_panel()
        except OSError as failure:
            if self.claim is None:
                raise
            self.paused = True
            self.rebuild(self.source)
            self.say(f"the record ends: {in_words(failure)}", bad=True)
        if ending and simulation.time >= self.config.duration:
            self.paused = True
            if self.claim is not None:
                self.rebuild(self.source)
            else:
                self.say(f"The scene ends at {self.config.duration:g} s; play goes on beyond it.")
            self.tell_panel()

    def follow_routes(self) -> None:
        """Tell the pages when a ship begins the next leg of her route; at the route's end, put her rudder amidships."""
        for name, pilot in list(self.pilots.items()):
            if pilot.has_arrived(self.simulation.ships[name].body):
                self.steer_amidships(name)
                self.say(f"{name}: the end of the route")
                self.tell_panel()
            elif self.sailed.get(name) != pilot.leg:
                self.sailed[name] = pilot.leg
                self.tell_panel()

    def obey(self) -> None:
        """Execute the pages' new commands; of several that replace each other (moves of one slider), only the last."""
        orders = self.server.orders()
        last = {replacement_key(order): k for k, order in enumerate(orders)}
        changed = False
        for k, order in enumerate(orders):
            if last[replacement_key(order)] != k and replacement_key(order)[0]:
                continue
            try:
                changed = self.execute(order) or changed
            except SceneError as error:
                self.tell_problems(order.watcher, error)
                self.say(next(map(str, error.problems), error.sentence), order.watcher, bad=True)
            except Failed as error:
                self.say(error.sentence, order.watcher, bad=True)
            except (OSError, MemoryError, RuntimeError) as error:
                if not self.plays:
                    raise
                self.say(in_words(error), order.watcher, bad=True)
        if changed:
            self.tell_panel()
            if self.paused:
                self.watch.show(perf_counter())

    def execute(self, order: Order) -> bool:
        """Execute a command; True if pages need the panel (`tell_panel`) anew. Raises Failed if it is impossible."""
        command = order.command
        match command:
            case p.Act(do="pause" | "play"):
                self.paused = command.do == "pause"
            case p.Act(do="step"):
                self.paused = True
                self.step()
            case p.Act(do="reset" | "stop"):
                self.rebuild(self.source)
            case p.Act(do="record"):
                self.record()
            case p.Act(do="scene"):
                self.tell_scene(order.watcher)
            case p.Act(do="scenes"):
                self.server.tell(order.watcher, type="scenes", rows=self.described())
            case p.Act(do="keys"):
                self.server.tell(order.watcher, type="keys", rows=key_table(self.config))
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
                self.note_setting(f"{label} = {slider.value:g}")
            case p.Steer(ship=ship, throttle=throttle, rudder=rudder):
                sailed = ship in self.pilots
                self.hand_steering(ship).give(throttle, rudder)
                self.note_setting(f"{ship}: throttle {throttle:g}, rudder {rudder:g} rad")
                return sailed
            case p.Route(ship=ship, points=points, speed=speed):
                if points:
                    pilot = self.ship_named(ship).sail(points, speed)
                    self.persons.pop(ship, None)
                    self.pilots[ship], self.sailed[ship] = pilot, 0
                    self.note_setting(f"{ship}: route {points} at {speed:g} m/s")
                else:
                    self.steer_amidships(ship)
                    self.note_setting(f"{ship}: no route")
            case p.Choose(do="wind", name=name):
                if name not in self.winds:
                    raise Failed(f"there is no wind {name!r}")
                rest = {key: value for key, value in self.source.overrides.items() if key.split(".")[0] != "wind"}
                self.rebuild(self.source._replace(overrides=rest | {"wind": name}))
            case p.Change(key=key, value=value):
                path, node = parse_setting(f"{key}={value}")
                self.rebuild(self.source._replace(overrides={**self.source.overrides, path: node}))
            case p.Write(do="check", text=text):
                self.check_text(order.watcher, text)
            case p.Write(text=text):
                self.rebuild(self.source._replace(text=text, overrides={}))
                self.server.tell(order.watcher, type="problems", problems=[])
            case p.Choose(name=name):
                if name not in packaged_scenes():
                    raise Failed(f"there is no scene {name!r}")
                source = Source.of(library("scenes") / f"{name}.yaml", self.source.profile)
                load_within_memory(source)
                self.moved = {}
                self.rebuild(source)
                self.tell_scene(None)
            case p.Save(name=name):
                self.save_scene(name)
        return command.do not in (*p.QUERY_NAMES, "save")

    def hand_steering(self, name: str) -> "Person":
        """Put the ship of this name under hand steering and return its `Person`; raises Failed without such a ship."""
        ship = self.ship_named(name)
        self.pilots.pop(name, None)
        if name not in self.persons:
            self.persons[name] = ship.hand_over()
        return self.persons[name]

    def steer_amidships(self, name: str) -> None:
        """Steer a ship by hand: rudder amidships, throttle as it is. Raises Failed if there is no ship of this name."""
        person = self.hand_steering(name)
        person.give(person.throttle, 0.0)

    def ship_named(self, name: str) -> "Ship":
        if name not in self.simulation.ships:
            raise Failed(f"there is no ship {name!r} here")
        return self.simulation.ships[name]

    def rebuild(self, source: Source, folder: Path | None = None) -> bool:
        """Play a source in place of the present one; True on success. A scene that cannot be loaded leaves the present
        one running; one that cannot be built restarts it."""
        more = {} if folder is None else {"render": None}
        config = load_within_memory(source._replace(overrides={**source.overrides, **more}))
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
        """Restart the scene with its files in a run folder that is kept, and tell the pages the folder's name."""
        folder = next(path for k in range(1, 10_000) if not (path := self.out / f"{self.source.name}-{k}").exists())
        claim = Claim(folder)
        with ExitStack() as failed:
            failed.callback(claim.close)
            if not self.rebuild(self.source, folder):
                return
            failed.pop_all()
        self.claim, self.paused = claim, False
        for label, value in self.moved.items():
            self.note_setting(f"{label} = {value:g}")
        self.say(f"recording {self.config.duration:g} s into {folder}")

    def note_setting(self, what: str) -> None:
        """Note in the record, if there is one, a setting `what` made by hand, since the recorded scene lacks it."""
        if self.claim is not None and self.plays:
            self.touched.append(f"t = {self.simulation.time:.6f} s: {what}")

    def check_text(self, watcher: int, text: str) -> None:
        """Check a scene's text from the editor, and send the problems, if any, to page number `watcher`."""
        try:
            self.source._replace(text=text, overrides={}).load()
        except SceneError as error:
            self.tell_problems(watcher, error)
        else:
            self.server.tell(watcher, type="problems", problems=[])

    def tell_problems(self, watcher: int, error: SceneError) -> None:
        self.server.tell(watcher, type="problems", problems=[each._asdict() for each in error.problems[:100]])

    def save_scene(self, name: str) -> None:
        """Save the scene being played as `name`.yaml: text, or all keys if some are overridden. Failed if it exists."""
        path = self.out / f"{name}.yaml"
        if path.exists():
            raise Failed(f"{path}: there is such a file already; choose another name")
        moved = [f"# set by hand: {label} = {value:g}" for label, value in self.moved.items()]
        body = self.source.text
        if self.source.overrides or self.source.profile:
            body = "\n".join(f"{key}: {json.dumps(value)}" for key, value in self.config.resolved().items())
        write_file(path, "\n".join([*moved, body.rstrip(), ""]))
        self.say(f"saved: {path}")

    def tell_waves(self, watcher: int, asked: p.Waves) -> None:
        try:
            found = answer_waves(self.simulation.fluid, self.simulation.time, asked)
        except Refused as refusal:
            found = {"error": refusal.sentence}
        self.server.tell(watcher, type="waves", id=asked.id, verb=asked.verb, **found)

    def tell_scene(self, watcher: int | None) -> None:
        """Send text and overrides of the scene being played to page number `watcher`, or to all (None)."""
        laid = [f"{key}={plain_value(value)}" for key, value in self.source.overrides.items()]
        self.server.tell(watcher, type="scene", name=self.source.name, text=self.source.text, sets=laid)

    def say(self, text: str, watcher: int | None = None, bad: bool = False) -> None:
        """Send a sentence `text` for the user to page number `watcher`, or to all (None); `bad`: True for a failure."""
        self.server.tell(watcher, type="said", text=text, bad=bad)

    def tell_panel(self) -> None:
        """Send all pages the state of the panel: settings and their values, sliders, and ships."""
        sliders = [{"label": s.label, "value": s.value, "low": s.low, "high": s.high} for s in self.sliders]
        ahead = {name: pilot.ahead for name, pilot in self.pilots.items()}  # waypoints [m] of those who sail a route
        setting = self.watch.setting
        setting.waves = self.simulation.fluid.plane_waves  # sliders change them
        ships = [
            {"name": name, "throttle": ship.orders[0], "rudder": ship.orders[1], "route": ahead.get(name, [])}
            for name, ship in self.simulation.ships.items()
        ]
        self.server.tell(
            None,
            type="panel",
            paused=self.paused,
            speed=self.speed,
            wind=self.wind,
            winds=[*([self.wind] if self.wind == SCENE_WIND else []), *self.winds],
            sliders=sliders,
            ships=ships,
            sea=setting.sea_header()[0],
            message=self.message,
            recording=str(self.claim.folder) if self.claim is not None else "",
            scene=self.source.name,
            duration=self.config.duration,
        )

    def __exit__(self, *failure: object) -> None:
        with suppress(Failed):
            self.end()


def load_within_memory(source: Source) -> SceneConfig:
    """Config of a source's scene; raises SceneError if it is wrong, Refused if it needs more memory than there is."""
    config = source.load()
    parts = [row.bytes for row in config.ledger() if row.part not in config.observers]
    taken, left = base_memory(config.preflight.particles) + sum(parts), machine.available_memory()
    if taken > left:
        large = f"this scene takes {taken / 1e9:.1f} GB of memory, and {left / 1e9:.1f} GB are left"
        raise Refused(f"{large}; try a larger resolution, or fewer particles")
    return config


def wind_name(source: Source) -> str:
    """Name of the wind preset that a source uses, or SCENE_WIND if its wind is not a preset."""
    written = parse_mapping(source.text, source.name).data.get("wind")
    name = plain_value(source.overrides.get("wind", written))
    if any(key.startswith("wind.") for key in source.overrides) or not isinstance(name, str | None):
        return SCENE_WIND
    return name or "still"


def plain_value(value: Any) -> Any:
    """Value of an override as plain data, without its position in a file."""
    return value.plain() if isinstance(value, Node) else value


def replacement_key(order: Order) -> tuple[str, ...]:
    """Key equal for commands of which only the last counts (moves of a slider), or unique with an empty first word."""
    command = order.command
    if isinstance(command, p.Slide):
        return ("slide", command.key)
    if isinstance(command, p.Steer):
        return ("steer", command.ship)
    return ("speed",) if isinstance(command, p.Speed) else ("", str(id(order)))
