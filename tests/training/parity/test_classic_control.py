"""Classic control trained in Rust: the tables of Gymnasium's own environments, byte for byte."""

from typing import Any, get_args

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab import _core
from qtab.config.choices import Algorithm
from qtab.config.options import TABLES_ONLY, fixed_settings
from support.learners.learner_settings import CAR, KEYWORDS, LIMITS, TRAINED
from support.parity import assert_same_run
from support.processes.machine import MACHINE

ALGORITHMS = get_args(Algorithm)
OTHERS = [env for env in TRAINED if env.values != (CAR,)]


def settings_of(env: str, discretizer: str) -> dict[str, Any]:
    low, high = LIMITS[env]
    few = {"actions": (-0.7, 0.1, 1.0)} if "Pendulum" in env or "Continuous" in env else {}
    own: dict[str, dict[str, Any]] = {
        "bins": {"bins": 3, "low": low, "high": high},
        "edges": {"edges": tuple((0.7 * first, 0.0, 0.2 * last) for first, last in zip(low, high, strict=True))},
        "round": {"scale": tuple(3.0 / (last - first) for first, last in zip(low, high, strict=True))},
        "tiles": {"tiles": 2, "tilings": 12, "low": low, "high": high},
    }
    return {"discretizer": discretizer, "learning_rate": 0.1, **own[discretizer], **few}


@pytest.mark.slow
@pytest.mark.parametrize("env", OTHERS)
def test_every_learner_and_discretizer_makes_the_table_of_gymnasium(env: str) -> None:
    kinds = ("bins", "edges", "tiles") if env == "CartPole-v1" else ("bins", "edges", "tiles", "round")
    pairs = [(kind, name) for kind in kinds for name in ALGORITHMS if kind != "tiles" or name not in TABLES_ONLY]
    for seed, (kind, algorithm) in enumerate(pairs):
        chosen = {**settings_of(env, kind), "algorithm": algorithm, "seed": seed, "episodes": 1 if seed % 2 else 4}
        chosen["max_episode_steps"] = 200 if seed % 2 else 37
        chosen["on_truncation"] = "terminate" if seed % 3 else "bootstrap"
        chosen |= fixed_settings(algorithm)
        fast = qtab.train(env, backend="rust", **chosen)
        assert_same_run(fast, qtab.train(env, backend="gymnasium", **chosen))


@pytest.mark.parametrize("env", OTHERS)
@pytest.mark.parametrize("kind", ["bins", "tiles"])
def test_many_runs_equal_single_runs(env: str, kind: str) -> None:
    chosen: dict[str, Any] = {**settings_of(env, kind), "episodes": 20, "max_episode_steps": 60}
    runs = qtab.train_many(env, seeds=6, threads=3, tables=True, **chosen)
    assert runs.tables is not None
    for seed in range(6):
        single = qtab.train(env, seed=seed, **chosen)
        assert runs.tables[seed].tobytes() == single.tables.tobytes()
        assert runs.episode_returns[seed].tobytes() == single.episode_returns.tobytes()


@pytest.mark.parametrize("env", OTHERS)
def test_all_ways_of_naming_an_environment_give_the_same_run(env: str) -> None:
    chosen: dict[str, Any] = {**settings_of(env, "bins"), "seed": 4, "episodes": 5, "max_episode_steps": 50}
    run = qtab.train(env, **chosen)
    assert run.config.backend == "rust"
    assert_same_run(run, qtab.train(f"qtab/{env}", **chosen))
    assert_same_run(run, qtab.train(gym.spec(env), **chosen))
    assert_same_run(run, qtab.train(gym.make(env), backend="rust", **chosen))
    assert_same_run(run, qtab.train(gym.make(env), backend="gymnasium", **chosen))


