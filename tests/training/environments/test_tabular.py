"""Training on TabularEnv in Rust."""

from typing import Any

import gymnasium as gym
import pytest
from gymnasium.wrappers import RecordEpisodeStatistics, TimeLimit

import qtab
from support.parity import assert_same_run

SETTINGS: dict[str, Any] = {"episodes": 200, "seed": 3, "epsilon": 0.5, "learning_rate": 0.3, "discount": 0.95}


def lake():
    env: Any = gym.make("FrozenLake-v1").unwrapped
    return qtab.TabularEnv(env.P, env.initial_state_distrib)


def test_rust_trains_on_a_tabular_env_as_python_does():
    env = lake()
    run = qtab.train(env, **SETTINGS)
    assert (run.config.backend, run.config.max_episode_steps) == ("rust", 10_000)
    assert_same_run(run, qtab.train(env, backend="gymnasium", **SETTINGS))
    assert qtab.verify(run, env=env).equal
    assert qtab.verify(run, episodes=20, env=env).equal
    assert qtab.evaluate(run, episodes=50, seed=0, env=env).lengths.sum() > 50


def test_a_tabular_env_of_the_lakes_table_trains_like_the_lake():
    one = qtab.train(TimeLimit(lake(), 100), **SETTINGS)
    other = qtab.train("FrozenLake-v1", initial_q=(-1.0, 1.0), **SETTINGS)
    assert (one.config.backend, other.config.backend) == ("rust", "rust")
    assert_same_run(one, other)


def test_an_edited_table_is_trained_as_edited():
    env = lake()
    env.P[0] = {action: [(1.0, 5, 3.0, True)] for action in range(4)}
    run = qtab.train(env, **SETTINGS)
    assert set(run.episode_returns) == {3.0}
    env.P[0][2] = [(0.5, 5, 3.0, True)]
    with pytest.raises(ValueError, match=r"got 'rust': P\[0\]\[2\] must have probabilities that sum to 1, got 0.5"):
        qtab.train(env, backend="rust", **SETTINGS)


def test_a_subclass_or_a_wrapper_is_stepped_in_python():
    class Mine(qtab.TabularEnv):
        def step(self, action):
            observation, reward, *rest = super().step(action)
            return observation, 2 * reward, *rest

    env = lake()
    assert qtab.train(Mine(env.P, env.initial_state_distrib), **SETTINGS).config.backend == "gymnasium"
    with pytest.raises(ValueError, match=r"got 'rust': its class Mine overrides step$"):
        qtab.train(Mine(env.P, env.initial_state_distrib), backend="rust", **SETTINGS)
    with pytest.raises(ValueError, match="Rust does not implement its wrapper RecordEpisodeStatistics"):
        qtab.train(RecordEpisodeStatistics(lake()), backend="rust", **SETTINGS)


class Painted(qtab.TabularEnv):
    """A subclass with attributes and pictures of its own, and TabularEnv's steps."""

    metadata = {"render_modes": ["ansi"]}  # noqa: RUF012 - Gymnasium's way

    def __init__(self, color: str = "red", render_mode: str | None = None) -> None:
        table: Any = gym.make("FrozenLake-v1").unwrapped
        self.color, self.render_mode = color, render_mode
        super().__init__(table.P, table.initial_state_distrib)

    def render(self) -> Any:
        return self.color


@pytest.fixture
def painted_id():
    name = "QtabTests/Painted-v0"
    gym.register(name, entry_point=lambda **kwargs: Painted(**kwargs), max_episode_steps=50)
    yield name
    del gym.registry[name]


@pytest.mark.parametrize("given", ["id", "spec", "object"])
def test_a_table_that_is_registered_by_an_id_is_stepped_in_rust(painted_id, given, caplog):
    env: Any = {"id": painted_id, "spec": gym.spec(painted_id), "object": gym.make(painted_id)}[given]
    run = qtab.train(env, **SETTINGS)
    assert (run.config.backend, run.config.max_episode_steps) == ("rust", 50)
    assert not caplog.records
    assert_same_run(run, qtab.train(env, backend="gymnasium", **SETTINGS))
    assert qtab.verify(run).equal
    assert (
        qtab.evaluate(run, episodes=3, seed=0).returns.tolist()
        == qtab.evaluate(run, episodes=3, seed=0, env=gym.make(painted_id, render_mode="ansi")).returns.tolist()
    )


def test_many_seeds_of_a_table_by_its_id_train_in_rust(painted_id):
    runs = qtab.train_many(
        painted_id, 3, tables=True, **{name: value for name, value in SETTINGS.items() if name != "seed"}
    )
    alone = qtab.train(painted_id, **{**SETTINGS, "seed": 1})
    assert runs.config.backend == "rust"
    assert runs[1].tables.tobytes() == alone.tables.tobytes()


def test_what_a_subclass_overrides_is_named(painted_id, caplog):
    gym.register("QtabTests/Mine-v0", entry_point=lambda **kwargs: Doubled(**kwargs))
    try:
        run = qtab.train("QtabTests/Mine-v0", **SETTINGS)
    finally:
        del gym.registry["QtabTests/Mine-v0"]
    assert run.config.backend == "gymnasium"
    assert "its class Doubled overrides reset; a subclass of qtab.TabularEnv that leaves reset" in caplog.text
    env = lake()
    env.observation_space = gym.spaces.Discrete(99)
    with pytest.raises(ValueError, match=r"got 'rust': its observation_space is Discrete\(99\), its table has 16$"):
        qtab.train(env, backend="rust", **SETTINGS)


class Doubled(Painted):
    def reset(self, *, seed=None, options=None):
        return super().reset(seed=seed, options=options)


@pytest.mark.parametrize("actions", [1, 2, 6, 7])
def test_tables_of_any_number_of_actions_train(actions):
    table = [[[(0.75, (state + action) % 5, action / 3, state == 4), (0.25, 0, -1, False)] for action in range(actions)]
             for state in range(5)]  # fmt: skip
    env = qtab.TabularEnv(table, [0.2] * 5)
    run = qtab.train(env, **SETTINGS, max_episode_steps=30)
    assert run.q_table.shape == (5, actions)
    assert_same_run(run, qtab.train(env, backend="gymnasium", **SETTINGS, max_episode_steps=30))
    assert qtab.verify(run, env=env).equal


def test_an_environment_of_gymnasium_trains_in_rust_when_requested():
    env = gym.make("Taxi-v4", fickle_passenger=True)
    rust = qtab.train(env, backend="rust", **SETTINGS)
    assert_same_run(rust, qtab.train(env, backend="gymnasium", **SETTINGS))


def test_many_runs_on_a_tabular_env_equal_single_runs():
    settings: dict[str, Any] = {**SETTINGS, "episodes": 40}
    del settings["seed"]
    runs = qtab.train_many(lake, seeds=4, tables=True, **settings)
    assert runs.config.backend == "rust"
    for seed, run in zip(runs.seeds, runs, strict=True):
        assert_same_run(run, qtab.train(lake(), seed=seed, **settings))
