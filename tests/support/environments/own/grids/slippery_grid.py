"""A grid with walls and a goal; the agent slips to either side."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab

MOVES = ((-1, 0), (0, 1), (1, 0), (0, -1))


class SlipperyGrid(qtab.FunctionalEnv):
    """The state is a row and a column. The walls are a boolean array."""

    action_space = gym.spaces.Discrete(4)

    def __init__(self, slip: float = 0.2, rows: int = 5, columns: int = 6) -> None:
        self.slip, self.rows, self.columns = slip, rows, columns
        self.walls = np.zeros((rows, columns), np.bool_)
        self.walls[1, 1:4] = True
        self.observation_space = gym.spaces.MultiDiscrete([rows, columns])

    def initial_state(self, rng: np.random.Generator) -> Any:
        while True:
            row, column = rng.integers(0, self.rows), rng.integers(0, self.columns)
            if not self.walls[row, column]:
                return row, column

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        draw = rng.random()
        if draw < self.slip / 2:
            action = (action + 1) % 4
        elif draw < self.slip:
            action = (action - 1) % 4
        row = min(max(state[0] + MOVES[action][0], 0), self.rows - 1)
        column = min(max(state[1] + MOVES[action][1], 0), self.columns - 1)
        if self.walls[row, column]:
            row, column = state
        done = row == self.rows - 1 and column == self.columns - 1
        return (row, column), int(done), done

    def observe(self, state: Any) -> Any:
        return state
