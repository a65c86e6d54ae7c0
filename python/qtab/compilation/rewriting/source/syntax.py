"""What the syntax of a function shows before it is rewritten: its local names, and how they are used."""

import ast
from collections import Counter
from collections.abc import Iterator
from functools import cached_property

from qtab.compilation.rewriting.source.sources import Source

LOOPS = (ast.For, ast.While)
CHANGING = (
    *("add", "append", "appendleft", "clear", "discard", "extend", "fill", "insert", "pop", "popleft", "put"),
    *("remove", "resize", "reverse", "setdefault", "sort", "update"),
)
"""The methods that change a list, a dict, a set or an array."""

GROWING = ("append", "extend", "clear")
"""Those that lists have to collect values."""


def parameters_of(node: ast.FunctionDef) -> list[str]:
    """Returns the names of a function's parameters, without those of ``*args`` and ``**kwargs``."""
    return [one.arg for one in (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs)]


def own_name(node: ast.FunctionDef) -> str | None:
    """Returns the name of a method's first parameter; None without any."""
    return next((one.arg for one in (*node.args.posonlyargs, *node.args.args)), None)


class Names:
    """The local names of a function."""

    def __init__(self, source: Source) -> None:
        self.node = source.node
        self.parameters = parameters_of(source.node)
        stored = [one for one in self._walk() if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)]
        imported = [
            alias for one in self._walk() if isinstance(one, ast.Import | ast.ImportFrom) for alias in one.names
        ]
        names = [one.id for one in stored] + [(alias.asname or alias.name.partition(".")[0]) for alias in imported]
        self.counts = Counter([*self.parameters, *names])

    def _walk(self) -> Iterator[ast.AST]:
        for statement in self.node.body:
            yield from ast.walk(statement)

    def is_local(self, name: str) -> bool:
        """Returns whether a name is a parameter or assigned in the function."""
        return name in self.counts

    @cached_property
    def _mutations(self) -> dict[str, list[tuple[int, int]]]:
        found: dict[str, list[tuple[int, int]]] = {}
        for one in self._walk():
            targets: list[ast.expr] = []
            if isinstance(one, ast.Assign):
                targets = one.targets
            elif isinstance(one, ast.AugAssign | ast.AnnAssign | ast.For):
                targets = [one.target]
            elif isinstance(one, ast.Call) and isinstance(one.func, ast.Attribute) and one.func.attr in CHANGING:
                targets = [one.func]
            for target in _written_out(targets):
                base: ast.expr = target
                while isinstance(base, ast.Subscript | ast.Attribute):
                    base = base.value
                direct = isinstance(target, ast.Name) and not isinstance(one, ast.AugAssign)
                if isinstance(base, ast.Name) and not direct:
                    found.setdefault(base.id, []).append((one.lineno, one.col_offset))  # type: ignore[attr-defined]
        return found

    def shared_before_change(self, name: str, ndim: int = 0) -> bool:
        """Returns whether another name may refer to a local value when its elements are assigned.

        Args:
            name: The local variable.
            ndim: The number of dimensions of an array, whose elements are copied numbers; 0 for a list.
        """
        changes = self._mutations.get(name, [])
        if name in self.parameters:
            return True
        shared = list(self._escapes(name, ndim))
        if not changes or not shared:
            return False
        if any(isinstance(one, LOOPS) for one in self._walk()):
            return True
        return min(shared) < max(changes)

    def are_shared(self, node: ast.stmt) -> bool:
        """Returns whether another name may refer to one of the local arrays that a statement returns."""
        value = node.value if isinstance(node, ast.Return) else None
        names = [part.id for part in _parts(value) if isinstance(part, ast.Name)] if value is not None else []
        return any(True for name in names for _ in self._escapes(name))

    def _escapes(self, name: str, ndim: int = 0) -> Iterator[tuple[int, int]]:
        for one in self._walk():
            kept: list[ast.expr] = []
            if isinstance(one, ast.Assign | ast.AnnAssign | ast.AugAssign):
                keeps = isinstance(one.value, _DISPLAYS) or not isinstance(one, ast.AugAssign)
                kept = [one.value] if keeps and one.value is not None else []
            elif isinstance(one, ast.For) and not (isinstance(one.iter, ast.Name) and not _grows(one, name)):
                kept = [one.iter]
            elif isinstance(one, ast.Call) and not _of_library(one.func):
                kept = [*one.args, *(keyword.value for keyword in one.keywords)]
            if any(_is_name(part, name) for value in kept for part in _parts(value, ndim)):
                yield one.lineno, one.col_offset  # type: ignore[attr-defined]


_DISPLAYS = (ast.Tuple, ast.List, ast.ListComp, ast.GeneratorExp)
_VIEWS = ("asarray", "ravel")
"""The functions of NumPy, and methods of arrays, that may return the array itself."""


def _written_out(targets: list[ast.expr]) -> Iterator[ast.expr]:
    """Yields the targets of an assignment, with tuples and lists replaced by their elements."""
    for target in targets:
        if isinstance(target, ast.Tuple | ast.List):
            yield from _written_out(target.elts)
        else:
            yield target.value if isinstance(target, ast.Starred) else target


def _grows(node: ast.For, name: str) -> bool:
    """Returns whether the body of a loop changes a variable by an operator, such as ``x += 1``."""
    return any(isinstance(one, ast.AugAssign) and _is_name(one.target, name) for one in ast.walk(node))


