"""Schedules of the exploration rate and the learning rate over the episodes."""

import numpy as np
from numpy.typing import NDArray

from qtab._utils.checks import required
from qtab.config import Config


class Schedule:
    """A rate that decreases after each episode, once its warm-up is over."""

    def __init__(
        self, kind: str, value: float, minimum: float, decay: float | None, warm_up: int, episodes: int
    ) -> None:
        self.value = value
        self.kind, self.minimum, self.decay, self.warm_up = kind, minimum, decay, warm_up
        self.reduction = (value - minimum) / (episodes - warm_up)

    def end_episode(self) -> None:
        """Decreases the rate by the article's constant amount, or by a factor."""
        if self.warm_up > 0:
            self.warm_up -= 1
        elif self.value > self.minimum:
            if self.kind == "linear":
                self.value -= self.reduction
            elif self.decay is not None:
                self.value = max(self.value * self.decay, self.minimum)


def epsilon_schedule(config: Config) -> Schedule:
    """Returns the exploration rate of a complete config."""
    return Schedule(
        required("epsilon_schedule", config.epsilon_schedule),
        required("epsilon", config.epsilon),
        config.min_epsilon or 0.0,
        config.epsilon_decay,
        config.epsilon_warm_up or 0,
        config.episodes,
    )


class LearningRate:
    """The step size of a value in the table: α over the number of active rows, or over a divisor of the row."""

    def __init__(
        self, config: Config, shape: tuple[int, int], n_active: int, divisors: list[float] | None = None
    ) -> None:
        self.schedule = Schedule(
            config.learning_rate_schedule,
            config.learning_rate,
            config.min_learning_rate or 0.0,
            config.learning_rate_decay,
            config.learning_rate_warm_up or 0,
            config.episodes,
        )
        self.n_active, self.divisors = n_active, divisors
        self.visits = np.zeros(shape, dtype=int)
        self.by_visits = config.learning_rate_schedule == "visits"

    def visit(self, rows: list[int], action: int) -> None:
        """Counts a visit of a state and action."""
        for row in rows:
            self.visits[row, action] += 1

    def step(self, row: int, action: int) -> float:
        """Returns the step size; by visits, that of the n-th visit is 1/n of the first one."""
        if self.by_visits:
            return max(self.schedule.value / int(self.visits[row, action]), self.schedule.minimum) / self.n_active
        return self.schedule.value / (self.n_active if self.divisors is None else self.divisors[row])

    def steps(self, rows: NDArray[np.int64], actions: NDArray[np.int64]) -> NDArray[np.float64]:
        """Returns the step sizes of several values, (n,)."""
        if self.by_visits:
            sizes = np.maximum(self.schedule.value / self.visits[rows, actions], self.schedule.minimum)
        else:
            sizes = np.full(len(rows), self.schedule.value)
        return sizes / (self.n_active if self.divisors is None else np.array(self.divisors)[rows])
