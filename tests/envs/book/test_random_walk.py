"""The random walks of the book."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import qtab

WALK = "qtab/RandomWalk-v0"


def test_it_passes_gymnasiums_checks() -> None:
    check_env(gym.make(WALK).unwrapped, skip_render_check=True)


@pytest.mark.parametrize(("states", "left_reward"), [(5, 0.0), (19, -1.0)])
def test_the_values_of_the_short_walks_are_linear(states: int, left_reward: float) -> None:
    env_kwargs = {"states": states, "left_reward": left_reward}
    values = qtab.policy_values(WALK, "random", env_kwargs=env_kwargs).values
    expected = np.linspace(left_reward, 1.0, states + 2)[1:-1]
    np.testing.assert_allclose(values, expected, atol=1e-12)


def test_a_step_of_the_long_walk_leads_to_each_neighbor_on_its_side() -> None:
    env: Any = gym.make(WALK, states=100, reach=10).unwrapped
    assert env.initial_state_distrib[49] == 1.0
    middle = env.P[49][0]
    assert [state for _, state, _, _ in middle] == list(range(48, 38, -1))
    end = env.P[95][1]
    assert [(state, terminated) for _, state, _, terminated in end[:-1]] == [
        (96, False),
        (97, False),
        (98, False),
        (99, False),
    ]
    assert end[-1] == (0.6, 99, 1.0, True)


def test_rust_steps_it_in_training() -> None:
    run = qtab.train(WALK, seed=0, episodes=3)
    assert run.config.backend == "rust"
    assert qtab.optimum(WALK).expected_return == 1.0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"states": 0}, "states must be an integer of at least 1"),
        ({"right_reward": np.inf}, "right_reward must be finite"),
    ],
)
def test_what_is_no_walk_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        gym.make(WALK, **changes)
