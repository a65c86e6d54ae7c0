"""Q-learning in plain NumPy, to read beside the article and the book (Sutton & Barto, 2nd ed., section 6.5)."""

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.reference.parts.task import Result, Task


def q_learning(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env`` with a complete config; returns the Q table and the return and length of each episode.

    Args:
        env: The environment, with its time limit.
        config: The config of a run, in which no setting that applies is None.
        stop_after: Stop after this many episodes, with the schedules of the full run.

    Raises:
        ValueError: if a setting that applies is None.
    """
    task = Task(env, config, stop_after)
    Q = task.table()

    for _ in task.episodes():
        state, over = task.reset(), False
        while not over:
            action = task.choose(Q, state)
            step = task.step(action)

            # Q(S, A) <- Q(S, A) + α [R + γ max Q(S', a) - Q(S, A)]; nothing follows a terminal state.
            following = None if step.terminal else float(np.max(task.values(Q, step.state)))
            task.learn(Q, state, action, step.reward, following)

            state, over = step.state, step.over

    return task.result(Q)
