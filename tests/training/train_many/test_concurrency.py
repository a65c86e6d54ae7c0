"""train_many with threads, processes and interrupts."""

import multiprocessing
import os
import signal
import subprocess
import sys
import textwrap
import threading
from typing import Any

import pytest

import qtab
from support.environments import make_brittle
from support.parity import assert_same_as_single_runs, run_of
from support.processes.interrupts import in_a_process
from support.processes.posix import posix_only

CAR = "MountainCar-v0"
SHORT: dict[str, Any] = {"episodes": 30}


def _in_a_child(queue):
    queue.put(qtab.train_many(CAR, 4, threads=2, **SHORT).episode_returns)


@posix_only
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_train_many_works_after_a_fork():
    before = qtab.train_many(CAR, 4, threads=2, **SHORT).episode_returns
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    child = context.Process(target=_in_a_child, args=(queue,))
    child.start()
    after = queue.get(timeout=600)
    child.join(600)
    assert child.exitcode == 0
    assert before.tobytes() == after.tobytes()


@posix_only
def test_other_python_threads_run_during_train_many():
    # Only the other thread can end these runs, after a million iterations of a Python loop.
    done = in_a_process("""
def count_and_stop():
    turns = 0
    while turns < 1_000_000:
        turns += 1
    _thread.interrupt_main()
once_it_trains(count_and_stop)
del ENDLESS["seed"]
try:
    qtab.train_many("MountainCar-v0", 4, threads=2, **ENDLESS)
except KeyboardInterrupt as interrupt:
    print(interrupt.run.completed)
""")
    assert done.stdout.strip() == "False"


def test_threads_may_call_train_many_at_the_same_time():
    results = {}

    def work(name):
        results[name] = qtab.train_many(CAR, 6, threads=2, episodes=100).episode_returns.tobytes()

    workers = [threading.Thread(target=work, args=(name,)) for name in range(3)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len(set(results.values())) == 1
    assert len(results) == 3


def run_until_ready_then_interrupt(script):
    """Runs a script until it prints a line, interrupts it, and returns the words that it prints then."""
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(script)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    os.kill(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=600)
    assert process.returncode == 0, err
    return out.split()


@posix_only
def test_ctrl_c_keeps_the_finished_runs():
    # The first runs finish before the interrupt, the others do not.
    said = run_until_ready_then_interrupt(
        """
        import threading, time, qtab
        def ready():
            began = time.process_time()  # on a busy machine, nothing may be trained in a time by the clock
            while time.process_time() < began + 0.5:
                time.sleep(0.01)
            print("ready", flush=True)
        qtab.train_many("MountainCar-v0", 1, episodes=1)  # what takes time before the first run is behind it
        threading.Thread(target=ready, daemon=True).start()
        try:
            qtab.train_many("MountainCar-v0", 100_000, threads=2, episodes=200)
        except KeyboardInterrupt as error:
            runs = error.run
            assert error.runs is runs and not runs.completed
            single = qtab.train("MountainCar-v0", seed=runs.seeds[0], episodes=200)
            print(len(runs), len(runs.episode_returns), (runs.episode_returns[0] == single.episode_returns).all())
        """
    )
    assert 0 < int(said[0]) == int(said[1]) < 100_000
    assert said[2] == "True"


def test_runs_on_python_environments_use_processes_and_equal_single_runs():
    runs = qtab.train_many(CAR, [3, 5, 8], threads=2, tables=True, backend="gymnasium", episodes=3)
    assert_same_as_single_runs(runs, episodes=3, backend="gymnasium")
    assert runs.config.backend == "gymnasium"


def test_a_failing_process_is_reported_with_its_seed_and_keeps_the_finished_runs():
    with pytest.raises(RuntimeError, match="out of order") as caught:
        qtab.train_many(make_brittle, [0, 4, 2], threads=1, scale=(10, 100), episodes=2)
    assert run_of(caught.value).seeds == (0, 4)
    single = qtab.train(make_brittle(), seed=0, scale=(10, 100), episodes=2)
    assert run_of(caught.value).episode_returns[0].tobytes() == single.episode_returns.tobytes()


@posix_only
@pytest.mark.slow
@pytest.mark.parametrize(
    "settings", ["threads=2, episodes=50", "threads=1, max_episode_steps=10**12, env_kwargs={'goal_velocity': 1.0}"]
)
def test_ctrl_c_stops_the_processes_too(settings):
    said = run_until_ready_then_interrupt(
        f"""
        import multiprocessing, threading, time, qtab
        def ready():
            while not multiprocessing.active_children():
                time.sleep(0.05)
            time.sleep(1.2)
            print("ready", flush=True)
        if __name__ == "__main__":
            threading.Thread(target=ready, daemon=True).start()
            try:
                qtab.train_many("MountainCar-v0", 1000, backend="gymnasium", {settings})
            except KeyboardInterrupt as error:
                print(error.run.completed, multiprocessing.active_children() == [])
        """
    )
    assert said == ["False", "True"]
