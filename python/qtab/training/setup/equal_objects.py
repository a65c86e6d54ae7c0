"""Whether an environment is the same whenever it is made."""

from collections.abc import Callable
from contextlib import closing
from typing import Any

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec, load_env_creator

from qtab._utils.shown import shown
from qtab.config import Config
from qtab.envs.in_rust.matching import equal_environments
from qtab.envs.registry import make_env, spec_of
from qtab.training.setup.visibility import HELD, references

DIFFERENT = "two environments that are made differ from each other"


def made_by(function: Callable[[], Any]) -> tuple[gym.Env, str | None]:
    """Returns the environment that a function makes, and why other code can see it; None if none can.

    Raises:
        TypeError: if the function makes something else.
    """
    made, new = function(), gym.Env()
    if not isinstance(made, gym.Env):
        raise TypeError(f"env must make an environment, got {shown(made)}")
    is_held = references(made) > references(new)  # before the result is a tuple, which refers to it, too
    return made, HELD if is_held else None


def maker_of(env: str | EnvSpec | Callable[[], gym.Env]) -> Any:
    """Returns the class or the function that makes an environment, given this or an id."""
    if callable(env):
        return env
    spec = env if isinstance(env, EnvSpec) else spec_of(env)
    return load_env_creator(spec.entry_point) if isinstance(spec.entry_point, str) else spec.entry_point


def makes_equals(env: str | EnvSpec | Callable[[], gym.Env], made: Any, config: Config) -> bool:
    """Returns whether an environment is the same whenever it is made; an id is tried only for a compiled class."""
    if callable(env):
        with closing(env()) as another:
            return equal_environments(made, another)
    if config.backend != "numba":
        return True
    spec = env if isinstance(env, EnvSpec) else spec_of(env)
    with closing(make_env(spec, config.env_kwargs)) as one, closing(make_env(spec, config.env_kwargs)) as other:
        return equal_environments(one, other)
