"""n-step tree backup in plain NumPy (Sutton & Barto, 2nd ed., the box in section 7.5)."""

import gymnasium as gym

from qtab.config import Config
from qtab.config.schedules import algorithm_options
from qtab.reference.backed_up import n_step_backups
from qtab.reference.task import Result


def n_step_tree_backup(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    options = algorithm_options(config)
    greedy = options.target_policy == "greedy"
    return n_step_backups(env, config, stop_after, options.n_steps, greedy, lambda share, _ratio: share)
