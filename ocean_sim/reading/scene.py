"""A scene: what a user wrote, composed, checked and frozen."""

from dataclasses import replace
from importlib import import_module
from math import inf
from pathlib import Path
from typing import Any

from ocean_sim import basin
from ocean_sim.files.yaml_file import Node, Place, Problem, SceneError, node_of, problem, read, shown
from ocean_sim.parts import SLOTS, LedgerRow, ObserverConfig, PartConfig, config_of, kinds, library, named, quantity
from ocean_sim.reading.composition import Composition, composed, unknown_name
from ocean_sim.reading.translation import choice_sentence, dotted, likeliest, validated
from ocean_sim.runtime import RuntimeConfig

ALWAYS_ON = ("manifest", "timings", "health", "accuracy", "frames", "report", "render")  # unless null
FIRST = ("timings", "health", "accuracy", "gauges")
LAST = ("frames", "manifest", "report", "render", "checkpoint")  # what others have written by then, they read
OVERRIDE = "--set"

Part = Any  # the Config of a kind, or None: scenes know kinds by name only


class Heading(PartConfig):
    """What a scene says of itself."""

    title: str = ""
    """One line that says what the experiment is."""
    seed: int = quantity("1", 0, ge=0, lt=2**31)
    """Seed of every random number of the run."""
    duration: float = quantity("s", 10.0, gt=0.0)
    """Simulated time."""
    resolution: float = quantity("1", 1.0, gt=0.0)
    """A factor on every spacing: 2 is twice as coarse."""


class SceneConfig(Heading):
    """A whole scene, checked: every part's Config, and the observers in the order in which they watch."""

    basin: basin.Config
    fluid: Part
    wind: Part
    surface: Part = None
    ship: Part = None
    platform: Part = None
    time_step: Part
    runtime: RuntimeConfig
    observers: dict[str, Part] = {}
    notes: list[str] = []
    """What composing the scene dropped or changed: sentences for `run` and `check`."""

    def parts(self) -> dict[str, Part]:
        """Every part that the scene has, by slot or name, observers last."""
        slots = {slot: getattr(self, slot) for slot in ("basin", *SLOTS)}
        return {name: part for name, part in slots.items() if part is not None} | self.observers

    def place(self) -> Any:
        """The basin with what floats in it, around which the water is built."""
        place = self.basin.build()
        return replace(place, afloat=self.ship.floating(place, self.fluid)) if hasattr(self.ship, "floating") else place

    def ledger(self) -> list[LedgerRow]:
        """What the scene will allocate and compile, and why; nothing is allocated to find out."""
        place, word = self.place(), 8 if self.runtime.precision == "f64" else 4
        rows = [row for part in self.parts().values() if hasattr(part, "ledger") for row in part.ledger(place, word)]
        if getattr(self.surface, "when_read", False):
            rows = [row._replace(every=self.reading()) if row.part == "surface" else row for row in rows]
        rate = self.observers["motion"].every if "motion" in self.observers else 0.0
        particles = self.particles(place)
        return rows + [part.watching(name, particles, rate) for name, part in self.observers.items()]

    def reading(self) -> float:
        """Simulated time between readings of the surface [s]; 0: each step is one."""
        if self.ship is not None and self.ship.needs_surface:
            return 0.0
        return min((getattr(part, "every", 0.0) for part in self.observers.values() if part.reads_surface), default=inf)

    def particles(self, place: Any) -> int:
        """How many the water has at most in this basin."""
        return self.fluid.lattice(place).n if hasattr(self.fluid, "lattice") else 0

    def warnings(self) -> list[str]:
        """What every part has to say against the scene."""
        return [said for part in self.parts().values() if hasattr(part, "warnings") for said in part.warnings(self)]

    def resolved(self) -> dict[str, Any]:
        """The scene as plain data that loads to this scene again; its spacings contain the resolution."""
        data: dict[str, Any] = {"title": self.title, "seed": self.seed, "duration": self.duration, "resolution": 1.0}
        for slot in ("basin", *SLOTS, "runtime"):
            part = getattr(self, slot)
            data[slot] = part.model_dump(mode="json") if part is not None else None
        off = {name: None for name in always_on() if name not in self.observers}
        return data | off | {name: config.model_dump(mode="json") for name, config in self.observers.items()}


def observer_names() -> tuple[str, ...]:
    """Every observer there is, in the order in which they watch."""
    between = [name for name in kinds("observers") if name not in FIRST + LAST]
    return tuple(name for name in (*FIRST, *between, *LAST) if name in kinds("observers"))


def always_on() -> tuple[str, ...]:
    """The observers that watch unless a scene says null."""
    return tuple(name for name in ALWAYS_ON if name in kinds("observers"))


