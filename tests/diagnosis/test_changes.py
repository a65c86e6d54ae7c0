"""Every change that a finding advises is accepted by ``Config.replace``, and can be trained."""

import ast
import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import qtab
from qtab.config.choices import ALGORITHM_NAMES
from qtab.config.options import PREFERENCES, TABLES_ONLY
from qtab.diagnosis.finding import change

LAKE, CAR = "FrozenLake-v1", "MountainCar-v0"
FALLING: dict[str, Any] = {"learning_rate_schedule": "linear"}


@pytest.mark.parametrize(
    ("settings", "wanted", "expected"),
    [
        ({"epsilon": 0.5, "min_epsilon": 0.1}, {"epsilon": 0.0}, {"epsilon": 0.0, "min_epsilon": 0.0}),
        ({"epsilon": 0.5, "min_epsilon": 0.1}, {"epsilon": 1.0}, {"epsilon": 1.0}),
        (
            {"exploration": "ucb", "confidence": 5.0},
            {"exploration": "epsilon_greedy", "epsilon": 0.0},
            {"exploration": "epsilon_greedy", "epsilon": 0.0, "confidence": None},
        ),
        ({"exploration": "ucb"}, {"epsilon": 0.0}, None),
        (
            {"learning_rate": 0.5, "min_learning_rate": 0.2, **FALLING},
            {"learning_rate": 0.05},
            {"learning_rate": 0.05, "min_learning_rate": 0.2 * 0.05 / 0.5},
        ),
        (
            {"learning_rate_schedule": "exponential", "learning_rate_decay": 0.9},
            FALLING,
            {**FALLING, "learning_rate_decay": None},
        ),
        ({"algorithm": "off_policy_monte_carlo"}, FALLING, None),
        ({"algorithm": "differential_sarsa"}, {"discount": 0.9}, None),
        ({"learning_rate": 0.3}, {"learning_rate": 0.3}, None),
        ({"learning_rate": 0.3}, {"learning_rate": 1.3}, None),
        ({"initial_q": np.zeros((16, 4))}, {"learning_rate": 0.3}, {"learning_rate": 0.3}),
    ],
)
def test_a_change_is_completed_or_left_out(
    settings: dict[str, Any], wanted: dict[str, Any], expected: dict[str, Any] | None
) -> None:
    config = qtab.train(LAKE, seed=0, episodes=1, **settings).config
    assert change(config, **wanted) == expected
    if expected is not None:
        replaced = config.replace(**expected)
        assert all(getattr(replaced, name) == value for name, value in wanted.items())


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        ({}, {"discretizer": "tiles", "tiles": (16,), "scale": (), "terminal_update": "target"}),
        ({"discretizer": "bins", "bins": (5, 6), "terminal_update": "target"}, {"bins": None}),
        ({"discretizer": "edges", "edges": ((0.0,), (0.0,)), "terminal_update": "target"}, {"edges": None}),
        ({"algorithm": "dyna_q"}, None),
        ({"exploration": "ucb"}, None),
        ({"time_aware": True}, None),
        ({"initial_q": np.zeros((19, 15, 3))}, None),
    ],
)
def test_another_discretizer_leaves_the_options_of_the_last_one_behind(
    settings: dict[str, Any], expected: dict[str, Any] | None
) -> None:
    config = qtab.train(CAR, seed=0, episodes=1, **settings).config
    given = change(config, discretizer="tiles", tiles=(16,))
    if expected is None:
        assert given is None
    else:
        assert given is not None
        assert given.items() >= expected.items()
        assert qtab.train(config=config.replace(**given), episodes=1).discretizer.n_active == 8


EXPLORATIONS: list[dict[str, Any]] = [
    {"epsilon": 0.9, "min_epsilon": 0.3},
    {"epsilon": 0.05, "min_epsilon": 0.01},
    {"epsilon": 0.5, "epsilon_schedule": "exponential", "epsilon_decay": 0.999, "min_epsilon": 0.2},
    {"epsilon": 0.5, "epsilon_schedule": "constant"},
    {"exploration": "softmax", "temperature": 50.0},
    {"exploration": "ucb", "confidence": 300.0},
]
RATES: list[dict[str, Any]] = [
    {"learning_rate": 1.0, "min_learning_rate": 0.7, **FALLING},
    {"learning_rate": 1e-3, "min_learning_rate": 1e-3, "learning_rate_schedule": "exponential"},
    {"learning_rate_schedule": "visits", "learning_rate": 1.0, "min_learning_rate": 0.5},
]
OTHERS: list[dict[str, Any]] = [
    {},
    {"algorithm": "sarsa_lambda", "traces": "accumulating"},
    {"algorithm": "double_q_learning"},
    {"algorithm": "dyna_q"},
    {"algorithm": "expected_sarsa", "on_truncation": "terminate", "count_bonus": 50.0},
]


