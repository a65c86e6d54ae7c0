"""A solution depends neither on states that cannot follow, nor on how states are numbered."""

from itertools import islice
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import qtab

METHODS = ("value_iteration", "policy_iteration", "finite_horizon")
STEPS = 30

THERE_AND_BACK = {
    0: {0: [(1.0, 1, 1.0, False)], 1: [(1.0, 0, 0.5, True)]},
    1: {0: [(1.0, 0, -1.0, False)], 1: [(1.0, 0, -1.0, False)]},
}
"""A way there and back without a gain, and an exit that is worth 0.5."""
IDLE = {
    0: {0: [(1.0, 0, 0.0, False)], 1: [(1.0, 1, -2.0, True)]},
    1: {0: [(0.5, 0, 1.0, False), (0.5, 1, 0.0, False)], 1: [(1.0, 0, 2.0, True)]},
}
"""State 0 may stay forever without a reward, or pay to leave."""


@st.composite
def tables(draw: st.DrawFn) -> Any:
    states = draw(st.integers(1, 4))
    outcome = st.tuples(st.integers(0, states - 1), st.integers(-3, 3).map(float), st.booleans())

    def outcomes() -> Any:
        share = draw(st.sampled_from([0.25, 0.5, 1.0]))
        parts = [(share, *draw(outcome)), (1.0 - share, *draw(outcome))]
        return parts if share < 1.0 else parts[:1]

    return {state: {action: outcomes() for action in range(2)} for state in range(states)}


def env_of(table: Any) -> qtab.TabularEnv:
    return qtab.TabularEnv(table, [1.0] + [0.0] * (len(table) - 1))


def solved(table: Any, method: str, discount: float) -> Any:
    """The values and the policy; the kind of error where there are none."""
    try:
        found = qtab.optimum(env_of(table), method=method, discount=discount, max_episode_steps=STEPS)
    except ValueError as error:
        return None, str(error).split(": ")[1].split(" state ")[0]
    return found.values, found.policy


def with_a_neighbor(table: Any, reward: float) -> Any:
    """The table and another state, which nothing leads to."""
    count = len(table)
    return {**table, count: {0: [(1.0, count, reward, True)], 1: [(1.0, 0, reward, True)]}}


def renumbered(table: Any, numbers: list[int]) -> Any:
    """The table with other numbers: the state ``s`` is ``numbers[s]`` there."""
    moved = {
        numbers[state]: {
            action: [(p, numbers[following], *rest) for p, following, *rest in outcomes]
            for action, outcomes in row.items()
        }
        for state, row in table.items()
    }
    return dict(sorted(moved.items()))


DISCOUNTS = st.sampled_from([0.5, 0.95, 1.0])


