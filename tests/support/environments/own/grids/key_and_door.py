"""A corridor with a key at one end and a door at the other; the floor is slippery."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab


class KeyAndDoor(qtab.FunctionalEnv):
    """The state is a place and whether the key was found. The two actions walk left and right."""

    action_space = gym.spaces.Discrete(2)

    def __init__(self, slip: float = 0.1, length: int = 20) -> None:
        self.slip, self.length = slip, length
        self.observation_space = gym.spaces.MultiDiscrete([length, 2])

    def initial_state(self, rng: np.random.Generator) -> Any:
        return rng.integers(0, self.length), False

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        place, has_key = state
        move = 2 * action - 1
        if rng.random() < self.slip:
            move = -move
        place = min(max(place + move, 0), self.length - 1)
        has_key = has_key or place == 0
        done = has_key and place == self.length - 1
        return (place, has_key), (1.0 if done else -0.01), done

    def observe(self, state: Any) -> Any:
        return state
