"""The source code of functions, as syntax trees with the lines of the user's files."""

import ast
import functools
import inspect
import linecache
import textwrap
from dataclasses import dataclass
from types import CodeType, FunctionType
from typing import Any

from qtab.compilation.not_compilable import NotCompilable


@dataclass(frozen=True, eq=False)
class Source:
    """A function's source."""

    function: FunctionType
    node: ast.FunctionDef
    file: str


_known: dict[tuple[CodeType, str], Source] = {}
"""The sources by code objects and their files, which the comparison of code objects leaves out."""


def source_of(function: FunctionType) -> Source:
    """Returns the source of a function.

    Raises:
        NotCompilable: if it is not available, or if the file was edited since it was imported.
    """
    key = function.__code__, function.__code__.co_filename
    if key not in _known:
        _known[key] = _read(function)
    found = _known[key]
    return Source(function, found.node, found.file)


def _read(function: FunctionType) -> Source:
    code, name = function.__code__, function.__qualname__
    file = code.co_filename
    linecache.checkcache(file)
    try:
        lines, first = inspect.getsourcelines(code)
        tree = ast.parse(textwrap.dedent("".join(lines)))
    except (OSError, TypeError, SyntaxError, IndentationError):
        raise NotCompilable(
            f"the source code of {name} is not available", file, code.co_firstlineno, "define the class in a file"
        ) from None
    ast.increment_lineno(tree, first - 1)
    node = tree.body[0]
    if not isinstance(node, ast.FunctionDef):
        advice = "write it as an ordinary function with def"
        raise NotCompilable(f"{name} is not an ordinary function", file, first, advice)
    if not _is_current(function, node):
        advice = "import it again"
        raise NotCompilable(f"the source code of {name} was edited after it was imported", file, first, advice)
    return Source(function, node, file)


def _is_current(function: FunctionType, node: ast.FunctionDef) -> bool:
    """Returns whether the file still has the code that runs.

    Functions with assertions are not compared if pytest imported their module, as pytest rewrites assertions.
    """
    loader = type(function.__globals__.get("__loader__"))
    is_rewritten = (loader.__module__, loader.__name__) == ("_pytest.assertion.rewrite", "AssertionRewritingHook")
    if is_rewritten and any(isinstance(one, ast.Assert) for one in ast.walk(node)):
        return node.name == function.__name__
    code = function.__code__
    text = "".join(linecache.getlines(code.co_filename))
    found = _codes_of(text, code.co_filename, by_statement=False)
    if found is None:
        return node.name == function.__name__
    return _is_among(code, found) or _is_among(code, _codes_of(text, code.co_filename, by_statement=True) or [])


def _is_among(code: CodeType, found: list[CodeType]) -> bool:
    same = [one for one in found if (one.co_name, one.co_firstlineno) == (code.co_name, code.co_firstlineno)]
    return any(_form(one) == _form(code) for one in same)


@functools.lru_cache(maxsize=16)
def _codes_of(text: str, file: str, *, by_statement: bool) -> list[CodeType] | None:
    """Returns the code objects of a file; None for a cell of a notebook with commands of IPython.

    Args:
        text: The content of the file.
        file: Its name.
        by_statement: Whether each statement is compiled alone, as IPython does with a cell. The code of a function then
            does not depend on the imports above it.
    """
    try:
        if not by_statement:
            return _nested(compile(text, file, "exec", dont_inherit=True))
        alone = [ast.Module([statement], []) for statement in ast.parse(text, file).body]
        return [one for module in alone for one in _nested(compile(module, file, "exec", dont_inherit=True))]
    except (SyntaxError, ValueError):
        return None


def _form(value: Any) -> Any:
    """Returns what distinguishes code or a constant of it: 1, 1.0 and True differ, and so do 0.0 and -0.0."""
    if isinstance(value, CodeType):
        return value.co_code, value.co_names, value.co_varnames, value.co_freevars, _form(value.co_consts)
    if isinstance(value, tuple):
        return tuple(map(_form, value))
    if isinstance(value, frozenset):
        return frozenset(map(_form, value))
    return type(value), repr(value)


def _nested(code: CodeType) -> list[CodeType]:
    found = [code]
    for part in code.co_consts:
        if isinstance(part, CodeType):
            found += _nested(part)
    return found
