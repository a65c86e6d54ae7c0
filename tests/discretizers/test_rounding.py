"""The article's grid: cells as NumPy rounds them, in the dtype of the space, without wrapping around."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import qtab
from qtab.discretizers.rounding import Rounding
from support.environments import ScriptedEnv
from support.parity import run_of

DTYPES = [np.float32, np.float64]


def numpys_cell(space, scale, observation):
    """The article's formula: round((observation - low) * scale)."""
    return tuple(np.round((observation - space.low) * np.array(scale), 0).astype(int))


def grid(env, scale):
    return Rounding.build(env.observation_space, qtab.Config(scale=scale), int(env.action_space.n))


def cell_that_training_used(env, **settings):
    """The only cell of a table of zeros that one step from one observation can change."""
    zeros = np.zeros((*grid(env, settings["scale"]).shape, int(env.action_space.n)))
    run = qtab.train(env, episodes=1, seed=0, initial_q=zeros, learning_rate=1.0, discount=0.0, **settings)
    ((*cell, _action),) = np.argwhere(run.q_table)
    return tuple(cell)


def test_the_articles_table_has_19_by_15_by_3_values():
    run = qtab.train("MountainCar-v0", episodes=1, seed=0)
    assert run.q_table.shape == (19, 15, 3)
    assert run.tables.shape == (1, 285, 3)
    assert run.policy.shape == (19, 15)


@pytest.mark.parametrize("scale", [(10, 100), (1, 1), (0.5, 3.0), (7.25, 111.0), (30, 300)])
def test_the_table_has_the_shape_that_the_article_computes(scale):
    env = gym.make("MountainCar-v0")
    space: Any = env.observation_space
    low, high = space.low, space.high
    cells = np.round((high - low) * np.array(scale), 0).astype(int) + 1
    run = qtab.train("MountainCar-v0", episodes=1, seed=0, scale=scale)
    assert run.q_table.shape == (*cells, 3)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("low", [0.0, -1.2, 0.1])
def test_training_updates_the_cell_that_numpy_rounds_to(dtype, low):
    # Halves, their neighbours on both sides, and the corners, in the dtype of the space.
    space: Any = gym.spaces.Box(low, low + 4.0, (1,), dtype)
    halves = (np.arange(9) / 2 + low).astype(dtype)
    values = np.concatenate([np.nextafter(halves, dtype(-9)), halves, np.nextafter(halves, dtype(9))])
    inside = [value for value in values if space.low[0] <= value <= space.high[0]]
    assert len(inside) > 20
    for value in inside:
        observation = np.array([value], dtype)
        env = ScriptedEnv([observation], low, low + 4.0, dtype, length=1)
        assert cell_that_training_used(env, scale=(1.0,)) == numpys_cell(space, (1.0,), observation), value


def test_float32_bounds_subtract_in_float32():
    # In f64 this observation lies just below the half, in f32 on it: NumPy's promotion decides the cell.
    space: Any = gym.spaces.Box(-1.2, 0.6, (1,), np.float32)
    differing = [
        value
        for value in np.linspace(-1.2, 0.6, 20_001).astype(np.float32)
        if np.round((value - space.low[0]) * np.float64(250)) != np.round((np.float64(value) - -1.2) * 250)
    ]
    assert differing
    for value in differing[:20]:
        env = ScriptedEnv([np.array([value])], -1.2, 0.6, np.float32, length=1)
        assert cell_that_training_used(env, scale=(250,)) == numpys_cell(space, (250,), np.array([value]))


@given(
    position=st.floats(-1.2, 0.6, width=64),
    velocity=st.floats(-0.07, 0.07, width=64),
    scale=st.sampled_from([(10.0, 100.0), (40.0, 400.0), (3.3, 77.0)]),
)
def test_a_run_reads_its_table_where_numpy_rounds_to(position, velocity, scale):
    space: Any = gym.make("MountainCar-v0").observation_space
    observation = np.array([position, velocity], np.float32)
    table = grid(gym.make("MountainCar-v0"), scale)
    cell = numpys_cell(space, scale, observation)
    assert table.cell(observation) == cell
    run = qtab.train("MountainCar-v0", episodes=1, seed=1, scale=scale, max_episode_steps=5)
    assert run.q_values(observation).tobytes() == run.q_table[cell].tobytes()
    assert run.predict(observation) == (int(np.argmax(run.q_table[cell])), None)
    assert run.policy[cell] == run.predict(observation)[0]


def test_the_corners_of_the_space_are_the_corners_of_the_table():
    run = qtab.train("MountainCar-v0", episodes=1, seed=0)
    space: Any = gym.make("MountainCar-v0").observation_space
    discretizer: Any = run.discretizer
    assert discretizer.cell(space.low) == (0, 0)
    assert discretizer.cell(space.high) == (18, 14)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("value", [-0.6, 4.6, 1e30, -1e30, np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("axis", [0, 1])
def test_training_refuses_an_observation_outside_with_its_component(dtype, value, axis):
    good, bad = np.full(2, 2.0, dtype), np.full(2, 2.0, dtype)
    bad[axis] = value
    env = ScriptedEnv([good, good, bad], dtype=dtype, dimensions=2)
    with pytest.raises(ValueError, match=rf"observation\[{axis}\] is .*outside the observation space") as caught:
        qtab.train(env, scale=(1, 1), episodes=5, seed=0)
    assert run_of(caught.value).completed is False


@pytest.mark.parametrize("dtype", DTYPES)
def test_an_observation_outside_is_refused_at_the_reset_and_at_a_terminal_state_too(dtype):
    bad = np.array([9.0], dtype)
    for observations in ([bad], [np.array([1.0], dtype), bad]):
        env = ScriptedEnv(observations, dtype=dtype, length=1)
        with pytest.raises(ValueError, match=r"observation\[0\] is 9"):
            qtab.train(env, scale=(1,), episodes=1, seed=0)


@pytest.mark.parametrize("value", [-1.4, 0.8, 1e30, 1e300, np.nan, np.inf, -np.inf])
def test_a_run_refuses_an_observation_outside_with_its_component(value):
    run = qtab.train("MountainCar-v0", episodes=1, seed=0)
    for ask in (run.q_values, run.predict):
        with pytest.raises(ValueError, match=r"observation\[0\] is .*outside the observation space"):
            ask([value, 0.0])


@pytest.mark.parametrize("observation", [0.0, [0.0], [0.0, 0.0, 0.0], [[[-0.5, 0.0]]], [[-0.5]], []])
def test_an_observation_of_another_shape_is_refused(observation):
    run = qtab.train("MountainCar-v0", episodes=1, seed=0)
    with pytest.raises(ValueError, match=r"observations? must have shape \((n, 2|2,)\), got "):
        run.predict(observation)


def test_an_observation_within_half_a_cell_of_the_box_belongs_to_the_last_cell():
    env = ScriptedEnv([np.array([4.4], np.float32)], length=1)
    assert cell_that_training_used(env, scale=(1.0,)) == (4,)
