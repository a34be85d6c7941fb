"""Merge the layers of a scene into one tree: presets of parts, the scene, the profile and `--set`, later ones over
earlier ones.

A place names a part: its slot, as `wind`, or one of several ships, as `ships.tug`.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from ocean_sim.files.yaml_file import (
    Location,
    Node,
    Problem,
    SceneError,
    describe_value,
    merge_nodes,
    node_of,
    problem_at,
    read_mapping,
)
from ocean_sim.parts import (
    ALONE,
    KEYS_BESIDE_SLOTS,
    MEANT,
    SEVERAL,
    SLOTS,
    config_of,
    key_of,
    kinds,
    library,
    named,
    slot_of,
)
from ocean_sim.reading.translation import NAME_RULE, choice_sentence, dotted, likeliest

DEFAULT_KINDS = {"wind": "still", "time_step": "courant"}  # any other absent slot is nothing at all


@dataclass
class Choice:
    """The kind or preset that a scene chooses for a part, as in `wind: stress`, and the user's own keys for it."""

    base: Node  # a mapping with `kind`
    own: Node  # a mapping without

    @property
    def kind(self) -> str:
        """Name of the kind; for a preset, of the kind that it is based on."""
        return self.base.data["kind"].data

    def whole(self) -> Node:
        """Merge the keys of the kind or preset with the user's own, which take precedence, into one mapping."""
        return merge_nodes(self.base, self.own)


