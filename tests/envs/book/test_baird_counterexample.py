"""Baird's counterexample: the transitions, features and policies of the book's picture."""

from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.utils.env_checker import check_env

import qtab

ENV = "qtab/BairdCounterexample-v0"


def test_it_passes_gymnasiums_checks() -> None:
    check_env(gym.make(ENV).unwrapped, skip_render_check=True)


def test_the_values_have_the_weights_of_the_picture() -> None:
    env: Any = gym.make(ENV).unwrapped
    w = 10.0 ** np.arange(8)
    assert (env.features @ w).tolist() == [*(2 * w[:6] + w[7]), w[6] + 2 * w[7]]
    assert env.P[3][1] == [(1.0, 6, 0.0, False)]
    assert [state for _, state, _, _ in env.P[6][0]] == list(range(6))
    assert {reward for row in env.P.values() for one in row.values() for _, _, reward, _ in one} == {0.0}
    assert not any(ended for row in env.P.values() for one in row.values() for *_, ended in one)


def test_all_states_are_equally_likely_under_the_behavior() -> None:
    env: Any = gym.make(ENV).unwrapped
    found = qtab.prediction.linear_geometry(env, env.target, env.features, 0.99, behavior=env.behavior)
    np.testing.assert_allclose(found.distribution, 1 / 7, rtol=1e-14)
    assert found.values.tolist() == [0.0] * 7
    assert env.target.tolist() == [[0.0, 1.0]] * 7


def test_rust_steps_it_in_training() -> None:
    assert qtab.train(ENV, seed=0, episodes=1, max_episode_steps=100).config.backend == "rust"
