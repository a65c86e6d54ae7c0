"""Makes signatures readable: types have short names, and the settings of ``train`` are ``**settings``.

The docstrings list the settings in groups; each gets its type and its default there. Classes of results, which users
do not construct, have no signature; their attributes are listed.
"""

import dataclasses
import inspect
import re
from collections.abc import Iterator
from typing import Any, get_type_hints

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.domains.python import _annotations

from qtab.config import Config
from qtab.config.help import default
from qtab.config.settings import Settings

SHORTER = (
    (
        re.compile(r"(?:numpy\.)?ndarray\[tuple\[(?:typing\.)?Any, \.\.\.\], (?:numpy\.)?dtype\[([^\]]+)\]\]"),
        r"NDArray[\1]",
    ),
    (re.compile(r"\bfloating\[[^\]]*\]"), "floating"),
    (
        re.compile(
            r"\b(?:typing|collections\.abc|concurrent\.futures\._base|gymnasium(?:\.\w+)+|np(?:\.random)?|numpy(?:\.random\._generator)?|os|qtab(?:\.\w+)+|gym|pd|pandas)\.(?=\w)"
        ),
        "",
    ),
    (re.compile(r"\bOptional\[(.*)\]$"), r"\1 | None"),
    (re.compile(r"\bUnion\[(.*)\]$"), r"\1"),
    (re.compile(r"'([A-Z]\w*)'"), r"\1"),
)
SETTINGS = get_type_hints(Settings)


def shorten(text: str) -> str:
    """Returns an annotation without the modules of its types."""
    for pattern, replacement in SHORTER:
        text = pattern.sub(replacement, text)
    return text


def spelled(annotation: Any) -> str:
    """Returns an annotation as a short text."""
    return shorten(annotation if isinstance(annotation, str) else inspect.formatannotation(annotation))


def parameters(value: Any, bound: bool) -> Iterator[str]:
    """Yields the parameters of a function or a class as they are shown: settings as one, the rest with types."""
    found = list(inspect.signature(value).parameters.values())
    has_settings = "learning_rate" in {one.name for one in found}
    keyword_only = False
    for one in found[1 if bound else 0 :]:
        if has_settings and one.kind is one.KEYWORD_ONLY and one.name in SETTINGS:
            continue
        if one.kind is one.KEYWORD_ONLY and not keyword_only:
            keyword_only = True
            yield "*"
        star = {one.VAR_POSITIONAL: "*", one.VAR_KEYWORD: "**"}.get(one.kind, "")
        keyword_only = keyword_only or star == "*"
        annotation = "" if one.annotation is one.empty or star == "**" else f": {spelled(one.annotation)}"
        shown = "" if one.default is one.empty else f"{' = ' if annotation else '='}{one.default!r}"
        yield star + one.name + annotation + shown
    if has_settings:
        yield "**settings"


def format_signature(
    app: Sphinx, kind: str, name: str, value: Any, options: Any, signature: str | None, returned: str | None
) -> tuple[str, str] | None:
    """Writes the signature of a function, a method or a class."""
    if kind == "class" and dataclasses.is_dataclass(value) and value is not Config:
        return "", ""
    if signature is None or value is Config:
        return ("", "") if value is Config else None
    try:
        bound = kind == "method" and not isinstance(inspect.getattr_static(*_owner(value)), staticmethod | classmethod)
        text = ", ".join(parameters(value, bound))
        result = inspect.signature(value).return_annotation if kind != "class" else None
    except (TypeError, ValueError, AttributeError):
        return shorten(signature), shorten(returned or "")
    return f"({text})", "" if result in (None, inspect.Signature.empty) else spelled(result)


def _owner(function: Any) -> tuple[Any, str]:
    """Returns the class of a method, and the method's name."""
    owner: Any = inspect.getmodule(function)
    *classes, name = function.__qualname__.split(".")
    for one in classes:
        owner = getattr(owner, one)
    return owner, name


def edit_docstring(app: Sphinx, kind: str, name: str, value: Any, options: Any, lines: list[str]) -> None:
    """Leaves out attributes that are listed elsewhere, adds the types of settings, and escapes the stars of shapes."""
    if kind == "class" and dataclasses.is_dataclass(value) and "Attributes:" in lines:
        del lines[lines.index("Attributes:") :]
    if "**settings" in str(lines):
        group = ""
        for index, line in enumerate(lines):
            group = line if re.match(r"\w+:$", line) else group
            found = re.match(r"    (\w+): ", line)
            if found and found[1] in SETTINGS and group not in ("Args:", "Returns:", "Raises:"):
                shown = f"{spelled(SETTINGS[found[1]])}, default {default(found[1])!r}"
                lines[index] = f"    {found[1]} ({shown}): {line[found.end() :]}"
    if kind in ("attribute", "property", "data"):
        # Without a comment first, napoleon takes "(episodes,): the sum of rewards" for a type and a description.
        lines[:0] = ["..", ""]
    lines[:] = [re.sub(r"(?<=\()\*(?=\w+[,)])|(?<=, )\*(?=\w+[,)])", r"\\*", line) for line in lines]


def shorten_types(app: Sphinx, doctree: nodes.document) -> None:
    """Shortens the types of attributes and properties, for which autodoc has no event."""
    for annotation in list(doctree.findall(addnodes.desc_annotation)):
        shown = annotation.deepcopy()
        for condition in list(shown.findall(addnodes.pending_xref_condition)):
            if condition["condition"] == "*":  # the full name, where the short one cannot be resolved
                condition.parent.remove(condition)
        text = shown.astext()
        if text.startswith(": ") and shorten(text) != text:
            annotation.clear()
            annotation += addnodes.desc_sig_punctuation("", ":")
            annotation += addnodes.desc_sig_space()
            annotation.extend(_annotations._parse_annotation(shorten(text[2:]), app.env))


def setup(app: Sphinx) -> dict[str, bool]:
    """Registers the formatting; before napoleon, which reads the docstrings at priority 500."""
    app.connect("autodoc-process-signature", format_signature)
    app.connect("autodoc-process-docstring", edit_docstring, priority=400)
    app.connect("doctree-read", shorten_types)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
