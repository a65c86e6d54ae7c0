"""Estimated values in each kind of environment that Rust steps."""

from typing import Any

import numpy as np
import pytest

import qtab

TOY_TEXT = ("FrozenLake-v1", "CliffWalking-v1", "Taxi-v4", "Blackjack-v1")
BOOK = ("BlockingMaze", "KArmedBandit", "MaximizationBias", "Racetrack", "RandomWalk", "ShortCorridor")


@pytest.mark.parametrize("changes", [{}, {"bit_generator": "MT19937"}, {"on_truncation": "terminate"}], ids=str)
@pytest.mark.parametrize("env", [*TOY_TEXT, *(f"qtab/{name}-v0" for name in BOOK)])
def test_every_environment_in_rust_is_estimated_as_in_plain_numpy(env: str, changes: dict[str, Any]) -> None:
    found = qtab.estimate_values(env, "random", episodes=4, max_episode_steps=7, discount=0.9, **changes)
    assert found.config is not None
    assert found.config.backend == "rust"
    assert found.verify().equal


@pytest.mark.parametrize("features", [None, [0], [[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]]], ids=str)
def test_a_policy_on_a_bandit_has_the_value_of_its_action(features: Any) -> None:
    for arm, true in enumerate(np.random.default_rng(0).standard_normal(10)):
        settings: dict[str, Any] = {"episodes": 400, "features": features, "max_episode_steps": 1}
        found = qtab.estimate_values("qtab/KArmedBandit-v0", np.array([arm]), **settings)
        assert found.values.shape == (1, 1)
        assert abs(found.values[0, 0] - true) < 4.0 / np.sqrt(400)
        assert found.verify(episodes=20).equal


def test_memory_of_runs_in_progress_is_counted() -> None:
    """Batch TD keeps four sums for each state beside its value, and each run its features."""
    settings: dict[str, Any] = {"episodes": 2, "seeds": [0], "record": 2, "memory_limit": 500}
    qtab.estimate_values("FrozenLake-v1", "random", method="td", **settings)
    with pytest.raises(MemoryError, match=r"^1 run of 'batch_td' with 1 recorded episode .* would take 896 bytes"):
        qtab.estimate_values("FrozenLake-v1", "random", method="batch_td", **settings)


def test_true_values_beside_a_map_are_refused() -> None:
    found = qtab.estimate_values("Blackjack-v1", "random", episodes=2, max_episode_steps=50)
    with pytest.raises(ValueError, match="true_values must be None for values that are drawn as a map, got"):
        found.plot(true_values=np.zeros(found.shape))
