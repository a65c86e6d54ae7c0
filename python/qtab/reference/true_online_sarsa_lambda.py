"""True online Sarsa(λ) in plain NumPy (Sutton & Barto, 2nd ed., the second box in section 12.7)."""

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.config.schedules import algorithm_options
from qtab.reference.parts.task import Result, Task, value
from qtab.reference.sarsa_lambda import apply_td_error, decay


def true_online_sarsa_lambda(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    task = Task(env, config, stop_after)
    options = algorithm_options(config)
    Q = task.table()
    gamma_lambda = task.discount * options.trace_decay

    for _ in task.episodes():
        z, old_value = np.zeros_like(Q), 0.0
        state, over = task.reset(), False
        action = next_action = task.choose(Q, state)
        while not over:
            step = task.step(action)
            next_value, following = 0.0, None
            if not step.terminal:
                next_action = task.choose(Q, step.state)
                next_value = following = value(Q, step.state, next_action)
            this_value = value(Q, state, action)
            error = step.reward + task.discount * next_value - this_value
            alpha = task.learning_rate.step(0, 0)

            # The dutch trace: z <- γλ z + (1 - α γλ zᵀx) x
            overlap = 0.0
            for row in state:
                overlap += float(z[row, action])
            decay(z, gamma_lambda, options.trace_cutoff)
            for row in state:
                z[row, action] += 1.0 - alpha * gamma_lambda * overlap

            # w <- w + α (δ + Q - Q_old) z - α (Q - Q_old) x
            task.observer.before_update(Q, state, action, task.target(step.reward, following))
            task.observer.traces(z, old_value)
            apply_td_error(task, Q, z, error + (this_value - old_value))
            for row in state:
                Q[row, action] -= alpha * (this_value - old_value)
            task.observer.after_update(Q, [alpha] * len(state))

            state, action, over, old_value = step.state, next_action, step.over, next_value

    return task.result(Q)
