"""``qtab.Runs``: the results of many runs of one config."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab.config import Config
from qtab.config.config import replace_checked
from qtab.discretizers import Discretizer
from qtab.discretizers.actions import Actions
from qtab.results.run import Run
from qtab.results.summary import FINAL_EPISODES, block_means, summarize


@dataclass(frozen=True, eq=False, repr=False)
class Runs:
    """Many runs of one config, one per row. ``runs[i]`` is the run of ``seeds[i]``, where the tables were kept."""

    config: Config
    """Everything needed to repeat the runs; its seed is that of the first run."""
    seeds: tuple[int, ...]
    """(runs,): the seed of each."""
    episode_returns: NDArray[np.float64]
    """(runs, episodes): the sum of rewards of each episode."""
    episode_lengths: NDArray[np.int64]
    """(runs, episodes): the number of steps of each episode."""
    terminated: NDArray[np.bool_]
    """(runs, episodes): whether each ended in a terminal state, not only by its time limit."""
    tables: NDArray[np.float64] | None
    """(runs, k, rows, actions): the Q tables of each run, where ``tables=True`` kept them."""
    discretizer: Discretizer
    """Maps observations to rows of the tables."""
    actions: Actions
    """The environment's actions, in the order of the columns of the tables."""
    completed: bool
    """False after an interruption; only the runs that were finished are there."""
    seconds: float
    """How long all runs took together, in wall-clock time."""
    versions: Mapping[str, str]
    """The versions of qtab, Gymnasium, NumPy and Python, and the platform."""

    def __repr__(self) -> str:
        runs, episodes = self.episode_returns.shape
        mean = (
            f", their last {min(episodes, FINAL_EPISODES)} at {self.final_returns().mean():.2f}"
            if self.episode_returns.size
            else ""
        )
        return f"<Runs of {self.config.env}: {self.config.algorithm}, {runs} seeds, {episodes} episodes each{mean}>"

    @property
    def grid(self) -> Discretizer:
        """An alias of :attr:`discretizer`, its name in earlier versions."""
        return self.discretizer

    def __len__(self) -> int:
        return len(self.seeds)

    def __getitem__(self, index: int) -> Run:
        """Returns one run, equal to what :func:`qtab.train` returns for its seed; ``seconds`` is an equal share.

        Raises:
            IndexError: if there is no such run.
            ValueError: if the tables were not kept.
        """
        index = range(len(self))[index]
        if self.tables is None:
            raise ValueError("a single run needs its table: train_many(..., tables=True) keeps them")
        return Run(
            config=replace_checked(self.config, seed=self.seeds[index]),
            tables=self.tables[index],
            episode_returns=self.episode_returns[index],
            episode_lengths=self.episode_lengths[index],
            terminated=self.terminated[index],
            discretizer=self.discretizer,
            actions=self.actions,
            completed=True,
            seconds=self.seconds / len(self),
            versions=self.versions,
        )

    def __iter__(self) -> Iterator[Run]:
        return map(self.__getitem__, range(len(self)))

    def mean_returns(self, block: int = 100) -> NDArray[np.float64]:
        """Returns (runs, blocks): the average return of each whole block of episodes, run by run.

        Raises:
            TypeError: if ``block`` is not an integer.
            ValueError: if it is less than one.
        """
        block = checks.integer("block", block, least=1)
        return block_means(self.episode_returns, block)

    def final_returns(self, last: int = 100) -> NDArray[np.float64]:
        """Returns (runs,): the average return of the last episodes of each run, of all where there are fewer.

        Raises:
            TypeError: if ``last`` is not an integer.
            ValueError: if it is less than one.
        """
        last = checks.integer("last", last, least=1)
        means: NDArray[np.float64] = self.episode_returns[:, -last:].mean(axis=1)
        return means

    def summaries(self) -> dict[str, NDArray[Any]]:
        """Returns columns with one number per run: its seed, and those of :func:`qtab.results.summary.summarize`."""
        seeds = np.array(self.seeds)
        return {"seed": seeds, **summarize(self.episode_returns, self.episode_lengths, self.terminated)}
