"""The windy grid world of Sutton and Barto, with random wind."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab


class WindyGrid(qtab.FunctionalEnv):
    """The wind is a list of the environment."""

    observation_space = gym.spaces.MultiDiscrete([7, 10])
    action_space = gym.spaces.Discrete(4)

    def __init__(self, random_wind: bool = True) -> None:
        self.wind = [0, 0, 0, 1, 1, 1, 2, 2, 1, 0]
        self.random_wind = random_wind
        self.goal = (3, 7)

    def initial_state(self, rng: np.random.Generator) -> Any:
        return 3, 0

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        row, column = state
        wind = self.wind[column]
        if self.random_wind and wind > 0:
            wind += rng.integers(-1, 2)
        row += (action == 1) - (action == 0) - wind
        column += (action == 3) - (action == 2)
        row, column = min(max(row, 0), 6), min(max(column, 0), 9)
        return (row, column), -1.0, (row, column) == self.goal

    def observe(self, state: Any) -> Any:
        return state
