"""Steps of qtab's toy text equal Gymnasium's: observations, rewards, flags, info and the state of the generator."""

from itertools import product
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.toy_text.frozen_lake import generate_random_map

import qtab
from support.lockstep.toy_text import IDS, TABLES, LockstepToyText

STEPS = 2_000
GOAL_STEPS = 6_000
"""Enough for a hundred goals, and for rides from most of the 300 states that a taxi starts in."""


def optimal_policy(name: str) -> list[int]:
    """An optimal action for each state: it leads to the goal, which random actions seldom reach."""
    return qtab.optimum(name).policy.tolist()


@pytest.mark.slow
@pytest.mark.parametrize("name", IDS)
def test_random_steps_equal_gymnasiums(name):
    terminated = LockstepToyText(name).run(STEPS, seed=3)
    if "FrozenLake" in name or "Blackjack" in name:  # random steps seldom reach the other goals
        assert terminated > 50


@pytest.mark.parametrize("name", TABLES)
def test_every_action_in_every_state_equals_gymnasiums(name):
    pair = LockstepToyText(name)
    pair.both(lambda env: env.reset(seed=8))
    for state, action in product(range(pair.theirs.observation_space.n), range(pair.theirs.action_space.n)):
        pair.set(s=state)
        pair.both(lambda env, action=action: env.step(action))


@pytest.mark.parametrize("name", [name for name in TABLES if "Taxi" not in name])
def test_steps_to_the_goal_equal_gymnasiums(name):
    assert LockstepToyText(name).run(GOAL_STEPS, optimal_policy(name), seed=3) > 30


@pytest.mark.slow
@pytest.mark.parametrize(
    "kwargs",
    [{}, {"fickle_passenger": True}, {"is_rainy": True}, {"is_rainy": True, "fickle_passenger": True}],
    ids=repr,
)
def test_rides_of_every_taxi_equal_gymnasiums(kwargs):
    assert LockstepToyText("Taxi-v4", **kwargs).run(GOAL_STEPS, optimal_policy("Taxi-v4"), seed=4) > 120


LAKE = ["SFFHF", "FHFSF", "FFFFG"]


@pytest.mark.parametrize(
    ("name", "kwargs"),
    [
        ("FrozenLake-v1", {"is_slippery": False}),
        ("FrozenLake-v1", {"map_name": "8x8"}),
        ("FrozenLake-v1", {"desc": LAKE}),
        ("FrozenLake-v1", {"desc": generate_random_map(size=6, p=0.9, seed=5), "is_slippery": False}),
        ("FrozenLake-v1", {"success_rate": 0.9}),
        ("FrozenLake-v1", {"success_rate": 1.0}),
        ("FrozenLake-v1", {"success_rate": 1}),
        ("FrozenLake-v1", {"success_rate": 0}),
        ("FrozenLake-v1", {"success_rate": 1.4}),
        ("FrozenLake-v1", {"success_rate": -0.3}),
        ("FrozenLake-v1", {"success_rate": np.float32(0.7)}),
        ("FrozenLake-v1", {"success_rate": np.float64(0.7)}),
        ("FrozenLake-v1", {"success_rate": float("nan")}),
        ("FrozenLake-v1", {"reward_schedule": (10, -10, -1)}),
        ("FrozenLake-v1", {"reward_schedule": (1.5, np.float32(-0.25), np.int64(3))}),
        ("FrozenLake8x8-v1", {"map_name": "4x4"}),
        ("CliffWalking-v1", {"is_slippery": True}),
        ("CliffWalkingSlippery-v1", {"is_slippery": False}),
        ("Taxi-v4", {"is_rainy": True, "rainy_probability": 0.3}),
        ("Taxi-v4", {"is_rainy": True, "rainy_probability": 1}),
        ("Taxi-v4", {"fickle_passenger": True, "fickle_probability": 1.0}),
        ("Taxi-v4", {"fickle_passenger": True, "fickle_probability": 0}),
        ("Blackjack-v1", {"natural": True, "sab": False}),
        ("Blackjack-v1", {"natural": True, "sab": True}),
        ("Blackjack-v1", {"natural": False, "sab": False}),
    ],
    ids=repr,
)
def test_every_constructor_argument_has_its_effect(name, kwargs):
    LockstepToyText(name, **kwargs).run(1_000, seed=5)


