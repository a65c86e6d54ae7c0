"""Sampled and expected off-policy updates: equal in the mean, and sampled ones to the bit those of estimate_values."""

from collections.abc import Iterator
from itertools import islice
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from numpy.typing import NDArray

import qtab
from qtab.envs.book.random_mdp import random_mdp
from qtab.prediction import LinearGeometry, expected_updates, linear_geometry
from qtab.prediction.reference.off_policy import (
    GTD2,
    TDC,
    EmphaticTD,
    OffPolicyUpdate,
    SemiGradientTD,
    transitions,
    weights_by_step,
)

METHODS: dict[Any, type[OffPolicyUpdate]] = {
    "td": SemiGradientTD,
    "gtd2": GTD2,
    "tdc": TDC,
    "emphatic_td": EmphaticTD,
}
GAMMA = 0.9
Table = NDArray[np.float64]


class Problem:
    """A random process with features, a target policy and a behavior."""

    def __init__(self, states: int, features: int, seed: int = 0, termination: float = 0.1) -> None:
        rng = np.random.default_rng(seed)
        self.env = random_mdp(states, 2, seed, actions=2, termination=termination)
        self.target, self.behavior = rng.dirichlet(np.ones(2), size=(2, states))
        self.features = rng.standard_normal((states, features))
        self.w, self.v = rng.standard_normal((2, features))

    def geometry(self, **arguments: Any) -> LinearGeometry:
        given = {} if "distribution" in arguments else {"behavior": self.behavior}
        return linear_geometry(self.env, self.target, self.features, GAMMA, **{**given, **arguments})

    def steps(self, state: int) -> Iterator[tuple[float, float, float, int, bool]]:
        """The probability under the behavior, the ratio, the reward, the next state and the end of each transition."""
        for action, outcomes in self.env.P[state].items():
            ratio = self.target[state, action] / self.behavior[state, action]
            for probability, next_state, reward, ended in outcomes:
                yield self.behavior[state, action] * probability, ratio, reward, next_state, ended

    def x(self, state: int, ended: bool = False) -> Table:
        return np.zeros(self.features.shape[1]) if ended else self.features[state]


@pytest.mark.parametrize("name", METHODS)
def test_an_expected_update_is_the_mean_of_the_sampled_ones(name: Any) -> None:
    problem, alpha, beta = Problem(9, 4), 0.3, 0.2
    geometry = problem.geometry()
    second = beta if name in ("gtd2", "tdc") else None
    found = expected_updates(geometry, name, 2, alpha, second_learning_rate=second, initial_weights=problem.w)
    w, v = problem.w.copy(), np.zeros(4)
    # The second update of an emphatic method depends on the first step; the others only on their weights.
    for after in found[1 : 2 if name == "emphatic_td" else 3]:
        means = np.zeros((2, 4))
        for state, weight in enumerate(geometry.distribution):
            for probability, ratio, reward, next_state, ended in problem.steps(state):
                method = METHODS[name](w.copy(), alpha, GAMMA, beta)
                method.v[:] = v
                method.start_episode()
                method.update(problem.x(state), reward, problem.x(next_state, ended), ratio)
                means += weight * probability * np.array([method.w, method.v])
        np.testing.assert_allclose(means[0], after, rtol=1e-12)
        w, v = means


def test_an_expected_emphasis_is_the_mean_over_all_paths() -> None:
    """With a tiny step size, the change of the weights is the sum of the updates at the initial weights."""
    problem, alpha, length = Problem(3, 2, seed=4, termination=0.0), 1e-7, 4
    geometry = problem.geometry()
    assert np.ptp(geometry.distribution) > 0.1

    def mean_after(state: int, steps: int, method: EmphaticTD) -> Table:
        """The mean of the weights after some steps from a state."""
        if steps == 0:
            return method.w
        total = np.zeros(2)
        for probability, ratio, reward, next_state, _ in problem.steps(state):
            after = EmphaticTD(method.w.copy(), alpha, GAMMA)
            after.emphasis, after.last_rho = method.emphasis, method.last_rho
            after.update(problem.x(state), reward, problem.x(next_state), ratio)
            total += probability * mean_after(next_state, steps - 1, after)
        return total

    start = EmphaticTD(problem.w, alpha, GAMMA)
    mean = sum(weight * mean_after(state, length, start) for state, weight in enumerate(geometry.distribution))
    found = expected_updates(geometry, "emphatic_td", length, alpha, initial_weights=problem.w)
    np.testing.assert_allclose((mean - problem.w) / alpha, (found[-1] - problem.w) / alpha, rtol=1e-4)


