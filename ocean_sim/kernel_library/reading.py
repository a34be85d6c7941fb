"""Replacements inside Taichi 1.7 that shorten the start of a run with compiled kernels.

Before Taichi finds a compiled kernel in its cache, it walks through the syntax tree of the kernel and of every function
called in it, as often as it is called. `install` replaces two parts of that walk, without changing its result:

- Source and syntax tree of a function are found once, and each node keeps its reader and its place: 2.6 s of processor
  time at the start of `showcase` (median of five interleaved runs on one thread, 2026-11-28).
- Sums over vectors and products with matrices are built directly, and not read as functions of Taichi: 0.9 s there.

OCEAN_SIM_QUICK_START=0 leaves Taichi as it is.
"""

import ast
import linecache
import os
import textwrap
from functools import cache, reduce
from types import CodeType, FunctionType, SimpleNamespace
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from ocean_sim.kernel_library import ast_transformer, impl, kernel_impl, matrix_ops, ti

SWITCH_VARIABLE = "OCEAN_SIM_QUICK_START"
Context = kernel_impl.ASTTransformerContext
Transformer, Builder = ast_transformer.ASTTransformer, ast_transformer.Builder
CLOSING_BRACKETS = (")", "]", "}")  # that may stand in lines after the last instruction


class Tree:
    """Syntax tree of a function that Taichi compiles; Taichi stores results on its nodes while it translates them."""

    def __init__(self, source: "Source") -> None:
        """Parse a syntax tree; store in each node its source line and Taichi's method for it: they are read often."""
        self.source, self.root = source, source.parse()
        self.root.tree = self
        self.nodes: list[Any] = [*ast.walk(self.root)]
        self.attributes = [node for node in self.nodes if type(node) is ast.Attribute]
        for node in self.nodes:
            node.place = source.places[node.lineno - 1] if isinstance(node, (ast.stmt, ast.expr)) else ""
            node.read = node_reader(node.__class__)

    def clear(self) -> None:
        """Remove Taichi's results (expressions) from the syntax nodes: they would keep simulations in memory."""
        for node in self.nodes:
            node.ptr = None
        for node in self.attributes:
            vars(node).pop("caller", None)


class Source:
    """Source text of a function, and a pool of its syntax trees: each is out of it while Taichi translates it."""

    def __init__(self, function: FunctionType) -> None:
        self.name, self.file = function.__name__, kernel_impl.getsourcefile(function)
        self.trees: list[Tree] = []  # those that nothing reads now
        try:
            self.set_lines(*function_lines(function))
        except (IndexError, SyntaxError):  # no file, or a string in it begins further left
            self.set_lines(*kernel_impl.getsourcelines(function))

    def set_lines(self, lines: list[str], first: int) -> None:
        """Store the function's source lines, the first of which has number `first` in its file, and parse them."""
        self.lines, self.first = [line.rstrip().expandtabs(4) for line in lines], first
        self.text = textwrap.dedent("\n".join(self.lines))
        at = [f'File "{self.file}", line {first + k}, in {self.name}:' for k in range(len(lines))]
        self.places = [f"{place}\n{line}\n" for place, line in zip(at, self.lines)]
        self.trees.append(Tree(self))

    def parse(self) -> Any:
        """Parse the source of the function into a syntax tree without decorators."""
        root: Any = ast.parse(self.text)
        root.body[0].decorator_list = []
        return root


def function_lines(function: FunctionType) -> tuple[list[str], int]:
    """Source lines of a function, found by the line numbers of its bytecode, and the number of the first line."""
    code = function.__code__
    lines, first = linecache.getlines(code.co_filename, function.__globals__), code.co_firstlineno
    last = max((end for _, end, *_ in code.co_positions() if end is not None), default=0)
    while lines[last:] and lines[last].lstrip().startswith(CLOSING_BRACKETS):
        last += 1
    return lines[first - 1 : last], first


known_sources: WeakKeyDictionary[CodeType, Source] = WeakKeyDictionary()


def tree_and_context(
    reader: Any,
    excluded_parameters: Any = (),
    is_kernel: bool = True,
    arg_features: Any = None,
    args: Any = None,
    ast_builder: Any = None,
    is_real_function: bool = False,
) -> tuple[Any, Any]:
    """Syntax tree of kernel or function `reader` and context to translate it; replaces Taichi's `_get_tree_and_ctx`."""
    function = reader.func
    source = known_sources.get(function.__code__)
    if source is None:
        source = known_sources[function.__code__] = Source(function)
    names = kernel_impl._get_global_vars(function)
    if is_kernel or is_real_function:
        names |= {reader.arguments[k].name: args[k] for k in reader.template_slot_locations}
    context = Context(
        excluded_parameters=excluded_parameters,
        is_kernel=is_kernel,
        func=reader,
        arg_features=arg_features,
        global_vars=names,
        argument_data=args,
        src=source.lines,
        start_lineno=source.first,
        file=source.file,
        ast_builder=ast_builder,
        is_real_function=is_real_function,
    )
    tree = source.trees.pop() if source.trees else Tree(source)  # a function may call itself
    return tree.root, context