def load(
    source: str | Path | dict[str, Any], overrides: dict[str, Any] | None = None, profile: str | None = None
) -> SceneConfig:
    """The scene in a file (or the name of a packaged scene, or a dict), with overrides and a profile laid over it.

    Names of files in it, and in overrides, are relative to its own file; in a dict, to the working directory.
    Raises SceneError, which holds everything that is wrong at once.
    """
    try:
        folder = None if isinstance(source, dict) else scene_path(source).parent.absolute()
        scene = node_of(source, Place("scene")) if isinstance(source, dict) else read(scene_path(source))
        layer, problems = profile_layer(profile)
        sets = {key: _override(key, value) for key, value in (overrides or {}).items()}
        composition = composed(scene, layer, sets)
        problems += composition.problems
        config = _checked(composition, problems, folder)
    except RecursionError:
        raise SceneError([Problem("scene", None, None, "", "nested too deeply")]) from None
    if problems or config is None:
        raise SceneError(problems)
    return config


def scene_path(source: str | Path) -> Path:
    """The file that a path, or the name of a packaged scene, stands for."""
    path, packaged = Path(source), library("scenes") / f"{source}.yaml"
    if path.suffix not in (".yaml", ".yml") and not path.is_file() and packaged.is_file():
        return packaged
    if not path.exists():
        end, suggestion = choice_sentence(str(source), packaged_scenes())
        raise SceneError([Problem(shown(path), None, None, "", f"there is no such file or scene{end}", suggestion)])
    return path


def packaged_scenes() -> list[str]:
    """The names of the scenes that come with the program."""
    folder = library("scenes")
    return sorted(path.relative_to(folder).with_suffix("").as_posix() for path in folder.rglob("*.yaml"))


def profile_layer(profile: str | None) -> tuple[Node | None, list[Problem]]:
    """The file of a profile, and what is wrong with it; profiles hold what a machine can afford, and no physics."""
    if profile is None:
        return None, []
    if profile not in named("run"):
        name = node_of(profile, Place(f"--profile {profile}"))
        return None, [unknown_name("profile", name, "", named("run"))]
    node = read(library("configs") / "run" / f"{profile}.yaml")
    allowed = ("runtime", "time_step", "resolution", *observer_names())
    problems = [
        problem(
            inner.key_place,
            key,
            f"a profile has no such key{choice_sentence(key, allowed)[0]}",
            likeliest(key, allowed),
        )
        for key, inner in node.data.items()
        if key not in allowed
    ]
    return node.with_data({key: inner for key, inner in node.data.items() if key in allowed}), problems


def _override(key: str, value: Any) -> Node:
    return value if isinstance(value, Node) else node_of(value, Place(f"{OVERRIDE} {key}={_short(value)}"))


def _short(value: Any) -> str:
    text = {None: "null", True: "true", False: "false"}.get(value) if value is None or isinstance(value, bool) else None
    text = text or str(value)
    return text if len(text) <= 40 else f"{text[:37]}..."


def _checked(composition: Composition, problems: list[Problem], folder: Path | None) -> SceneConfig | None:
    """The models of a composed scene, or None; `problems` grows by everything that is wrong."""
    data, root = composition.root.data, composition.root
    headings, observers = tuple(Heading.model_fields), observer_names()
    known = (*headings, "basin", *SLOTS, "runtime", *observers)
    for key, node in data.items():
        if key not in known:
            end, suggestion = choice_sentence(key, known)
            problems.append(problem(node.key_place, key, f"unknown key{end}", suggestion))
    heading = validated(Heading, root.with_data({k: v for k, v in data.items() if k in headings}), (), problems)
    parts = _parts(composition, problems, folder)
    watching = _observers(data, root, problems)
    failed = composition.failed | {name for name, part in parts.items() if part is None}
    for name, config in watching.items():
        there = {*watching, *failed}  # a part that is wrong is there
        absent = [need for need in config.needs if parts.get(need) is None and need not in there]
        if absent:
            place = data.get(name, root).place
            problems.append(problem(place, name, f"needs {', '.join(absent)}, which this scene does not have"))
    notes = [*composition.notes]
    if parts.get("basin") is not None and heading is not None:
        place = parts["basin"].build()
        for name in ("fluid", "surface", "ship"):
            if parts.get(name) is not None and heading.resolution != 1.0:
                scaled = _scaled(parts[name].model_dump(), heading.resolution, place, name, notes)
                parts[name] = validated(type(parts[name]), node_of(scaled, data[name].place), (name,), problems)
        for name, part in (parts | watching).items():
            if hasattr(part, "problems"):
                problems += _misplaced(name, part.problems(place), data.get(name, root))
        wrong = failed | {found.key.partition(".")[0] for found in problems}
        for name, part in watching.items():
            if hasattr(part, "mismatched") and not wrong & {"basin", *SLOTS}:
                problems += _misplaced(name, part.mismatched(parts), data.get(name, root))
        _surface_on_fluid(parts, place, data, problems)
    _ship_on_water(parts, data, problems)
    if problems or heading is None:
        return None
    values = {key: getattr(heading, key) for key in headings}
    return SceneConfig(**values, **parts, observers=watching, notes=notes)


