"""A small taxi world."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab

STOPS = ((0, 0), (0, 4), (4, 0), (4, 3))


class Taxi(qtab.FunctionalEnv):
    """The state is the row, the column, the passenger's stop (4 in the taxi) and the destination."""

    observation_space = gym.spaces.MultiDiscrete([5, 5, 5, 4])
    action_space = gym.spaces.Discrete(6)

    def initial_state(self, rng: np.random.Generator) -> Any:
        passenger = rng.integers(0, 4)
        destination = (passenger + rng.integers(1, 4)) % 4
        return rng.integers(0, 5), rng.integers(0, 5), passenger, destination

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        row, column, passenger, destination = state
        if action < 2:
            row = min(max(row + 2 * action - 1, 0), 4)
        elif action < 4:
            column = min(max(column + 2 * action - 5, 0), 4)
        elif action == 4:
            if passenger == 4 or STOPS[passenger] != (row, column):
                return state, -10, False
            passenger = 4
        else:
            if passenger != 4 or STOPS[destination] != (row, column):
                return state, -10, False
            return (row, column, destination, destination), 20, True
        return (row, column, passenger, destination), -1, False

    def observe(self, state: Any) -> Any:
        return state
