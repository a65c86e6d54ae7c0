"""Long episodes have exact values, and values beyond the range of float64 are errors."""

from collections.abc import Callable
from itertools import islice
from typing import Any

import numpy as np
import pytest

import qtab


def rarely_ending(steps: float, states: int = 1) -> qtab.TabularEnv:
    """A reward of 1 for each step; the last of some states in a row ends the episode after so many steps on average."""
    table = {state: {0: [(1.0, state + 1, 0.0, False)]} for state in range(states - 1)}
    last = states - 1
    table[last] = {0: [(1.0 - 1.0 / steps, last, 1.0, False), (1.0 / steps, last, 1.0, True)]}
    return qtab.TabularEnv(table, np.eye(1, states)[0])


@pytest.mark.parametrize("steps", [1e4, 1e6])
@pytest.mark.parametrize("states", [1, 30])
def test_long_episodes_have_exact_values(steps: float, states: int) -> None:
    env = rarely_ending(steps, states)
    policy = [0] * states
    found = qtab.policy_values(env, policy)
    assert found.expected_return == pytest.approx(steps, rel=1e-14 * steps)
    assert abs(found.expected_return - steps) <= found.error < 1e-14 * steps**2
    assert found.visits[-1] == pytest.approx(steps, rel=1e-14 * steps)
    for method in ("value_iteration", "policy_iteration"):
        best = qtab.optimum(env, method=method, max_episode_steps=1)
        assert best.values[0] == pytest.approx(steps, rel=1e-14 * steps)
    planning = qtab.planning.ExpectedUpdates(env)
    assert planning.greedy_return() == pytest.approx(steps, rel=1e-14 * steps)
    planning.advance(100)
    assert planning.greedy_return() == pytest.approx(steps, rel=1e-14 * steps)


def test_a_discount_close_to_1_is_solved_by_both_iterations() -> None:
    env = rarely_ending(1e9)
    expected = 1.0 / (1.0 - 0.999999 * (1.0 - 1e-9))
    for method in ("value_iteration", "policy_iteration"):
        best = qtab.optimum(env, method=method, discount=0.999999, max_episode_steps=1)
        assert best.values[0] == pytest.approx(expected, rel=1e-9)


def test_an_endless_greedy_policy_is_refused_at_once() -> None:
    env = qtab.TabularEnv({0: {0: [(1.0, 0, -1.0, False)], 1: [(1.0, 0, -9.0, True)]}}, [1.0])
    planning = qtab.planning.ExpectedUpdates(env)
    planning.advance(2)
    with pytest.raises(ValueError, match="policy must end every episode: from state 0 no episode ends"):
        planning.greedy_return()


def test_values_that_do_not_settle_name_what_would_help() -> None:
    """Rounded probabilities add up to more than the discount takes away."""
    env = qtab.TabularEnv({0: {0: [(0.5 + 1e-10, 0, 1.0, False), (0.5, 0, 1.0, False)]}}, [1.0])
    with pytest.raises(ValueError, match=r"^discount must be smaller, got 0\.99999999999: the values still"):
        qtab.policy_values(env, [0], discount=0.99999999999)
    with pytest.raises(ValueError, match=r"^policy must end every episode: .*; with a discount below 1 it has"):
        qtab.policy_values(env, [0])


HUGE = qtab.TabularEnv({0: {0: [(1.0, 1, 1e308, False)]}, 1: {0: [(1.0, 1, 1e308, True)]}}, [1.0, 0.0])


def _expected_updates(count: int) -> float:
    planning = qtab.planning.ExpectedUpdates(HUGE)
    planning.advance(count)
    return planning.greedy_return()


@pytest.mark.parametrize(
    "compute",
    [
        lambda: qtab.optimum(HUGE, method="value_iteration"),
        lambda: qtab.optimum(HUGE, method="policy_iteration"),
        lambda: qtab.optimum(HUGE, max_episode_steps=2),
        lambda: qtab.optimum(HUGE, method="policy_iteration", discount=0.0, max_episode_steps=2),
        lambda: qtab.policy_values(HUGE, [0, 0]),
        lambda: list(qtab.planning.policy_iteration(HUGE)),
        lambda: list(islice(qtab.planning.value_iteration(HUGE), 4)),
        lambda: list(islice(qtab.planning.policy_evaluation(HUGE, [0, 0]), 4)),
        lambda: _expected_updates(0),
        lambda: _expected_updates(4),
    ],
)
def test_values_beyond_the_range_of_float64_are_errors(compute: Callable[[], Any]) -> None:
    with pytest.raises(OverflowError, match=r"rewards must be smaller: the return from state [01] exceeds the range"):
        compute()


def test_values_within_the_range_are_not() -> None:
    assert qtab.optimum(HUGE, max_episode_steps=1).expected_return == 1e308
    assert qtab.policy_values(HUGE, [0, 0], 0.5).values.tolist() == [1.5e308, 1e308]


def test_nothing_is_postponed_for_a_rounding_error() -> None:
    """The same rewards in another order and a step later add up to one unit more in the last place."""
    rows = [(1, 0.1), (2, 0.2), (2, 0.3), (4, 0.0), (5, 0.2), (5, 0.1)]
    table = {
        state: {action: [(1.0, following, reward, state in (2, 5))] for action in range(2)}
        for state, (following, reward) in enumerate(rows)
    }
    table[0][1] = [(1.0, 3, 0.3, False)]
    assert 0.3 + (0.0 + (0.2 + 0.1)) > 0.1 + (0.2 + 0.3)
    best = qtab.optimum(qtab.TabularEnv(table, np.eye(1, 6)[0]), max_episode_steps=4)
    assert best.policy[0] == 0


def test_small_rewards_are_told_apart() -> None:
    """Within one step, the policy that waits for a larger reward earns nothing."""
    now, later = [(1.0, 0, 1e-14, True)], [(1.0, 0, 3e-14, True)]
    env = qtab.TabularEnv({0: {0: now, 1: [(1.0, 1, 0.0, False)]}, 1: {0: later, 1: later}}, [1.0, 0.0])
    known = qtab.optimum(env, max_episode_steps=1).stationary
    assert known is not None
    assert known.expected_return == 1e-14
