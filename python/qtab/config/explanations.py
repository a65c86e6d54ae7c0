"""The explanation of each setting, for the docstrings of functions and the help of the command line."""

from collections.abc import Iterable, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

from qtab._utils.fields import source_fields
from qtab.config.config import DEFAULTS, Config
from qtab.config.options import OPTIONS, listed

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
