"""The parts that all prediction methods share: the task, the policy, and the weights of the values."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils.checks import required
from qtab.config import Config
from qtab.config.config import replace_checked
from qtab.prediction.learning_rates import rate_settings
from qtab.prediction.observation_policies import ObservationPolicies, TablePolicy
from qtab.prediction.reference.off_policy import dot
from qtab.prediction.reference.policies import policy_of, probability, sampled
from qtab.prediction.settings import OFF_POLICY
from qtab.reference.parts.schedules import LearningRate
from qtab.reference.parts.task import Rows, Task
from qtab.reference.parts.weighted import WeightedRows

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
    ratio: float
    """π(A|S) / b(A|S), the importance-sampling ratio."""


class ObservedTask(Task):
    """A task that keeps its last observation."""

    observation: Any

    def rows(self, observation: Any) -> Rows:
        """Returns the active rows of an observation."""
        self.observation = observation
        return super().rows(observation)


class Prediction:
    """A task whose policy does not change, and the weights of its values."""

    def __init__(self, env: gym.Env, config: Config, estimates: "ValueEstimates", stop_after: int) -> None:
        self.settings = estimates.settings
        self.task = ObservedTask(env, config, stop_after)
        self.discount = self.settings.discount
        # With tile coding and weighted features, the states are numbered in the order of their visits in an episode.
        self.has_states = estimates.of_cells
        self.rows: list[Rows] = []
        if estimates.feature_vectors is not None:
            self.rows = [WeightedRows(x) for x in estimates.feature_vectors.tolist()]
        elif estimates.rows is not None:
            self.rows = estimates.rows.tolist()
        self.w = required("initial_weights", estimates.initial_weights).copy()
        # Features with values other than 1 do not share the learning rate.
        self.is_weighted = estimates.is_weighted
        self.n_active = 1 if self.is_weighted else estimates.n_active
        self.divisors: list[float] | None = getattr(self.task.discretizer, "divisors", None)
        rate = replace_checked(config, **rate_settings(vars(self.settings)))
        self.rate = LearningRate(rate, (len(self.w), 1), self.n_active, self.divisors)
        policies = estimates.policies
        if policies is None:
            tables = [required("policies", table) for table in (estimates.probabilities, estimates.behavior)]
            policies = ObservationPolicies(*(TablePolicy(table.reshape(-1, table.shape[-1])) for table in tables))
        self.target, self.behavior = policy_of(policies.target, env), policy_of(policies.behavior, env)
        self.is_off_policy = self.settings.method in OFF_POLICY

    def value(self, state: int) -> float:
        """Returns v(S) = wᵀx(S)."""
        return self.dot(self.w, state)

    def dot(self, w: NDArray[np.float64], state: int) -> float:
        """Returns wᵀx(S): the sum of the weights of its active features from left to right, or of four partial sums."""
        rows = self.rows[state]
        if isinstance(rows, WeightedRows):
            return dot(w, np.array(rows.x))
        first, *others = rows
        total = float(w[first])
        for row in others:
            total += float(w[row])
        return total

    def features(self, state: int) -> list[tuple[int, float]]:
        """Returns the active features of S with their values."""
        rows = self.rows[state]
        return list(zip(rows, rows.x if isinstance(rows, WeightedRows) else [1.0] * len(rows), strict=True))

    def vector(self, state: int | None) -> NDArray[np.float64]:
        """Returns x(S), which is zero in a terminal state, None."""
        x = np.zeros_like(self.w)
        for row, value in [] if state is None else self.features(state):
            x[row] += value
        return x

    def steps(self, rate: float | None = None) -> NDArray[np.float64] | float:
        """Returns the step size of all weights, or of each one if they differ, also for another learning rate."""
        alpha = self.rate.schedule.value if rate is None else rate
        return alpha / self.n_active if self.divisors is None else alpha / np.array(self.divisors)

    def update(self, state: int, target: float) -> None:
        """W <- w + α [target - v(S)] x(S)."""
        error = target - self.value(state)
        for row, x in self.features(state):
            self.rate.visit([row], 0)
            self.w[row] += self.rate.step(row, 0) * error * x

    def choose(self) -> tuple[int, float]:
        """Returns an action, the first whose cumulative probability exceeds one ``random()``, and its ratio."""
        given = self.task.observation, self.task.state
        answer = self.behavior(*given)
        action = sampled(answer, self.task.rng)
        if not self.is_off_policy:
            return action, 1.0
        return action, probability(self.target(*given), action) / probability(answer, action)

    def state_of(self, rows: Rows) -> int:
        """Returns the number of a state, given its active rows."""
        if self.has_states:
            return rows[0]
        self.rows.append(rows)
        return len(self.rows) - 1

    def episodes(self) -> Iterator[Iterator[Visit]]:
        """Yields the steps of each episode as an iterator, which takes them one by one."""
        if self.task.stop_after == 0:
            return
        for _ in self.task.episodes():
            yield self._steps()
            self.rate.schedule.end_episode()

    def _steps(self) -> Iterator[Visit]:
        if not self.has_states:
            self.rows.clear()
        state = self.state_of(self.task.reset())
        over = False
        while not over:
            action, ratio = self.choose()
            step = self.task.step(action)
            next_state = self.state_of(step.state)
            over = step.over
            yield Visit(state, action, step.reward, next_state, step.terminal, over, ratio)
            state = next_state

    def error(self, visit: Visit) -> float:
        """Returns δ = R + γ v(S') - v(S)."""
        return visit.reward + self.discount * self.next_value(visit) - self.value(visit.state)

    def next_value(self, visit: Visit) -> float:
        """Returns v(S'), which is 0 in a terminal state."""
        return 0.0 if visit.terminal else self.value(visit.next_state)
