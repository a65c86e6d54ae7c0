"""Threads that train, step, read and save at once, in different objects and in the same ones.

They run with any interpreter; `.ci/run threads` runs them with a free-threaded one. What threads share, and what guards
it, is listed in the page on free threading.
"""

import sys
import sysconfig
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import chain
from pathlib import Path
from threading import Barrier
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab import _core
from qtab.envs.classic_control import MountainCarEnv
from support.parity import assert_same_run, state_bytes

THREADS = 4


@pytest.fixture(autouse=True)
def frequent_switches() -> Iterator[None]:
    """Where there is an interpreter's lock, threads pass it on as often as they can."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(before)


def at_once(call: Callable[[int], Any], threads: int = THREADS) -> list[Any]:
    """The results of a function in threads that start together; an exception is a result."""
    together = Barrier(threads)

    def task(number: int) -> Any:
        together.wait()
        try:
            return call(number)
        except Exception as error:
            return error

    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(task, range(threads)))


@pytest.mark.skipif(not sysconfig.get_config_var("Py_GIL_DISABLED"), reason="needs a free-threaded Python")
def test_the_extension_leaves_the_interpreters_lock_off():
    assert not sys._is_gil_enabled()  # type: ignore[attr-defined]


def test_threads_with_objects_of_their_own_compute_what_one_thread_computes(tmp_path: Path):
    def work(number: int) -> tuple[qtab.Run, bytes]:
        run = qtab.train("MountainCar-v0", seed=number, episodes=100)
        run.save(tmp_path / f"{number}.npz")
        env: Any = gym.make("qtab/CartPole-v1")
        env.action_space.seed(number)
        env.reset(seed=number)
        for _ in range(200):
            if env.step(env.action_space.sample())[2]:
                env.reset()
        return qtab.load(tmp_path / f"{number}.npz"), state_bytes(env)

    results = at_once(work)
    for number, (run, state) in enumerate(results):
        expected_run, expected_state = work(number)
        assert_same_run(run, expected_run)
        assert state == expected_state


def test_calls_of_train_many_at_once_compute_what_one_computes():
    def train(number: int) -> qtab.Runs:
        return qtab.train_many("MountainCar-v0", seeds=range(10 * number, 10 * number + 3), episodes=50, threads=2)

    for number, runs in enumerate(at_once(train)):
        assert runs.episode_returns.tobytes() == train(number).episode_returns.tobytes()


def test_one_run_is_saved_evaluated_and_asked_by_many_threads(tmp_path: Path):
    run = qtab.train("MountainCar-v0", preset="solved", seed=0, episodes=50)
    observations = np.array([[-0.5, 0.0], [0.3, 0.02]])

    def use(_: int) -> Any:
        for _ in range(5):
            run.save(tmp_path / "run.npz")
        return qtab.evaluate(run, seed=1, episodes=5).returns.tolist(), run.predict(observations)[0].tolist()

    assert at_once(use) == [use(0)] * THREADS
    assert_same_run(qtab.load(tmp_path / "run.npz"), run)
    assert [path.name for path in tmp_path.iterdir()] == ["run.npz"]


def test_only_one_thread_at_a_time_advances_a_trainer():
    from qtab.training.setup.resolve import resolve

    resolved = resolve("MountainCar-v0", {"seed": 0, "episodes": 2000})
    trainer = _core.Trainer(resolved.spec(), resolved.seed)
    errors = [error for error in at_once(lambda _: trainer.advance(2000)) if error is not None]
    assert all(isinstance(error, RuntimeError) and "busy in another thread" in str(error) for error in errors)
    trainer.advance(2000)
    expected = qtab.train("MountainCar-v0", seed=0, episodes=2000)
    assert trainer.episodes()[0].tobytes() == expected.episode_returns.tobytes()


def test_threads_take_different_numbers_from_one_generator():
    shared, alone = _core.AgentRng("PCG64", 7), _core.AgentRng("PCG64", 7)
    drawn = at_once(lambda _: [shared.random() for _ in range(500)])
    assert sorted(chain.from_iterable(drawn)) == sorted(alone.random() for _ in range(500 * THREADS))


def test_steps_of_many_threads_in_one_environment_leave_a_valid_state():
    """As in Gymnasium's class, they overwrite each other's state."""
    env: Any = MountainCarEnv()
    env.reset(seed=0)

    def use(number: int) -> None:
        for index in range(500):
            env.step(index % 3)
            if number == 0:
                env.force = 0.001 + index * 1e-6
            if number == 1 and index % 100 == 0:
                env.reset(seed=index)

    assert at_once(use) == [None] * THREADS
    position, speed = env.state
    assert -1.2 <= position <= 0.6
    assert abs(speed) <= 0.07


def test_a_thread_that_reads_the_state_does_not_undo_a_step():
    env: Any = MountainCarEnv()
    alone: Any = MountainCarEnv()
    for each in (env, alone):
        each.reset(seed=0)
    done: list[int] = []

    def use(number: int) -> int:
        if number > 0:
            reads = 0
            while not done:
                assert len(env.state) == 2
                reads += 1
            return reads
        try:
            for index in range(3000):
                env.step(index // 40 % 3)
        finally:
            done.append(number)
        return 0

    results = at_once(use, threads=2)
    assert isinstance(results[1], int)
    for index in range(3000):
        alone.step(index // 40 % 3)
    assert state_bytes(env) == state_bytes(alone)


def test_an_attribute_assigned_while_the_attributes_are_read_takes_effect():
    class Assigning(MountainCarEnv):
        """Assigns the force when the step reads its last attribute, as another thread may do."""

        assign = False

        @property
        def render_mode(self) -> None:
            if self.assign:
                self.__dict__["assign"] = False
                self.force = 0.01

        @render_mode.setter
        def render_mode(self, _: None) -> None:
            pass

    env, expected = Assigning(), MountainCarEnv()
    for each in (env, expected):
        each.reset(seed=0)
    env.__dict__["assign"] = True
    env.step(2)
    expected.step(2)
    assert env.force == 0.01
    expected.force = 0.01
    assert env.step(2)[0].tobytes() == expected.step(2)[0].tobytes()


def test_one_thread_at_a_time_steps_a_vector_environment():
    envs: Any = gym.make_vec("qtab/MountainCar-v0", num_envs=64)
    envs.reset(seed=0)
    actions = np.ones(64, dtype=np.int64)

    refused: list[str] = []

    def use(_: int) -> None:
        for _ in range(100):
            try:
                envs.step(actions)
            except RuntimeError as error:
                refused.append(str(error))

    assert at_once(use) == [None] * THREADS
    assert all("this vector environment is busy" in message for message in refused)
    alone: Any = gym.make_vec("qtab/MountainCar-v0", num_envs=64)
    alone.reset(seed=0)
    for _ in range(100 * THREADS - len(refused)):
        alone.step(actions)
    assert envs.step(actions)[0].tobytes() == alone.step(actions)[0].tobytes()
