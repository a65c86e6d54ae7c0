"""Every setting of every prediction method: it changes the estimates, or it is refused by name, and never ignored."""

import inspect
from typing import Any

import numpy as np
import pytest

import qtab
from qtab.envs.book.random_mdp import random_mdp
from qtab.prediction import state_aggregation
from qtab.prediction.settings import METHODS
from qtab.prediction.task import OF_OBSERVATIONS

OFTEN_FIRST = np.tile([0.6, 0.3, 0.1], (6, 1))
LINEAR: dict[str, Any] = {"learning_rate": 0.5, "learning_rate_schedule": "linear"}
EXPONENTIAL: dict[str, Any] = {"learning_rate": 0.5, "learning_rate_schedule": "exponential"}
TRACES: dict[str, Any] = {"trace_decay": 0.5, "learning_rate": 0.3}

PAIRS: dict[str, tuple[tuple[Any, Any], dict[str, Any]]] = {
    "policy": ((OFTEN_FIRST, np.zeros(6, int)), {}),
    "episodes": ((20, 21), {}),
    "learning_rate": ((0.5, 0.3), {}),
    "learning_rate_schedule": (("constant", "linear"), {"learning_rate": 0.5}),
    "min_learning_rate": ((0.0, 0.3), LINEAR),
    "learning_rate_decay": ((0.9, 0.5), EXPONENTIAL),
    "learning_rate_warm_up": ((0, 10), LINEAR),
    "second_learning_rate": ((0.1, 0.4), {}),
    "discount": ((0.9, 0.5), {}),
    "n_steps": ((2, 4), {}),
    "trace_decay": ((0.9, 0.4), {}),
    "first_visit": ((False, True), {}),
    "weighted": ((True, False), {}),
    "epsilon": ((0.001, 0.5), {}),
    "recursive": ((True, False), {}),
    "behavior": (("random", OFTEN_FIRST), {}),
    "features": ((None, state_aggregation(6, 2)), {}),
    "initial_value": ((0.0, 1.0), {}),
    "initial_weights": ((np.zeros(6), np.arange(6)), {}),
    "on_truncation": (("bootstrap", "terminate"), {}),
    "bit_generator": (("PCG64", "MT19937"), {}),
    "seeds": (([0], [1]), {}),
    "max_episode_steps": ((12, 3), {}),
    "env_kwargs": (({"mean": 0.0}, {"mean": 4.0}), {"env": "qtab/KArmedBandit-v0", "policy": np.zeros(1, int)}),
}
NEUTRAL = {
    **dict.fromkeys(("env", "method"), "every pair of values has one"),
    **dict.fromkeys(("threads", "progress", "record"), "they say how to compute and what to keep"),
    **dict.fromkeys(
        OF_OBSERVATIONS,
        "they are for a Box of observations, as the tests of its estimates show",
    ),
}
NEEDED: dict[str, dict[str, Any]] = {
    "n_step_td": {"n_steps": 2},
    "td_lambda": TRACES,
    "true_online_td_lambda": TRACES,
    "offline_lambda_return": TRACES,
    "importance_sampling": {"behavior": "random"},
    "off_policy_td": {"behavior": "random", "learning_rate": 0.3},
    "off_policy_td_lambda": {"behavior": "random", **TRACES},
    "gtd2": {"learning_rate": 0.3, "second_learning_rate": 0.2},
    "tdc": {"learning_rate": 0.3, "second_learning_rate": 0.2},
    "emphatic_td": {"learning_rate": 0.05},
}


def test_every_setting_has_two_values_here_or_a_reason_why_not() -> None:
    assert inspect.signature(qtab.estimate_values).parameters.keys() == PAIRS.keys() | NEUTRAL.keys()


@pytest.mark.parametrize("method", METHODS)
def test_a_setting_changes_the_estimates_or_is_refused(method: Any) -> None:
    for name, (values, common) in PAIRS.items():
        weights = []
        for value in values:
            given = {"policy": OFTEN_FIRST, "episodes": 20, "max_episode_steps": 12, "seeds": [0], "discount": 0.9}
            given |= {"env": random_mdp(6, 2, actions=3), "method": method, **NEEDED.get(method, {}), **common}
            try:
                weights.append(qtab.estimate_values(**{**given, name: value}, progress=False).weights[:, -1])
            except ValueError as error:
                if str(error).split(" ", 1)[0] not in (name, "method", *common):
                    raise
                break
        else:
            assert weights[0].tobytes() != weights[1].tobytes(), f"{name} is ignored"
