"""Planning by expected updates: equal to plain NumPy, and converging to the optimum."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from qtab.envs.book.random_mdp import random_mdp
from qtab.reference import dynamic_programming as reference


@settings(max_examples=settings().max_examples // 2)
@given(
    seed=st.integers(0, 2**40),
    states=st.integers(1, 12),
    branching=st.integers(1, 4),
    epsilon=st.one_of(st.none(), st.sampled_from([0.0, 0.1, 1.0])),
    parts=st.lists(st.integers(0, 60), min_size=1, max_size=4),
)
def test_updates_equal_the_reference(seed, states, branching, epsilon, parts):
    env = random_mdp(states, branching, seed % 1000)
    distribution = {"distribution": "uniform"} if epsilon is None else {"distribution": "on_policy", "epsilon": epsilon}
    planning = qtab.planning.ExpectedUpdates(env, discount=0.9, seed=seed, **distribution)
    for updates in parts:
        planning.advance(updates)
    expected = reference.expected_updates(env.P, env.initial_state_distrib, 0.9, epsilon, seed, sum(parts))
    assert planning.q_values.tobytes() == expected.tobytes()


@pytest.mark.parametrize("distribution", ["uniform", "on_policy"])
def test_both_distributions_find_the_optimum(distribution):
    env = random_mdp(20, 2, seed=3)
    planning = qtab.planning.ExpectedUpdates(env, distribution, epsilon=0.3)
    assert planning.greedy_return() == pytest.approx(qtab.policy_values(env, [0] * 20).expected_return, rel=1e-7)
    planning.advance(20_000)
    best = qtab.optimum(env, method="policy_iteration")
    assert planning.greedy_return() == pytest.approx(best.values[0], rel=1e-7)


def test_bad_arguments_are_refused():
    for arguments, error, message in (
        ({"distribution": "even"}, ValueError, "distribution must be one of"),
        ({"discount": -1}, ValueError, "discount must lie in"),
        ({"epsilon": 2.0}, ValueError, "epsilon must lie in"),
        ({"seed": -1}, ValueError, "seed must be an integer of at least 0"),
    ):
        with pytest.raises(error, match=message):
            qtab.planning.ExpectedUpdates("FrozenLake-v1", **arguments)
    planning = qtab.planning.ExpectedUpdates("FrozenLake-v1")
    with pytest.raises(ValueError, match="updates must be"):
        planning.advance(-1)
    with pytest.raises(TypeError, match="updates must be"):
        planning.advance(1.5)  # type: ignore[arg-type]
    assert np.array_equal(planning.q_values, np.zeros((16, 4)))
