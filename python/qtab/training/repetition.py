"""Whether an environment repeats itself: the same seed and the same actions twice, with the same outcome."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.wrappers.utils import RunningMeanStd


def repeats_itself(
    make: Callable[[], AbstractContextManager[gym.Env]], seed: int, actions: Sequence[Sequence[Any]]
) -> bool:
    """Plays episodes twice, and returns whether all observations, rewards and ends were the same to the last bit.

    Args:
        make: Called for each time; it returns the environment, which is left when the time is over.
        seed: The seed of the first reset; no other reset has one.
        actions: The actions of each episode, which stops where the environment ends it.
    """
    outcomes = []
    for _ in range(2):
        with make() as env:
            outcomes.append(_play(env, seed, actions))
    return outcomes[0] == outcomes[1]


def wrapper_with_statistics(env: gym.Env) -> str | None:
    """Returns the class name of the outermost wrapper that keeps a running mean; None if there is none."""
    while isinstance(env, gym.Wrapper):
        if any(isinstance(value, RunningMeanStd) for value in vars(env).values()):
            return type(env).__name__
        env = env.env
    return None


def _play(env: gym.Env, seed: int, actions: Sequence[Sequence[Any]]) -> list[int]:
    """Returns a hash for each reset and each step."""
    outcomes = []
    for episode, episode_actions in enumerate(actions):
        observation, _ = env.reset(seed=seed if episode == 0 else None)
        outcomes.append(hash(_encoded(observation)))
        for action in episode_actions:
            observation, reward, terminated, truncated, _ = env.step(action)
            outcomes.append(hash(_encoded((observation, reward, terminated, truncated))))
            if terminated or truncated:
                break
    return outcomes


def _encoded(value: Any) -> bytes:
    """Returns bytes that are equal for equal bits, also of NaN."""
    if isinstance(value, Mapping):
        return b"".join(_encoded(name) + _encoded(part) for name, part in value.items())
    if isinstance(value, tuple | list):
        return b"".join(_encoded(part) for part in value)
    array = np.asarray(value)
    if array.dtype.hasobject or array.dtype.kind == "U":
        return repr(value).encode()
    return array.dtype.str.encode() + array.tobytes()
