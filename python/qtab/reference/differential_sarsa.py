"""Differential Sarsa in plain NumPy (Sutton & Barto, 2nd ed., the box in section 10.3)."""

import gymnasium as gym

from qtab.config import Config
from qtab.config.schedules import algorithm_options
from qtab.reference.average_reward import AverageReward
from qtab.reference.task import Result, Task, value


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
