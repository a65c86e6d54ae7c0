"""Dyna-Q+ in plain NumPy (Sutton & Barto, 2nd ed., section 8.3 and its footnote)."""

import math

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.config.schedules import algorithm_options
from qtab.reference.dyna_q import largest
from qtab.reference.task import Result, Rows, Task


def dyna_q_plus(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    task = Task(env, config, stop_after)
    options = algorithm_options(config)
    Q = task.table()
    # Model(S, A) = R, S' (None after a terminal state); an untried action leads back to S with a reward of zero.
    model: dict[int, dict[int, tuple[float, Rows | None]]] = {}
    last_tried = np.zeros(Q.shape, dtype=int)
    now = 0

    for _ in task.episodes():
        state, over = task.reset(), False
        while not over:
            action = task.choose(Q, state)
            step = task.step(action)
            next_state = None if step.terminal else step.state
            now += 1
            last_tried[state[0], action] = now
            task.learn(Q, state, action, step.reward, largest(task, Q, next_state))
            model.setdefault(state[0], {})[action] = (step.reward, next_state)

            for _ in range(options.planning_steps):
                row = list(model)[int(task.rng.integers(0, len(model)))]
                valid = task.valid_actions(Q, [row])
                any_action = valid[int(task.rng.integers(0, len(valid)))]
                reward, after = model[row].get(any_action, (0.0, [row]))
                # The reward grows with the time since the pair was last tried: R + κ √τ
                bonus = options.time_weight * math.sqrt(now - int(last_tried[row, any_action]))
                task.learn(Q, [row], any_action, reward + bonus, largest(task, Q, after), planned=True)

            state, over = step.state, step.over

    return task.result(Q)
