"""verify tells a difference of qtab's from an environment that does not repeat itself."""

import dataclasses
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.wrappers import NormalizeObservation, NormalizeReward

import qtab
from support.environments import Walk


class Restless(Walk):
    """Ends an episode by a generator that no reset seeds."""

    def __init__(self) -> None:
        super().__init__(start=5)
        self.generator = np.random.default_rng(0)

    def step(self, action: Any) -> Any:
        observation, reward, terminated, truncated, info = super().step(action)
        return observation, reward + self.generator.random(), terminated, truncated, info


class Silent(Walk):
    """Changes nothing but the last bits of its rewards, from call to call."""

    rewards = 0

    def step(self, action: Any) -> Any:
        observation, _, *rest = super().step(action)
        self.rewards += 1
        return observation, 1.0 + self.rewards * 2.0**-52, *rest


class Belated(Walk):
    """Draws rewards from the generator that it had before the last reset."""

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        self.generator = self.np_random
        return super().reset(seed=seed, options=options)

    def step(self, action: Any) -> Any:
        observation, _, *rest = super().step(action)
        return observation, self.generator.random(), *rest


SETTINGS: dict[str, Any] = {"scale": (2, 2), "seed": 0, "episodes": 5, "max_episode_steps": 40}


@pytest.mark.parametrize("make", [Restless, Silent])
def test_an_environment_that_does_not_repeat_itself_is_told_from_a_difference_of_qtab(make):
    env = make()
    run = qtab.train(env, **SETTINGS)
    report = qtab.verify(run, env=env)
    assert report.equal is False
    assert report.repeats is False
    assert report.wrapper is None
    assert "the environment does not repeat itself" in str(report)
    assert "does not show a fault of qtab" in str(report)


@pytest.mark.parametrize("seed_before", [None, 0])
def test_a_generator_that_is_seeded_too_late_is_told_from_a_difference_of_qtab(seed_before):
    run = qtab.train(Belated(start=5), **SETTINGS)
    env = Belated(start=5)
    if seed_before is not None:
        env.reset(seed=seed_before)
    report = qtab.verify(run, env=env)
    assert (report.equal, report.repeats) == (False, False)


def test_a_difference_in_an_environment_that_repeats_itself_is_told():
    run = qtab.train(Walk(start=5), **SETTINGS)
    lengths = run.episode_lengths.copy()
    lengths[2] += 1
    tampered = dataclasses.replace(run, episode_lengths=lengths)
    report = qtab.verify(tampered, env=Walk(start=5))
    assert (report.equal, report.repeats, report.episode) == (False, True, 2)
    assert "the environment repeats itself: the same seed and actions gave the same results twice" in str(report)


def test_a_table_alone_that_differs_is_told_too():
    run = qtab.train("FrozenLake-v1", seed=0, episodes=20)
    report = qtab.verify(dataclasses.replace(run, tables=run.tables + 1.0))
    assert (report.episode, report.table_equal, report.repeats) == (None, False, True)


def test_nothing_is_said_of_the_environment_where_all_is_equal():
    report = qtab.verify(qtab.train("FrozenLake-v1", seed=0, episodes=20))
    assert (report.equal, report.repeats, report.wrapper) == (True, None, None)
    assert "repeat" not in str(report)


@pytest.mark.parametrize("wrapper", [NormalizeObservation, NormalizeReward])
def test_a_wrapper_with_statistics_of_its_own_starts_where_the_last_call_left_it(wrapper):
    def make() -> Any:
        return gym.wrappers.TimeLimit(wrapper(Walk(start=5)), 30)

    settings: dict[str, Any] = {
        "seed": 0,
        "episodes": 4,
        "discretizer": "bins",
        "bins": 4,
        "low": (-2.0, -2.0),
        "high": (2.0, 2.0),
    }
    env = make()
    run = qtab.train(env, **settings)
    report = qtab.verify(run, env=env)
    assert (report.equal, report.repeats, report.wrapper) == (False, False, wrapper.__name__)
    assert f"its wrapper {wrapper.__name__} keeps statistics from one call to the next" in str(report)
    assert "give train and verify a new environment each, and call verify without episodes=" in str(report)
    # The advice, followed.
    assert qtab.verify(run, env=make()).equal


def test_a_verification_leaves_a_given_environment_open():
    env = Restless()
    closed: list[bool] = []
    env.close = lambda: closed.append(True)  # type: ignore[method-assign]
    assert not qtab.verify(qtab.train(env, **SETTINGS), env=env).equal
    assert closed == []
