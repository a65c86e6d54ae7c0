"""Resets of toy text equal Gymnasium's, for any initial distribution."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import qtab
from support.exact import bitwise
from support.lockstep.toy_text import TABLES, LockstepToyText

PAIRS = {name: LockstepToyText(name) for name in TABLES}

DISTRIBUTIONS = {
    "one state": np.eye(16)[3],
    "float32": np.full(16, 1 / 16, np.float32),
    "integers": np.eye(16, dtype=int)[5],
    "a list": [0.25] * 4,
    "zeros": np.zeros(16),
    "less than one": np.full(16, 0.01),
    "more than one": np.full(16, 0.4),
    "nan in it": np.array([0.1, np.nan, 0.9]),
    "negative": np.array([0.5, -0.3, 0.8]),
    "infinite": np.array([0.1, np.inf]),
    "a view": np.linspace(0.0, 0.1, 32)[::-2],
    "two axes": np.full((4, 4), 1 / 16),
    "masked": np.ma.masked_array(np.full(16, 1 / 16), mask=[True] + [False] * 15),
    "read-only": np.frombuffer(np.full(16, 1 / 16).tobytes()),
    "empty": np.empty(0),
    "a number": 0.5,
    "none": None,
    "words": ["a", "b"],
}


@pytest.mark.parametrize("distribution", DISTRIBUTIONS)
@pytest.mark.parametrize("name", ["FrozenLake-v1", "CliffWalking-v1", "Taxi-v4"])
def test_an_odd_distribution_has_gymnasiums_result(name, distribution):
    pair = LockstepToyText(name)
    pair.set(initial_state_distrib=DISTRIBUTIONS[distribution])
    for seed in [*range(20), None, None]:
        pair.both(lambda env, seed=seed: env.reset(seed=seed))


def test_a_missing_distribution_raises_gymnasiums_error():
    pair = LockstepToyText("FrozenLake-v1")
    for env in (pair.ours, pair.theirs):
        del env.initial_state_distrib
    value, _ = pair.both(lambda env: env.reset(seed=0))
    assert value[0] is AttributeError


@given(st.lists(st.floats(0, 1), min_size=1, max_size=30), st.integers(0, 2**40))
def test_every_distribution_starts_in_gymnasiums_state(weights, seed):
    for name in ("FrozenLake-v1", "CliffWalkingSlippery-v1"):
        pair = PAIRS[name]
        pair.set(initial_state_distrib=np.array(weights))
        for chosen in (seed, None, None):
            pair.both(lambda env, chosen=chosen: env.reset(seed=chosen))


@pytest.mark.parametrize("passenger", [True, False, 1, 0, None, "yes", np.True_])
@pytest.mark.parametrize("probability", [0.3, np.float64(0.3), np.float32(0.3), 1, 0, np.array([0.3])], ids=repr)
def test_the_fickle_step_is_drawn_as_in_gymnasium(passenger, probability):
    pair = LockstepToyText("Taxi-v4")
    pair.set(fickle_passenger=passenger, fickle_probability=probability)
    for seed in range(20):
        pair.both(lambda env, seed=seed: env.reset(seed=seed))


def test_a_tabular_env_starts_like_gymnasiums_environment():
    theirs: Any = gym.make("FrozenLake-v1").unwrapped
    ours: Any = qtab.TabularEnv(theirs.P, theirs.initial_state_distrib)
    for name in ("one state", "float32", "a list", "zeros", "nan in it", "a view"):
        ours.initial_state_distrib = theirs.initial_state_distrib = DISTRIBUTIONS[name]
        for seed in (*range(20), None, None):
            assert bitwise(ours.reset(seed=seed)) == bitwise(theirs.reset(seed=seed))
            assert bitwise(ours.s) == bitwise(theirs.s)


def test_an_overridden_reset_may_call_ours():
    class Mine(qtab.TabularEnv):
        def reset(self, *, seed=None, options=None):
            first, info = super().reset(seed=seed, options=options)
            return first, {**info, "mine": True}

    theirs: Any = gym.make("FrozenLake-v1").unwrapped
    assert Mine(theirs.P, theirs.initial_state_distrib).reset(seed=0) == (0, {"prob": 1, "mine": True})


def test_reset_takes_keyword_arguments_only():
    for name in ("FrozenLake-v1", "Taxi-v4"):
        pair = PAIRS[name]
        for call in (lambda env: env.reset(seed="x"), lambda env: env.reset(seed=-1), lambda env: env.reset(7)):
            ours, theirs = (raised(call, env) for env in (pair.ours, pair.theirs))
            assert ours[0] is theirs[0]
            # The error for a positional seed names the function, which differs.
            assert ours == theirs or ours[0] is TypeError


def raised(call, env):
    with pytest.raises(Exception) as caught:
        call(env)
    return type(caught.value), str(caught.value)
