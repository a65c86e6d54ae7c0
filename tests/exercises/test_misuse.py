"""The grader reports what a solution must not do, and continues with the next check."""

import random
import re
import sys
import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from qtab.exercises import EXERCISES, check, find, grader, time_limit

SARSA = find("sarsa").model


def epsilon_greedy(values, epsilon, rng):
    return np.argmax(values) if rng.random() < 1 - epsilon else rng.integers(len(values))


def broken(function: Callable[..., Any], message: str, name: str = "sarsa", seconds: float = 10.0) -> None:
    """Checks that every check of a function fails with a message, and none is left out."""
    report = check(name, function, seconds=seconds)
    assert len(report.results) == len(EXERCISES[name].checks)
    for result in report.results:
        assert not result.passed
        assert any(message in fault for fault in result.faults), result.faults


def raises(env, q, *others):
    q[0, 99] = 1.0


def old_step(env, *_):
    env.reset()
    _, _, _, _ = env.step(0)


def one_episode(env, q, episodes, *others):
    SARSA(env, q, 1, *others)


def returns_late(env, *others):
    while True:
        try:
            env.reset()
        except BaseException:  # noqa: S112 - as careless as can be
            continue


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (raises, "it raised IndexError: index 99 is out of bounds for axis 1 with size 4, in line"),
        (lambda *_: exit(), "it raised SystemExit"),
        (
            lambda env, q: None,
            "7 arguments in this order: (env, q, episodes, learning_rate, discount, epsilon, rng), but",
        ),
        (lambda q, env, episodes, learning_rate, discount, epsilon, rng: None, "but takes (q, env, episodes,"),
        (lambda env, q, *_: q[env.reset()], ". env.reset() returns two values: state, info = "),
        (old_step, "(expected 4), in line"),
        (old_step, ". env.step returns five values: next_state, reward, terminated, truncated, info"),
        (one_episode, "it returns after 1 episode, but episodes is"),
        (lambda *_: None, "it never calls env.reset(), which starts an episode"),
        (lambda env, *_: env.reset(seed=1), "it calls env.reset with a seed"),
        (lambda env, *_: env.step(0), "it calls env.step before env.reset()"),
        (lambda env, *_: (env.reset(), env.step(4)), "an action must be an integer from 0 to 3, got 4"),
        (lambda env, *_: (env.reset(), env.step(1.0)), "an action must be an integer from 0 to 3, got 1.0"),
        (lambda env, *_: [env.reset() for _ in range(50)], "but episodes is"),
        (lambda env, *_: (env.reset(), [env.step(0) for _ in range(2000)]), "env.step after the end of the episode"),
    ],
)
def test_misuse_is_reported_and_the_next_check_follows(function: Callable[..., Any], message: str) -> None:
    broken(function, message)


@pytest.mark.parametrize("in_thread", [False, True])
def test_a_loop_without_an_end_is_stopped(in_thread: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    # The error may be raised in a callback of the garbage collector, which reports it and goes on; another one follows,
    # perhaps while pytest still handles the report.
    monkeypatch.setattr(sys, "unraisablehook", lambda _: None)
    done = []

    def checked() -> None:
        broken(
            returns_late, "it was stopped after 0.2 seconds (is there a loop that never ends?), in line ", seconds=0.2
        )
        assert check("sarsa", returns_late, seconds=0.2).advice == ()
        assert check("sarsa", SARSA).passed
        done.append(True)

    if in_thread:
        thread = threading.Thread(target=checked)
        thread.start()
        thread.join()
    else:
        checked()
    assert done == [True]


def test_without_signals_a_second_thread_stops_a_loop() -> None:
    def loop() -> None:
        while True:
            pass

    with pytest.raises(time_limit.TimeIsUp):
        time_limit._by_thread(0.1, loop, ())
    assert time_limit._by_thread(10.0, max, (1, 2)) == 2


def test_a_very_short_limit_in_threads_neither_escapes_nor_blocks() -> None:
    def loop() -> None:
        while True:
            pass

    outcomes: list[Any] = []

    def stopped() -> None:
        for _ in range(8):
            with pytest.raises(time_limit.TimeIsUp):
                time_limit._by_thread(0.002, loop, ())
            outcomes.append(time_limit._by_thread(60.0, max, (1, 2)))

    threads = [threading.Thread(target=stopped, daemon=True) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(600.0)
    assert outcomes == [2] * 24


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (lambda values, epsilon, rng: 1.5, "call 0: action must be an integer, got 1.5 (float)"),
        (lambda values, epsilon, rng: None, "call 0: action must be an integer, got None (is a return missing?)"),
        (lambda values, epsilon, rng: int(values.sort() is None), "call 0: it changes its argument values"),
    ],
)
def test_results_of_the_wrong_type_and_changed_arguments_are_reported(function: Any, message: str) -> None:
    broken(function, message, "epsilon_greedy")


