"""Admission control of a queue: accept or reject a customer who arrives."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab


class Queue(qtab.FunctionalEnv):
    """The state is the number of waiting customers and whether one asks to join."""

    observation_space = gym.spaces.Dict(asking=gym.spaces.Discrete(2), waiting=gym.spaces.Discrete(21))
    action_space = gym.spaces.Discrete(2)
    CAPACITY = 20

    def __init__(self, arrival: float = 0.6, service: float = 0.5) -> None:
        self.arrival, self.service = arrival, service

    def initial_state(self, rng: np.random.Generator) -> Any:
        return 0, False

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        waiting, asking = state
        reward = 0.0
        if asking and action == 1 and waiting < self.CAPACITY:
            waiting += 1
            reward += 1.0
        if waiting > 0 and rng.random() < self.service:
            waiting -= 1
        reward -= 0.1 * waiting
        return (waiting, rng.random() < self.arrival), reward, False

    def observe(self, state: Any) -> Any:
        return state[1], state[0]
