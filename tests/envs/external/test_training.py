"""Training in an environment of a C library: the numbers of the same environment in Python, to the last bit."""

from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from support.native.libraries import compile_c, example_class, needs_compiler
from support.repository import ROOT

pytestmark = needs_compiler
BINS: dict[str, Any] = {"discretizer": "bins", "bins": [12, 10], "episodes": 60}


def in_python() -> gym.Env[Any, Any]:
    """The lander in Python, with the time limit of the library."""
    env: Any = example_class("own_environment_c/lander.py", "Lander")()
    return gym.wrappers.TimeLimit(env, 200)


def assert_equal(ours: Any, theirs: Any) -> None:
    """The results of two runs are equal, byte for byte."""
    assert ours.config.backend == "rust"
    assert theirs.config.backend == "gymnasium"
    for name in ("episode_returns", "episode_lengths", "terminated", "tables"):
        assert getattr(ours, name).tobytes() == getattr(theirs, name).tobytes(), name


@pytest.mark.parametrize(
    "settings",
    [
        BINS,
        {"discretizer": "tiles", "tiles": [6, 6], "tilings": 8, "episodes": 30},
        {"discretizer": "round", "scale": [0.2, 0.5], "episodes": 60},
        {**BINS, "algorithm": "sarsa_lambda", "trace_decay": 0.9},
        {**BINS, "algorithm": "n_step_sarsa"},
        {**BINS, "algorithm": "dyna_q"},
        {**BINS, "algorithm": "double_q_learning", "bit_generator": "MT19937"},
        {**BINS, "on_truncation": "terminate", "max_episode_steps": 30},
        {**BINS, "time_aware": True, "max_episode_steps": 20, "on_truncation": "terminate"},
        {**BINS, "exploration": "softmax"},
    ],
    ids=lambda settings: "-".join(str(value) for value in settings.values() if isinstance(value, str)),
)
def test_the_numbers_are_those_of_python(lander: Path, settings: dict[str, Any]) -> None:
    ours = qtab.train(qtab.NativeEnv(lander), seed=3, **settings)
    theirs = qtab.train(in_python(), seed=3, **settings)
    assert_equal(ours, theirs)
    assert np.any(ours.tables)


def test_mountain_car_in_c_equals_that_of_the_core(tmp_path: Path) -> None:
    core = qtab.train("MountainCar-v0", episodes=50, seed=1)
    library = compile_c(ROOT / "benchmarks" / "mountain_car.c", tmp_path, "mountain_car")
    names = (
        "algorithm",
        "discretizer",
        "scale",
        "initial_q",
        "terminal_update",
        "learning_rate",
        "discount",
        "epsilon",
    )
    settings = {name: getattr(core.config, name) for name in (*names, "min_epsilon", "epsilon_schedule")}
    ours = qtab.train(qtab.NativeEnv(library), episodes=50, seed=1, **settings)
    for name in ("episode_returns", "episode_lengths", "terminated", "tables"):
        assert getattr(ours, name).tobytes() == getattr(core, name).tobytes(), name
