"""Executors that lose their workers, cancel their work, or do not return it."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor, wait
from contextlib import contextmanager, nullcontext
from multiprocessing import get_context
from typing import Any

import pytest

import qtab
from qtab.sweeps import executors
from support.environments import make_brittle
from support.sweeps import CAR, GRID, SMALL, assert_equal


class Faulty(ThreadPoolExecutor):
    """Passes some of its tasks to a function that spoils them."""

    def __init__(self, spoil: Callable[[int, "Future[Any]"], Any]) -> None:
        super().__init__(1)
        self._spoil, self.submitted = spoil, 0
        self.passed: list[Future[Any]] = []

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> "Future[Any]":
        future: Future[Any] = Future()
        self.submitted += 1
        if self._spoil(self.submitted, future) is None:
            future = super().submit(fn, *args, **kwargs)
            self.passed.append(future)
        return future


def test_a_task_that_never_returns_is_trained_here(small_chunks, monkeypatch, caplog):
    monkeypatch.setattr(executors, "LATE_SECONDS", 0.0)
    with Faulty(lambda number, _: True if number in (2, 5) else None) as executor:
        study = qtab.sweep(CAR, GRID, executor=executor, **SMALL)
    assert_equal(study, qtab.sweep(CAR, GRID, **SMALL))
    assert sum("runs here, which the executor has not returned for" in text for text in caplog.messages) >= 2


def test_a_task_that_fails_is_submitted_again(small_chunks, caplog):
    def fail(number: int, future: "Future[Any]") -> Any:
        if number not in (2, 3, 7):
            return None
        future.set_exception(AttributeError("'float' object has no attribute 'with_traceback'"))
        return True

    with Faulty(fail) as executor:
        assert_equal(qtab.sweep(CAR, GRID, executor=executor, **SMALL), qtab.sweep(CAR, GRID, **SMALL))
    assert sum("submitting" in text for text in caplog.messages) == 3


def test_a_task_that_fails_every_time_ends_the_sweep(small_chunks, tmp_path):
    def fail(number: int, future: "Future[Any]") -> Any:
        if number < 4:
            return None
        wait(executor.passed)  # so that there are runs to keep
        future.set_exception(ModuleNotFoundError("No module named 'lake'"))
        return True

    path = tmp_path / "study.db"
    message = (
        r"the executor failed: ModuleNotFoundError: No module named 'lake'; run the same call again: \d+ of 30 runs"
    )
    with Faulty(fail) as executor, pytest.raises(RuntimeError, match=message) as caught:
        qtab.sweep(CAR, GRID, executor=executor, store=path, **SMALL)
    found = len(qtab.load_sweep(path))
    assert f"{found} of 30 runs are kept in store {str(path)!r}" in str(caught.value)
    assert len(caught.value.run) == found > 0  # type: ignore[attr-defined]
    assert_equal(qtab.sweep(CAR, GRID, store=path, **SMALL), qtab.sweep(CAR, GRID, **SMALL))


def test_an_executor_that_cancels_its_work_says_how_to_resume(small_chunks):
    def cancel(number: int, future: "Future[Any]") -> Any:
        return None if number < 4 else future.cancel() and future.set_running_or_notify_cancel() is False

    message = (
        r"the executor cancelled its work; was it, its client or its scheduler closed\? \d+ of 30 runs are kept as"
    )
    with Faulty(cancel) as executor, pytest.raises(RuntimeError, match=message) as caught:
        qtab.sweep(CAR, GRID, executor=executor, **SMALL)
    assert f"{len(caught.value.run)} of 30" in str(caught.value)  # type: ignore[attr-defined]


def test_a_closed_executor_says_how_to_resume():
    executor = ThreadPoolExecutor(1)
    executor.shutdown()
    with pytest.raises(RuntimeError, match="the executor failed: RuntimeError: cannot schedule new futures after"):
        qtab.sweep(CAR, GRID, executor=executor, **SMALL)


class Blocked(ProcessPoolExecutor):
    """Has one worker, which waits before the fifth task, so that some tasks are always left."""

    def __init__(self) -> None:
        super().__init__(1, get_context("spawn"))
        self.submitted = 0

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> "Future[Any]":
        self.submitted += 1
        if self.submitted == 5:
            super().submit(time.sleep, 600)
        return super().submit(fn, *args, **kwargs)


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="kills a process")
def test_a_killed_worker_of_a_process_pool_says_how_to_resume(small_chunks, tmp_path):
    path = tmp_path / "study.db"
    with Blocked() as executor:
        worker = executor.submit(os.getpid).result()
        killed: list[int] = []

        def kill(progress: qtab.SweepProgress) -> None:
            if not killed:
                os.kill(worker, signal.SIGKILL)
                killed.append(worker)

        message = r"the executor failed: BrokenProcessPool: .*; run the same call again: \d+ of 30 runs are kept in"
        with pytest.raises(RuntimeError, match=message):
            qtab.sweep(CAR, GRID, executor=executor, store=path, callback=kill, **SMALL)
    assert_equal(qtab.sweep(CAR, GRID, store=path, **SMALL), qtab.sweep(CAR, GRID, **SMALL))


def die() -> Any:
    """Makes an environment, except in a worker process, which it ends."""
    from multiprocessing import parent_process

    if parent_process() is not None:
        os.kill(os.getpid(), signal.SIGKILL)
    return make_brittle()


def die_with_a_lock() -> Any:
    """Does the same, but dies as soon as it holds a lock that processes share, if it takes one within a second."""
    from multiprocessing import parent_process, synchronize

    take = synchronize.SemLock.__enter__

    def take_and_die(lock: Any) -> Any:
        take(lock)
        return die()

    if parent_process() is not None:
        synchronize.SemLock.__enter__ = take_and_die  # type: ignore[method-assign]
        time.sleep(1.0)
    return die()


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="kills a process")
@pytest.mark.parametrize("die", [die, die_with_a_lock])
def test_a_killed_worker_of_this_package_is_said_to_be_killed(tmp_path, die):
    message = r"a worker process ended abruptly \(killed, or out of memory\).*0 of 4 runs are kept in store"
    with pytest.raises(RuntimeError, match=message):
        qtab.sweep(
            die, {"learning_rate": [0.1, 0.2]}, 2, episodes=2, scale=(10, 100), threads=1, store=tmp_path / "s.db"
        )


@contextmanager
def busy_cores() -> Iterator[None]:
    """A busy process for every core."""
    processes = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(os.cpu_count() or 1)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="stops a process")
@pytest.mark.filterwarnings("ignore")  # distributed warns
@pytest.mark.parametrize(("sent", "load"), [("SIGKILL", busy_cores), ("SIGSTOP", nullcontext)])
def test_dask_without_one_of_its_workers_gives_the_same_table(tmp_path, small_chunks, monkeypatch, sent, load):
    import dask
    from distributed import Client, LocalCluster

    monkeypatch.setattr(executors, "LATE_SECONDS", 2.0)
    monkeypatch.setattr(executors, "LATE_FACTOR", 0.0)
    lost: list[int] = []
    # Dask tries for so long to fetch what the lost worker had finished.
    patient = {"distributed.comm.timeouts.connect": "600s", "distributed.comm.timeouts.tcp": "600s"}
    with dask.config.set(patient), LocalCluster(2, threads_per_worker=1, dashboard_address=None) as cluster, load():
        with Client(cluster) as client:
            worker, _ = client.run(os.getpid).values()

            def lose(progress: qtab.SweepProgress) -> None:
                if not lost:
                    os.kill(worker, getattr(signal, sent))
                    lost.append(progress.runs)

            study = qtab.sweep(CAR, GRID, executor=client.get_executor(), callback=lose, **SMALL)
        if sent == "SIGSTOP":
            os.kill(worker, signal.SIGKILL)  # it would not end with its cluster
    assert 0 < lost[0] < 30
    assert_equal(study, qtab.sweep(CAR, GRID, **SMALL))
