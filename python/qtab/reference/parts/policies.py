"""Policies, which choose actions from their values (Sutton & Barto, 2nd ed., sections 2.2, 2.7 and 2.8)."""

import math
from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from qtab._utils.checks import required
from qtab.config import Config
from qtab.reference.parts.schedules import epsilon_schedule
from qtab.reference.parts.streams import AgentStream

Values = NDArray[np.float64]


class Policy(Protocol):
    """Chooses actions from their values."""

    def choose(self, values: Values, state: list[int]) -> int:
        """Returns an action in a state, which is given by its active rows."""

    def probabilities(self, values: Values, state: list[int]) -> list[float]:
        """Returns the probability of each action in a state."""

    def end_episode(self) -> None:
        """Called after every episode; softmax and UCB do not change then."""


class EpsilonGreedy(Policy):
    """With probability ε a random action, else a greedy one."""

    def __init__(self, config: Config, rng: AgentStream) -> None:
        self.rng = rng
        self.epsilon = epsilon_schedule(config)
        self.random_ties = config.ties == "random"
        self.config = config

    def choose(self, values: Values, state: list[int]) -> int:  # noqa: ARG002
        """Always draws one ``random()``; one integer more to explore, or to choose among several greedy actions."""
        if self.rng.random() < 1.0 - self.epsilon.value:
            greedy = self.greedy(values)
            return greedy[0] if len(greedy) == 1 else greedy[int(self.rng.integers(0, len(greedy)))]
        valid = valid_actions(self.config, values)
        return valid[int(self.rng.integers(0, len(valid)))]

    def greedy(self, values: Values) -> list[int]:
        """Returns the greedy actions to choose from: the first, or with random ties all of them."""
        if self.random_ties:
            return [int(action) for action in np.flatnonzero(values == np.max(values))]
        return [int(np.argmax(values))]

    def probabilities(self, values: Values, state: list[int]) -> list[float]:  # noqa: ARG002
        """Returns ε / n for each of the n valid actions, and shares the rest among the greedy ones."""
        epsilon, greedy = self.epsilon.value, self.greedy(values)
        valid = valid_actions(self.config, values)
        shares = [epsilon / len(valid) if action in valid else 0.0 for action in range(len(values))]
        for action in greedy:
            shares[action] += (1.0 - epsilon) / len(greedy)
        return shares

    def end_episode(self) -> None:
        """Decreases ε."""
        self.epsilon.end_episode()


class Softmax(Policy):
    """Each action with probability proportional to exp(Q / τ)."""

    def __init__(self, config: Config, rng: AgentStream) -> None:
        self.rng = rng
        self.temperature = required("temperature", config.temperature)

    def choose(self, values: Values, state: list[int]) -> int:
        """Draws one ``random()`` and compares it with the cumulative sum of the probabilities."""
        drawn, reached = self.rng.random(), 0.0
        for action, share in enumerate(self.probabilities(values, state)):
            reached += share
            if drawn < reached:
                return action
        return int(np.flatnonzero(values != -math.inf)[-1])

    def probabilities(self, values: Values, state: list[int]) -> list[float]:  # noqa: ARG002
        """Returns exp(Q / τ) over their sum, shifted by the largest value so that nothing overflows."""
        largest = np.max(values)
        weights = [math.exp((value - largest) / self.temperature) for value in values]
        total = 0.0
        for weight in weights:
            total += weight
        return [weight / total for weight in weights]


class Ucb(Policy):
    """The action with the largest upper confidence bound of its value (section 2.7)."""

    def __init__(self, config: Config, rng: AgentStream) -> None:
        self.rng, self.config = rng, config
        self.confidence = required("confidence", config.confidence)
        self.random_ties = config.ties == "random"
        self.counts: dict[int, list[int]] = {}

    def choose(self, values: Values, state: list[int]) -> int:
        """Draws one integer to choose among several actions with the largest bound, if ties are random."""
        candidates = self.candidates(values, state)
        action = candidates[0] if len(candidates) == 1 else candidates[int(self.rng.integers(0, len(candidates)))]
        self.counts[state[0]][action] += 1
        return action

    def bounds(self, values: Values, state: list[int]) -> list[float]:
        """Returns Q + c √(ln t / N), where N counts the choices of an action in the state and t is 1 more than all."""
        counts = self.counts.setdefault(state[0], [0] * len(values))
        log = math.log(1 + sum(counts))
        valid = valid_actions(self.config, values)
        return [
            (math.inf if action in valid else -math.inf)
            if count == 0
            else float(values[action]) + self.confidence * math.sqrt(log / count)
            for action, count in enumerate(counts)
        ]

    def candidates(self, values: Values, state: list[int]) -> list[int]:
        """Returns the actions with the largest bound: the first, or with random ties all of them."""
        bounds = self.bounds(values, state)
        best = [action for action, bound in enumerate(bounds) if bound == max(bounds)]
        return best if self.random_ties else best[:1]

    def probabilities(self, values: Values, state: list[int]) -> list[float]:
        """Returns equal shares for the actions with the largest bound."""
        candidates = self.candidates(values, state)
        return [1.0 / len(candidates) if action in candidates else 0.0 for action in range(len(values))]


def valid_actions(config: Config, values: Values) -> list[int]:
    """Returns the actions that a state has. All others have the value -inf, by a mask or in the initial table."""
    missing_at_first = isinstance(config.initial_q, np.ndarray) and bool(np.isneginf(config.initial_q).any())
    if config.action_mask is False and not missing_at_first:
        return list(range(len(values)))
    return [action for action, value in enumerate(values) if value != -math.inf]


def policy(config: Config, rng: AgentStream) -> Policy:
    """Returns the policy of a complete config."""
    kinds: dict[str, Callable[[Config, AgentStream], Policy]]
    kinds = {"epsilon_greedy": EpsilonGreedy, "softmax": Softmax, "ucb": Ucb}
    return kinds[config.exploration](config, rng)
