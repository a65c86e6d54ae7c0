"""``qtab.Progress``: the argument of callbacks while a run is in progress."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab import _core
from qtab._utils.fields import with_fields
from qtab._utils.shown import counted, last_of
from qtab.config import Config
from qtab.config.schedules import ByVisits, Constant, Schedule, epsilon, learning_rate
from qtab.results.rates import rates
from qtab.results.summary import FINAL_EPISODES

if TYPE_CHECKING:
    from qtab.results.run import Run
    from qtab.training.setup.resolved_run import ResolvedRun


@with_fields
@dataclass(frozen=True, repr=False)
class Progress:
    """The progress of a run, passed to callbacks. Each call receives the arrays of the call before, extended.

    ``tables``, ``q_table`` and ``run`` are copied when first read, and cost nothing otherwise. Read them during the
    call: afterwards training has continued.
    """

    episodes: int
    """The number of finished episodes."""
    total: int
    """The number of episodes of the run."""
    returns: NDArray[np.float64]
    """(episodes,): the return of each finished episode, read-only."""
    lengths: NDArray[np.int64]
    """(episodes,): the number of steps of each finished episode, read-only."""
    _source: "ProgressSource | None" = field(default=None, repr=False, compare=False)

    def __repr__(self) -> str:
        """Returns one line, without the returns."""
        last = self.returns[-FINAL_EPISODES:]
        mean = f", the {last_of(len(last))} at {last.mean():.2f}" if len(last) else ""
        return f"<Progress: {self.episodes:,} of {counted(self.total, 'episode')}{mean}>"

    @property
    def episode(self) -> int:
        """The index of the last finished episode, from 0; -1 before the first."""
        return self.episodes - 1

    @property
    def steps(self) -> int:
        """The total number of steps of all finished episodes."""
        return int(self.lengths.sum()) if self._source is None else self._source.steps

    @property
    def seconds(self) -> float:
        """The wall-clock time since the training began."""
        return self._required.seconds

    @property
    def is_current(self) -> bool:
        """Whether training has not continued since the call, so that the tables can be read."""
        return self._required.current

    @property
    def config(self) -> Config:
        """The complete config of the run, as in :attr:`qtab.Run.config`."""
        return self._required.reader.config

    @cached_property
    def epsilon(self) -> float | None:
        """The exploration rate of the last finished episode; None with softmax exploration."""
        return self._required.reader.epsilon(max(self.episode, 0))

    @cached_property
    def learning_rate(self) -> float:
        """The learning rate of the last finished episode; with schedule ``"visits"`` that of a first visit."""
        return self._required.reader.learning_rate(max(self.episode, 0))

    @cached_property
    def tables(self) -> NDArray[np.float64]:
        """(k, rows, actions): a copy of the Q tables; two for Double Q-learning, else one.

        Raises:
            RuntimeError: if ``tables`` is first read after the call.
        """
        return self._current("tables").read_tables()

    @cached_property
    def q_table(self) -> NDArray[np.float64]:
        """(*cells, actions): a copy of the values that the greedy policy uses; with two tables their sum.

        Raises:
            RuntimeError: if ``q_table`` is first read after the call.
            ValueError: with tile coding, which has no cells.
        """
        discretizer = self._current("q_table").discretizer
        if not discretizer.has_cells or self.config.action_mask is not False:
            return self.run.q_table  # with tile coding, its error names the alternative
        from qtab.results.action_values import read_by_policy

        first, *others = read_by_policy(self.config, self.tables)
        values: NDArray[np.float64] = sum(others, first.copy())
        return values.reshape(*discretizer.shape, -1)

    @cached_property
    def run(self) -> "Run":
        """The run so far, to be evaluated, plotted or saved. Its ``completed`` is False before the last episode.

        It has no recordings, which are made of the last episodes of the whole run.

        Raises:
            RuntimeError: if ``run`` is first read after the call.
        """
        return self._current("run").make_run()

    @property
    def _required(self) -> "ProgressSource":
        if self._source is None:
            raise RuntimeError("this Progress was not made by qtab.train: it has only episodes, returns and lengths")
        return self._source

    def _current(self, name: str) -> "EpisodeReader":
        if not self._required.current:
            raise RuntimeError(
                f"progress.{name} must be read during the call: the run has moved on since its "
                + counted(self.episodes, "episode")
            )
        return self._required.reader


Callback = Callable[[Progress], bool | None]


@dataclass(slots=True)
class ProgressSource:
    """The run behind a Progress."""

    reader: "EpisodeReader"
    steps: int
    seconds: float
    current: bool = True
    """False once training has continued: the reader then reads later values."""


class EpisodeReader:
    """Reads the finished episodes of a trainer. Each call copies only the episodes since the last call.

    It is a context manager; when it exits, the last Progress can no longer read its tables.
    """

    def __init__(
        self, trainer: _core.Trainer, resolved: "ResolvedRun", began: float, make_run: "Callable[[], Run]"
    ) -> None:
        self._trainer, self._resolved = trainer, resolved
        self.config, self.discretizer, self.make_run = resolved.config, resolved.discretizer, make_run
        self._began = began
        self._episodes = self._steps = 0
        self._returns, self._lengths = np.empty(0, np.float64), np.empty(0, np.int64)
        self._rates: dict[Schedule, NDArray[np.float64]] = {}
        """The rates of the first episodes, by schedule."""
        self._source: ProgressSource | None = None

    def __enter__(self) -> "EpisodeReader":
        return self

    def __exit__(self, *_: object) -> None:
        self.move_on()

    def read(self) -> Progress:
        """Returns the progress so far."""
        returns, lengths, _ = self._trainer.episodes(since=self._episodes)
        before, self._episodes = self._episodes, self._episodes + len(returns)
        total = self.config.episodes
        if self._episodes > len(self._returns):
            # The capacity doubles, so that over a run each episode is copied about once more.
            capacity = min(max(self._episodes, 2 * len(self._returns)), total)
            self._returns = _enlarge(self._returns, before, capacity)
            self._lengths = _enlarge(self._lengths, before, capacity)
        now = slice(before, self._episodes)
        self._returns[now], self._lengths[now] = returns, lengths
        self._steps += int(lengths.sum())
        self._source = ProgressSource(self, self._steps, time.perf_counter() - self._began)
        columns = _read_only(self._returns, self._episodes), _read_only(self._lengths, self._episodes)
        return Progress(self._episodes, total, *columns, self._source)

    def epsilon(self, episode: int) -> float | None:
        """Returns the exploration rate of an episode, counted from 0; None unless exploration is epsilon-greedy."""
        return self._rate(epsilon(self.config), episode) if self.config.exploration == "epsilon_greedy" else None

    def learning_rate(self, episode: int) -> float:
        """Returns the learning rate of an episode, counted from 0; with schedule ``"visits"`` that of a first visit."""
        rate = learning_rate(self.config)
        return self._rate(Constant(rate.value) if isinstance(rate, ByVisits) else rate, episode)

    def _rate(self, schedule: Schedule, episode: int) -> float:
        known = self._rates.get(schedule, np.empty(0, np.float64))
        if episode >= len(known):
            # As many as the columns hold: their capacity doubles, so few rates are computed twice.
            count = max(len(self._returns), episode + 1)
            known = self._rates[schedule] = rates(schedule, self.config.episodes, count)
        return float(known[episode])

    def move_on(self) -> None:
        """Called before the trainer advances: the last Progress can no longer read its tables."""
        if self._source is not None:
            self._source.current = False
            self._source = None

    def read_tables(self) -> NDArray[np.float64]:
        """Returns a copy of the current tables, (k, rows, actions)."""
        return self._trainer.tables().reshape(-1, self.discretizer.n_rows, len(self._resolved.actions))


def _enlarge(column: NDArray[Any], used: int, capacity: int) -> NDArray[Any]:
    enlarged = np.empty(capacity, column.dtype)
    enlarged[:used] = column[:used]
    return enlarged


def _read_only(column: NDArray[Any], used: int) -> NDArray[Any]:
    """Returns a read-only view of the used part, so that a callback cannot change what later ones read."""
    view = column[:used]
    view.flags.writeable = False
    return view