def read_tree(root: Any, context: Any) -> Any:
    """Translate a tree from its root, return its value and free it for reuse; replaces Taichi's `transform_tree`."""
    try:
        read_node(Transformer(), context, root)
    finally:
        root.tree.clear()
    if not context.is_kernel:  # from whose tree Taichi removes parameters
        root.tree.source.trees.append(root.tree)
    return context.return_data


def read_node(builder: Any, context: Any, node: Any) -> Any:
    """Translate a syntax node. Taichi raises errors again with the source line added. Replaces `Builder.__call__`."""
    places = impl.pytaichi.src_info_stack
    places.append(node.place)
    try:
        return node.read(context, node)
    except Exception as error:

        def fail(context: Any, node: Any, failure: Exception = error) -> None:
            raise failure

        return taichi_read_node(SimpleNamespace(**{f"build_{type(node).__name__}": fail}), context, node)
    finally:
        places.pop()


def node_place(context: Any, node: Any) -> Any:
    """Source line of a syntax node, for messages of the compiler; replaces `get_pos_info` of Taichi's context."""
    return node.place


@cache
def node_reader(kind: Any) -> Any:
    """Method of Taichi that translates nodes of the class `kind`; if there is none, one that raises a syntax error."""

    def refuse(context: Any, node: Any) -> None:
        raise ti.TaichiSyntaxError(f'Unsupported node "{kind.__name__}"')

    return getattr(Transformer, f"build_{kind.__name__}", refuse)


def vector_elements(value: Any) -> dict[tuple[int, ...], Any]:
    """Elements of a Taichi vector or matrix by index, for code in a kernel; the expression `value` is computed once."""
    builder, held = impl.pytaichi.compiling_callable.ast_builder(), impl.expr_init(value)
    return {at: impl.subscript(builder, held, *at) for at in np.ndindex(*held.get_shape())}


def reduce_vector(value: Any, combine: Any) -> Any:
    """Combine all elements of vector or matrix `value` in order by `combine` (as add); replaces Taichi's `_reduce`."""
    if not impl.inside_kernel():
        return taichi_reduce(value, combine)
    return impl.expr_init(reduce(combine, vector_elements(value).values()))


def matrix_product(matrix: Any, vector: Any) -> Any:
    """Product of a matrix and a vector in a kernel; replaces Taichi's `matmul`, which still serves other operands."""
    (rows, *columns), shape = matrix.get_shape(), vector.get_shape()
    if not impl.inside_kernel() or (*columns,) != shape:
        return taichi_product(matrix, vector)
    a, x = vector_elements(matrix), vector_elements(vector)
    ops = matrix_ops.ops_mod
    sums = [reduce(ops.add, [ops.mul(a[i, k], x[k,]) for k in range(*columns)]) for i in range(rows)]
    return impl.expr_init(ast_transformer.matrix.make_matrix(sums))


reduce_vector._is_taichi_function = False  # type: ignore[attr-defined]  # else it would warn that it is not read
taichi_read_node, taichi_reduce, taichi_product = Builder.__call__, matrix_ops._reduce, matrix_ops.matmul
REPLACEMENTS: tuple[tuple[Any, str, Any], ...] = (
    (kernel_impl, "_get_tree_and_ctx", tree_and_context),
    (kernel_impl, "transform_tree", read_tree),
    (Builder, "__call__", read_node),
    (Context, "get_pos_info", node_place),
    (matrix_ops, "_reduce", reduce_vector),
    (matrix_ops, "matmul", matrix_product),
)
TAICHI_ORIGINALS = tuple((owner, name, getattr(owner, name)) for owner, name, _ in REPLACEMENTS)


def install() -> None:
    """Make Taichi read kernels faster, with the same result, by REPLACEMENTS; undo it if OCEAN_SIM_QUICK_START is 0."""
    for owner, name, value in TAICHI_ORIGINALS if os.environ.get(SWITCH_VARIABLE) == "0" else REPLACEMENTS:
        setattr(owner, name, value)
