"""The random walk of Sutton and Barto."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab


class RandomWalk(qtab.FunctionalEnv):
    """The state is a place; the action does not matter."""

    action_space = gym.spaces.Discrete(1)

    def __init__(self, states: int = 19) -> None:
        self.states = states
        self.observation_space = gym.spaces.Discrete(states + 2)

    def initial_state(self, rng: np.random.Generator) -> int:
        return (self.states + 1) // 2

    def transition(self, state: int, action: int, rng: np.random.Generator) -> Any:
        state += 1 if rng.random() < 0.5 else -1
        reward = -1 if state == 0 else 1 if state == self.states + 1 else 0
        return state, reward, reward != 0

    def observe(self, state: int) -> int:
        return state