def test_results_of_the_wrong_shape_are_reported() -> None:
    broken(lambda *_: (np.zeros(3), np.zeros(3)), "values must be an array of shape (", "value_iteration")
    broken(lambda *_: np.zeros(3), "it must return values, policy, got an array of shape (3,)", "value_iteration")
    broken(lambda P, policy, values, discount: values.tolist(), "values must be an array of", "policy_evaluation")  # noqa: N803


def test_global_generators_are_reported_and_left_as_they_were() -> None:
    def legacy(env, q, episodes, learning_rate, discount, epsilon, rng):
        np.random.seed(1)  # noqa: NPY002
        SARSA(env, q, episodes, learning_rate, discount, epsilon, rng)

    def python(env, q, episodes, learning_rate, discount, epsilon, rng):
        random.random()  # noqa: S311
        SARSA(env, q, episodes, learning_rate, discount, epsilon, rng)

    numpy_before, python_before = np.random.get_state()[1].copy(), random.getstate()  # type: ignore[index]  # noqa: NPY002
    broken(legacy, "it uses NumPy's global generator")
    broken(python, "it uses Python's global generator")
    assert np.array_equal(np.random.get_state()[1], numpy_before)  # type: ignore[index]  # noqa: NPY002
    assert random.getstate() == python_before
    report = check("epsilon_greedy", lambda values, epsilon, rng: np.random.randint(5))  # noqa: NPY002
    assert all(str(result.faults).count("NumPy's global generator") == 1 for result in report.results)
    assert str(report).count("NumPy's global generator") == 1
    assert str(report).count("the same as in the check above") == len(report.results) - 1


def test_the_generator_of_the_action_space_is_reported() -> None:
    def samples(env, q, episodes, learning_rate, discount, epsilon, rng):
        env.action_space.sample()
        SARSA(env, q, episodes, learning_rate, discount, epsilon, rng)

    broken(samples, "it calls env.action_space.sample(), which uses a separate generator")
    assert check("sarsa", samples).advice == ()


def test_a_report_on_a_loop_names_its_line_and_does_not_wait_in_every_check(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(grader, "AFTER_A_STOP", 0.1)

    def loops(*_):
        while True:
            pass

    line = loops.__code__.co_firstlineno + 1
    faults = [result.faults[0] for result in check("td_prediction", loops, seconds=0.3).results]
    after = [re.sub(r" \(.*?\), in line .*", "", fault) for fault in faults]
    assert after == [f"it was stopped after {seconds} seconds" for seconds in (0.3, 0.1, 0.1)]
    assert all(re.search(f", in line ({line}: while True:|{line + 1}: pass)$", fault) for fault in faults)


def test_the_error_handling_of_numpy_is_left_as_it_was() -> None:
    def strict(*arguments):
        np.seterr(all="raise")
        SARSA(*arguments)

    before = np.geterr()
    check("sarsa", strict)
    assert np.geterr() == before


def resets_after_each_episode(more_steps: int, more_resets: int) -> Callable[..., None]:
    """Returns a Q-learning that resets after each episode, the last one included, and then goes too far."""

    def q_learning(env, q, episodes, learning_rate, discount, epsilon, rng):
        state, _ = env.reset()
        for _ in range(episodes):
            over = False
            while not over:
                action = epsilon_greedy(q[state], epsilon, rng)
                next_state, reward, terminated, truncated, _ = env.step(action)
                target = reward if terminated else reward + discount * q[next_state].max()
                q[state, action] += learning_rate * (target - q[state, action])
                state, over = next_state, terminated or truncated
            state, _ = env.reset()
        for _ in range(more_resets):
            env.reset()
        for _ in range(more_steps):
            env.step(0)

    return q_learning


def test_a_reset_after_the_last_episode_is_ignored() -> None:
    assert check("q_learning", resets_after_each_episode(0, 0)).passed
    broken(resets_after_each_episode(1, 0), "but episodes is", "q_learning")
    broken(resets_after_each_episode(0, 1), "but episodes is", "q_learning")


def test_a_generator_function_is_reported() -> None:
    def sarsa(env, q, episodes, learning_rate, discount, epsilon, rng):
        yield

    broken(sarsa, "it contains yield")


def test_a_changed_policy_is_reported() -> None:
    def changes(env, values, policy, episodes, learning_rate, discount):
        find("td_prediction").model(env, values, policy, episodes, learning_rate, discount)
        policy[:] = 0

    broken(changes, "it changes its argument policy", "td_prediction")


def test_stopped_functions_are_not_compared_with_mistakes() -> None:
    assert check("sarsa", raises).mistakes == ()
