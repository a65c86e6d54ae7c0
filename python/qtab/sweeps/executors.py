"""Trains a study with a :class:`concurrent.futures.Executor`, which may lose its workers."""

import logging
import time
from collections import Counter
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, wait
from dataclasses import dataclass
from functools import partial
from typing import Any

import cloudpickle

from qtab.sweeps.connection import name_of
from qtab.sweeps.store import Store
from qtab.sweeps.study import Study
from qtab.sweeps.worker import Pace, claim_size, train_chunk, train_claim

POLL_SECONDS = 0.5
"""The time between two checks for results of the executor."""
NOTICE_SECONDS = 2.0
"""The time to wait for the executor before the wait is logged."""
NEXT_NOTICE_SECONDS = 60.0
"""The time after which the wait is logged again."""
LATE_SECONDS = 10.0
"""A chunk that takes longer than this may be late."""
LATE_FACTOR = 10.0
"""A chunk is late if it takes this many times longer than the slowest chunk that returned."""
MAX_ATTEMPTS = 3
"""The number of failures of a chunk's task after which the sweep gives up."""

_LOGGER = logging.getLogger("qtab")


@dataclass(frozen=True)
class _Submitted:
    claim: range
    at: float
    """The time of the submission, on this process's monotonic clock."""


class ExecutorTraining:
    """Submits chunks to an executor, and stores the results."""

    def __init__(
        self, study: Study, store: Store, executor: Executor, report: Callable[[], None], is_own: bool = False
    ) -> None:
        self._study, self._store, self._executor, self._report = study, store, executor, report
        self._is_own = is_own
        """Whether the executor is a process pool of this package, for messages."""
        self._pace = Pace()
        self._next_notice = time.monotonic() + NOTICE_SECONDS
        """The time at which to log the wait for the executor, on this process's monotonic clock."""
        self._pending: dict[Future[Any], _Submitted] = {}
        self._poll_seconds = POLL_SECONDS
        self._failures: Counter[int] = Counter()
        """The number of failures of each task, by its first run."""
        self._slowest: float | None = None
        """The longest time after which a chunk returned, in seconds."""

    def run(self, max_pending: int) -> None:
        """Trains the runs missing in the store; the executor has at most ``max_pending`` chunks at a time.

        Raises:
            RuntimeError: if the executor fails; the message explains how to resume.
        """
        try:
            while self._store.finished() < self._study.runs:
                all_claimed = self._submit(max_pending)
                if self._collect():
                    self._next_notice = time.monotonic() + NOTICE_SECONDS
                elif not (all_claimed and self._train_late_chunk()):
                    self._log_wait()
        finally:
            for future in self._pending:
                future.cancel()

    def _submit(self, max_pending: int) -> bool:
        """Submits chunks; returns whether all runs that are not stored have been submitted."""
        while len(self._pending) < max_pending:
            claim = self._store.claim(partial(claim_size, self._study, self._pace, 1))
            if claim is None:
                return True
            try:
                future = self._executor.submit(train_chunk, self._task(claim))
            except Exception as error:
                raise self._lost(error) from error
            self._pending[future] = _Submitted(claim, time.monotonic())
        return False

    def _task(self, claim: range) -> bytes:
        study = self._study
        parts = [(setting, study.overrides[setting], seeds) for setting, seeds in study.split(claim)]
        task: bytes = cloudpickle.dumps((study.env, parts, study.block, study.memory_limit, self._pace))
        return task

    def _collect(self) -> bool:
        """Stores the chunks that return within the poll time; returns whether there were any."""
        timeout, self._poll_seconds = self._poll_seconds, POLL_SECONDS
        done, _ = wait(self._pending, timeout=timeout, return_when="FIRST_COMPLETED")
        for future in sorted(done, key=_has_failed):  # store results before an error ends the sweep
            submitted = self._pending[future]
            try:
                records, seconds, self._pace, versions = future.result()
            except (BrokenExecutor, CancelledError) as error:
                raise self._lost(error) from error
            except Exception as error:
                self._try_again(submitted.claim, error)
                del self._pending[future]
                continue
            del self._pending[future]
            self._slowest = max(self._slowest or 0.0, time.monotonic() - submitted.at)
            self._store.commit(submitted.claim, records, seconds, versions)
            self._report()
        return bool(done)

    def _try_again(self, claim: range, error: Exception) -> None:
        """Releases the runs of a failed task, so that they are submitted again, unless the task has failed too often.

        The errors of runs are results. An error of a task comes from the executor: Dask, for example, confuses a result
        with an error if the worker that sent it is killed at that moment.
        """
        self._failures[claim.start] += 1
        if self._failures[claim.start] >= MAX_ATTEMPTS:
            raise self._lost(error) from error
        _LOGGER.warning(
            "submitting %d runs again: the executor failed with %s: %s", len(claim), type(error).__name__, error
        )
        self._store.release(claim)

    def _train_late_chunk(self) -> bool:
        """Trains a late chunk in this process; returns whether there was one.

        Dask, for example, tries for 30 seconds to fetch a result from a worker that was killed after it finished, and
        for minutes from one that was stopped.
        """
        if self._slowest is None or not self._pending:
            return False  # the executor may still wait for its first worker, or another process has stored the rest
        limit = max(LATE_SECONDS, LATE_FACTOR * self._slowest)
        future, submitted = min(self._pending.items(), key=lambda pair: pair[1].at)
        late = time.monotonic() - submitted.at
        if late < limit:
            return False
        claim = submitted.claim
        _LOGGER.warning("training %d runs here, which the executor has not returned for %.0f s", len(claim), late)
        del self._pending[future]
        future.cancel()
        train_claim(self._study, self._store, claim, 1, self._pace)
        self._report()
        self._poll_seconds = 0.0  # the next chunk may be late, too
        return True

    def _log_wait(self) -> None:
        """Logs the wait for the executor, if a notice is due."""
        now = time.monotonic()
        if now >= self._next_notice:
            self._next_notice = now + NEXT_NOTICE_SECONDS
            runs = sum(len(submitted.claim) for submitted in self._pending.values())
            _LOGGER.warning("waiting for %s runs that the executor has in %d tasks", f"{runs:,}", len(self._pending))

    def _lost(self, error: BaseException) -> RuntimeError:
        """Returns the error to raise if the executor fails; its message explains how to resume."""
        finished = self._store.finished()
        if isinstance(error, CancelledError):
            message = "the executor cancelled its work; was it, its client or its scheduler closed? "
        else:
            own = "a worker process ended abruptly (killed, or out of memory)"
            reason = " ".join(str(error).split())
            message = f"{own if self._is_own else 'the executor failed'}: {type(error).__name__}"
            message += f": {reason}; " if reason else "; "
        if self._is_own and not finished:
            message += "a script must keep its call behind if __name__ == '__main__'; "
        kept = f"{finished:,} of {self._study.runs:,} runs are kept"
        if self._store.path is None:
            return RuntimeError(f"{message}{kept} as .run of this error; with store= the same call could resume")
        return RuntimeError(f"{message}run the same call again: {kept} in {name_of(self._store.path)}")


def _has_failed(future: Future[Any]) -> bool:
    return future.cancelled() or future.exception() is not None
