"""A field with hidden mines: the state has two arrays with two axes."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab


class MineField(qtab.FunctionalEnv):
    """The actions open cells of a 3 by 3 field; the mask leaves out those that are open."""

    observation_space = gym.spaces.Box(-1, 8, (3, 3), np.int8)
    action_space = gym.spaces.Discrete(9)

    def __init__(self, mines: int = 2) -> None:
        self.mines = mines

    def initial_state(self, rng: np.random.Generator) -> Any:
        mines = np.zeros((3, 3), np.bool_)
        placed = 0
        while placed < self.mines:
            cell = rng.integers(0, 9)
            if not mines[cell // 3, cell % 3]:
                mines[cell // 3, cell % 3] = True
                placed += 1
        return mines, np.full((3, 3), -1, np.int8)

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        mines, seen = state
        row, column = action // 3, action % 3
        if mines[row, column]:
            return (mines, seen), -1.0, True
        seen = seen.copy()
        around = 0
        for other_row in range(max(row - 1, 0), min(row + 2, 3)):
            for other_column in range(max(column - 1, 0), min(column + 2, 3)):
                around += mines[other_row, other_column]
        seen[row, column] = around
        closed = 0
        for one in seen.flat:
            closed += one < 0
        return (mines, seen), 0.1, closed == self.mines

    def observe(self, state: Any) -> Any:
        return state[1]

    def action_mask(self, state: Any) -> Any:
        mask = np.zeros(9, np.bool_)
        for cell in range(9):
            mask[cell] = state[1][cell // 3, cell % 3] < 0
        return mask