@dataclass
class Composition:
    """Working state of merging the layers of a scene: tree so far, choice for each part, problems and notes found."""

    root: Node
    slots: dict[str, Choice | None] = field(default_factory=dict)  # by place
    failed: set[str] = field(default_factory=set)  # places that already have a problem of their own
    meant: dict[str, Node] = field(default_factory=dict)  # what stands there if its kind is the likeliest one
    problems: list[Problem] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def lay(self, place: str, node: Node, below: Choice | None) -> None:
        """Apply one layer's `node` to the part at `place` (such as `wind`): null removes the part, a name replaces it,
        a mapping sets keys of it. `below`: choice that earlier layers made for this part."""
        try:
            if node.data is None:
                self.slots[place] = None
            elif below is None or not node.is_mapping:
                self.slots[place] = choice_of(place, node)
            else:
                rest = {key: value for key, value in node.data.items() if key != "kind"}
                if "kind" in node.data:
                    below = self.another_kind(place, below, node.data["kind"])
                self.slots[place] = Choice(below.base, merge_nodes(below.own, node.with_data(rest)))
        except SceneError as error:
            self.problems += error.problems
            self.slots[place] = None
            self.failed.add(place)
            kind = next((found.suggestion for found in error.problems if found.suggestion), None)
            if node.is_mapping and kind in known_names(slot_of(place)):
                meant = node.data.get("kind", node).with_data(kind)
                self.meant[place] = choice_of(place, node.with_data(node.data | {"kind": meant})).whole()

    def named_ships(self, node: Node) -> Iterator[tuple[str, Node]]:
        """Yield key (`ships.tug`) and content of each ship in `node`, a mapping by name; mistakes become problems."""
        if node.data is None:
            return
        if not node.is_mapping:
            message = f"expected a mapping of names to ships, got {describe_value(node.data)}"
            self.problems.append(problem_at(node.location, SEVERAL, message))
            return
        for name, ship in node.data.items():
            key, meant = key_for_name(name, ship), None
            if re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", str(name)) is None:
                message = f"{name!r} is not a name: {NAME_RULE}"
            elif name == ALONE:
                message = f"{ALONE!r} is the name of the only ship of a scene; choose another"
            elif key is not None:
                meant = f"{ALONE}.{key}"
                message = f"expected the name of a ship; did you mean {meant!r}, or {f'{SEVERAL}.NAME.{key}'!r}?"
            else:
                yield key_of(name), ship
                continue
            self.problems.append(problem_at(ship.key_location, f"{SEVERAL}.{name}", message, meant))

    def another_kind(self, place: str, below: Choice, kind: Node) -> Choice:
        """Copy of a choice `below` with another `kind` or preset at `place`; keys that this lacks go, with a note."""
        slot = slot_of(place)
        base = choice_of(place, kind.with_data({"kind": kind})).base
        written = below.own if isinstance(kind.data, str) and kind.data not in kinds(slot) else below.whole()
        old = config_of(slot, below.kind).model_fields
        new = config_of(slot, base.data["kind"].data).model_fields
        kept = {key: value for key, value in written.data.items() if key != "kind" and (key in new or key not in old)}
        dropped = [key for key in written.data if key != "kind" and key not in kept]
        if dropped:
            self.notes.append(f"{place}: kind {kind.data} has no {', '.join(dropped)}; dropped")
        return Choice(base, written.with_data(kept))

    def set(self, key: str, value: Node) -> None:
        """Apply one `--set KEY=VALUE`, whose key names a part, a key inside a part, or a key outside the parts."""
        path = tuple(key.split("."))
        path = (KEYS_BESIDE_SLOTS[path[0]], *path) if path[0] in KEYS_BESIDE_SLOTS else path
        if "" in path:
            meant = ".".join(filter(None, path)) or None
            end = f"; did you mean {meant!r}?" if meant else ""
            self.problems.append(problem_at(value.location, key, f"there is a dot where a key should be{end}", meant))
            return
        if path == (SEVERAL,):
            if value.data is None:
                self.slots = {place: choice for place, choice in self.slots.items() if slot_of(place) == place}
            for place, ship in self.named_ships(value):
                self.set_part(place, (), ship)
        elif path[0] == SEVERAL:
            for place, _ in self.named_ships(value.with_data({path[1]: value})):
                self.set_part(place, path[2:], value)
        elif path[0] in SLOTS:
            self.set_part(path[0], path[1:], value)
        elif len(path) == 1 and (meant := self.without_dot(key)) is not None:
            self.problems.append(problem_at(value.location, key, f"unknown key; did you mean {meant!r}?", meant))
        else:
            self.root = self.put(self.root, path, (), value)

    def without_dot(self, word: str) -> str | None:
        """Key that a user meant by a word without its dot, as `fluid.spacing` by `fluid_spacing`; None for others."""
        for place, choice in self.slots.items():
            key = word.removeprefix(place).lstrip("_")
            if choice is None or not word.startswith(place):
                continue
            if key in config_of(slot_of(place), choice.kind).model_fields:
                return f"{place}.{key}"
        return None

    def lay_beside(self, key: str, node: Node) -> None:
        """Apply a key that a scene may write beside the part to which it belongs (as `rim`, of `sea`) to that part."""
        slot = KEYS_BESIDE_SLOTS[key]
        choice = self.slots.get(slot)
        if choice is not None and key in choice.own.data:
            self.problems.append(problem_at(node.key_location, key, f"give either `{key}` or `{slot}.{key}`, not both"))
        elif choice is None and slot not in self.failed:
            self.problems.append(problem_at(node.key_location, key, f"there is no `{slot}` that it could belong to"))
        elif choice is not None:
            self.set_part(slot, (key,), node)

    def below(self, place: str, node: Node) -> Choice | None:
        """Choice of kind and keys that earlier layers (scene, then profile) made for the part at `place` (as `wind`);
        else its default kind, located at `node` for messages; else None."""
        absent = self.slots.get(place) is None and place in DEFAULT_KINDS
        return choice_of(place, node.with_data(DEFAULT_KINDS[place])) if absent else self.slots.get(place)

    def set_part(self, place: str, path: tuple[str, ...], value: Node) -> None:
        """Replace or change the part at `place` (such as `wind`) by `value`, or set the key at `path` inside it."""
        if place in self.failed and path:
            return
        below, above = self.below(place, value), tuple(place.split("."))
        if not path:
            self.lay(place, value, below if value.is_mapping and "kind" not in value.data else None)
        elif path == ("kind",) or below is None:
            self.lay(place, self.put(value.with_data({}), path, above, value), below)
        else:
            whole = self.put(below.whole(), path, above, value)
            own = {k: v for k, v in whole.data.items() if k != "kind"}
            self.slots[place] = Choice(below.base, whole.with_data(own))

    def put(self, node: Node, path: tuple[str, ...], above: tuple[str, ...], value: Node) -> Node:
        """Copy of `node` with `value` at `path`, missing mappings created; `above`: path of `node`, for messages."""
        if not path:
            return value
        step, data = path[0], node.data
        if data is None:
            node, data = value.with_data({}), {}
        if isinstance(data, dict):
            inner = data.get(step, value.with_data(None))
            return node.with_data({**data, step: self.put(inner, path[1:], (*above, step), value)})
        whole = dotted(above)
        if isinstance(data, list) and step.isascii() and step.isdecimal() and int(step) < len(data):
            k = int(step)
            return node.with_data([*data[:k], self.put(data[k], path[1:], (*above, step), value), *data[k + 1 :]])
        if isinstance(data, list):
            there = f"0 to {len(data) - 1}" if data else "none"
            message = f"{whole} is a list; its entries are numbered: {there}"
        else:
            message = f"{whole} is {describe_value(data)}, which has no keys; set {whole} as a whole"
        self.problems.append(problem_at(value.location, dotted((*above, *path)), message))
        return node


