"""Stores that processes share: claims that are lost, processes that are killed, locks, and files that vanish."""

import contextlib
import logging
import os
import signal
import socket
import sqlite3
import subprocess
import sys
import time
from typing import Any

import pytest

import qtab
from qtab.sweeps import claims, connection, training, waiting
from qtab.sweeps import store as stores
from qtab.sweeps.study import plan_study
from support.sweeps import CAR, GRID, SMALL, assert_equal

OWN = f"{socket.gethostname()}/{os.getpid()}/x"


def a_dead_process() -> int:
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    return ended.pid


def claim_all(path: Any, owner: object, heartbeat: object) -> None:
    """Creates the store of a sweep, all of whose runs are claimed."""
    planned = plan_study(CAR, GRID, SMALL["seeds"], 100, {"episodes": SMALL["episodes"]})
    stores.Store(path, planned.description).close()
    with contextlib.closing(sqlite3.connect(path)) as opened:
        values = (planned.runs, owner, heartbeat)
        opened.execute("INSERT INTO chunks (start, stop, owner, heartbeat) VALUES (0, ?, ?, ?)", values)
        opened.commit()


@pytest.fixture
def no_sleep(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Time passes without waiting: a sleep moves the clock that the watch of claims reads."""
    slept: list[float] = []
    now = time.monotonic
    for module in (training, claims, waiting):
        monkeypatch.setattr(module, "time", _Clock(slept, now))
    return slept


class _Clock:
    perf_counter = staticmethod(time.perf_counter)
    time = staticmethod(time.time)

    def __init__(self, slept: list[float], now: Any) -> None:
        self._slept, self._now = slept, now

    def sleep(self, seconds: float) -> None:
        self._slept.append(seconds)

    def monotonic(self) -> float:
        return float(self._now() + sum(self._slept))


@pytest.mark.parametrize(
    ("owner", "heartbeat"),
    [
        (None, None),
        ("nobody", 1e12),
        ("a/b/c", 1e12),
        (f"{socket.gethostname()}/99999999999999999999/x", 1e12),
        (f"{socket.gethostname()}/0/x", 1e12),
        (b"\xff", 1e12),
        (OWN, None),
        (OWN, "soon"),
        (OWN, b"\x00"),
        (OWN, 0.0),
        ("elsewhere/1/x", 0.0),
    ],
    ids=map(str, range(11)),  # the owners hold process numbers, which differ from one test process to the next
)
def test_a_claim_of_no_living_process_is_taken_over_at_once(tmp_path, no_sleep, owner, heartbeat):
    path = tmp_path / "study.db"
    claim_all(path, owner, heartbeat)
    assert_equal(qtab.sweep(CAR, GRID, store=path, **SMALL), qtab.sweep(CAR, GRID, **SMALL))
    assert no_sleep == []


def test_the_claim_of_a_dead_process_is_taken_over_at_once(tmp_path, no_sleep):
    path = tmp_path / "study.db"
    claim_all(path, f"{socket.gethostname()}/{a_dead_process()}/x", time.time())
    assert len(qtab.sweep(CAR, GRID, store=path, **SMALL)) == 30
    assert no_sleep == []


@pytest.mark.parametrize("heartbeat", [1e300, float("inf"), "now"])
def test_a_claim_without_a_new_heartbeat_expires_by_this_clock_and_the_wait_is_logged(
    tmp_path, no_sleep, caplog, heartbeat
):
    path = tmp_path / "study.db"
    claim_all(path, "elsewhere/7/x", time.time() if heartbeat == "now" else heartbeat)
    with caplog.at_level(logging.WARNING, logger="qtab"):
        assert len(qtab.sweep(CAR, GRID, store=path, **SMALL)) == 30
    assert claims.CLAIM_EXPIRY_SECONDS <= sum(no_sleep) < claims.CLAIM_EXPIRY_SECONDS + 5
    assert caplog.messages[0].startswith("waiting for runs of store")
    assert caplog.messages[0].endswith("that are being trained: 30 by process 7 on elsewhere")
    assert len(caplog.messages) == 1


def test_a_claim_with_heartbeats_is_taken_over_in_the_end(tmp_path, no_sleep, monkeypatch):
    path = tmp_path / "study.db"
    claim_all(path, OWN, time.time())
    monkeypatch.setattr(claims, "MAX_CLAIM_SECONDS", 90.0)
    is_lost = claims.ClaimWatch.is_lost
    beats = iter(range(10**9))
    # The owner lives and beats, but never stores a result.
    monkeypatch.setattr(
        claims.ClaimWatch,
        "is_lost",
        lambda self, start, stop, owner, _: is_lost(self, start, stop, owner, time.time() + next(beats)),
    )
    assert len(qtab.sweep(CAR, GRID, store=path, **SMALL)) == 30
    assert 80 <= sum(no_sleep) < 95


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="other systems cannot ask whether a process runs")
def test_the_survivor_of_two_processes_resumes_in_seconds(tmp_path, no_sleep):
    path = tmp_path / "study.db"
    planned = plan_study(CAR, GRID, SMALL["seeds"], 100, {"episodes": SMALL["episodes"]})
    script = (
        "import sys, time; from qtab.sweeps.store import Store; from qtab.sweeps.study import plan_study\n"
        f"store = Store(sys.argv[1], plan_study('{CAR}', {GRID}, 5, 100, {{'episodes': 40}}).description)\n"
        "print(store.claim(lambda start: 7), flush=True); time.sleep(600)\n"
    )
    holder = subprocess.Popen([sys.executable, "-c", script, str(path)], stdout=subprocess.PIPE, text=True)
    assert holder.stdout is not None
    assert holder.stdout.readline() == "range(0, 7)\n"
    killed: list[int] = []

    # The other runs are finished then, and only those of the killed process are left.
    def kill(progress: qtab.SweepProgress) -> None:
        if progress.runs == planned.runs - 7 and not killed:
            killed.append(progress.runs)
            holder.send_signal(signal.SIGKILL)
            holder.communicate()

    study = qtab.sweep(CAR, GRID, store=path, callback=kill, **SMALL)
    assert killed
    assert sum(no_sleep) < 5
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
