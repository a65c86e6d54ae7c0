"""What a training run leaves behind."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import checks
from qtab.config import Config
from qtab.discretizers.base import Features
from qtab.discretizers.tile_coding import Tiling
from qtab.results.summary import FINAL_EPISODES

if TYPE_CHECKING:
    import os


@dataclass(frozen=True, eq=False, repr=False)
class Run:
    """A finished or interrupted run: what it was made from, what it brought, what it learned."""

    config: Config
    """Everything needed to repeat it, defaults and preset resolved."""
    tables: NDArray[np.float64]
    """(k, rows, actions): the raw tables; two for Double Q-learning, else one."""
    episode_returns: NDArray[np.float64]
    """(episodes,): the sum of rewards of each finished episode."""
    episode_lengths: NDArray[np.int64]
    """(episodes,): the number of steps of each finished episode."""
    terminated: NDArray[np.bool_]
    """(episodes,): whether each ended in a terminal state, and not by its time limit alone."""
    grid: Features
    """How observations become rows."""
    completed: bool
    """False after an early stop; the table then holds what was learned up to it, an unfinished episode included."""
    seconds: float
    """How long the training took, by the wall clock."""
    versions: Mapping[str, str]
    """Of qtab, Gymnasium, NumPy and Python, and the platform."""
    recordings: tuple["Recording", ...] = field(default=(), repr=False)
    """The last episodes, where they were asked for: what it takes to play them again. Not saved."""

    def __repr__(self) -> str:
        """One line: a prompt that shows a run should not show its table."""
        config, finished = self.config, len(self.episode_returns)
        episodes = f"{finished}" if self.completed else f"{finished} of {config.episodes}"
        last = self.episode_returns[-FINAL_EPISODES:]
        mean = f", the last {len(last)} at {last.mean():.2f}" if finished else ""
        return f"<Run of {config.env}: {config.algorithm}, seed {config.seed}, {episodes} episodes{mean}>"

    @property
    def q_table(self) -> NDArray[np.float64]:
        """(*cells, actions): what the greedy policy reads; of two tables the sum.

        Raises:
            ValueError: with tile coding, which has no cells.
        """
        if isinstance(self.grid, Tiling):
            raise ValueError("q_table needs a grid, and this run has tile coding; run.q_values(observation) works")
        table: NDArray[np.float64] = _sum(self.tables).reshape(self.grid.shape)
        return table

    @property
    def policy(self) -> NDArray[Any]:
        """(*cells,): the greedy action of each cell, the first of equals; (*cells, d) where actions are continuous.

        Raises:
            ValueError: with tile coding, which has no cells; :meth:`predict` works.
        """
        return self.grid.choices.greedy(np.argmax(self.q_table, axis=-1))

    def q_values(self, observation: ArrayLike) -> NDArray[np.float64]:
        """Returns the (actions,) values of an observation.

        Raises:
            ValueError: if the observation lies outside the space.
        """
        rows = self.grid.lit(np.asarray(observation))
        return _sum([_sum(table[rows]) for table in self.tables])

    def predict(
        self,
        observation: ArrayLike,
        state: Any = None,  # noqa: ARG002 - Stable-Baselines3's signature
        episode_start: Any = None,  # noqa: ARG002
        deterministic: bool = True,  # noqa: ARG002
    ) -> tuple[Any, None]:
        """Returns the greedy action of an observation, for the environment, and None, as in Stable-Baselines3."""
        return self.grid.choices[int(np.argmax(self.q_values(observation)))], None

    def mean_returns(self, block: int = 100) -> NDArray[np.float64]:
        """Returns the average return of each whole block of episodes, as the article plots it.

        Raises:
            TypeError: if ``block`` is no integer.
            ValueError: if it is less than one.
        """
        block = checks.integer("block", block, least=1)
        whole = len(self.episode_returns) // block * block
        means: NDArray[np.float64] = self.episode_returns[:whole].reshape(-1, block).mean(axis=1)
        return means

    def save(self, path: "str | os.PathLike[str]") -> None:
        """Writes the run to one ``.npz`` file: arrays and a JSON header, never a pickle.

        Raises:
            OSError: if the file cannot be written; nothing half written is left.
            TypeError: if the environment's keyword arguments hold what JSON cannot.
            ValueError: if they hold a number that JSON cannot.
        """
        from qtab.results.storage import save

        save(self, Path(path))


@dataclass(frozen=True)
class Recording:
    """One episode that can be played again."""

    episode: int
    """Its number in the run, from 0."""
    start: Mapping[str, Any]
    """The state of the environment's bit generator before the episode's reset."""
    actions: tuple[Any, ...]
    """The environment's own actions: integers, a Discrete space's start included, or arrays."""


def _sum(parts: Sequence[NDArray[np.float64]] | NDArray[np.float64]) -> NDArray[np.float64]:
    """From the left, as the learners add; NumPy's own sum goes by pairs."""
    total: NDArray[np.float64] = np.array(parts[0])
    for part in parts[1:]:
        total += part
    return total
