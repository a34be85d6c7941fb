"""Load a scene: merge the layers of its text, check them and return an immutable SceneConfig."""

from collections.abc import Iterable, Mapping
from importlib import import_module
from itertools import combinations
from os import PathLike
from pathlib import Path
from typing import Any

from pydantic import PrivateAttr

from ocean_sim import basin, waves
from ocean_sim.conventions import Refused, Unsuited
from ocean_sim.files.input_file import display_path, file_digest, input_names
from ocean_sim.files.yaml_file import (
    Location,
    Node,
    Problem,
    SceneError,
    in_yaml,
    node_of,
    parse_mapping,
    problem_at,
    read_mapping,
    shorten,
)
from ocean_sim.model import Faults, Model
from ocean_sim.parts import (
    ALONE,
    KEYS_BESIDE_SLOTS,
    SEVERAL,
    SLOTS,
    FluidConfig,
    LedgerRow,
    PartConfig,
    PlatformConfig,
    Preflight,
    SeaConfig,
    ShipConfig,
    SurfaceConfig,
    TimeStepConfig,
    WindConfig,
    config_of,
    key_of,
    kinds,
    library,
    named,
    slot_of,
    water_schemes,
)
from ocean_sim.reading import Heading
from ocean_sim.reading.composition import Composition, compose, unknown_name, with_owners
from ocean_sim.reading.idle import idle_keys, inner_models
from ocean_sim.reading.translation import choice_sentence, dotted, key_sentence, validated
from ocean_sim.runtime import RuntimeConfig
from ocean_sim.simulation import ObserverConfig
from ocean_sim.waves.spectrum_files import ndbc_files

ALWAYS_ON = ("manifest", "timings", "health", "accuracy", "frames", "report", "render")  # observers, unless null
ON_WITH = {"motion": ALONE, "platform_log": "platform"}  # observers, unless null, where the scene has this part
DRAWN_FROM = {"render": "frames", "platform_log": "motion"}  # the observer without which one is not on by itself
OVERRIDE_NAME, MAX_VALUE_BYTES = "--set", 40  # how a message names what `--set` gives
WORD_BYTES = {"f32": 4, "f64": 8}  # bytes of a number


class SceneConfig(Heading):
    """A checked scene: every part's Config as the user wrote it, and the observers in their running order."""

    basin: basin.Config
    sea: SeaConfig | None = None
    wind: WindConfig
    fluid: FluidConfig
    surface: SurfaceConfig | None = None
    ships: dict[str, ShipConfig] = {}
    """Ships by name; one that is alone and has none is `ship`."""
    platform: PlatformConfig | None = None
    time_step: TimeStepConfig
    runtime: RuntimeConfig
    observers: dict[str, ObserverConfig] = {}
    notes: list[str] = []
    """Sentences for `run` and `check` on keys that composing the scene dropped or changed."""

    _preflight: Preflight | None = PrivateAttr(None)
    _inputs: dict[str, str] = PrivateAttr({})

    def parts(self) -> dict[str, PartConfig]:
        """Configs of the parts by place (`wind`, `ships.tug`), then of observers by name; empty slots are left out."""
        found: dict[str, PartConfig] = {}
        for slot in SLOTS:
            part = None if slot == ALONE else getattr(self, slot)
            found |= {slot: part} if part is not None else {}
            found |= {key_of(name): ship for name, ship in self.ships.items()} if slot == ALONE else {}
        return found | self.observers

    @property
    def preflight(self) -> Preflight:
        """Facts on the whole scene that parts need before it is built, as the tank; cached until the parts change."""
        known, word, arch = self._preflight, WORD_BYTES[self.runtime.precision], self.runtime.arch
        facts = self.parts(), self.basin, word, self.duration, arch
        if known is None or (known.parts, known.tank.config, known.word, known.duration, known.arch) != facts:
            parts, tank, word, duration, arch = facts
            known = self._preflight = Preflight(parts, tank.build(self.sea), word, duration, arch)
        return known

    def ledger(self) -> list[LedgerRow]:
        """Rows with the memory and kernels that each part will need; nothing is allocated."""
        rows = [(key, row) for key, part in self.parts().items() for row in part.ledger(self.preflight)]
        return [row if slot_of(key) == key else row._replace(part=key) for key, row in rows]

    def inputs(self) -> dict[str, str]:
        """SHA-256 by name of each input file of the scene's numbers; raises Refused if one changed since loading."""
        parts = [part.model_dump() for part in (self.basin, *self.parts().values())]
        names = set(input_names(parts))
        names |= {str(beside) for name in names for beside in ndbc_files(name) if beside.is_file()}
        found = {name: file_digest(name) for name in sorted(names)}
        for name, now in found.items():
            if self._inputs.get(name, now) != now:
                changed = f"{display_path(name)}: this file has changed since the scene was loaded"
                raise Refused(f"{changed}; load the scene again")
        return found

    def files(self) -> list[str]:
        """Names of the files that a run writes into its folder; * stands for digits and dots."""
        return sorted({name for each in self.observers.values() for name in each.files_of(self.preflight)})

    def warnings(self) -> list[str]:
        """Sentences: the warnings of every part, keys that have no effect, and angles that may be in radians."""
        preflight, parts = self.preflight, self.parts()
        told = [
            f"{key}: {sentence}" if slot_of(key) != key else sentence
            for key, part in parts.items()
            for sentence in part.warnings(preflight)
        ]
        whole = {"scene": self, "basin": self.basin, "runtime": self.runtime} | parts
        return [*told, *idle_keys(whole, preflight)]

    def resolved(self) -> dict[str, Any]:
        """The scene as plain data that load to an equal one: absent keys null, spacings times the resolution."""
        data = self.model_dump(mode="json", by_alias=True, serialize_as_any=True, exclude={"notes"})
        ships, observers = data[SEVERAL], data.pop("observers")
        written = (ALONE, ships.get(ALONE)) if not ships or ALONE in ships else (SEVERAL, ships)
        data = dict(written if key == SEVERAL else (key, value) for key, value in data.items())
        slots = {slot_of(place) for place in self.parts()}
        off = {name: None for name in on_unless_null(slots) if name not in observers}
        return data | {"resolution": 1.0} | off | observers


