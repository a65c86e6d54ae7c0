"""The classes of classic control and toy text with Gymnasium's checker and in its wrappers."""

import warnings

import gymnasium as gym
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.wrappers import NormalizeObservation, RecordEpisodeStatistics

from support.exact import bitwise
from support.lockstep import classic_control, toy_text

IDS = [*classic_control.IDS, *toy_text.IDS]


@pytest.mark.parametrize("name", IDS)
def test_gymnasiums_checker_passes(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the checker also warns of Gymnasium's own spaces
        check_env(gym.make(f"qtab/{name}", render_mode="rgb_array").unwrapped)


def wrapped(name: str) -> gym.Env:
    env: gym.Env = RecordEpisodeStatistics(gym.make(name, max_episode_steps=20))
    return NormalizeObservation(env) if isinstance(env.observation_space, gym.spaces.Box) else env


@pytest.mark.parametrize("name", IDS)
def test_gymnasiums_wrappers_return_the_same_around_ours(name: str) -> None:
    ours, theirs = wrapped(f"qtab/{name}"), wrapped(name)
    assert bitwise(ours.reset(seed=0)) == bitwise(theirs.reset(seed=0))
    for _ in range(20):
        action = theirs.action_space.sample()
        one, other = ours.step(action), theirs.step(action)
        assert bitwise(one[:4]) == bitwise(other[:4])
        if one[2] or one[3]:
            assert one[4]["episode"]["r"] == other[4]["episode"]["r"]
            break
