"""``qtab.sweep``: the training of many settings with many seeds each."""

import os
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor, Future, wait
from contextlib import closing
from dataclasses import dataclass
from typing import Any

import cloudpickle
from gymnasium.envs.registration import EnvSpec
from typing_extensions import Unpack

from qtab._utils import checks, memory
from qtab.config import Config
from qtab.config.layers import collect
from qtab.config.settings import SharedSettings
from qtab.config.signature import with_settings
from qtab.envs.registry import spec_of
from qtab.sweeps.results import Sweep, build_sweep
from qtab.sweeps.store import Store
from qtab.sweeps.study import Chunk, Study, plan_study
from qtab.sweeps.worker import train_chunk, train_setting
from qtab.training.process_pool import process_pool
from qtab.training.resolve import log_default_limit
from qtab.training.train_many import MakeEnv, thread_count

BLOCK = 100
MAX_PENDING_CHUNKS = 64
"""The maximum number of chunks that an executor is given at a time."""
POLL_SECONDS = 0.5
"""The time between two attempts to claim a chunk while other processes hold all of them."""


@dataclass(frozen=True)
class SweepProgress:
    """The progress of a sweep, as a callback receives it."""

    runs: int
    """The number of finished runs, including those found in the store."""
    total: int
    """The number of runs of the sweep."""
    new: int
    """The number of runs finished since this call began, by any process."""
    seconds: float
    """The wall-clock time since this call began."""


@with_settings
def sweep(
    env: str | EnvSpec | MakeEnv | None,
    grid: Mapping[str, Sequence[Any]] | Sequence[Mapping[str, Any]],
    seeds: int | Iterable[int] = 100,
    *,
    config: Config | Mapping[str, Any] | None = None,
    store: "str | os.PathLike[str] | None" = None,
    executor: Executor | None = None,
    threads: int | None = None,
    memory_limit: int | None = None,
    block: int = BLOCK,
    callback: Callable[[SweepProgress], None] | None = None,
    **settings: Unpack[SharedSettings],
) -> Sweep:
    """Trains every setting of a grid with the same seeds.

    With a ``store`` an interrupted sweep resumes when it is called again.

    Args:
        env: An environment's id, its EnvSpec, or a function that creates one. None takes that of ``config``.
        grid: Lists of values by name, to train every combination of them; or a list of settings, such as
            :func:`qtab.designs.sobol` returns. The names are those of settings.
        seeds: The seeds of every setting; an integer N means 0 to N - 1.
        config: The settings to start from, as for :func:`qtab.train`, without the seed.
        store: An SQLite file for the results, which several processes may share. None keeps the results in memory.
        executor: Trains the runs: any :class:`concurrent.futures.Executor`, such as Dask's ``client.get_executor()``.
            None trains on threads of this process, or in worker processes if Python steps the environment.
        threads: The number of threads or processes without an executor; None means one per core.
        memory_limit: The most memory that a single run may need, in bytes; None means half of the machine's memory.
        block: The number of episodes that each point of a stored learning curve averages.
        callback: Called with a :class:`SweepProgress` after each chunk of runs, which takes one core about a second.
        **settings: The settings that all runs share, explained below.

    Returns:
        A table with one row per run. A run that failed has its error in the column ``error``.

    Raises:
        gymnasium.error.Error: from Gymnasium, for an unknown id.
        MemoryError: if a run would need more than ``memory_limit``, before any training.
        OSError: if the store cannot be written.
        StoreError: if the store is damaged, has another format version, or belongs to another sweep.
        TypeError: for an argument of the wrong type, or an unknown setting.
        ValueError: for an argument out of range.
        KeyboardInterrupt: on Ctrl-C; its attribute ``run`` is the table of the finished runs.
    """
    block = checks.integer("block", block, least=1)
    workers = thread_count(threads)
    if executor is not None and not hasattr(executor, "submit"):
        raise TypeError(f"executor must have a method submit, as in concurrent.futures, got {executor!r}")
    env, base = collect(sweep, env, config, settings)
    if isinstance(env, str):
        env = spec_of(env)  # a worker process may not have imported the package that registers the id
    study = plan_study(env, grid, seeds, block, settings, base)
    for resolved in study.resolved:
        log_default_limit(resolved)
    study.check_memory(memory.memory_limit(memory_limit))
    with closing(Store(store, study)) as opened_store:
        report_progress = _ProgressReporter(study, opened_store, callback)
        try:
            if executor is not None:
                _train_with_executor(study, opened_store, executor, report_progress)
            elif all(resolved.is_native for resolved in study.resolved):
                _train_in_threads(study, opened_store, workers, report_progress)
            else:
                with process_pool(workers) as processes:
                    _train_with_executor(study, opened_store, processes, report_progress, max_pending=2 * workers)
        except KeyboardInterrupt as error:
            error.run = _table(study, opened_store)  # type: ignore[attr-defined]
            raise
        return _table(study, opened_store)


class _ProgressReporter:
    """Calls the callback with the progress since the reporter was created."""

    def __init__(self, study: Study, store: Store, callback: Callable[[SweepProgress], None] | None) -> None:
        self._total, self._store, self._callback = study.runs, store, callback
        self._started = time.perf_counter()
        self._already_finished = store.finished()[1]

    def __call__(self) -> None:
        if self._callback is not None:
            runs = self._store.finished()[1]
            seconds = time.perf_counter() - self._started
            self._callback(SweepProgress(runs, self._total, runs - self._already_finished, seconds))


def _train_in_threads(study: Study, store: Store, threads: int, report_progress: _ProgressReporter) -> None:
    while not _is_finished(study, store):
        number = store.claim()
        if number is None:
            time.sleep(POLL_SECONDS)
            continue
        chunk = study.chunks[number]
        records = []
        for setting, seeds in study.split(chunk):
            resolved = study.resolved[setting]
            records += train_setting(study.env, study.overrides[setting], resolved, seeds, study.block, threads)
        store.commit(chunk, records)
        report_progress()


def _train_with_executor(
    study: Study,
    store: Store,
    executor: Executor,
    report_progress: _ProgressReporter,
    max_pending: int = MAX_PENDING_CHUNKS,
) -> None:
    pending: dict[Future[Any], Chunk] = {}
    try:
        while pending or not _is_finished(study, store):
            while len(pending) < max_pending and (number := store.claim()) is not None:
                chunk = study.chunks[number]
                pending[executor.submit(train_chunk, _task(study, chunk))] = chunk
            if not pending:
                time.sleep(POLL_SECONDS)
                continue
            done, _ = wait(pending, timeout=POLL_SECONDS, return_when="FIRST_COMPLETED")
            for future in done:
                store.commit(pending.pop(future), future.result())
                report_progress()
    finally:
        for future in pending:
            future.cancel()


def _is_finished(study: Study, store: Store) -> bool:
    return store.finished()[0] == len(study.chunks)


def _task(study: Study, chunk: Chunk) -> bytes:
    parts = [(study.overrides[setting], seeds) for setting, seeds in study.split(chunk)]
    task: bytes = cloudpickle.dumps((study.env, parts, study.block))
    return task


def _table(study: Study, store: Store) -> Sweep:
    env = study.resolved[0].config.env
    return build_sweep(env, study.settings, study.seeds, study.block, store.runs())
