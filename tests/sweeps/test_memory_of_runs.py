"""Each run of a sweep honours ``memory_limit``, by itself: on threads, in worker processes and with an executor."""

from concurrent.futures import Executor, Future
from typing import Any

import gymnasium as gym
import pytest

import qtab
from support.sweeps import assert_equal

GRID = {"algorithm": ["q_learning", "monte_carlo"]}
"""Monte Carlo stores its episodes, Q-learning nothing."""
SHORT: dict[str, Any] = {"seeds": 4, "episodes": 3, "progress": False, "discretizer": "bins", "bins": 4}
LIMIT = 20_000
"""Enough for the tables and the arrays, and for half an episode of 10,000 steps."""


class Here:
    """An executor in this process."""

    def submit(self, function: Any, *arguments: Any) -> Any:
        future: Any = Future()
        future.set_result(function(*arguments))
        return future


def make_car() -> gym.Env[Any, Any]:
    return gym.make("MountainCar-v0", max_episode_steps=10_000)


def swept(env: Any = "MountainCar-v0", **arguments: Any) -> qtab.Sweep:
    if isinstance(env, str):
        arguments = {"max_episode_steps": 10_000, **arguments}
    return qtab.sweep(env, GRID, **SHORT, **arguments)


def check(table: qtab.Sweep) -> None:
    errors = table.columns["error"].tolist()
    assert errors[:4] == [None] * 4
    assert all(error.startswith("MemoryError: ") and f"memory_limit={LIMIT} " in error for error in errors[4:])


@pytest.mark.parametrize("threads", [1, 3])
def test_runs_on_threads_fail_beyond_the_limit(threads: int) -> None:
    check(swept(memory_limit=LIMIT, threads=threads))


@pytest.mark.parametrize("backend", ["rust", pytest.param("gymnasium", marks=pytest.mark.slow)])
def test_runs_of_an_executor_fail_beyond_the_limit(backend: str) -> None:
    executor: Executor = Here()  # type: ignore[assignment]
    check(swept(memory_limit=LIMIT, executor=executor, backend=backend))


@pytest.mark.slow
def test_runs_in_worker_processes_fail_beyond_the_limit() -> None:
    check(swept(make_car, memory_limit=LIMIT, threads=2, backend="gymnasium"))


def test_the_limit_holds_for_each_run_and_not_for_all_at_the_same_time() -> None:
    """A limit that is enough for one run is enough on any number of threads."""
    alone = swept(memory_limit=200_000, threads=1)  # an episode of 10,000 steps takes more than 150,000 bytes
    assert alone.failed == 0
    assert_equal(swept(memory_limit=200_000, threads=4), alone)
