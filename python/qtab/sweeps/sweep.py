"""``qtab.sweep``."""

import os
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor, Future, wait
from contextlib import closing
from dataclasses import dataclass
from typing import Any

import cloudpickle
from gymnasium.envs.registration import EnvSpec

from qtab._utils import checks, memory
from qtab.envs.registry import spec_of
from qtab.sweeps.loading import table
from qtab.sweeps.results import Sweep
from qtab.sweeps.store import Store
from qtab.sweeps.study import Piece, Study, study
from qtab.sweeps.worker import train_piece, train_share
from qtab.training.process_pool import pool
from qtab.training.resolve import log_default_limit
from qtab.training.train_many import MakeEnv, thread_count

BLOCK = 100
IN_FLIGHT = 64
"""How many pieces an executor is given at a time."""
PATIENCE = 0.5
"""Seconds between two looks for pieces that another process had claimed."""


@dataclass(frozen=True)
class SweepProgress:
    """A sweep underway, as a callback sees it."""

    runs: int
    """How many runs are finished, those found in the store included …"""
    total: int
    """… of how many."""
    new: int
    """How many this call has finished …"""
    seconds: float
    """… in how long."""


def sweep(
    env: str | EnvSpec | MakeEnv,
    grid: Mapping[str, Sequence[Any]] | Sequence[Mapping[str, Any]],
    seeds: int | Iterable[int] = 100,
    *,
    store: "str | os.PathLike[str] | None" = None,
    executor: Executor | None = None,
    threads: int | None = None,
    memory_limit: int | None = None,
    block: int = BLOCK,
    callback: Callable[[SweepProgress], None] | None = None,
    **config: Any,
) -> Sweep:
    """Trains every setting with the same seeds. Killed and called again, it goes on where its store ends.

    Args:
        env: An environment's id, its EnvSpec, or a function that makes one.
        grid: Lists of values by name, of which every combination is tried; or a list of settings, such as
            :func:`qtab.sweeps.designs.sobol` returns. Any field of :class:`qtab.Config` can be a name.
        seeds: The seeds of every setting; an integer N means 0 to N - 1.
        store: An SQLite file to keep the results in; several processes may share it. None keeps them in memory.
        executor: Where to train: any of :mod:`concurrent.futures`, Dask's ``client.get_executor()``. None trains here,
            in threads, and what is stepped in Python in processes.
        threads: How many threads or processes, without an executor; None means one a core.
        memory_limit: The bytes that a run underway may take; None means half of the machine's memory.
        block: Learning curves are kept as the mean returns of so many episodes.
        callback: Called after every piece of work, of about a second.
        **config: The fields of :class:`qtab.Config` that all settings share.

    Returns:
        A table of a row a run. A run that failed has its error in it.

    Raises:
        gymnasium.error.Error: Gymnasium's own, for an id that it does not know.
        MemoryError: if a run would take more than ``memory_limit``, before anything begins.
        OSError: if the store cannot be written.
        StoreError: if the store is damaged, of another version, or of another sweep.
        TypeError: for an argument of the wrong type, or an unknown one.
        ValueError: for an argument out of range.
        KeyboardInterrupt: on Ctrl-C; it carries the table of the finished runs as ``.run``.
    """
    block = checks.integer("block", block, least=1)
    workers = thread_count(threads)
    if executor is not None and not hasattr(executor, "submit"):
        raise TypeError(f"executor must have the method submit, as those of concurrent.futures do, got {executor!r}")
    if isinstance(env, str):
        env = spec_of(env)  # a worker may not have imported what registered it
    planned = study(env, grid, seeds, block, config)
    for resolved in planned.resolved:
        log_default_limit(resolved)
    planned.check_memory(memory.memory_limit(memory_limit))
    with closing(Store(store, planned)) as kept:
        report = _Report(planned, kept, callback)
        try:
            if executor is not None:
                _with_executor(planned, kept, executor, report)
            elif all(resolved.model is not None for resolved in planned.resolved):
                _here(planned, kept, workers, report)
            else:
                with pool(workers) as own:
                    _with_executor(planned, kept, own, report, in_flight=2 * workers)
        except KeyboardInterrupt as error:
            error.run = _table(planned, kept)  # type: ignore[attr-defined]
            raise
        return _table(planned, kept)


class _Report:
    def __init__(self, planned: Study, kept: Store, callback: Callable[[SweepProgress], None] | None) -> None:
        self._total, self._kept, self._callback = planned.runs, kept, callback
        self._began = time.perf_counter()
        self._found = kept.finished()[1]

    def __call__(self) -> None:
        if self._callback is not None:
            done = self._kept.finished()[1]
            seconds = time.perf_counter() - self._began
            self._callback(SweepProgress(done, self._total, done - self._found, seconds))


def _here(planned: Study, kept: Store, threads: int, report: _Report) -> None:
    while not _all_done(planned, kept):
        number = kept.claim()
        if number is None:
            time.sleep(PATIENCE)
            continue
        piece = planned.pieces[number]
        rows = []
        for setting, seeds in planned.share(piece):
            overrides = {**planned.fixed, **planned.settings[setting]}
            resolved = planned.resolved[setting]
            rows += train_share(planned.env, overrides, resolved, seeds, planned.block, threads)
        kept.enter(piece, rows)
        report()


def _with_executor(
    planned: Study, kept: Store, executor: Executor, report: _Report, in_flight: int = IN_FLIGHT
) -> None:
    pending: dict[Future[Any], Piece] = {}
    try:
        while pending or not _all_done(planned, kept):
            while len(pending) < in_flight and (number := kept.claim()) is not None:
                piece = planned.pieces[number]
                pending[executor.submit(train_piece, _task(planned, piece))] = piece
            if not pending:
                time.sleep(PATIENCE)
                continue
            done, _ = wait(pending, timeout=PATIENCE, return_when="FIRST_COMPLETED")
            for future in done:
                kept.enter(pending.pop(future), future.result())
                report()
    finally:
        for future in pending:
            future.cancel()


def _all_done(planned: Study, kept: Store) -> bool:
    return kept.finished()[0] == len(planned.pieces)


def _task(planned: Study, piece: Piece) -> bytes:
    shares = [({**planned.fixed, **planned.settings[setting]}, seeds) for setting, seeds in planned.share(piece)]
    task: bytes = cloudpickle.dumps((planned.env, shares, planned.block))
    return task


def _table(planned: Study, kept: Store) -> Sweep:
    env = planned.resolved[0].config.env
    return table(env, planned.settings, planned.seeds, planned.block, kept.rows())
