"""The actions of an environment, in the order of the columns of the table."""

import itertools
from typing import Any

import gymnasium as gym
import numpy as np

from qtab._utils.checks import required
from qtab.config import Config


def actions(env: gym.Env, config: Config) -> list[Any]:
    """Returns the actions as ``env.step`` takes them; for several components every combination, the last one fastest.

    Raises:
        TypeError: for an action space that cannot be enumerated.
    """
    space = env.action_space
    if isinstance(space, gym.spaces.Box) and config.actions is not None:
        if isinstance(config.actions, int):
            # Equal steps along each component, and every combination of them.
            steps = np.linspace(space.low.ravel(), space.high.ravel(), config.actions, dtype=space.dtype)
            return [np.array(action, dtype=space.dtype).reshape(space.shape) for action in itertools.product(*steps.T)]
        listed = required("actions", config.actions)
        return [np.array(action, dtype=space.dtype).reshape(space.shape) for action in listed]
    return all_actions(space)


def all_actions(space: gym.Space[Any]) -> list[Any]:
    """Returns every action of a discrete space: integers, arrays, tuples or dicts."""
    match space:
        case gym.spaces.Discrete():
            return [int(space.start) + action for action in range(int(space.n))]
        case gym.spaces.MultiDiscrete():
            ranges = [
                range(start, start + count)
                for start, count in zip(space.start.ravel().tolist(), space.nvec.ravel().tolist(), strict=True)
            ]
        case gym.spaces.MultiBinary():
            ranges = [range(2)] * int(np.prod(space.shape))
        case gym.spaces.Box() if space.dtype is not None and space.dtype.kind in "iub":
            ranges = [
                range(low, high + 1)
                for low, high in zip(space.low.ravel().tolist(), space.high.ravel().tolist(), strict=True)
            ]
        case gym.spaces.Tuple():
            return list(itertools.product(*map(all_actions, space.spaces)))
        case gym.spaces.Dict():
            combinations = itertools.product(*map(all_actions, space.spaces.values()))
            return [dict(zip(space.spaces, values, strict=True)) for values in combinations]
        case _:
            raise TypeError(f"the action space must have finitely many actions, got {space}")
    return [np.array(values, dtype=space.dtype).reshape(space.shape) for values in itertools.product(*ranges)]