def observer_names() -> tuple[str, ...]:
    return kinds("observers")


def on_unless_null(slots: Iterable[str]) -> list[str]:
    """Names of the observers that run by default in a scene with these slots filled."""
    return [*ALWAYS_ON, *(name for name, slot in ON_WITH.items() if slot in slots)]


def load(
    source: str | Path | dict[str, Any], overrides: dict[str, Any] | None = None, profile: str | None = None
) -> SceneConfig:
    """Load a scene from a file, the name of a packaged scene or a dict, with overrides (values by dotted key) and a
    profile over it. Names of files start in the folder of its file, of a dict in the working directory. Raises
    SceneError, which lists all mistakes at once."""
    if not isinstance(source, str | PathLike | dict):
        raise Unsuited(f"load: source is the name or the file of a scene, or a dict, not {source!r:.60}")
    if overrides is not None and not (isinstance(overrides, dict) and all(isinstance(key, str) for key in overrides)):
        raise Unsuited(f"load: overrides is a dict of values by dotted key, not {overrides!r:.60}")
    try:
        folder = None if isinstance(source, dict) else scene_path(source).parent.absolute()
        scene = node_of(source, Location("scene")) if isinstance(source, dict) else read_mapping(scene_path(source))
        return _compose_and_check(scene, folder, overrides, profile)
    except RecursionError:
        raise SceneError([problem_at(Location("scene"), "", "nested too deeply")]) from None


def load_text(
    text: str, name: str, folder: Path, overrides: dict[str, Any] | None = None, profile: str | None = None
) -> SceneConfig:
    """The scene in a YAML text that errors call `name`; file names start in `folder`. Raises SceneError."""
    return _compose_and_check(parse_mapping(text, name), folder.absolute(), overrides, profile)


def _compose_and_check(
    scene: Node, folder: Path | None, overrides: dict[str, Any] | None, profile: str | None
) -> SceneConfig:
    """Lay profile and overrides over a scene, and check it; `folder`: base of file names. Raises SceneError."""
    layer, problems = profile_layer(profile)
    sets = {key: _override_node(key, value) for key, value in (overrides or {}).items()}
    composition = compose(scene, layer, sets)
    problems += composition.problems
    config = _check_models(composition, problems, folder)
    if problems or config is None:
        raise SceneError(problems)
    return config


