"""Every function of the package that takes an environment, with one of a C library."""

import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from support.native.board import SETTINGS, board_library
from support.native.libraries import EXAMPLES, compile_c, needs_compiler
from support.processes.posix import posix_only
from support.processes.timer import stopped_by_a_timer

pytestmark = needs_compiler
ID = "own/Lander-v0"
BINS: dict[str, Any] = {"discretizer": "bins", "bins": [12, 10], "episodes": 40}


@pytest.fixture(autouse=True)
def registered(lander: Path) -> Iterator[None]:
    gym.register(ID, entry_point="qtab:NativeEnv", kwargs={"path": str(lander)})
    yield
    gym.registry.pop(ID)


def stopped(env: Any, after: int, **settings: Any) -> qtab.Run:
    """A run that is stopped after some episodes."""
    return qtab.train(env, callback=lambda _: False, callback_every=after, **settings)


def test_verify_compares_with_the_functions_called_from_python(lander: Path) -> None:
    assert qtab.verify(qtab.train(ID, seed=1, **BINS)).equal
    env = qtab.NativeEnv(lander)
    assert qtab.verify(qtab.train(env, seed=1, **BINS), env=env).equal
    assert qtab.verify(qtab.train(ID, seed=1, **BINS), episodes=10).equal


def test_verify_with_masks(tmp_path: Path) -> None:
    env = qtab.NativeEnv(board_library(tmp_path))
    assert qtab.verify(qtab.train(env, seed=1, **SETTINGS), env=env).equal


def test_evaluate_plays_with_the_learned_policy(lander: Path) -> None:
    run = qtab.train(ID, seed=1, **BINS)
    one = qtab.evaluate(run, episodes=5, seed=3)
    other = qtab.evaluate(
        qtab.train(qtab.NativeEnv(lander), seed=1, **BINS), env=qtab.NativeEnv(lander), episodes=5, seed=3
    )
    assert one.returns.tobytes() == other.returns.tobytes()


def test_train_many_equals_single_runs_on_any_number_of_threads(lander: Path) -> None:
    runs = [
        qtab.train_many(env, seeds=5, threads=threads, tables=True, **BINS)
        for env, threads in ((ID, 1), (ID, 3), (lambda: qtab.NativeEnv(lander), 2))
    ]
    for many in runs:
        assert many.config.backend == "rust"
        for seed in range(5):
            one = qtab.train(ID, seed=seed, **BINS)
            assert one.tables.tobytes() == many[seed].tables.tobytes()
            assert one.episode_returns.tobytes() == many.episode_returns[seed].tobytes()


def test_a_sweep_runs_on_threads() -> None:
    sweep = qtab.sweep(ID, {"learning_rate": [0.1, 0.3]}, seeds=2, **BINS)
    assert (len(sweep), sweep.failed) == (4, 0)
    one, other = (qtab.train(ID, seed=0, learning_rate=rate, **BINS).episode_returns for rate in (0.1, 0.3))
    assert not np.array_equal(one, other)


@pytest.mark.parametrize(
    "settings", [BINS, {**BINS, "algorithm": "n_step_sarsa"}, {**BINS, "algorithm": "sarsa_lambda"}], ids=str
)
def test_a_resumed_run_equals_the_uninterrupted_one(lander: Path, tmp_path: Path, settings: dict[str, Any]) -> None:
    whole = qtab.train(ID, seed=2, visits=True, **settings)
    part = stopped(ID, 13, seed=2, visits=True, **settings)
    part.save(tmp_path / "run.npz")
    env = qtab.NativeEnv(lander)
    resumed = [qtab.resume(part), qtab.resume(tmp_path / "run.npz")]
    resumed.append(qtab.resume(stopped(env, 13, seed=2, visits=True, **settings), env=env))
    for run in resumed:
        assert run.config.backend == "rust"
        for name in ("tables", "episode_returns", "visits"):
            assert getattr(run, name).tobytes() == getattr(whole, name).tobytes(), name


