"""The access-control queue of Sutton and Barto."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab

PRIORITIES = np.array([1.0, 2.0, 4.0, 8.0])


class AccessControl(qtab.FunctionalEnv):
    """The state is the number of free servers and the priority of the first customer. The rewards are global."""

    observation_space = gym.spaces.MultiDiscrete([11, 4])
    action_space = gym.spaces.Discrete(2)

    def __init__(self, free: float = 0.06) -> None:
        self.free = free

    def initial_state(self, rng: np.random.Generator) -> Any:
        return 10, rng.integers(0, 4)

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        servers, customer = state
        reward = 0.0
        if action == 1 and servers > 0:
            servers -= 1
            reward = PRIORITIES[customer]
        servers += rng.binomial(10 - servers, self.free)
        return (servers, rng.integers(0, 4)), reward, False

    def observe(self, state: Any) -> Any:
        return state
