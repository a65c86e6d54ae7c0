"""Signatures and docstrings that show every setting, for ``help()``, notebooks and completion at a prompt."""

import inspect
import textwrap
from collections.abc import Callable
from typing import Any, TypeVar, get_args, get_type_hints

from qtab.config.explanations import applicability, default, explanations, groups

F = TypeVar("F", bound=Callable[..., Any])

_INTRODUCTION = """\
A preset's values replace the defaults of the settings below. Options, the settings that apply only beside certain
choices, raise an error beside others."""


def with_settings(function: F) -> F:
    """Shows the settings that a function takes as ``**settings: Unpack[...]`` in its signature and its docstring.

    Type checkers read the annotation, and need no help. At run time ``inspect.signature`` reports each setting as a
    keyword-only parameter with its type and default, and the docstring ends with their explanations.
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
        sections = [_section(title, names) for title, names in grouped.items()]
        parts = [inspect.cleandoc(function.__doc__), _INTRODUCTION, *sections]
        function.__doc__ = "\n\n".join(parts) + "\n"
    return function


def _section(title: str, names: list[str]) -> str:
    entries = [_entry(name) for name in names]
    return "\n".join([f"{title}:", *entries])


def _entry(name: str) -> str:
    text = " ".join(filter(None, [explanations().get(name, ""), applicability(name)]))
    return textwrap.fill(f"{name}: {text}", 112, initial_indent=" " * 4, subsequent_indent=" " * 8)
