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
    **dict.fromkeys(
        ("backend", "threads", "progress", "record", "memory_limit"), "they say how to compute and what to keep"
    ),
    **dict.fromkeys(OF_OBSERVATIONS, "they are for a Box of observations, and have two values below"),
}
RADIAL: dict[str, Any] = {"discretizer": "radial", "learning_rate": 0.1}
FOURIER: dict[str, Any] = {"discretizer": "fourier", "learning_rate": 0.1}
CAR = "MountainCar-v0"
BOXES: dict[str, tuple[tuple[Any, Any], dict[str, Any]]] = {
    "discretizer": (("bins", "tiles"), {}),
    "tilings": ((4, 8), {"discretizer": "tiles"}),
    "tiles": ((4, 8), {"discretizer": "tiles"}),
    "hashed_rows": ((7, 11), {"discretizer": "tiles"}),
    "bins": ((10, 20), {"discretizer": "bins"}),
    "edges": ((((-0.5,), (0.0,)), ((-0.52, -0.48), (0.0,))), {"discretizer": "edges"}),
    "scale": (((10, 100), (20, 100)), {"discretizer": "round"}),
    "low": (((-1.2, -0.07), (-0.7, -0.07)), {"discretizer": "bins", "bins": 10, "high": (0.6, 0.07)}),
    "high": (((0.6, 0.07), (-0.3, 0.07)), {"discretizer": "bins", "bins": 10, "low": (-1.2, -0.07)}),
    "order": ((2, 3), FOURIER),
    "coupled": ((True, False), FOURIER),
    "scale_step_sizes": ((True, False), FOURIER),
    "centers": ((4, 5), RADIAL),
    "width": ((1.0, 0.5), RADIAL),
    "normalized": ((True, False), RADIAL),
    "radius": ((1.5, 1.0), {"discretizer": "coarse", "learning_rate": 0.1}),
    "actions": ((2, 3), {"env": "Pendulum-v1", "discretizer": "bins", "bins": 2}),
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


def test_every_setting_of_a_box_has_two_values_here() -> None:
    assert set(BOXES) == set(OF_OBSERVATIONS)


@pytest.mark.parametrize("name", BOXES)
def test_a_setting_of_a_box_changes_the_estimates(name: str) -> None:
    values, common = BOXES[name]
    given: dict[str, Any] = {"env": CAR, "policy": "random", "episodes": 3, "max_episode_steps": 40, "seeds": [0]}
    found = [qtab.estimate_values(**{**given, **common, name: value}, progress=False) for value in values]
    at = np.array([[1.0, 0.0, 0.0]] if "env" in common else [[-0.5, 0.0], [-0.55, 0.005]], np.float32)
    assert found[0].value(at).tobytes() != found[1].value(at).tobytes(), f"{name} is ignored"


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
