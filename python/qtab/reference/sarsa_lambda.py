"""Sarsa(λ) and eligibility traces, one for each value of the table (Sutton & Barto, 2nd ed., chapter 12), in NumPy."""

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.config.choices import Traces
from qtab.config.schedules import algorithm_options
from qtab.reference.parts.task import Result, Rows, Table, Task, features, value


def mark(z: Table, state: Rows, action: int, kind: Traces) -> None:
    """Adds x to an accumulating trace or sets a replacing one to 1; clearing also zeroes those of other actions."""
    for row, x in zip(state, features(state), strict=True):
        if kind == "accumulating":
            z[row, action] += x
        else:
            if kind == "clearing":
                z[row] = 0.0
            z[row, action] = 1.0


def learn(task: Task, Q: Table, z: Table, state: Rows, action: int, target: float) -> None:
    """Updates w <- w + α z [target - Q(S, A)], where the traces z already include S and A."""
    task.observer.before_update(Q, state, action, target)
    task.observer.traces(z)
    apply_td_error(task, Q, z, target - value(Q, state, action))
    task.observer.after_update(Q, [task.learning_rate.step(row, action) for row in state])


def apply_td_error(task: Task, Q: Table, z: Table, error: float) -> None:
    """Updates w <- w + α δ z, for the weights whose trace is not zero."""
    traced = np.nonzero(z)
    Q[traced] += task.learning_rate.steps(*traced) * error * z[traced]


def decay(z: Table, factor: float, cutoff: float) -> None:
    """Updates z <- γλ z; traces at the cutoff or below are set to zero."""
    z *= factor
    z[np.abs(z) <= cutoff] = 0.0


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
