"""States with fewer actions than others, marked by -inf in the initial table."""

import math
from typing import Any, get_args

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from hypothesis import given
from hypothesis import strategies as st

import qtab
from qtab.config.choices import Algorithm
from qtab.config.options import PREFERENCES
from support.learners.learner_settings import (
    BY_EPISODE,
    explorations,
    learning_rates,
    own_options,
    possible_explorations,
)

BIAS = "qtab/MaximizationBias-v0"
ALGORITHMS = [name for name in get_args(Algorithm) if name not in PREFERENCES]


def some_of_a(missing=8):
    table = np.zeros((3, 10))
    table[0, 10 - missing :] = -np.inf
    return table


@st.composite
def settings(draw):
    algorithm = draw(st.sampled_from(ALGORITHMS))
    values = st.floats(-1, 1)
    rows = [draw(st.lists(values | st.just(-math.inf), min_size=10, max_size=10)) for _ in range(3)]
    for row in rows:
        row[draw(st.integers(0, 9))] = draw(values)
    return {
        **draw(learning_rates(1.0, by_visits=algorithm not in BY_EPISODE, algorithm=algorithm)),
        **draw(own_options(algorithm)),
        "algorithm": algorithm,
        "initial_q": np.array(rows),
        **draw(explorations(possible_explorations(algorithm, {}))),
        "seed": draw(st.integers(0, 2**32 - 1)),
        "episodes": 30,
    }


@pytest.mark.slow
@given(settings())
def test_runs_with_missing_actions_equal_the_reference(config):
    run = qtab.train(BIAS, **config)
    assert run.config.backend == "rust"
    assert qtab.verify(run).equal
    assert qtab.verify(run, episodes=11).equal
    missing = np.isneginf(config["initial_q"])
    assert (np.isneginf(run.tables) == missing).all()


def test_a_missing_action_is_never_taken():
    env = qtab.book.windy_grid_world()
    first = np.zeros((70, 4))
    first[:, 3] = -np.inf  # left is missing everywhere
    settings: dict[str, Any] = {"epsilon": 1.0, "epsilon_schedule": "constant", "episodes": 3, "max_episode_steps": 500}
    run = qtab.train(env, initial_q=first, **settings, seed=0, record=3)
    taken = [action for recording in run.recordings for action in recording.actions]
    assert set(taken) == {0, 1, 2}
    assert run.predict(30)[0] != 3
    assert qtab.evaluate(run, episodes=1, seed=0, env=env).lengths[0] > 0


def test_both_backends_agree_and_a_run_can_be_saved(tmp_path):
    rust, python = (qtab.train(BIAS, seed=4, backend=backend) for backend in ("rust", "gymnasium"))
    assert rust.tables.tobytes() == python.tables.tobytes()
    assert rust.episode_returns.tobytes() == python.episode_returns.tobytes()
    rust.save(tmp_path / "run.npz")
    back = qtab.load(tmp_path / "run.npz")
    assert np.asarray(back.config.initial_q).tobytes() == np.asarray(rust.config.initial_q).tobytes()
    assert qtab.verify(back).equal


def test_one_initial_table_is_used_for_both_tables_of_double_q_learning():
    run = qtab.train(BIAS, algorithm="double_q_learning", seed=1)
    assert np.shape(run.config.initial_q) == (2, 3, 10)
    assert qtab.verify(run).equal


def test_maximization_bias_passes_gymnasiums_checker():
    env = gym.make(BIAS).unwrapped
    check_env(env, skip_render_check=True)
    observation, info = env.reset(seed=0)
    assert (observation, info["action_mask"].tolist()) == (0, [1, 1] + [0] * 8)
    assert env.step(0)[:4] == (2, 0.0, True, False)
    env.reset()
    observation, reward, terminated, truncated, info = env.step(1)
    assert (observation, reward, terminated, truncated, int(info["action_mask"].sum())) == (1, 0.0, False, False, 10)
    u, v = np.random.default_rng(0).random(2)
    assert env.step(5)[1] == -0.1 + math.sqrt(-2 * math.log(1 - u)) * math.cos(2 * math.pi * v)
    with pytest.raises(AssertionError, match="10"):
        env.step(10)


@pytest.mark.parametrize(
    ("settings", "error", "message"),
    [
        ({"actions": 1}, ValueError, "actions must be an integer of at least 2, got 1"),
        ({"actions": 2.0}, TypeError, "actions must be"),
        ({"mean": math.inf}, ValueError, "mean must"),
        ({"deviation": "one"}, TypeError, "deviation must"),
    ],
)
def test_bad_rewards_are_refused(settings, error, message):
    with pytest.raises(error, match=message):
        gym.make(BIAS, **settings)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"initial_q": some_of_a(10)}, "initial_q must leave every state at least one action"),
        ({"initial_q": -some_of_a()}, "initial_q must hold finite numbers"),
        ({"initial_q": np.full((3, 10), np.nan)}, "initial_q must hold finite numbers"),
        (
            {"initial_q": np.stack([some_of_a(), np.zeros((3, 10))]), "algorithm": "double_q_learning"},
            "initial_q must have -inf in both tables or in none",
        ),
    ],
)
def test_a_bad_table_is_refused(settings, message):
    with pytest.raises(ValueError, match=message):
        qtab.train(BIAS, seed=0, **settings)


def test_tile_coding_refuses_missing_actions():
    table = np.zeros((648, 3))
    table[0, 0] = -np.inf
    with pytest.raises(
        ValueError,
        match="discretizer must be 'round', 'bins', 'edges' or 'identity' for an initial_q that contains -inf, got",
    ):
        qtab.train("MountainCar-v0", discretizer="tiles", initial_q=table)
