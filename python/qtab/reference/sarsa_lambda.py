"""Sarsa(λ) in plain NumPy (Sutton & Barto, 2nd ed., the box in section 12.7)."""

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.config.schedules import algorithm_options
from qtab.reference.task import Result, Task, value
from qtab.reference.traces import decay, learn, mark


def sarsa_lambda(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    task = Task(env, config, stop_after)
    options = algorithm_options(config)
    Q = task.table()

    for _ in task.episodes():
        z = np.zeros_like(Q)
        state, over = task.reset(), False
        action = next_action = task.choose(Q, state)
        while not over:
            step = task.step(action)
            task.learning_rate.visit(state, action)
            mark(z, state, action, options.traces)

            # δ = R + γ Q(S', A') - Q(S, A)
            following = None
            if not step.terminal:
                next_action = task.choose(Q, step.state)
                following = value(Q, step.state, next_action)
            learn(task, Q, z, state, action, task.target(step.reward, following))
            decay(z, task.discount * options.trace_decay, options.trace_cutoff)

            state, action, over = step.state, next_action, step.over

    return task.result(Q)
