"""What a run keeps on request: its last episodes for replay, and copies of its tables."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab.config import Config
from qtab.envs.actions import Actions

if TYPE_CHECKING:
    from qtab import _core


@dataclass(frozen=True, repr=False)
class Recording:
    """One episode that can be replayed."""

    episode: int
    """The number of the episode in its run, from 0."""
    start: Mapping[str, Any]
    """The state of the environment's bit generator before the episode's reset."""
    actions: tuple[Any, ...]
    """The arguments of ``env.step``: integers, with the start of a Discrete space added, or arrays."""

    def __repr__(self) -> str:
        return f"<Recording of episode {self.episode}: {len(self.actions):,} actions>"


def recordings_of(
    config: Config, actions: Actions, kept: Sequence[tuple[Any, NDArray[Any]]], finished: int
) -> tuple[Recording, ...]:
    """Returns the recordings of the last of the ``finished`` episodes of a run.

    Args:
        config: The resolved config of the run.
        actions: The actions of the run.
        kept: For each recorded episode its start, as for :func:`generator_before`, and the columns of its actions.
        finished: The number of finished episodes.
    """
    return tuple(
        Recording(number, generator_before(config.seed, start), tuple(actions[column] for column in columns.tolist()))
        for number, (start, columns) in enumerate(kept, finished - len(kept))
    )


def generator_before(seed: int | None, start: Any) -> dict[str, Any]:
    """Returns the state of the environment's bit generator before a recorded episode.

    Args:
        seed: The seed of the run.
        start: The number of 64-bit words drawn since seeding and the buffered uint32 (None if there is none); or the
            state itself; or any other value, for an episode that starts right after seeding.
    """
    if isinstance(start, dict):
        return start
    generator = np.random.PCG64(seed)
    if isinstance(start, tuple):
        words_drawn, buffered_uint32 = start
        generator.advance(words_drawn)
        state: dict[str, Any] = dict(generator.state)
        return {**state, "has_uint32": int(buffered_uint32 is not None), "uinteger": buffered_uint32 or 0}
    return dict(generator.state)


@dataclass(frozen=True, eq=False)
class Snapshots:
    """The tables of a run at several points in time."""

    episodes: NDArray[np.int64]
    """(n,): the number of finished episodes at each snapshot, ascending."""
    tables: NDArray[np.float64]
    """(n, k, rows, actions): the Q tables at each snapshot, in the layout of ``run.tables``."""

    def __len__(self) -> int:
        return len(self.episodes)

    def __repr__(self) -> str:
        shown = f", after episodes {self.episodes[0]:,} to {self.episodes[-1]:,}" if len(self) else ""
        return f"<{len(self)} Snapshots{shown}>"


def snapshot_episodes(wanted: int | Sequence[int] | None, total: int) -> tuple[int, ...]:
    """Returns the numbers of finished episodes at which to copy the tables, ascending and without duplicates.

    Args:
        wanted: The number of snapshots, evenly spaced over the run and including its end, at most one per episode; or
            the numbers of episodes, from 0 (before the run) to ``total``; None and 0 mean none.
        total: The number of episodes of the run.

    Raises:
        TypeError: if ``wanted`` is neither an integer nor a sequence of integers.
        ValueError: if a number is out of range.
    """
    if wanted is None:
        return ()
    if isinstance(wanted, bool | str | bytes) or not np.iterable(wanted):  # an array of several has an __index__ too
        count = min(_count(wanted), total)
        return tuple(total * (index + 1) // count for index in range(count))
    numbers = {
        checks.integer(f"snapshots[{index}]", number, least=0, most=total) for index, number in enumerate(wanted)
    }
    if not numbers:
        raise ValueError("snapshots must be a number, or hold at least one episode number, got an empty sequence")
    return tuple(sorted(numbers))


def resumed_snapshot_episodes(
    wanted: int | Sequence[int] | None, total: int, finished: int, earlier: Snapshots | None, to_take: Sequence[int]
) -> tuple[int, ...]:
    """Returns the numbers of episodes of all snapshots of a resumed run, those of its earlier part first.

    Args:
        wanted: The snapshots of the resuming call, as for :func:`snapshot_episodes`. Of evenly spaced ones, only those
            after the finished episodes can be taken.
        total: The number of episodes of the whole run.
        finished: The number of finished episodes.
        earlier: The snapshots of the earlier part.
        to_take: The episodes of the snapshots that the earlier part still had to take.

    Raises:
        TypeError: if ``wanted`` is neither an integer nor a sequence of integers.
        ValueError: if a number is out of range, or names an episode already finished.
    """
    taken = () if earlier is None else tuple(earlier.episodes.tolist())
    planned = {number for number in to_take if finished <= number <= total}
    asked = set(snapshot_episodes(wanted, total)) - planned - set(taken)
    over = sorted(number for number in asked if number <= finished)
    if over and not isinstance(wanted, int | np.integer):
        raise ValueError(f"snapshots must lie after the {finished:,} episodes that the run has finished, got {over[0]}")
    return (*taken, *sorted(planned | (asked - set(over))))


def _count(wanted: Any) -> int:
    try:
        return checks.count("snapshots", wanted, least=0)
    except TypeError:
        raise TypeError(f"snapshots must be an integer or a sequence of episode numbers, got {wanted!r}") from None


class SnapshotCollector:
    """Copies the tables of a trainer at chosen episodes.

    Args:
        trainer: The trainer.
        episodes: The episodes at which to copy, from :func:`snapshot_episodes`; those of ``earlier`` come first.
        shape: The shape of the tables, (k, rows, actions).
        earlier: The snapshots of an earlier part of the run.

    Raises:
        ValueError: if the copies do not fit into memory.
    """

    def __init__(
        self,
        trainer: "_core.Trainer",
        episodes: tuple[int, ...],
        shape: tuple[int, int, int],
        earlier: Snapshots | None = None,
    ) -> None:
        self._trainer, self._episodes, self._taken = trainer, episodes, 0
        self._wanted = bool(episodes) or earlier is not None
        try:
            self._tables = np.empty((len(episodes), *shape))
        except (MemoryError, ValueError):
            raise ValueError(
                f"snapshots must fit into memory, got {len(episodes)} of tables of shape {shape}, which need "
                f"{len(episodes) * 8.0 * np.prod([float(size) for size in shape]):.3g} bytes"
            ) from None
        if earlier is not None:
            self._taken = len(earlier)
            self._tables[: self._taken] = earlier.tables

    def stops(self, done: int, target: int) -> Iterator[int]:
        """Yields the next episodes to stop at, from ``done`` to ``target``, and copies the tables at each."""
        self._copy(done)
        for episode in self._episodes:
            if done < episode < target:
                yield episode
                self._copy(episode)
        yield target
        self._copy(target)

    def _copy(self, done: int) -> None:
        if self._taken < len(self._episodes) and self._episodes[self._taken] == done:
            self._tables[self._taken] = self._trainer.tables().reshape(self._tables.shape[1:])
            self._taken += 1

    def snapshots(self) -> Snapshots | None:
        """Returns the snapshots so far; None if none were requested."""
        if not self._wanted:
            return None
        return Snapshots(np.array(self._episodes[: self._taken], np.int64), self._tables[: self._taken])

    @property
    def to_take(self) -> tuple[int, ...]:
        """The episodes at which the tables are still to be copied."""
        return self._episodes[self._taken :]
