"""The classes of toy text: spaces, rendering, copies, hands and action masks."""

import copy
import pickle
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

from qtab.envs.toy_text import FrozenLakeEnv, TaxiEnv
from support.lockstep.toy_text import IDS, TABLES, LockstepToyText


@pytest.mark.parametrize("name", IDS)
def test_registration_and_spaces_equal_gymnasiums(name):
    ours, theirs = gym.spec(f"qtab/{name}"), gym.spec(name)
    fields = ("max_episode_steps", "reward_threshold", "nondeterministic", "order_enforce", "disable_env_checker")
    for field in (*fields, "kwargs"):
        assert getattr(ours, field) == getattr(theirs, field), field
    pair = LockstepToyText(name)
    pair.both(lambda env: env.reset(seed=0))
    pair.both(lambda env: (env.observation_space == pair.theirs.observation_space, env.metadata, env.render_mode))
    pair.both(lambda env: env.action_space == pair.theirs.action_space)
    if name in TABLES:
        pair.both(lambda env: (env.P, env.initial_state_distrib))


MODES = [(name, mode) for name in IDS for mode in ("rgb_array", "ansi") if (name, mode) != ("Blackjack-v1", "ansi")]


@pytest.mark.parametrize(("name", "mode"), MODES)
def test_rendered_images_and_text_equal_gymnasiums(name, mode):
    pair = LockstepToyText(name, render_mode=mode)
    pair.both(lambda env: env.reset(seed=8))
    seen = set()
    for step in range(12):
        seen.add(repr(pair.both(lambda env: env.render())))
        if pair.both(lambda env, step=step: env.step(step % env.action_space.n)) and step % 4 == 3:
            pair.both(lambda env: env.reset())
    assert len(seen) > 2
    pair.both(lambda env: env.close())


@pytest.mark.parametrize("name", IDS)
def test_every_step_is_rendered_in_human_mode(name):
    shown = []
    env: Any = gym.make(f"qtab/{name}").unwrapped
    env.reset(seed=0)
    env.render_mode = "human"
    env.render = lambda: shown.append(copy.deepcopy((getattr(env, "s", None), getattr(env, "player", None))))
    env.step(1)
    env.reset()
    env.step(1)
    assert len(shown) == 3
    assert shown[-1] == (getattr(env, "s", None), getattr(env, "player", None))


@pytest.mark.parametrize("name", IDS)
def test_no_frames_are_made_without_a_render_mode(name):
    env = gym.make(f"qtab/{name}").unwrapped
    env.reset(seed=0)
    with pytest.warns(UserWarning, match=f"qtab/{name}"):
        assert env.render() is None


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("copied", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])  # noqa: S301
def test_a_copy_continues_like_its_original(name, copied):
    pair = LockstepToyText(name)
    copied(pair.ours)
    pair.both(lambda env: env.reset(seed=9))
    pair.both(lambda env: env.step(1))
    original, pair.ours = pair.ours, copied(pair.ours)
    assert type(pair.ours) is type(original)
    before = repr(original.np_random.bit_generator.state)
    for _ in range(50):
        pair.both(lambda env: env.step(0))
        pair.both(lambda env: env.reset())
    assert repr(original.np_random.bit_generator.state) == before


HANDS: list[Any] = [
    [10, 9],
    [1, 10],
    [10, 1],
    [1, 1, 9],
    [10, 10, 1],
    [5],
    [],
    [1] * 12,
    (5, 6),
    [5.0, 6],
    [True, 10],
    None,
    "ab",
]
HANDS += [[np.int64(5), 6], [0, 11], [-3, 10], [2**70, 1]]


@pytest.mark.parametrize("hand", HANDS, ids=repr)
@pytest.mark.parametrize("side", ["player", "dealer"])
@pytest.mark.parametrize("action", [0, 1])
def test_an_assigned_hand_is_played(hand, side, action):
    for rules in ({"sab": True}, {"sab": False, "natural": True}):
        pair = LockstepToyText("Blackjack-v1", **rules)
        pair.both(lambda env: env.reset(seed=3))
        pair.set(**{side: hand})
        for _ in range(3):
            pair.both(lambda env: env.step(action))


def test_rules_and_action_space_can_be_assigned():
    pair = LockstepToyText("Blackjack-v1")
    pair.set(sab=False, natural=1)
    for seed in range(200):
        pair.both(lambda env, seed=seed: env.reset(seed=seed))
        pair.both(lambda env: env.step(0))
    pair.set(action_space=gym.spaces.Discrete(2, start=1))
    for action in (0, 1, 2):
        pair.both(lambda env, action=action: env.step(action))


def test_hands_keep_their_list_objects():
    env: Any = gym.make("qtab/Blackjack-v1").unwrapped
    env.reset(seed=0)
    player = env.player
    env.step(1)
    assert env.player is player
    assert len(player) == 3


@pytest.mark.parametrize("states", [range(500), *([odd] for odd in (np.int64(17), True, -1, 500, 1.5, None))], ids=str)
def test_the_action_mask_equals_gymnasiums(states):
    for state in states:
        TAXIS.both(lambda env, state=state: env.action_mask(state))


TAXIS = LockstepToyText("Taxi-v4")
TAXIS.both(lambda env: env.reset(seed=0))


MAPS = [
    {"desc": np.asarray([row.replace("|", ":") for row in TAXIS.theirs.desc.astype(str).view("U11").ravel()], "c")},
    {"desc": TAXIS.theirs.desc[:, ::-1]},
    {"desc": np.asfortranarray(TAXIS.theirs.desc)},
    {"desc": TAXIS.theirs.desc.astype("S2")},
    {"desc": TAXIS.theirs.desc.astype(str)},
    {"desc": TAXIS.theirs.desc[:5]},
    {"desc": None},
    {"locs": [(1, 1), (2, 2), (3, 3), (4, 4)]},
    {"locs": ((1, 1), (2, 2), (3, 3), (4, 4), (0, 0))},
    {"locs": [[1, 1], [2, 2], [3, 3], [4, 4]]},
    {"locs": [(1, 1), (2, 2)]},
]


@pytest.mark.parametrize("edit", MAPS, ids=lambda edit: f"{next(iter(edit))} {next(iter(edit.values()))!r:.40}")
def test_an_assigned_map_changes_the_action_mask(edit):
    pair = LockstepToyText("Taxi-v4", fickle_passenger=True, fickle_probability=1.0)
    pair.both(lambda env: env.reset(seed=1))
    pair.set(**edit)
    for state in range(0, 500, 7):
        pair.both(lambda env, state=state: env.action_mask(state))
        pair.set(s=state, fickle_step=True)
        pair.both(lambda env: env.step(1))


def test_an_overridden_action_mask_is_in_the_info():
    class Mine(TaxiEnv):
        def action_mask(self, state):
            return "all"

    env = Mine()
    assert env.reset(seed=0)[1]["action_mask"] == "all"
    assert env.step(0)[4]["action_mask"] == "all"


def test_an_overridden_step_may_call_ours():
    class Mine(FrozenLakeEnv):
        def step(self, a):
            return (*super().step(a)[:4], {"mine": True})

    env = Mine(is_slippery=False)
    env.reset(seed=0)
    assert env.step(1) == (4, 0, False, False, {"mine": True})
