"""Environments of one's own in a vector environment: functions that Numba compiles, and native libraries."""

import logging
from collections.abc import Sequence
from typing import Any

import gymnasium as gym
from gymnasium import spaces

from qtab import _core
from qtab.envs.external.capsule import external_env
from qtab.envs.external.native_env import NativeEnv, space_of
from qtab.envs.functional import FunctionalEnv
from qtab.envs.in_rust.matching import NotInRustError
from qtab.envs.vector.python_vector_env import Snapshot
from qtab.envs.vector.spaces import VectorSpaces

_LOGGER = logging.getLogger("qtab")


def own_env(env: gym.Env[Any, Any], num_envs: int, copy: bool) -> _core.NativeEnv | None:
    """Returns an environment of one's own as the extension module steps its copies; None if Python must step it.

    The reason is then logged.

    Args:
        env: A ``FunctionalEnv`` or a ``NativeEnv``, perhaps in the wrappers of ``gymnasium.make``.
        num_envs: The number of sub-environments.
        copy: Whether each step returns new arrays of observations.
    """
    try:
        return _in_rust(env, num_envs, copy)
    except NotInRustError as error:
        name = env.spec.id if env.spec is not None else type(env.unwrapped).__name__
        message = "%s is stepped in Python, which is much slower than Rust: %s"
        _LOGGER.warning(message, name, f"{error}; {error.remedy}" if error.remedy else error)
        return None


def _in_rust(env: gym.Env[Any, Any], num_envs: int, copy: bool) -> _core.NativeEnv:
    unwrapped: Any = env.unwrapped
    if not any(type(unwrapped).__qtab_env__ is cls.__qtab_env__ for cls in (FunctionalEnv, NativeEnv)):
        raise NotInRustError("the infos of its class are known to Python only", "derive it from qtab.FunctionalEnv")
    external: Any = external_env(env, "auto")
    if isinstance(unwrapped, NativeEnv):
        if (unwrapped.observation_space, unwrapped.action_space) != (
            space_of(external),
            spaces.Discrete(external.num_actions),
        ):
            raise NotInRustError("its spaces were changed", "leave them as qtab.NativeEnv makes them")
        if unwrapped.max_episode_steps != external.max_episode_steps:
            raise NotInRustError("its max_episode_steps was changed", "register an id with max_episode_steps")
    vector_spaces = VectorSpaces(env.observation_space, unwrapped.action_space, num_envs, copy)
    made: _core.NativeEnv = external.native_env(spaces=vector_spaces)
    return made


def in_python(env: gym.Env[Any, Any], snapshots: Sequence[Snapshot], not_reset: Sequence[int]) -> list[Snapshot]:
    """Returns snapshots of sub-environments with the attributes of the environment in Python.

    Args:
        env: An environment like the sub-environments.
        snapshots: Their snapshots, whose attribute ``state`` are the bytes of the state.
        not_reset: The indices of those that were never reset and have no state.
    """
    unwrapped: Any = env.unwrapped
    if isinstance(unwrapped, NativeEnv):
        return [({**attributes, "_elapsed": elapsed}, elapsed, *rest) for attributes, elapsed, *rest in snapshots]
    started = [index for index in range(len(snapshots)) if index not in not_reset]
    states = dict(zip(started, unwrapped._states_in([snapshots[index][0]["state"] for index in started]), strict=True))
    return [({"state": states[index]} if index in states else {}, *rest) for index, (_, *rest) in enumerate(snapshots)]
