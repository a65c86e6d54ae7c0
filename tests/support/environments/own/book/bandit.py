"""A bandit whose arms are drawn at each reset."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab


class Bandit(qtab.FunctionalEnv):
    """The state is the number of pulls and the means of the arms, an array."""

    observation_space = gym.spaces.Discrete(51)

    def __init__(self, arms: int = 4) -> None:
        self.arms = arms
        self.action_space = gym.spaces.Discrete(arms)

    def initial_state(self, rng: np.random.Generator) -> Any:
        means = np.zeros(self.arms)
        for arm in range(self.arms):
            means[arm] = rng.standard_normal()
        return 0, means

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        pulls, means = state
        return (pulls + 1, means), rng.normal(means[action], 1.0), pulls + 1 == 50

    def observe(self, state: Any) -> Any:
        return state[0]
