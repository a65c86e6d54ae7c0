"""Monte Carlo control with exploring starts in plain NumPy (Sutton & Barto, 2nd ed., the box in section 5.3)."""

import gymnasium as gym

from qtab.config import Config
from qtab.reference.monte_carlo import first_visits
from qtab.reference.task import Result, Task


def monte_carlo_es(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`. The first action of every episode is random."""
    task = Task(env, config, stop_after)
    Q = task.table()

    for _ in task.episodes():
        state = task.reset()
        valid = task.valid_actions(Q, state)
        action = valid[int(task.rng.integers(0, len(valid)))]
        task.observer.exploring_start(task.values(Q, state), action, len(valid))
        first_visits(task, Q, state, action)

    return task.result(Q)
