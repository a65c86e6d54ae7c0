"""The presets named ``solved``: over many seeds by Gymnasium's thresholds, and on tables by exact evaluation."""

import functools
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from numpy.typing import NDArray

import qtab

HORIZON = 1_000
"""Steps evaluated where there is no time limit; an episode of a good policy ends long before."""


@functools.cache
def training(env: str, seeds: int) -> qtab.Runs:
    return qtab.train_many(env, seeds, preset="solved", tables=True)


def best_hundreds(runs: qtab.Runs) -> NDArray[np.float64]:
    """The best mean return of 100 consecutive episodes of each run."""
    sums = np.cumsum(np.pad(runs.episode_returns, ((0, 0), (1, 0))), axis=1)
    return np.max((sums[:, 100:] - sums[:, :-100]) / 100, axis=1)


def greedy_returns(env: str, runs: qtab.Runs) -> NDArray[np.float64]:
    """Each greedy policy's expected return under the time limit, by dynamic programming over Gymnasium's P."""
    made: Any = gym.make(env)
    P, start = made.unwrapped.P, made.unwrapped.initial_state_distrib  # noqa: N806 - Gymnasium's name
    assert runs.tables is not None
    policies = np.argmax(runs.tables.sum(axis=1), axis=2)
    states, actions = len(P), len(P[0])
    follows, rewards = np.zeros((states, actions, states)), np.zeros((states, actions))
    for state, action in np.ndindex(states, actions):
        for probability, after, reward, terminated in P[state][action]:
            rewards[state, action] += probability * reward
            follows[state, action, after] += probability * (not terminated)
    found = []
    for policy in policies:
        of_policy = (range(states), policy)
        rewarded, followed, values = rewards[of_policy], follows[of_policy], np.zeros(states)
        for _ in range(made.spec.max_episode_steps or HORIZON):
            before, values = values, rewarded + followed @ values
            if np.array_equal(before, values):
                break
        found.append(start @ values)
    return np.array(found)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("env", "seeds", "mean"),
    [("MountainCar-v0", 3, -102), ("FrozenLake-v1", 20, 0.7), ("FrozenLake8x8-v1", 3, 0.85)],
)
def test_every_seed_reaches_the_threshold_and_the_mean_ends_above_it(env, seeds, mean):
    runs = training(env, seeds)
    threshold = gym.spec(env).reward_threshold
    assert best_hundreds(runs).min() >= threshold
    assert runs.final_returns(100).mean() > mean >= threshold


@pytest.mark.slow
def test_every_seed_finds_the_best_policy_of_the_small_lake_without_a_time_limit():
    # Under the time limit that policy returns 0.7402; the best time-dependent policy returns 0.7442.
    assert greedy_returns("FrozenLake-v1", training("FrozenLake-v1", 50)) == pytest.approx(0.740165, abs=1e-6)


@pytest.mark.slow
def test_every_seed_comes_close_to_the_best_policy_of_the_large_lake_without_a_count_of_steps():
    # 0.893568 by dynamic programming over the discount, and then by changing one state's action at a time.
    assert greedy_returns("FrozenLake8x8-v1", training("FrozenLake8x8-v1", 8)).mean() > 0.995 * 0.893568


def test_the_car_on_the_racetrack_comes_close_to_the_optimum():
    # -11.6946, by value iteration over the moves of the environment's class.
    assert qtab.train("qtab/Racetrack-v0", seed=0).episode_returns[-1000:].mean() > -12.1


@pytest.mark.slow
def test_every_seed_learns_an_optimal_policy_for_the_taxi():
    runs = training("Taxi-v4", 50)
    assert greedy_returns("Taxi-v4", runs) == pytest.approx(7.93, abs=1e-9)
    # Gymnasium's threshold of 8 is above the optimum: 100 episodes may reach it by luck, the mean of all does not.
    assert best_hundreds(runs).min() >= 8
    assert runs.final_returns(100).mean() > 7.83


@pytest.mark.slow
def test_every_seed_learns_the_shortest_path_along_the_cliff():
    runs = training("CliffWalking-v1", 100)
    assert (runs.episode_returns[:, -100:] == -13).all()
    assert (greedy_returns("CliffWalking-v1", runs) == -13).all()


@pytest.mark.slow
def test_on_the_slippery_cliff_every_seed_comes_close_to_the_optimum():
    returns = greedy_returns("CliffWalkingSlippery-v1", training("CliffWalkingSlippery-v1", 20))
    assert returns.mean() > -64.9
    assert returns.min() > -65.5
    assert returns.max() < -64.709


def test_blackjack_is_played_close_to_the_optimum():
    gap = qtab.optimum("Blackjack-v1").gap(training("Blackjack-v1", 4))
    assert gap.optimum == pytest.approx(-0.0431131, abs=1e-7)
    assert (gap.greedy > 0).all()
    assert gap.greedy.max() < 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("env", ["MountainCar-v0", "FrozenLake-v1", "Taxi-v4"])
def test_the_solved_preset_verifies(env):
    run = qtab.train(env, preset="solved", seed=0)
    assert qtab.verify(run, episodes=2).equal
