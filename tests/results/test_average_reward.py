"""The average reward that the differential methods learn: the reference's, resumed, saved and loaded."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import gymnasium as gym
import pytest

import qtab
from qtab.reference import LEARNERS
from qtab.reference.average_reward import AverageReward

QUEUE = "qtab/AccessControlQueue-v0"
SHORT: dict[str, Any] = {"episodes": 3, "max_episode_steps": 50, "seed": 2, "ties": "random"}


@pytest.mark.parametrize("algorithm", ["differential_sarsa", "differential_q_learning"])
def test_it_is_that_of_the_reference(algorithm: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    run = qtab.train(QUEUE, algorithm=algorithm, **SHORT)
    made: list[AverageReward] = []
    begin = AverageReward.__init__

    def kept(self: AverageReward, *arguments: Any) -> None:
        begin(self, *arguments)
        made.append(self)

    monkeypatch.setattr(AverageReward, "__init__", kept)
    LEARNERS[algorithm](gym.make(QUEUE, max_episode_steps=50), run.config)
    assert run.average_reward == made[0].value != 0.0
    assert "average reward" in run._repr_html_()


def test_it_is_saved_and_resumed(tmp_path: Path) -> None:
    run = qtab.train(QUEUE, algorithm="differential_sarsa", **SHORT)
    stopped = qtab.train(
        QUEUE, algorithm="differential_sarsa", callback=lambda _: False, callback_every=1, **{**SHORT, "episodes": 3}
    )
    stopped.save(tmp_path / "run.npz")
    loaded = qtab.load(tmp_path / "run.npz")
    assert loaded.average_reward == stopped.average_reward != run.average_reward
    assert qtab.resume(loaded).average_reward == run.average_reward


def test_other_algorithms_have_none(tmp_path: Path) -> None:
    run = qtab.train("CliffWalking-v1", episodes=2, seed=0)
    assert run.average_reward is None
    with pytest.raises(ValueError, match="average_reward, which algorithm 'q_learning' does not learn"):
        replace(run, average_reward=1.0).save(tmp_path / "run.npz")
