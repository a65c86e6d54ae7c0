"""A class of which others replace parts."""

from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces


class Base(gym.Env):
    """A walk on the integers, whose parts the classes below replace."""

    def __init__(self) -> None:
        self.observation_space: Any = spaces.Box(-100, 100, (1,), dtype=np.float64)
        self.action_space: Any = spaces.Discrete(3)
        self.names = ["left", "stay", "right"]
        self.start_cells = np.zeros(2)
        self.velocity = 0.5

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.x = 0.0
        self.cells = np.zeros(2)
        return self.observe(), {}

    def observe(self):
        return np.array([self.x])

    def step(self, action):
        self.x += action - 1.0 + self.np_random.random()
        reward = self.change(action)
        return self.observe(), reward, self.x > 50, False, {}

    def change(self, action):
        return 0.0
