"""Classes that raise errors, or compute differently in compiled code."""

import gymnasium as gym
import numpy as np
from gymnasium import spaces


class Breaks(gym.Env):
    """Raises an error on a cell in the fourth row."""

    def __init__(self) -> None:
        self.observation_space = spaces.Discrete(60)
        self.action_space = spaces.Discrete(2, start=5)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.cell = int(self.np_random.integers(4))
        return self.cell, {}

    def step(self, action):
        self.cell += action - 4
        if self.cell > 30:
            raise ValueError(f"cell {self.cell} does not exist")
        return self.cell, -1.0, self.np_random.random() < 0.05, False, {}


class LeavesArray(Breaks):
    """Reads beyond the end of an array."""

    def __init__(self) -> None:
        super().__init__()
        self.rewards = np.linspace(0.0, 1.0, 12)

    def step(self, action):
        self.cell += action - 4
        return self.cell, self.rewards[self.cell], self.np_random.random() < 0.05, False, {}


class BigIntegers(Breaks):
    """Computes with integers of more than 64 bits."""

    def step(self, action):
        self.cell = (self.cell * 6364136223846793005 + action) * 9007199254740993 % 59
        return self.cell, 0.0, self.np_random.random() < 0.05, False, {}
