"""The training of all runs of a study that its store does not have yet."""

import logging
import os
import time
from collections.abc import Callable
from concurrent.futures import CancelledError, Executor, Future, wait
from contextlib import closing, suppress
from functools import partial
from typing import Any, TypeVar

import cloudpickle

from qtab._utils import memory
from qtab.sweeps.connection import name_of
from qtab.sweeps.database import Contents
from qtab.sweeps.pace import CHUNK_SECONDS, MAX_CHUNK_RUNS, Pace
from qtab.sweeps.progress import Callback, ProgressReporter
from qtab.sweeps.store import Store
from qtab.sweeps.stored import finished_contents, store_path
from qtab.sweeps.study import Study
from qtab.sweeps.worker import train_chunk, train_parts
from qtab.training.process_pool import process_pool
from qtab.training.train_many import thread_count

MAX_PENDING_CHUNKS = 64
"""The maximum number of chunks that an executor is given at a time."""
POLL_SECONDS = 0.5
"""The time between two attempts to claim runs while other processes hold all of them."""
NOTICE_SECONDS = 2.0
"""How long to wait for other processes before it is logged."""
NEXT_NOTICE_SECONDS = 60.0
"""The time after which it is logged again."""

T = TypeVar("T")
_LOGGER = logging.getLogger("qtab")


def run_study(
    study: Study,
    build: Callable[[Contents], T],
    store: "str | os.PathLike[str] | None",
    executor: Executor | None,
    threads: int | None,
    memory_limit: int | None,
    callback: Callback | None,
) -> T:
    """Trains the runs of a study that its store does not have, and returns the table of all.

    Args:
        study: The study.
        build: Returns the table of what a store holds.
        store: The file, or None for a store in memory.
        executor: Trains the runs; None trains them here, or in worker processes if Python steps the environment.
        threads: The number of threads or processes without an executor; None means one per core.
        memory_limit: The most memory that a single run may need, in bytes; None means half of the machine's memory.
        callback: Receives the progress.

    Raises:
        Exception: the errors of :func:`qtab.sweep`. Its attribute ``run`` is the table of the finished runs.
    """
    workers = thread_count(threads)
    if executor is not None and not hasattr(executor, "submit"):
        raise TypeError(f"executor must have a method submit, as in concurrent.futures, got {executor!r}")
    if callback is not None and not callable(callback):
        raise TypeError(f"callback must be a function of the progress or None, got {callback!r}")
    path = None if store is None else store_path(store)
    study.check_memory(memory.memory_limit(memory_limit))
    if path is not None and (finished := finished_contents(path, study.description)) is not None:
        return build(finished)
    with closing(Store(path, study.description)) as opened:
        try:
            report = ProgressReporter(study.runs, opened.finished, callback)
            if executor is not None:
                _train_with_executor(study, opened, executor, report, MAX_PENDING_CHUNKS)
            elif all(resolved.is_native for resolved in study.resolved):
                _train_in_threads(study, opened, workers, report)
            elif opened.finished() < study.runs:
                with process_pool(workers) as processes:
                    _train_with_executor(study, opened, processes, report, 2 * workers, is_own=True)
            return build(opened.contents())
        except BaseException as error:
            with suppress(Exception):
                error.run = build(opened.contents())  # type: ignore[attr-defined]
            raise


class _Notice:
    """Logs what a sweep is waiting for, if it waits long."""

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Ends a wait."""
        self._next = time.monotonic() + NOTICE_SECONDS

    def __call__(self, describe: Callable[[], str]) -> None:
        now = time.monotonic()
        if now >= self._next:
            self._next = now + NEXT_NOTICE_SECONDS
            _LOGGER.warning("waiting for %s", describe())


def _train_in_threads(study: Study, store: Store, threads: int, report: Callable[[], None]) -> None:
    pace, notice = Pace(), _Notice()
    while store.finished() < study.runs:
        claim = store.claim(partial(_claim_size, study, pace, threads))
        if claim is None:
            notice(store.claimed_by_others)
            time.sleep(POLL_SECONDS)
            continue
        parts = [
            (setting, study.overrides[setting], study.resolved[setting], seeds) for setting, seeds in study.split(claim)
        ]
        began = time.perf_counter()
        records = train_parts(study.env, parts, study.block, threads, pace)
        store.commit(claim, records, time.perf_counter() - began)
        notice.reset()
        report()


def _train_with_executor(
    study: Study,
    store: Store,
    executor: Executor,
    report: Callable[[], None],
    max_pending: int,
    is_own: bool = False,
) -> None:
    pace, notice = Pace(), _Notice()
    pending: dict[Future[Any], range] = {}
    try:
        while pending or store.finished() < study.runs:
            while len(pending) < max_pending:
                claim = store.claim(partial(_claim_size, study, pace, 1))
                if claim is None:
                    break
                task = _task(study, claim, pace)
                try:
                    pending[executor.submit(train_chunk, task)] = claim
                except Exception as error:
                    raise _lost_workers(error, study, store, is_own) from error
            if not pending:
                notice(store.claimed_by_others)
                time.sleep(POLL_SECONDS)
                continue
            done, _ = wait(pending, timeout=POLL_SECONDS, return_when="FIRST_COMPLETED")
            for future in done:
                try:
                    records, seconds, pace = future.result()
                except (Exception, CancelledError) as error:
                    raise _lost_workers(error, study, store, is_own) from error
                store.commit(pending.pop(future), records, seconds)
                notice.reset()
                report()
    finally:
        for future in pending:
            future.cancel()


def _claim_size(study: Study, pace: Pace, at_least: int, start: int) -> int:
    """Returns how many runs from an index are expected to take about a second; a few more do not matter."""
    count = len(study.seeds)
    size, left = 0, CHUNK_SECONDS
    while left > 0 and size < MAX_CHUNK_RUNS and start + size < study.runs:
        setting = (start + size) // count
        of_setting = (setting + 1) * count - start - size
        predicted = pace.runs(setting, study.resolved[setting], left, at_least)
        size += min(of_setting, predicted)
        if predicted <= of_setting:
            break
        left *= 1 - of_setting / predicted
    return min(size, MAX_CHUNK_RUNS)


def _task(study: Study, claim: range, pace: Pace) -> bytes:
    parts = [(setting, study.overrides[setting], seeds) for setting, seeds in study.split(claim)]
    task: bytes = cloudpickle.dumps((study.env, parts, study.block, pace))
    return task


def _lost_workers(error: BaseException, study: Study, store: Store, is_own: bool) -> RuntimeError:
    """Returns the error to raise where an executor fails, which tells how to resume."""
    finished = store.finished()
    what = "a worker process ended abruptly (killed, or out of memory)" if is_own else "the executor failed"
    reason = " ".join(str(error).split())
    detail = f"{type(error).__name__}: {reason}" if reason else type(error).__name__
    if isinstance(error, CancelledError):
        detail = "it cancelled its work; was it, its client or its scheduler closed?"
    message = f"{what}: {detail}; "
    if is_own and not finished:
        message += "where this is a script, it must keep its call behind if __name__ == '__main__'; "
    kept = f"{finished:,} of {study.runs:,} runs are kept"
    if store.path is None:
        return RuntimeError(f"{message}{kept} as .run of this error; with a store= the same call could resume")
    return RuntimeError(f"{message}run the same call again: {kept} in {name_of(store.path)}")
