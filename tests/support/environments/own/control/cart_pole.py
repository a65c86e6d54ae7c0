"""A cart with a pole, after Gymnasium's."""

import math
from typing import Any, NamedTuple

import gymnasium as gym
import numpy as np

import qtab


class Motion(NamedTuple):
    position: float
    velocity: float
    angle: float
    rate: float


class CartPole(qtab.FunctionalEnv):
    """The state is a named tuple. A method computes the total mass."""

    observation_space = gym.spaces.Box(-10.0, 10.0, (4,))
    action_space = gym.spaces.Discrete(2)

    def __init__(self, force: float = 10.0, mass: float = 0.1) -> None:
        self.force, self.mass = force, mass

    def total_mass(self) -> float:
        return self.mass + 1.0

    def initial_state(self, rng: np.random.Generator) -> Motion:
        return Motion(rng.uniform(-0.05, 0.05), rng.uniform(-0.05, 0.05), rng.uniform(-0.05, 0.05), 0.0)

    def transition(self, state: Motion, action: int, rng: np.random.Generator) -> Any:
        force = self.force if action == 1 else -self.force
        cosine, sine = math.cos(state.angle), math.sin(state.angle)
        pushed = (force + 0.5 * self.mass * state.rate * state.rate * sine) / self.total_mass()
        angular = (9.8 * sine - cosine * pushed) / (0.5 * (4.0 / 3.0 - self.mass * cosine * cosine / self.total_mass()))
        linear = pushed - 0.5 * self.mass * angular * cosine / self.total_mass()
        following = Motion(
            state.position + 0.02 * state.velocity,
            state.velocity + 0.02 * linear,
            state.angle + 0.02 * state.rate,
            state.rate + 0.02 * angular,
        )
        return following, 1.0, abs(following.position) > 2.4 or abs(following.angle) > 0.21

    def observe(self, state: Motion) -> Any:
        return np.array([state.position, state.velocity, state.angle, state.rate])
