"""Signatures and docstrings that show every setting, for ``help()``, notebooks and completion at a prompt."""

import inspect
import textwrap
from collections.abc import Callable
from functools import cache
from typing import Any, TypeVar, get_args, get_type_hints

from qtab.config.explanations import applicability, default, explanations, groups

F = TypeVar("F", bound=Callable[..., Any])

_INTRODUCTION = """\
The settings have the defaults of the signature unless ``config`` or a preset gives other values. A setting that does
not apply to the choices made raises an error."""


def with_settings(function: F) -> F:
    """Shows the settings that a function takes as ``**settings: Unpack[...]`` in its signature and its docstring.

    Type checkers read the annotation. At run time ``inspect.signature`` reports each setting as a keyword-only
    parameter with its type and default, and the docstring ends with the explanations.
    """
    signature = inspect.signature(function)
    *parameters, keywords = signature.parameters.values()
    (settings,) = get_args(keywords.annotation)
    types = get_type_hints(settings)
    grouped = groups(types)
    parameters += [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default(name), annotation=types[name])
        for names in grouped.values()
        for name in names
    ]
    function.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
    if function.__doc__ is not None:
        sections = ["\n".join([f"{title}:", *map(_entry, names)]) for title, names in grouped.items()]
        function.__doc__ = "\n\n".join([inspect.cleandoc(function.__doc__), _INTRODUCTION, *sections, ""])
    return function


@cache  # several functions take the same settings
def _entry(name: str) -> str:
    text = f"{name}: {explanations().get(name, '')} {applicability(name)}".strip()
    return textwrap.fill(text, 112, initial_indent=" " * 4, subsequent_indent=" " * 8)
