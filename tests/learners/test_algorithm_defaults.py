"""The settings that algorithms bring along, and those that they need."""

from typing import Any

import pytest

import qtab
from qtab.config.options import AVERAGE_REWARD, WITH_PROBABILITIES


def test_off_policy_monte_carlo_needs_averages() -> None:
    with pytest.raises(
        ValueError,
        match=r"^learning_rate_schedule must be 'visits' for .* 'off_policy_monte_carlo', got 'linear'",
    ):
        qtab.train("MountainCar-v0", algorithm="off_policy_monte_carlo", learning_rate_schedule="linear")


@pytest.mark.parametrize("algorithm", AVERAGE_REWARD)
def test_the_average_reward_is_not_discounted(algorithm: Any) -> None:
    with pytest.raises(
        ValueError,
        match=rf"^discount must be 1 for .* '{algorithm}', which learns the average reward, got 0\.9$",
    ):
        qtab.train("MountainCar-v0", algorithm=algorithm, discount=0.9)


def test_an_algorithm_brings_the_settings_of_the_book() -> None:
    def used(**settings: Any) -> tuple[Any, ...]:
        config = qtab.train("MountainCar-v0", episodes=1, max_episode_steps=5, **settings).config
        return config.learning_rate, config.learning_rate_schedule, config.epsilon, config.discount

    assert used(algorithm="monte_carlo") == (1.0, "visits", 0.8, 0.9)
    assert used(algorithm="monte_carlo_es") == (1.0, "visits", 0.0, 0.9)
    assert used(algorithm="monte_carlo", learning_rate=0.1, epsilon=0.3) == (0.1, "constant", 0.3, 0.9)
    assert used(algorithm="off_policy_monte_carlo", learning_rate=0.5) == (0.5, "visits", 0.8, 0.9)
    assert used(algorithm="differential_sarsa") == (0.2, "constant", 0.8, 1.0)
    assert used() == (0.2, "constant", 0.8, 0.9)
    # A preset's rate, which was chosen for another algorithm, yields too.
    frozen = qtab.train("FrozenLake-v1", episodes=1, preset="solved", algorithm="monte_carlo").config
    assert (frozen.learning_rate, frozen.learning_rate_schedule, frozen.epsilon) == (1.0, "visits", 0.0)


@pytest.mark.parametrize("algorithm", WITH_PROBABILITIES)
def test_upper_confidence_bounds_have_no_probabilities(algorithm: Any) -> None:
    with pytest.raises(
        ValueError, match=rf"^exploration must be 'epsilon_greedy' or 'softmax' for .* '{algorithm}', got 'ucb'"
    ):
        qtab.train("FrozenLake-v1", algorithm=algorithm, exploration="ucb")
