"""Differential Q-learning in plain NumPy (Sutton & Barto, 2nd ed., section 10.3 and Exercise 10.4)."""

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.config.schedules import algorithm_options
from qtab.reference.average_reward import AverageReward
from qtab.reference.task import Result, Task


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