def compose(scene: Node, profile: Node | None, overrides: dict[str, Node]) -> Composition:
    """Merge a scene, a profile and `--set` values; parts become mappings with `kind`, `problems` lists mistakes."""
    result = Composition(scene.with_data(dict(scene.data)))
    for slot in SLOTS:
        if slot in scene.data:
            result.lay(slot, scene.data[slot], None)
    beside = {key: node for key, node in scene.data.items() if key in KEYS_BESIDE_SLOTS and node.data is not None}
    early = [key for key in beside if result.slots.get(KEYS_BESIDE_SLOTS[key]) is not None]
    for key in early:
        result.lay_beside(key, beside[key])
    if SEVERAL in scene.data:
        for place, ship in result.named_ships(scene.data[SEVERAL]):
            result.lay(place, ship, None)
    if profile is not None:
        result.root = result.root.with_data(merge_nodes(result.root, profile).data)
        for slot in [slot for slot in SLOTS if slot in profile.data]:
            result.lay(slot, profile.data[slot], result.below(slot, profile))
    for key, node in sorted(overrides.items(), key=lambda item: (item[0].count("."), not item[0].endswith(".kind"))):
        result.set(key, node)
    for key in beside.keys() - early:
        result.lay_beside(key, beside[key])
    result.slots |= {slot: result.below(slot, scene) for slot in DEFAULT_KINDS}
    data = {key: node for key, node in result.root.data.items() if key not in (*SLOTS, *KEYS_BESIDE_SLOTS, SEVERAL)}
    found = {place: choice.whole() for place, choice in result.slots.items() if choice is not None}
    data |= {place: node for place, node in found.items() if place in SLOTS}
    ships = {place.partition(".")[2]: node for place, node in sorted(found.items()) if place not in SLOTS}
    if ships and ALONE in data:
        written = [node for key, node in overrides.items() if key.partition(".")[0] == ALONE]
        location = next(iter([*written, scene.data.get(ALONE, data[ALONE])])).key_location
        result.problems.append(problem_at(location, ALONE, "give either `ship` or `ships`, not both"))
    if ships:
        data[SEVERAL] = scene.data.get(SEVERAL, next(iter(ships.values()))).with_data(ships)
    result.root = result.root.with_data(data)
    return result


def choice_of(place: str, node: Node, within: tuple[str, ...] = ()) -> Choice:
    """Choice that `node`, a name or a mapping with `kind`, makes for the part at `place` (such as `wind`); raises
    SceneError. `within`: presets that are being read, on which this one must not be based."""
    slot = slot_of(place)
    if isinstance(node.data, str):
        name, own = node, node.with_data({})
    elif node.is_mapping and "kind" in node.data:
        name, own = node.data["kind"], node.with_data({key: value for key, value in node.data.items() if key != "kind"})
    elif node.is_mapping and slot in MEANT:
        name, own = node.with_data(MEANT[slot]), node
    else:
        raise SceneError([without_kind(place, node)])
    if not isinstance(name.data, str):
        message = f"expected a name, got {describe_value(name.data)}"
        raise SceneError([problem_at(name.location, f"{place}.kind", message)])
    if name.data in named(slot) and name.data not in within and (name is node or name.data not in kinds(slot)):
        part = read_mapping(library("configs") / slot / f"{name.data}.yaml")
        base = choice_of(place, part, (*within, name.data)).whole()
        return Choice(base.with_data(base.data | {"kind": name.with_data(base.data["kind"].data)}), own)
    if name.data in kinds(slot):
        return Choice(node.with_data({"kind": name}), own)
    raise SceneError([unknown_name(slot, name, f"{place}.kind" if node.is_mapping else place)])


