"""Stores that processes share: each run is stored once, whoever trains it, whoever dies, whatever the clocks say."""

import contextlib
import logging
import os
import signal
import socket
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from qtab.sweeps import connection
from qtab.sweeps import store as stores
from qtab.sweeps.run_records import RunRecord
from qtab.sweeps.store import Store
from qtab.sweeps.study import plan_study
from support.sweeps import CAR, GRID, SMALL, assert_equal

PLANNED = plan_study(CAR, GRID, SMALL["seeds"], 100, {"episodes": SMALL["episodes"]})


@contextlib.contextmanager
def opened(path: Path | None, workers: int) -> Iterator[list[Store]]:
    """The same store in several workers, all of which have this process's number and host name."""
    with contextlib.ExitStack() as on_exit:
        yield [on_exit.enter_context(contextlib.closing(Store(path, PLANNED.stored))) for _ in range(workers)]


def results(runs: range) -> list[RunRecord]:
    """The same results in every worker."""
    return [RunRecord(PLANNED.seeds[run % len(PLANNED.seeds)], None, b"", f"RuntimeError: {run}") for run in runs]


def errors(store: Store) -> list[str]:
    return [run[-1] for run in store.contents().runs]


ALL = [f"RuntimeError: {run}" for run in range(PLANNED.runs)]


@pytest.mark.parametrize(
    ("owner", "heartbeat"),
    [
        (None, None),
        (b"\xff", b"\x00"),
        ("elsewhere/7/x", 1e300),
        ("elsewhere/7/x", float("-inf")),
        (f"{socket.gethostname()}/{os.getpid()}/x", "now"),  # as earlier versions write it
    ],
    ids=range(5),
)
@pytest.mark.parametrize("with_executor", [False, True])
def test_claims_that_others_left_behind_are_trained_without_waiting(
    tmp_path, monkeypatch, owner, heartbeat, with_executor
):
    path = tmp_path / "study.db"
    Store(path, PLANNED.stored).close()
    with contextlib.closing(sqlite3.connect(path)) as other:
        values = (PLANNED.runs, owner, time.time() if heartbeat == "now" else heartbeat)
        other.execute("INSERT INTO chunks (start, stop, owner, heartbeat) VALUES (0, ?, ?, ?)", values)
        other.commit()
    monkeypatch.setattr(time, "sleep", None)
    with ThreadPoolExecutor(1) as executor:
        study = qtab.sweep(CAR, GRID, store=path, executor=executor if with_executor else None, **SMALL)
    assert_equal(study, qtab.sweep(CAR, GRID, **SMALL))


def test_runs_of_others_come_last_those_claimed_the_longest_ago_first(tmp_path):
    with opened(tmp_path / "study.db", 3) as (one, two, idle):
        first = one.claim(lambda start: 10)
        second = two.claim(lambda start: 10)
        assert (first, second) == (range(10), range(10, 20))
        assert idle.claim(lambda start: 100) == range(20, 30)
        assert idle.claim(lambda start: 4) == range(4)
        assert two.claim(lambda start: 100) == range(4, 10)  # which nobody has claimed now
        assert idle.claim(lambda start: 100) == range(10, 20)
        assert idle.claim(lambda start: 100) == range(4, 10)
        assert idle.claim(lambda start: 100) is None


def test_results_that_another_worker_stored_meanwhile_are_kept_once_and_the_others_are_added(tmp_path):
    with opened(tmp_path / "study.db", 2) as (slow, quick):
        claim = slow.claim(lambda start: 30)
        assert claim == range(30)
        for runs in (range(3), range(7, 9)):
            quick._claims.append(runs)
            quick.commit(runs, results(runs), 1.0)
        slow.commit(claim, results(range(12)), 6.0)
        assert errors(slow) == ALL[:12]
        assert slow.contents().seconds == pytest.approx(1 + 1 + 6 * 7 / 12)
        assert quick.claim(lambda start: 100) == range(12, 30)
        late = slow.claim(lambda start: 100)
        assert late == range(12, 30)
        quick.commit(late, results(late), 1.0)
        slow.commit(late, results(late), 1.0)
        assert errors(quick) == ALL


def test_other_results_for_a_stored_run_are_logged_and_not_stored(tmp_path, caplog):
    with opened(tmp_path / "study.db", 2) as (slow, quick):
        claim = slow.claim(lambda start: 30)
        assert claim is not None
        quick.claim(lambda start: 30)
        quick.commit(claim, results(claim[:5]), 1.0)
        others = results(claim[:7])
        others[3] = RunRecord(others[3].seed, None, b"", "RuntimeError: another")
        with caplog.at_level(logging.WARNING, logger="qtab"):
            slow.commit(claim, others, 1.0)
        assert errors(slow) == ALL[:7]
    (message,) = caplog.messages
    assert message.startswith("the results of 1 of 7 runs trained here differ from those in store '")


