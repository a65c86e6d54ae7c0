"""TabularEnv: a user's transition table is checked when it is made, and stepped as Gymnasium steps its own."""

import copy
import pickle
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import qtab
from support.exact import bitwise, identical
from support.ids import short_repr
from support.lockstep.toy_text import TABLES


@pytest.mark.parametrize("name", [name for name in TABLES if name != "Taxi-v4"])
def test_a_tabular_env_of_gymnasiums_table_steps_like_gymnasiums_environment(name):
    theirs: Any = gym.make(name).unwrapped
    ours = qtab.TabularEnv(theirs.P, theirs.initial_state_distrib)
    assert (ours.observation_space, ours.action_space) == (theirs.observation_space, theirs.action_space)
    assert bitwise(ours.reset(seed=3)) == bitwise(theirs.reset(seed=3))
    for step, action in enumerate(np.random.default_rng(0).integers(4, size=8_000).tolist()):
        one, other = ours.step(action), theirs.step(action)
        assert identical(one, other), (step, one, other)
        if one[2] or step % 200 == 199:
            assert identical(ours.reset(), theirs.reset()), step
    assert ours.np_random.bit_generator.state == theirs.np_random.bit_generator.state


def chain(**changes):
    """A table of two states: action 0 stays, action 1 usually moves to the other."""
    table = {
        0: {0: [(1.0, 0, -1.0, False)], 1: [(0.9, 1, 5.0, True), (0.1, 0, 0.0, False)]},
        1: {0: [(1.0, 1, 0.0, True)], 1: [(1.0, 1, 0.0, True)]},
    }
    for place, outcomes in changes.items():
        table[int(place[1])][int(place[2])] = outcomes
    return table


def test_a_table_may_be_nested_lists():
    table = [[row[action] for action in (0, 1)] for row in chain().values()]
    one, other = qtab.TabularEnv(table, [1, 0]), qtab.TabularEnv(chain(), np.array([1.0, 0.0]))
    for seed in range(50):
        assert one.reset(seed=seed) == other.reset(seed=seed) == (0, {"prob": 1})
        assert bitwise(one.step(1)) == bitwise(other.step(1))


def test_a_tabular_env_passes_gymnasiums_checker_and_can_be_copied():
    check_env(qtab.TabularEnv(chain(), [1, 0]), skip_render_check=True)
    env = qtab.TabularEnv(chain(), [0.5, 0.5])
    env.reset(seed=1)
    for twin in (copy.deepcopy(env), pickle.loads(pickle.dumps(env))):  # noqa: S301
        one = copy.deepcopy(env)
        for _ in range(30):
            assert one.reset() == twin.reset()
            assert one.step(1) == twin.step(1)


def test_a_tabular_env_copies_its_table_and_lets_it_be_edited():
    table = chain()
    env: Any = qtab.TabularEnv(table, [1, 0])
    table[0][0].append("nonsense")
    env.reset(seed=0)
    assert env.step(0) == (0, -1.0, False, False, {"prob": 1.0})
    env.P[0][0] = [(1.0, 1, 9.0, True)]
    assert env.step(0) == (1, 9.0, True, False, {"prob": 1.0})
    env.P[1][0] = [[1.0, 0, 2.0, False]]  # an entry that is a list is stepped in Gymnasium's code
    assert env.step(0) == (0, 2.0, False, False, {"prob": 1.0})


@pytest.mark.parametrize("action", [2, -1, 0.5, None, "left"])
def test_an_action_outside_the_space_is_refused(action):
    env = qtab.TabularEnv(chain(), [1, 0])
    with pytest.raises(gym.error.ResetNeeded):
        env.step(0)
    env.reset(seed=0)
    before = env.np_random.bit_generator.state
    with pytest.raises(AssertionError, match="invalid"):
        env.step(action)
    assert env.s == 0
    assert env.np_random.bit_generator.state == before


def test_probabilities_may_sum_to_1_within_a_billionth():
    qtab.TabularEnv(chain(p00=[(1 / 3, 0, 0, False)] * 2 + [(1 / 3 + 9e-10, 0, 0, False)]), [1, 0])
    with pytest.raises(ValueError, match=r"^P\[0\]\[0\] must have probabilities that sum to 1, got 1.00000000"):
        qtab.TabularEnv(chain(p00=[(1.0, 0, 0, False), (2e-9, 0, 0, False)]), [1, 0])


