"""The lander of ``lander.c`` in Python: the same numbers, hundreds of times slower in training."""

from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces


class Lander(gym.Env[Any, Any]):
    """A lander that falls onto a planet and is slowed down by its engine, in gusts of wind."""

    gravity, thrust, gust, seconds = 3.7, 8.0, 0.3, 0.25

    def __init__(self) -> None:
        self.observation_space = spaces.Box(np.array([0, -30], np.float32), np.array([100, 30], np.float32))
        self.action_space = spaces.Discrete(2)

    def _observation(self) -> Any:
        return np.array([self.height, self.velocity], np.float32)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Begins an episode."""
        super().reset(seed=seed)
        self.height = self.np_random.uniform(40, 60)
        self.velocity = self.np_random.uniform(-5, 0)
        return self._observation(), {}

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Takes one step."""
        acceleration = self.thrust - self.gravity if action == 1 else -self.gravity
        velocity = self.velocity + acceleration * self.seconds + self.np_random.uniform(-self.gust, self.gust)
        height = self.height + velocity * self.seconds
        landed = height <= 0
        self.velocity = min(max(velocity, -30.0), 30.0)
        self.height = 0.0 if landed else min(height, 100.0)
        reward = -(self.velocity * self.velocity) if landed else -1.0 if action == 1 else 0.0
        return self._observation(), reward, landed, False, {}