class Worker:
    """A worker that takes several turns for a chunk, and may die in between."""

    def __init__(self, store: Store) -> None:
        self.store = store
        self.claim: range | None = None

    def turn(self, size: int, done: int) -> int:
        """Claims runs, or commits the first of those that it has claimed; returns how many were stored."""
        if self.claim is None:
            self.claim = self.store.claim(lambda start: size)
            return 0
        before = self.store.finished()
        trained = self.claim[: max(1, done)]
        is_news = not set(trained) <= {run[0] for run in self.store.contents().runs}
        self.store.commit(self.claim, results(trained), 1.0)
        self.claim = None
        stored = self.store.finished() - before
        assert (stored > 0) == is_news, "a result was refused"
        return stored


@pytest.mark.slow
@settings(max_examples=20, deadline=None)
@given(
    turns=st.lists(st.tuples(st.integers(0, 2), st.integers(1, 12), st.integers(1, 12)), max_size=40),
    clock=st.lists(st.sampled_from([0.0, 90.0, -90.0, 1e9, 5.0]), min_size=1, max_size=8),
    survivor=st.integers(0, 2),
)
def test_every_result_is_stored_once_whatever_the_order_the_clocks_and_the_deaths(turns, clock, survivor):
    times = iter(clock * 100)
    with pytest.MonkeyPatch.context() as patch, tempfile.TemporaryDirectory() as folder:
        patch.setattr(stores.time, "time", lambda: next(times))  # type: ignore[attr-defined]
        with opened(Path(folder) / "study.db", 3) as shared:
            workers = [Worker(store) for store in shared]
            for number, size, done in turns:
                workers[number].turn(size, done)
            # The others are dead, or take for ever, from now on; each chunk of the survivor is progress.
            left = workers[survivor]
            for _ in range(2 * PLANNED.runs + 2):
                left.turn(3, 2)
            assert errors(left.store) == ALL
            assert left.store.claim(lambda start: 1) is None
            for worker in workers:  # and those that were only slow
                if worker.claim is not None:
                    worker.turn(1, 5)
            assert errors(left.store) == ALL


def test_a_late_worker_finds_nothing_to_do(tmp_path, small_chunks):
    path = tmp_path / "study.db"
    slow = Store(path, PLANNED.stored)
    claim = slow.claim(lambda start: 3)
    assert claim == range(3)
    study = qtab.sweep(CAR, GRID, store=path, **SMALL)
    slow.commit(claim, results(claim), 1.0)
    assert slow.claim(lambda start: 3) is None
    slow.close()
    assert study.failed == qtab.load_sweep(path).failed == 0
    assert_equal(study, qtab.sweep(CAR, GRID, **SMALL))


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="stops a process")
@pytest.mark.parametrize("sent", ["SIGKILL", "SIGSTOP"])
def test_the_survivor_of_two_processes_does_not_wait(tmp_path, monkeypatch, sent):
    path = tmp_path / "study.db"
    script = (
        "import sys, time; from qtab.sweeps.store import Store; from qtab.sweeps.study import plan_study\n"
        f"store = Store(sys.argv[1], plan_study('{CAR}', {GRID}, 5, 100, {{'episodes': 40}}).stored)\n"
        "print(store.claim(lambda start: 7), flush=True); time.sleep(600)\n"
    )
    holder = subprocess.Popen([sys.executable, "-c", script, str(path)], stdout=subprocess.PIPE, text=True)
    try:
        assert holder.stdout is not None
        assert holder.stdout.readline() == "range(0, 7)\n"
        holder.send_signal(getattr(signal, sent))
        monkeypatch.setattr(time, "sleep", None)
        study = qtab.sweep(CAR, GRID, store=path, **SMALL)
    finally:
        holder.kill()
        holder.communicate()
    assert_equal(study, qtab.sweep(CAR, GRID, **SMALL))


def test_a_store_deleted_during_the_sweep_is_an_error_with_the_results(tmp_path, small_chunks):
    path = tmp_path / "study.db"

    def delete(progress: qtab.SweepProgress) -> None:
        if progress.runs > 10:
            path.unlink()

    with pytest.raises(FileNotFoundError, match=r"study.db' was deleted or replaced during the sweep") as caught:
        qtab.sweep(CAR, GRID, store=path, callback=delete, **SMALL)
    assert 10 < len(caught.value.run) < 30  # type: ignore[attr-defined]
    assert not path.exists()


def test_a_lock_of_another_process_is_waited_for_and_logged(tmp_path, monkeypatch, caplog):
    path = tmp_path / "study.db"
    qtab.sweep(CAR, GRID, store=path, **SMALL)
    monkeypatch.setattr(connection, "LOCK_TIMEOUT_SECONDS", 0.01)
    monkeypatch.setattr(connection, "BUSY_TIMEOUT_SECONDS", 0.1)
    with contextlib.closing(sqlite3.connect(path, isolation_level=None)) as other:
        other.execute("BEGIN IMMEDIATE")
        with caplog.at_level(logging.WARNING, logger="qtab"), pytest.raises(OSError, match="locked"):
            qtab.sweep(CAR, GRID, store=path, **SMALL)
    assert caplog.messages == [f"waiting for another process that is writing to store {str(path)!r}"]
