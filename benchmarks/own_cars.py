"""MountainCar-v0 as environments of one's own in Python: as functions of its state, and as an ordinary class."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab

STEPS = 200
"""The time limit of an episode."""
SETTINGS: dict[str, Any] = {"scale": (10, 100), "terminal_update": "assign", "progress": False}
"""The settings of the article, which the preset of MountainCar-v0 has."""
LOW, HIGH = np.array([-1.2, -0.07], np.float32), np.array([0.6, 0.07], np.float32)


class OwnCar(qtab.FunctionalEnv):
    """MountainCar-v0 as functions of its state, the position and the velocity."""

    observation_space = gym.spaces.Box(LOW, HIGH)
    action_space = gym.spaces.Discrete(3)

    def __init__(self, force: float = 0.001, gravity: float = 0.0025) -> None:
        self.force, self.gravity = force, gravity

    def initial_state(self, rng: np.random.Generator) -> tuple[float, float]:
        """Returns a position near the bottom, and no velocity."""
        return rng.uniform(low=-0.6, high=-0.4), 0.0

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:  # noqa: ARG002 - it does not draw
        """Returns the next state, the reward and whether the goal is reached."""
        position, velocity = state
        velocity += (action - 1) * self.force + np.cos(3 * position) * (-self.gravity)
        velocity = min(max(velocity, -0.07), 0.07)
        position = min(max(position + velocity, -1.2), 0.6)
        if position == -1.2 and velocity < 0:
            velocity = 0.0
        return (position, velocity), -1.0, position >= 0.5 and velocity >= 0.0

    def observe(self, state: Any) -> Any:
        """Returns the state."""
        return state


class OrdinaryCar(gym.Env[Any, Any]):
    """MountainCar-v0 as a Gymnasium class with attributes that change."""

    observation_space = gym.spaces.Box(LOW, HIGH)
    action_space = gym.spaces.Discrete(3)

    def __init__(self, force: float = 0.001, gravity: float = 0.0025) -> None:
        self.force, self.gravity = force, gravity
        self.position = self.velocity = 0.0

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:  # noqa: ARG002
        """Returns the first observation and an empty info."""
        super().reset(seed=seed)
        self.position, self.velocity = self.np_random.uniform(low=-0.6, high=-0.4), 0.0
        return np.array([self.position, self.velocity], dtype=np.float32), {}

    def step(self, action: int) -> Any:
        """Returns the observation, the reward, whether the goal is reached, False, and an empty info."""
        velocity = self.velocity + (action - 1) * self.force + np.cos(3 * self.position) * (-self.gravity)
        velocity = min(max(velocity, -0.07), 0.07)
        position = min(max(self.position + velocity, -1.2), 0.6)
        if position == -1.2 and velocity < 0:
            velocity = 0.0
        self.position, self.velocity = position, velocity
        terminated = position >= 0.5 and velocity >= 0.0
        return np.array([position, velocity], dtype=np.float32), -1.0, terminated, False, {}


def limited() -> gym.Env[Any, Any]:
    """Returns the environment of functions with the time limit of MountainCar-v0."""
    return gym.wrappers.TimeLimit(OwnCar(), STEPS)


def limited_class() -> gym.Env[Any, Any]:
    """Returns the ordinary class with the time limit of MountainCar-v0."""
    return gym.wrappers.TimeLimit(OrdinaryCar(), STEPS)
