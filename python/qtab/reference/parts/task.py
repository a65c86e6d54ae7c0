"""The parts that all learners share: the discretized environment, schedules, the policy, and the episodes' records."""

import math
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils.checks import required
from qtab.config import Config
from qtab.reference.parts.actions import ActionMasks, actions
from qtab.reference.parts.observations import discretizer
from qtab.reference.parts.observer import current_observer
from qtab.reference.parts.policies import policy, valid_actions
from qtab.reference.parts.schedules import LearningRate
from qtab.reference.parts.streams import agent_stream
from qtab.reference.parts.weighted import WeightedRows

Table = NDArray[np.float64]
"""(rows, actions): a table."""
Rows = list[int]
"""A state: the active rows of its observation."""
Result = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]
"""The table (two for Double Q-learning), and the return and length of each episode."""


@dataclass(frozen=True)
class Step:
    """The result of a step."""

    reward: float
    state: Rows
    terminal: bool
    """Whether the next state is terminal, so that its value is zero."""
    over: bool
    """Whether the episode ends here, in a terminal state or by its time limit."""


class Task:
    """An environment to learn in, with the parts that all algorithms share."""

    def __init__(self, env: gym.Env, config: Config, stop_after: int | None = None) -> None:
        self.env, self.config = env, config
        self.seed = required("seed", config.seed)
        self.stop_after = stop_after or config.episodes
        self.discount = config.discount
        self.actions = actions(env, config)
        self.n_actions = len(self.actions)
        self.masks = ActionMasks(env, config)
        self.observer = current_observer()
        self.observer.masks(self.masks)
        self.rng = self.observer.stream(agent_stream(self.seed, config.bit_generator))
        self.discretizer = discretizer(env, config)
        # With time_aware each step before the time limit has separate rows, in the order of the steps.
        self.limit = required("max_episode_steps", config.max_episode_steps) if config.time_aware else None
        self.shape = self.discretizer.shape if self.limit is None else (self.limit, *self.discretizer.shape)
        self.n_rows = int(np.prod(self.shape))
        self.policy = self.observer.policy(policy(config, self.rng))
        self.learning_rate = self.new_learning_rate()
        self.visits = np.zeros((self.n_rows, self.n_actions), dtype=int)
        self.state: Rows = []
        self.returns: list[float] = []
        self.lengths: list[int] = []

    def new_learning_rate(self) -> LearningRate:
        """Returns the learning rate of a table."""
        divisors = getattr(self.discretizer, "divisors", None)
        rate = LearningRate(self.config, (self.n_rows, self.n_actions), self.discretizer.n_active, divisors)
        self.observer.learning_rate(rate)
        return rate

    def table(self, index: int = 0, tables: int = 1) -> Table:
        """Returns one of the tables as it is before the first episode: of a number, random numbers, or given ones."""
        shape, initial_q = (self.n_rows, self.n_actions), self.config.initial_q
        if isinstance(initial_q, float):
            Q = np.full(shape, initial_q)
        elif isinstance(initial_q, tuple):
            Q = self.rng.uniform(*initial_q, size=shape)
        else:
            Q = initial_q.reshape(tables, *shape)[index].copy()
        self.observer.table(Q)
        return Q

    def critic_table(self) -> Table:
        """Returns the state values for a table of preferences: 0 at first, unless both tables are given."""
        if isinstance(self.config.initial_q, np.ndarray):
            return self.table(1, tables=2)
        w = np.zeros((self.n_rows, self.n_actions))
        self.observer.table(w)
        return w

    def episodes(self) -> Iterator[int]:
        """Yields the numbers of the episodes; after each one the rates decrease."""
        for episode in range(self.stop_after):
            self.returns.append(0.0)
            self.lengths.append(0)
            yield episode
            self.policy.end_episode()
            self.learning_rate.schedule.end_episode()

    def reset(self) -> Rows:
        """Starts an episode. Only the first reset seeds the environment."""
        observation, info = self.env.reset(seed=self.seed if len(self.returns) == 1 else None)
        state = self.rows(observation)
        self.masks.see(state, observation, info)
        self.state = state
        return state

    def rows(self, observation: Any) -> Rows:
        """Returns the active rows of an observation at this step of the episode."""
        rows = self.discretizer.rows(observation)
        if self.limit is None:
            return rows
        step = min(self.lengths[-1], self.limit - 1)
        return [step * math.prod(self.discretizer.shape) + row for row in rows]

    def step(self, action: int) -> Step:
        """Takes a step. At a time-out the state is not terminal, unless the config treats it as terminal by mistake."""
        observation, reward, terminated, truncated, info = self.env.step(deepcopy(self.actions[action]))
        self.returns[-1] += float(reward)
        self.lengths[-1] += 1
        terminal = terminated or (truncated and self.config.on_truncation == "terminate")
        state = self.rows(observation)
        # A terminal state may have no action; after the last step of time_aware there is no state.
        if not terminated and self.lengths[-1] != self.limit:
            self.masks.see(state, observation, info)
        bonus = 0.0
        if self.config.count_bonus:
            bonus = self.bonus(action)
            reward = float(reward) + bonus
        self.observer.stepped(bonus, bool(terminal))
        self.state = state
        return Step(float(reward), state, bool(terminal), bool(terminated or truncated))

    def bonus(self, action: int) -> float:
        """Counts a visit of the state and action; returns β / √n, the average of the active rows."""
        total = 0.0
        for row in self.state:
            self.visits[row, action] += 1
            total += self.config.count_bonus / math.sqrt(int(self.visits[row, action]))
        return total / len(self.state)

    def choose(self, Q: Table, state: Rows) -> int:
        """Returns an action by the policy."""
        return self.policy.choose(self.values(Q, state), state)

    def values(self, Q: Table, state: Rows) -> NDArray[np.float64]:
        """Returns Q(S, ·), with -inf for the actions that S does not have."""
        return self.masks.masked(state, values(Q, state))

    def valid_actions(self, Q: Table, state: Rows) -> list[int]:
        """Returns the actions that S has: all, unless a mask or the initial table excludes some."""
        return valid_actions(self.config, self.values(Q, state))

    @property
    def step_number(self) -> int:
        """The number of the last step in its episode, from 0; -1 before the first one."""
        return self.lengths[-1] - 1

    def target(self, reward: float, following: float | None) -> float:
        """Returns R + γ following, where ``following`` is the value of the next state: None if that is terminal."""
        self.observer.target(self.step_number, (reward,), following)
        return reward if following is None else reward + self.discount * following

    def learn(
        self,
        Q: Table,
        state: Rows,
        action: int,
        reward: float,
        following: float | None,
        *,
        rate: LearningRate | None = None,
        planned: bool = False,
    ) -> None:
        """Updates Q(S, A) <- Q(S, A) + α [R + γ following - Q(S, A)]; ``following`` is None at a terminal state."""
        self.observer.target(None if planned else self.step_number, (reward,), following)
        if following is None and self.config.terminal_update == "assign":  # as the article does
            self.observer.before_update(Q, state, action, reward)
            Q[state[0], action] = reward
            self.observer.after_update(Q, None)
        else:
            target = reward if following is None else reward + self.discount * following
            self.update(Q, state, action, target, rate)

    def update(self, Q: Table, state: Rows, action: int, target: float, rate: LearningRate | None = None) -> None:
        """Updates Q(S, A) <- Q(S, A) + α [target - Q(S, A)]; the active rows of S share the change."""
        rate = rate or self.learning_rate
        step_sizes = []
        for row in state:
            rate.visit([row], action)
            step_sizes.append(rate.step(row, action))
        self.move(Q, state, action, target, step_sizes)

    def move(self, Q: Table, state: Rows, action: int, target: float, step_sizes: list[float]) -> None:
        """Updates Q(S, A) <- Q(S, A) + α [target - Q(S, A)], with the step size of each active row of S."""
        self.observer.before_update(Q, state, action, target)
        error = target - value(Q, state, action)
        for row, x, step_size in zip(state, features(state), step_sizes, strict=True):
            Q[row, action] += step_size * error * x
        self.observer.after_update(Q, step_sizes)

    def result(self, *tables: Table) -> Result:
        """Returns the table in the shape of the grid (two are stacked), the returns and the lengths."""
        shape = (*self.shape, self.n_actions)
        Q = tables[0].reshape(shape) if len(tables) == 1 else np.stack(tables).reshape(-1, *shape)
        return Q, np.array(self.returns), np.array(self.lengths)


def values(Q: Table, state: Rows) -> NDArray[np.float64]:
    """Returns Q(S, ·): the sum over the active rows of S, from left to right (``np.sum`` would add in pairs).

    With weighted features it is the sum of w x: every fourth product from left to right, and the four sums in pairs.
    """
    if isinstance(state, WeightedRows):
        parts = np.zeros((4, Q.shape[1]))
        for row, x in zip(state, state.x, strict=True):
            parts[row % 4] += Q[row] * x
        return np.asarray((parts[0] + parts[1]) + (parts[2] + parts[3]))
    total: NDArray[np.float64] = Q[state[0]].copy()
    for row in state[1:]:
        total += Q[row]
    return total


def value(Q: Table, state: Rows, action: int) -> float:
    """Returns Q(S, A)."""
    return float(values(Q, state)[action])


def features(state: Rows) -> list[float]:
    """Returns the value x of the feature of each active row: 1, unless the features are weighted."""
    return state.x if isinstance(state, WeightedRows) else [1.0] * len(state)
