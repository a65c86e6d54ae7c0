"""Checks of the arguments of a vector environment and of its ``reset``, the latter with Gymnasium's errors."""

from collections.abc import Sequence
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec
from gymnasium.error import Error, ResetNeeded
from gymnasium.wrappers import TimeLimit
from numpy.typing import NDArray

from qtab import _core
from qtab._utils import checks
from qtab._utils.shown import shown
from qtab.envs.external.capsule import has_capsule
from qtab.envs.in_rust.matching import NotInRustError, entry_for_env, layers
from qtab.envs.in_rust.native import native_env
from qtab.envs.origin.class_code import is_of_library
from qtab.envs.registry import ENTRIES, PREFIX, EnvEntry, gymnasium_id

MAX_RESET_BOUND = 1e6
"""First states beyond this may overflow. Gymnasium's code then decides what happens."""


def spec_to_step(name: Any) -> EnvSpec:
    """Returns the spec of the twin of a Gymnasium id, or of another registered id.

    Raises:
        TypeError: if ``name`` is not a string.
        ValueError: if it is not a registered id; the message suggests the nearest one that Rust implements.
    """
    if isinstance(name, str) and gymnasium_id(name) not in ENTRIES and name in gym.registry:
        return gym.spec(name)
    if isinstance(name, gym.Env) or (isinstance(name, type) and issubclass(name, gym.Env)):
        cls = name if isinstance(name, type) else type(name)
        raise TypeError(f"name must be an environment id, got {shown(name)}{_way_to_an_id(cls)}")
    # A spec instead of an id: Gymnasium would warn of an old version a second time.
    return gym.spec(PREFIX + checks.choice("name", gymnasium_id(name) if isinstance(name, str) else name, ENTRIES))


def _way_to_an_id(cls: type) -> str:
    """Returns what to write instead of a class of one's own."""
    if is_of_library(cls):
        return ""
    return f"; call gymnasium.register('my/{cls.__name__}-v0', {cls.__name__}) and pass 'my/{cls.__name__}-v0'"


def entry_to_step(spec: EnvSpec, env: gym.Env[Any, Any]) -> EnvEntry | None:
    """Returns the entry of an environment that was made from a spec; None for an environment of one's own.

    Raises:
        ValueError: if it is neither; the message gives the reason.
    """
    if has_capsule(env):
        return None
    if gymnasium_id(spec.id) in ENTRIES:
        return ENTRIES[gymnasium_id(spec.id)]
    try:
        return entry_for_env(env)
    except NotInRustError as error:
        bases = type(env.unwrapped).__mro__
        if not is_of_library(bases[0]) and not any(base.__module__.partition(".")[0] == "qtab" for base in bases):
            return None
        env.close()
        raise ValueError(f"name must be the id of an environment that Rust steps, got {spec.id!r}: {error}") from None


def known_env(name: str, env: gym.Env[Any, Any]) -> _core.NativeEnv | None:
    """Returns an environment of the registry as Rust steps it; None if Rust does not take its parameters or table.

    Args:
        name: The name of its entry.
        env: The environment without wrappers.
    """
    try:
        return native_env(name, env)
    except (TypeError, ValueError):
        return None


def seeds_of(seed: Any, num_envs: int) -> list[int | None]:
    """Returns one seed for each sub-environment.

    Args:
        seed: None, the first of consecutive integers, or a list of num_envs integers or None.
        num_envs: The number of sub-environments.

    Raises:
        gymnasium.error.Error: for a seed that is not a non-negative integer.
        TypeError: if ``seed`` is none of the above.
        ValueError: for a list of another length.
    """
    if seed is None:
        return [None] * num_envs
    if isinstance(seed, int):
        seeds: list[Any] = [seed + index for index in range(num_envs)]
    elif isinstance(seed, list | tuple):
        seeds = list(seed)
    else:
        raise TypeError(f"seed must be an integer, a list of integers or None, got {seed!r}")
    if len(seeds) != num_envs:
        raise ValueError(
            f"If seeds are passed as a list the length must match num_envs={num_envs} but got length={len(seeds)}."
        )
    for index, value in enumerate(seeds):
        if value is not None and not isinstance(value, int):
            raise Error(f"sub-environment {index}: Seed must be a python integer, actual type: {type(value)}")
        if value is not None and value < 0:
            raise Error(f"sub-environment {index}: Seed must be greater or equal to zero, actual value: {value}")
    return seeds


def check_reset_mask(mask: Any, num_envs: int, not_reset: Sequence[int]) -> NDArray[np.bool_]:
    """Returns the mask of the sub-environments to reset, (num_envs,) bool.

    Args:
        mask: The value of ``options["reset_mask"]``.
        num_envs: The number of sub-environments.
        not_reset: The indices of those that were never reset, which the mask must include.

    Raises:
        gymnasium.error.ResetNeeded: if the mask leaves out a sub-environment that was never reset.
        TypeError: if it is not a NumPy array of bool.
        ValueError: for another shape, or a mask without any True.
    """
    subject = "`options['reset_mask']` must"
    if not isinstance(mask, np.ndarray):
        raise TypeError(f"{subject} be a numpy array, got {type(mask)}")
    if mask.shape != (num_envs,):
        raise ValueError(f"{subject} have shape `({num_envs},)`, got {mask.shape}")
    if mask.dtype != np.bool_:
        raise TypeError(f"{subject} have `dtype=np.bool_`, got {mask.dtype}")
    if not mask.any():
        raise ValueError(f"{subject} contain a boolean array with at least one True value, got reset_mask={mask}")
    left_out = [index for index in not_reset if not mask[index]]
    if left_out:
        raise ResetNeeded(f"{subject} not leave out sub-environment {left_out[0]}, which was never reset")
    return mask


def reset_bounds(
    names: Sequence[tuple[str, float]] | None, env: gym.Env[Any, Any], options: dict[str, Any] | None
) -> tuple[float, float] | None:
    """Returns the bounds of the first states that the options of a reset set; None for the default ones.

    Args:
        names: The names of the two options, with their defaults; None for an environment without them.
        env: An environment like the sub-environments. It is reset, so that it raises Gymnasium's errors.
        options: The options.
    """
    if names is None or not options:
        return None
    env.reset(options=options)
    low, high = (float(options.get(name, default)) for name, default in names)
    return low, high


def limit_of_wrappers(env: gym.Env) -> int | None:
    """Returns the smallest time limit of the wrappers of an environment, in steps; None if they have none."""
    limits = [layer._max_episode_steps for layer in layers(env) if isinstance(layer, TimeLimit)]
    # Gymnasium accepts any integer; no episode reaches the largest of 64 bits.
    return min([*limits, checks.LARGEST_COUNT]) if limits else None
