"""Dynamic programming by steps: equal to plain NumPy, and converging to what is known."""

from itertools import islice, pairwise
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from qtab.envs.book.random_mdp import random_mdp
from qtab.envs.grid_worlds import grid_world_4x4
from qtab.reference import dynamic_programming as reference


@settings(max_examples=settings().max_examples // 2)
@given(
    seed=st.integers(0, 10_000),
    states=st.integers(1, 12),
    branching=st.integers(1, 4),
    actions=st.integers(1, 4),
    discount=st.sampled_from([0.0, 0.3, 0.9, 1.0]),
    in_place=st.booleans(),
)
def test_sweeps_equal_the_reference(seed, states, branching, actions, discount, in_place):
    env = random_mdp(states, branching, seed, actions=actions)
    policy = np.random.default_rng(seed).dirichlet(np.ones(actions), size=states)
    for chosen, swept in (
        (policy, qtab.planning.policy_evaluation(env, policy, discount, in_place=in_place)),
        (None, qtab.planning.value_iteration(env, discount, in_place=in_place)),
    ):
        values = [0.0] * states
        for made in islice(swept, 4):
            assert made.tobytes() == np.array(values).tobytes()
            values = reference.sweep(env.P, values, discount, chosen, in_place)


def test_sweeps_converge_to_the_values_of_the_policy_and_of_the_optimum():
    env = grid_world_4x4()
    evaluated = next(islice(qtab.planning.policy_evaluation(env, "random"), 500, None))
    np.testing.assert_allclose(evaluated, qtab.policy_values(env, "random").values, atol=1e-9)
    best = next(islice(qtab.planning.value_iteration("FrozenLake-v1", 0.95), 500, None))
    np.testing.assert_allclose(best, qtab.optimum("FrozenLake-v1", discount=0.95, method="value_iteration").values)


def test_the_arrays_are_the_callers():
    sweeps = qtab.planning.value_iteration("FrozenLake-v1")
    next(sweeps)[:] = 7.0
    after = next(sweeps)
    assert after.max() < 1


def test_policy_iteration_improves_to_the_optimum():
    steps = list(qtab.planning.policy_iteration("FrozenLake-v1", 0.95))
    assert (steps[0].policy == 0).all()
    for before, after in pairwise(steps):
        assert (after.values >= before.values - 1e-12).all()
        assert (after.policy != before.policy).any()
    best = qtab.optimum("FrozenLake-v1", discount=0.95, method="policy_iteration")
    np.testing.assert_allclose(steps[-1].values, best.values, atol=1e-12)
    again = list(qtab.planning.policy_iteration("FrozenLake-v1", 0.95, policy=steps[-1].policy))
    assert len(again) == 1


@pytest.mark.parametrize("method", ["policy_evaluation", "value_iteration", "policy_iteration"])
def test_bad_arguments_are_refused_at_once(method):
    def call(env, *arguments, **settings):
        given = ("random",) if method == "policy_evaluation" else ()
        return getattr(qtab.planning, method)(env, *given, *arguments, **settings)

    for env, arguments, error, message in (
        (3, {}, TypeError, "env must be an environment id"),
        ("MountainCar-v0", {}, ValueError, "env must have a transition table P"),
        ("FrozenLake-v1", {"discount": 1.5}, ValueError, r"discount must lie in \[0, 1\], got 1.5"),
        ("FrozenLake-v1", {"env_kwargs": 3}, TypeError, "env_kwargs must map names to values, got 3"),
        (gym.make("FrozenLake-v1"), {"env_kwargs": {}}, ValueError, "env_kwargs must be None"),
    ):
        with pytest.raises(error, match=message):
            call(env, **arguments)


def test_policies_that_do_not_fit_are_refused():
    for policy, message in (
        ([0, 1], r"policy must have the shape \(16,\) of actions"),
        (np.full((16, 4), 0.3), "policy must sum to 1 in every state"),
    ):
        with pytest.raises(ValueError, match=message):
            qtab.planning.policy_evaluation("FrozenLake-v1", policy)
    with pytest.raises(ValueError, match="policy must take one action in each state"):
        qtab.planning.policy_iteration("FrozenLake-v1", policy="random")
    wrong: Any = "yes"
    with pytest.raises(TypeError, match="in_place must be True or False"):
        qtab.planning.value_iteration("FrozenLake-v1", in_place=wrong)
