"""Sarsa(λ) in plain NumPy (Sutton & Barto, 2nd ed., the box in section 12.7)."""

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.config.algorithms import EligibilityTraces
from qtab.reference.task import Result, Task, value
from qtab.reference.traces import apply_td_error, decay, mark


def sarsa_lambda(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    task = Task(env, config, stop_after)
    options = EligibilityTraces.of(config)
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
            target = step.reward
            if not step.terminal:
                next_action = task.choose(Q, step.state)
                target = step.reward + task.discount * value(Q, step.state, next_action)
            apply_td_error(task, Q, z, target - value(Q, state, action))
            decay(z, task.discount * options.trace_decay, options.trace_cutoff)

            state, action, over = step.state, next_action, step.over

    return task.result(Q)
