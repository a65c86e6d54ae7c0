"""Snapshots: the tables of a run at chosen episodes."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks

if TYPE_CHECKING:
    from qtab import _core


@dataclass(frozen=True, eq=False)
class Snapshots:
    """The tables of a run at several points in time."""

    episodes: NDArray[np.int64]
    """(n,): how many episodes were finished at each snapshot, ascending."""
    tables: NDArray[np.float64]
    """(n, k, rows, actions): the Q tables then, in the layout of ``run.tables``."""

    def __len__(self) -> int:
        return len(self.episodes)

    def __repr__(self) -> str:
        shown = f", after episodes {self.episodes[0]:,} to {self.episodes[-1]:,}" if len(self) else ""
        return f"<{len(self)} Snapshots{shown}>"


def snapshot_episodes(wanted: int | Sequence[int] | None, total: int) -> tuple[int, ...]:
    """Returns the numbers of finished episodes at which to copy the tables, ascending and without duplicates.

    Args:
        wanted: How many, evenly spaced over the run and the last one included, at most one after each episode; or the
            numbers themselves, from 0, before the run, to ``total``; None and 0 mean none.
        total: How many episodes the run has.

    Raises:
        TypeError: if it is neither an integer nor a sequence of integers.
        ValueError: if a number is out of range.
    """
    if wanted is None:
        return ()
    if hasattr(wanted, "__index__") or isinstance(wanted, bool | str | bytes) or not np.iterable(wanted):
        count = min(_count(wanted), total)
        return tuple(total * (index + 1) // count for index in range(count))
    numbers = {checks.integer("snapshots[...]", number, least=0, most=total) for number in wanted}
    if not numbers:
        raise ValueError("snapshots must be how many, or hold at least one episode number, got an empty sequence")
    return tuple(sorted(numbers))


def _count(wanted: Any) -> int:
    try:
        return checks.count("snapshots", wanted, least=0)
    except TypeError:
        raise TypeError(f"snapshots must be an integer or a sequence of episode numbers, got {wanted!r}") from None


class SnapshotCollector:
    """Copies the tables of a trainer at chosen episodes.

    Args:
        trainer: The trainer.
        episodes: When to copy, as :func:`snapshot_episodes` returns it.
        shape: The shape of the tables, (k, rows, actions).

    Raises:
        ValueError: if the copies do not fit into memory.
    """

    def __init__(self, trainer: "_core.Trainer", episodes: tuple[int, ...], shape: tuple[int, int, int]) -> None:
        self._trainer, self._episodes, self._taken = trainer, episodes, 0
        try:
            self._tables = np.empty((len(episodes), *shape))
        except (MemoryError, ValueError):
            raise ValueError(
                f"snapshots must fit into memory, got {len(episodes)} of tables of shape {shape}, which need "
                f"{len(episodes) * 8.0 * np.prod([float(size) for size in shape]):.3g} bytes"
            ) from None

    def stops(self, done: int, target: int) -> Iterator[int]:
        """Yields the episodes to train up to in turn, from ``done`` to ``target``, and copies the tables there."""
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
        """Returns the snapshots so far; None if none were asked for."""
        if not self._episodes:
            return None
        return Snapshots(np.array(self._episodes[: self._taken], np.int64), self._tables[: self._taken])
