"""Trains all runs of a study that are missing in its store, and reports the progress."""

import os
import time
from collections.abc import Callable
from concurrent.futures import Executor
from contextlib import closing, suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, TypeVar

from qtab._utils.attach import attach
from qtab._utils.progress import ProgressBar, check_progress
from qtab.sweeps.connection import store_path
from qtab.sweeps.environments import describe_environments
from qtab.sweeps.executors import ExecutorTraining
from qtab.sweeps.store import Store, finished_contents
from qtab.sweeps.store_format import Contents
from qtab.sweeps.study import Study
from qtab.sweeps.worker import Pace, claim_size, train_claim
from qtab.training.process_pool import process_pool
from qtab.training.train_many import thread_count

MAX_PENDING_CHUNKS = 64
"""The maximum number of chunks that an executor has at a time."""

T = TypeVar("T")


@dataclass(frozen=True)
class SweepProgress:
    """The progress of a sweep, passed to callbacks."""

    runs: int
    """The number of finished runs, including those found in the store."""
    total: int
    """The number of runs of the sweep."""
    new: int
    """The number of runs that any process has finished since this call began."""
    seconds: float
    """The wall-clock time since this call began."""


SweepCallback = Callable[[SweepProgress], Any]


def _reporter(
    total: int, finished: Callable[[], int], callback: SweepCallback | None, bar: ProgressBar
) -> Callable[[], None]:
    """Returns a function that moves the bar and calls the callback with the progress since now."""
    started, before = time.perf_counter(), finished()
    if before:
        bar.move_to(before)

    def report() -> None:
        runs, seconds = finished(), time.perf_counter() - started
        bar.move_to(runs)
        if callback is not None:
            callback(SweepProgress(runs, total, runs - before, seconds))

    return report


def run_study(
    study: Study,
    build: Callable[[Contents], T],
    store: "str | os.PathLike[str] | None",
    executor: Executor | None,
    threads: int | None,
    memory_limit: int | None,
    callback: SweepCallback | None,
    progress: bool | None,
) -> T:
    """Trains the runs of a study that are missing in its store, and returns the table of all runs.

    Args:
        study: The study.
        build: Returns the table for the contents of a store.
        store: The file, or None for a store in memory.
        executor: Trains the runs; None trains them here, or in worker processes if Python steps the environment.
        threads: The number of threads or processes without an executor; None means one per core.
        memory_limit: The most memory that a single run may take, in bytes; None means half of the machine's memory.
        callback: Receives the progress.
        progress: Whether to show a progress bar; None shows one on a terminal or in a notebook after a second.

    Raises:
        Exception: the errors of :func:`qtab.sweep`, with the table of the finished runs as the attribute ``run``.
    """
    workers = thread_count(threads)
    if executor is not None and not hasattr(executor, "submit"):
        raise TypeError(f"executor must have a method submit, as in concurrent.futures, got {executor!r}")
    if callback is not None and not callable(callback):
        raise TypeError(f"callback must be a function of the progress or None, got {callback!r}")
    check_progress(progress)
    path = None if store is None else store_path(store)
    study = replace(study, memory_limit=memory_limit)
    study.check_memory()
    stored = study.stored
    if path is not None:
        stored = replace(stored, environments=describe_environments(study.env, study.resolved))
        if (finished := finished_contents(path, stored)) is not None:
            return build(finished)
    with closing(Store(path, stored)) as opened, ProgressBar(study.runs, "run", progress, "sweep") as bar:
        try:
            report = _reporter(study.runs, opened.finished, callback, bar)
            if executor is not None:
                ExecutorTraining(study, opened, executor, report).run(MAX_PENDING_CHUNKS)
            elif all(resolved.is_native for resolved in study.resolved):
                _train_in_threads(study, opened, workers, report)
            elif opened.finished() < study.runs:
                with process_pool(workers) as processes:
                    ExecutorTraining(study, opened, processes, report, is_own=True).run(2 * workers)
            return build(opened.contents())
        except BaseException as error:
            with suppress(Exception):
                attach(error, run=build(opened.contents()))
            raise


def _train_in_threads(study: Study, store: Store, threads: int, report: Callable[[], None]) -> None:
    pace = Pace()
    while (claim := store.claim(partial(claim_size, study, pace, threads))) is not None:
        train_claim(study, store, claim, threads, pace)
        report()
