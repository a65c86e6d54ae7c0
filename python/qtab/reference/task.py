"""What surrounds every learner: the environment as rows, the schedules, the policy, the bookkeeping of episodes."""

from collections.abc import Iterator
from copy import copy
from dataclasses import dataclass

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab.config import Config
from qtab.reference.actions import actions
from qtab.reference.discretizers import discretizer
from qtab.reference.policies import policy
from qtab.reference.schedules import LearningRate
from qtab.reference.streams import agent_stream

Table = NDArray[np.float64]
"""(rows, actions)"""
Rows = list[int]
"""A state: the rows that its observation lights."""
Result = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]
"""The table (two where the learner has two), and each episode's return and length."""


@dataclass(frozen=True)
class Step:
    """What a step brings."""

    reward: float
    state: Rows
    terminal: bool
    """Nothing follows: the value of what comes is zero."""
    over: bool
    """The episode ends here, by a terminal state or by its time limit."""


class Task:
    """An environment to learn, and everything about it that the algorithms share."""

    def __init__(self, env: gym.Env, config: Config, stop_after: int | None = None) -> None:
        assert config.seed is not None  # noqa: S101
        self.env, self.config = env, config
        self.stop_after = stop_after or config.episodes
        self.discount = config.discount
        self.actions = actions(env, config)
        self.n_actions = len(self.actions)
        self.rng = agent_stream(config.seed, config.bit_generator)
        self.discretizer = discretizer(env, config)
        self.n_rows = int(np.prod(self.discretizer.shape))
        self.policy = policy(config, self.rng)
        self.learning_rate = self.new_learning_rate()
        self.returns: list[float] = []
        self.lengths: list[int] = []

    def new_learning_rate(self) -> LearningRate:
        """Returns the learning rate of a table."""
        return LearningRate(self.config, (self.n_rows, self.n_actions), self.discretizer.lit)

    def table(self, index: int = 0, tables: int = 1) -> Table:
        """Returns the table of that index as it is before the first episode."""
        shape = (self.n_rows, self.n_actions)
        if isinstance(self.config.initial_q, float):
            return np.full(shape, self.config.initial_q)
        if isinstance(self.config.initial_q, tuple):
            return self.rng.uniform(*self.config.initial_q, size=shape)
        given: Table = self.config.initial_q.reshape(tables, *shape)[index].copy()
        return given

    def episodes(self) -> Iterator[int]:
        """Yields the episodes' numbers; between them the rates fall."""
        for episode in range(self.stop_after):
            self.returns.append(0.0)
            self.lengths.append(0)
            yield episode
            self.policy.end_episode()
            self.learning_rate.schedule.end_episode()

    def reset(self) -> Rows:
        """Begins an episode. The environment is seeded once, with the first."""
        observation, _ = self.env.reset(seed=self.config.seed if len(self.returns) == 1 else None)
        return self.discretizer.rows(observation)

    def step(self, action: int) -> Step:
        """Takes a step. A time-out is no terminal state, unless the config makes that mistake."""
        observation, reward, terminated, truncated, _ = self.env.step(copy(self.actions[action]))
        self.returns[-1] += float(reward)
        self.lengths[-1] += 1
        terminal = terminated or (truncated and self.config.on_truncation == "terminate")
        return Step(float(reward), self.discretizer.rows(observation), bool(terminal), bool(terminated or truncated))

    def choose(self, Q: Table, state: Rows) -> int:
        """Returns an action by the policy."""
        return self.policy.choose(values(Q, state))

    def update(self, Q: Table, state: Rows, action: int, target: float, rate: LearningRate | None = None) -> None:
        """Q(S, A) <- Q(S, A) + α [target - Q(S, A)]; the rows that S lights share it."""
        rate = rate or self.learning_rate
        error = target - value(Q, state, action)
        for row in state:
            rate.visit([row], action)
            Q[row, action] += rate.step(row, action) * error

    def end(self, Q: Table, state: Rows, action: int, reward: float, rate: LearningRate | None = None) -> None:
        """Updates before a terminal state: the target is the reward alone. The article assigns it."""
        if self.config.terminal_update == "assign":
            Q[state[0], action] = reward
        else:
            self.update(Q, state, action, reward, rate)

    def result(self, *tables: Table) -> Result:
        """Returns the table in the shape of the grid (two, one after the other), the returns and the lengths."""
        shape = (*self.discretizer.shape, self.n_actions)
        Q = tables[0].reshape(shape) if len(tables) == 1 else np.stack(tables).reshape(-1, *shape)
        return Q, np.array(self.returns), np.array(self.lengths)


def values(Q: Table, state: Rows) -> NDArray[np.float64]:
    """Returns Q(S, ·): the sum over the rows that S lights, from the first (``np.sum`` would add by pairs)."""
    total: NDArray[np.float64] = Q[state[0]].copy()
    for row in state[1:]:
        total += Q[row]
    return total


def value(Q: Table, state: Rows, action: int) -> float:
    """Returns Q(S, A)."""
    return float(values(Q, state)[action])
