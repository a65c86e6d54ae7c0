"""A room that is heated; the draws are of several distributions."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab


class Thermostat(qtab.FunctionalEnv):
    """The state is the temperature, the outside temperature and the hour."""

    observation_space = gym.spaces.Box(-50.0, 60.0, (3,))
    action_space = gym.spaces.Discrete(3)

    def __init__(self, gain: float = 1.5, loss: float = 0.1, target: float = 20.0) -> None:
        self.gain, self.loss, self.target = gain, loss, target

    def initial_state(self, rng: np.random.Generator) -> Any:
        return rng.triangular(10.0, 18.0, 25.0), rng.normal(5.0, 3.0), 0

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        inside, outside, hour = state
        outside += rng.uniform(-0.5, 0.5) + 0.3 * np.sin(hour * np.pi / 12.0)
        sun = rng.gamma(2.0, 0.2) if 8 <= hour < 18 else 0.0
        inside += self.gain * action - self.loss * (inside - outside) + sun
        inside, outside = min(max(inside, -50.0), 60.0), min(max(outside, -50.0), 60.0)
        return (inside, outside, (hour + 1) % 24), -abs(inside - self.target) - 0.2 * action, False

    def observe(self, state: Any) -> Any:
        return state
