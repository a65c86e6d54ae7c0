"""Training on other environments: LunarLander, a room like those of MiniGrid, and wrappers of many kinds."""

import sys
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.rendering.replay import replay_episode
from support.environments.gridworld import SHORTEST
from support.parity import assert_same_run

gym.register("qtab-tests/Room-v0", "support.environments.gridworld:Room", max_episode_steps=100)
ROOM: dict[str, Any] = {
    "episodes": 250,
    "learning_rate": 0.5,
    "discount": 0.95,
    "epsilon": 0.5,
    "min_epsilon": 0.0,
    "initial_q": 0.0,
}
ROOM |= {"seed": 0, "ties": "random"}


@pytest.mark.parametrize("multi", [False, True])
def test_the_shortest_path_through_a_room_is_learned(multi: bool) -> None:
    run = qtab.train("qtab-tests/Room-v0", env_kwargs={"multi": multi}, **ROOM)
    assert run.q_table.shape == (5, 5, 4, 3)
    assert run.config.max_episode_steps == 100
    played = qtab.evaluate(run, episodes=3, seed=1)
    assert played.lengths.tolist() == [SHORTEST] * 3
    assert played.terminated.all()
    assert played.mean_return == 1.0 - 0.005 * SHORTEST


def test_a_tuple_and_an_array_are_the_same_observation() -> None:
    one, other = (qtab.train("qtab-tests/Room-v0", env_kwargs={"multi": multi}, **ROOM) for multi in (False, True))
    assert_same_run(one, other)


@pytest.mark.parametrize(
    "algorithm", ["q_learning", *(pytest.param(name, marks=pytest.mark.slow) for name in ("sarsa_lambda", "dyna_q"))]
)
def test_a_slippery_room_is_learned_saved_loaded_and_verified(algorithm: Any, tmp_path: Any) -> None:
    few = {} if algorithm == "q_learning" else {"episodes": 120}  # these learn from fewer
    run = qtab.train("qtab-tests/Room-v0", env_kwargs={"slip": 0.1}, algorithm=algorithm, **{**ROOM, **few})
    run.save(tmp_path / "run.npz")
    loaded = qtab.load(tmp_path / "run.npz")
    assert qtab.verify(loaded).equal
    played = qtab.evaluate(loaded, episodes=50, seed=1)
    assert played.returns.tobytes() == qtab.evaluate(run, episodes=50, seed=1).returns.tobytes()
    assert played.terminated_rate == 1.0
    assert loaded.predict((1, 1, 0)) == run.predict(np.array([1, 1, 0]))


def test_the_last_episodes_in_the_room_are_replayed() -> None:
    run = qtab.train("qtab-tests/Room-v0", env_kwargs={"slip": 0.1}, record=5, **ROOM)
    env = gym.make("qtab-tests/Room-v0", slip=0.1, render_mode="ansi")
    returns = [replay_episode(env, recording) for recording in run.recordings]
    assert returns == run.episode_returns[-5:].tolist()
    assert all(returns)


LANDER: dict[str, Any] = {
    "algorithm": "sarsa_lambda",
    "discretizer": "tiles",
    "tilings": 8,
    "tiles": (3, 3, 3, 3, 3, 3, 1, 1),
    "low": (-1.0, -0.5, -1.5, -1.5, -1.0, -2.0, 0.0, 0.0),
    "high": (1.0, 1.5, 1.5, 1.0, 1.0, 2.0, 1.0, 1.0),
    "learning_rate": 0.3,
    "learning_rate_schedule": "constant",
    "discount": 0.99,
    "epsilon": 0.1,
    "trace_decay": 0.8,
    "trace_cutoff": 0.01,
    "initial_q": 0.0,
    "max_episode_steps": 300,
    "seed": 0,
}
"""Settings for LunarLander that learn something quickly; the bounds of its space are wider than its usual states."""


@pytest.fixture(scope="module")
def lander() -> str:
    pytest.importorskip("Box2D", reason="LunarLander needs the extra box2d")
    return "LunarLander-v3"


def test_the_preset_of_the_lander_trains_without_settings(lander: str) -> None:
    run = qtab.train(lander, episodes=2, seed=0)
    assert (run.config.preset, run.config.algorithm) == ("solved", "true_online_sarsa_lambda")
    assert run.tables.shape == (1, 2**20, 4)
    assert qtab.train(config=run.config).tables.tobytes() == run.tables.tobytes()


def test_without_box2d_the_error_names_its_installation(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.startswith("gymnasium.envs.box2d")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "Box2D", None)
    with pytest.raises(gym.error.DependencyNotInstalled, match=r'pip install "gymnasium\[box2d\]"'):
        qtab.train("LunarLander-v3", seed=0)


