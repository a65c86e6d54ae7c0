"""The gambler's problem of Sutton and Barto, with masked stakes."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab


class Gambler(qtab.FunctionalEnv):
    """The state is the capital; a stake may not exceed it. The reward is whether the goal was reached, a boolean."""

    def __init__(self, goal: int = 20, probability: float = 0.4) -> None:
        self.goal, self.probability = goal, probability
        self.observation_space = gym.spaces.Discrete(goal + 1)
        self.action_space = gym.spaces.Discrete(goal // 2, start=1)

    def initial_state(self, rng: np.random.Generator) -> int:
        return int(rng.integers(1, self.goal))

    def transition(self, state: int, action: int, rng: np.random.Generator) -> Any:
        if action > state:
            raise ValueError("the stake exceeds the capital")
        state += action if rng.random() < self.probability else -action
        state = min(state, self.goal)
        return state, state == self.goal, state == 0 or state == self.goal

    def observe(self, state: int) -> int:
        return state

    def action_mask(self, state: int) -> Any:
        mask = np.zeros(self.goal // 2, np.int8)
        for stake in range(1, self.goal // 2 + 1):
            if stake <= state:
                mask[stake - 1] = 1
        return mask
