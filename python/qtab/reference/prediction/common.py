"""What all prediction methods share: the task, the policy, and the weights of the values."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.config.config import replace_checked
from qtab.reference.schedules import LearningRate
from qtab.reference.task import Task

if TYPE_CHECKING:
    from qtab.prediction.estimates import ValueEstimates


@dataclass(frozen=True)
class Visit:
    """A step of an episode."""

    state: int
    action: int
    reward: float
    next_state: int
    terminal: bool
    """Whether the next state is terminal, so that its value is zero."""
    over: bool
    """Whether the episode ends here."""


class Prediction:
    """A task whose policy does not change, and the weights of its values."""

    def __init__(self, env: gym.Env, config: Config, estimates: "ValueEstimates", stop_after: int) -> None:
        self.settings = estimates.settings
        self.task = Task(env, config, stop_after)
        self.discount = self.settings.discount
        self.rows = estimates.rows.tolist()
        count, n_active = estimates.weights.shape[2], estimates.rows.shape[1]
        self.w = np.full(count, self.settings.initial_value / n_active)
        settings, by_visits = self.settings, self.settings.learning_rate is None
        learning_rate: dict[str, Any] = {
            "learning_rate": 1.0 if settings.learning_rate is None else settings.learning_rate,
            "learning_rate_schedule": settings.learning_rate_schedule or ("visits" if by_visits else "constant"),
            "min_learning_rate": settings.min_learning_rate,
            "learning_rate_decay": settings.learning_rate_decay,
            "learning_rate_warm_up": settings.learning_rate_warm_up,
        }
        self.rate = LearningRate(replace_checked(config, **learning_rate), (count, 1), n_active)
        self.target = estimates.probabilities.reshape(len(self.rows), -1)
        self.behavior = estimates.behavior.reshape(len(self.rows), -1)
        self.is_deterministic = bool((np.count_nonzero(self.behavior, axis=1) == 1).all())

    def value(self, state: int) -> float:
        """Returns v(S), the sum of the weights of its active features from left to right."""
        first, *others = self.rows[state]
        total = float(self.w[first])
        for row in others:
            total += float(self.w[row])
        return total

    def update(self, state: int, target: float) -> None:
        """W <- w + α [target - v(S)] x(S)."""
        error = target - self.value(state)
        for row in self.rows[state]:
            self.rate.visit([row], 0)
            self.w[row] += self.rate.step(row, 0) * error

    def choose(self, state: int) -> int:
        """Returns an action: the first whose cumulative probability exceeds one ``random()``."""
        probabilities = self.behavior[state]
        possible = np.flatnonzero(probabilities)
        if self.is_deterministic:
            return int(possible[0])
        random, total = self.task.rng.random(), 0.0
        for action in possible:
            total += float(probabilities[action])
            if random < total:
                return int(action)
        return int(possible[-1])

    def episodes(self) -> Iterator[Iterator[Visit]]:
        """Yields the steps of each episode, which are taken as they are asked for."""
        if self.task.stop_after == 0:
            return
        for _ in self.task.episodes():
            yield self._steps()
            self.rate.schedule.end_episode()

    def _steps(self) -> Iterator[Visit]:
        [state] = self.task.reset()
        over = False
        while not over:
            action = self.choose(state)
            step = self.task.step(action)
            [next_state] = step.state
            over = step.over
            yield Visit(state, action, step.reward, next_state, step.terminal, over)
            state = next_state

    def next_value(self, visit: Visit) -> float:
        """Returns v(S'), which is 0 in a terminal state."""
        return 0.0 if visit.terminal else self.value(visit.next_state)
