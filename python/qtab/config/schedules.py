"""The schedules, the policy and the options of the algorithm of a complete config."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import TypeAlias

from qtab._utils.checks import required
from qtab.config.choices import Ties
from qtab.config.config import Config
from qtab.config.options import options_of


@dataclass(frozen=True)
class Constant:
    """The same value in every episode."""

    value: float

    def after(self, episodes: int, total: int) -> float:  # noqa: ARG002 - as the others
        """Returns the value."""
        return self.value


@dataclass(frozen=True)
class Linear:
    """Falls by equal amounts from episode ``warm_up`` on, to reach ``minimum`` at the end of the run."""

    value: float
    minimum: float
    warm_up: int

    def after(self, episodes: int, total: int) -> float:
        """Returns the value after some of a run's ``total`` episodes, up to the rounding of each subtraction."""
        reduction = (self.value - self.minimum) / (total - self.warm_up)
        return max(self.value - reduction * max(episodes - self.warm_up, 0), self.minimum)


@dataclass(frozen=True)
class Exponential:
    """Falls by the factor ``decay`` after each episode from ``warm_up`` on, down to ``minimum``."""

    value: float
    minimum: float
    decay: float
    warm_up: int

    def after(self, episodes: int, total: int) -> float:  # noqa: ARG002 - as the others
        """Returns the value after some episodes, up to the rounding of each multiplication."""
        return max(self.value * self.decay ** max(episodes - self.warm_up, 0), self.minimum)


@dataclass(frozen=True)
class ByVisits:
    """``value`` / n at the n-th visit of a state and action, down to ``minimum``."""

    value: float
    minimum: float


Schedule: TypeAlias = Constant | Linear | Exponential
LearningRate: TypeAlias = Schedule | ByVisits


def learning_rate(config: Config) -> LearningRate:
    """Returns the learning rate of a complete config.

    Raises:
        ValueError: if an option of its schedule is None.
    """
    value, kind = config.learning_rate, config.learning_rate_schedule
    if kind == "constant":
        return Constant(value)
    minimum = required("min_learning_rate", config.min_learning_rate)
    if kind == "visits":
        return ByVisits(value, minimum)
    warm_up = required("learning_rate_warm_up", config.learning_rate_warm_up)
    if kind == "linear":
        return Linear(value, minimum, warm_up)
    return Exponential(value, minimum, required("learning_rate_decay", config.learning_rate_decay), warm_up)


def epsilon(config: Config) -> Schedule:
    """Returns the exploration rate of a complete config whose policy is epsilon-greedy.

    Raises:
        ValueError: if the rate, or an option of its schedule, is None.
    """
    value, kind = required("epsilon", config.epsilon), required("epsilon_schedule", config.epsilon_schedule)
    if kind == "constant":
        return Constant(value)
    minimum = required("min_epsilon", config.min_epsilon)
    warm_up = required("epsilon_warm_up", config.epsilon_warm_up)
    if kind == "linear":
        return Linear(value, minimum, warm_up)
    return Exponential(value, minimum, required("epsilon_decay", config.epsilon_decay), warm_up)


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


def algorithm_options(config: Config) -> SimpleNamespace:
    """Returns the options of the algorithm of a complete config, as attributes.

    Raises:
        ValueError: if one of them is None.
    """
    names = options_of("algorithm", config.algorithm)
    return SimpleNamespace(**{name: required(name, getattr(config, name)) for name in names})
