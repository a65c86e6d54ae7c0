"""``Optimum.predict`` answers many observations at once as it does one by one."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab


@pytest.fixture(scope="module")
def lake() -> qtab.Optimum:
    return qtab.optimum("FrozenLake-v1")


def test_without_a_horizon_there_is_no_state():
    found = qtab.optimum("FrozenLake-v1", method="policy_iteration")
    actions, state = found.predict(np.arange(15))
    assert state is None
    assert actions.dtype == np.int64
    assert actions.tolist() == [found.predict(cell)[0] for cell in range(15)]
    assert found.predict(np.array([], dtype=np.int64))[0].shape == (0,)


def test_several_episodes_are_at_steps_of_their_own(lake):
    cells = np.array([0, 4, 8])
    actions, steps = lake.predict(cells)
    assert steps.tolist() == [1, 1, 1]
    later, steps = lake.predict(cells, np.array([98, 99, 3]), episode_start=np.array([False, False, True]))
    assert steps.tolist() == [99, 100, 1]
    assert later.tolist() == [lake.predict(0, 98)[0], lake.predict(4, 99)[0], lake.predict(8)[0]]
    assert actions.tolist() == [lake.predict(cell)[0] for cell in cells]


def test_a_vector_environment_is_played_by_it(lake):
    envs = gym.make_vec("FrozenLake-v1", num_envs=4, vectorization_mode="sync")
    observations, _ = envs.reset(seed=0)
    state: Any = None
    starts = None
    for _ in range(30):
        actions, state = lake.predict(observations, state, starts)
        observations, _, terminated, truncated, _ = envs.step(actions)
        starts = terminated | truncated
    envs.close()
    assert state.shape == (4,)


def test_a_state_of_another_length_is_refused(lake):
    with pytest.raises(ValueError, match=r"^state must hold a value for each of the 2 observations, got 3$"):
        lake.predict([0, 1], 3)
    with pytest.raises(ValueError, match=r"^episode_start must hold a value for each of the 2 observations"):
        lake.predict([0, 1], [3, 4], [True])
    with pytest.raises(TypeError, match="state must be an integer"):
        lake.predict([0, 1], [0.5, 1.0])


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_a_vector_environment_of_tuples_is_answered_as_one_by_one(count):
    found = qtab.optimum("Blackjack-v1")
    run = qtab.train("Blackjack-v1", seed=0, episodes=200)
    hands = [(12, 2, 0), (20, 10, 0), (18, 1, 1), (5, 7, 0)][:count]
    batch = tuple(np.array(parts) for parts in zip(*hands, strict=True))
    assert found.predict(batch)[0].tolist() == [found.predict(hand)[0] for hand in hands]
    assert run.predict(batch)[0].tolist() == [run.predict(hand)[0] for hand in hands]
    assert run.q_values(batch).tolist() == run.q_values(np.array(hands)).tolist()


def test_torques_of_many_observations_are_those_of_each():
    best = qtab.optimum("Pendulum-v1")
    angles = np.linspace(-0.3, 0.3, 20)
    observations = np.stack((np.cos(angles), np.sin(angles), np.zeros(20)), axis=1).astype(np.float32)
    torques, state = best.predict(observations)
    assert (state, torques.shape, torques.dtype) == (None, (20, 1), np.float32)
    assert torques.tolist() == [best.predict(observation)[0].tolist() for observation in observations]
    assert (torques != torques.round()).any()
    assert best.predict(observations[:0])[0].shape == (0, 1)