def scene_path(source: str | Path) -> Path:
    """The file of a scene given by its path or as the name of a packaged scene; raises SceneError."""
    path, packaged = Path(source), library("scenes") / f"{source}.yaml"
    if path.suffix not in (".yaml", ".yml") and not path.is_file() and packaged.is_file():
        return packaged
    if not path.exists():
        there = [str(each) for each in path.parent.glob("*.y*ml")] if path.suffix in (".yaml", ".yml") else []
        end, suggestion = choice_sentence(str(source), [*there, *packaged_scenes()])
        location = Location(display_path(path))
        raise SceneError([problem_at(location, "", f"there is no such file or scene{end}", suggestion)])
    return path


def packaged_scenes() -> list[str]:
    folder = library("scenes")
    return sorted(path.relative_to(folder).with_suffix("").as_posix() for path in folder.rglob("*.yaml"))


def profile_layer(profile: str | None) -> tuple[Node | None, list[Problem]]:
    """Mapping in a profile's file, less keys not of numerical effort, and problems of these; None without a profile."""
    if profile is None:
        return None, []
    if profile not in named("run"):
        name = node_of(profile, Location(f"--profile {profile}"))
        return None, [unknown_name("profile", name, "", named("run"))]
    node = read_mapping(library("configs") / "run" / f"{profile}.yaml")
    allowed = ("runtime", "time_step", "resolution", *observer_names())
    problems = []
    for key, inner in node.data.items():
        if key not in allowed:
            end, suggestion = choice_sentence(key, allowed)
            problems.append(problem_at(inner.key_location, key, f"a profile has no such key{end}", suggestion))
    return node.with_data({key: inner for key, inner in node.data.items() if key in allowed}), problems


def _override_node(key: str, value: Any) -> Node:
    """The value of an override as a node whose location reads `--set KEY=VALUE`."""
    shown = "" if isinstance(value, Node) else shorten(in_yaml(value), MAX_VALUE_BYTES)
    return node_of(value, Location(f"{OVERRIDE_NAME} {key}={shown}"))


def _check_models(composition: Composition, problems: list[Problem], folder: Path | None) -> SceneConfig | None:
    """The checked scene of a composed tree, or None if it has mistakes, all of which are appended to `problems`."""
    root, data = composition.root, composition.root.data
    headings = tuple(Heading.model_fields)
    problems += _unknown_keys(root, headings)
    heading = validated(Heading, root.with_data({k: v for k, v in data.items() if k in headings}), (), problems)
    tank_config = _part_model("basin", basin.Config, composition, problems, folder)
    tank = tank_config.build() if tank_config is not None else None
    runtime = _part_model("runtime", RuntimeConfig, composition, problems, folder)
    notes = [*composition.notes]
    if heading is not None and tank is not None:
        composition.root = _scale_spacings(composition.root, heading.resolution, tank.dimension, notes)
    ships = [key_of(name) for name in data[SEVERAL].data] if SEVERAL in data else []
    places = [place for slot in SLOTS for place in ((slot, *ships) if slot == ALONE else (slot,))]
    parts = {place: _part_model(place, None, composition, problems, folder) for place in places}
    for place, node in composition.meant.items():  # the other keys of a part whose kind is misspelled
        validated(config_of(slot_of(place), node.data["kind"].data), node, (place,), problems, folder)
    there = {place: part for place, part in parts.items() if isinstance(part, PartConfig)}
    named_in = {place for place in places if _place_node(data, place) is not None}
    wrong = composition.failed | named_in - set(there)
    observers = _observers(data, root, problems, folder)
    problems += _missing_needs(observers, there, wrong, data, root)
    problems += _kind_mismatches(there, data, tank is not None and tank.dimension == 2)
    if tank_config is None or tank is None or runtime is None or heading is None:
        return None
    sea = there.get("sea")
    patch = tank_config.build(sea) if isinstance(sea, SeaConfig) else tank
    preflight = Preflight(there | observers, patch, WORD_BYTES[runtime.precision], heading.duration, runtime.arch)
    problems += _locate_problems("basin", tank_config.problems(tank, heading.duration), root)
    for name, part in (there | observers).items():
        problems += _locate_problems(name, part.problems(preflight), root)
    afloat = {name: part for name, part in there.items() if isinstance(part, ShipConfig)}
    others = {name: part for name, part in (there | observers).items() if name not in afloat}
    for asked in (afloat, others):  # the others count the particles around what floats
        if not problems:
            for name, part in asked.items():
                problems += _locate_problems(name, part.mismatches(preflight), root)
    if not problems:
        problems += _overlapping_ships(preflight, root)
    if problems:
        return None
    values = {key: getattr(heading, key) for key in headings} | {slot: parts[slot] for slot in SLOTS if slot != ALONE}
    notes += preflight.fluid.notes(preflight)
    models = [model for part in there.values() for _, _, model in inner_models(part)]
    notes += [model.statement(tank.dimension) for model in models if isinstance(model, waves.FileSpectrum)]
    values |= {"ships": preflight.ships, "basin": tank_config, "runtime": runtime}
    config = SceneConfig(**values, observers=observers, notes=notes)
    config._preflight = preflight
    config._inputs = config.inputs()
    return config


