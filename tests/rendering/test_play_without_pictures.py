"""``qtab.play`` in an environment that cannot be rendered."""

from typing import Any

import gymnasium as gym
import pytest
from gymnasium.envs.toy_text.frozen_lake import FrozenLakeEnv

import qtab


def test_an_environment_without_pictures_is_refused_without_advice_to_save_them(
    caplog: pytest.LogCaptureFixture,
) -> None:
    class Plain(FrozenLakeEnv):
        metadata = {"render_modes": ["ansi"]}  # noqa: RUF012 - as in Gymnasium's classes

    run = qtab.train("FrozenLake-v1", seed=0, episodes=5)
    entry_point: Any = Plain
    gym.register("Plain-v0", entry_point)
    try:
        with pytest.raises(ValueError, match="Plain-v0 cannot be rendered as 'rgb_array'; its render modes are: 'ansi"):
            qtab.play(run, env="Plain-v0")
    finally:
        del gym.registry["Plain-v0"]
    assert caplog.messages == []
