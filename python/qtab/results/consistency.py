"""What holds for every run, and is checked of one that is saved or loaded: its parts fit together."""

import math
from typing import TYPE_CHECKING

import numpy as np

from qtab._utils.checks import required
from qtab.config.options import n_tables

if TYPE_CHECKING:
    from qtab.results.run import Run


def check_consistent(run: "Run") -> None:
    """Refuses a run that no training returns.

    Raises:
        FloatingPointError: if the bounds of the discretizer overflow.
        ValueError: if its parts contradict each other or its config, or a number is not finite; the message says which.
    """
    with np.errstate(all="raise"):
        _check_tables(run)
    _check_episodes(run)
    if not (math.isfinite(run.seconds) and run.seconds >= 0):
        raise ValueError(f"its seconds must be finite and not negative, got {run.seconds!r}")


def _check_tables(run: "Run") -> None:
    config, discretizer = run.config, run.discretizer
    if not run.actions.match(config):
        raise ValueError("its actions are not those of its config")
    k, rows, actions = n_tables(config.algorithm), discretizer.n_rows, len(run.actions)
    if run.tables.shape != (k, rows, actions) or actions < 1:
        raise ValueError(f"its tables have shape {run.tables.shape}, which does not fit its {discretizer.shape} rows")
    expected = np.isfinite(run.tables)
    if isinstance(config.initial_q, np.ndarray):
        shape = (*discretizer.shape, actions)
        if config.initial_q.shape not in (shape if k == 1 else (k, *shape), (k, rows, actions)):
            raise ValueError(f"its initial_q has shape {config.initial_q.shape}, which does not fit its table {shape}")
        missing = np.isneginf(config.initial_q).reshape(run.tables.shape)
        expected = np.where(missing, np.isneginf(run.tables), expected)
    if not expected.all():
        value = run.tables[~expected][0]
        raise ValueError(f"its tables must be finite, and -inf for the actions that initial_q excludes, got {value}")


def _check_episodes(run: "Run") -> None:
    returns, lengths, config = run.episode_returns, run.episode_lengths, run.config
    counts = {len(returns), len(lengths), len(run.terminated)}
    if len(counts) != 1 or len(returns) > config.episodes:
        raise ValueError("its episodes do not fit together")
    if run.completed is not (len(returns) == config.episodes):
        raise ValueError(f"it must have {config.episodes} episodes if it is complete, and fewer if not")
    if not np.isfinite(returns).all():
        raise ValueError(f"its episode_returns must be finite, got {returns[~np.isfinite(returns)][0]}")
    most = required("max_episode_steps", config.max_episode_steps)
    outside = lengths[(lengths < 1) | (lengths > most)]
    if len(outside):
        raise ValueError(f"its episode_lengths must lie between 1 and max_episode_steps = {most}, got {outside[0]}")
