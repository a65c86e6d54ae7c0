"""``qtab.Runs``: the results of many runs of one config."""

import operator
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks, html
from qtab._utils.data_frames import data_frame, integer_column
from qtab._utils.fields import with_fields
from qtab._utils.shown import last_of, plural
from qtab.config import Config
from qtab.config.config import replace_checked
from qtab.config.origin import trained_on
from qtab.discretizers import Discretizer
from qtab.envs.actions import Actions
from qtab.envs.origin.description import EnvironmentDescription
from qtab.results.files import file_parts, run_file
from qtab.results.files.consistency import check_consistent_runs
from qtab.results.run import Run
from qtab.results.summary import FINAL_EPISODES, block_means, default_block, summarize

if TYPE_CHECKING:
    import pandas as pd

BAND = (10.0, 90.0)
"""The percentiles of the runs shown as a band around their mean."""


@with_fields
@dataclass(frozen=True, eq=False, repr=False)
class Runs:
    """Many runs of one config, one per row.

    ``runs[i]`` is the run of ``seeds[i]``, if the tables were kept; ``runs[10:20]`` are ten of the runs.
    """

    config: Config
    """Everything needed to repeat the runs; its seed is that of the first finished run."""
    seeds: tuple[int, ...]
    """(runs,): the seed of each run."""
    episode_returns: NDArray[np.float64]
    """(runs, episodes): the sum of rewards of each episode."""
    episode_lengths: NDArray[np.int64]
    """(runs, episodes): the number of steps of each episode."""
    terminated: NDArray[np.bool_]
    """(runs, episodes): whether each episode ended in a terminal state, not only by its time limit."""
    tables: NDArray[np.float64] | None
    """(runs, k, rows, actions): the Q tables of each run; None without ``tables=True``."""
    discretizer: Discretizer
    """Maps observations to rows of the tables."""
    actions: Actions
    """The environment's actions, in the order of the columns of the tables."""
    completed: bool
    """False after an interruption; then only the finished runs are included."""
    seconds: float
    """The wall-clock time of the training of all runs together."""
    versions: Mapping[str, str]
    """The versions of qtab, Gymnasium, NumPy and Python, and the platform."""
    action_masks: NDArray[np.bool_] | None = None
    """(runs, *cells, actions): the masks of each run; see :attr:`qtab.Run.action_masks`."""

    def __post_init__(self) -> None:
        """Sets the config's seed to that of the first run, even if runs of earlier seeds did not finish."""
        if self.seeds and self.config.seed != self.seeds[0]:
            vars(self)["config"] = replace_checked(self.config, seed=self.seeds[0])

    def __repr__(self) -> str:
        runs, episodes = self.episode_returns.shape
        mean = (
            f", their {last_of(min(episodes, FINAL_EPISODES))} at {self.final_returns().mean():.2f}"
            if self.episode_returns.size
            else ""
        )
        seeds, each = f"{runs} {plural('seed', runs)}", f"{episodes} {plural('episode', episodes)} each"
        return f"<Runs of {self.config.env}: {self.config.algorithm}, {seeds}, {each}{mean}>"

    def _repr_html_(self) -> str:
        """Returns a table and the mean learning curve, for notebooks."""
        config, (runs, episodes) = self.config, self.episode_returns.shape
        facts: dict[str, object] = {
            "algorithm": config.algorithm,
            "runs": f"{runs:,}, seeds {self.seeds[0]} to {self.seeds[-1]}" if runs > 1 else f"{runs}",
            "episodes": f"{episodes:,} each",
            "time": f"{self.seconds:.3g} s",
        }
        picture = ""
        if self.episode_returns.size:
            final = self.final_returns()
            facts[f"mean of the last {min(episodes, FINAL_EPISODES)}"] = (
                f"{final.mean():.2f}, runs from {final.min():.2f} to {final.max():.2f}"
            )
            block = min(default_block(episodes), max(episodes // 20, 1))
            means = self.mean_returns(block)
            low, high = np.percentile(means, BAND, axis=0)
            label = f"Mean learning curve in blocks of {block:,}, with the band of 80% of the runs"
            picture = html.lines(label, {"mean of the runs": means.mean(axis=0)}, (low, high))
        return html.summary(f"Runs of {config.env}", facts, picture)

    @property
    def trained_on(self) -> EnvironmentDescription | None:
        """The environment in detail, as it was when training began; None if a file does not store it."""
        return trained_on(self.config)

    @property
    def grid(self) -> Discretizer:
        """An alias of :attr:`discretizer`, its name in earlier versions."""
        return self.discretizer

    def __len__(self) -> int:
        return len(self.seeds)

    @overload
    def __getitem__(self, index: int) -> Run: ...
    @overload
    def __getitem__(self, index: slice) -> "Runs": ...
    def __getitem__(self, index: int | slice) -> "Run | Runs":
        """Returns one run, equal to the result of :func:`qtab.train` for its seed, or the runs of a slice.

        ``seconds`` is divided equally among all runs.

        Raises:
            IndexError: if there is no such run.
            TypeError: if ``index`` is neither an integer nor a slice.
            ValueError: if the tables were not kept, for one run.
        """
        if isinstance(index, slice):
            return self._part(index)
        if isinstance(index, bool | np.bool_) or not hasattr(index, "__index__"):
            raise TypeError(f"index must be an integer or a slice, got {index!r}")
        try:
            index = range(len(self))[operator.index(index)]
        except IndexError:
            raise IndexError(f"there are {len(self)} runs, got index {index}") from None
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
            action_masks=None if self.action_masks is None else self.action_masks[index],
        )

    def _part(self, part: slice) -> "Runs":
        seeds = self.seeds[part]
        return replace(
            self,
            seeds=seeds,
            episode_returns=self.episode_returns[part],
            episode_lengths=self.episode_lengths[part],
            terminated=self.terminated[part],
            tables=None if self.tables is None else self.tables[part],
            action_masks=None if self.action_masks is None else self.action_masks[part],
            seconds=self.seconds * len(seeds) / max(len(self), 1),
        )

    def __iter__(self) -> Iterator[Run]:
        return map(self.__getitem__, range(len(self)))

    def mean_returns(self, block: int = 100) -> NDArray[np.float64]:
        """Returns (runs, blocks): the average return of each whole block of episodes, run by run.

        Episodes after the last whole block do not count: with fewer episodes than ``block``, there are no blocks.

        Raises:
            TypeError: if ``block`` is not an integer.
            ValueError: if ``block`` is less than one.
        """
        block = checks.integer("block", block, least=1)
        return block_means(self.episode_returns, block)

    def final_returns(self, last: int | None = None) -> NDArray[np.float64]:
        """Returns (runs,): the average return of the last episodes of each run.

        Args:
            last: The number of episodes; None averages the last 100, or all if there are fewer.

        Raises:
            TypeError: if ``last`` is not an integer.
            ValueError: if ``last`` is less than one, or the runs have fewer episodes.
        """
        episodes = self.episode_returns.shape[1]
        last = min(episodes, FINAL_EPISODES) if last is None else checks.integer("last", last, 1, episodes)
        means: NDArray[np.float64] = self.episode_returns[:, -last:].mean(axis=1)
        return means

    def summaries(self) -> dict[str, NDArray[Any]]:
        """Returns columns with one number per run: the seed, and those of :func:`qtab.results.summary.summarize`.

        Seeds are int64, uint64 if one needs it, or Python integers in an object array if one is at least 2**64.
        """
        seeds = integer_column(self.seeds)
        return {"seed": seeds, **summarize(self.episode_returns, self.episode_lengths, self.terminated)}

    def save(self, path: "str | os.PathLike[str]") -> None:
        """Writes all runs to one ``.npz`` file, as :meth:`qtab.Run.save` does. :func:`qtab.load_runs` reads it.

        Raises:
            OSError: if the file cannot be written, or ``path`` exists and is not a regular file. An older file stays
                intact, even if the process is killed.
            TypeError: if the environment's keyword arguments are not JSON data.
            ValueError: if they hold a number that JSON cannot represent, or training cannot have returned the runs.
        """
        path = checks.file_path("path", path)
        try:
            check_consistent_runs(self)
        except ValueError as error:
            raise ValueError(f"these runs cannot be saved: {error}") from None
        arrays = {name: getattr(self, name) for name in (*run_file.ARRAYS, "action_masks")}
        arrays = {name: array for name, array in arrays.items() if array is not None}
        file_parts.write(path, run_file.RUNS, self, {"seeds": self.seeds, "rows": self.discretizer.n_rows}, arrays)

    def to_pandas(self) -> "pd.DataFrame":
        """Returns the columns of :meth:`summaries` as a data frame with one row per run.

        Raises:
            ModuleNotFoundError: without pandas; the message names the ``pip install``.
        """
        return data_frame(self.summaries())
