"""Watkins's Q(λ) in plain NumPy (Sutton & Barto, 2nd ed., section 12.10; 1st ed., the box in section 7.6)."""

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.config.schedules import algorithm_options
from qtab.reference.parts.task import Result, Task
from qtab.reference.sarsa_lambda import decay, learn, mark


def watkins_q_lambda(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
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

            # δ = R + γ max Q(S', a) - Q(S, A); the traces last while A' is greedy.
            following, greedy = None, False
            if not step.terminal:
                next_action = task.choose(Q, step.state)
                next_values = task.values(Q, step.state)
                greedy = bool(next_values[next_action] == np.max(next_values))
                following = float(np.max(next_values))
            learn(task, Q, z, state, action, task.target(step.reward, following))
            if greedy:
                decay(z, task.discount * options.trace_decay, options.trace_cutoff)
            else:
                z[:] = 0.0

            state, action, over = step.state, next_action, step.over

    return task.result(Q)
