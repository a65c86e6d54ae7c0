"""The functions in a student's files, without running the rest of them.

A notebook also has trials, plots and long training runs, and perhaps a cell that fails. Only imports, functions,
classes, and the assignments of names that functions use are run, also those in ``if`` and ``try`` statements. Each runs
separately, so that one that fails does not hide the others.
"""

import ast
import copy
import linecache
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

from qtab.exercises.classroom.notebook_cells import code_parts
from qtab.exercises.time_limit import TimeIsUp, call_within

_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
_ASSIGNMENTS = (ast.Assign, ast.AnnAssign, ast.AugAssign)


def definitions(files: Sequence[Path], seconds: float, names: Collection[str] = ()) -> tuple[dict[str, Any], list[str]]:
    """Returns what the files define, by name, and a sentence on each part of them that could not be run.

    Args:
        files: Python files and notebooks. If several define a name, the last one counts.
        seconds: The time limit of each statement.
        names: The names of the exercises, which may be assigned, as in ``sarsa = my_function``.
    """
    namespace: dict[str, Any] = {"__name__": "submission"}
    notes: list[str] = []
    statements: list[tuple[str, ast.stmt]] = []
    for path in files:
        try:
            parts, left_out = code_parts(path)
        except (OSError, ValueError, KeyError, TypeError) as error:
            notes.append(f"{path.name} cannot be read: {error}")
            continue
        notes += left_out
        for name, code in parts:
            linecache.cache[name] = (len(code), None, code.splitlines(keepends=True), name)
            try:
                statements += [(name, node) for node in ast.parse(code, name).body]
            except (SyntaxError, ValueError) as error:
                line = f", line {error.lineno}" if isinstance(error, SyntaxError) else ""
                notes.append(f"{name}{line} is not Python: {getattr(error, 'msg', error)}")
    future = [node for _, node in statements if isinstance(node, ast.ImportFrom) and node.module == "__future__"]
    used = _used([node for _, node in statements], names)
    for name, node in statements:
        definition = _definition(node, used)
        if definition is None:
            continue
        try:
            statement = compile(ast.Module([*future, definition], []), name, "exec")
            call_within(seconds, exec, (statement, namespace))
        except TimeIsUp:
            notes.append(f"{name}, line {node.lineno} was stopped after {seconds:g} seconds")
        except (Exception, SystemExit) as error:
            notes.append(f"{name}, line {node.lineno} raised {type(error).__name__}: {error}")
    return namespace, notes


def _definition(node: ast.stmt, used: set[str]) -> ast.stmt | None:
    """Returns a statement, or the definitions in an ``if`` or ``try`` statement; None if it defines nothing."""
    if isinstance(node, _ASSIGNMENTS):
        return node if _assigned(node) & used else None
    if isinstance(node, ast.ImportFrom) and node.module == "__future__":
        return None
    if isinstance(node, (ast.If, ast.Try)):
        return _with_definitions(node, used)
    return node if isinstance(node, (*_FUNCTIONS, ast.Import, ast.ImportFrom)) else None


def _with_definitions(node: ast.If | ast.Try, used: set[str]) -> ast.stmt | None:
    """Returns an ``if`` or ``try`` statement that has only its definitions; None if it has none."""
    handlers = [copy.copy(handler) for handler in getattr(node, "handlers", [])]
    result = copy.copy(node)
    if isinstance(result, ast.Try):
        result.handlers = handlers
    found = False
    for block in (result, *handlers):
        for name in ("body", "orelse", "finalbody"):
            before: list[ast.stmt] = getattr(block, name, [])
            if before:
                after = [kept for inner in before if (kept := _definition(inner, used)) is not None]
                found = found or bool(after)
                setattr(block, name, after or [ast.copy_location(ast.Pass(), before[0])])
    return result if found else None


def _used(nodes: Sequence[ast.stmt], names: Collection[str]) -> set[str]:
    """Returns the names of the exercises, and those that functions, classes and the assignments of such names use."""
    used = set(names)
    while True:
        found = [definition for node in nodes if (definition := _definition(node, used)) is not None]
        more = {name for definition in found for name in _read(definition)} - used
        if not more:
            return used
        used |= more


def _read(node: ast.AST) -> set[str]:
    return {part.id for part in ast.walk(node) if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Load)}


def _assigned(node: ast.AST) -> set[str]:
    """Returns the names to which a statement assigns, or to an item or attribute of which it assigns."""
    found: set[str] = set()
    for part in ast.walk(node):
        target: ast.AST = part
        if isinstance(getattr(part, "ctx", None), ast.Store):
            while isinstance(target, (ast.Subscript, ast.Attribute)):
                target = target.value
            if isinstance(target, ast.Name):
                found.add(target.id)
    return found
