"""The optimum of environments with a transition table: compared with NumPy, with known values, and as played."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from qtab.reference import dynamic_programming as plain
from support.lockstep.toy_text import IDS

CONTINUOUS = "MountainCarContinuous-v0"
METHODS = ["value_iteration", "policy_iteration", "finite_horizon"]


def table_of(name: str, **kwargs: Any) -> Any:
    return gym.make(name, **kwargs).unwrapped


VARIANTS = [
    ("FrozenLake-v1", {}),
    ("FrozenLake-v1", {"is_slippery": False, "reward_schedule": (1, -1, -0.01)}),
    ("FrozenLake-v1", {"desc": ["SFH", "FHF", "FFG"], "success_rate": 0.9}),
    ("FrozenLake8x8-v1", {}),
    ("CliffWalking-v1", {}),
    ("CliffWalkingSlippery-v1", {}),
    ("Taxi-v4", {}),
]


@pytest.mark.parametrize(("name", "kwargs"), VARIANTS)
def test_values_equal_numpys_to_the_last_bit(name, kwargs):
    env = table_of(name, **kwargs)
    for discount in (0.9, 1.0):
        found = qtab.optimum(name, env_kwargs=kwargs, method="value_iteration", discount=discount)
        assert found.values.tobytes() == plain.value_iteration(env.P, discount).tobytes()
        found = qtab.optimum(name, env_kwargs=kwargs, discount=discount, max_episode_steps=30)
        assert found.values.tobytes() == plain.finite_horizon(env.P, discount, 30).tobytes()
        fewer = plain.finite_horizon(env.P, discount, 29).tolist()
        by_action = [[plain.action_value(env.P, fewer, s, a, discount) for a in env.P[s]] for s in env.P]
        assert found.q_values.tobytes() == np.array(by_action).tobytes()


@pytest.mark.slow
@pytest.mark.parametrize(("name", "kwargs"), VARIANTS)
def test_policy_iteration_finds_the_values_of_value_iteration(name, kwargs):
    for discount in (0.9, 1.0):
        ours, theirs = (qtab.optimum(name, env_kwargs=kwargs, method=each, discount=discount) for each in METHODS[:2])
        np.testing.assert_allclose(theirs.values, ours.values, rtol=1e-9, atol=1e-12)
        env = table_of(name, **kwargs)
        exactly = plain.policy_return(env.P, env.initial_state_distrib, ours.policy, ours.max_episode_steps)
        assert ours.expected_return == exactly


def test_known_optima_are_found():
    assert qtab.optimum("CliffWalking-v1").expected_return == -13
    assert qtab.optimum("Taxi-v4").expected_return == pytest.approx(7.93, abs=1e-12)
    assert qtab.optimum("FrozenLake-v1", env_kwargs={"is_slippery": False}).expected_return == 1
    # The slippery lake without a time limit has the well-known value 0.8235.
    lake = qtab.optimum("FrozenLake-v1", method="policy_iteration")
    assert lake.values[0] == pytest.approx(14 / 17, abs=1e-12)
    assert lake.expected_return < qtab.optimum("FrozenLake-v1").expected_return < 14 / 17


@pytest.mark.slow
@pytest.mark.parametrize("name", IDS)
def test_the_optimal_policy_earns_the_optimum_in_gymnasium(name):
    found = qtab.optimum(name)
    env = gym.make(name)
    returns = []
    for episode in range(40):
        observation, _ = env.reset(seed=0 if episode == 0 else None)
        state, total, over = None, 0.0, False
        while not over:
            action, state = found.predict(observation, state)
            observation, reward, terminated, truncated, _ = env.step(action)
            total += float(reward)
            over = terminated or truncated
        returns.append(total)
    error = np.std(returns) / np.sqrt(len(returns))
    assert abs(np.mean(returns) - found.expected_return) <= 3.5 * error + 1e-9


@st.composite
def tables(draw: st.DrawFn) -> Any:
    states, actions = draw(st.integers(1, 4)), draw(st.integers(1, 3))
    outcome = st.tuples(st.integers(1, 5), st.integers(0, states - 1), st.floats(-3, 3), st.booleans())

    def row() -> list[Any]:
        drawn = draw(st.lists(outcome, min_size=1, max_size=3))
        whole = sum(weight for weight, *_ in drawn)
        return [(weight / whole, *rest) for weight, *rest in drawn]

    return {state: {action: row() for action in range(actions)} for state in range(states)}


@given(tables(), st.floats(0, 0.95))
def test_values_of_random_tables_equal_numpys(table, discount):
    start = np.full(len(table), 1 / len(table))
    env = qtab.TabularEnv(table, start)
    values = qtab.optimum(env, method="value_iteration", discount=discount).values
    assert values.tobytes() == plain.value_iteration(table, discount).tobytes()
    horizon = qtab.optimum(env, discount=discount, max_episode_steps=7)
    assert horizon.values.tobytes() == plain.finite_horizon(table, discount, 7).tobytes()


@settings(max_examples=settings().max_examples // 2)
@given(tables(), st.integers(1, 4))
def test_no_policy_earns_more_than_the_finite_horizon_optimum(table, steps):
    def best(state: int, left: int) -> float:
        if left == 0:
            return 0.0
        return max(
            sum(p * (r + (0.0 if terminated else best(s, left - 1))) for p, s, r, terminated in table[state][action])
            for action in table[state]
        )

    env = qtab.TabularEnv(table, [1.0] + [0.0] * (len(table) - 1))
    assert qtab.optimum(env, max_episode_steps=steps).expected_return == pytest.approx(best(0, steps), abs=1e-12)


def test_predict_depends_on_the_remaining_steps():
    # A reward of 1 now, or of 3 at the third step: with two steps left it is too late to wait.
    wait, take, slow = [(1.0, 1, 0.0, False)], [(1.0, 0, 1.0, True)], [(1.0, 2, 0.0, False)]
    env = qtab.TabularEnv(
        {0: {0: take, 1: wait}, 1: {0: slow, 1: slow}, 2: {0: [(1.0, 2, 3.0, True)]} | {1: slow}}, [1, 0, 0]
    )
    found = qtab.optimum(env, max_episode_steps=3)
    assert found.predict(0) == (1, 1)
    assert found.predict(0, 1) == (0, 2)
    assert found.predict(0, 1, episode_start=np.array([True])) == (1, 1)
    assert qtab.optimum(env, method="policy_iteration").predict(0) == (1, None)
    for method in METHODS:
        assert qtab.optimum(env, method=method, max_episode_steps=2).expected_return == (method == METHODS[2])


@pytest.mark.parametrize("kwargs", [{"sab": True}, {"sab": False, "natural": True}, {"sab": False}])
def test_blackjack_is_computed_from_its_rules(kwargs):
    found = qtab.optimum("Blackjack-v1", env_kwargs=kwargs)
    assert found.values.shape == (32, 11, 2)
    # Figure 5.2: hit at 16 against a ten, stick at 17; stick at 19 with a usable ace, hit at 17.
    actions = [found.policy[16, 10, 0], found.policy[17, 10, 0], found.policy[19, 10, 1], found.policy[17, 10, 1]]
    assert actions == [1, 0, 0, 1]
    assert found.predict((20, 5, 0))[0] == 0


def test_all_ways_of_naming_an_environment_give_the_same_optimum():
    env = gym.make("FrozenLake-v1")
    run = qtab.train("FrozenLake-v1", episodes=10, seed=0)
    ways: list[Any] = ["FrozenLake-v1", "qtab/FrozenLake-v1", gym.spec("FrozenLake-v1"), env, env.unwrapped, run]
    assert len({qtab.optimum(way, max_episode_steps=100).values.tobytes() for way in ways}) == 1
    table = table_of("FrozenLake-v1")
    own = qtab.optimum(qtab.TabularEnv(table.P, table.initial_state_distrib))
    assert own.max_episode_steps == 10_000
    assert qtab.optimum(qtab.train("FrozenLake-v1", episodes=5, max_episode_steps=7)).max_episode_steps == 7


MINT = qtab.TabularEnv({0: {0: [(1.0, 0, 1.0, False)], 1: [(1.0, 0, 0.0, True)]}}, [1.0])


@pytest.mark.parametrize("method", METHODS[:2])
def test_unbounded_returns_need_a_discount(method):
    with pytest.raises(
        ValueError, match=r"^discount must be smaller, got 1: .*'finite_horizon' works with any discount$"
    ):
        qtab.optimum(MINT, method=method)
    assert qtab.optimum(MINT, method=method, discount=0.5).values[0] == 2.0
    assert qtab.optimum(MINT, max_episode_steps=12).expected_return == 12.0


class Odd(gym.RewardWrapper[Any, Any]):
    def reward(self, reward: Any) -> Any:
        return -reward


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"env": CONTINUOUS}, ValueError, f"env must have a transition table P .* the optimum of {CONTINUOUS} is not"),
        ({"env": 3}, TypeError, "env must be an environment id, an EnvSpec, an environment or a run, got 3"),
        ({"env": "Nothing-v0"}, gym.error.Error, "Nothing"),
        (
            {"env": Odd(gym.make("Taxi-v4"))},
            ValueError,
            "env must have no wrapper that may .* rewards, got Odd",
        ),
        ({"discount": 1.5}, ValueError, r"discount must lie in \[0, 1\], got 1.5"),
        ({"discount": float("nan")}, ValueError, r"discount must lie in \[0, 1\], got nan"),
        ({"discount": "1"}, TypeError, "discount must be a number"),
        ({"max_episode_steps": 0}, ValueError, "max_episode_steps must be an integer of at least 1, got 0"),
        ({"max_episode_steps": 1.5}, TypeError, "max_episode_steps must be an integer of at least 1, got 1.5"),
        ({"method": "search"}, ValueError, "method must be one of 'finite_horizon', 'value_iteration', 'policy_"),
        ({"method": 3}, TypeError, "method must be one of"),
        (
            {"env": gym.make("Taxi-v4"), "env_kwargs": {}},
            ValueError,
            "env_kwargs must be None if env is an env",
        ),
        ({"env": "MountainCar-v0", "method": "value_iteration"}, ValueError, "method must be 'search', got"),
        ({"env": "MountainCar-v0", "discount": 0.9}, ValueError, "discount must be 1 for method .search."),
    ],
)
def test_bad_input_is_refused(arguments, error, message):
    with pytest.raises(error, match=message):
        qtab.optimum(**{"env": "Taxi-v4", **arguments})


def test_an_invalid_table_is_refused_with_the_entry():
    env: Any = gym.make("FrozenLake-v1")
    env.unwrapped.P[3][1] = [(0.5, 0, 0.0, False)]
    with pytest.raises(ValueError, match=r"P\[3\]\[1\] must have probabilities that sum to 1, got 0.5"):
        qtab.optimum(env)
    env = gym.make("Taxi-v4", fickle_passenger=True, fickle_probability=1.5)
    with pytest.raises(ValueError, match="must have a probability in"):
        qtab.optimum(env)
    env = gym.make("Taxi-v4")
    del env.unwrapped.P[499]
    with pytest.raises(ValueError, match="initial_state_distrib must hold 499 numbers"):
        qtab.optimum(env)


def test_observations_outside_the_space_are_refused():
    found = qtab.optimum("FrozenLake-v1")
    with pytest.raises(ValueError, match="outside the observation space"):
        found.predict(16)
    with pytest.raises(ValueError, match="state must be an integer of at least 0, got -1"):
        found.predict(0, -1)


def test_an_environment_that_is_passed_in_is_neither_closed_nor_stepped():
    env: Any = gym.make("FrozenLake-v1")
    observation, _ = env.reset(seed=0)
    qtab.optimum(env)
    assert env.unwrapped.s == observation


def test_an_optimum_describes_itself():
    text = str(qtab.optimum("Taxi-v4"))
    assert text.startswith("Taxi-v4\n  expected return  7.93 within 200 steps\n  threshold        8\n")
    assert "finite_horizon, discount 1: exact" in text
