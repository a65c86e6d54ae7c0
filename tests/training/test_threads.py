"""Runs in concurrent threads equal those that run separately."""

from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import gymnasium as gym
import pytest

import qtab
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


def test_an_exception_in_a_thread_stays_in_that_thread():
    def stop(progress):
        raise RuntimeError("mine")

    with ThreadPoolExecutor(2) as threads:
        failing = threads.submit(qtab.train, "MountainCar-v0", seed=1, episodes=200, callback=stop)
        fine = threads.submit(qtab.train, "MountainCar-v0", seed=2, episodes=200)
    assert isinstance(failing.exception(), RuntimeError)
    assert_same_run(fine.result(), qtab.train("MountainCar-v0", seed=2, episodes=200))
