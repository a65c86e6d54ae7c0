"""A class whose reward is a method, for tests that override it."""

from typing import Any

import gymnasium as gym
import numpy as np


class ExtraEnv(gym.Env):
    """Has a cell, an array, and rewards of ``extra``."""

    observation_space = gym.spaces.Discrete(10)
    action_space = gym.spaces.Discrete(2)

    def __init__(self):
        self.board = np.zeros(4)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.cell, self.board[:] = 0, 0.0
        return self.cell, {}

    def extra(self) -> Any:
        return 0.0

    def step(self, action):
        self.cell = (self.cell + action) % 10
        return self.cell, self.extra(), False, False, {}
