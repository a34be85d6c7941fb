"""How Taichi 1.7 reads a kernel, made quicker. Before it finds a compiled kernel in its cache it goes through the
kernel's source, and through that of every function called in it as often as it is called, node by node. What it reads
and what it makes of that is as it was; what it found anew for each call and each node is found once. Its own functions
that take the elements of a vector together, and multiply it by a matrix, are not read at all, but done.
"""

import ast
import linecache
import textwrap
from functools import cache, reduce
from types import CodeType, FunctionType, MethodType
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from ocean_sim.kernel_library import ast_transformer, expr, impl, kernel_impl, matrix_ops, ti

core, ops, ScalarField, MatrixField = impl._ti_core, matrix_ops.ops_mod, impl.ScalarField, impl.MatrixField
Context, Transformer = kernel_impl.ASTTransformerContext, ast_transformer.ASTTransformer
CLOSING = (")", "]", "}")  # with which a line goes on that begins no further to the right than its statement


class Tree:
    """A parsed function, and its nodes, on which Taichi writes what they are while it reads them."""

    def __init__(self, source: "Source") -> None:
        self.source, self.root = source, source.parsed()
        self.root.tree = self
        self.nodes: list[Any] = [*ast.walk(self.root)]
        self.attributes = [node for node in self.nodes if type(node) is ast.Attribute]
        for node in self.nodes:
            node.place, node.read = source.place(node), _reader(node.__class__)

    def clear(self) -> None:
        """Take off what was written: it holds on to simulations."""
        for node in self.nodes:
            node.ptr = None
        for node in self.attributes:
            vars(node).pop("caller", None)


class Source:
    """A function's text, and what has been made of it."""

    def __init__(self, function: FunctionType) -> None:
        self.name, self.file = function.__name__, kernel_impl.getsourcefile(function)
        self.trees: list[Tree] = []  # which nothing reads now
        try:
            self.begin(*_block(function))
        except (IndexError, StopIteration, SyntaxError):  # it lies in no file, or a text in it begins further left
            self.begin(*kernel_impl.getsourcelines(function))

    def begin(self, lines: list[str], first: int) -> None:
        """Take these lines, of which the first has this number in its file."""
        self.lines, self.first = [line.rstrip().expandtabs(4) for line in lines], first
        self.text = textwrap.dedent("\n".join(self.lines))
        at = [f'File "{self.file}", line {first + k}, in {self.name}:' for k in range(len(lines))]
        self.places = [f"{place}\n{line}\n" for place, line in zip(at, self.lines)]
        self.trees.append(Tree(self))

    def parsed(self) -> Any:
        """A tree without its decorators."""
        root: Any = ast.parse(self.text)
        root.body[0].decorator_list = []
        return root

    def tree(self) -> Tree:
        """One that nothing else reads: a function may call itself."""
        return self.trees.pop() if self.trees else Tree(self)

    def place(self, node: ast.AST) -> str:
        """Where a node stands, for messages of the compiler: file, line, function, and the line itself."""
        return self.places[node.lineno - 1] if isinstance(node, (ast.stmt, ast.expr)) else ""


def _block(function: FunctionType) -> tuple[list[str], int]:
    """The lines of a function, to the next that begins no further to the right, and the number of the first."""
    code = function.__code__
    lines = linecache.getlines(code.co_filename, function.__globals__)[code.co_firstlineno - 1 :]
    body = next(k for k, line in enumerate(lines) if line.lstrip().startswith("def ")) + 1
    indent = len(lines[0]) - len(lines[0].lstrip())
    return lines[: body + _within(lines[body:], indent)], code.co_firstlineno


def _within(lines: list[str], indent: int) -> int:
    """How many of these lines are within a statement that begins so far to the right."""
    for k, line in enumerate(lines):
        text = line.lstrip()
        if text and len(line) - len(text) <= indent and not text.startswith(("#", *CLOSING)):
            return k
    return len(lines)


_sources: WeakKeyDictionary[CodeType, Source] = WeakKeyDictionary()