def test_a_random_map_can_be_generated():
    env: Any = gym.make("qtab/FrozenLake-v1", desc=None, map_name=None).unwrapped
    assert env.observation_space.n == 64


@pytest.mark.parametrize("desc", [["FFF", "FFG"], ["SFF", "FG"]])
def test_a_bad_map_has_gymnasiums_result(desc):
    texts: list[Any] = []
    for name in ("qtab/FrozenLake-v1", "FrozenLake-v1"):
        try:
            with np.errstate(invalid="ignore"):
                env = gym.make(name, desc=desc).unwrapped
                env.reset(seed=0)
            texts.append(env.step(1))
        except ValueError as error:
            texts.append(str(error))
    assert texts[0] == texts[1]


def edited(env):
    """Edits entries of the table in different ways."""
    env.P[env.s][0] = [(0.25, 3, 7, False), (0.25, 3, 7, False), (0.5, 9, -0.5, True)]
    env.P[3][1].insert(0, (0.5, 5, np.float64(2.5), False))
    env.P[9] = dict(env.P[9])
    env.P[5][2] = [(np.float64(0.5), np.int64(3), 1.0, np.True_), (0.4999, 9, 2, False)]


@pytest.mark.parametrize("name", TABLES)
def test_an_edited_table_is_used_from_the_next_step(name):
    pair = LockstepToyText(name)
    pair.both(lambda env: env.reset(seed=2))
    pair.both(edited)
    for seed in range(100):
        for action in (0, 1, 2):
            for state in (3, 5, 9, np.int64(3)):
                pair.set(s=state)
                pair.ours.np_random = np.random.default_rng(seed)
                pair.theirs.np_random = np.random.default_rng(seed)
                pair.both(lambda env, action=action: env.step(action))


ROWS = [
    [],
    (),
    [(1.0, 0, 0)],
    [(1.0, 0, 0, False, 5)],
    [[1.0, 1, 2, True]],
    [(np.float32(0.3), 1, 0, False), (np.float32(0.7), 2, 0, False)],
    [(True, 1, 0, False)],
    [(np.int64(1), 1, 0, False)],
    [(2, 1, 0, False), (-1, 2, 0, False)],
    [(float("nan"), 1, 0, False), (1.0, 2, 0, False)],
    [(float("inf"), 1, 0, False), (float("-inf"), 2, 0, False)],
    [(0.0, 1, 0, False)],
    [("a", 1, 0, False)],
    [(1.0, 1.5, None, "done")],
    [(1.0, "3", 0, False)],
    [(1.0, 700, 0, False)],
    [(1.0, -1, 0, False)],
    [(1.0, 2**70, 0, False)],
    [(1.0, None, 0, False)],
    None,
    np.array([[1.0, 1.0, 2.0, 0.0]]),
    [(0.01, 1, 1, False)] * 100,
]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: repr(row)[:50])
@pytest.mark.parametrize("name", ["FrozenLake-v1", "CliffWalking-v1", "Taxi-v4"])
def test_an_odd_row_has_gymnasiums_result(name, row):
    pair = LockstepToyText(name)
    pair.both(lambda env: env.reset(seed=1))
    for env in (pair.ours, pair.theirs):
        env.P[env.s][1] = row
    pair.both(lambda env: env.step(1))
    pair.both(lambda env: env.step(0))