def _is_name(node: ast.AST, name: str) -> bool:
    return isinstance(node, ast.Name) and node.id == name


def _parts(node: ast.expr, ndim: int = 0) -> Iterator[ast.expr]:
    """Yields an expression, or the parts of those that keep a reference to them; views keep one to the array.

    Args:
        node: The expression.
        ndim: The number of dimensions of the arrays in question, whose elements are numbers; 0 for lists.
    """
    if isinstance(node, ast.Tuple | ast.List):
        for part in node.elts:
            yield from _parts(part, ndim)
    elif isinstance(node, ast.Dict):
        for part in node.values:
            yield from _parts(part, ndim)
    elif isinstance(node, ast.IfExp):
        yield from _parts(node.body, ndim)
        yield from _parts(node.orelse, ndim)
    elif isinstance(node, ast.BoolOp):
        for part in node.values:
            yield from _parts(part, ndim)
    elif isinstance(node, ast.Subscript | ast.Starred):
        if not (isinstance(node, ast.Subscript) and _is_element(node, ndim)):
            yield from _parts(node.value, ndim)
    elif isinstance(node, ast.ListComp | ast.GeneratorExp):
        for part in (node.elt, *[one.iter for one in node.generators if not isinstance(one.iter, ast.Name)]):
            yield from _parts(part, ndim)
    elif isinstance(node, ast.BinOp):  # of lists and tuples, which keep their elements
        for side in (node.left, node.right):
            if isinstance(side, (*_DISPLAYS, ast.BinOp)):
                yield from _parts(side, ndim)
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in ("max", "min"):
        yield from (part for part in node.args if isinstance(part, ast.Name))
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in _VIEWS:
        for part in (node.func.value, *node.args[:1]):
            yield from _parts(part, ndim)
    else:
        yield node


def _is_element(node: ast.Subscript, ndim: int) -> bool:
    """Returns whether an index of a variable selects an element: a number for each dimension, no slice or ``None``."""
    index = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
    are_numbers = all(not isinstance(one, ast.Slice | ast.Starred) for one in index)
    has_others = any(isinstance(one, ast.Constant) and one.value in (None, ...) for one in index)
    return isinstance(node.value, ast.Name) and len(index) == ndim and are_numbers and not has_others


def _of_library(function: ast.expr) -> bool:
    """Returns whether a called function is a builtin, or has the prefix of NumPy or of ``math``."""
    if isinstance(function, ast.Attribute):
        return isinstance(function.value, ast.Name) and function.value.id in ("np", "numpy", "math")
    return isinstance(function, ast.Name) and function.id in ("len", "int", "float", "bool", "abs", "min", "max", "sum")


def calls_own_functions(node: ast.AST) -> bool:
    """Returns whether a statement calls something that may change the state: anything but NumPy, ``math``, builtins."""
    return any(isinstance(one, ast.Call) and not _of_library(one.func) for one in ast.walk(node))


def changed_attributes(body: list[ast.stmt]) -> set[str]:
    """Returns the names of attributes that statements assign, or whose elements they assign."""
    found = set()
    for statement in body:
        for one in ast.walk(statement):
            targets = one.targets if isinstance(one, ast.Assign) else []
            for target in [one.target] if isinstance(one, ast.AugAssign | ast.AnnAssign | ast.For) else targets:
                found |= {part.attr for part in ast.walk(target) if isinstance(part, ast.Attribute)}
    return found


def info_names(node: ast.FunctionDef) -> set[str]:
    """Returns the names of the info dicts that ``reset`` or ``step`` returns last."""
    found = set()
    for one in ast.walk(node):
        if isinstance(one, ast.Return) and isinstance(one.value, ast.Tuple) and len(one.value.elts) in (2, 5):
            last = one.value.elts[-1]
            if isinstance(last, ast.Name):
                found.add(last.id)
    return found


def growing_lists(node: ast.AST, own: str) -> list[ast.Attribute]:
    """Returns the attributes of the environment in statements such as ``self.path.append(cell)``."""
    found = []
    for one in ast.walk(node):
        call = one.value if isinstance(one, ast.Expr) else None
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute) and call.func.attr in GROWING:
            base = call.func.value
            if isinstance(base, ast.Attribute) and isinstance(base.value, ast.Name) and base.value.id == own:
                found.append(base)
    return found


def new_lists(node: ast.AST) -> list[ast.expr]:
    """Returns the targets of assignments of lists that are written out, such as ``self.path = []``."""
    found: list[ast.expr] = []
    for one in ast.walk(node):
        targets = one.targets if isinstance(one, ast.Assign) else [one.target] if isinstance(one, ast.AnnAssign) else []
        for target in targets:
            value = one.value  # type: ignore[attr-defined]
            if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple) and len(targets) == 1:
                pairs = list(zip(target.elts, value.elts, strict=False))
            else:
                pairs = [(target, value)]
            found += [part for part, given in pairs if isinstance(given, ast.List) and len(targets) == 1]
    return found


def leaves_loop(body: list[ast.stmt]) -> bool:
    """Returns whether statements in the body of a loop break or continue this loop."""
    for statement in body:
        if isinstance(statement, ast.Break | ast.Continue):
            return True
        if not isinstance(statement, LOOPS):
            for inner in ("body", "orelse"):
                if leaves_loop(getattr(statement, inner, [])):
                    return True
    return False
