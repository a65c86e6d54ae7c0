"""Features with weights in an environment of a C library: the numbers of Python, resumed runs, and policies."""

from functools import partial
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from support.native.libraries import example_class, needs_compiler
from support.processes.posix import posix_only
from support.processes.timer import stopped_by_a_timer

pytestmark = needs_compiler
FOURIER: dict[str, Any] = {"discretizer": "fourier", "order": 3, "learning_rate": 0.002, "seed": 3, "progress": False}
ALGORITHMS = ("sarsa", "double_q_learning", "n_step_sarsa")


def in_python() -> gym.Env[Any, Any]:
    """The lander in Python, with the time limit of the library."""
    env: Any = example_class("own_environment_c/lander.py", "Lander")()
    return gym.wrappers.TimeLimit(env, 200)


def chosen(run: qtab.Run, observation: Any) -> Any:
    return run.predict(observation)[0]


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_the_numbers_are_those_of_python_and_of_the_reference(lander: Path, algorithm: Any) -> None:
    env = qtab.NativeEnv(lander)
    ours = qtab.train(env, algorithm=algorithm, episodes=20, **FOURIER)
    theirs = qtab.train(in_python(), algorithm=algorithm, episodes=20, **FOURIER)
    assert (ours.config.backend, theirs.config.backend) == ("rust", "gymnasium")
    for name in ("episode_returns", "episode_lengths", "terminated", "tables"):
        assert getattr(ours, name).tobytes() == getattr(theirs, name).tobytes(), name
    assert np.any(ours.tables)
    assert qtab.verify(ours, episodes=3, env=env).equal


@posix_only
@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_a_run_resumes_within_an_episode(lander: Path, algorithm: Any) -> None:
    env, settings = qtab.NativeEnv(lander), {**FOURIER, "algorithm": algorithm, "episodes": 2_000_000}
    part = stopped_by_a_timer(0.01, env, **settings)
    finished = len(part.episode_returns) + 2
    resumed = qtab.resume(part, env=env, callback=lambda _: False, callback_every=finished, progress=False)
    whole = qtab.train(env, callback=lambda _: False, callback_every=finished, **settings)
    for name in ("tables", "episode_returns", "episode_lengths"):
        assert getattr(resumed, name).tobytes() == getattr(whole, name).tobytes(), name


def test_a_learned_policy_acts_and_is_evaluated_as_in_python(lander: Path, tmp_path: Path) -> None:
    env = qtab.NativeEnv(lander)
    run = qtab.train(env, algorithm="sarsa", episodes=60, **FOURIER)
    run.save(tmp_path / "run.npz")
    stored = qtab.load(tmp_path / "run.npz")
    played = qtab.evaluate(run, 4, seed=1, env=env).returns
    assert played.tobytes() == qtab.evaluate(stored, 4, seed=1, env=in_python()).returns.tobytes()
    estimates = []
    for one in (run, stored):
        for policy in (one, partial(chosen, one)):
            estimates.append(qtab.estimate_values(env, policy, seeds=1, episodes=4, discretizer="tiles"))
    assert len({found.weights.tobytes() for found in estimates}) == 1
    assert np.any(estimates[0].weights)
    assert estimates[0].verify(env=env).equal
