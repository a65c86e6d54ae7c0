"""Fetch a parcel from one corner of a square and bring it to another: as functions, and as an ordinary class."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab

SIZE = 6
MOVES = ((-1, 0), (0, 1), (1, 0), (0, -1))
SETTINGS: dict[str, Any] = {"discount": 0.95, "epsilon": 0.3, "epsilon_schedule": "constant"}
"""With few episodes, exploration brings the parcel home, and the greedy policy never does."""


class Errand(qtab.FunctionalEnv):
    """The state is a row, a column, and whether the agent has the parcel."""

    observation_space = gym.spaces.MultiDiscrete([SIZE, SIZE, 2])
    action_space = gym.spaces.Discrete(4)

    def __init__(self, cost: float = 1.0) -> None:
        self.cost = cost

    def initial_state(self, rng: np.random.Generator) -> Any:
        return 0, 0, 0

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        row, column, has = state
        if action == 0:
            row -= 1
        elif action == 1:
            column += 1
        elif action == 2:
            row += 1
        else:
            column -= 1
        row, column = min(max(row, 0), 5), min(max(column, 0), 5)
        if row == 5 and column == 0:
            has = 1
        return (row, column, has), -self.cost, has == 1 and row == 0 and column == 5

    def observe(self, state: Any) -> Any:
        return state


class ErrandClass(gym.Env[Any, Any]):
    """The same with attributes."""

    observation_space = Errand.observation_space
    action_space = Errand.action_space

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self.row, self.column, self.has = 0, 0, 0
        return np.array([0, 0, 0]), {}

    def step(self, action: int) -> Any:
        row, column = MOVES[action]
        self.row, self.column = min(max(self.row + row, 0), 5), min(max(self.column + column, 0), 5)
        if self.row == 5 and self.column == 0:
            self.has = 1
        home = self.has == 1 and self.row == 0 and self.column == 5
        return np.array([self.row, self.column, self.has]), -1.0, home, False, {}
