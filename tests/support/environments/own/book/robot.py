"""A robot that collects cans until its battery is empty, or recharges."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab


class Robot(qtab.FunctionalEnv):
    """The state is nested: the place and the battery, and the cans on the floor as an array of small integers."""

    observation_space = gym.spaces.Tuple(
        (gym.spaces.Discrete(6), gym.spaces.Box(0.0, 1.0, (1,)), gym.spaces.Discrete(7))
    )
    action_space = gym.spaces.Discrete(4)

    def __init__(self, cans: float = 0.5, drain: float = 0.07) -> None:
        self.cans, self.drain = cans, drain

    def initial_state(self, rng: np.random.Generator) -> Any:
        floor = np.zeros(6, np.int8)
        for place in range(6):
            if rng.random() < self.cans:
                floor[place] = 1
        return (0, 1.0), floor

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        (place, battery), floor = state
        reward = 0.0
        if action == 0:
            place = max(place - 1, 0)
        elif action == 1:
            place = min(place + 1, 5)
        elif action == 2:
            if floor[place] == 1:
                floor = floor.copy()
                floor[place] = 0
                reward = 1.0
        elif place == 0:
            battery = 1.0
        battery -= self.drain * rng.exponential(1.0)
        if battery <= 0.0:
            return ((place, 0.0), floor), -5.0, True
        return ((place, battery), floor), reward, False

    def observe(self, state: Any) -> Any:
        (place, battery), floor = state
        left = np.int64(0)
        for one in floor:
            left += np.int64(one)
        return place, battery, left
