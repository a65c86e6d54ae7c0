"""Whatever a transition table holds, it is imported and solved, or refused with a documented error."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

import qtab
from qtab import _core
from support.wild import NUMBERS, VALUES, limited_memory, paths_of, replaced

MEMORY = 2**26


@st.composite
def tables(draw):
    """A valid ``P`` with its initial distribution, as lists or dicts."""
    states, actions = draw(st.integers(1, 4)), draw(st.integers(1, 3))

    def outcomes():
        weights = draw(st.lists(st.integers(1, 3), min_size=1, max_size=3))
        return [
            (
                weight / sum(weights),
                draw(st.integers(0, states - 1)),
                float(draw(st.integers(-2, 2))),
                draw(st.booleans()),
            )
            for weight in weights
        ]

    table = {state: {action: outcomes() for action in range(actions)} for state in range(states)}
    return table, [1 / states] * states


@st.composite
def changed_tables(draw):
    """A table in which up to two values are others."""
    table, initial = draw(tables())
    for _ in range(draw(st.integers(0, 2))):
        paths = list(paths_of(table))
        if not paths:
            break
        table = replaced(table, draw(st.sampled_from(paths)), draw(NUMBERS | VALUES))
    if draw(st.integers(0, 5)) == 0:
        initial = draw(VALUES)
    return table, initial


@given(changed_tables(), st.sampled_from(["value_iteration", "policy_iteration", "finite_horizon"]), st.floats(0, 0.99))
def test_a_changed_table_is_solved_or_refused(changed, method, discount):
    table, initial = changed
    try:
        env = qtab.TabularEnv(table, initial)
    except (TypeError, ValueError, OverflowError):
        return
    try:
        best = qtab.optimum(env, method=method, discount=discount, max_episode_steps=20)
    except OverflowError:
        outcomes = [outcome for row in env.P.values() for pair in row.values() for outcome in pair]
        assert max(abs(reward) for _, _, reward, _ in outcomes) > 1e300
        return
    assert np.isfinite(best.values).all()
    assert qtab.train(env, episodes=2, max_episode_steps=20, seed=0).completed


@given(tables(), VALUES)
def test_a_changed_initial_table_trains_or_is_refused(whole, initial_q):
    env = qtab.TabularEnv(*whole)
    try:
        run = qtab.train(env, episodes=2, max_episode_steps=20, initial_q=initial_q, seed=0)
    except (TypeError, ValueError, OverflowError):
        return
    assert run.completed


@given(tables(), VALUES, st.floats() | st.just(1.0), st.integers(0, 2**64 - 1) | st.integers(0, 30))
def test_a_changed_policy_has_a_return_or_is_refused(whole, policy, discount, steps):
    env = qtab.TabularEnv(*whole)
    solver = _core.MdpSolver(_core.NativeEnv("Table", env))
    try:
        with limited_memory(MEMORY):
            solver.policy_return(policy, min(steps, 100))
            solver.finite_horizon(discount, min(steps, 100))
    except (TypeError, ValueError, OverflowError):
        pass
