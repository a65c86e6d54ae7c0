"""True online Sarsa(λ) in plain NumPy (Sutton & Barto, 2nd ed., the second box in section 12.7)."""

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.config.schedules import algorithm_options
from qtab.reference.parts.task import Result, Rows, Table, Task, features, value
from qtab.reference.parts.weighted import WeightedRows
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

            # The dutch trace: z <- γλ z + (1 - α γλ zᵀx) x
            increment = 1.0 - overlap(task, z, state, action, gamma_lambda)
            decay(z, gamma_lambda, options.trace_cutoff)
            for row, x in zip(state, features(state), strict=True):
                z[row, action] += increment * x

            # w <- w + α (δ + Q - Q_old) z - α (Q - Q_old) x
            task.observer.before_update(Q, state, action, task.target(step.reward, following))
            task.observer.traces(z, old_value)
            apply_td_error(task, Q, z, error + (this_value - old_value))
            step_sizes = [task.learning_rate.step(row, action) for row in state]
            for row, x, step_size in zip(state, features(state), step_sizes, strict=True):
                Q[row, action] -= step_size * (this_value - old_value) * x
            task.observer.after_update(Q, step_sizes)

            state, action, over, old_value = step.state, next_action, step.over, next_value

    return task.result(Q)


def overlap(task: Task, z: Table, state: Rows, action: int, gamma_lambda: float) -> float:
    """Returns α γλ zᵀx; with a step size for each feature, as with a Fourier basis, γλ Σ α z x."""
    if isinstance(state, WeightedRows):
        step_sizes = [[task.learning_rate.step(row, action)] for row in state]
        return gamma_lambda * value(np.array(step_sizes) * z, state, action)
    total = 0.0
    for row in state:
        total += float(z[row, action])
    return task.learning_rate.step(0, 0) * gamma_lambda * total
