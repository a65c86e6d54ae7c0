"""The name of an environment in messages: no method of the user's class is called for it."""

import gymnasium as gym
import pytest
from gymnasium import spaces

from qtab.envs.external.capsule import compiled_class
from qtab.envs.in_rust.matching import NotInRustError

CALLS: list[str] = []


class Shows(gym.Env):
    """Its text has an effect, and its step cannot be compiled."""

    observation_space = spaces.Discrete(3)
    action_space = spaces.Discrete(2)

    def __str__(self) -> str:
        CALLS.append("str")
        return "shown"

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return 0, {}

    def step(self, action):
        print(action)  # noqa: T201
        return 0, 0.0, False, False, {}


def test_the_text_of_a_class_of_ones_own_is_not_asked_for() -> None:
    pytest.importorskip("numba")
    with pytest.raises(NotInRustError, match="print"):
        compiled_class(Shows(), needs_masks=False)
    assert CALLS == []