def _place_node(data: dict[str, Node], place: str) -> Node | None:
    """The node of a part by its place, or of an observer by its name; None where it is absent."""
    slot, _, name = place.partition(".")
    node = data.get(slot)
    return node.child(name) if node is not None and name else node


def _overlapping_ships(preflight: Preflight, root: Node) -> list[Problem]:
    """Problems of ships whose outlines overlap at the start."""
    if len(preflight.ships) < 2:
        return []
    problems: list[Problem] = []
    outlines = {name: ship.outline(preflight) for name, ship in preflight.ships.items()}
    for (first, one), (second, other) in combinations(outlines.items(), 2):
        depth = 0.0
        if one is not None and other is not None:
            depth = max(one.overlap(image) for image in other.images(one, preflight.repeats))
        if depth > 0.0:
            sentence = f"the hulls of {first} and {second} reach {depth:.3g} m into each other"
            problems += _locate_problems(key_of(second), [(("position",), f"{sentence}; move one")], root)
    return problems


def _unknown_keys(root: Node, headings: tuple[str, ...]) -> list[Problem]:
    """Problems of unknown keys at the top level of a scene; `headings`: its keys that belong to no part."""
    known, problems = (*headings, "basin", *SLOTS, *KEYS_BESIDE_SLOTS, SEVERAL, "runtime", *observer_names()), []
    for key, node in root.data.items():
        if key not in known:
            end, suggestion = _suggest_below(key, root.data)
            end, suggestion = (end, suggestion) if end else key_sentence(key, known)
            problems.append(problem_at(node.key_location, key, f"unknown key{end}", suggestion))
    return problems


def _suggest_below(key: str, data: dict[str, Node]) -> tuple[str, str | None]:
    """End of an error message for a top-level key that belongs in a part, and the path to suggest or None."""
    from ocean_sim.reading.keys import example_path, keys_elsewhere, named_so  # they read scenes

    def here(path: str) -> bool:
        slot, kind, *_ = path.split(".")
        return slot not in SLOTS or (slot in data and data[slot].is_mapping and data[slot].plain()["kind"] == kind)

    paths = [example_path(path) for path in named_so(key) if "." in path and here(path)]
    paths.sort(key=lambda path: path.count("."))
    return choice_sentence(paths[0], paths[:1]) if paths else (keys_elsewhere(key), None)


def _part_model(
    name: str, model: type[Model] | None, composition: Composition, problems: list[Problem], folder: Path | None
) -> Any:
    """The checked Config of a part, of class `model` or else of its kind; None where it is absent or wrong, with its
    mistakes appended to `problems`. `folder`: base of file names."""
    node = _place_node(composition.root.data, name)
    if node is not None and node.data is not None:
        if model is not None:
            return validated(model, node, (name,), problems, folder)
        slot, wrong = slot_of(name), list[Problem]()
        found = validated(config_of(slot, node.data["kind"].data), node, (name,), wrong, folder)
        problems += (with_owners(one, slot, name) for one in wrong)
        return found
    if name in ("basin", "fluid") and name not in composition.failed:
        problems.append(problem_at(composition.root.location, name, "missing key"))
    return RuntimeConfig() if name == "runtime" else None


