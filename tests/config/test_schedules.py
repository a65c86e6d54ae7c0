"""Which schedule a rate has: a rate alone is constant, one with a minimum falls, and a preset's belongs to its rate."""

from typing import Any

import numpy as np
import pytest

import qtab

CLIFF = "CliffWalking-v1"
RATES: list[Any] = [
    ("epsilon", "epsilon_schedule", "min_epsilon", "epsilon_warm_up"),
    ("learning_rate", "learning_rate_schedule", "min_learning_rate", "learning_rate_warm_up"),
]
WALK = "qtab/RandomWalk-v0"
"""An environment without presets."""
LAKE = "FrozenLake8x8-v1"
"""An environment whose first preset lets both rates fall."""


def config(env: str, **settings: Any) -> Any:
    return qtab.train(env, episodes=4, max_episode_steps=5, seed=0, **settings).config


@pytest.mark.parametrize("env", [WALK, LAKE])
@pytest.mark.parametrize(("rate", "schedule", "minimum", "warm_up"), RATES)
def test_a_rate_alone_is_constant(env, rate, schedule, minimum, warm_up):
    trained = config(env, **{rate: 0.1})
    assert (getattr(trained, rate), getattr(trained, schedule)) == (0.1, "constant")
    assert getattr(trained, minimum) is None
    assert getattr(trained, warm_up) is None


@pytest.mark.parametrize("env", [WALK, LAKE])
@pytest.mark.parametrize(("rate", "schedule", "minimum", "warm_up"), RATES)
def test_a_rate_with_a_minimum_or_a_warm_up_falls_linearly(env, rate, schedule, minimum, warm_up):
    assert getattr(config(env, **{rate: 0.1, minimum: 0.05}), schedule) == "linear"
    assert getattr(config(env, **{rate: 0.1, warm_up: 1}), schedule) == "linear"
    assert getattr(config(env, **{minimum: 0.05}), schedule) == "linear"


@pytest.mark.parametrize(("rate", "schedule", "minimum", "warm_up"), RATES)
def test_another_schedule_can_be_named(rate, schedule, minimum, warm_up):
    trained = config(LAKE, **{rate: 0.1, minimum: 0.05, schedule: "exponential"})
    assert (getattr(trained, schedule), getattr(trained, minimum)) == ("exponential", 0.05)
    with pytest.raises(ValueError, match=rf"^{minimum} applies to {schedule} .*, not to 'constant', got 0.05$"):
        config(LAKE, **{rate: 0.1, minimum: 0.05, schedule: "constant"})


def test_the_schedule_of_a_preset_applies_to_its_own_rate_only():
    preset = config("CartPole-v1", preset="solved")
    assert (preset.learning_rate_schedule, preset.learning_rate_decay) == ("exponential", 0.997)
    assert config("CartPole-v1", preset="solved", epsilon=0.2).learning_rate_decay == 0.997
    other = config("CartPole-v1", preset="solved", learning_rate=0.5, learning_rate_schedule="exponential")
    assert other.learning_rate_decay == 0.999  # the default, not the preset's
    assert config("qtab/KArmedBandit-v0", learning_rate=0.1).learning_rate_schedule == "constant"


def test_without_a_rate_the_schedules_are_those_of_the_preset_or_of_the_article():
    assert (config(CLIFF).epsilon, config(CLIFF).epsilon_schedule) == (0.1, "linear")
    assert (config(WALK).epsilon, config(WALK).epsilon_schedule) == (0.8, "linear")
    assert config(WALK).learning_rate_schedule == "constant"
    assert config("qtab/KArmedBandit-v0").learning_rate_schedule == "visits"


def test_a_config_keeps_what_it_states():
    falling = config(CLIFF)
    assert qtab.train(config=falling, epsilon=0.3, seed=0).config.epsilon_schedule == "linear"
    assert falling.replace(epsilon=0.3).epsilon_schedule == "linear"
    assert qtab.Config(env=WALK, epsilon=0.3).epsilon_schedule == "constant"
    assert qtab.Config(env=WALK, epsilon=0.3, min_epsilon=0.1).epsilon_schedule == "linear"
    assert qtab.Config(env=WALK, min_learning_rate=0.1).learning_rate_schedule == "linear"


def test_every_call_has_the_same_rule():
    chosen: dict[str, Any] = {"episodes": 4, "epsilon": 0.1}
    many = qtab.train_many(CLIFF, 2, **chosen).config
    swept = qtab.Config(**qtab.sweep(CLIFF, {"epsilon": [0.1]}, seeds=2, episodes=4).configs[0])
    mapped = qtab.train(CLIFF, config=chosen).config
    assert many.epsilon_schedule == swept.epsilon_schedule == mapped.epsilon_schedule == "constant"


@pytest.mark.parametrize("algorithm", ["monte_carlo", "off_policy_monte_carlo"])
def test_averages_stay_averages_beside_a_minimum(algorithm):
    assert config(CLIFF, algorithm=algorithm, min_learning_rate=0.1).learning_rate_schedule == "visits"


def test_a_rate_of_another_policy_is_refused_by_its_own_name():
    with pytest.raises(
        ValueError, match=r"^epsilon applies to exploration 'epsilon_greedy', not to 'softmax', got 0.1"
    ):
        config(CLIFF, exploration="softmax", epsilon=0.1)
    with pytest.raises(ValueError, match=r"^min_epsilon applies to "):
        config(CLIFF, exploration="softmax", min_epsilon=0.1)


@pytest.mark.slow
def test_a_constant_epsilon_gives_the_textbooks_result_on_the_cliff():
    """Sutton & Barto, Example 6.6: Sarsa takes the safe path, Q-learning falls off the edge while it explores."""
    sarsa, q_learning = (
        qtab.train_many(CLIFF, 30, algorithm=algorithm, epsilon=0.1).final_returns(100)
        for algorithm in ("sarsa", "q_learning")
    )
    assert np.mean(sarsa) > np.mean(q_learning) + 10