@pytest.mark.parametrize("env", [env for env in TRAINED if env.values[0] in KEYWORDS])
def test_keyword_arguments_reach_rust(env: str) -> None:
    name, values = KEYWORDS[env]
    chosen: dict[str, Any] = {**settings_of(env, "bins"), "seed": 4, "episodes": 5, "max_episode_steps": 300}
    for value in values:
        run = qtab.train(env, env_kwargs={name: value}, **chosen)
        assert run.config.backend == "rust"
        assert_same_run(run, qtab.train(env, env_kwargs={name: value}, backend="gymnasium", **chosen))


@pytest.mark.parametrize(
    ("env", "keywords"),
    [
        ("Pendulum-v1", {"g": np.float32(9.8)}),
        ("Pendulum-v1", {"g": 1e40}),
        ("CartPole-v1", {"render_mode": "rgb_array"}),
    ],
)
def test_unsupported_keyword_arguments_are_stepped_in_gymnasium(env: str, keywords: dict[str, Any]) -> None:
    chosen: dict[str, Any] = {
        **settings_of(env, "bins"),
        "seed": 4,
        "episodes": 1,
        "max_episode_steps": 3,
        "env_kwargs": keywords,
    }
    assert qtab.train(env, **chosen).config.backend == "gymnasium"
    with pytest.raises(ValueError, match=r"^backend must be 'auto' or 'gymnasium' for this environment, got 'rust': "):
        qtab.train(env, backend="rust", **chosen)


@pytest.mark.parametrize(
    ("env", "attribute", "value"),
    [
        ("CartPole-v1", "gravity", 9.0),
        ("CartPole-v1", "kinematics_integrator", "semi-implicit euler"),
        ("Acrobot-v1", "book_or_nips", "nips"),
        ("Acrobot-v1", "AVAIL_TORQUE", [-2.0, 0.0, 2.0]),
        ("Pendulum-v1", "max_speed", 9),
    ],
)
def test_rust_refuses_an_edited_object_with_the_name_of_the_attribute(env: str, attribute: str, value: Any) -> None:
    made = gym.make(env)
    setattr(made.unwrapped, attribute, value)
    with pytest.raises(ValueError, match=f"its attribute {attribute} was changed from"):
        qtab.train(made, backend="rust", **settings_of(env, "bins"))


@pytest.mark.parametrize("env", ["CartPole-v1", "Acrobot-v1", "Pendulum-v1"])
def test_gymnasium_steps_where_numpy_does_not_use_libm(env: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_core, "matches_numpy", lambda model: False)
    chosen: dict[str, Any] = {**settings_of(env, "bins"), "seed": 4, "episodes": 1, "max_episode_steps": 3}
    assert qtab.train(env, **chosen).config.backend == "gymnasium"
    with pytest.raises(ValueError, match=r"got 'rust': NumPy's sin and cos are not the platform's on this machine"):
        qtab.train(env, backend="rust", **chosen)


def test_rust_trains_where_numpy_uses_libm() -> None:
    assert all(_core.matches_numpy(name) for name in ("MountainCar", "ContinuousMountainCar"))
    for name in ("CartPole", "Pendulum"):
        assert _core.matches_numpy(name) == _core.numpy_uses_libm(), MACHINE


@pytest.mark.parametrize("name", [env for env in TRAINED if env.values == ("Acrobot-v1",)])
def test_first_observations_of_acrobot_equal_numpys_single_precision(name: str) -> None:
    """Edges right below and at each first observation of Gymnasium put it in the cell between them."""
    env = gym.make(name)
    for seed in range(300):
        observation, _ = env.reset(seed=seed)
        edges = tuple((float(np.nextafter(x, np.float32(-99))), float(x)) for x in observation)
        run = qtab.train(
            name,
            backend="rust",
            seed=seed,
            episodes=1,
            max_episode_steps=1,
            initial_q=0.0,
            discretizer="edges",
            edges=edges,
            epsilon=0.0,
            discount=0.0,
            learning_rate=1.0,
        )
        assert run.tables[0, run.discretizer.row(observation), 0] == -1.0
        assert run.discretizer.cell(observation) == (2,) * 6
