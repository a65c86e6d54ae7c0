"""Checks that the parts of a run fit together, when it is saved or loaded."""

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from qtab._utils.checks import required
from qtab.config.options import AVERAGE_REWARD, n_tables

if TYPE_CHECKING:
    from qtab.results.run import Run
    from qtab.results.runs import Runs


def check_consistent(run: "Run") -> None:
    """Raises an error for a run that training cannot have returned.

    Raises:
        FloatingPointError: if the bounds of the discretizer overflow.
        ValueError: if its parts contradict each other or its config, or a number is not finite; the message names the
            part.
    """
    with np.errstate(all="raise"):
        _check_tables(run, run.tables, _shape(run))
    counts = {len(run.episode_returns), len(run.episode_lengths), len(run.terminated)}
    if len(counts) != 1 or len(run.episode_returns) > run.config.episodes:
        raise ValueError("its episodes do not fit together")
    if run.completed is not (len(run.episode_returns) == run.config.episodes):
        raise ValueError(f"it must have {run.config.episodes} episodes if it is complete, and fewer if not")
    if run.average_reward is not None and run.config.algorithm not in AVERAGE_REWARD:
        raise ValueError(f"it has an average_reward, which algorithm {run.config.algorithm!r} does not learn")
    _check_episodes(run)


def check_consistent_runs(runs: "Runs") -> None:
    """Raises an error for runs that ``train_many`` cannot have returned.

    Raises:
        FloatingPointError: if the bounds of the discretizer overflow.
        ValueError: if their parts contradict each other or their config, or a number is not finite.
    """
    seeds = runs.seeds
    if not all(type(seed) is int and seed >= 0 for seed in seeds) or len(set(seeds)) < len(seeds):
        raise ValueError("its seeds must be different integers that are not negative")
    shape = (len(seeds), runs.config.episodes)
    if {runs.episode_returns.shape, runs.episode_lengths.shape, runs.terminated.shape} != {shape}:
        raise ValueError(f"its episodes must be those of {shape[0]} seeds, {shape[1]} each")
    if not isinstance(runs.completed, bool):
        raise ValueError(f"its completed must be true or false, got {runs.completed!r}")
    with np.errstate(all="raise"):
        layout = (0 if runs.tables is None else len(seeds), *_shape(runs))
        _check_tables(runs, np.empty(layout) if runs.tables is None else runs.tables, layout)
    _check_episodes(runs)


def _shape(run: "Run | Runs") -> tuple[int, int, int]:
    """Returns the shape of the tables of one run."""
    return n_tables(run.config.algorithm), run.discretizer.n_rows, len(run.actions)


def _check_tables(run: "Run | Runs", tables: NDArray[np.float64], shape: tuple[int, ...]) -> None:
    config, discretizer = run.config, run.discretizer
    if not run.actions.match(config):
        raise ValueError("its actions are not those of its config")
    k, rows, actions = _shape(run)
    if tables.shape != shape or actions < 1:
        raise ValueError(f"its tables have shape {tables.shape}, which does not fit its {discretizer.shape} rows")
    expected = np.isfinite(tables)
    if isinstance(config.initial_q, np.ndarray):
        cells = (*discretizer.shape, actions)
        if config.initial_q.shape not in (cells if k == 1 else (k, *cells), (k, rows, actions)):
            raise ValueError(f"its initial_q has shape {config.initial_q.shape}, which does not fit its table {cells}")
        missing = np.isneginf(config.initial_q).reshape(k, rows, actions)
        expected = np.where(missing, np.isneginf(tables), expected)
    if not expected.all():
        value = tables[~expected][0]
        raise ValueError(f"its tables must be finite, and -inf for the actions that initial_q excludes, got {value}")


def _check_episodes(run: "Run | Runs") -> None:
    returns, lengths = run.episode_returns, run.episode_lengths
    if not np.isfinite(returns).all():
        raise ValueError(f"its episode_returns must be finite, got {returns[~np.isfinite(returns)][0]}")
    most = required("max_episode_steps", run.config.max_episode_steps)
    outside = lengths[(lengths < 1) | (lengths > most)]
    if len(outside):
        raise ValueError(f"its episode_lengths must lie between 1 and max_episode_steps = {most}, got {outside[0]}")
    if not (math.isfinite(run.seconds) and run.seconds >= 0):
        raise ValueError(f"its seconds must be finite and not negative, got {run.seconds!r}")
