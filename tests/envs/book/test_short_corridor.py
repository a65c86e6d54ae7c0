"""The short corridor with switched actions."""

import math
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import qtab

CORRIDOR = "qtab/ShortCorridor-v0"
LEFT, RIGHT = 0, 1


def test_it_is_an_environment_of_gymnasium() -> None:
    check_env(gym.make(CORRIDOR).unwrapped, skip_render_check=True)


def test_actions_are_switched_in_the_second_state() -> None:
    env: Any = gym.make(CORRIDOR).unwrapped
    assert env.reset() == (0, {})
    path = []
    for action in (LEFT, RIGHT, RIGHT, RIGHT, LEFT, LEFT, LEFT, RIGHT):
        observation, reward, terminated, _, _ = env.step(action)
        assert (observation, reward) == (0, -1.0)
        path.append((env.state, terminated))
    assert path == [*((state, False) for state in (0, 1, 0, 1, 2, 1, 2)), (3, True)]


@pytest.mark.parametrize("probability", [0.05, 2 - math.sqrt(2), 0.95])
def test_returns_are_the_exact_ones_by_the_probability_of_right(probability: float) -> None:
    preferences = np.array([[0.0, math.log(probability / (1 - probability))]])
    run = qtab.train(CORRIDOR, algorithm="reinforce", learning_rate=0.0, initial_q=preferences, episodes=4000, seed=0)
    exact = (2 * probability - 4) / (probability * (1 - probability))
    error = run.episode_returns.std() / math.sqrt(4000)
    assert run.config.backend == "rust"
    assert abs(run.episode_returns.mean() - exact) < 4 * error
