"""Named settings for the environments that have a known good start."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from qtab.models import gymnasium_id

# G. Hayes, "Getting Started with Reinforcement Learning and Open AI Gym" (2019). What equals the config's default is
# not repeated: those defaults are the article's.
_ARTICLE = {"scale": (10.0, 100.0), "terminal_update": "assign"}

# The first preset of an environment is its own.
_PRESETS: Mapping[str, Mapping[str, Mapping[str, Any]]] = {
    "MountainCar-v0": {"article": _ARTICLE},
}


def presets(env: str) -> Mapping[str, Mapping[str, Any]]:
    """Returns the presets of an environment by name, its own one first."""
    return MappingProxyType(_PRESETS.get(gymnasium_id(env), {}))


def preset(env: str, name: str | None) -> tuple[str | None, Mapping[str, Any]]:
    """Returns the name and the values of an environment's preset; None asks for its own, if it has one.

    Raises:
        ValueError: if there is none of that name.
    """
    known = presets(env)
    if name is None:
        return next(iter(known.items()), (None, {}))
    if name not in known:
        there = ", ".join(map(repr, known)) or "none"
        raise ValueError(f"preset must be one that {env} has ({there}), got {name!r}")
    return name, known[name]
