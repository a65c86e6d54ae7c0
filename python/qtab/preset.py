"""Named settings for the environments that have a known good start."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from qtab.models import gymnasium_id

# G. Hayes, "Getting Started with Reinforcement Learning and Open AI Gym" (2019). What equals the config's default is
# not repeated: those defaults are the article's.
_ARTICLE = {"scale": (10.0, 100.0), "terminal_update": "assign"}

# Sarsa(λ) on tile coding, as in Sutton & Barto, Example 10.1 and Figure 12.10: no exploration is needed, since values
# of zero are optimistic where every step costs one.
_SOLVED = {
    "algorithm": "sarsa_lambda",
    "discretizer": "tiles",
    "tilings": 8,
    "tiles": (16,),
    "learning_rate": 0.5,
    "learning_rate_schedule": "linear",
    "discount": 1.0,
    "epsilon": 0.0,
    "trace_decay": 0.9,
    "trace_cutoff": 1e-3,
    "initial_q": 0.0,
    "episodes": 2000,
}

# The first preset of an environment is its own.
_PRESETS: Mapping[str, Mapping[str, Mapping[str, Any]]] = {
    "MountainCar-v0": {"article": _ARTICLE, "solved": _SOLVED},
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
