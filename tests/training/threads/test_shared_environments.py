"""Two threads cannot train in one environment: they would mix up their episodes."""

import threading

import gymnasium as gym
import numpy as np
import pytest

import qtab
from support.environments import Calls, ScriptedEnv
from support.parity import assert_same_run, run_of

ONE = np.array([1.0], np.float32)


def train(env):
    return qtab.train(env, scale=(1,), seed=0, episodes=3)


@pytest.mark.parametrize("wrap", [lambda env: env, lambda env: gym.wrappers.TimeLimit(env, 100)])
def test_a_second_thread_is_refused_and_the_first_goes_on(wrap):
    errors: list[RuntimeError] = []

    def meddle(count):
        if count != 5:
            return

        def train_too():
            try:
                train(wrap(env))
            except RuntimeError as error:
                errors.append(error)

        thread = threading.Thread(target=train_too)
        thread.start()
        thread.join()

    env = Calls(ScriptedEnv([ONE]), meddle)
    run = train(env)
    assert_same_run(run, train(ScriptedEnv([ONE])))
    assert "is in use by another thread's training" in str(errors[0])
    assert len(run_of(errors[0]).episode_returns) == 0
    # Afterwards it is free again, for any thread.
    assert_same_run(train(env), run)


def test_a_callback_may_evaluate_in_the_same_environment():
    env = ScriptedEnv([ONE])
    evaluations = []
    first = train(ScriptedEnv([ONE]))
    qtab.train(
        env,
        scale=(1,),
        episodes=2,
        callback_every=1,
        callback=lambda progress: evaluations.append(qtab.evaluate(first, 1, env=env)),
    )
    assert len(evaluations) == 2


def test_a_run_that_another_thread_resumes_there_is_refused_before_it_touches_the_environment():
    error = KeyboardInterrupt()

    def interrupt(count):
        if count == 12:
            raise error

    called = [interrupt]

    def before(count):
        called[0](count)

    with pytest.raises(KeyboardInterrupt):
        train(Calls(ScriptedEnv([ONE]), before))
    errors: list[RuntimeError] = []

    def meddle(count):
        if count != 5:
            return

        def resume():
            try:
                qtab.resume(run_of(error), env=env)
            except RuntimeError as refusal:
                errors.append(refusal)

        thread = threading.Thread(target=resume)
        thread.start()
        thread.join()

    scripted = ScriptedEnv([ONE])
    called[0] = meddle
    env = Calls(scripted, before)
    run = train(env)
    assert "is in use by another thread's training" in str(errors[0])
    assert scripted.seeds == [0, None, None]
    assert_same_run(run, train(ScriptedEnv([ONE])))
