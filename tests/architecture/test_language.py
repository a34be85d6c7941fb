"""Plain technical English: docstrings open with a subject or a verb, and names say quantity and use."""

import ast
import re
from functools import cache

from tests.architecture.test_arrows import sources

CLAUSE_OPENERS = set(
    "what whether who whom whose of that to in at where when how which why whatever as for by with from on here there "
    "it but".split()
)
RETIRED_FUNCTIONS = set("told felt met kept made found held risen worked raised_by unsuited unreached in_turn".split())
RETIRED_CONSTANTS = set("MOST LEAST FEWEST APART BESIDE BENT SPENT TORN NEAR FAR KEPT FOUND MADE".split())
VAGUE_WORD = re.compile(r"\bwhat\b", re.IGNORECASE)
DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
OWNERS = (ast.Module, ast.ClassDef)
FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


def is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


@cache
def docstrings() -> list[tuple[str, str]]:
    """Place and text of each docstring: of modules, classes, functions and attributes."""
    found = []
    for module, tree in sources().items():
        for node in ast.walk(tree):
            if isinstance(node, DOCUMENTED):
                first = node.body[:1] if isinstance(node, FUNCTIONS) else node.body
                found += [(f"{module}:{each.lineno}", each.value.value) for each in first if is_text(each)]
    return found


def constants() -> list[tuple[str, str]]:
    """Module and name of each constant: upper-case names that a module assigns."""
    found = []
    for module, tree in sources().items():
        for node in tree.body:
            targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
            names = [name for target in targets for name in getattr(target, "elts", [target])]
            found += [(module, name.id) for name in names if isinstance(name, ast.Name) and name.id.isupper()]
    return found


def functions() -> list[tuple[str, str]]:
    """Module and name of each function and method but the special ones, and but functions inside others."""
    owners = [(module, owner) for module, tree in sources().items() for owner in ast.walk(tree)]
    bodies = [(module, node) for module, owner in owners if isinstance(owner, OWNERS) for node in owner.body]
    return [(m, node.name) for m, node in bodies if isinstance(node, FUNCTIONS) and not node.name.startswith("__")]


def one_word(named: list[tuple[str, str]]) -> list[tuple[str, str]]:
    return [(module, name) for module, name in named if "_" not in name.strip("_")]


def test_no_docstring_opens_with_a_clause():
    opened = [(place, text.split()) for place, text in docstrings() if text.strip()]
    headless = [
        (place, " ".join(words[:9])) for place, words in opened if words[0].strip(".,:;").lower() in CLAUSE_OPENERS
    ]
    assert headless == []


def test_docstrings_name_their_subjects():
    words = sum(len(text.split()) for _, text in docstrings())
    vague = [place for place, text in docstrings() for _ in VAGUE_WORD.findall(text)]
    assert len(vague) < 0.001 * words, vague


def test_constants_say_quantity_and_use():
    assert len(one_word(constants())) < 0.40 * len(constants())
    assert [(module, name) for module, name in constants() if name in RETIRED_CONSTANTS] == []


def test_functions_say_what_they_do():
    assert len(one_word(functions())) < 0.60 * len(functions())
    assert [(module, name) for module, name in functions() if name in RETIRED_FUNCTIONS] == []
