"""The result of ``gymnasium.make_vec("qtab/…")``, with and without wrappers."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import gymnasium as gym
from gymnasium.vector import SyncVectorEnv, VectorEnv

from qtab._utils import checks
from qtab.envs.registry import PREFIX
from qtab.envs.vector import RustVectorEnv
from qtab.envs.vector.arguments import spec_to_step

_SYNC_OPTIONS = {"copy", "autoreset_mode"}
"""The arguments of ``SyncVectorEnv`` that Rust has as well."""


def make_vector_env(
    name: str,
    num_envs: int = 1,
    *,
    wrappers: Sequence[Callable[[gym.Env[Any, Any]], gym.Env[Any, Any]]] = (),
    vector_kwargs: Mapping[str, Any] | None = None,
    **kwargs: Any,
) -> VectorEnv[Any, Any, Any]:
    """Returns the result of ``gymnasium.make_vec("qtab/…")``: with wrappers a ``SyncVectorEnv``, else a RustVectorEnv.

    Args:
        name: The id of the environment.
        num_envs: The number of sub-environments.
        wrappers: Functions that wrap each sub-environment, the first of them innermost. Python then steps one
            sub-environment after another, and Rust each of them.
        vector_kwargs: Arguments of ``SyncVectorEnv``. ``copy`` and ``autoreset_mode`` can also be given directly.
        kwargs: Further arguments of :class:`RustVectorEnv`.

    Raises:
        TypeError: for an argument of the wrong type, or one that is given twice.
        ValueError: for an argument out of range.
    """
    options = dict(vector_kwargs or {})
    for option in options.keys() & kwargs.keys():
        raise TypeError(f"{option} must be given once, got {kwargs[option]!r} and in vector_kwargs {options[option]!r}")
    if not wrappers and options.get("observation_mode", "same") == "same":
        options.pop("observation_mode", None)
        if options.keys() <= _SYNC_OPTIONS:
            return RustVectorEnv(name, num_envs, **options, **kwargs)
    options |= {option: kwargs.pop(option) for option in _SYNC_OPTIONS & kwargs.keys()}
    kwargs.pop("threads", None)
    make = partial(_wrapped_env, partial(gym.make, spec_to_step(name), **kwargs), tuple(wrappers))
    return SyncVectorEnv([make] * checks.integer("num_envs", num_envs, least=1), **options)


def _wrapped_env(make: Callable[[], gym.Env[Any, Any]], wrappers: Sequence[Any]) -> gym.Env[Any, Any]:
    env = make()
    for wrapper in wrappers:
        env = wrapper(env)
    return env


def __getattr__(name: str) -> Any:
    """Returns the vector entry point of an id: ``qtab.envs.make_vector:Taxi-v4``, or that of a user's table."""
    if PREFIX + name not in gym.registry and name not in gym.registry:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return partial(make_vector_env, name)
