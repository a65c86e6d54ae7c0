"""Every learner in Rust gives the table of its NumPy reference, byte for byte."""

from typing import Any, get_args

import pytest
from hypothesis import given, settings

import qtab
from qtab.config.choices import Algorithm
from qtab.config.options import PREFERENCES, TABLES_ONLY, fixed_settings
from support.environments import Chain
from support.learners.learner_settings import CAR, TRAINED, run_settings

ALGORITHMS = get_args(Algorithm)
PROFILE: Any = settings.default
BACKENDS: tuple[Any, ...] = ("rust", "gymnasium")


@pytest.mark.parametrize("env", TRAINED)
@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_random_settings_give_the_identical_table(algorithm: Any, env: str) -> None:
    @settings(max_examples=PROFILE.max_examples // (6 if env == CAR else 30), deadline=None)
    @given(run_settings(algorithm, env))
    def check(chosen: dict[str, Any]) -> None:
        try:
            run = qtab.train(env, backend="rust", **chosen)
        except OverflowError:
            return
        verification = qtab.verify(run)
        assert verification.equal, f"{chosen}\n{verification}"

    check()


@pytest.mark.slow
@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_a_long_episode_gives_the_identical_table(algorithm: Any) -> None:
    exploration: dict[str, Any] = {} if algorithm in PREFERENCES else {"epsilon": 0.1}
    cells: dict[str, Any] = {"scale": (10, 100)} if algorithm in TABLES_ONLY else {"discretizer": "tiles"}
    run = qtab.train(
        "MountainCar-v0",
        algorithm=algorithm,
        seed=0,
        episodes=1,
        max_episode_steps=250,
        learning_rate=0.3,
        initial_q=0.0,
        **{"discount": 1.0, **fixed_settings(algorithm)},
        **exploration,
        **cells,
    )
    assert qtab.verify(run).equal


@pytest.mark.parametrize("algorithm", ALGORITHMS)
@pytest.mark.parametrize("discretizer", ["round", "tiles"])
def test_both_backends_give_the_identical_table(algorithm: Any, discretizer: Any) -> None:
    if algorithm in TABLES_ONLY:
        discretizer = "round"
    chosen: dict[str, Any] = {"algorithm": algorithm, "discretizer": discretizer, "seed": 5, "episodes": 3}
    rust, python = (qtab.train("MountainCar-v0", backend=backend, **chosen) for backend in BACKENDS)
    assert rust.tables.tobytes() == python.tables.tobytes()
    assert rust.episode_returns.tobytes() == python.episode_returns.tobytes()


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_a_prefix_is_verified_with_the_full_runs_schedules(algorithm: Any) -> None:
    run = qtab.train("MountainCar-v0", algorithm=algorithm, seed=1, episodes=40, max_episode_steps=80)
    assert qtab.verify(run, episodes=3).equal


@pytest.mark.parametrize("algorithm", ALGORITHMS)
@pytest.mark.parametrize("features", [{"scale": (4,)}, {"discretizer": "tiles", "tilings": 4, "tiles": (5,)}])
def test_an_environment_in_python_gives_the_identical_table(algorithm: Any, features: dict[str, Any]) -> None:
    if algorithm in TABLES_ONLY:
        features = {"scale": (4,)}
    run = qtab.train(Chain(), algorithm=algorithm, seed=2, episodes=6, **features)
    assert run.terminated.any()
    assert qtab.verify(run, env=Chain()).equal
