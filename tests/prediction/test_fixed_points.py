"""Sampled methods reach the fixed points that theory gives, those of linear_geometry, from the transition table.

The mean of the last weights over the seeds is compared with the fixed point, within 4.5 standard errors and a bias:
with a step size that falls to nearly zero, weights still move towards the fixed point, and LSTD begins with ε.
"""

from functools import cache
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from numpy.typing import NDArray

import qtab
from qtab.prediction import LinearGeometry, ValueEstimates, linear_geometry

WALK, BOYAN, BAIRD = "qtab/RandomWalk-v0", "qtab/BoyanChain-v0", "qtab/BairdCounterexample-v0"
GAMMA = 0.9
FEATURES = np.random.default_rng(1).uniform(-1.0, 1.0, (7, 2))
"""Features that cannot represent the values, so that the fixed points of different methods are apart."""
SEVEN: dict[str, Any] = {"env_kwargs": {"states": 7}}
LEAN, LEANER = np.tile([0.4, 0.6], (7, 1)), np.tile([0.3, 0.7], (7, 1))
FALLING: dict[str, Any] = {"learning_rate": 0.2, "min_learning_rate": 0.001}


@cache
def walk(trace_decay: float, *, off_policy: bool) -> LinearGeometry:
    behavior = {"behavior": LEAN} if off_policy else {}
    policy = LEANER if off_policy else LEAN
    return linear_geometry(WALK, policy, FEATURES, GAMMA, trace_decay=trace_decay, **behavior, **SEVEN)  # type: ignore[arg-type]


def emphatic_fixed_point() -> NDArray[np.float64]:
    """The fixed point of TD under the emphatic weighting f = (I - γPᵀ)⁻¹ μ of the states (section 11.8)."""
    geometry = walk(0.0, off_policy=True)
    identity = np.eye(len(geometry.values))
    emphasis = np.linalg.solve(identity - GAMMA * geometry.transition_matrix.T, geometry.distribution)
    weighted = linear_geometry(WALK, LEANER, FEATURES, GAMMA, distribution=emphasis / emphasis.sum(), **SEVEN)
    return weighted.td_fixed_point


def assert_near(found: ValueEstimates, expected: NDArray[np.float64], bias: float) -> None:
    weights = found.weights[:, -1]
    error = weights.std(axis=0, ddof=1) / np.sqrt(len(weights))
    assert error.max() < 0.05  # so that the bounds below can fail
    assert (np.abs(weights.mean(axis=0) - expected) < 4.5 * error + bias).all()


CASES: dict[str, tuple[dict[str, Any], float, bool]] = {
    "td": ({}, 0.0, False),
    "n_step_td": ({"n_steps": 1}, 0.0, False),
    "td_lambda": ({"trace_decay": 0.6}, 0.6, False),
    "true_online_td_lambda": ({"trace_decay": 0.6}, 0.6, False),
    "lstd": ({}, 0.0, False),
    "off_policy_td": ({}, 0.0, True),
    "off_policy_td_lambda": ({"trace_decay": 0.6}, 0.6, True),
    "gtd2": ({"second_learning_rate": 0.2}, 0.0, True),
    "tdc": ({"second_learning_rate": 0.2}, 0.0, True),
}


@pytest.mark.parametrize("method", CASES)
def test_a_method_reaches_the_fixed_point_of_td(method: Any) -> None:
    options, trace_decay, off_policy = CASES[method]
    given: dict[str, Any] = {**options, **SEVEN, "episodes": 2000, "record": 2000, "seeds": 30, "discount": GAMMA}
    given |= {} if method == "lstd" else FALLING
    given |= {"behavior": LEAN} if off_policy else {}
    policy = LEANER if off_policy else LEAN
    found = qtab.estimate_values(WALK, policy, method=method, features=FEATURES, **given)
    assert_near(found, walk(trace_decay, off_policy=off_policy).td_fixed_point, 0.01)


