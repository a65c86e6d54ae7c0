"""Environments whose observations have only some of the actions."""

from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

MASKS = np.array([[1, 0, 1, 0], [0, 0, 0, 1], [1, 1, 1, 1]], np.int8)
TILES: dict[str, Any] = {"discretizer": "tiles", "tilings": 3, "tiles": (3, 2)}
SHORT: dict[str, Any] = {"episodes": 12, "max_episode_steps": 15}


class MaskedGraph(gym.Env[Any, Any]):
    """Random transitions between a few states, each with its own actions; it refuses the others.

    ``by`` says how it gives its masks: in ``info["action_mask"]``, by a method ``action_masks``, or not at all. Its
    terminal states have no action. With ``shown`` "box" a state is seen as two numbers.
    """

    def __init__(self, masks: NDArray[Any], by: str = "info", shown: str = "discrete") -> None:
        states, actions = masks.shape
        self.masks, self.by, self.shown = masks, by, shown
        self.action_space = gym.spaces.Discrete(actions)
        self.observation_space: Any = gym.spaces.Discrete(states + 1)
        if shown == "box":
            self.observation_space = gym.spaces.Box(-1.0, states + 1.0, (2,), np.float32)
        self.state = 0
        self.taken: list[tuple[int, int]] = []
        if by == "method":
            self.action_masks = lambda: self.mask(self.state)

    def mask(self, state: int) -> NDArray[Any]:
        return self.masks[state] if state < len(self.masks) else np.zeros(self.masks.shape[1], np.int8)

    def _answer(self) -> tuple[Any, dict[str, Any]]:
        info = {"action_mask": self.mask(self.state)} if self.by == "info" else {}
        if self.shown == "box":
            return np.array([self.state, 0.3 * self.state], np.float32), info
        return self.state, info

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self.state = int(self.np_random.integers(len(self.masks)))
        return self._answer()

    def step(self, action: Any) -> Any:
        assert self.masks[self.state, action], f"state {self.state} does not have action {action}"
        self.taken.append((self.state, int(action)))
        self.state = int(self.np_random.integers(len(self.masks) + 1))
        observation, info = self._answer()
        return observation, float(action) - 0.7 * self.state, self.state == len(self.masks), False, info
