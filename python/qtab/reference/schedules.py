"""How the rates fall: the exploration rate and the learning rate."""

import numpy as np

from qtab.config import Config


class Schedule:
    """A rate that falls from episode to episode, once its warm-up is over."""

    def __init__(self, kind: str, value: float, least: float, decay: float | None, warm_up: int, episodes: int) -> None:
        self.value = value
        self.kind, self.least, self.decay, self.warm_up = kind, least, decay, warm_up
        self.reduction = (value - least) / (episodes - warm_up)

    def end_episode(self) -> None:
        """Falls by the article's rule, or by a factor."""
        if self.warm_up > 0:
            self.warm_up -= 1
        elif self.value > self.least:
            if self.kind == "linear":
                self.value -= self.reduction
            elif self.decay is not None:
                self.value = max(self.value * self.decay, self.least)


def epsilon_schedule(config: Config) -> Schedule:
    """Returns the exploration rate of a resolved config."""
    assert config.epsilon_schedule is not None  # noqa: S101
    assert config.epsilon is not None  # noqa: S101
    return Schedule(
        config.epsilon_schedule,
        config.epsilon,
        config.min_epsilon or 0.0,
        config.epsilon_decay,
        config.epsilon_warm_up or 0,
        config.episodes,
    )


class LearningRate:
    """α, over the number of rows that an observation lights: the step size of a weight."""

    def __init__(self, config: Config, weights: tuple[int, int], lit: int) -> None:
        self.schedule = Schedule(
            config.learning_rate_schedule,
            config.learning_rate,
            config.min_learning_rate or 0.0,
            config.learning_rate_decay,
            config.learning_rate_warm_up or 0,
            config.episodes,
        )
        self.lit = lit
        self.visits = np.zeros(weights, dtype=int)
        self.by_visits = config.learning_rate_schedule == "visits"

    def visit(self, rows: list[int], action: int) -> None:
        """Counts a visit of a pair."""
        for row in rows:
            self.visits[row, action] += 1

    def step(self, row: int, action: int) -> float:
        """Returns the step size of a weight; its n-th visit takes 1/n of the first's, where visits count."""
        if self.by_visits:
            return max(self.schedule.value / int(self.visits[row, action]), self.schedule.least) / self.lit
        return self.schedule.value / self.lit
