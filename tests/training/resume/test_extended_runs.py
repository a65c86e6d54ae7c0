"""A run that was resumed with more episodes while a rate fell: only its first episodes can be repeated."""

import json
import logging
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import qtab
from qtab.results.run_state import RunState

POLE = "CartPole-v1"


def extended(**settings: Any) -> qtab.Run:
    return qtab.resume(qtab.train(POLE, seed=0, episodes=30, **settings), 60)


def test_verify_repeats_the_episodes_before_the_extension_and_refuses_the_others(tmp_path: Path) -> None:
    extended().save(tmp_path / "run.npz")
    run = qtab.load(tmp_path / "run.npz")
    report = qtab.verify(run, episodes=30)
    assert report.equal, report
    assert report.episodes == 30
    reason = "only those can be repeated, because its falling rates were then spread over more episodes"
    start = f"episodes must be at most 30 for a run that was extended after 30 episodes: {reason}"
    with pytest.raises(ValueError, match=rf"^{start}, got 31$"):
        qtab.verify(run, episodes=31)
    start = f"episodes must be given for a run that was extended after 30 episodes: {reason}"
    with pytest.raises(ValueError, match=rf"^{start}; episodes=30 compares them$"):
        qtab.verify(run)


def test_explain_shows_the_rates_that_an_episode_had() -> None:
    run = extended()
    explained = qtab.explain(run, episode=20, steps=1)
    assert explained.learning_rate == qtab.explain(qtab.train(POLE, seed=0, episodes=30), episode=20).learning_rate
    with pytest.raises(ValueError, match=r"^episode must be at most 29 for a run that was extended"):
        qtab.explain(run, episode=30)


def test_a_second_extension_keeps_the_first() -> None:
    run = qtab.resume(extended(), 80)
    assert run.state is not None
    assert run.state.extensions == ((30, 30), (60, 60))
    assert qtab.verify(run, episodes=30).equal
    stopped = qtab.train(POLE, seed=0, episodes=30, callback=lambda progress: progress.episodes < 10, callback_every=10)
    finished = qtab.resume(qtab.resume(stopped, 40, callback=lambda progress: False, callback_every=5))
    assert finished.state is not None
    assert finished.state.extensions == ((10, 30),)
    assert qtab.verify(finished, episodes=10).equal


def test_with_constant_rates_the_whole_run_is_repeated(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING, "qtab"):
        run = extended(epsilon=0.1, min_epsilon=0.1, learning_rate_schedule="constant")
    assert caplog.text == ""
    assert qtab.verify(run).equal
    assert run.episode_lengths.tobytes() == qtab.train(config=run.config).episode_lengths.tobytes()


@pytest.mark.parametrize("extensions", ["a", {}, [1], [[1]], [[1, 2, 3]], [[0, 3]], [[4, 3]], [[True, 3]], [[1.0, 3]]])
def test_extensions_in_a_file_are_checked(extensions: Any) -> None:
    with pytest.raises(ValueError, match=r"^its extensions must be a list of pairs"):
        RunState.restore(np.zeros(3, np.uint8), None, [], json.loads(json.dumps(extensions)))