@pytest.mark.parametrize("method", METHODS)
@settings(max_examples=settings().max_examples // 2)
@example(THERE_AND_BACK, 1.0, -1e16)
@given(tables(), DISCOUNTS, st.sampled_from([-1e16, 1e11]))
def test_a_large_value_elsewhere_changes_nothing(method: str, table: Any, discount: float, reward: float) -> None:
    alone, beside = solved(table, method, discount), solved(with_a_neighbor(table, reward), method, discount)
    if alone[0] is None:
        assert beside == alone
        return
    np.testing.assert_array_equal(beside[0][:-1], alone[0])
    np.testing.assert_array_equal(beside[1][:-1], alone[1])
    assert beside[0][-1] == reward


@pytest.mark.parametrize("method", METHODS)
@settings(max_examples=settings().max_examples // 2)
@example(THERE_AND_BACK, 1.0, [1, 0, 2, 3])
@example(IDLE, 1.0, [1, 0, 2, 3])
@given(tables(), DISCOUNTS, st.permutations(range(4)))
def test_other_numbers_of_the_states_change_nothing(
    method: str, table: Any, discount: float, numbers: list[int]
) -> None:
    numbers = [number for number in numbers if number < len(table)]
    first, second = solved(table, method, discount), solved(renumbered(table, numbers), method, discount)
    if first[0] is None:
        assert second == first
        return
    np.testing.assert_allclose(second[0][numbers], first[0], rtol=1e-11, atol=1e-11)
    np.testing.assert_array_equal(second[1][numbers], first[1])


@settings(max_examples=settings().max_examples // 2)
@example(THERE_AND_BACK, 1.0)
@example(IDLE, 1.0)
@given(tables(), DISCOUNTS)
def test_the_values_are_those_of_the_policy(table: Any, discount: float) -> None:
    for method in METHODS[:2]:
        values, policy = solved(table, method, discount)
        if values is not None:
            evaluated = qtab.policy_values(env_of(table), policy, discount)
            np.testing.assert_allclose(values, evaluated.values, rtol=0, atol=1e-11 + 4 * evaluated.error)
    # Both refuse the same tables.
    refused = [solved(table, method, discount)[1] for method in METHODS[:2]]
    assert isinstance(refused[0], str) == isinstance(refused[1], str)


@settings(max_examples=settings().max_examples // 2)
@given(tables(), st.sampled_from([-1e16, 1e11]))
def test_no_step_of_policy_iteration_sees_a_large_value_elsewhere(table: Any, reward: float) -> None:
    alone, beside = (
        list(islice(qtab.planning.policy_iteration(env_of(one), 0.9), 20))
        for one in (table, with_a_neighbor(table, reward))
    )
    assert len(alone) == len(beside)
    for ours, theirs in zip(alone, beside, strict=True):
        np.testing.assert_array_equal(theirs.policy[:-1], ours.policy)
        np.testing.assert_array_equal(theirs.values[:-1], ours.values)


@pytest.mark.parametrize("penalty", [-1e9, -1e11])
def test_small_differences_are_seen_beside_a_large_penalty(penalty: float) -> None:
    start = {number: [(1.0, 0, reward, True)] for number, reward in enumerate((-1.05, -1.0, penalty))}
    env = qtab.TabularEnv({0: start, 1: {number: [(1.0, 1, penalty, True)] for number in start}}, [1.0, 0.0])
    for method in METHODS:
        found = qtab.optimum(env, method=method)
        assert (found.values.tolist(), found.policy[0]) == ([-1.0, penalty], 1)
    last = list(qtab.planning.policy_iteration(env))[-1]
    assert (last.values.tolist(), last.policy[0]) == ([-1.0, penalty], 1)


@pytest.mark.parametrize("count", [8, 40])
def test_a_corridor_beside_a_large_value_has_its_length(count: int) -> None:
    ahead = {state: {0: [(1.0, state + 1, -1.0, state == count - 1)]} for state in range(count)}
    env = qtab.TabularEnv({**ahead, count: {0: [(1.0, 0, -1e16, True)]}}, [1.0] + [0.0] * count)
    for method in METHODS:
        assert qtab.optimum(env, method=method).values[:count].tolist() == [
            -float(count - state) for state in range(count)
        ]
    assert qtab.policy_values(env, [0] * (count + 1)).values[0] == -count


def test_a_cycle_without_an_exit_is_refused_by_both_iterations() -> None:
    cycle = {0: {0: [(1.0, 1, 1.0, False)]}, 1: {0: [(1.0, 0, -1.0, False)]}}
    for numbers in ([0, 1], [1, 0]):
        for method in METHODS[:2]:
            with pytest.raises(ValueError, match="from state 0 no episode ends"):
                qtab.optimum(env_of(renumbered(cycle, numbers)), method=method)


def test_states_that_are_never_left_without_a_reward_are_worth_nothing() -> None:
    """As the goal of a table that does not flag it as terminal."""
    goal = {
        0: {0: [(1.0, 1, 1.0, False)], 1: [(1.0, 0, -1.0, False)]},
        1: {0: [(1.0, 1, 0.0, False)], 1: [(1.0, 1, 0.0, False)]},
    }
    for method in METHODS[:2]:
        assert qtab.optimum(env_of(goal), method=method).values.tolist() == [1.0, 0.0]
    assert qtab.policy_values(env_of(goal), [0, 0]).values.tolist() == [1.0, 0.0]


def test_staying_without_a_reward_is_considered_by_value_iteration_alone() -> None:
    assert qtab.optimum(env_of(IDLE), method="value_iteration").values.tolist() == [0.0, 2.0]
    assert qtab.optimum(env_of(IDLE), method="policy_iteration").values.tolist() == [-2.0, 2.0]
