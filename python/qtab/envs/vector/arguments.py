"""Checks of the arguments of a vector environment and of its ``reset``, the latter with Gymnasium's errors."""

from collections.abc import Sequence
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec
from gymnasium.error import Error, ResetNeeded
from numpy.typing import NDArray

from qtab import _core
from qtab._utils import checks
from qtab._utils.shown import shown
from qtab.envs.in_rust.matching import NotInRustError, entry_for_env
from qtab.envs.in_rust.native import native_env
from qtab.envs.origin.class_code import is_of_library
from qtab.envs.registry import ENTRIES, PREFIX, EnvEntry, gymnasium_id


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
    """Returns what to write instead of a class; Rust steps only some classes of one's own."""
    if getattr(cls, "__qtab_env__", None) is None and is_of_library(cls):
        return ""
    own = f"gymnasium.register('my/{cls.__name__}-v0', {cls.__name__}) and pass 'my/{cls.__name__}-v0'"
    if getattr(cls, "__qtab_env__", None) is not None:
        return f"; call {own}"
    makers = f"gymnasium.vector.SyncVectorEnv([{cls.__name__}] * num_envs)"
    return f"; Rust steps a qtab.FunctionalEnv, registered with an id; step this class with {makers}"


def entry_to_step(spec: EnvSpec, env: gym.Env[Any, Any]) -> EnvEntry:
    """Returns the entry of an environment that was made from a spec.

    Raises:
        ValueError: if Rust does not step it; the message gives the reason.
    """
    if gymnasium_id(spec.id) in ENTRIES:
        return ENTRIES[gymnasium_id(spec.id)]
    try:
        return entry_for_env(env)
    except NotInRustError as error:
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
