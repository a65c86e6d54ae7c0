"""Extending a run logs that epsilon rises again, once, and how to keep it low."""

import logging
import re

import pytest

import qtab


def messages(caplog: pytest.LogCaptureFixture) -> list[str]:
    return [message for message in caplog.messages if "epsilon now falls" in message]


def test_the_rise_of_epsilon_is_logged_once_with_advice(caplog: pytest.LogCaptureFixture) -> None:
    run = qtab.train("MountainCar-v0", episodes=300, seed=0)
    with caplog.at_level(logging.WARNING, "qtab"):
        longer = qtab.resume(run, episodes=400)
    (message,) = messages(caplog)
    assert "over 400 episodes instead of 300: epsilon rises from 0 to 0.2 and falls again" in message
    advice = re.search(r"(qtab\.train\(.*\))$", message)
    assert advice is not None
    more = eval(advice[1], {"qtab": qtab, "run": run})  # noqa: S307 - our own message
    assert len(more.episode_returns) == len(longer.episode_returns) - len(run.episode_returns)
    assert more.config.epsilon == more.config.min_epsilon == 0.0
    assert more.config.seed == 1  # not the random numbers of the earlier run again
    assert "starts again" not in message
    assert (more.config.initial_q.reshape(run.q_table.shape) == run.q_table).all()


def test_the_advice_mentions_a_learning_rate_that_starts_again(caplog: pytest.LogCaptureFixture) -> None:
    run = qtab.train(
        "FrozenLake-v1", episodes=20, seed=4, learning_rate=0.5, learning_rate_schedule="linear", min_learning_rate=0.1
    )
    with caplog.at_level(logging.WARNING, "qtab"):
        qtab.resume(run, episodes=30)
    (message,) = [message for message in caplog.messages if "rises" in message]
    assert "instead (the learning rate then starts again at 0.5): qtab.train(" in message
    assert "seed=5, initial_q=run.tables))" in message


def test_other_extensions_do_not_speak_of_a_rise(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING, "qtab"):
        constant = qtab.train("MountainCar-v0", episodes=20, seed=0, epsilon=0.1, epsilon_schedule="constant")
        qtab.resume(constant, episodes=30)
        rate = qtab.train(
            "MountainCar-v0",
            episodes=20,
            seed=0,
            epsilon=0.1,
            epsilon_schedule="constant",
            learning_rate=0.5,
            learning_rate_schedule="linear",
            min_learning_rate=0.1,
        )
        qtab.resume(rate, episodes=30)
    assert messages(caplog) == []
    assert any("learning_rate now falls linearly" in message for message in caplog.messages)
    assert not any("rises" in message for message in caplog.messages)
