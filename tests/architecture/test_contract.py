"""The contract of parts: what every kind must say, and what nobody may ask."""

import ast
import inspect

import pytest

from ocean_sim.parts import SLOTS, KindConfig, PartConfig, config_of, kinds
from ocean_sim.reading.scene import observer_names
from ocean_sim.simulation import ObserverConfig
from tests.architecture.test_arrows import SOURCES

KINDS = [(slot, kind) for slot in SLOTS for kind in kinds(slot)]
CONTRACT = ("problems", "mismatches", "warnings", "ledger")


@pytest.mark.parametrize("slot, kind", [*KINDS, *(("observers", name) for name in observer_names())])
def test_every_kind_says_all_that_a_scene_asks(slot, kind):
    """A kind without its ledger or its `build` is abstract, and could not be made from a scene."""
    config = config_of(slot, kind)
    assert issubclass(config, ObserverConfig if slot == "observers" else KindConfig)
    assert not inspect.isabstract(config), f"{slot}.{kind} lacks {', '.join(config.__abstractmethods__)}"
    for name in CONTRACT:
        parameters = list(inspect.signature(getattr(config, name)).parameters)
        assert parameters == ["self", "preflight"], f"{slot}.{kind}.{name}({', '.join(parameters)})"


def test_no_kind_has_a_question_of_its_own_that_nobody_asks():
    """A misspelt `warning` or `problem` would be silent."""
    public = {name for name in dir(PartConfig) if not name.startswith("_")}
    for slot, kind in KINDS:
        own = {name for name in vars(config_of(slot, kind)) if not name.startswith("_")} - public
        near = {name for name in own for word in CONTRACT if name != word and word.startswith(name.rstrip("s"))}
        assert not near, f"{slot}.{kind}: {near}"


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
    for module, tree in SOURCES.items():
        for node in ast.walk(tree):
            named = isinstance(node, ast.Attribute) and node.attr == word
            assert not named and not (isinstance(node, ast.keyword) and node.arg == word), (
                f"{module}: {FORBIDDEN[word]}"
            )


FOREIGN = {  # what is asked there is no part of ours
    "hasattr": {"ocean_sim.machine", "ocean_sim.runtime", "ocean_sim.state.walk"},
    "getattr": {
        "ocean_sim.runtime",
        "ocean_sim.files.input_file",
        "ocean_sim.ship.shared.mesh",
        "ocean_sim.state.fields",
    },
}


@pytest.mark.parametrize("name", FOREIGN)
def test_nobody_asks_one_of_our_own_whether_it_has_something(name):
    """A `getattr` without a default reads what has to be there."""
    for module, tree in SOURCES.items():
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == name:
                asks = name == "hasattr" or len(node.args) == 3
                assert not asks or module in FOREIGN[name], f"{module}:{node.lineno}"
