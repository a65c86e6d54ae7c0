"""Constructs in source that cannot be compiled, or whose compiled results differ, with their lines and the advice."""

import ast
import inspect
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from types import FunctionType

from qtab.compilation.checks.known_functions import DRAWS_DIFFERENT, DRAWS_MISSING, NUMPY_DIFFERENT, NUMPY_SUMS
from qtab.compilation.not_compilable import NotCompilable, combined


@dataclass(frozen=True)
class Place:
    """A construct in a user's source."""

    text: str
    file: str
    line: int
    advice: str


def refuse_constructs(functions: list[FunctionType]) -> None:
    """Checks the source of functions, as far as it can be read.

    Raises:
        NotCompilable: with all constructs that cannot be compiled.
    """
    found = []
    for function in functions:
        for node, file, line in _nodes(function):
            if (refused := _refused(node)) is not None:
                reason, advice = refused
                found.append(NotCompilable(f"{_text(node)} {reason}", file, line, advice))
    if found:
        raise combined(found)


def suspects(functions: list[FunctionType]) -> list[Place]:
    """Returns the constructs in the source of functions whose compiled results can differ from Python's."""
    found = []
    for function in functions:
        for node, file, line in _nodes(function):
            if (advice := _suspect(node)) is not None:
                found.append(Place(_text(node), file, line, advice))
    return found


def place_of(function: FunctionType) -> tuple[str, int]:
    """Returns the file and the line of a function."""
    return function.__code__.co_filename, function.__code__.co_firstlineno


def _nodes(function: FunctionType) -> Iterator[tuple[ast.AST, str, int]]:
    try:
        lines, first = inspect.getsourcelines(function)
        tree = ast.parse(textwrap.dedent("".join(lines)))
    except (OSError, SyntaxError, TypeError):
        return
    file = function.__code__.co_filename
    for node in ast.walk(tree):
        yield node, file, first + getattr(node, "lineno", 1) - 1


def _refused(node: ast.AST) -> tuple[str, str] | None:
    is_assigned = isinstance(node, ast.Attribute | ast.Subscript) and isinstance(node.ctx, ast.Store | ast.Del)
    if is_assigned and _dotted(node).startswith("self."):
        return "changes the environment", "keep in the state what changes"
    if isinstance(node, ast.Try):
        # It would catch the errors of integers of more than 64 bits, which Python does not raise.
        return "cannot be compiled", "write the condition with if"
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "super":
        return "cannot be compiled", "call a method of another name"
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
        if _dotted(node.func).startswith(("np.random.", "numpy.random.", "random.")):
            return "does not draw from the generator of the environment", "draw from rng"
        name = node.func.attr
        if name == "integers" and len(node.args) == 1 and not any(word.arg == "high" for word in node.keywords):
            low = ast.unparse(node.args[0])
            return "cannot be compiled with one argument", f"write {ast.unparse(node.func)}(0, {low})"
        if name in DRAWS_MISSING and not _dotted(node.func).startswith(("np.", "numpy.", "math.")):
            return "cannot be compiled", DRAWS_MISSING[name]
    return None


def _suspect(node: ast.AST) -> str | None:
    if isinstance(node, ast.BinOp | ast.AugAssign) and isinstance(node.op, ast.Pow):
        if isinstance(node, ast.BinOp) and isinstance(node.left, ast.Constant) and isinstance(node.right, ast.Constant):
            return None
        return "write products: x * x for x ** 2"
    if isinstance(node, ast.Call):
        name = _dotted(node.func)
        module, _, last = name.rpartition(".")
        if module in ("np", "numpy") and last in NUMPY_DIFFERENT:
            return NUMPY_DIFFERENT[last]
        if last in DRAWS_DIFFERENT and not name.startswith(("np.", "math.")):
            return "draw from another distribution"
        if last in NUMPY_SUMS:
            return "add in a loop"
        if name == "round":
            return "write math.floor(x + 0.5)"
    return None


def _dotted(node: ast.AST) -> str:
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Subscript):
        return _dotted(node.value)
    return f"{_dotted(node.value)}.{node.attr}" if isinstance(node, ast.Attribute) else "?"


def _text(node: ast.AST) -> str:
    text = ast.unparse(node).splitlines()[0]
    return text if len(text) <= 80 else text[:77] + "..."
