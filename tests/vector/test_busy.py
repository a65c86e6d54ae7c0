"""A vector environment that is being stepped says so to whoever else uses it."""

import threading
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

from support.lockstep.vector import ours


def test_two_threads_cannot_step_the_same_sub_environments_at_once():
    env = ours("CartPole-v1", 8, threads=2)
    env.reset(seed=0)
    raised = []

    class Meddling(np.random.Generator):
        """Steps the environment from another thread while it is drawn from."""

        def random(self, *arguments: Any) -> Any:  # type: ignore[override]
            def meddle():
                try:
                    env.step(np.zeros(8, np.int64))
                except RuntimeError as error:
                    raised.append(str(error))

            thread = threading.Thread(target=meddle)
            thread.start()
            thread.join()
            return super().random(*arguments)

    env.unwrapped.set_rng(3, Meddling(np.random.PCG64(0)))
    while not raised:
        env.step(np.zeros(8, np.int64))
    assert all(text.startswith("this vector environment is busy: another thread is stepping") for text in raised)


@pytest.mark.parametrize(
    "use",
    [
        lambda env: env.reset(seed=1),
        lambda env: env.np_random,
        lambda env: env.np_random_seed,
        lambda env: env.call("spec"),
        lambda env: env.render(),
    ],
)
def test_a_vector_environment_says_that_a_step_is_under_way(use):
    env = ours("CartPole-v1", 4, threads=2, render_mode="rgb_array").unwrapped
    env.reset(seed=0)
    raised: list[BaseException] = []

    class Meddling(np.random.Generator):
        def random(self, *arguments: Any) -> Any:  # type: ignore[override]
            try:
                use(env)
            except BaseException as error:
                raised.append(error)
            return super().random(*arguments)

    env.set_rng(1, Meddling(np.random.PCG64(0)))
    while not raised:
        env.step(np.zeros(4, np.int64))
    assert {type(error) for error in raised} == {RuntimeError}
    assert str(raised[0]).startswith("this vector environment is busy: ")


def test_the_autoreset_mode_cannot_be_assigned():
    env = ours("CartPole-v1", 2).unwrapped
    with pytest.raises(AttributeError, match=r"autoreset_mode cannot be assigned: .* autoreset_mode='SameStep'\)"):
        env.autoreset_mode = gym.vector.AutoresetMode.SAME_STEP
    assert env.autoreset_mode is gym.vector.AutoresetMode.NEXT_STEP
