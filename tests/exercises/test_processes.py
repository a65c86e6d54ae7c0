"""A student's process ends with the processes that it started, and does not confuse its answers."""

import json
import sys
import threading
import time
from pathlib import Path

import pytest

from qtab.exercises import grade
from qtab.exercises.classroom.grading import _answers
from qtab.exercises.classroom.processes import Processes

fcntl = pytest.importorskip("fcntl", reason="Windows has no process groups")

LEAVES_A_CHILD = """\
import fcntl, multiprocessing, pathlib, time
LOCK = pathlib.Path({path!r})
STARTED = []

def wait(pipe):
    file = LOCK.open("a")
    fcntl.flock(file, fcntl.LOCK_EX)
    pipe.send("locked")
    time.sleep(600)

def leave_a_child():
    if not STARTED:
        ours, theirs = multiprocessing.get_context("fork").Pipe()
        process = multiprocessing.get_context("fork").Process(target=wait, args=(theirs,))
        STARTED.append(process)
        process.start()
        ours.recv()
"""


def assert_dead(lock: Path) -> None:
    """Fails if a process still holds the lock."""
    with lock.open("a") as file:
        for _ in range(500):  # the kernel may need a moment to end a process
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                time.sleep(0.02)
            else:
                return
    pytest.fail("the child still runs")


def test_the_time_limit_ends_a_child_that_holds_the_output(tmp_path: Path) -> None:
    lock = tmp_path / "lock"
    code = LEAVES_A_CHILD.format(path=str(lock)) + "leave_a_child()\nprint('begun', flush=True)\nSTARTED[0].join()\n"
    limits = iter([1.0, 4.0, 16.0, 64.0, 256.0])  # seconds; on a busy machine it has not begun after the first
    while (output := Processes().output([sys.executable, "-c", code], next(limits))) != "begun\n":
        assert output == ""
        assert_dead(lock)
    assert_dead(lock)


def test_processes_can_be_stopped(tmp_path: Path) -> None:
    running, begun = Processes(), tmp_path / "begun"
    code = f"import pathlib, time\npathlib.Path({str(begun)!r}).touch()\ntime.sleep(600)"
    thread = threading.Thread(target=running.output, args=([sys.executable, "-c", code], 600.0))
    thread.start()
    while not begun.exists():
        time.sleep(0.01)
    running.stop()
    thread.join()
    assert running.output([sys.executable, "-c", "print(1)"], 600.0) == ""


def test_solutions_that_start_processes_are_graded(tmp_path: Path) -> None:
    (tmp_path / "class").mkdir()
    average = (
        "def sample_average(estimates, counts, action, reward):\n    {first}\n    counts[action] += 1\n"
        "    estimates[action] += 1 / counts[action] * (reward - estimates[action])\n"
    )
    child = LEAVES_A_CHILD.format(path=str(tmp_path / "lock")) + average.format(first="leave_a_child()")
    (tmp_path / "class" / "ada.py").write_text(child, encoding="utf-8")
    fork = "import os\nFORKED = []\n" + average.format(first="FORKED or FORKED.append(1) or os.fork()")
    (tmp_path / "class" / "bob.py").write_text(fork, encoding="utf-8")
    marks = grade(tmp_path / "class", ["sample_average", "epsilon_greedy"], processes=2)
    assert [[mark.passed for mark in marks.of(student)] for student in marks.students] == [[2, 0], [2, 0]]
    assert_dead(tmp_path / "lock")


def test_the_first_answer_of_each_exercise_counts() -> None:
    first, again = ({"exercise": "sarsa", "passed": count, "report": "R"} for count in (1, 2))
    lines = [json.dumps(first), "not JSON", "3", "{}", json.dumps(again), json.dumps(first)[:20]]
    assert _answers("\n".join(lines)) == {"sarsa": {"passed": 1, "report": "R"}}
