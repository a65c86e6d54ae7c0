"""The environment of ``board.c`` in Python, and its library with options that make it break a rule."""

from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces

from support.native.libraries import SOURCES, compile_c

SOURCE = SOURCES / "board.c"
SETTINGS: dict[str, Any] = {"episodes": 80, "max_episode_steps": 40, "action_mask": True}


class Board(gym.Env[Any, Any]):
    """A walk on a board of 5 x 3 squares with a forbidden action on its edge."""

    observation_space = spaces.MultiDiscrete([5, 3], start=[-2, 3])
    action_space = spaces.Discrete(3)

    def _is_over(self) -> bool:
        return self.x == 2 and self.y == 5

    def _answer(self) -> tuple[Any, dict[str, Any]]:
        mask = np.array([self.x > -2, self.x < 2, True], np.int8) * (not self._is_over())
        return np.array([self.x, self.y]), {"action_mask": mask.astype(np.int8)}

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[Any, dict[str, Any]]:
        super().reset(seed=seed)
        self.x = -2 + int(self.np_random.integers(0, 2**32, dtype=np.uint32)) % 3
        self.y = 3
        self.steps = 0
        return self._answer()

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        chance = self.np_random.random()
        self.x += {0: -1, 1: 1, 2: 0}[int(action)]
        if chance < 0.3:
            self.y = 3 if self.y == 5 else self.y + 1
        self.steps += 1
        observation, info = self._answer()
        reward = 10.0 if self._is_over() else -1.0 - 0.25 * chance
        return observation, reward, self._is_over(), self.steps == 12 and not self._is_over(), info


def board_library(folder: Path, **options: object) -> Path:
    """The library of the board; ``NO_ACTION=3`` and the like are options of the source."""
    given = [f"-D{name}" if value is True else f"-D{name}={value}" for name, value in options.items()]
    return compile_c(SOURCE, folder, "board", "-Wno-unused", *given)
