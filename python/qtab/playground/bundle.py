"""Bundles ES modules as one script, for a page in a single file: browsers load no modules from ``file://``."""

import re
from collections.abc import Mapping
from graphlib import CycleError, TopologicalSorter
from posixpath import dirname, join, normpath

_IMPORT = re.compile(
    r"""^import\s+(?:\{(?P<names>[^}]*)\}\s+from\s+)?["'](?P<file>\.{1,2}/[\w./-]+)["'];?[ \t]*$""", re.MULTILINE
)
_DECLARED = re.compile(r"^export\s+(?=(?:async\s+)?(?:function\*?|class|const)\s+(?P<name>\w+))", re.MULTILINE)
_OTHER = re.compile(r"^(?:import|export)\b.*$", re.MULTILINE)
_INDENTATION = re.compile(r"^[ \t]+", re.MULTILINE)
_COMMENT_LINES = re.compile(r"^[ \t]*(?://.*|/\*\*(?:[^*]|\*(?!/))*\*/[ \t]*)\n", re.MULTILINE)


def bundle(sources: Mapping[str, str], entry: str) -> str:
    """Returns one script equivalent to the module ``entry``, without indentation and lines that only hold a comment.

    Args:
        sources: The text of each module by its path. The modules may use ``import { a, b as c } from "./a.js"``,
            ``import "./a.js"`` and ``export`` before a function, a class or a const.
        entry: The module to begin with.

    Raises:
        ValueError: for other imports and exports, a missing module, modules that import each other in a circle, or a
            text in backticks that spans lines, whose indentation would be lost.
    """
    needed: dict[str, set[str]] = {}
    waiting = [entry]
    while waiting:
        name = waiting.pop()
        if name in needed:
            continue
        if name not in sources:
            raise ValueError(f"the module {name} is missing")
        needed[name] = {_imported(name, found) for found in _IMPORT.finditer(sources[name])}
        waiting.extend(needed[name])
    try:
        order = list(TopologicalSorter(needed).static_order())
    except CycleError as error:
        raise ValueError(f"modules import each other in a circle: {' -> '.join(error.args[1])}") from None
    return "\n".join(["const modules = {};", *(_wrapped(name, sources[name]) for name in order)])


def _imported(name: str, found: re.Match[str]) -> str:
    """The path of the module that an import of the module ``name`` names."""
    return normpath(join(dirname(name), found["file"]))


def _wrapped(name: str, source: str) -> str:
    """A module as a function that returns what the module exports."""
    exported = [found["name"] for found in _DECLARED.finditer(source)]
    code = _INDENTATION.sub("", _COMMENT_LINES.sub("", source))
    if spanning := next((line for line in code.splitlines() if line.count("`") % 2), None):
        raise ValueError(f"{name}: {spanning!r} begins or ends a text that spans lines")
    body = _DECLARED.sub("", _IMPORT.sub(lambda found: _destructured(name, found), code))
    if other := _OTHER.search(body):
        raise ValueError(f"{name}: {other[0]!r} is not a form of import or export that can be bundled")
    return f"modules[{name!r}] = (() => {{\n{body}\nreturn {{ {', '.join(exported)} }};\n}})();"


def _destructured(name: str, found: re.Match[str]) -> str:
    if found["names"] is None:
        return ""
    names = re.sub(r"\s+as\s+", ": ", " ".join(found["names"].split()))
    return f"const {{ {names} }} = modules[{_imported(name, found)!r}];"
