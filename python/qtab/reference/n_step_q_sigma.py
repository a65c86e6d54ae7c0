"""n-step Q(σ) in plain NumPy (Sutton & Barto, 2nd ed., the box in section 7.6)."""

import gymnasium as gym

from qtab.config import Config
from qtab.config.schedules import algorithm_options
from qtab.reference.backed_up import n_step_backups
from qtab.reference.task import Result


def n_step_q_sigma(env: gym.Env, config: Config, stop_after: int | None = None) -> Result:
    """Trains on ``env``; see :func:`qtab.reference.q_learning`."""
    options = algorithm_options(config)
    sigma: float = options.sigma
    greedy: bool = options.target_policy == "greedy"

    def weight(share: float, ratio: float) -> float:
        return sigma * ratio + (1.0 - sigma) * share

    return n_step_backups(env, config, stop_after, options.n_steps, greedy, weight)