@posix_only
@pytest.mark.parametrize("algorithm", ["q_learning", "sarsa", "n_step_sarsa", "monte_carlo", "double_q_learning"])
@pytest.mark.parametrize("name", ["board", "lander"])
def test_a_run_resumes_within_an_episode(lander: Path, tmp_path: Path, name: str, algorithm: str) -> None:
    """The bytes of the state are stored, and the mask and the observation follow from them."""
    env = qtab.NativeEnv(lander if name == "lander" else board_library(tmp_path))
    settings = {**(BINS if name == "lander" else SETTINGS), "episodes": 2_000_000, "algorithm": algorithm, "seed": 5}
    part = stopped_by_a_timer(0.02, env, **settings)
    finished = len(part.episode_returns) + 2
    resumed = qtab.resume(part, env=env, callback=lambda _: False, callback_every=finished)
    whole = stopped(env, finished, **settings)
    for name in ("tables", "episode_returns", "episode_lengths"):
        assert getattr(resumed, name).tobytes() == getattr(whole, name).tobytes(), name


def test_recordings_visits_and_explanations() -> None:
    run = qtab.train(ID, seed=1, record=2, visits=True, **BINS)
    assert run.visits is not None
    assert run.visits.sum() == run.episode_lengths.sum()
    env = qtab.NativeEnv(gym.spec(ID).kwargs["path"])
    for recording in run.recordings:
        env.np_random = np.random.Generator(np.random.PCG64())
        env.np_random.bit_generator.state = dict(recording.start)
        env.reset()
        rewards = [env.step(action)[1] for action in recording.actions]
        assert np.add.accumulate(rewards)[-1] == run.episode_returns[recording.episode]
    assert f"{ID}, q_learning, seed 1, episode 3" in str(qtab.explain(run, episode=3))
    assert qtab.diagnose(run).findings is not None


@pytest.mark.parametrize("discretizer", [{"discretizer": "bins", "bins": [5, 4]}, {"discretizer": "tiles"}], ids=str)
@pytest.mark.parametrize("kind", ["function", "random"])
def test_values_of_a_policy(lander: Path, discretizer: dict[str, Any], kind: str) -> None:
    policy: Any = (lambda observation: int(observation[1] < -4)) if kind == "function" else "random"
    ours = qtab.estimate_values(ID, policy, seeds=2, episodes=25, **discretizer)
    for index, seed in enumerate(ours.seeds):
        # Any wrapper makes Python step the environment.
        env = gym.wrappers.TransformReward(qtab.NativeEnv(lander), lambda reward: reward)
        theirs = qtab.estimate_values(env, policy, seeds=[seed], episodes=25, **discretizer)
        assert ours.weights[index].tobytes() == theirs.weights[0].tobytes()


def test_the_time_limit_of_the_library_is_known_where_python_steps_it(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING, "qtab"):
        ours, theirs = (
            qtab.train(ID, seed=1, time_aware=True, backend=backend, **{**BINS, "episodes": 3})
            for backend in ("rust", "gymnasium")
        )
    assert "no time limit" not in caplog.text
    assert ours.config.max_episode_steps == theirs.config.max_episode_steps == 200
    assert ours.tables.tobytes() == theirs.tables.tobytes()


def test_a_library_of_other_content_is_reported(lander: Path, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    source = (EXAMPLES / "own_environment_c" / "lander.c").read_text(encoding="utf-8")
    heavier = compile_c(source.replace("{3.7, ", "{3.9, "), tmp_path, "heavier")
    run = stopped(qtab.NativeEnv(lander), 13, seed=2, **BINS)
    with caplog.at_level(logging.WARNING, "qtab"):
        qtab.resume(run, env=qtab.NativeEnv(heavier))
    assert "the code of NativeEnv was edited: its numbers may differ from earlier ones" in caplog.text


def test_discretizers_in_python_are_stepped_in_python(lander: Path) -> None:
    env = qtab.NativeEnv(lander)
    with pytest.raises(ValueError, match="got 'rust': a function as the discretizer, or max_rows"):
        qtab.train(env, backend="rust", max_rows=50, **BINS)
    assert (
        qtab.train(env, backend="gymnasium", seed=0, **BINS).tables.tobytes()
        == qtab.train(env, seed=0, **BINS).tables.tobytes()
    )


def test_a_vector_environment_of_gymnasium() -> None:
    envs = gym.make_vec(ID, 3)
    first, _ = envs.reset(seed=7)
    singly = [gym.make(ID).reset(seed=7 + index)[0] for index in range(3)]
    assert first.tobytes() == np.stack(singly).tobytes()