def _parts(composition: Composition, problems: list[Problem], folder: Path | None) -> dict[str, Any]:
    """The models of basin, slots and runtime, each where there is one and it is in order."""
    parts: dict[str, Any] = {}
    models: dict[str, Any] = {"basin": basin.Config, "runtime": RuntimeConfig}
    for name in ("basin", *SLOTS, "runtime"):
        node = composition.root.data.get(name)
        if node is not None and node.data is not None:
            model = models.get(name) or config_of(name, node.data["kind"].data)
            parts[name] = validated(model, node, (name,), problems, folder)
        elif name in ("basin", "fluid") and name not in composition.failed:
            problems.append(problem(composition.root.place, name, "missing key"))
        elif name == "runtime":
            parts[name] = RuntimeConfig()
    return parts


def _surface_on_fluid(
    parts: dict[str, Any], place: basin.Basin, data: dict[str, Node], problems: list[Problem]
) -> None:
    """A surface takes what it leaves open from its particles; without any there is nothing for it to follow."""
    fluid, surface = parts.get("fluid"), parts.get("surface")
    if surface is None or fluid is None:
        return
    if not hasattr(fluid, "lattice"):
        said = f"a surface follows particles, and fluid.kind {fluid.kind} has none; leave it out"
        problems.append(problem(data["surface"].place, "surface", said))
    elif hasattr(surface, "beside") and not problems:
        parts["surface"] = surface.beside(fluid, place)
        problems += _misplaced("surface", surface.problems_beside(fluid, place), data["surface"])


def _ship_on_water(parts: dict[str, Any], data: dict[str, Node], problems: list[Problem]) -> None:
    """Whether this kind of ship floats on this kind of water, and where it is put."""
    ship, fluid = parts.get("ship"), parts.get("fluid")
    if ship is None or fluid is None:
        return
    if parts.get("surface") is None and hasattr(fluid, "lattice") and ship.needs_surface:
        said = f"a {ship.kind} ship over particles asks a surface how high the water stands; give a `surface`"
        problems.append(problem(data["ship"].place, "ship", said))
    if fluid.kind not in getattr(ship, "waters", (fluid.kind,)):
        said = f"water of kind {fluid.kind} does not carry a ship of kind {ship.kind}; take {' or '.join(ship.waters)}"
        problems.append(problem(data["ship"].place, "ship", said))
    if hasattr(ship, "problems_beside") and not problems:
        problems += _misplaced("ship", ship.problems_beside(fluid, parts["basin"].build()), data["ship"])


def _observers(data: dict[str, Node], root: Node, problems: list[Problem]) -> dict[str, ObserverConfig]:
    """The observers that a scene names or does not switch off, in the order in which they watch."""
    watching: dict[str, ObserverConfig] = {}
    afloat = data.get("ship") is not None and data["ship"].data is not None
    unless_null = (*always_on(), *(("motion",) if afloat else ()))
    for name in observer_names():
        on = name in unless_null or (name == "platform_log" and "platform" in data and "motion" in watching)
        node = data.get(name, root.with_data({} if on else None))
        if node.data is None:
            if name == "manifest":
                problems.append(problem(node.place, name, "a run always says what was run; this one cannot be null"))
            continue
        config = validated(import_module(f"ocean_sim.observers.{name}").Config, node, (name,), problems)
        if config is not None:
            watching[name] = config
    return watching


def _scaled(data: dict[str, Any], factor: float, place: basin.Basin, path: str, notes: list[str]) -> dict[str, Any]:
    """The data of a part with every spacing times `factor`; a budget of particles shrinks by what that leaves out."""
    scaled = dict(data)
    for key, value in data.items():
        if isinstance(value, dict):
            scaled[key] = _scaled(value, factor, place, f"{path}.{key}", notes)
        elif key in ("particles", "cap") and isinstance(value, int):
            scaled[key] = max(1, round(value / factor**place.dimension))
        elif key == "spacing" and isinstance(value, float | int):
            scaled[key] = value * factor
        if scaled[key] != value and not isinstance(value, dict):
            notes.append(f"resolution {factor:g}: {path}.{key} {value:g} -> {scaled[key]:g}")
    return scaled


def _misplaced(name: str, found: list[tuple[str | tuple[str | int, ...], str]], node: Node) -> list[Problem]:
    """What only shows against the basin: a Config's `problems(basin)` gives (key inside it, sentence)."""
    problems = []
    for key, sentence in found:
        path = tuple(key.split(".")) if isinstance(key, str) else key
        inner = node
        for step in path:
            inner = inner.child(step) or inner
        problems.append(problem(inner.place, dotted((name, *filter(lambda step: step != "", path))), sentence))
    return problems
