"""``qtab.Run``: the result of a training run."""

import dataclasses
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import checks
from qtab._utils.files import check_writable
from qtab.config import Config
from qtab.discretizers import Discretizer
from qtab.discretizers.actions import Actions
from qtab.results import run_file
from qtab.results.run_state import RunState
from qtab.results.summary import FINAL_EPISODES


@dataclass(frozen=True, eq=False, repr=False)
class Run:
    """A finished or interrupted run: its config, its episodes, and what it learned."""

    config: Config
    """Everything needed to repeat the run; defaults and preset are filled in."""
    tables: NDArray[np.float64]
    """(k, rows, actions): the Q tables; two for Double Q-learning, else one."""
    episode_returns: NDArray[np.float64]
    """(episodes,): the sum of rewards of each finished episode."""
    episode_lengths: NDArray[np.int64]
    """(episodes,): the number of steps of each finished episode."""
    terminated: NDArray[np.bool_]
    """(episodes,): whether each ended in a terminal state, not only by its time limit."""
    discretizer: Discretizer
    """Maps observations to rows of the tables."""
    actions: Actions
    """The environment's actions, in the order of the columns of the tables."""
    completed: bool
    """False after an early stop; the tables then hold what was learned so far, an unfinished episode included."""
    seconds: float
    """How long the training took, in wall-clock time."""
    versions: Mapping[str, str]
    """The versions of qtab, Gymnasium, NumPy and Python, and the platform."""
    recordings: tuple["Recording", ...] = field(default=(), repr=False)
    """The last episodes, where ``record=`` asked for them, to be replayed. They are not saved."""
    state: RunState | None = field(default=None, repr=False)
    """What :func:`qtab.resume` needs; None for runs of ``train_many`` and from files of earlier versions."""

    def __repr__(self) -> str:
        """One line: the tables are not shown."""
        config, finished = self.config, len(self.episode_returns)
        episodes = f"{finished}" if self.completed else f"{finished} of {config.episodes}"
        last = self.episode_returns[-FINAL_EPISODES:]
        mean = f", the last {len(last)} at {last.mean():.2f}" if finished else ""
        return f"<Run of {config.env}: {config.algorithm}, seed {config.seed}, {episodes} episodes{mean}>"

    @property
    def grid(self) -> Discretizer:
        """An alias of :attr:`discretizer`, its name in earlier versions."""
        return self.discretizer

    @property
    def q_table(self) -> NDArray[np.float64]:
        """(*cells, actions): the values that the greedy policy reads; of two tables the sum.

        Raises:
            ValueError: with tile coding, which has no cells.
        """
        self._require_cells("q_table", "q_values")
        return _sum(self.tables).reshape(*self.discretizer.shape, len(self.actions))

    @property
    def policy(self) -> NDArray[Any]:
        """(*cells,): the greedy action of each cell, the first of several; (*cells, d) for actions of a Box.

        Raises:
            ValueError: with tile coding, which has no cells; :meth:`predict` works.
        """
        self._require_cells("policy", "predict")
        return self.actions.take(np.argmax(self.q_table, axis=-1))

    def _require_cells(self, attribute: str, method: str) -> None:
        if not self.discretizer.has_cells:
            raise ValueError(
                f"{attribute} needs cells, which discretizer {self.config.discretizer!r} does not have; "
                f"run.{method}(observation) works"
            )

    def q_values(self, observation: ArrayLike) -> NDArray[np.float64]:
        """Returns the (actions,) values of an observation, or the (n, actions) values of n observations.

        Raises:
            TypeError: if the observation does not hold numbers (integers for a discrete space).
            ValueError: if it has another shape than the space, or lies outside the space.
        """
        active = np.moveaxis(self.discretizer.active_rows(observation), -1, 0)
        return _sum(_sum(table[rows] for rows in active) for table in self.tables)

    def predict(
        self,
        observation: ArrayLike,
        state: Any = None,  # noqa: ARG002 - Stable-Baselines3's signature
        episode_start: Any = None,  # noqa: ARG002
        deterministic: bool = True,  # noqa: ARG002
    ) -> tuple[Any, None]:
        """Returns the greedy action of an observation as ``env.step`` takes it, and None, as Stable-Baselines3 does.

        For n observations, an array with one more leading axis, it returns an array of n actions. ``state``,
        ``episode_start`` and ``deterministic`` are accepted and ignored: a greedy policy has no use for them.

        Raises:
            TypeError: if the observation does not hold numbers (integers for a discrete space).
            ValueError: if it has another shape than the space, or lies outside the space.
        """
        greedy = np.argmax(self.q_values(observation), axis=-1)
        return (self.actions.take(greedy) if greedy.ndim else self.actions[int(greedy)]), None

    def mean_returns(self, block: int = 100) -> NDArray[np.float64]:
        """Returns the average return of each whole block of episodes, as the article plots it.

        Raises:
            TypeError: if ``block`` is not an integer.
            ValueError: if it is less than one.
        """
        block = checks.integer("block", block, least=1)
        whole = len(self.episode_returns) // block * block
        means: NDArray[np.float64] = self.episode_returns[:whole].reshape(-1, block).mean(axis=1)
        return means

    def save(self, path: "str | os.PathLike[str]") -> None:
        """Writes the run to one ``.npz`` file: arrays and a JSON header, never a pickle. :func:`qtab.load` reads it.

        Raises:
            OSError: if the file cannot be written. An older file stays, and no unfinished one is left behind.
            TypeError: if the environment's keyword arguments hold what JSON cannot.
            ValueError: if they hold a number that JSON cannot.
        """
        path = Path(path)
        check_writable("path", path)
        arrays = {name: getattr(self, name) for name in run_file.ARRAYS} | self.discretizer.arrays()
        if self.actions.values is not None:
            arrays["actions"] = self.actions.values
        config = {field.name: getattr(self.config, field.name) for field in dataclasses.fields(Config)}
        if isinstance(self.config.initial_q, np.ndarray):
            arrays["initial_q"] = self.config.initial_q
            config["initial_q"] = None
        if self.state is not None:
            arrays["state"] = self.state.array()
        header = {
            "config": config,
            "actions": len(self.actions),
            "first_action": self.actions.first,
            "completed": self.completed,
            "seconds": self.seconds,
            "versions": dict(self.versions),
            "generator": None if self.state is None else self.state.generator,
        }
        try:
            text = run_file.encode(header)
        except (TypeError, ValueError) as error:
            kwargs = self.config.env_kwargs
            raise type(error)(f"env_kwargs must hold what JSON can, got {kwargs!r}: {error}") from None
        run_file.write(path, text, arrays)


@dataclass(frozen=True)
class Recording:
    """One episode that can be replayed."""

    episode: int
    """The number of the episode in its run, from 0."""
    start: Mapping[str, Any]
    """The state of the environment's bit generator before the episode's reset."""
    actions: tuple[Any, ...]
    """What ``env.step`` was given: integers, with the start of a Discrete space added, or arrays."""


def _sum(parts: Iterable[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Adds from left to right, as the learners do; ``np.sum`` would add in pairs."""
    first, *others = parts
    total: NDArray[np.float64] = np.array(first)
    for part in others:
        total += part
    return total
