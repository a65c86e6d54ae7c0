"""The functions in a student's files, without running the rest of them.

A notebook also has trials, plots and long training runs, and perhaps a cell that fails. Only imports, functions,
classes, and the assignments of names that functions use are run. Each runs separately, so that one that fails does not
hide the others.
"""

import ast
import json
import linecache
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from qtab.exercises.time_limit import TimeIsUp, call_within

_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
_ASSIGNMENTS = (ast.Assign, ast.AnnAssign, ast.AugAssign)


def definitions(files: Sequence[Path], seconds: float) -> tuple[dict[str, Any], list[str]]:
    """Returns what the files define, by name, and a sentence on each part of them that could not be run.

    Args:
        files: Python files and notebooks. If several define a name, the last one counts.
        seconds: The time limit of each statement.
    """
    namespace: dict[str, Any] = {"__name__": "submission"}
    notes: list[str] = []
    statements: list[tuple[str, ast.stmt]] = []
    for path in files:
        try:
            parts = list(_parts(path))
        except (OSError, ValueError, KeyError, TypeError) as error:
            notes.append(f"{path.name} cannot be read: {error}")
            continue
        for name, code in parts:
            linecache.cache[name] = (len(code), None, code.splitlines(keepends=True), name)
            try:
                statements += [(name, node) for node in ast.parse(code, name).body]
            except (SyntaxError, ValueError) as error:
                line = f", line {error.lineno}" if isinstance(error, SyntaxError) else ""
                notes.append(f"{name}{line} is not Python: {getattr(error, 'msg', error)}")
    future = [node for _, node in statements if isinstance(node, ast.ImportFrom) and node.module == "__future__"]
    used = _used([node for _, node in statements])
    for name, node in statements:
        if not _is_definition(node, used):
            continue
        statement = compile(ast.Module([*future, node], []), name, "exec")
        try:
            call_within(seconds, exec, (statement, namespace))
        except TimeIsUp:
            notes.append(f"{name}, line {node.lineno} was stopped after {seconds:g} seconds")
        except (Exception, SystemExit) as error:
            notes.append(f"{name}, line {node.lineno} raised {type(error).__name__}: {error}")
    return namespace, notes


def _parts(path: Path) -> Iterator[tuple[str, str]]:
    """Yields the code of a Python file, or of each cell of a notebook, with its name."""
    text = path.read_text(encoding="utf-8-sig")
    if path.suffix == ".py":
        yield path.name, text
        return
    for number, cell in enumerate(json.loads(text)["cells"]):
        source = "".join(cell["source"])
        if cell["cell_type"] == "code" and not source.lstrip().startswith("%%"):
            yield f"{path.name}, cell {number + 1}", "\n".join(map(_without_magic, source.splitlines()))


def _without_magic(line: str) -> str:
    """Returns a line of a notebook, or an empty line for IPython's ``%matplotlib``, ``!pip`` and ``name?``."""
    code = line.strip()
    return "" if code.startswith(("%", "!", "?")) or code.endswith("?") else line


def _is_definition(node: ast.stmt, used: set[str]) -> bool:
    if isinstance(node, _ASSIGNMENTS):
        return bool(_assigned(node) & used)
    if isinstance(node, ast.ImportFrom) and node.module == "__future__":
        return False
    return isinstance(node, (*_FUNCTIONS, ast.Import, ast.ImportFrom))


def _used(nodes: Sequence[ast.stmt]) -> set[str]:
    """Returns the names that functions and classes use, and those that the assignments of such names use."""
    used = {name for node in nodes if isinstance(node, _FUNCTIONS) for name in _read(node)}
    assignments = [node for node in nodes if isinstance(node, _ASSIGNMENTS)]
    while True:
        more = {name for node in assignments if _assigned(node) & used for name in _read(node)} - used
        if not more:
            return used
        used |= more


def _read(node: ast.AST) -> set[str]:
    return {part.id for part in ast.walk(node) if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Load)}


def _assigned(node: ast.AST) -> set[str]:
    return {part.id for part in ast.walk(node) if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store)}
