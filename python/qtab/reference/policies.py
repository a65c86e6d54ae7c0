"""How actions are chosen from their values (Sutton & Barto, 2nd ed., sections 2.2 and 2.8)."""

import math
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from qtab.config import Config
from qtab.reference.schedules import epsilon_schedule
from qtab.reference.streams import AgentStream

Values = NDArray[np.float64]


class Policy(Protocol):
    """A way of choosing actions."""

    def choose(self, values: Values) -> int:
        """Returns an action."""

    def probabilities(self, values: Values) -> list[float]:
        """Returns how often each action would be chosen."""

    def end_episode(self) -> None:
        """Called after every episode."""


class EpsilonGreedy:
    """Mostly the greedy action, now and then any."""

    def __init__(self, config: Config, rng: AgentStream) -> None:
        self.rng = rng
        self.epsilon = epsilon_schedule(config)
        self.random_ties = config.ties == "random"
        self.some_missing = isinstance(config.initial_q, np.ndarray) and bool(np.isneginf(config.initial_q).any())

    def choose(self, values: Values) -> int:
        """Draws one ``random()`` always, and one integer to explore, or to choose among several greedy actions."""
        if self.rng.random() < 1.0 - self.epsilon.value:
            greedy = self.greedy(values)
            return greedy[0] if len(greedy) == 1 else greedy[int(self.rng.integers(0, len(greedy)))]
        some = self.there(values)
        return some[int(self.rng.integers(0, len(some)))]

    def there(self, values: Values) -> list[int]:
        """Returns the actions that a state has: where some are missing, their values are -inf."""
        return [action for action, value in enumerate(values) if not (self.some_missing and value == -math.inf)]

    def greedy(self, values: Values) -> list[int]:
        """Returns the actions among which the greedy one is chosen: the first, or all of the best."""
        if self.random_ties:
            return [int(action) for action in np.flatnonzero(values == np.max(values))]
        return [int(np.argmax(values))]

    def probabilities(self, values: Values) -> list[float]:
        """Returns ε / n for each of the actions there are, and the rest for the greedy ones."""
        epsilon, greedy = self.epsilon.value, self.greedy(values)
        some = self.there(values)
        shares = [epsilon / len(some) if action in some else 0.0 for action in range(len(values))]
        for action in greedy:
            shares[action] += (1.0 - epsilon) / len(greedy)
        return shares

    def end_episode(self) -> None:
        """Lets ε fall."""
        self.epsilon.end_episode()


class Softmax:
    """Each action by exp(Q / τ)."""

    def __init__(self, config: Config, rng: AgentStream) -> None:
        assert config.temperature is not None  # noqa: S101
        self.rng = rng
        self.temperature = config.temperature

    def choose(self, values: Values) -> int:
        """Draws one ``random()``, and holds it against the probabilities' cumulative sum."""
        drawn, reached = self.rng.random(), 0.0
        for action, share in enumerate(self.probabilities(values)):
            reached += share
            if drawn < reached:
                return action
        return len(values) - 1

    def probabilities(self, values: Values) -> list[float]:
        """Returns exp(Q / τ) over their sum, shifted by the largest value so that nothing overflows."""
        largest = np.max(values)
        weights = [math.exp((value - largest) / self.temperature) for value in values]
        total = 0.0
        for weight in weights:
            total += weight
        return [weight / total for weight in weights]

    def end_episode(self) -> None:
        """The temperature stays."""


def policy(config: Config, rng: AgentStream) -> Policy:
    """Returns the policy of a resolved config."""
    return Softmax(config, rng) if config.exploration == "softmax" else EpsilonGreedy(config, rng)
