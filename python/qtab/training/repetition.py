"""Tests whether an environment repeats itself: whether equal seeds and actions give equal results."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.wrappers.utils import RunningMeanStd


def repeats_itself(
    make: Callable[[], AbstractContextManager[gym.Env]],
    seed: int,
    actions: Sequence[Sequence[Any]],
    returns: Sequence[float],
) -> bool:
    """Plays episodes twice more, and returns whether all results are equal bit for bit.

    The two passes must have equal observations, rewards and ends, and the returns of the original episodes. The second
    pass begins with a reset by another seed, since some environments draw from the generator of the previous reset.

    Args:
        make: Called for each pass; returns a context manager of the environment.
        seed: The seed of the first reset; all other resets are unseeded.
        actions: The actions of each episode, which stops early if the environment ends it.
        returns: The return of each original episode.
    """
    outcomes = []
    for seeds_before in ((), (seed + 1,)):
        with make() as env:
            for other in seeds_before:
                env.reset(seed=other)
            outcomes.append(_play(env, seed, actions))
    (first, first_returns), (second, _) = outcomes
    return first == second and first_returns == list(returns)


def wrapper_with_statistics(env: gym.Env) -> str | None:
    """Returns the class name of the outermost wrapper with a running mean; None if there is none."""
    while isinstance(env, gym.Wrapper):
        if any(isinstance(value, RunningMeanStd) for value in vars(env).values()):
            return type(env).__name__
        env = env.env
    return None


def _play(env: gym.Env, seed: int, actions: Sequence[Sequence[Any]]) -> tuple[list[int], list[float]]:
    """Returns a hash for each reset and each step, and the return of each episode."""
    outcomes, returns = [], []
    for episode, episode_actions in enumerate(actions):
        observation, _ = env.reset(seed=seed if episode == 0 else None)
        outcomes.append(hash(encoded(observation)))
        returns.append(0.0)
        for action in episode_actions:
            observation, reward, terminated, truncated, _ = env.step(action)
            outcomes.append(hash(encoded((observation, reward, terminated, truncated))))
            returns[-1] += float(reward)
            if terminated or truncated:
                break
    return outcomes, returns


def encoded(value: Any) -> bytes:
    """Encodes an observation, or the result of a step, as bytes that are equal for equal bits, also of NaN."""
    if isinstance(value, Mapping):
        return b"".join(encoded(name) + encoded(part) for name, part in value.items())
    if isinstance(value, tuple | list):
        return b"".join(encoded(part) for part in value)
    array = np.asarray(value)
    if array.dtype.hasobject or array.dtype.kind == "U":
        return repr(value).encode()
    return array.dtype.str.encode() + array.tobytes()
