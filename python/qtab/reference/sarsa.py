"""Sarsa in plain NumPy (Sutton & Barto, 2nd ed., section 6.4)."""

import gymnasium as gym

from qtab.config import Config
from qtab.reference.task import Result, Task, value


def sarsa(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    task = Task(env, config, stop_after)
    Q = task.table()

    for _ in task.episodes():
        state, over = task.reset(), False
        action = task.choose(Q, state)
        while not over:
            step = task.step(action)

            # Q(S, A) <- Q(S, A) + α [R + γ Q(S', A') - Q(S, A)]. At a time-out A' is drawn, but not taken.
            next_action, following = action, None
            if not step.terminal:
                next_action = task.choose(Q, step.state)
                following = value(Q, step.state, next_action)
            task.learn(Q, state, action, step.reward, following)

            state, action, over = step.state, next_action, step.over

    return task.result(Q)
