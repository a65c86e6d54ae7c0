"""The shop of ``src/lib.rs`` in Python: the same numbers, hundreds of times slower in training."""

from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces


class Shop(gym.Env[Any, Any]):
    """A shop that orders goods every evening, and sells them the next day."""

    capacity, largest_order = 12, 8
    price, cost, delivery, storage = 3.0, 1.0, 1.5, 0.125

    def __init__(self) -> None:
        self.observation_space = spaces.MultiDiscrete([self.capacity + 1, 7])
        self.action_space = spaces.Discrete(self.largest_order + 1)

    def _answer(self) -> tuple[Any, dict[str, Any]]:
        orders = np.arange(self.largest_order + 1)
        return np.array([self.stock, self.day]), {"action_mask": self.stock + orders <= self.capacity}

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Begins an episode."""
        super().reset(seed=seed)
        self.stock = int(self.np_random.integers(0, self.capacity + 1))
        self.day = int(self.np_random.integers(0, 7))
        return self._answer()

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Takes one step."""
        order = int(action)
        customers = int(self.np_random.integers(0, 6 if self.day < 5 else 10))
        sold = min(customers, self.stock + order)
        self.stock += order - sold
        self.day = (self.day + 1) % 7
        spent = self.cost * order + (self.delivery if order > 0 else 0.0)
        reward = self.price * sold - spent - self.storage * self.stock
        observation, info = self._answer()
        return observation, reward, False, False, info
