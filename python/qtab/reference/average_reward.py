"""Differential Sarsa and differential Q-learning in plain NumPy, with the average reward of a continuing task.

Sutton & Barto, 2nd ed., section 10.3 with its box, and Exercise 10.4.
"""

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.config.schedules import algorithm_options
from qtab.reference.parts.task import Result, Rows, Table, Task, value


class AverageReward:
    """R̄, and the deferred update of an episode's last step, which needs the first state of the next episode."""

    def __init__(self, task: Task, Q: Table, step_size: float) -> None:
        self.task, self.Q, self.step_size = task, Q, step_size
        self.value = 0.0
        self.waiting: tuple[Rows, int, float] | None = None

    def learn(self, state: Rows, action: int, reward: float, following: float) -> None:
        """Updates by δ = R - R̄ + following - Q(S, A): R̄ <- R̄ + β δ, Q(S, A) <- Q(S, A) + α δ."""
        target = (reward - self.value) + following
        # Before the first step of an episode, this updates the last step of the previous episode.
        self.task.observer.target(self.task.step_number, (reward,), following)
        self.task.observer.average_reward(self.value)
        self.value += self.step_size * (target - value(self.Q, state, action))
        self.task.update(self.Q, state, action, target)

    def begin_episode(self, following: float) -> None:
        """Applies the deferred update: a reset counts as a transition from the terminal state, without a step."""
        if self.waiting is not None:
            self.learn(*self.waiting, following)
            self.waiting = None


def differential_sarsa(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    task = Task(env, config, stop_after)
    Q = task.table()
    average = AverageReward(task, Q, algorithm_options(config).reward_learning_rate)

    for _ in task.episodes():
        state, over = task.reset(), False
        action = task.choose(Q, state)
        average.begin_episode(value(Q, state, action))
        while not over:
            step = task.step(action)
            past_action = action
            if step.terminal:
                average.waiting = state, past_action, step.reward
            else:
                # δ = R - R̄ + Q(S', A') - Q(S, A). At a time-out A' is drawn, but not taken.
                action = task.choose(Q, step.state)
                average.learn(state, past_action, step.reward, value(Q, step.state, action))
            state, over = step.state, step.over

    return task.result(Q)


def differential_q_learning(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    task = Task(env, config, stop_after)
    Q = task.table()
    average = AverageReward(task, Q, algorithm_options(config).reward_learning_rate)

    for _ in task.episodes():
        state, over = task.reset(), False
        action = task.choose(Q, state)
        average.begin_episode(float(np.max(task.values(Q, state))))
        while not over:
            step = task.step(action)
            if step.terminal:
                average.waiting = state, action, step.reward
            else:
                # δ = R - R̄ + max Q(S', a) - Q(S, A)
                average.learn(state, action, step.reward, float(np.max(task.values(Q, step.state))))
            state, over = step.state, step.over
            if not over:
                action = task.choose(Q, state)

    return task.result(Q)
