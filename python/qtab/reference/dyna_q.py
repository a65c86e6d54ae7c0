"""Dyna-Q in plain NumPy (Sutton & Barto, 2nd ed., the box in section 8.2)."""

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.config.algorithms import DynaQ
from qtab.reference.task import Result, Rows, Table, Task


def dyna_q(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    task = Task(env, config, stop_after)
    options = DynaQ.of(config)
    Q = task.table()
    # Model(S, A) = R, S' (None after a terminal state); dicts keep the order of first visits and first tries.
    model: dict[int, dict[int, tuple[float, Rows | None]]] = {}

    for _ in task.episodes():
        state, over = task.reset(), False
        while not over:
            action = task.choose(Q, state)
            step = task.step(action)
            next_state = None if step.terminal else step.state
            learn(task, Q, state, action, step.reward, next_state)
            model.setdefault(state[0], {})[action] = (step.reward, next_state)

            for _ in range(options.planning_steps):
                row = list(model)[int(task.rng.integers(0, len(model)))]
                tried = list(model[row])
                past_action = tried[int(task.rng.integers(0, len(tried)))]
                learn(task, Q, [row], past_action, *model[row][past_action])

            state, over = step.state, step.over

    return task.result(Q)


def learn(task: Task, Q: Table, state: Rows, action: int, reward: float, next_state: Rows | None) -> None:
    """Q(S, A) <- Q(S, A) + α [R + γ max Q(S', a) - Q(S, A)]."""
    if next_state is None:
        task.end(Q, state, action, reward)
    else:
        task.update(Q, state, action, reward + task.discount * float(np.max(task.values(Q, next_state))))
