"""Cliff walking."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab


class Cliff(qtab.FunctionalEnv):
    """The state is the number of a cell; the class has a static method."""

    observation_space = gym.spaces.Discrete(48)
    action_space = gym.spaces.Discrete(4)

    def initial_state(self, rng: np.random.Generator) -> int:
        return 36

    @staticmethod
    def moved(state: int, action: int, width: int = 12) -> tuple[int, int]:
        row, column = state // width, state % width
        if action == 0:
            row -= 1
        elif action == 1:
            column += 1
        elif action == 2:
            row += 1
        else:
            column -= 1
        return min(max(row, 0), 3), min(max(column, 0), width - 1)

    def transition(self, state: int, action: int, rng: np.random.Generator) -> Any:
        row, column = self.moved(state, action)
        if row == 3 and 0 < column < 11:
            return 36, -100, False
        return row * 12 + column, -1, row == 3 and column == 11

    def observe(self, state: int) -> int:
        return state
