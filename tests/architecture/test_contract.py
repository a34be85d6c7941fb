"""The contract of parts: what every kind must say, and what nobody may ask."""

import ast
import inspect
from difflib import get_close_matches
from importlib import import_module
from typing import Literal

import pytest

from ocean_sim.parts import SLOTS, KindConfig, ObserverConfig, config_of, kinds
from ocean_sim.reading.scene import observer_names
from ocean_sim.simulation import Observer
from tests.architecture.test_arrows import every, sources

KINDS = [(slot, kind) for slot in SLOTS for kind in kinds(slot)]
EVERY = [*KINDS, *(("observers", name) for name in observer_names())]
CONTRACT = ("problems", "mismatches", "warnings", "ledger")


@pytest.mark.parametrize("slot, kind", EVERY)
def test_every_kind_says_all_that_a_scene_asks(slot, kind):
    """A kind without its ledger or its `build` is abstract, and could not be made from a scene."""
    config = config_of(slot, kind)
    assert issubclass(config, ObserverConfig if slot == "observers" else KindConfig)
    assert not inspect.isabstract(config), f"{slot}.{kind} lacks {', '.join(config.__abstractmethods__)}"
    for name in CONTRACT:
        parameters = list(inspect.signature(getattr(config, name)).parameters)
        assert parameters == ["self", "preflight"], f"{slot}.{kind}.{name}({', '.join(parameters)})"


@pytest.mark.parametrize("slot, kind", EVERY)
def test_no_kind_misspells_a_question_of_the_contract(slot, kind):
    """A `warning` or a `mismatch` would never be asked for."""
    own = {name for name in vars(config_of(slot, kind)) if not name.startswith("_")} - set(CONTRACT)
    near = {name: get_close_matches(name, CONTRACT, cutoff=0.75) for name in own}
    assert not any(near.values()), f"{slot}.{kind}: {near}"


@pytest.mark.parametrize("slot, kind", EVERY)
def test_every_kind_gives_the_class_variables_that_have_no_default(slot, kind):
    config = config_of(slot, kind)
    named = {
        name
        for base in config.__mro__
        for name, hint in vars(base).get("__annotations__", {}).items()
        if "ClassVar" in str(hint)
    }
    lacking = [name for name in named if not hasattr(config, name)]
    assert not lacking, f"{slot}.{kind}: {lacking}"


@pytest.mark.parametrize("slot, kind", KINDS)
def test_every_kind_is_named_by_its_own_literal(slot, kind):
    field = config_of(slot, kind).model_fields["kind"]
    assert field.annotation == Literal[kind] and field.default == kind


@pytest.mark.parametrize("name", observer_names())
def test_every_observer_observes_and_says_what_it_leaves(name):
    module = import_module(f"ocean_sim.observers.{name}")
    classes = [value for value in vars(module).values() if isinstance(value, type) and issubclass(value, Observer)]
    (own,) = [value for value in classes if value.__module__ == module.__name__]
    public = {method for method in dir(Observer) if not method.startswith("_")}
    assert {"observe", "close"} & set(vars(own)), f"{name} never observes"
    near = {method: get_close_matches(method, public, cutoff=0.75) for method in set(vars(own)) - public}
    assert not any(near.values()), near
    assert module.Config.leaves or not module.Config.writes, f"{name} does not say what it leaves"


def test_a_kind_that_forgets_its_ledger_cannot_be_made():
    """The negative control."""

    class Config(KindConfig):
        kind: str = "made_up"

    with pytest.raises(TypeError, match="ledger"):
        Config()  # type: ignore[abstract]


FORBIDDEN = {  # what hides a forgotten part of a contract, or decides physics by what was typed
    "model_fields_set": "what a scene left open is null in its dump, and `is None` asks for it",
    "exclude_unset": "a dump shows what a scene left open, as null",
}


@pytest.mark.parametrize("word", FORBIDDEN)
def test_nobody_asks_what_was_typed(word):
    for module in sources():
        for node in every(module):
            named = isinstance(node, ast.Attribute) and node.attr == word
            assert not named and not (isinstance(node, ast.keyword) and node.arg == word), (
                f"{module}: {FORBIDDEN[word]}"
            )


FOREIGN = {  # what is asked there is no part of ours
    "hasattr": {"ocean_sim.machine", "ocean_sim.runtime", "ocean_sim.state.snapshot"},
    "getattr": {
        "ocean_sim.runtime",
        "ocean_sim.kernel_library.reading",
        "ocean_sim.files.input_file",
        "ocean_sim.basin.solids.mesh",
        "ocean_sim.state.fields",
    },
}


@pytest.mark.parametrize("name", FOREIGN)
def test_nobody_asks_one_of_our_own_whether_it_has_something(name):
    """A `getattr` without a default reads what has to be there."""
    for module in sources():
        for node in every(module):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == name:
                asks = name == "hasattr" or len(node.args) == 3
                assert not asks or module in FOREIGN[name], f"{module}:{node.lineno}"