def test_an_episode_of_emphatic_td_begins_with_an_emphasis_of_one() -> None:
    method, x = EmphaticTD(np.zeros(1), 0.5, 0.9), np.ones(1)
    method.update(x, 1.0, x, 2.0)
    method.update(x, 0.0, x, 1.0)
    assert method.emphasis == 1.0 + 0.9 * 2.0
    method.start_episode()
    method.update(x, 0.0, x, 1.0)
    assert method.emphasis == 1.0


@pytest.mark.parametrize("method", [SemiGradientTD, TDC])
def test_the_random_numbers_are_those_of_estimate_values(method: type[OffPolicyUpdate]) -> None:
    """On-policy with a table, semi-gradient TD is TD(0) to the bit, and so is TDC with a second step size of zero."""
    env = gym.make("qtab/RandomWalk-v0", states=7)
    lean = np.tile([0.4, 0.6], (7, 1))
    estimates = qtab.estimate_values(env, lean, learning_rate=0.1, episodes=5, discount=0.5, seeds=[4])
    found = weights_by_step(method(np.zeros(7), 0.1, 0.5), np.eye(7), islice(transitions(env, lean, lean, 4), 500))
    recorded = {row.tobytes() for row in found}
    assert len(recorded) > 5
    assert all(row.tobytes() in recorded for row in estimates.weights[0])


def test_a_step_size_that_is_small_enough_leads_to_the_fixed_point() -> None:
    geometry = Problem(9, 4).geometry()
    fixed = geometry.td_fixed_point
    for name, rates in {"td": (0.1,), "tdc": (0.1, 0.1), "gtd2": (0.3, 0.3)}.items():
        first, *second = rates
        found = expected_updates(geometry, name, 5000, first, second_learning_rate=second[0] if second else None)  # type: ignore[arg-type]
        np.testing.assert_allclose(found[-1], fixed, rtol=1e-6)
    traces = Problem(9, 4).geometry(trace_decay=0.7)
    np.testing.assert_allclose(expected_updates(traces, "td", 5000, 0.1)[-1], traces.td_fixed_point, rtol=1e-6)


def test_the_weight_of_two_states_with_the_values_w_and_2w_grows_as_in_the_book() -> None:
    """Section 11.2: from the first state to the second, w changes by α (2γ - 1) w, which diverges for γ > 1/2."""
    env = qtab.TabularEnv([[[(1.0, 1, 0.0, False)]], [[(1.0, 1, 0.0, True)]]], [1.0, 0.0])
    geometry = linear_geometry(env, "random", np.array([[1.0], [2.0]]), 0.99, distribution=[1.0, 0.0])
    found = expected_updates(geometry, "td", 10, 0.1, initial_weights=[10.0])
    np.testing.assert_allclose(found[:, 0], 10.0 * (1.0 + 0.1 * (2 * 0.99 - 1.0)) ** np.arange(11))
    with pytest.raises(OverflowError, match="the weights overflow in update"):
        expected_updates(geometry, "td", 20_000, 0.1, initial_weights=[10.0])


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        ({"method": "dp"}, ValueError, r"method must be one of 'td', 'gtd2', 'tdc', 'emphatic_td', got 'dp'"),
        ({"second_learning_rate": 0.1}, ValueError, "second_learning_rate must be None for method 'td'"),
        ({"method": "tdc"}, ValueError, "second_learning_rate must be given for method 'tdc'"),
        (
            {"updates": 10**12},
            MemoryError,
            "the weights of 1,000,000,000,000 updates would take .* TiB, more than half",
        ),
        ({"updates": -1}, ValueError, "updates must be"),
        ({"learning_rate": np.nan}, ValueError, "learning_rate must be finite"),
        ({"initial_weights": np.ones(3)}, ValueError, r"initial_weights must have 4 numbers, .* got shape \(3,\)"),
    ],
)
def test_bad_arguments_are_refused(changes: dict[str, Any], error: type[Exception], message: str) -> None:
    geometry = Problem(9, 4).geometry()
    with pytest.raises(error, match=message):
        expected_updates(**{"geometry": geometry, "method": "td", "updates": 1, "learning_rate": 0.1, **changes})


def test_traces_are_refused_where_they_have_no_update() -> None:
    with pytest.raises(ValueError, match=r"trace_decay must be 0 for method 'emphatic_td', got 0\.5"):
        expected_updates(Problem(9, 4).geometry(trace_decay=0.5), "emphatic_td", 1, 0.1)
