"""Training of many runs of one setting: runs that diverge are counted, and raise no error."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from qtab.training.train_many import MakeEnv, allocate_results, resolve_template, train_in_threads

FloatArray: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class EpisodeLog:
    """The episodes of all runs of a setting, one row per run."""

    returns: FloatArray
    """(runs, episodes): the undiscounted return of each episode."""
    lengths: NDArray[np.int64]
    """(runs, episodes): the number of steps of each episode."""
    truncated: NDArray[np.bool_]
    """(runs, episodes): whether the time limit ended the episode, or the run had diverged before it."""
    diverged: NDArray[np.bool_]
    """(runs,): whether the action values of the run overflowed."""


def train_runs(env: str | MakeEnv, config: Mapping[str, Any], seeds: Sequence[int], threads: int) -> EpisodeLog:
    """Trains one run per seed, with the same numbers as :func:`qtab.train`.

    If the action values of a run overflow, :func:`qtab.train` raises an error. Here the episodes that the run did not
    finish count as truncated, with a reward of -1 per step.
    """
    resolved = resolve_template(env, {**config, "seed": seeds[0]})
    max_steps = resolved.max_episode_steps
    results, memory = allocate_results(resolved, len(seeds), min(threads, len(seeds)), keep_tables=False)
    diverged = np.zeros(len(seeds), np.bool_)
    for index, error in train_in_threads(resolved, seeds, results, threads, memory, keep_going=True):
        if not isinstance(error, OverflowError):
            raise error
        diverged[index] = True
    unfinished = results["lengths"] == 0
    return EpisodeLog(
        returns=np.where(unfinished, -float(max_steps), results["returns"]),
        lengths=np.where(unfinished, max_steps, results["lengths"]),
        truncated=unfinished | ~results["terminated"],
        diverged=diverged,
    )
