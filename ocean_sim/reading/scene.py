"""Load a scene: merge the layers of its text, check them and return an immutable SceneConfig."""

from collections.abc import Iterable
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
from ocean_sim.model import Faults, Key, Model
from ocean_sim.parts import (
    ALONE,
    KEYS_BESIDE_SLOTS,
    SEVERAL,
    SLOTS,
    FluidConfig,
    LedgerRow,
    ObserverConfig,
    PartConfig,
    PlatformConfig,
    SceneFacts,
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

    _preflight: SceneFacts | None = PrivateAttr(None)
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
    def preflight(self) -> SceneFacts:
        """Facts on the whole scene for parts that are not built yet, such as the tank; cached until parts change."""
        known, word, arch = self._preflight, WORD_BYTES[self.runtime.precision], self.runtime.arch
        parts = self.parts()
        facts = parts, self.basin, word, self.duration, arch
        if known is None or (known.parts, known.tank.config, known.word, known.duration, known.arch) != facts:
            known = self._preflight = SceneFacts(parts, self.basin.build(self.sea), word, self.duration, arch)
        return known

    def ledger(self) -> list[LedgerRow]:
        """Rows with the memory and kernels that each part will need; nothing is allocated."""
        rows = [(key, row) for key, part in self.parts().items() for row in part.ledger(self.preflight)]
        return [row if slot_of(key) == key else row._replace(part=key) for key, row in rows]

    def inputs(self) -> dict[str, str]:
        """SHA-256 by name of each input file of the scene's numbers; raises Refused if one changed since loading."""
        names = set(input_names([part.model_dump() for part in (self.basin, *self.parts().values())]))
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
        """The scene as plain data from which an equal one loads: absent keys null, `resolution` applied to spacings."""
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
    """Names of the observers that run unless set to null, in a scene that has the parts `slots` (as `ship`)."""
    return [*ALWAYS_ON, *(name for name, slot in ON_WITH.items() if slot in slots)]


def load(
    source: str | Path | dict[str, Any], overrides: dict[str, Any] | None = None, profile: str | None = None
) -> SceneConfig:
    """Load a scene from a file, the name of a packaged scene or a dict; over it, the settings of a `profile` (packaged,
    by name), then `overrides` (values by dotted key). File names in it are relative to the folder of its file, or for a
    dict to the working directory. Raises SceneError, which lists all mistakes at once."""
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
    """Load the scene in a YAML text like `load`. `name`: of the text in errors; `folder`: base of its file names."""
    return _compose_and_check(parse_mapping(text, name), folder.absolute(), overrides, profile)


def _compose_and_check(
    scene: Node, folder: Path | None, overrides: dict[str, Any] | None, profile: str | None
) -> SceneConfig:
    """Merge profile and overrides into a scene, and check it; `folder`: base of file names. Raises SceneError."""
    layer, problems = profile_layer(profile)
    sets: dict[str, Node] = {}
    for key, value in (overrides or {}).items():  # those of the command line are nodes already
        shown = "" if isinstance(value, Node) else shorten(in_yaml(value), MAX_VALUE_BYTES)
        sets[key] = node_of(value, Location(f"{OVERRIDE_NAME} {key}={shown}"))
    config = _SceneCheck(compose(scene, layer, sets), problems, folder).scene()
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
    """Content of a profile's file without keys that no profile may set, and their problems; None without a profile."""
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


class _SceneCheck:
    """Check of a composed scene: models of its parts and observers, and all problems with their locations."""

    def __init__(self, composition: Composition, problems: list[Problem], folder: Path | None) -> None:
        """`problems`: those known so far, to which others are appended; `folder`: base of relative file names."""
        self.composition, self.root, self.problems, self.folder = composition, composition.root, problems, folder
        self.problems += composition.problems

    def node(self, place: str) -> Node | None:
        """The node (value with location) of a part or observer at `place`, as `ships.tug`; None if it is absent."""
        slot, _, name = place.partition(".")
        node = self.root.data.get(slot)
        return node.child(name) if node is not None and name else node

    def report(self, place: str, sentence: str, path: Key = ()) -> None:
        """Append a problem, a sentence on key `path` of part or observer `place` (`ships.tug`), at the deepest key."""
        node = self.node(place) or self.root
        for step in path:
            node = node.child(step) or node
        self.problems.append(problem_at(node.location, dotted((place, *path)), sentence))

    def scene(self) -> SceneConfig | None:
        """The checked scene; None if it has problems."""
        self.find_unknown_keys()
        keys = {key: node for key, node in self.root.data.items() if key in Heading.model_fields}
        heading = validated(Heading, self.root.with_data(keys), (), self.problems)
        tank_config = self.part("basin", basin.Config)
        tank = tank_config.build() if tank_config is not None else None
        runtime = self.part("runtime", RuntimeConfig)
        notes = [*self.composition.notes]
        if heading is not None and tank is not None:
            self.root = _scale_spacings(self.root, heading.resolution, tank.dimension, notes)
        ships = [key_of(name) for name in self.root.data[SEVERAL].data] if SEVERAL in self.root.data else []
        places = [place for slot in SLOTS for place in ((slot, *ships) if slot == ALONE else (slot,))]
        parts = {place: self.part(place) for place in places}
        for place, node in self.composition.meant.items():  # the other keys of a part whose kind is misspelled
            validated(config_of(slot_of(place), node.data["kind"].data), node, (place,), self.problems, self.folder)
        there = {place: part for place, part in parts.items() if part is not None}
        observers = self.observers()
        self.find_missing_needs(observers)
        self.find_kind_mismatches(there, tank is not None and tank.dimension == 2)
        if tank_config is None or tank is None or runtime is None or heading is None:
            return None
        sea = there.get("sea")
        patch = tank_config.build(sea) if isinstance(sea, SeaConfig) else tank
        preflight = SceneFacts(there | observers, patch, WORD_BYTES[runtime.precision], heading.duration, runtime.arch)
        faults = {"basin": tank_config.problems(tank, heading.duration)}
        faults |= {place: part.problems(preflight) for place, part in preflight.parts.items()}
        self.report_all(faults)
        afloat = {place: part for place, part in there.items() if isinstance(part, ShipConfig)}
        others = {place: part for place, part in preflight.parts.items() if place not in afloat}
        for asked in (afloat, others):  # the others count the particles around what floats
            if not self.problems:
                self.report_all({place: part.mismatches(preflight) for place, part in asked.items()})
        if not self.problems:
            self.find_overlapping_ships(preflight)
        if self.problems:
            return None
        notes += preflight.fluid.notes(preflight)
        models = [model for part in there.values() for _, _, model in inner_models(part)]
        notes += [model.statement(tank.dimension) for model in models if isinstance(model, waves.FileSpectrum)]
        values: dict[str, Any] = dict(heading) | {slot: parts[slot] for slot in SLOTS if slot != ALONE}
        values |= {"basin": tank_config, "ships": preflight.ships, "runtime": runtime, "observers": observers}
        config = SceneConfig(**values, notes=notes)
        config._preflight = preflight
        config._inputs = config.inputs()
        return config

    def report_all(self, faults: dict[str, Faults]) -> None:
        """Append problems of parts and observers; `faults`: (key path, sentence) by place, such as `ships.tug`."""
        for place, found in faults.items():
            for path, sentence in found:
                self.report(place, sentence, path)

    def part(self, place: str, model: type[Model] | None = None) -> Any:
        """Checked Config of the part at `place` (as `ships.tug`), of `model` or its kind; None if absent or wrong."""
        node = self.node(place)
        if node is not None and node.data is not None:
            if model is not None:
                return validated(model, node, (place,), self.problems, self.folder)
            slot, wrong = slot_of(place), list[Problem]()
            found = validated(config_of(slot, node.data["kind"].data), node, (place,), wrong, self.folder)
            self.problems += (with_owners(one, slot, place) for one in wrong)
            return found
        if place in ("basin", "fluid") and place not in self.composition.failed:
            self.problems.append(problem_at(self.root.location, place, "missing key"))
        return RuntimeConfig() if place == "runtime" else None

    def observers(self) -> dict[str, ObserverConfig]:
        """The checked observers that are named or on by default, in running order."""
        observers: dict[str, ObserverConfig] = {}
        default = on_unless_null({ALONE if key == SEVERAL else key for key in self.root.data})
        for name in observer_names():
            on = name in default and DRAWN_FROM.get(name, name) in (name, *observers)
            node = self.root.data.get(name, self.root.with_data({} if on else None))
            if node.data is not None:
                model = import_module(f"ocean_sim.observers.{name}").Config
                config = validated(model, node, (name,), self.problems, self.folder)
                observers |= {name: config} if config is not None else {}
            elif name == "manifest":
                self.report(name, "every run writes its manifest; this key cannot be null")
        return dict(sorted(observers.items(), key=lambda item: (item[1].turn, item[0])))

    def find_unknown_keys(self) -> None:
        """Report unknown keys at the top level of the scene."""
        known = (*Heading.model_fields, "basin", *SLOTS, *KEYS_BESIDE_SLOTS, SEVERAL, "runtime", *observer_names())
        for key, node in self.root.data.items():
            if key not in known:
                end, suggestion = _suggest_below(key, self.root.data)
                end, suggestion = (end, suggestion) if end else key_sentence(key, known)
                self.problems.append(problem_at(node.key_location, key, f"unknown key{end}", suggestion))

    def find_missing_needs(self, observers: dict[str, ObserverConfig]) -> None:
        """Report observers that need an absent part; parts that have other problems count as present."""
        there = {*observers, *self.composition.failed, *(slot for slot in SLOTS if self.node(slot) is not None)}
        for name, config in observers.items():
            if absent := [need for need in config.needs if need not in there]:
                self.report(name, f"needs {', '.join(absent)}, which this scene does not have")

    def find_kind_mismatches(self, parts: dict[str, PartConfig], flat: bool) -> None:
        """Report kinds of parts that cannot be combined; `flat`: True in 2-D, where ships need no surface."""
        fluid = parts.get("fluid")
        if not isinstance(fluid, FluidConfig):
            return
        water = fluid.kind
        if "sea" in parts and not fluid.joins_a_sea:
            joining = " or ".join(name for name, config in water_schemes() if config.joins_a_sea)
            self.report("sea", f"water of kind {water} cannot be a patch of open sea; take {joining}")
        if "surface" in parts and not fluid.made_of_particles:
            self.report("surface", f"a surface follows particles, and fluid.kind {water} has none; leave it out")
        for place, ship in parts.items():
            if not isinstance(ship, ShipConfig):
                continue
            if "surface" not in parts and fluid.made_of_particles and ship.needs_surface and not flat:
                reads = f"a {ship.kind} ship over particles reads the height of the water from a surface"
                self.report(place, f"{reads}; add a `surface`")
            if ship.carried_as_body and not fluid.carries_bodies:
                carrying = " or ".join(name for name, config in water_schemes() if config.carries_bodies)
                self.report(place, f"water of kind {water} does not carry a ship of kind {ship.kind}; take {carrying}")

    def find_overlapping_ships(self, preflight: SceneFacts) -> None:
        """Report ships whose outlines overlap at the start."""
        ships = preflight.ships if len(preflight.ships) > 1 else {}
        outlines = {name: found for name, ship in ships.items() if (found := ship.outline(preflight)) is not None}
        for (first, one), (second, other) in combinations(outlines.items(), 2):
            depth = max(one.overlap(image) for image in other.images(one, preflight.repeats))
            if depth > 0.0:
                sentence = f"the hulls of {first} and {second} reach {depth:.3g} m into each other; move one"
                self.report(key_of(second), sentence, ("position",))


def _suggest_below(key: str, data: dict[str, Node]) -> tuple[str, str | None]:
    """End of an error message for a top-level key that belongs in a part, and the path to suggest or None; `data`: the
    scene's nodes by top-level key."""
    from ocean_sim.reading.keys import example_path, keys_elsewhere, named_so  # they read scenes

    def here(path: str) -> bool:
        slot, kind, *_ = path.split(".")
        return slot not in SLOTS or (slot in data and data[slot].is_mapping and data[slot].plain()["kind"] == kind)

    paths = [example_path(path) for path in named_so(key) if "." in path and here(path)]
    paths.sort(key=lambda path: path.count("."))
    return choice_sentence(paths[0], paths[:1]) if paths else (keys_elsewhere(key), None)


def _scale_spacings(root: Node, factor: float, dimension: int, notes: list[str]) -> Node:
    """The scene with spacings of water, surface and ships times `factor`, and particle counts divided by `factor` to
    the power `dimension`; sentences on it are added to `notes`. Values from `--set` are kept."""

    def scaled(node: Node, path: tuple[str, ...]) -> Node:
        if isinstance(node.data, dict):
            return node.with_data({key: scaled(inner, (*path, key)) for key, inner in node.data.items()})
        value, number = node.data, node.data
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if not is_number or node.location.file.startswith(OVERRIDE_NAME):
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