def test_the_table_may_be_nested_lists():
    pair = LockstepToyText("FrozenLake-v1")
    pair.both(lambda env: env.reset(seed=1))
    for env in (pair.ours, pair.theirs):
        env.P = [[env.P[state][action] for action in range(4)] for state in range(16)]
    for action in (-1, 0, 1, 2, 3, 4, True, 1.0):
        pair.both(lambda env, action=action: env.step(action))
    pair.set(P=None)
    pair.both(lambda env: env.step(0))


STATES = [0, 3, 5, np.int64(3), np.uint8(4), True, 499, 500, -1, 2.0, 2.5, None, "3", np.array(3), 2**70]


@pytest.mark.parametrize("name", TABLES)
@pytest.mark.parametrize("state", STATES, ids=repr)
def test_an_assigned_state_is_used(name, state):
    pair = LockstepToyText(name)
    pair.both(lambda env: env.reset(seed=4))
    pair.set(s=state)
    for _ in range(4):
        pair.both(lambda env: env.step(1))


ACTIONS = [0, 1, np.int64(1), np.uint8(0), True, 1.0, 0.5, -1, 4, 7, None, "a", np.array(1), np.array([1]), [0], 2**70]


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("action", ACTIONS, ids=repr)
def test_odd_actions_have_gymnasiums_result(name, action):
    pair = LockstepToyText(name)
    pair.both(lambda env: env.reset(seed=6))
    pair.both(lambda env: env.step(action))


@pytest.mark.parametrize("name", TABLES)
def test_an_assigned_initial_distribution_is_used(name):
    pair = LockstepToyText(name)
    states = pair.theirs.observation_space.n
    pair.set(initial_state_distrib=np.eye(states)[7])
    assert "7" in repr(pair.both(lambda env: env.reset(seed=1)))
    pair.set(initial_state_distrib=[0.1] * 10)
    for seed in range(20):
        pair.both(lambda env, seed=seed: env.reset(seed=seed))


@pytest.mark.parametrize("name", IDS)
def test_reset_accepts_what_gymnasiums_accepts(name):
    pair = LockstepToyText(name)
    for seed in (0, 2**40, None, -1, 1.5, np.int64(3)):
        if seed is not None:
            pair.both(lambda env, seed=seed: env.reset(seed=seed, options={"anything": 1}))
    pair.both(lambda env: env.reset(seed=0))
    pair.both(lambda env: env.reset())
    pair.both(lambda env: env.reset(options={}))


@pytest.mark.parametrize("name", IDS)
def test_a_step_before_a_reset_is_refused(name):
    with pytest.raises(gym.error.ResetNeeded, match="before calling"):
        gym.make(f"qtab/{name}").unwrapped.step(0)
    with pytest.raises(gym.error.ResetNeeded):
        gym.make(f"qtab/{name}").step(0)


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("bits", [np.random.MT19937, np.random.Philox, np.random.SFC64])
def test_an_assigned_generator_is_used(name, bits):
    pair = LockstepToyText(name)
    pair.both(lambda env: env.reset(seed=0))
    pair.ours.np_random, pair.theirs.np_random = (np.random.Generator(bits(7)) for _ in range(2))
    for step in range(60):
        done = pair.ours.step(step % 2)[2]
        assert pair.theirs.step(step % 2)[2] == done
        if done:
            assert pair.ours.reset() == pair.theirs.reset() if name != "Taxi-v4" else True
    one, other = pair.ours.np_random, pair.theirs.np_random
    assert [one.random(), one.integers(9)] == [other.random(), other.integers(9)]


def test_blackjack_deals_from_a_random_state():
    pair = LockstepToyText("Blackjack-v1")
    pair.ours.np_random, pair.theirs.np_random = (np.random.RandomState(7) for _ in range(2))
    for step in range(60):
        done = pair.ours.step(step % 2)[2] if step else True
        if step:
            assert pair.theirs.step(step % 2)[2] == done
        if done:
            assert pair.ours.reset() == pair.theirs.reset()
    assert pair.ours.np_random.random() == pair.theirs.np_random.random()
