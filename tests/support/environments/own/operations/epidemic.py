"""An epidemic in a population; the actions are degrees of restriction."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab

CONTACTS = [3.0, 1.5, 0.6]


def infection_probability(contacts: float, infected: int, total: int) -> float:
    return contacts * 0.2 * infected / total


class Epidemic(qtab.FunctionalEnv):
    """The state is the number of susceptible and infected people. The contacts are a global list."""

    observation_space = gym.spaces.Box(0, 1000, (2,), np.int32)
    action_space = gym.spaces.Discrete(3)

    def __init__(self, people: int = 1000, recovery: float = 0.25) -> None:
        self.people, self.recovery = people, recovery

    def initial_state(self, rng: np.random.Generator) -> Any:
        infected = 1 + rng.binomial(20, 0.5)
        return self.people - infected, infected

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        susceptible, infected = state
        probability = min(infection_probability(CONTACTS[action], infected, self.people), 1.0)
        new = rng.binomial(susceptible, probability)
        recovered = rng.binomial(infected, self.recovery)
        infected = infected + new - recovered
        return (susceptible - new, infected), -new - 5.0 * action, infected == 0

    def observe(self, state: Any) -> Any:
        return state