def _kind_mismatches(parts: Mapping[str, PartConfig], data: dict[str, Node], flat: bool) -> list[Problem]:
    """Problems of kinds of parts that do not go together; `data`: their nodes; `flat`: 2-D, ships need no surface."""
    fluid, surface = parts.get("fluid"), parts.get("surface")
    if not isinstance(fluid, FluidConfig):
        return []
    problems, water = [], fluid.kind
    if "sea" in parts and not fluid.joins_a_sea:
        joining = " or ".join(name for name, config in water_schemes() if config.joins_a_sea)
        sentence = f"water of kind {water} cannot be a patch of open sea; take {joining}"
        problems.append(problem_at(data["sea"].location, "sea", sentence))
    if surface is not None and not fluid.made_of_particles:
        sentence = f"a surface follows particles, and fluid.kind {water} has none; leave it out"
        problems.append(problem_at(data["surface"].location, "surface", sentence))
    for place, ship in parts.items():
        if not isinstance(ship, ShipConfig):
            continue
        kind, location = ship.kind, (_place_node(data, place) or data["fluid"]).location
        if "surface" not in parts and fluid.made_of_particles and ship.needs_surface and not flat:
            sentence = f"a {kind} ship over particles reads the height of the water from a surface; add a `surface`"
            problems.append(problem_at(location, place, sentence))
        if ship.carried_as_body and not fluid.carries_bodies:
            carrying = " or ".join(name for name, config in water_schemes() if config.carries_bodies)
            sentence = f"water of kind {water} does not carry a ship of kind {kind}; take {carrying}"
            problems.append(problem_at(location, place, sentence))
    return problems


def _missing_needs(
    observers: Mapping[str, ObserverConfig],
    parts: Mapping[str, PartConfig],
    wrong: set[str],
    data: dict[str, Node],
    root: Node,
) -> list[Problem]:
    """Problems of observers that need an absent part; parts in `wrong`, which have other problems, count as present."""
    problems, there = [], {*observers, *parts, *wrong}
    for name, config in observers.items():
        absent = [need for need in config.needs if need not in there]
        if absent:
            sentence = f"needs {', '.join(absent)}, which this scene does not have"
            problems.append(problem_at(data.get(name, root).location, name, sentence))
    return problems


def _observers(
    data: dict[str, Node], root: Node, problems: list[Problem], folder: Path | None
) -> dict[str, ObserverConfig]:
    """The checked observers that are named or on by default, in running order; mistakes are appended to `problems`."""
    observers: dict[str, ObserverConfig] = {}
    default = on_unless_null({ALONE if key == SEVERAL else key for key in data})
    for name in observer_names():
        on = name in default and DRAWN_FROM.get(name, name) in (name, *observers)
        node = data.get(name, root.with_data({} if on else None))
        if node.data is None:
            if name == "manifest":
                message = "every run writes its manifest; this key cannot be null"
                problems.append(problem_at(node.location, name, message))
            continue
        config = validated(import_module(f"ocean_sim.observers.{name}").Config, node, (name,), problems, folder)
        if config is not None:
            observers[name] = config
    return dict(sorted(observers.items(), key=lambda item: (item[1].turn, item[0])))


def _scale_spacings(root: Node, factor: float, dimension: int, notes: list[str]) -> Node:
    """The scene with spacings of water, surface and ships times `factor`, and particle counts divided by `factor` to
    the power `dimension`; sentences on it are added to `notes`. Values from `--set` are kept."""

    def scaled(node: Node, path: tuple[str, ...]) -> Node:
        if isinstance(node.data, dict):
            return node.with_data({key: scaled(inner, (*path, key)) for key, inner in node.data.items()})
        value, number = node.data, node.data
        if (
            isinstance(value, bool)
            or not isinstance(value, int | float)
            or node.location.file.startswith(OVERRIDE_NAME)
        ):
            return node
        if path[-1] in ("particles", "cap") and isinstance(value, int):
            number = max(1, round(value / factor**dimension))
        elif path[-1] == "spacing":
            number = value * factor
        if number != value:
            notes.append(f"resolution {factor:g}: {dotted(path)} {value:g} -> {number:g}")
        return node.with_data(number)

    if factor == 1.0:
        return root
    slots = {slot: root.data[slot] for slot in ("fluid", "surface", ALONE, SEVERAL) if slot in root.data}
    return root.with_data(root.data | {slot: scaled(node, (slot,)) for slot, node in slots.items()})


def _locate_problems(name: str, found: Faults, root: Node) -> list[Problem]:
    """Problems (pairs of key path and sentence) that the part `name` reports, each with its location in the file."""
    problems = []
    for path, sentence in found:
        inner = _place_node(root.data, name) or root
        for step in path:
            inner = inner.child(step) or inner
        problems.append(problem_at(inner.location, dotted((name, *path)), sentence))
    return problems
