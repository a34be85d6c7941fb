"""The gate: each kind of each slot, and each promise that the page on tests names, has a test in it."""

import ast
import csv
from functools import cache

import pytest

from ocean_sim.parts import SLOTS, kinds, library
from tests.conftest import GATE_SECONDS, module_costs

ROOT = library("scenes").parent
LAYERS = ROOT / "docs" / "test_layers.csv"

pytestmark = pytest.mark.skipif(not LAYERS.is_file(), reason="an installed package has no docs")


def rows() -> list[dict[str, str]]:
    if not LAYERS.is_file():
        return []
    with LAYERS.open() as file:
        return list(csv.DictReader(file))


@cache
def marks_of_tests(module: str) -> dict[str, str]:
    """The decorators of each test of a module, as source."""
    tree = ast.parse((ROOT / module).read_text())
    tests = [node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")]
    return {test.name: " ".join(map(ast.unparse, test.decorator_list)) for test in tests}


def test_each_kind_has_a_test_in_the_gate():
    named = {row["promise"] for row in rows()}
    assert {f"{slot}: {kind}" for slot in SLOTS for kind in kinds(slot)} <= named


@pytest.mark.parametrize("row", rows(), ids=lambda row: row["promise"])
def test_each_promise_is_kept_by_a_test_in_the_gate(row):
    module, _, name = row["test"].partition("::")
    marks = marks_of_tests(module)[name]
    slow = any(mark.endswith("mark.slow") for mark in marks.split())
    assert not slow and ("mark.anchor" in marks or module_costs().get(module, 0.0) <= GATE_SECONDS)
