"""The best policy known that does not depend on the number of steps taken."""

import itertools
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import qtab


def test_frozen_lake_is_worth_less_to_a_policy_that_ignores_the_time() -> None:
    best = qtab.optimum("FrozenLake-v1")
    known = best.stationary
    assert known is not None
    assert 0.7401648 < known.expected_return < best.expected_return - 0.004
    assert (known.proven, known.label) == (False, "best known")
    assert known.policy.shape == (16,)
    assert "0.740165 by the best known policy that ignores the time" in str(best)
    assert "0.740165" in best._repr_html_()
    run = qtab.train("FrozenLake-v1", seed=0, episodes=300)
    gap = best.gap(run)
    assert gap.attainable == known.expected_return
    assert "due to the table, whose best known policy returns 0.7402, and" in str(gap)
    assert "best known with this table" in gap._repr_html_()


@pytest.mark.parametrize("name", ["CliffWalking-v1", "Taxi-v4"])
def test_it_is_proven_where_no_policy_returns_more(name: str) -> None:
    best = qtab.optimum(name)
    known = best.stationary
    assert known is not None
    assert (known.proven, known.label) == (True, "best")
    assert known.expected_return == pytest.approx(best.expected_return, rel=1e-12)
    assert best.gap(qtab.train(name, seed=0, episodes=20)).approximation == 0


def test_it_is_proven_where_its_rewards_cancel() -> None:
    # Two ways whose first three rewards sum to 0, up to rounding: 0.1 + 0.2 - 0.3, and then 1; or 0.3 + 0.1 - 0.4.
    steps = {1: (2, 0.2, False), 2: (3, -0.3, False), 3: (3, 1.0, True), 4: (5, 0.1, False), 5: (5, -0.4, True)}
    ways = {0: {0: [(1.0, 1, 0.1, False)], 1: [(1.0, 4, 0.3, False)]}}
    table = ways | {state: {action: [(1.0, *step)] for action in range(2)} for state, step in steps.items()}
    best = qtab.optimum(qtab.TabularEnv(table, [1.0, 0, 0, 0, 0, 0]), max_episode_steps=3)
    known = best.stationary
    assert known is not None
    assert known.expected_return != best.expected_return
    assert (known.proven, known.label) == (True, "best")


def test_it_is_not_proven_where_large_rewards_hide_that_another_policy_returns_more() -> None:
    size, steps = 1e6, 100_000
    first = {action: [(1.0, 1, size, False)] for action in range(2)}
    second = {0: [(1.0, 0, -size + 0.04 / (steps / 2), False)], 1: [(1.0, 1, -size + 0.04, True)]}
    best = qtab.optimum(qtab.TabularEnv({0: first, 1: second}, [1.0, 0.0]), max_episode_steps=steps)
    known = best.stationary
    assert known is not None
    assert best.expected_return == pytest.approx(0.08, abs=1e-5)
    assert known.expected_return < best.expected_return - 0.03
    assert not known.proven


def test_it_is_known_where_the_sum_of_the_magnitudes_of_its_rewards_overflows() -> None:
    rewards = (9e307, -9e307, 1.0)
    table = {state: {0: [(1.0, min(state + 1, 2), reward, state == 2)]} for state, reward in enumerate(rewards)}
    best = qtab.optimum(qtab.TabularEnv(table, [1.0, 0.0, 0.0]), max_episode_steps=3)
    assert "stationary" in str(best) or best.stationary is not None


def test_it_is_not_known_for_a_search_or_a_large_table() -> None:
    walk = {state: {0: [(1.0, state - 1, -1.0, state == 1)]} for state in range(1, 2100)}
    large = qtab.TabularEnv({0: {0: [(1.0, 0, 0.0, True)]}, **walk}, [0.0] * 2099 + [1.0])
    assert qtab.optimum(large).stationary is None


@st.composite
def tables(draw: st.DrawFn) -> Any:
    probability = st.sampled_from([0.25, 0.5, 0.75])
    outcome = st.tuples(st.integers(0, 2), st.integers(-3, 3).map(float), st.booleans())

    def outcomes() -> Any:
        first, second = draw(outcome), draw(outcome)
        share = draw(probability)
        return [(share, *first), (1.0 - share, *second)]

    return {state: {action: outcomes() for action in range(2)} for state in range(3)}


@given(tables(), st.integers(1, 12))
def test_it_returns_what_it_claims_and_no_single_change_helps(table: Any, limit: int) -> None:
    env = qtab.TabularEnv(table, [0.5, 0.5, 0.0])
    best = qtab.optimum(env, max_episode_steps=limit)
    known, planner = best.stationary, best.solver._planner  # type: ignore[union-attr]
    assert known is not None
    policies = [np.array(actions) for actions in itertools.product(range(2), repeat=3)]
    returns = [planner.policy_return(policy, limit) for policy in policies]
    assert known.expected_return == planner.policy_return(known.policy, limit)
    # No change of a single action helps.
    for state in range(3):
        changed = known.policy.copy()
        changed[state] = 1 - changed[state]
        assert planner.policy_return(changed, limit) <= known.expected_return + 1e-9
    assert known.expected_return <= max(returns) + 1e-12
    if known.proven:
        assert known.expected_return == pytest.approx(max(returns), abs=1e-9)
    # A stationary policy is one that depends on the time, but does not change.
    repeated = np.tile(known.policy, (limit, 1))
    assert planner.policy_return(repeated, limit) == known.expected_return


def test_the_command_reports_it(capsys: pytest.CaptureFixture[str]) -> None:
    from qtab.cli import main

    assert main(["optimum", "FrozenLake-v1", "--json"]) == 0
    written = capsys.readouterr().out
    assert '"stationary_return": 0.74016' in written
    assert '"stationary_proven": false' in written


def test_actions_are_numbered_as_the_environment_numbers_them() -> None:
    table = {0: {0: [(1.0, 0, 0.0, True)], 1: [(1.0, 0, 1.0, True)]}}
    env = qtab.TabularEnv(table, [1.0])
    env.action_space = gym.spaces.Discrete(2, start=3)
    known = qtab.optimum(env).stationary
    assert known is not None
    assert known.policy.tolist() == [4]