def without_kind(place: str, node: Node) -> Problem:
    """Problem to report: the part at `place` (as `wind`) names no kind (as `gusts`); with a guess of the kind meant."""
    slot = slot_of(place)
    end = f"there are {', '.join(known_names(slot))}"
    if not node.is_mapping:
        wrong = f"expected a name or a mapping with `kind`, got {describe_value(node.data)}"
        return problem_at(node.location, place, f"{wrong}, as in {{kind: {kinds(slot)[0]}}}; {end}")
    mistyped = next((key for key in node.data if likeliest(str(key), keys_of(slot)) == "kind"), None)
    if mistyped is not None:
        message = f"unknown key; did you mean 'kind'? {end}"
        return problem_at(node.data[mistyped].key_location, f"{place}.{mistyped}", message, "kind")
    meant = kind_of_keys(slot, node)
    wrong = "missing key;" if meant is None else f"missing key; with these keys, did you mean {meant!r}?"
    return problem_at(node.location, f"{place}.kind", f"{wrong} {end}", meant)


def keys_of(slot: str) -> list[str]:
    """Names of the keys of all kinds of a slot (`wind`, `fluid`, ...), each once, `kind` included."""
    return list(dict.fromkeys(key for kind in kinds(slot) for key in config_of(slot, kind).model_fields))


def key_for_name(name: str, ship: Node) -> str | None:
    """Likeliest key of a ship that a user meant by `name` under `ships`; None if that can be the name of a ship."""
    if name != "kind" and (ship.data is None or ship.is_mapping or ship.data in known_names(ALONE)):
        return None
    return likeliest(name, keys_of(ALONE))


def kind_of_keys(slot: str, node: Node) -> str | None:
    """Kind (as `gusts`) of a slot (as `wind`) that has most keys of a mapping, misspelt ones too; None if undecided."""
    fields = {kind: config_of(slot, kind).model_fields for kind in kinds(slot)}
    had = {kind: sum(likeliest(str(key), keys) is not None for key in node.data) for kind, keys in fields.items()}
    most = max(had.values(), default=0)
    best = [kind for kind, count in had.items() if count == most]
    return best[0] if most and len(best) == 1 else None


def with_owners(found: Problem, slot: str, place: str) -> Problem:
    """Add to a problem `found`, an unknown key of the part at `place` (as `wind`), the kinds of its slot, as `gusts`,
    that have this key; a problem with a suggestion stays as it is."""
    key = found.key.removeprefix(f"{place}.")
    if not found.message.startswith("unknown key") or found.suggestion is not None:
        return found
    owners = [kind for kind in kinds(slot) if key in config_of(slot, kind).model_fields]
    if not owners:
        return found
    return found._replace(message=f"{found.message}; it is a key of kind {', '.join(owners)}")


def kind_named(slot: str, name: str) -> str:
    """Kind that `name`, a kind or a preset of a slot (as `wind`), stands for; raises SceneError if there is none."""
    return choice_of(slot, node_of({"kind": name}, Location(name))).kind


def known_names(slot: str) -> list[str]:
    """All names that a slot accepts, sorted: presets (for `wind`, as `gale`) and kinds (as `gusts`)."""
    return sorted({*named(slot), *kinds(slot)})


def unknown_name(what: str, name: Node, key: str, choices: Any = None) -> Problem:
    """Problem to report at the scene's `key`: no `what` (a slot, or `profile`) has this name. It suggests the closest
    of `choices`, by default all names in the slot."""
    choices = choices or known_names(what)
    end, suggestion = choice_sentence(name.data, choices)
    if suggestion is not None:
        end += f" there are {', '.join(choices)}"
    return problem_at(name.location, key, f"no {what} {name.data!r}{end}", suggestion)
