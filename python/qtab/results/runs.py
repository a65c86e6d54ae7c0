"""What many runs leave behind."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab.config import Config
from qtab.discretizers.base import Features
from qtab.results.run import Run
from qtab.results.summary import FINAL_EPISODES, block_means, summarize


@dataclass(frozen=True, eq=False, repr=False)
class Runs:
    """Many runs of one config, a row each. ``runs[i]`` is the run of ``seeds[i]``, where the tables were kept."""

    config: Config
    """Everything needed to repeat them, but for the seed, which is the first run's."""
    seeds: tuple[int, ...]
    """(runs,): the seed of each."""
    episode_returns: NDArray[np.float64]
    """(runs, episodes): the sum of rewards of each episode."""
    episode_lengths: NDArray[np.int64]
    """(runs, episodes): the number of steps of each episode."""
    terminated: NDArray[np.bool_]
    """(runs, episodes): whether each ended in a terminal state, and not by its time limit alone."""
    tables: NDArray[np.float64] | None
    """(runs, k, rows, actions): the raw tables, where they were asked for."""
    grid: Features
    """How observations become rows."""
    completed: bool
    """False after an interruption; the rows are then those of the runs that were finished."""
    seconds: float
    """How long it all took, by the wall clock."""
    versions: Mapping[str, str]
    """Of qtab, Gymnasium, NumPy and Python, and the platform."""

    def __repr__(self) -> str:
        runs, episodes = self.episode_returns.shape
        mean = (
            f", their last {min(episodes, FINAL_EPISODES)} at {self.final_returns().mean():.2f}"
            if self.episode_returns.size
            else ""
        )
        return f"<Runs of {self.config.env}: {self.config.algorithm}, {runs} seeds, {episodes} episodes each{mean}>"

    def __len__(self) -> int:
        return len(self.seeds)

    def __getitem__(self, index: int) -> Run:
        """Returns one run, equal to the lone one with its seed; its ``seconds`` are an equal share.

        Raises:
            IndexError: if there is no such run.
            ValueError: if the tables were not kept.
        """
        index = range(len(self))[index]
        if self.tables is None:
            raise ValueError("a single run needs its table: train_many(..., tables=True) keeps them")
        return Run(
            config=self.config.replace(seed=self.seeds[index]),
            tables=self.tables[index],
            episode_returns=self.episode_returns[index],
            episode_lengths=self.episode_lengths[index],
            terminated=self.terminated[index],
            grid=self.grid,
            completed=True,
            seconds=self.seconds / len(self),
            versions=self.versions,
        )

    def __iter__(self) -> Iterator[Run]:
        return map(self.__getitem__, range(len(self)))

    def mean_returns(self, block: int = 100) -> NDArray[np.float64]:
        """Returns (runs, blocks): the average return of each whole block of episodes, run by run.

        Raises:
            TypeError: if ``block`` is no integer.
            ValueError: if it is less than one.
        """
        block = checks.integer("block", block, least=1)
        return block_means(self.episode_returns, block)

    def final_returns(self, last: int = 100) -> NDArray[np.float64]:
        """Returns (runs,): the average return of the last episodes of each run, of all where there are fewer.

        Raises:
            TypeError: if ``last`` is no integer.
            ValueError: if it is less than one.
        """
        last = checks.integer("last", last, least=1)
        means: NDArray[np.float64] = self.episode_returns[:, -last:].mean(axis=1)
        return means

    def summaries(self) -> dict[str, NDArray[Any]]:
        """Returns columns with a number a run: its seed, and what :func:`qtab.results.summary.summarize` says of it."""
        seeds = np.array(self.seeds)
        return {"seed": seeds, **summarize(self.episode_returns, self.episode_lengths, self.terminated)}