@pytest.mark.slow
def test_the_lander_learns_to_land_more_gently(lander: str) -> None:
    run = qtab.train(lander, episodes=200, hashed_rows=2**16, **LANDER)
    first, second = run.mean_returns(100)
    assert first < -50 < 0 < second


@pytest.mark.parametrize("hashed_rows", [None, 5000])
@pytest.mark.parametrize("algorithm", ["q_learning", "sarsa_lambda"])
def test_runs_on_the_lander_verify(lander: str, algorithm: Any, hashed_rows: int | None) -> None:
    # The reference visits the whole table at every step, so it is smaller than the one that learns to land.
    tiles = (2, 2, 2, 2, 2, 2, 1, 1)
    settings: dict[str, Any] = {**LANDER, "tiles": tiles, "algorithm": algorithm, "hashed_rows": hashed_rows}
    if algorithm == "q_learning":
        settings = {name: value for name, value in settings.items() if not name.startswith("trace_")}
    run = qtab.train(lander, episodes=3, **settings)
    assert run.config.backend == "gymnasium"
    assert qtab.verify(run).equal


def discretized(env: gym.Env) -> gym.Env:
    return gym.wrappers.DiscretizeObservation(env, bins=12)


WRAPPED: dict[str, tuple[Any, dict[str, Any]]] = {
    "TimeLimit": (lambda env: gym.wrappers.TimeLimit(env, 50), {"scale": (10, 100)}),
    "TransformReward": (
        lambda env: gym.wrappers.TransformReward(env, lambda reward: 2 * float(reward)),
        {"scale": (10, 100)},
    ),
    "NormalizeObservation": (
        gym.wrappers.NormalizeObservation,
        {"discretizer": "tiles", "low": (-2.0, -2.0), "high": (2.0, 2.0)},
    ),
    "NormalizeReward": (gym.wrappers.NormalizeReward, {"scale": (10, 100)}),
    "TimeAwareObservation": (
        gym.wrappers.TimeAwareObservation,
        {"discretizer": "tiles", "tiles": (8, 8, 2)},
    ),
    "DiscretizeObservation": (discretized, {}),
    "RescaleObservation": (
        lambda env: gym.wrappers.RescaleObservation(env, np.float32(-1), np.float32(1)),
        {"scale": (9, 7)},
    ),
    "StickyAction": (lambda env: gym.wrappers.StickyAction(env, 0.25), {"scale": (10, 100)}),
}


@pytest.mark.parametrize("name", WRAPPED)
def test_a_wrapped_environment_is_trained_with_its_wrappers(name: str) -> None:
    wrap, settings = WRAPPED[name]
    settings = {**settings, "episodes": 4, "seed": 3}
    ours, theirs = (qtab.train(wrap(gym.make(env)), **settings) for env in ("qtab/MountainCar-v0", "MountainCar-v0"))
    assert ours.config.backend == ("rust" if name == "TimeLimit" else "gymnasium")
    assert_same_run(ours, theirs)
    assert qtab.verify(ours, env=wrap(gym.make("MountainCar-v0"))).equal


def test_low_above_high_is_refused() -> None:
    env: Any = gym.make("MountainCar-v0").unwrapped
    env.observation_space.low[1] = 5.0
    with pytest.raises(ValueError, match=r"^the observation space must have low <= high, got Box\("):
        qtab.train(env, scale=(10, 100))
    with pytest.raises(ValueError, match=r"^low must lie below high, got \[-1.2.*, 5.0\] and \[0.6"):
        qtab.train(env, discretizer="tiles")


@pytest.mark.parametrize("settings", [{"discretizer": "round", "scale": (1,) * 4}, {"discretizer": "tiles"}], ids=str)
def test_infinite_bounds_without_limits_are_refused(settings: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"(have|has no) finite bounds.* Box\(\[-4.8 +-inf"):
        qtab.train("CartPole-v1", backend="gymnasium", low=None, high=None, **settings)


@pytest.mark.parametrize("hashed_rows", [None, 100])
def test_nan_in_an_observation_is_refused_with_its_component(hashed_rows: int | None) -> None:
    def spoil(observation: Any) -> Any:
        return np.array([observation[0], np.nan], np.float32)

    env = gym.make("MountainCar-v0")
    env = gym.wrappers.TransformObservation(env, spoil, env.observation_space)
    with pytest.raises(ValueError, match=r"^observation\[1\] is NaN, outside the observation space$") as caught:
        qtab.train(env, discretizer="tiles", hashed_rows=hashed_rows)
    assert len(caught.value.run.episode_returns) == 0  # type: ignore[attr-defined]
