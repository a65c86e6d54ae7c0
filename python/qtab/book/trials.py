"""Many runs of one setting in which nothing fails: whoever diverges is counted."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils.memory import memory_limit
from qtab.training.train_many import allocate, resolve_one, train_in_threads

Environment: TypeAlias = str | Callable[[], gym.Env]


@dataclass(frozen=True, eq=False)
class Outcome:
    """What runs of a setting brought, a row each."""

    returns: NDArray[np.float64]
    """(runs, episodes): the sum of rewards of each episode."""
    lengths: NDArray[np.int64]
    """(runs, episodes): the steps of each."""
    capped: NDArray[np.bool_]
    """(runs, episodes): whether it was cut off by the cap, or came after its run had diverged."""
    diverged: NDArray[np.bool_]
    """(runs,): whether the values of a run overflowed."""


def train(env: Environment, config: Mapping[str, Any], seeds: Sequence[int], threads: int) -> Outcome:
    """Trains one agent a seed, each as :func:`qtab.train` would.

    Where the values of a run overflow, which :func:`qtab.train` raises, the episodes that it did not finish count as
    capped, -1 a step.
    """
    resolved = resolve_one(env, {**config, "seed": seeds[0]})
    cap = resolved.config.max_episode_steps
    assert cap is not None  # noqa: S101 - resolved
    results = allocate(resolved, len(seeds), min(threads, len(seeds)), tables=False, limit=memory_limit(None))
    diverged = np.zeros(len(seeds), np.bool_)
    for index, error in train_in_threads(resolved, tuple(seeds), results, threads, keep_going=True):
        if not isinstance(error, OverflowError):
            raise error
        diverged[index] = True
    unfinished = results["lengths"] == 0
    return Outcome(
        returns=np.where(unfinished, -float(cap), results["returns"]),
        lengths=np.where(unfinished, cap, results["lengths"]),
        capped=unfinished | ~results["terminated"],
        diverged=diverged,
    )
