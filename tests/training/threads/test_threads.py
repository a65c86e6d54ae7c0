"""Runs in concurrent threads equal those that run separately."""

import sys
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier, Event, Thread

import gymnasium as gym
import pytest

import qtab
from qtab import _core
from qtab.training.setup.resolve import resolve
from support.parity import assert_same_run

SETTINGS = {
    "rust": {"episodes": 1500},
    "gymnasium": {"episodes": 15, "backend": "gymnasium"},
    "MT19937": {"episodes": 1500, "bit_generator": "MT19937"},
}


@pytest.mark.parametrize("settings", SETTINGS.values(), ids=SETTINGS)
def test_concurrent_runs_equal_sequential_ones(settings):
    together = Barrier(2)

    def train(seed):
        together.wait()
        return qtab.train("MountainCar-v0", seed=seed, **settings)

    with ThreadPoolExecutor(2) as threads:
        at_once = list(threads.map(train, [1, 2]))
    for seed, run in zip([1, 2], at_once, strict=True):
        assert_same_run(run, qtab.train("MountainCar-v0", seed=seed, **settings))


def test_concurrent_runs_in_rust_and_python_do_not_affect_each_other():
    with ThreadPoolExecutor(2) as threads:
        fast = threads.submit(qtab.train, "MountainCar-v0", seed=1, episodes=3000)
        slow = threads.submit(qtab.train, gym.make("MountainCar-v0"), backend="gymnasium", seed=1, episodes=20)
    assert_same_run(fast.result(), qtab.train("MountainCar-v0", seed=1, episodes=3000))
    assert_same_run(slow.result(), qtab.train("MountainCar-v0", seed=1, episodes=20))


@pytest.mark.parametrize("backend", ["rust", "gymnasium"])
def test_other_threads_run_while_a_table_is_filled(backend):
    resolved = resolve("MountainCar-v0", {"discretizer": "bins", "bins": 300, "seed": 0, "backend": backend})
    may_run, has_run = Event(), Event()

    def run() -> None:
        may_run.wait()
        has_run.set()

    thread = Thread(target=run)
    thread.start()
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1000.0)  # from now on this thread lets others run only where it releases the interpreter
    try:
        may_run.set()
        made = 0
        while not has_run.is_set() and made < 20_000:  # on a busy machine, the thread waits for a core
            _core.Trainer(resolved.spec(), resolved.seed)
            made += 1
        assert has_run.is_set()
    finally:
        sys.setswitchinterval(interval)
        thread.join()
        resolved.close()


def test_an_exception_in_a_thread_stays_in_that_thread():
    def stop(progress):
        raise RuntimeError("mine")

    with ThreadPoolExecutor(2) as threads:
        failing = threads.submit(qtab.train, "MountainCar-v0", seed=1, episodes=200, callback=stop)
        fine = threads.submit(qtab.train, "MountainCar-v0", seed=2, episodes=200)
    assert isinstance(failing.exception(), RuntimeError)
    assert_same_run(fine.result(), qtab.train("MountainCar-v0", seed=2, episodes=200))