def _begun(
    reader: Any,
    excluded_parameters: Any = (),
    is_kernel: bool = True,
    arg_features: Any = None,
    args: Any = None,
    ast_builder: Any = None,
    is_real_function: bool = False,
) -> tuple[Any, Any]:
    """What Taichi reads of a kernel or a function, and what it knows while it does."""
    function = reader.func
    source = _sources.get(function.__code__)
    if source is None:
        source = _sources[function.__code__] = Source(function)
    known = kernel_impl._get_global_vars(function)
    if is_kernel or is_real_function:
        known |= {reader.arguments[k].name: args[k] for k in reader.template_slot_locations}
    context = Context(
        excluded_parameters=excluded_parameters,
        is_kernel=is_kernel,
        func=reader,
        arg_features=arg_features,
        global_vars=known,
        argument_data=args,
        src=source.lines,
        start_lineno=source.first,
        file=source.file,
        ast_builder=ast_builder,
        is_real_function=is_real_function,
    )
    return source.tree().root, context


def _read(root: Any, context: Any) -> Any:
    """Read a tree from its root on, and let others read it then, unless Taichi has taken a kernel's parameters out."""
    try:
        _build(Transformer(), context, root)
    finally:
        root.tree.clear()
    if not context.is_kernel:
        root.tree.source.trees.append(root.tree)
    return context.return_data


class _Failed:
    """Reads nothing, for the reason why reading a node has failed."""

    def __init__(self, error: Exception) -> None:
        self.error = error

    def __getattr__(self, name: str) -> Any:
        def fail(context: Any, node: Any) -> None:
            raise self.error

        return fail


def _build(builder: Any, context: Any, node: Any) -> Any:
    """Read one node; where that fails, Taichi's own way adds the place."""
    places = impl.pytaichi.src_info_stack
    places.append(node.place)
    try:
        return node.read(context, node)
    except Exception as error:
        return _tell(_Failed(error), context, node)
    finally:
        places.pop()


def _place(context: Any, node: Any) -> Any:
    return node.place


@cache
def _reader(kind: Any) -> Any:
    """What reads a kind of node."""

    def cannot(context: Any, node: Any) -> None:
        raise ti.TaichiSyntaxError(f'Unsupported node "{kind.__name__}"')

    return getattr(Transformer, f"build_{kind.__name__}", cannot)


def _decorator(context: Any, node: Any) -> str:
    """The name of what a call calls, if that is one of those that Taichi's reading depends on."""
    return _decorators.get(id(_resolved(node.func, context.global_vars)), "") if type(node) is ast.Call else ""


def _resolved(node: Any, known: dict[str, Any]) -> Any:
    """What a name, or a name with dots, stands for outside a kernel; None where that is nothing."""
    if type(node) is ast.Name:
        return known.get(node.id)
    return getattr(_resolved(node.value, known), node.attr, None) if type(node) is ast.Attribute else None


def _calls_builtin(context: Any, node: Any, args: list[Any], keywords: dict[str, Any]) -> bool:
    """Whether a call has been read as one of a function of Python's own."""
    return not isinstance(node.func.ptr, (FunctionType, MethodType)) and _builtin(context, node, args, keywords)


def _merged(*parts: dict[str, Any]) -> dict[str, Any]:
    return {name: value for part in reversed(parts) for name, value in part.items()}


@cache
def _limits(kind: Any) -> tuple[int, int]:
    limits = np.iinfo(kind)
    return limits.min, limits.max


def _fits(kind: Any, value: int) -> bool:
    low, high = _limits(kind)
    return low <= value <= high


def _pointers(value: Any) -> list[Any]:
    return [value.ptr] if type(value) is expr.Expr else _flattened(value)


