"""Small environments as ordinary Gymnasium classes."""

from typing import Any

import gymnasium as gym


class Corridor(gym.Env[int, int]):
    """A corridor with a coin in a random place; slippery. The observation hides whether the coin was found."""

    def __init__(self, length: int = 5, slip: float = 0.25) -> None:
        self.length, self.slip = length, slip
        self.observation_space = gym.spaces.Discrete(length)  # type: ignore[assignment]
        self.action_space = gym.spaces.Discrete(2)  # type: ignore[assignment]

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[int, dict[str, Any]]:
        super().reset(seed=seed)
        self.place = 0
        self.coins = [int(self.np_random.integers(1, 3))]
        return self.place, {}

    def step(self, action: int) -> tuple[int, float, bool, bool, dict[str, Any]]:
        if self.np_random.random() < self.slip:
            action = 1 - action
        self.place = min(max(self.place + 2 * action - 1, 0), self.length - 1)
        reward = -1.0
        if self.place in self.coins:
            self.coins.remove(self.place)
            reward = 5.0
        return self.place, reward, self.place == self.length - 1, False, {}


def corridor(**methods: Any) -> Any:
    """Returns a corridor with other methods."""
    return type("Corridor", (Corridor,), methods)()
