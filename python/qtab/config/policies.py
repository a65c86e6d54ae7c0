"""The policies of the agent."""

from dataclasses import dataclass
from typing import TypeAlias

from qtab._utils.checks import required
from qtab.config.choices import Ties
from qtab.config.config import Config
from qtab.config.schedules import Schedule, epsilon


@dataclass(frozen=True)
class EpsilonGreedy:
    """A random action with probability epsilon, otherwise a greedy one."""

    epsilon: Schedule
    ties: Ties
    """The choice among several greedy actions."""


@dataclass(frozen=True)
class Softmax:
    """Each action with probability proportional to exp(Q / temperature)."""

    temperature: float


@dataclass(frozen=True)
class Ucb:
    """The action with the largest upper confidence bound of its value."""

    confidence: float
    ties: Ties


Policy: TypeAlias = EpsilonGreedy | Softmax | Ucb


def policy(config: Config) -> Policy:
    """Returns the policy of a complete config.

    Raises:
        ValueError: if one of its options is None.
    """
    if config.exploration == "softmax":
        return Softmax(required("temperature", config.temperature))
    if config.exploration == "ucb":
        return Ucb(required("confidence", config.confidence), required("ties", config.ties))
    return EpsilonGreedy(epsilon(config), required("ties", config.ties))
