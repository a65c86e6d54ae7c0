"""The k-armed bandit testbed: its problems, its rewards, and NumPy's standard normals in Rust."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import qtab

BANDIT = "qtab/KArmedBandit-v0"


def test_a_million_rewards_are_numpys_normals() -> None:
    count = 1_000_000
    run = qtab.train(
        BANDIT, env_kwargs={"k": 1, "mean": 2.0, "deviation": 0.5}, episodes=count, seed=123, max_episode_steps=1
    )
    assert run.config.backend == "rust"
    generator = np.random.default_rng(123)
    true_value = 2.0 + 0.5 * generator.standard_normal()
    assert run.episode_returns.tobytes() == (true_value + generator.standard_normal(count)).tobytes()


@pytest.mark.parametrize("kwargs", [{}, {"k": 3, "mean": 4.0}, {"deviation": 0.0, "random_walk": 0.1}], ids=str)
@pytest.mark.parametrize("chosen", [{}, {"exploration": "ucb"}, {"algorithm": "gradient_bandit"}], ids=str)
def test_training_equals_the_reference_and_python(kwargs: dict[str, Any], chosen: dict[str, Any]) -> None:
    settings: dict[str, Any] = {"env_kwargs": kwargs, "seed": 5, "episodes": 200, "max_episode_steps": 1, **chosen}
    rust, python = (qtab.train(BANDIT, backend=backend, **settings) for backend in ("rust", "gymnasium"))
    assert rust.episode_returns.tobytes() == python.episode_returns.tobytes()
    assert rust.tables.tobytes() == python.tables.tobytes()
    assert qtab.verify(rust).equal


def test_it_is_an_environment_of_gymnasium() -> None:
    check_env(gym.make(BANDIT).unwrapped, skip_render_check=True)
    assert gym.make_vec(BANDIT, num_envs=2).reset(seed=0)[0].tolist() == [0, 0]


def test_a_problem_lasts_until_the_next_seed() -> None:
    env: Any = gym.make(BANDIT).unwrapped
    env.reset()
    first = env.action_values
    env.reset()
    assert env.action_values is first
    env.reset(seed=1)
    second = env.action_values
    assert second.tolist() == np.random.default_rng(1).standard_normal(10).tolist()
    for action in (int(np.argmax(second)), int(np.argmin(second))):
        _, _, terminated, _, info = env.step(action)
        assert terminated
        assert info["optimal"] is bool(action == np.argmax(second))


@pytest.mark.parametrize("chosen", [{"epsilon": 0.3, "ties": "random"}, {"exploration": "ucb"}], ids=str)
@pytest.mark.parametrize("by_visits", [True, False])
def test_a_resumed_run_chooses_as_an_uninterrupted_one(chosen: dict[str, Any], by_visits: bool) -> None:
    settings: dict[str, Any] = {"seed": 3, "max_episode_steps": 1, "epsilon_schedule": "constant", **chosen}
    if "exploration" in chosen:
        del settings["epsilon_schedule"]
    if by_visits:
        settings |= {"learning_rate": 1.0, "learning_rate_schedule": "visits"}
    whole = qtab.train(BANDIT, episodes=300, **settings)
    resumed = qtab.resume(qtab.train(BANDIT, episodes=150, **settings), 300)
    assert resumed.episode_returns.tobytes() == whole.episode_returns.tobytes()
    assert resumed.q_table.tobytes() == whole.q_table.tobytes()


def test_sample_averages_are_the_means_of_the_rewards() -> None:
    run = qtab.train(BANDIT, seed=2, episodes=50, epsilon=1.0, visits=True, record=50, max_episode_steps=1)
    actions = np.array([one.actions[0] for one in run.recordings])
    for action in range(10):
        rewards = run.episode_returns[actions == action]
        assert run.q_table[0, action] == pytest.approx(rewards.mean() if len(rewards) else 0.0)
    assert qtab.verify(qtab.train(config=run.config)).equal


@pytest.mark.parametrize(
    ("kwargs", "error", "text"),
    [
        ({"k": 0}, ValueError, "k must be an integer of at least 1, got 0"),
        ({"k": 2.5}, TypeError, "k must be an integer"),
        ({"mean": float("nan")}, ValueError, "mean must be"),
        ({"deviation": -1.0}, ValueError, "deviation must not be negative, got -1.0"),
        ({"random_walk": -0.1}, ValueError, "random_walk must not be negative, got -0.1"),
    ],
    ids=str,
)
def test_bad_arguments_are_refused(kwargs: dict[str, Any], error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        gym.make(BANDIT, **kwargs)


@pytest.mark.parametrize(
    "chosen",
    [
        {"time_aware": True},
        {"time_aware": True, "exploration": "ucb", "count_bonus": 1.0},
        {"on_truncation": "terminate", "algorithm": "sarsa"},
        {"on_truncation": "terminate"},
        {"algorithm": "gradient_bandit", "learning_rate": 0.3, "learning_rate_schedule": "linear"},
        {"action_mask": lambda _: np.arange(10) % 2 == 0, "bit_generator": "MT19937"},
    ],
    ids=lambda chosen: "-".join(chosen),
)
def test_a_bandit_honours_what_other_environments_do(chosen: dict[str, Any]) -> None:
    settings: dict[str, Any] = {"episodes": 60, "max_episode_steps": 3, **chosen}
    run = qtab.train(BANDIT, seed=1, record=5, visits=True, **settings)
    assert run.config.backend == "rust"
    assert run.q_table.shape == ((3, 1, 10) if "time_aware" in chosen else (1, 10))
    assert run.visits is not None
    assert run.visits.sum() == 60
    assert len(run.recordings) == 5
    assert qtab.verify(run).equal
    many = qtab.train_many(BANDIT, seeds=2, threads=1, tables=True, **settings)
    assert many[1].tables.tobytes() == run.tables.tobytes()
    stopped = qtab.train(
        BANDIT, seed=1, callback=lambda progress: progress.episodes < 20, callback_every=20, **settings
    )
    assert qtab.resume(stopped).tables.tobytes() == run.tables.tobytes()
