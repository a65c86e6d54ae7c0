"""The explanation of each setting, for the command line, and for signatures and docstrings: ``help()`` shows them."""

import inspect
import textwrap
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any, TypeVar, get_args, get_type_hints

from qtab._utils.fields import source_fields
from qtab._utils.shown import listed
from qtab.config.config import DEFAULTS, Config
from qtab.config.options import OPTIONS

_TITLES = {
    "env": "Environment",
    "episodes": "Run",
    "algorithm": "Learning",
    "exploration": "Exploration",
    "discretizer": "Discretizer",
}
"""The title of each group of settings, by the field of the config that starts the group."""


@cache
def explanations() -> Mapping[str, str]:
    """Returns the docstring of each field of the config, in one line; empty if the source is not installed."""
    return MappingProxyType({name: text for name, _, text in source_fields(Config) if text})


def applicability(name: str) -> str:
    """Returns a sentence that names the choices a setting applies to; empty if it always applies."""
    if name not in OPTIONS:
        return ""
    option = OPTIONS[name]
    return f"Applies to {option.choice} {listed(option.values)}."


def default(name: str) -> Any:
    """Returns the default value of a setting, where it applies, if neither the user nor a preset gives one."""
    option = OPTIONS.get(name)
    return DEFAULTS[name] if option is None or option.default is None else option.default


def groups(names: Iterable[str]) -> dict[str, list[str]]:
    """Returns the settings of each group by its title, in the order of the config, restricted to ``names``."""
    wanted = set(names)
    grouped: dict[str, list[str]] = {}
    title = ""
    for name in DEFAULTS:
        title = _TITLES.get(name, title)
        if name in wanted:
            grouped.setdefault(title, []).append(name)
    return grouped


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