BAD = [
    ({"p01": [(0.5, 0, 0, False)]}, ValueError, r"P\[0\]\[1\] must have probabilities that sum to 1, got 0.5"),
    ({"p01": []}, ValueError, r"P\[0\]\[1\] must have probabilities that sum to 1, got 0"),
    ({"p11": [(1.0, 2, 0, False)]}, ValueError, r"P\[1\]\[1\]\[0\] must lead to a state from 0 to 1, got 2"),
    ({"p11": [(1.0, -1, 0, False)]}, ValueError, r"P\[1\]\[1\]\[0\] must lead to a state from 0 to 1, got -1"),
    ({"p10": [(2.0, 0, 0, False), (-1.0, 1, 0, False)]}, ValueError, r"P\[1\]\[0\]\[0\] .* in \[0, 1\], got 2"),
    ({"p10": [(float("nan"), 0, 0, False)]}, ValueError, r"P\[1\]\[0\]\[0\] .* in \[0, 1\], got NaN"),
    ({"p10": [(1.0, 0, float("nan"), False)]}, ValueError, r"P\[1\]\[0\]\[0\] must have a finite reward"),
    ({"p10": [(1.0, 0, 0)]}, TypeError, r"P\[1\]\[0\]\[0\] must be \(probability, .*\), got \(1.0, 0, 0\)"),
    ({"p10": [(1.0, 0.5, 0, False)]}, TypeError, r"P\[1\]\[0\]\[0\] must be"),
    ({"p10": [(1.0, 0, True, -1)]}, TypeError, r"P\[1\]\[0\]\[0\] must be"),
    ({"p10": 5}, TypeError, r"P\[1\]\[0\] must be a list of outcomes"),
    ({"p10": iter([(1.0, 0, 0, False)])}, TypeError, r"P\[1\]\[0\] must be a list of outcomes"),
    ({"p12": [(1.0, 0, 0, False)]}, ValueError, r"P\[1\] must have 2 actions as P\[0\] has, got 3"),
]


@pytest.mark.parametrize(("changes", "error", "text"), BAD, ids=short_repr)
def test_a_bad_table_is_refused_with_the_entry(changes, error, text):
    with pytest.raises(error, match=text):
        qtab.TabularEnv(chain(**changes), [1, 0])


@pytest.mark.parametrize(
    ("table", "error", "text"),
    [
        (5, TypeError, "P must hold"),
        ({0: 3, 1: 3}, TypeError, "P must hold"),
        ({}, ValueError, "^P must have at least 1 state, got none$"),
        ([], ValueError, "^P must have at least 1 state, got none$"),
        ([[], []], ValueError, r"^P\[0\] must have at least 1 action, got none$"),
        ({0: chain()[0], 2: chain()[1]}, ValueError, "P must have the states 0 to 1, it lacks 1"),
        ({0: chain()[0], 1: {0: [], 7: []}}, ValueError, r"P\[1\] must have the actions 0 to 1, it lacks 1"),
    ],
    ids=repr,
)
def test_a_table_of_another_structure_is_refused(table, error, text):
    with pytest.raises(error, match=text):
        qtab.TabularEnv(table, [1, 0])


@pytest.mark.parametrize(
    ("start", "error", "text"),
    [
        ([1.0], ValueError, "initial_state_distrib must hold 2 numbers, one for each state, got 1"),
        ([0.5, 0.4], ValueError, "initial_state_distrib must have probabilities that sum to 1, got 0.9"),
        ([1.5, -0.5], ValueError, r"initial_state_distrib\[0\] must have a probability in \[0, 1\], got 1.5"),
        ([[1.0, 0.0]], ValueError, "initial_state_distrib must have one axis, got 2"),
        (1.0, ValueError, "initial_state_distrib must have one axis, got 0"),
        ("start", TypeError, "initial_state_distrib must hold numbers"),
        ([1.0, None], ValueError, "initial_state_distrib"),
        ([1.0, "x"], TypeError, "initial_state_distrib"),
    ],
    ids=repr,
)
def test_a_bad_initial_distribution_is_refused(start, error, text):
    with pytest.raises(error, match=text):
        qtab.TabularEnv(chain(), start)


def test_it_has_no_public_names_besides_those_of_every_environment():
    env = qtab.TabularEnv([[[(1.0, 0, 0.0, True)]]], [1.0])
    added = {name for name in dir(env) if not name.startswith("_")} - set(dir(gym.make("FrozenLake-v1").unwrapped))
    assert added == set()
