"""Gymnasium's MountainCar, without noise."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab


class MountainCar(qtab.FunctionalEnv):
    """The state is the position and the velocity."""

    observation_space = gym.spaces.Box(np.array([-1.2, -0.07], np.float32), np.array([0.6, 0.07], np.float32))
    action_space = gym.spaces.Discrete(3)

    def __init__(self, force: float = 0.001, gravity: float = 0.0025) -> None:
        self.force, self.gravity = force, gravity

    def initial_state(self, rng: np.random.Generator) -> Any:
        return rng.uniform(-0.6, -0.4), 0.0

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        position, velocity = state
        velocity += (action - 1) * self.force + np.cos(3 * position) * (-self.gravity)
        velocity = min(max(velocity, -0.07), 0.07)
        position = min(max(position + velocity, -1.2), 0.6)
        if position == -1.2 and velocity < 0:
            velocity = 0.0
        return (position, velocity), -1.0, position >= 0.5

    def observe(self, state: Any) -> Any:
        return state