def test_the_fixed_points_are_apart() -> None:
    best = walk(0.0, off_policy=False).minimizer("value_error")
    for off_policy, other in ((False, best), (True, emphatic_fixed_point())):
        points = [other, *(walk(decay, off_policy=off_policy).td_fixed_point for decay in (0.0, 0.6))]
        assert all(np.abs(points[index] - points[index - 1]).max() > 0.08 for index in range(3))


def test_monte_carlo_minimizes_the_value_error() -> None:
    best = walk(0.0, off_policy=False).minimizer("value_error")
    found = qtab.estimate_values(
        WALK,
        LEAN,
        method="monte_carlo",
        features=FEATURES,
        episodes=2000,
        record=2000,
        seeds=30,
        discount=GAMMA,
        **FALLING,
        **SEVEN,
    )
    assert_near(found, best, 0.01)


def test_emphatic_td_reaches_the_fixed_point_of_its_weighting() -> None:
    found = qtab.estimate_values(
        WALK,
        LEANER,
        method="emphatic_td",
        behavior=LEAN,
        features=FEATURES,
        learning_rate=0.05,
        min_learning_rate=0.0005,
        episodes=4000,
        record=4000,
        seeds=30,
        discount=GAMMA,
        **SEVEN,
    )
    assert_near(found, emphatic_fixed_point(), 0.01)


@pytest.mark.parametrize(("trace_decay", "recursive"), [(0.0, True), (0.7, True), (0.7, False)])
def test_lstd_finds_the_exact_weights_of_boyans_chain(trace_decay: float, recursive: bool) -> None:
    env: Any = gym.make(BOYAN).unwrapped
    arguments: dict[str, Any] = {"features": env.features, "episodes": 1000, "record": [100, 1000], "seeds": 30}
    options: dict[str, Any] = {"trace_decay": trace_decay, "recursive": recursive}
    found = qtab.estimate_values(BOYAN, "random", method="lstd", **options, **arguments)
    exact = linear_geometry(BOYAN, "random", env.features).td_fixed_point
    np.testing.assert_allclose(exact, [-24, -16, -8, 0], atol=1e-9)
    assert_near(found, exact, 0.02)
    td = qtab.estimate_values(BOYAN, "random", learning_rate=0.1, **arguments)
    errors = [one.rms_error(linear_geometry(BOYAN, "random").values).mean(axis=0) for one in (found, td)]
    assert (errors[0] < 0.5 * errors[1]).all()


def test_on_bairds_counterexample_td_diverges_and_tdc_does_not() -> None:
    env: Any = gym.make(BAIRD).unwrapped
    geometry = linear_geometry(env, env.target, env.features, 0.99, behavior=env.behavior)
    arguments: dict[str, Any] = {
        "policy": env.target,
        "behavior": env.behavior,
        "features": env.features,
        "initial_weights": [1, 1, 1, 1, 1, 1, 10, 1],
        "discount": 0.99,
        "episodes": 10,
        "max_episode_steps": 1000,
        "seeds": 20,
        "record": [0, 1, 10],
    }
    for method in ("tdc", "gtd2"):
        found = qtab.estimate_values(BAIRD, method=method, learning_rate=0.005, second_learning_rate=0.05, **arguments)
        errors = np.sqrt(geometry.projected_bellman_error(found.weights)).mean(axis=0)
        assert errors[0] > 8.0
        assert errors[2] < 0.05
    # "which remains almost 2": the value error of TDC after 1,000 steps in Figure 11.5
    tdc = qtab.estimate_values(BAIRD, method="tdc", learning_rate=0.005, second_learning_rate=0.05, **arguments)
    assert np.sqrt(geometry.value_error(tdc.weights[:, 1])).mean() == pytest.approx(2.0, abs=0.15)
    with pytest.raises(OverflowError, match="the values diverged in episode"):
        qtab.estimate_values(BAIRD, method="off_policy_td", learning_rate=1.0, **arguments)