def advised(env: str, settings: dict[str, Any]) -> list[tuple[qtab.Config, dict[str, Any]]]:
    run = qtab.train(env, seed=5, episodes=60, max_episode_steps=40, **settings)
    return [(run.config, dict(given)) for finding in qtab.diagnose(run, seeds=0) for given in finding.changes]


@pytest.mark.parametrize("rate", RATES, ids=lambda rate: str(rate.get("learning_rate_schedule")))
@pytest.mark.parametrize("explored", EXPLORATIONS, ids=lambda explored: "-".join(map(str, explored.values())))
def test_whatever_is_advised_can_be_trained(explored: dict[str, Any], rate: dict[str, Any]) -> None:
    found = []
    for other in OTHERS:
        settings = {"discount": 0.3, **explored, **rate, **other}
        found += advised(LAKE, settings) + advised(CAR, {"terminal_update": "target", **settings})
    if "ucb" not in explored.values():
        narrow = {"low": (-0.55, -0.001), "high": (-0.5, 0.001)}
        found += advised(CAR, {"preset": "solved", "learning_rate": 1.8, **explored, **narrow})
    names = {name for _, given in found for name in given}
    assert len(names) > 4
    for config, given in found:
        assert config.replace(**given) != config
        if "preset" not in given:
            given = {**given, "episodes": 1}
            assert qtab.train(config=config, **given).tables.tobytes() == (
                qtab.train(config=config.replace(**given)).tables.tobytes()
            )


def named_settings(advice: str) -> Iterator[tuple[str, Any]]:
    """The settings that an advice names as keywords, such as ``discount=0.99``, with their values."""
    for found in re.finditer(r"\b([a-z_]+)=('[^']*'|\([^)]*\)|[-+.\w]*\w)", advice):
        yield found[1], ast.literal_eval(found[2])


@pytest.mark.parametrize("algorithm", ALGORITHM_NAMES)
def test_no_advice_names_a_setting_that_the_algorithm_refuses(algorithm: str) -> None:
    """Not even in its text; and the changes that it tries can be trained."""
    short: dict[str, Any] = {"algorithm": algorithm, "episodes": 60, "max_episode_steps": 40, "seed": 5}
    runs = [qtab.train(env, **short) for env in (LAKE, "CliffWalking-v1")]
    runs.append(qtab.train(CAR, **{**short, "episodes": 20}, discretizer="bins", bins=3))
    if algorithm not in TABLES_ONLY:
        narrow: dict[str, Any] = {"discretizer": "tiles", "low": (-0.55, -0.001), "high": (-0.5, 0.001)}
        runs.append(qtab.train(CAR, **{**short, "episodes": 20}, **narrow))
    if algorithm not in PREFERENCES:
        runs.append(qtab.train(LAKE, **short, epsilon=0.9, learning_rate=1.0, count_bonus=50.0, initial_q=9.0))
    if algorithm not in ("gradient_bandit", "differential_sarsa", "differential_q_learning"):
        runs.append(qtab.train("CliffWalking-v1", **short, discount=0.1))
    findings = [(run.config, finding) for run in runs for finding in qtab.diagnose(run, seeds=0).findings]
    assert len({finding.name for _, finding in findings}) > 1
    for config, finding in findings:
        for name, value in named_settings(finding.advice):
            along = next((given for given in finding.changes if name in given), {})
            assert getattr(config.replace(**{**along, name: value}), name) == value, finding.advice
        for given in finding.changes:
            if "preset" not in given:
                qtab.train(config=config.replace(**given), episodes=2)


def test_a_gradient_bandit_in_a_long_task_is_advised_another_algorithm() -> None:
    run = qtab.train("CliffWalking-v1", seed=0, episodes=60, max_episode_steps=100, algorithm="gradient_bandit")
    diagnosis = qtab.diagnose(run, seeds=0)
    (finding,) = (found for found in diagnosis.findings if found.name == "horizon")
    assert finding.title == "The algorithm, gradient_bandit, learns from the next reward alone."
    assert [given["algorithm"] for given in finding.changes] == ["q_learning"]