def _covered(self: Any, *given: Any, dbg_info: Any = None, dtype: Any = None) -> None:
    """Python's cover of an expression of the compiler, of which nearly all are made."""
    if len(given) != 1 or type(given[0]) is not core.Expr:
        _any_covered(self, *given, dbg_info=dbg_info, dtype=dtype)
        return
    self.ptr, self.dbg_info, self.ptr_type_checked = given[0], dbg_info, True
    if dbg_info:
        self.ptr.set_dbg_info(dbg_info)
    self.ptr.type_check(impl.pytaichi.prog.config())


def _variable(value: Any) -> Any:
    """A variable of a kernel that begins with a value."""
    if type(value) is not expr.Expr:
        return _any_variable(value)
    builder, place = impl.pytaichi.compiling_callable.ast_builder(), impl.pytaichi.src_info_stack[-1]
    return expr.Expr(builder.expr_var(value.ptr, core.DebugInfo(place)))


def _element(builder: Any, value: Any, *indices: Any, skip_reordered: bool = False) -> Any:
    """An element of a field of numbers or of vectors."""
    plain = type(value) in (ScalarField, MatrixField) and all(type(index) is expr.Expr for index in indices)
    first = value._get_field_members()[0].ptr if plain else None
    if first is None or first.snode() is None:
        return _any_element(builder, value, *indices, skip_reordered=skip_reordered)
    group = core.ExprGroup()
    for index in indices:
        group.push_back(index.ptr)
    field = value.ptr if type(value) is MatrixField else first
    return expr.Expr(builder.expr_subscript(field, group, core.DebugInfo(impl.pytaichi.src_info_stack[-1])))


def _within_range(kind: Any, value: int) -> int:
    return value if _fits(kind, value) else _clamped(kind, value)


def _elements(value: Any) -> dict[tuple[int, ...], Any]:
    """Those of a vector or a matrix, which is worked out once."""
    builder, held = impl.pytaichi.compiling_callable.ast_builder(), _variable(value)
    return {at: impl.subscript(builder, held, *at) for at in np.ndindex(*held.get_shape())}


def _reduced(value: Any, fun: Any) -> Any:
    """All elements of a vector or a matrix taken together, one after the other: their sum, or whether any is true."""
    if not impl.inside_kernel():
        return _any_reduced(value, fun)
    return _variable(reduce(fun, _elements(value).values()))


def _product(matrix: Any, vector: Any) -> Any:
    """A matrix times a vector."""
    (rows, *columns), shape = matrix.get_shape(), vector.get_shape()
    if not impl.inside_kernel() or (*columns,) != shape:
        return _any_product(matrix, vector)
    a, x = _elements(matrix), _elements(vector)
    sums = [reduce(ops.add, [ops.mul(a[i, k], x[k,]) for k in range(*columns)]) for i in range(rows)]
    return _variable(ast_transformer.matrix.make_matrix(sums))


_tell, _builtin = ast_transformer.Builder.__call__, Transformer.build_call_if_is_builtin
_any_covered, _any_variable, _any_element = expr.Expr.__init__, impl.expr_init, impl.subscript
_flattened, _clamped = expr._get_flattened_ptrs, expr._clamp_unsigned_to_range
_any_reduced, _any_product = matrix_ops._reduce, matrix_ops.matmul
_decorators = {id(getattr(ti, name)): name for name in ("static", "static_assert", "grouped", "ndrange")}


def quicken() -> None:
    """From now on, read kernels in this way."""
    kernel_impl._get_tree_and_ctx, kernel_impl.transform_tree = _begun, _read
    ast_transformer.Builder.__call__, Context.get_pos_info = _build, _place
    Transformer.get_decorator, Transformer.build_call_if_is_builtin = _decorator, _calls_builtin
    ast_transformer.ChainMap = _merged
    expr.Expr.__init__, impl.expr_init, impl.subscript = _covered, _variable, _element
    expr._get_flattened_ptrs, expr._check_in_range = _pointers, _fits
    expr._clamp_unsigned_to_range = _within_range
    matrix_ops._reduce, matrix_ops.matmul = _reduced, _product
    ours: Any = _reduced
    ours._is_taichi_function = False  # without which it would warn that it does not read it
