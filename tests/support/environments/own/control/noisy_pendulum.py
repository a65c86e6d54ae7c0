"""A pendulum with noise, after Gymnasium's."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab


class NoisyPendulum(qtab.FunctionalEnv):
    """The state is an array of the angle and the angular velocity."""

    observation_space = gym.spaces.Box(np.array([-1.0, -1.0, -8.0]), np.array([1.0, 1.0, 8.0]), dtype=np.float64)
    action_space = gym.spaces.Discrete(5, start=-2)

    def __init__(self, gravity: float = 10.0, noise: float = 0.05) -> None:
        self.gravity, self.noise = gravity, noise

    def initial_state(self, rng: np.random.Generator) -> Any:
        return np.array([rng.uniform(-np.pi, np.pi), rng.uniform(-1.0, 1.0)])

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        angle, velocity = state[0], state[1]
        wrapped = (angle + np.pi) % (2 * np.pi) - np.pi
        cost = wrapped * wrapped + 0.1 * velocity * velocity + 0.001 * action * action
        velocity = velocity + (1.5 * self.gravity * np.sin(angle) + 3.0 * action + rng.normal(0.0, self.noise)) * 0.05
        velocity = min(max(velocity, -8.0), 8.0)
        return np.array([angle + velocity * 0.05, velocity]), -cost, False

    def observe(self, state: Any) -> Any:
        return np.cos(state[0]), np.sin(state[0]), state[1]
