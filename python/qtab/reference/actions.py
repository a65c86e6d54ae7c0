"""The actions of an environment, in the order of the columns of the table."""

import itertools
from typing import Any

import gymnasium as gym
import numpy as np

from qtab._utils.checks import required
from qtab.config import Config


def actions(env: gym.Env, config: Config) -> list[Any]:
    """Returns the actions as ``env.step`` takes them: integers, or arrays where the action space is a Box.

    Raises:
        TypeError: for any other action space.
    """
    space = env.action_space
    if isinstance(space, gym.spaces.Discrete):
        return [int(space.start) + action for action in range(int(space.n))]
    if not isinstance(space, gym.spaces.Box):
        raise TypeError(f"the action space must be Discrete or a Box, got {space}")
    if isinstance(config.actions, int):
        # Equal steps along each component, and every combination of them.
        steps = np.linspace(space.low, space.high, config.actions, dtype=space.dtype)
        return [np.array(action, dtype=space.dtype) for action in itertools.product(*steps.T)]
    listed = required("actions", config.actions)
    return [np.array(action, dtype=space.dtype).reshape(space.shape) for action in listed]
