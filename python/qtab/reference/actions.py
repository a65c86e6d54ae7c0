"""What a table's columns stand for."""

import itertools
from typing import Any

import gymnasium as gym
import numpy as np

from qtab.config import Config


def actions(env: gym.Env, config: Config) -> list[Any]:
    """Returns what the environment's step takes: integers, or arrays where its action space is a Box."""
    space = env.action_space
    if isinstance(space, gym.spaces.Discrete):
        return [int(space.start) + action for action in range(int(space.n))]
    assert isinstance(space, gym.spaces.Box)  # noqa: S101
    if isinstance(config.actions, int):
        # Equal steps along each component, and every combination of them.
        steps = np.linspace(space.low, space.high, config.actions, dtype=space.dtype)
        return [np.array(action, dtype=space.dtype) for action in itertools.product(*steps.T)]
    assert config.actions is not None  # noqa: S101 - resolved
    return [np.array(action, dtype=space.dtype).reshape(space.shape) for action in config.actions]
