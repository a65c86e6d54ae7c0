"""The settings that a refusal suggests for an unbounded space work as they are printed."""

import re
from typing import Any

import gymnasium as gym
import pytest
from gymnasium.envs.classic_control import CartPoleEnv

import qtab


class Pole(CartPoleEnv):
    """CartPole without a preset, which would have limits."""


def suggested(message: str) -> dict[str, Any]:
    """The settings after "such as" in a message."""
    found = re.search(r", such as (.*)$", message)
    assert found is not None, message
    return dict(eval(f"dict({found[1]})"))  # noqa: S307 - our own message


@pytest.mark.parametrize(
    ("discretizer", "expected"),
    [
        ("round", {"discretizer", "bins", "low", "high"}),
        ("bins", {"low", "high"}),
        ("tiles", {"low", "high"}),
    ],
)
def test_what_the_refusal_of_cart_pole_suggests_works(discretizer: Any, expected: set[str]) -> None:
    env = Pole()
    short: dict[str, Any] = {"episodes": 20, "seed": 0, "max_episode_steps": 100}
    with pytest.raises(ValueError, match="bounds") as refused:
        qtab.train(env, discretizer=discretizer, **short)
    settings = suggested(str(refused.value))
    assert settings.keys() == expected
    assert settings["low"] == [-4.8, -3.0, -0.419, -3.0]
    assert settings["high"] == [4.8, 3.0, 0.419, 3.0]
    run = qtab.train(env, **{"discretizer": discretizer, **settings}, **short)
    assert run.completed
    assert len(run.episode_returns) == 20


def test_many_components_have_no_example() -> None:
    env = gym.wrappers.FrameStackObservation(gym.make("CartPole-v1"), 3)
    with pytest.raises(ValueError, match="bounds") as refused:
        qtab.train(env, discretizer="bins", bins=2, episodes=1)
    assert "such as" not in str(refused.value)
