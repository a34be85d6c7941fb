"""The rooms of the house, drawn from all imports, those for annotations included: few of them, and no circle."""

import ast
from functools import cache

from ocean_sim.parts import SLOTS
from tests.architecture.test_arrows import every, room, sources

MOST_ROOMS = 32


@cache
def targets(module: str) -> set[str]:
    """What a module imports of ours, anywhere in it, also for type checkers alone."""
    found = set()
    for node in every(module):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            inner = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= {name for name in inner if name in sources()} or {str(node.module)}
    return {name for name in found if name in sources() and name != module}


def circles(graph: dict[str, set[str]]) -> list[list[str]]:
    """The strongly connected components of more than one node (Tarjan 1972)."""
    number: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(node: str) -> None:
        number[node] = low[node] = len(number)
        stack.append(node)
        for other in sorted(graph[node]):
            if other not in number:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], number[other])
        if low[node] == number[node]:
            members = stack[stack.index(node) :]
            del stack[stack.index(node) :]
            if len(members) > 1:
                found.append(sorted(members))

    for node in graph:
        if node not in number:
            visit(node)
    return found


def test_there_are_few_rooms():
    rooms = {room(module) for module in sources()}
    assert len(rooms) <= MOST_ROOMS, sorted(rooms)


def test_no_module_imports_one_that_imports_it():
    assert circles({module: targets(module) for module in sources()}) == []


UP = {("parts", slot) for slot in SLOTS if slot != "sea"}  # arrows that run back up; of a sea nothing is built


def test_no_room_imports_one_that_imports_it_but_for_the_arrows_that_contributing_names():
    rooms: dict[str, set[str]] = {room(module): set() for module in sources()}
    for module in sources():
        rooms[room(module)] |= {room(target) for target in targets(module)} - {room(module)}
    assert all(up in rooms[low] for low, up in UP)
    assert circles({name: {other for other in rooms[name] if (name, other) not in UP} for name in rooms}) == []


def test_a_circle_would_be_found():
    """The negative control."""
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"a"}, "d": {"a"}}) == [["a", "b", "c"]]
