"""Every function says what it takes and gives, so that mypy can check who calls it."""

import ast

from tests.architecture.test_arrows import every, sources

TAICHI = ("ti.func", "ti.kernel")  # compiled: Taichi reads their annotations itself
IN_KERNELS = {  # ordinary functions, or members of a protocol, that kernels call
    "ocean_sim.random_numbers.pcg4d",
    "ocean_sim.wind.shared.air_load.drag_coefficient",
}


def is_compiled(function: ast.FunctionDef) -> bool:
    return any(ast.unparse(decorator) in TAICHI for decorator in function.decorator_list)


def is_of_a_protocol(function: ast.FunctionDef) -> bool:
    """Whether it is a member of a protocol that stands for a ti.func, and says so."""
    return (ast.get_docstring(function) or "").startswith("ti.func")


def bare(function: ast.FunctionDef) -> bool:
    """Whether an argument, other than the object itself, or the answer has no annotation."""
    arguments = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
    arguments += [extra for extra in (function.args.vararg, function.args.kwarg) if extra is not None]
    missing = [a for a in arguments if a.annotation is None and a.arg not in ("self", "cls")]
    return bool(missing) or function.returns is None


def test_every_function_that_taichi_does_not_compile_is_annotated():
    for module in sources():
        inside = {
            id(inner)
            for node in every(module)
            if isinstance(node, ast.FunctionDef) and is_compiled(node)
            for inner in ast.walk(node)
            if inner is not node
        }
        for node in every(module):
            if isinstance(node, ast.FunctionDef) and id(node) not in inside and bare(node):
                known = f"{module}.{node.name}" in IN_KERNELS
                assert is_compiled(node) or is_of_a_protocol(node) or known, f"{module}:{node.lineno} {node.name}"
