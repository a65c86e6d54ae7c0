"""Q-learning in plain NumPy, to be read beside the article and the book (Sutton & Barto, 2nd ed., section 6.5)."""

import gymnasium as gym
import numpy as np

from qtab.config import Config
from qtab.reference.task import Result, Task, values


def q_learning(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env`` as a resolved config says, and returns the Q table and each episode's return and length.

    Args:
        env: The environment, its time limit included.
        config: The run's config, its seed resolved.
        stop_after: Stop after so many episodes, with the schedule of the full run.
    """
    task = Task(env, config, stop_after)
    Q = task.table()

    for _ in task.episodes():
        state, over = task.reset(), False
        while not over:
            action = task.choose(Q, state)
            step = task.step(action)

            # Q(S, A) <- Q(S, A) + α [R + γ max Q(S', a) - Q(S, A)]; nothing follows a terminal state.
            if step.terminal:
                task.end(Q, state, action, step.reward)
            else:
                target = step.reward + task.discount * float(np.max(values(Q, step.state)))
                task.update(Q, state, action, target)

            state, over = step.state, step.over

    return task.result(Q)
